"""The paper's scene in both formulations, its statements judged by numbers, and which errors would explain them.

Their words are those of `templates/paper.toml`.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import pairwise
from typing import Any

import numpy as np

import damper
from workflows import pipeline
from workflows.effects.definition import Effect
from workflows.formatting import significant
from workflows.io.files import StudyResult
from workflows.progress import Stages
from workflows.report.templates import texts
from workflows.scene import load as scene_file
from workflows.scene import plate_mesh
from workflows.scene.materials import OSMIUM
from workflows.scene.paper import SDC_RANGE, TABLE_II
from workflows.scene.scene import Scene
from workflows.solve.damper import particle_damper, simulate
from workflows.solve.limits import energy_loss
from workflows.solve.results import Damping, Figures, Floats, SpeedPoint

FORMULATIONS = ("printed", "consistent")
SHOWN = 3
"""10000 rpm, or 21932 g, which the paper calls 22000 g and draws Figs. 2 and 4 to 7 for."""

RELEASE = (20e-3, 5e-3)

TEXTS = texts("paper")
"""Statements, errors and assumptions of the paper in words."""


@dataclass(frozen=True, eq=False)
class CapacityCurve:
    """One curve of a figure: a value per vibration cycle, from the release to rest.

    `amplitude_g` is the paper's Gamma, `ball` the capacity beyond the structure's own, `sdc` all of it.
    """

    label: str
    amplitude_g: Floats
    sdc: Floats
    ball: Floats
    cutoff_g: float | None


@dataclass(frozen=True, eq=False)
class PaperRun:
    """The paper's scene, its structure at the seven speeds, and the ring-downs there in both formulations."""

    scene: Scene
    effects: dict[str, Effect]
    points: dict[str, tuple[SpeedPoint, ...]]
    rest_hz: float

    @property
    def plate(self) -> tuple[SpeedPoint, ...]:
        """The seven speeds, consistent formulation; the structure is the same in both."""
        return self.points["consistent"]

    @property
    def dampings(self) -> list[list[Damping]]:
        """The ring-downs of each formulation at the seven speeds."""
        return [[point.damper for point in self.points[f] if point.damper is not None] for f in FORMULATIONS]

    def system(self, formulation: str, *, mass_ratio: float | None = None, **changes: Any) -> damper.ParticleDamper:
        """The damper that the run simulates at 10000 rpm, changed.

        Its stiffness is kept, so that curves differ by what was changed alone.
        """
        scene, point = self.scene.changed(damper={"formulation": formulation}), self.plate[SHOWN]
        if mass_ratio is not None and point.reduced is not None:
            changes["ball_mass"] = mass_ratio * point.reduced.M2
        return replace(particle_damper(scene, self.effects, point), **changes)

    def curve(self, label: str, system: damper.ParticleDamper, release: tuple[float, float] = RELEASE) -> CapacityCurve:
        """Ring a damper down to rest, cycle by cycle."""
        cycles, gravity = damper.capacity(damper.ringdown(system, release, max_cycles=20_000)), self.scene.rotor.gravity
        cutoff = None if cycles.cutoff is None else cycles.cutoff / gravity
        ball = cycles.sdc - cycles.intrinsic_sdc
        return CapacityCurve(label, cycles.amplitude / gravity, cycles.sdc, ball, cutoff)


def study(stages: Stages) -> PaperRun:
    """Solve the paper's plate once and ring both formulations down at every speed."""
    source = scene_file.load("paper")
    structure = pipeline.structure(source, stages, shapes=False)
    points = {}
    for formulation in FORMULATIONS:
        scene = source.scene.changed(damper={"formulation": formulation})
        points[formulation] = simulate(scene, structure.effects, structure.points, stages, SHOWN)
    at_rest = source.changed(rotor={"speeds": (0.0,)}, damper=None, release=None)
    rest_hz = pipeline.structure(at_rest, stages, shapes=False).points[0].modes[0].frequency_hz
    return PaperRun(source.scene, structure.effects, points, rest_hz)


