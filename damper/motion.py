"""Ring-downs before and after the event loop: how they begin, and what they leave.

`prepare` turns initial states into runs; `kinds` says whether their axes are coupled, and `flights` gives them the
constants of their flights. `RingDown` is the result, with its `Outcome` and its `EnergyBooks`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from damper.equations import structures_by, systems_of
from damper.model import (
    Floats,
    Harmonic,
    Records,
    half_gap,
    number,
    stuck_decay,
    stuck_frequency,
    table,
)
from damper.state import FLYING, RUN, SHARED, Counts, balls_of, zeros

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.equations import Systems
    from damper.model import Integers, Parameters, ParticleDamper


APART, COUPLED = 0, 1
"""How a damper flies: along x and along y, each for itself, or along both together."""


@dataclass(frozen=True, eq=False)
class Flights:
    """Runs of n ring-downs alike, dtype `damper.state.FLYING`, and the systems that they share.

    The constants of a run name the terms of its flights, among `systems.flows`.
    """

    runs: Records
    systems: Systems

    def modal_energies(self, damper: ParticleDamper) -> Floats:
        """Kinetic and elastic energy of each mode, shape (n, k) [J]."""
        structures = structures_by(damper, damper.parameters)
        back = np.argsort(self.systems.order)[: structures.mass.shape[1]]
        z, rate = self.runs["motion"]["z"][:, back], self.runs["motion"]["rate"][:, back]
        return np.asarray(0.5 * (structures.spring * z**2 + structures.mass * rate**2))


def kinds(damper: ParticleDamper, rows: Parameters, harmonic: Harmonic | None = None) -> Integers:
    """How each of the rows flies, shape (n,)."""
    if rows["printed"].any() and not (harmonic is None and damper.modes is None):
        raise ValueError("the printed equations support one free mode only; use the consistent formulation")
    return np.where(structures_by(damper, rows).coupled, COUPLED, APART)


def flights(
    damper: ParticleDamper,
    rows: Parameters,
    prepared: Records,
    harmonic: Harmonic | Sequence[Harmonic] | None = None,
    amplitudes: tuple[float, ...] | Floats | None = None,
) -> Flights:
    """Flights of what is prepared, from its u, v, s and w; all of one kind, driven alike or each by a harmonic.

    Several modes that a displacement of the cavity leaves open are displaced as by a force there, and set going as by a
    blow; `amplitudes`, shape (k,) or (n, k), are theirs instead.
    """
    first = which = np.arange(len(rows))
    if harmonic is None or isinstance(harmonic, Harmonic):  # rows that are equal share a system
        every = rows.view(f"V{rows.itemsize}")
        first, which = np.unique(every, return_index=True, return_inverse=True)[1:]
    if harmonic is None and len(first) == 1 and rows[0].tobytes() == damper.parameters[0].tobytes():
        systems = _free(damper)
    else:
        systems = systems_of(rows[first], structures_by(damper, rows[first]), harmonic)
    runs, axes = zeros(len(rows), FLYING), prepared["axes"]
    runs[SHARED], runs["system"] = prepared, systems.constants[which]
    n, k = len(rows), len(systems.order) - 2
    z, rate = np.zeros((n, k + 2)), np.zeros((n, k + 2))
    structures = structures_by(damper, rows)
    if damper.modes is None:
        z[:, :k], rate[:, :k] = axes["u"], axes["v"]
    else:
        z[:, :k] = _spread(structures.shape, structures.spring, axes["u"])
        rate[:, :k] = _spread(structures.shape, structures.mass, axes["v"])
    if amplitudes is not None:
        z[:, :k] = amplitudes
    if harmonic is None:  # where both axes vibrate, at frequencies that differ, the cavity's speed beats
        both = ((z[:, :k] != 0) | (rate[:, :k] != 0)).all(axis=1) & ~rows["printed"]
        runs["system"]["several"] |= both & (np.ptp(structures.spring / structures.mass, axis=1) > 0)
    z[:, k:], rate[:, k:] = axes["s"], axes["w"]
    runs["motion"]["z"][:, : k + 2], runs["motion"]["rate"][:, : k + 2] = z[:, systems.order], rate[:, systems.order]
    if isinstance(harmonic, Harmonic):  # its cycles are those of what drives it
        cycles, period = runs["cycle"], 2 * math.pi / harmonic.frequency
        cycles["period"], cycles["wait"], cycles["closes"] = period, 0.75 * period, 0.5 * period
    return Flights(runs, systems)


@lru_cache(maxsize=4)
def _free(damper: ParticleDamper) -> Systems:
    """The system of a damper that nothing drives, worked out once for all that is let go on it."""
    return systems_of(damper.parameters, structures_by(damper, damper.parameters))


def moved_by(damper: ParticleDamper, amplitudes: npt.ArrayLike, count: int) -> tuple[Floats, Floats]:
    """Amplitudes of a damper's modes, shape (count, k), and the cavity's displacement by them, shape (count, 2)."""
    shapes = np.array([mode.shape for mode in damper.modes or ()]).reshape(-1, 2)
    modal = table("amplitudes", amplitudes)
    if damper.modes is None or modal.shape != (count, len(shapes)):
        raise ValueError(
            f"amplitudes must be {len(shapes)} for each ring-down, one for each mode, got shape {modal.shape}"
        )
    return modal, modal @ shapes


def _spread(shape: Floats, weight: Floats, moved: Floats) -> Floats:
    """Least coordinates, by their weights, that move the cavity so, shape (n, k)."""
    light = shape.transpose(0, 2, 1) / weight[:, :, None]
    return np.asarray((light @ np.linalg.pinv(shape @ light, hermitian=True) @ moved[:, :, None])[..., 0])


class Outcome(StrEnum):
    """Why a ring-down ended."""

    AT_REST = "the ball came to rest for good"
    TREMBLES = "the ball no longer hits and only trembles at the rolling threshold"
    DIED_OUT = "the vibration died out while the ball still moved"
    CYCLES_DONE = "the requested number of cycles was completed"
    CYCLE_CAP = "the cap on cycles was reached while the ball still moved"
    EVENT_CAP = "the cap on events was reached while the ball still moved"


Value = TypeVar("Value", float, Floats)


@dataclass(frozen=True)
class EnergyBooks(Generic[Value]):
    """Where the energy went [J], of one ring-down or of each of many.

    ``initial`` and ``final`` are the energies of structure and ball; ``structure`` the work of the structure's own
    dashpot, ``rolling`` that of the rolling resistance, ``impact`` what wall hits and sticking took, ``slip`` what
    sliding on the floor took; ``work`` is what a harmonic force put in; ``residual`` is what the books do not explain.
    """

    initial: Value
    final: Value
    structure: Value
    rolling: Value
    impact: Value
    slip: Value
    work: Value

    @property
    def residual(self) -> Value:
        """Initial + work - final - all losses [J]; negative when energy appeared from nowhere."""
        return self.initial - self.final - self.structure - self.rolling - self.impact - self.slip + self.work


@dataclass(frozen=True, eq=False)
class RingDown(Counts[int]):
    """What a ring-down left, with the counters of `damper.state.Counts`.

    Attributes:
        damper: the damper simulated.
        outcome: why it ended.
        duration: simulated time [s].
        peak_times: times of the structure's velocity maxima, one per vibration cycle, or per cycle of what drives it,
            shape (n + 1,) [s]; none in a run that ends within the first half of one.
        peak_velocities: v = sqrt(v_x^2 + v_y^2) there, shape (n + 1,) [m/s]; where modes of different frequencies
            vibrate, sqrt(2 E / (M + m_p)) of the energy E of all, the ball counted as stuck.
        last_motion: last time at which the ball moved in its cavity [s]; None if it never did.
        rested: whether the ball came to rest for good, or only trembles.
        energy: the books.
        largest_rolling_demand: largest force that rolling asked of the floor over the normal load [-], per axis;
            None without a normal load. Rolling is tenable where the static friction exceeds it.
        rows: the event table (dtype `damper.state.EVENT`), None unless asked for.
        harmonic: what drove it.
        states: coordinates and their velocities at each event, shape (n, 2, N), None unless asked for; N is 0 where
            each axis has one mode, whose motion stands in `rows`.
        modal_energies: kinetic and elastic energy of each of the damper's modes at the end, without the ball's part,
            shape (k,) [J]; None without modes.
    """

    damper: ParticleDamper
    outcome: Outcome
    duration: float
    peak_times: Floats
    peak_velocities: Floats
    last_motion: float | None
    rested: bool
    energy: EnergyBooks[float]
    largest_rolling_demand: float | None
    rows: Records | None = None
    harmonic: Harmonic | None = None
    states: Floats | None = None
    modal_energies: Floats | None = None


def outcome_of(done: bool, fixed_cycles: bool, clock: np.void) -> Outcome:
    """Why a run ended that was done, or capped; `fixed_cycles` for a number of cycles or not."""
    if not done:
        return Outcome.EVENT_CAP
    if fixed_cycles:
        return Outcome.CYCLES_DONE
    if not math.isfinite(clock["rest"]):
        return Outcome.CYCLE_CAP
    return (Outcome.AT_REST, Outcome.TREMBLES, Outcome.DIED_OUT)[int(clock["trembles"])]


_CYCLES_AFTER_REST = 3

_LIGHT = 0.1
"""Decay rate over frequency up to which a structure's velocity peaks where it would without damping, nearly."""

