"""The paper's statements, judged by numbers, and which errors of its program would explain them.

Their words are those of `templates/paper.toml`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from workflows.formatting import significant
from workflows.scene import plate_mesh
from workflows.scene.materials import OSMIUM
from workflows.scene.paper import SDC_RANGE, TABLE_II
from workflows.solve.results import Figures, SpeedPoint
from workflows.studies.reproduction.simulation import (
    FORMULATIONS,
    MASS_RATIOS,
    RELEASE,
    SHOWN,
    TEXTS,
    DampingCurve,
    Family,
    Floats,
    Simulated,
    Sweeps,
    level,
    moving,
)

if TYPE_CHECKING:
    from damper import ParticleDamper


Value = float | int | str | list[float] | None
"""A number, several, words, or nothing where a formulation has no say."""

_CYCLES = 20


class Verdict(StrEnum):
    """How a statement fares."""

    REPRODUCED = "reproduced"
    PARTLY = "partly"
    NOT = "not reproduced"
    UNTESTABLE = "not testable"


@dataclass(frozen=True)
class Claim:
    """A checkable statement.

    Attributes:
        id: short and lasting.
        source: where it stands in the paper.
        claim: the statement, in our words.
        paper: the paper's value, with its unit.
        printed, consistent: the values with either formulation, in the same unit.
        verdict: how it fares.
        why: the reason, in a sentence or two.
    """

    id: str
    source: str
    claim: str
    paper: str
    printed: Value
    consistent: Value
    verdict: Verdict
    why: str


def judge(holds: bool, partly: bool = False) -> Verdict:
    """Reproduced, partly, or not."""
    if holds:
        return Verdict.REPRODUCED
    return Verdict.PARTLY if partly else Verdict.NOT


def _claim(name: str, values: Iterable[Value], verdict: Verdict, **numbers: float | str) -> Claim:
    """A statement with its verdict; `values`: printed and consistent; `numbers` fill in its words."""
    words = TEXTS["claims"][name]
    paper, why = words["paper"].format(**numbers), words["why"].format(**numbers)
    printed, consistent = values
    return Claim(name, words["source"], words["claim"], paper, printed, consistent, verdict, why)


def of_table_two(study: Simulated) -> Iterator[Claim]:
    """Table II: loads, frequencies, cut-offs, ratios."""
    points, n2 = study.plate, [(point.rpm / 60) ** 2 for point in study.plate]
    loads, frequencies = [point.load_g for point in points], [_first(point) for point in points]
    exact = all(round(load) == row.load for load, row in zip(loads, TABLE_II, strict=True))
    yield _claim("T2-loads", (loads, loads), judge(exact))
    worst = 100 * max(abs(f / row.frequency - 1) for f, row in zip(frequencies, TABLE_II, strict=True))
    yield _claim("T2-frequencies", (frequencies, frequencies), judge(worst <= 0.1), worst=worst)
    slope = (frequencies[-1] ** 2 - frequencies[0] ** 2) / (n2[-1] - n2[0])
    theirs = (TABLE_II[-1].frequency ** 2 - TABLE_II[0].frequency ** 2) / (n2[-1] - n2[0])
    yield _claim("T2-stiffening", (slope, slope), judge(abs(slope / theirs - 1) < 0.01), slope=theirs)
    own = study.rest_hz
    back = [math.sqrt(r.frequency**2 - f**2 + own**2) for r, f in zip(TABLE_II, frequencies, strict=True)]
    verdict = judge(abs(own / 198 - 1) < 1e-3, partly=abs(own / 198 - 1) < 1e-2)
    yield _claim("T2-rest", (own, own), verdict, printed=sum(back) / len(back), own=own)
    yield from _cutoffs(study, loads)
    yield _with_tilt(study)


def _cutoffs(study: Simulated, loads: list[float]) -> Iterator[Claim]:
    printed, consistent = ([_cutoff(point) for point in study.points[f]] for f in FORMULATIONS)
    ratios = [[c / load for c, load in zip(cut, loads, strict=True)] for cut in (printed, consistent)]
    damping = study.plate[0].damper
    decay = 1 / math.sqrt(1 - damping.intrinsic_sdc) if damping else 1.0
    # As close to the table's as two cycles resolve.
    resolved = [abs(math.log(c / r.cutoff)) <= 2 * math.log(decay) for c, r in zip(consistent, TABLE_II, strict=True)]
    yield _claim("T2-cutoff-high", (printed[2:], consistent[2:]), judge(all(resolved[2:])), decay=decay, both=decay**2)
    yield _claim("T2-cutoff-low", (printed[:2], consistent[:2]), judge(all(resolved[:2]), partly=resolved[1]))
    high = [ratio[2:] for ratio in ratios]
    yield _claim("T2-ratio", high, judge(all(map(_near_a_tenth, high[0] + high[1]))))
    rises = judge(sorted(consistent) == consistent and sorted(printed) == printed)
    yield _claim("T2-cutoff-rises", (printed[-1] / printed[0], consistent[-1] / consistent[0]), rises)
    taken, moves = [_taken(point) for point in study.plate], all(map(_near_a_tenth, ratios[1]))
    verdict = judge(moves and min(taken) >= SDC_RANGE[0], partly=moves)
    most, effective = 100 * max(taken), 100 * SDC_RANGE[0]
    yield _claim("A-effective", (min(ratios[0]), min(ratios[1])), verdict, most=most, effective=effective)


def _with_tilt(study: Simulated) -> Claim:
    """The cut-offs of the blade itself, whose floor tilts as it bends."""
    points = study.plate
    ratios = [math.nan if p.tilted is None or p.tilted.ratio is None else p.tilted.ratio for p in points]
    tilted, flat = ([_in_a_cycle(p.working) for p in points], [_in_a_cycle(p.level) for p in points])
    shares = {"least": points[0].tilt_share, "most": points[-1].tilt_share}
    shares |= {"level_low": flat[0], "level_high": flat[-1], "tilted_low": tilted[0], "tilted_high": tilted[-1]}
    percents = {name: significant(100 * share, 2) for name, share in shares.items()}
    return _claim("T2-tilt", (None, ratios), judge(all(map(_near_a_tenth, ratios))), **percents)


def _in_a_cycle(figures: Figures | None) -> float:
    """Share of a cycle's energy that the largest damping ratio takes."""
    return 0.0 if figures is None else -math.expm1(-4 * math.pi * figures.peak)