def moving(curve: CapacityCurve) -> CapacityCurve:
    """The part of a curve in which the ball moved, the first cycle and the one of the cut-off left out."""
    level = curve.cutoff_g or 0.0
    keep = curve.amplitude_g > level * (1 + 1e-9)
    keep[0] = False
    return replace(curve, amplitude_g=curve.amplitude_g[keep], sdc=curve.sdc[keep], ball=curve.ball[keep])


def level(curve: CapacityCurve) -> float:
    """Average of the ball's part while it moved [-]."""
    part = moving(curve).ball
    return float(part.mean()) if len(part) else math.nan


Family = dict[str, list[CapacityCurve]]
"""Curves by formulation."""

MASS_RATIOS = (0.003, 0.006, 0.009, 0.012)
CLEARANCES = (0.25e-3, 0.5e-3, 0.75e-3, 1.0e-3, 1.25e-3)
RELEASES = (12e-3, 16e-3, 20e-3, 24e-3)
RADII = (0.6e-3, 0.8e-3, 1.0e-3, 1.1e-3)


def sweeps(study: PaperRun) -> dict[str, Family]:
    """The families of curves behind Figs. 3 to 7."""

    def varied(label: str, values: tuple[float, ...], changes: Callable[[float], dict[str, Any]]) -> Family:
        """A curve at 10000 rpm for each value, from its own release; the label shows it scaled."""
        family: Family = {formulation: [] for formulation in FORMULATIONS}
        for formulation, curves in family.items():
            for value in values:
                changed = changes(value)
                release = changed.pop("release", RELEASE)
                system = study.system(formulation, **changed)
                curves.append(study.curve(label.format(1e3 * value, 100 * value), system, release))
        return family

    load = {
        formulation: [
            CapacityCurve(f"{p.load_g:.0f} g", d.amplitude_g, d.sdc, d.sdc - d.intrinsic_sdc, d.cutoff_g)
            for p, d in zip(study.plate, dampings, strict=True)
        ]
        for formulation, dampings in zip(FORMULATIONS, study.dampings, strict=True)
    }
    return {
        "load": load,
        "mass": varied("{1:.1f} %", MASS_RATIOS, lambda ratio: {"mass_ratio": ratio}),
        "cavity": varied("{0:g} mm", CLEARANCES, lambda gap: {"mass_ratio": 0.012, "cavity": (2e-3 + gap, 2e-3 + gap)}),
        "release": varied("{0:g} mm", RELEASES, lambda x: {"release": (x, x / 4)}),
        "radius": varied("{0:g} mm", RADII, lambda radius: {"mass_ratio": 0.01, "ball_radius": radius}),
    }


Value = float | int | list[float] | None
"""A number, several, or nothing where a formulation has no say."""

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


def of_table_two(study: PaperRun) -> Iterator[Claim]:
    """Table II: loads, frequencies, cut-offs, ratios."""
    points, n2 = study.plate, [(point.rpm / 60) ** 2 for point in study.plate]
    loads = [point.load_g for point in points]
    frequencies = [next(mode.frequency_hz for mode in point.modes if mode.family == "flap") for point in points]
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
    # The blade itself, whose floor tilts as it bends.
    known = [None if p.damping_curve is None else p.damping_curve.tilted_cutoff_ratio for p in points]
    ratios = [math.nan if ratio is None else ratio for ratio in known]
    tilted, flat = ([_in_a_cycle(p.damping_curve) for p in points], [_in_a_cycle(p.level) for p in points])
    shares = {"least": points[0].tilt_share, "most": points[-1].tilt_share}
    shares |= {"level_low": flat[0], "level_high": flat[-1], "tilted_low": tilted[0], "tilted_high": tilted[-1]}
    percents = {name: significant(100 * share, 2) for name, share in shares.items()}
    yield _claim("T2-tilt", (None, ratios), judge(all(map(_near_a_tenth, ratios))), **percents)


