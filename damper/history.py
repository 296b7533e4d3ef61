"""Motion at any time, from the event table of a ring-down."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from damper.compiled import kernel
from damper.flight import begin, expand, increment, increments, relative, travel
from damper.model import Floats
from damper.slip import spin_after
from damper.state import AXIS, ROLLING, SLIPPING, STUCK, balls_of, laws_of

if TYPE_CHECKING:
    from damper.model import Floats, Integers, Record, Records
    from damper.motion import RingDown
    from damper.state import Tables


@dataclass(frozen=True)
class History:
    """Motion at given times; the columns of the (n, 2) arrays are the axes x and y.

    Attributes:
        time: shape (n,) [s].
        displacement: of the structure, shape (n, 2) [m].
        velocity: of the structure, shape (n, 2) [m/s].
        relative_position: of the ball's centre from the cavity's centre, shape (n, 2) [m].
        relative_velocity: of the ball in the cavity, shape (n, 2) [m/s].
        spin: of the ball, as the speed of its surface about its centre, shape (n, 2) [m/s]; rolling, it is the
            relative velocity.
        regime: 0 stuck to the structure, 1 rolling, 2 slipping on the floor, shape (n, 2).
    """

    time: Floats
    displacement: Floats
    velocity: Floats
    relative_position: Floats
    relative_velocity: Floats
    spin: Floats
    regime: npt.NDArray[np.int64]


def sample(ringdown: RingDown, times: npt.ArrayLike) -> History:
    """The motion at `times` [s], shape (n,), exact to rounding; at an event, the state just after it.

    Raises:
        ValueError: the ring-down kept no events, or a time lies outside it.
    """
    if ringdown.rows is None:
        raise ValueError("the ring-down kept no events: call ringdown(..., keep_events=True)")
    time = np.atleast_1d(np.asarray(times, dtype=np.float64))
    if time.ndim != 1:
        raise ValueError(f"times must have shape (n,), got {time.shape}")
    if time.size and not (time.min() >= 0 and time.max() <= ringdown.duration * (1 + 1e-12)):
        raise ValueError(f"times must lie between 0 and the ring-down's end, {ringdown.duration:g} s")
    if ringdown.states is None:
        return _closed(ringdown, ringdown.rows, time)
    return _stepwise(ringdown, ringdown.rows, ringdown.states, time)


def _closed(ringdown: RingDown, rows: Records, time: Floats) -> History:
    """From the closed form of the flights."""
    laws, ball = laws_of(ringdown.damper.parameters)[0], _ball(ringdown)
    out = np.empty((5, time.size, 2))
    regime = np.empty((time.size, 2), np.int64)
    for i in range(2):
        events = rows[rows["axis"] == i]
        at = np.searchsorted(events["time"], time, side="right") - 1
        flights = np.zeros(time.size, AXIS)
        for name in ("u", "v", "s", "w", "spin", "regime", "direction"):
            flights[name] = events[name][at]
        flights["start"] = events["time"][at]
        evaluate(flights, laws[i], ball, time, out[:, :, i])
        regime[:, i] = flights["regime"]
    return History(time, out[0], out[1], out[2], out[3], out[4], regime)


def _stepwise(ringdown: RingDown, rows: Records, states: Floats, time: Floats) -> History:
    """From the states at the events, through the steps of the flights."""
    from damper.motion import flights, prepare
    from damper.state import Tables

    damper = ringdown.damper
    one = prepare(damper.parameters, np.zeros((1, 5, 2)), 1.0, 1.0)
    of = flights(damper, damper.parameters, one, ringdown.harmonic)
    order = np.argsort(time, kind="stable")
    out, regime = np.empty((5, time.size, 2)), np.empty((time.size, 2), np.int64)
    follow(of.runs[0], of.systems.flows[0], Tables(np.zeros((0, 2)), rows, states), time[order], out, regime)
    back = np.argsort(order)
    out = out[:, back]
    return History(time, out[0], out[1], out[2], out[3], out[4], regime[back])


def _ball(ringdown: RingDown) -> Record:
    ball: Record = balls_of(ringdown.damper.parameters, np.zeros(1))[0]
    return ball


@kernel
def evaluate(flights: Records, laws: Records, ball: Record, times: Floats, out: Floats) -> None:
    """Fill `out`, shape (5, n), with u, v, s, w and spin of n flights at n times."""
    for k in range(len(times)):
        axis = flights[k]
        begin(axis, laws, ball, axis.start)
        tau = times[k] - axis.start
        law = laws[axis.regime]
        du, dv, _ = increments(axis, law, tau)
        out[0, k], out[1, k] = axis.u + axis.v * tau + du, axis.v + dv
        out[2, k], out[3, k], out[4, k] = axis.s, 0.0, 0.0
        if axis.regime != STUCK:
            out[2, k], out[3, k], _, _ = relative(axis, law, tau)
        if axis.regime == ROLLING:
            out[4, k] = out[3, k]
        elif axis.regime == SLIPPING or axis.spin != 0.0:
            out[4, k] = spin_after(axis, ball, tau)


@kernel
def follow(it: Record, flow: Floats, tables: Tables, times: Floats, out: Floats, regimes: Integers) -> None:
    """Fill `out`, shape (5, n, 2), with u, v, s, w and spin at n ascending times, and the regimes, shape (n, 2)."""
    system, motion, rows = it.system, it.motion, tables.rows
    for g in range(system.groups):
        row = -1
        for k in range(len(times)):
            while row + 1 < len(rows) and rows[row + 1].time <= times[k]:
                row += 1
                if system.group[rows[row].axis] == g:
                    _resume(g, row, it, flow, tables)
            while (times[k] - motion.start[g]) > system.span[g]:
                travel(g, 1.0, it)
                motion.start[g] += system.span[g]
                expand(g, it, flow)
            x = (times[k] - motion.start[g]) / system.span[g]
            for i in range(system.first[g], system.last[g]):
                _read(i, x, it, out[:, k, i])
                _spin(times[k], it.axes[i], it.ball, out[:, k, i])
                regimes[k, i] = it.axes[i].regime


@kernel
def _resume(g: int, row: int, it: Record, flow: Floats, tables: Tables) -> None:
    """Put a group into its state after an event."""
    event = tables.rows[row]
    axis = it.axes[event.axis]
    axis.regime, axis.direction, axis.spin, axis.start = event.regime, event.direction, event.spin, event.time
    axis.f = -axis.direction * it.ball.grip if axis.regime == SLIPPING else 0.0
    for m in range(it.system.low[g], it.system.high[g]):
        it.motion.z[m], it.motion.rate[m] = tables.states[row, 0, m], tables.states[row, 1, m]
    it.motion.start[g] = event.time
    expand(g, it, flow)


@kernel
def _read(i: int, x: float, it: Record, out: Floats) -> None:
    """Displacement, velocity, relative position and velocity along an axis x steps on."""
    system, g = it.system, it.system.group[i]
    c, span = it.motion.series[g], system.span[g]
    cavity = c[system.high[g] - system.low[g] + i - system.first[g]]
    gain, rate = increment(cavity, x)
    out[0], out[1] = cavity[0] + gain, rate / span
    out[2], out[3] = it.motion.z[system.place[i]], 0.0
    if it.axes[i].regime != STUCK:
        gain, rate = increment(c[system.lane[i]], x)
        out[2], out[3] = out[2] + gain, rate / span


@kernel
def _spin(time: float, axis: Record, ball: Record, out: Floats) -> None:
    out[4] = out[3] if axis.regime == ROLLING else 0.0
    if axis.regime == SLIPPING or (axis.regime == STUCK and axis.spin != 0.0):
        out[4] = spin_after(axis, ball, time - axis.start)
