"""What is free and what limits it: from a point of the unit cube to a damper, and to what it is worth."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from workflows.formatting import significant
from workflows.progress import Stages
from workflows.scene.load import SceneFile
from workflows.scene.materials import KNOWN, OSMIUM
from workflows.scene.scene import FLAT, Design, Scene
from workflows.solve import coupling, excitation, limits
from workflows.solve.results import Floats, SpeedPoint
from workflows.studies.design import objectives
from workflows.studies.design.objectives import Evaluation, LeastAmplitude, LeastDamping, Obstacle
from workflows.studies.sweep.evaluate import DamperCase, damper_cases, empty
from workflows.studies.sweep.plan import SPEEDS, Axis, Plan, Spread, Value, at_shares, find


@dataclass(frozen=True)
class Deviation:
    """A design with one of its lengths off by so much, relative, and its worth with full figures."""

    name: str
    relative: float
    evaluation: Evaluation


@dataclass(frozen=True)
class Optimum:
    """The best design.

    Attributes:
        evaluation: its worth with full figures; where the forced motion refutes the search, by the motion.
        evaluations: how many designs were tried.
        worst: its worst small deviation.
        confirmed: the greatest mean amplitude at the crossings, of the forced motion [m]; search_value: the one by
            which it was found [m]; None where the motion was not followed.
    """

    shares: Floats
    evaluation: Evaluation
    evaluations: int
    worst: Deviation | None = None
    confirmed: float | None = None
    search_value: float | None = None

    @property
    def is_vague(self) -> bool:
        """Whether what a small change gains or loses is lost in the scatter, or in the error of the search."""
        return self.is_refuted or not math.isnan(self.evaluation.greatest)

    @property
    def is_refuted(self) -> bool:
        """Whether the forced motion has another amplitude than the search."""
        return self.search_value is not None and self.search_value != self.evaluation.value


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
        has_to_fit: whether a cavity has to lie within a solid blade.
    """

    source: SceneFile
    design: Design
    axes: tuple[Axis, ...]
    goal: LeastDamping | LeastAmplitude
    solved_as: SceneFile
    has_to_fit: bool = True

    @property
    def continuous(self) -> list[int]:
        """Numbers of the axes that are ranges."""
        return [k for k, axis in enumerate(self.axes) if axis.is_continuous]

    @property
    def bounded(self) -> list[str]:
        """What has ends, beyond which other designs lie: ranges, and lists of numbers."""
        numbers = (sum(isinstance(value, int | float) for value in axis.values) for axis in self.axes)
        ranges = any(axis.spread is not None for axis in self.axes)
        return ["ranges"] * ranges + ["lists"] * any(count > 1 for count in numbers)

    def plan(self, shares: Floats) -> Plan:
        """Designs at rows of shares, at all speeds of the goal."""
        speeds = Axis(find(SPEEDS, "[design]"), self.goal.speeds)
        return at_shares((*self.axes, speeds), np.clip(shares, 0.0, 1.0), {})

    def values(self, shares: Floats) -> dict[str, Value]:
        """The keys of a design by name."""
        return {axis.name: axis.at(np.array([share]))[0] for axis, share in zip(self.axes, shares, strict=True)}

    def count(self, shares: Floats) -> int:
        """Balls of a design."""
        return int(self.values(shares).get("damper.count", self.source.scene.ball_count))

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
    return f"{label} {significant(float(in_mm(name, value)), 4)} mm"


def in_mm(name: str, value: Any) -> Any:
    """Lengths of a key in mm; of a ball its diameter."""
    return 1e3 * np.asarray(value, dtype=float) * (2 if name == "damper.radius" else 1)


def exceeded(shares: Mapping[str, float]) -> tuple[str, float] | None:
    """The limit that a damper exceeds, and the ratio by which; None within all of them."""
    over = [(name, ratio) for name, ratio in shares.items() if ratio > 1 + 1e-9 or (name == "hardness" and ratio >= 1)]
    return max(over, key=lambda item: item[1], default=None)


def has_thickness(scene: Scene) -> bool:
    """Whether the thickness of what holds the cavity is known: that of a plate without a mesh of its own is."""
    return math.isfinite(limits.room(scene))


def limit_shares(design: Design, scene: Scene, ball_mass: float, fastest: SpeedPoint) -> dict[str, float]:
    """How much of each limit a damper uses up: of osmium's density, the mass, the plate's thickness, the strength."""
    shares = _own_shares(design, scene, ball_mass)
    contact = limits.contact(scene, fastest)
    if contact is not None and not math.isnan(contact.hardness_ratio):
        shares["hardness"] = contact.hardness_ratio / design.hardness_ratio
    if contact is not None and design.yield_ratio is not None and not math.isnan(contact.yield_ratio):
        shares["first yield"] = contact.yield_ratio / design.yield_ratio
    return shares