def _cutoffs(study: PaperRun, loads: list[float]) -> Iterator[Claim]:
    cutoffs = [[math.nan if d.cutoff_g is None else d.cutoff_g for d in each] for each in study.dampings]
    ratios = [[cutoff / load for cutoff, load in zip(each, loads, strict=True)] for each in cutoffs]
    printed, consistent = cutoffs
    ring_downs = study.dampings[1]
    decay = 1 / math.sqrt(1 - ring_downs[0].intrinsic_sdc)
    # As close to the table's as two cycles resolve.
    resolved = [abs(math.log(c / r.cutoff)) <= 2 * math.log(decay) for c, r in zip(consistent, TABLE_II, strict=True)]
    yield _claim("T2-cutoff-high", (printed[2:], consistent[2:]), judge(all(resolved[2:])), decay=decay, both=decay**2)
    yield _claim("T2-cutoff-low", (printed[:2], consistent[:2]), judge(all(resolved[:2]), partly=resolved[1]))
    high = [ratio[2:] for ratio in ratios]
    yield _claim("T2-ratio", high, judge(all(map(_near_a_tenth, high[0] + high[1]))))
    rises = judge(sorted(consistent) == consistent and sorted(printed) == printed)
    yield _claim("T2-cutoff-rises", (printed[-1] / printed[0], consistent[-1] / consistent[0]), rises)
    # Most that a cycle of the ring-down loses beyond what the structure's own damping takes.
    most = [0.0 if d.peak_sdc is None else d.peak_sdc - d.intrinsic_sdc for d in ring_downs]
    moves = all(map(_near_a_tenth, ratios[1]))
    verdict = judge(moves and min(most) >= SDC_RANGE[0], partly=moves)
    percents = {"most": 100 * max(most), "effective": 100 * SDC_RANGE[0]}
    yield _claim("A-effective", (min(ratios[0]), min(ratios[1])), verdict, **percents)


def _in_a_cycle(figures: Figures | None) -> float:
    """Share of a cycle's energy that the largest damping ratio takes."""
    return 0.0 if figures is None else energy_loss(figures.peak)


def _near_a_tenth(ratio: float) -> bool:
    return 0.09 <= ratio <= 0.112


def of_equations(study: PaperRun) -> Iterator[Claim]:
    """Sections I and II: rolling and sliding, impacts, sticking, time steps, the measure of damping."""
    demands = [[damping.largest_rolling_demand or 0.0 for damping in each] for each in study.dampings]
    friction = study.system("consistent").friction
    rolls = judge(max(demands[1]) <= friction, partly=min(demands[1]) <= friction)
    yield _claim("S1-rolls", (max(demands[0]), max(demands[1])), rolls, friction=friction)
    ratios = [_threshold(study, formulation) for formulation in FORMULATIONS]
    yield _claim("S2-threshold", ratios, judge(all(abs(ratio / 0.1 - 1) < 1e-9 for ratio in ratios)))
    momentum, restitution, losses, caps = zip(*(_hits(study, f) for f in FORMULATIONS), strict=True)
    yield _claim("S2-momentum", momentum, judge(max(momentum) < 1e-9))
    yield _claim("S2-restitution", restitution, judge(max(abs(r - 0.5) for r in restitution) < 1e-9))
    yield _claim("S2-cap", losses, judge(min(losses) >= 0 and min(caps) > 0), printed=caps[0], capped=caps[1])
    yield _sticking(study)
    yield _steps(study)
    energies = [each[SHOWN].energy for each in study.dampings]
    shares = [energy.impact / (energy.impact + energy.rolling) for energy in energies]
    yield _claim("S2-measure", shares, judge(shares[1] > 0.99, partly=shares[1] > 0.1))
    gains = [100 * gain(study.system(formulation, damping_ratio=0.0)) for formulation in FORMULATIONS]
    yield _claim("S2-energy", gains, judge(max(gains) < 0, partly=gains[1] < 0))
    base = study.system("consistent", damping_ratio=0.0)
    change = gain(replace(base, floor_friction=base.friction)) / gain(base) - 1
    yield _claim("S2-rotation", (None, change), judge(abs(change) <= 0.01))


def gain(system: damper.ParticleDamper) -> float:
    """Energy after 20 cycles over that at the release, less one."""
    energy = damper.ringdown(system, RELEASE, _CYCLES).energy
    return energy.final / energy.initial - 1


