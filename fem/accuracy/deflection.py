"""What a plate's static state does to its frequencies beyond the stiffening that is linear in Omega²."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fem.modes.real import Divergence, solve_real
from fem.modes.solve import solve_modes
from fem.operators.assembly import assemble
from fem.statics.large_deflection import NoEquilibrium, settle, tangent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.operators.assembly import Operators
    from fem.plate.given import Plate
    from fem.plate.rotor import Effects, Rotor

    Array = NDArray[np.float64]

ENOUGH = 1e-8
"""Energy of Newton's last step and residual of the modes, relatively: far below any change worth knowing."""


@dataclass(frozen=True, eq=False)
class Bent:
    """The static state at a speed omega (rad/s), and what it does.

    Attributes:
        rotation: the largest of a point of the plate, in rad.
        strain: the largest principal one of the mid-surface.
        shifts: (count,) relative differences between frequencies about the state and those with the stiffening of the
            flat plate, infinite where only one of the two has modes.
    """

    omega: float
    rotation: float
    strain: float
    shifts: Array

    @property
    def shift(self) -> float:
        """The largest of the shifts."""
        return float(self.shifts.max())


def bent(plate: Plate, rotor: Rotor, effects: Effects, speeds: tuple[float, ...], count: int) -> Bent | None:
    """Find what the static state does to the count lowest modes at the highest of some speeds (rad/s).

    Where the plate diverges there, at a lower one; None where it does at all that are tried. In Mindlin's theory and
    without Coriolis forces. The shift is a difference on one mesh, for which a coarse one will do.

    Raises:
        ValueError: as `solve_modes` does and for effects without stress stiffening.
        Unresolved: the plate is too thin for its theory in double precision.
    """
    large = assemble(plate, rotor, replace(effects, coriolis=False, large_deflection=True))
    flat = replace(large, effects=replace(large.effects, large_deflection=False))
    ascending = sorted(set(speeds))
    found = _at(flat, large, ascending.pop(), count)
    while found is None and ascending:  # past the critical speed
        middle = len(ascending) // 2
        found = _at(flat, large, ascending[middle], count)
        ascending = ascending[:middle]
    return found


def _at(flat: Operators, large: Operators, omega: float, count: int) -> Bent | None:
    before, (state, after) = _flat(flat, omega, count), _about(large, omega, count)
    if before is None and after is None:
        return None
    if before is None or after is None:
        return Bent(omega, *_size(large, state), np.full(count, np.inf))
    return Bent(omega, *_size(large, state), np.abs(np.sqrt(after / before) - 1.0))


def _flat(operators: Operators, omega: float, count: int) -> Array | None:
    try:
        return solve_modes(operators, omega, count).eigenvalues
    except Divergence:
        return None


def _about(operators: Operators, omega: float, count: int) -> tuple[Array | None, Array | None]:
    try:
        state = settle(operators, omega, converged=ENOUGH)[0]
    except NoEquilibrium:
        return None, None
    try:
        return state, solve_real(
            operators, omega, tangent(operators, omega, state), count, tolerance=ENOUGH
        ).eigenvalues
    except Divergence:
        return state, None


def _size(operators: Operators, state: Array | None) -> tuple[float, float]:
    """Largest rotation in rad, in the plane or out of it, and largest strain of the mid-surface (Green's)."""
    if state is None:
        return np.nan, np.nan
    stretched = operators.model.gradient.evaluate(state)[:6].reshape(3, 2, -1)
    stretched[:2] += np.eye(2)[:, :, None]
    strain = 0.5 * (np.einsum("kan,kbn->abn", stretched, stretched) - np.eye(2)[:, :, None])
    within = np.arctan2(stretched[1, 0] - stretched[0, 1], stretched[0, 0] + stretched[1, 1])
    out = np.arctan(np.linalg.norm(stretched[2], axis=0))
    return float(max(np.abs(within).max(), out.max())), float(np.abs(np.linalg.eigvalsh(strain.T)).max())
