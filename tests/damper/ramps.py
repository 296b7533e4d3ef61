"""A ball in a cavity of a level floor on one spring, led through the amplitudes, by closed forms of its own.

It shares nothing with the engine: between events the structure swings about a shifted place and the ball follows, both
in closed form. While it rolls, its speed has its extremes where cos(theta) = a_r sigma / (omega² R): between two of
these a bisection finds the only zero there can be, and before that zero its place is monotone.
"""

import math

import numba
import numpy as np
import numpy.typing as npt

from damper import ParticleDamper

Floats = npt.NDArray[np.float64]
_BETA = 5 / 7


@numba.njit(cache=True)
def _starts(u: float, v: float, s: float, given: Floats) -> tuple[float, float]:
    """When a ball at rest in its cavity sets off, and which way."""
    m2, m, k, a, h = given[:5]
    omega = math.sqrt(k / (m2 + m))
    size, phase, level = math.hypot(u, v / omega), math.atan2(-v / omega, u), a / omega**2
    first, way = math.inf, 0.0
    for side in (-1.0, 1.0):
        if side * s >= h or size <= level:
            continue
        if side * u > level:
            return 0.0, side
        turn = -math.acos(level / size) - phase - (math.pi if side < 0 else 0.0)
        time = (turn % (2 * math.pi)) / omega
        if time < first:
            first, way = time, side
    return first, way


@numba.njit(cache=True)
def _rolled(time: float, u: float, v: float, s: float, w: float, way: float, given: Floats) -> Floats:
    """Place and velocity of structure and rolling ball after a time."""
    m2, m, k, a = given[:4]
    omega, shift = math.sqrt(k / (m2 + m * (1 - _BETA))), _BETA * m * a * way / k
    cosine, sine = math.cos(omega * time), math.sin(omega * time)
    now = shift + (u - shift) * cosine + v / omega * sine
    rate = v * cosine - (u - shift) * omega * sine
    place = s + w * time - _BETA * (now - u - v * time + 0.5 * a * way * time**2)
    return np.array([now, rate, place, w - _BETA * (rate - v + a * way * time)])


@numba.njit(cache=True)
def _ends(last: float, u: float, v: float, s: float, w: float, way: float, given: Floats) -> tuple[float, int]:
    """When a rolling ball stops (1) or meets a wall (2), at the latest after `last` (0)."""
    m2, m, k, a, h = given[:5]
    omega, shift = math.sqrt(k / (m2 + m * (1 - _BETA))), _BETA * m * a * way / k
    size, phase = math.hypot(u - shift, v / omega), math.atan2(-v / omega, u - shift)
    turn = a * way / (omega**2 * size) if size > 0 else 2.0
    turn = math.acos(turn) if abs(turn) < 1 else math.nan
    low, found = 0.0, False
    while low < last and not found:
        high = last
        for angle in (turn, -turn):
            knot = low + ((angle - phase - omega * low) % (2 * math.pi)) / omega
            if low + 1e-12 / omega < knot < high:
                high = knot
        if way * _rolled(high, u, v, s, w, way, given)[3] < 0:
            found = True
            for _ in range(60):
                middle = 0.5 * (low + high)
                if way * _rolled(middle, u, v, s, w, way, given)[3] > 0:
                    low = middle
                else:
                    high = middle
        low = high
    if way * _rolled(low, u, v, s, w, way, given)[2] < h:
        return low, 1 if found else 0
    begin = 0.0
    for _ in range(60):
        middle = 0.5 * (begin + low)
        if way * _rolled(middle, u, v, s, w, way, given)[2] < h:
            begin = middle
        else:
            low = middle
    return low, 2


@numba.njit(cache=True)
def _led(amplitudes: Floats, s: float, w: float, given: Floats, decrements: Floats) -> None:
    m2, m, k, _, h, e, sticking = given
    stuck, u, v = m2 + m, amplitudes[0], 0.0
    slowest = 1e-9 * math.sqrt(k / stuck) * u
    way = 0.0 if w == 0 else math.copysign(1.0, w)
    for n in range(len(amplitudes)):
        swing = 0.5 * k * amplitudes[n] ** 2
        scale = math.sqrt(swing / (0.5 * (stuck * v**2 + k * u**2)))
        u, v = u * scale, v * scale
        before = 0.5 * (k * u**2 + m2 * v**2 + m * (v + w) ** 2) + 0.2 * m * w**2
        left = 2 * math.pi * math.sqrt(stuck / k)
        while left > 0:
            if way == 0:
                lag, heading = _starts(u, v, s, given)
                lag = min(lag, left)
                omega = math.sqrt(k / stuck)
                cosine, sine = math.cos(omega * lag), math.sin(omega * lag)
                u, v = u * cosine + v / omega * sine, v * cosine - u * omega * sine
                way = heading if lag < left else 0.0
            else:
                lag, end = _ends(left, u, v, s, w, way, given)
                u, v, s, w = _rolled(lag, u, v, s, w, way, given)
                if end == 1:
                    w = way = 0.0
                elif end == 2:
                    s = way * h
                    v += m / stuck * (1 + e) * w
                    w = -e * w
                    if abs(w) <= max(sticking * abs(v), slowest):
                        v += m / stuck * w
                        w = 0.0
                    way = 0.0 if w == 0 else math.copysign(1.0, w)
            left -= lag
        after = 0.5 * (k * u**2 + m2 * v**2 + m * (v + w) ** 2) + 0.2 * m * w**2
        decrements[n] = -0.5 * math.log1p((after - before) / swing)


def led(damper: ParticleDamper, amplitudes: npt.ArrayLike, place: float = 0.0, speed: float = 0.0) -> Floats:
    """Logarithmic decrement of each cycle, shape (n,) [-].

    Args:
        damper: on a level floor, without damping of its own.
        amplitudes: that the structure is given before each cycle, the first at a crest, shape (n,) [m].
        place: of the ball at the beginning, over half the clearance.
        speed: of the ball in its cavity then [m/s].
    """
    half, each = damper.half_gap[0], np.array(amplitudes, dtype=float)
    given = [damper.modal_mass, damper.ball_mass, damper.stiffness[0], damper.rolling_threshold, half]
    decrements = np.zeros(len(each))
    _led(each, place * half, speed, np.array([*given, damper.restitution, damper.sticking_ratio]), decrements)
    return decrements