def _threshold(study: PaperRun, formulation: str) -> float:
    """Acceleration at which the ball sets off over the load; NaN where it does not, or sets off below."""
    system = study.system(formulation, damping_ratio=0.0)
    square = system.stuck_frequency**2
    amplitude = system.rolling_threshold / square
    still = damper.ringdown(system, (amplitude * (1 - 1e-9), 0.0), 3).events == 0
    moves = damper.ringdown(system, (amplitude * (1 + 1e-6), 0.0), 3).events > 0
    return amplitude * square / system.centrifugal_acceleration if still and moves else math.nan


def _hits(study: PaperRun, formulation: str) -> tuple[float, float, float, int]:
    """Over single oblique hits: worst momentum, restitution farthest from e, least loss, hits at the cap."""
    base = study.system(formulation, centrifugal_acceleration=0.0, damping_ratio=0.0, stiffness=(1e-9, 1e-9))
    m2, ball, gap = base.modal_mass, base.ball_mass, base.half_gap[0]
    system = replace(base, cavity=(base.cavity[0], 1.0), sticking_ratio=0.0)
    worst, farthest, least, capped = 0.0, base.restitution, math.inf, 0
    # Where friction ends the sliding, the printed equations stop the centre; a solid sphere rolls on along the wall.
    rolls = 0.0 if formulation == "printed" else 1 - (1 / m2 + 1 / ball) / (1 / m2 + 3.5 / ball)
    for angle in np.linspace(0.02, 1.5, 40):
        w = (math.cos(angle), math.sin(angle))
        duration = 1.5 * gap / w[0]
        cycles = duration * system.stuck_frequency / (2 * math.pi)
        run = damper.ringdown(system, (0.0, 0.0), cycles, ball_velocity=w, keep_events=True)
        end = damper.sample(run, run.duration)
        after, v = end.relative_velocity[0], end.velocity[0]
        for axis in range(2):
            worst = max(worst, abs(m2 * v[axis] + ball * (v[axis] + after[axis]) - ball * w[axis]) / ball)
        ratio = -after[0] / w[0]
        if abs(ratio - base.restitution) > abs(farthest - base.restitution):
            farthest = float(ratio)
        least = min(least, run.energy.impact)
        capped += abs(after[1] - rolls * w[1]) < 1e-9
    return worst, farthest, least, capped


def _sticking(study: PaperRun) -> Claim:
    changes, fewer = [], []
    for formulation in FORMULATIONS:
        systems = [study.system(formulation, sticking_ratio=epsilon) for epsilon in (1e-2, 1e-6)]
        runs = [damper.ringdown(system, RELEASE, _CYCLES) for system in systems]
        part = [float(damper.capacity(run).sdc.mean()) for run in runs]
        lossless = 1 - runs[1].energy.final / runs[1].energy.initial == 0
        changes.append(math.nan if lossless else abs(part[0] / part[1] - 1))
        fewer.append(1 - runs[0].impacts / runs[1].impacts)
    verdict = judge(max(changes) < 1e-2 and min(fewer) > 0.1, partly=max(changes) < 1e-2)
    return _claim("S2-epsilon", changes, verdict, saved=100 * fewer[1])


def _steps(study: PaperRun) -> Claim:
    systems = [study.system(formulation, damping_ratio=0.0) for formulation in FORMULATIONS]
    exact = [float(damper.capacity(damper.ringdown(system, RELEASE, _CYCLES)).sdc.mean()) for system in systems]
    stepped = [float(damper.stepped_ringdown(system, RELEASE, _CYCLES, 40).sdc.mean()) for system in systems]
    verdict = judge(all(abs(s / e - 1) < 0.1 for s, e in zip(stepped, exact, strict=True)))
    shown = {"printed": 100 * exact[0], "consistent": 100 * exact[1]}
    return _claim("S2-steps", (100 * stepped[0], 100 * stepped[1]), verdict, **shown)


