"""Modes without Coriolis forces, and the families that they belong to.

`solve_real` finds the lowest modes under a stiffness; `families` tells flap, twist, lag and chord modes apart by
where their energy is.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.linalg import CONVERGED, Factor, NotConverged, SingularMatrix, factorise, lanczos, rounding
from fem.operators.assembly import Operators
from fem.rotor import in_rpm
from fem.statics import LOST, Unresolved, check_rest
from fem.theory.forms import elastic_energies

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.operators.assembly import Body

    Array = NDArray[np.float64]


FELT = 1e-5
"""Rounding of a frequency, as it is estimated beforehand, from which the frequency is taken from the mode's strains."""

MOVED = 0.02
"""Relative change of a frequency by that up to which it is believed: its own error is about the square."""

SOFTENED = 1e-2
"""Share of the elastic stiffness that spin softening leaves, below which a frequency is a difference of two that are
known: near the critical speed its uncertainty is theirs, which the bounds contain, and not that of a thin plate."""

DIGITS = 1e28
"""Ratio of squared rates, above the square of what double precision holds, at which a mode is none."""

SHIFTED = 1e-6
"""Residual of the eigenvalue that a divergence is reported with."""


class Divergence(ArithmeticError):
    """Spin softening has overcome the stiffness: the plate or blade leaves its equilibrium without oscillating.

    That holds for the plate on its mesh: where stiffening and softening nearly cancel, as in the plane of rotation
    without a hub, it is the mesh that decides, until it is fine.

    Attributes:
        omega: the speed in rad/s.
        eigenvalue: the lowest omega_n², negative, in rad²/s².
        count: how many are.
    """

    def __init__(self, omega: float, eigenvalue: float, count: int = 1, body: str = "plate") -> None:
        super().__init__(
            f"the {body} diverges at {in_rpm(omega):.6g} rpm: {count} mode(s) without a frequency, "
            f"eigenvalue {eigenvalue:.6g} rad²/s²"
        )
        self.omega = omega
        self.eigenvalue = eigenvalue
        self.count = count


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes at a speed omega (rad/s).

    Attributes:
        eigenvalues: (count,) squared circular frequencies in rad²/s², ascending.
        shapes: (n, count), mass-normalised; complex with Coriolis, displacement Re(shape e^{i omega_n t}).
        damping_ratios: (count,), zero without a damper of the plate's own.
        factor: of K at this speed.
        state: the displacement (n,) about which the plate vibrates, where the deflection is large.
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


def check_count(operators: Body, count: int) -> None:
    """Raise ValueError unless count is a whole number of modes that the model can have."""
    n = operators.mass.shape[0]
    if not hasattr(count, "__index__") or not 1 <= count <= n:
        raise ValueError(f"count of modes must be a whole number from 1 to the model's {n} unknowns, got {count!r}")


def check_damping(ratio: float) -> None:
    """Raise ValueError unless modes of a damping ratio oscillate."""
    if not 0.0 <= ratio < 1.0:
        raise ValueError(f"damping_ratio must be zero or more and below 1, got {ratio!r}")


def solve_real(
    operators: Body,
    omega: float,
    stiffness: csc_array,
    count: int,
    state: Array | None = None,
    tolerance: float = CONVERGED,
) -> Modes:
    """Find the count lowest modes of a stiffness (n, n), Coriolis apart; fewer where fewer directions have mass.

    Raises:
        Divergence: past the critical speed.
        Unresolved: the plate is too thin for its theory in double precision.
    """
    body = "plate" if isinstance(operators, Operators) else "blade"
    try:
        factor = operators.factorise(stiffness)
    except SingularMatrix:
        check_rest(operators)
        raise Divergence(omega, 0.0, body=body) from None
    values, vectors = lanczos(factor, operators.mass, count, tolerance)
    if factor.negative:
        check_rest(operators)
        value = lowest(stiffness, operators.mass, values, operators.factorise)
        raise Divergence(omega, value, factor.negative, body)
    if np.finfo(float).eps * values[-1] > max(tolerance**2, CONVERGED) * values[0]:
        values, vectors = _undrowned(operators, stiffness, values, tolerance)
    known = _known(values)
    if not known.any():
        raise NotConverged
    values, vectors = values[known], vectors[:, known]
    order = np.argsort(values)
    uncertain = rounding(stiffness, vectors, values)
    if uncertain[order[0]] > LOST:
        check_rest(operators)
    if uncertain.max() > FELT and state is None and isinstance(operators, Operators):
        values, vectors = _from_strains(operators, omega, values, vectors)
        order = np.argsort(values)
    return Modes(omega, values[order], vectors[:, order], np.zeros(order.size), factor, state)


