"""Sparse symmetric factors, and the lowest modes by shift-inverted block Lanczos.

The Lanczos basis is kept orthonormal in the mass (twice-repeated Gram-Schmidt), so no mode is found twice;
blocks of vectors find double eigenvalues, which a square plate has. Sources: Ericsson and Ruhe, Math. Comp.
35 (1980) 1251; Grimes, Lewis and Simon, SIAM J. Matrix Anal. Appl. 15 (1994) 228. `refine` takes one mode further by
Davidson's method; `rounding` estimates what double precision leaves uncertain. Knows no plate; imports nothing of fem.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csc_array, csr_array

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

BLOCK = 4
"""Vectors in a Lanczos block: eigenvalues up to this multiplicity are found whole."""

SEED = 0
"""Of the vectors that Krylov spaces start from."""

CONVERGED = 1e-11
"""Residual of a mode relative to its own inverse eigenvalue."""

SETTLED = (1e-8, 1e-12)
"""Residual at which one that no longer falls is rounding, relative to its eigenvalue and to the largest; the
eigenvalue is then off by no more."""

PATIENCE = 6
"""Blocks in which a residual must halve, or it no longer falls."""

LARGEST = (200, 10)
"""Vectors at which a basis counts as too large: so many, and so many more for each mode."""

LARGE = 1e7
"""Numbers in a factor from which on it is too large for a second copy of it."""

GLANCE = 0.05
"""Residual with which their sign is known."""

NULL = 1e-24
"""Squared weight of a unit direction that counts as nothing."""

ROUNDING = 16.0 * float(np.finfo(float).eps)
"""Error of a quadratic form relative to the root of its terms' sum of squares: rounding is random."""


class NotConverged(FloatingPointError):
    """Lanczos's method did not find the modes within the basis that it is allowed."""


class SingularMatrix(ArithmeticError):
    """A matrix that, to rounding, has no inverse."""


@dataclass(frozen=True, eq=False)
class Factor:
    """A sparse LU factor with a symmetric ordering and pivots on the diagonal."""

    lu: Any

    def solve(self, right: Array) -> Array:
        """Solution for one (n,) or several (n, k) right-hand sides."""
        return np.asarray(self.lu.solve(right))

    @cached_property
    def negative_pivots(self) -> int | None:
        """How many negative eigenvalues the matrix has: as many as negative pivots (Sylvester).

        None of a large factor, of which SuperLU gives its pivots with a copy of the whole.
        """
        return int(np.count_nonzero(self.lu.U.diagonal() < 0.0)) if self.lu.nnz <= LARGE else None

    @cached_property
    def negative(self) -> int:
        """The same; of a large factor those that are among the inverse's largest, as they are at first."""
        if self.negative_pivots is not None:
            return self.negative_pivots
        from scipy.sparse import eye_array

        n = self.lu.shape[0]
        one = eye_array(n, format="csc")
        eigenvalues, _ = krylov(
            lambda _, heavy: self.solve(heavy), one, random_block(n), BLOCK, np.abs, tolerance=GLANCE
        )
        return int(np.count_nonzero(eigenvalues < 0.0))


@dataclass(frozen=True, eq=False)
class PardisoFactor(Factor):
    """A symmetric indefinite factor L D L' of Intel's PARDISO, through pypardiso.

    upper: the matrix's upper triangle, by rows.
    """

    upper: csr_array

    def solve(self, right: Array) -> Array:
        """Solution for one (n,) or several (n, k) right-hand sides."""
        self.lu.set_phase(33)
        return np.asarray(self.lu._call_pardiso(self.upper, np.asfortranarray(right)))

    @cached_property
    def negative_pivots(self) -> int:
        """How many negative eigenvalues the matrix has."""
        return int(self.lu.get_iparm(23))


def has_pardiso() -> bool:
    """Whether pypardiso is installed, with which matrices whose order is given are factorised."""
    return find_spec("pypardiso") is not None


