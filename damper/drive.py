"""What drives a stuck ball along the floor: now, by which it sets off, and at most from here on."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.records import STUCK
from damper.series import gather, regimes
from damper.threshold import MARGIN

if TYPE_CHECKING:
    from damper.arrays import Floats, Record


@kernel
def departure(i: int, time: float, it: Record, flow: Floats) -> int:
    """Direction in which a ball at relative rest sets off now: -1, 1, or 0 if it stays."""
    system, axis, g = it.system, it.axes[i], it.system.group[i]
    regime, axis.regime = axis.regime, STUCK
    sources, terms = gather(g, time, it), flow[regimes(g, it), drive_lane(i, it)]
    axis.regime = regime
    drive = 0.0
    for j in range(sources):
        drive += terms[j, 0] * it.motion.source[j]
    for d in (-1, 1):
        if d * it.motion.z[system.place[i]] < axis.half_gap and d * drive > MARGIN * it.ball.threshold:
            return d
    return 0


@kernel
def drive_lane(i: int, it: Record) -> int:
    """Which series of its group is the drive of a ball stuck along an axis."""
    system, g = it.system, it.system.group[i]
    return int(system.high[g] - system.low[g] + system.last[g] - 2 * system.first[g] + i)


@kernel
def settled(g: int, it: Record) -> bool:
    """Whether the balls of a group, all stuck, will never set off again of themselves."""
    system, axes = it.system, it.axes
    first, last = system.first[g], system.last[g]
    if system.frequency > 0.0:
        return False
    for i in range(first, last):
        if axes[i].regime != STUCK or axes[i].spin != 0.0:
            return False
    for i in range(first, last):
        bias, swing = largest_drive(i, system, it.motion.z, it.motion.rate)
        for d in (-1, 1):
            away = d * it.motion.z[system.place[i]] < axes[i].half_gap
            if away and d * bias + swing > MARGIN * it.ball.threshold:
                return False
    return True


@kernel
def strongest_drive(it: Record) -> float:
    """Largest drive of the ball, were it stuck, along either axis from here on [m/s²]."""
    most = 0.0
    for i in range(2):
        bias, swing = largest_drive(i, it.system, it.motion.z, it.motion.rate)
        most = max(most, abs(bias) + swing)
    return most


@kernel
def largest_drive(i: int, system: Record, z: Floats, rate: Floats) -> tuple[float, float]:
    """Drive of a stuck ball at the structure's place of rest, and a bound on what its motion adds, now and later.

    Without dashpots the amplitudes of the modes stay; with them, the sum of their squares falls.
    """
    low, high = system.low[system.group[i]], system.high[system.group[i]]
    bias = total = reaches = squares = 0.0
    for k in range(low, high):
        bias += system.bias[i, k] * z[k]
        deflection = swing = 0.0
        for m in range(low, high):
            deflection += system.deflection[k, m] * z[m]
            swing += system.swing[k, m] * rate[m]
        square = deflection * deflection + swing * swing
        total += system.reach[i, k] * math.sqrt(square)
        reaches += system.reach[i, k] ** 2
        squares += square
    damped = system.damped != 0
    return bias, math.sqrt(reaches * squares) if damped else total
