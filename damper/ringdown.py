"""One ring-down: a damper released from rest, run to its end."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import numpy.typing as npt

from damper.records import AXIS, BOOKS, CLOCK, EVENT, PEAK, Floats, Records, ball_of, laws_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from damper.model import ParticleDamper


_Scalar = TypeVar("_Scalar", bound=np.generic)

_CYCLES_AFTER_REST = 3
_BUDGET = 200_000
"""Events between two looks at the progress callback and at Ctrl-C."""


class Outcome(StrEnum):
    """Why a ring-down ended."""

    AT_REST = "the ball came to rest for good"
    TREMBLES = "the ball no longer hits and only trembles at the rolling threshold"
    CYCLES_DONE = "the asked number of cycles was done"
    CYCLE_CAP = "the cap on cycles was reached while the ball still moved"
    EVENT_CAP = "the cap on events was reached while the ball still moved"


@dataclass(frozen=True)
class EnergyBooks:
    """Where the energy went [J].

    ``initial`` and ``final`` are the energies of structure and ball; ``structure`` the work of the structure's own
    dashpot, ``rolling`` that of the rolling resistance, ``impact`` what wall hits and sticking took, ``slip`` what
    sliding on the floor took; ``residual`` is what the books do not explain.
    """

    initial: float
    final: float
    structure: float
    rolling: float
    impact: float
    slip: float

    @property
    def residual(self) -> float:
        """Initial - final - all losses [J]; negative when energy appeared from nowhere."""
        return self.initial - self.final - self.structure - self.rolling - self.impact - self.slip


@dataclass(frozen=True)
class RingDown:
    """What a ring-down left.

    Attributes:
        damper: the damper simulated.
        outcome: why it ended.
        duration: simulated time [s].
        impacts: number of wall hits.
        events: number of events of any kind.
        peak_times: times of the structure's velocity maxima, one per vibration cycle, shape (n + 1,) [s].
        peak_velocities: v = sqrt(v_x^2 + v_y^2) there, shape (n + 1,) [m/s].
        last_motion: last time at which the ball moved in its cavity [s]; None if it never did.
        rested: whether the ball came to rest for good, or only trembles.
        energy: the books.
        largest_rolling_demand: largest force that rolling asked of the floor over the normal load [-], per axis;
            None without a normal load. Rolling is tenable where the static friction exceeds it.
        rows: the event table (dtype `damper.records.EVENT`), None unless asked for.
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


