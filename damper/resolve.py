"""What an event does: a wall hit, sticking after it, a reversal of the relative motion, setting off."""

from __future__ import annotations

from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.detect import departure

if TYPE_CHECKING:
    from damper.records import Record, Records


@kernel
def settle(axis: Record, laws: Records, ball: Record) -> None:
    """At a zero of the relative velocity: the ball sticks, or sets off the way the structure drives it."""
    axis.w = 0.0
    axis.direction = departure(axis, laws, ball)


@kernel
def hit(axis: Record, ball: Record, books: Record) -> float:
    """Impact of the ball with the wall ahead, first two of eqs. (10), then sticking or rebound.

    Returns the normal impulse [N s]. The spin follows the new rolling velocity at once; what that takes away is
    booked with the impact.
    """
    reduced = ball.mass * ball.host_mass / (ball.mass + ball.host_mass)
    impulse = reduced * (1.0 + ball.restitution) * abs(axis.w)
    axis.s = axis.direction * axis.half_gap
    _exchange(axis, -ball.restitution * axis.w, reduced, ball, books)
    axis.direction = -axis.direction
    if abs(axis.w) <= max(ball.sticking_ratio * abs(axis.v), ball.sticking_floor):
        _exchange(axis, 0.0, reduced, ball, books)
        axis.direction = 0
    return impulse


@kernel
def rub(axis: Record, normal_impulse: float, laws: Records, ball: Record, books: Record) -> None:
    """Tangential part of an impact, last two of eqs. (10), friction capped by eq. (11)."""
    reduced = ball.mass * ball.host_mass / (ball.mass + ball.host_mass)
    change = ball.friction * normal_impulse / reduced
    if change < abs(axis.w):
        _exchange(axis, axis.w - axis.direction * change, reduced, ball, books)
    else:
        _exchange(axis, 0.0, reduced, ball, books)
        settle(axis, laws, ball)


@kernel
def _exchange(axis: Record, w: float, reduced: float, ball: Record, books: Record) -> None:
    """Give the ball the relative velocity w by an impulse between it and the structure; book the loss."""
    books.impact += 0.5 * (reduced + ball.spin_mass) * (axis.w - w) * (axis.w + w)
    axis.v -= (w - axis.w) * reduced / ball.host_mass
    axis.w = w
