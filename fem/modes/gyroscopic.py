"""Modes with Coriolis forces, (K + i w Omega G - w² M) x = 0, and the critical speed.

Davidson's method: a space that begins with the plate's own modes takes in the residuals, solved for with the factor of
K, until these are small. Residuals are those of the full matrices, so that nothing hangs on the rounding of a
recurrence. Vectors are orthonormal in K + shift M, which next to the critical speed stays as regular as elsewhere,
and the small problem is solved for 1 / w in the energy x'Kx + w² x'Mx, in which it is Hermitian: stiff modes cost the
soft ones no digits. Sources: Meirovitch, AIAA J. 12 (1974) 1337; Davidson, J. Comput. Phys. 17 (1975) 87. Structural
damping, given as a ratio for each mode of the plate, is added in the space of these modes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fem import linalg
from fem.linalg import NotConverged, SingularMatrix, factorise, krylov, orthonormal, random_block, rounding
from fem.modes.real import Modes, solve_real
from fem.statics import check_rest

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]
    from fem.linalg import Factor


EXTRA = 4
"""Modes of the plate's own beyond those asked for: among them damping is shared out, and none is missed."""

BEGINNING = 1e-6
"""Residual of the plate's own modes."""

SETTLED = 1e-18
"""Energy of a mode's error relative to its own, which is about the relative error of its frequency."""


def solve_gyroscopic(
    operators: Operators,
    omega: float,
    stiffness: csc_array,
    count: int,
    state: Array | None = None,
    damping_ratio: float = 0.0,
) -> Modes:
    """Find the count lowest complex modes of a stiffness (n, n) at a speed omega (rad/s).

    Raises:
        Divergence: where the stiffness is not positive: Coriolis forces may hold such a plate, but no damped one.
        ValueError: where damping leaves one of these modes no frequency.
        NotConverged: the iteration does not converge.
    """
    assert operators.gyroscopic is not None
    coriolis = omega * operators.gyroscopic
    extra = EXTRA
    while True:
        still = solve_real(operators, omega, stiffness, count + extra, state, tolerance=BEGINNING)
        rates, shapes = _undamped(still, stiffness, operators.mass, coriolis, count)
        if still.eigenvalues.size < count + extra or still.eigenvalues[-1] >= _reached(rates[-1], omega):
            break
        extra *= 2
    if damping_ratio == 0.0:
        return Modes(omega, rates**2, shapes, np.zeros_like(rates), still.factor, state)
    values, shapes = _damped(shapes, still, stiffness, operators.mass, coriolis, damping_ratio)
    order = np.argsort(np.abs(values))[:count]
    if (values[order].imag == 0.0).any():
        raise ValueError(f"with damping_ratio {damping_ratio!r} one of the {count} lowest modes does not oscillate")
    size = np.abs(values[order])
    return Modes(omega, size**2, shapes[:, order], -values[order].real / size, still.factor, state)


def _reached(rate: float, omega: float) -> float:
    """Up to which own eigenvalue modes of the plate can have a part alone in one of a rate, in rad²/s².

    Where x'Kx is larger, x'(K + i w Omega G - w² M)x is positive, for |x'Gx| is at most 2 x'Mx.
    """
    return rate**2 + 2.0 * abs(omega) * rate


class _Span(NamedTuple):
    """Vectors (n, r), orthonormal in a weight, and their images under it, the mass and the Coriolis matrix."""

    vectors: Array
    weighed: Array
    heavy: Array
    turned: Array


def _undamped(
    still: Modes, stiffness: csc_array, mass: csc_array, coriolis: csc_array, count: int
) -> tuple[Array, NDArray[Any]]:
    """Frequencies (count,) in rad/s, ascending, and mass-normalised shapes (n, count).

    Modes beyond those asked for are followed as far as it takes to know that they stay beyond.

    Raises:
        NotConverged: the iteration does not converge.
    """
    shift = float(np.sqrt(still.eigenvalues[0] * still.eigenvalues[-1]))
    matrices = ((stiffness + shift * mass).tocsc(), mass, coriolis)
    nothing = np.empty((mass.shape[0], 0))
    span, more = _Span(nothing, nothing, nothing, nothing), still.shapes
    while True:
        span = _grown(span, more, *matrices)
        rates, small = _small(span, shift, still.eigenvalues.size)
        shapes, weighed, heavy, turned = (_product(columns, small) for columns in span)
        residual = weighed - (shift + rates**2) * heavy + 1j * rates * turned
        residual -= _product(span.weighed, _product(span.vectors.T, residual))  # but rounding, which K^-1 would enlarge
        step = still.factor.solve(residual.real) + 1j * still.factor.solve(residual.imag)
        energy = np.abs(np.einsum("nk,nk->k", residual.conj(), step)) / rates**2
        settled = energy <= np.maximum(SETTLED, rounding(stiffness, np.abs(shapes), rates**2) ** 2)
        far = ~settled & (rates * (1.0 - energy) <= rates[:count][-1])
        if not far.any():
            return rates[:count], _turned(shapes[:, :count], mass)
        if span.vectors.shape[1] >= linalg.LARGEST[0] + linalg.LARGEST[1] * count:
            worst = float(energy[:count].max())
            raise NotConverged(f"{span.vectors.shape[1]} vectors leave {worst:.2g} of the energy of {count} modes")
        more = np.hstack([step[:, far].real, step[:, far].imag])


