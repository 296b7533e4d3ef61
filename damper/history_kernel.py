"""Kernels that evaluate the motion between the events of a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.flight import begin, expand, increment, increments, relative, travel
from damper.slip import spin_after
from damper.state import ROLLING, SLIPPING, STUCK

if TYPE_CHECKING:
    from damper.model import Floats, Integers, Record, Records
    from damper.state import Tables


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
    cavity = c[system.cavity[i]]
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
