"""Slip: after a wall hit the ball keeps its spin, and slides on the floor until it rolls again.

Sliding friction (grip = mu Omega^2 R per unit of mass) slows the contact; rolling resistance, which has no say in
where a sliding contact goes, is left out until the ball rolls. A slipping ball can meet either wall, and one that the
friction presses against a wall spins there until its spin is spent or the structure pulls the wall away.

In a wall hit the ball's surface rubs up or down the wall: a vertical impulse, at most friction times the normal one, up
to what ends that sliding, (2/7) m |spin|, since it lifts the ball too. What it gives the ball upwards or downwards is
taken for lost on the floor.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.flight import first_extremum, relative, wave
from damper.state import GRIP, HIT, NOTHING, PIECES, ROLLING, SLIPPING, START

if TYPE_CHECKING:
    from damper.model import Record


MARGIN = 1.0 + 1e-12
"""By which a threshold has to be exceeded: less is rounding, and a ball set off by it would turn back at once."""


@kernel
def drive(axis: Record, law: Record, damping: float, d: int) -> tuple[float, float]:
    """Coefficients of  d (K u + c v) / M1 = exp(-decay tau) (p C + q S)  in stuck motion; C, S: `damper.flight`."""
    v_cos = axis.b - law.decay * axis.a
    v_sin = -law.frequency * law.frequency * axis.a - law.decay * axis.b
    return d * (law.stiffness * axis.a + damping * v_cos) / law.mass, d * (
        law.stiffness * axis.b + damping * v_sin
    ) / law.mass


@kernel
def first_exceed(p: float, q: float, law: Record, threshold: float) -> float:
    """First tau ≥ 0 at which exp(-decay tau) (p C + q S) exceeds the threshold, inf if never."""
    decay: float = law.decay
    frequency: float = law.frequency
    if p > threshold * MARGIN:
        return 0.0
    if (frequency * p) ** 2 + q * q <= (frequency * threshold) ** 2:
        return np.inf
    turn = math.atan2(frequency * (q - decay * p), frequency * frequency * p + decay * q)
    high = (turn if turn > 0.0 else turn + 2.0 * math.pi) / frequency
    c, s = wave(law, high)
    top = math.exp(-decay * high) * (p * c + q * s)  # the peak to come
    if top <= threshold * MARGIN:
        return np.inf
    low, peak = max(high - math.pi / frequency, 0.0), high
    lag = math.atan2(decay, frequency)  # by which damping brings the peak forward
    tau = max(low, peak - (math.acos(threshold / top * math.cos(lag)) - lag) / frequency)
    for _ in range(100):
        c, s = wave(law, tau - peak)
        e = top * math.exp(decay * (peak - tau))
        f = e * (c + decay * s) - threshold
        if f > 0.0:
            high = tau
        else:
            low = tau
        slope = -e * law.square * s
        new: float = tau - f / slope if slope > 0.0 else low
        if abs(new - tau) <= 4e-16 * peak:
            return new
        tau = new if low < new < high else 0.5 * (low + high)
    return tau


SPIN_UP = 2.5
"""A force on the rim of a solid sphere changes its surface speed 5/2 times as fast as its velocity."""
_POSITION, _VELOCITY, _ACCELERATION, _CONTACT, _CONTACT_RATE = 0, 1, 2, 3, 4
_RATE = (1, 2, 5, 4, 5)  # where the rate of each stands


@kernel
def spin_after(axis: Record, ball: Record, tau: float) -> float:
    """Surface speed after sliding for tau; a ball pressed against a wall spins down to rest."""
    if axis.f != 0.0:
        return float(axis.spin - SPIN_UP * axis.f * tau)
    return math.copysign(max(abs(axis.spin) - SPIN_UP * ball.grip * tau, 0.0), axis.spin)


@kernel
def rubbed(spin: float, normal_impulse: float, ball: Record) -> float:
    """Spin after a wall hit with this impulse [N s]."""
    vertical = min(ball.friction * normal_impulse / ball.mass, abs(spin) / (1.0 + SPIN_UP))
    return math.copysign(abs(spin) - SPIN_UP * vertical, spin)


@kernel
def sliding_distance(axis: Record, path: float, tau: float) -> float:
    """Distance that the contact slid while the ball's centre moved by `path`."""
    return float(path - axis.spin * tau + 0.5 * SPIN_UP * axis.f * tau * tau)


