"""Many points at once: scenes, structures, dampers, and the headline numbers of each, a row for every point."""

import json
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import groupby
from threading import Lock
from typing import Any

import numpy as np
import numpy.typing as npt

from damper import DampingCurve, ParticleDamper, damping_curve, ringdowns
from damper.curve_measurement import undamped
from damper.model import PARAMETERS
from workflows.effects import selection
from workflows.effects.selection import OF_THE_DAMPER, OF_THE_PLATE
from workflows.errors import BadInput, SpindampError, during, one_line
from workflows.formatting import interval, turning
from workflows.io import serialise
from workflows.io.serialise import Quantity
from workflows.progress import Stages
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene
from workflows.solve import coupling, limits
from workflows.solve import damper as damper_stage
from workflows.solve.damper import QUICK
from workflows.solve.known_modes import Request
from workflows.solve.model_choice import translated_errors
from workflows.solve.results import Damping, OwnFigures, Results, SpeedPoint
from workflows.solve.structure import PlateSolution, StructureSolver, StructureState
from workflows.studies.sweep.plan import SPEEDS, Plan, base, of_a_point, with_values

Rows = npt.NDArray[np.void]


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
    def verdict_damper(self) -> ParticleDamper:
        """The damper that a verdict speaks of."""
        return damper_stage.verdict_damper(self.scene, self.state.effects, self.point)

    @property
    def results(self) -> Results:
        """A run at this point alone, without the damper's own figures."""
        return replace(self.state, points=(self.point,)).results()


Known = dict[tuple[ParticleDamper, float, float], DampingCurve]
"""Figures of dampers as they are measured, with the dents in which their balls lie, and from where on they count.

Dampers that differ in their leading mode's damping alone have the same.
"""


_PLATES, _CAVITIES = 4, 16
"""Plates that are kept at a time, and cavities with which each of them is kept."""


class PlateCache:
    """The plates that were solved last, for as long as their dampers need them; for several threads."""

    def __init__(self) -> None:
        self._plate = lru_cache(maxsize=_PLATES)(_solver_of)
        self._lock = Lock()

    def state(self, source: SceneFile) -> StructureState:
        """The structure of a scene at all its speeds.

        Raises:
            BadInput, NoAnswer: see :class:`workflows.solve.structure.StructureSolver`.
        """
        if source.scene.plate is None:
            return StructureSolver(source, Stages(visible=False)).at()
        key = f"{plate_key(source.scene)} {source.mesh} {source.files_sha256}"
        solver, solutions = self._plate(Request(key, source))
        effects = {name: solver.choice.effects[name] for name in OF_THE_PLATE}
        effects |= selection.resolve(source.scene, source.name, solver.choice.form, names=OF_THE_DAMPER)
        with self._lock:
            known = tuple(solutions)
        solution = solver.with_cavities_of(source, effects, known)
        if solution not in known:
            with self._lock:
                solutions.append(solution)
        with translated_errors(source):
            points = solution.with_ball(source, effects)
        surface = None if source.mesh is None else solution.first_surface
        return StructureState(source, effects, points, solution, surface)


def _solver_of(plate: Request) -> tuple[StructureSolver, deque[PlateSolution]]:
    """What solves a plate, and its solutions with the cavities of the last dampers."""
    return StructureSolver(plate.source, Stages(visible=False)), deque(maxlen=_CAVITIES)


PLATES = PlateCache()
"""Of this process."""


def plate_key(scene: Scene) -> str:
    """What a scene's plate without cavities depends on, as text: all but the damper, of which the place counts."""
    data = scene.model_dump(mode="json", exclude_none=True, exclude={"title", "damper", "release", "design"})
    damper = scene.damper
    place = None if damper is None else {"at": damper.at, "housing": damper.housing}
    return json.dumps(data | {"damper": place}, sort_keys=True)


_OF_A_RING_DOWN = tuple(each.name for each in serialise.quantities(Damping) if each.headline)
"""Columns that a batch of ring-downs fills in, by the names of its fields."""

QUANTITIES = (
    *(each for each in serialise.quantities(SpeedPoint) if each.headline),
    Quantity("grade", "1", "beside what the air gives: 0 no, 1 hardly, 2 modestly, 3 yes; -1 no verdict", "i1"),
    Quantity("best_damping_ratio", "1", "largest damping ratio that the structure endures; none without a verdict"),
    Quantity("best_amplitude", "m", "amplitude where that is"),
    Quantity("friction_needed", "1", "friction coefficient that rolling requires there, if more than the scene has"),
    Quantity("sticks_out", "m", "how far the cavity sticks out of the structure; none where it does not"),
    Quantity("ball_mass", "kg", "of all balls together"),
)
"""Columns in the order of files; the first are those that a run's data set has too, by the same names."""

HEADLINE = "best_damping_ratio"
"""What the best point has most of: the damping ratio within what the structure endures."""

DONE = "done"

ROW = np.dtype([*((quantity.name, quantity.dtype) for quantity in QUANTITIES), ("reason", object), (DONE, bool)])
"""What is known of a point: its columns, why there is no answer (empty where there is one), whether it is done."""

UNGRADED = -1
"""The grade without a verdict."""


def empty(count: int) -> Rows:
    """Rows of which nothing is known yet."""
    rows = np.zeros(count, ROW)
    for quantity in QUANTITIES:
        rows[quantity.name] = np.nan if quantity.dtype == "f8" else UNGRADED
    rows["reason"] = ""
    return rows


