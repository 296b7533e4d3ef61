"""Vibration cycles: the structure's velocity maxima, and the damping from one to the next.

A cycle runs from one velocity maximum to the next, about a period later. Each maximum is the largest speed of the
cavity in a window of time, which opens a little before it is due. `watch` looks through a window while the flights
last; `close` ends a cycle there and keeps the largest damping capacity and the last cycle in which the ball moved.

Further modes, which hits excite, come and go in the cavity's speed. Where there are any, a cycle is judged by the
energy E of all modes with the ball riding along: the speed recorded is sqrt(2 E / M1), which a single mode has at its
maximum. It stays the same while the ball is stuck, however the modes exchange energy.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from damper.compiled import by_flights, kernel
from damper.flight import increment, rates, slope, velocity
from damper.state import STUCK

if TYPE_CHECKING:
    from damper.model import Record


@kernel
def watch(it: Record, begin: float, end: float) -> bool:
    """Look for the window's largest speed from time `begin` to `end`, on which all axes fly.

    Returns True when the window closed, `cycle.time` and `cycle.speed` then hold the peak; call again with the time
    at which it closed until it returns False.
    """
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


@kernel
def close(cycle: Record, last_motion: float) -> None:
    """Take the peak just found as the end of a cycle and the start of the next, and open the window after it."""
    first = cycle.last_speed < 0.0
    if not first:
        _tally(cycle, last_motion)
    cycle.last_time = 0.0 if first else cycle.time
    cycle.last_speed = cycle.speed
    cycle.opens = cycle.time + cycle.wait
    cycle.closes = cycle.opens + 0.5 * cycle.period
    cycle.speed = cycle.square = -1.0


@kernel
def _tally(cycle: Record, last_motion: float) -> None:
    """Keep the largest capacity, and where the ball last moved: it may rest for a while and move again."""
    sdc = 1.0 - (cycle.speed / cycle.last_speed) ** 2 if cycle.last_speed > 0.0 else 0.0
    if sdc > cycle.peak_sdc:
        cycle.peak_sdc, cycle.peak_sdc_speed = sdc, cycle.last_speed
    resume(cycle, last_motion)
    if cycle.last_time <= last_motion:
        cycle.moving_speed = cycle.last_speed
    else:
        cycle.waiting_speed, cycle.waiting_since = cycle.last_speed, last_motion


@kernel
def resume(cycle: Record, last_motion: float) -> None:
    """If the ball moved after it had rested, the cycles in between count as ones before its last motion."""
    if cycle.waiting_speed >= 0.0 and last_motion > cycle.waiting_since:
        cycle.moving_speed, cycle.waiting_speed = cycle.waiting_speed, -1.0


@kernel
def pass_time(it: Record, time: float) -> None:
    """All is seen up to a time."""
    it.clock.watched = time
    if it.axes[0].regime != STUCK or it.axes[1].regime != STUCK:
        it.clock.last_motion = time


@kernel
def _level_take(it: Record, time: float, square: float) -> None:
    """`_take` in closed form."""
    cycle, speed = it.cycle, math.sqrt(square)
    if speed > cycle.speed:
        cycle.speed, cycle.time = speed, time


@kernel
def _level_speed(it: Record, time: float) -> tuple[float, float]:
    """`_speed` in closed form."""
    square = rate = 0.0
    for i in range(2):
        axis = it.axes[i]
        law = it.laws[i, axis.regime]
        v, acceleration = velocity(axis, law, time - axis.start)
        square += v * v
        rate += v * acceleration
    return square, rate


@kernel
def _linear_take(it: Record, time: float, square: float) -> None:
    """`_take` in linear flights."""
    cycle = it.cycle
    if not it.system.several:
        _level_take(it, time, square)
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
def _linear_speed(it: Record, time: float) -> tuple[float, float]:
    """`_speed` in linear flights."""
    system, square, rate = it.system, 0.0, 0.0
    for g in range(system.groups):
        span, cavity = system.span[g], system.high[g] - system.low[g]
        x = (time - it.motion.start[g]) / span
        for lane in range(cavity, cavity + system.last[g] - system.first[g]):
            v, acceleration = rates(it.motion.series[g, lane], x)
            square += v * v / (span * span)
            rate += v * acceleration / (span * span * span)
    return square, rate


@by_flights(_level_take, _linear_take)
def _take(it: Record, time: float, square: float) -> None:
    """Take a time and the square of the cavity's speed then for the window's largest, if they are."""


@by_flights(_level_speed, _linear_speed)
def _speed(it: Record, time: float) -> tuple[float, float]:
    """Square of the cavity's speed at a time, and half its rate."""
    raise NotImplementedError
