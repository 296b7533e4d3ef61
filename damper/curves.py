"""Points of a damping curve, from samples of sweeps through the amplitudes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from damper.model import Floats


BINS = 12
"""Points of the curve in an octave of amplitude."""

_WIDTH = math.log(2) / BINS

BINNED = 0.01
"""Relative error that reading a peak off bins may leave."""

_LEAST_STAY = 1.0
"""Cycles that must have been spent in a bin for it to have a point of the curve."""

_CLOSE = 3
"""Bins above the cut-off in which a rolling ball's own amplitudes are points of the curve.

The damping rises there from nothing, by a power of the amplitude: its mean over a bin is more than in its middle.
"""

_SMALL = 1e-15
"""Damping ratio below which a ball takes nothing: rounding of the energies compared gives less than 1e-16."""

TINY = 1e-11
"""Rounding of damping ratios, absolute: a peak below a negative ratio of less is none."""

_ROUNDED = 1e-6
"""Share of the peak up to which a negative ratio is what rounding leaves of a ball's energy next to the structure's."""

_STEP = 1e-6
"""Relative width of the step from one motion to another."""

_NEAR = 2.5
"""Bins between the end of a stretch and the amplitude that ends it, at most, or between ends of one stretch."""

_ALL = slice(None)

_STEEP = 0.25
"""Most that either side counts for, relative: steeper is a fall, of which little lies in the bin of the peak."""

_FOOT = 0.01
"""Bins, at most, between the two ends of a step from one motion to another."""

_PARTED = 0.1
"""Relative difference from which on a point of the way up is another motion's than that of the way down."""


@dataclass(frozen=True, eq=False)
class DampingCurve:
    """The damper's own figures; amplitudes are the structure's displacements along x at the damper.

    Attributes:
        amplitude: A, ascending, shape (n,) [m].
        damping_ratio: -ln(1 - Psi) / (4 pi) at A, Psi being the share of the energy taken in a cycle, shape (n,) [-].
        cutoff: amplitude up to which the ball stays at rest in the middle, a_r / |omega_1^2 - E|, where E u is how the
            load pulls it down the tilting floor: a_r / omega_1^2 on a level one [m]; inf where it fills its cavity.
        peak: largest damping ratio at a prescribed amplitude [-]; 0 where the ball dissipates nothing.
        peak_amplitude: A there [m].
        half: amplitudes between which the damping is at least half its peak [m].
        error: of the peak, relative: by how much halves of the sweeps differ from all of them around it, or both from
            what faster sweeps show there, or the sweeps up from each other and from what others may show, or what the
            width of the bins may take from a narrow peak [-].
        half_error: of `half`, relative: the same, and by how much its ends move with all that [-].
        from_above: the same for falling vibration, in which the ball keeps bouncing; None: these figures are that.
        slow_ramp: the mean of the sweeps up from rest, which may bounce before that is certain; None: as
            `from_above`.
        abrupt_start: the same for an abrupt start at the full amplitude, the ball at rest in the middle, or at a wall
            where it would not stay there, and the structure at a crest, in cycles 13 to 36; None: as `from_above`.
        folds: between which amplitudes the two ways differ most: where a ball stops bouncing on the way down, and up to
            where one that rolls about the middle meets no wall and has not strayed to one, or, where that is too soon,
            from where on all of the sweeps up bounce [m]; nan where they do not differ. The damping ratio rises there.
        jump: where the first and the last of the sweeps up from rest begin to bounce [m]. No force
            returns a rolling ball to the middle of a level floor, so this depends on how the vibration grows.
    """

    amplitude: Floats
    damping_ratio: Floats
    cutoff: float
    peak: float = 0.0
    peak_amplitude: float = math.nan
    half: tuple[float, float] = (math.nan, math.nan)
    error: float = 0.0
    half_error: float = 0.0
    from_above: DampingCurve | None = None
    slow_ramp: DampingCurve | None = None
    abrupt_start: DampingCurve | None = None
    folds: tuple[float, float] = (math.nan, math.nan)
    jump: tuple[float, float] = (math.nan, math.nan)

    def at(self, amplitude: Floats | float) -> Floats:
        """Damping ratio at amplitudes between the points, and beyond them as at the nearest."""
        return np.asarray(np.interp(np.log(amplitude), np.log(self.amplitude), self.damping_ratio))

    @property
    def range(self) -> tuple[float, float]:
        """Amplitudes between which the damper works, with at least half its peak [m]."""
        return self.half

    @property
    def descending(self) -> DampingCurve:
        """The figures of the way down."""
        return self if self.from_above is None else self.from_above


