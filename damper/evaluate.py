"""States between events, from the flights that the event table holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.flight import begin, increments, relative
from damper.records import ROLLING, SLIPPING, STUCK
from damper.series import expand, increment
from damper.slip import spin_after

if TYPE_CHECKING:
    from damper.arrays import Floats, Integers, Record, Records


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
def follow(
    system: Record,
    motion: Record,
    axes: Records,
    ball: Record,
    rows: Records,
    states: Floats,
    times: Floats,
    out: Floats,
    regimes: Integers,
) -> None:
    """Fill `out`, shape (5, n, 2), with u, v, s, w and spin at n ascending times, and the regimes, shape (n, 2)."""
    for g in range(system.groups):
        row = -1
        for k in range(len(times)):
            while row + 1 < len(rows) and rows[row + 1].time <= times[k]:
                row += 1
                if system.group[rows[row].axis] == g:
                    _resume(g, row, system, motion, axes, ball, rows, states)
            while (times[k] - motion.start[g]) > system.span[g]:
                _step(g, 1.0, system, motion)
                motion.start[g] += system.span[g]
                expand(g, system, motion, axes, ball)
            x = (times[k] - motion.start[g]) / system.span[g]
            for i in range(system.first[g], system.last[g]):
                _read(i, k, x, system, motion, axes[i], out)
                regimes[k, i] = axes[i].regime
                _spin(times[k], axes[i], ball, out[:, k, i])


@kernel
def _resume(
    g: int, row: int, system: Record, motion: Record, axes: Records, ball: Record, rows: Records, states: Floats
) -> None:
    """Put a group into its state after an event."""
    event = rows[row]
    axis = axes[event.axis]
    axis.regime, axis.direction, axis.spin, axis.start = event.regime, event.direction, event.spin, event.time
    axis.f = -axis.direction * ball.grip if axis.regime == SLIPPING else 0.0
    for m in range(system.low[g], system.high[g]):
        motion.z[m], motion.rate[m] = states[row, 0, m], states[row, 1, m]
    motion.start[g] = event.time
    expand(g, system, motion, axes, ball)


@kernel
def _step(g: int, x: float, system: Record, motion: Record) -> None:
    """Fly x steps on."""
    for m in range(system.low[g], system.high[g]):
        gain, rate = increment(motion.series[m], x)
        motion.z[m] += gain
        motion.rate[m] = rate / system.span[g]


@kernel
def _read(i: int, k: int, x: float, system: Record, motion: Record, axis: Record, out: Floats) -> None:
    """Displacement, velocity, relative position and velocity along an axis x steps on."""
    span, s = system.span[system.group[i]], system.place[i]
    gain, rate = increment(motion.cavity[i], x)
    out[0, k, i], out[1, k, i] = motion.cavity[i, 0] + gain, rate / span
    out[2, k, i], out[3, k, i] = motion.z[s], 0.0
    if axis.regime != STUCK:
        gain, rate = increment(motion.series[s], x)
        out[2, k, i], out[3, k, i] = motion.z[s] + gain, rate / span


@kernel
def _spin(time: float, axis: Record, ball: Record, out: Floats) -> None:
    out[4] = out[3] if axis.regime == ROLLING else 0.0
    if axis.regime == SLIPPING or (axis.regime == STUCK and axis.spin != 0.0):
        out[4] = spin_after(axis, ball, time - axis.start)
