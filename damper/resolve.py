"""What an event does: a wall hit, sticking after it, a reversal of the relative motion, setting off, slip."""

from __future__ import annotations

from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.detect import departure
from damper.records import ROLLING, SLIPPING, STUCK
from damper.slip import rubbed

if TYPE_CHECKING:
    from damper.arrays import Record, Records


@kernel
def settle(axis: Record, laws: Records, ball: Record) -> None:
    """At a zero of the relative velocity: the ball sticks, or rolls off the way the structure drives it."""
    axis.w = 0.0
    roll(axis, departure(axis, laws, ball))


@kernel
def roll(axis: Record, direction: int) -> None:
    """Roll in a direction from now on, or stick (0)."""
    axis.direction = direction
    axis.regime = STUCK if direction == 0 else ROLLING
    axis.spin = axis.w


@kernel
def roll_on(axis: Record) -> None:
    """Roll from now on as it moves."""
    roll(axis, 1 if axis.w > 0.0 else -1)


@kernel
def slip(axis: Record) -> None:
    """Slide on the floor from now on, with the spin that the ball has."""
    axis.regime = SLIPPING
    axis.direction = 1 if axis.w > axis.spin else -1


@kernel
def hit(axis: Record, ball: Record, books: Record) -> float:
    """Impact of the ball with the wall on the side `heading`, first two of eqs. (10), then sticking or rebound.

    Returns the normal impulse [N s]. Without slip the spin follows the new rolling velocity at once, and what that
    takes away is booked with the impact.
    """
    reduced = ball.mass * ball.host_mass / (ball.mass + ball.host_mass)
    impulse = float(reduced * (1.0 + ball.restitution) * abs(axis.w))
    axis.s = axis.heading * axis.half_gap
    _exchange(axis, -ball.restitution * axis.w, reduced, ball, books)
    if ball.grip > 0.0:
        spin = rubbed(axis.spin, impulse, ball)
        books.impact += 0.5 * ball.spin_mass * (axis.spin - spin) * (axis.spin + spin)
        axis.spin = spin
    if abs(axis.w) <= max(ball.sticking_ratio * abs(axis.v), ball.sticking_floor):
        _exchange(axis, 0.0, reduced, ball, books)
        axis.regime, axis.direction = STUCK, 0
    elif ball.grip > 0.0:
        slip(axis)
    else:
        roll(axis, -axis.heading)
    return impulse


@kernel
def rub(axis: Record, normal_impulse: float, laws: Records, ball: Record, books: Record) -> None:
    """Tangential part of an impact, last two of eqs. (10), friction capped by eq. (11)."""
    reduced = ball.mass * ball.host_mass / (ball.mass + ball.host_mass)
    change = ball.friction * normal_impulse / reduced
    way = 1 if axis.w > 0.0 else -1
    capped = change >= abs(axis.w)
    _exchange(axis, 0.0 if capped else axis.w - way * change, reduced, ball, books)
    if ball.grip > 0.0 and axis.w != axis.spin:
        slip(axis)
    elif capped:
        settle(axis, laws, ball)


@kernel
def _exchange(axis: Record, w: float, reduced: float, ball: Record, books: Record) -> None:
    """Give the ball the relative velocity w by an impulse between it and the structure; book the loss."""
    inertia = reduced
    if ball.grip == 0.0:
        inertia += ball.spin_mass
        axis.spin = w
    books.impact += 0.5 * inertia * (axis.w - w) * (axis.w + w)
    axis.v -= (w - axis.w) * reduced / ball.host_mass
    axis.w = w
