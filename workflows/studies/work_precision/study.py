"""`spindamp accuracy`: every ladder that a scene has."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np

from workflows import pipeline
from workflows.errors import NoAnswer
from workflows.formatting import fixed, significant, whole
from workflows.progress import Stages, Step
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile
from workflows.scene.rotor import Accuracy
from workflows.solve import coupling
from workflows.solve import damper as ringdowns
from workflows.solve import structure as plate
from workflows.solve.model_choice import Decided, decide
from workflows.solve.results import Discrete, Floats, Results, SpeedPoint, middle
from workflows.studies.work_precision.timing import Costs, Ladder, Picked, Rung, measure

if TYPE_CHECKING:
    import fem
    from damper import ParticleDamper, RingDown, SteppedRingDown
    from fem.meshes.mesh_sequence import Planform


Integrator = Literal["RK45", "DOP853", "LSODA", "Radau"]

_CREEP = 1e-9
"""Relative speed, in omega_1 times the release, below which a hit ends on the wall: near a turning point the paper's
criterion alone never fires."""

_MOST_EVENTS = 20_000


@dataclass(frozen=True)
class ByIvp:
    """What the peer found: wall hits, evaluations of the equations of motion, and energies [J].

    structure: what the structure's own dashpot took.
    """

    initial: float
    final: float
    structure: float
    impacts: int
    evaluations: int


def by_ivp(
    damper: ParticleDamper, release: tuple[float, float], cycles: float, method: Integrator, rtol: float
) -> ByIvp:
    """Follow a ring-down for some vibration cycles.

    Raises:
        ValueError: the damper slips on the floor.
        ArithmeticError: the integrator gives up, or events without end.
    """
    if damper.floor_friction is not None:
        raise ValueError("slip on the floor is not part of this peer")
    return _Peer(damper, release, method, rtol).run(2 * math.pi * cycles)


class _Peer:
    """Time in 1/omega_1, length in the larger release, mass in M2."""

    def __init__(self, damper: ParticleDamper, release: tuple[float, float], method: Integrator, rtol: float) -> None:
        self.length, self.rate = max(map(abs, release)), damper.stuck_frequency
        self.method, self.rtol = method, rtol
        self.e, self.mu, self.sticking = damper.restitution, damper.friction, damper.sticking_ratio
        self.m = damper.ball_mass / damper.modal_mass
        self.energy_unit = damper.modal_mass * (self.rate * self.length) ** 2
        self.k = [k / damper.modal_mass / self.rate**2 for k in damper.stiffness]
        self.gap = [gap / self.length for gap in damper.half_gap]
        self.resistance = damper.rolling_threshold / (self.rate**2 * self.length)
        self.printed = damper.formulation == "printed"
        self.beta = damper.inertia_ratio
        self.spin = damper.spin_mass / damper.modal_mass
        self.zeta = damper.damping_ratio
        self.y: Floats = np.zeros(9)
        self.y[[0, 4]] = [displacement / self.length for displacement in release]
        self.moves = [0, 0]
        self.impacts = self.evaluations = 0

    def run(self, end: float) -> ByIvp:
        initial, t = self.energy(), 0.0
        for axis in (0, 1):
            self.settle(axis)
        for _ in range(_MOST_EVENTS):
            t, happened = self.fly(t, end)
            if not happened:
                return ByIvp(initial, self.energy(), self.energy_unit * self.y[8], self.impacts, self.evaluations)
            for axis, kind in happened:
                self.resolve(axis, kind)
        raise ArithmeticError(f"more than {_MOST_EVENTS} events")

    def dashpot(self, axis: int, stuck: bool) -> float:
        """The c of eq. (1): in the printed equations it follows the mass that moves."""
        return 2 * self.zeta * math.sqrt(self.k[axis] * (1 + self.m if stuck and self.printed else 1))

    def acceleration(self, axis: int, u: float, v: float, moves: int) -> float:
        """That of the structure, the ball stuck (0) or rolling to one side."""
        restoring = self.k[axis] * u + self.dashpot(axis, moves == 0) * v
        if moves == 0:
            return -restoring / (1 + self.m)
        push = self.m * self.resistance * moves
        if self.printed:
            return push - restoring
        return (self.beta * push - restoring) / (1 + (1 - self.beta) * self.m)

    def motion(self, _: float, y: Floats) -> Floats:
        self.evaluations += 1
        rates = np.zeros(9)
        for axis, moves in enumerate(self.moves):
            u, v, _, w = y[4 * axis : 4 * axis + 4]
            a = self.acceleration(axis, u, v, moves)
            relative = 0.0 if moves == 0 else -self.beta * (a + self.resistance * moves)
            rates[4 * axis : 4 * axis + 4] = v, a, (w if moves else 0.0), relative
            rates[8] += self.dashpot(axis, moves == 0) * v**2
        return rates

    def fly(self, t: float, end: float) -> tuple[float, list[tuple[int, str]]]:
        """Integrate to the next event or the end; events of both axes at one instant come together."""
        from scipy.integrate import solve_ivp

        watched = [(axis, kind) for axis in (0, 1) for kind in self.kinds(axis)]
        due = [(axis, kind) for axis, kind in watched if kind != "turn" and self.value(axis, kind, self.y) >= 0]
        if due:
            return t, due[:1]
        solved: Any = solve_ivp(
            self.motion,
            (t, end),
            self.y,
            self.method,
            rtol=self.rtol,
            atol=1e-4 * self.rtol,
            events=[self.watch(axis, kind) for axis, kind in watched],
        )
        if solved.status < 0:
            raise ArithmeticError(solved.message)
        self.y = solved.y[:, -1]
        happened = [key for key, times in zip(watched, solved.t_events, strict=True) if len(times)]
        return float(solved.t[-1]), happened

    def kinds(self, axis: int) -> tuple[str, ...]:
        """What can end the present motion of an axis."""
        if self.moves[axis]:
            return "hit", "turn"
        side = self.side(axis)
        return tuple(kind for kind, way in (("up", 1), ("down", -1)) if way != side)

    def side(self, axis: int) -> int:
        """The wall that a stuck ball rests on, 0 for none."""
        s = self.y[4 * axis + 2]
        return int(np.sign(s)) if abs(s) >= self.gap[axis] * (1 - 1e-12) else 0

    def value(self, axis: int, kind: str, y: Floats) -> float:
        """Rises through zero when it happens."""
        u, v, s, w = y[4 * axis : 4 * axis + 4]
        moves = self.moves[axis]
        if kind == "hit":
            return float(moves * s - self.gap[axis])
        if kind == "turn":
            return float(-moves * w)
        way = 1 if kind == "up" else -1
        drives = ((self.k[axis] * u + self.dashpot(axis, stuck) * v) / (1 + self.m) for stuck in (True, False))
        return float(min(way * drive for drive in drives) - self.resistance)

    def watch(self, axis: int, kind: str) -> Callable[[float, Floats], float]:
        def event(_: float, y: Floats) -> float:
            return self.value(axis, kind, y)

        event.terminal, event.direction = True, 1.0  # type: ignore[attr-defined]
        return event

    def resolve(self, axis: int, kind: str) -> None:
        if kind == "hit":
            self.hit(axis)
        elif kind == "turn":
            self.settle(axis)
        else:
            self.moves[axis] = 1 if kind == "up" else -1

    def settle(self, axis: int) -> None:
        """The ball has stopped relative to the structure: it stays, or rolls the other way."""
        self.y[4 * axis + 3] = 0.0
        self.moves[axis] = 0
        for kind in self.kinds(axis):
            if self.value(axis, kind, self.y) > 0:
                self.moves[axis] = 1 if kind == "up" else -1
                return

    def hit(self, axis: int) -> None:
        """Restitution along the wall's normal, capped friction along the wall."""
        self.impacts += 1
        m, side = self.m, self.moves[axis]
        v, w = self.y[[4 * axis + 1, 4 * axis + 3]]
        impulse = m / (1 + m) * (1 + self.e) * w
        v, w = v + impulse, -self.e * w
        self.y[[4 * axis + 1, 4 * axis + 2, 4 * axis + 3]] = v, side * self.gap[axis], w
        self.moves[axis] = -side
        if abs(w) <= max(self.sticking * abs(v), _CREEP):
            self.y[4 * axis + 1], self.y[4 * axis + 3], self.moves[axis] = v + m / (1 + m) * w, 0.0, 0
        other = 1 - axis
        slide = self.y[4 * other + 3]
        if self.moves[other] and self.mu > 0 and slide != 0:
            most = abs(slide) * m / (1 + m)
            tangential = math.copysign(min(self.mu * abs(impulse), most), slide)
            self.y[4 * other + 1] += tangential
            self.y[4 * other + 3] -= tangential * (1 + m) / m
            if self.mu * abs(impulse) >= most:
                self.settle(other)

    def energy(self) -> float:
        total = 0.0
        for axis in (0, 1):
            u, v, _, w = self.y[4 * axis : 4 * axis + 4]
            total += self.k[axis] * u**2 + v**2 + self.m * (v + w) ** 2 + self.spin * w**2
        return 0.5 * total * self.energy_unit


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


