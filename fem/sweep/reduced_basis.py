"""A reduced basis for a range of speeds: small matrices that answer for every speed in it.

The matrices are affine: K(Omega) = K_r + (Omega² - Omega_r²) K_1, with one factor, at a reference speed r. The
basis V, orthonormal in K_r, starts with the modes there; in the axes of K_1 the small stiffness is diagonal at every
speed, so that the lowest frequencies keep their digits however stiff the highest. Everything a residual can be
made of lies in span(V, K_r^-1 K_1 V, K_r^-1 M V, K_r^-1 G V); with the Gram matrix of these vectors in K_r, dual
norms of residuals cost r³ at any speed (`fem.sweep.error_bounds`). New vectors are the dominant parts of the
residuals' own representers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.linalg import polar

from fem.linalg import orthonormal, rounding

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.modes.real import Modes
    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]


SAFETY = 2.0
"""Factor on the largest stiffening outside the basis, which is an estimate from within."""


@dataclass(frozen=True, eq=False)
class ReducedBasis:
    """Small matrices over a basis V (n, r) that is orthonormal in K_r.

    Attributes:
        reference: speed in rad/s of the factor.
        images: K_r V, M V, K_1 V and with Coriolis G V.
        representers: K_r^-1 K_1 V, K_r^-1 M V and K_r^-1 G V.
        mass, coriolis: V'M V and V'G V.
        stretches: eigenvalues (r,) of V'K_1 V, ascending, and axes (r, r) its eigenvectors.
        gram: (b r, b r), of V and the representers in K_r.
        outside: of the representers' parts outside V.
        known: lowest omega_n² (rad²/s²) of K_r, the last of them the least outside V.
        stretch_outside: the largest stretch outside V in magnitude, doubled.
        rounding: what double precision leaves uncertain of each vector's energy, (r,).
    """

    reference: float
    vectors: Array
    images: tuple[Array, ...]
    representers: tuple[Array, ...]
    mass: Array
    coriolis: Array | None
    stretches: Array
    axes: Array
    gram: Array
    outside: Array
    known: Array
    stretch_outside: float
    rounding: Array

    @property
    def size(self) -> int:
        """Number of vectors."""
        return int(self.vectors.shape[1])

    def shift(self, omega: Array) -> Array:
        """Omega² (k,) less that of the reference, rad²/s²."""
        return np.asarray(omega**2 - self.reference**2)

    def held(self, omega: Array) -> Array:
        """Eigenvalues (k, r) of V'K(Omega) V along the axes: what speed leaves of the stiffness at the reference."""
        return np.asarray(1.0 + self.shift(omega)[:, None] * self.stretches)


def begin(operators: Operators, stiffness: csc_array, modes: Modes) -> ReducedBasis:
    """Make the basis of a stiffness's real modes; the last of them only says what lies above the basis."""
    empty = np.empty((modes.shapes.shape[0], 0))
    shapes = modes.shapes[:, :-1] / np.sqrt(modes.eigenvalues[:-1])
    block, energy, _, coupling = orthonormal(shapes, empty, empty, stiffness)
    back = polar(coupling)[0]  # to the modes: in a mixture the large representer of a soft one drowns a stiff one's
    block, energy = block @ back, energy @ back
    images, representers = _columns(operators, modes, block, energy)
    return _project(operators, modes, block, images, representers, _uncertain(stiffness, block))


def enrich(operators: Operators, stiffness: csc_array, modes: Modes, basis: ReducedBasis, more: Array) -> ReducedBasis:
    """Add vectors (n, k) to a basis that began with these modes."""
    block, energy, _, _ = orthonormal(more, basis.vectors, basis.images[0], stiffness)
    fresh = _columns(operators, modes, block, energy)
    images, representers = (
        tuple(np.hstack(pair) for pair in zip(old, new, strict=True))
        for old, new in zip((basis.images, basis.representers), fresh, strict=True)
    )
    uncertain = np.append(basis.rounding, _uncertain(stiffness, block))
    return _project(operators, modes, np.hstack([basis.vectors, block]), images, representers, uncertain)


def _uncertain(stiffness: csc_array, vectors: Array) -> Array:
    """What rounding leaves uncertain of the energies (k,) of vectors (n, k) of unit energy."""
    return rounding(stiffness, vectors, np.ones(vectors.shape[1]))


def _columns(
    operators: Operators, modes: Modes, vectors: Array, energy: Array
) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """Images and representers of new vectors (n, k) whose image under K_r is given (n, k)."""
    images = [energy, operators.mass @ vectors, operators.spinning @ vectors]
    if operators.gyroscopic is not None:
        images.append(operators.gyroscopic @ vectors)
    loads = [images[2], images[1], *images[3:]]
    solved = np.split(modes.factor.solve(np.hstack(loads)), len(loads), axis=1)
    return tuple(images), tuple(solved)


def _project(
    operators: Operators,
    modes: Modes,
    vectors: Array,
    images: tuple[Array, ...],
    representers: tuple[Array, ...],
    uncertain: Array,
) -> ReducedBasis:
    energy, heavy, spinning, *turning = images
    r = vectors.shape[1]
    span = np.hstack([vectors, *representers])
    gram = _symmetric(span.T @ np.hstack([energy, spinning, heavy, *turning]))
    outside = gram[r:, r:] - gram[r:, :r] @ gram[:r, r:]
    left = representers[0] - vectors @ gram[:r, r : 2 * r]
    stretches, axes = np.linalg.eigh(gram[:r, r : 2 * r])
    return ReducedBasis(
        reference=modes.omega,
        vectors=vectors,
        images=images,
        representers=representers,
        mass=_symmetric(vectors.T @ heavy),
        coriolis=vectors.T @ turning[0] if turning else None,
        stretches=stretches,
        axes=axes,
        gram=gram,
        outside=outside,
        known=modes.eigenvalues,
        stretch_outside=SAFETY * max(map(abs, _extremes(left.T @ (operators.spinning @ left), outside[:r, :r]))),
        rounding=uncertain,
    )


def _symmetric(matrix: Array) -> Array:
    return np.asarray(0.5 * (matrix + matrix.T))


def _extremes(a: Array, b: Array) -> tuple[float, float]:
    """Smallest and largest eigenvalue of the pencil (a, b), with b's null space left out."""
    values, vectors = np.linalg.eigh(_symmetric(b))
    keep = values > 1e-12 * max(values[-1], 0.0)
    if not keep.any():
        return 0.0, 0.0
    whitened = vectors[:, keep] / np.sqrt(values[keep])
    found = np.linalg.eigvalsh(whitened.T @ _symmetric(a) @ whitened)
    return float(found[0]), float(found[-1])


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
