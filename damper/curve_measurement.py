"""The damping curve of a damper: equivalent damping ratio against amplitude.

A ring-down tells of one release and of the structure's own damping. What belongs to the damper is how much of the
energy the ball takes in a cycle while the structure, without damping of its own, vibrates along x with an amplitude A
that is held, whatever the ball takes. It is measured on sweeps that come down through all amplitudes, from several
starts, slower where that changes them, and on sweeps up from a ball at rest, in the middle or at a wall that it is
pulled against, or rolling about the middle, of which the least counts; what the pace still changes is in the error.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from damper import laws, self_check
from damper.batch import in_blocks, workers
from damper.curves import (
    BINNED,
    BINS,
    DampingCurve,
    Down,
    as_read,
    continued,
    differs,
    figures,
    folded,
    from_amplitude,
    grown,
    held_until,
    moved,
    nothing,
    resolved,
    spread,
    tally,
    with_error,
)
from damper.equations import structures_by
from damper.model import Mode, rim_threshold, whole
from damper.motion import flights, prepare
from damper.state import Tables

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy.typing as npt

    from damper.model import Floats, Integers, ParticleDamper

SWEEPS, STAY = 16, 120
"""Sweeps through the amplitudes, and cycles that each of them takes for an octave at least."""

_SLOWER = 4
"""By how much sweeps become slower, once and half as many, where the pace moves the peak."""

_FIRST = 4
"""Sweeps down, at most, that are as much faster: they show how high to begin, and whether the pace counts."""

_SHARES = 4, 2, 1
"""One of how many sweeps down goes, until there are enough."""

_SAME = 0.03
"""Relative difference of peaks, and of where half of them is left, up to which the pace does not move them."""

_CLIMBS, _PACES = 3, (0.4, 0.6)
"""Sweeps up through the amplitudes at each of two paces, and the shares of all cycles of sweeps down for each."""

_SLOW, _SLOWEST = 5, 1 / 3
"""Sweeps down again, through the amplitudes at which there are two motions, and the share of all cycles for each."""

_APART = (math.sqrt(5) - 1) / 2
"""Cycles by which sweeps up begin apart, no two by a whole number: where a rolling ball meets a wall goes by that."""

_HELD = 24
"""Cycles for which amplitudes that are there at once are held, once the ball has found its motion."""

_SETTLED, _CHANCE = 500, 1e-3
"""Cycles until chaotic motion has settled, and of as many its damping; what parts starts that are alike, relative."""

_AROUND = 0.97, 1.5
"""Ends of the sweeps up of balls that roll about the middle, over the amplitude at which these must meet the walls.

All sweeps up end there unless a ball at rest, in an abrupt start, is damped less beyond than on the way down.
"""

_FINE, _ROLLED = 4 * BINS, (3, 2)
"""Amplitudes in an octave at which a rolling ball is followed, and cycles until it has settled and for its losses.