class _Balance(Protocol):
    """Energies [J] at the start and at the end, and what the structure's own dashpot took."""

    @property
    def initial(self) -> float: ...
    @property
    def final(self) -> float: ...
    @property
    def structure(self) -> float: ...


def level(system: ParticleDamper) -> ParticleDamper:
    """The damper on a level floor with one mode along each axis, which is what the other methods know."""
    return replace(system, floor_tilt=(0.0, 0.0), floor_radius=None, rotation=0.0, modes=None)


def damper_ladder(
    system: ParticleDamper, release: tuple[float, float], point: SpeedPoint, step: Step
) -> tuple[Ladder | None, Picked]:
    """Error of the energy that the ball takes in 20 cycles, and of the exact events against the tightest integration.

    What the structure's own damping takes is left out: it hides the ball's share, and every method has it right. There
    is no ladder where the ball takes nothing.
    """
    from damper import ringdown

    step.advance("reference")
    exact = ringdown(system, release, CYCLES).energy
    taken = _taken(exact)
    if abs(taken) < _NOTHING * exact.initial:
        return None, Picked("exact events", f"the ball takes nothing in {CYCLES} cycles", None, None)
    contest = _Contest(system, release, taken, _apart(system, release, taken))
    rows = (*contest.steps(step), *contest.integrators(step), contest.events(step))
    found = Ladder(
        "damper",
        f"relative error of the energy that the ball takes in {CYCLES} cycles at {whole(point.rpm)} rpm",
        f"the exact events, {_between(contest.apart)}",
        tuple(replace(row, uncertainty=contest.apart) for row in rows),
    )
    rounding = _ROUNDING * exact.initial / abs(taken)
    return found, Picked("exact events", "closed form between events, roots to rounding", rounding, contest.apart)


