"""The event loop: detect, propagate, resolve, record."""

from __future__ import annotations

import math

import numba as nb
import numpy as np

from damper.detect import schedule
from damper.flight import begin, first_extremum, relative, structure, viscous_loss
from damper.peaks import next_window, watch
from damper.records import HIT, RELEASE, REVERSAL, ROLLING, RUB, START, STUCK
from damper.resolve import hit, rub, settle

DONE, PAUSED, FULL = 0, 1, 2
"""Why the loop returns: the end is reached, the budget of events is spent, or a table is full."""


@nb.njit(cache=True)
def release(clock, axes, laws, ball, rows):
    """Let go at time 0 from the displacements and positions in `axes`, everything at rest."""
    for i in range(2):
        settle(axes[i], laws[i], ball)
        _restart(i, RELEASE, 0.0, clock, axes, laws, ball, rows)
    _rest(clock, axes)


@nb.njit(cache=True)
def run(clock, axes, laws, ball, books, peak, peaks, rows, budget):
    """Go on until the end, for `budget` events, or until a table is full; call again to continue."""
    stop = clock.events + budget
    while True:
        i = 0 if axes[0].next <= axes[1].next else 1
        time = min(axes[i].next, clock.end)
        if not _observe(clock, axes, laws, peak, peaks, time):
            return FULL
        if time >= clock.end:
            for j in range(2):
                _fly(axes[j], laws[j], ball, books, time)
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


@nb.njit(cache=True)
def _happen(i, clock, axes, laws, ball, books, rows):
    """The next event of axis i: fly to it, resolve it, start the flights that follow."""
    axis, other = axes[i], axes[1 - i]
    kind = axis.kind
    _fly(axis, laws[i], ball, books, clock.time)
    before = axis.w
    if kind == START:
        axis.direction = axis.heading
    elif kind == REVERSAL:
        settle(axis, laws[i], ball)
    elif kind == HIT:
        clock.impacts += 1
        impulse = hit(axis, ball, books)
        if ball.friction > 0.0 and other.direction != 0:
            _fly(other, laws[1 - i], ball, books, clock.time)
            sliding = other.w
            rub(other, impulse, laws[1 - i], ball, books)
            _restart(1 - i, RUB, sliding, clock, axes, laws, ball, rows)
    _restart(i, kind, before, clock, axes, laws, ball, rows)


@nb.njit(cache=True)
def _fly(axis, laws, ball, books, time):
    """Bring an axis to `time`: its state there, and the work done on the way."""
    tau = time - axis.start
    law = laws[STUCK if axis.direction == 0 else ROLLING]
    books.structure += viscous_loss(axis, law, tau)
    s, w = axis.s, 0.0
    if axis.direction != 0:
        axis.demand = max(axis.demand, _demand(axis, law, ball, tau))
        s, w, _ = relative(axis, law, ball, tau)
        books.rolling += ball.mass * ball.threshold * abs(s - axis.s)
    axis.u, axis.v, _ = structure(axis, law, tau)
    axis.s, axis.w, axis.start = s, w, time


@nb.njit(cache=True)
def _demand(axis, law, ball, tau):
    """Largest force that rolling asks of the floor on this flight, per unit of the ball's mass [m/s^2]."""
    f = -axis.direction * ball.relative_push
    largest = 0.0
    extremum = first_extremum(axis, law, 2)
    for t in (0.0, extremum, extremum + math.pi / law.frequency, tau):
        if t <= tau:
            acceleration = structure(axis, law, t)[2]
            largest = max(largest, abs((1.0 - ball.inertia_ratio) * acceleration + f))
    return largest


@nb.njit(cache=True)
def _restart(i, kind, before, clock, axes, laws, ball, rows):
    """Begin the flight that follows an event of axis i, schedule its end, and write the event's row if asked."""
    axis = axes[i]
    begin(axis, laws[i], ball, clock.time)
    schedule(axis, laws[i], ball, clock.end)
    if len(rows) > 0:
        row = rows[clock.rows]
        row.time, row.axis, row.kind = clock.time, i, kind
        row.u, row.v, row.s, row.w = axis.u, axis.v, axis.s, axis.w
        row.direction, row.w_before = axis.direction, before
        clock.rows += 1


@nb.njit(cache=True)
def _observe(clock, axes, laws, peak, peaks, time):
    """Seek velocity maxima up to `time`; False if their table is full."""
    while watch(peak, axes, laws, clock.watched, time):
        if clock.peaks == len(peaks):
            return False
        peaks[clock.peaks, 0], peaks[clock.peaks, 1] = peak.time, peak.speed
        clock.peaks += 1
        clock.watched = peak.closes
        next_window(peak)
    clock.watched = time
    if axes[0].direction != 0 or axes[1].direction != 0:
        clock.last_motion = time
    return True


@nb.njit(cache=True)
def _rest(clock, axes):
    """Once both axes stick and nothing will ever happen again, the run ends a little later."""
    for i in range(2):
        if axes[i].direction != 0 or axes[i].next < np.inf:
            return
    clock.rest = clock.time
    clock.end = min(clock.end, clock.time + clock.tail)
