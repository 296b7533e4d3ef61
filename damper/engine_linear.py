"""The event loop where the load pulls the ball aside or several modes move the cavity: detect, fly, resolve, record."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.engine import DIED_OUT, DONE, FULL, NEAR, PAUSED, TREMOR, settle_down
from damper.guards import largest_drive, seek
from damper.jumps import hit, read, rebound, rub, settle
from damper.peaks import close, resume
from damper.records import GRIP, HIT, NOTHING, RELEASE, REVERSAL, ROLLING, RUB, SLIPPING, START, STUCK
from damper.resolve import roll, slip
from damper.series import dissipated, expand, increment, put_in, rates
from damper.slip import sliding_distance, spin_after
from damper.watch import watch

if TYPE_CHECKING:
    from damper.arrays import Floats, Integers, Record, Records


@kernel
def release(
    clock: Record, system: Record, motion: Record, axes: Records, ball: Record, rows: Records, states: Floats
) -> None:
    """Let go at time 0 from the state in `motion`."""
    let_go(system, motion, axes, ball)
    for i in range(2):
        _write(i, RELEASE, axes[i].w, clock, system, motion, axes, rows, states)
    for g in range(system.groups):
        restart(g, 0.0, system, motion, axes, ball)
    _rest(clock, system, motion, 0.0)


@kernel
def let_go(system: Record, motion: Record, axes: Records, ball: Record) -> None:
    """The regimes in which the state in `motion` begins at time 0."""
    for i in range(2):
        read(i, system, motion, axes)
    for i in range(2):
        if ball.grip > 0.0 and axes[i].spin != axes[i].w:
            slip(axes[i])
        elif axes[i].w == 0.0:
            settle(i, system, motion, axes, ball, 0.0)
        else:
            roll(axes[i], 1 if axes[i].w > 0.0 else -1)


@kernel
def restart(g: int, time: float, system: Record, motion: Record, axes: Records, ball: Record) -> None:
    """Begin the flight that follows an event of a group, or the next step of one, and seek its end."""
    motion.start[g] = time
    for i in range(system.first[g], system.last[g]):
        axes[i].f = -axes[i].direction * ball.grip if axes[i].regime == SLIPPING else 0.0
    expand(g, system, motion, axes, ball)
    seek(g, system, motion, axes, ball)


@kernel
def run(
    clock: Record,
    system: Record,
    motion: Record,
    axes: Records,
    ball: Record,
    books: Record,
    cycle: Record,
    peaks: Floats,
    rows: Records,
    states: Floats,
    budget: int,
) -> int:
    """Go on until the end, for `budget` events, or until a table is full; call again to continue."""
    stop = clock.events + budget
    while True:
        g = 0 if system.groups == 1 or motion.next[0] <= motion.next[1] else 1
        time = min(motion.next[g], clock.end)
        if not _observe(clock, system, motion, axes, ball, books, cycle, peaks, time):
            return FULL
        if time >= clock.end:
            for each in range(system.groups):
                fly(each, (time - motion.start[each]) / system.span[each], system, motion, axes, ball, books)
                motion.start[each] = time
            resume(cycle, clock.last_motion)
            clock.time = time
            return DONE
        if motion.kind[g] == NOTHING:
            fly(g, 1.0, system, motion, axes, ball, books)
            restart(g, time, system, motion, axes, ball)
            _rest(clock, system, motion, time)
            continue
        if clock.events >= stop:
            return PAUSED
        if len(rows) > 0 and clock.rows + 2 > len(rows):
            return FULL
        clock.time = time
        clock.events += 1
        happen(g, clock, system, motion, axes, ball, books, rows, states)
        _rest(clock, system, motion, time)


@kernel
def run_block(
    block: tuple[int, int],
    clocks: Records,
    systems: Records,
    motions: Records,
    axes: Records,
    balls: Records,
    books: Records,
    cycles: Records,
    tables: tuple[Floats, Records, Floats],
    budget: int,
    status: Integers,
) -> None:
    """Run the ring-downs from `block[0]` to before `block[1]` to their ends, one after the other, without tables."""
    peaks, rows, states = tables
    for k in range(block[0], block[1]):
        system, motion = systems[k], motions[k]
        release(clocks[k], system, motion, axes[k], balls[k], rows, states)
        status[k] = run(clocks[k], system, motion, axes[k], balls[k], books[k], cycles[k], peaks, rows, states, budget)


@kernel
def happen(
    g: int,
    clock: Record,
    system: Record,
    motion: Record,
    axes: Records,
    ball: Record,
    books: Record,
    rows: Records,
    states: Floats,
) -> None:
    """The next event of a group: fly to it, resolve it, start the flights that follow."""
    i, kind = motion.axis[g], motion.kind[g]
    axis, other = axes[i], axes[1 - i]
    fly(g, motion.at[g], system, motion, axes, ball, books)
    before, sliding, touched = axis.w, other.w, False
    if kind == START and axis.spin != 0.0:
        slip(axis)
    elif kind == START:
        roll(axis, axis.heading)
    elif kind == REVERSAL:
        settle(i, system, motion, axes, ball, clock.time)
    elif kind == GRIP:
        _grip(i, system, motion, axes, ball, clock.time)
    elif kind == HIT:
        clock.impacts += 1
        if system.groups == 2 and ball.friction > 0.0 and other.regime != STUCK:
            span = system.span[1 - g]
            fly(1 - g, (clock.time - motion.start[1 - g]) / span, system, motion, axes, ball, books)
            sliding = other.w
        impulse = hit(i, system, motion, axes, ball, books)
        touched = ball.friction > 0.0 and other.regime != STUCK
        if touched:
            rub(1 - i, impulse, system, motion, axes, ball, books, clock.time)
        rebound(i, system, motion, axes, ball, books)
        if touched or system.groups == 1:
            _write(1 - i, RUB, sliding, clock, system, motion, axes, rows, states)
    if touched and system.groups == 2:
        restart(1 - g, clock.time, system, motion, axes, ball)
    restart(g, clock.time, system, motion, axes, ball)
    _write(i, kind, before, clock, system, motion, axes, rows, states)


@kernel
def _grip(i: int, system: Record, motion: Record, axes: Records, ball: Record, time: float) -> None:
    """Sliding ends: the ball rolls on, or its spin against a wall is spent."""
    if axes[i].regime == STUCK:
        axes[i].spin = 0.0
    elif axes[i].w == 0.0:
        settle(i, system, motion, axes, ball, time)
    else:
        roll(axes[i], 1 if axes[i].w > 0.0 else -1)


@kernel
def fly(g: int, x: float, system: Record, motion: Record, axes: Records, ball: Record, books: Record) -> None:
    """Bring a group x steps on from its start: its state there, and the work done on the way."""
    low, high, first, last = system.low[g], system.high[g], system.first[g], system.last[g]
    span = system.span[g]
    books.structure += dissipated(g, system, motion, x)
    books.work += put_in(g, system, motion, x)
    for i in range(first, last):
        if axes[i].regime == ROLLING:
            _account(motion.series[system.place[i]], x, span, axes[i], ball)
    for m in range(low, high):
        motion.gain[m], rate = increment(motion.series[m], x)
        motion.z[m] += motion.gain[m]
        motion.rate[m] = rate / span
    for i in range(first, last):
        read(i, system, motion, axes)
        _spend(axes[i], motion.gain[system.place[i]], x * span, ball, books)


@kernel
def _spend(axis: Record, path: float, tau: float, ball: Record, books: Record) -> None:
    """Spin after a flight of length tau, and what the floor took on it."""
    if axis.regime == ROLLING:
        books.rolling += ball.mass * ball.threshold * abs(path)
        axis.spin = axis.w
    elif axis.spin != 0.0 or axis.regime == SLIPPING:
        spin = spin_after(axis, ball, tau)
        if axis.regime == SLIPPING:
            books.slip += ball.mass * ball.grip * abs(sliding_distance(axis, path, tau))
        else:
            books.slip += 0.5 * ball.spin_mass * (axis.spin - spin) * (axis.spin + spin)
        axis.spin = spin


@kernel
def _account(s: Floats, x: float, span: float, axis: Record, ball: Record) -> None:
    """Largest force that rolling asked of the floor on this flight, per unit of the ball's mass [m/s^2].

    That is spin_mass s'' + rolling resistance: largest where s'' is, at an end or where its slope vanishes.
    """
    share, resistance = ball.spin_mass / ball.mass, axis.direction * ball.threshold
    square = 1.0 / (span * span)
    most = 0.0
    for k in range(len(s) - 1, 1, -1):
        most = most * x + k * (k - 1) * abs(s[k])
    if share * most * square + abs(resistance) <= axis.demand:
        return
    here, there = 2.0 * s[2] * square, rates(s, x)[1] * square
    axis.demand = max(axis.demand, abs(share * here + resistance), abs(share * there + resistance))
    crest = rates(s, _crest(s, x))[1] * square
    axis.demand = max(axis.demand, abs(share * crest + resistance))


@kernel
def _crest(s: Floats, end: float) -> float:
    """Where the second derivative of a series is extreme within a step; its end where it is monotone."""
    low, high = 0.0, end
    rises = _third(s, low) > 0.0
    if rises == (_third(s, high) > 0.0):
        return end
    for _ in range(24):
        middle = 0.5 * (low + high)
        if (_third(s, middle) > 0.0) == rises:
            low = middle
        else:
            high = middle
    return low


@kernel
def _third(s: Floats, x: float) -> float:
    """Third derivative of a series."""
    third = 0.0
    for k in range(len(s) - 1, 2, -1):
        third = third * x + k * (k - 1) * (k - 2) * s[k]
    return third


@kernel
def _write(
    i: int,
    kind: int,
    before: float,
    clock: Record,
    system: Record,
    motion: Record,
    axes: Records,
    rows: Records,
    states: Floats,
) -> None:
    """An event's row, and the state of the whole motion that goes with it, if asked."""
    if len(rows) == 0:
        return
    row, axis = rows[clock.rows], axes[i]
    row.time, row.axis, row.kind = clock.time, i, kind
    row.u, row.v, row.s, row.w = axis.u, axis.v, axis.s, axis.w
    row.spin, row.regime, row.direction, row.w_before = axis.spin, axis.regime, axis.direction, before
    for m in range(system.coordinates):
        states[clock.rows, 0, m], states[clock.rows, 1, m] = motion.z[m], motion.rate[m]
    clock.rows += 1


