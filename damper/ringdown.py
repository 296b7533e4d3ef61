"""One ring-down: structure and ball released and followed until the ball rests.

`Course` is what a ring-down needs of the event loop, in closed form or in linear flights.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from damper import laws, self_check
from damper.model import energy, number, pair, whole
from damper.motion import (
    APART,
    CLOSED_FORM,
    COUPLED,
    EnergyBooks,
    Outcome,
    RingDown,
    flights,
    kinds,
    outcome_of,
    prepare,
)
from damper.state import BOOKS, COUNTED, EVENT, Tables

if TYPE_CHECKING:
    from collections.abc import Callable

    from damper.model import Floats, Harmonic, ParticleDamper, Record, Records
    from damper.motion import Flights, Prepared


class Course(Protocol):
    """What `ringdown` asks of either engine."""

    runs: Records
    run: Record
    initial: float
    kind: int

    def states(self, size: int) -> Floats:
        """A table of states for as many events."""

    def release(self, tables: Tables) -> None:
        """Let go."""

    def go_on(self, tables: Tables, budget: int) -> bool:
        """Until the end (True), a full table or the end of the budget."""

    def energy(self) -> float:
        """Of structure and ball, now [J]."""

    def modal_energies(self) -> Floats | None:
        """Of each of the damper's modes, now [J]; None without modes."""


def course_of(
    damper: ParticleDamper,
    one: Prepared,
    harmonic: Harmonic | None = None,
    amplitudes: tuple[float, ...] | None = None,
) -> Course:
    """The course of the one ring-down that is prepared."""
    if kinds(damper, damper.parameters, harmonic)[0] == CLOSED_FORM:
        return _Closed(damper, one)
    return _Linear(damper, flights(damper, damper.parameters, one, harmonic, amplitudes))


class _Closed:
    def __init__(self, damper: ParticleDamper, one: Prepared) -> None:
        self.rows, self.one = damper.parameters, one
        self.runs, self.run, self.initial, self.kind = one.runs, one.runs[0], float(one.initial[0]), CLOSED_FORM

    def states(self, size: int) -> Floats:
        return np.zeros((0, 2, 0))

    def release(self, tables: Tables) -> None:
        from damper import engine

        engine.level_release(self.run, tables)

    def go_on(self, tables: Tables, budget: int) -> bool:
        from damper import engine
        from damper.engine import DONE

        return engine.level_run(self.run, tables, budget) == DONE

    def energy(self) -> float:
        return float(energy(self.rows, self.one.axes)[0])

    def modal_energies(self) -> Floats | None:
        return None


class _Linear:
    def __init__(self, damper: ParticleDamper, flights: Flights) -> None:
        self.damper, self.rows, self.flights = damper, damper.parameters, flights
        self.runs, self.run, self.flow = flights.runs, flights.runs[0], flights.systems.flows[0]
        self.initial, self.kind = self.energy(), (COUPLED, APART)[int(self.run["system"]["groups"]) - 1]

    def states(self, size: int) -> Floats:
        return np.zeros((size, 2, len(self.run["motion"]["z"])))

    def release(self, tables: Tables) -> None:
        from damper import engine

        engine.release(self.run, self.flow, tables)

    def go_on(self, tables: Tables, budget: int) -> bool:
        from damper import engine
        from damper.engine import DONE

        return engine.run(self.run, self.flow, tables, budget) == DONE

    def energy(self) -> float:
        return float(self.flights.energy(self.rows)[0])

    def modal_energies(self) -> Floats | None:
        return None if self.damper.modes is None else self.flights.modal_energies(self.damper, self.rows)[0]


_Scalar = TypeVar("_Scalar", bound=np.generic)

_BUDGET = 200_000
"""Events between two looks at the progress callback and at Ctrl-C."""


def ringdown(
    damper: ParticleDamper,
    release: tuple[float, float],
    cycles: float | None = None,
    *,
    velocity: tuple[float, float] = (0.0, 0.0),
    ball_position: tuple[float, float] = (0.0, 0.0),
    ball_velocity: tuple[float, float] = (0.0, 0.0),
    ball_spin: tuple[float, float] | None = None,
    harmonic: Harmonic | None = None,
    amplitudes: tuple[float, ...] | None = None,
    keep_events: bool = False,
    max_cycles: float = 100_000,
    max_events: int = 50_000_000,
    progress: Callable[[float], None] | None = None,
) -> RingDown:
    """Release structure and ball, by default from rest with the ball at the cavity's centre, and follow them.

    Args:
        damper: what is simulated.
        release: the structure's displacements along x and y at time 0 [m].
        cycles: length of the run in periods 2 pi / omega_1; None: until the ball rests for good.
        velocity: the structure's velocities then [m/s].
        ball_position: of the ball's centre from the cavity's centre then [m].
        ball_velocity: of the ball relative to the structure then [m/s].
        ball_spin: speed of the ball's surface about its centre then [m/s]; None: the ball rolls.
        harmonic: a force that drives structure and ball; `cycles` must then be given.
        amplitudes: of the damper's modes at time 0, in place of `release`; without them, modes that `release` leaves
            open are displaced as by a force at the cavity, and set going by `velocity` as by a blow there.
        keep_events: keep the event table, from which `damper.history` makes time histories.
        max_cycles: cap where `cycles` is None.
        max_events: cap on events; the run ends there with `Outcome.EVENT_CAP`.
        progress: called now and then with the simulated time [s].

    Raises:
        ValueError: a pair is not two finite numbers, or too large to be squared; a number of cycles or events is not
            positive; the ball is outside its cavity.
    """
    if amplitudes is not None:
        release = _moved(damper, amplitudes)
    start = _Start(release, velocity, ball_position, ball_velocity, ball_velocity if ball_spin is None else ball_spin)
    limits = _Limits(cycles, max_cycles, whole("max_events", max_events))
    one = _prepared(damper, start, limits, harmonic)
    course = course_of(damper, one, harmonic, amplitudes)
    done, tables = _followed(course, limits.max_events, keep_events, progress)
    outcome = outcome_of(done, cycles is not None, course.run["clock"])
    result = replace(_gathered(damper, course, outcome, tables), harmonic=harmonic)
    longest = (max_cycles if cycles is None else cycles) * 2 * math.pi / damper.stuck_frequency
    _check(result, course, start, longest)
    self_check.once("level" if course.kind == CLOSED_FORM else "linear", ringdown)
    return result


