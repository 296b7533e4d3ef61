"""What an event does to the motion: hits, wall friction, sticking, setting off, slip; `resolve` is the entry.

The law of impact is `restitution`, `sticks`, `rubbing` and `rubbed`. An impulse along one axis moves the cavity along
the other too if a mode couples them. In a wall hit the ball's surface rubs up or down the wall: a vertical impulse, at
most friction times the normal one, up to what ends that sliding, (2/7) m |spin|, since it lifts the ball too. What it
gives the ball upwards or downwards is taken for lost on the floor.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import inlined, kernel, part
from damper.events import departure
from damper.state import GRIP, HIT, REVERSAL, ROLLING, SLIPPING, SPIN_UP, START, STUCK, balls_of

if TYPE_CHECKING:
    from damper.model import Floats, Parameters, Record


@part
def restitution(speed: float, ball: Record) -> float:
    """Ratio of the normal relative speeds after and before a hit at this speed."""
    pairs = ball.restitution_by_speed
    if speed <= pairs[0, 0]:
        return float(ball.restitution)
    last = 0
    while last + 1 < len(pairs) and speed > pairs[last + 1, 0]:
        last += 1
    v, e = pairs[last, 0], pairs[last, 1]
    if last + 1 < len(pairs) and pairs[last + 1, 0] < np.inf:
        return float(e + (pairs[last + 1, 1] - e) * math.log(speed / v) / math.log(pairs[last + 1, 0] / v))
    return float(e * math.sqrt(math.sqrt(v / speed)))


@kernel
def restitutions(speeds: Floats, ball: Record, ratios: Floats) -> None:
    """The same of many hits, into `ratios`."""
    for k in range(len(speeds)):
        ratios[k] = restitution(speeds[k], ball)


def restitution_of(rows: Parameters, speeds: Floats) -> Floats:
    """Ratios (n,) of the normal relative speeds after and before hits at speeds (n,) [m/s], by a damper's row."""
    ratios = np.empty(len(speeds))
    restitutions(speeds, balls_of(rows, np.zeros(1))[0], ratios)
    return ratios


@part
def sticks(axis: Record, ball: Record) -> bool:
    """Whether a ball that was just hit stays on the wall."""
    return bool(abs(axis.w) <= max(ball.sticking_ratio * abs(axis.v), ball.sticking_floor))


@part
def rubbing(w: float, normal: float, mass: float, ball: Record) -> float:
    """Relative velocity along a wall after a hit with this normal impulse: friction at most ends the sliding.

    The impulse P turns the ball about the vertical too: the sliding loses (1/mass + 5/2m) P, that is all of it where P
    is 2/7 of what stops the centre, at a wall at rest. The floor's pivoting friction then stops that spin. The paper's
    eq. (11) stops the centre.
    """
    most = abs(w) / (1.0 + ball.wall_spin * mass / ball.mass)
    change = ball.friction * normal / mass
    return w - math.copysign(min(change, most), w)


@part
def rubbed(spin: float, normal_impulse: float, ball: Record) -> float:
    """Spin after a wall hit with this impulse [N s]."""
    vertical = min(ball.friction * normal_impulse / ball.mass, abs(spin) / (1.0 + SPIN_UP))
    return math.copysign(abs(spin) - SPIN_UP * vertical, spin)


@part
def roll(axis: Record, direction: int) -> None:
    """Roll in a direction from now on, or stick (0)."""
    axis.direction = direction
    axis.regime = STUCK if direction == 0 else ROLLING
    axis.spin = axis.w


@part
def roll_on(axis: Record) -> None:
    """Roll from now on as it moves."""
    roll(axis, 1 if axis.w > 0.0 else -1)


@part
def slip(axis: Record) -> None:
    """Slide on the floor from now on, with the spin that the ball has."""
    axis.regime = SLIPPING
    axis.direction = 1 if axis.w > axis.spin else -1


@part
def slip_or_press(axis: Record) -> None:
    """The same; a ball at rest on a wall spins against it until something pulls it off."""
    slip(axis)
    if axis.w == 0.0 and abs(axis.s) >= axis.half_gap:
        axis.regime, axis.direction = STUCK, 0


_NOTHING = 1e-7
"""Share of the speed that always sticks to a wall: next to the structure's own speed it is rounding."""

_ROUNDS = 4
"""Of asking whether a ball let go at rest sets off along an axis: setting off along one changes the other's drive."""


@part
def let_go(it: Record, flow: Floats) -> None:
    """The regimes in which the state in `it.motion` begins at time 0."""
    for i in range(2):
        read(i, it)
        if it.axes[i].w != 0.0 or it.axes[i].spin != 0.0:
            _leave_dent(it)
    for i in range(2):
        if it.ball.grip > 0.0 and it.axes[i].spin != it.axes[i].w:
            slip_or_press(it.axes[i])
        elif it.axes[i].w != 0.0:
            roll_on(it.axes[i])
    for _ in range(_ROUNDS):
        for i in range(2):
            if it.axes[i].w == 0.0 and (it.ball.grip == 0.0 or it.axes[i].spin == 0.0):
                settle(i, 0.0, it, flow)
                if it.axes[i].regime != STUCK:
                    _leave_dent(it)