def of_figures(study: PaperRun, sweeps: dict[str, Family]) -> Iterator[Claim]:
    """Section III, figures 2 to 7: the ball over load, mass, cavity, release and radius."""
    dampings = [each[SHOWN] for each in study.dampings]
    ends = [100 * damping.energy.ball_share for damping in dampings]
    peaks = dampings[1].peak_velocity
    decays = bool((peaks[:100] < peaks[0] / math.e).any())
    yield _claim("F2-decay", ends, judge(decays and ends[1] > 50, partly=decays))

    tops, levels = _peaks(sweeps["load"]), _levels(sweeps["load"])
    curve = sweeps["load"]["consistent"][0]
    own = 100 * float(curve.sdc[-1] - curve.ball[-1])
    yield _claim("F3-level", tops, judge(min(tops[1]) >= 14), own=own)
    drop = [values[0] - values[-1] for values in levels]
    falls = all(a > b for a, b in pairwise(levels[1]))
    yield _claim("F3-trend", drop, judge(falls and drop[1] > 1, partly=falls))
    after = [max(abs(float(c.ball[-1])) for c in sweeps["load"][f]) for f in FORMULATIONS]
    yield _claim("F3-stops", after, judge(max(after) < 1e-9))

    levels = _levels(sweeps["mass"])
    fits = [float(np.corrcoef(MASS_RATIOS, values)[0, 1]) ** 2 for values in levels]  # R² of the best line
    yield _claim("F4-linear", fits, judge(fits[1] > 0.99, partly=fits[1] > 0.9))
    growth = [values[-1] / values[0] for values in levels]
    yield _claim("F4-rises", growth, judge(growth[1] > 1))

    levels = _levels(sweeps["cavity"])
    changes, totals = ([100 * (v[-1] / v[0] - 1) for v in values] for values in (levels, _peaks(sweeps["cavity"])))
    verdict = judge(abs(changes[1]) <= 5, partly=abs(totals[1]) <= 5)
    yield _claim("F5-weak", changes, verdict, total=totals[1])
    yield _claim("F5-sense", (v[0] / v[-1] for v in levels), judge(levels[1][0] >= levels[1][-1]))
    spread = _overlaps(sweeps["cavity"], total=True)
    verdict = judge(spread[1] < 0.02, partly=spread[1] < 0.1)
    yield _claim("F5-overlap", (100 * spread[0], 100 * spread[1]), verdict)

    spread, ball = _overlaps(sweeps["release"], total=True), _overlaps(sweeps["release"], total=False)
    yield _claim("F6-weak", (100 * spread[0], 100 * spread[1]), judge(0 < spread[1] < 0.05), own=100 * ball[1])
    ratios = [values[-1] / values[0] for values in _levels(sweeps["radius"])]
    yield _claim("F7-radius", ratios, judge(0.8 < ratios[1] < 1.25))
    yield _claim("A-experiments", (None, None), Verdict.UNTESTABLE)


def _peaks(family: Family) -> list[list[float]]:
    return [[100 * float(c.sdc.max()) for c in family[f]] for f in FORMULATIONS]


def _levels(family: Family) -> list[list[float]]:
    return [[100 * level(c) for c in family[f]] for f in FORMULATIONS]


def _overlaps(family: Family, *, total: bool) -> list[float]:
    """Mean over amplitudes that all curves reach of their spread over their mean, interpolated."""
    overlaps = []
    for formulation in FORMULATIONS:
        parts = [moving(curve) for curve in family[formulation]]
        low = max(float(part.amplitude_g.min()) for part in parts)
        high = min(float(part.amplitude_g.max()) for part in parts)
        at = np.linspace(low, high, 50)
        values = np.array([np.interp(at, p.amplitude_g[::-1], (p.sdc if total else p.ball)[::-1]) for p in parts])
        overlaps.append(float(np.mean(np.ptp(values, axis=0) / np.abs(values.mean(axis=0)))))
    return overlaps


@dataclass(frozen=True)
class PaperError:
    """What is wrong, the number that shows it, and what that number is."""

    where: str
    slip: str
    value: float
    unit: str
    meaning: str


