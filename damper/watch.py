"""The structure's velocity maxima where flights are series; what a cycle is, `damper.peaks` says.

Where hits feed modes beside one along each axis, these come and go in the cavity's speed. What a cycle has lost is then
told by the energy E of all modes with the ball riding along: the speed recorded is sqrt(2 E / M1), which a single mode
has at its maximum. While the ball is stuck that keeps, however the modes exchange it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.peaks import take
from damper.series import increment, rates, slope

if TYPE_CHECKING:
    from damper.arrays import Record


@kernel
def watch(it: Record, begin: float, end: float) -> bool:
    """Look for the window's largest speed from time `begin` to `end`; True when it closed, as `damper.peaks.watch`."""
    cycle = it.cycle
    low, high = max(begin, cycle.opens), min(end, cycle.closes)
    if low <= high:
        pieces = 1 + int(8 * (high - low) / cycle.period)
        t, (f, g) = low, _speed(it, low)
        _take(it, t, f)
        for i in range(pieces):
            t_next = low + (high - low) * (i + 1) / pieces
            f_next, g_next = _speed(it, t_next)
            _take(it, t_next, f_next)
            if g > 0.0 > g_next:
                top = _stationary(it, (t, t_next), (g, g_next))
                _take(it, top, _speed(it, top)[0])
            t, g = t_next, g_next
    return bool(end >= cycle.closes)


@kernel
def _take(it: Record, time: float, square: float) -> None:
    """Take a time and the square of the cavity's speed then for the window's largest, if they are."""
    cycle = it.cycle
    if not it.system.several:
        take(cycle, time, square)
    elif square > cycle.square:
        cycle.square, cycle.time = square, time
        cycle.speed = math.sqrt(_twice_the_energy(it, time) / (it.ball.host_mass + it.ball.mass))


@kernel
def _twice_the_energy(it: Record, time: float) -> float:
    """Of all modes, the ball riding along [J]."""
    system, twice = it.system, 0.0
    for g in range(system.groups):
        span, low, c = system.span[g], system.low[g], it.motion.series[g]
        x = (time - it.motion.start[g]) / span
        for m in range(low, system.high[g]):
            if system.inertia[m] > 0.0:
                gain, rate = increment(c[m - low], x)
                q = c[m - low, 0] + gain
                twice += system.spring[m, m] * q * q + system.mass[m, m] * (rate / span) ** 2
                for n in range(low, m):
                    if system.inertia[n] > 0.0:
                        twice += 2.0 * system.mass[m, n] * rate * slope(c[n - low], x) / (span * span)
    return twice


@kernel
def _speed(it: Record, time: float) -> tuple[float, float]:
    """Speed squared and half its rate."""
    system, square, rate = it.system, 0.0, 0.0
    for g in range(system.groups):
        span, cavity = system.span[g], system.high[g] - system.low[g]
        x = (time - it.motion.start[g]) / span
        for lane in range(cavity, cavity + system.last[g] - system.first[g]):
            v, acceleration = rates(it.motion.series[g, lane], x)
            square += v * v / (span * span)
            rate += v * acceleration / (span * span * span)
    return square, rate


@kernel
def _stationary(it: Record, times: tuple[float, float], slopes: tuple[float, float]) -> float:
    """Zero of the rate between two times of opposite sign, by the Illinois rule."""
    low, high = times
    g_low, g_high = slopes
    t = low
    for _ in range(60):
        t = high - g_high * (high - low) / (g_high - g_low)
        g = _speed(it, t)[1]
        if g == 0.0 or abs(high - low) < 1e-8 * it.cycle.period:
            break
        if (g > 0.0) == (g_high > 0.0):
            high, g_high = t, g
            g_low *= 0.5
        else:
            low, g_low = high, g_high
            high, g_high = t, g
    return t
