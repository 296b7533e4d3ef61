"""Steady states through every crossing of an engine order with a mode, without and with the ball; and their records."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from decimal import ROUND_DOWN, ROUND_UP, Context, Decimal
from functools import partial
from typing import Any, NamedTuple

import numpy as np

import damper
from damper.starts import usual_starts
from workflows.errors import during, read_from
from workflows.io.files import StudyResult
from workflows.progress import Stages
from workflows.scene.load import SceneFile
from workflows.scene.scene import Excitation, Scene
from workflows.solve import coupling, engine_orders, excitation, limits, resources
from workflows.solve import damper as damper_stage
from workflows.solve.engine_orders import Crossing
from workflows.solve.results import CavityMode, Floats, ForceLevel, Results, SpeedPoint, VibrationReduction
from workflows.solve.structure import StructureSolver


@dataclass(frozen=True, eq=False, repr=False)
class Passage:
    """Steady states through a crossing: s speeds, f forces, from each start.

    Attributes:
        crossing: where; at: the structure there; axis: along which of the damper's axes the amplitude is.
        omega: (s,) [rad/s]; forces: (f,).
        states: of the damper, in arrays of shape (s, f), or (s, f, starts).
        reduction: the same by free vibration, as a run estimates it, at the levels followed.
        least_force: up to which the ball stays at rest, in the unit of the forces.
        driven_from: force from which on the simulated forces move it.
        figures: the damper's own, at the crossing; None where another mode leads along axis 1, whose they would be.
    """

    crossing: Crossing
    at: SpeedPoint
    axis: int
    omega: Floats
    forces: tuple[float, ...]
    states: damper.Forced
    reduction: VibrationReduction
    least_force: float
    driven_from: float
    figures: damper.DampingCurve | None


@dataclass(frozen=True, eq=False, repr=False)
class Response(StudyResult):
    """All that a forced response found.

    Attributes:
        results: the structure over the whole range of speeds, as of a run, with the estimates by free vibration.
        passages: crossings that were followed; not_followed: the others, each with the reason.
        requested_levels: those of the scene; the others are where the ball does most, by free vibration, or above that.
    """

    REPORT = "workflows.studies.response_report"
    results: Results
    excitation: Excitation
    passages: tuple[Passage, ...]
    not_followed: tuple[tuple[Crossing, str], ...]
    requested_levels: tuple[float, ...]


def peak(passage: Passage, force: int) -> tuple[int, int]:
    """Speed and start at which the mean amplitude under a force is largest, whatever the start."""
    means = np.nan_to_num(passage.states.mean[:, force])  # nan where a ball has no end of hits
    speed, start = np.unravel_index(int(np.argmax(means)), means.shape)
    return int(speed), int(start)


def shows(passage: Passage, speeds: Sequence[float]) -> bool:
    """Whether the mode has a peak at the cavity without the ball, or may have one beyond the scene's speeds [rad/s].

    Otherwise another mode moves the cavity more at an end of the band: its tail is no answer about this one.
    """
    omega, last = passage.omega, len(passage.omega) - 1
    places = np.abs(passage.states.without).argmax(axis=0)
    return all(0 < k < last or is_scene_end(float(omega[k]), speeds) for k in places)


def is_scene_end(omega: float, speeds: Sequence[float]) -> bool:
    """Whether a speed is the least or the greatest of a scene's [rad/s]."""
    return any(math.isclose(omega, each, rel_tol=1e-9, abs_tol=1e-9) for each in (min(speeds), max(speeds)))


