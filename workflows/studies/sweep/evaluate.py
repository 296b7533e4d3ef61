"""Many points at once: scenes, structures, dampers, and the headline numbers of each, a row for every point."""

from __future__ import annotations

import json
from collections import OrderedDict, deque
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import groupby
from threading import Lock
from typing import Any

import numpy as np
import numpy.typing as npt

from damper import DampingCurve, ParticleDamper, damping_curve, ringdowns
from damper.model import PARAMETERS
from fem.meshes.mesh_sequence import Planform
from workflows.effects import selection
from workflows.effects.definition import Effect
from workflows.effects.selection import OF_THE_DAMPER, OF_THE_PLATE
from workflows.errors import BadInput, SpindampError, during, one_line
from workflows.io import serialise
from workflows.progress import Stages
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene
from workflows.solve import coupling, limits
from workflows.solve import damper as damper_stage
from workflows.solve.model_choice import translated_errors
from workflows.solve.results import Damping, OwnFigures, Results, SpeedPoint
from workflows.solve.structure import PlateSolution, StructureSolver, StructureState
from workflows.studies.sweep.plan import SPEEDS, Plan, base, of_a_point, with_values

Rows = npt.NDArray[np.void]
Block = tuple[Rows, tuple[str, ...]]

QUICK = {"sweeps": 4, "stay": 60}
"""What the working range is measured with where a percent of it does not count."""


@dataclass(frozen=True, eq=False)
class DamperCase:
    """The damper of a point of a sweep on the structure at a speed; `number`: of its row."""

    number: int
    state: StructureState
    point: SpeedPoint
    damper: ParticleDamper
    release: tuple[float, float]

    @property
    def scene(self) -> Scene:
        """What is asked."""
        return self.state.source.scene

    @property
    def judged(self) -> ParticleDamper:
        """The damper that a verdict speaks of."""
        return damper_stage.verdict_damper(self.scene, self.state.effects, self.point)

    @property
    def results(self) -> Results:
        """A run at this point alone, without the damper's own figures."""
        return self.state.results((self.point,))


def measured(damper: ParticleDamper, known: dict[ParticleDamper, DampingCurve], **how: Any) -> DampingCurve:
    """The damper's own figures; those of one that differs in the structure's damping alone are known already."""
    bare = replace(damper, damping_ratio=0.0)
    if bare not in known:
        known[bare] = damping_curve(bare, threads=1, **how)
    return known[bare]


_KEPT = 4
"""Plates that are kept at a time."""

_CUT = 16
"""Cavities with which each of them is kept."""


@dataclass(frozen=True, eq=False)
class _Plate:
    """A plate with its planform, its effects and what solves it; `solutions` with the cavities of the last dampers."""

    form: Planform | None
    effects: dict[str, Effect]
    solver: StructureSolver
    solutions: deque[PlateSolution] = field(default_factory=lambda: deque(maxlen=_CUT))


class PlateCache:
    """The plates that were solved last, for as long as their dampers need them; for several threads."""

    def __init__(self) -> None:
        self._known: OrderedDict[str, _Plate] = OrderedDict()
        self._lock = Lock()

    def state(self, source: SceneFile) -> StructureState:
        """The structure of a scene at all its speeds.

        Raises:
            BadInput, NoAnswer: see :class:`workflows.solve.structure.StructureSolver`.
        """
        if source.scene.plate is None:
            return StructureSolver(source, Stages(visible=False)).at()
        plate = self._plate(source)
        effects = plate.effects | of_the_damper(source.scene, plate.form)
        with self._lock:
            known = tuple(plate.solutions)
        solution = plate.solver.with_cavities_of(source, effects, known)
        if solution not in known:
            with self._lock:
                plate.solutions.append(solution)
        with translated_errors(source):
            points = solution.with_ball(source, effects)
        surface = None if source.mesh is None else solution.first_surface
        return StructureState(source, effects, points, solution, surface)

    def _plate(self, source: SceneFile) -> _Plate:
        key = plate_key(source.scene)
        with self._lock:
            if key in self._known:
                self._known.move_to_end(key)
                return self._known[key]
        solver = StructureSolver(source, Stages(visible=False))
        effects = {name: solver.choice.effects[name] for name in OF_THE_PLATE}
        plate = _Plate(solver.choice.form, effects, solver)
        with self._lock:
            self._known[key] = plate
            while len(self._known) > _KEPT:
                self._known.popitem(last=False)
        return plate