def _known(values: Array) -> NDArray[np.bool_]:
    """Which of some squared rates are those of modes: what has no mass has none, and double precision ends."""
    return np.asarray((values > 0.0) & (values < values[values > 0.0].min(initial=np.inf) * DIGITS))


def _from_strains(operators: Operators, omega: float, values: Array, vectors: Array) -> tuple[Array, Array]:
    """Modes among known ones by the energy of their strains, whose rounding is of second order.

    Raises:
        Unresolved: the plate is too thin for its theory in double precision.
    """
    energies = elastic_energies(operators.model, vectors)
    if omega != 0.0 and (values < SOFTENED * np.diag(energies)).any():
        return values, vectors
    if omega != 0.0 and not (operators.geometric is None and operators.softening is None):
        energies += omega**2 * (vectors.T @ (operators.spinning @ vectors))
    corrected, mixed = np.linalg.eigh(0.5 * (energies + energies.T))
    moved = float(np.abs(np.sqrt(np.maximum(corrected, 0.0) / np.sort(values)) - 1.0).max())
    if not moved <= MOVED:
        raise Unresolved(operators.model.theory, moved)
    return corrected, vectors @ mixed


def _undrowned(operators: Body, stiffness: csc_array, values: Array, tolerance: float) -> tuple[Array, Array]:
    """Modes of which the lowest is so low that its inverse eigenvalue, as values have it, drowns the others'.

    From a shift between them the others keep their digits; the lowest has its own from the inverse.
    """
    shift, mass = float(np.sqrt(values[0] * values[-1])), operators.mass
    shifted, vectors = lanczos(operators.factorise((stiffness + shift * mass).tocsc()), mass, values.size, tolerance)
    return np.where(values < shift, values, shifted - shift), vectors


def lowest(
    stiffness: csc_array, mass: csc_array, values: Array, factor_of: Callable[[csc_array], Factor] = factorise
) -> float:
    """Find the lowest of eigenvalues that are known to reach below zero, by shifting all above it."""
    shift = 2.0 * float(np.abs(values).max())
    while (factor := factor_of((stiffness + shift * mass).tocsc())).negative:
        shift *= 4.0
    return float(lanczos(factor, mass, 1, SHIFTED)[0][0] - shift)


STRIPS = 16
"""Strips along x in which a chord is fitted."""

FAMILIES = ("flap", "twist", "chord", "lag", "axial")


def families(operators: Operators, modes: Modes) -> list[str]:
    """Name each mode by the largest share of its kinetic energy, one of `FAMILIES`."""
    shares = energy_shares(operators, modes.shapes)
    return [FAMILIES[k] for k in shares.argmax(axis=0)]


def energy_shares(operators: Operators, shapes: NDArray[Any]) -> Array:
    """Shares (5, count) of kinetic energy in each of `FAMILIES`, for shapes (n, count) real or complex."""
    if np.iscomplexobj(shapes):
        both = np.hstack([shapes.real, shapes.imag])
        energy = np.einsum("fii->fi", share_matrices(operators, both))
        energy = energy[:, : shapes.shape[1]] + energy[:, shapes.shape[1] :]
    else:
        energy = np.einsum("fii->fi", share_matrices(operators, shapes))
    return np.asarray(energy / energy.sum(axis=0))


def share_matrices(operators: Operators, basis: Array) -> Array:
    """Matrices E (5, r, r): the energy of basis @ y (n, r) in family f is y' E_f y, up to one factor."""
    model = operators.model
    weight = np.sqrt(model.displacement.dx.ravel())[:, None]
    u, v, w = (weight * moved.reshape(weight.size, -1) for moved in model.displacement.evaluate(basis)[:3])
    flap, twist = _chordwise(model.points[0].ravel(), model.points[1].ravel(), w, weight)
    return np.stack([flap, twist, w.T @ w - flap - twist, v.T @ v, u.T @ u])


def _chordwise(x: Array, y: Array, w: Array, weight: Array) -> tuple[Array, Array]:
    """Energy matrices (r, r) of what in w (npoint, r) is even along the chord, and linear in it."""
    edges = np.linspace(x.min(), x.max(), STRIPS + 1)[1:-1]
    strip = np.searchsorted(edges, x)
    even, linear = [], []
    for k in np.unique(strip):
        here = strip == k
        a, b = x[here] - x[here].mean(), y[here] - y[here].mean()
        ordered = np.stack([np.ones_like(a), a, b, a * b], axis=1) * weight[here]
        content = np.linalg.qr(ordered)[0].T @ w[here]
        even.append(content[:2])
        linear.append(content[2:])
    flap, twist = np.vstack(even), np.vstack(linear)
    return flap.T @ flap, twist.T @ twist
