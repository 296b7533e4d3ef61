"""The small eigenproblems of a reduced basis, at many speeds at once.

They are solved for 1/w² or 1/w, whose largest, the lowest frequencies, then come with all their digits. In the
axes of K_1 the small stiffness is diagonal, D^-2, and x = D p turns K x = w² M x into D M D p = p / w². With
Coriolis forces, M = R'R and the velocities R w x beside p, the problem is Hermitian too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.sweep.reduced_basis import ReducedBasis

    Array = NDArray[np.float64]

LEAST = float(np.finfo(float).eps)
"""What counts as no stiffness; a speed that leaves less has no lowest frequency."""


def still(basis: ReducedBasis, omega: Array, count: int) -> tuple[Array, Array]:
    """Frequencies (k, count) in rad/s and mass-normalised vectors (k, r, count), Coriolis forces apart."""
    soft = _softness(basis, omega)
    mass = basis.axes.T @ basis.mass @ basis.axes
    values, vectors = np.linalg.eigh(soft[:, :, None] * mass * soft[:, None, :])
    rates = _inverse(values[:, : -count - 1 : -1]) ** 0.5
    return rates, _turned(basis, soft[:, :, None] * vectors[:, :, : -count - 1 : -1] * rates[:, None, :])


def turning(basis: ReducedBasis, coriolis: Array, omega: Array, count: int) -> tuple[Array, NDArray[Any]]:
    """Frequencies (k, count) in rad/s and mass-normalised complex vectors (k, r, count)."""
    r, soft = basis.size, _softness(basis, omega)
    squares, directions = np.linalg.eigh(basis.axes.T @ basis.mass @ basis.axes)
    root = np.sqrt(np.maximum(squares, 0.0))[:, None] * directions.T
    felt = soft[:, :, None] * (basis.axes.T @ coriolis @ basis.axes) * soft[:, None, :]
    state = np.zeros((omega.size, 2 * r, 2 * r), dtype=complex)
    state[:, :r, :r] = -1j * omega[:, None, None] * felt
    state[:, r:, :r] = root * soft[:, None, :]
    state[:, :r, r:] = state[:, r:, :r].transpose(0, 2, 1)
    values, vectors = np.linalg.eigh(state)
    rates, vectors = _inverse(values[:, : -count - 1 : -1]), vectors[:, :, : -count - 1 : -1]
    speeds = np.linalg.norm(vectors[:, r:], axis=1)
    return rates, _turned(basis, soft[:, :, None] * vectors[:, :r] * (rates / speeds)[:, None, :])


def _turned(basis: ReducedBasis, vectors: NDArray[Any]) -> NDArray[Any]:
    """Coordinates (k, r, q) in the basis of vectors given along the axes; one product, not k."""
    rows = vectors.transpose(0, 2, 1)
    return np.asarray((rows.reshape(-1, basis.size) @ basis.axes.T).reshape(rows.shape).transpose(0, 2, 1))


def _softness(basis: ReducedBasis, omega: Array) -> Array:
    """Roots (k, r) of the small stiffness's inverse, along the axes."""
    return np.asarray(np.maximum(basis.held(omega), LEAST) ** -0.5)


def _inverse(values: Array) -> Array:
    return np.asarray(1.0 / np.maximum(values, np.finfo(float).tiny))