PARDISO = {1: 1, 2: 2, 5: 1, 10: 13, 18: -1, 21: 1, 24: 1}
"""Parameters (`iparm`, from 1): no defaults, the order given, pivots perturbed from 1e-13 on, Bunch and Kaufman's."""


def _pardiso(matrix: csc_array) -> PardisoFactor:
    """Factor of a symmetric matrix in the order of its unknowns."""
    from pypardiso import PyPardisoSolver
    from pypardiso.pardiso_wrapper import PyPardisoError
    from scipy.sparse import csr_array, triu

    upper = csr_array(triu(matrix, format="csr"))
    lu = PyPardisoSolver(mtype=-2)
    lu.iparm[[number - 1 for number in PARDISO]] = list(PARDISO.values())
    lu.perm = np.arange(1, upper.shape[0] + 1, dtype=np.int32)
    lu.set_phase(12)
    try:
        lu._call_pardiso(upper, np.zeros((upper.shape[0], 1)))
    except PyPardisoError as error:
        raise SingularMatrix(str(error)) from None
    factor = PardisoFactor(lu, upper)
    weakref.finalize(factor, lu.free_memory, everything=True)
    return factor


INNER = 30
"""Steps of conjugate gradients after which a factor of the matrix's own is cheaper."""

SOLVED = 1e-7
"""Residual of conjugate gradients relative to that of nothing, in the norm of the inverse."""


@dataclass(eq=False)
class Nearby:
    """Solves with a symmetric matrix by conjugate gradients, preconditioned with the factor of a similar one.

    Directions along which the matrix is not positive are noticed on the way, and then counted in `negative`. Where the
    two are not similar enough, `own` makes a factor.
    """

    matrix: csc_array
    similar: Factor
    own: Callable[[csc_array], Factor]
    negative: int = 0
    exact: Factor | None = None

    def solve(self, right: Array) -> Array:
        """Solution for one (n,) or several (n, k) right-hand sides."""
        if self.exact is not None:
            return self.exact.solve(right)
        if right.ndim == 2:
            return np.column_stack([self.solve(column) for column in right.T])
        state, residual = np.zeros_like(right), right
        nearly = self.similar.solve(residual)
        along, size = nearly, float(residual @ nearly)
        first = size
        for _ in range(INNER):
            if size <= SOLVED**2 * first:
                return state
            pushed = self.matrix @ along
            curved = float(along @ pushed)
            if curved <= 0.0:
                self.negative = 1
                return state if state.any() else along
            step = size / curved
            state, residual = state + step * along, residual - step * pushed
            nearly = self.similar.solve(residual)
            before, size = size, float(residual @ nearly)
            along = nearly + size / before * along
        self.exact = self.own(self.matrix)
        self.negative = self.exact.negative
        return self.exact.solve(right)


Solver = Factor | Nearby
"""What solves with a symmetric matrix, and knows then how many of its eigenvalues are negative."""


def factorise(matrix: csc_array, ordered: bool = False) -> Factor:
    """Factor of a symmetric matrix, (n, n).

    ordered: its unknowns are in an order that leaves the factor thin; PARDISO then makes it, where it is installed.

    Raises:
        SingularMatrix: it is singular.
    """
    if ordered and has_pardiso():
        return _pardiso(matrix)
    from scipy.sparse.linalg import splu

    options = {"SymmetricMode": True}
    try:
        # relax=1: relaxed supernodes make some triangles' factors seven times dearer, none cheaper
        order: Literal["NATURAL", "MMD_AT_PLUS_A"] = "NATURAL" if ordered else "MMD_AT_PLUS_A"
        return Factor(splu(matrix, permc_spec=order, diag_pivot_thresh=0.0, relax=1, options=options))
    except RuntimeError as error:  # SuperLU: "Factor is exactly singular"
        if "singular" not in str(error):
            raise
        raise SingularMatrix(str(error)) from None


