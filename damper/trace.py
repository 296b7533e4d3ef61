"""How a driven motion is watched: its envelope cycle by cycle, in sums, and how far it is from where it was."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.series import increment

if TYPE_CHECKING:
    from damper.arrays import Record


@kernel
def follow(it: Record, begin: float, end: float) -> None:
    """Take the probe's extremes between two times of the same flights, at most a step apart."""
    trace = it.envelope
    u, v = _probed(it, begin)
    _take(trace, u)
    u_end, v_end = _probed(it, end)
    _take(trace, u_end)
    if (v > 0.0) == (v_end > 0.0) or end <= begin:
        return
    low, high, v_low, v_high = begin, end, v, v_end
    for _ in range(60):
        t = high - v_high * (high - low) / (v_high - v_low)
        u, v = _probed(it, t)
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
def _probed(it: Record, time: float) -> tuple[float, float]:
    """The probe's displacement and velocity."""
    system, probe, u, v = it.run.system, it.envelope.probe, 0.0, 0.0
    for g in range(system.groups):
        span, low, c = system.span[g], system.low[g], it.run.motion.series[g]
        x = (time - it.run.motion.start[g]) / span
        for m in range(low, system.high[g]):
            if probe[m] != 0.0:
                gain, rate = increment(c[m - low], x)
                u += probe[m] * (c[m - low, 0] + gain)
                v += probe[m] * rate / span
    return u, v


@kernel
def open_tally(tally: Record, it: Record) -> None:
    """Begin to add up."""
    tally.cycles = tally.total = tally.squares = tally.greatest = tally.impacts = 0.0
    tally.least = np.inf
    tally.work, tally.lost, tally.stored = it.run.books.work, lost(it.run.books), stored(it.run)


@kernel
def add_cycle(tally: Record, amplitude: float, impacts: int) -> None:
    """Add a cycle."""
    tally.cycles += 1.0
    tally.total += amplitude
    tally.squares += amplitude * amplitude
    tally.least, tally.greatest = min(tally.least, amplitude), max(tally.greatest, amplitude)
    tally.impacts += impacts


@kernel
def add_batch(batch: int, it: Record) -> None:
    """Add the last batch, closed, to the window."""
    window, last, means = it.window, it.last, it.envelope.means
    cycles = last.cycles
    means[0, batch], means[1, batch] = last.total / cycles, last.work / (cycles * it.envelope.period)
    means[2, batch] = last.squares / cycles
    window.cycles += cycles
    window.total += last.total
    window.squares += last.squares
    window.impacts += last.impacts
    window.least, window.greatest = min(window.least, last.least), max(window.greatest, last.greatest)


@kernel
def close_tally(tally: Record, it: Record) -> None:
    """From what was there at the beginning to what was gained."""
    tally.work, tally.lost = it.run.books.work - tally.work, lost(it.run.books) - tally.lost
    tally.stored = stored(it.run) - tally.stored


@kernel
def lost(books: Record) -> float:
    """Energy lost so far [J]."""
    return float(books.structure + books.rolling + books.impact + books.slip)


@kernel
def stored(it: Record) -> float:
    """Energy of structure and ball [J]."""
    system, motion = it.system, it.motion
    twice = it.ball.spin_mass * (it.axes[0].spin ** 2 + it.axes[1].spin ** 2)
    for m in range(system.coordinates):
        for n in range(system.coordinates):
            twice += motion.rate[m] * system.mass[m, n] * motion.rate[n]
            twice += motion.z[m] * system.spring[m, n] * motion.z[n]
    return float(0.5 * twice)


@kernel
def mark(it: Record) -> None:
    """Remember the state."""
    for m in range(it.run.system.coordinates):
        it.envelope.reference[0, m], it.envelope.reference[1, m] = it.run.motion.z[m], it.run.motion.rate[m]
    for i in range(2):
        it.envelope.spin[i] = it.run.axes[i].spin


@kernel
def distance(it: Record, trace: Record) -> float:
    """Largest difference of the state from the one that a trace remembers, in the coordinates' scales."""
    system, motion, axes = it.run.system, it.run.motion, it.run.axes
    z, rate, spin = trace.reference[0], trace.reference[1], trace.spin
    turn, most = 2.0 * math.pi / trace.period, 0.0
    for m in range(system.coordinates):
        if trace.scale[m] > 0.0:
            most = max(most, abs(motion.z[m] - z[m]) / trace.scale[m])
            most = max(most, abs(motion.rate[m] - rate[m]) / (turn * trace.scale[m]))
    for i in range(2):
        if trace.scale[system.place[i]] > 0.0:
            most = max(most, abs(axes[i].spin - spin[i]) / (turn * trace.scale[system.place[i]]))
    return most