class _Start(NamedTuple):
    """Where structure and ball are at time 0; the fields are the arguments of `ringdown`."""

    release: tuple[float, float]
    velocity: tuple[float, float]
    ball_position: tuple[float, float]
    ball_velocity: tuple[float, float]
    ball_spin: tuple[float, float]


class _Limits(NamedTuple):
    """How far a run goes: cycles asked for, or a cap on them; and a cap on events."""

    cycles: float | None
    max_cycles: float
    max_events: int


def _prepared(damper: ParticleDamper, start: _Start, limits: _Limits, harmonic: Harmonic | None) -> Prepared:
    if harmonic is not None and limits.cycles is None:
        raise ValueError("cycles must be given where a harmonic force drives the motion: it never comes to rest")
    state = np.array([[pair(name, value) for name, value in start._asdict().items()]])
    return prepare(damper.parameters, state, limits.cycles, limits.max_cycles)


def _followed(
    course: Course, most: int, keep_events: bool, progress: Callable[[float], None] | None
) -> tuple[bool, Tables]:
    """Run to the end, or to so many events at most; whether it was done, and what was recorded."""
    clock, size = course.run["clock"], 1024 if keep_events else 0
    tables = Tables(np.zeros((1024, 2)), np.zeros(size, EVENT), course.states(size))
    course.release(tables)
    while True:
        done = course.go_on(tables, min(_BUDGET, most - int(clock["events"])))
        if done or clock["events"] >= most:
            break
        peaks, used = _roomier(tables.peaks, int(clock["peaks"])), int(clock["rows"]) + 2
        tables = Tables(peaks, _roomier(tables.rows, used), _roomier(tables.states, used))
        if progress is not None:
            progress(float(clock["time"]))
    count = clock["rows"]
    return done, Tables(tables.peaks[: clock["peaks"]].copy(), tables.rows[:count].copy(), tables.states[:count].copy())


def _gathered(damper: ParticleDamper, course: Course, outcome: Outcome, tables: Tables) -> RingDown:
    clock, books, axes = (course.run[name] for name in ("clock", "books", "axes"))
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
        energy=EnergyBooks(
            initial=course.initial,
            final=course.energy(),
            **{name: float(books[name]) for name in BOOKS.names or ()},
        ),
        largest_rolling_demand=float(axes["demand"].max()) / load if load > 0 else None,
        rows=tables.rows if len(tables.rows) else None,
        states=tables.states if tables.states.size else None,
        modal_energies=course.modal_energies(),
    )


def _check(result: RingDown, course: Course, start: _Start, longest: float) -> None:
    """Check a ring-down against its laws; `longest`: it lasts so long at most [s]."""
    damper, (velocity, spin) = result.damper, (np.square(start.ball_velocity).sum(), np.square(start.ball_spin).sum())
    extremes = laws.Extremes(
        kind=np.array([course.kind]),
        excursion=course.run["axes"]["excursion"][None],
        velocity=np.array([result.peak_velocities.max(initial=0.0)]),
        ball_energy=0.5 * float(damper.ball_mass * velocity + damper.spin_mass * spin),
        driven=result.harmonic is not None,
    )
    laws.check_ringdowns(damper, damper.parameters, result, extremes)
    laws.check_times(result, longest)
    laws.check_rest(course.runs)
    if result.rows is not None and course.kind != COUPLED:
        laws.check_hits(result, result.rows)


def _moved(damper: ParticleDamper, amplitudes: tuple[float, ...]) -> tuple[float, float]:
    """Displacement of the cavity at these amplitudes of its modes."""
    if damper.modes is None or len(amplitudes) != len(damper.modes):
        raise ValueError(f"amplitudes must be as many as the damper has modes, got {amplitudes!r}")
    shape = np.array([mode.shape for mode in damper.modes])
    x, y = np.array([number("amplitudes", a) for a in amplitudes]) @ shape
    return float(x), float(y)


def _roomier(table: npt.NDArray[_Scalar], used: int) -> npt.NDArray[_Scalar]:
    """The table, twice as long if it is full."""
    if len(table) == 0 or used < len(table):
        return table
    bigger = np.zeros((2 * len(table), *table.shape[1:]), table.dtype)
    bigger[: len(table)] = table
    return bigger