@dataclass(frozen=True)
class Row:
    """A crossing under one force, at the speed and from the start at which the mean amplitude is largest.

    Attributes:
        without: largest amplitude without the ball, whatever the speed [m]; the same in each of the others.
        least, mean, rms, greatest: of the cycles' amplitudes [m].
        error: of the mean; with the ball at rest, by how much farther it goes until it is set off [m].
        smallest: mean at the same speed from the start from which it is smallest [m].
        from_rest: largest mean of the motions that begin with the ball at rest, whatever the speed [m]; inf: not known.
        stress_without, stress_with: the largest, of a plate by bending [Pa]; None where it is not known.
        estimate: by free vibration, of a run; None where that does not apply.
    """

    passage: Passage
    force: float
    omega: float
    frequency: float
    without: float
    least: float
    mean: float
    rms: float
    greatest: float
    error: float
    smallest: float
    from_rest: float
    regime: str
    hits_per_cycle: float
    power_in: float
    power_lost: float
    estimate: ForceLevel | None
    stress_without: float | None
    stress_with: float | None

    @property
    def ratio(self) -> float:
        """Mean amplitude with the ball over the one without."""
        return self.mean / self.without

    @property
    def ratio_error(self) -> float | None:
        """Error of the ratio where the motion has not settled; None where the ratio is known.

        The motion may dwell for longer than the last half of a run: what cycles, and means of other starts, differ by
        counts, too.
        """
        cycles = math.sqrt(max(self.rms**2 - self.mean**2, 0.0))
        spread = max(self.error, self.mean - self.smallest, cycles)
        return spread / self.without if self.regime == damper.Regime.UNSETTLED else None

    @property
    def difference(self) -> float | None:
        """The estimated ratio over the one of the motion, less 1."""
        return None if self.estimate is None else self.estimate.ratio / self.ratio - 1


def rows(result: Response, only: Passage | None = None) -> list[Row]:
    """All crossings under all forces, or one of them."""
    passages = result.passages if only is None else (only,)
    return [_row(result, passage, k) for passage in passages for k in range(len(passage.forces))]


_OF_A_ROW = ("least", "mean", "rms", "greatest", "hits_per_cycle", "power_in", "power_lost")
"""Fields of a row that steady states have by the same names."""


def _row(result: Response, passage: Passage, force: int) -> Row:
    speed, start = peak(passage, force)
    states = passage.states

    def at(name: str) -> float:
        return float(getattr(states, name)[speed, force, start])

    without = float(np.abs(states.without)[:, force].max())
    regime, short = states.regime[speed, force, start], _short_of_set_off(passage, speed, force)
    estimates = {each.level: each for each in passage.reduction.levels}
    stress = excitation.largest_stress(result.results, passage.crossing)
    return Row(
        passage=passage,
        force=passage.forces[force],
        omega=float(passage.omega[speed]),
        frequency=passage.crossing.order * float(passage.omega[speed]) / (2 * np.pi),
        without=without,
        **{name: at(name) for name in _OF_A_ROW},
        error=at("error") + (short if regime == damper.Regime.LOCKED else 0.0) * at("mean"),
        smallest=float(states.mean[speed, force].min()),
        from_rest=float(np.nan_to_num(states.mean[:, force, states.starts.index(damper.Start.UP)], nan=np.inf).max()),
        regime=str(regime),
        estimate=estimates.get(passage.forces[force]),
        stress_without=None if stress is None else stress * without,
        stress_with=None if stress is None else stress * at("greatest"),
    )


def _short_of_set_off(passage: Passage, speed: int, force: int) -> float:
    """Relative growth of the amplitude until the ball, at rest there, is set off, where it is at a speed beside."""
    factor = passage.states.moves_from[:, force]
    beside = factor[max(speed - 1, 0) : speed + 2]
    return float(factor[speed]) - 1 if factor[speed] >= 1 > beside.min() else 0.0


def is_beyond(result: Response, row: Row) -> bool:
    """Whether the plate endures neither the amplitude of a row nor, at any amplitude, its speed."""
    limit = excitation.endured(result.results, row.passage.crossing)
    torn = (limits.root_stress(result.results, row.passage.crossing.omega) or 0.0) > limits.STRONGEST
    return torn or row.greatest > limit


_RINGS = 5.0
"""Half the width of the band looked through, in damping ratios of the structure: the response falls to a tenth."""

