"""Many points at once: scenes, structures, dampers, and the headline numbers of each, a row for every point."""

from __future__ import annotations

import json
from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import groupby
from threading import Lock
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.effects import selection
from workflows.effects.definition import Effect
from workflows.effects.selection import OF_THE_DAMPER, OF_THE_PLATE
from workflows.errors import BadInput, SpindampError, during, one_line
from workflows.findings import limits
from workflows.findings.limits import Grade
from workflows.progress import Stages
from workflows.results.serialise import headlines
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene
from workflows.solve import coupling, structure
from workflows.solve import damper as damper_stage
from workflows.solve import results as plate_records
from workflows.solve.error_translation import answering
from workflows.solve.model_choice import decide
from workflows.solve.results import Discrete, OwnFigures, Results, SpeedPoint, Surface, taken_over
from workflows.studies.sweep import plan as scenes
from workflows.studies.sweep.axes import SPEEDS
from workflows.studies.sweep.plan import Plan

if TYPE_CHECKING:
    import numpy.typing as npt

    import fem
    from damper import Batch, ParticleDamper, Working
    from fem.meshes.mesh_sequence import Planform

    Rows = npt.NDArray[np.void]


QUICK = {"sweeps": 4, "stay": 60}
"""What the working range is measured with where a percent of it does not count."""


@dataclass(frozen=True, eq=False)
class Carried:
    """What carries a damper: its effects, a point for each speed that has an answer, and the plate's surface."""

    effects: dict[str, Effect]
    points: dict[float, SpeedPoint]
    surface: Surface | None


@dataclass(frozen=True, eq=False)
class Placed:
    """The damper of a point on the structure that carries it."""

    number: int
    scene: Scene
    carried: Carried
    point: SpeedPoint
    damper: ParticleDamper
    release: tuple[float, float]

    @property
    def judged(self) -> ParticleDamper:
        """The damper that a verdict speaks of."""
        return damper_stage.judged(self.scene, self.carried.effects, self.point)

    @property
    def results(self) -> Results:
        """A run at this point alone, without the damper's own figures."""
        return Results(self.scene, self.carried.effects, (self.point,), surface=self.carried.surface)


def measured(damper: ParticleDamper, known: dict[ParticleDamper, Working], **how: Any) -> Working:
    """The damper's own figures; those of one that differs in the structure's damping alone are known already."""
    from damper import working

    bare = replace(damper, damping_ratio=0.0)
    if bare not in known:
        known[bare] = working(bare, threads=1, **how)
    return known[bare]


_KEPT, _MASSES = 4, 256
"""Plates that are kept at a time, and balls' masses of each."""


@dataclass(frozen=True, eq=False)
class Solved:
    """A plate at all speeds: its effects and matrices, its modes, and the points of the speeds it has an answer at."""

    form: Planform | None
    effects: dict[str, Effect]
    discrete: Discrete
    diagram: fem.Campbell
    reduction: fem.Reduction
    points: tuple[SpeedPoint, ...]
    numbers: tuple[int, ...]
    surface: Surface | None
    carrying: dict[tuple[float | None, float | None, bool], tuple[SpeedPoint, ...]] = field(default_factory=dict)

    def with_ball(self, source: SceneFile, effects: dict[str, Effect]) -> tuple[SpeedPoint, ...]:
        """The points with what a damper of the mass in this scene feels."""
        damper, modes = source.scene.damper, effects["structural_modes"].on
        key = (None, None, modes) if damper is None else (damper.balls, damper.mass_ratio, modes)
        if key not in self.carrying:
            if len(self.carrying) >= _MASSES:
                self.carrying.clear()
            operators = self.discrete.choice.operators
            with answering(source):
                reduced = coupling.with_ball(source, self.reduction)
                at_cavity = coupling.cavity_modes(source, effects, operators, self.diagram, reduced)
            self.carrying[key] = tuple(
                replace(point, reduced=reduced[number], cavity_modes=at_cavity[number])
                for point, number in zip(self.points, self.numbers, strict=True)
            )
        return self.carrying[key]


class Plates:
    """The plates that were solved last, for as long as their dampers need them; for several threads."""

    def __init__(self) -> None:
        self._known: OrderedDict[str, Solved] = OrderedDict()
        self._lock = Lock()

    def carry(self, source: SceneFile) -> Carried:
        """The structure of a scene at all its speeds.

        Raises:
            BadInput, NoAnswer: see :func:`workflows.solve.structure.solve`.
        """
        scene = source.scene
        if scene.plate is None:
            effects = selection.resolve(scene, source.name)
            known = {omega: coupling.known_structure(scene, omega) for omega in scene.rotor.speeds}
            return Carried(effects, known, None)
        solved = self._solved(source)
        effects = solved.effects | of_the_damper(scene, solved.form)
        points = {point.omega: point for point in solved.with_ball(source, effects)}
        return Carried(effects, points, solved.surface)

    def _solved(self, source: SceneFile) -> Solved:
        key = plate_key(source.scene)
        with self._lock:
            if key in self._known:
                self._known.move_to_end(key)
                return self._known[key]
        found = solve(source)
        with self._lock:
            self._known[key] = found
            while len(self._known) > _KEPT:
                self._known.popitem(last=False)
        return found