def _own_shares(design: Design, scene: Scene, ball_mass: float | None) -> dict[str, float]:
    """The same of what does not depend on the load; without a ball's mass of the thickness alone."""
    shares, damper = {}, scene.damper
    assert damper is not None
    if damper.ball_density is None and ball_mass is not None:
        shares["density"] = damper.density(ball_mass) / OSMIUM
    if design.mass is not None and ball_mass is not None:
        shares["mass"] = ball_mass / design.mass
    if has_thickness(scene):
        shares["thickness"] = (damper.cavity[0] + 2 * design.wall) / limits.room(scene)
    return shares


_WIDE = 4.0
"""Ratio of a range's ends from which on it is searched in its logarithm."""


def design_space(source: SceneFile, stages: Stages | None = None) -> Space:
    """The designs that a scene allows.

    With a range of amplitudes they are compared by the least damping over it, else by the amplitude at the crossings.

    Raises:
        BadInput: it has no [design] or no damper to begin with, or one by the printed equations; see also
            :func:`amplitude_objective`.
        NoAnswer: the plate has none.
    """
    scene, design, damper = source.scene, source.scene.design, source.scene.damper
    if damper is None or design is None:
        raise source.wrong("the table is missing: design needs it", "[damper]" if damper is None else "[design]")
    if damper.formulation == "printed":
        problem = (
            "the printed equations do not conserve energy, so a design by them means nothing: expected 'consistent'"
        )
        raise source.wrong(problem, "[damper] formulation", damper.formulation)
    if design.place is not None and scene.plate is None:
        raise source.wrong("belongs to a plate", "[design] place")
    if design.wall and not has_thickness(scene):
        housed = ", not of a housing" if damper.housing is not None else ""
        why = f"the thickness at the damper is known only of a plate with length and width{housed}"
        problem = f"{why}: leave the key out, and limit ball_diameter and clearance to what fits"
        if scene.blade is not None:
            why = "on a solid blade the cavity itself has to fit, and walls beside it are not known"
            problem = f"{why}: leave the key out"
        raise source.wrong(problem, "[design] wall", design.wall)
    axes = _axes(design)
    if design.amplitude is not None:
        return Space(source, design, axes, LeastDamping(*design.amplitude, tuple(sorted(scene.rotor.speeds))), source)
    excitation.excitation_of(source)
    forced = coupling.with_forced_effects(source)
    return Space(source, design, axes, objectives.amplitude_objective(forced, stages or Stages(visible=False)), forced)


def _axes(design: Design) -> tuple[Axis, ...]:
    tables = {name: getattr(design, table) for name, table in NAMES.items()}
    return tuple(_axis(name, table) for name, table in tables.items() if table is not None)


def least_shares(source: SceneFile) -> dict[str, float]:
    """How much every design of a scene uses up at least of what it says itself: of density, mass and thickness."""
    scene, design, damper = source.scene, source.scene.design, source.scene.damper
    if damper is None or design is None:
        return {}
    ends = np.array([0.0, 1.0])
    free = {axis.name: axis.at(ends) if axis.spread is not None else list(axis.values) for axis in _axes(design)}
    dampers = []
    for end in (min, max):
        least: dict[str, Any] = {
            name: end(free.get(f"damper.{name}", [getattr(damper, name)])) for name in ("radius", "count")
        }
        if "damper.ball_material" in free:
            densities = [KNOWN[str(name)].density for name in free["damper.ball_material"]]
            least |= {"ball_density": end(densities), "mass": None, "mass_ratio": None}
        if "damper.clearance" in free:
            least["cavity"] = (2 * least["radius"] + end(free["damper.clearance"]),) * 2
        dampers.append(damper.model_copy(update=least))
    shares = [_own_shares(design, scene.model_copy(update={"damper": each}), each.balls) for each in dampers]
    known = {name: min(each[name] for each in shares) for name in shares[0]}
    if "damper.at[0]" in free:
        known.pop("thickness", None)
    return known


def _axis(name: str, limits: tuple[Any, ...]) -> Axis:
    """A pair is a range, any other list a choice; a ball is drawn by its radius."""
    key = find(name, "[design]")
    values = [math.inf if value == FLAT else value for value in limits]
    if name == "damper.radius":
        values = [value / 2 for value in values]
    numbers = all(isinstance(value, int | float) and math.isfinite(value) for value in values)
    if len(values) == 2 and numbers and values[0] < values[1]:
        low, high = map(float, values)
        return Axis(key, (), Spread(low, high, "log" if high > _WIDE * low and not key.whole else "even"))
    return Axis(key, tuple(values))


def screened(space: Space, shares: Floats) -> list[Evaluation]:
    """The first designs, up to one whose ball has to be simulated: what formulas say they are worth."""
    evaluations = list[Evaluation]()
    for row in shares:
        (evaluation,) = _evaluations(space, row[None], None)
        if evaluation is None:
            break
        evaluations.append(evaluation)
    return evaluations


