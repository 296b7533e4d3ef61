"""`spindamp accuracy`: error against time for the plate, the speeds, the damper and the whole pipeline."""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any, Literal

import numpy as np

import damper
import fem
from fem.meshes.mesh_sequence import Planform
from workflows import pipeline
from workflows.errors import NoAnswer, read_from
from workflows.formatting import fixed, significant, turning
from workflows.progress import Stages, Step
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile
from workflows.scene.scene import Accuracy
from workflows.solve import coupling
from workflows.solve.damper import particle_damper
from workflows.solve.model_choice import ModelChoice, choose_model
from workflows.solve.results import Discrete, Floats, Results, SpeedPoint, middle_speed
from workflows.solve.structure import discretise
from workflows.studies.work_precision.integration import LEVEL, Integration, Integrator
from workflows.studies.work_precision.timing import Choice, ConvergenceStudy, Setting, WorkPrecision, ladder, measure

CYCLES = 20
STEPS = (20, 40, 80, 160, 320, 640, 1280, 2560, 5120, 10240)
METHODS: dict[Integrator, tuple[float, ...]] = {
    "RK45": (1e-3, 1e-5, 1e-7, 1e-9),
    "DOP853": (1e-3, 1e-6, 1e-9, 1e-12),
    "LSODA": (1e-3, 1e-6, 1e-9),
    "Radau": (1e-3, 1e-6),
}
"""Integrators of `solve_ivp` with their relative tolerances."""

_REFERENCE: tuple[Integrator, float] = ("DOP853", 1e-13)

_ROUNDING = 1e-12
"""Share of the initial energy that rounding may misplace in the exact events' books."""

_NOTHING = 1e-9
"""Share of the initial energy below which what the ball takes drowns in rounding."""


def level(system: damper.ParticleDamper) -> damper.ParticleDamper:
    """The damper on a level floor with one mode along each axis, which is what the other methods know."""
    defaults: dict[str, Any] = {each.name: each.default for each in fields(system) if each.name in LEVEL}
    return replace(system, **defaults)


def damper_study(
    system: damper.ParticleDamper, release: tuple[float, float], point: SpeedPoint, step: Step
) -> tuple[ConvergenceStudy | None, Choice]:
    """Error of the energy that the ball takes in 20 cycles, and of the exact events against the tightest integration.

    What the structure's own damping takes is left out: it hides the ball's share, and every method has it right. There
    is no study where the ball takes nothing.
    """
    step.advance("reference")
    exact = damper.ringdown(system, release, CYCLES).energy
    taken = _taken(exact)
    if abs(taken) < _NOTHING * exact.initial:
        return None, Choice("exact events", f"the ball dissipates nothing in {CYCLES} cycles", None, None)
    try:
        apart = abs(_taken(Integration(system, release, CYCLES, *_REFERENCE)) / taken - 1.0)
        confirmed = (
            f"from which solve_ivp with {_REFERENCE[0]} at rtol {_REFERENCE[1]:g} differs by {significant(apart, 1)};"
            " the exact events' own error is given against that"
        )
    except (ArithmeticError, ValueError):
        apart, confirmed = None, "which no independent integration confirmed here"

    def error(run: Any) -> float:
        return abs(_taken(run) / taken - 1.0)

    def stepped(run: Any) -> tuple[int, float]:
        return len(run.time) - 1, error(run)

    start = system, release, CYCLES
    cases: list[tuple[Any, ...]] = [
        ("fixed step, as in the paper", f"{steps} a cycle", partial(damper.stepped_ringdown, *start, steps), stepped)
        for steps in STEPS
    ]
    for method, tolerances in METHODS.items():
        for rtol in tolerances:
            work = partial(Integration, *start, method, rtol)
            cases.append((f"solve_ivp, {method}", f"rtol {rtol:g}", work, lambda run: (run.evaluations, error(run))))
    own = (lambda run: (run.events, error(run.energy))) if apart is None else (lambda run: (run.events, apart))
    cases.append(("exact events", "no step", partial(damper.ringdown, *start), own))
    study = ConvergenceStudy(
        "damper",
        f"relative error of the energy that the ball dissipates in {CYCLES} cycles at {turning(point.omega)}",
        f"the exact events, {confirmed}",
        tuple(replace(row, uncertainty=apart) for row in ladder(step, cases)),
    )
    rounding = _ROUNDING * exact.initial / abs(taken)
    setting = "power series between events, roots to rounding"
    if apart is not None:
        setting += "; estimate: what rounding misplaces, true: against solve_ivp"
    return study, Choice("exact events", setting, rounding, apart)


