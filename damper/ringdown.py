"""One ring-down: a damper released from rest, run to its end."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import numpy.typing as npt

from damper.arrays import Floats, Records
from damper.course import course_of
from damper.parameters import number, pair, whole
from damper.prepare import prepare
from damper.records import EVENT
from damper.tables import Tables

if TYPE_CHECKING:
    from collections.abc import Callable

    from damper.course import Course
    from damper.model import ParticleDamper
    from damper.modes import Harmonic


_Scalar = TypeVar("_Scalar", bound=np.generic)

_BUDGET = 200_000
"""Events between two looks at the progress callback and at Ctrl-C."""


class Outcome(StrEnum):
    """Why a ring-down ended."""

    AT_REST = "the ball came to rest for good"
    TREMBLES = "the ball no longer hits and only trembles at the rolling threshold"
    DIED_OUT = "the vibration died out while the ball still moved"
    CYCLES_DONE = "the asked number of cycles was done"
    CYCLE_CAP = "the cap on cycles was reached while the ball still moved"
    EVENT_CAP = "the cap on events was reached while the ball still moved"


@dataclass(frozen=True)
class EnergyBooks:
    """Where the energy went [J].

    ``initial`` and ``final`` are the energies of structure and ball; ``structure`` the work of the structure's own
    dashpot, ``rolling`` that of the rolling resistance, ``impact`` what wall hits and sticking took, ``slip`` what
    sliding on the floor took; ``work`` is what a harmonic force put in; ``residual`` is what the books do not explain.
    """

    initial: float
    final: float
    structure: float
    rolling: float
    impact: float
    slip: float
    work: float = 0.0

    @property
    def residual(self) -> float:
        """Initial + work - final - all losses [J]; negative when energy appeared from nowhere."""
        return self.initial - self.final - self.structure - self.rolling - self.impact - self.slip + self.work


@dataclass(frozen=True)
class RingDown:
    """What a ring-down left.

    Attributes:
        damper: the damper simulated.
        outcome: why it ended.
        duration: simulated time [s].
        impacts: number of wall hits.
        events: number of events of any kind.
        peak_times: times of the structure's velocity maxima, one per vibration cycle, or per cycle of what drives it,
            shape (n + 1,) [s].
        peak_velocities: v = sqrt(v_x^2 + v_y^2) there, shape (n + 1,) [m/s].
        last_motion: last time at which the ball moved in its cavity [s]; None if it never did.
        rested: whether the ball came to rest for good, or only trembles.
        energy: the books.
        largest_rolling_demand: largest force that rolling asked of the floor over the normal load [-], per axis;
            None without a normal load. Rolling is tenable where the static friction exceeds it.
        rows: the event table (dtype `damper.records.EVENT`), None unless asked for.
        harmonic: what drove it.
        states: coordinates and their velocities at each event where flights are linear, shape (n, 2, N), else None.
        modal_energies: kinetic and elastic energy of each of the damper's modes at the end, without the ball's part,
            shape (k,) [J]; None without modes.
    """

    damper: ParticleDamper
    outcome: Outcome
    duration: float
    impacts: int
    events: int
    peak_times: Floats
    peak_velocities: Floats
    last_motion: float | None
    rested: bool
    energy: EnergyBooks
    largest_rolling_demand: float | None
    rows: Records | None = None
    harmonic: Harmonic | None = None
    states: Floats | None = None
    modal_energies: Floats | None = None

    @property
    def peak_phases(self) -> Floats | None:
        """Phase of the harmonic at the velocity maxima, from -pi/2 to pi/2, shape (n + 1,) [rad]; None without one.

        By so much the velocity, or its opposite, lags behind the force; `peak_velocities` is the envelope.
        """
        if self.harmonic is None:
            return None
        phases: Floats = self.harmonic.frequency * self.peak_times + self.harmonic.phase
        return (phases + 0.5 * math.pi) % math.pi - 0.5 * math.pi


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
        keep_events: keep the event table, from which `damper.sample` makes time histories.
        max_cycles: cap where `cycles` is None.
        max_events: cap on events; the run ends there with `Outcome.EVENT_CAP`.
        progress: called now and then with the simulated time [s].

    Raises:
        ValueError: a pair is not two finite numbers, or too large to be squared; a number of cycles or events is not
            positive; the ball is outside its cavity.
    """
    most = whole("max_events", max_events)
    if harmonic is not None and cycles is None:
        raise ValueError("cycles must be given where a harmonic force drives the motion: it never comes to rest")
    if amplitudes is not None:
        release = _moved(damper, amplitudes)
    state = {
        "release": release,
        "velocity": velocity,
        "ball_position": ball_position,
        "ball_velocity": ball_velocity,
        "ball_spin": ball_velocity if ball_spin is None else ball_spin,
    }
    start = np.array([[pair(name, value) for name, value in state.items()]])
    parameters = damper.parameters
    one = prepare(parameters, start, cycles, max_cycles)
    course = course_of(damper, one, harmonic, amplitudes)
    done, tables = _followed(course, most, keep_events, progress)
    outcome = outcome_of(done, cycles is not None, course.run["clock"])
    kept = replace(_gathered(damper, course, outcome, tables), harmonic=harmonic)
    if not keep_events:
        return kept
    return replace(kept, rows=tables.rows, states=tables.states if tables.states.size else None)


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
    clock, books, axes, load = (
        *(course.run[name] for name in ("clock", "books", "axes")),
        damper.centrifugal_acceleration,
    )
    moved = math.isfinite(clock["last_motion"])
    return RingDown(
        damper=damper,
        outcome=outcome,
        duration=float(clock["time"]),
        impacts=int(clock["impacts"]),
        events=int(clock["events"]),
        peak_times=tables.peaks[:, 0],
        peak_velocities=tables.peaks[:, 1],
        last_motion=float(clock["last_motion"]) if moved else None,
        rested=math.isfinite(clock["rest"]) and clock["trembles"] != 2,
        energy=EnergyBooks(
            initial=course.initial,
            final=course.energy(),
            **{name: float(books[name]) for name in ("structure", "rolling", "impact", "slip", "work")},
        ),
        largest_rolling_demand=float(axes["demand"].max()) / load if load > 0 else None,
        modal_energies=course.modal_energies(),
    )


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


def outcome_of(done: bool, asked: bool, clock: np.void) -> Outcome:
    """Why a run ended that was done, or capped; `asked` for a number of cycles or not."""
    if not done:
        return Outcome.EVENT_CAP
    if asked:
        return Outcome.CYCLES_DONE
    if not math.isfinite(clock["rest"]):
        return Outcome.CYCLE_CAP
    return (Outcome.AT_REST, Outcome.TREMBLES, Outcome.DIED_OUT)[int(clock["trembles"])]
