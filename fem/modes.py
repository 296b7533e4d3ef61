"""Free vibration of the spinning plate at one speed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.solver import CONVERGED, Factor, SingularMatrix, factorise, lanczos, rounding

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.operators import Operators

    Array = NDArray[np.float64]


LOST = 0.1
"""What rounding may leave uncertain of the lowest frequency at rest, by an estimate that is some twenty times what is
measured (strips of h/L = 1e-4, W/L = 0.01 against thin-plate theory, 0.05 to 0.19: errors of 2e-3 to 6e-3)."""


SHIFTED = 1e-6
"""Residual of the eigenvalue that a divergence is reported with."""


class Divergence(ArithmeticError):
    """Spin softening has overcome the stiffness: the plate leaves its equilibrium without oscillating.

    That holds for the plate on its mesh: where stiffening and softening nearly cancel, as in the plane of rotation
    without a hub, it is the mesh that decides, until it is fine.
    omega: the speed in rad/s. eigenvalue: the lowest omega_n², negative, in rad²/s². count: how many are.
    """

    def __init__(self, omega: float, eigenvalue: float, count: int = 1) -> None:
        super().__init__(
            f"the plate diverges at {omega * 30 / np.pi:.6g} rpm: {count} mode(s) without a frequency, "
            f"eigenvalue {eigenvalue:.6g} rad²/s²"
        )
        self.omega = omega
        self.eigenvalue = eigenvalue
        self.count = count


class Unresolved(ArithmeticError):
    """Rounding has eaten up the stiffness: in double precision the theory has no answer for a plate so thin.

    uncertain: what is left uncertain of the lowest frequency at rest, relatively; infinite where it has none.
    """

    def __init__(self, theory: str, uncertain: float) -> None:
        left = f"rounding may be {100 * uncertain:.2g} % of" if uncertain < 1.0 else "rounding leaves nothing of"
        super().__init__(
            f"too thin for theory {theory!r} in double precision: {left} the lowest frequency at rest; "
            "of the theories, kirchhoff loses the fewest digits and solid the most"
        )
        self.uncertain = uncertain


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes at a speed omega (rad/s).

    eigenvalues: (count,) squared circular frequencies in rad²/s², ascending.
    shapes: (n, count), mass-normalised; complex with Coriolis, displacement Re(shape e^{i omega_n t}).
    damping_ratios: (count,), zero without a damper of the plate's own.
    factor: of K at this speed. state: the displacement (n,) about which the plate vibrates, where the
    deflection is large.
    """

    omega: float
    eigenvalues: Array
    shapes: NDArray[Any]
    damping_ratios: Array
    factor: Factor = field(repr=False, compare=False)
    state: Array | None = field(default=None, repr=False, compare=False)

    @property
    def frequencies_hz(self) -> Array:
        """Natural frequencies (count,) in Hz, ascending."""
        return np.asarray(np.sqrt(self.eigenvalues) / (2.0 * np.pi))


def solve_modes(
    operators: Operators,
    omega: float,
    count: int = 6,
    *,
    start: Array | None = None,
    state: Array | None = None,
    damping_ratio: float = 0.0,
) -> Modes:
    """Find the count lowest modes at a speed omega (rad/s).

    start: the state at a neighbouring speed, to warm-start a large deflection. state: that at this speed, if known.
    damping_ratio: viscous damping of each mode of the plate, below 1, which Coriolis forces then share out.
    Raises ValueError for a speed that is not one finite number, a count that the plate does not have, and a ratio
    at which modes do not oscillate; Divergence past the critical speed, NoEquilibrium where a large deflection
    has none, and Unresolved for a plate too thin for the theory.

    Rounding takes some digits of a thin plate, most of its lowest frequency. `fem.solver.rounding` estimates how much,
    some twenty times too cautiously, and the `bounds` of `campbell` contain it. On a square of 8 x 8 cells it is 1e-5
    for a solid of h/L = 1e-4, and grows with (L/h)²; for Mindlin's plates it is below 1e-6, for Kirchhoff's below
    1e-10, at any thickness. Finer meshes, strips, and speeds next to the critical one lose more.
    """
    from fem.gyroscopic import solve_gyroscopic

    check_count(operators, count)
    check_damping(damping_ratio)
    stiffness, state = linearise(operators, omega, start, state)
    if operators.gyroscopic is not None and omega != 0.0:
        return solve_gyroscopic(operators, omega, stiffness, count, state, damping_ratio)
    return solve_real(operators, omega, stiffness, count, state, damping_ratio)