def _taken(balance: Any) -> float:
    """What the ball took: by rolling, by impacts and, where the equations do not conserve energy, by their fault.

    balance: energies [J] at the start and at the end, and what the structure's own dashpot took.
    """
    return float(balance.initial - balance.final - balance.structure)


ASKED = (1e-1, 1e-2, 1e-3, 1e-4)
FINEST = 1e-5


QUANTITIES: dict[str, Callable[[SpeedPoint], float | None]] = {
    "first frequency": lambda point: point.reduced.f2_hz if point.reduced else point.modes[0].frequency_hz,
    "cut-off": lambda point: None if point.damper is None else point.damper.cutoff_g,
    "peak specific damping capacity": lambda point: None if point.damper is None else point.damper.peak_sdc,
}
"""Headline numbers of a run, at one speed."""


def pipeline_studies(source: SceneFile, step: Step) -> tuple[list[ConvergenceStudy], dict[str, Choice]]:
    """A study of each headline number that the scene has; none without a plate, where there is nothing to choose."""
    if source.scene.plate is None:
        return [], {}
    known = choose_model(source, Stages(visible=False)).theory
    if known is not None:  # the error of a theory is not one of accuracy
        source = source.changed(plate={"theory": known.name})

    def run(accuracy: float | None = None) -> Results:
        wanted = {} if accuracy is None else {"accuracy": Accuracy(frequency=accuracy, damping=accuracy)}
        return pipeline.run(source.changed(**wanted), Stages(visible=False))

    step.advance("reference")
    finest = run(FINEST)
    shown = middle_speed(finest.speeds)
    best = finest.speeds[shown]
    runs: list[tuple[Setting, Results | None]] = []
    for target in ASKED:
        step.advance(f"accuracy {target:g}")
        runs.append(measure("pipeline", f"accuracy {target:g}", partial(run, target), lambda _: (None, 0.0)))
    own = run()
    studies, chosen = [], {}
    for name, quantity in QUANTITIES.items():
        if not (reference := quantity(best)):
            continue

        def error(results: Results, quantity: Any = quantity, reference: float = reference) -> float | None:
            """Relative error against the finest run; None on its own mesh, whose error it shares."""
            value = quantity(results.speeds[shown])
            same = finest.diagram is not None and _mesh(results) == _mesh(finest)
            return None if value is None or same else abs(value / reference - 1.0)

        rows = []
        for row, results in runs:
            if results is not None and quantity(results.speeds[shown]) is None:
                row = Setting(row.method, row.setting, failed=f"no {name} was obtained")
            elif results is not None:
                setting = ": ".join(filter(None, (row.setting, _mesh(results))))
                failed = "the reference's own mesh" if error(results) is None else None
                row = replace(row, setting=setting, unknowns=None, error=error(results), failed=failed)
            rows.append(row)
        compared = f"relative error of the {name} at {turning(best.omega)}"
        against = f"the same scene and theory with an accuracy of {FINEST:g}{_reference(finest, shown)}"
        studies.append(ConvergenceStudy(f"whole pipeline: {name}", compared, against, tuple(rows)))
        modes = own.speeds[shown].modes
        estimate = modes[0].error_estimate if name == "first frequency" and modes else None
        chosen[f"pipeline: {name}"] = Choice("pipeline", _mesh(own), estimate, error(own))
    return studies, chosen


def _mesh(results: Results) -> str:
    return "" if results.diagram is None else results.diagram.mesh


def _reference(finest: Results, shown: int) -> str:
    """What the reference was solved on, and the accuracy of its first frequency."""
    modes = finest.speeds[shown].modes
    if finest.diagram is None or not modes:
        return ""
    estimate = modes[0].error_estimate
    good = "" if estimate is None else f", its first frequency good to about {significant(estimate, 1)}"
    return f" ({finest.diagram.mesh}{good})"


SOLID_AT_MOST = 40_000
"""Unknowns of a solid that are still tried."""

WITH_THEORY = "plate, with the error of the theory"
"""The stage in which all theories are held against the solid."""


@dataclass(frozen=True)
class Method:
    """A way to solve a plate: theory or theory/element, cells, what tables call it, the finest size it is tried on."""

    model: str
    name: str
    finest: int
    cells: Literal["graded", "even", "triangles"] = "graded"

    @property
    def theory(self) -> str:
        """Without the element or the number of layers."""
        return self.model.partition("/")[0]


