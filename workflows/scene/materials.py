"""Materials by name, from `workflows/materials.toml`. What a scene resolves to are the numbers."""

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workflows.scene.quantities import ROUNDING, fault

LIGHTEST = 10.0
"""Density [kg/m^3] below which a number is more likely one of g/cm^3: foams begin here, metals in g/cm^3 end at 23."""

OSMIUM = 22_600.0
"""Density [kg/m^3] of the densest element."""


@dataclass(frozen=True)
class Substance:
    """Density [kg/m^3], Young's modulus [Pa] and Poisson's ratio with their source; strength [Pa] where it is known.

    `plate`: whether plates are made of it. `strength`: the source of yield strength and hardness.
    """

    density: float
    youngs_modulus: float
    poissons_ratio: float
    source: str
    yield_strength: float | None = None
    hardness: float | None = None
    strength: str = ""
    plate: bool = False


NUMBERS = ("youngs_modulus", "poissons_ratio", "density")
"""Of a plate, which its material's name stands for."""

KGF = 9.80665e6
"""A kilogram-force per mm² [Pa], the unit of Brinell's and Vickers's numbers."""


def _known() -> Iterator[tuple[str, Substance]]:
    text = Path(__file__).parents[1].joinpath("materials.toml").read_text(encoding="utf-8")
    for name, numbers in tomllib.loads(text).items():
        hardness = KGF * numbers["hardness"] if "hardness" in numbers else None
        yield name, Substance(**numbers | {"hardness": hardness})


KNOWN = dict(_known())
"""By the names that a scene may give."""

PLATES = tuple(name for name, substance in KNOWN.items() if substance.plate)
BALLS = tuple(KNOWN)


def with_numbers(data: Any, name: str, names: tuple[str, ...], numbers: tuple[str, ...]) -> Any:
    """A table with the numbers of the material that its key `name` holds; as it is where there is none (of `names`)."""
    if not isinstance(data, Mapping) or data.get(name) is None:
        return data
    for number in numbers:
        if number in data:
            raise fault(number, f"already given by {name} = {data[name]!r}: leave one out")
    if not isinstance(data[name], str) or data[name] not in names:
        return data
    return {**data, **{number: getattr(KNOWN[data[name]], number.removeprefix("ball_")) for number in numbers}}


def is_too_dense(density: float) -> bool:
    """Whether nothing is as dense [kg/m³]."""
    return density > OSMIUM * (1 + ROUNDING)


def check_density(key: str, value: float) -> None:
    """A density [kg/m^3] that something solid has."""
    if value < LIGHTEST * (1 - ROUNDING):
        meant = f": was '{value:g} g/cm^3' meant?" if value >= 0.1 else ""
        raise fault(key, f"expected at least {LIGHTEST:g} kg/m^3, the lightest foam{meant}")