def paper_errors(study: PaperRun) -> tuple[PaperError, ...]:
    """Errors in the paper, in its order."""
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
        damper.ball_density(consistent, 1) / OSMIUM,
        100 * shown.tilt_share,
    )
    return tuple(PaperError(value=value, **words) for value, words in zip(values, TEXTS["slips"], strict=True))


_STEPS = 40


@dataclass(frozen=True)
class Assumption:
    """An unprinted assumption and its source."""

    name: str
    text: str


@dataclass(frozen=True)
class Closure:
    """A line of the table: damping by everything in % of the energy a cycle, or None where it is not defined."""

    assumptions: tuple[Assumption, ...]
    printed: float
    consistent: float
    work_bound: float


def closure(study: PaperRun) -> tuple[Closure, ...]:
    """Damping at 21932 g and 20 mm, averaged over 20 cycles or those before rest, for every case."""
    table = []
    for case in TEXTS["cases"]["closure"]:
        systems = [_system(study, formulation, case) for formulation in FORMULATIONS]
        printed, consistent = (_velocity(system, case) for system in systems)
        speeds = _speeds(consistent)[:-1] / systems[1].stuck_frequency
        bound = 100 * float(np.mean([damper.work_bound(systems[1], amplitude) for amplitude in speeds]))
        assumptions = tuple(Assumption(name, TEXTS["closure"][name]) for name in case)
        table.append(Closure(assumptions, _damping(printed, case), _damping(consistent, case), bound))
    return tuple(table)


def _system(study: PaperRun, formulation: str, case: list[str]) -> damper.ParticleDamper:
    system = study.system(formulation, damping_ratio=0.01 if "ζ" in case else 0.0)
    plate, material = study.scene.plate, study.scene.material
    if "mass" in case and plate is not None and material is not None:
        whole = material.density * plate_mesh.volume(plate)[0]
        system = replace(system, ball_mass=system.ball_mass * whole / system.modal_mass)
    return system


def _velocity(system: damper.ParticleDamper, case: list[str]) -> Floats:
    """The structure's velocity along both axes, shape (cycles, times, 2) [m/s]."""
    if "steps" in case:
        run = damper.stepped_ringdown(system, RELEASE, _CYCLES, _STEPS, friction_opposes_structure="sign" in case)
        return run.velocity[1:].reshape(_CYCLES, _STEPS, 2)
    exact = damper.ringdown(system, RELEASE, _CYCLES, keep_events=True)
    fine = 100 * _STEPS
    times = np.linspace(0, exact.duration, _CYCLES * fine + 1)[1:]
    return damper.sample(exact, times).velocity.reshape(_CYCLES, fine, 2)


def _damping(velocity: Floats, case: list[str]) -> float:
    """Mean over the cycles of 1 - (V next / V)^2, in %."""
    peaks = np.abs(velocity[:, :, 0]).max(axis=1) if "component" in case else _speeds(velocity)
    return 100 * float(np.mean(1 - (peaks[1:] / peaks[:-1]) ** 2))


def _speeds(velocity: Floats) -> Floats:
    return np.asarray(np.hypot(velocity[:, :, 0], velocity[:, :, 1]).max(axis=1))


@dataclass(frozen=True, eq=False, repr=False)
class Reproduction(StudyResult):
    """Everything the report shows."""

    REPORT = "workflows.studies.reproduction_report"
    study: PaperRun
    sweeps: dict[str, Family]
    claims: tuple[Claim, ...]
    slips: tuple[PaperError, ...]
    closure: tuple[Closure, ...]

    @property
    def count(self) -> dict[Verdict, int]:
        """How many claims got which verdict."""
        counts = Counter(claim.verdict for claim in self.claims)
        return {verdict: counts[verdict] for verdict in Verdict}


def reproduce(stages: Stages | None = None) -> Reproduction:
    """Judge every claim; nothing is written."""
    stages = stages or Stages()
    simulated = study(stages)
    with stages("damper"):
        curves = sweeps(simulated)
        claims = (*of_table_two(simulated), *of_equations(simulated), *of_figures(simulated, curves))
        return Reproduction(simulated, curves, claims, paper_errors(simulated), closure(simulated))
