"""What is free and what limits it, and from a point of the unit cube to a damper."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from workflows.scene import thicknesses
from workflows.scene.design import FLAT, Design
from workflows.scene.materials import OSMIUM
from workflows.scene.scene import Scene
from workflows.scene.source import SceneFile
from workflows.studies.design.scored import Goal
from workflows.studies.sweep import keys, plans
from workflows.studies.sweep.axes import SPEEDS, Axis
from workflows.studies.sweep.keys import Value

if TYPE_CHECKING:
    from workflows.studies.design.scored import Floats

NAMES = {
    "damper.ball_material": "ball_material",
    "damper.radius": "ball_diameter",
    "damper.clearance": "clearance",
    "damper.floor_radius": "floor_radius",
    "damper.count": "count",
    "damper.at[0]": "place",
}
"""Keys of a damper, and what [design] calls them."""


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


def misfit(design: Design, scene: Scene, ball_mass: float) -> tuple[str, float] | None:
    """The limit that a damper exceeds, and the ratio by which; None within all of them."""
    ratios = used(design, scene, ball_mass)
    over = [(name, ratio) for name, ratio in ratios.items() if ratio > 1 + 1e-9]
    return max(over, key=lambda item: item[1], default=None)


def used(design: Design, scene: Scene, ball_mass: float) -> dict[str, float]:
    """How much of each limit a damper uses up: of osmium's density, of the mass, and of the plate's thickness."""
    found = {}
    if scene.damper is not None and scene.damper.ball_density is None:
        found["density"] = scene.damper.density(ball_mass) / OSMIUM
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
