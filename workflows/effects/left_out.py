"""What an effect that is left out would move, for the estimate of the whole error."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LeftOut:
    """Relative shifts (k, count), without sign, of the modes at speeds omega (k,) in rad/s, ascending."""

    omega: Floats = field(repr=False)
    shifts: Floats = field(repr=False)

    def at(self, omega: float, count: int) -> Floats:
        """Shifts (count,) at a speed in rad/s: nothing at rest, and between speeds linear in its square."""
        square = np.concatenate([[0.0], self.omega**2]) if self.omega[0] > 0.0 else self.omega**2
        rows = np.vstack([np.zeros(self.shifts.shape[1]), self.shifts]) if self.omega[0] > 0.0 else self.shifts
        found = np.array([np.interp(omega**2, square, column) for column in rows.T])
        beyond = np.full(max(count - found.size, 0), found.max(initial=0.0))
        shifts: Floats = np.concatenate([found, beyond])[:count]
        return shifts

    @property
    def largest(self) -> float:
        """The largest shift."""
        return float(self.shifts.max())


class Called(NamedTuple):
    """Whether a scene calls for an effect, why (not), and what leaving it out would move, where that is known."""

    called: bool
    why: str
    moves: LeftOut | None = None


def everywhere(omega: float, shift: float, count: int) -> LeftOut:
    """The same shift of all modes at a speed in rad/s."""
    return LeftOut(np.array([omega]), np.full((1, count), shift))