_SPLITS = 0.75
"""And in what a ball that swings in a hollow floor splits the resonance by (Den Hartog: the root of the mass ratio)."""

_SHIFTS = 0.5
"""And in shifts of the frequency by the ball at rest: where that moves a resonance is roughly known for some modes."""

_NARROWEST = 2e-3
"""Least half width of the band."""


def band(resonances: Sequence[float], half: float, speeds: tuple[float, float]) -> tuple[float, float]:
    """Speeds between which the resonances are, and half a width beside them [rad/s], within what the scene asks for."""
    low, high = speeds
    return max(min(resonances) - half, low), min(max(resonances) + half, high)


def resonance_speeds(resonances: Sequence[float], width: float, ends: tuple[float, float], count: int) -> Floats:
    """Speeds between two ends [rad/s], closest to each other about resonances of a half width, which are among them.

    They lie evenly on the sum of asinh((omega - resonance) / width): the farther off, the farther apart.
    """
    around = np.add.outer(resonances, width * np.sinh(np.linspace(-15.0, 15.0, 3001)))
    fine = np.unique(np.clip(around, *ends))
    place = np.arcsinh(np.subtract.outer(fine, resonances) / width).sum(axis=1)
    omega: Floats = np.interp(np.linspace(place[0], place[-1], count), place, fine)
    for each in resonances:
        omega[np.argmin(np.abs(omega - each))] = min(max(each, ends[0]), ends[1])
    return omega


SET_OFF = 1e-4
"""By how much a force may grow, relative, until it sets off the ball at rest, at a speed that counts as the last."""

_TRIES = 8
"""How often a further speed is tried for each of these."""


def set_off_speeds(omega: Floats, threshold: Floats, levels: Sequence[float]) -> Floats:
    """Further speeds at which forces just do not set off the ball at rest, as far as they are not known [rad/s].

    Beside a linear resonance the square of the threshold is a parabola.

    Args:
        omega: ascending (s,) [rad/s].
        threshold: least force that sets the ball off, (s,).
        levels: of the forces.
    """
    more = []
    for level in levels:
        aim = (1 + 0.5 * SET_OFF) * level
        for k, rests in _last_at_rest(threshold, level):
            if threshold[rests] <= (1 + SET_OFF) * level:
                continue
            low, high = omega[k : k + 2]
            begin = min(max(k - 1, 0), max(len(omega) - 3, 0))
            known, square = omega[begin : begin + 3] - low, threshold[begin : begin + 3] ** 2
            roots: Any = np.empty(0)
            if len(known) == 3 and np.isfinite(square).all():
                roots = np.polynomial.Polynomial.fit(known, square - aim**2, 2).roots()
            real = low + roots[np.isreal(roots)].real
            inside = real[(low < real) & (real < high)]
            more.append(float(inside[0]) if len(inside) == 1 else 0.5 * (low + high))
    return np.unique(more)


def _last_at_rest(threshold: Floats, level: float) -> list[tuple[int, int]]:
    """Steps between speeds in which a force sets off the ball at rest, each with its end at which the ball stays."""
    rests = threshold >= level
    return [(int(k), int(k if rests[k] else k + 1)) for k in np.flatnonzero(rests[:-1] != rests[1:])]


