"""The series of a group's flight, and what they are within its step; `damper.flows` has what they are made of."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from damper.compiled import fused
from damper.records import ROLLING, SLIPPING, STUCK
from damper.system import TERMS
from damper.vectors import add_times, fill, load, store, times

if TYPE_CHECKING:
    from damper.arrays import Floats, Record


@fused
def expand(g: int, it: Record, flow: Floats) -> None:
    """The series of a group from its state on."""
    system, axes, terms = it.system, it.axes, flow[regimes(g, it)]
    first, last, count = system.first[g], system.last[g], system.high[g] - system.low[g]
    sources = gather(g, it.motion.start[g], it)
    c, source, series = it.motion.series[g], it.motion.source, count + last - first
    for lane in range(series):
        _combine(c[lane], terms[lane], source, sources)
    for i in range(first, last):
        if axes[i].regime == STUCK:
            _combine(c[series + i - first], terms[series + i - first], source, sources)
    if system.frequency > 0.0:
        for lane in range(series + last - first, series + last - first + 2):
            _combine(c[lane], terms[lane], source, sources)


@fused
def regimes(g: int, it: Record) -> int:
    """Which flow a group's regimes ask for."""
    if it.system.groups == 1:
        return int(3 * it.axes[0].regime + it.axes[1].regime)
    return int(3 * g + it.axes[g].regime)


@fused
def gather(g: int, time: float, it: Record) -> int:
    """What a group's flight begins with at a time, from its state and regimes; returns how many sources count."""
    system, motion = it.system, it.motion
    low, count, span, source = system.low[g], system.high[g] - system.low[g], system.span[g], motion.source
    for m in range(count):
        source[m], source[count + m] = motion.z[low + m], motion.rate[low + m] * span
    sources = 2 * count
    for i in range(system.first[g], system.last[g]):
        source[sources] = _resisting(it.axes[i], it.ball)
        sources += 1
    if system.frequency > 0.0:
        angle = system.frequency * time + system.phase
        source[sources], source[sources + 1] = math.cos(angle), math.sin(angle)
        sources += 2
    return int(sources)


@fused
def _resisting(axis: Record, ball: Record) -> float:
    """What resists the motion of the ball along an axis, in the direction of that motion or sliding [m/s²]."""
    if axis.regime == ROLLING:
        return float(axis.direction * ball.threshold)
    return float(axis.direction * ball.grip) if axis.regime == SLIPPING else 0.0


@fused
def _combine(c: Floats, terms: Floats, source: Floats, sources: int) -> None:
    """A series from its sources."""
    x = fill(source[0])
    one, two, three = times(load(terms[0], 0), x), times(load(terms[0], 8), x), times(load(terms[0], 16), x)
    for j in range(1, sources):
        x, row = fill(source[j]), terms[j]
        one, two = add_times(one, load(row, 0), x), add_times(two, load(row, 8), x)
        three = add_times(three, load(row, 16), x)
    store(c, 0, one)
    store(c, 8, two)
    store(c, 16, three)


@fused
def value(c: Floats, x: float) -> float:
    """A series at x."""
    f = 0.0
    for k in range(TERMS - 1, -1, -1):
        f = f * x + c[k]
    return f


@fused
def increment(c: Floats, x: float) -> tuple[float, float]:
    """What a series gains from 0 to x, and its slope there."""
    f = rate = 0.0
    for k in range(TERMS - 1, 0, -1):
        rate = rate * x + f
        f = f * x + c[k]
    return f * x, rate * x + f


@fused
def slope(c: Floats, x: float) -> float:
    """Slope of a series."""
    rate = 0.0
    for k in range(TERMS - 1, 0, -1):
        rate = rate * x + k * c[k]
    return rate


@fused
def rates(c: Floats, x: float) -> tuple[float, float]:
    """First and second derivative of a series."""
    first = second = 0.0
    for k in range(TERMS - 1, 0, -1):
        second = second * x + first
        first = first * x + k * c[k]
    return first, second


@fused
def third(c: Floats, x: float) -> float:
    """Third derivative of a series."""
    jerk = 0.0
    for k in range(TERMS - 1, 2, -1):
        jerk = jerk * x + k * (k - 1) * (k - 2) * c[k]
    return jerk