def _first(point: SpeedPoint) -> float:
    return next(mode.frequency_hz for mode in point.modes if mode.family == "flap")


def _near_a_tenth(ratio: float) -> bool:
    return 0.09 <= ratio <= 0.112


def _taken(point: SpeedPoint) -> float:
    """Most that a cycle loses beyond what the structure's own damping takes [-]."""
    if point.damper is None or point.damper.peak_sdc is None:
        return 0.0
    return point.damper.peak_sdc - point.damper.intrinsic_sdc


def _cutoff(point: SpeedPoint) -> float:
    if point.damper is None or point.damper.cutoff_g is None:
        return math.nan
    return point.damper.cutoff_g


def of_equations(study: Simulated) -> Iterator[Claim]:
    """Sections I and II: rolling and sliding, impacts, sticking, time steps, the measure of damping."""
    demands = [[p.damper.largest_rolling_demand or 0.0 for p in study.points[f] if p.damper] for f in FORMULATIONS]
    friction = study.scene.damper.friction if study.scene.damper else 0.0
    rolls = judge(max(demands[1]) <= friction, partly=min(demands[1]) <= friction)
    yield _claim("S1-rolls", (max(demands[0]), max(demands[1])), rolls, friction=friction)
    ratios = [_threshold(study, formulation) for formulation in FORMULATIONS]
    yield _claim("S2-threshold", ratios, judge(all(abs(ratio / 0.1 - 1) < 1e-9 for ratio in ratios)))
    momentum, restitution, losses, caps = zip(*(_hits(study, f) for f in FORMULATIONS), strict=True)
    yield _claim("S2-momentum", momentum, judge(max(momentum) < 1e-9))
    yield _claim("S2-restitution", restitution, judge(max(abs(r - 0.5) for r in restitution) < 1e-9))
    yield _claim("S2-cap", losses, judge(min(losses) >= 0), capped=caps[1])
    yield _sticking(study)
    yield _steps(study)
    energies = [damping.energy if (damping := study.points[f][SHOWN].damper) else None for f in FORMULATIONS]
    shares = [energy.impact / (energy.impact + energy.rolling) if energy else math.nan for energy in energies]
    yield _claim("S2-measure", shares, judge(shares[1] > 0.99, partly=shares[1] > 0.1))
    gains = [100 * gain(study.system(formulation, damping_ratio=0.0)) for formulation in FORMULATIONS]
    yield _claim("S2-energy", gains, judge(max(gains) < 0, partly=gains[1] < 0))
    base = study.system("consistent", damping_ratio=0.0)
    change = gain(replace(base, floor_friction=base.friction), loss=True) / gain(base, loss=True) - 1
    yield _claim("S2-rotation", (None, change), judge(abs(change) <= 0.01))


