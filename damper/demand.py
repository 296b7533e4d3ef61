"""What rolling asks of the floor along a series: the friction that it needs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.series import rates, third
from damper.system import TERMS

if TYPE_CHECKING:
    from damper.arrays import Floats, Record


@kernel
def account(s: Floats, x: float, span: float, axis: Record, ball: Record) -> None:
    """Largest force that rolling asked of the floor on this flight, per unit of the ball's mass [m/s^2].

    That is spin_mass s'' + rolling resistance: largest where s'' is, at an end or where its slope vanishes.
    """
    share, resistance = ball.spin_mass / ball.mass, axis.direction * ball.threshold
    square = 1.0 / (span * span)
    most = 0.0
    for k in range(TERMS - 1, 1, -1):
        most = most * x + k * (k - 1) * abs(s[k])
    if share * most * square + abs(resistance) <= axis.demand:
        return
    here, there = 2.0 * s[2] * square, rates(s, x)[1] * square
    axis.demand = max(axis.demand, abs(share * here + resistance), abs(share * there + resistance))
    crest = rates(s, _crest(s, x))[1] * square
    axis.demand = max(axis.demand, abs(share * crest + resistance))


@kernel
def _crest(s: Floats, end: float) -> float:
    """Where the second derivative of a series is extreme within a step; its end where it is monotone."""
    low, high = 0.0, end
    rises = third(s, low) > 0.0
    if rises == (third(s, high) > 0.0):
        return end
    for _ in range(24):
        middle = 0.5 * (low + high)
        if (third(s, middle) > 0.0) == rises:
            low = middle
        else:
            high = middle
    return low
