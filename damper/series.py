"""Flights as power series: where structure and ball are within a step after an event.

The coordinates z of a group obey z'' = - stiffness z - damping z' + a constant + a harmonic: their Taylor series follow
term by term; there is nothing to diagonalise, so that equal and vanishing frequencies are no special case. A step of
`span` is as long as the fastest motion takes for a radian: what the series leaves out there is rounding, and so it is
at every other point of the step, however close to its start.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial.legendre import leggauss

from damper.compiled import fused
from damper.records import ROLLING, SLIPPING
from damper.system import TERMS

if TYPE_CHECKING:
    from damper.arrays import Floats, Record, Records

_STEP = tuple(1.0 / ((k + 1) * (k + 2)) for k in range(TERMS))
_FEW, _MANY = 5, 9
_NODES, _WEIGHTS = (np.array([np.pad(leggauss(n)[part], (0, _MANY - n)) for n in (_FEW, _MANY)]) for part in (0, 1))
_SHORT = 0.25
"""Of a step: up to here five points of Gauss integrate a product of two velocities to rounding."""


@fused
def expand(g: int, system: Record, motion: Record, axes: Records, ball: Record) -> None:
    """The series of a group from its state on."""
    low, high, first, last = system.low[g], system.high[g], system.first[g], system.last[g]
    span = system.span[g]
    pair = 3 * axes[0].regime + axes[1].regime
    a, d, c = system.stiffness[pair], system.damping[pair], motion.series
    for m in range(low, high):
        c[m, 0], c[m, 1], c[m, 2] = motion.z[m], motion.rate[m] * span, 0.0
        for i in range(first, last):
            c[m, 2] += resisting(axes[i], ball) * system.resistance[pair, i, m]
    wave, driven = motion.wave[g], system.frequency > 0.0
    if driven:
        _oscillate(wave, system.frequency * span, system.frequency * motion.start[g] + system.phase)
    plain = not driven and system.damped == 0
    if plain and high - low == 2:
        _recur_plain_pair(low, a, c)
    elif plain:
        _recur_plain(low, high, a, c)
    elif high - low == 2:
        _recur_pair(low, a, d, c, system.force[pair], wave)
    else:
        _recur(low, high, a, d, c, system.force[pair], wave)
    for i in range(first, last):
        for k in range(TERMS):
            motion.cavity[i, k] = 0.0
            for m in range(low, high):
                motion.cavity[i, k] += system.mode_shape[i, m] * c[m, k]


@fused
def _recur(low: int, high: int, a: Floats, d: Floats, c: Floats, force: Floats, wave: Floats) -> None:
    """Term by term, from the two first ones and the constant in the place of the third."""
    for m in range(low, high):
        c[m, 2] += force[m] * wave[0]
        for n in range(low, high):
            c[m, 2] -= a[m, n] * c[n, 0] + d[m, n] * c[n, 1]
        c[m, 2] *= 0.5
    for k in range(1, TERMS - 2):
        for m in range(low, high):
            acceleration = force[m] * wave[k]
            for n in range(low, high):
                acceleration -= a[m, n] * c[n, k] + (k + 1) * d[m, n] * c[n, k + 1]
            c[m, k + 2] = acceleration * _STEP[k]


@fused
def _recur_plain(low: int, high: int, a: Floats, c: Floats) -> None:
    """The same without damping or a harmonic."""
    for m in range(low, high):
        for n in range(low, high):
            c[m, 2] -= a[m, n] * c[n, 0]
        c[m, 2] *= 0.5
    for k in range(1, TERMS - 2):
        for m in range(low, high):
            deceleration = 0.0
            for n in range(low, high):
                deceleration += a[m, n] * c[n, k]
            c[m, k + 2] = -deceleration * _STEP[k]


@fused
def _recur_pair(low: int, a: Floats, d: Floats, c: Floats, force: Floats, wave: Floats) -> None:
    """The same for one mode and one axis, nearly always so."""
    aqq, aqs, asq, ass = -a[low, low], -a[low, low + 1], -a[low + 1, low], -a[low + 1, low + 1]
    dq, ds, fq, fs = -d[low, low], -d[low + 1, low], force[low], force[low + 1]
    q, s = c[low], c[low + 1]
    q[2] = 0.5 * (q[2] + fq * wave[0] + aqq * q[0] + aqs * s[0] + dq * q[1])
    s[2] = 0.5 * (s[2] + fs * wave[0] + asq * q[0] + ass * s[0] + ds * q[1])
    for k in range(1, TERMS - 2):
        q[k + 2] = _STEP[k] * (fq * wave[k] + aqq * q[k] + aqs * s[k] + (k + 1) * dq * q[k + 1])
        s[k + 2] = _STEP[k] * (fs * wave[k] + asq * q[k] + ass * s[k] + (k + 1) * ds * q[k + 1])


@fused
def _recur_plain_pair(low: int, a: Floats, c: Floats) -> None:
    """The same without damping or a harmonic."""
    aqq, aqs, asq, ass = -a[low, low], -a[low, low + 1], -a[low + 1, low], -a[low + 1, low + 1]
    q, s = c[low], c[low + 1]
    q[2] = 0.5 * (q[2] + aqq * q[0] + aqs * s[0])
    s[2] = 0.5 * (s[2] + asq * q[0] + ass * s[0])
    for k in range(1, TERMS - 2):
        q[k + 2] = _STEP[k] * (aqq * q[k] + aqs * s[k])
        s[k + 2] = _STEP[k] * (asq * q[k] + ass * s[k])


@fused
def _oscillate(wave: Floats, turn: float, phase: float) -> None:
    """Series of cos(turn x + phase)."""
    wave[0], wave[1] = math.cos(phase), -turn * math.sin(phase)
    for k in range(TERMS - 2):
        wave[k + 2] = -turn * turn * wave[k] * _STEP[k]


@fused
def resisting(axis: Record, ball: Record) -> float:
    """What resists the motion of the ball along an axis, in the direction of that motion or sliding [m/s²]."""
    if axis.regime == ROLLING:
        return float(axis.direction * ball.threshold)
    return float(axis.direction * ball.grip) if axis.regime == SLIPPING else 0.0


@fused
def increment(series: Floats, x: float) -> tuple[float, float]:
    """What a series gains from 0 to x, and its slope there."""
    f = rate = 0.0
    for k in range(TERMS - 1, 0, -1):
        rate = rate * x + f
        f = f * x + series[k]
    return f * x, rate * x + f


@fused
def slope(series: Floats, x: float) -> float:
    """Slope of a series."""
    rate = 0.0
    for k in range(TERMS - 1, 0, -1):
        rate = rate * x + k * series[k]
    return rate


@fused
def rates(series: Floats, x: float) -> tuple[float, float]:
    """First and second derivative of a series."""
    first = second = 0.0
    for k in range(TERMS - 1, 0, -1):
        second = second * x + first
        first = first * x + k * series[k]
    return first, second


@fused
def dissipated(g: int, system: Record, motion: Record, x: float) -> float:
    """Work of the structure's dashpots from a group's start to x [J]."""
    low, high = system.low[g], system.high[g]
    work = 0.0
    for m in range(low, high):
        if system.dashpot[m] > 0.0:
            work += system.dashpot[m] * _squares(motion.series[m], x)
    return float(work * x / system.span[g])


@fused
def put_in(g: int, system: Record, motion: Record, x: float) -> float:
    """Work of the harmonic force from a group's start to x [J]."""
    if system.frequency == 0.0:
        return 0.0
    low, high = system.low[g], system.high[g]
    row, points = (0, _FEW) if x <= _SHORT else (1, _MANY)
    work = 0.0
    for n in range(points):
        node, power = 0.5 * (1.0 + _NODES[row, n]) * x, 0.0
        for m in range(low, high):
            if system.power[m] != 0.0:
                power += system.power[m] * slope(motion.series[m], node)
        work += 0.5 * _WEIGHTS[row, n] * power * value(motion.wave[g], node)
    return work * x


@fused
def value(series: Floats, x: float) -> float:
    """A series at x."""
    f = 0.0
    for k in range(TERMS - 1, -1, -1):
        f = f * x + series[k]
    return f


@fused
def _squares(series: Floats, x: float) -> float:
    """Mean of the squared slope from 0 to x."""
    row, points = (0, _FEW) if x <= _SHORT else (1, _MANY)
    mean = 0.0
    for n in range(points):
        mean += 0.5 * _WEIGHTS[row, n] * slope(series, 0.5 * (1.0 + _NODES[row, n]) * x) ** 2
    return mean
