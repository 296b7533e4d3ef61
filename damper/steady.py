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
from damper.drive import largest_drive
from damper.engine_linear import arrive, fly, happen, restart
from damper.jumps import let_go
from damper.records import NOTHING, STUCK
from damper.tallies import BATCHES, GOES_ON, LOCKED, PERIODIC, TIRED, UNSETTLED
from damper.threshold import MARGIN
from damper.trace import add_batch, add_cycle, close_tally, distance, follow, mark, open_tally
from damper.verdict import judge

if TYPE_CHECKING:
    from damper.arrays import Floats, Record, Records
    from damper.tables import Tables

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
def cycle(it: Record, flow: Floats, tables: Tables) -> bool:
    """Go through one cycle of the force; False where it has too many events."""
    trace, clock, motion = it.envelope, it.run.clock, it.run.motion
    stop, begin = clock.events + EVENTS, 0.0
    trace.high, trace.low = -np.inf, np.inf
    for g in range(it.run.system.groups):
        restart(g, 0.0, it.run, flow)
    while True:
        g = 0 if it.run.system.groups == 1 or motion.next[0] <= motion.next[1] else 1
        time = min(motion.next[g], trace.period)
        follow(it, begin, time)
        begin = time
        if time >= trace.period:
            arrive(it.run, time)
            trace.cycles += 1
            return True
        if motion.kind[g] == NOTHING:
            fly(g, 1.0, it.run)
            restart(g, time, it.run, flow)
            continue
        if clock.events >= stop:
            return False
        clock.time = time
        clock.events += 1
        happen(g, it.run, flow, tables)


@kernel
def run_block(block: tuple[int, int], runs: Records, flows: Floats, tables: Tables, accuracy: float, most: int) -> None:
    """Bring the motions from `block[0]` to before `block[1]` to their steady states, one after the other."""
    for k in range(block[0], block[1]):
        if runs[k].envelope.verdict != LOCKED:
            flow = flows[runs[k].run.system.flow]
            let_go(runs[k].run, flow)
            _settle(runs[k], flow, tables, accuracy, most)


@kernel
def _settle(it: Record, flow: Floats, tables: Tables, accuracy: float, most: int) -> None:
    """Double the run until its second half is steady."""
    trace = it.envelope
    length = trace.patience
    trace.verdict = GOES_ON
    open_tally(it.window, it)
    open_tally(it.last, it)
    for _ in range(length):
        if not _one(it, flow, tables):
            return
    while trace.verdict == GOES_ON:
        if not _look(length, it, flow, tables):
            return
        judge(trace, it.window, length, accuracy)
        length *= 2
        if trace.verdict == GOES_ON and trace.cycles + length > most:
            trace.verdict = UNSETTLED
    if trace.verdict == PERIODIC:
        open_tally(it.last, it)
        for _ in range(trace.repeats):
            if not _one(it, flow, tables):
                return
        close_tally(it.last, it)


@kernel
def _one(it: Record, flow: Floats, tables: Tables) -> bool:
    """A cycle and its amplitude; False where that settles it."""
    trace = it.envelope
    if _locked(it):
        trace.verdict = LOCKED
        return False
    before = it.run.clock.impacts
    if not cycle(it, flow, tables):
        trace.verdict = TIRED
        return False
    add_cycle(it.last, 0.5 * (trace.high - trace.low), it.run.clock.impacts - before)
    return True


@kernel
def _look(length: int, it: Record, flow: Floats, tables: Tables) -> bool:
    """Go through a window, batch by batch; False where it ends before."""
    trace = it.envelope
    open_tally(it.window, it)
    for batch in range(BATCHES):
        open_tally(it.last, it)
        mark(it)
        near, repeats, halfway = np.inf, 0, 2 * (batch + 1) % BATCHES == 0
        for n in range(length // BATCHES):
            if not _one(it, flow, tables):
                return False
            if n < _LONGEST and halfway:
                here = distance(it, trace)
                if here < _MUCH * near and near > _SAME:  # a multiple of the period is hardly nearer
                    near, repeats = here, n + 1
        if halfway:
            trace.near[2 * (batch + 1) // BATCHES - 1], trace.repeats = near, repeats
        close_tally(it.last, it)
        add_batch(batch, it)
    close_tally(it.window, it)
    return True


@kernel
def _locked(it: Record) -> bool:
    """Whether the ball, at rest, will never move again: the structure's own motion dies out."""
    trace, system, motion, axes = it.envelope, it.run.system, it.run.motion, it.run.axes
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
            if free and d * bias + swing + trace.drive[i] > MARGIN * it.run.ball.threshold:
                return False
    return True


@kernel
def run_together(block: tuple[int, int], runs: Records, flows: Floats, tables: Tables, growth: Floats) -> None:
    """Follow pairs of motions, [:, 0] and [:, 1], that begin a nudge apart: their divergence a cycle, shape (n,)."""
    for k in range(block[0], block[1]):
        one, other, flow = runs[k, 0], runs[k, 1], flows[runs[k, 0].run.system.flow]
        apart, cycles = NUDGE, 0
        while cycles < TOGETHER and apart < APART:
            if not (cycle(one, flow, tables) and cycle(other, flow, tables)):
                return
            mark(one)
            apart = distance(other, one.envelope)
            cycles += 1
        growth[k] = math.log(max(apart, 1e-300) / NUDGE) / cycles