def less(matrix: csc_array, factor: float, other: csc_array) -> csc_array:
    """A matrix less a multiple of another; fast where they share the arrays of their pattern.

    Args:
        matrix: shape (n, n).
        factor: of the other.
        other: shape (n, n).
    """
    from scipy.sparse import csc_array as sparse

    if not np.shares_memory(matrix.indices, other.indices):
        return sparse(matrix - factor * other)
    return sparse((matrix.data - factor * other.data, matrix.indices, matrix.indptr), shape=matrix.shape)


def lanczos(factor: Factor, mass: csc_array, count: int, tolerance: float = CONVERGED) -> tuple[Array, Array]:
    """The eigenvalues nearest zero of K x = lambda M x, by shift-inverted block Lanczos.

    Args:
        factor: of K.
        mass: M, shape (n, n).
        count: of eigenvalues.
        tolerance: relative, on residuals in 1/lambda.

    Returns:
        Eigenvalues (count,) of either sign, ordered by magnitude, and mass-normalised vectors (n, count).

    Raises:
        NotConverged: the iteration does not converge.
    """
    start = factor.solve(mass @ random_block(mass.shape[0]))
    inverse, vectors = krylov(lambda _, heavy: factor.solve(heavy), mass, start, count, np.abs, tolerance=tolerance)
    return 1.0 / inverse, vectors


def random_block(n: int) -> Array:
    """Vectors (n, BLOCK) to start a Krylov space from, the same in every run."""
    return np.random.default_rng(SEED).standard_normal((n, min(BLOCK, n)))


def krylov(
    apply: Callable[[Array, Array], Array],
    weight: csc_array,
    start: Array,
    count: int,
    rank: Callable[[Array], Array],
    tolerance: float = CONVERGED,
) -> tuple[Array, Array]:
    """Extreme eigenvalues of an operator that is self-adjoint in a weight, by block Lanczos.

    Args:
        apply: the operator on a block (n, k), given the block and its product with the weight.
        weight: shape (n, n).
        start: block to begin with, shape (n, b).
        count: of eigenvalues.
        rank: how much each eigenvalue is wanted.
        tolerance: on residuals relative to their eigenvalues. Where rounding forbids it, as with small eigenvalues next
            to a huge one, they are as good as rounding allows.

    Returns:
        Eigenvalues (count,), the most wanted first, and vectors (n, count) normalised in the weight.

    Raises:
        NotConverged: the iteration does not converge.
    """
    n = start.shape[0]
    basis = image = np.empty((n, 0), order="F")
    projected = np.empty((0, 0))
    block, heavy, _, _ = orthonormal(start, weight)
    best, waited = np.inf, 0
    while True:
        basis, image = _append(basis, block), _append(image, heavy)
        block, heavy, column, coupling = orthonormal(apply(block, heavy), weight, basis, image)
        m, b = column.shape
        projected = np.pad(projected, ((0, b), (0, b)))
        projected[m - b :] = column.T
        projected[:, m - b :] = column
        values, vectors = np.linalg.eigh(symmetric(projected))
        order = np.argsort(-rank(values))[:count]
        residual = np.linalg.norm(coupling @ vectors[m - b :, order], axis=0)
        size = np.maximum(np.abs(values[order]), np.finfo(float).tiny)
        worst = float((residual / size).max()) if order.size == count else np.inf
        best, waited = (worst, 0) if worst < 0.5 * best else (best, waited + 1)
        rounded = bool((residual <= np.maximum(SETTLED[0] * size, SETTLED[1] * np.abs(values).max())).all())
        settled = rounded and order.size == count and waited >= PATIENCE
        if worst <= tolerance or settled or block.shape[1] == 0 or m >= n:
            return values[order], basis @ vectors[:, order]
        if m >= LARGEST[0] + LARGEST[1] * count:
            raise NotConverged(f"{m} Lanczos vectors leave a residual of {worst:.2g} in the {count} wanted modes")


def _append(columns: Array, more: Array) -> Array:
    return np.concatenate([columns.T, more.T]).T