@kernel
def spend(axis: Record, path: float, tau: float, ball: Record, books: Record) -> None:
    """Spin after a flight of length tau on which the ball went by `path`, and what the floor took on it."""
    if axis.regime == ROLLING:
        books.rolling += ball.mass * ball.threshold * abs(path)
        axis.spin = axis.w
    elif axis.spin != 0.0 or axis.regime == SLIPPING:
        spin = spin_after(axis, ball, tau)
        if axis.regime == SLIPPING:
            books.slip += ball.mass * ball.grip * abs(sliding_distance(axis, path, tau))
        else:
            books.slip += 0.5 * ball.spin_mass * (axis.spin - spin) * (axis.spin + spin)
        axis.spin = spin


@kernel
def end_of_pressing(axis: Record, law: Record, ball: Record) -> tuple[float, int]:
    """End of spinning while pressed against a wall: the spin is spent, or the structure pulls the wall away."""
    spent = abs(axis.spin) / (SPIN_UP * ball.grip)
    side = 1 if axis.s > 0.0 else -1
    pressing = side * math.copysign(ball.grip, axis.spin)
    p, q = drive(axis, law, law.damping, -side)
    away = first_exceed(p, q, law, pressing)
    axis.heading = -side
    return (away, START) if away < spent else (spent, GRIP)


@kernel
def end_of_slip(axis: Record, law: Record, horizon: float) -> tuple[float, int]:
    """First wall hit or end of sliding; (inf, NOTHING) past the horizon.

    Between extremes of the structure's acceleration both accelerations are monotone; cut at their zeros, the relative
    velocity and the speed of the contact are, and cut at the zero of the former, the position.
    """
    if axis.looked == 0.0:
        axis.crest = axis.ahead = first_extremum(axis, law, 2)
    low, high = axis.looked, axis.ahead
    for _ in range(PIECES):
        if low >= horizon:
            return np.inf, NOTHING
        one = _zero(axis, law, _ACCELERATION, 0.0, low, high)
        two = _zero(axis, law, _CONTACT_RATE, 0.0, low, high)
        for cut in (min(one, two), max(one, two), high):
            if cut <= high:
                grip = _zero(axis, law, _CONTACT, 0.0, low, cut)
                end = min(grip, cut)
                turn = min(_zero(axis, law, _VELOCITY, 0.0, low, end), end)
                tau = _wall(axis, law, low, turn)
                if tau == np.inf:
                    tau = _wall(axis, law, turn, end)
                if tau < np.inf:
                    return tau, HIT
                if grip <= cut:
                    return grip, GRIP
                low = cut
        high += math.pi / law.frequency
    axis.looked, axis.ahead = low, high
    return low, NOTHING


@kernel
def _wall(axis: Record, law: Record, low: float, high: float) -> float:
    """Hit of a wall while the position is monotone from low to high, inf if none; its side goes into `heading`."""
    begin, end = _slide(axis, law, low)[_POSITION], _slide(axis, law, high)[_POSITION]
    side = 1 if end > begin else -1
    if end == begin or side * end < axis.half_gap:
        return np.inf
    axis.heading = side
    if side * begin >= axis.half_gap:  # a hit of the other wall found it there, perhaps by rounding beyond
        return low
    return _zero(axis, law, _POSITION, side * axis.half_gap, low, high)


@kernel
def _slide(axis: Record, law: Record, tau: float) -> tuple[float, float, float, float, float, float]:
    """Relative position, velocity, acceleration; speed and acceleration of the contact; jerk."""
    s, w, acceleration, jerk = relative(axis, law, tau)
    contact = w - axis.spin + SPIN_UP * axis.f * tau
    return s, w, acceleration, contact, acceleration + SPIN_UP * axis.f, jerk


@kernel
def _zero(axis: Record, law: Record, order: int, target: float, low: float, high: float) -> float:
    """Where a quantity that is monotone from low to high passes `target`, inf if nowhere; not at low itself."""
    rate = _RATE[order]
    falling = _slide(axis, law, low)[order] - target
    last = _slide(axis, law, high)[order] - target
    if falling == 0.0 and order == _POSITION:
        return low
    if falling * last > 0.0 or falling == 0.0 or low >= high:
        return np.inf
    tau = 0.5 * (low + high)
    for _ in range(200):
        motion = _slide(axis, law, tau)
        f = motion[order] - target
        if f == 0.0:
            return tau
        if (f > 0.0) == (falling > 0.0):
            low = tau
        else:
            high = tau
        new = tau - f / motion[rate] if motion[rate] != 0.0 else low
        new = new if low < new < high else 0.5 * (low + high)
        if abs(new - tau) <= 4e-16 * new:
            return new
        tau = new
    return tau