@part
def _leave_dent(it: Record) -> None:
    """From here on the ball rolls in its groove: where it comes to rest, no rim holds it."""
    it.ball.hold = it.ball.threshold


@inlined
def resolve(i: int, kind: int, it: Record, flow: Floats) -> bool:
    """What an event along an axis does; whether the ball, hitting a wall, rubbed along it."""
    axis, other, time = it.axes[i], it.axes[1 - i], it.clock.time
    _leave_dent(it)
    rubs = False
    if kind == START and axis.spin != 0.0:
        slip(axis)
    elif kind == START:
        roll(axis, axis.heading)
    elif kind == GRIP and axis.regime == STUCK:  # its spin against a wall is spent
        axis.spin = 0.0
    elif kind == REVERSAL or (kind == GRIP and axis.w == 0.0):
        settle(i, time, it, flow)
    elif kind == GRIP:
        roll_on(axis)
    elif kind == HIT:
        impulse = hit(i, it)
        rubs = it.ball.friction > 0.0 and other.regime != STUCK
        if rubs:
            rub(1 - i, impulse, it, flow)
        rebound(i, it)
    return rubs


@part
def read(i: int, it: Record) -> None:
    """Copy position and velocity of an axis from z into its record."""
    axis, z, rate, s = it.axes[i], it.motion.z, it.motion.rate, it.system.place[i]
    axis.s, axis.w, axis.u, axis.v = z[s], rate[s], 0.0, 0.0
    axis.excursion = max(axis.excursion, abs(axis.s))
    g = it.system.group[i]
    for m in range(it.system.low[g], it.system.high[g]):
        axis.u += it.system.mode_shape[i, m] * z[m]
        axis.v += it.system.mode_shape[i, m] * rate[m]


@part
def settle(i: int, time: float, it: Record, flow: Floats) -> None:
    """At a zero of the relative velocity: the ball sticks, or rolls off the way it is driven."""
    it.motion.rate[it.system.place[i]] = it.axes[i].w = 0.0
    roll(it.axes[i], departure(i, time, it, flow))


@part
def hit(i: int, it: Record) -> float:
    """Impact with the wall on the side `heading`; returns the normal impulse [N s]."""
    axis, ball = it.axes[i], it.ball
    e = restitution(abs(axis.w), ball)
    impulse = float(it.system.reduced[i] * (1.0 + e) * abs(axis.w))
    it.motion.z[it.system.place[i]] = axis.heading * axis.half_gap
    _exchange(i, -e * axis.w, it)
    if ball.grip > 0.0:
        _follow(axis, rubbed(axis.spin, impulse, ball), it)
    return impulse


@part
def rebound(i: int, it: Record) -> None:
    """Sticking to the wall after an impact, or the flight from it."""
    axis, ball = it.axes[i], it.ball
    if sticks(axis, ball):
        _exchange(i, 0.0, it)
        axis.regime, axis.direction = STUCK, 0
    elif ball.grip > 0.0:
        slip(axis)
    else:
        roll_on(axis)


@inlined
def rub(i: int, normal: float, it: Record, flow: Floats) -> None:
    """Friction at the wall of the other axis, at most what ends the sliding along it, eq. (11) of the paper."""
    axis, ball = it.axes[i], it.ball
    after = rubbing(axis.w, normal, it.system.reduced[i], ball)
    _exchange(i, after, it)
    if ball.grip > 0.0 and axis.w != axis.spin:
        slip_or_press(axis)
    elif after == 0.0:
        settle(i, it.clock.time, it, flow)


@part
def _exchange(i: int, w: float, it: Record) -> None:
    """Give the ball the relative velocity w by an impulse between it and the cavity; book the loss."""
    axis, other, rate, ball, system = it.axes[i], it.axes[1 - i], it.motion.rate, it.ball, it.system
    mass, g = it.system.reduced[i], system.group[i]
    impulse = mass * (axis.w - w)
    for m in range(system.low[g], system.high[g]):
        rate[m] += impulse * system.yielding[i, m]
    it.books.impact += 0.5 * mass * (axis.w - w) * (axis.w + w)
    rate[system.place[i]] = w
    read(i, it)
    _follow(axis, axis.spin if ball.grip > 0.0 else w, it)
    if system.groups == 2:
        return
    aside = other.w
    read(1 - i, it)
    if other.regime == STUCK and abs(other.w) <= _NOTHING * ball.sticking_floor:
        rate[system.place[1 - i]] = other.w = 0.0  # two walls that push each other in turn: the rest is rounding
    elif other.w != aside:
        _carry(other, it)


@part
def _follow(axis: Record, spin: float, it: Record) -> None:
    """The spin follows a new rolling velocity at once; what that takes is booked with the impact."""
    it.books.impact += 0.5 * it.ball.spin_mass * (axis.spin - spin) * (axis.spin + spin)
    axis.spin = spin


@part
def _carry(axis: Record, it: Record) -> None:
    """An impact along the other axis moved the cavity along this one, under the ball."""
    if it.ball.grip > 0.0:
        slip(axis)
    else:
        _follow(axis, axis.w, it)
        roll_on(axis)