def beside_peaks(omega: Floats, amplitude: Floats) -> Floats:
    """A further speed for each force, beside the one at which its amplitude is largest [rad/s].

    It lies where a parabola through 1 / A² is least, as about a linear resonance, or where that is known, midway to a
    neighbour; where a motion ends beside the largest amplitude, midway to there. Never beyond the speeds, where another
    mode may rise.

    Args:
        omega: ascending (s,) [rad/s].
        amplitude: (s, f).
    """
    known = omega
    for curve in amplitude.T:
        k = int(np.argmax(curve))
        below, at, above = omega[max(k - 1, 0)], omega[k], omega[min(k + 1, len(omega) - 1)]
        tries = [0.5 * (at + each) for each in sorted((below, above), key=lambda each: -abs(each - at))]
        if 0 < k < len(omega) - 1 and curve[k - 1] > 0 < curve[k + 1]:
            low, high = below - at, above - at
            left, right = ((curve[k] / curve[each]) ** 2 - 1 for each in (k - 1, k + 1))
            curvature = (right / high - left / low) / (high - low)
            tries.insert(0, at + 0.5 * (low - left / (low * curvature)) if curvature > 0 else at)
            least, most = sorted((curve[k - 1], curve[k + 1]))
            if least < _FALLS * curve[k] and most > _KEEPS * curve[k]:  # the motion ends on that side
                tries.insert(0, 0.5 * (at + (below if curve[k - 1] < curve[k + 1] else above)))
        gaps = np.diff(known)
        tries.append(known[np.argmax(gaps)] + 0.5 * gaps.max())
        apart = _APART * (above - below)
        chosen = next((each for each in tries[:-1] if np.abs(known - each).min() > apart), tries[-1])
        known = np.sort(np.append(known, chosen))
    return np.setdiff1d(known, omega)


_FALLS, _KEEPS = 0.5, 0.8
"""Amplitudes on either side of the largest, over that, between which the motion ends on one of them."""

_APART = 0.05
"""How far a further speed lies from all others, over the distance of the neighbours of the largest amplitude."""

SPEEDS, FEW_SPEEDS = 40, 12
"""Through a crossing, at first; fewer where each speed of the plate is solved by itself."""

ROUNDS, _HOLLOW = 4, 2
"""How often a further speed is evaluated for each force; by how much more often where large motions end abruptly."""

_ACCURACY = 1e-2
"""To which the mean amplitude of motion that does not repeat itself is known."""

MOST_CYCLES = 30_000
"""Most cycles of a motion."""


def respond(source: SceneFile, stages: Stages | None = None) -> Response:
    """Follow a scene's steady states through its crossings; nothing is written.

    The floor of the cavity tilts and the plate moves in its own modes, whatever [effects] says: the answer is about the
    blade. Each damper has the modes that yield most along its axes, and the one that is crossed.

    Raises:
        BadInput: no damper, no excitation, no range of speeds, no order that drives a mode within it; see also
            :func:`workflows.pipeline.run`.
        NoAnswer: the plate has none.
    """
    forcing = excitation.excitation_of(source)
    resources.check(source)
    stages = stages or Stages()
    source = coupling.with_forced_effects(source)
    solver = StructureSolver(source, stages)
    results = excitation.over_speed_range(solver).results(stages=stages)
    met = excitation.solved_crossings(solver, results.speeds, forcing)
    if not met:
        raise engine_orders.no_crossing(results.speeds, forcing.orders, source.name)

    reductions = excitation.estimates_at(solver, results, met, forcing)
    levels = forcing.levels
    followed = with_levels(forcing, best_levels(reductions))
    response = _response(solver, results, met, followed, reductions if followed.levels == levels else None)
    if above := levels_above(response):
        response = _response(solver, results, met, with_levels(followed, above))
    return replace(response, requested_levels=levels, results=replace(response.results, timings=stages.timings()))


def _response(
    solver: StructureSolver,
    results: Results,
    met: Sequence[excitation.Meeting],
    forcing: Excitation,
    reductions: Sequence[VibrationReduction] | None = None,
) -> Response:
    """The steady states through all crossings at the levels of an excitation; `reductions`: estimates at these.

    Raises:
        BadInput: nothing drives a mode that is crossed.
    """
    reductions = reductions or excitation.estimates_at(solver, results, met, forcing)
    passages, not_followed, source = [], [], solver.source
    for each, reduction in zip(met, reductions, strict=True):
        with during(each.crossing.place):
            passage = _passage(solver, each, forcing, reduction)
        if isinstance(passage, str):
            not_followed.append((each.crossing, passage))
        else:
            passages.append(passage)
    if not passages:
        raise engine_orders.no_crossing(results.speeds, forcing.orders, source.name, driven=False)
    results = replace(results, scene=source.scene, reductions=tuple(reductions))
    return Response(results, forcing, tuple(passages), tuple(not_followed), forcing.levels)