def _apart(system: ParticleDamper, release: tuple[float, float], taken: float) -> float | None:
    """How far the tightest integration is from what the exact events say is taken; None where it has no answer."""
    try:
        return abs(_taken(by_ivp(system, release, CYCLES, *_REFERENCE)) / taken - 1.0)
    except (ArithmeticError, ValueError):
        return None


def _between(apart: float | None) -> str:
    if apart is None:
        return "which no independent integration could confirm here"
    return (
        f"from which solve_ivp with {_REFERENCE[0]} at rtol {_REFERENCE[1]:g} differs by {significant(apart, 1)};"
        " the exact events' own error is given against that"
    )


@dataclass(frozen=True, eq=False)
class _Contest:
    """One ring-down by every method; `taken` [J] is what the ball takes, `apart` the tightest integration's error."""

    system: ParticleDamper
    release: tuple[float, float]
    taken: float
    apart: float | None

    def steps(self, step: Step) -> Iterator[Rung]:
        """The paper's way, from coarse steps to fine ones."""
        from damper import stepped_ringdown

        def judge(found: SteppedRingDown) -> tuple[int | None, float]:
            return len(found.time) - 1, self._error(found)

        for steps in STEPS:
            step.advance(f"{steps} steps a cycle")
            solve = partial(stepped_ringdown, self.system, self.release, CYCLES, steps)
            yield measure("fixed step, as in the paper", f"{steps} a cycle", solve, judge)

    def integrators(self, step: Step) -> Iterator[Rung]:
        """Those of SciPy, from loose tolerances to tight ones."""

        def judge(found: ByIvp) -> tuple[int | None, float]:
            return found.evaluations, self._error(found)

        for method, tolerances in METHODS.items():
            for rtol in tolerances:
                step.advance(f"{method}, {rtol:g}")
                solve = partial(by_ivp, self.system, self.release, CYCLES, method, rtol)
                yield measure(f"solve_ivp, {method}", f"rtol {rtol:g}", solve, judge)

    def events(self, step: Step) -> Rung:
        """What a run uses; held against the tightest integration, where that has an answer."""
        from damper import ringdown

        def judge(found: RingDown) -> tuple[int | None, float]:
            return found.events, self._error(found.energy) if self.apart is None else self.apart

        step.advance("exact events")
        return measure("exact events", "no step", partial(ringdown, self.system, self.release, CYCLES), judge)

    def _error(self, found: _Balance) -> float:
        return abs(_taken(found) / self.taken - 1.0)


