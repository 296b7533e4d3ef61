"""What Coriolis forces would do to the modes of a plate found without them.

Two modes of rates a and b, coupled by g = phi_a' G phi_b, have together the rates w of
    (w² - a²) (w² - b²) = (Omega g w)²,
far from one another a shift of second order in Omega, where they nearly coincide one of first order, Omega g / 2. Modes
beyond those found take part by their static answer to the Coriolis forces of these. On a coarse mesh rates are off by
more than modes may be apart: the shift is the largest that their distance, as uncertain as it is, allows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fem.linalg.lanczos import orthonormal
from fem.modes.real import Divergence, solve_real
from fem.operators.assembly import assemble
from fem.statics.large_deflection import NoEquilibrium
from fem.statics.linearised import linearise

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.operators.assembly import Operators
    from fem.plate.given import Plate
    from fem.plate.rotor import Effects, Rotor

    Array = NDArray[np.float64]

BEYOND = 4
"""Modes beyond those asked for that are found as well."""

UNCERTAIN = 0.01
"""Relative error of a rate on a coarse mesh."""

SAMPLES = 4
"""Speeds at which a large deflection is solved for; between them its stiffness is a polynomial in Omega²."""

ENOUGH = 1e-6
"""Residual of the modes."""


@dataclass(frozen=True, eq=False)
class Turned:
    """Shifts (k, count), relative and without sign, that Coriolis forces cause at speeds omega (k,) in rad/s."""

    omega: Array
    shifts: Array

    @property
    def largest(self) -> tuple[float, float]:
        """The largest shift, and its speed in rad/s."""
        row = int(self.shifts.max(axis=1).argmax())
        return float(self.shifts[row].max()), float(self.omega[row])


def turned(
    plate: Plate, rotor: Rotor, effects: Effects, speeds: tuple[float, ...], count: int, theory: str = "mindlin"
) -> Turned | None:
    """Find by how much Coriolis forces would move the count lowest modes at speeds in rad/s.

    None where the plate has no modes at any of them. A coarse mesh will do, on which rates are good to `UNCERTAIN`.

    Raises:
        ValueError: as `solve_modes` does.
        Unresolved: the plate is too thin for its theory in double precision.
    """
    operators = assemble(plate, rotor, replace(effects, coriolis=True), theory)
    gyroscopic = operators.gyroscopic
    assert gyroscopic is not None
    asked = np.unique(np.asarray(speeds, dtype=float))
    samples = _samples(operators, gyroscopic, asked, count + BEYOND)
    if not samples:
        return None
    basis = np.hstack([vectors for _, _, vectors in samples])
    empty = np.empty((len(basis), 0))
    basis = orthonormal(basis, empty, empty, operators.mass)[0]
    stiffness = [basis.T @ (matrix @ basis) for _, matrix, _ in samples]
    known = np.array([omega for omega, _, _ in samples])
    asked = asked[asked <= known.max()] if operators.effects.large_deflection else asked
    small = np.tensordot(_lagrange(known**2, asked**2), np.array(stiffness), 1)
    turning = basis.T @ (gyroscopic @ basis)
    squares, vectors = np.linalg.eigh(0.5 * (small + small.transpose(0, 2, 1)))
    alive = squares[:, 0] > 0.0
    if not alive.any():
        return None
    coupled = np.swapaxes(vectors[alive], 1, 2) @ turning @ vectors[alive]
    force = (asked[alive, None, None] * coupled) ** 2
    return Turned(asked[alive], _shifts(squares[alive], force)[:, :count])


def _samples(
    operators: Operators, gyroscopic: csc_array, asked: Array, count: int
) -> list[tuple[float, csc_array, Array]]:
    """Speeds that have modes, the stiffness there, and the modes with what answers their Coriolis forces.

    A linear prestress is known everywhere from two speeds, at which there need be no modes but at the lower.
    """
    found: list[tuple[float, csc_array, Array]] = []
    large = operators.effects.large_deflection
    tried = np.linspace(asked[0] ** 2, asked[-1] ** 2, SAMPLES if large else 2) ** 0.5
    state = None
    for omega in np.unique(np.where(asked[-1] > asked[0], tried, asked[-1])):
        try:
            stiffness, state = linearise(operators, float(omega), state)
            modes = solve_real(operators, float(omega), stiffness, count, tolerance=ENOUGH)
        except (Divergence, NoEquilibrium):
            if large or not found:
                break
            found.append((float(omega), operators.at(float(omega)), found[0][2][:, :0]))
            break
        answers = modes.factor.solve(gyroscopic @ modes.shapes)
        found.append((float(omega), stiffness, np.hstack([modes.shapes, answers])))
    return found


def _lagrange(known: Array, asked: Array) -> Array:
    """Weights (k, n) of values at n known places in the polynomial through them at k places."""
    weights = np.ones((asked.size, known.size))
    for i, at in enumerate(known):
        for other in np.delete(known, i):
            weights[:, i] *= (asked - other) / (at - other)
    return weights


def _shifts(squares: Array, force: Array) -> Array:
    """Sums (k, m) over its partners of the largest shift of each mode of squared rates (k, m).

    force: (Omega g)², (k, m, m).
    """
    own, partner = np.broadcast_arrays(squares[:, :, None], squares[:, None, :])
    ratio = partner / own
    near = np.where(
        ratio < 1.0, np.minimum(ratio * (1.0 + 2.0 * UNCERTAIN), 1.0), np.maximum(ratio * (1.0 - 2.0 * UNCERTAIN), 1.0)
    )
    force = force / own
    middle, split = 0.5 * (1.0 + near + force), np.sqrt(np.maximum((1.0 + near + force) ** 2 / 4.0 - near, 0.0))
    moved = np.where(near < 1.0, middle + split, middle - split)
    moved = np.maximum(
        np.abs(np.sqrt(np.maximum(moved, 0.0)) - 1.0), np.where(near == 1.0, np.sqrt(middle + split) - 1.0, 0.0)
    )
    return np.asarray(np.where(force > 0.0, moved, 0.0).sum(axis=2))