_NOTHING = 36.0
"""Decay times after which nothing is left of a vibration: exp(-36) is rounding."""

_LARGEST = 1e150
"""Largest displacement, speed and acceleration at release [SI]: the square of a larger one may overflow."""


def prepare(
    rows: Parameters, start: Floats, cycles: float | None, max_cycles: float, harmonic: Harmonic | None = None
) -> Records:
    """Set up n ring-downs, dtype `damper.state.RUN`, from `start`, shape (n, 5, 2): u, v, s, w and spin along x and y.

    Raises:
        ValueError: a number is not finite, or its square is not; the number of cycles is not positive, or a ball is
            outside its cavity.
    """
    if harmonic is not None and cycles is None:
        raise ValueError("cycles must be given where a harmonic force drives the motion: it never comes to rest")
    if cycles is not None and not 0 < number("cycles", cycles) < math.inf:
        raise ValueError(f"cycles must be positive, got {cycles:g}")
    if not (math.isfinite(number("max_cycles", max_cycles)) or cycles is not None) or not max_cycles > 0:
        raise ValueError(f"max_cycles must be positive and finite, got {max_cycles:g}")
    if not np.isfinite(start).all():
        raise ValueError(f"the release must be finite, got {start[~np.isfinite(start)][0]}")
    _check_size(rows, start)
    runs = np.zeros(len(rows), RUN)
    axes, clocks, windows = runs["axes"], runs["clock"], runs["cycle"]
    axes["half_gap"] = half = half_gap(rows)
    for i, name in enumerate(("u", "v", "s", "w", "spin")):
        axes[name] = start[:, i]
    place: Floats = axes["s"]
    outside = abs(place) > half + 1e-12 * rows["ball_radius"][:, None]
    if outside.any():
        raise ValueError(f"ball_position {place[outside][0]:g} m lies outside the cavity")
    axes["s"] = np.clip(place, -half, half)

    omega = stuck_frequency(rows)
    period = 2 * np.pi / omega
    size = np.abs(start).max(axis=2)
    reach = np.maximum(size[:, 0], np.maximum(size[:, 1], size[:, 3]) / omega)
    clocks["end"] = period * (max_cycles if cycles is None else cycles)
    clocks["rest"], clocks["last_motion"] = np.inf, -np.inf
    windows["period"], windows["wait"], windows["closes"] = period, _waits(rows, period), 0.5 * period
    clocks["tail"] = np.maximum(_CYCLES_AFTER_REST * period, windows["wait"] + period) if cycles is None else np.inf
    windows["waiting_since"] = -np.inf
    for name in ("speed", "square", "last_speed", "moving_speed", "waiting_speed"):
        windows[name] = -1.0
    runs["ball"] = balls_of(rows, reach)
    return runs


