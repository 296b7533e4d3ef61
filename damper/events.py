"""The next event of a flight: when it ends, and how.

An event is a zero of a guard: the distance to a wall, the relative velocity, the rolling threshold less the drive of
a stuck ball, the sliding speed of the contact. Three parts:

- `first_zero`: the first zero of a power series, proved to be the first;
- `seek`: the next event of a group of coordinates;
- `departure`: the direction in which a ball at rest sets off, `settled`: whether it ever will; `account`: the friction
  that rolling demands of the floor.

Ties: a hit comes before a reversal in the same instant, x before y.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import fused, inlined, part
from damper.flight import derivatives, gather, regimes, sizes
from damper.state import GRIP, HIT, INVERSE, MARGIN, NOTHING, REVERSAL, ROLLING, SPIN_UP, START, STUCK, TERMS

if TYPE_CHECKING:
    from damper.model import Floats, Record


_STEPS = 200
"""Most steps to a zero: a guard that touches zero takes about 15, more is rounding."""

FAR = 1.25
"""Over the end up to which a flight is looked at: how far off a guess is worth a look."""

_SURE = 1e-4
"""Share of its slope by which a guard must fall towards a root that is not known to its last digits."""

_NOTHING = 1e-290
"""Drive [m/s²] that moves nothing: what is computed of a smaller one has no digits."""

_SMALL = 1e-190
"""Square of a slope whose cube may have lost its digits to underflow."""

_SET_OFF = 1e-9
"""Share of a velocity's other terms by which a ball that has just set off may seem to accelerate backwards.

A ball at a turning point, where its flight was broken off, does so by more: it reverses at once.
"""

_ROUNDING = 4.5e-16
"""Of the sum of a guard's terms: the guard is not known better, and has reached zero there."""


@part
def first_zero(guard: Floats, end: float) -> float:
    """First x in [0, end] at which the guard, a series, reaches zero, inf if it stays above.

    A guard that begins at zero has just been there and counts from its second zero on, if it rises: it is divided by
    x, in place. Below zero, or about to be, it is at zero now.
    """
    first = 0
    while first < TERMS and guard[first] == 0.0:
        first += 1
    if first == TERMS:
        return np.inf
    if guard[first] < 0.0:
        return 0.0
    if first > 0:
        share = 1.0
        for k in range(first):
            share /= k + 1.0
        for k in range(TERMS):
            guard[k] = share * guard[k + first] if k + first < TERMS else 0.0
            share *= (k + 1.0) / (k + first + 1.0)
    guess = _root(guard[0], guard[1], guard[2])
    if guess < FAR * end:
        x, last, slope, bend, _ = polished(guard, 0, -guard[0], _nearer(guard, 0, -guard[0], guess))
        if x > 0.0 and falls(guard, 0, last, slope, bend):
            return x if x <= end else np.inf
        if not x > end:
            return _searched(guard, end)
    return np.inf if stays(guard, 0, 0, 0.0, 1.0, end) else _searched(guard, end)


@fused
def falls(c: Floats, order: int, last: float, slope: float, bend: float) -> bool:
    """Whether a guard, a derivative of a series, is proved to have its first zero where it was found to have one.

    At x = last - y, from the last place before it on, the guard is at least y (-slope + bend y / 2 - bound y² / 6),
    with the bound of its third derivative: least at an end.
    """
    bound = sizes(c, order + 3, 0, last)
    return bool(slope < 0.0 and slope + last * (bound * last / 6.0 - 0.5 * bend) < _SURE * slope)


@fused
def stays(c: Floats, order: int, skip: int, level: float, d: float, x: float) -> bool:
    """Whether d times a derivative of a series, and a level, is proved to stay above zero up to x.

    It is at least the quartic of its first five terms less the sizes of all others, and that is at least the least of
    its coefficients in Bernstein's basis on (0, x]. With `skip` 1 it begins at zero, and counts over its argument.
    """
    power, k = (x if skip == 1 else 1.0), order + skip
    c0 = level + d * power * c[k]
    c1, c2 = d * power * x * c[k + 1] * INVERSE[skip + 1], d * power * x * x * c[k + 2] * INVERSE[skip + 2]
    power *= x * x * x
    c3, c4 = d * power * c[k + 3] * INVERSE[skip + 3], d * power * x * c[k + 4] * INVERSE[skip + 4]
    return _bernstein(c0, c1, c2, c3, c4 - sizes(c, order, 5 + skip, x))