NEAR_BEST = 0.9
"""Share of the largest reduction that a level asked for has to show, or else the best is followed besides."""


_ROUNDED = 0.01
"""By how much the best level may be rounded, relative: the ratio there grows by no more."""


def best_level(reduction: VibrationReduction) -> float:
    """Where the ball does most by free vibration, rounded to as few digits as leave it the best.

    Downwards, since the amplitude may jump beyond the best level, where another motion begins; below it the amplitude
    is no larger, and the ratio hardly so. Upwards only where no such level is in the range of those that help.
    """
    low, high = reduction.range
    near = max(low, (1 - _ROUNDED) * reduction.level)
    ways = (*((digits, ROUND_DOWN) for digits in (2, 3, 4)), (4, ROUND_UP))
    rounded = (_rounded(reduction.level, *way) for way in ways)
    return next((level for level in rounded if near <= level <= high), reduction.level)


def _rounded(level: float, digits: int, way: str) -> float:
    """A level in so many digits."""
    return float(Context(prec=digits, rounding=way).create_decimal(Decimal(repr(level))))


def best_levels(reductions: Sequence[VibrationReduction]) -> set[float]:
    """The levels at which the ball does most by free vibration, where those asked for show much less."""
    best = set()
    for each in reductions:
        shown = max((1 - level.ratio for level in each.levels if level.endured), default=0.0)
        if math.isfinite(each.range[0]) and shown < NEAR_BEST * (1 - each.ratio):
            best.add(best_level(each))
    return best


_ABOVE, _MUCH_LESS = 1.25, 0.75
"""A further level over the best one of free vibration, and the share of the reduction predicted there below which the
motion has to stay for it."""


def levels_above(response: Response) -> set[float]:
    """Levels above the best of free vibration where the motion followed shows much less than predicted.

    Below a fold the ball may go on rolling to and fro; above it, it bounces.
    """
    above, speeds = set(), response.results.scene.rotor.speeds
    for passage in (one for one in response.passages if shows(one, speeds)):
        each = passage.reduction
        shown = max((1 - row.ratio for row in rows(response, passage) if not is_beyond(response, row)), default=0.0)
        if math.isfinite(each.range[0]) and shown < _MUCH_LESS * (1 - each.ratio):
            level = _rounded(min(_ABOVE * each.level, each.range[1]), 2, ROUND_DOWN)
            above |= {level} if level > each.level else set()
    return above - {*response.excitation.levels}


def with_levels(forcing: Excitation, more: set[float]) -> Excitation:
    """The excitation with further levels."""
    return forcing.model_copy(update={forcing.kind: tuple(sorted({*forcing.levels, *more}))})


_SAME = 0.02
"""Difference of amplitude ratios from which on the modes that hits feed are followed too."""

_TRIED, _ABOUT = 5, 0.7
"""Speeds by which this is told, and the part of a peak down to which they reach."""


def _passage(
    solver: StructureSolver, met: excitation.Meeting, forcing: Excitation, reduction: VibrationReduction
) -> Passage | str:
    """The steady states through a crossing, or why there is nothing to follow.

    In the mode crossed and those that yield most along either axis, and where others move a peak, in all that a
    ring-down has.
    """
    passage = _followed(solver, met, forcing, reduction, every=False)
    if isinstance(passage, str) or not _others_count(solver, met, passage, forcing):
        return passage
    return _followed(solver, met, forcing, reduction, every=True)


