"""A solid blade as a structure known by its modes: what a damper on it needs, at any speed."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from fem.modal_model import ModalModel, ModesAtSpeed
from fem.solid.mesh_error import mesh_errors
from fem.solid.sweep import BladeSweep, sweep_blade

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from fem.solid.assembly import SolidOperators

    Array = NDArray[np.float64]

MORE = 5
"""Speeds that a range is swept by at least, so that what lies between is known with its error."""

KEPT = 64
"""Speeds of which the shapes are kept, for who asks again."""


class SolvedBlade:
    """A solid blade whose modes are solved over a range of speeds, which grows where speeds beyond are asked for.

    Attributes:
        operators: its matrices; sweep: what is solved so far.
        errors: estimated relative errors (count,) of frequencies by the mesh.
    """

    def __init__(
        self,
        operators: SolidOperators,
        speeds: Array,
        count: int,
        tolerance: float,
        progress: Callable[[int], None] | None = None,
    ) -> None:
        """Solve for the count lowest modes at speeds (k,) in rad/s; tolerance, progress: see `sweep_blade`.

        Raises:
            NoEquilibrium, Divergence: where the blade has no stable state at the highest speed.
        """
        self.operators, self.tolerance, self.progress = operators, tolerance, progress
        self.sweep: BladeSweep = sweep_blade(operators, speeds, count, tolerance=tolerance, progress=progress)
        ends = [(float(self.sweep.squares[k]) ** 0.5, self.sweep.states[k]) for k in (0, -1)]
        solved = [(*self.sweep.modes(omega), state) for omega, state in ends[: self.sweep.squares.size]]
        self.errors = np.max(
            [mesh_errors(operators, shapes, values, state) for values, shapes, state in solved], axis=0
        )
        self._at = lru_cache(KEPT)(self._solved)

    def model(self) -> ModalModel:
        """The blade with its modes at the lowest speed."""
        blade = self.operators.blade
        lowest = self.at(float(self.sweep.squares[0]) ** 0.5)
        mesh = blade.mesh
        return ModalModel(mesh.points, (lowest,), blade.axis, blade.origin, mesh.cells, mesh.sets)

    def at(self, omega: float) -> ModesAtSpeed:
        """Its modes at a speed in rad/s.

        Raises:
            NoEquilibrium, Divergence: where the blade has no stable state there.
        """
        self._reach(omega)
        return self._at(omega)

    def coriolis_shifts(self, omega: float) -> Array:
        """Relative shifts (count,) of frequencies by Coriolis forces, which the modes leave out."""
        self._reach(omega)
        return self.sweep.coriolis_shifts(omega)

    def _reach(self, omega: float) -> None:
        """Solve a range that holds a speed."""
        if self.sweep.covers(omega):
            return
        known = np.sqrt(np.append(self.sweep.squares, omega**2))
        speeds = np.linspace(known.min(), known.max(), MORE)
        count, tolerance = self.sweep.count, self.tolerance
        self.sweep = sweep_blade(self.operators, speeds, count, tolerance=tolerance, progress=self.progress)
        self._at.cache_clear()

    def _solved(self, omega: float) -> ModesAtSpeed:
        sweep, operators = self.sweep, self.operators
        values, shapes = sweep.modes(omega)
        moved = np.moveaxis(operators.spread(shapes), 2, 0)
        exact = np.isinf(sweep.errors).any()
        return ModesAtSpeed(
            omega=omega,
            frequencies_hz=np.sqrt(values) / (2.0 * np.pi),
            shapes=moved,
            static=operators.spread(sweep.state(omega)),
            errors=self.errors,
            interpolation=np.zeros(sweep.count) if exact else sweep.errors,
            drawn=np.einsum("kni,n->ki", moved, operators.masses),
            tracks=sweep.tracks(omega),
        )
