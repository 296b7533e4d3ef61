"""When the next event of an axis comes: isolate on monotone pieces, then polish.

While the ball rolls, its relative velocity keeps its sign (a change of sign is itself an event), so its position is
monotone and the wall ahead is met at most once. The relative velocity is split where the structure's acceleration
is extreme, which closed form gives; on such a piece the relative acceleration is monotone and changes sign at most
once, and between its zero and the ends of the piece the velocity is monotone too. No sampling, nothing to miss.

Ties and edges, decided once: a velocity that touches zero has reached it; a wall that is touched is hit; a ball
that was just set off has a relative acceleration along its direction, whatever rounding says; a drive is above a
threshold only when it exceeds it by more than 1e-12 of it (`damper.threshold`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from damper.compiled import kernel
from damper.flight import first_extremum, relative, wave
from damper.records import HIT, NOTHING, PIECES, REVERSAL, ROLLING, SLIPPING, START, STUCK
from damper.slip import end_of_pressing, end_of_slip
from damper.threshold import MARGIN, drive, first_exceed

if TYPE_CHECKING:
    from damper.arrays import Record, Records

Motion: TypeAlias = tuple[float, float, float, float]

_POSITION, _VELOCITY, _ACCELERATION, _JERK = 0, 1, 2, 3


@kernel
def schedule(axis: Record, laws: Records, ball: Record, horizon: float) -> None:
    """Write into `axis` when its next event happens (inf if not before time `horizon`) and what it is.

    A flight is looked through for a while only, since a hit of the other axis may cut it short: where nothing was
    found yet, the event is NOTHING, and `look` goes on from there.
    """
    axis.looked = 0.0
    look(axis, laws, ball, horizon)


@kernel
def look(axis: Record, laws: Records, ball: Record, horizon: float) -> None:
    """Go on looking for the next event of a flight."""
    left = horizon - axis.start
    if axis.regime == ROLLING:
        axis.heading = axis.direction
        tau, kind = _end_of_roll(axis, laws[ROLLING], left)
    elif axis.regime == SLIPPING:
        tau, kind = end_of_slip(axis, laws[SLIPPING], left)
    elif axis.spin == 0.0:
        tau, kind = _set_off(axis, laws, ball), START
    else:
        tau, kind = end_of_pressing(axis, laws[STUCK], ball)
    axis.next, axis.due = axis.start + tau, tau
    axis.kind = kind if tau < np.inf else NOTHING


@kernel
def departure(axis: Record, laws: Records, ball: Record) -> int:
    """Direction in which a ball at relative rest sets off now: -1, 1, or 0 if it stays.

    It leaves when the structure's acceleration exceeds the threshold (eq. 1 and Table I) and the rolling motion
    that follows (eqs. 2-4) really sets off that way; the two differ where the two laws have different dashpots.
    """
    mass = laws[STUCK].mass
    stuck = (laws[STUCK].stiffness * axis.u + laws[STUCK].damping * axis.v) / mass
    rolling = (laws[ROLLING].stiffness * axis.u + laws[ROLLING].damping * axis.v) / mass
    least = MARGIN * ball.threshold
    for d in (-1, 1):
        if d * axis.s < axis.half_gap and d * stuck > least and d * rolling > least:
            return d
    return 0


@kernel
def _set_off(axis: Record, laws: Records, ball: Record) -> float:
    """First tau at which a stuck ball leaves: its drive exceeds the threshold away from any wall it rests on."""
    first = np.inf
    for d in (-1, 1):
        if d * axis.s < axis.half_gap:
            tau = _both_exceed(axis, laws, d, ball.threshold)
            if tau < first:
                first, axis.heading = tau, d
    return first


@kernel
def _both_exceed(axis: Record, laws: Records, d: int, threshold: float) -> float:
    """First tau at which both drives, by the stuck and by the rolling law's dashpot, exceed the threshold."""
    law = laws[STUCK]
    p1, q1 = drive(axis, law, law.damping, d)
    if laws[ROLLING].damping == law.damping:
        return first_exceed(p1, q1, law, threshold)
    p2, q2 = drive(axis, law, laws[ROLLING].damping, d)
    above = threshold - 1e-13 * (abs(p1) + abs(q1))
    tau = 0.0
    for _ in range(8):  # whichever comes second decides; each peak passed is lower than the one before
        tau += first_exceed(*_turned(p1, q1, law, tau), law, threshold)
        if tau == np.inf or _turned(p2, q2, law, tau)[0] >= above:
            return tau
        tau += first_exceed(*_turned(p2, q2, law, tau), law, threshold)
        if tau == np.inf or _turned(p1, q1, law, tau)[0] >= above:
            return tau
    return np.inf


@kernel
def _turned(p: float, q: float, law: Record, tau: float) -> tuple[float, float]:
    """Coefficients of exp(-decay t) (p C + q S) counted from t = tau; the first is its value there."""
    e, (c, s) = math.exp(-law.decay * tau), wave(law, tau)
    return e * (p * c + q * s), e * (q * c - law.frequency * law.frequency * p * s)


@kernel
def _end_of_roll(axis: Record, law: Record, horizon: float) -> tuple[float, int]:
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
        new = tau + step
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - tau) <= 4e-16 * new:
            return new
        tau = new
    return tau
