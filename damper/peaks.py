"""The structure's velocity maxima, one per vibration cycle, found as the flights go by.

The speed v(t) = sqrt(v_x**2 + v_y**2) peaks twice in a vibration period. A cycle runs from one peak to the one a
period later: the largest speed between 3/4 and 5/4 of a period after the last peak (for the first: in the first half
period after the release). Following the peaks keeps the count right while the frequency shifts, and one large
window keeps the kinks that impacts make from being taken for cycles.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.flight import velocity

if TYPE_CHECKING:
    from damper.records import Record, Records


@kernel
def watch(peak: Record, axes: Records, laws: Records, begin: float, end: float) -> bool:
    """Look for the window's largest speed while both axes fly from time `begin` to `end`.

    Returns True when the window closed, `peak.time` and `peak.speed` then hold the peak; call again with the time
    at which it closed until it returns False.
    """
    low, high = max(begin, peak.opens), min(end, peak.closes)
    if low <= high:
        pieces = 1 + int(8 * (high - low) / peak.period)
        t, (f, g) = low, _speed(axes, laws, low)
        _take(peak, t, f)
        for i in range(pieces):
            t_next = low + (high - low) * (i + 1) / pieces
            f_next, g_next = _speed(axes, laws, t_next)
            _take(peak, t_next, f_next)
            if g > 0.0 > g_next:
                top = _stationary(axes, laws, t, t_next, g, g_next, 1e-8 * peak.period)
                _take(peak, top, _speed(axes, laws, top)[0])
            t, g = t_next, g_next
    return end >= peak.closes


@kernel
def next_window(peak: Record) -> None:
    """Open the window of the following peak."""
    peak.opens = peak.time + 0.75 * peak.period
    peak.closes = peak.time + 1.25 * peak.period
    peak.speed = -1.0


@kernel
def _take(peak: Record, time: float, square: float) -> None:
    speed = math.sqrt(square)
    if speed > peak.speed:
        peak.speed = speed
        peak.time = time


@kernel
def _speed(axes: Records, laws: Records, time: float) -> tuple[float, float]:
    """Speed squared and half its rate."""
    square = rate = 0.0
    for i in range(2):
        axis = axes[i]
        law = laws[i, axis.regime]
        v, acceleration = velocity(axis, law, time - axis.start)
        square += v * v
        rate += v * acceleration
    return square, rate


@kernel
def _stationary(
    axes: Records, laws: Records, low: float, high: float, g_low: float, g_high: float, tolerance: float
) -> float:
    """Zero of the rate between two times of opposite sign, by the Illinois rule."""
    t = low
    for _ in range(60):
        t = high - g_high * (high - low) / (g_high - g_low)
        g = _speed(axes, laws, t)[1]
        if g == 0.0 or abs(high - low) < tolerance:
            break
        if (g > 0.0) == (g_high > 0.0):
            high, g_high = t, g
            g_low *= 0.5
        else:
            low, g_low = high, g_high
            high, g_high = t, g
    return t
