"""Engine orders at resonance: what drives a mode, and how much less it vibrates with the ball, from free vibration.

The estimate goes by the balance of work in a cycle (:mod:`damper.backbone`), over all forces up to what the structure
endures; `spindamp response` follows the motion itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

import damper
from workflows.errors import during, present, read_from
from workflows.progress import Stages
from workflows.scene.load import SceneFile
from workflows.scene.scene import Excitation, Scene
from workflows.solve import coupling, engine_orders, limits
from workflows.solve.damper import particle_damper
from workflows.solve.engine_orders import Crossing
from workflows.solve.results import (
    CavityMode,
    Floats,
    ForceLevel,
    Reason,
    Results,
    SpeedPoint,
    VibrationReduction,
    copy_fields,
    leading_mode,
)
from workflows.solve.structure import StructureSolver, StructureState

HELPS = 0.99
"""Amplitude over that without the ball up to which the ball is said to help: less is next to nothing."""


_STILL = 1e-6
"""Displacement of the cavity over that of the whole plate, and force over that of a mode, that counts as none."""


def branch_of(points: Sequence[SpeedPoint], crossing: Crossing) -> int:
    """What the mode that is crossed is called among some speeds: branches are numbered at the lowest of them."""
    point = min(points, key=lambda point: abs(point.omega - crossing.omega))
    near = min(point.modes, key=lambda mode: abs(mode.frequency_hz - crossing.frequency_hz), default=None)
    return 0 if near is None else near.branch


def modes_of(point: SpeedPoint, branch: int) -> list[CavityMode] | None:
    """The mode that is crossed first, then the others; None where the structure is given."""
    if not point.cavity_modes:
        return None
    crossed = next((k for k, mode in enumerate(point.modes) if mode.branch == branch), 0)
    return [point.cavity_modes[crossed], *(m for k, m in enumerate(point.cavity_modes) if k != crossed)]


def modes_at_crossing(point: SpeedPoint, crossing: Crossing) -> tuple[list[CavityMode] | None, int, bool]:
    """The modes of :func:`modes_of`, the axis along which the first moves the cavity, and whether it leads along x."""
    modes = modes_of(point, branch_of((point,), crossing))
    if modes is None:
        return None, 0, True
    axis = int(abs(modes[0].shape[1]) > abs(modes[0].shape[0]))
    return modes, axis, axis == 0 and leading_mode(point.cavity_modes, 0) is modes[0]


def modes_followed(
    scene: Scene, point: SpeedPoint, modes: list[CavityMode] | None, *, every: bool = False
) -> tuple[CavityMode, ...] | None:
    """The mode crossed and those that yield most along either axis, ascending; None where the structure is given.

    With `every`, also those that a hit feeds by more than the accuracy asked for.
    """
    return None if modes is None else coupling.damper_modes(scene, point, modes[0], every=every)


def idle_structure(modes: list[CavityMode] | None, excitation: Excitation) -> str:
    """Why a crossing has nothing to follow; nothing where it has."""
    if modes is None:
        return ""
    most = max(math.hypot(*mode.shape) for mode in modes)
    if math.hypot(*modes[0].shape) <= _STILL * most:
        return "the damper's place does not move in this mode"
    pushes = [abs(_push(mode, excitation)) for mode in modes]
    return "" if pushes[0] > _STILL * max(pushes) else "the excitation does not drive this mode"


def _push(mode: CavityMode, excitation: Excitation) -> float:
    """Modal force by a unit of the excitation."""
    force = mode.shape[0] if excitation.at is None else mode.pushed
    return {"force": force, "pressure": mode.pressed, "base": -mode.drawn[0]}[excitation.kind]


def harmonic_of(
    system: damper.ParticleDamper, crossing: Crossing, point: SpeedPoint, excitation: Excitation, level: float
) -> damper.Harmonic:
    """The excitation at a level, at a speed."""
    frequency = crossing.order * point.omega
    if excitation.kind == "force" and excitation.at is None:
        return damper.Harmonic(frequency, force=(level, 0.0))
    if excitation.kind == "base":
        return damper.Harmonic(frequency, base=(level, 0.0))
    pushes = {mode.stiffness: _push(mode, excitation) for mode in point.cavity_modes}
    return damper.Harmonic(frequency, modal=tuple(level * pushes[mode.stiffness] for mode in system.modes or ()))


def force_at_cavity(system: damper.ParticleDamper, harmonic: damper.Harmonic, *, ball: bool = True) -> float:
    """The force at the cavity along x that drives the leading mode as much, with the ball's part in a base [N]."""
    ball_mass = system.ball_mass if ball else 0.0
    if system.modes is None:
        return abs(harmonic.force[0] - (system.stuck_mass - system.ball_mass + ball_mass) * harmonic.base[0])
    k = system.leading(0)
    mode = system.modes[k]
    modal = 0.0 if harmonic.modal is None else harmonic.modal[k]
    drawn = mode.participation[0] + ball_mass * mode.shape[0]
    return abs(harmonic.force[0] + (modal - drawn * harmonic.base[0]) / mode.shape[0])


