"""The event loop where the load pulls the ball aside or several modes move the cavity: detect, fly, resolve, record."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.demand import account
from damper.drive import strongest_drive
from damper.ending import DONE, FULL, PAUSED, end_cycle, settle_down
from damper.guards import seek
from damper.jumps import let_go, read, resolve
from damper.keeping import full, write_event
from damper.peaks import pass_time, resume
from damper.records import HIT, NOTHING, RELEASE, ROLLING, RUB, SLIPPING, STUCK
from damper.series import expand
from damper.slip import spend
from damper.travel import travel
from damper.watch import watch

if TYPE_CHECKING:
    from damper.arrays import Floats, Integers, Record, Records
    from damper.tables import Tables


@kernel
def release(it: Record, flow: Floats, tables: Tables) -> None:
    """Let go at time 0 from the state in `it.motion`."""
    let_go(it, flow)
    for i in range(2):
        _record(i, RELEASE, it.axes[i].w, it, tables)
    for g in range(it.system.groups):
        restart(g, 0.0, it, flow)
    _rest(it, 0.0)


@kernel
def restart(g: int, time: float, it: Record, flow: Floats) -> None:
    """Begin the flight that follows an event of a group, or the next step of one, and seek its end."""
    it.motion.start[g] = time
    for i in range(it.system.first[g], it.system.last[g]):
        axis = it.axes[i]
        axis.f = -axis.direction * it.ball.grip if axis.regime == SLIPPING else 0.0
    expand(g, it, flow)
    seek(g, it)


@kernel
def run(it: Record, flow: Floats, tables: Tables, budget: int) -> int:
    """Go on until the end, for `budget` events, or until a table is full; call again to continue."""
    clock, motion = it.clock, it.motion
    stop = clock.events + budget
    while True:
        g = 0 if it.system.groups == 1 or motion.next[0] <= motion.next[1] else 1
        time = min(motion.next[g], clock.end)
        if not _observe(it, tables, time):
            return FULL
        if time >= clock.end:
            arrive(it, time)
            resume(it.cycle, clock.last_motion)
            clock.time = time
            return DONE
        if motion.kind[g] == NOTHING:
            fly(g, 1.0, it)
            restart(g, time, it, flow)
            _rest(it, time)
            continue
        if clock.events >= stop:
            return PAUSED
        if full(it, tables):
            return FULL
        clock.time = time
        clock.events += 1
        happen(g, it, flow, tables)
        _rest(it, time)


@kernel
def run_block(
    block: tuple[int, int], runs: Records, flows: Floats, tables: Tables, budget: int, status: Integers
) -> None:
    """Run the ring-downs from `block[0]` to before `block[1]` to their ends, one after the other, without tables."""
    for k in range(block[0], block[1]):
        it, flow = runs[k], flows[runs[k].system.flow]
        release(it, flow, tables)
        status[k] = run(it, flow, tables, budget)


@kernel
def happen(g: int, it: Record, flow: Floats, tables: Tables) -> None:
    """The next event of a group: fly to it, resolve it, start the flights that follow, record it."""
    i, kind, time = it.motion.axis[g], it.motion.kind[g], it.clock.time
    axis, other, apart = it.axes[i], it.axes[1 - i], it.system.groups == 2
    fly(g, it.motion.at[g], it)
    if apart and kind == HIT and it.ball.friction > 0.0 and other.regime != STUCK:
        fly(1 - g, (time - it.motion.start[1 - g]) / it.system.span[1 - g], it)
    before, sliding = axis.w, other.w
    rubbed = resolve(i, kind, it, flow)
    if rubbed or (kind == HIT and not apart):
        _record(1 - i, RUB, sliding, it, tables)
    if rubbed and apart:
        restart(1 - g, time, it, flow)
    restart(g, time, it, flow)
    _record(i, kind, before, it, tables)


@kernel
def arrive(it: Record, time: float) -> None:
    """Bring all groups to a time, in the middle of their flights."""
    for g in range(it.system.groups):
        fly(g, (time - it.motion.start[g]) / it.system.span[g], it)
        it.motion.start[g] = time


@kernel
def fly(g: int, x: float, it: Record) -> None:
    """Bring a group x steps on from its start: its state there, and the work done on the way."""
    system, motion, axes = it.system, it.motion, it.axes
    span = system.span[g]
    for i in range(system.first[g], system.last[g]):
        if axes[i].regime == ROLLING:
            account(motion.series[g, system.lane[i]], x, span, axes[i], it.ball)
    travel(g, x, it)
    for i in range(system.first[g], system.last[g]):
        read(i, it)
        spend(axes[i], motion.gain[system.place[i]], x * span, it.ball, it.books)


@kernel
def _record(i: int, kind: int, before: float, it: Record, tables: Tables) -> None:
    """An event's row, and the state of the whole motion that goes with it, if asked."""
    if len(tables.rows) > 0:
        for m in range(it.system.coordinates):
            tables.states[it.clock.rows, 0, m] = it.motion.z[m]
            tables.states[it.clock.rows, 1, m] = it.motion.rate[m]
    write_event(i, kind, before, it, tables)


@kernel
def _observe(it: Record, tables: Tables, time: float) -> bool:
    """Seek velocity maxima up to `time`; False if their table is full."""
    while watch(it, it.clock.watched, time):
        if not end_cycle(it, tables, strongest_drive(it)):
            return False
    pass_time(it, time)
    return True


@kernel
def _rest(it: Record, now: float) -> None:
    """Once nothing will ever happen again, the run ends a little later than the last event."""
    for g in range(it.system.groups):
        if it.motion.settled[g] == 0:
            return
    if it.clock.rest == np.inf:
        settle_down(it.clock)
        it.clock.end = max(it.clock.end, now)