def gain(system: ParticleDamper, *, loss: bool = False) -> float:
    """Energy after 20 cycles over that at the release, less one; or the loss, one less it."""
    from damper import ringdown

    energy = ringdown(system, RELEASE, _CYCLES).energy
    ratio = energy.final / energy.initial
    return 1 - ratio if loss else ratio - 1


def _threshold(study: Simulated, formulation: str) -> float:
    """Acceleration at which the ball sets off over the load; NaN where it does not, or sets off below."""
    from damper import ringdown

    system = study.system(formulation, damping_ratio=0.0)
    square = system.stuck_frequency**2
    amplitude = system.rolling_threshold / square
    still = ringdown(system, (amplitude * (1 - 1e-9), 0.0), 3).events == 0
    moves = ringdown(system, (amplitude * (1 + 1e-6), 0.0), 3).events > 0
    return amplitude * square / system.centrifugal_acceleration if still and moves else math.nan


def _hits(study: Simulated, formulation: str) -> tuple[float, float, float, int]:
    """Over single oblique hits: worst momentum, restitution farthest from e, least loss, hits at the cap."""
    from damper import ringdown, sample

    base = study.system(formulation, centrifugal_acceleration=0.0, damping_ratio=0.0, stiffness=(1e-9, 1e-9))
    m2, ball, gap = base.modal_mass, base.ball_mass, base.half_gap[0]
    system = replace(base, cavity=(base.cavity[0], 1.0), sticking_ratio=0.0)
    worst, farthest, least, capped = 0.0, base.restitution, math.inf, 0
    for angle in np.linspace(0.02, 1.5, 40):
        w = (math.cos(angle), math.sin(angle))
        duration = 1.5 * gap / w[0]
        cycles = duration * system.stuck_frequency / (2 * math.pi)
        run = ringdown(system, (0.0, 0.0), cycles, ball_velocity=w, keep_events=True)
        end = sample(run, run.duration)
        after, v = end.relative_velocity[0], end.velocity[0]
        for axis in range(2):
            worst = max(worst, abs(m2 * v[axis] + ball * (v[axis] + after[axis]) - ball * w[axis]) / ball)
        ratio = -after[0] / w[0]
        if abs(ratio - base.restitution) > abs(farthest - base.restitution):
            farthest = float(ratio)
        least = min(least, run.energy.impact)
        capped += abs(after[1]) < 1e-9
    return worst, farthest, least, capped


def _sticking(study: Simulated) -> Claim:
    from damper import capacity, ringdown

    changes, fewer = [], []
    for formulation in FORMULATIONS:
        systems = [study.system(formulation, sticking_ratio=epsilon) for epsilon in (1e-2, 1e-6)]
        runs = [ringdown(system, RELEASE, _CYCLES) for system in systems]
        part = [float(capacity(run).sdc.mean()) for run in runs]
        lossless = 1 - runs[1].energy.final / runs[1].energy.initial == 0
        changes.append(math.nan if lossless else abs(part[0] / part[1] - 1))
        fewer.append(1 - runs[0].impacts / runs[1].impacts)
    verdict = judge(max(changes) < 1e-2 and min(fewer) > 0.1, partly=max(changes) < 1e-2)
    return _claim("S2-epsilon", changes, verdict, saved=100 * fewer[1])


def _steps(study: Simulated) -> Claim:
    from damper import capacity, ringdown, stepped_ringdown

    systems = [study.system(formulation, damping_ratio=0.0) for formulation in FORMULATIONS]
    exact = [float(capacity(ringdown(system, RELEASE, _CYCLES)).sdc.mean()) for system in systems]
    stepped = [float(stepped_ringdown(system, RELEASE, _CYCLES, 40).sdc.mean()) for system in systems]
    verdict = judge(all(abs(s / e - 1) < 0.1 for s, e in zip(stepped, exact, strict=True)))
    shown = {"printed": 100 * exact[0], "consistent": 100 * exact[1]}
    return _claim("S2-steps", (100 * stepped[0], 100 * stepped[1]), verdict, **shown)