def plate_key(scene: Scene) -> str:
    """What a scene's plate without cavities depends on, as text: all but the damper, of which the place counts."""
    data = scene.model_dump(mode="json", exclude_none=True, exclude={"title", "damper", "release", "design"})
    damper = scene.damper
    place = None if damper is None else {"at": damper.at, "housing": damper.housing}
    return json.dumps(data | {"damper": place}, sort_keys=True)


def of_the_damper(scene: Scene, form: Planform | None) -> dict[str, Effect]:
    """The effects of a scene's damper, decided as in a run."""
    effects = {}
    for name, (called, why, _) in selection.called_for(scene, form, OF_THE_DAMPER).items():
        switch = getattr(scene.effects, name)
        effects[name] = Effect(called if switch == "auto" else switch is True, why)
    return effects


@dataclass(frozen=True)
class Quantity:
    """A column: its name, unit (1: none) and meaning; `kind` is its type in files."""

    name: str
    unit: str
    meaning: str
    kind: str = "f8"


_OF_A_RUN = tuple(each for each in serialise.quantities(SpeedPoint) if each.headline)
"""Columns that a run's data set has too, by the same names."""

_OF_A_RING_DOWN = tuple(each.name for each in serialise.quantities(Damping) if each.headline)
"""Those of them that a batch of ring-downs fills in, by the names of its fields."""

QUANTITIES = (
    *(Quantity(each.name, each.unit, each.meaning, "i8" if each.kind == "integer" else "f8") for each in _OF_A_RUN),
    Quantity("grade", "1", "beside what the air gives: 0 no, 1 hardly, 2 modestly, 3 yes; -1 no verdict", "i1"),
    Quantity("best_damping_ratio", "1", "largest damping ratio that the structure endures; none without a verdict"),
    Quantity("best_amplitude", "m", "amplitude where that is"),
    Quantity("ball_mass", "kg", "of all balls together"),
)
"""Columns in the order of files."""

HEADLINE = "best_damping_ratio"
"""What the best point has most of: the damping ratio within what the structure endures."""

_REASON = ("reason", "i4")

ROW = np.dtype([(quantity.name, quantity.kind) for quantity in QUANTITIES] + [_REASON])
"""A row; `reason` is the number of the text that says why there is no answer, -1 where there is one."""

NUMBERS = tuple(quantity.name for quantity in QUANTITIES)
UNGRADED = -1
"""The grade without a verdict."""


def empty(count: int) -> Rows:
    """Rows without an answer."""
    rows = np.zeros(count, ROW)
    for quantity in QUANTITIES:
        rows[quantity.name] = np.nan if quantity.kind.startswith("f") else UNGRADED
    rows["reason"] = -1
    return rows


def _measure(row: Any, each: DamperCase, known: dict[ParticleDamper, DampingCurve], how: dict[str, int]) -> None:
    """Fill in the damper's own figures."""
    point = replace(each.point, damping_curve=OwnFigures.of(measured(each.judged, known, **how), each.point.tilt_share))
    _fill(row, point)
    verdict = limits.verdict(replace(each.results, speeds=(point,)), point)
    row["grade"] = verdict.rank
    for name, value in (("best_damping_ratio", verdict.damping_ratio), ("best_amplitude", verdict.amplitude)):
        if value is not None:
            row[name] = value


def _fill(row: Any, point: SpeedPoint) -> None:
    for name, value in serialise.headlines(point):
        row[name] = value


def block(source: SceneFile, plan: Plan, begin: int, end: int, plates: PlateCache, *, quick: bool = False) -> Block:
    """The headline numbers of the points from `begin` to before `end`, and the texts that their reasons count."""
    rows, reasons = empty(end - begin), list[str]()
    cases = list(all_placed(source, plan, begin, plates, rows, reasons))
    known: dict[ParticleDamper, DampingCurve] = {}
    for each in cases:
        with during(f"at point {begin + each.number}, {each.point.rpm:.6g} rpm"):
            _measure(rows[each.number], each, known, QUICK if quick else {})
    with during(f"at points {begin} to {end - 1}"):
        _ring_down(rows, cases)
    return rows, tuple(reasons)