@fused
def _bernstein(c0: float, c1: float, c2: float, c3: float, c4: float) -> bool:
    """Whether a quartic's coefficients in Bernstein's basis on [0, 1] are positive."""
    middle = min(c0 + 0.25 * c1, c0 + 0.5 * c1 + c2 / 6.0)
    return bool(min(min(c0, middle), min(c0 + 0.75 * c1 + 0.5 * c2 + 0.25 * c3, c0 + c1 + c2 + c3 + c4)) > 0.0)


@fused
def polished(c: Floats, order: int, level: float, x: float) -> tuple[float, float, float, float, float]:
    """Where a series gains so much (order 0) or its slope has a zero (1), by Householder's method; nan: nowhere near.

    Also the place before the last step, and there the first two derivatives of what has that zero, and the gain.
    """
    for _ in range(6):
        if not x > 0.0:
            break
        near = 1.0 / x
        gain, f1, f2, f3 = derivatives(c, x)
        miss, slope, bend, third = (level - gain, f1, f2, f3) if order == 0 else (-f1, f2, f3, 0.0)
        inverse = 1.0 / slope
        step = miss * inverse
        curve, share = 0.5 * step * bend * inverse, step * near
        if not (abs(curve) < 0.25 and abs(share) < 0.5 and slope * slope > _SMALL):
            break
        last, x = x, x + _step(miss, slope, bend, third)
        off = abs(share) * (curve * curve + share * share)
        if order == 0:
            off *= abs(curve) + abs(share)
        if off <= 1e-17:
            return x, last, slope, bend, gain
    return np.nan, x, 0.0, 0.0, 0.0


@part
def _searched(guard: Floats, end: float) -> float:
    """First zero of a guard that begins above zero, by steps that no zero can lie in."""
    bound, noise = sizes(guard, 3, 0, 1.0), _ROUNDING * sizes(guard, 0, 0, 1.0)
    x, f, f1, f2 = 0.0, guard[0], guard[1], guard[2]
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
        gain, f1, f2, _ = derivatives(guard, x)
        f = guard[0] + gain
        if f <= noise:
            return x
    return x


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
def _least(ball: Record) -> float:
    """Drive that a stuck ball needs to set off."""
    return float(MARGIN * ball.hold + _NOTHING)


@inlined
def drives(i: int, time: float, it: Record, flow: Floats) -> tuple[float, float]:
    """Drive of the ball along an axis now, were it stuck, with the dashpot of a moving and of a stuck ball.

    They differ in the printed equations alone.
    """
    axis, g = it.axes[i], it.system.group[i]
    regime, axis.regime = axis.regime, STUCK
    sources, terms = gather(g, time, it), flow[regimes(g, it), drive_lane(i, it)]
    axis.regime = regime
    drive = 0.0
    for j in range(sources):
        drive += terms[j, 0] * it.motion.source[j]
    return drive, drive + it.system.excess[i] * axis.v


@inlined
def departure(i: int, time: float, it: Record, flow: Floats) -> int:
    """Direction in which a ball at relative rest sets off now: -1, 1, or 0 if it stays."""
    one, other = drives(i, time, it, flow)
    d = 1 if one > 0.0 else -1
    free = d * it.motion.z[it.system.place[i]] < it.axes[i].half_gap
    return d if free and min(d * one, d * other) > _least(it.ball) else 0


@part
def drive_lane(i: int, it: Record) -> int:
    """Which series of its group is the drive of a ball stuck along an axis."""
    system, g = it.system, it.system.group[i]
    return int(system.high[g] - system.low[g] + system.last[g] - 2 * system.first[g] + i)


@part
def settled(g: int, it: Record) -> bool:
    """Whether the balls of a group, all stuck, will never set off again of themselves."""
    system, axes = it.system, it.axes
    first, last = system.first[g], system.last[g]
    if system.frequency > 0.0:
        return False
    for i in range(first, last):
        if axes[i].regime != STUCK or axes[i].spin != 0.0:
            return False
    stays = True
    for i in range(first, last):
        stays = stays and stays_stuck(i, it, it.motion.z, it.motion.rate, 0.0)
    return stays


