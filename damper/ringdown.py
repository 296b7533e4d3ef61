"""One ring-down: structure and ball released and followed until the ball rests, and the motion at any time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import numpy.typing as npt

from damper import laws, self_check
from damper.model import pair, resting_place, whole
from damper.motion import COUPLED, EnergyBooks, Outcome, RingDown, flights, kinds, moved_by, outcome_of, prepare
from damper.state import BOOKS, COUNTED, EVENT, INVERSE, ROLLING, SLIPPING, SPIN_UP, STUCK, TERMS, Tables

if TYPE_CHECKING:
    from collections.abc import Callable

    from damper.model import Floats, Harmonic, Integers, ParticleDamper, Records
    from damper.motion import Flights


_Scalar = TypeVar("_Scalar", bound=np.generic)

_BUDGET = 200_000
"""Events between two looks at the progress callback and at Ctrl-C."""


def ringdown(
    damper: ParticleDamper,
    release: tuple[float, float],
    cycles: float | None = None,
    *,
    velocity: tuple[float, float] = (0.0, 0.0),
    ball_position: tuple[float, float] | None = None,
    ball_velocity: tuple[float, float] = (0.0, 0.0),
    ball_spin: tuple[float, float] | None = None,
    harmonic: Harmonic | None = None,
    amplitudes: tuple[float, ...] | None = None,
    keep_events: bool = False,
    max_cycles: float = 100_000,
    max_events: int = 50_000_000,
    progress: Callable[[float], None] | None = None,
) -> RingDown:
    """Release structure and ball, by default from rest, and follow them.

    Args:
        damper: what is simulated.
        release: the structure's displacements along x and y at time 0 [m].
        cycles: length of the run in periods 2 pi / omega_1; None: until the ball rests for good.
        velocity: the structure's velocities then [m/s].
        ball_position: of the ball's centre from the cavity's centre then [m]; None: in the middle, or where a ball
            lies in its dent (`damper.model.resting_place`).
        ball_velocity: of the ball relative to the structure then [m/s].
        ball_spin: speed of the ball's surface about its centre then [m/s]; None: the ball rolls.
        harmonic: a force that drives structure and ball; `cycles` must then be given.
        amplitudes: of the damper's modes at time 0, in place of `release`; without them, modes that `release` leaves
            open are displaced as by a force at the cavity, and set going by `velocity` as by a blow there.
        keep_events: keep the event table, from which `damper.sample` makes time histories.
        max_cycles: cap where `cycles` is None.
        max_events: cap on events; the run ends there with `Outcome.EVENT_CAP`.
        progress: called now and then with the simulated time [s].

    Raises:
        ValueError: a pair is not two finite numbers, or too large to be squared; a number of cycles or events is not
            positive; the ball is outside its cavity.
    """
    rows, modal = damper.parameters, None
    named: dict[str, object] = {
        "release": release,
        "velocity": velocity,
        "ball_position": resting_place(rows)[0] if ball_position is None else ball_position,
        "ball_velocity": ball_velocity,
        "ball_spin": ball_velocity if ball_spin is None else ball_spin,
    }
    if amplitudes is not None:
        modal, displacement = moved_by(damper, [amplitudes], 1)
        named["release"] = displacement[0]
    start = np.array([[pair(name, value) for name, value in named.items()]])
    most = whole("max_events", max_events)
    one = prepare(rows, start, cycles, max_cycles, harmonic)
    kind = kinds(damper, rows, harmonic)
    flying = flights(damper, rows, one, harmonic, modal)
    done, tables = _followed(flying, most, keep_events, progress)
    outcome = outcome_of(done, cycles is not None, flying.runs["clock"][0])
    result = _gathered(damper, harmonic, flying, outcome, tables)
    longest = (max_cycles if cycles is None else cycles) * 2 * math.pi / damper.stuck_frequency
    _check(result, flying.runs, kind, start, longest)
    self_check.once("ring-downs", ringdown)
    return result


def _followed(
    flying: Flights, most: int, keep_events: bool, progress: Callable[[float], None] | None
) -> tuple[bool, Tables]:
    """Run to the end, or to so many events at most; whether it was done, and what was recorded."""
    from damper import engine

    run, size = flying.runs[0], 1024 if keep_events else 0
    clock, status, ramp = run["clock"], np.full(1, engine.BEGINS), engine.Ramp()
    more = int(run["system"]["coordinates"]) if run["system"]["cavity"].any() else 0
    tables = Tables(np.zeros((1024, 2)), np.zeros(size, EVENT), np.zeros((size, 2, more)))
    while True:
        pause = min(_BUDGET + int(clock["events"]), most)
        engine.run_block((0, 1), flying.runs, flying.systems.flows, tables, ramp, pause, status)
        done = bool(status[0] == engine.DONE)
        if done or clock["events"] >= most:
            break
        peaks, used = _roomier(tables.peaks, int(clock["peaks"])), int(clock["rows"]) + 2
        tables = Tables(peaks, _roomier(tables.rows, used), _roomier(tables.states, used))
        if progress is not None:
            progress(float(clock["time"]))
    count = clock["rows"]
    return done, Tables(tables.peaks[: clock["peaks"]].copy(), tables.rows[:count].copy(), tables.states[:count].copy())


def _gathered(
    damper: ParticleDamper, harmonic: Harmonic | None, flying: Flights, outcome: Outcome, tables: Tables
) -> RingDown:
    clock, books, axes = (flying.runs[name][0] for name in ("clock", "books", "axes"))
    load = damper.centrifugal_acceleration
    moved = math.isfinite(clock["last_motion"])
    counted: dict[str, Any] = {name: int(clock[name]) for name in COUNTED}
    return RingDown(
        **counted,
        damper=damper,
        outcome=outcome,
        duration=float(clock["time"]),
        peak_times=tables.peaks[:, 0],
        peak_velocities=tables.peaks[:, 1],
        last_motion=float(clock["last_motion"]) if moved else None,
        rested=math.isfinite(clock["rest"]) and clock["trembles"] != 2,
        energy=EnergyBooks(**{name: float(books[name]) for name in BOOKS.names or ()}),
        largest_rolling_demand=float(axes["demand"].max()) / load if load > 0 else None,
        harmonic=harmonic,
        rows=tables.rows if len(tables.rows) else None,
        states=tables.states if len(tables.states) else None,
        modal_energies=None if damper.modes is None else flying.modal_energies(damper)[0],
    )


def _check(result: RingDown, runs: Records, kind: Integers, start: Floats, longest: float) -> None:
    """Check a ring-down against its laws; `longest`: it lasts so long at most [s]."""
    damper, (velocity, spin) = result.damper, np.square(start[0, 3:]).sum(axis=1)
    extremes = laws.Extremes(
        kind=kind,
        excursion=runs["axes"]["excursion"],
        velocity=np.array([result.peak_velocities.max(initial=0.0)]),
        ball_energy=0.5 * float(damper.ball_mass * velocity + damper.spin_mass * spin),
        driven=result.harmonic is not None,
    )
    laws.check_ringdowns(damper, damper.parameters, result, extremes)
    laws.check_times(result, longest)
    laws.check_rest(runs)
    if result.rows is not None and kind[0] != COUPLED:
        laws.check_hits(result, result.rows)


def _roomier(table: npt.NDArray[_Scalar], used: int) -> npt.NDArray[_Scalar]:
    """The table, twice as long if it is full."""
    return table if used < len(table) else np.concatenate([table, np.zeros_like(table)])


@dataclass(frozen=True, eq=False)
class History:
    """Motion at given times; the columns of the (n, 2) arrays are the axes x and y.

    Attributes:
        time: shape (n,) [s].
        displacement: of the structure, shape (n, 2) [m].
        velocity: of the structure, shape (n, 2) [m/s].
        relative_position: of the ball's centre from the cavity's centre, shape (n, 2) [m].
        relative_velocity: of the ball in the cavity, shape (n, 2) [m/s].
        spin: of the ball, as the speed of its surface about its centre, shape (n, 2) [m/s]; rolling, it is the
            relative velocity.
        regime: 0 stuck to the structure, 1 rolling, 2 slipping on the floor, shape (n, 2).
    """

    time: Floats
    displacement: Floats
    velocity: Floats
    relative_position: Floats
    relative_velocity: Floats
    spin: Floats
    regime: npt.NDArray[np.int64]


def sample(ringdown: RingDown, times: npt.ArrayLike) -> History:
    """The motion at `times` [s], shape (n,), exact to rounding; at an event, the state just after it.

    Raises:
        ValueError: the ring-down kept no events, or a time lies outside it.
    """
    if ringdown.rows is None or ringdown.states is None:
        raise ValueError("the ring-down kept no events: call ringdown(..., keep_events=True)")
    time = np.atleast_1d(np.asarray(times, dtype=np.float64))
    if time.ndim != 1:
        raise ValueError(f"times must have shape (n,), got {time.shape}")
    if time.size and not (time.min() >= 0 and time.max() <= ringdown.duration * (1 + 1e-12)):
        raise ValueError(f"times must lie between 0 and the ring-down's end, {ringdown.duration:g} s")
    damper = ringdown.damper
    one = prepare(damper.parameters, np.zeros((1, 5, 2)), 1.0, 1.0)
    of = flights(damper, damper.parameters, one, ringdown.harmonic)
    out, regime = np.empty((5, time.size, 2)), np.empty((time.size, 2), np.int64)
    for g in range(of.runs["system"]["groups"][0]):
        _sample_group(g, ringdown.rows, ringdown.states, of, time, out, regime)
    return History(time, out[0], out[1], out[2], out[3], out[4], regime)


def _sample_group(
    g: int, rows: Records, states: Floats, of: Flights, times: Floats, out: Floats, regimes: Integers
) -> None:
    """Fill in u, v, s, w and spin, shape (5, n, 2), and the regimes, shape (n, 2), along the axes of a group."""
    system, ball, terms = of.runs["system"][0], of.runs["ball"][0], of.systems.flows[0]
    axes, here = np.arange(system["first"][g], system["last"][g]), slice(system["low"][g], system["high"][g])
    span = system["span"][g]
    mine = np.flatnonzero(np.isin(rows["axis"], axes))
    seen, which = np.unique(np.searchsorted(rows["time"][mine], times, side="right") - 1, return_inverse=True)
    last = [np.maximum.accumulate(np.where(rows["axis"][mine] == i, mine, mine[0]))[seen] for i in axes]
    own = rows[np.stack(last, axis=1)]  # the last event along each axis, shape (events, axes)
    rolls, slips, start = own["regime"] == ROLLING, own["regime"] == SLIPPING, rows["time"][mine[seen]]
    flow = 3 * own["regime"][:, 0] + own["regime"][:, 1] if len(axes) == 2 else 3 * g + own["regime"][:, 0]
    resisting = own["direction"] * (rolls * ball["threshold"] + slips * ball["grip"]) - system["lateral"][axes]
    if states.shape[2]:
        z, rate = states[mine[seen], 0, here], states[mine[seen], 1, here]
    else:
        z, rate = (np.stack([own[first][:, 0], own[second][:, 0]], axis=1) for first, second in ("us", "vw"))
    count, frequency = z.shape[1], system["frequency"]
    terms = terms[:, :, : 2 * count + len(axes) + 2 * (frequency > 0)]
    steps = np.maximum(np.ceil((times - start[which]) / span).astype(int) - 1, 0)
    most, begin = np.zeros(len(seen), int), np.empty(len(times))
    np.maximum.at(most, which, steps)
    source = np.empty((len(times), terms.shape[2]))
    values, slopes = terms @ INVERSE, terms[..., 1:] @ INVERSE[:-1]  # after a step
    for done in range(steps.max(initial=-1) + 1):
        angle = frequency * start[:, None] + system["phase"]
        wave = [np.cos(angle), np.sin(angle)] if frequency > 0 else []
        begins = np.concatenate([z, rate * span, resisting, *wave], axis=1)
        now, on = np.flatnonzero(steps == done), np.flatnonzero(most > done)
        source[now], begin[now] = begins[which[now]], start[which[now]]
        z[on], rate[on] = (
            np.einsum("ej,ecj->ec", begins[on], after[flow[on], :count]) / unit
            for after, unit in ((values, 1.0), (slopes, span))
        )
        start[on] += span
    powers = ((times - begin) / span)[:, None] ** np.arange(TERMS) * INVERSE
    for each in np.unique(flow):
        k = np.flatnonzero(flow[which] == each)
        series = np.tensordot(source[k], terms[each], (1, 1))
        value = np.einsum("kct,kt->kc", series, powers[k])
        slope = np.einsum("kct,kt->kc", series[..., 1:], powers[k, :-1]) / span
        for n, i in enumerate(axes):
            cavity, lane, place = system["cavity"][i], system["lane"][i], system["place"][i] - here.start
            event = own[which[k], n]
            stuck, past = event["regime"] == STUCK, times[k] - event["time"]
            relative = np.where(stuck, source[k, place], value[:, lane]), np.where(stuck, 0.0, slope[:, lane])
            spin, loss = event["spin"], SPIN_UP * ball["grip"] * past
            spin = np.where(
                stuck,
                np.copysign(np.maximum(np.abs(spin) - loss, 0.0), spin),
                np.where(event["regime"] == ROLLING, relative[1], spin + event["direction"] * loss),
            )
            out[:, k, i] = value[:, cavity], slope[:, cavity], *relative, spin
            regimes[k, i] = event["regime"]
