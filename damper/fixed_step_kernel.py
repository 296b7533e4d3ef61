"""The compiled loop of the paper's fixed-step algorithm."""

from __future__ import annotations

from typing import TYPE_CHECKING

from damper.compiled import kernel, part
from damper.engine import stored
from damper.events import drives
from damper.impacts import hit, read, rebound, roll, roll_on, rub, settle
from damper.state import ROLLING, STUCK

if TYPE_CHECKING:
    from damper.model import Floats, Record


@kernel
def march(it: Record, flow: Floats, steps: Floats, losses: Floats, opposing: bool, velocity: Floats) -> int:
    """Fill `velocity`, shape (n + 1, 2), step by step; returns the number of wall hits.

    `steps` and `losses`: see `damper.fixed_step.propagators`; `opposing`: friction takes its sign from the structure's
    velocity instead of the relative one.
    """
    axes, impacts = it.axes, 0
    it.books.initial = stored(it)
    for k in range(len(velocity) - 1):
        for i in range(2):
            axis = axes[i]
            if axis.regime == STUCK:
                settle(i, 0.0, it, flow)
            axis.heading = axis.direction
            if opposing and axis.regime != STUCK:
                axis.direction = -1 if axis.v > 0.0 else 1
            _step(i, steps[i, axis.regime], losses[i, axis.regime], it)
        for i in range(2):
            axis, other = axes[i], axes[1 - i]
            side = 1 if axis.w > 0.0 else -1
            if axis.regime != STUCK and side * axis.s >= axis.half_gap:
                axis.heading = side
                impulse = hit(i, it)
                impacts += 1
                if it.ball.friction > 0.0 and other.regime != STUCK:
                    rub(1 - i, impulse, it, flow)
                rebound(i, it)
            elif axis.regime != STUCK:
                axis.direction = axis.heading
                if axis.w * axis.direction <= 0.0:
                    _turn(i, it, flow)
        velocity[k + 1, 0], velocity[k + 1, 1] = axes[0].v, axes[1].v
    it.books.final = stored(it)
    return impacts


@part
def _step(i: int, step: Floats, loss: Floats, it: Record) -> None:
    """Take an axis a step on: its state and the resistance times a matrix."""
    axis, motion, low = it.axes[i], it.motion, it.system.low[i]
    y = motion.source
    y[0], y[1], y[2], y[3] = motion.z[low], motion.z[low + 1], motion.rate[low], motion.rate[low + 1]
    y[4] = axis.direction * it.ball.threshold if axis.regime == ROLLING else 0.0
    for m in range(4):
        after = 0.0
        for n in range(5):
            after += step[m, n] * y[n]
            it.books.structure += loss[m, n] * y[m] * y[n]
        if m < 2:
            motion.z[low + m] = after
        else:
            motion.rate[low + m - 2] = after
    for n in range(5):
        it.books.structure += loss[4, n] * y[4] * y[n]
    read(i, it)
    axis.spin = axis.w


@part
def _turn(i: int, it: Record, flow: Floats) -> None:
    """The relative velocity has changed sign: stick if the structure no longer drives the ball, else roll on."""
    axis = it.axes[i]
    if abs(drives(i, 0.0, it, flow)[1]) <= it.ball.threshold:
        it.motion.rate[it.system.place[i]] = axis.w = 0.0
        roll(axis, 0)
    else:
        roll_on(axis)