def _waits(rows: Parameters, period: Floats) -> Floats:
    """Times [s], shape (n,), from a velocity maximum of free vibration to the zero before the one a period later.

    At most until nothing is left of the vibration; 3/4 of the period where damping is light.
    """
    decay, frequency = stuck_decay(rows)
    zero = (2 * np.pi - np.arctan2(frequency, decay)) / frequency
    light = decay <= _LIGHT * frequency
    return np.where(light, 0.75 * period, np.minimum(zero, _NOTHING / np.where(light, 1.0, decay)))


def _check_size(rows: Parameters, start: Floats) -> None:
    """Raise ValueError where squares of the motion from `start` overflow, which kernels do not notice."""
    length, speed = np.abs(start[:, [0, 2]]).max(axis=(1, 2)), np.abs(start[:, [1, 3, 4]]).max(axis=(1, 2))
    with np.errstate(over="ignore", invalid="ignore"):
        omega = np.sqrt(rows["stiffness"].max(axis=1) / rows["modal_mass"])
        small = (
            (length < _LARGEST) & (speed + omega * length < _LARGEST) & (omega * (speed + omega * length) < _LARGEST)
        )
    if not small.all():
        raise ValueError(
            f"the release, or what moves from it, is too large: expected less than {_LARGEST:g} in SI units"
        )
