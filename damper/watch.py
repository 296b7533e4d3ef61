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
from damper.series import rates, slope, value

if TYPE_CHECKING:
    from damper.arrays import Record


@kernel
def watch(cycle: Record, system: Record, motion: Record, stuck_mass: float, begin: float, end: float) -> bool:
    """Look for the window's largest speed from time `begin` to `end`; True when it closed, as `damper.peaks.watch`."""
    low, high = max(begin, cycle.opens), min(end, cycle.closes)
    if low <= high:
        pieces = 1 + int(8 * (high - low) / cycle.period)
        t, (f, g) = low, _speed(system, motion, low)
        _take(cycle, system, motion, stuck_mass, t, f)
        for i in range(pieces):
            t_next = low + (high - low) * (i + 1) / pieces
            f_next, g_next = _speed(system, motion, t_next)
            _take(cycle, system, motion, stuck_mass, t_next, f_next)
            if g > 0.0 > g_next:
                top = _stationary(system, motion, t, t_next, g, g_next, 1e-8 * cycle.period)
                _take(cycle, system, motion, stuck_mass, top, _speed(system, motion, top)[0])
            t, g = t_next, g_next
    return bool(end >= cycle.closes)


@kernel
def _take(cycle: Record, system: Record, motion: Record, stuck_mass: float, time: float, square: float) -> None:
    """Take a time and the square of the cavity's speed then for the window's largest, if they are."""
    if not system.several:
        take(cycle, time, square)
    elif square > cycle.square:
        cycle.square, cycle.time = square, time
        cycle.speed = math.sqrt(_twice_the_energy(system, motion, time) / stuck_mass)


@kernel
def _twice_the_energy(system: Record, motion: Record, time: float) -> float:
    """Of all modes, the ball riding along [J]."""
    twice = 0.0
    for g in range(system.groups):
        span = system.span[g]
        x = (time - motion.start[g]) / span
        for m in range(system.low[g], system.high[g]):
            if system.inertia[m] > 0.0:
                q, rate = value(motion.series[m], x), slope(motion.series[m], x) / span
                twice += system.spring[m, m] * q * q + system.mass[m, m] * rate * rate
                for n in range(system.low[g], m):
                    if system.inertia[n] > 0.0:
                        twice += 2.0 * system.mass[m, n] * rate * slope(motion.series[n], x) / span
    return twice


@kernel
def _speed(system: Record, motion: Record, time: float) -> tuple[float, float]:
    """Speed squared and half its rate."""
    square = rate = 0.0
    for g in range(system.groups):
        span = system.span[g]
        x = (time - motion.start[g]) / span
        for i in range(system.first[g], system.last[g]):
            v, acceleration = rates(motion.cavity[i], x)
            square += v * v / (span * span)
            rate += v * acceleration / (span * span * span)
    return square, rate


@kernel
def _stationary(
    system: Record, motion: Record, low: float, high: float, g_low: float, g_high: float, tolerance: float
) -> float:
    """Zero of the rate between two times of opposite sign, by the Illinois rule."""
    t = low
    for _ in range(60):
        t = high - g_high * (high - low) / (g_high - g_low)
        g = _speed(system, motion, t)[1]
        if g == 0.0 or abs(high - low) < tolerance:
            break
        if (g > 0.0) == (g_high > 0.0):
            high, g_high = t, g
            g_low *= 0.5
        else:
            low, g_low = high, g_high
            high, g_high = t, g
    return t
