"""When the next event of an axis comes: isolate on monotone pieces, then polish.

While the ball rolls, its relative velocity keeps its sign (a change of sign is itself an event), so its position is
monotone and the wall ahead is met at most once. The relative velocity is split where the structure's acceleration
is extreme, which closed form gives; on such a piece the relative acceleration is monotone and changes sign at most
once, and between its zero and the ends of the piece the velocity is monotone too. No sampling, nothing to miss.

Ties and edges, decided once: a velocity that touches zero has reached it; a wall that is touched is hit; a ball
that was just set off has a relative acceleration along its direction, whatever rounding says; a peak is above a
threshold only when it exceeds it by more than 1e-12 of it.
"""

from __future__ import annotations

import math

import numba as nb
import numpy as np

from damper.flight import first_extremum, increments
from damper.records import HIT, NOTHING, REVERSAL, ROLLING, START, STUCK

_POSITION, _VELOCITY, _ACCELERATION = 0, 1, 2
_MARGIN = 1.0 + 1e-12


@nb.njit(cache=True)
def schedule(axis, laws, ball, horizon):
    """Write into `axis` when its next event happens (inf if not before time `horizon`) and what it is."""
    if axis.direction == 0:
        tau, kind = _set_off(axis, laws, ball), START
    else:
        tau, kind = _end_of_roll(axis, laws[ROLLING], ball, horizon - axis.start)
    axis.next = axis.start + tau
    axis.kind = kind if tau < np.inf else NOTHING


@nb.njit(cache=True)
def departure(axis, laws, ball):
    """Direction in which a ball at relative rest sets off now: -1, 1, or 0 if it stays.

    It leaves when the structure's acceleration exceeds the threshold (eq. 1 and Table I) and the rolling motion
    that follows (eqs. 2-4) really sets off that way; the two differ where the two laws have different dashpots.
    """
    mass = laws[STUCK].mass
    stuck = (laws[STUCK].stiffness * axis.u + laws[STUCK].damping * axis.v) / mass
    rolling = (laws[ROLLING].stiffness * axis.u + laws[ROLLING].damping * axis.v) / mass
    for d in (-1, 1):
        if d * axis.s < axis.half_gap and d * stuck > ball.threshold and d * rolling > ball.threshold:
            return d
    return 0


@nb.njit(cache=True)
def _set_off(axis, laws, ball):
    """First tau at which a stuck ball leaves: its drive exceeds the threshold away from any wall it rests on."""
    first = np.inf
    for d in (-1, 1):
        if d * axis.s < axis.half_gap:
            tau = _both_exceed(axis, laws, d, ball.threshold)
            if tau < first:
                first, axis.heading = tau, d
    return first


@nb.njit(cache=True)
def _both_exceed(axis, laws, d, threshold):
    """First tau at which both drives, by the stuck and by the rolling law's dashpot, exceed the threshold."""
    law = laws[STUCK]
    p1, q1 = _drive(axis, law, law.damping, d)
    if laws[ROLLING].damping == law.damping:
        return _first_exceed(p1, q1, law.decay, law.frequency, threshold)
    p2, q2 = _drive(axis, law, laws[ROLLING].damping, d)
    origin = 0.0
    for _ in range(3):
        e = math.exp(-law.decay * origin)
        c, s = e * math.cos(law.frequency * origin), e * math.sin(law.frequency * origin)
        a1, b1, a2, b2 = p1 * c + q1 * s, q1 * c - p1 * s, p2 * c + q2 * s, q2 * c - p2 * s
        later = max(
            _first_exceed(a1, b1, law.decay, law.frequency, threshold),
            _first_exceed(a2, b2, law.decay, law.frequency, threshold),
        )
        if later == np.inf:
            return np.inf
        c, s = math.cos(law.frequency * later), math.sin(law.frequency * later)
        level = threshold * math.exp(law.decay * later) * (1 - 1e-12)
        if a1 * c + b1 * s >= level and a2 * c + b2 * s >= level:
            return origin + later
        origin += later + 0.5 * math.pi / law.frequency
    return np.inf


@nb.njit(cache=True)
def _drive(axis, law, damping, d):
    """Coefficients of  d (K u + c v) / M1 = exp(-decay tau) (p cos + q sin)  in stuck motion."""
    v_cos = law.frequency * axis.b - law.decay * axis.a
    v_sin = -law.frequency * axis.a - law.decay * axis.b
    return d * (law.stiffness * axis.a + damping * v_cos) / law.mass, d * (
        law.stiffness * axis.b + damping * v_sin
    ) / law.mass