def block(
    source: SceneFile, plan: Plan, begin: int, end: int, speeds: tuple[float, ...], *, quick: bool = False
) -> Rows:
    """The headline numbers of the points from `begin` to before `end`.

    speeds: at which structures are solved together, those of the points among them.
    """
    rows = empty(end - begin)
    cases = list(damper_cases(source, plan, rows, begin, speeds))
    known: Known = {}
    for each in cases:
        with during(f"at point {begin + each.number}, {turning(each.point.omega)}"):
            _measure(rows[each.number], each, known, QUICK if quick else {})
    with during(f"at {interval(str(begin), str(end - 1), before='points ', alone='point ')}"):
        _ring_down(rows, cases)
    rows[DONE] = True
    return rows


def damper_cases(
    source: SceneFile, plan: Plan, rows: Rows | None = None, begin: int = 0, speeds: tuple[float, ...] = ()
) -> Iterator[DamperCase]:
    """The dampers of all points from `begin` on, a row for each, that have one; the others get a reason.

    The structure's numbers are filled into the rows. It is solved at `speeds` together, by default those of the points.
    """
    rows = empty(plan.size) if rows is None else rows
    end = begin + len(rows)
    columns, speeds = plan.columns(begin, end), speeds or plan.speeds(begin, end)
    varied = [axis.key for axis in plan.axes]
    data, others = base(source, varied), [key for key in varied if key.name != SPEEDS]

    def refuse(numbers: list[int], error: SpindampError) -> None:
        rows["reason"][numbers] = one_line(str(error).removeprefix(f"{source.name}: "))

    for values, group in groupby(range(len(rows)), key=lambda number: [columns[key.name][number] for key in others]):
        numbers = list(group)
        try:
            state = PLATES.state(of_a_point(source, with_values(data, dict(zip(others, values, strict=True))), speeds))
        except SpindampError as error:
            refuse(numbers, error)
            continue
        for number in numbers:
            try:
                yield _case(number, state, float(columns[SPEEDS][number]), rows[number])
            except SpindampError as error:
                refuse([number], error)


def _case(number: int, state: StructureState, omega: float, row: Any) -> DamperCase:
    """The damper of a scene at a speed.

    Raises:
        BadInput: the structure has no answer at this speed, or the damper makes no sense on it.
    """
    scene, point = state.source.scene, state.by_speed.get(omega)
    if point is None or point.reduced is None:
        raise BadInput("the structure diverges at this speed", key="[rotor] speeds")
    damper = damper_stage.particle_damper(scene, state.effects, point)
    _fill(row, limits.with_contact(scene, point))
    row["ball_mass"] = damper.ball_mass
    row["sticks_out"] = point.sticks_out or np.nan
    return DamperCase(number, state, point, damper, coupling.release_displacement(scene, point, damper))


def _fill(row: Any, point: SpeedPoint) -> None:
    for name, value in serialise.headlines(point):
        row[name] = value


def _measure(row: Any, each: DamperCase, known: Known, how: dict[str, int]) -> None:
    """Fill in the damper's own figures."""
    damper = each.verdict_damper
    least, first = limits.least_amplitude(each.point), coupling.moves_first_from(damper, each.point)
    own = undamped(damper), damper.break_away, least
    if own not in known:
        known[own] = damping_curve(damper, threads=1, least=least, **how)
    point = replace(each.point, damping_curve=OwnFigures.of(known[own], each.point.tilt_share, first))
    verdict = limits.verdict(replace(each.results, speeds=(point,)), point)
    _fill(row, replace(point, verdict=verdict))
    row["grade"] = verdict.rank
    for name, value in (("best_damping_ratio", verdict.damping_ratio), ("best_amplitude", verdict.amplitude)):
        if value is not None:
            row[name] = value
    if verdict.amplitude is not None:
        row["friction_needed"] = limits.friction_needed(each.results, point, verdict.amplitude)


def _ring_down(rows: Rows, cases: list[DamperCase]) -> None:
    """Ring all dampers down from their scenes' releases, in batches of those that can go together."""
    groups: dict[Any, list[DamperCase]] = {}
    for each in cases:
        damper = each.damper
        alike = damper.formulation, damper.modes, damper.floor_friction is None, damper.floor_radius is None
        groups.setdefault((*alike, damper_stage.most_cycles(damper), each.scene.stop_cycles), []).append(each)
    for group in groups.values():
        batch, mine = _batch(group), [each.number for each in group]
        gravity, load = np.array([each.scene.rotor.gravity for each in group]), rows["load_g"][mine]
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(load > 0, batch.cutoff / gravity / load, np.nan)
        for name in _OF_A_RING_DOWN:
            rows[name][mine] = ratio if name == "cutoff_ratio" else getattr(batch, name)


def _batch(group: list[DamperCase]) -> Any:
    first, rows = group[0], np.concatenate([each.damper.parameters for each in group])
    left_out = ("printed", "floor_friction") if first.damper.floor_friction is None else ("printed",)
    how: dict[str, Any] = {name: rows[name] for name in PARAMETERS.names or () if name not in left_out}
    if first.damper.modes is not None:
        how["amplitudes"] = np.array([coupling.amplitudes(each.damper, each.release) for each in group])
    how["max_cycles"] = damper_stage.most_cycles(first.damper)
    return ringdowns(first.damper, [each.release for each in group], first.scene.stop_cycles, threads=1, **how)