def _taken(found: _Balance) -> float:
    """What the ball took: by rolling, by impacts and, where the equations do not conserve energy, by their fault."""
    return float(found.initial - found.final - found.structure)


ASKED = (1e-1, 1e-2, 1e-3, 1e-4)
FINEST = 1e-5


@dataclass(frozen=True)
class _Quantity:
    """A headline number of a run, at the speed that the report shows."""

    name: str
    at: int

    def __call__(self, results: Results) -> float | None:
        point = results.speeds[self.at]
        if self.name == "first frequency":
            return point.reduced.f2_hz if point.reduced is not None else point.modes[0].frequency_hz
        if point.damping is None:
            return None
        return point.damping.cutoff_g if self.name == "cut-off" else point.damping.peak_sdc


QUANTITIES = ("first frequency", "cut-off", "peak specific damping capacity")


def pipeline_ladders(source: SceneFile, step: Step) -> tuple[list[Ladder], dict[str, Picked]]:
    """A ladder for each headline number that the scene has; none without a plate, where there is nothing to choose."""
    if source.scene.plate is None:
        return [], {}
    known = decide(source, Stages(visible=False)).theory
    theory = None if known is None else known.name
    step.advance("reference")
    finest = pipeline.run(_asking(source, FINEST, theory), Stages(visible=False))
    shown = middle(finest.speeds)
    runs: dict[float, tuple[Rung, Results | None]] = {}
    for asked in ASKED:
        step.advance(f"accuracy {asked:g}")
        runs[asked] = _run(_asking(source, asked, theory), asked)
    own = pipeline.run(_asking(source, None, theory), Stages(visible=False))
    found, chosen = [], {}
    for quantity in (_Quantity(name, shown) for name in QUANTITIES):
        if not quantity(finest):
            continue
        rows = [_judged(row, results, quantity, finest) for row, results in runs.values()]
        rpm = finest.speeds[shown].rpm
        found.append(
            Ladder(
                f"whole pipeline: {quantity.name}",
                f"relative error of the {quantity.name} at {whole(rpm)} rpm",
                f"the same scene and theory with an accuracy of {FINEST:g}{_trust(finest, shown)}",
                tuple(rows),
            )
        )
        chosen[f"pipeline: {quantity.name}"] = _chosen_pipeline(own, quantity, finest)
    return found, chosen


def _run(source: SceneFile, asked: float) -> tuple[Rung, Results | None]:
    kept: list[Results] = []

    def judge(results: Results) -> tuple[int | None, float]:
        kept.append(results)
        return None, 0.0

    row = measure("pipeline", f"accuracy {asked:g}", lambda: pipeline.run(source, Stages(visible=False)), judge)
    return row, kept[0] if kept else None