PLATE_METHODS = (
    Method("kirchhoff/bfs", "thin plate, BFS rectangles", 12),
    Method("kirchhoff/argyris", "thin plate, Argyris triangles", 8, "triangles"),
    Method("kirchhoff/morley", "thin plate, Morley triangles", 10, "triangles"),
    Method("mindlin", "Mindlin, Q2 rectangles", 12),
    Method("mindlin", "Mindlin, P2 triangles", 8, "triangles"),
    Method("mindlin", "Mindlin, Q2 on even cells", 12, "even"),
    Method("solid/2", "solid, 2 layers of bricks", 5),
    Method("solid/4", "solid, 4 layers of bricks", 4),
)
"""What is tried on the planform's ladder of meshes."""

LIMITS = (
    Method("kirchhoff/bfs", "thin plate", 12),
    Method("mindlin", "Mindlin", 16),
    Method("solid/4", "solid", 6),
)
"""By what the limit of each theory is extrapolated, and from which size; on a file's mesh from the fourth or second."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A plate to be solved for some modes at one speed [rad/s], without Coriolis forces and large deflection.

    `mindlin`: what a run takes for Mindlin's theory, which says where its plate is clamped.
    """

    form: Planform
    plate: Callable[[Any], fem.Plate]
    rotor: fem.Rotor
    effects: fem.Effects
    omega: float
    count: int
    mindlin: str = "mindlin"

    def solve(self, method: Method, size: int) -> tuple[int, Floats]:
        """Unknowns, and frequencies (count,) in Hz, on a mesh of the planform's ladder."""
        if method.cells != "even":
            mesh = self.form.mesh(size)
        elif isinstance(self.form, fem.Rectangle):
            mesh = fem.rectangle(*self.form.sides, *self.form.cells(size))
        else:
            raise ValueError("the mesh is from a file")
        if method.cells == "triangles" and mesh.t.shape[0] == 4:
            mesh = mesh.to_meshtri()
        model = self.mindlin if method.model == "mindlin" else method.model
        operators = fem.assemble(self.plate(mesh), self.rotor, self.effects, model)
        return operators.mass.shape[0], fem.solve_modes(operators, self.omega, self.count).frequencies_hz

    def sizes(self, finest: int) -> list[int]:
        """The meshes on which a method is tried: of a file's mesh, itself and one finer."""
        every = self.form.sizes if isinstance(self.form, fem.Rectangle) else self.form.sizes[:2]
        return [size for size in every if size <= finest]

    def unknowns(self, method: Method, size: int) -> int:
        """About how many unknowns a solid has; 0 of other theories, which are small."""
        if method.theory != "solid":
            return 0
        mesh = self.form.mesh(1)
        cells = mesh.t.shape[1] * size**2 * (3 if mesh.t.shape[0] == 3 else 1)
        return int(cells * 4 * (2 * int(method.model.partition("/")[2]) + 1) * 3)

    def setting(self, size: int) -> str:
        """A mesh in words."""
        if isinstance(self.form, fem.Rectangle):
            return "{} × {}".format(*self.form.cells(size))
        return "the file's mesh" if size == 1 else f"each edge split in {size}"