@part
def stays_stuck(i: int, it: Record, z: Floats, rate: Floats, more: float) -> bool:
    """Whether the drive by what moves so, and that much more, never sets a ball off that is stuck along an axis."""
    bias, swing = largest_drive(i, it.system, z, rate)
    for d in (-1, 1):
        away = d * it.motion.z[it.system.place[i]] < it.axes[i].half_gap
        if away and d * bias + swing + more > MARGIN * it.ball.hold:
            return False
    return True


@part
def strongest_drive(it: Record) -> float:
    """Largest drive of the ball, were it stuck, along either axis from here on [m/s²]."""
    most = 0.0
    for i in range(2):
        bias, swing = largest_drive(i, it.system, it.motion.z, it.motion.rate)
        most = max(most, abs(bias) + swing)
    return most


@part
def largest_drive(i: int, system: Record, z: Floats, rate: Floats) -> tuple[float, float]:
    """Drive of a stuck ball at the structure's place of rest, and a bound on what its motion adds, now and later.

    Without dashpots the amplitudes of the modes stay; with them, the sum of their squares falls.
    """
    low, high = system.low[system.group[i]], system.high[system.group[i]]
    bias, total, reaches, squares = system.lateral[i], 0.0, 0.0, 0.0
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


@part
def seek(g: int, it: Record) -> None:
    """Write into a group when its next event happens, at the latest the end of its step, and what it is.

    Where nothing moves, and never will, that is inf.
    """
    system, motion, axes = it.system, it.motion, it.axes
    end, event, axis = 1.0, NOTHING, system.first[g]
    for i in range(system.first[g], system.last[g]):
        if axes[i].regime == ROLLING:
            x, kind = _end_of_roll(motion.series[g, system.lane[i]], motion.guard[:], axes[i], end)
        elif axes[i].regime != STUCK:
            x, kind = _end_of_slip(i, it, end)
        elif axes[i].spin == 0.0:
            x, kind = _set_off(i, it, end), START
        else:
            x, kind = _end_of_pressing(i, it, end)
        if x < end or (x == end and event == NOTHING):
            end, event, axis = x, kind, i
    motion.settled[g] = event == NOTHING and settled(g, it)
    motion.at[g], motion.kind[g], motion.axis[g] = end, event, axis
    stands = motion.settled[g] != 0 and _stands(motion.series[g, : system.high[g] - system.low[g]])
    motion.next[g] = np.inf if stands else motion.start[g] + end * system.span[g]


@part
def _stands(series: Floats) -> bool:
    """Whether nothing moves on a flight: it then needs no further steps."""
    for c in series:
        for k in range(1, TERMS):
            if c[k] != 0.0:
                return False
    return True


@fused
def _end_of_roll(s: Floats, guard: Floats, axis: Record, end: float) -> tuple[float, int]:
    """Hit of the wall ahead, or a zero of the relative velocity before it.

    As long as the velocity is positive the ball nears the wall: that it stays positive up to a root proves that neither
    a hit nor a reversal comes before. Nearly every flight ends by Householder's method and that bound, of the velocity,
    or of the velocity over x where it begins at zero.
    """
    d = float(axis.direction)
    gap, v, v1, v2, v3 = axis.half_gap - d * s[0], d * s[1], d * s[2], d * s[3], d * s[4]
    axis.heading, begins = axis.direction, v == 0.0
    if gap > 0.0 and (v > 0.0 or (begins and v1 > 0.0)):
        turn = _root(v1, 0.5 * v2, v3 / 3.0) if begins else _root(v, v1, v2)
        turns = turn < FAR * end and turn * (v + turn * (0.5 * v1 + turn * (v2 / 6.0 + turn * v3 / 24.0))) < gap
        guess, order, level, most = turn, 1, 0.0, -s[1]
        if not turns:
            guess, order, level, most = _root(gap, -v, -v1), 0, d * gap, d * gap
            if v2 * guess > 12.0 * v1:  # just set off: the jerk carries the ball
                guess = min(guess, np.cbrt(6.0 * gap / v2))
        x, sure = np.inf, True
        if guess < FAR * end:
            x, last, slope, bend, gain = polished(s, order, level, _nearer(s, order, most, guess))
            if turns and 0.0 < x <= end:
                left = gap - d * gain - abs(slope) * (x - last) ** 2
                sure = False
                if left > 0.0 and falls(s, 1, last, d * slope, d * bend):
                    return x, REVERSAL
        if sure and x > 0.0 and stays(s, 1, int(begins), 0.0, d, min(x, end)):
            if x <= end:
                return x, HIT
            if d * derivatives(s, end)[0] < gap:
                return np.inf, NOTHING
    return _searched_end(s, guard, axis, end)