def ringdown(
    damper: ParticleDamper,
    release: tuple[float, float],
    cycles: float | None = None,
    *,
    velocity: tuple[float, float] = (0.0, 0.0),
    ball_position: tuple[float, float] = (0.0, 0.0),
    ball_velocity: tuple[float, float] = (0.0, 0.0),
    ball_spin: tuple[float, float] | None = None,
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
        keep_events: keep the event table, from which `damper.sample` makes time histories.
        max_cycles: cap where `cycles` is None.
        max_events: cap on events; the run ends there with `Outcome.EVENT_CAP`.
        progress: called now and then with the simulated time [s].

    Raises:
        ValueError: a number is not finite, the number of cycles not positive, or the ball outside its cavity.
    """
    from damper import engine

    if cycles is not None and not (math.isfinite(cycles) and cycles > 0):
        raise ValueError(f"cycles must be positive, got {cycles:g}")
    axes = _start(damper, release, velocity, ball_position, ball_velocity, ball_spin or ball_velocity)
    omega = damper.stuck_frequency
    period = 2 * math.pi / omega
    reach = max(map(abs, (*release, *(x / omega for x in (*velocity, *ball_velocity)))))
    laws, ball = laws_of(damper), ball_of(damper, reach)
    clock, books, peak = np.zeros(1, CLOCK), np.zeros(1, BOOKS), np.zeros(1, PEAK)
    clock["end"] = period * (max_cycles if cycles is None else cycles)
    clock["tail"] = _CYCLES_AFTER_REST * period if cycles is None else np.inf
    clock["rest"], clock["last_motion"] = np.inf, -np.inf
    peak[0] = (period, 0.0, 0.5 * period, -1.0, 0.0)
    peaks = np.zeros((1024, 2))
    rows = np.zeros(1024 if keep_events else 0, EVENT)
    initial = energy_of(damper, axes)

    engine.release(clock[0], axes, laws, ball[0], rows)
    while True:
        budget = min(_BUDGET, max_events - int(clock["events"][0]))
        status = engine.run(clock[0], axes, laws, ball[0], books[0], peak[0], peaks, rows, budget)
        if status == engine.DONE or clock["events"][0] >= max_events:
            break
        peaks, rows = _roomier(peaks, int(clock["peaks"][0])), _roomier(rows, int(clock["rows"][0]) + 2)
        if progress is not None:
            progress(float(clock["time"][0]))

    end, book = clock[0], books[0]
    load = damper.centrifugal_acceleration
    return RingDown(
        damper=damper,
        outcome=_outcome(status == engine.DONE, cycles is not None, end),
        duration=float(end["time"]),
        impacts=int(end["impacts"]),
        events=int(end["events"]),
        peak_times=peaks[: end["peaks"], 0].copy(),
        peak_velocities=peaks[: end["peaks"], 1].copy(),
        last_motion=float(end["last_motion"]) if math.isfinite(end["last_motion"]) else None,
        rested=math.isfinite(end["rest"]),
        energy=EnergyBooks(
            initial=initial,
            final=energy_of(damper, axes),
            structure=float(book["structure"]),
            rolling=float(book["rolling"]),
            impact=float(book["impact"]),
            slip=float(book["slip"]),
        ),
        largest_rolling_demand=float(axes["demand"].max()) / load if load > 0 else None,
        rows=rows[: end["rows"]].copy() if keep_events else None,
    )


def _start(damper: ParticleDamper, *state: tuple[float, float]) -> Records:
    """The two axes at time 0, from u, v, s, w and the spin of each."""
    axes = np.zeros(2, AXIS)
    axes["half_gap"] = damper.half_gap
    for name, pair in zip(("u", "v", "s", "w", "spin"), state, strict=True):
        if not all(map(math.isfinite, pair)):
            raise ValueError(f"the release must be finite, got {pair}")
        axes[name] = pair
    if (abs(axes["s"]) > axes["half_gap"] + 1e-12 * damper.ball_radius).any():
        raise ValueError(f"ball_position {state[2]} lies outside the cavity, ±{damper.half_gap}")
    axes["s"] = np.clip(axes["s"], -axes["half_gap"], axes["half_gap"])
    return axes


def energy_of(damper: ParticleDamper, state: Records) -> float:
    """Energy of structure and ball [J] from records with fields u, v, w and spin, one per axis.

    Sum over the axes of  K u^2 / 2 + M2 v^2 / 2 + m_p (v + w)^2 / 2, and 2/5 m_p spin^2 / 2.
    """
    u, v, w, spin = state["u"], state["v"], state["w"], state["spin"]
    stiffness = np.asarray(damper.stiffness)
    twice = stiffness * u**2 + damper.modal_mass * v**2 + damper.ball_mass * (v + w) ** 2 + damper.spin_mass * spin**2
    return 0.5 * float(twice.sum())


def _roomier(table: npt.NDArray[_Scalar], used: int) -> npt.NDArray[_Scalar]:
    """The table, twice as long if it is full."""
    if len(table) == 0 or used < len(table):
        return table
    bigger = np.zeros((2 * len(table), *table.shape[1:]), table.dtype)
    bigger[: len(table)] = table
    return bigger


def _outcome(done: bool, asked: bool, clock: np.void) -> Outcome:
    if not done:
        return Outcome.EVENT_CAP
    if asked:
        return Outcome.CYCLES_DONE
    if not math.isfinite(clock["rest"]):
        return Outcome.CYCLE_CAP
    return Outcome.TREMBLES if clock["trembles"] else Outcome.AT_REST
