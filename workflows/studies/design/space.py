"""What is free and what limits it: from the table [design] to axes, and from a point of the unit cube to a damper."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.errors import BadInput
from workflows.scene import thicknesses
from workflows.scene.design import FLAT, Design
from workflows.scene.file import SceneFile
from workflows.scene.scene import Scene
from workflows.stages import Stages
from workflows.studies.design import amplitude
from workflows.studies.design.damping import LeastDamping
from workflows.studies.design.scored import Goal
from workflows.studies.response.solved import shaken
from workflows.studies.response.study import checked
from workflows.studies.sweep import keys, plans
from workflows.studies.sweep.axes import SPEEDS, Axis, Spread
from workflows.studies.sweep.keys import Value

if TYPE_CHECKING:
    import numpy.typing as npt

    Floats = npt.NDArray[np.float64]

NAMES = {
    "damper.ball_material": "ball_material",
    "damper.radius": "ball_diameter",
    "damper.clearance": "clearance",
    "damper.floor_radius": "floor_radius",
    "damper.count": "count",
    "damper.at[0]": "place",
}
"""Keys of a damper, and what [design] calls them."""

_WIDE = 4.0
"""Ratio of a range's ends from which on it is searched in its logarithm."""


@dataclass(frozen=True)
class Space:
    """All designs: axes of which each takes a share from 0 to 1, and limits.

    Attributes:
        source: the scene that they have in common.
        design: its table.
        axes: what is free.
        goal: what designs are compared by.
        solved_as: the scene with the effects that this takes.
    """

    source: SceneFile
    design: Design
    axes: tuple[Axis, ...]
    goal: Goal
    solved_as: SceneFile

    @property
    def continuous(self) -> list[int]:
        """Numbers of the axes that are ranges."""
        return [k for k, axis in enumerate(self.axes) if axis.spread is not None and not axis.key.whole]

    def plan(self, shares: Floats) -> plans.Sample:
        """Designs at rows of shares, at all speeds at which they are looked at."""
        speeds = Axis(keys.find(SPEEDS, "[design]"), self.goal.speeds)
        return plans.Sample((*self.axes, speeds), len(shares), 0, tiles=np.clip(shares, 0.0, 1.0))

    def values(self, shares: Floats) -> dict[str, Value]:
        """The keys of a design by name."""
        pairs = zip(self.axes, np.asarray(shares), strict=True)
        return {axis.name: plans.drawn(axis, np.array([share]))[0] for axis, share in pairs}


def of(source: SceneFile, stages: Stages | None = None) -> Space:
    """The designs that a scene allows.

    With a range of amplitudes they are compared by the least damping over it, else by the amplitude at the crossings.

    Raises:
        BadInput: it has no [design] or no damper to begin with; see also :func:`amplitude.of`.
        NoAnswer: the plate has none.
    """
    scene = source.scene
    for name in ("damper", "design"):
        if getattr(scene, name) is None:
            raise BadInput("the table is missing: design needs it", file=source.name, key=f"[{name}]")
    design = scene.design
    if design is None or scene.damper is None:
        raise ValueError("the scene has no [design]")
    if design.place is not None and scene.plate is None:
        raise BadInput("belongs to a plate", file=source.name, key="[design] place")
    found = []
    for name, table_name in NAMES.items():
        given = getattr(design, table_name)
        if given is not None:
            found.append(_axis(name, given))
    axes = tuple(found)
    if design.amplitude is not None:
        return Space(source, design, axes, LeastDamping(*design.amplitude, tuple(sorted(scene.rotor.speeds))), source)
    checked(source)
    as_shaken = shaken(source)
    return Space(source, design, axes, amplitude.of(as_shaken, stages or Stages(visible=False)), as_shaken)


def _axis(name: str, given: tuple[Any, ...]) -> Axis:
    """A pair is a range, any other list a choice; a ball is drawn by its radius."""
    key = keys.find(name, "[design]")
    values = [math.inf if value == FLAT else value for value in given]
    if name == "damper.radius":
        values = [value / 2 for value in values]
    numbers = all(isinstance(value, int | float) and math.isfinite(value) for value in values)
    if len(values) == 2 and numbers and values[0] < values[1]:
        low, high = map(float, values)
        return Axis(key, (), Spread(low, high, "log" if high > _WIDE * low and not key.whole else "even"))
    return Axis(key, tuple(values))


def misfit(design: Design, scene: Scene, ball_mass: float) -> tuple[str, float] | None:
    """The limit that a damper exceeds, and the ratio by which; None within all of them."""
    ratios = used(design, scene, ball_mass)
    over = [(name, ratio) for name, ratio in ratios.items() if ratio > 1 + 1e-9]
    return max(over, key=lambda item: item[1], default=None)


def used(design: Design, scene: Scene, ball_mass: float) -> dict[str, float]:
    """How much of each limit a damper uses up: of the mass, and of the plate's thickness."""
    found = {}
    if design.mass is not None:
        found["mass"] = ball_mass / design.mass
    damper, plate = scene.damper, scene.plate
    if damper is not None and plate is not None and damper.housing is None and plate.length is not None:
        thickness = thicknesses.at(plate, (plate.length, 0.0) if damper.at is None else damper.at)
        found["thickness"] = (damper.cavity[0] + 2 * design.wall) / thickness
    return found


def in_words(name: str, value: Value) -> str:
    """A key of a design as [design] has it: a diameter, a clearance in mm."""
    from workflows.wording import significant

    called = NAMES[name].replace("_", " ")
    if isinstance(value, str):
        return f"{called} {value}"
    if not math.isfinite(value):
        return f"{called} {FLAT}"
    if name == "damper.count":
        return f"{called} {value}"
    return f"{called} {significant(1e3 * float(value) * (2 if name == 'damper.radius' else 1), 4)} mm"
