"""Modes of a stiffness from modes of a similar one, whose factor serves in place of its own.

The basis of the known modes takes in the residuals, solved for with the known factor, until these are small. Source:
Davidson, J. Comput. Phys. 17 (1975) 87.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.linalg.lanczos import orthonormal

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.linalg.lanczos import Factor

    Array = NDArray[np.float64]

REFINED = 1e-13
"""Relative energy of a refined mode's error, which is the relative error of its eigenvalue."""

STEPS = 30
"""Steps after which a refined mode is taken to be as good as rounding allows."""

ROUNDS = 10
"""Rounds after which a factor of the stiffness's own is the better way: the known modes are not similar."""


def lowest_modes(
    stiffness: csc_array, mass: csc_array, start: Array, factor: Factor, tolerance: float
) -> tuple[Array, Array] | None:
    """Find the lowest eigenpairs of (stiffness, mass) that vectors (n, k) to start from lead to, as many as these.

    Modes of which the start has no part, for their symmetry, are not found. factor: of a similar stiffness.
    tolerance: relative, of eigenvalues, by the energy of the error to first order. Returns eigenvalues (k,), ascending,
    and mass-normalised vectors (n, k), or None where they do not settle.
    """
    count = start.shape[1]
    empty = np.empty((start.shape[0], 0))
    basis, image, _, _ = orthonormal(start, empty, empty, mass)
    pushed = stiffness @ basis
    for _ in range(ROUNDS):
        reduced = basis.T @ pushed
        values, vectors = np.linalg.eigh(0.5 * (reduced + reduced.T))
        values, vectors = values[:count], vectors[:, :count]
        residual = pushed @ vectors - (image @ vectors) * values
        step = factor.solve(residual)
        far = np.abs(np.einsum("nk,nk->k", residual, step)) > tolerance * np.abs(values)
        if values.size == count and not far.any():
            return values, basis @ vectors
        block, heavy, _, _ = orthonormal(step[:, far], basis, image, mass)
        basis, image = np.hstack([basis, block]), np.hstack([image, heavy])
        pushed = np.hstack([pushed, stiffness @ block])
    return None


def refine(
    stiffness: csc_array, mass: csc_array, start: Array, target: int, factor: Factor, measure: csc_array
) -> tuple[float, Array]:
    """Find the eigenpair of (stiffness, mass) most like one column of start, by Davidson's method.

    start: (n, k) vectors to begin with. factor: of the stiffness. measure: the mass (n, n) in which likeness is
    taken. Returns the eigenvalue and the vector (n,), mass-normalised.
    """
    wanted = measure @ start[:, target]
    empty = np.empty((start.shape[0], 0))
    basis, image, _, _ = orthonormal(start, empty, empty, mass)
    for _ in range(STEPS):
        reduced = basis.T @ (stiffness @ basis)
        values, vectors = np.linalg.eigh(0.5 * (reduced + reduced.T))
        pick = most_alike(wanted @ basis, basis.T @ (measure @ basis), vectors)
        value, shape = float(values[pick]), basis @ vectors[:, pick]
        residual = stiffness @ shape - value * (mass @ shape)
        step = factor.solve(residual)
        # The step is the shape's error to first order; its energy is that of the eigenvalue.
        if abs(residual @ step) <= REFINED * abs(value):
            break
        block, heavy, _, _ = orthonormal(step[:, None], basis, image, mass)
        basis, image = np.hstack([basis, block]), np.hstack([image, heavy])
    return value, shape


def most_alike(wanted: Array, measure: Array, vectors: Array) -> int:
    """Which of some vectors (r, k) is most like another, whose product with the measure (r, r) is wanted (r,)."""
    lengths = np.einsum("rk,rs,sk->k", vectors, measure, vectors)
    return int(np.argmax(np.abs(wanted @ vectors) / np.sqrt(np.maximum(lengths, np.finfo(float).tiny))))