_ACROSS, _FEW_ACROSS = 61, 13
"""Speeds over the whole range, by which crossings are found; fewer where each speed is solved by itself."""


def over_speed_range(solver: StructureSolver) -> StructureState:
    """The structure over the whole range of a scene's speeds."""
    speeds = solver.source.scene.rotor.speeds
    return solver.at(np.linspace(min(speeds), max(speeds), _FEW_ACROSS if solver.solves_each_speed else _ACROSS))


def excitation_of(source: SceneFile) -> Excitation:
    """What shakes a scene.

    Raises:
        BadInput: no damper, no excitation, no range of speeds.
    """
    scene = source.scene
    if scene.damper is None:
        raise source.wrong("the table is missing: response needs a damper", "[damper]")
    if scene.excitation is None:
        problem = 'the table is missing: response needs it, such as orders = [2, 3] and force = ["1 N", "10 N"]'
        raise source.wrong(problem, "[excitation]")
    if scene.is_printed:
        problem = "the printed equations do not support a force: expected 'consistent'"
        raise source.wrong(problem, "[damper] formulation", "printed")
    if len(scene.rotor.speeds) < 2:
        problem = "expected at least two speeds: crossings are sought between the lowest and the highest"
        raise source.wrong(problem, "[rotor] speeds")
    return scene.excitation


def damper_at(
    solver: StructureSolver, at: SpeedPoint, crossing: Crossing, excitation: Excitation
) -> damper.ParticleDamper | str:
    """The damper on the structure at the speed of a crossing, or why there is nothing to damp.

    Raises:
        BadInput: the damper does not fit there.
    """
    modes, _, _ = modes_at_crossing(at, crossing)
    if idle := idle_structure(modes, excitation):
        return idle
    scene = solver.source.scene
    with read_from(solver.source.name):
        return particle_damper(scene, solver.choice.effects, at, modes_followed(scene, at, modes))


def largest_stress(results: Results, crossing: Crossing) -> float | None:
    """Largest stress per amplitude at the cavity, in the mode the damper follows [Pa/m]; None where it is not known.

    Of a plate by bending, of a structure in space wherever its strain is largest.
    """
    material, strain = results.scene.material, limits.largest_strain(results, crossing.omega)
    if material is None or strain is None or not _is_followed(results, crossing):
        return None
    return material.youngs_modulus * strain


def endured(results: Results, crossing: Crossing, at: SpeedPoint | None = None) -> float:
    """Amplitude at the cavity that the structure endures [m], by the structure there if known; inf: it is not known."""
    if not _is_followed(results, crossing):
        return math.inf
    return limits.endured(results if at is None else replace(results, speeds=(at,)), crossing.omega)


def _is_followed(results: Results, crossing: Crossing) -> bool:
    """Whether a crossing is that of the mode the damper follows, whose strain is known."""
    point = min(results.speeds, key=lambda point: abs(point.omega - crossing.omega))
    return point.followed is not None and point.modes[point.followed].branch == crossing.branch


def refused(results: Results) -> Reason | None:
    """Why a damper has a verdict at no speed, the lowest, where the load is least, included; None where it may have."""
    return limits.inadmissible(results, min(results.speeds, key=lambda point: point.omega))


def estimates(state: StructureState, stages: Stages) -> tuple[VibrationReduction, ...]:
    """What the ball does at every crossing of a run's orders with its modes, from free vibration.

    None without [excitation] and a damper, and where the damper is refused at all speeds.

    Raises:
        BadInput, NoAnswer: see :class:`workflows.solve.structure.StructureSolver`.
    """
    excitation, spec = state.source.scene.excitation, state.source.scene.damper
    results = state.results(stages=stages)
    if excitation is None or spec is None or state.solver is None or refused(results) is not None:
        return ()
    solver = state.solver.with_switches(coupling.with_forced_effects(state.source))
    met = solved_crossings(solver, state.points, excitation)
    return tuple(estimates_at(solver, results, met, excitation))


def estimates_at(
    solver: StructureSolver, results: Results, met: Sequence[Meeting], excitation: Excitation
) -> list[VibrationReduction]:
    """The same at crossings that are known; see :func:`estimate`."""
    found = []
    for each in met:
        with during(each.crossing.place):
            found.append(estimate(solver, results, each, excitation))
    return found


