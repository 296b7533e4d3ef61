"""Modes with Coriolis forces: the quadratic eigenproblem (lambda² M + lambda Omega G + K) x = 0.

With y = lambda x it reads S z = z / lambda for z = (x, y) and S z = (-K^-1 (Omega G x + M y), x). In the energy
product x'Kx + y'My the operator S is skew-adjoint because G is skew, so that 1/lambda is imaginary, the block
Lanczos of `fem.solver` applies, and each step needs one solve with K. Source: Meirovitch, AIAA J. 12 (1974)
1337. Structural damping, given as a ratio for each mode of the plate, is added in the space of these modes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fem.solver import BLOCK, krylov

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.modes import Modes
    from fem.operators import Operators

    Array = NDArray[np.float64]

EXTRA = 4
"""Modes beyond those asked for among which damping is shared out."""


def solve_gyroscopic(
    operators: Operators,
    omega: float,
    stiffness: csc_array,
    count: int,
    state: Array | None = None,
    damping_ratio: float = 0.0,
) -> Modes:
    """Find the count lowest complex modes of a stiffness (n, n) at a speed omega (rad/s).

    Raises Divergence where the stiffness is not positive: Coriolis forces may hold such a plate, but no
    damped one. Raises ValueError where damping leaves one of these modes no frequency.
    """
    from scipy.sparse import block_diag

    from fem.modes import Modes, solve_real

    assert operators.gyroscopic is not None
    mass, coriolis = operators.mass, omega * operators.gyroscopic
    still = solve_real(operators, omega, stiffness, count + EXTRA, state)
    n = mass.shape[0]

    def apply(block: Array, _: Array) -> Array:
        x, y = block[:n], block[n:]
        return np.vstack([-still.factor.solve(coriolis @ x + mass @ y), x])

    energy = block_diag([stiffness, mass]).tocsc()
    generator = np.random.default_rng(0)
    moving = still.shapes @ generator.standard_normal((still.shapes.shape[1], BLOCK))
    _, vectors = krylov(apply, energy, np.vstack([moving, moving]), count, np.asarray, skew=True)
    values, shapes = _project(
        vectors[:n], still.shapes, stiffness, mass, coriolis, damping_ratio * np.sqrt(still.eigenvalues)
    )
    order = np.argsort(np.abs(values))[:count]
    if (values[order].imag == 0.0).any():
        raise ValueError(f"with damping_ratio {damping_ratio!r} one of the {count} lowest modes does not oscillate")
    size = np.abs(values[order])
    return Modes(omega, size**2, shapes[:, order], -values[order].real / size, still.factor, state)


def _project(
    complex_shapes: NDArray[Any],
    shapes: Array,
    stiffness: csc_array,
    mass: csc_array,
    coriolis: csc_array,
    rates: Array,
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Eigenvalues with positive frequency or none, and mass-normalised vectors, of the problem in a small space.

    The damping matrix is 2 sum_j rate_j (M phi_j)(M phi_j)' over the plate's own modes phi_j.
    """
    from fem.solver import orthonormal

    empty = np.empty((shapes.shape[0], 0))
    span = np.hstack([complex_shapes.real, complex_shapes.imag, shapes])
    basis, _, _, _ = orthonormal(span, empty, empty, stiffness)
    heavy = mass @ basis
    felt = heavy.T @ shapes
    damping = basis.T @ (coriolis @ basis) + 2.0 * (felt * rates) @ felt.T
    # In energy coordinates, of x and of the velocity, the largest 1 / lambda are the lowest frequencies.
    squares, directions = np.linalg.eigh(0.5 * (basis.T @ heavy + heavy.T @ basis))
    root = np.sqrt(np.maximum(squares, 0.0))[:, None] * directions.T
    values, vectors = np.linalg.eig(np.block([[-damping, -root.T], [root, np.zeros_like(root)]]))
    heaviest = np.abs(values).max()
    up = (values.imag < 0.0) | ((values.imag == 0.0) & (np.abs(values) > np.finfo(float).eps * heaviest))
    small = vectors[: basis.shape[1], up]
    small = small / np.linalg.norm(root @ small, axis=0)
    # Turn each shape so that as much of it as possible is real.
    phase = np.exp(-0.5j * np.angle(np.einsum("ij,ij->j", small, basis.T @ heavy @ small)))
    return 1.0 / values[up], basis @ (small * phase)
