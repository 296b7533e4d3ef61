"""Growing a reduced basis until it answers every speed of a range within a tolerance.

The basis is trained at a few speeds: it takes in the representers of the residuals there until the bounds
(`fem.sweep.error_bounds`) meet the tolerance, and is then tried at all speeds. Where no gap is found above the wanted
modes, more modes are known at the reference speed; where the basis would grow too large, the range is halved.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.modes.real import FAMILIES, share_matrices, solve_real
from fem.sweep import error_bounds
from fem.sweep.reduced_basis import ReducedBasis, begin, enrich, still

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]


LARGEST = 60
"""Vectors at which a basis counts as too large for its range of speeds."""

TRAINING = 7
"""Speeds at which a basis is trained before all are tried."""

ROUNDS = 6
"""Times a basis is enriched before its range is halved."""

REFERENCE = 0.65
"""Where in a range of speeds its reference lies: midway for Omega², nearly."""

ROUGH = 1e-4
"""Residual of the modes a basis begins with; the bounds see what they lack."""

AIM = 0.6
"""Part of the tolerance that is aimed at in training, so that the other speeds meet it too."""

SPARES = (1, 4, 16)
"""Modes beyond the wanted ones among which a gap is sought, in turn."""

NEAR = 0.3
"""Least ratio of stiffness to that at the reference for which more modes, not a nearer reference, are tried."""

HALVINGS = 6
"""How often a range of speeds is halved at most."""

FEW = 16
"""Speeds up to which what one basis leaves open is dearer to answer by others than speed by speed."""


@dataclass(frozen=True, eq=False)
class Swept:
    """Modes at k speeds.

    Attributes:
        omega: the speeds (k,) in rad/s.
        rates: circular frequencies (k, count) in rad/s.
        bounds: on their relative error.
        damping: ratios (k, count).
        shares: (k, 5, count), see `fem.modes.real`. The shapes are basis (n, r) @ vectors (k, r, q), q >= count.
        reduced: whether from a reduced basis.
        met: speeds (k,) whose bounds are within the tolerance, or as good as rounding allows.
        state: the displacement (n,) vibrated about, where the deflection is large.
    """

    omega: Array
    rates: Array
    bounds: Array
    damping: Array
    shares: Array
    vectors: NDArray[Any]
    basis: Array
    reduced: bool
    met: NDArray[np.bool_]
    state: Array | None = None

    def only(self, rows: NDArray[np.int64]) -> Swept:
        """The same at some of the speeds."""
        names = ("omega", "rates", "bounds", "damping", "shares", "vectors", "met")
        return replace(self, **{name: getattr(self, name)[rows] for name in names})


def answer(
    operators: Operators,
    omega: Array,
    count: int,
    tolerance: float,
    damping_ratio: float,
    halvings: int = HALVINGS,
) -> list[Swept]:
    """Answer speeds (k,) from one reduced basis, or from one for each half; bounds say what was achieved.

    FEW speeds have one basis alone.

    Raises:
        Divergence: when a speed is found to be beyond the critical one.
    """
    if omega.size > FEW:
        return _by_halves(operators, omega, count, tolerance, damping_ratio, halvings)
    basis, found, _ = grow(operators, omega, count, tolerance, SPARES[0])
    return [_collect(operators, basis, found, count, tolerance, damping_ratio)]


def _by_halves(
    operators: Operators, omega: Array, count: int, tolerance: float, damping_ratio: float, halvings: int
) -> list[Swept]:
    for spare in SPARES:
        basis, found, gapless = grow(operators, omega, count, tolerance, spare)
        if found.within(tolerance).all() or omega.size == 1:
            return [_collect(operators, basis, found, count, tolerance, damping_ratio)]
        if not gapless:
            break
    if halvings == 0:
        return [_collect(operators, basis, found, count, tolerance, damping_ratio)]
    half = int(np.searchsorted(omega, 0.5 * (omega[0] + omega[-1]), side="right"))
    return [
        part
        for piece in (omega[:half], omega[half:])
        for part in _by_halves(operators, piece, count, tolerance, damping_ratio, halvings - 1)
    ]


def grow(
    operators: Operators, omega: Array, count: int, tolerance: float, spare: int
) -> tuple[ReducedBasis, error_bounds.ReducedModes, bool]:
    """Grow a basis for speeds (k,) from count + spare modes, and say whether it lacks a gap above the wanted."""
    reference = float(omega[0] + REFERENCE * (omega[-1] - omega[0]))
    known = count + spare + 1
    stiffness = operators.at(reference)
    modes = solve_real(operators, reference, stiffness, known, tolerance=ROUGH)
    basis = begin(operators, stiffness, modes)
    training = np.linspace(omega[0], omega[-1], TRAINING)
    for _ in range(ROUNDS):
        trial = error_bounds.solve(basis, training, count)
        if trial.within(AIM * tolerance).all():
            found = error_bounds.solve(basis, omega, count)
            if found.within(tolerance).all():
                return basis, found, False
            training = np.append(training, omega[np.argsort(-found.bounds.max(axis=1))[:2]])
            trial = error_bounds.solve(basis, training, count)
        if (trial.floor <= 0.0).any():
            worst = float(training[trial.floor <= 0.0][0])
            solve_real(operators, worst, operators.at(worst), count)
        finest = AIM * tolerance / (2 * count)
        more = error_bounds.representatives(basis, trial, count, finest)
        if more.shape[1] == 0:  # the mode above the wanted ones may stand in the way of their bounds
            more = error_bounds.representatives(basis, trial, count + 1, finest)
        if more.shape[1] == 0 or more.shape[1] + basis.size > known + LARGEST:
            break
        basis = enrich(operators, stiffness, modes, basis, more)
    gapless = np.isinf(trial.bounds).any(axis=1) & (trial.floor > NEAR)
    return basis, error_bounds.solve(basis, omega, count), bool(gapless.any())


def _collect(
    operators: Operators,
    basis: ReducedBasis,
    found: error_bounds.ReducedModes,
    count: int,
    tolerance: float,
    damping_ratio: float,
) -> Swept:
    rates, vectors = found.rates[:, :count], found.vectors[:, :, :count]
    rows = vectors.transpose(0, 2, 1).reshape(-1, basis.size)
    moved = rows @ share_matrices(operators, basis.vectors)
    shares = np.einsum("nr,fnr->fn", rows.conj(), moved).real.reshape(len(FAMILIES), -1, count).swapaxes(0, 1)
    damping = np.full(rates.shape, damping_ratio)
    if basis.coriolis is not None and damping_ratio > 0.0:
        damping = _shared_damping(basis, basis.coriolis, found.omega, rates, vectors, damping_ratio)
    parts = shares / shares.sum(axis=1, keepdims=True)
    met = found.within(tolerance)
    return Swept(found.omega, rates, found.bounds, damping, parts, found.vectors, basis.vectors, True, met)


def _shared_damping(
    basis: ReducedBasis, coriolis: Array, omega: Array, rates: Array, vectors: NDArray[Any], ratio: float
) -> Array:
    """Damping ratios (k, count) to first order: x' C x / (2 w x' M x - i Omega x' G x) for C = 2 ratio K^(1/2)."""
    own, shapes = still(basis, omega, basis.size)
    along = np.abs(shapes.transpose(0, 2, 1) @ basis.mass @ vectors) ** 2
    lost = 2.0 * ratio * np.einsum("kr,krc->kc", own, along)
    turning = np.einsum("krc,rs,ksc->kc", vectors.conj(), coriolis, vectors, optimize=True)
    return np.asarray(lost / (2.0 * rates + (omega[:, None] * turning).imag))