def _others_count(solver: StructureSolver, met: excitation.Meeting, passage: Passage, forcing: Excitation) -> bool:
    """Whether modes that only hits feed change the amplitude ratio of a peak, by a few speeds about it."""
    scene, crossing, at = solver.source.scene, met.crossing, met.at
    modes, _, _ = excitation.modes_at_crossing(at, crossing)
    few, many = (excitation.modes_followed(scene, at, modes, every=every) or () for every in (False, True))
    if len(few) == len(many):
        return False
    without = np.abs(passage.states.without).max(axis=0)
    means = np.nan_to_num(passage.states.mean).max(axis=2)
    for k, level in enumerate(passage.forces):
        about = np.flatnonzero(means[:, k] >= _ABOUT * means[:, k].max())
        tried = np.unique(about[np.linspace(0, about.size - 1, _TRIED).round().astype(int)])
        one = forcing.model_copy(update={forcing.kind: (level,)})
        cases = _cases(solver, crossing, one, passage.omega[tried], passage.axis, every=True)
        most = np.nan_to_num(_steady_states(solver, crossing, cases, passage.axis).mean).max()
        if abs(most - means[tried, k].max()) > _SAME * without[k]:
            return True
    return False


def _followed(
    solver: StructureSolver,
    met: excitation.Meeting,
    forcing: Excitation,
    reduction: VibrationReduction,
    *,
    every: bool,
) -> Passage | str:
    crossing, at, _ = met
    system = excitation.damper_at(solver, at, crossing, forcing)
    if isinstance(system, str):
        return system
    _, axis, leads = excitation.modes_at_crossing(at, crossing)
    share = coupling.resting_share(system, at) if axis == 0 else 1.0
    omega = _speeds(solver, met, system)
    cases = partial(_cases, solver, crossing, forcing, axis=axis, every=every)
    steady_states = partial(_steady_states, solver, crossing, axis=axis)
    go_on = partial(_gone_on, solver, cases, axis, dict[tuple[float, float, int], float]())
    states = go_on(omega, steady_states(cases(omega)))
    for _ in range(ROUNDS if system.floor_radius is None else _HOLLOW * ROUNDS):
        more = beside_peaks(omega, np.nan_to_num(states.mean).max(axis=2))
        omega, states = _merged(omega, states, more, steady_states(cases(more)))
        states = go_on(omega, states)
    if last := _just_at_rest(cases, forcing, omega, states):
        omega, states = _merged(omega, states, np.array(list(last)), steady_states(list(last.values())))
    with solver.stages("damper"):
        driven_from = float((np.array(forcing.levels) * states.moves_from).min())
    figures = None
    if leads:
        own = damper.damping_curve(system, least=limits.least_amplitude(met.at))
        figures = replace(own, cutoff=share * own.cutoff)
    moves = share * driven_from, driven_from
    return Passage(crossing, at, axis, omega, forcing.levels, states, reduction, *moves, figures)


def _found(
    dampers: Sequence[damper.ParticleDamper],
    harmonics: Sequence[damper.Harmonic],
    starts: Sequence[damper.Start],
    axis: int,
    **more: Any,
) -> damper.Forced:
    """Steady states as accurate as a response has them."""
    return damper.forced(dampers, harmonics, starts, probe=axis, accuracy=_ACCURACY, max_cycles=MOST_CYCLES, **more)


def _merged(omega: Floats, states: damper.Forced, more: Floats, others: damper.Forced) -> tuple[Floats, damper.Forced]:
    """Some speeds and others, ascending, and the steady states there."""
    speeds = np.array([*omega, *more])
    order = np.argsort(speeds)
    every: dict[str, Any] = {f: np.concatenate([getattr(states, f), getattr(others, f)])[order] for f in _FIGURES}
    return speeds[order], replace(states, **every)


_FIGURES = [field.name for field in fields(damper.Forced) if field.name != "starts"]
"""Fields of steady states that are arrays."""

_OF_STARTS = [name for name in _FIGURES if name not in ("linear", "without", "moves_from")]
"""Those that differ from start to start."""


