"""The event loop: detect, propagate, resolve, record."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.detect import look, schedule
from damper.flight import begin, increments, structure, viscous_loss
from damper.peaks import close, resume, watch
from damper.records import GRIP, HIT, NOTHING, RELEASE, REVERSAL, ROLLING, RUB, SLIPPING, START, STUCK
from damper.resolve import hit, roll, rub, settle, slip
from damper.slip import sliding_distance, spin_after

if TYPE_CHECKING:
    from damper.arrays import Floats, Integers, Record, Records

DONE, PAUSED, FULL = 0, 1, 2
"""Why the loop returns: the end is reached, the budget of events is spent, or a table is full."""

DIED_OUT = 1e-6
"""Share of its first velocity maximum at which a vibration is over, whatever the ball does."""

NEAR = 1.01
"""Acceleration over the rolling threshold at which a ball that rolls next to nothing is taken to tremble there."""

TREMOR = 1e-7
"""Share of the energy that a ball must roll away in a cycle to count as moving, where it hits nothing."""


@kernel
def release(clock: Record, axes: Records, laws: Records, ball: Record, rows: Records) -> None:
    """Let go at time 0 from the state in `axes`."""
    for i in range(2):
        if ball.grip > 0.0 and axes[i].spin != axes[i].w:
            slip(axes[i])
        elif axes[i].w == 0.0:
            settle(axes[i], laws[i], ball)
        else:
            roll(axes[i], 1 if axes[i].w > 0.0 else -1)
        _restart(i, RELEASE, 0.0, clock, axes, laws, ball, rows)
    _rest(clock, axes)


@kernel
def run(
    clock: Record,
    axes: Records,
    laws: Records,
    ball: Record,
    books: Record,
    cycle: Record,
    peaks: Floats,
    rows: Records,
    budget: int,
) -> int:
    """Go on until the end, for `budget` events, or until a table is full; call again to continue."""
    stop = clock.events + budget
    while True:
        i = 0 if axes[0].next <= axes[1].next else 1
        if axes[i].kind == NOTHING and axes[i].next < clock.end:
            look(axes[i], laws[i], ball, clock.end)
            continue
        time = min(axes[i].next, clock.end)
        if not _observe(clock, axes, laws, ball, books, cycle, peaks, time):
            return FULL
        if time >= clock.end:
            for j in range(2):
                _fly(axes[j], laws[j], ball, books, time - axes[j].start)
            resume(cycle, clock.last_motion)
            clock.time = time
            return DONE
        if clock.events >= stop:
            return PAUSED
        if len(rows) > 0 and clock.rows + 2 > len(rows):
            return FULL
        clock.time = time
        clock.events += 1
        _happen(i, clock, axes, laws, ball, books, rows)
        _rest(clock, axes)


@kernel
def run_block(
    block: tuple[int, int],
    clocks: Records,
    axes: Records,
    laws: Records,
    balls: Records,
    books: Records,
    cycles: Records,
    tables: tuple[Floats, Records],
    budget: int,
    status: Integers,
) -> None:
    """Run the ring-downs from `block[0]` to before `block[1]` to their ends, one after the other, without tables."""
    peaks, rows = tables
    for k in range(block[0], block[1]):
        release(clocks[k], axes[k], laws[k], balls[k], rows)
        status[k] = run(clocks[k], axes[k], laws[k], balls[k], books[k], cycles[k], peaks, rows, budget)


@kernel
def _happen(i: int, clock: Record, axes: Records, laws: Records, ball: Record, books: Record, rows: Records) -> None:
    """The next event of axis i: fly to it, resolve it, start the flights that follow."""
    axis, other = axes[i], axes[1 - i]
    kind = axis.kind
    _fly(axis, laws[i], ball, books, axis.due)
    before = axis.w
    if kind == START and axis.spin != 0.0:
        slip(axis)
    elif kind == START:
        roll(axis, axis.heading)
    elif kind == REVERSAL:
        settle(axis, laws[i], ball)
    elif kind == GRIP:
        _grip(axis, laws[i], ball)
    elif kind == HIT:
        clock.impacts += 1
        impulse = hit(axis, ball, books)
        if ball.friction > 0.0 and other.regime != STUCK:
            _fly(other, laws[1 - i], ball, books, clock.time - other.start)
            sliding = other.w
            rub(other, impulse, laws[1 - i], ball, books)
            _restart(1 - i, RUB, sliding, clock, axes, laws, ball, rows)
    _restart(i, kind, before, clock, axes, laws, ball, rows)


@kernel
def _grip(axis: Record, laws: Records, ball: Record) -> None:
    """Sliding ends: the ball rolls on, or its spin against a wall is spent."""
    if axis.regime == STUCK:
        axis.spin = 0.0
    elif axis.w == 0.0:
        settle(axis, laws, ball)
    else:
        roll(axis, 1 if axis.w > 0.0 else -1)


@kernel
def _fly(axis: Record, laws: Records, ball: Record, books: Record, tau: float) -> None:
    """Bring an axis to a flight time tau after its start: its state there, and the work done on the way."""
    law = laws[axis.regime]
    books.structure += viscous_loss(axis, law, tau)
    du, dv, acceleration = increments(axis, law, tau)
    path = 0.0
    if axis.regime != STUCK:
        path = axis.w * tau - axis.beta * du + 0.5 * axis.f * tau * tau
        axis.s += path
        axis.w += axis.f * tau - axis.beta * dv
    if axis.regime == ROLLING:
        _account(axis, law, tau, acceleration)
        books.rolling += ball.mass * ball.threshold * abs(path)
        axis.spin = axis.w
    elif axis.spin != 0.0 or axis.regime == SLIPPING:
        spin = spin_after(axis, ball, tau)
        if axis.regime == SLIPPING:
            books.slip += ball.mass * ball.grip * abs(sliding_distance(axis, path, tau))
        else:
            books.slip += 0.5 * ball.spin_mass * (axis.spin - spin) * (axis.spin + spin)
        axis.spin = spin
    axis.u += axis.v * tau + du
    axis.v += dv


@kernel
def _account(axis: Record, law: Record, tau: float, acceleration: float) -> None:
    """Largest force that rolling asked of the floor on this flight, per unit of the ball's mass [m/s^2]."""
    share = 1.0 - axis.beta
    at_start = -2.0 * law.decay * axis.v - law.square * (axis.u - axis.offset)
    axis.demand = max(axis.demand, abs(share * at_start + axis.f), abs(share * acceleration + axis.f))
    crest = axis.crest
    for _ in range(2):
        if crest < tau:
            axis.demand = max(axis.demand, abs(share * structure(axis, law, crest)[2] + axis.f))
        crest += math.pi / law.frequency