def figures(found: Tally, cutoff: float) -> DampingCurve | None:
    """The curve of sweeps and what is read off it; None where the ball takes nothing."""
    amplitude, ratio = _points(found)
    if not len(ratio) or ratio.max() < _SMALL:
        return None
    return at_peak(DampingCurve(amplitude, ratio, cutoff))


def at_bin(curve: DampingCurve, best: int) -> DampingCurve:
    """The same curve with its peak at one of its points."""
    amplitude, ratio = curve.amplitude, curve.damping_ratio
    half = (_half(amplitude, ratio, best, -1), _half(amplitude, ratio, best, 1)) if ratio[best] > 0 else (math.nan,) * 2
    return replace(curve, peak=float(ratio[best]), peak_amplitude=float(amplitude[best]), half=half)


def at_peak(curve: DampingCurve) -> DampingCurve:
    """The same with its peak where its damping is largest."""
    return at_bin(curve, int(np.argmax(curve.damping_ratio)))


def grown(
    down: Down, up: Floats, rolls: Floats, meets: float, grazes: Floats, held: float = 0.0
) -> tuple[DampingCurve, tuple[int, int] | None]:
    """What every vibration that grows slowly is given at least, and the bins between which that is another motion's.

    Where the sweeps up agree with those down both show one motion, and the many sweeps down give its figures; where
    they differ, the least counts: of the sweeps up, and of a ball that rolls about the middle until it meets the walls.
    A ball that the sweeps down leave at rest, as at a wall against which it is drawn, stays so below their end.

    Args:
        down: what the way down shows.
        up: samples of the sweeps up.
        rolls: samples of a ball that rolls about the middle.
        meets: amplitude from which on it meets the walls; inf where there is none [m].
        grazes: a sample of it there; none where there is none.
        held: amplitude up to which its dent holds the ball, below which no figure is read whose error counts [m].
    """
    above, climbing = down.curve, tally(up, down.curve.cutoff)
    every = [_binned(*_points(climbing, slice(k, k + 1))) for k in range(len(climbing.cycles))]
    climbs = [dict(list(each.items())[:-1]) for each in every]  # without the last bin, which a sweep leaves at once
    rolling, known = _binned(*_points(tally(rolls, above.cutoff))), _binned(above.amplitude, above.damping_ratio)
    begins = min((min(each) for each in (*climbs, rolling) if each), default=min(known))
    known = {k: point for k, point in known.items() if k >= begins}  # hits may take a falling vibration further down
    lowest = _lowest(above, known, climbs, rolling)
    points = [lowest[k] for k in sorted(lowest)]
    if grazes.size:
        points = _with_rise(lowest, above, meets, grazes[0])
    amplitude, ratio = (np.array([getattr(each, name) for each in points]) for name in ("amplitude", "ratio"))
    whole = at_peak(DampingCurve(amplitude, ratio, above.cutoff, from_above=above))
    curve = from_dent(whole, held)
    usual = from_dent(replace(whole, damping_ratio=np.array([max(each.ratio, each.usual) for each in points])), held)
    more = usual.peak / curve.peak - 1 if curve.peak > 0 else 0.0
    spread = points[int(np.argmax(curve.damping_ratio))].spread
    curve = with_error(with_error(curve, *moved(curve, usual)), max(more, spread))
    alone = [place for k, (place, _) in known.items() if k not in rolling]
    curve = _with_error_of_descent(curve, down, [*alone, meets], held)
    parted = {k: each.lacks for k, each in lowest.items() if each.lacks is not None}
    return replace(whole, error=curve.error, half_error=curve.half_error), _largest(parted)


class _Point(NamedTuple):
    """A point of the way up.

    Attributes:
        amplitude: [m].
        ratio: damping ratio, the lowest that is seen there.
        usual: what most of the sweeps up show; 0 where chance has no part.
        spread: by how much the largest of theirs exceeds the lowest, relative.
        lacks: what the damping ratio lacks of that of the way down, a motion of its own; None where both show one.
    """

    amplitude: float
    ratio: float
    usual: float = 0.0
    spread: float = 0.0
    lacks: float | None = None