def evaluate_designs(space: Space, shares: Floats, *, quick: bool) -> list[Evaluation]:
    """The designs at rows of shares; `quick` where a few percent do not count."""
    return [each for each in _evaluations(space, shares, quick) if each is not None]


def measured_again(space: Space, optimum: Optimum) -> Optimum:
    """The best design with the scatter of its damping over the starts, where it is of damping and works."""
    goal, found = space.goal, optimum.evaluation
    if not isinstance(goal, LeastDamping) or not found.works:
        return optimum
    cases = damper_cases(space.solved_as, space.plan(optimum.shares[None]))
    there = next(each for each in cases if each.point.omega == found.speed)
    return replace(optimum, evaluation=goal.scattered(found, there))


def _evaluations(space: Space, shares: Floats, quick: bool | None) -> list[Evaluation | None]:
    """The same; without `quick` by formulas alone, and None where these do not say."""
    plan = space.plan(shares)
    speeds = len(space.goal.speeds)
    rows = empty(plan.size)
    cases: list[list[DamperCase]] = [[] for _ in shares]
    for each in damper_cases(space.solved_as, plan, rows):
        cases[each.number // speeds].append(each)
    scores = list[Evaluation | None]()
    for number, mine in enumerate(cases):
        if refused := [text for text in rows["reason"][number * speeds : (number + 1) * speeds] if text]:
            scores.append(Evaluation(0.0, -objectives.NONE, why=Obstacle("refused", text=refused[-1])))
        else:
            scores.append(_one(space, mine, quick))
    return scores


def _one(space: Space, cases: list[DamperCase], quick: bool | None) -> Evaluation | None:
    """A design on its structure at every speed, these ascending."""
    scene, fastest = cases[0].scene, cases[-1]
    known: dict[str, Any] = {"mass": max(each.damper.ball_mass for each in cases)}
    if (why := _no_verdict(space, cases)) is not None:
        return Evaluation(0.0, -objectives.NONE, why=why, **known)
    shares = limit_shares(space.design, scene, known["mass"], fastest.point)
    known["used"] = tuple(shares.items())
    if (over := exceeded(shares)) is not None:
        name, ratio = over
        return Evaluation(0.0, -objectives.BEYOND - math.log(ratio), why=Obstacle("limit", text=name), **known)
    known["sticks_out"] = out = fastest.point.sticks_out
    if space.has_to_fit and scene.blade is not None and out > 0:
        score, why = -objectives.BEYOND - math.log1p(1e3 * out), Obstacle("sticks_out", value=out)
        return Evaluation(0.0, score, why=why, **known)
    evaluation = space.goal.screened(cases)
    if evaluation is None and quick is not None:
        evaluation = space.goal.worth(cases, quick=quick)
    if evaluation is None:
        return None
    endured = limits.endured(fastest.results)
    there, amplitude, hertz = cases[0], evaluation.value, None
    least = amplitude
    if isinstance(space.goal, LeastDamping):
        least, amplitude = space.goal.low, min(space.goal.high, endured)
    elif evaluation.order:
        of_order = [met for met in space.goal.crossings if met.order == evaluation.order]
        met = min(of_order, key=lambda each: abs(each.omega - evaluation.speed))
        there = min(cases, key=lambda each: abs(each.point.omega - met.omega))
        hertz = None if excitation.modes_at_crossing(there.point, met)[2] else met.frequency_hz
    if evaluation.works and limits.weight_at(there.results, there.point, least, hertz) > 1:
        return Evaluation(0.0, -objectives.NONE, why=Obstacle("weight", there.point.omega), **known)
    known["friction_needed"] = limits.friction_needed(there.results, there.point, amplitude, hertz)
    return replace(evaluation, endured=endured, **known)


def _no_verdict(space: Space, cases: list[DamperCase]) -> Obstacle | None:
    """Why there is no verdict on a design, whatever its ball does; None where there may be one."""
    slowest, fastest = cases[0], cases[-1]
    if limits.weight_governs(slowest.point):
        return Obstacle("weight", slowest.point.omega)
    if limits.is_torn(fastest.results, fastest.point):
        omega = fastest.point.omega
        return Obstacle("root_stress", omega, limits.root_stress(fastest.results, omega) or 0.0)
    if not isinstance(space.goal, LeastDamping):
        return None
    if space.goal.low > limits.endured(fastest.results):
        kind = "deflection" if limits.deflection_governs(fastest.results) else "strain"
        return Obstacle(kind, text=limits.strained(fastest.results.scene))
    friction = limits.friction_demand(slowest.results, slowest.point, space.goal.high)
    slides = limits.slides(slowest.results, slowest.point, space.goal.high)
    return Obstacle("slip", slowest.point.omega, friction) if slides else None
