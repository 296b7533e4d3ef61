"""Materials by name: a few, each with its source. What a scene resolves to are the numbers.

Elastic constants, densities and strengths are those at room temperature. A ball needs a density alone; what it presses
on its floor takes the rest, of both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from workflows.scene.quantities import ROUNDING, fault

LIGHTEST = 10.0
"""Density [kg/m^3] below which a number is more likely one of g/cm^3: foams begin here, metals in g/cm^3 end at 23."""

OSMIUM = 22_600.0
"""Density [kg/m^3] of the densest element."""


@dataclass(frozen=True)
class Substance:
    """Density [kg/m^3] and its source; of what is known of it, Young's modulus [Pa], Poisson's ratio and strength [Pa].

    `plate`: whether plates are made of it. `strength`: the source of yield strength and hardness.
    """

    density: float
    source: str
    youngs_modulus: float | None = None
    poissons_ratio: float | None = None
    yield_strength: float | None = None
    hardness: float | None = None
    strength: str = ""
    plate: bool = False


def _plate(youngs_modulus: float, poissons_ratio: float, density: float, source: str, **strength: Any) -> Substance:
    return Substance(density, source, youngs_modulus, poissons_ratio, plate=True, **strength)


KGF = 9.80665e6
"""A kilogram-force per mm² [Pa], the unit of Brinell's and Vickers's numbers."""

KNOWN = {
    "steel": _plate(210e9, 0.3, 7850.0, "EN 1993-1-1, 3.2.6; EN 1991-1-1, Table A.4"),
    "stainless steel": _plate(
        200e9,
        0.3,
        7900.0,
        "EN 1993-1-4, 2.1.3; EN 10088-1, grade 1.4301",
        yield_strength=215e6,
        hardness=129 * KGF,
        strength="ASM Aerospace Specification Metals, AISI 304: 215 MPa, 129 HV",
    ),
    "aluminium": _plate(70e9, 0.3, 2700.0, "EN 1999-1-1, 3.2.5"),
    "Ti-6Al-4V": _plate(
        113.8e9,
        0.342,
        4430.0,
        "ASM Aerospace Specification Metals, grade 5, annealed",
        yield_strength=880e6,
        hardness=349 * KGF,
        strength="the same: 880 MPa, 349 HV; 875 to 995 MPa are typical of annealed stock (nickel-systems.com)",
    ),
    # 29.0e6 psi at 70 °F, 0.297 lb/in^3 aged.
    "Inconel 718": _plate(
        200e9,
        0.29,
        8220.0,
        "Special Metals, SMC-045",
        yield_strength=1034e6,
        hardness=331 * KGF,
        strength="AMS 5663, aged bar, at least 150 ksi and 331 HB",
    ),
    "hardened steel": Substance(
        7800.0,
        "100Cr6, ISO 683-17: elastic constants of steel",
        210e9,
        0.3,
        2000e6,
        700 * KGF,
        "58 to 64 HRC (ASM International), 650 HV and more; proof stress about 2000 MPa, of which no source was found",
    ),
    # WC at 15.6 g/cm^3 with 6 % by mass of cobalt at 8.86 g/cm^3.
    "tungsten carbide": Substance(
        14_900.0,
        "WC with 6 % cobalt, from the densities of the CRC Handbook",
        630e9,
        0.22,
        4900e6,
        1500 * KGF,
        "data sheets of WC-6Co: 1500 HV 30; yield at a third of it, near the 4780 MPa in compression of makeitfrom.com",
    ),
    # Brittle: what yields in the formulas cracks.
    "silicon nitride": Substance(
        3200.0,
        "bearing balls, Lily Bearing, ceramic materials",
        310e9,
        0.27,
        4000e6,
        1500 * KGF,
        "the same: over 4000 MPa in compression, 1400 to 1600 HV",
    ),
    "alumina": Substance(
        3890.0,
        "99.5 % Al2O3, Lily Bearing, ceramic materials",
        375e9,
        0.22,
        2600e6,
        1440 * KGF,
        "the same: 2600 MPa in compression, 1440 kgf/mm²",
    ),
    "tungsten": Substance(19_300.0, "CRC Handbook of Chemistry and Physics"),
    "lead": Substance(
        11_300.0,
        "CRC Handbook of Chemistry and Physics",
        16.1e9,
        0.44,
        11e6,
        4.6 * KGF,
        "Callister, Materials Science and Engineering (1994): 11 MPa; 4 to 5 HB",
    ),
}
"""By the names that a scene may give."""

PLATES = tuple(name for name, substance in KNOWN.items() if substance.plate)
BALLS = tuple(KNOWN)


def filled(data: Any, name: str, names: tuple[str, ...], numbers: tuple[str, ...]) -> Any:
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


def dense_enough(key: str, value: float) -> None:
    """A density [kg/m^3] that something solid has."""
    if value < LIGHTEST * (1 - ROUNDING):
        meant = f": was '{value:g} g/cm^3' meant?" if value >= 0.1 else ""
        raise fault(key, f"expected at least {LIGHTEST:g} kg/m^3, the lightest foam{meant}")