It goes on as it begins from the second cycle on, to 2e-4 of its loss.
"""

_GROWTH, _ASTRAY = 1e-3, 0.01
"""Growth of the amplitude in a cycle, relative, and distance from the middle, over half the clearance, that it begins
with, of a vibration under which a ball that rolls about the middle must not stray to a wall."""

_SHALLOW, _FAST = 0.05, 30.0
"""Largest square of the frequency of a ball in its bowl, over that of the structure, at which it rolls as on a level
floor; most growth of its distance from the middle that is told between two amplitudes, as a logarithm."""

_ASIDE = 3
"""Bins on either side of two motions that slow sweeps go through."""

_ROUNDS = 16
"""Steps along either axis towards the place of least potential: these converge, but for a saddle."""

SETTLING = 12
"""Cycles that the ball is given to find its motion at the start of a sweep."""

_EVENTS = 2000
"""Most events that a cycle may have on average; a sweep with more is left out from there on."""

_OCTAVES, _MOST_OCTAVES = 2, 24
"""By which sweeps begin higher until the damping falls to half its peak, and the most that they may go through."""

_LOWEST = 1e-3
"""Least amplitude over half the clearance that is looked at where nothing holds the ball."""

_EARLY = 0.25
"""Amplitude over half the clearance from which on damping always counts."""

_CLEAR = 10
"""Least amplitude on the way up over the static deflection by a ball that rests off the middle of a tilting floor."""

_BEYOND = 4
"""Over the amplitude at which a ball leaves its dent, above which it has most of its damping: sweeps go up to there."""

_BALANCED = 1e-3
"""Share of its drive that a ball must be left with for its figures to have a meaning."""


class _Pace(NamedTuple):
    """Sweeps, and the cycles of each for an octave."""

    sweeps: int
    stay: int


def damping_curve(
    damper: ParticleDamper,
    *,
    threads: int | None = None,
    sweeps: int = SWEEPS,
    stay: int = STAY,
    least: float = 0.0,
    reach: float = 0.0,
) -> DampingCurve:
    """Measure the damper on sweeps through the amplitudes along x, the own damping of that mode set aside.

    A ball may have two steady motions at an amplitude: it keeps bouncing where the vibration comes down, and rolls to
    and fro without a hit where it grows. Sweeps go down and up, and the figures are those of the way up, from a ball at
    rest (`resting_places`); `DampingCurve.from_above` has the others.

    Args:
        damper: what is measured; the damping ratio of the mode that yields most along x has no influence.
        threads: see :func:`damper.ringdowns`.
        sweeps: down through the amplitudes, from as many starts; a half or a quarter of them where that is enough, by
            what halves of them show. Abrupt starts are at as many amplitudes an octave, up to 12.
        stay: cycles that a sweep down takes for an octave, and four times as many in half as many sweeps where the pace
            moves the peak, as it does where hits take next to nothing from the ball. 4 sweeps of 60 take half of the
            time, and move the peak by less than 1 % where the ball has one motion at an amplitude. Sweeps up take as
            many cycles in all.
        least: amplitude from which on damping counts, at most an eighth of the clearance: where the ball moves at
            smaller ones, the curve begins there [m].
        reach: amplitude up to which the curve goes at least [m].
    """
    bare, cycles = undamped(damper), sweeps * stay  # of all sweeps for an octave
    places = resting_places(bare)
    held = _held_by_dent(damper, places[-1])
    reach = max([reach, *(_BEYOND * each for each in held if each < math.inf)])
    least = min(least, _EARLY * bare.half_gap[0] / max(abs(1 - bare.tilt_share[0]), _BALANCED))
    descent, low, high = _down(bare, _Pace(sweeps, stay), (least, reach), threads)
    above = descent.curve
    if above.peak == 0:
        return above
    deflection = bare.ball_mass * max(abs(float(bare.pull[0] @ place)) for place in places) / bare.stiffness[0]
    low = min(max(low, _CLEAR * deflection), 0.5 * high)
    rolls, ends, grazes, meets = ball = rolling(bare, low, threads)
    begun = samples_at(bare, low, high, min(sweeps, BINS), threads, places[0])
    last = _AROUND[1] * meets
    abrupt = tally(begun, above.cutoff)
    last = high if last > high or differs(above, abrupt, last) else last
    paces = [max(round(part * cycles / _CLIMBS), 1) for part in _PACES]
    climbs = [Climb(low, last, pace, place) for place in places for pace in paces]
    resting = len(climbs)
    if ball.is_centred:
        climbs += [Climb(_AROUND[0] * meets, _AROUND[1] * meets, pace, rolls=True) for pace in paces]
    up = samples_up(bare, climbs, threads)
    ramps = up[up[:, 2] < _CLIMBS * resting]
    samples = np.vstack([descent.samples, up, rolls, grazes, begun])
    dented = max(held, default=0.0)
    growing, region = grown(descent, up, rolls, ends, grazes, dented)
    if region is not None:
        first, last = (2 ** (k / BINS) for k in (region[0] - _ASIDE, region[1] + _ASIDE))
        down = samples_of(bare, first, last, _SLOW, max(round(_SLOWEST * cycles), 1), threads)
        if down.size and ramps.size:  # a ball may have more events than a sweep goes on for
            growing = folded(growing, region, down, ramps, ends, dented)
        samples = np.vstack([samples, down])
    ways = {"slow_ramp": tally(ramps, above.cutoff), "abrupt_start": abrupt}
    others: dict[str, Any] = {
        name: continued(figures(each, above.cutoff) or growing, growing) for name, each in ways.items()
    }
    others["from_above"] = growing.descending
    others = {name: as_read(from_amplitude(resolved(each, rolls), least)) for name, each in others.items()}
    growing = replace(as_read(from_amplitude(resolved(growing, rolls), least)), **others)
    for curve in (growing, *others.values()):
        if curve.amplitude.size:
            laws.check_curve(bare, curve)
            laws.check_readings(curve, samples)
    for each in held:
        growing = replace(held_until(growing, each), cutoff=held[0])
    return growing


def _held_by_dent(damper: ParticleDamper, place: tuple[float, float]) -> list[float]:
    """Amplitudes up to which its dent holds a ball [m]: where it lies at first, and where the load pulls it to."""
    if damper.break_away == 0:
        return []
    drives = [damper.break_away_threshold]
    if any(place):
        rim = float(rim_threshold(damper.parameters)[0])
        drives.append(rim + float(_outward(damper, np.array(place)).min()))
    return [damper.amplitude_of(drive) for drive in drives]


def falling(
    damper: ParticleDamper, *, threads: int | None = None, sweeps: int = SWEEPS, stay: int = STAY
) -> DampingCurve:
    """The figures of the sweeps down alone; see :func:`damping_curve` for the arguments."""
    return as_read(_down(undamped(damper), _Pace(sweeps, stay), (0.0, 0.0), threads)[0].curve)


def _down(
    bare: ParticleDamper, pace: _Pace, ends: tuple[float, float], threads: int | None
) -> tuple[Down, float, float]:
    """What sweeps down show, and between which amplitudes a vibration grows.

    `ends`: `least` and `reach` of :func:`damping_curve` [m].
    """
    if whole("sweeps", pace.sweeps) < 2:
        raise ValueError(f"sweeps must be at least 2, got {pace.sweeps}")
    whole("stay", pace.stay)
    left = abs(1 - bare.tilt_share[0])
    gap = bare.half_gap[0]
    if left < _BALANCED or gap == 0:
        return _no_descent(math.inf)
    cutoff = bare.amplitude_of(bare.leaving_threshold)
    laws.check_rest_amplitude(bare, cutoff)
    if cutoff == 0 and _loses_nothing(bare):
        return _no_descent(cutoff)
    least, reach = ends
    lowest, top = max(cutoff, least, _freely(bare) * gap / left), max(reach, 8 * max(cutoff, gap / left))
    go_down = partial(samples_of, bare, lowest, threads=threads)
    fast = _Pace(min(pace.sweeps, _FIRST), max(pace.stay // _SLOWER, 1))
    before, top = _falling(go_down, cutoff, top, lowest * 2**_MOST_OCTAVES, fast)
    if before.peak == 0:
        return _no_descent(cutoff)
    curve, samples = _settled(go_down, cutoff, top, pace, before)
    if max(moved(before, curve)) > _SAME:
        slower = _Pace(max(pace.sweeps // 2, 2), _SLOWER * pace.stay)
        before, (curve, samples) = curve, _settled(go_down, cutoff, top, slower, curve)
    above = with_error(curve, *moved(before, curve))
    if above.peak > 0:
        laws.check_curve(bare, above)
        laws.check_readings(above, samples)
    return Down(above, before, samples), max(cutoff, least, _LOWEST * gap / left), top


def _loses_nothing(bare: ParticleDamper) -> bool:
    """Whether a ball that rolls freely loses nothing: in hits, by slip, along walls, to modes that are damped."""
    structures = structures_by(bare, bare.parameters)
    slips = bare.floor_friction is not None and bare.centrifugal_acceleration > 0
    rubs = bare.friction > 0 and bool(structures.coupled[0])
    return bare.loses_nothing_in_hits and not (slips or rubs or structures.dashpot.any())


def _no_descent(cutoff: float) -> tuple[Down, float, float]:
    return Down(nothing(cutoff), nothing(cutoff), np.zeros((0, 3))), 0.0, 0.0


_GoDown: TypeAlias = "Callable[..., Floats]"
"""`samples_of` a damper down to an amplitude: from another, at a pace."""


def _falling(go_down: _GoDown, cutoff: float, top: float, highest: float, pace: _Pace) -> tuple[DampingCurve, float]:
    """Figures up to where the damping has fallen to half its peak, and the amplitude that this takes."""
    while True:
        curve = _read(cutoff, go_down(top, *pace))
        if curve.peak == 0 or curve.damping_ratio[-1] < curve.peak / 2 or top > highest:
            return curve, top
        top *= 2**_OCTAVES


def _settled(
    go_down: _GoDown, cutoff: float, top: float, pace: _Pace, before: DampingCurve
) -> tuple[DampingCurve, Floats]:
    """Figures of sweeps down at a pace, and their samples: of as many sweeps as bring their error down.

    No more go once halves of them differ by no more than reading a peak does, or by half of what the pace changes, up
    to `_SAME`.
    """
    samples, done = np.zeros((0, 3)), np.zeros(0, int)
    for share in (share for share in _SHARES if 2 * share <= pace.sweeps):
        spaced = np.linspace(0, pace.sweeps - 1, pace.sweeps // share).round().astype(int)
        wanted = np.setdiff1d(spaced, done)
        samples = np.vstack([samples, go_down(top, *pace, numbers=wanted)])
        done = np.append(done, wanted)
        curve = _read(cutoff, samples)
        if curve.error <= max(BINNED, min(max(moved(before, curve)), _SAME) / 2):
            break
    return curve, samples


def _read(cutoff: float, samples: Floats) -> DampingCurve:
    """Figures of sweeps down."""
    self_check.once("curves", falling)
    found = tally(samples, cutoff)
    whole = figures(found, cutoff)
    return nothing(cutoff) if whole is None else with_error(whole, max(spread(found, whole), BINNED))


def undamped(damper: ParticleDamper) -> ParticleDamper:
    """The damper on a structure that is not damped in the mode that yields most along x, the ball out of its dent.

    Other modes that its motion feeds keep the damping of their own, or a little: they would shake the ball for ever.
    """
    modes = damper.modes
    aside = damper.lateral_pull[1] != 0 or damper.restoring[0, 1] != 0  # ball and structure move along y too
    if modes is None and aside and damper.formulation != "printed":
        mass, (along, across), (tilt, tilt_across) = damper.modal_mass, damper.stiffness, damper.floor_tilt
        modes = Mode(mass, along, (1.0, 0.0), (tilt, 0.0)), Mode(mass, across, (0.0, 1.0), (0.0, tilt_across))
        damper = replace(damper, modes=modes, floor_tilt=(0.0, 0.0))
    if modes is not None:
        own = (damper.damping_ratio if mode.damping_ratio is None else mode.damping_ratio for mode in modes)
        kept = [max(each, _OTHERS) for each in own]
        kept[damper.leading(0)] = 0.0
        modes = tuple(replace(mode, damping_ratio=each) for mode, each in zip(modes, kept, strict=True))
    return replace(damper, damping_ratio=0.0, modes=modes, break_away=0.0)


_OTHERS = 1e-3
"""Least damping ratio of modes that are not measured: what air gives blades at least."""


def _freely(damper: ParticleDamper) -> float:
    """Half the amplitude, over half the clearance, down to which a ball that nothing holds keeps bouncing.

    Two symmetric hits a cycle exist from rho / sqrt(1 + rho^2) on, rho = (2/pi) (1 - e)/(1 + e), for a free ball
    (Weidemann, Bergman, Vakakis and Krack 2025, doi 10.1007/s11071-025-10928-4); a rolling one feels beta times that.
    """
    e = damper.largest_restitution
    rho = 2 / math.pi * (1 - e) / (1 + e)
    return max(0.5 * rho / math.hypot(1, rho) / damper.inertia_ratio, _LOWEST)


def samples_of(
    damper: ParticleDamper,
    low: float,
    high: float,
    sweeps: int,
    stay: int,
    threads: int | None,
    numbers: Integers | None = None,
) -> Floats:
    """Samples on sweeps from high to low, a row for each cycle of each sweep.

    From cycle to cycle the structure is led to a little less motion, the ball keeps its own in its cavity. Columns: the
    logarithms of the amplitude before a cycle and of what its losses would leave of that, and the sweep's number.
    `numbers`: of the sweeps that are wanted; None: all.
    """
    each = np.arange(sweeps) if numbers is None else numbers
    start = high * 2 ** ((each + 1) / sweeps)  # at least one octave's share above, to settle on the way
    cycles = SETTLING + math.ceil(stay * (math.log2(high / low) + 1))
    down = Sweeps(start, cycles, 4 ** (-1 / stay), damper.half_gap[0] * (1 - each / sweeps))
    rows = _rows(damper, _ramped(damper, down, threads, low)[:, SETTLING:])
    rows[:, 2] = each[rows[:, 2].astype(int)]
    return rows


class Climb(NamedTuple):
    """A way up: its ends [m], the cycles for an octave, where balls begin at rest [m], or that they roll evenly."""

    low: float
    high: float
    stay: int
    place: tuple[float, float] = (0.0, 0.0)
    rolls: bool = False


def samples_up(damper: ParticleDamper, climbs: Sequence[Climb], threads: int | None, sweeps: int = _CLIMBS) -> Floats:
    """The same on sweeps up, so many for each climb, numbered on."""
    every, ahead = [], _APART * np.arange(sweeps)
    for low, high, stay, rests, rolls in climbs:
        start = low * 2 ** (-(SETTLING + ahead) / stay)
        place, velocity = swinging(damper, start) if rolls else (rests[0], 0.0)
        cycles = SETTLING + math.ceil(stay * math.log2(high / low) + _APART * sweeps)
        every.append(np.broadcast_arrays(*Sweeps(start, cycles, 4 ** (1 / stay), place, velocity, rests[1])))
    way_up = Sweeps(*map(np.concatenate, zip(*every, strict=True)))
    return _rows(damper, _ramped(damper, way_up, threads)[:, SETTLING:])


def samples_at(
    damper: ParticleDamper, low: float, high: float, count: int, threads: int | None, place: tuple[float, float]
) -> Floats:
    """The same at so many amplitudes an octave that are there at once and held, the ball at rest at a place [m]."""
    amplitude = np.geomspace(low, high, max(math.ceil(count * math.log2(high / low)), 2))
    sweeps = Sweeps(amplitude, SETTLING + _HELD, 1.0, place[0], 0.0, place[1])
    return _rows(damper, _ramped(damper, sweeps, threads)[:, SETTLING:])


def resting_places(damper: ParticleDamper) -> list[tuple[float, float]]:
    """Where a ball may lie at rest before a vibration grows [m]: in the middle, or where the load pulls it to.

    The latter is the place of least potential, at a wall or, in a bowl, on the way there. It counts where the load
    pulls the ball against the wall by more than the rolling threshold, or away from the middle. A ball that this draws
    out of the middle, as soon as a vibration moves it there, does not begin in it: what it gains on its way is lost
    once, and not taken from the structure.
    """
    middle, pull, curve, threshold = (0.0, 0.0), np.abs(damper.lateral_pull), damper.restoring, damper.rolling_threshold
    place = _lowest(damper)
    outward = _outward(damper, place)
    leaves, sideways = outward[0] > threshold or pull[0] > threshold, abs(curve[0, 1])
    if not leaves and (sideways == 0 or outward[1] <= threshold):
        return [middle]
    rests = (float(place[0]), float(place[1]))
    return [rests] if leaves or pull[1] + sideways * damper.half_gap[0] > threshold else [middle, rests]


def _lowest(damper: ParticleDamper) -> Floats:
    """Place of least potential in the cavity, shape (2,) [m]."""
    (x, y), pull, curve = damper.half_gap, np.array(damper.lateral_pull), damper.restoring
    places = np.array([(x, y), (x, -y), (-x, y), (-x, -y)])
    for i in (0, 1) * _ROUNDS:  # in a bowl, up to where it rises as steeply
        push = pull[i] - curve[i, 1 - i] * places[:, 1 - i]
        if curve[i, i] > 0:
            places[:, i] = np.clip(push / curve[i, i], -damper.half_gap[i], damper.half_gap[i])
    energy = 0.5 * np.einsum("ni,ij,nj->n", places, curve, places) - places @ pull
    return np.asarray(places[int(np.argmin(energy))])


def _outward(damper: ParticleDamper, place: Floats) -> Floats:
    """How the load pulls a ball away from the middle along x and y, shape (2,) [m/s^2]."""
    return np.asarray(np.sign(place) * (damper.lateral_pull - damper.restoring @ place))


def settled(damper: ParticleDamper, amplitude: float) -> float:
    """Damping ratio at an amplitude [m] that is held, from where motion from rest in the middle has settled."""
    starts = np.linspace(amplitude, (1 + _CHANCE) * amplitude, SWEEPS)
    energy = _ramped(undamped(damper), Sweeps(starts, 2 * _SETTLED), 1)[:, _SETTLED:]
    return float(-np.nanmean(np.log(energy[..., 1] / energy[..., 0]))) / (4 * math.pi)


class Rolling(NamedTuple):
    """A ball that rolls to and fro about the middle; `Rolling()`: there is none.

    Attributes:
        samples: as `samples_of` has them, at amplitudes at which it goes on rolling.
        ends: amplitude from which on it does not, since it meets the walls or has strayed to one; inf where the load
            pulls it away before it rolls, or holds it in a bowl [m].
        there: a sample at that amplitude.
        meets: amplitude from which on it meets the walls if it does not stray; inf as before [m].
    """

    samples: Floats = np.zeros((0, 3))
    ends: float = math.inf
    there: Floats = np.zeros((0, 3))
    meets: float = math.inf

    @property
    def is_centred(self) -> bool:
        """Whether it goes on about the middle until it meets the walls, or nearly so."""
        return math.isfinite(self.ends) and self.ends > _AROUND[0] * self.meets

    @property
    def last(self) -> float:
        """Amplitude up to which it goes on rolling, 0 where there is none [m]."""
        return self.ends if math.isfinite(self.ends) else 0.0


def rolling(damper: ParticleDamper, low: float, threads: int | None) -> Rolling:
    """Follow a ball that rolls to and fro about the middle as the amplitude grows, until the load has drawn it away.

    Args:
        damper: without damping of its own.
        low: amplitude from which on it rolls [m].
        threads: see :func:`damper.ringdowns`.
    """
    gap, share, curve = damper.half_gap[0], abs(1 - damper.tilt_share[0]), damper.restoring
    free = gap / (damper.inertia_ratio * share)
    high = free + 2 * damper.rolling_threshold / damper.stuck_frequency**2 / share
    amplitude = np.geomspace(low * (1 + 1e-9), high, max(math.ceil(_FINE * math.log2(high / low)), 2))
    alone, strays, held = damper.lateral_pull[0] == 0 and curve[0, 0] == 0, np.zeros(len(amplitude)), True
    if not alone:
        held = bool(_held_aside(damper, amplitude).all())
        if low < high and damper.inertia_ratio * curve[0, 0] <= _SHALLOW * damper.stuck_frequency**2:
            strays = _strays(damper, amplitude)
        else:
            strays += math.inf
        lasts = strays < 1
        if lasts.sum() < 2:
            return Rolling()
        amplitude, strays = amplitude[lasts], strays[lasts]
    wide = in_wide_cavity(damper, high)

    ball = swinging(wide, amplitude)
    settling, counted = _ROLLED
    energy = _ramped(wide, Sweeps(amplitude, settling + counted, 1.0, *ball), threads, alike=damper)[:, settling:]
    if damper.rolling_threshold > 0 and held:  # over half the clearance, by what it loses
        swing = energy[..., 3].mean(axis=1) / (4 * damper.ball_mass * damper.rolling_threshold * gap)
    else:
        swing = np.sqrt(np.maximum(amplitude**2 - _lag(damper) ** 2, 0.0)) / free
    ends = float(np.exp(np.interp(1.0, swing + strays, np.log(amplitude))))
    meets = ends if alone else math.hypot(free, _lag(damper))
    rows = _rows(damper, energy)
    which, number, cycles = np.unique(rows[:, 2].astype(int), return_inverse=True, return_counts=True)
    if not which.size:  # the ball takes more than the structure has
        return Rolling()
    lost = np.interp(ends, amplitude[which], np.bincount(number, rows[:, 0] - rows[:, 1]) / cycles)
    there = np.array([[math.log(ends), math.log(ends) - lost, 0.0]])
    return Rolling(rows[amplitude[which][number] < ends], ends, there, meets)


def in_wide_cavity(damper: ParticleDamper, amplitude: float) -> ParticleDamper:
    """The same in a cavity so wide that up to an amplitude [m] a ball rolls along x without a hit."""
    return replace(damper, cavity=(2 * (damper.ball_radius + 100 * amplitude), damper.cavity[1]))


def _lag(damper: ParticleDamper) -> float:
    """Amplitude that rolling resistance takes from that of a ball that rolls evenly, as the root of squares [m]."""
    return 0.5 * math.pi * damper.rolling_threshold / damper.stuck_frequency**2 / abs(1 - damper.tilt_share[0])


def _held_aside(damper: ParticleDamper, amplitude: Floats) -> npt.NDArray[np.bool_]:
    """Whether rolling resistance holds a ball along y that rolls along x, from wall to wall at most, shape (n,)."""
    pull = abs(damper.lateral_pull[1]) + abs(damper.restoring[0, 1]) * damper.half_gap[0]
    return np.asarray(pull + damper.cross_drive * amplitude <= damper.rolling_threshold)


def _strays(damper: ParticleDamper, amplitude: Floats) -> Floats:
    """How far the load draws a rolling ball off the middle while the amplitude grows, over half the clearance.

    Averaged over swings whose speed is at most W, rolling resistance acts as a dashpot: x'' + g x' = k x + a, with
    g = 2 beta a_r / (pi W). The ball follows the slow root of r (r + g) = k, which is k / m with -m the other one:
    m x' = k x + a. It begins `_ASTRAY` off the middle. Where it moves along y too, it is at a wall there.
    """
    beta, omega, gap = damper.inertia_ratio, damper.stuck_frequency, damper.half_gap[0]
    middle, curve = np.sqrt(amplitude[1:] * amplitude[:-1]), damper.restoring
    lag = _lag(damper)  # where the ball pauses, below some 1.2 times that, it has about half the speed of one set off
    pauses = 0.25 * np.maximum(middle**2 - (2 * lag / math.pi) ** 2, 1e-12 * middle**2)
    evenly = np.sqrt(np.maximum(middle**2 - lag**2, pauses))
    half = damper.rolling_threshold / (math.pi * abs(1 - damper.tilt_share[0]) * omega * evenly)  # g / 2
    k, time = -beta * curve[0, 0], math.log(amplitude[1] / amplitude[0]) / _GROWTH * 2 * math.pi / omega
    elapsed = time * (0.5 + np.arange(len(middle)))
    root = half**2 + k
    m = np.where(root >= 0, half + np.sqrt(np.maximum(root, 0.0)), math.sqrt(abs(k)))
    m = np.maximum(m, 1 / elapsed)  # without resistance a pull accelerates the ball for so long
    aside = np.where(_held_aside(damper, middle), 0.0, abs(curve[0, 1]) * damper.half_gap[1])
    grows, moves = np.minimum(k * time / m, _FAST), beta * (abs(damper.lateral_pull[0]) + aside) * time / m
    place, far = _ASTRAY * gap, np.zeros(len(amplitude))
    for n, (growth, path) in enumerate(zip(grows, moves, strict=True)):
        place += (growth * place + path) * (math.expm1(growth) / growth if growth else 1.0)
        far[n + 1] = max(far[n], place - _ASTRAY * gap)
        if far[n + 1] > gap:
            far[n + 1 :] = math.inf
            break
    return far / gap


def swinging(damper: ParticleDamper, amplitude: Floats | float) -> tuple[Floats, Floats]:
    """Place and velocity along x, at a crest of the structure, of a ball that rolls evenly to and fro.

    s'' = -share u'' - beta a_r sgn s' with a turn every half period: at each the structure's velocity is
    pi beta a_r / (2 share omega) towards its crest. Where that is more than it has, or the ball is driven too little
    there to turn at once, it pauses: it begins at rest. With a ball so heavy that the structure
    does not move evenly this may be beyond the wall: it begins there.
    """
    share = damper.inertia_ratio * (1 - damper.tilt_share[0])
    omega, push, swing = damper.stuck_frequency, damper.inertia_ratio * damper.rolling_threshold, abs(share) * amplitude
    ahead = 0.5 * math.pi * push / (swing * omega**2)
    lag = np.minimum(ahead, 1.0)
    evenly = (ahead < 1) & (np.sqrt(1 - lag**2) * swing * omega**2 >= push)
    way, wait = math.copysign(1.0, share), np.arcsin(lag) / omega
    place = np.maximum(swing * (lag * wait * omega - 1) - 0.5 * push * wait**2, -damper.half_gap[0])
    velocity = swing * omega * lag - push * wait
    return np.where(evenly, way * place, 0.0), np.where(evenly, way * velocity, 0.0)


def _rows(damper: ParticleDamper, energy: Floats) -> Floats:
    """Samples of sweeps."""
    with np.errstate(divide="ignore", invalid="ignore"):  # what rounding leaves of nothing has either sign
        level = 0.5 * np.log(2 * energy[..., :2] / damper.stiffness[0])
    number = np.repeat(np.arange(len(level)), level.shape[1])
    rows: Floats = np.column_stack([level.reshape(-1, 2), number])
    return np.asarray(rows[np.isfinite(rows[:, 0] + rows[:, 1])])


class Sweeps(NamedTuple):
    """How n sweeps go: shape (n,), or a number for all of them.

    Attributes:
        amplitude: at which they begin [m].
        cycles: that they go on for.
        factor: by which the structure's energy changes from cycle to cycle.
        place, velocity: of the ball along x at the beginning [m, m/s].
        aside: its place along y then [m].
    """

    amplitude: Floats
    cycles: Integers | int
    factor: Floats | float = 1.0
    place: Floats | float = 0.0
    velocity: Floats | float = 0.0
    aside: Floats | float = 0.0


def _ramped(
    damper: ParticleDamper,
    sweeps: Sweeps,
    threads: int | None,
    least: float = 0.0,
    alike: ParticleDamper | None = None,
) -> Floats:
    """Energies of sweeps, shape (n, cycles, 5) [J]; see `damper.engine.Ramp`.

    `least`: as an amplitude [m]; `alike`: a damper in another cavity, whose equations of motion are the same and known.
    """
    from damper import engine

    amplitude, each_cycles, factor, place, velocity, aside = map(np.array, np.broadcast_arrays(*sweeps))
    count, cycles = len(amplitude), int(each_cycles.max())
    start = np.zeros((count, 5, 2))
    start[:, 0, 0], start[:, 2, 0], start[:, 3, 0], start[:, 2, 1] = amplitude, place, velocity, aside
    p = prepare(np.repeat(damper.parameters, count), start, cycles, cycles)
    energy = np.full((count, cycles, 5), np.nan)
    energy[..., 3] = laws.NOT_REACHED
    below = 0.5 * damper.stiffness[0] * least**2
    ramp, status = engine.Ramp(factor, each_cycles, float(below), energy), np.full(count, engine.BEGINS)
    known = alike or damper
    f = flights(known, np.repeat(known.parameters, count), p, amplitudes=in_one_mode(damper, amplitude))
    arguments = f.runs, f.systems.flows, Tables(), ramp, _EVENTS * cycles, status
    threads = workers(threads)
    size = count if threads == 1 else math.ceil(count / (4 * threads))
    in_blocks(engine.run_block, arguments, count, threads, block_size=size)
    laws.check_sweeps(damper, energy, f.runs["axes"]["excursion"])
    self_check.once("sweeps", samples_of)
    return energy


def in_one_mode(damper: ParticleDamper, displacement: Floats) -> Floats | None:
    """Amplitudes of the modes where the one that yields most along x moves the cavity so, shape (n, k)."""
    if damper.modes is None:
        return None
    k = damper.leading(0)
    amplitudes = np.zeros((len(displacement), len(damper.modes)))
    amplitudes[:, k] = displacement / damper.modes[k].shape[0]
    return amplitudes
