"""What events do to the motion: impulses at the walls, sticking, setting off, slip.

An impulse along one axis moves the cavity along the other too where a mode does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.guards import departure
from damper.records import STUCK
from damper.resolve import roll, slip
from damper.slip import rubbed

if TYPE_CHECKING:
    from damper.arrays import Record, Records

_NOTHING = 1e-7
"""Share of the speed that always sticks to a wall: next to the structure's own speed it is rounding."""


@kernel
def read(i: int, system: Record, motion: Record, axes: Records) -> None:
    """Copy position and velocity of an axis from z into its record."""
    axis, s = axes[i], system.place[i]
    axis.s, axis.w, axis.u, axis.v = motion.z[s], motion.rate[s], 0.0, 0.0
    for m in range(system.coordinates):
        axis.u += system.mode_shape[i, m] * motion.z[m]
        axis.v += system.mode_shape[i, m] * motion.rate[m]


@kernel
def settle(i: int, system: Record, motion: Record, axes: Records, ball: Record, time: float) -> None:
    """At a zero of the relative velocity: the ball sticks, or rolls off the way it is driven."""
    motion.rate[system.place[i]] = axes[i].w = 0.0
    roll(axes[i], departure(i, system, motion, axes, ball, time))


@kernel
def hit(i: int, system: Record, motion: Record, axes: Records, ball: Record, books: Record) -> float:
    """Impact with the wall on the side `heading`; returns the normal impulse [N s]."""
    axis = axes[i]
    impulse = float(reduced(i, system, ball) * (1.0 + ball.restitution) * abs(axis.w))
    motion.z[system.place[i]] = axis.heading * axis.half_gap
    _exchange(i, -ball.restitution * axis.w, system, motion, axes, ball, books)
    if ball.grip > 0.0:
        _follow(axis, rubbed(axis.spin, impulse, ball), ball, books)
    return impulse


@kernel
def rebound(i: int, system: Record, motion: Record, axes: Records, ball: Record, books: Record) -> None:
    """Sticking to the wall after an impact, or the flight from it."""
    axis = axes[i]
    if abs(axis.w) <= max(ball.sticking_ratio * abs(axis.v), ball.sticking_floor):
        _exchange(i, 0.0, system, motion, axes, ball, books)
        axis.regime, axis.direction = STUCK, 0
    elif ball.grip > 0.0:
        slip(axis)
    else:
        roll(axis, 1 if axis.w > 0.0 else -1)


@kernel
def rub(
    i: int, normal: float, system: Record, motion: Record, axes: Records, ball: Record, books: Record, time: float
) -> None:
    """Friction at the wall of the other axis, at most what ends the sliding along it, eq. (11) of the paper."""
    axis = axes[i]
    change = ball.friction * normal / reduced(i, system, ball)
    way = 1 if axis.w > 0.0 else -1
    capped = change >= abs(axis.w)
    _exchange(i, 0.0 if capped else axis.w - way * change, system, motion, axes, ball, books)
    if ball.grip > 0.0 and axis.w != axis.spin:
        slip(axis)
        if axis.w == 0.0 and abs(axis.s) >= axis.half_gap:  # pressed against a wall, unless something pulls it off
            axis.regime, axis.direction = STUCK, 0
    elif capped:
        settle(i, system, motion, axes, ball, time)


@kernel
def reduced(i: int, system: Record, ball: Record) -> float:
    """Mass that an impulse between ball and cavity along an axis moves [kg]."""
    return float(1.0 / (1.0 / ball.mass - system.yielding[i, system.place[i]]))


@kernel
def _exchange(i: int, w: float, system: Record, motion: Record, axes: Records, ball: Record, books: Record) -> None:
    """Give the ball the relative velocity w by an impulse between it and the cavity; book the loss."""
    axis, other = axes[i], axes[1 - i]
    mass = reduced(i, system, ball)
    impulse = mass * (axis.w - w)
    for m in range(system.coordinates):
        motion.rate[m] += impulse * system.yielding[i, m]
    books.impact += 0.5 * mass * (axis.w - w) * (axis.w + w)
    motion.rate[system.place[i]] = w
    aside = other.w
    read(i, system, motion, axes)
    read(1 - i, system, motion, axes)
    _follow(axis, axis.spin if ball.grip > 0.0 else w, ball, books)
    if other.regime == STUCK and abs(other.w) <= _NOTHING * ball.sticking_floor:
        motion.rate[system.place[1 - i]] = other.w = 0.0  # two walls that push each other in turn: the rest is rounding
    elif other.w != aside:
        _carry(other, ball, books)


@kernel
def _follow(axis: Record, spin: float, ball: Record, books: Record) -> None:
    """The spin follows a new rolling velocity at once; what that takes is booked with the impact."""
    books.impact += 0.5 * ball.spin_mass * (axis.spin - spin) * (axis.spin + spin)
    axis.spin = spin


@kernel
def _carry(axis: Record, ball: Record, books: Record) -> None:
    """An impact along the other axis moved the cavity along this one, under the ball."""
    if ball.grip > 0.0:
        slip(axis)
    else:
        _follow(axis, axis.w, ball, books)
        roll(axis, 1 if axis.w > 0.0 else -1)