_Bins = dict[int, tuple[float, float]]
"""Amplitudes and damping ratios by the numbers of their bins."""


def _lowest(above: DampingCurve, known: _Bins, climbs: list[_Bins], rolling: _Bins) -> dict[int, _Point]:
    """The lowest damping in each bin, of the way down where sweeps up agree with it."""
    points = {k: _Point(*point) for k, point in known.items()}
    end, rests = min(known), abs(above.damping_ratio[0]) < _SMALL
    edge = _bins(np.array([above.cutoff]))[0] + 1 if above.cutoff > 0 else end - 1  # bins that a cut-off shares
    for k in sorted(set(rolling).union(*climbs)):
        if k <= edge if k in known else k > end:
            continue
        seen = [curve[k] for curve in (*climbs, rolling) if k in curve]
        ranked = sorted(seen, key=lambda point: point[1])
        (place, least), (_, usual) = ranked[0], ranked[len(ranked) // 2]
        least = 0.0 if rests and k < end else least
        falling = known[k][1] if k in known else None
        if falling is not None and least > (1 - _PARTED) * falling:
            points[k] = _Point(*min(known[k], rolling.get(k, known[k]), key=lambda point: point[1]))
            continue
        if k in rolling:
            usual = 0.0
        elif falling is not None and usual > (1 - _PARTED) * falling:
            usual = falling
        spread = ranked[-1][1] / least - 1 if least > 0 and k not in rolling else 0.0
        points[k] = _Point(place, least, usual, spread, None if falling is None else falling - least)
    return points


def _with_rise(lowest: dict[int, _Point], above: DampingCurve, meets: float, grazes: Floats) -> list[_Point]:
    """All points, with those of the step at which a ball that rolls about the middle meets the walls, if it parts two.

    Args:
        lowest: points by the numbers of their bins.
        above: figures of the way down.
        meets: amplitude at which it does [m].
        grazes: a sample of it there.
    """
    rolled = float(grazes[0] - grazes[1]) / (2 * math.pi)

    def parts(k: int) -> bool:
        return k in lowest and lowest[k].lacks is not None

    last = _bins(np.array([meets]))[0]
    begun = float(above.at(meets))
    if not (parts(last) or (parts(last - 1) and rolled < (1 - _PARTED) * begun)):
        return [lowest[k] for k in sorted(lowest)]
    begun = min(begun, lowest[last + 1].ratio) if parts(last + 1) else begun
    foot = min(rolled, lowest[last].ratio) if parts(last) else rolled
    first = last + 1 if parts(last) else last  # a bin that both motions share shows neither
    spread = lowest[last + 1].spread if last + 1 in lowest else 0.0
    if last in lowest:
        lowest = lowest | {last: lowest[last]._replace(usual=0.0, spread=spread)}
    step = [_Point((1 - _STEP) * meets, foot, spread=spread), _Point(meets, max(begun, foot), spread=spread)]
    below = [lowest[k] for k in sorted(lowest) if lowest[k].amplitude < step[0].amplitude]
    seen = math.exp(0.5 * float(grazes[0] + grazes[1]))  # as a heavy ball loses much in a cycle; it rolls on from there
    below = [each._replace(ratio=min(each.ratio, foot)) if each.amplitude > seen else each for each in below]
    return [*below, *step, *(lowest[k] for k in sorted(lowest) if k >= first and lowest[k].amplitude > meets)]


def _with_error_of_descent(curve: DampingCurve, down: Down, alone: list[float], held: float) -> DampingCurve:
    """A curve of the way up, with the errors of what it has of the way down `alone`, at these amplitudes [m]."""
    shown, best = np.isin(curve.amplitude, alone), int(np.argmax(curve.damping_ratio))
    before = down.before.at(curve.amplitude)
    faster = from_dent(replace(curve, damping_ratio=np.where(shown, before, curve.damping_ratio)), held)
    curve, found = with_error(with_error(curve, BINNED), *moved(faster, curve)), tally(down.samples, curve.cutoff)
    doubt = np.where(shown, np.interp(curve.amplitude, _points(found)[0], 2 * _scatter(found)), 0.0)
    doubt[best] *= -1
    for way in (-1, 1):
        other = at_bin(replace(curve, damping_ratio=(1 + way * doubt) * curve.damping_ratio), best)
        curve = with_error(curve, *moved(other, curve))
    if not shown[best]:
        return curve
    there = int(np.argmin(abs(down.curve.amplitude - curve.peak_amplitude)))
    return with_error(curve, spread(found, at_bin(down.curve, there)))


class Down(NamedTuple):
    """What sweeps down show: figures and those of faster sweeps, and the samples of the former."""

    curve: DampingCurve
    before: DampingCurve
    samples: Floats


class Moved(NamedTuple):
    """Relative differences of two peaks, and of the amplitudes between which half of them is left, the larger."""

    peak: float
    half: float


def moved(before: DampingCurve, after: DampingCurve) -> Moved:
    """By how much the figures of two curves differ: ends by all at most, where both curves have both peaks."""
    if after.peak == 0:
        return Moved(1.0, 1.0)
    ends = float(np.abs(np.array(before.half) / np.array(after.half) - 1).max())
    both = all(one.at(other.peak_amplitude) > one.peak / 2 for one, other in ((before, after), (after, before)))
    return Moved(abs(before.peak / after.peak - 1), min(ends, 1.0) if both else ends)


def with_error(curve: DampingCurve, error: float, of_half: float = 0.0) -> DampingCurve:
    """The same, its errors at least so large; that of `half` is no less than that of the peak."""
    error = max(curve.error, error)
    return replace(curve, error=error, half_error=max(curve.half_error, error, of_half))


def as_read(curve: DampingCurve) -> DampingCurve:
    """The same without rounding of a ball that takes nothing, its error at least what the bins may take from the peak.

    Of a tent whose top lies anywhere in a bin, the mean over that bin lacks a sixth to a half of what the means on
    either side lack of it, and of a smooth peak a sixth: a quarter counts, and of a side no more than `_STEEP`.
    """
    ratio = curve.damping_ratio
    noise = max(_SMALL, -ratio.min(initial=0.0))
    if curve.peak < min(noise, TINY):
        return nothing(curve.cutoff) if noise < TINY else curve
    none = (abs(ratio) < _SMALL) | ((ratio < 0) & (ratio > -_ROUNDED * curve.peak))
    curve = at_peak(replace(curve, damping_ratio=np.where(none, 0.0, ratio)))
    place, best, lacks = np.log(curve.amplitude) / _WIDTH, int(np.argmax(curve.damping_ratio)), 0.0
    for way in (-1, 1):
        if 0 <= best + way < len(place) and abs(place[best + way] - place[best]) > _FOOT:
            beside = float(np.interp(place[best] + way, place, curve.damping_ratio))
            lacks += min(1 - beside / curve.peak, _STEEP)
    return with_error(curve, lacks / 4)


def differs(curve: DampingCurve, found: Tally, amplitude: float) -> bool:
    """Whether sweeps show a motion damped less than a curve's somewhere beyond an amplitude."""
    known, seen = _binned(curve.amplitude, curve.damping_ratio), _binned(*_points(found))
    return any(ratio < (1 - _PARTED) * known[k][1] for k, (a, ratio) in seen.items() if k in known and a > amplitude)


def folded(
    curve: DampingCurve, region: tuple[int, int], down: Floats, up: Floats, meets: float, held: float = 0.0
) -> DampingCurve:
    """The same with its folds; on the way down a ball bounces no further than to where a sweep falls off.

    Not one that falls off far above most of the others: a fold is where the median does.

    Args:
        curve: figures of the way up, with those of the way down.
        region: first and last of the bins in which they differ.
        down: samples of slow sweeps down through these.
        up: samples of the sweeps up from rest.
        meets: amplitude from which on a ball that rolls about the middle meets the walls; inf where there is none [m].
        held: see :func:`grown`.
    """
    above = curve.descending
    leaves, joins = (
        [_turn(curve, each[each[:, 2] == number], region) for number in np.unique(each[:, 2])] for each in (down, up)
    )
    place = np.log(above.amplitude)
    stops = float(np.median(leaves))
    first = max(each for each in leaves if each <= stops * 2 ** (_NEAR / BINS))
    fallen = (place >= region[0] * _WIDTH) & (above.amplitude < first)
    ratio = np.where(fallen, np.minimum(above.damping_ratio, curve.at(above.amplitude)), above.damping_ratio)
    above = at_peak(replace(above, damping_ratio=ratio))
    last = meets if abs(math.log(meets) / _WIDTH - region[1]) < _NEAR else max(joins)
    curve = curve if last == meets else with_error(curve, *_chance(curve, region, joins, held))
    return replace(curve, from_above=above, folds=(min(stops, last), last), jump=(min(joins), max(joins)))


def _chance(curve: DampingCurve, region: tuple[int, int], joins: list[float], held: float) -> Moved:
    """By how much the figures change if the last of the sweeps up begins to bounce later, as that of others may.

    Escapes at a rate are spread exponentially from the first on, with the scale s that is their mean. Of six others the
    last comes no later than 1.3 s after the last of these, three times in four; it counts by whole bins.

    Args:
        curve: figures of the way up.
        region: first and last of the bins in which they differ from those of the way down.
        joins: where the sweeps up begin to bounce [m].
        held: see :func:`grown`.
    """
    place = np.log(joins)
    later = place.max() + 1.3 * (place - place.min()).sum() / max(len(place) - 1, 1)
    numbers, amplitude, ratio = np.array(_bins(curve.amplitude)), curve.amplitude, curve.damping_ratio.copy()
    inside = np.flatnonzero((numbers >= region[0]) & (numbers * _WIDTH < later))
    if not inside.size:
        return Moved(0.0, 0.0)
    before = inside[np.log(amplitude[inside]) < place.min() - _WIDTH]
    last = before[-1] if before.size else inside[0]  # where all roll
    after = inside[inside > last]
    ratio[after] = np.minimum(ratio[after], ratio[last] * amplitude[last] / amplitude[after])  # goes on rolling
    return moved(from_dent(curve, held), from_dent(replace(curve, damping_ratio=ratio), held))


def resolved(curve: DampingCurve, rolls: Floats) -> DampingCurve:
    """The same with the amplitudes of a ball that rolls about the middle next to the cut-off, where it shows that.

    Args:
        curve: figures of either way.
        rolls: samples of that ball.
    """
    last = curve.cutoff * 2 ** (_CLOSE / BINS)
    below = rolls[rolls[:, :2].sum(axis=1) < 2 * math.log(last)] if last > 0 else rolls[:0]
    if not below.size:
        return curve
    _, number, cycles = np.unique(below[:, 2], return_inverse=True, return_counts=True)
    before, after = (np.bincount(number, below[:, k]) / cycles for k in (0, 1))
    place, ratio = np.exp(0.5 * (before + after)), (before - after) / (2 * math.pi)
    rises = np.diff(np.maximum.accumulate(place), prepend=0.0) > 0  # a heavy ball's loss may outgrow its amplitude
    place, ratio = place[rises], ratio[rises]
    shown = curve.at(place[-1])
    if curve.amplitude[0] > last or abs(ratio[-1] - shown) > _PARTED * shown:
        return curve
    return continued(replace(curve, amplitude=place, damping_ratio=ratio), curve)


def continued(curve: DampingCurve, other: DampingCurve) -> DampingCurve:
    """The same with what another shows beyond its last amplitude."""
    beyond = other.amplitude > curve.amplitude[-1]
    amplitude = np.concatenate([curve.amplitude, other.amplitude[beyond]])
    ratio = np.concatenate([curve.damping_ratio, other.damping_ratio[beyond]])
    return at_peak(replace(curve, amplitude=amplitude, damping_ratio=ratio))


def from_amplitude(curve: DampingCurve, least: float) -> DampingCurve:
    """The same from an amplitude [m] on; all of it where no point lies there."""
    counts = curve.amplitude >= least
    if counts.all() or not counts.any():
        return curve
    return at_peak(replace(curve, amplitude=curve.amplitude[counts], damping_ratio=curve.damping_ratio[counts]))


def from_dent(curve: DampingCurve, amplitude: float) -> DampingCurve:
    """The same of a ball that takes nothing up to an amplitude [m], if it takes something beyond."""
    ratio = np.where(curve.amplitude < amplitude, 0.0, curve.damping_ratio)
    return at_peak(replace(curve, damping_ratio=ratio)) if ratio.any() else at_peak(curve)


def held_until(curve: DampingCurve, amplitude: float) -> DampingCurve:
    """The same of a ball that lies in its dent up to an amplitude; out of it, it is as one that was never in it."""
    curve = _with_step(curve, amplitude)
    ratio = np.where(curve.amplitude < amplitude, 0.0, curve.damping_ratio)
    starts: dict[str, Any] = {
        name: held_until(each, amplitude)
        for name in ("slow_ramp", "abrupt_start")
        if (each := getattr(curve, name)) is not None
    }
    if not ratio.any():
        return replace(nothing(amplitude), from_above=curve.descending, **starts)
    first, last = (max(each, amplitude) for each in curve.jump)
    starts |= {"folds": (curve.folds[0], max(curve.folds[1], amplitude)), "jump": (first, last)}
    sustained = at_peak(replace(curve, damping_ratio=ratio, cutoff=amplitude, **starts))
    return replace(sustained, half=(max(sustained.half[0], amplitude), sustained.half[1]))


def _with_step(curve: DampingCurve, amplitude: float) -> DampingCurve:
    """The same with a point at an amplitude [m], and one just below it, where it may step."""
    if not curve.amplitude.size or not curve.amplitude[0] < amplitude < curve.amplitude[-1]:
        return curve
    step = np.array([(1 - _STEP) * amplitude, amplitude])
    places = np.unique([*curve.amplitude, *step])
    return replace(curve, amplitude=places, damping_ratio=curve.at(places))


def _bins(amplitude: Floats) -> list[int]:
    """Numbers of the bins in which amplitudes lie."""
    return [math.floor(place) for place in np.log(amplitude) / _WIDTH]


def _binned(amplitude: Floats, ratio: Floats) -> _Bins:
    """Points of a curve by the numbers of their bins."""
    return dict(zip(_bins(amplitude), zip(amplitude.tolist(), ratio.tolist(), strict=True), strict=True))


def _largest(parted: dict[int, float]) -> tuple[int, int] | None:
    """Ends of the run of bins, one may be missing, over which two curves differ most in all; None: nowhere."""
    runs: list[list[int]] = []
    for k in sorted(parted):
        if runs and k - runs[-1][-1] <= 2:
            runs[-1].append(k)
        else:
            runs.append([k])
    most = max(runs, key=lambda run: sum(parted[k] for k in run), default=None)
    return None if most is None else (most[0], most[-1])


def _turn(curve: DampingCurve, samples: Floats, region: tuple[int, int]) -> float:
    """Amplitude at which a sweep changes from the lower of two motions to the upper, in or beside a region [m].

    That splits it best: below it more cycles lose less than midway between the two, above it more lose more. The upper
    one goes on below where some of the sweeps down have left it.
    """
    place = 0.5 * (samples[:, 0] + samples[:, 1])
    inside = (place >= (region[0] - 1) * _WIDTH) & (place < (region[1] + 2) * _WIDTH)
    order = np.argsort(place[inside])
    place, lost = place[inside][order], (samples[inside, 0] - samples[inside, 1])[order] / (2 * math.pi)
    if not place.size:
        return math.exp((region[1] + 1) * _WIDTH)
    upper, lower = (np.interp(place, np.log(each.amplitude), each.damping_ratio) for each in (curve.descending, curve))
    upper = np.maximum.accumulate(upper[::-1])[::-1]
    rise = np.concatenate([[0.0], np.cumsum(2 * lost / (upper + lower) - 1)])
    return float(math.exp(place[min(int(np.argmin(rise)), len(place) - 1)]))


class Tally(NamedTuple):
    """What sweeps spent and lost in bins of amplitude.

    Attributes:
        cycles: spent in each bin by each sweep, shape (sweeps, bins).
        lost: sums of their damping ratios, the same.
        place: and of where they were, in bins, the same.
    """

    cycles: Floats
    lost: Floats
    place: Floats


def tally(samples: Floats, cutoff: float) -> Tally:
    """Add up samples by sweeps and bins.

    A cycle that crosses bins counts in each by its share, over an octave from where it began at most: a heavy ball may
    take, and give back, nearly all energy in a cycle. It does not count below the cut-off, where the load holds the
    ball, nor below the amplitudes that sweeps were led to.
    """
    numbers, sweep = np.unique(samples[:, 2], return_inverse=True)
    before, after = samples[:, 0], samples[:, 1]
    if cutoff > 0:
        moving = before > math.log(cutoff) + 1e-12
        before, after, sweep = before[moving], after[moving], sweep[moving]
    if not before.size:
        none = np.zeros((len(numbers), 0))
        return Tally(none, none, none)
    ratio = (before - after) / (2 * math.pi)
    end = np.clip(after, np.maximum(before - math.log(2), before.min()), before + math.log(2))
    low, high = np.minimum(before, end) / _WIDTH, np.maximum(before, end) / _WIDTH
    first = np.floor(low).astype(int)
    crossed = np.floor(high).astype(int) - first + 1  # bins that each cycle is in
    cycle = np.repeat(np.arange(len(low)), crossed)
    at = np.arange(len(cycle)) + np.repeat(first - np.cumsum(crossed) + crossed, crossed)
    low, high, ratio = low[cycle], high[cycle], ratio[cycle]
    begin, end = np.maximum(low, at), np.minimum(high, at + 1)
    share = np.ones(len(cycle))
    np.divide(end - begin, high - low, out=share, where=high > low)
    origin, bins = int(first.min()), int(at.max() - first.min()) + 1
    which, size = sweep[cycle] * bins + at - origin, len(numbers) * bins
    weights = share, share * ratio, share * 0.5 * (begin + end)
    return Tally(*(np.bincount(which, each, size).reshape(-1, bins).astype(float) for each in weights))


def _points(found: Tally, sweeps: slice | npt.NDArray[Any] = _ALL) -> tuple[Floats, Floats]:
    """Amplitude [m] and mean damping ratio in bins, shape (n,): what sweeps lost in one over their cycles in it."""
    cycles, lost, place = (each[sweeps].sum(axis=0) for each in found[:3])
    met = cycles > _LEAST_STAY
    return np.exp(place[met] / cycles[met] * _WIDTH), lost[met] / cycles[met]


def _scatter(found: Tally) -> Floats:
    """Standard errors of the mean damping ratios in bins, relative, shape (n,): of a ratio of sums over sweeps."""
    met = found.cycles.sum(axis=0) > _LEAST_STAY
    cycles, lost, count = found.cycles[:, met], found.lost[:, met], len(found.cycles)
    mean = lost.sum(axis=0) / cycles.sum(axis=0)
    off = np.linalg.norm(lost - mean * cycles, axis=0) * math.sqrt(count / max(count - 1, 1)) / cycles.sum(axis=0)
    return np.asarray(np.divide(off, abs(mean), out=np.zeros_like(off), where=abs(mean) > _SMALL))


def _half(amplitude: Floats, ratio: Floats, best: int, step: int) -> float:
    """Amplitude at which the curve has fallen to half its peak on one side; the last one where it does not."""
    at = best
    while 0 <= at + step < len(ratio) and ratio[at + step] > ratio[best] / 2:
        at += step
    if not 0 <= at + step < len(ratio):
        return float(amplitude[at])
    share = (ratio[at] - ratio[best] / 2) / (ratio[at] - ratio[at + step])
    return float(amplitude[at] * (amplitude[at + step] / amplitude[at]) ** share)


def spread(found: Tally, whole: DampingCurve) -> float:
    """Largest relative deviation of the damping around the peak in a half of the sweeps.

    Around the peak means within two bins on either side of it. 1 where fewer than two halves see it.
    """

    def around(amplitude: Floats, ratio: Floats) -> Floats:
        near = np.abs(np.log2(amplitude / whole.peak_amplitude)) < 2.5 / BINS
        return np.asarray(ratio[near])

    count = len(found.cycles)
    number = np.arange(count)
    halves = [sides == side for sides in (number % 2, number // (count // 2)) for side in (0, 1)]
    seen = [part.mean() for half in halves if (part := around(*_points(found, half))).size]
    mean = around(whole.amplitude, whole.damping_ratio).mean()
    return max(float(abs(one / mean - 1)) for one in seen) if len(seen) > 1 else 1.0


def nothing(cutoff: float) -> DampingCurve:
    """Of a ball that takes nothing."""
    return DampingCurve(np.zeros(0), np.zeros(0), cutoff)
