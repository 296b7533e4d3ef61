"""Whether a window of a driven motion is steady, and what the errors of its means are; `damper.steady` says by what."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.tallies import APERIODIC, BATCHES, GOES_ON, PERIODIC

if TYPE_CHECKING:
    from damper.arrays import Floats, Record

REPEATED = 1e-7
"""Of the linear answer's amplitude: what may be left to go to the orbit that a periodic motion comes to."""

NEARER = 0.5
"""By which a motion that comes to a periodic one must come closer to itself within half a window."""

_CALMER = 0.8
"""By which the variance of the amplitudes of a motion that calms down falls within half a window."""

_STILL = 1e-12
"""Variance over square below which an amplitude is constant, but for rounding."""


@kernel
def judge(trace: Record, window: Record, length: int, accuracy: float) -> None:
    """The verdict on a window, and the errors of its means."""
    for row in range(2):
        trace.error[row] = _standard_error(trace.means[row])
    half, mean = BATCHES // 2, window.total / window.cycles
    trace.drift = (trace.means[0, half:].sum() - trace.means[0, :half].sum()) / half
    middle, end = trace.near[0], trace.near[1]
    closer = end < NEARER * middle or _calmer(trace.means)
    trace.left = _left(middle, end, 0.5 * length / max(trace.repeats, 1))
    if trace.left <= REPEATED:
        trace.verdict = PERIODIC
    elif not closer and _steady(trace, window, accuracy * mean):
        balanced = abs(window.stored) <= accuracy * abs(window.work)
        trace.verdict = APERIODIC if balanced else GOES_ON


@kernel
def _calmer(means: Floats) -> bool:
    """Whether the amplitudes of cycles vary less in the second half of the window than in the first."""
    half = BATCHES // 2
    first = means[2, :half].sum() / half - (means[0, :half].sum() / half) ** 2
    second = means[2, half:].sum() / half - (means[0, half:].sum() / half) ** 2
    return bool(second < _CALMER * first and first > _STILL * means[2, 0])


@kernel
def _left(middle: float, end: float, turns: float) -> float:
    """Way left to an orbit that is come to geometrically; what comes no closer is there, but for rounding."""
    if end >= middle:
        return end
    return end / -math.expm1(math.log(end / middle) / turns) if end > 0.0 else 0.0


@kernel
def _steady(trace: Record, window: Record, allowed: float) -> bool:
    """Whether the mean amplitude is known so well, and drifts no more than chance explains or than that."""
    error = trace.error[0]
    return bool(error <= allowed and abs(trace.drift) <= max(6.0 * error, allowed))


@kernel
def _standard_error(means: Floats) -> float:
    """Of the mean of batches that each remember something of the one before."""
    n = len(means)
    mean = means.sum() / n
    square = lagged = 0.0
    for k in range(n):
        square += (means[k] - mean) ** 2
        if k:
            lagged += (means[k] - mean) * (means[k - 1] - mean)
    if square == 0.0:
        return 0.0
    memory = min(max(lagged / square, 0.0), 0.9)
    return math.sqrt(square / (n - 1) / n * (1.0 + memory) / (1.0 - memory))