def _trust(finest: Results, shown: int) -> str:
    """What the reference was solved on, and how far its first frequency can be trusted."""
    modes = finest.speeds[shown].modes
    if finest.diagram is None or not modes:
        return ""
    estimate = modes[0].error_estimate
    good = "" if estimate is None else f", its first frequency good to about {significant(estimate, 1)}"
    return f" ({finest.diagram.mesh}{good})"


def _judged(row: Rung, results: Results | None, quantity: _Quantity, finest: Results) -> Rung:
    if results is None:
        return row
    if quantity(results) is None:
        return Rung(row.method, row.setting, failed=f"no {quantity.name} came out")
    row = replace(row, setting=_setting(row, results), unknowns=None, error=_error(results, finest, quantity))
    return row if row.error is not None else replace(row, failed="the reference's own mesh")


def _error(results: Results, finest: Results, quantity: _Quantity) -> float | None:
    """Relative error against the finest run; None on its own mesh, whose error it shares."""
    value, reference = quantity(results), quantity(finest)
    if value is None or reference is None or _same_mesh(results, finest):
        return None
    return abs(value / reference - 1.0)


def _same_mesh(results: Results, finest: Results) -> bool:
    if results.diagram is None or finest.diagram is None:
        return False
    return results.diagram.mesh == finest.diagram.mesh


def _setting(row: Rung, results: Results) -> str:
    return row.setting if results.diagram is None else f"{row.setting}: {results.diagram.mesh}"


def _chosen_pipeline(results: Results, quantity: _Quantity, finest: Results) -> Picked:
    """What the scene's own accuracy chose, and its error."""
    estimate = None
    if quantity.name == "first frequency" and results.speeds[quantity.at].modes:
        estimate = results.speeds[quantity.at].modes[0].error_estimate
    setting = "" if results.diagram is None else results.diagram.mesh
    return Picked("pipeline", setting, estimate, _error(results, finest, quantity))


def _asking(source: SceneFile, accuracy: float | None, theory: str | None) -> SceneFile:
    """The scene with another accuracy, its theory held: the error of a theory is not one of accuracy."""
    changed = source
    if accuracy is not None:
        changed = changed.changed(accuracy=Accuracy(frequency=accuracy, damping=accuracy))
    if theory is not None and source.scene.plate is not None:
        changed = changed.changed(plate=source.scene.plate.model_copy(update={"theory": theory}))
    return changed


SOLID_AT_MOST = 40_000
"""Unknowns of a solid that are still tried."""

FINEST_PLATE = {"kirchhoff": 12, "mindlin": 16, "solid": 6}
"""The finest size from which the limit of each theory is extrapolated."""

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


@dataclass(frozen=True, eq=False)
class Problem:
    """A plate to be solved for some modes at one speed [rad/s], without Coriolis forces and large deflection."""

    form: Planform
    plate: Callable[[Any], fem.Plate]
    rotor: fem.Rotor
    effects: fem.Effects
    omega: float
    count: int

    def operators(self, method: Method, size: int) -> fem.Operators:
        """Matrices of a method on a mesh of the planform's ladder."""
        from fem import assemble

        mesh = self._even(size) if method.cells == "even" else self.form.mesh(size)
        if method.cells == "triangles" and mesh.t.shape[0] == 4:
            mesh = mesh.to_meshtri()
        return assemble(self.plate(mesh), self.rotor, self.effects, method.model)

    def solve(self, method: Method, size: int) -> tuple[int, Floats]:
        """Unknowns, and frequencies (count,) in Hz."""
        from fem import solve_modes

        operators = self.operators(method, size)
        return operators.mass.shape[0], solve_modes(operators, self.omega, self.count).frequencies_hz

    def _even(self, size: int) -> Any:
        from fem import Rectangle, rectangle

        if not isinstance(self.form, Rectangle):
            raise ValueError("the mesh is a file's")
        return rectangle(*self.form.sides, *self.form.cells(size))