def _speeds(solver: StructureSolver, met: excitation.Meeting, system: damper.ParticleDamper) -> Floats:
    """Speeds through the resonance without the ball, and with it at rest."""
    crossing, at, resting = met
    scene, zeta = solver.source.scene, system.damping_ratio
    speeds = scene.rotor.speeds
    slower = crossing.order - crossing.turns  # than the order the frequency grows
    per_frequency = crossing.omega * crossing.order / math.copysign(max(abs(slower), 1e-3), slower)
    shift = excitation.resting_shift(scene, at, crossing, system.ball_mass)
    there = crossing.omega + shift * per_frequency if resting is None else resting.omega
    both = (min(max(there, min(speeds)), max(speeds)), crossing.omega)
    splits = math.sqrt(system.stuck_mass / system.modal_mass - 1) if system.floor_radius is not None else 0.0
    relative = max(_RINGS * zeta + max(_SHIFTS * abs(shift), _SPLITS * splits), _NARROWEST)
    ends = band(both, relative * abs(per_frequency), (min(speeds), max(speeds)))
    count = FEW_SPEEDS if solver.solves_each_speed else SPEEDS
    return resonance_speeds(both, zeta * abs(per_frequency), ends, count)


def without_pull(
    system: damper.ParticleDamper, scene: Scene, point: SpeedPoint, only: Sequence[CavityMode] | None
) -> damper.ParticleDamper:
    """The damper on its structure as it is without the ball, whose centrifugal pull stiffens it.

    Modes above those of the scene, which no order asked for meets, keep the pull. `only`: the modes that are followed;
    None: those of the scene.
    """
    if system.modes is None:
        share = 1.0 if point.reduced is None else point.reduced.K2 / point.reduced.K1
        return replace(system, stiffness=(share * system.stiffness[0], share * system.stiffness[1]))
    free = {k + 1: (2 * math.pi * mode.frequency_hz) ** 2 for k, mode in enumerate(point.modes)}
    pairs = zip(system.modes, coupling.damper_modes(scene, point) if only is None else only, strict=True)
    return replace(
        system, modes=tuple(replace(each, stiffness=each.mass * free.get(k.number, k.stiffness)) for each, k in pairs)
    )


class _Case(NamedTuple):
    """What is driven at a speed: by all forces; `alone`: amplitudes without the ball and its pull on the structure."""

    system: damper.ParticleDamper
    harmonics: list[damper.Harmonic]
    alone: list[complex]


def _cases(
    solver: StructureSolver, crossing: Crossing, forcing: Excitation, omega: Floats, axis: int, *, every: bool
) -> list[_Case]:
    """The damper on the structure at some speeds, each with all forces."""
    from damper.equations import structures_by
    from damper.starts import without_ball

    cases, points = [], solver.at(omega).points
    branch, source = excitation.branch_of(points, crossing), solver.source
    for point in points:
        modes = excitation.modes_of(point, branch)
        only = excitation.modes_followed(source.scene, point, modes, every=every)
        with read_from(source.name):
            system = damper_stage.particle_damper(source.scene, solver.choice.effects, point, only)
        driven = [excitation.harmonic_of(system, crossing, point, forcing, level) for level in forcing.levels]
        bare = without_pull(system, source.scene, point, only)
        shape = np.eye(2)[axis] if bare.modes is None else np.array([mode.shape[axis] for mode in bare.modes])
        structures = structures_by(bare, bare.parameters)
        cases.append(_Case(system, driven, [without_ball(structures, [each])[0] @ shape for each in driven]))
    return cases


