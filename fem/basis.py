"""A reduced basis for a range of speeds: small matrices that answer for every speed in it.

The matrices are affine: K(Omega) = K_r + (Omega² - Omega_r²) K_1, with one factor, at a reference speed r. The
basis V starts with the modes there. Everything a residual can be made of lies in span(V, K_r^-1 K_1 V,
K_r^-1 M V, K_r^-1 G V); with the Gram matrix of these vectors in K_r, dual norms of residuals cost r³ at any
speed (`fem.bounds`). New vectors are the dominant parts of the residuals' own representers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem.solver import orthonormal, rounding

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.modes import Modes
    from fem.operators import Operators

    Array = NDArray[np.float64]

SAFETY = 2.0
"""Factor on the largest stiffening outside the basis, which is an estimate from within."""


@dataclass(frozen=True, eq=False)
class ReducedBasis:
    """Small matrices over a basis (n, r) that is orthonormal in the mass.

    reference: speed in rad/s of the factor. images: K_0 V, M V, K_1 V and with Coriolis G V. representers:
    K_r^-1 K_1 V, K_r^-1 M V and K_r^-1 G V. elastic, stiffening, coriolis: V'K_0 V, V'K_1 V, V'G V.
    gram: (b r, b r), of V and the representers in K_r. outside: of the representers' parts outside V.
    known: lowest omega_n² (rad²/s²) of K_r, the last of them the least outside V. stretch: extreme
    eigenvalues of (K_1, K_r). stretch_outside: the largest outside V in magnitude, doubled. rounding: what
    double precision leaves uncertain of a frequency, relatively.
    """

    reference: float
    vectors: Array
    images: tuple[Array, ...]
    representers: tuple[Array, ...]
    elastic: Array
    stiffening: Array
    coriolis: Array | None
    gram: Array
    outside: Array
    known: Array
    stretch: tuple[float, float]
    stretch_outside: float
    rounding: float

    @property
    def size(self) -> int:
        """Number of vectors."""
        return int(self.vectors.shape[1])


def begin(operators: Operators, modes: Modes) -> ReducedBasis:
    """Make the basis of real modes at one speed; the last of them only says what lies above the basis."""
    shapes = modes.shapes[:, :-1]
    images, representers = _columns(operators, modes, shapes, operators.mass @ shapes)
    uncertain = rounding(operators.at(modes.omega), shapes, modes.eigenvalues[:-1])
    return _project(operators, modes, shapes, images, representers, float(uncertain.max()))


def enrich(operators: Operators, modes: Modes, basis: ReducedBasis, more: Array) -> ReducedBasis:
    """Add vectors (n, k) to a basis that began with these modes."""
    scaled = more / np.linalg.norm(more, axis=0)
    block, heavy, _, _ = orthonormal(scaled, basis.vectors, basis.images[1], operators.mass)
    fresh = _columns(operators, modes, block, heavy)
    images, representers = (
        tuple(np.hstack(pair) for pair in zip(old, new, strict=True))
        for old, new in zip((basis.images, basis.representers), fresh, strict=True)
    )
    vectors = np.hstack([basis.vectors, block])
    return _project(operators, modes, vectors, images, representers, basis.rounding)


def _columns(
    operators: Operators, modes: Modes, vectors: Array, heavy: Array
) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """Images and representers of new vectors (n, k) with mass image (n, k)."""
    images = [operators.stiffness @ vectors, heavy, operators.spinning @ vectors]
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
    uncertain: float,
) -> ReducedBasis:
    elastic, heavy, spinning, *turning = images
    r = vectors.shape[1]
    span = np.hstack([vectors, *representers])
    dual = np.hstack([elastic + modes.omega**2 * spinning, spinning, heavy, *turning])
    gram = _symmetric(span.T @ dual)
    slope = np.linalg.solve(gram[:r, :r], gram[:r, r:])
    outside = gram[r:, r:] - gram[r:, :r] @ slope
    left = representers[0] - vectors @ slope[:, :r]
    return ReducedBasis(
        reference=modes.omega,
        vectors=vectors,
        images=images,
        representers=representers,
        elastic=_symmetric(vectors.T @ elastic),
        stiffening=_symmetric(vectors.T @ spinning),
        coriolis=vectors.T @ turning[0] if turning else None,
        gram=gram,
        outside=outside,
        known=modes.eigenvalues,
        stretch=_extremes(gram[:r, r : 2 * r], gram[:r, :r]),
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