def sizes(problem: Problem, finest: int) -> list[int]:
    """The meshes on which a method is tried: of a file's mesh, itself and one finer."""
    from fem import Rectangle

    every = problem.form.sizes if isinstance(problem.form, Rectangle) else problem.form.sizes[:2]
    return [size for size in every if size <= finest]


def limits(problem: Problem, step: Step) -> dict[str, tuple[Floats, float]]:
    """The limit of each theory, extrapolated from the two finest meshes, and how far it can be trusted, relatively."""
    found = {}
    for method in (_thin(problem), Method("mindlin", "Mindlin", FINEST_PLATE["mindlin"]), _bricks(4)):
        theory, pair = method.theory, _finest(problem, method)
        step.advance(f"limit of {theory}")
        if len(pair) < 2:
            continue
        (_, before), (_, last) = (problem.solve(method, size) for size in pair)
        growth = (pair[1] / pair[0]) ** min(problem.form.orders)
        limit = last + (last - before) / (growth - 1.0)
        if theory == "solid":
            limit = limit * _more_layers(problem, pair[0])
        found[theory] = limit, float(np.abs(limit / last - 1.0).max())
    return found


def plate_ladders(problem: Problem, step: Step) -> tuple[list[Ladder], dict[str, tuple[Floats, float]]]:
    """Error against the limit of the row's own theory, and against the solid: that of the theory comes on top."""
    known = limits(problem, step)
    own, solid = [], []
    for method in PLATE_METHODS:
        limit, trust = known.get(method.theory, (None, None))
        for size in sizes(problem, method.finest):
            step.advance(f"{method.name}, {size}")
            row, frequencies = _row(problem, method, size, limit)
            own.append(replace(row, uncertainty=trust))
            if "solid" in known and frequencies is not None:
                error = float(np.abs(frequencies / known["solid"][0] - 1.0).max())
                solid.append(replace(row, error=error, uncertainty=known["solid"][1]))
            else:
                solid.append(row)
    where = f"{problem.count} frequencies at {whole(problem.omega * 30 / np.pi)} rpm"
    trusts = ", ".join(f"{theory} to {significant(error, 1)}" for theory, (_, error) in known.items())
    ours = Ladder(
        "plate",
        f"largest relative error of the mesh in {where}",
        f"limit of each row's own theory, extrapolated from the two finest meshes ({trusts})",
        tuple(own),
    )
    if "solid" not in known:
        return [ours], known
    theirs = Ladder(
        WITH_THEORY,
        f"largest relative error in {where}, mesh and theory together",
        f"limit of solid bricks, good to about {significant(known['solid'][1], 1)}",
        tuple(solid),
    )
    return [ours, theirs], known


def _row(problem: Problem, method: Method, size: int, limit: Floats | None) -> tuple[Rung, Floats | None]:
    found: list[Floats] = []

    def judge(solved: tuple[int, Floats]) -> tuple[int | None, float]:
        found.append(solved[1])
        if limit is None:
            raise ValueError("there is no reference: the mesh is too large for a finer one")
        return solved[0], float(np.abs(solved[1] / limit - 1.0).max())

    if method.theory == "solid" and _unknowns(problem, method, size) > SOLID_AT_MOST:
        reason = f"too slow: {fixed(_unknowns(problem, method, size))} unknowns"
        return Rung(method.name, _plate_setting(problem, size), failed=reason), None
    if method.theory == "mindlin" and method.cells == "graded" and problem.form.mesh(1).t.shape[0] == 3:
        return Rung(method.name, _plate_setting(problem, size), failed="the mesh is of triangles"), None
    row = measure(method.name, _plate_setting(problem, size), lambda: problem.solve(method, size), judge)
    return row, found[0] if found else None


def _plate_setting(problem: Problem, size: int) -> str:
    from fem import Rectangle

    if isinstance(problem.form, Rectangle):
        return "{} × {}".format(*problem.form.cells(size))
    return "the file's mesh" if size == 1 else f"each edge split in {size}"