def _grown(span: _Span, more: Array, weight: csc_array, mass: csc_array, coriolis: csc_array) -> _Span:
    """The span with vectors (n, k) added."""
    block, weighed, _, _ = orthonormal(more, span.vectors, span.weighed, weight)
    fresh = (block, weighed, mass @ block, coriolis @ block)
    return _Span(*(np.hstack(pair) for pair in zip(span, fresh, strict=True)))


def _small(span: _Span, shift: float, count: int) -> tuple[Array, NDArray[Any]]:
    """The count lowest frequencies in rad/s that a span has, and mass-normalised coordinates (r, count) in it.

    With z = (x, w x) the problem is diag(K, M) z = w ((-i Omega G, M), (M, 0)) z.
    """
    return _projected(span.vectors.T @ span.heavy, span.vectors.T @ span.turned, shift, count)


def _projected(mass: Array, turned: Array, shift: float, count: int) -> tuple[Array, NDArray[Any]]:
    """The same of the mass and Coriolis matrices (r, r) in the span."""
    squares, axes = np.linalg.eigh(_even(mass))
    soft = np.maximum(1.0 - shift * squares, np.finfo(float).eps) ** -0.5
    turning = axes.T @ turned @ axes
    heavy = np.diag(soft * np.sqrt(np.maximum(squares, 0.0)))
    felt = -0.5j * soft[:, None] * (turning - turning.T) * soft
    inverse, vectors = np.linalg.eigh(np.block([[felt, heavy], [heavy, np.zeros_like(heavy)]]))
    count = min(count, squares.size)
    parts = soft[:, None] * vectors[: squares.size, : -count - 1 : -1]
    sizes = np.sqrt(np.maximum(squares, 0.0) @ np.abs(parts) ** 2)
    return 1.0 / inverse[: -count - 1 : -1], axes @ (parts / sizes)


def _product(real: Array, other: NDArray[Any]) -> NDArray[Any]:
    """Product of a real matrix and a complex one; numpy would make both complex."""
    return np.asarray(real @ other.real + 1j * (real @ other.imag))


def _even(matrix: Array) -> Array:
    return np.asarray(0.5 * (matrix + matrix.T))


def _turned(shapes: NDArray[Any], mass: csc_array) -> NDArray[Any]:
    """Shapes (n, k), each turned in phase so that as much of it as possible is real."""
    return np.asarray(shapes * np.exp(-0.5j * np.angle(np.einsum("nk,nk->k", shapes, mass @ shapes))))


def _damped(
    complex_shapes: NDArray[Any],
    still: Modes,
    stiffness: csc_array,
    mass: csc_array,
    coriolis: csc_array,
    damping_ratio: float,
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Eigenvalues with positive frequency or none, and mass-normalised shapes, in the space of undamped modes.

    The damping matrix is 2 sum_j rate_j (M phi_j)(M phi_j)' over the plate's own modes phi_j.
    """
    empty = np.empty((still.shapes.shape[0], 0))
    span = np.hstack([complex_shapes.real, complex_shapes.imag, still.shapes])
    basis, _, _, _ = orthonormal(span, empty, empty, stiffness)
    heavy = mass @ basis
    felt = heavy.T @ still.shapes
    rates = damping_ratio * np.sqrt(still.eigenvalues)
    damping = basis.T @ (coriolis @ basis) + 2.0 * (felt * rates) @ felt.T
    # In energy coordinates, of x and of the velocity, the largest 1 / lambda are the lowest frequencies.
    squares, directions = np.linalg.eigh(_even(basis.T @ heavy))
    root = np.sqrt(np.maximum(squares, 0.0))[:, None] * directions.T
    values, vectors = np.linalg.eig(np.block([[-damping, -root.T], [root, np.zeros_like(root)]]))
    heaviest = np.abs(values).max()
    up = (values.imag < 0.0) | ((values.imag == 0.0) & (np.abs(values) > np.finfo(float).eps * heaviest))
    small = vectors[: basis.shape[1], up]
    shapes = basis @ (small / np.linalg.norm(root @ small, axis=0))
    return 1.0 / values[up], _turned(shapes, mass)


NEVER = 1e3
"""A critical speed above this times the lowest frequency at rest counts as none."""

RUNG = 4.0
"""Ratio of the speeds between which the critical one is bracketed."""


def critical_speed(operators: Operators) -> float:
    """Lowest speed in rad/s at which K(Omega) is singular; infinity where it never is.

    It is the mesh's: where stiffening and softening nearly cancel, as in the plane of rotation without a hub, a coarse
    mesh may have a critical speed that a finer one has not, or not have one. Prestress is taken as linear in Omega²,
    also where the effects ask for large deflection.

    Raises:
        Unresolved: for a plate too thin for its theory.
        NotConverged: the iteration does not converge.
    """
    if operators.softening is None and operators.geometric is None:
        return np.inf
    rest = check_rest(operators)
    below = NEVER * float(np.sqrt(rest))
    if _stable(operators, below) is not None:
        return np.inf
    while (factor := _stable(operators, below)) is None:
        below = below / RUNG if below**2 * NEVER**2 > rest else 0.0
    loss = -operators.spinning
    start = factor.solve(loss @ random_block(loss.shape[0]))
    values, _ = krylov(lambda x, _: factor.solve(loss @ x), operators.at(below), start, 1, np.asarray)
    if values[0] <= 0.0:
        raise NotConverged(f"rounding hides the critical speed above {below:.6g} rad/s")
    return float(np.sqrt(below**2 + 1.0 / values[0]))


def _stable(operators: Operators, omega: float) -> Factor | None:
    """Factor of K at a speed in rad/s, if it is positive."""
    try:
        factor = factorise(operators.at(omega))
    except SingularMatrix:
        return None
    return None if factor.negative else factor