@part
def _searched_end(s: Floats, guard: Floats, axis: Record, end: float) -> tuple[float, int]:
    """The end of a roll by its two guards, each for itself."""
    d = axis.direction
    x = _hit(s, guard, d, axis.half_gap, end)
    _guarded(s, 1, float(d), guard)
    if guard[0] == 0.0 and guard[1] > -_SET_OFF * sizes(guard, 0, 2, 1.0):  # just set off, whatever rounding says
        guard[1] = max(guard[1], 0.0)
    turn = first_zero(guard, min(x, end))
    return (turn, REVERSAL) if turn < x else (x, HIT)


@fused
def _nearer(s: Floats, order: int, level: float, x: float) -> float:
    """Where a series (order 0) or its slope (1) gains so much, by a step from x with its first seven derivatives."""
    f1, f2, f3, f4 = s[order + 1], s[order + 2], s[order + 3], s[order + 4]
    f5, f6, f7 = s[order + 5], s[order + 6], s[order + 7]
    y = x * x
    gain = (f5 / 120.0 + x * f6 / 720.0) + y * f7 / 5040.0
    gain = (f1 + x * f2 / 2.0) + y * ((f3 / 6.0 + x * f4 / 24.0) + y * gain)
    slope = (f1 + x * f2) + y * ((f3 / 2.0 + x * f4 / 6.0) + y * ((f5 / 24.0 + x * f6 / 120.0) + y * f7 / 720.0))
    bend = (f2 + x * f3) + y * ((f4 / 2.0 + x * f5 / 6.0) + y * (f6 / 24.0 + x * f7 / 120.0))
    third = (f3 + x * f4) + y * (f5 / 2.0 + x * f6 / 6.0)
    return x + _step(level - x * gain, slope, bend, third)


@fused
def _step(miss: float, slope: float, bend: float, third: float) -> float:
    """How far on a function with these derivatives gains so much: Householder's step, its error of fourth order."""
    square, part = slope * slope, 0.5 * miss * bend
    return miss * (square + part) / (slope * (square + 2.0 * part) + miss * miss * third / 6.0)


@fused
def _guarded(s: Floats, order: int, d: float, guard: Floats) -> None:
    """Into the guard: d times a series (order 0) or its slope (1)."""
    for k in range(TERMS - order):
        guard[k] = d * s[k + order]
    for k in range(TERMS - order, TERMS):
        guard[k] = 0.0


@part
def _hit(s: Floats, guard: Floats, side: int, half_gap: float, end: float) -> float:
    """Hit of the wall on a side; a ball on that wall, or by rounding beyond it, must have left it before."""
    _guarded(s, 0, float(-side), guard)
    guard[0] = max(guard[0] + half_gap, 0.0)
    if guard[0] == guard[1] == 0.0:  # just pulled off the wall: it leaves, whatever rounding says
        guard[2] = max(guard[2], 0.0)
    return first_zero(guard, end)


@part
def _set_off(i: int, it: Record, end: float) -> float:
    """Setting off of a stuck ball, its drive above the threshold, away from any wall it rests on."""
    x, axis, guard, system = np.inf, it.axes[i], it.motion.guard[:], it.system
    drive, least = it.motion.series[system.group[i], drive_lane(i, it)], _least(it.ball)
    for d in (-1, 1):
        if d * it.motion.z[system.place[i]] < axis.half_gap:
            if stays(drive, 0, 0, least, -float(d), end):
                continue
            _guarded(drive, 0, float(-d), guard)
            guard[0] += least
            leaves = first_zero(guard, min(x, end))
            if leaves < x and (system.excess[i] == 0.0 or _both_drive(i, it, d, leaves)):
                x, axis.heading = leaves, d
    return x