@nb.njit(cache=True)
def _first_exceed(p, q, decay, frequency, threshold):
    """First tau ≥ 0 at which exp(-decay tau) (p cos + q sin) exceeds the threshold, inf if never."""
    if p > threshold * _MARGIN:
        return 0.0
    if p * p + q * q <= threshold * threshold:
        return np.inf
    slope, curl = frequency * q - decay * p, -frequency * p - decay * q
    angle = math.atan2(slope, -curl)
    if slope < 0.0 or (slope == 0.0 and curl > 0.0):  # falls first: the extremum found is a minimum
        angle = math.atan2(-slope, curl) + math.pi
    peak = angle / frequency
    top = math.exp(-decay * peak) * (p * math.cos(angle) + q * math.sin(angle))
    if top <= threshold * _MARGIN:
        return np.inf
    low, high = max(peak - math.pi / frequency, 0.0), peak
    tau = 0.5 * (low + high)
    for _ in range(100):
        e = math.exp(-decay * tau)
        c, s = math.cos(frequency * tau), math.sin(frequency * tau)
        f = e * (p * c + q * s) - threshold
        if f > 0.0:
            high = tau
        else:
            low = tau
        derivative = e * (slope * c + curl * s)
        new = tau - f / derivative if derivative > 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - tau) <= 4e-16 * high:
            return new
        tau = new
    return tau


@nb.njit(cache=True)
def _end_of_roll(axis, law, ball, horizon):
    """First hit of the wall ahead or zero of the relative velocity, and which; (inf, NOTHING) past the horizon."""
    spacing = math.pi / law.frequency
    low, g_low = 0.0, _motion(axis, law, ball, 0.0)[_ACCELERATION]
    if axis.w == 0.0:
        g_low = max(g_low, 0.0)
    high = first_extremum(axis, law, 2)
    while low < horizon:
        position, velocity, g_high, _ = _motion(axis, law, ball, high)
        reversal = np.inf
        if g_low < 0.0 and g_high > 0.0:
            valley = _root(axis, law, ball, _ACCELERATION, low, high)
            if _motion(axis, law, ball, valley)[_VELOCITY] <= 0.0:
                reversal = _root(axis, law, ball, _VELOCITY, low, valley)
        elif velocity <= 0.0:
            top = _root(axis, law, ball, _ACCELERATION, low, high) if g_low > 0.0 else low
            reversal = _root(axis, law, ball, _VELOCITY, top, high)
        if reversal < np.inf:
            position = _motion(axis, law, ball, reversal)[_POSITION]
        if position >= axis.half_gap:
            return _root(axis, law, ball, _POSITION, low, min(reversal, high)), HIT
        if reversal < np.inf:
            return reversal, REVERSAL
        low, g_low = high, g_high
        high += spacing
    return np.inf, NOTHING


@nb.njit(cache=True)
def _motion(axis, law, ball, tau):
    """Relative position, velocity, acceleration and jerk along the direction of motion."""
    du, dv, acceleration = increments(axis, law, tau)
    d, beta = axis.direction, ball.inertia_ratio
    position = d * (axis.s + axis.w * tau - beta * du) - 0.5 * ball.relative_push * tau * tau
    velocity = d * (axis.w - beta * dv) - ball.relative_push * tau
    jerk = beta * (2 * law.decay * acceleration + law.stiffness / law.mass * (axis.v + dv))
    return position, velocity, -d * beta * acceleration - ball.relative_push, d * jerk


@nb.njit(cache=True)
def _root(axis, law, ball, order, low, high):
    """The one zero of position - half_gap, velocity or acceleration (`order` 0, 1, 2) in [low, high]: safeguarded Newton."""
    target = axis.half_gap if order == _POSITION else 0.0
    rising = order == _POSITION or (order == _ACCELERATION and _motion(axis, law, ball, high)[order] > 0.0)
    tau = high if order == _VELOCITY else 0.5 * (low + high)
    for _ in range(200):
        motion = _motion(axis, law, ball, tau)
        f = motion[order] - target
        if f == 0.0:
            return tau
        if (f > 0.0) == rising:
            high = tau
        else:
            low = tau
        slope = motion[order + 1]
        new = tau - f / slope if slope != 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - tau) <= 4e-16 * high:
            return new
        tau = new
    return tau