_MET, _CLOSED = 1e-5, 1e-9
"""Relative distance of an order from a frequency solved at a speed up to which they meet; and relative width of a
bracket of squared speeds that jumps over the order."""


class Meeting(NamedTuple):
    """A crossing, the structure there, and the structure where the ball at rest moves it to; None: it is not known."""

    crossing: Crossing
    at: SpeedPoint
    resting: SpeedPoint | None


def solved_crossings(solver: StructureSolver, points: Sequence[SpeedPoint], excitation: Excitation) -> list[Meeting]:
    """Crossings between the speeds of some points, with the structure there, and where the ball at rest moves them to.

    The latter is the last of the points where the order meets the frequency beyond it, and None where another mode
    moves the cavity more along x. An order that passes through the gap between two modes that veer meets neither.
    """
    estimated = engine_orders.of_points(points, excitation.orders)
    between = [engine_orders.ends(points, crossing) for crossing in estimated]
    modes = [partial(_nearest, crossing.order, ends) for crossing, ends in zip(estimated, between, strict=True)]
    solved = _meetings(solver, estimated, modes, [(low, high) for (low, _), (high, _) in between])
    met = [(crossing.moved(at), at) for crossing, at in zip(estimated, solved, strict=True) if at is not None]
    leading = [(crossing, at) for crossing, at in met if modes_at_crossing(at, crossing)[2]]
    slowest, fastest = (of(points, key=lambda point: point.omega) for of in (min, max))
    hertz = partial(_resting_hertz, solver.source.scene)
    sides = [(at, slowest if hertz(at) < crossing.frequency_hz else fastest) for crossing, at in leading]
    moved = _meetings(solver, [crossing for crossing, _ in leading], [hertz] * len(leading), sides)
    resting = {crossing: point for (crossing, _), point in zip(leading, moved, strict=True)}
    return [Meeting(crossing, at, resting.get(crossing)) for crossing, at in met]


def _nearest(order: int, ends: Sequence[tuple[SpeedPoint, int]], point: SpeedPoint) -> float:
    """Frequency of the mode that an order meets between two points, each with the mode's number there [Hz]."""
    known = {end.omega: [number] for end, number in ends}
    numbers = sorted(number for _, number in ends)
    between = known.get(point.omega, range(numbers[0], numbers[-1] + 1))
    every = [engine_orders.frequency_of(point, number) for number in between]
    return min(every, key=lambda hertz: abs(hertz - point.excited_by(order)))


def _resting_hertz(scene: Scene, point: SpeedPoint) -> float:
    """Frequency with the ball at rest of the mode that moves the cavity most along x [Hz]."""
    leader, reduced = leading_mode(point.cavity_modes, 0), present(point.reduced)
    if leader is None:
        return reduced.f1_hz
    return math.sqrt(leader.square(coupling.ball_mass(scene, reduced.M2), 0)) / (2 * math.pi)


def resting_shift(scene: Scene, at: SpeedPoint, crossing: Crossing, ball_mass: float) -> float:
    """By how much a ball at rest [kg] moves the frequency of a mode that is crossed, relative to the mode without it.

    By the modes that it is followed with; the ball's mass lowers it, its pull raises it.
    """
    modes, _, _ = modes_at_crossing(at, crossing)
    followed = modes_followed(scene, at, modes)
    if modes is None or followed is None:
        return 0.0 if at.reduced is None else at.reduced.f1_hz / at.reduced.f2_hz - 1
    shapes = np.array([mode.shape for mode in followed])
    soft = np.array([mode.stiffness for mode in followed]) ** -0.5
    mass = np.eye(len(followed)) + ball_mass * shapes @ shapes.T
    squares = np.sort(1 / np.linalg.eigvalsh(soft[:, None] * mass * soft))
    crossed = [mode.number for mode in followed].index(modes[0].number)
    return float(np.sqrt(squares[crossed])) / (2 * math.pi * at.excited_by(crossing.order)) - 1


