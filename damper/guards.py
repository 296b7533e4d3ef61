"""When the next event of a group comes, from guards on its series.

A guard is what has to reach zero: the way to a wall, the relative velocity, the rolling threshold less the drive of a
stuck ball, the sliding of the contact. Its first zero in the step is proved to be the first (`damper.finder`).

Ties: a hit comes before a reversal in the same instant, x before y.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import fused, kernel
from damper.drive import drive_lane, settled
from damper.finder import first_zero
from damper.records import GRIP, HIT, NOTHING, REVERSAL, ROLLING, START, STUCK
from damper.slip import SPIN_UP
from damper.system import TERMS
from damper.threshold import MARGIN

if TYPE_CHECKING:
    from damper.arrays import Floats, Record


@kernel
def seek(g: int, it: Record) -> None:
    """Write into a group when its next event happens, at the latest the end of its step, and what it is."""
    system, motion, axes = it.system, it.motion, it.axes
    end, event, axis = 1.0, NOTHING, system.first[g]
    motion.settled[g] = settled(g, it)
    if motion.settled[g] == 0:
        for i in range(system.first[g], system.last[g]):
            if axes[i].regime == ROLLING:
                x, kind = _end_of_roll(motion.series[g, system.lane[i]], motion.guard, axes[i], end)
            elif axes[i].regime != STUCK:
                x, kind = _end_of_slip(i, it, end)
            elif axes[i].spin == 0.0:
                x, kind = _set_off(i, it, end), START
            else:
                x, kind = _end_of_pressing(i, it, end)
            if x < end or (x == end and event == NOTHING):
                end, event, axis = x, kind, i
    motion.at[g], motion.kind[g], motion.axis[g] = end, event, axis
    motion.next[g] = motion.start[g] + end * system.span[g]


@kernel
def _end_of_roll(s: Floats, guard: Floats, axis: Record, end: float) -> tuple[float, int]:
    """Hit of the wall ahead, or a zero of the relative velocity before it."""
    d = axis.direction
    axis.heading = d
    x = _hit(s, guard, d, axis.half_gap, end)
    _velocity(s, guard, d)
    if guard[0] == 0.0:  # just set off: it accelerates along its direction, whatever rounding says
        guard[1] = max(guard[1], 0.0)
    turn = first_zero(guard, min(x, end))
    return (turn, REVERSAL) if turn < x else (x, HIT)


@fused
def _velocity(s: Floats, guard: Floats, d: int) -> None:
    """Into the guard: d times the relative velocity."""
    for k in range(TERMS - 1):
        guard[k] = d * (k + 1) * s[k + 1]
    guard[TERMS - 1] = 0.0


@kernel
def _hit(s: Floats, guard: Floats, side: int, half_gap: float, end: float) -> float:
    """Hit of the wall on a side; a ball on that wall, or by rounding beyond it, must have left it before."""
    for k in range(TERMS):
        guard[k] = -side * s[k]
    guard[0] = max(guard[0] + half_gap, 0.0)
    if guard[0] == guard[1] == 0.0:  # just pulled off the wall: it leaves, whatever rounding says
        guard[2] = max(guard[2], 0.0)
    return first_zero(guard, end)


@kernel
def _set_off(i: int, it: Record, end: float) -> float:
    """Setting off of a stuck ball, its drive above the threshold, away from any wall it rests on."""
    x, axis, guard = np.inf, it.axes[i], it.motion.guard
    for d in (-1, 1):
        if d * it.motion.z[it.system.place[i]] < axis.half_gap:
            _drive(i, it, -d)
            guard[0] += MARGIN * it.ball.threshold
            leaves = first_zero(guard, min(x, end))
            if leaves < x:
                x, axis.heading = leaves, d
    return x


@kernel
def _end_of_pressing(i: int, it: Record, end: float) -> tuple[float, int]:
    """End of spinning while pressed against a wall: the spin is spent, or the structure pulls the wall away."""
    system, axis, guard = it.system, it.axes[i], it.motion.guard
    side = 1 if it.motion.z[system.place[i]] > 0.0 else -1
    axis.heading = -side
    spent = abs(axis.spin) / (SPIN_UP * it.ball.grip * system.span[system.group[i]])
    _drive(i, it, side)
    pressing = side * math.copysign(it.ball.grip, axis.spin)
    guard[0] += pressing * MARGIN if pressing > 0.0 else pressing / MARGIN
    away = first_zero(guard, min(end, spent))
    if away < spent:
        return away, START
    return (spent, GRIP) if spent <= end else (np.inf, NOTHING)


@kernel
def _end_of_slip(i: int, it: Record, end: float) -> tuple[float, int]:
    """Hit of either wall, or the end of sliding before it."""
    system, axis, guard = it.system, it.axes[i], it.motion.guard
    g = system.group[i]
    s, d, span = it.motion.series[g, system.lane[i]], axis.direction, system.span[g]
    x, kind = np.inf, HIT
    for side in (-1, 1):
        hit = _hit(s, guard, side, axis.half_gap, min(x, end))
        if hit < x:
            x, axis.heading = hit, side
    _velocity(s, guard, d)
    guard[0] = d * (it.motion.rate[system.place[i]] - axis.spin) * span
    guard[1] -= SPIN_UP * it.ball.grip * span * span
    grip = first_zero(guard, min(x, end))
    if grip < x:
        x, kind = grip, GRIP
    return x, kind


@kernel
def _drive(i: int, it: Record, d: int) -> None:
    """Into the guard: d times the drive of a stuck ball, what accelerates it against the structure [m/s²]."""
    drive = it.motion.series[it.system.group[i], drive_lane(i, it)]
    for k in range(TERMS):
        it.motion.guard[k] = d * drive[k]
