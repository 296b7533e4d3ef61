"""What an event does: a wall hit, sticking after it, a reversal of the relative motion, setting off."""

from __future__ import annotations

import numba as nb

from damper.detect import departure


@nb.njit(cache=True)
def settle(axis, laws, ball):
    """At a zero of the relative velocity: the ball sticks, or sets off the way the structure drives it."""
    axis.w = 0.0
    axis.direction = departure(axis, laws, ball)


@nb.njit(cache=True)
def hit(axis, ball, books):
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


@nb.njit(cache=True)
def rub(axis, normal_impulse, laws, ball, books):
    """Tangential part of an impact, last two of eqs. (10), friction capped by eq. (11)."""
    reduced = ball.mass * ball.host_mass / (ball.mass + ball.host_mass)
    change = ball.friction * normal_impulse / reduced
    if change < abs(axis.w):
        _exchange(axis, axis.w - axis.direction * change, reduced, ball, books)
    else:
        _exchange(axis, 0.0, reduced, ball, books)
        settle(axis, laws, ball)


@nb.njit(cache=True)
def _exchange(axis, w, reduced, ball, books):
    """Give the ball the relative velocity w by an impulse between it and the structure; book the loss."""
    books.impact += 0.5 * (reduced + ball.spin_mass) * (axis.w - w) * (axis.w + w)
    axis.v -= (w - axis.w) * reduced / ball.host_mass
    axis.w = w
