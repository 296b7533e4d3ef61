"""What a forced response hands on: frozen records, SI inside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from workflows.results.crossings import Crossing
from workflows.scene.scene import Excitation
from workflows.solve import limits
from workflows.solve.results import Floats, Results

if TYPE_CHECKING:
    import damper


@dataclass(frozen=True, eq=False, repr=False)
class Path:
    """The ball in its cavity over some cycles of a steady state: time (n,) [s], places (n, 2) [m]."""

    rpm: float
    force: float
    time: Floats
    structure: Floats
    ball: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Through:
    """Steady states through a crossing: s speeds, f forces, from each start.

    Attributes:
        crossing: where; axis: along which of the damper's axes the amplitude is.
        omega: (s,) [rad/s]; forces: (f,).
        states: of the damper, s * f points, the speeds one after the other.
        short: amplitude by the short way that is nearest to the mean, (s, f, starts) [m]; nan where it is not.
        least_force: from which on the ball cannot stay at rest, in the unit of the forces.
        figures: the damper's own, at the crossing; path: of the ball at the crossing under the largest force.
    """

    crossing: Crossing
    axis: int
    omega: Floats
    forces: tuple[float, ...]
    states: damper.Forced
    short: Floats
    least_force: float
    figures: damper.Working
    path: Path

    def shaped(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Values of the points as (s, f) or (s, f, starts)."""
        return values.reshape(len(self.omega), len(self.forces), *values.shape[1:])


@dataclass(frozen=True, eq=False, repr=False)
class Response:
    """All that a forced response found.

    Attributes:
        results: the structure over the whole range of speeds, as of a run.
        passed: crossings that were followed; idle: the others, each with the reason.
        strain_per_amplitude: at the root in the first bending mode [1/m]; None where it is not known.
    """

    results: Results
    excitation: Excitation
    passed: tuple[Through, ...]
    idle: tuple[tuple[Crossing, str], ...]
    strain_per_amplitude: float | None


def peak(found: Through, force: int) -> tuple[int, int]:
    """Speed and start at which the mean amplitude under a force is largest, whatever the start."""
    means = np.nan_to_num(found.shaped(found.states.mean)[:, force])  # nan where a ball has no end of hits
    speed, start = np.unravel_index(int(np.argmax(means)), means.shape)
    return int(speed), int(start)


HELPS = 0.99
"""Amplitude over that without the ball up to which the ball is said to help: less is next to nothing."""


@dataclass(frozen=True)
class Row:
    """A crossing under one force, at the speed and from the start at which the mean amplitude is largest.

    Attributes:
        without: largest amplitude without the ball, whatever the speed [m]; the same in each of the others.
        least, mean, rms, greatest: of the cycles' amplitudes; error: of the mean [m].
        smallest: mean at the same speed from the start from which it is smallest [m].
        stress_without, stress_with: at the root [Pa], None where it is not known.
        short, difference: amplitude by the short way, and over the mean less 1; None where it does not speak of this.
    """

    through: Through
    force: float
    rpm: float
    frequency: float
    without: float
    least: float
    mean: float
    rms: float
    greatest: float
    error: float
    smallest: float
    regime: str
    hits_per_cycle: float
    power_in: float
    power_lost: float
    short: float | None
    stress_without: float | None
    stress_with: float | None

    @property
    def ratio(self) -> float:
        """Mean amplitude with the ball over the one without."""
        return self.mean / self.without

    @property
    def difference(self) -> float | None:
        """The short way's amplitude over the true one, less 1."""
        return None if self.short is None else self.short / self.mean - 1


def rows(found: Response) -> list[Row]:
    """All crossings under all forces."""
    return [_row(found, through, k) for through in found.passed for k in range(len(through.forces))]


def _row(found: Response, through: Through, force: int) -> Row:
    speed, start = peak(through, force)
    states = through.states

    def at(name: str) -> float:
        return float(through.shaped(getattr(states, name))[speed, force, start])

    without = float(np.abs(through.shaped(states.without))[:, force].max())
    short = float(through.short[speed, force, start])
    stress = root_stress(found, through)
    return Row(
        through=through,
        force=through.forces[force],
        rpm=float(through.omega[speed]) * 30 / np.pi,
        frequency=through.crossing.order * float(through.omega[speed]) / (2 * np.pi),
        without=without,
        **{name: at(name) for name in ("least", "mean", "rms", "greatest", "error")},
        smallest=float(through.shaped(states.mean)[speed, force].min()),
        regime=str(through.shaped(states.regime)[speed, force, start]),
        hits_per_cycle=at("hits_per_cycle"),
        power_in=at("power_in"),
        power_lost=at("power_lost"),
        short=short if np.isfinite(short) else None,
        stress_without=None if stress is None else stress * without,
        stress_with=None if stress is None else stress * at("greatest"),
    )


def root_stress(found: Response, through: Through) -> float | None:
    """At the root per amplitude at the cavity, in the first bending mode [Pa/m]."""
    material, strain = found.results.scene.material, found.strain_per_amplitude
    if material is None or strain is None or through.crossing.family != "flap" or through.crossing.branch != 0:
        return None
    return material.youngs_modulus * strain


def endured(found: Response, through: Through) -> float | None:
    """Amplitude at the cavity that the root endures [m]; None where it is not known."""
    return None if root_stress(found, through) is None else limits.endured(found.results)


def is_beyond(found: Response, row: Row) -> bool:
    """Whether the plate endures neither the amplitude of a row nor, at any amplitude, its speed."""
    limit = endured(found, row.through)
    torn = (limits.root_stress(found.results, row.through.crossing.omega) or 0.0) > limits.STRONGEST
    return torn or (limit is not None and row.greatest > limit)
