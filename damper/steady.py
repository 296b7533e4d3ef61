"""Driven motion followed cycle by cycle of the force until it is steady, by a criterion that has a figure.

Each cycle begins at time 0, where the force begins anew, so that a motion that repeats itself does so to the last bit.
The run is doubled until its second half, the window, passes:

- the ball rests, and nothing that is left of the structure's own motion can move it again: locked;
- the motion comes back to where it was in the last batch of the window, and what is then left to go, by the rate at
  which it came closer since the middle, is at most `damper.verdict.REPEATED`: periodic;
- or it comes no closer and does not calm down, and the window's mean amplitude is known to the accuracy asked for, by
  its standard error, by the drift from its first to its second half, and by the balance of power: aperiodic.

A window is at least as long as the structure takes to forget its own motion.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.engine_linear import fly, happen, let_go, restart
from damper.guards import largest_drive
from damper.records import NOTHING, STUCK
from damper.tallies import BATCHES, GOES_ON, LOCKED, PERIODIC, TIRED, UNSETTLED
from damper.threshold import MARGIN
from damper.trace import add_cycle, close_tally, distance, follow, mark, open_tally
from damper.verdict import judge

if TYPE_CHECKING:
    from damper.arrays import Floats, Record, Records

_MUCH = 0.1
"""By which a motion must come closer to itself after some more cycles for these to be its period."""

_SAME = 1e-10
"""Distance at which a motion is where it was, but for rounding."""

_LONGEST = 64
"""Cycles after which a periodic motion must repeat itself."""

EVENTS = 5000
"""Most events in a cycle; a ball that has more, hardly free to move, is left at that."""

APART, NUDGE, TOGETHER = 1e-4, 1e-9, 512
"""Two motions that begin `NUDGE` apart and are `APART` within so many cycles are chaotic."""


@kernel
def cycle(
    trace: Record,
    clock: Record,
    system: Record,
    motion: Record,
    axes: Records,
    ball: Record,
    books: Record,
    rows: Records,
    states: Floats,
) -> bool:
    """Go through one cycle of the force; False where it has too many events."""
    stop, begin = clock.events + EVENTS, 0.0
    trace.high, trace.low = -np.inf, np.inf
    for g in range(system.groups):
        restart(g, 0.0, system, motion, axes, ball)
    while True:
        g = 0 if system.groups == 1 or motion.next[0] <= motion.next[1] else 1
        time = min(motion.next[g], trace.period)
        follow(trace, system, motion, begin, time)
        begin = time
        if time >= trace.period:
            for each in range(system.groups):
                fly(each, (time - motion.start[each]) / system.span[each], system, motion, axes, ball, books)
            trace.cycles += 1
            return True
        if motion.kind[g] == NOTHING:
            fly(g, 1.0, system, motion, axes, ball, books)
            restart(g, time, system, motion, axes, ball)
            continue
        if clock.events >= stop:
            return False
        clock.time = time
        clock.events += 1
        happen(g, clock, system, motion, axes, ball, books, rows, states)


@kernel
def run_block(
    block: tuple[int, int],
    traces: Records,
    tallies: Records,
    clocks: Records,
    systems: Records,
    motions: Records,
    axes: Records,
    balls: Records,
    books: Records,
    tables: tuple[Records, Floats],
    accuracy: float,
    most: int,
) -> None:
    """Bring the motions from `block[0]` to before `block[1]` to their steady states, one after the other.

    Of `tallies`, shape (n, 2), the first is of the window, the second of its last batch.
    """
    for k in range(block[0], block[1]):
        if traces[k].verdict == LOCKED:
            continue
        let_go(systems[k], motions[k], axes[k], balls[k])
        where = clocks[k], systems[k], motions[k], axes[k], balls[k], books[k]
        _settle(traces[k], tallies[k, 0], tallies[k, 1], where, tables, accuracy, most)


@kernel
def _settle(
    trace: Record,
    window: Record,
    last: Record,
    where: tuple[Record, Record, Record, Records, Record, Record],
    tables: tuple[Records, Floats],
    accuracy: float,
    most: int,
) -> None:
    """Double the run until its second half is steady."""
    _, system, motion, axes, ball, books = where
    length = trace.patience
    trace.verdict = GOES_ON
    open_tally(window, system, motion, axes, ball, books)
    open_tally(last, system, motion, axes, ball, books)
    for _ in range(length):
        if not _one(trace, last, where, tables):
            return
    while trace.verdict == GOES_ON:
        if not _look(trace, window, last, length, where, tables):
            return
        judge(trace, window, length, accuracy)
        length *= 2
        if trace.verdict == GOES_ON and trace.cycles + length > most:
            trace.verdict = UNSETTLED
    if trace.verdict == PERIODIC:
        open_tally(last, system, motion, axes, ball, books)
        for _ in range(trace.repeats):
            if not _one(trace, last, where, tables):
                return
        close_tally(last, system, motion, axes, ball, books)


@kernel
def _one(
    trace: Record,
    tally: Record,
    where: tuple[Record, Record, Record, Records, Record, Record],
    tables: tuple[Records, Floats],
) -> bool:
    """A cycle and its amplitude; False where that settles it."""
    clock, system, motion, axes, ball, books = where
    if _locked(trace, system, motion, axes, ball):
        trace.verdict = LOCKED
        return False
    before = clock.impacts
    if not cycle(trace, clock, system, motion, axes, ball, books, tables[0], tables[1]):
        trace.verdict = TIRED
        return False
    add_cycle(tally, 0.5 * (trace.high - trace.low), clock.impacts - before)
    return True


@kernel
def _look(
    trace: Record,
    window: Record,
    last: Record,
    length: int,
    where: tuple[Record, Record, Record, Records, Record, Record],
    tables: tuple[Records, Floats],
) -> bool:
    """Go through a window, batch by batch; False where it ends before."""
    _, system, motion, axes, ball, books = where
    open_tally(window, system, motion, axes, ball, books)
    cycles = length // BATCHES
    for batch in range(BATCHES):
        open_tally(last, system, motion, axes, ball, books)
        mark(trace, system, motion, axes)
        near, repeats = np.inf, 0
        for n in range(cycles):
            if not _one(trace, last, where, tables):
                return False
            if n < _LONGEST and 2 * (batch + 1) % BATCHES == 0:
                here = distance(trace, system, trace.reference[0], trace.reference[1], trace.spin, motion, axes)
                if here < _MUCH * near and near > _SAME:  # a multiple of the period is hardly nearer
                    near, repeats = here, n + 1
        if 2 * (batch + 1) % BATCHES == 0:
            trace.near[2 * (batch + 1) // BATCHES - 1], trace.repeats = near, repeats
        close_tally(last, system, motion, axes, ball, books)
        trace.means[0, batch], trace.means[1, batch] = last.total / cycles, last.work / (cycles * trace.period)
        trace.means[2, batch] = last.squares / cycles
        window.cycles += last.cycles
        window.total += last.total
        window.squares += last.squares
        window.impacts += last.impacts
        window.least, window.greatest = min(window.least, last.least), max(window.greatest, last.greatest)
    close_tally(window, system, motion, axes, ball, books)
    return True


@kernel
def _locked(trace: Record, system: Record, motion: Record, axes: Records, ball: Record) -> bool:
    """Whether the ball, at rest, will never move again: the structure's own motion dies out."""
    for i in range(2):
        if axes[i].regime != STUCK or axes[i].spin != 0.0 or system.damped == 0:
            return False
    for m in range(system.coordinates):
        trace.away[0, m] = motion.z[m] - trace.still[0, m]
        trace.away[1, m] = motion.rate[m] - trace.still[1, m]
    for i in range(2):
        bias, swing = largest_drive(i, system, trace.away[0], trace.away[1])
        for d in (-1, 1):
            free = d * motion.z[system.place[i]] < axes[i].half_gap
            if free and d * bias + swing + trace.drive[i] > MARGIN * ball.threshold:
                return False
    return True


@kernel
def run_together(
    block: tuple[int, int],
    traces: Records,
    clocks: Records,
    systems: Records,
    motions: Records,
    axes: Records,
    balls: Records,
    books: Records,
    tables: tuple[Records, Floats],
    growth: Floats,
) -> None:
    """Follow pairs of motions, [:, 0] and [:, 1], that begin a nudge apart: their divergence a cycle, shape (n,)."""
    rows, states = tables
    for k in range(block[0], block[1]):
        apart, cycles = NUDGE, 0
        while cycles < TOGETHER and apart < APART:
            for i in range(2):
                where = clocks[k, i], systems[k], motions[k, i], axes[k, i], balls[k], books[k, i]
                if not cycle(traces[k, i], *where, rows, states):
                    return
            spin = traces[k, 0].spin
            for i in range(2):
                spin[i] = axes[k, 0, i].spin
            z, rate = motions[k, 0].z, motions[k, 0].rate
            apart = distance(traces[k, 0], systems[k], z, rate, spin, motions[k, 1], axes[k, 1])
            cycles += 1
        growth[k] = math.log(max(apart, 1e-300) / NUDGE) / cycles
