"""Closed-form flight: where structure and ball are, a time tau after an event.

The structure is a damped oscillator about a constant offset, u = offset + exp(-decay tau) (a C + b S) with
C = cos(omega tau) and S = sin(omega tau) / omega, which stays good as damping nears its critical value and omega zero;
the ball follows as  s = s0 + w0 tau - beta (u - u0 - v0 tau) + f tau**2 / 2: rolling, with beta of its inertia and f
of the rolling resistance; slipping, with beta = 1 and f of the sliding friction.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.records import ROLLING, SLIPPING

if TYPE_CHECKING:
    from damper.arrays import Record, Records

_SHORT = 0.1
"""Phase angle below which differences are summed as a series, since u - u0 - v0 tau would cancel."""
_TERMS = 10
_NODES = tuple(float(0.5 * (1.0 + x)) for x in np.polynomial.legendre.leggauss(5)[0])
_WEIGHTS = tuple(float(0.5 * w) for w in np.polynomial.legendre.leggauss(5)[1])
_RECIPROCALS = tuple(1.0 / max(k, 1) for k in range(_TERMS + 2))


@kernel
def begin(axis: Record, laws: Records, ball: Record, time: float) -> None:
    """Start a flight from the state in `axis`: the constants of its closed form."""
    law = laws[axis.regime]
    axis.start = time
    axis.beta, axis.f, push = 0.0, 0.0, 0.0
    if axis.regime == ROLLING:
        axis.beta, axis.f = ball.inertia_ratio, -axis.direction * ball.relative_push
        push = axis.direction * ball.push
    elif axis.regime == SLIPPING:
        axis.beta, axis.f = 1.0, -axis.direction * ball.grip
        push = -ball.mass * axis.f
    axis.offset = push / law.stiffness
    axis.a = axis.u - axis.offset
    axis.b = axis.v + law.decay * axis.a


@kernel
def wave(law: Record, tau: float) -> tuple[float, float]:
    """C and S: the cosine, and the sine over the frequency [s]."""
    angle = law.frequency * tau
    return math.cos(angle), math.sin(angle) / law.frequency


@kernel
def structure(axis: Record, law: Record, tau: float) -> tuple[float, float, float]:
    """Displacement, velocity and acceleration of the structure, to the rounding of its amplitude about the offset.

    A heavy ball pushes the offset far out: just after the start, `increments` are better.
    """
    c, s = wave(law, tau)
    e = math.exp(-law.decay * tau) if law.decay > 0.0 else 1.0
    p = e * (axis.a * c + axis.b * s)
    v = e * (axis.b * c - law.frequency * law.frequency * axis.a * s) - law.decay * p
    acceleration = -2 * law.decay * v - law.square * p
    return axis.offset + p, v, acceleration


@kernel
def velocity(axis: Record, law: Record, tau: float) -> tuple[float, float]:
    """Velocity and acceleration of the structure."""
    if tau == 0.0:
        return axis.v, -2 * law.decay * axis.v - law.square * (axis.u - axis.offset)
    _, dv, acceleration = increments(axis, law, tau)
    return axis.v + dv, acceleration


@kernel
def increments(axis: Record, law: Record, tau: float) -> tuple[float, float, float]:
    """U - u0 - v0 tau, v - v0 and the acceleration, without cancellation however small tau is."""
    if law.frequency * tau > _SHORT or law.decay * tau > _SHORT:
        u, v, acceleration = structure(axis, law, tau)
        return u - axis.u - axis.v * tau, v - axis.v, acceleration
    square = law.square
    first = axis.v
    second = -2 * law.decay * axis.v - square * (axis.u - axis.offset)
    du = dv = ddv = 0.0
    power = 1.0  # tau**k / k!
    for k in range(_TERMS):
        ddv += second * power
        power *= tau * _RECIPROCALS[k + 1]
        dv += second * power
        du += second * power * tau * _RECIPROCALS[k + 2]
        first, second = second, -2 * law.decay * second - square * first
    return du, dv, ddv


@kernel
def relative(axis: Record, law: Record, tau: float) -> tuple[float, float, float, float]:
    """Position, velocity, acceleration and jerk of a moving ball relative to the structure."""
    du, dv, acceleration = increments(axis, law, tau)
    jerk = -2.0 * law.decay * acceleration - law.square * (axis.v + dv)
    return (
        axis.s + axis.w * tau - axis.beta * du + 0.5 * axis.f * tau * tau,
        axis.w - axis.beta * dv + axis.f * tau,
        axis.f - axis.beta * acceleration,
        -axis.beta * jerk,
    )


@kernel
def first_extremum(axis: Record, law: Record, order: int) -> float:
    """First tau > 0 at which derivative `order` + 1 of u vanishes (order 2: acceleration is extreme)."""
    p, q = axis.a, axis.b
    for _ in range(order + 1):
        p, q = q - law.decay * p, -law.frequency * law.frequency * p - law.decay * q
    if p == 0.0 and q == 0.0:
        return np.inf
    angle = math.atan2(law.frequency * p, -q) if p > 0.0 else math.atan2(-law.frequency * p, q)
    return (angle if angle > 0.0 else math.pi) / law.frequency


@kernel
def viscous_loss(axis: Record, law: Record, tau: float) -> float:
    """Work of the structure's dashpot over a flight of length tau, c * integral of v**2 [J]."""
    if law.damping == 0.0:
        return 0.0
    if law.frequency * tau <= _SHORT and law.decay * tau <= _SHORT:  # the closed form would cancel: by Gauss
        square = 0.0
        for k in range(5):
            square += _WEIGHTS[k] * (axis.v + increments(axis, law, _NODES[k] * tau)[1]) ** 2
        return float(law.damping * tau * square)
    alpha, c, s = law.decay, *wave(law, tau)
    e = math.exp(-2 * alpha * tau)
    gone = -math.expm1(-2 * alpha * tau)
    # integrals of exp(-2 alpha t) times C S and S^2; that of C^2 is what 1 leaves over omega^2 S^2
    mixed = (1.0 - e * (2 * alpha * s * c + c * c - (law.frequency * s) ** 2)) / (4 * law.square)
    sines = (gone - 2 * e * alpha * s * (alpha * s + c)) / (4 * alpha * law.square)
    cosines = 0.5 * gone / alpha - law.frequency**2 * sines
    fall = alpha * axis.v + law.square * axis.a  # v = exp(-alpha t) (v0 C - fall S)
    return law.damping * (axis.v * axis.v * cosines - 2 * axis.v * fall * mixed + fall * fall * sines)
