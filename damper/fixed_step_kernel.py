"""The compiled loop of the paper's fixed-step algorithm."""

from __future__ import annotations

from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.flight import begin, increments, velocity
from damper.impacts import level_hit, level_rub, level_settle, roll
from damper.state import STUCK

if TYPE_CHECKING:
    from damper.model import Floats, Record, Records


@kernel
def march(it: Record, step: float, opposing: bool, velocity: Floats) -> int:
    """Fill `velocity`, shape (n + 1, 2), step by step; returns the number of wall hits.

    `opposing`: friction takes its sign from the structure's velocity instead of the relative one.
    """
    axes, laws, ball, impacts = it.axes, it.laws, it.ball, 0
    for k in range(len(velocity) - 1):
        for i in range(2):
            axis = axes[i]
            if axis.regime == STUCK:
                level_settle(axis, laws[i], ball)
            axis.heading = axis.direction
            if opposing and axis.regime != STUCK:
                axis.direction = -1 if axis.v > 0.0 else 1
            _step(i, step, it)
        for i in range(2):
            axis, other = axes[i], axes[1 - i]
            side = 1 if axis.w > 0.0 else -1
            if axis.regime != STUCK and side * axis.s >= axis.half_gap:
                axis.heading = side
                impulse = level_hit(axis, ball, it.books)
                impacts += 1
                if ball.friction > 0.0 and other.regime != STUCK:
                    level_rub(other, impulse, laws[1 - i], ball, it.books)
            elif axis.regime != STUCK:
                axis.direction = axis.heading
                if axis.w * axis.direction <= 0.0:
                    _turn(axis, laws[i], ball)
        velocity[k + 1, 0], velocity[k + 1, 1] = axes[0].v, axes[1].v
    return impacts


@kernel
def _step(i: int, step: float, it: Record) -> None:
    axis, law = it.axes[i], it.laws[i, it.axes[i].regime]
    begin(axis, it.laws[i], it.ball, 0.0)
    du, dv, last = increments(axis, law, step)
    it.books.structure += _viscous_loss(axis, law, dv, last, step)
    if axis.regime != STUCK:
        axis.s += axis.w * step - axis.beta * du + 0.5 * axis.f * step * step
        axis.w += axis.f * step - axis.beta * dv
        axis.spin = axis.w
    axis.u += axis.v * step + du
    axis.v += dv


@kernel
def _viscous_loss(axis: Record, law: Record, dv: float, last: float, step: float) -> float:
    """Work of the structure's dashpot over a step, by the trapezoidal rule with its correction of the ends [J].

    Good to the fourth power of the step, where the algorithm is to the first; the exact integral would cost thrice
    as much as all the rest of a step. `last`: the acceleration at its end.
    """
    _, first = velocity(axis, law, 0.0)
    before, after = axis.v, axis.v + dv
    ends = 0.5 * (before * before + after * after) + step / 6.0 * (before * first - after * last)
    return float(law.damping * step * ends)


@kernel
def _turn(axis: Record, laws: Records, ball: Record) -> None:
    """The relative velocity has changed sign: stick if the structure no longer drives the ball, else roll on."""
    direction = 1 if axis.w > 0.0 else -1
    acceleration = (laws[STUCK].stiffness * axis.u + laws[STUCK].damping * axis.v) / laws[STUCK].mass
    if abs(acceleration) <= ball.threshold:
        axis.w = 0.0
        roll(axis, 0)
    else:
        roll(axis, direction)
