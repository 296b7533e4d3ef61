"""What figures 2 to 7 claim: the ball over load, mass, cavity, release and radius."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from workflows.studies.reproduction.claims import (
    FORMULATIONS,
    MASS_RATIOS,
    SHOWN,
    Claim,
    DampingCurve,
    Family,
    Floats,
    Simulated,
    Sweeps,
    Verdict,
    judge,
    level,
    moving,
)


def claims(study: Simulated, found: Sweeps) -> Iterator[Claim]:
    """The claims of section III."""
    yield _fig2(study)
    yield from _fig3(found.load)
    yield from _fig4(found.mass)
    yield from _fig5(found.cavity)
    yield from _fig6(found.release)
    yield from _fig7(found.radius)
    yield Claim(
        "A-experiments",
        "abstract, III.A",
        "The results agree considerably well with the scarce experiments (Flint 1999; Flint et al. 2000).",
        "—",
        None,
        None,
        Verdict.UNTESTABLE,
        "Not computed: the paper prints no measured value, geometry or load of those experiments.",
    )


def _peaks(family: Family) -> list[list[float]]:
    return [[100 * float(c.sdc.max()) for c in family[f]] for f in FORMULATIONS]


def _levels(family: Family) -> list[list[float]]:
    return [[100 * level(c) for c in family[f]] for f in FORMULATIONS]


def _fig2(study: Simulated) -> Claim:
    dampings = [study.points[f][SHOWN].damping for f in FORMULATIONS]
    ends = [100 * damping.energy.ball_share if damping else 0.0 for damping in dampings]
    decays = dampings[1] is not None and _cycles_to_decay(dampings[1].peak_velocity) < 100
    return Claim(
        "F2-decay",
        "Fig. 2",
        "At 10000 rpm the particle damper makes the velocity decay.",
        "a decay within tens of cycles",
        ends[0],
        ends[1],
        judge(decays and ends[1] > 50, partly=decays),
        "Share of the ball in the energy lost, in %: the velocity decays as in the figure, by the structure's own"
        " damping ζ = 0.01, which is our assumption.",
    )


def _cycles_to_decay(peaks: Floats) -> float:
    """After how many cycles the velocity has fallen to 1/e; infinite where the run ends before."""
    fallen = np.flatnonzero(peaks < peaks[0] / math.e)
    return float(fallen[0]) if len(fallen) else math.inf


def _fig3(family: Family) -> Iterator[Claim]:
    peaks, levels = _peaks(family), _levels(family)
    yield Claim(
        "F3-level",
        "Fig. 3, III.A",
        "The specific damping capacity is 14 to 18 %.",
        "14 to 18 %",
        peaks[0],
        peaks[1],
        judge(min(peaks[1]) >= 14),
        f"Largest of any cycle, all losses counted; {100 * _intrinsic(family):.1f} of it are the structure's own. The"
        " work that the ball can do in this cavity rules the rest out.",
    )
    drop = [high[0] - high[-1] for high in levels]
    falls = all(a > b for a, b in zip(levels[1], levels[1][1:], strict=False))
    yield Claim(
        "F3-trend",
        "Fig. 3, III.A",
        "The damping falls slightly as the load rises.",
        "from 18 to 14 %",
        drop[0],
        drop[1],
        judge(falls and drop[1] > 1, partly=falls),
        "Ball's part at the lowest load less that at the highest, in % of the energy a cycle: consistent, it falls, on"
        " a level two orders of magnitude lower; printed, where the ball gives energy, it rises.",
    )
    after = [max(abs(float(c.ball[-1])) for c in family[f]) for f in FORMULATIONS]
    yield Claim(
        "F3-stops",
        "Fig. 3, III.A",
        "Below the cut-off the particle rests and damps nothing.",
        "0",
        after[0],
        after[1],
        judge(max(after) < 1e-9),
        "Ball's part in the last cycle of each run, after rest.",
    )


def _intrinsic(family: Family) -> float:
    curve = family["consistent"][0]
    return float(curve.sdc[-1] - curve.ball[-1])


def _fig4(family: Family) -> Iterator[Claim]:
    levels = _levels(family)
    fits = [_linearity(MASS_RATIOS, values) for values in levels]
    yield Claim(
        "F4-linear",
        "Fig. 4, III.B",
        "The peak damping rises with the mass ratio in almost a linear fashion.",
        "R² close to 1",
        fits[0],
        fits[1],
        judge(fits[1] > 0.99, partly=fits[1] > 0.9),
        "R² of the ball's part, averaged over the cycles in which it moves, over mass ratios of 0.3 to 1.2 %; printed,"
        " that part is a gain of energy.",
    )
    growth = [values[-1] / values[0] for values in levels]
    yield Claim(
        "F4-rises",
        "abstract, III.B",
        "Damping increases with the mass ratio.",
        "more",
        growth[0],
        growth[1],
        judge(growth[1] > 1),
        "Ball's part at 1.2 % over that at 0.3 %; printed, both are gains of energy.",
    )


def _fig5(family: Family) -> Iterator[Claim]:
    levels, peaks = _levels(family), _peaks(family)
    changes = [100 * (values[-1] / values[0] - 1) for values in levels]
    totals = [100 * (values[-1] / values[0] - 1) for values in peaks]
    yield Claim(
        "F5-weak",
        "Fig. 5, III.C, abstract",
        "Five times the cavity changes the damping by no more than 5 %.",
        "−5 %",
        changes[0],
        changes[1],
        judge(abs(changes[1]) <= 5, partly=abs(totals[1]) <= 5),
        "Change of the ball's own part in %: consistent, it grows almost in proportion to the clearance, as the bound"
        f" on its work does; printed, a gain of energy shrinks."
        f" Only all that is lost, mostly the structure's own, changes as little as {totals[1]:.1f} %.",
    )
    yield Claim(
        "F5-sense",
        "III.C, IV",
        "A bigger cavity damps no better; a smaller one perhaps more.",
        "smaller ≥ bigger",
        levels[0][0] / levels[0][-1],
        levels[1][0] / levels[1][-1],
        judge(levels[1][0] >= levels[1][-1]),
        "Ball's part in the smallest cavity over that in the biggest; printed, both are gains of energy.",
    )
    spread = [_overlap(family[f], total=True) for f in FORMULATIONS]
    yield Claim(
        "F5-overlap",
        "Fig. 5, III.C",
        "At low amplitudes the curves for different cavities overlap.",
        "overlap",
        100 * spread[0],
        100 * spread[1],
        judge(spread[1] < 0.02, partly=spread[1] < 0.1),
        "Spread of all that is lost at equal amplitude, in % of it; of the ball's part alone they do not overlap.",
    )


def _fig6(family: Family) -> Iterator[Claim]:
    spread = [_overlap(family[f], total=True) for f in FORMULATIONS]
    own = [_overlap(family[f], total=False) for f in FORMULATIONS]
    yield Claim(
        "F6-weak",
        "Fig. 6, III.D",
        "At equal amplitude the damping depends on the initial displacement, but only slightly.",
        "slightly",
        100 * spread[0],
        100 * spread[1],
        judge(0 < spread[1] < 0.05),
        f"Spread at equal amplitude in % of all that is lost; of the ball's part alone it is {100 * own[1]:.0f} %.",
    )


def _fig7(family: Family) -> Iterator[Claim]:
    levels = _levels(family)
    yield Claim(
        "F7-radius",
        "Fig. 7, III.D",
        "A larger particle in the same cavity acts like a smaller cavity: a weak effect.",
        "weak",
        levels[0][-1] / levels[0][0],
        levels[1][-1] / levels[1][0],
        judge(0.8 < levels[1][-1] / levels[1][0] < 1.25),
        "Ball's part with r = 1.1 mm over that with 0.6 mm (printed, a gain over a loss): less"
        " clearance, less work, as with the cavity; and a"
        " cut-off that falls as 1/r, since rolling resistance is μ_r N / r.",
    )


def _linearity(x: tuple[float, ...], y: list[float]) -> float:
    """R² of the best line."""
    r = np.corrcoef(x, y)[0, 1]
    return float(r * r)


def _overlap(curves: list[DampingCurve], *, total: bool) -> float:
    """Mean over amplitudes that all curves reach of their spread over their mean, interpolated."""
    parts = [moving(curve) for curve in curves]
    low = max(float(part.amplitude_g.min()) for part in parts)
    high = min(float(part.amplitude_g.max()) for part in parts)
    amplitudes = np.linspace(low, high, 50)
    values = np.array([np.interp(amplitudes, p.amplitude_g[::-1], (p.sdc if total else p.ball)[::-1]) for p in parts])
    return float(np.mean(np.ptp(values, axis=0) / np.abs(values.mean(axis=0))))
