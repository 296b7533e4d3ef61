"""A group's way along its series: where it comes to, and the work of dashpots and of a harmonic force on the way.

A series at a place, scaled by the powers of that place, gives by one table what it gains and its slopes at the points
of Lobatto's rule, which integrates products of two slopes over the longest step to 3e-14 of themselves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import legendre

from damper.compiled import fused
from damper.system import TERMS
from damper.vectors import WIDTH, add_times, fill, load, store, times, total

if TYPE_CHECKING:
    from damper.arrays import Floats, Record

_POINTS = 8


def lobatto() -> tuple[Floats, Floats]:
    """Points and weights of Lobatto's rule on [0, 1].

    Points inside are roots of the Jacobi polynomial of weight 1 - x², which are the eigenvalues of a symmetric matrix
    (G. H. Golub, J. H. Welsch, Math. Comp. 23 (1969) 221) and so float64 whatever the version of numpy.
    """
    k = np.arange(1, _POINTS - 2)
    inside = np.linalg.eigvalsh(np.diag(np.sqrt(k * (k + 2) / ((2 * k + 1) * (2 * k + 3))), -1), UPLO="L")
    points = np.array([-1.0, *(0.5 * (inside - inside[::-1])), 1.0])
    weights = 2.0 / (_POINTS * (_POINTS - 1) * legendre.legval(points, np.eye(_POINTS)[-1]) ** 2)
    return 0.5 * (1.0 + points), 0.5 * weights


_PLACES, _SHARES = lobatto()
_ORDER = np.arange(TERMS)[:, None]

_SLOPES = _ORDER * _PLACES ** np.maximum(_ORDER - 1, 0)
_SLOPES[:, 0] = _ORDER[:, 0] > 0
"""Of a scaled series: what it gains, then its slopes at all points but the first, where it has its second term."""

_VALUES = _PLACES**_ORDER

_WEIGHTS = _SHARES * (np.arange(_POINTS) > 0)
_FIRST = float(_SHARES[0])


@fused
def travel(g: int, x: float, it: Record) -> None:
    """Bring a group's coordinates x steps on, and book the work."""
    system, motion = it.system, it.motion
    low, high, c, scaled = system.low[g], system.high[g], motion.series[g], motion.scaled
    if x == 0.0:
        for m in range(low, high):
            motion.gain[m] = 0.0
        return
    motion.power[0], motion.power[1] = 1.0, x
    for k in range(2, WIDTH):
        motion.power[k] = motion.power[k // 2] * motion.power[k - k // 2]
    eighth = fill(motion.power[4] * motion.power[4])
    one = load(motion.power, 0)
    two = times(one, eighth)
    three = times(two, eighth)
    time, squares, first = x * system.span[g], fill(0.0), 0.0
    for m in range(low, high):
        series, dashpot = c[m - low], system.dashpot[m]
        _scale(series, one, two, three, scaled)
        at = _at_points(scaled, _SLOPES)
        squares, first = add_times(squares, times(at, at), fill(dashpot)), first + dashpot * scaled[1] * scaled[1]
        store(scaled, 0, at)
        motion.gain[m] = scaled[0]
        motion.z[m] += scaled[0]
        motion.rate[m] = scaled[WIDTH - 1] / time
    it.books.structure += (total(times(squares, load(_WEIGHTS, 0))) + _FIRST * first) / time
    if system.frequency > 0.0:
        wave = high - low + 2 * (system.last[g] - system.first[g])
        _scale(c[wave], one, two, three, scaled)
        harmonic = _at_points(scaled, _VALUES)
        _scale(c[wave + 1], one, two, three, scaled)
        power = times(_at_points(scaled, _SLOPES), load(_WEIGHTS, 0))
        it.books.work += total(times(power, harmonic)) + _FIRST * scaled[1] * c[wave, 0]


@fused
def _scale(c: Floats, one: Floats, two: Floats, three: Floats, scaled: Floats) -> None:
    """A series times powers."""
    store(scaled, 0, times(load(c, 0), one))
    store(scaled, 8, times(load(c, 8), two))
    store(scaled, 16, times(load(c, 16), three))


@fused
def _at_points(scaled: Floats, table: Floats) -> Floats:
    """A scaled series at the points of the rule."""
    even, odd = times(load(table[0], 0), fill(scaled[0])), times(load(table[1], 0), fill(scaled[1]))
    for k in range(2, TERMS, 2):
        even = add_times(even, load(table[k], 0), fill(scaled[k]))
        odd = add_times(odd, load(table[k + 1], 0), fill(scaled[k + 1]))
    return add_times(even, odd, fill(1.0))
