"""What a ring-down leaves."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from damper.arrays import Floats, Records

if TYPE_CHECKING:
    import numpy as np

    from damper.model import ParticleDamper
    from damper.modes import Harmonic


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
            shape (n + 1,) [s]; none in a run that ends within the first half of one.
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


def outcome_of(done: bool, asked: bool, clock: np.void) -> Outcome:
    """Why a run ended that was done, or capped; `asked` for a number of cycles or not."""
    if not done:
        return Outcome.EVENT_CAP
    if asked:
        return Outcome.CYCLES_DONE
    if not math.isfinite(clock["rest"]):
        return Outcome.CYCLE_CAP
    return (Outcome.AT_REST, Outcome.TREMBLES, Outcome.DIED_OUT)[int(clock["trembles"])]
