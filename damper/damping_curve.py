"""Points of a damping curve, from samples of sweeps through the amplitudes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from damper.model import Floats


BINS = 12
"""Points of the curve in an octave of amplitude."""

BINNED = 0.01
"""Relative error that reading a peak off bins may leave."""

_LEAST_STAY = 1.0
"""Cycles that must have been spent in a bin for it to have a point of the curve."""

_SMALL = 1e-15
"""Damping ratio below which a ball takes nothing: rounding of the energies compared gives less than 1e-16."""


@dataclass(frozen=True, eq=False)
class Working:
    """The damper's own figures; amplitudes are the structure's displacements along x at the damper.

    Attributes:
        amplitude: A, ascending, shape (n,) [m].
        damping_ratio: -ln(1 - Psi) / (4 pi) at A, Psi being the share of the energy taken in a cycle, shape (n,) [-].
        cutoff: amplitude up to which the ball stays at rest in the middle, a_r / |omega_1^2 - E|, where E u is how the
            load pulls it down the tilting floor: a_r / omega_1^2 on a level one [m].
        peak: largest damping ratio [-]; 0 where the ball takes nothing.
        peak_amplitude: A there [m].
        range: amplitudes between which the damper works, from the cut-off (or, where nothing holds the ball, from half
            the peak) to where the damping has fallen to half its peak [m].
        half: amplitudes between which the damping is at least half its peak [m].
        error: of the peak and of `half`, relative: by how much halves of the sweeps differ from all of them around the
            peak, or both from what faster sweeps show, at most [-].
    """

    amplitude: Floats
    damping_ratio: Floats
    cutoff: float
    peak: float
    peak_amplitude: float
    range: tuple[float, float]
    half: tuple[float, float]
    error: float


def figures(samples: Floats, cutoff: float) -> Working | None:
    """The curve through samples and what is read off it; None where the ball takes nothing."""
    amplitude, ratio = _curve(samples, cutoff)
    if not len(ratio) or ratio.max() < _SMALL:
        return None
    best = int(np.argmax(ratio))
    below, above = _half(amplitude, ratio, best, -1), _half(amplitude, ratio, best, 1)
    return Working(
        amplitude=amplitude,
        damping_ratio=ratio,
        cutoff=cutoff,
        peak=float(ratio[best]),
        peak_amplitude=float(amplitude[best]),
        range=(cutoff if cutoff > 0 else below, above),
        half=(below, above),
        error=0.0,
    )


def _curve(samples: Floats, cutoff: float) -> tuple[Floats, Floats]:
    """Mean damping ratio in bins of amplitude, shape (n,) each: what was lost in a bin over the cycles spent in it.

    A cycle that crosses bins counts in each by its share, so that nothing is left out or counted twice however steep
    the decay.
    """
    before, after = samples[:, 0], samples[:, 1]
    if cutoff > 0:
        moving = before > math.log(cutoff) + 1e-12
        before, after = before[moving], after[moving]
    if not before.size:
        return np.zeros(0), np.zeros(0)
    width = math.log(2) / BINS
    low, high = np.minimum(before, after) / width, np.maximum(before, after) / width
    origin = math.floor(low.min())
    size = math.floor(high.max()) - origin + 1
    cycles, lost, place = np.zeros(size), np.zeros(size), np.zeros(size)
    ratio = (before - after) / (2 * math.pi)
    for step in range(math.floor((np.floor(high) - np.floor(low)).max()) + 1):
        at = np.floor(low) + step
        begin, end = np.maximum(low, at), np.minimum(high, at + 1)
        share = np.where(high > low, (end - begin) / np.maximum(high - low, 1e-300), step == 0)
        inside = share > 0
        bins = (at[inside] - origin).astype(int)
        np.add.at(cycles, bins, share[inside])
        np.add.at(lost, bins, share[inside] * ratio[inside])
        np.add.at(place, bins, share[inside] * 0.5 * (begin + end)[inside])
    met = cycles > _LEAST_STAY
    return np.exp(place[met] / cycles[met] * width), lost[met] / cycles[met]


def _half(amplitude: Floats, ratio: Floats, best: int, step: int) -> float:
    """Amplitude at which the curve has fallen to half its peak on one side; the last one where it does not."""
    at = best
    while 0 <= at + step < len(ratio) and ratio[at + step] > ratio[best] / 2:
        at += step
    if not 0 <= at + step < len(ratio):
        return float(amplitude[at])
    share = (ratio[at] - ratio[best] / 2) / (ratio[at] - ratio[at + step])
    return float(amplitude[at] * (amplitude[at + step] / amplitude[at]) ** share)


def spread(samples: Floats, whole: Working) -> float:
    """Largest relative deviation of the damping around the peak in a half of the samples.

    Around the peak means within two bins on either side of it. 1 where fewer than two halves see it.
    """

    def around(amplitude: Floats, ratio: Floats) -> Floats:
        near = np.abs(np.log2(amplitude / whole.peak_amplitude)) < 2.5 / BINS
        selected: Floats = ratio[near]
        return selected

    halves = [samples[samples[:, column] == value] for column in (2, 3) for value in (0, 1)]
    seen = [part.mean() for half in halves if (part := around(*_curve(half, whole.cutoff))).size]
    mean = around(whole.amplitude, whole.damping_ratio).mean()
    return max(float(abs(one / mean - 1)) for one in seen) if len(seen) > 1 else 1.0


def nothing(cutoff: float) -> Working:
    """Of a ball that takes nothing."""
    empty = np.zeros(0)
    return Working(empty, empty, cutoff, 0.0, math.nan, (math.nan, math.nan), (math.nan, math.nan), 0.0)