@kernel
def _restart(
    i: int, kind: int, before: float, clock: Record, axes: Records, laws: Records, ball: Record, rows: Records
) -> None:
    """Begin the flight that follows an event of axis i, schedule its end, and write the event's row if asked."""
    axis = axes[i]
    begin(axis, laws[i], ball, clock.time)
    schedule(axis, laws[i], ball, clock.end)
    if len(rows) > 0:
        row = rows[clock.rows]
        row.time, row.axis, row.kind = clock.time, i, kind
        row.u, row.v, row.s, row.w = axis.u, axis.v, axis.s, axis.w
        row.spin, row.regime, row.direction, row.w_before = axis.spin, axis.regime, axis.direction, before
        clock.rows += 1


@kernel
def _observe(
    clock: Record,
    axes: Records,
    laws: Records,
    ball: Record,
    books: Record,
    cycle: Record,
    peaks: Floats,
    time: float,
) -> bool:
    """Seek velocity maxima up to `time`; False if their table is full."""
    while watch(cycle, axes, laws, clock.watched, time):
        if len(peaks) > 0:
            if clock.peaks == len(peaks):
                return False
            peaks[clock.peaks, 0], peaks[clock.peaks, 1] = cycle.time, cycle.speed
        clock.peaks += 1
        clock.watched = cycle.closes
        _tremor(clock, axes, laws, ball, books, cycle)
        close(cycle, clock.last_motion)
    clock.watched = time
    if axes[0].regime != STUCK or axes[1].regime != STUCK:
        clock.last_motion = time
    return True


@kernel
def _tremor(clock: Record, axes: Records, laws: Records, ball: Record, books: Record, cycle: Record) -> None:
    """End a run soon in which nothing more will happen that counts.

    Either the ball, a cycle long, hit no wall and rolled away next to nothing, on a structure whose acceleration is at
    the threshold: without damping of its own it nears the threshold for ever. Or the vibration has died out.
    """
    energy = 0.5 * ball.host_mass * cycle.speed * cycle.speed
    still = clock.impacts == clock.last_impacts and books.rolling - clock.last_rolling <= TREMOR * energy
    if clock.peaks == 1:
        clock.first_speed = cycle.speed
    clock.last_impacts, clock.last_rolling = clock.impacts, books.rolling
    if clock.rest < np.inf or clock.tail == np.inf:
        return
    if cycle.speed <= DIED_OUT * clock.first_speed:
        clock.trembles = 2
        settle_down(clock)
    elif still and ball.threshold > 0.0:
        for i in range(2):
            law = laws[i, STUCK]
            square = law.square
            if math.sqrt((square * axes[i].u) ** 2 + square * axes[i].v ** 2) > NEAR * ball.threshold:
                return
        clock.trembles = 1
        settle_down(clock)


@kernel
def _rest(clock: Record, axes: Records) -> None:
    """Once both axes stick and nothing will ever happen again, the run ends a little later."""
    for i in range(2):
        if axes[i].regime != STUCK or axes[i].next < np.inf:
            return
    if clock.rest == np.inf:
        settle_down(clock)


@kernel
def settle_down(clock: Record) -> None:
    """End the run a little after the last event."""
    clock.rest = clock.time
    clock.end = min(clock.end, clock.time + clock.tail)
