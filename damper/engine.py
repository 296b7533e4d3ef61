"""The event loop: detect, propagate, resolve, record."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.detect import look, schedule
from damper.ending import DONE, FULL, PAUSED, end_cycle, settle_down
from damper.flight import begin, increments, structure, viscous_loss
from damper.keeping import full, write_event
from damper.peaks import pass_time, resume, watch
from damper.records import GRIP, HIT, NOTHING, RELEASE, REVERSAL, ROLLING, RUB, START, STUCK
from damper.resolve import hit, roll, roll_on, rub, settle, slip
from damper.slip import spend

if TYPE_CHECKING:
    from damper.arrays import Integers, Record, Records
    from damper.tables import Tables


@kernel
def release(it: Record, tables: Tables) -> None:
    """Let go at time 0 from the state in `it.axes`."""
    for i in range(2):
        axis = it.axes[i]
        if it.ball.grip > 0.0 and axis.spin != axis.w:
            slip(axis)
        elif axis.w == 0.0:
            settle(axis, it.laws[i], it.ball)
        else:
            roll_on(axis)
        _restart(i, RELEASE, 0.0, it, tables)
    _rest(it)


@kernel
def run(it: Record, tables: Tables, budget: int) -> int:
    """Go on until the end, for `budget` events, or until a table is full; call again to continue."""
    clock, axes = it.clock, it.axes
    stop = clock.events + budget
    while True:
        i = 0 if axes[0].next <= axes[1].next else 1
        if axes[i].kind == NOTHING and axes[i].next < clock.end:
            look(axes[i], it.laws[i], it.ball, clock.end)
            continue
        time = min(axes[i].next, clock.end)
        if not _observe(it, tables, time):
            return FULL
        if time >= clock.end:
            for j in range(2):
                _fly(j, time - axes[j].start, it)
            resume(it.cycle, clock.last_motion)
            clock.time = time
            return DONE
        if clock.events >= stop:
            return PAUSED
        if full(it, tables):
            return FULL
        clock.time = time
        clock.events += 1
        _happen(i, it, tables)
        _rest(it)


@kernel
def run_block(block: tuple[int, int], runs: Records, tables: Tables, budget: int, status: Integers) -> None:
    """Run the ring-downs from `block[0]` to before `block[1]` to their ends, one after the other, without tables."""
    for k in range(block[0], block[1]):
        release(runs[k], tables)
        status[k] = run(runs[k], tables, budget)


@kernel
def _happen(i: int, it: Record, tables: Tables) -> None:
    """The next event of axis i: fly to it, resolve it, start the flights that follow."""
    axis, other, laws, ball = it.axes[i], it.axes[1 - i], it.laws[i], it.ball
    kind = axis.kind
    _fly(i, axis.due, it)
    before = axis.w
    if kind == START and axis.spin != 0.0:
        slip(axis)
    elif kind == START:
        roll(axis, axis.heading)
    elif kind == REVERSAL:
        settle(axis, laws, ball)
    elif kind == GRIP and axis.regime == STUCK:  # its spin against a wall is spent
        axis.spin = 0.0
    elif kind == GRIP and axis.w == 0.0:
        settle(axis, laws, ball)
    elif kind == GRIP:
        roll_on(axis)
    elif kind == HIT:
        it.clock.impacts += 1
        impulse = hit(axis, ball, it.books)
        if ball.friction > 0.0 and other.regime != STUCK:
            _fly(1 - i, it.clock.time - other.start, it)
            sliding = other.w
            rub(other, impulse, it.laws[1 - i], ball, it.books)
            _restart(1 - i, RUB, sliding, it, tables)
    _restart(i, kind, before, it, tables)


@kernel
def _fly(i: int, tau: float, it: Record) -> None:
    """Bring an axis to a flight time tau after its start: its state there, and the work done on the way."""
    axis, law = it.axes[i], it.laws[i, it.axes[i].regime]
    it.books.structure += viscous_loss(axis, law, tau)
    du, dv, acceleration = increments(axis, law, tau)
    path = 0.0
    if axis.regime != STUCK:
        path = axis.w * tau - axis.beta * du + 0.5 * axis.f * tau * tau
        axis.s += path
        axis.w += axis.f * tau - axis.beta * dv
        axis.excursion = max(axis.excursion, abs(axis.s))
    if axis.regime == ROLLING:
        _account(axis, law, tau, acceleration)
    spend(axis, path, tau, it.ball, it.books)
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
def _restart(i: int, kind: int, before: float, it: Record, tables: Tables) -> None:
    """Begin the flight that follows an event of axis i, schedule its end, and write the event's row if asked."""
    begin(it.axes[i], it.laws[i], it.ball, it.clock.time)
    schedule(it.axes[i], it.laws[i], it.ball, it.clock.end)
    write_event(i, kind, before, it, tables)


@kernel
def _observe(it: Record, tables: Tables, time: float) -> bool:
    """Seek velocity maxima up to `time`; False if their table is full."""
    while watch(it, it.clock.watched, time):
        if not end_cycle(it, tables, _strongest_drive(it)):
            return False
    pass_time(it, time)
    return True


@kernel
def _strongest_drive(it: Record) -> float:
    """Largest acceleration of a structure whose ball is stuck, along either axis, from here on [m/s^2]."""
    most = 0.0
    for i in range(2):
        square = it.laws[i, STUCK].square
        most = max(most, math.sqrt((square * it.axes[i].u) ** 2 + square * it.axes[i].v ** 2))
    return most


@kernel
def _rest(it: Record) -> None:
    """Once both axes stick and nothing will ever happen again, the run ends a little later."""
    for i in range(2):
        if it.axes[i].regime != STUCK or it.axes[i].next < np.inf:
            return
    if it.clock.rest == np.inf:
        settle_down(it.clock)