@part
def _both_drive(i: int, it: Record, d: int, x: float) -> bool:
    """Whether the dashpot of a stuck ball, too, lets the drive exceed the threshold x steps on.

    While the structure moves the way that the ball is to go, it does; after that both drives fall for half a period.
    """
    g = it.system.group[i]
    c, drive = it.motion.series[g, it.system.cavity[i]], it.motion.series[g, drive_lane(i, it)]
    other = drive[0] + derivatives(drive, x)[0] + it.system.excess[i] * derivatives(c, x)[1] / it.system.span[g]
    return bool(d * other >= it.ball.hold / MARGIN)


@part
def _end_of_pressing(i: int, it: Record, end: float) -> tuple[float, int]:
    """End of spinning while pressed against a wall: the spin is spent, or the structure pulls the wall away."""
    system, axis, guard = it.system, it.axes[i], it.motion.guard[:]
    side = 1 if it.motion.z[system.place[i]] > 0.0 else -1
    axis.heading = -side
    spent = abs(axis.spin) / (SPIN_UP * it.ball.grip * system.span[system.group[i]])
    _guarded(it.motion.series[system.group[i], drive_lane(i, it)], 0, float(side), guard)
    pressing = side * math.copysign(it.ball.grip, axis.spin)
    guard[0] += pressing * MARGIN if pressing > 0.0 else pressing / MARGIN
    away = first_zero(guard, min(end, spent))
    if away < spent:
        return away, START
    return (spent, GRIP) if spent <= end else (np.inf, NOTHING)


@part
def _end_of_slip(i: int, it: Record, end: float) -> tuple[float, int]:
    """Hit of either wall, or the end of sliding before it."""
    system, axis, guard = it.system, it.axes[i], it.motion.guard[:]
    g = system.group[i]
    s, d, span = it.motion.series[g, system.lane[i]], axis.direction, system.span[g]
    x = np.inf
    for side in (-1, 1):
        hit = _hit(s, guard, side, axis.half_gap, min(x, end))
        if hit < x:
            x, axis.heading = hit, side
    _guarded(s, 1, float(d), guard)
    guard[0] = d * (it.motion.rate[system.place[i]] - axis.spin) * span
    guard[1] -= SPIN_UP * it.ball.grip * span * span
    grip = first_zero(guard, min(x, end))
    return (grip, GRIP) if grip < x else (x, HIT)


@inlined
def account(s: Floats, x: float, span: float, axis: Record, ball: Record) -> None:
    """Largest force that rolling asked of the floor on this flight, per unit of the ball's mass [m/s^2].

    That is (1 / beta - 1) s'' + rolling resistance: largest where s'' is, at an end or where its slope vanishes.
    Between two ends it exceeds the larger one by x²/8 times the fourth derivative at most.
    """
    share, resistance = (1.0 / ball.inertia_ratio - 1.0) / (span * span), axis.direction * ball.threshold
    here, there = share * s[2] + resistance, share * derivatives(s, x)[2] + resistance
    axis.demand = max(axis.demand, abs(here), abs(there))
    beyond = 0.125 * abs(share) * x * x * sizes(s, 4, 0, x)
    if max(max(here, there), -min(here, there)) + beyond > axis.demand:
        axis.demand = max(axis.demand, abs(share * derivatives(s, _crest(s, x))[2] + resistance))


@part
def _crest(s: Floats, end: float) -> float:
    """Where the second derivative of a series is extreme within a step; its end where it is monotone."""
    low, high, j_low, j_high = 0.0, end, s[3], derivatives(s, end)[3]
    if (j_low > 0.0) == (j_high > 0.0):
        return end
    x = end
    for _ in range(24):
        x = high - j_high * (high - low) / (j_high - j_low)
        j = derivatives(s, x)[3]
        if j == 0.0 or abs(high - low) < 1e-6 * end:
            break
        low, j_low, high, j_high = narrowed(low, j_low, high, j_high, x, j)
    return x


@part
def narrowed(low: float, f_low: float, high: float, f_high: float, x: float, f: float) -> tuple[float, ...]:
    """The last two places, and values there, around a zero after one more: an end that stays counts half (Illinois)."""
    if (f > 0.0) == (f_high > 0.0):
        return low, 0.5 * f_low, x, f
    return high, f_high, x, f
