"""When a power series first comes down to zero: a finder of events that steps over none.

A guard F ≥ 0 is a polynomial on [0, 1]. From a point x, Taylor to the third order with a bound B on |F'''| over [0, 1],
the sum of the moduli of its terms, gives on (0, m]

    F(x + h) ≥ F + F' h + (F'' - B m / 3) h² / 2.

Its root lies before that of F, so a step up to it passes no zero of F, however near F comes to touching; where it has
none up to m, F has none either. Steps to such roots converge to a simple zero with the third order, from below.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import fused

if TYPE_CHECKING:
    from damper.arrays import Floats

_THIRD = tuple(float(k * (k - 1) * (k - 2)) for k in range(64))

_STEPS = 200
"""Most steps to a zero: a guard that touches zero takes about 15, more is rounding."""

_ROUNDING = 4.5e-16
"""Of the sum of a guard's terms: the guard is not known better, and has reached zero there."""


@fused
def first_zero(guard: Floats, end: float) -> float:
    """First x in [0, end] at which the guard with these coefficients reaches zero, inf if it stays above.

    A guard that begins at zero has just been there and counts from its second zero on, if it rises; below zero, or
    about to be, it is at zero now.
    """
    first = 0
    while first < len(guard) and guard[first] == 0.0:
        first += 1
    if first == len(guard):
        return np.inf
    if guard[first] < 0.0:
        return 0.0
    bound, size = _bounds(guard, first)
    noise = _ROUNDING * size
    x, f = 0.0, guard[first]
    f1 = guard[first + 1] if first + 1 < len(guard) else 0.0
    f2 = 2.0 * guard[first + 2] if first + 2 < len(guard) else 0.0
    for _ in range(_STEPS):
        left = end - x
        if _safe(f, f1, f2, bound, left) > left:
            return np.inf
        reach = _reach(f, f1, f2, left)
        h = _safe(f, f1, f2, bound, reach)
        if h > reach:
            x += reach
            if x >= end:
                return np.inf
        else:
            x += h
            if bound * h * h * h <= 6e-17 * abs(f1 + f2 * h) * x:
                return x
        f, f1, f2 = _at(guard, first, x)
        if f <= noise:
            return x
    return x


@fused
def _bounds(guard: Floats, first: int) -> tuple[float, float]:
    """Bound on the third derivative over [0, 1] of what is left of a guard divided by x**first, and on itself."""
    bound = size = 0.0
    for k in range(len(guard) - first):
        term = abs(guard[first + k])
        size += term
        bound += _THIRD[k] * term
    return bound, size


@fused
def _safe(f: float, f1: float, f2: float, bound: float, reach: float) -> float:
    """Up to where the lower bound on (0, reach] stays positive, inf where it has no root."""
    return _root(f, f1, f2 - bound * reach / 3.0)


@fused
def _reach(f: float, f1: float, f2: float, left: float) -> float:
    """How far to look at once: a little beyond the root of the parabola, or past its bottom, at most what is left."""
    root = _root(f, f1, f2)
    if root < np.inf:
        return min(left, 1.25 * root)
    if f1 < 0.0:
        return min(left, -2.0 * f1 / f2)
    return 0.25 * left


@fused
def _root(f: float, f1: float, f2: float) -> float:
    """First root of the parabola f + f1 h + f2 h² / 2, f > 0, beyond h = 0, inf where it has none.

    Of the two forms of a root the one in which nothing cancels: where a guard rises from next to nothing, the other
    would lose the root, and with it an event.
    """
    square = f1 * f1 - 2.0 * f * f2
    if square < 0.0:
        return np.inf
    if f1 > 0.0:
        return (f1 + math.sqrt(square)) / -f2 if f2 < 0.0 else np.inf
    slope = math.sqrt(square) - f1
    return 2.0 * f / slope if slope > 0.0 else np.inf


@fused
def _at(guard: Floats, first: int, x: float) -> tuple[float, float, float]:
    """The guard over x**first, and its first two derivatives."""
    f = f1 = half = 0.0
    for k in range(len(guard) - 1, first - 1, -1):
        half = half * x + f1
        f1 = f1 * x + f
        f = f * x + guard[k]
    return f, f1, 2.0 * half
