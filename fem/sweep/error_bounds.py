"""Frequencies from a reduced basis, and how far each can be from the full model's.

A Galerkin frequency is never below the true one of the same number (min-max). That it is hardly above it is
shown in two steps, at each speed and for reduced modes x_j with residuals r_j:

1. Counting, with d = Omega² - Omega_r². K(Omega) is at least s K_r, s = 1 + d stretch, so that frequency number
   p + 1 is no lower than sqrt(s) times the one at the reference speed. Where that is too coarse: outside the
   basis the form K(Omega) - w² M, Coriolis included, exceeds g K_r with
   g = 1 - |d| stretch_outside - (w² + 2 w Omega) / (the least omega_n² outside); so by the Schur complement the
   full model has no more frequencies below w than the small matrix Q(w) - F'F / g has negative eigenvalues, F
   being what couples the basis to the outside. With w in a gap after p frequencies this number is p, and
   none was missed.
2. Error. In the inverse form T z = z / w of the problem (see `fem.modes.gyroscopic`), self-adjoint in the energy, the p
   modes couple to the rest by rho_j = |r_j| / |z_j|, in K^-1 and energy norms. Outside them T does not exceed
   u = 1/w_gap + sum_j rho_j² / (w_j² (1/w_j - 1/w_gap)), and so no 1/w_i is larger than its reduced value by more
   than p rho_i² / (1 - u w_i), relatively: R'R for the residuals R of p modes is at most p times its diagonal.
   (Where that lifts a higher mode past mode i, it is the one that counts as number i.) It is also at most c times
   its entry i and c / (c - 1) times (p - 1) the others, so that c does for p where the higher modes are so far that
   this does not bring them down to mode i. What rounding leaves uncertain is added.

The residuals' norm in K(Omega)^-1 is at most that in K_r^-1 over sqrt(1 + d stretch). Taken on trust are that
Lanczos found all modes at the reference speed and the largest stretch there. Sources: Haynsworth, Linear
Algebra Appl. 1 (1968) 73; Parlett, The Symmetric Eigenvalue Problem, ch. 10; Mathias, SIAM J. Matrix Anal.
Appl. 19 (1998) 541.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.sweep.reduced_basis import LEAST, still, turning

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.sweep.reduced_basis import ReducedBasis

    Array = NDArray[np.float64]


ALONE = 1.5
"""The factor c of a mode that stands alone."""

PRECISION = float(np.finfo(float).eps)
"""Relative rounding of a product."""

ROUNDED = 4.0
"""A bound of so many times what rounding leaves uncertain is as good as any."""


@dataclass(frozen=True, eq=False)
class ReducedModes:
    """Reduced modes at several speeds.

    Attributes:
        omega: (k,) speeds in rad/s.
        rates: (k, q) circular frequencies in rad/s, ascending.
        vectors: (k, r, q), mass-normalised, complex with Coriolis; the wanted ones come first.
        residuals: (k, q), rho.
        bounds: (k, wanted) on the relative error of the frequencies; inf where none can be shown.
        rounding: (k, wanted), what double precision leaves uncertain, which the bounds contain.
        floor: (k,), least ratio of the stiffness to that at the reference speed; not positive where the plate diverges.
    """

    omega: Array
    rates: Array
    vectors: NDArray[Any]
    residuals: Array
    bounds: Array
    rounding: Array
    floor: Array

    def within(self, tolerance: float) -> NDArray[np.bool_]:
        """Which speeds (k,) have every frequency to a tolerance, or as well as rounding allows."""
        return np.asarray((self.bounds <= np.maximum(tolerance, ROUNDED * self.rounding)).all(axis=1))


def solve(basis: ReducedBasis, omega: Array, wanted: int) -> ReducedModes:
    """Solve a basis at speeds (k,) in rad/s for the wanted lowest modes, with their bounds."""
    q = min(basis.known.size, basis.size) - 1
    if basis.coriolis is None:
        rates, vectors = still(basis, omega, q + 1)
    else:
        rates, vectors = turning(basis, basis.coriolis, omega, q + 1)
    above = np.minimum(rates[:, wanted:], np.sqrt(basis.known[wanted : q + 1]))
    last = wanted + (above / rates[:, wanted - 1 : q]).argmax(axis=1)
    gap = _gap(basis, omega, rates, last)
    rates, vectors = rates[:, :q], vectors[:, :, :q]
    floor = basis.held(omega).min(axis=1)
    rounding = (np.abs(vectors).transpose(0, 2, 1) @ np.sqrt(basis.rounding) / rates) ** 2
    residuals = _residuals(basis, omega, rates, vectors)
    inside = np.arange(q) < last[:, None]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        spread = np.where(inside, residuals**2 / (rates * (1.0 - rates / gap[:, None])), 0.0)
        top = 1.0 / gap + spread.sum(axis=1)
        good = inside & (rates < gap[:, None]) & (top[:, None] * rates < 1.0)
        amount = np.where(good, residuals**2 / (1.0 - top[:, None] * rates), np.inf)
        error = _errors(rates, amount, last, inside)
    bounds = np.where(good, error + rounding, np.inf)[:, :wanted]
    return ReducedModes(omega, rates, vectors, residuals, bounds, rounding[:, :wanted], floor)


def _errors(rates: Array, amount: Array, last: NDArray[np.int64], inside: NDArray[np.bool_]) -> Array:
    """Bounds (k, q) on relative errors from each mode's amount rho² / (1 - u w).

    All modes lifted by p times their amounts: the i-th largest 1/w, whichever mode has become it. Or mode i by ALONE
    times its own, where the higher modes, lifted by what is left for them, do not reach it.
    """
    lifted = -np.sort(-np.where(inside, (1.0 + last[:, None] * amount) / rates, 0.0), axis=1)
    others = 1.0 + ALONE / (ALONE - 1.0) * (last[:, None] - 1) * amount
    lowered = np.where(inside, rates / others, np.inf)
    above = np.minimum.accumulate(lowered[:, ::-1], axis=1)[:, ::-1]
    clear = np.hstack([above[:, 1:], np.full((len(rates), 1), np.inf)]) > rates
    return np.asarray(np.minimum(lifted * rates - 1.0, np.where(clear, ALONE * amount, np.inf)))


def _gap(basis: ReducedBasis, omega: Array, rates: Array, last: NDArray[np.int64]) -> Array:
    """Frequencies (k,) below which the full model has no more than `last` (k,) ones; 0 where none is found."""
    k = np.arange(omega.size)
    below = rates[k, last - 1]
    above = np.minimum(rates[k, last], np.sqrt(basis.known[last]))
    raised = basis.held(omega).min(axis=1) * basis.known[last]
    drag = omega if basis.coriolis is not None else np.zeros_like(omega)
    coarse = np.sqrt(drag**2 + np.maximum(raised, 0.0)) - drag
    middle = np.sqrt(below * above)
    unclear = coarse < middle
    gap = np.minimum(coarse, above)
    if unclear.any():
        counted = _count_below(basis, omega[unclear], middle[unclear])
        gap[unclear] = np.where(counted == last[unclear], middle[unclear], 0.0)
    return np.where(gap > below, gap, 0.0)


def representatives(basis: ReducedBasis, modes: ReducedModes, wanted: int, tolerance: float) -> Array:
    """Fewest vectors (n, m) that hold the residuals' representers K_r^-1 r of the wanted modes.

    The squares of what they leave out add up to at most the tolerance, relative to the modes.
    """
    coefficients = _coefficients(basis, modes.omega, modes.rates, modes.vectors)[:, :wanted]
    size = np.sqrt(2.0) * modes.rates[:, :wanted, None]
    flat = (coefficients / size).reshape(-1, coefficients.shape[2]).T
    flat = np.hstack([flat.real, flat.imag]) if np.iscomplexobj(flat) else flat
    weights, directions = np.linalg.eigh(flat.T @ basis.gram @ flat)
    keep = np.cumsum(np.maximum(weights, 0.0)) > tolerance
    span = np.hstack([basis.vectors, *basis.representers])
    return np.asarray(span @ (flat @ directions[:, keep]))


def _coefficients(basis: ReducedBasis, omega: Array, rates: Array, vectors: NDArray[Any]) -> NDArray[Any]:
    """Coordinates (k, q, b r) of the residuals' representers in [V, K_r^-1 K_1 V, K_r^-1 M V, ...]."""
    rows = vectors.transpose(0, 2, 1)
    parts = [rows, basis.shift(omega)[:, None, None] * rows, -(rates[:, :, None] ** 2) * rows]
    if basis.coriolis is not None:
        parts.append(1j * omega[:, None, None] * rates[:, :, None] * rows)
    return np.concatenate(parts, axis=2)