def plate_key(scene: Scene) -> str:
    """What the solution of a scene's plate depends on, as text: all but the damper, of which the place counts."""
    data = scene.model_dump(mode="json", exclude_none=True, exclude={"title", "damper", "release", "design"})
    damper = scene.damper
    place = None if damper is None else {"at": damper.at, "housing": damper.housing}
    return json.dumps(data | {"damper": place}, sort_keys=True)


def solve(source: SceneFile) -> Solved:
    """Solve a plate at all speeds of a scene."""
    quiet = Stages(visible=False)
    decided = decide(source, quiet)
    with answering(source):
        discrete = structure.discretise(source, decided, quiet)
        diagram = structure.sweep(source, discrete)
        known = {float(omega): number for number, omega in enumerate(diagram.omega)}
        numbers = [known[omega] for omega in source.scene.rotor.speeds if omega in known]
        none: list[None] = [None] * diagram.omega.size
        points = plate_records.points(source, discrete, diagram, numbers, [*none], [() for _ in none])
        reduction = coupling.reduction(source, discrete.choice.operators, diagram)
        surface = None
        if source.mesh is not None:
            surface = plate_records.surface(discrete.choice.operators, diagram, numbers[:1], 1)
    effects = {name: decided.effects[name] for name in OF_THE_PLATE}
    return Solved(decided.form, effects, discrete, diagram, reduction, points, tuple(numbers), surface)


def of_the_damper(scene: Scene, form: Planform | None) -> dict[str, Effect]:
    """The effects of a scene's damper, decided as in a run."""
    found = {}
    for name, (called, why, _) in selection.called_for(scene, form, OF_THE_DAMPER).items():
        asked = getattr(scene.effects, name)
        found[name] = Effect(called if asked == "auto" else asked is True, why)
    return found


@dataclass(frozen=True)
class Quantity:
    """A column: its name, unit (1: none) and meaning; `kind` is its type in files."""

    name: str
    unit: str
    meaning: str
    kind: str = "f8"


_OF_A_RUN = tuple(headlines(SpeedPoint))
"""Columns that a run's data set has too, by the same names."""

QUANTITIES = (
    *(Quantity(each.name, each.unit, each.meaning, "i8" if each.kind is int else "f8") for each in _OF_A_RUN),
    Quantity("grade", "1", "beside what the air gives: 0 no, 1 hardly, 2 modestly, 3 yes; -1 no verdict", "i1"),
    Quantity("best_damping_ratio", "1", "largest damping ratio within what the plate endures; none without a verdict"),
    Quantity("best_amplitude", "m", "amplitude where that is"),
    Quantity("ball_mass", "kg", "of all balls together"),
)
"""Columns in the order of files."""

HEADLINE = "best_damping_ratio"
"""What the best point has most of: the damping ratio within what the plate endures."""

_REASON = ("reason", "i4")

ROW = np.dtype([(quantity.name, quantity.kind) for quantity in QUANTITIES] + [_REASON])
"""A row; `reason` is the number of the text that says why there is no answer, -1 where there is one."""

NUMBERS = tuple(quantity.name for quantity in QUANTITIES)
UNGRADED = int(Grade.UNKNOWN)


@dataclass(frozen=True, eq=False)
class Block:
    """Rows of the points from `begin` on, and the texts that their reasons count."""

    begin: int
    rows: Rows
    reasons: tuple[str, ...]


class Reasons:
    """Texts by number, each once."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def number(self, text: str) -> int:
        """Which one it is."""
        if text not in self.texts:
            self.texts.append(text)
        return self.texts.index(text)


def empty(count: int) -> Rows:
    """Rows without an answer."""
    rows = np.zeros(count, ROW)
    for quantity in QUANTITIES:
        rows[quantity.name] = np.nan if quantity.kind.startswith("f") else UNGRADED
    rows["reason"] = -1
    return rows


def of_the_structure(row: Any, point: SpeedPoint, ball_mass: float) -> None:
    """Fill in what carries the damper."""
    _fill(row, point)
    row["ball_mass"] = ball_mass


def damper_quantities(row: Any, results: Results, point: SpeedPoint) -> None:
    """Fill in the damper's own figures."""
    _fill(row, point)
    best, grade = limits.best(results, point), limits.grade(results, point)
    row["grade"] = int(grade)
    if grade is Grade.UNKNOWN:
        return
    row["best_damping_ratio"] = 0.0
    if best is not None:
        row["best_damping_ratio"], row["best_amplitude"] = best.damping_ratio, best.amplitude


def _fill(row: Any, point: SpeedPoint) -> None:
    for quantity in _OF_A_RUN:
        if (value := quantity.of(point)) is not None:
            row[quantity.name] = value


