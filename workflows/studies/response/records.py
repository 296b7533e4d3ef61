"""What a forced response hands on: frozen records, SI inside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from workflows.results.crossings import Crossing
from workflows.scene.excitation import Excitation
from workflows.solve.records import Floats, Results

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