def limits(problem: Problem, step: Step) -> dict[str, tuple[Floats, float]]:
    """The limit of each theory, extrapolated from the two finest meshes, and how far it can be trusted, relatively."""
    best, rectangle = {}, isinstance(problem.form, fem.Rectangle)
    for method in LIMITS:
        step.advance(f"limit of {method.theory}")
        finest = method.finest if rectangle else 4 if method.theory == "mindlin" else 2
        if not rectangle and method.theory == "kirchhoff":
            method = replace(method, model="kirchhoff")
        sizes = [size for size in problem.form.sizes if size <= finest]
        sizes = [size for size in sizes if problem.unknowns(method, size) <= SOLID_AT_MOST]
        pair = sizes[-3::2] if len(sizes) > 2 and rectangle else sizes[-2:]
        if len(pair) < 2:
            continue
        (_, before), (_, last) = (problem.solve(method, size) for size in pair)
        growth = (pair[1] / pair[0]) ** min(problem.form.orders)
        limit = last + (last - before) / (growth - 1.0)
        if method.theory == "solid":  # from four layers of bricks to six, on a coarse mesh, whose error falls out
            coarse = next(size for size in reversed(problem.form.sizes) if size <= max(1, pair[0] // 2))
            models = (replace(method, model=f"solid/{layers}") for layers in (4, 6))
            (_, four), (_, six) = (problem.solve(model, coarse) for model in models)
            limit = limit * (six / four)
        best[method.theory] = limit, _largest_error(limit, last)
    return best


def plate_studies(problem: Problem, step: Step) -> tuple[list[ConvergenceStudy], dict[str, tuple[Floats, float]]]:
    """Error against the limit of the row's own theory, and against the solid: that of the theory comes on top."""
    known = limits(problem, step)
    own, solid = [], []
    for method in PLATE_METHODS:
        limit, trust = known.get(method.theory, (None, None))
        for size in problem.sizes(method.finest):
            step.advance(f"{method.name}, {size}")
            row, frequencies = _row(problem, method, size, limit)
            own.append(replace(row, uncertainty=trust))
            if "solid" in known and frequencies is not None:
                exact, trust_of_exact = known["solid"]
                row = replace(row, error=_largest_error(frequencies, exact), uncertainty=trust_of_exact)
            solid.append(row)
    where = f"{problem.count} frequencies at {turning(problem.omega)}"
    trusts = ", ".join(f"{theory} to {significant(error, 1)}" for theory, (_, error) in known.items())
    reference = f"limit of each row's own theory, extrapolated from the two finest meshes ({trusts})"
    studies = [ConvergenceStudy("plate", f"largest relative error of the mesh in {where}", reference, tuple(own))]
    if "solid" in known:
        quantity = f"largest relative error in {where}, mesh and theory together"
        reference = f"limit of solid bricks, good to about {significant(known['solid'][1], 1)}"
        studies.append(ConvergenceStudy(WITH_THEORY, quantity, reference, tuple(solid)))
    return studies, known


def _row(problem: Problem, method: Method, size: int, limit: Floats | None) -> tuple[Setting, Floats | None]:
    """A method on one mesh, and its frequencies where it has any."""
    failed = None
    if (unknowns := problem.unknowns(method, size)) > SOLID_AT_MOST:
        failed = f"too slow: {fixed(unknowns)} unknowns"
    elif method.theory == "mindlin" and method.cells == "graded" and problem.form.mesh(1).t.shape[0] == 3:
        failed = "the mesh is of triangles"
    if failed is not None:
        return Setting(method.name, problem.setting(size), failed=failed), None

    def judge(solved: tuple[int, Floats]) -> tuple[int | None, float]:
        if limit is None:
            raise ValueError("there is no reference: the mesh is too large for a finer one")
        return solved[0], _largest_error(solved[1], limit)

    outcome = measure(method.name, problem.setting(size), partial(problem.solve, method, size), judge)
    return outcome[0], None if outcome[1] is None else outcome[1][1]


def _largest_error(frequencies: Floats, reference: Floats) -> float:
    return float(np.abs(frequencies / reference - 1.0).max())


_TIMED_SPEEDS = 5
"""Speeds solved by themselves; the time of all is estimated from them."""

SPEEDS = 1000
_TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8)


def speeds(operators: fem.Operators, top: float, count: int, step: Step) -> tuple[ConvergenceStudy, Choice]:
    """A thousand speeds from rest to the highest: from a reduced basis, or each by itself."""
    omega = np.linspace(0.0, top, SPEEDS) if top > 0 else np.zeros(1)
    timed = omega[np.unique(np.linspace(0, omega.size - 1, _TIMED_SPEEDS + 2).round().astype(int)[1:-1])]

    def one_by_one() -> Floats:
        return np.array([fem.solve_modes(operators, float(w), count).frequencies_hz for w in timed])

    direct = one_by_one()

    def judge(diagram: fem.Campbell) -> tuple[int | None, float]:
        at = np.searchsorted(diagram.omega, timed)
        return max(diagram.sizes, default=None), _largest_error(diagram.frequencies_hz[at], direct)

    def judge_alone(solved: Floats) -> tuple[int | None, float]:
        return operators.mass.shape[0], _largest_error(solved, direct)

    cases = list[tuple[Any, ...]]()
    for tolerance in _TOLERANCES:
        work = partial(fem.campbell, operators, omega, count, tolerance=tolerance)
        cases.append(("reduced basis", f"bound below {tolerance:g}", work, judge))
    alone = "each speed by itself", f"{timed.size} of {omega.size} timed", one_by_one, judge_alone
    cases.append((*alone, omega.size / timed.size))
    study = ConvergenceStudy(
        "speeds",
        f"largest relative error of {count} frequencies at {omega.size} speeds up to {turning(top)}",
        f"modes solved for at {timed.size} of the speeds on the same mesh, good to rounding",
        ladder(step, cases),
    )
    diagram = fem.campbell(operators, omega, count)
    sizes = " and ".join(map(str, diagram.sizes))
    return study, Choice("reduced basis", f"{sizes} vectors", float(diagram.bounds.max()), judge(diagram)[1])


def study(source: SceneFile, stages: Stages | None = None) -> WorkPrecision:
    """Time against error for the plate, the speeds, the damper and the whole, as far as the scene has them.

    Raises:
        BadInput: see :class:`workflows.solve.structure.StructureSolver`; or the scene has neither plate nor damper.
        NoAnswer: see there; or the scene has nothing whose accuracy costs anything.
    """
    left_out = None
    if source.scene.plate is None:
        given = "the blade's mesh is" if source.scene.blade is not None else "the structure is"
        if source.scene.damper is None:
            raise source.wrong(f"the table is missing: nothing to compare, since {given} given", "[damper]")
        left_out = f"Only the damper is compared: no plate, no speeds and no whole pipeline, since {given} given."
    stages = stages or Stages()
    studies: list[ConvergenceStudy] = []
    chosen: dict[str, Choice] = {}
    choice = choose_model(source, Stages(visible=False))
    ball = None if source.scene.damper is None else _ball(source, choice)  # refused before the plate takes its time
    if choice.form is not None:
        plates, picked = _plate(source, choice, stages)
        studies += plates
        chosen |= picked
    if ball is not None:
        with stages("damper", len(STEPS) + sum(map(len, METHODS.values())) + 2) as step:
            balls, exact = damper_study(*ball, step)
        studies += [] if balls is None else [balls]
        chosen["damper"] = exact
    with stages("pipeline", len(ASKED) + 1) as step:
        whole, picked = pipeline_studies(source, step)
    if not studies:
        raise NoAnswer(f"{source.name}: {chosen['damper'].setting}, so that accuracy has no cost here")
    targets = source.scene.accuracy.model_dump()
    return WorkPrecision(source.scene.title, targets, (*studies, *whole), chosen | picked, left_out)


def _ball(source: SceneFile, choice: ModelChoice) -> tuple[damper.ParticleDamper, tuple[float, float], SpeedPoint]:
    """The damper at the middle speed, on a level floor, its release, and the structure there."""
    points = pipeline.structure(source, Stages(visible=False), shapes=False, choice=choice).points
    point = points[middle_speed(points)]
    with read_from(source.name):
        system = level(particle_damper(source.scene, choice.effects, point))
        return system, coupling.release_displacement(source.scene, point, system), point


def _plate(source: SceneFile, choice: ModelChoice, stages: Stages) -> tuple[list[ConvergenceStudy], dict[str, Choice]]:
    (form, _), solver = choice.plate, discretise(source, choice, Stages(visible=False))
    operators, count = solver.choice.operators, source.scene.rotor.modes
    plain = replace(operators.effects, coriolis=False, large_deflection=False)
    top = float(solver.choice.probes[-1])
    mindlin = choice.model if solver.theory.name == "mindlin" else "mindlin"
    made = partial(plate_mesh.plate, source, form=form)
    problem = Problem(form, made, operators.rotor, plain, top, count, mindlin)
    steps = 3 + sum(len(problem.sizes(method.finest)) for method in PLATE_METHODS)
    with stages("plate", steps) as step:
        studies, limits = plate_studies(problem, step)
    linear = replace(operators, effects=plain, gyroscopic=None)
    with stages("speeds", 6) as step:
        swept, basis = speeds(linear, problem.omega, count, step)
    mesh = _chosen(solver, problem, limits)
    switches = {"large deflection": operators.effects.large_deflection, "Coriolis forces": operators.effects.coriolis}
    on = " and ".join(name for name, switch in switches.items() if switch)
    left_out = f"; all without {on}, which the scene has on" if on else ""
    studies = [replace(one, reference=one.reference + left_out) for one in (*studies, swept)]
    return studies, {"plate": mesh, "speeds": basis}


def _chosen(solver: Discrete, problem: Problem, limits: dict[str, tuple[Floats, float]]) -> Choice:
    """The mesh that the scene's accuracy chose, its estimate, and its error against the limit of its theory."""
    name, error = solver.theory.name, None
    estimate = float(np.max(solver.choice.errors)) + solver.layers
    if name in limits:
        linear = replace(solver.choice.operators, effects=problem.effects, gyroscopic=None)
        frequencies = fem.solve_modes(linear, problem.omega, problem.count).frequencies_hz
        error = _largest_error(frequencies, limits[name][0])
    return Choice(name, solver.mesh, estimate if np.isfinite(estimate) else None, error)