def of_the_ring_downs(rows: Rows, batch: Batch, gravity: npt.NDArray[np.float64]) -> None:
    """Fill in what ring-downs from the scenes' releases left."""
    rows["peak_sdc"], rows["impacts"], rows["events"] = batch.peak_sdc, batch.impacts, batch.events
    load = rows["load_g"]
    with np.errstate(divide="ignore", invalid="ignore"):
        rows["cutoff_ratio"] = np.where(load > 0, batch.cutoff / gravity / load, np.nan)


def block(source: SceneFile, plan: Plan, begin: int, end: int, plates: Plates, *, quick: bool = False) -> Block:
    """The headline numbers of the points from `begin` to before `end`."""
    rows, reasons = empty(end - begin), Reasons()
    placed = list(all_placed(source, plan, begin, plates, rows, reasons))
    known: dict[ParticleDamper, Working] = {}
    for each in placed:
        with during(f"at point {begin + each.number}, {each.point.rpm:.6g} rpm"):
            _measure(rows[each.number], each, known, QUICK if quick else {})
    with during(f"at points {begin} to {end - 1}"):
        _ring_down(rows, placed)
    return Block(begin, rows, tuple(reasons.texts))


def all_placed(
    source: SceneFile, plan: Plan, begin: int, plates: Plates, rows: Rows, reasons: Reasons
) -> Iterator[Placed]:
    """The dampers of all points from `begin` on, a row for each, that have one; the others get a reason."""
    end = begin + len(rows)
    columns = plan.columns(begin, end)
    varied = [axis.key for axis in plan.axes]
    data = scenes.base(source, varied)
    others = [key for key in varied if key.name != SPEEDS]
    every = plan.speeds(begin, end)

    def values(number: int) -> tuple[Any, ...]:
        return tuple(columns[key.name][number] for key in others)

    for given, numbers in groupby(range(len(rows)), key=values):
        mine = list(numbers)
        try:
            changed = scenes.with_values(data, dict(zip(others, given, strict=True)))
            found = scenes.of_a_point(source, changed, every)
            carried = plates.carry(found)
        except SpindampError as error:
            rows["reason"][mine] = reasons.number(said(error, source))
            continue
        for number in mine:
            omega = float(columns[SPEEDS][number])
            try:
                yield place(number, found.scene, carried, omega, rows[number])
            except SpindampError as error:
                rows["reason"][number] = reasons.number(said(error, source))


def place(number: int, scene: Scene, carried: Carried, omega: float, row: Any) -> Placed:
    """The damper of a scene at a speed, the structure's numbers filled into its row.

    Raises:
        BadInput: the structure has no answer at this speed, or the damper makes no sense on it.
    """
    point = carried.points.get(omega)
    if point is None or point.reduced is None:
        raise BadInput("the plate diverges at this speed", key="[rotor] speeds")
    damper = damper_stage.particle_damper(scene, carried.effects, point)
    of_the_structure(row, point, damper.ball_mass)
    return Placed(number, scene, carried, point, damper, coupling.released_at(scene, point))


def said(error: SpindampError, source: SceneFile) -> str:
    """Why a point has no answer."""
    return one_line(str(error).removeprefix(f"{source.name}: "))


def _measure(row: Any, each: Placed, known: dict[ParticleDamper, Working], how: dict[str, int]) -> None:
    figures = taken_over(OwnFigures, measured(each.judged, known, **how))
    point = replace(each.point, working=figures)
    damper_quantities(row, replace(each.results, speeds=(point,)), point)


def _ring_down(rows: Rows, placed: list[Placed]) -> None:
    """Ring all dampers down from their scenes' releases, in batches of those that can go together."""
    groups: dict[Any, list[Placed]] = {}
    for each in placed:
        groups.setdefault(_together(each), []).append(each)
    for group in groups.values():
        batch = _batch(group)
        mine = [each.number for each in group]
        filled = rows[mine]
        of_the_ring_downs(filled, batch, np.array([each.scene.rotor.gravity for each in group]))
        rows[mine] = filled


def _together(each: Placed) -> Any:
    """What the dampers of a batch have in common."""
    damper, release = each.damper, each.scene.release
    cycles = "auto" if release is None else release.cycles
    most = damper_stage.most_cycles(damper)
    return damper.formulation, damper.modes, damper.floor_friction is None, damper.floor_radius is None, most, cycles


def _batch(group: list[Placed]) -> Any:
    from damper import ringdowns
    from damper.model import PARAMETERS

    first = group[0]
    cycles = first.scene.release.cycles if first.scene.release is not None else "auto"
    released = [each.release for each in group]
    rows = np.concatenate([each.damper.parameters for each in group])
    names = [name for name in PARAMETERS.names or () if name != "printed"]
    if first.damper.floor_friction is None:
        names.remove("floor_friction")
    how: dict[str, Any] = {name: rows[name] for name in names}
    if first.damper.modes is not None:
        how["amplitudes"] = np.array([coupling.amplitudes(each.damper, each.release) for each in group])
    how["max_cycles"] = damper_stage.most_cycles(first.damper)
    return ringdowns(first.damper, released, None if isinstance(cycles, str) else cycles, threads=1, **how)
