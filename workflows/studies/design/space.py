"""What is free and what limits it, and from a point of the unit cube to a damper."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from fem.rotor import in_rpm
from workflows.formatting import significant
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile
from workflows.scene.materials import OSMIUM
from workflows.scene.scene import FLAT, Design, Scene
from workflows.solve import limits
from workflows.solve.results import Floats, SpeedPoint
from workflows.studies.sweep.evaluate import DamperCase
from workflows.studies.sweep.plan import SPEEDS, Axis, Plan, Value, at_shares, find

BEYOND, NONE = 100.0, 200.0
"""What a design loses that exceeds a limit, and one that makes no sense."""


@dataclass(frozen=True)
class Obstacle:
    """Why a design is worth nothing.

    Attributes:
        kind: `held` (at rest, by the load), `lossless`, `useless`, `undriven`, `limit`, `weight`, `root_stress`,
            `strain`, `deflection`, `slip`; or `refused`, for what a scene's checks say.
        rpm: the speed that it is about [rev/min]; value: the stress [Pa] or the friction that it takes.
        text: of what was refused, or the name of the limit.
    """

    kind: str
    rpm: float = math.nan
    value: float = math.nan
    text: str = ""


@dataclass(frozen=True)
class Evaluation:
    """What a design is worth.

    Attributes:
        value: what the goal is about: the least damping ratio, or the greatest amplitude [m]; 0 where there is none.
        score: what is searched for the most of.
        bound: what no ball of its mass in its room can better, at the goal's own amplitudes, speeds and forces; nan
            where there is no such figure.
        speed: at which the value is taken [rad/s]; amplitude: at which [m]; order: of the engine, 0 without.
        cutoff: largest amplitude over the speeds up to which the ball stays at rest [m].
        without: amplitude without any ball that the value stands beside [m]; nan where there is none.
        grows: by how much the force may grow at most before no ball is left at rest [-]; nan without a force.
        mass: of all balls [kg].
        used: shares of the limits.
        endured: amplitude that the plate endures [m]; inf where it is not known.
        falling: the least damping ratio where the vibration falls and a ball keeps bouncing; nan for other goals.
        why: why it is worth nothing; None where it is worth something.
    """

    value: float
    score: float
    bound: float = math.nan
    speed: float = math.nan
    amplitude: float = math.nan
    cutoff: float = math.nan
    mass: float = math.nan
    used: tuple[tuple[str, float], ...] = ()
    why: Obstacle | None = None
    order: int = 0
    without: float = math.nan
    grows: float = math.nan
    endured: float = math.inf
    falling: float = math.nan

    @property
    def rpm(self) -> float:
        """The speed at which the value is taken [rev/min]."""
        return round(in_rpm(self.speed), 9)

    @property
    def impossible(self) -> bool:
        """Whether it exceeds a limit, or makes no sense."""
        return self.score <= -BEYOND

    @property
    def works(self) -> bool:
        """Whether it is worth anything."""
        return self.why is None


@dataclass(frozen=True)
class Optimum:
    """The best design: its shares, its worth with full figures, and how many were tried."""

    shares: Floats
    evaluation: Evaluation
    evaluations: int


class Goal(Protocol):
    """What designs are compared by.

    Attributes:
        objective: what the value is, in words; of_damping: whether it is a damping ratio, or else an amplitude.
    """

    objective: ClassVar[str]
    of_damping: ClassVar[bool]

    @property
    def speeds(self) -> tuple[float, ...]:
        """At which designs are solved, ascending [rad/s]."""

    def worth(self, cases: list[DamperCase], *, quick: bool) -> Evaluation:
        """What a damper is worth on its structure at these speeds; `quick`: to a few percent."""


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
        solved_as: the scene with the effects that the goal requires.
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

    def plan(self, shares: Floats) -> Plan:
        """Designs at rows of shares, at all speeds of the goal."""
        speeds = Axis(find(SPEEDS, "[design]"), self.goal.speeds)
        return at_shares((*self.axes, speeds), np.clip(shares, 0.0, 1.0), {})

    def values(self, shares: Floats) -> dict[str, Value]:
        """The keys of a design by name."""
        return {axis.name: axis.at(np.array([share]))[0] for axis, share in zip(self.axes, shares, strict=True)}

    def summary(self, shares: Floats) -> str:
        """A design in words, key by key."""
        return ", ".join(formatted(name, value) for name, value in self.values(shares).items())


def formatted(name: str, value: Value) -> str:
    """A key of a design as [design] has it: a diameter, a clearance in mm."""
    label = NAMES[name].replace("_", " ")
    if isinstance(value, str) or name == "damper.count":
        return f"{label} {value}"
    if not math.isfinite(value):
        return f"{label} {FLAT}"
    return f"{label} {significant(1e3 * float(value) * (2 if name == 'damper.radius' else 1), 4)} mm"


def exceeded(shares: Mapping[str, float]) -> tuple[str, float] | None:
    """The limit that a damper exceeds, and the ratio by which; None within all of them."""
    over = [(name, ratio) for name, ratio in shares.items() if ratio > 1 + 1e-9 or (name == "hardness" and ratio >= 1)]
    return max(over, key=lambda item: item[1], default=None)


def limit_shares(design: Design, scene: Scene, ball_mass: float, fastest: SpeedPoint) -> dict[str, float]:
    """How much of each limit a damper uses up: of osmium's density, the mass, the plate's thickness, the strength."""
    shares, damper, plate = {}, scene.damper, scene.plate
    assert damper is not None
    if damper.ball_density is None:
        shares["density"] = damper.density(ball_mass) / OSMIUM
    if design.mass is not None:
        shares["mass"] = ball_mass / design.mass
    if plate is not None and damper.housing is None and plate.length is not None:
        thickness = plate_mesh.plate_thickness(plate, damper.on_plate or (plate.length, 0.0))
        shares["thickness"] = (damper.cavity[0] + 2 * design.wall) / thickness
    contact = limits.contact(scene, fastest)
    if contact is not None and not math.isnan(contact.hardness_ratio):
        shares["hardness"] = contact.hardness_ratio / design.hardness_ratio
    if contact is not None and design.yield_ratio is not None and not math.isnan(contact.yield_ratio):
        shares["first yield"] = contact.yield_ratio / design.yield_ratio
    return shares