def orthonormal(
    block: Array, weight: csc_array, basis: Array | None = None, image: Array | None = None
) -> tuple[Array, Array, Array, Array]:
    """Orthonormalise a block in a weight, and against a basis; directions without weight are dropped.

    Args:
        block: shape (n, b).
        weight: shape (n, n).
        basis: orthonormal in the weight, shape (n, m); None: there is none yet.
        image: weight @ basis, shape (n, m).

    Returns:
        Vectors (n, k), their image (n, k), column (m, b) and coupling (k, b), with block = basis @ column + vectors @
        coupling.
    """
    if basis is None or image is None:
        basis = image = np.empty((len(block), 0))
    column = image.T @ block
    vectors, coupling = block - basis @ column, np.eye(block.shape[1])
    for number, null in enumerate((NULL, NULL**0.5)):  # what was made a unit vector and is none was rounding
        again = image.T @ vectors
        vectors = vectors - basis @ again
        heavy = weight @ vectors
        gram = vectors.T @ heavy
        before = np.sqrt(np.maximum(gram.diagonal(), 0.0) + np.einsum("ij,ij->j", again, again))
        scale = np.where((before > 0.0) & (number == 0), before, 1.0)
        values, rotation = np.linalg.eigh(symmetric(gram) / scale / scale[:, None])
        keep = (values > null) & (np.arange(values.size)[::-1] < basis.shape[0] - basis.shape[1])
        root = np.sqrt(values[keep])
        column = column + again @ coupling
        coupling = (root[:, None] * rotation[:, keep].T * scale) @ coupling
        apart = rotation[:, keep] / root / scale[:, None]
        vectors, heavy = vectors @ apart, heavy @ apart
        if not keep.any() or values[0] > 0.1:
            break
    return vectors, heavy, column, coupling


def forms(matrices: Array, rows: NDArray[Any]) -> Array:
    """Quadratic forms of real symmetric matrices at vectors, complex or not.

    Args:
        matrices: shape (f, b, b).
        rows: the vectors, shape (k, q, b).

    Returns:
        Shape (f, k, q).
    """
    parts = (rows.real, rows.imag) if np.iscomplexobj(rows) else (rows,)
    flat = np.concatenate([each.reshape(-1, rows.shape[2]) for each in parts])
    values = np.stack([np.einsum("nb,nb->n", flat, flat @ matrix) for matrix in matrices])
    return np.asarray(values.reshape(len(matrices), len(parts), *rows.shape[:2]).sum(axis=1))


def quadratic_forms(matrix: csc_array, vectors: NDArray[Any]) -> Array:
    """Products x'Ax (k,) of real or complex vectors x (n, k) with themselves in a matrix A (n, n)."""
    return np.asarray(np.real((vectors.conj() * (matrix @ vectors)).sum(axis=0)))


def perpendicular(vectors: Array, unit: Array) -> Array:
    """What of vectors (..., 3) is perpendicular to a unit vector (3,)."""
    return np.asarray(vectors - (vectors @ unit)[..., None] * unit)


LEAST_ACROSS = np.radians(10.0)
"""Angle [rad] from a floor's normal from which on a direction gives axis 1: nearer, its rest across is chance."""


def axes_beside(normal: Array, direction: Array) -> tuple[Array, float]:
    """Axes (2, 3) beside a unit normal, the first as near to a direction as may be, and the angle between those two.

    Of a direction along the normal the axes are zero.
    """
    first = perpendicular(direction, normal)
    length = float(np.linalg.norm(first))
    first = first / (length or 1.0)
    return np.array([first, np.cross(first, normal)]), float(np.arctan2(length, abs(direction @ normal)))


def symmetric(matrices: NDArray[Any]) -> NDArray[Any]:
    """The symmetric parts of matrices (..., n, n)."""
    return np.asarray(0.5 * (matrices + matrices.swapaxes(-1, -2)))