def _meetings(
    solver: StructureSolver,
    crossings: Sequence[Crossing],
    hertz: Sequence[Callable[[SpeedPoint], float]],
    ends: Sequence[tuple[SpeedPoint, SpeedPoint]],
) -> list[SpeedPoint | None]:
    """The structure where orders meet frequencies between two points each, or at the second where they do not.

    By the Illinois rule in Omega², over which f² is nearly straight: what is left always has them on either side. None
    where the frequency jumps over the order.
    """

    def side(k: int, point: SpeedPoint) -> tuple[float, float]:
        return point.omega**2, hertz[k](point) ** 2 - point.excited_by(crossings[k].order) ** 2

    brackets = {k: (side(k, a), side(k, b)) for k, (a, b) in enumerate(ends)}
    found = dict[int, SpeedPoint | None]()
    while left := {k: bracket for k, bracket in brackets.items() if k not in found}:
        last = {k for k, ((_, u), (_, v)) in left.items() if u * v > 0 or u == v}
        squares = {k: b if k in last else (a * v - b * u) / (v - u) for k, ((a, u), (b, v)) in left.items()}
        tries = {k: math.sqrt(square) for k, square in squares.items()}
        at = solver.at(sorted(set(tries.values())), followed=False).by_speed
        for k, ((a, u), (b, v)) in left.items():
            point = at[tries[k]]
            if k in last or abs(hertz[k](point) / point.excited_by(crossings[k].order) - 1) <= _MET:
                found[k] = point
            elif abs(b - a) <= _CLOSED * b:
                found[k] = None
            else:
                new = side(k, point)
                brackets[k] = ((b, v) if new[1] * v < 0 else (a, u / 2), new)
    return [found[k] for k in range(len(ends))]


def estimate(solver: StructureSolver, results: Results, met: Meeting, excitation: Excitation) -> VibrationReduction:
    """What the ball does at a crossing, from free vibration.

    Args:
        solver: of the structure, with the effects of forced motion.
        results: the structure over the range of speeds.
        met: where an order meets a mode.
        excitation: its kind and levels.
    """
    crossing, at, resting = met
    bare = damper_at(solver, at, crossing, excitation)
    system = bare if resting is None else damper_at(solver, resting, crossing.moved(resting), excitation)
    none = copy_fields(VibrationReduction, crossing, mode=crossing.branch + 1)
    if isinstance(bare, str) or isinstance(system, str):
        return replace(none, reason=Reason.NOT_DRIVEN, detail=bare if isinstance(bare, str) else str(system))
    limit = endured(results, crossing, at)
    reason = limits.inadmissible(results, at) or (Reason.WEIGHT if limits.weight_governs(at) else None)
    if reason is None and resting is None:
        reason = Reason.OTHER_MODE
    if reason is None and system.floor_radius is not None and not is_well_held(system):
        reason = Reason.SWINGS
    if reason is None and resting is not None:  # which stays outside the half-power band where the speeds end before
        off = _resting_hertz(solver.source.scene, resting) / resting.excited_by(crossing.order) - 1
        reason = Reason.OUTSIDE if abs(off) > max(system.damping_ratio, _MET) else None
    if reason is not None:
        return replace(none, reason=reason)
    with solver.stages("damper"):
        balance = _Balance.of(system, bare, met, excitation)
        known, amplitude = _over_levels(balance, limit, excitation.levels)
    if math.isfinite(amplitude):
        hertz = None if modes_at_crossing(at, crossing)[2] else crossing.frequency_hz
        if limits.weight_at(results, at, amplitude, hertz) > 1:
            return replace(none, reason=Reason.WEIGHT)
        if limits.slides(results, at, amplitude, hertz):
            return replace(none, reason=Reason.SLIP)
        known["friction_needed"] = limits.friction_needed(results, at, amplitude, hertz)
    return replace(none, **known, loose=not is_well_held(system) or limits.is_heavy(at))


HELD, HELD_IN_A_BOWL = 0.3, 1.0
"""Cut-off over half the clearance from which on the balance speaks for a ball on a flat floor, and in a hollow one."""


def is_well_held(system: damper.ParticleDamper) -> bool:
    """Whether the load or the cavity holds a ball well: one that swings in a bowl or rolls far moves otherwise too."""
    gap, left = system.half_gap[0], abs(1 - system.tilt_share[0])
    threshold = system.leaving_threshold / system.stuck_frequency**2
    return threshold >= (HELD if system.floor_radius is None else HELD_IN_A_BOWL) * gap * left


@lru_cache(maxsize=16)
def free_vibration(system: damper.ParticleDamper, threads: int | None = None) -> damper.Backbone:
    """Damping and frequency of free vibration, measured once for a damper that is met again."""
    return damper.backbone(system, threads=threads)


