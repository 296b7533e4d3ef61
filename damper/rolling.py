"""When a ball stops rolling as it does: a hit of the wall ahead or a zero of its velocity, by monotone pieces.

While the ball rolls, its relative velocity keeps its sign (a change of sign is itself an event), so its position is
monotone and the wall ahead is met at most once. The relative velocity is split where the structure's acceleration
is extreme, which closed form gives; on such a piece the relative acceleration is monotone and changes sign at most
once, and between its zero and the ends of the piece the velocity is monotone too. No sampling, nothing to miss.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from damper.compiled import kernel
from damper.flight import first_extremum, relative
from damper.records import HIT, NOTHING, PIECES, REVERSAL

if TYPE_CHECKING:
    from damper.arrays import Record

Motion: TypeAlias = tuple[float, float, float, float]

_POSITION, _VELOCITY, _ACCELERATION, _JERK = 0, 1, 2, 3


@kernel
def end_of_roll(axis: Record, law: Record, horizon: float) -> tuple[float, int]:
    """First hit of the wall ahead or zero of the relative velocity, and which; (inf, NOTHING) past the horizon."""
    spacing = math.pi / law.frequency
    if axis.looked == 0.0:
        axis.crest = axis.ahead = first_extremum(axis, law, 2)
    low, high = axis.looked, axis.ahead
    here = _motion(axis, law, low) if low > 0.0 else _departure_motion(axis, law)
    for _ in range(PIECES):
        if low >= horizon:
            return np.inf, NOTHING
        hit = _early_hit(axis, law, low, high, here)
        if hit < np.inf:
            return hit, HIT
        reversal, position = _early_reversal(axis, law, low, high, here)
        there = here
        if reversal == np.inf:
            there = _motion(axis, law, high)
            reversal = _reversal(axis, law, low, high, here, there)
            position = _motion(axis, law, reversal)[_POSITION] if reversal < np.inf else there[_POSITION]
        if position >= axis.half_gap:
            end = min(reversal, high)
            return _root(axis, law, _POSITION, low, end, 0.5 * (low + end)), HIT
        if reversal < np.inf:
            return reversal, REVERSAL
        low, here = high, there
        high += spacing
    axis.looked, axis.ahead = low, high
    return low, NOTHING


@kernel
def _early_hit(axis: Record, law: Record, low: float, high: float, here: Motion) -> float:
    """Hit of the wall ahead on a piece [low, high] where it is certain to be the first event, else inf.

    Guessed by a parabola. Certain: the relative velocity is positive at the root and cannot have dipped below zero
    before, because on the piece the acceleration falls, or has not fallen below zero, or has not risen above it.
    """
    distance = axis.half_gap - here[_POSITION]
    square = here[_VELOCITY] ** 2 + 2.0 * here[_ACCELERATION] * distance
    speed = here[_VELOCITY] + math.sqrt(square) if square >= 0.0 else -1.0
    if speed < 0.0:
        return np.inf
    guess = 2.0 * distance / speed if speed > 0.0 else np.inf
    if here[_JERK] > 0.0 and here[_JERK] * guess > 3.0 * here[_ACCELERATION]:  # just set off: the jerk carries the ball
        guess = min(guess, (6.0 * distance / here[_JERK]) ** (1.0 / 3.0))
    guess += low
    tau, motion = _polish(axis, law, _POSITION, low, high, guess)
    certain = here[_JERK] <= 0.0 or here[_ACCELERATION] >= 0.0 or motion[_ACCELERATION] <= 0.0
    return tau if certain and motion[_VELOCITY] > 0.0 else np.inf


@kernel
def _early_reversal(axis: Record, law: Record, low: float, high: float, here: Motion) -> tuple[float, float]:
    """First zero of the relative velocity on a piece [low, high], and the position there, or inf if in doubt.

    Guessed by a parabola. With monotone acceleration the velocity has at most one zero where it falls.
    """
    velocity, acceleration, jerk = here[_VELOCITY], here[_ACCELERATION], here[_JERK]
    square = acceleration * acceleration - 2.0 * jerk * velocity
    if square < 0.0 or math.sqrt(square) <= acceleration:
        guess = low - 2.0 * acceleration / jerk if velocity == 0.0 and jerk < 0.0 else np.inf
    else:
        guess = low + 2.0 * velocity / (math.sqrt(square) - acceleration)
    tau, motion = _polish(axis, law, _VELOCITY, low, high, guess)
    return (tau if motion[_ACCELERATION] < 0.0 and tau > low else np.inf), motion[_POSITION]


@kernel
def _polish(axis: Record, law: Record, order: int, low: float, high: float, tau: float) -> tuple[float, Motion]:
    """Halley's method from `tau` for the zero of position - half_gap or velocity; (inf, …) if it leaves [low, high]."""
    target = axis.half_gap if order == _POSITION else 0.0
    motion = (0.0, 0.0, 0.0, 0.0)
    for _ in range(8):
        if not low <= tau <= high:
            break
        motion = _motion(axis, law, tau)
        slope = motion[order + 1]
        step = (target - motion[order]) / slope if slope != 0.0 else np.inf
        bend = step * motion[order + 2] / slope
        if not abs(bend) < 0.5:
            break
        step /= 1.0 + 0.5 * bend
        tau += step
        if abs(step) * (bend * bend + law.square * step * step) <= 1e-17 * tau:
            return (tau if low <= tau <= high else np.inf), motion
    return np.inf, motion