def of_figures(study: Simulated, sweeps: Sweeps) -> Iterator[Claim]:
    """Section III, figures 2 to 7: the ball over load, mass, cavity, release and radius."""
    yield _decay(study)
    yield from _over_load(sweeps.load)
    levels = _levels(sweeps.mass)
    fits = [_linearity(MASS_RATIOS, values) for values in levels]
    yield _claim("F4-linear", fits, judge(fits[1] > 0.99, partly=fits[1] > 0.9))
    growth = [values[-1] / values[0] for values in levels]
    yield _claim("F4-rises", growth, judge(growth[1] > 1))
    yield from _over_cavity(sweeps.cavity)
    spread, own = _overlaps(sweeps.release, total=True), _overlaps(sweeps.release, total=False)
    yield _claim("F6-weak", (100 * spread[0], 100 * spread[1]), judge(0 < spread[1] < 0.05), own=100 * own[1])
    ratios = [values[-1] / values[0] for values in _levels(sweeps.radius)]
    yield _claim("F7-radius", ratios, judge(0.8 < ratios[1] < 1.25))
    yield _claim("A-experiments", (None, None), Verdict.UNTESTABLE)


def _decay(study: Simulated) -> Claim:
    dampings = [study.points[f][SHOWN].damper for f in FORMULATIONS]
    ends = [100 * damping.energy.ball_share if damping else 0.0 for damping in dampings]
    decays = dampings[1] is not None and _cycles_to_decay(dampings[1].peak_velocity) < 100
    return _claim("F2-decay", ends, judge(decays and ends[1] > 50, partly=decays))


def _over_load(family: Family) -> Iterator[Claim]:
    peaks, levels = _peaks(family), _levels(family)
    curve = family["consistent"][0]
    own = 100 * float(curve.sdc[-1] - curve.ball[-1])
    yield _claim("F3-level", peaks, judge(min(peaks[1]) >= 14), own=own)
    drop = [values[0] - values[-1] for values in levels]
    falls = all(a > b for a, b in zip(levels[1], levels[1][1:], strict=False))
    yield _claim("F3-trend", drop, judge(falls and drop[1] > 1, partly=falls))
    after = [max(abs(float(c.ball[-1])) for c in family[f]) for f in FORMULATIONS]
    yield _claim("F3-stops", after, judge(max(after) < 1e-9))


def _over_cavity(family: Family) -> Iterator[Claim]:
    levels = _levels(family)
    changes, totals = ([100 * (v[-1] / v[0] - 1) for v in values] for values in (levels, _peaks(family)))
    verdict = judge(abs(changes[1]) <= 5, partly=abs(totals[1]) <= 5)
    yield _claim("F5-weak", changes, verdict, total=totals[1])
    yield _claim("F5-sense", (v[0] / v[-1] for v in levels), judge(levels[1][0] >= levels[1][-1]))
    spread = _overlaps(family, total=True)
    verdict = judge(spread[1] < 0.02, partly=spread[1] < 0.1)
    yield _claim("F5-overlap", (100 * spread[0], 100 * spread[1]), verdict)


def _cycles_to_decay(peaks: Floats) -> float:
    """After how many cycles the velocity has fallen to 1/e; infinite where the run ends before."""
    fallen = np.flatnonzero(peaks < peaks[0] / math.e)
    return float(fallen[0]) if len(fallen) else math.inf


def _peaks(family: Family) -> list[list[float]]:
    return [[100 * float(c.sdc.max()) for c in family[f]] for f in FORMULATIONS]


def _levels(family: Family) -> list[list[float]]:
    return [[100 * level(c) for c in family[f]] for f in FORMULATIONS]


def _linearity(x: tuple[float, ...], y: list[float]) -> float:
    """R² of the best line."""
    r = np.corrcoef(x, y)[0, 1]
    return float(r * r)


def _overlaps(family: Family, *, total: bool) -> list[float]:
    return [_overlap(family[formulation], total=total) for formulation in FORMULATIONS]


def _overlap(curves: list[DampingCurve], *, total: bool) -> float:
    """Mean over amplitudes that all curves reach of their spread over their mean, interpolated."""
    parts = [moving(curve) for curve in curves]
    low = max(float(part.amplitude_g.min()) for part in parts)
    high = min(float(part.amplitude_g.max()) for part in parts)
    amplitudes = np.linspace(low, high, 50)
    values = np.array([np.interp(amplitudes, p.amplitude_g[::-1], (p.sdc if total else p.ball)[::-1]) for p in parts])
    return float(np.mean(np.ptp(values, axis=0) / np.abs(values.mean(axis=0))))


@dataclass(frozen=True)
class Slip:
    """What is wrong, the number that shows it, and what that number is."""

    where: str
    slip: str
    value: float
    unit: str
    meaning: str