@kernel
def _observe(
    clock: Record,
    system: Record,
    motion: Record,
    axes: Records,
    ball: Record,
    books: Record,
    cycle: Record,
    peaks: Floats,
    time: float,
) -> bool:
    """Seek velocity maxima up to `time`; False if their table is full."""
    while watch(cycle, system, motion, ball.host_mass + ball.mass, clock.watched, time):
        if len(peaks) > 0:
            if clock.peaks == len(peaks):
                return False
            peaks[clock.peaks, 0], peaks[clock.peaks, 1] = cycle.time, cycle.speed
        clock.peaks += 1
        clock.watched = cycle.closes
        _tremor(clock, system, motion, ball, books, cycle)
        close(cycle, clock.last_motion)
    clock.watched = time
    if axes[0].regime != STUCK or axes[1].regime != STUCK:
        clock.last_motion = time
    return True


@kernel
def _tremor(clock: Record, system: Record, motion: Record, ball: Record, books: Record, cycle: Record) -> None:
    """End a run soon in which nothing more will happen that counts; see `damper.engine`."""
    energy = 0.5 * ball.host_mass * cycle.speed * cycle.speed
    still = clock.impacts == clock.last_impacts and books.rolling - clock.last_rolling <= TREMOR * energy
    if clock.peaks == 1:
        clock.first_speed = cycle.speed
    clock.last_impacts, clock.last_rolling = clock.impacts, books.rolling
    if clock.rest < np.inf or clock.tail == np.inf or system.frequency > 0.0:
        return
    if cycle.speed <= DIED_OUT * clock.first_speed:
        clock.trembles = 2
        settle_down(clock)
    elif still and ball.threshold > 0.0:
        for i in range(2):
            bias, swing = largest_drive(i, system, motion.z, motion.rate)
            if abs(bias) + swing > NEAR * ball.threshold:
                return
        clock.trembles = 1
        settle_down(clock)


@kernel
def _rest(clock: Record, system: Record, motion: Record, now: float) -> None:
    """Once nothing will ever happen again, the run ends a little later than the last event."""
    for g in range(system.groups):
        if motion.settled[g] == 0:
            return
    if clock.rest == np.inf:
        settle_down(clock)
        clock.end = max(clock.end, now)