def rounding(stiffness: csc_array, shapes: Array, eigenvalues: Array) -> Array:
    """What double precision leaves uncertain of frequencies, relatively.

    Args:
        stiffness: shape (n, n).
        shapes: mass-normalised, shape (n, k).
        eigenvalues: shape (k,).

    Returns:
        Shape (k,).
    """
    squares = stiffness.power(2) @ shapes**2
    return np.asarray(ROUNDING * np.sqrt(np.einsum("nk,nk->k", shapes**2, squares)) / eigenvalues)


REFINED = 1e-13
"""Relative energy of a refined mode's error, which is the relative error of its eigenvalue."""

STEPS = 30
"""Steps after which a refined mode is taken to be as good as rounding allows."""

ROUNDS = 10
"""Rounds after which a factor of the stiffness's own is the better way: the known modes are not similar."""


def lowest_modes(
    stiffness: csc_array, mass: csc_array, start: Array, factor: Solver, tolerance: float | Array
) -> tuple[Array, Array] | None:
    """The lowest eigenpairs that vectors to start from lead to, by a block Davidson iteration.

    Modes of which the start has no part, because of their symmetry, are not found.

    Args:
        stiffness: shape (n, n).
        mass: shape (n, n).
        start: shape (n, k).
        factor: of a similar stiffness.
        tolerance: relative, of eigenvalues, by the energy of the error to first order.

    Returns:
        Eigenvalues (k,), ascending, and mass-normalised vectors (n, k); None where they do not settle.
    """
    count = start.shape[1]
    basis, image, _, _ = orthonormal(start, mass)
    pushed = stiffness @ basis
    for _ in range(ROUNDS):
        reduced = basis.T @ pushed
        values, vectors = np.linalg.eigh(symmetric(reduced))
        values, vectors = values[:count], vectors[:, :count]
        residual = pushed @ vectors - (image @ vectors) * values
        step = factor.solve(residual)
        far = np.abs(np.einsum("nk,nk->k", residual, step)) > tolerance * np.abs(values)
        if values.size == count and not far.any():
            return values, basis @ vectors
        block, heavy, _, _ = orthonormal(step[:, far], mass, basis, image)
        basis, image = np.hstack([basis, block]), np.hstack([image, heavy])
        pushed = np.hstack([pushed, stiffness @ block])
    return None


def refine(
    stiffness: csc_array, mass: csc_array, start: Array, target: int, factor: Factor, measure: csc_array
) -> tuple[float, Array]:
    """The eigenpair most like one of several vectors, by Davidson's method.

    Args:
        stiffness: shape (n, n).
        mass: shape (n, n).
        start: vectors to begin with, shape (n, k).
        target: number of the vector.
        factor: of the stiffness.
        measure: mass in which likeness is measured, shape (n, n).

    Returns:
        Eigenvalue and mass-normalised vector (n,).
    """
    wanted = measure @ start[:, target]
    basis, image, _, _ = orthonormal(start, mass)
    for _ in range(STEPS):
        reduced = basis.T @ (stiffness @ basis)
        values, vectors = np.linalg.eigh(symmetric(reduced))
        pick = most_alike(wanted @ basis, basis.T @ (measure @ basis), vectors)
        value, shape = float(values[pick]), basis @ vectors[:, pick]
        residual = stiffness @ shape - value * (mass @ shape)
        step = factor.solve(residual)
        # The step is the shape's error to first order; its energy is that of the eigenvalue.
        if abs(residual @ step) <= REFINED * abs(value):
            break
        block, heavy, _, _ = orthonormal(step[:, None], mass, basis, image)
        basis, image = np.hstack([basis, block]), np.hstack([image, heavy])
    return value, shape


def most_alike(wanted: Array, measure: Array, vectors: Array) -> int:
    """Number of the vector that is most like another.

    Args:
        wanted: product of the other with the measure, shape (r,).
        measure: shape (r, r).
        vectors: shape (r, k).
    """
    lengths = np.einsum("rk,rs,sk->k", vectors, measure, vectors)
    return int(np.argmax(np.abs(wanted @ vectors) / np.sqrt(np.maximum(lengths, np.finfo(float).tiny))))
