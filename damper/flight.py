"""Closed-form flight: where structure and ball are, a time tau after an event.

The structure is a damped oscillator about a constant offset, u = offset + exp(-decay tau) (a cos + b sin); the ball
follows as  s = s0 + w0 tau - beta (u - u0 - v0 tau) + f tau**2 / 2: rolling, with beta of its inertia and f of the
rolling resistance; slipping, with beta = 1 and f of the sliding friction.
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
    axis.b = (axis.v + law.decay * axis.a) / law.frequency


@kernel
def structure(axis: Record, law: Record, tau: float) -> tuple[float, float, float]:
    """Displacement, velocity and acceleration of the structure, to the rounding of its amplitude about the offset.

    A heavy ball pushes the offset far out: just after the start, `increments` are better.
    """
    c, s = math.cos(law.frequency * tau), math.sin(law.frequency * tau)
    e = math.exp(-law.decay * tau) if law.decay > 0.0 else 1.0
    p = e * (axis.a * c + axis.b * s)
    q = e * (axis.b * c - axis.a * s)
    v = law.frequency * q - law.decay * p
    acceleration = -2 * law.decay * v - law.stiffness / law.mass * p
    return axis.offset + p, v, acceleration


@kernel
def velocity(axis: Record, law: Record, tau: float) -> tuple[float, float]:
    """Velocity and acceleration of the structure."""
    if tau == 0.0:
        return axis.v, -2 * law.decay * axis.v - law.stiffness / law.mass * (axis.u - axis.offset)
    _, dv, acceleration = increments(axis, law, tau)
    return axis.v + dv, acceleration


@kernel
def increments(axis: Record, law: Record, tau: float) -> tuple[float, float, float]:
    """U - u0 - v0 tau, v - v0 and the acceleration, without cancellation however small tau is."""
    if law.frequency * tau > _SHORT or law.decay * tau > _SHORT:
        u, v, acceleration = structure(axis, law, tau)
        return u - axis.u - axis.v * tau, v - axis.v, acceleration
    square = law.stiffness / law.mass
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
    jerk = -2.0 * law.decay * acceleration - law.stiffness / law.mass * (axis.v + dv)
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
        p, q = law.frequency * q - law.decay * p, -law.frequency * p - law.decay * q
    if p == 0.0 and q == 0.0:
        return np.inf
    angle = math.atan2(p, -q)
    if angle <= 0.0:
        angle += math.pi
    return angle / law.frequency


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
    p = law.frequency * axis.b - law.decay * axis.a
    q = -law.frequency * axis.a - law.decay * axis.b
    alpha, omega = law.decay, law.frequency
    mean = 0.25 * (p * p + q * q) * -math.expm1(-2 * alpha * tau) / alpha
    e = math.exp(-2 * alpha * tau)
    c, s = math.cos(2 * omega * tau), math.sin(2 * omega * tau)
    # integral of exp(-2 alpha t) (A cos 2 omega t + B sin 2 omega t)
    big_a, big_b = 0.5 * (p * p - q * q), p * q
    end = e * (big_a * (omega * s - alpha * c) - big_b * (omega * c + alpha * s))
    begin_value = -big_a * alpha - big_b * omega
    wave = 0.5 * (end - begin_value) / (alpha * alpha + omega * omega)
    return law.damping * (mean + wave)