def _gone_on(
    solver: StructureSolver,
    cases: Callable[[Floats], list[_Case]],
    axis: int,
    tried: dict[tuple[float, float, int], float],
    omega: Floats,
    states: damper.Forced,
) -> damper.Forced:
    """Steady states with motions from resonance that go on from those of a neighbouring speed where these are larger.

    In a hollow floor, where large motions begin from few starts, and are largest next to the speed at which they end.
    `tried`: amplitudes [m] at a speed from whose neighbour at which force this has been tried before.
    """
    if damper.Start.RESONANT not in states.starts:
        return states
    column = states.starts.index(damper.Start.RESONANT)
    while True:
        means = np.nan_to_num(states.mean)
        most, best = means.max(axis=2), means.argmax(axis=2)
        moves = np.take_along_axis(states.regime, best[..., None], axis=2)[..., 0] != damper.Regime.LOCKED
        pairs = [
            (k, j, level)
            for k, j in ((k, k + way) for k in range(len(omega)) for way in (-1, 1) if 0 <= k + way < len(omega))
            for level in range(most.shape[1])
            if moves[j, level]
            and most[j, level] > _LARGER * max(most[k, level], tried.get((omega[k], omega[j], level), 0.0))
        ]
        if not pairs:
            return states
        tried |= {(omega[k], omega[j], level): float(most[j, level]) for k, j, level in pairs}
        speeds = sorted({k for k, _, _ in pairs})
        driven = dict(zip(speeds, cases(omega[speeds]), strict=True))
        begun = np.array([states.state[j, level, best[j, level]] for _, j, level in pairs])
        systems, harmonics = zip(
            *((driven[k].system, driven[k].harmonics[level]) for k, _, level in pairs), strict=True
        )
        with solver.stages("damper"):
            found = _found(systems, harmonics, [damper.Start.RESONANT], axis, states=begun)
        every = {name: getattr(states, name).copy() for name in _OF_STARTS}
        for n, (k, _, level) in enumerate(pairs):
            if np.nan_to_num(found.mean[n, 0]) > max(most[k, level], np.nan_to_num(every["mean"][k, level, column])):
                for name, values in every.items():
                    values[k, level, column] = getattr(found, name)[n, 0]
        states = replace(states, **every)


_LARGER = 1.2
"""By which a motion at a neighbouring speed is larger that is tried here."""


def _just_at_rest(
    cases: Callable[[Floats], list[_Case]], forcing: Excitation, omega: Floats, states: damper.Forced
) -> dict[float, _Case]:
    """What is driven at the speeds beside which forces set off the ball at rest [rad/s]: there it moves farthest."""
    level, tried = forcing.levels[0], dict[float, _Case]()
    threshold = level * states.moves_from[:, 0]
    for _ in range(_TRIES):
        more = set_off_speeds(omega, threshold, forcing.levels)
        if not more.size:
            break
        new = cases(more)
        least = [level * float(damper.moves_from(each.system, each.harmonics[:1])[0]) for each in new]
        tried |= dict(zip(more.tolist(), new, strict=True))
        order = np.argsort([*omega, *more])
        omega, threshold = np.array([*omega, *more])[order], np.array([*threshold, *least])[order]
    last = {float(omega[rests]) for level in forcing.levels for _, rests in _last_at_rest(threshold, level)}
    return {speed: tried[speed] for speed in sorted(last & tried.keys())}


def _steady_states(solver: StructureSolver, crossing: Crossing, cases: Sequence[_Case], axis: int) -> damper.Forced:
    """The steady states of what is driven, (speeds, forces) of them, with progress for a person who waits.

    Those without the ball are of the structure without its pull.
    """
    starts = usual_starts(cases[0].system)
    dampers = [each.system for each in cases for _ in each.harmonics]
    harmonics = [harmonic for each in cases for harmonic in each.harmonics]
    with solver.stages("damper", len(dampers) * len(starts)) as step:
        done = 0

        def progress(number: int) -> None:
            nonlocal done
            if number > done:
                step.advance(crossing.place, number - done)
            done = number

        states = _found(dampers, harmonics, starts, axis, progress=progress)
    states = replace(states, without=np.array([alone for each in cases for alone in each.alone], complex))
    every: dict[str, Any] = {name: getattr(states, name) for name in _FIGURES}
    return replace(states, **{name: each.reshape(len(cases), -1, *each.shape[1:]) for name, each in every.items()})