def all_placed(
    source: SceneFile, plan: Plan, begin: int, plates: PlateCache, rows: Rows, reasons: list[str]
) -> Iterator[DamperCase]:
    """The dampers of all points from `begin` on, a row for each, that have one; the others get a reason."""
    end = begin + len(rows)
    columns = plan.columns(begin, end)
    varied = [axis.key for axis in plan.axes]
    data = base(source, varied)
    others = [key for key in varied if key.name != SPEEDS]
    every = plan.speeds(begin, end)

    def values(number: int) -> tuple[Any, ...]:
        return tuple(columns[key.name][number] for key in others)

    for group, numbers in groupby(range(len(rows)), key=values):
        mine = list(numbers)
        try:
            changed = with_values(data, dict(zip(others, group, strict=True)))
            case = of_a_point(source, changed, every)
            state = plates.state(case)
        except SpindampError as error:
            rows["reason"][mine] = _number(reasons, said(error, source))
            continue
        for number in mine:
            omega = float(columns[SPEEDS][number])
            try:
                yield place(number, state, omega, rows[number])
            except SpindampError as error:
                rows["reason"][number] = _number(reasons, said(error, source))


def _number(reasons: list[str], text: str) -> int:
    """Which of the reasons a text is; a new one is added."""
    if text not in reasons:
        reasons.append(text)
    return reasons.index(text)


def place(number: int, state: StructureState, omega: float, row: Any) -> DamperCase:
    """The damper of a scene at a speed, the structure's numbers filled into its row.

    Raises:
        BadInput: the structure has no answer at this speed, or the damper makes no sense on it.
    """
    scene, point = state.source.scene, state.by_speed.get(omega)
    if point is None or point.reduced is None:
        raise BadInput("the structure diverges at this speed", key="[rotor] speeds")
    damper = damper_stage.particle_damper(scene, state.effects, point)
    _fill(row, limits.with_contact(scene, point))
    row["ball_mass"] = damper.ball_mass
    return DamperCase(number, state, point, damper, coupling.release_displacement(scene, point, damper))


def said(error: SpindampError, source: SceneFile) -> str:
    """Why a point has no answer."""
    return one_line(str(error).removeprefix(f"{source.name}: "))


def _ring_down(rows: Rows, cases: list[DamperCase]) -> None:
    """Ring all dampers down from their scenes' releases, in batches of those that can go together."""
    groups: dict[Any, list[DamperCase]] = {}
    for each in cases:
        groups.setdefault(_together(each), []).append(each)
    for group in groups.values():
        batch, mine = _batch(group), [each.number for each in group]
        gravity, load = np.array([each.scene.rotor.gravity for each in group]), rows["load_g"][mine]
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(load > 0, batch.cutoff / gravity / load, np.nan)
        for name in _OF_A_RING_DOWN:
            rows[name][mine] = ratio if name == "cutoff_ratio" else getattr(batch, name)


def _together(each: DamperCase) -> Any:
    """What the dampers of a batch have in common."""
    damper, release = each.damper, each.scene.release
    cycles = "auto" if release is None else release.cycles
    most = damper_stage.most_cycles(damper)
    return damper.formulation, damper.modes, damper.floor_friction is None, damper.floor_radius is None, most, cycles


def _batch(group: list[DamperCase]) -> Any:
    first, released = group[0], [each.release for each in group]
    cycles = first.scene.release.cycles if first.scene.release is not None else "auto"
    rows = np.concatenate([each.damper.parameters for each in group])
    names = [name for name in PARAMETERS.names or () if name != "printed"]
    if first.damper.floor_friction is None:
        names.remove("floor_friction")
    how: dict[str, Any] = {name: rows[name] for name in names}
    if first.damper.modes is not None:
        how["amplitudes"] = np.array([coupling.amplitudes(each.damper, each.release) for each in group])
    how["max_cycles"] = damper_stage.most_cycles(first.damper)
    return ringdowns(first.damper, released, None if isinstance(cycles, str) else cycles, threads=1, **how)