@kernel
def _reversal(axis: Record, law: Record, low: float, high: float, here: Motion, there: Motion) -> float:
    """First zero of the relative velocity on a piece [low, high] with monotone acceleration, inf if none."""
    if here[_ACCELERATION] < 0.0 < there[_ACCELERATION]:  # convex: at most two zeros, the first before the valley
        valley = _root(axis, law, _ACCELERATION, low, high, 0.5 * (low + high))
        if _motion(axis, law, valley)[_VELOCITY] > 0.0:
            return np.inf
        return _root(axis, law, _VELOCITY, low, valley, low)
    if there[_VELOCITY] > 0.0 or here[_ACCELERATION] >= 0.0 <= there[_ACCELERATION]:
        return np.inf
    # the velocity is concave or falls all the way: one zero after its top, which Newton meets from the right
    return _root(axis, law, _VELOCITY, low, high, high)


@kernel
def _departure_motion(axis: Record, law: Record) -> Motion:
    """`_motion` at tau = 0, where a ball that was just set off accelerates along its direction."""
    d, square = axis.direction, law.square
    structure = -2.0 * law.decay * axis.v - square * (axis.u - axis.offset)
    acceleration = d * (axis.f - axis.beta * structure)
    if axis.w == 0.0:
        acceleration = max(acceleration, 0.0)
    jerk = d * axis.beta * (2.0 * law.decay * structure + square * axis.v)
    return d * axis.s, d * axis.w, acceleration, jerk


@kernel
def _motion(axis: Record, law: Record, tau: float) -> Motion:
    """Relative position, velocity, acceleration and jerk along the direction of motion."""
    d = axis.direction
    s, w, acceleration, jerk = relative(axis, law, tau)
    return d * s, d * w, d * acceleration, d * jerk


@kernel
def _root(axis: Record, law: Record, order: int, low: float, high: float, tau: float) -> float:
    """Zero of position - half_gap, velocity or acceleration (`order` 0, 1, 2) in [low, high] near `tau`.

    Newton's method, or Halley's where the next derivative is at hand, kept inside the bracket by bisection.
    """
    target = axis.half_gap if order == _POSITION else 0.0
    rising = order == _POSITION or (order == _ACCELERATION and _motion(axis, law, high)[order] > 0.0)
    for _ in range(200):
        motion = _motion(axis, law, tau)
        f, slope = motion[order] - target, motion[order + 1]
        if f == 0.0:
            return tau
        if (f > 0.0) == rising:
            high = tau
        else:
            low = tau
        step = -f / slope if slope != 0.0 else np.inf
        bend = 0.5 * step * motion[order + 2] / slope if order < _ACCELERATION else 0.0
        if abs(bend) < 0.5:
            step /= 1.0 + bend
        new = tau + step if low < tau + step < high else 0.5 * (low + high)
        if abs(new - tau) <= 4e-16 * new:
            return new
        tau = new
    return tau