def _residuals(basis: ReducedBasis, omega: Array, rates: Array, vectors: NDArray[Any]) -> Array:
    """Relative residuals rho (k, q), with what rounding leaves uncertain of them."""
    c = _coefficients(basis, omega, rates, vectors)
    moved = (c.reshape(-1, c.shape[2]) @ basis.gram).reshape(c.shape)
    squared = np.einsum("kqb,kqb->kq", c.conj(), moved).real
    lost = PRECISION * (np.abs(c) @ np.sqrt(np.maximum(np.diagonal(basis.gram), 0.0))) ** 2
    held = basis.held(omega)
    energy = rates**2
    if basis.coriolis is not None:
        energy = 0.5 * (energy + (held[:, :, None] * np.abs(basis.axes.T @ vectors) ** 2).sum(axis=1))
    floor = held.min(axis=1)[:, None]
    squared = (np.maximum(squared, 0.0) + lost) / (2.0 * energy * np.maximum(floor, LEAST))
    return np.where(floor > 0.0, np.sqrt(squared), np.inf)


def _count_below(basis: ReducedBasis, omega: Array, rates: Array) -> NDArray[np.int64]:
    """Upper bound (k,) on the number of the full model's frequencies below given ones (k,); -1 if none."""
    r = basis.size
    shift = basis.shift(omega)
    weights: list[NDArray[Any]] = [shift, -(rates**2)]
    form = np.eye(r) + shift[:, None, None] * basis.gram[:r, r : 2 * r] - (rates**2)[:, None, None] * basis.mass
    drag = rates**2
    if basis.coriolis is not None:
        weights.append(1j * omega * rates)
        form = form + (1j * omega * rates)[:, None, None] * basis.coriolis
        drag = drag + 2.0 * rates * omega
    margin = 1.0 - np.abs(shift) * basis.stretch_outside - drag / basis.known[-1]
    safe = np.where(margin > 0.0, margin, 1.0)
    blocks = basis.outside.reshape(len(weights), r, len(weights), r)
    for a, left in enumerate(weights):
        for b, right in enumerate(weights):
            form = form - (left.conj() * right / safe)[:, None, None] * blocks[a, :, b]
    negative = (np.linalg.eigvalsh(form) < 0.0).sum(axis=1)
    return np.where(margin > 0.0, negative, -1)
