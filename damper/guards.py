"""When the next event of a group comes, from guards on its series; and what bounds the drive of a stuck ball for ever.

A guard is what has to reach zero: the way to a wall, the relative velocity, the rolling threshold less the drive of a
stuck ball, the sliding of the contact. Its first zero in the step is proved to be the first (`damper.finder`).

Ties: a hit comes before a reversal in the same instant, x before y.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.finder import first_zero
from damper.records import GRIP, HIT, NOTHING, REVERSAL, ROLLING, START, STUCK
from damper.series import resisting
from damper.slip import SPIN_UP
from damper.system import TERMS
from damper.threshold import MARGIN

if TYPE_CHECKING:
    from damper.arrays import Floats, Record, Records


@kernel
def seek(g: int, system: Record, motion: Record, axes: Records, ball: Record) -> None:
    """Write into a group when its next event happens, at the latest the end of its step, and what it is."""
    first, last = system.first[g], system.last[g]
    end, event, axis = 1.0, NOTHING, first
    motion.settled[g] = settled(g, system, motion, axes, ball)
    if motion.settled[g] == 0:
        for i in range(first, last):
            if axes[i].regime == ROLLING:
                x, kind = _end_of_roll(system.place[i], motion, axes[i], end)
            elif axes[i].regime != STUCK:
                x, kind = _end_of_slip(i, system, motion, axes[i], ball, end)
            elif axes[i].spin == 0.0:
                x, kind = _set_off(i, system, motion, axes[i], ball, end), START
            else:
                x, kind = _end_of_pressing(i, system, motion, axes[i], ball, end)
            if x < end or (x == end and event == NOTHING):
                end, event, axis = x, kind, i
    motion.at[g], motion.kind[g], motion.axis[g] = end, event, axis
    motion.next[g] = motion.start[g] + end * system.span[g]


@kernel
def _end_of_roll(place: int, motion: Record, axis: Record, end: float) -> tuple[float, int]:
    """Hit of the wall ahead, or a zero of the relative velocity before it."""
    guard, s, d = motion.guard, motion.series[place], axis.direction
    axis.heading = d
    x = _hit(guard, s, d, axis.half_gap, end)
    for k in range(TERMS - 1):
        guard[k] = d * (k + 1) * s[k + 1]
    guard[TERMS - 1] = 0.0
    if guard[0] == 0.0:  # just set off: it accelerates along its direction, whatever rounding says
        guard[1] = max(guard[1], 0.0)
    turn = first_zero(guard, min(x, end))
    return (turn, REVERSAL) if turn < x else (x, HIT)


@kernel
def _hit(guard: Floats, s: Floats, side: int, half_gap: float, end: float) -> float:
    """Hit of the wall on a side; a ball on that wall, or by rounding beyond it, must have left it before."""
    for k in range(TERMS):
        guard[k] = -side * s[k]
    guard[0] = max(guard[0] + half_gap, 0.0)
    if guard[0] == guard[1] == 0.0:  # just pulled off the wall: it leaves, whatever rounding says
        guard[2] = max(guard[2], 0.0)
    return first_zero(guard, end)


@kernel
def _set_off(i: int, system: Record, motion: Record, axis: Record, ball: Record, end: float) -> float:
    """Setting off of a stuck ball, its drive above the threshold, away from any wall it rests on."""
    x = np.inf
    for d in (-1, 1):
        if d * motion.z[system.place[i]] < axis.half_gap:
            _drive(i, system, motion, -d)
            motion.guard[0] += MARGIN * ball.threshold
            leaves = first_zero(motion.guard, min(x, end))
            if leaves < x:
                x, axis.heading = leaves, d
    return x


@kernel
def _end_of_pressing(
    i: int, system: Record, motion: Record, axis: Record, ball: Record, end: float
) -> tuple[float, int]:
    """End of spinning while pressed against a wall: the spin is spent, or the structure pulls the wall away."""
    side = 1 if motion.z[system.place[i]] > 0.0 else -1
    axis.heading = -side
    spent = abs(axis.spin) / (SPIN_UP * ball.grip * system.span[system.group[i]])
    _drive(i, system, motion, side)
    pressing = side * math.copysign(ball.grip, axis.spin)
    motion.guard[0] += pressing * MARGIN if pressing > 0.0 else pressing / MARGIN
    away = first_zero(motion.guard, min(end, spent))
    if away < spent:
        return away, START
    return (spent, GRIP) if spent <= end else (np.inf, NOTHING)


@kernel
def _end_of_slip(i: int, system: Record, motion: Record, axis: Record, ball: Record, end: float) -> tuple[float, int]:
    """Hit of either wall, or the end of sliding before it."""
    guard, s, d = motion.guard, motion.series[system.place[i]], axis.direction
    x, kind = np.inf, HIT
    for side in (-1, 1):
        hit = _hit(guard, s, side, axis.half_gap, min(x, end))
        if hit < x:
            x, axis.heading = hit, side
    span = system.span[system.group[i]]
    for k in range(TERMS - 1):
        guard[k] = d * (k + 1) * s[k + 1]
    guard[TERMS - 1] = 0.0
    guard[0] = d * (motion.rate[system.place[i]] - axis.spin) * span
    guard[1] -= SPIN_UP * ball.grip * span * span
    grip = first_zero(guard, min(x, end))
    if grip < x:
        x, kind = grip, GRIP
    return x, kind


@kernel
def _drive(i: int, system: Record, motion: Record, d: int) -> None:
    """Into the guard: d times the drive of a stuck ball, what accelerates it against the structure [m/s²]."""
    g = system.group[i]
    low, high = system.low[g], system.high[g]
    square = 1.0 / (system.span[g] * system.span[g])
    for k in range(TERMS - 2):
        drive = -(k + 1) * (k + 2) * square * motion.cavity[i, k + 2]
        for m in range(low, high):
            drive -= system.pull[i, m] * motion.series[m, k]
        if system.frequency > 0.0:
            drive += system.sway[i] * motion.wave[g, k]
        motion.guard[k] = d * drive
    motion.guard[TERMS - 2] = motion.guard[TERMS - 1] = 0.0


@kernel
def settled(g: int, system: Record, motion: Record, axes: Records, ball: Record) -> bool:
    """Whether the balls of a group, all stuck, will never set off again of themselves."""
    first, last = system.first[g], system.last[g]
    if system.frequency > 0.0:
        return False
    for i in range(first, last):
        if axes[i].regime != STUCK or axes[i].spin != 0.0:
            return False
    for i in range(first, last):
        bias, swing = largest_drive(i, system, motion.z, motion.rate)
        for d in (-1, 1):
            if d * motion.z[system.place[i]] < axes[i].half_gap and d * bias + swing > MARGIN * ball.threshold:
                return False
    return True


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


@kernel
def departure(i: int, system: Record, motion: Record, axes: Records, ball: Record, time: float) -> int:
    """Direction in which a ball at relative rest sets off now: -1, 1, or 0 if it stays."""
    g, axis = system.group[i], axes[i]
    low, high = system.low[g], system.high[g]
    regime, axis.regime = axis.regime, STUCK
    pair = 3 * axes[0].regime + axes[1].regime
    swing = math.cos(system.frequency * time + system.phase) if system.frequency > 0.0 else 0.0
    drive = system.sway[i] * swing
    for m in range(low, high):
        drive -= system.pull[i, m] * motion.z[m]
        if system.mode_shape[i, m] != 0.0:
            drive -= system.mode_shape[i, m] * _acceleration(m, pair, g, system, motion, axes, ball, swing)
    axis.regime = regime
    for d in (-1, 1):
        if d * motion.z[system.place[i]] < axis.half_gap and d * drive > MARGIN * ball.threshold:
            return d
    return 0


@kernel
def _acceleration(
    m: int, pair: int, g: int, system: Record, motion: Record, axes: Records, ball: Record, swing: float
) -> float:
    """Of a coordinate, now [m/s²]."""
    low, high, first, last = system.low[g], system.high[g], system.first[g], system.last[g]
    span = system.span[g]
    a = system.force[pair, m] * swing
    for n in range(low, high):
        a -= system.stiffness[pair, m, n] * motion.z[n] + system.damping[pair, m, n] * motion.rate[n] * span
    for i in range(first, last):
        a += resisting(axes[i], ball) * system.resistance[pair, i, m]
    return float(a / (span * span))