def check_speed(omega: float) -> None:
    """Raise ValueError unless omega is one finite speed in rad/s."""
    if np.ndim(omega) != 0 or not np.isfinite(omega):
        raise ValueError(f"omega must be one finite speed in rad/s, got {omega!r}")


def check_count(operators: Operators, count: int) -> None:
    """Raise ValueError unless count is a whole number of modes that the model can have."""
    n = operators.mass.shape[0]
    if not hasattr(count, "__index__") or not 1 <= count <= n:
        raise ValueError(f"count of modes must be a whole number from 1 to the model's {n} unknowns, got {count!r}")


def check_damping(ratio: float) -> None:
    """Raise ValueError unless modes of a damping ratio oscillate."""
    if not 0.0 <= ratio < 1.0:
        raise ValueError(f"damping_ratio must be zero or more and below 1, got {ratio!r}")


def solve_real(
    operators: Operators,
    omega: float,
    stiffness: csc_array,
    count: int,
    state: Array | None = None,
    damping_ratio: float = 0.0,
    tolerance: float = CONVERGED,
) -> Modes:
    """Find the count lowest modes of a stiffness (n, n), Coriolis apart. Raises Divergence and Unresolved."""
    try:
        factor = factorise(stiffness)
    except SingularMatrix:
        check_rest(operators)
        raise Divergence(omega, 0.0) from None
    values, vectors = lanczos(factor, operators.mass, count, tolerance)
    if factor.negative:
        check_rest(operators)
        raise Divergence(omega, lowest(stiffness, operators.mass, values), factor.negative)
    if np.finfo(float).eps * values[-1] > max(tolerance**2, CONVERGED) * values[0]:
        values, vectors = _undrowned(stiffness, operators.mass, values, tolerance)
    order = np.argsort(values)
    first = order[:1]
    if rounding(stiffness, vectors[:, first], values[first])[0] > LOST:
        check_rest(operators)
    ratios = np.full(order.size, damping_ratio)
    return Modes(omega, values[order], vectors[:, order], ratios, factor, state)


def _undrowned(stiffness: csc_array, mass: csc_array, values: Array, tolerance: float) -> tuple[Array, Array]:
    """Modes of which the lowest is so low that its inverse eigenvalue, as values have it, drowns the others'.

    From a shift between them the others keep their digits; the lowest has its own from the inverse.
    """
    shift = float(np.sqrt(values[0] * values[-1]))
    shifted, vectors = lanczos(factorise((stiffness + shift * mass).tocsc()), mass, values.size, tolerance)
    return np.where(values < shift, values, shifted - shift), vectors


def linearise(
    operators: Operators, omega: float, start: Array | None = None, state: Array | None = None
) -> tuple[csc_array, Array | None]:
    """Return the stiffness (n, n) at a speed, and the state it is taken about if the deflection is large.

    start, state: see `solve_modes`. Raises ValueError for a speed that is not one finite number.
    """
    from fem.statics import equilibrium, tangent

    check_speed(omega)
    if not operators.effects.large_deflection:
        return operators.at(omega), None
    if omega == 0.0:
        return operators.stiffness, np.zeros_like(operators.load)
    if state is None:
        state = equilibrium(operators, omega, start)
    return tangent(operators, omega, state), state


def check_rest(operators: Operators) -> None:
    """Raise Unresolved unless the plate at rest has a lowest frequency that rounding leaves.

    At rest the stiffness is positive by construction: what is not so there, or is not there, is rounding.
    """
    try:
        factor = factorise(operators.stiffness)
    except SingularMatrix:
        raise Unresolved(operators.model.theory, np.inf) from None
    if factor.negative:
        raise Unresolved(operators.model.theory, np.inf)
    value, shape = lanczos(factor, operators.mass, 1)
    uncertain = float(rounding(operators.stiffness, shape, value)[0])
    if uncertain > LOST:
        raise Unresolved(operators.model.theory, uncertain)


def lowest(stiffness: csc_array, mass: csc_array, values: Array) -> float:
    """Find the lowest of eigenvalues that are known to reach below zero, by shifting all above it."""
    shift = 2.0 * float(np.abs(values).max())
    while (factor := factorise((stiffness + shift * mass).tocsc())).negative:
        shift *= 4.0
    return float(lanczos(factor, mass, 1, SHIFTED)[0][0] - shift)