def _thin(problem: Problem) -> Method:
    from fem import Rectangle

    return Method(
        "kirchhoff/bfs" if isinstance(problem.form, Rectangle) else "kirchhoff", "thin plate", FINEST_PLATE["kirchhoff"]
    )


def _bricks(layers: int) -> Method:
    return Method(f"solid/{layers}", "solid", FINEST_PLATE["solid"])


def _finest(problem: Problem, method: Method) -> list[int]:
    """The two sizes from which a limit is extrapolated."""
    from fem import Rectangle

    most = method.finest
    if not isinstance(problem.form, Rectangle):
        most = 4 if method.theory == "mindlin" else 2
    tried = [size for size in problem.form.sizes if size <= most]
    if method.theory == "solid":
        tried = [size for size in tried if _unknowns(problem, method, size) <= SOLID_AT_MOST]
    return tried[-3::2] if len(tried) > 2 and isinstance(problem.form, Rectangle) else tried[-2:]


def _more_layers(problem: Problem, size: int) -> Floats:
    """Factor from four layers of bricks to six, on a coarse mesh: the mesh's error falls out."""
    coarse = next(s for s in reversed(problem.form.sizes) if s <= max(1, size // 2))
    (_, four), (_, six) = (problem.solve(_bricks(layers), coarse) for layers in (4, 6))
    return np.asarray(six / four)


def _unknowns(problem: Problem, method: Method, size: int) -> int:
    """About how many unknowns a solid has."""
    mesh = problem.form.mesh(1)
    cells = mesh.t.shape[1] * size**2 * (3 if mesh.t.shape[0] == 3 else 1)
    return int(cells * 4 * (2 * int(method.model.partition("/")[2]) + 1) * 3)


_TIMED_SPEEDS = 5
"""Speeds solved by themselves; what all would take is reckoned from them."""

SPEEDS = 1000
_TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8)


def speeds(operators: fem.Operators, top: float, count: int, step: Step) -> tuple[Ladder, Picked]:
    """A thousand speeds from rest to the highest: from a reduced basis, or each by itself."""
    from fem import campbell, solve_modes

    omega = np.linspace(0.0, top, SPEEDS) if top > 0 else np.zeros(1)
    tried = omega[np.unique(np.linspace(0, omega.size - 1, _TIMED_SPEEDS + 2).round().astype(int)[1:-1])]
    direct = np.array([solve_modes(operators, float(w), count).frequencies_hz for w in tried])

    def judge(diagram: fem.Campbell) -> tuple[int | None, float]:
        at = np.searchsorted(diagram.omega, tried)
        return max(diagram.sizes, default=None), float(np.abs(diagram.frequencies_hz[at] / direct - 1.0).max())

    rows = []
    for tolerance in _TOLERANCES:
        step.advance(f"reduced basis, {tolerance:g}")
        rows.append(
            measure(
                "reduced basis",
                f"bound below {tolerance:g}",
                lambda tolerance=tolerance: campbell(operators, omega, count, tolerance=tolerance),  # type: ignore[misc]
                judge,
            )
        )
    step.advance("each speed by itself")
    alone = measure(
        "each speed by itself",
        f"{tried.size} of {omega.size} timed",
        lambda: np.array([solve_modes(operators, float(w), count).frequencies_hz for w in tried]),
        lambda found: (operators.mass.shape[0], float(np.abs(found / direct - 1.0).max())),
        share=omega.size / tried.size,
    )
    ladder = Ladder(
        "speeds",
        f"largest relative error of {count} frequencies at {omega.size} speeds up to {whole(top * 30 / np.pi)} rpm",
        f"modes solved for at {tried.size} of the speeds on the same mesh, good to rounding",
        (*rows, alone),
    )
    return ladder, _chosen_basis(operators, omega, tried, direct, count)


def _chosen_basis(operators: fem.Operators, omega: Floats, tried: Floats, direct: Floats, count: int) -> Picked:
    from fem import campbell

    diagram = campbell(operators, omega, count)
    at = np.searchsorted(diagram.omega, tried)
    error = float(np.abs(diagram.frequencies_hz[at] / direct - 1.0).max())
    sizes = " and ".join(map(str, diagram.sizes))
    return Picked("reduced basis", f"{sizes} vectors", float(diagram.bounds.max()), error)


def study(source: SceneFile, stages: Stages | None = None) -> Costs:
    """Time against error for the plate, the speeds, the damper and the whole, as far as the scene has them.

    Raises:
        BadInput: see :func:`workflows.solve.structure.solve`.
        NoAnswer: see there; or the scene has nothing whose accuracy costs anything.
    """
    stages = stages or Stages()
    ladders: list[Ladder] = []
    chosen: dict[str, Picked] = {}
    decided = decide(source, Stages(visible=False))
    if decided.form is not None:
        found, picked = _plate(source, decided, stages)
        ladders += found
        chosen |= picked
    if source.scene.damper is not None:
        with stages("damper", len(STEPS) + sum(map(len, METHODS.values())) + 2) as step:
            points = pipeline.structure(source, Stages(visible=False), shapes=False, decided=decided).points
            point = points[middle(points)]
            system = level(ringdowns.particle_damper(source.scene, decided.effects, point))
            ladder, exact = damper_ladder(system, coupling.released_at(source.scene, point), point, step)
        ladders += [] if ladder is None else [ladder]
        chosen["damper"] = exact
    with stages("pipeline", len(ASKED) + 1) as step:
        whole, picked = pipeline_ladders(source, step)
    if not ladders:
        raise NoAnswer(f"{source.name}: {chosen['damper'].setting}, so that there is no accuracy to pay for")
    asked = source.scene.accuracy.model_dump()
    return Costs(source.scene.title, asked, (*ladders, *whole), chosen | picked)


def _plate(source: SceneFile, decided: Decided, stages: Stages) -> tuple[list[Ladder], dict[str, Picked]]:
    (form, _), solver = decided.plate, plate.discretise(source, decided, Stages(visible=False))
    operators, count = solver.choice.operators, source.scene.rotor.modes
    plain = replace(operators.effects, coriolis=False, large_deflection=False)
    problem = Problem(
        form=form,
        plate=lambda mesh: plate_mesh.plate(source, mesh, form),
        rotor=operators.rotor,
        effects=plain,
        omega=float(solver.choice.probes[-1]),
        count=count,
    )
    steps = 3 + sum(len(sizes(problem, method.finest)) for method in PLATE_METHODS)
    with stages("plate", steps) as step:
        ladders, limits = plate_ladders(problem, step)
    linear = replace(operators, effects=plain, gyroscopic=None)
    with stages("speeds", 6) as step:
        ladder, basis = speeds(linear, problem.omega, count, step)
    mesh = _chosen(solver, problem, limits)
    left_out = _left_out(operators.effects)
    said = [replace(ladder, reference=ladder.reference + left_out) for ladder in (*ladders, ladder)]
    return said, {"plate": mesh, "speeds": basis}


def _left_out(effects: fem.Effects) -> str:
    """What the scene has on and the plate's ladders are without, in words."""
    names = {"large deflection": effects.large_deflection, "Coriolis forces": effects.coriolis}
    on = [name for name, switch in names.items() if switch]
    return f"; all without {' and '.join(on)}, which the scene has on" if on else ""


def _chosen(solver: Discrete, problem: Problem, limits: dict[str, tuple[Floats, float]]) -> Picked:
    """The mesh that the scene's accuracy chose, its estimate, and its error against the limit of its theory."""
    from fem import solve_modes

    name, error = solver.theory.name, None
    estimate = float(np.max(solver.choice.errors)) + solver.layers
    if name in limits:
        linear = replace(solver.choice.operators, effects=problem.effects, gyroscopic=None)
        frequencies = solve_modes(linear, problem.omega, problem.count).frequencies_hz
        error = float(np.abs(frequencies / limits[name][0] - 1.0).max())
    return Picked(name, solver.mesh, estimate if np.isfinite(estimate) else None, error)