@dataclass(frozen=True, eq=False)
class _Balance:
    """Amplitudes at resonance by the level of the excitation.

    Attributes:
        free: free vibration with the ball.
        force: at the cavity by a unit of the excitation [N].
        resting: frequency with the ball at rest [rad/s].
        bare: amplitude without the ball, by a unit of the excitation [m].
        moves_from: level up to which the ball stays at rest, along both axes.
        driven_from: level from which the simulated forces move it.
    """

    free: damper.Backbone
    force: float
    resting: float
    bare: float
    moves_from: float
    driven_from: float

    @classmethod
    def of(
        cls, system: damper.ParticleDamper, bare: damper.ParticleDamper, met: Meeting, excitation: Excitation
    ) -> _Balance:
        """That of a damper where the ball at rest moves a crossing to, beside the structure that is bare, at it."""
        crossing, at, there = met.crossing, met.at, met.resting or met.at
        unit, alone = (
            harmonic_of(each, crossing, point, excitation, 1.0) for each, point in ((system, there), (bare, at))
        )
        branch = branch_of((at,), crossing)
        crossed = next((k for k, mode in enumerate(at.modes) if mode.branch == branch), 0)
        free, frequency = free_vibration(system), system.swing_frequency
        driven = float(damper.moves_from(system, [replace(unit, frequency=frequency)])[0])
        share = coupling.resting_share(system, there) if modes_at_crossing(there, crossing)[1] == 0 else 1.0
        twice_zeta = free.dashpot / math.sqrt(system.stiffness[0] * system.modal_mass)
        stiffness = bare.modal_mass * (2 * math.pi * engine_orders.frequency_of(at, crossed)) ** 2
        without = force_at_cavity(bare, alone, ball=False) / (twice_zeta * stiffness)
        return cls(free, force_at_cavity(system, unit), frequency, without, share * driven, driven)

    def amplitude(self, levels: Floats) -> Floats:
        """The largest as the speed goes through the crossing, whatever the ball does [m]."""
        return self.free.peaks(levels * self.force)

    @property
    def at_rest(self) -> float:
        """With the ball at rest, by a unit of the excitation [m]."""
        return self.force / (self.free.dashpot * self.resting)


def half_way(ratio: float) -> float:
    """The amplitude ratio of half the reduction of another."""
    return 0.5 * (1.0 + ratio)


_LEVELS = 2000
"""Levels looked through."""

_BELOW, _ABOVE = 0.1, 30.0
"""Amplitudes looked through: from a part of where the ball begins to move, to a multiple of the last known."""


def _over_levels(balance: _Balance, limit: float, requested: Sequence[float]) -> tuple[dict[str, Any], float]:
    """Look through all levels up to what the structure endures, and at those asked for.

    Returns:
        Fields of a `VibrationReduction`, and the amplitude with the ball at the best level [m]; nan: there is none.
    """
    moving = [branch for branch in balance.free.branches if branch.damping_ratio.max() > 0]
    rests = next((branch.range[1] for branch in balance.free.branches if branch not in moving), 0.0)
    by_level = zip(requested, balance.amplitude(np.array(requested)).tolist(), strict=True)
    levels = tuple(ForceLevel(level, each / balance.bare / level, each, each <= limit) for level, each in by_level)
    low = min([limit, *(_BELOW * max(rests, float(branch.amplitude[0])) for branch in moving)])
    high = min(limit, max((_ABOVE * float(branch.amplitude[-1]) for branch in moving), default=math.inf))
    known: dict[str, Any] = {"moves_from": balance.moves_from, "driven_from": balance.driven_from, "levels": levels}
    if not moving or not low < high:
        return known | {"endured_level": limit / balance.at_rest}, math.nan
    strongest = max(float(branch.damping_ratio.max()) for branch in moving)
    per_level = balance.force / (balance.free.dashpot * balance.resting + 2 * balance.free.stiffness * strongest)
    scan = np.geomspace(low / balance.at_rest, high / per_level, _LEVELS)
    amplitude = balance.amplitude(scan)
    ratio, borne = amplitude / balance.bare / scan, amplitude <= limit
    moves = borne & ((scan >= balance.moves_from) | (amplitude < (1 - _STILL) * balance.at_rest * scan))
    best = int(np.argmin(np.where(moves, ratio, math.inf)))
    helps = np.flatnonzero(moves & (ratio <= min(half_way(float(ratio[best])), HELPS)))
    if best in helps:
        known["range"] = neighbours(scan, helps, best)
    last = neighbours(scan, np.flatnonzero(borne), 0)[1]
    most = max(last, limit / balance.at_rest) if borne.all() else last
    known |= {"ratio": float(ratio[best]), "level": float(scan[best]), "endured_level": most}
    return known, float(amplitude[best])


def neighbours(scan: Floats, places: npt.NDArray[np.intp], one: int) -> tuple[float, float]:
    """The first and the last of the neighbouring places that one of them belongs to."""
    runs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    mine = next((run for run in runs if one in run), np.array([one]))
    return float(scan[mine[0]]), float(scan[mine[-1]])
