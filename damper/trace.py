"""How a driven motion is watched: its envelope cycle by cycle, in sums, and how far it is from where it was."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.series import increment

if TYPE_CHECKING:
    from damper.arrays import Floats, Record, Records


@kernel
def follow(trace: Record, system: Record, motion: Record, begin: float, end: float) -> None:
    """Take the probe's extremes between two times of the same flights, at most a step apart."""
    u, v = _probed(trace, system, motion, begin)
    _take(trace, u)
    u_end, v_end = _probed(trace, system, motion, end)
    _take(trace, u_end)
    if (v > 0.0) == (v_end > 0.0) or end <= begin:
        return
    low, high, v_low, v_high = begin, end, v, v_end
    for _ in range(60):
        t = high - v_high * (high - low) / (v_high - v_low)
        u, v = _probed(trace, system, motion, t)
        if v == 0.0 or abs(high - low) < 1e-9 * trace.period:
            break
        if (v > 0.0) == (v_high > 0.0):
            high, v_high, v_low = t, v, 0.5 * v_low
        else:
            low, v_low, high, v_high = high, v_high, t, v
    _take(trace, u)


@kernel
def _take(trace: Record, u: float) -> None:
    trace.high, trace.low = max(trace.high, u), min(trace.low, u)


@kernel
def _probed(trace: Record, system: Record, motion: Record, time: float) -> tuple[float, float]:
    """The probe's displacement and velocity."""
    u = v = 0.0
    for g in range(system.groups):
        span = system.span[g]
        x = (time - motion.start[g]) / span
        for m in range(system.low[g], system.high[g]):
            if trace.probe[m] != 0.0:
                gain, rate = increment(motion.series[m], x)
                u += trace.probe[m] * (motion.series[m, 0] + gain)
                v += trace.probe[m] * rate / span
    return u, v


@kernel
def open_tally(tally: Record, system: Record, motion: Record, axes: Records, ball: Record, books: Record) -> None:
    """Begin to add up."""
    tally.cycles = tally.total = tally.squares = tally.greatest = tally.impacts = 0.0
    tally.least = np.inf
    tally.work, tally.lost = books.work, lost(books)
    tally.stored = stored(system, motion, axes, ball)


@kernel
def add_cycle(tally: Record, amplitude: float, impacts: int) -> None:
    """Add a cycle."""
    tally.cycles += 1.0
    tally.total += amplitude
    tally.squares += amplitude * amplitude
    tally.least, tally.greatest = min(tally.least, amplitude), max(tally.greatest, amplitude)
    tally.impacts += impacts


@kernel
def close_tally(tally: Record, system: Record, motion: Record, axes: Records, ball: Record, books: Record) -> None:
    """From what was there at the beginning to what was gained."""
    tally.work, tally.lost = books.work - tally.work, lost(books) - tally.lost
    tally.stored = stored(system, motion, axes, ball) - tally.stored


@kernel
def lost(books: Record) -> float:
    """Energy lost so far [J]."""
    return float(books.structure + books.rolling + books.impact + books.slip)


@kernel
def stored(system: Record, motion: Record, axes: Records, ball: Record) -> float:
    """Energy of structure and ball [J]."""
    twice = ball.spin_mass * (axes[0].spin ** 2 + axes[1].spin ** 2)
    for m in range(system.coordinates):
        for n in range(system.coordinates):
            twice += motion.rate[m] * system.mass[m, n] * motion.rate[n]
            twice += motion.z[m] * system.spring[m, n] * motion.z[n]
    return float(0.5 * twice)


@kernel
def mark(trace: Record, system: Record, motion: Record, axes: Records) -> None:
    """Remember the state."""
    for m in range(system.coordinates):
        trace.reference[0, m], trace.reference[1, m] = motion.z[m], motion.rate[m]
    for i in range(2):
        trace.spin[i] = axes[i].spin


@kernel
def distance(
    trace: Record, system: Record, z: Floats, rate: Floats, spin: Floats, motion: Record, axes: Records
) -> float:
    """Largest difference of a state from the motion's, in the coordinates' scales."""
    turn, most = 2.0 * math.pi / trace.period, 0.0
    for m in range(system.coordinates):
        if trace.scale[m] > 0.0:
            most = max(most, abs(motion.z[m] - z[m]) / trace.scale[m])
            most = max(most, abs(motion.rate[m] - rate[m]) / (turn * trace.scale[m]))
    for i in range(2):
        if trace.scale[system.place[i]] > 0.0:
            most = max(most, abs(axes[i].spin - spin[i]) / (turn * trace.scale[system.place[i]]))
    return most