def slips(study: Simulated) -> tuple[Slip, ...]:
    """The slips, in the order of the paper."""
    from damper import ball_density

    printed, consistent = study.system("printed"), study.system("consistent")
    undamped = study.system("printed", damping_ratio=0.0)
    lossless = replace(undamped, rolling_friction=0.0, friction=0.0, restitution=1.0, sticking_ratio=0.0)
    slowest, shown = study.plate[0].modes[0].frequency_hz, study.plate[SHOWN]
    values = (
        printed.inertia_ratio / consistent.inertia_ratio,
        100 * gain(lossless),
        100 * gain(undamped),
        1e3 * (RELEASE[0] - RELEASE[1]),
        math.sqrt(TABLE_II[0].frequency ** 2 - (slowest**2 - study.rest_hz**2)),
        100 * (shown.omega**2 * shown.radius / 9.80665 / TABLE_II[SHOWN].load - 1),
        ball_density(consistent, 1) / OSMIUM,
        100 * shown.tilt_share,
    )
    return tuple(Slip(value=value, **words) for value, words in zip(values, TEXTS["slips"], strict=True))


_CYCLES = 20
_STEPS = 40


@dataclass(frozen=True)
class Assumption:
    """An unprinted assumption and its source."""

    name: str
    text: str


ZETA, MASS, STEPS, SIGN, AMPLITUDE = (Assumption(name, text) for name, text in TEXTS["closure"].items())


@dataclass(frozen=True)
class Closure:
    """A line of the table: damping by everything in % of the energy a cycle, or None where it cannot be had."""

    assumptions: tuple[Assumption, ...]
    printed: float
    consistent: float
    work_bound: float


CASES: tuple[tuple[Assumption, ...], ...] = (
    (),
    (ZETA,),
    (MASS,),
    (STEPS,),
    (STEPS, SIGN),
    (AMPLITUDE,),
    (MASS, STEPS),
    (MASS, STEPS, SIGN),
    (ZETA, STEPS),
    (ZETA, MASS),
    (ZETA, MASS, STEPS),
    (ZETA, MASS, STEPS, SIGN, AMPLITUDE),
)


def closure(study: Simulated) -> tuple[Closure, ...]:
    """Damping at 21932 g and 20 mm, averaged over 20 cycles or those before rest, for every case."""
    table = []
    for case in CASES:
        printed, consistent = (_velocity(_system(study, formulation, case), case) for formulation in FORMULATIONS)
        bound = _bound(_system(study, "consistent", case), consistent)
        table.append(Closure(case, _damping(printed, case), _damping(consistent, case), bound))
    return tuple(table)


def _system(study: Simulated, formulation: str, case: tuple[Assumption, ...]) -> ParticleDamper:
    system = study.system(formulation, damping_ratio=0.01 if ZETA in case else 0.0)
    if MASS in case:
        scene, m2 = study.scene, system.modal_mass
        plate, material = scene.plate, scene.material
        if plate is None or material is None or plate.length is None or plate.width is None:
            raise ValueError("the paper's scene has a rectangular plate")
        whole = material.density * plate_mesh.volume(plate)[0]
        system = replace(system, ball_mass=system.ball_mass * whole / m2)
    return system


def _velocity(system: ParticleDamper, case: tuple[Assumption, ...]) -> Floats:
    """The structure's velocity along both axes, shape (cycles, times, 2) [m/s]."""
    from damper import ringdown, sample, stepped_ringdown

    if STEPS in case:
        run = stepped_ringdown(system, RELEASE, _CYCLES, _STEPS, friction_opposes_structure=SIGN in case)
        return run.velocity[1:].reshape(_CYCLES, _STEPS, 2)
    exact = ringdown(system, RELEASE, _CYCLES, keep_events=True)
    fine = 100 * _STEPS
    times = np.linspace(0, exact.duration, _CYCLES * fine + 1)[1:]
    return sample(exact, times).velocity.reshape(_CYCLES, fine, 2)


def _damping(velocity: Floats, case: tuple[Assumption, ...]) -> float:
    """Mean over the cycles of 1 - (V next / V)^2, in %."""
    peaks = np.abs(velocity[:, :, 0]).max(axis=1) if AMPLITUDE in case else _speeds(velocity)
    return 100 * float(np.mean(1 - (peaks[1:] / peaks[:-1]) ** 2))


def _bound(system: ParticleDamper, velocity: Floats) -> float:
    """Mean over the same cycles of the most that the ball can take, in %."""
    from damper import work_bound

    return 100 * float(np.mean([work_bound(system, v / system.stuck_frequency) for v in _speeds(velocity)[:-1]]))


def _speeds(velocity: Floats) -> Floats:
    return np.asarray(np.hypot(velocity[:, :, 0], velocity[:, :, 1]).max(axis=1))
