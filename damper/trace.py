"""What is kept of a driven motion: its envelope cycle by cycle, in batches, and where it was at the end of a cycle.

A cycle is one of the force. Its amplitude is half of what a displacement, the probe, goes through in it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.records import record
from damper.series import increment
from damper.system import MODES

if TYPE_CHECKING:
    from damper.arrays import Floats, Record, Records

BATCHES = 32
"""Parts of a window whose means tell the statistical error."""

_N = MODES + 2

TALLY = record(
    ("cycles", "f8"),
    ("least", "f8"),
    ("greatest", "f8"),
    ("total", "f8"),  # of the amplitudes of cycles
    ("squares", "f8"),
    ("work", "f8"),  # put in since the start, at the beginning of the tally [J]
    ("lost", "f8"),
    ("stored", "f8"),  # energy of structure and ball then [J]
    ("impacts", "f8"),
)
"""Sums over cycles; after its end `work`, `lost`, `stored` and `impacts` are what was gained in it."""

TRACE = record(
    ("probe", "f8", _N),  # displacement = probe z
    ("still", "f8", (2, _N)),  # z and its rate at the start of a cycle if the ball is never to move
    ("drive", "f8", 2),  # largest drive of a stuck ball then [m/s^2]
    ("scale", "f8", _N),  # by which differences of z are measured; rates by that times the frequency
    ("period", "f8"),  # of the force
    ("cycles", "i8"),  # so far
    ("patience", "i8"),  # cycles that the structure's own motion takes to be forgotten
    ("high", "f8"),  # extremes of the probe in this cycle
    ("low", "f8"),
    ("away", "f8", (2, _N)),  # to work on: z and its rate less those of `still`
    ("reference", "f8", (2, _N)),  # z and its rate at the start of a batch
    ("spin", "f8", 2),
    ("near", "f8", 2),  # least distance from there at later cycles, in the middle and in the last batch of a window
    ("repeats", "i8"),  # after how many cycles, in the last
    ("left", "f8"),  # distance that is left to the orbit which the motion comes to
    ("means", "f8", (3, BATCHES)),  # of amplitude, of power put in and of amplitude squared, batch by batch
    ("error", "f8", 2),  # standard errors of these means over the window
    ("drift", "f8"),  # mean amplitude of the window's second half less that of its first
    ("verdict", "i8"),
)
"""A driven motion on its way to its steady state."""


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
