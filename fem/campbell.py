"""The Campbell diagram: frequencies over speed, for about the price of one modal analysis.

With a linear prestress every speed is answered by a reduced basis (`fem.basis`) with a bound on the error of
every frequency (`fem.bounds`). The basis grows until the bounds meet the tolerance; a range of speeds for which
it would grow too large is halved. With large deflection the modes are solved speed by speed, each from the
state before.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fem import bounds
from fem.basis import ReducedBasis, begin, enrich
from fem.critical import critical_speed
from fem.family import FAMILIES, energy_shares, share_matrices
from fem.modes import Divergence, solve_modes, solve_real
from fem.solver import CONVERGED
from fem.tracking import Veering, follow

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.operators import Operators

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

AIM = 0.3
"""Part of the tolerance that is aimed at in training, so that the other speeds meet it too."""

MOST_KNOWN = 100
"""Modes at the reference speed that are tried to find a gap above the wanted ones."""

NEAR = 0.3
"""Least ratio of stiffness to that at the reference for which more modes, not a nearer reference, are tried."""

NARROW = 1e-6
"""Relative width of a range of speeds that is not halved any more."""


@dataclass(frozen=True)
class Campbell:
    """Modes over speed.

    omega: (k,) speeds in rad/s, ascending, below the critical one. frequencies_hz: (k, count), ascending at
    each speed. bounds: (k, count), on their relative error against the full model. damping_ratios: (k, count).
    branches: (k, count), which mode of the first speed each one continues. shares: (k, 5, count), see
    `fem.family`. veerings: where this is ambiguous. diverged: the speeds asked for that lie at or beyond the
    critical one. sizes: vectors in each reduced basis used.
    """

    omega: Array
    frequencies_hz: Array
    bounds: Array
    damping_ratios: Array
    branches: NDArray[np.int64]
    shares: Array
    veerings: tuple[Veering, ...]
    diverged: Array
    sizes: tuple[int, ...]

    @property
    def families(self) -> list[list[str]]:
        """The family of every mode at every speed."""
        return [[FAMILIES[k] for k in row] for row in self.shares.argmax(axis=1)]


@dataclass(frozen=True)
class _Part:
    """Answers for some speeds: numbers (k, count), shapes basis (n, r) @ vectors (k, r, q)."""

    rates: Array
    bounds: Array
    damping: Array
    shares: Array
    vectors: NDArray[Any]
    basis: Array
    reduced: bool


def campbell(
    operators: Operators,
    omega: Array,
    count: int = 6,
    *,
    tolerance: float = 1e-6,
    damping_ratio: float = 0.0,
) -> Campbell:
    """Find the count lowest modes at speeds (k,) in rad/s, each frequency bounded to a relative tolerance.

    damping_ratio: as in `solve_modes`, to first order. Raises ValueError for no speeds or a count or
    tolerance out of range, and Divergence when every speed is at or beyond the critical one.
    """
    asked = np.unique(np.asarray(omega, dtype=float))
    if asked.size == 0 or not np.isfinite(asked).all() or asked[0] < 0.0:
        raise ValueError("campbell needs at least one speed, finite and not negative")
    if count < 1 or not 0.0 < tolerance < 1.0:
        raise ValueError(
            f"count must be at least 1 and tolerance between 0 and 1, got {count!r} and {tolerance!r}"
        )
    sweep = _speed_by_speed if operators.effects.large_deflection else _reduced
    try:
        below, parts = asked, sweep(operators, asked, count, tolerance, damping_ratio)
    except Divergence:
        below = asked[asked < critical_speed(operators)]
        if below.size in (0, asked.size):
            raise
        parts = sweep(operators, below, count, tolerance, damping_ratio)
    branches, veerings = follow(_likeness(operators, parts), count)
    return Campbell(
        omega=below,
        frequencies_hz=np.vstack([part.rates for part in parts]) / (2.0 * np.pi),
        bounds=np.vstack([part.bounds for part in parts]),
        damping_ratios=np.vstack([part.damping for part in parts]),
        branches=branches,
        shares=np.concatenate([part.shares for part in parts]),
        veerings=veerings,
        diverged=asked[below.size :],
        sizes=tuple(part.basis.shape[1] for part in parts if part.reduced),
    )


def _reduced(
    operators: Operators,
    omega: Array,
    count: int,
    tolerance: float,
    damping_ratio: float,
    spare: int = bounds.SPARE,
) -> list[_Part]:
    """Answer speeds (k,) from one reduced basis, or from one for each half."""
    reference = float(omega[0] + REFERENCE * (omega[-1] - omega[0]))
    known = count + spare + 1
    modes = solve_real(operators, reference, operators.at(reference), known, tolerance=ROUGH)
    basis = begin(operators, modes)
    tolerance = max(tolerance, 4.0 * basis.rounding)
    training = np.linspace(omega[0], omega[-1], TRAINING)
    for _ in range(ROUNDS):
        trial = bounds.solve(basis, training, count)
        if (trial.bounds <= AIM * tolerance).all():
            found = bounds.solve(basis, omega, count)
            if (found.bounds <= tolerance).all():
                return [_answer(operators, basis, found, count, damping_ratio)]
            training = np.append(training, omega[np.argsort(-found.bounds.max(axis=1))[:2]])
            trial = bounds.solve(basis, training, count)
        if trial.diverged.any():
            worst = float(training[trial.diverged][0])
            solve_real(operators, worst, operators.at(worst), count)
        more = bounds.representatives(basis, trial, count, AIM * tolerance / (2 * count))
        if more.shape[1] == 0 or more.shape[1] + basis.size > known + LARGEST:
            break
        basis = enrich(operators, modes, basis, more)
    gapless = np.isinf(trial.bounds).any(axis=1) & (trial.floor > NEAR)
    if gapless.any() and modes.eigenvalues.size == known < MOST_KNOWN:
        return _reduced(operators, omega, count, tolerance, damping_ratio, 4 * spare)
    if omega[-1] - omega[0] <= NARROW * omega[-1]:
        return [_answer(operators, basis, bounds.solve(basis, omega, count), count, damping_ratio)]
    half = int(np.searchsorted(omega, 0.5 * (omega[0] + omega[-1]), side="right"))
    return [
        part
        for piece in (omega[:half], omega[half:])
        for part in _reduced(operators, piece, count, tolerance, damping_ratio)
    ]


def _answer(
    operators: Operators,
    basis: ReducedBasis,
    found: bounds.ReducedModes,
    count: int,
    damping_ratio: float,
) -> _Part:
    rates, vectors = found.rates[:, :count], found.vectors[:, :, :count]
    columns = vectors.transpose(1, 0, 2).reshape(basis.size, -1)
    moved = share_matrices(operators, basis.vectors) @ columns
    shares = (columns.conj() * moved).sum(axis=1).real.reshape(len(FAMILIES), -1, count).swapaxes(0, 1)
    damping = np.full(rates.shape, damping_ratio)
    if basis.coriolis is not None and damping_ratio > 0.0:
        damping = _shared_damping(basis, found.omega, rates, vectors, damping_ratio)
    return _Part(rates, found.bounds, damping, shares / shares.sum(axis=1, keepdims=True), found.vectors, basis.vectors, True)


def _shared_damping(
    basis: ReducedBasis, omega: Array, rates: Array, vectors: NDArray[Any], ratio: float
) -> Array:
    """Damping ratios (k, count) to first order: x' C x / (2 w x' M x - i Omega x' G x) for C = 2 ratio K^(1/2)."""
    values, own = np.linalg.eigh(basis.elastic + omega[:, None, None] ** 2 * basis.stiffening)
    along = np.abs(own.transpose(0, 2, 1) @ vectors) ** 2
    lost = 2.0 * ratio * np.einsum("kr,krc->kc", np.sqrt(np.maximum(values, 0.0)), along)
    turning = np.einsum("krc,rs,ksc->kc", vectors.conj(), basis.coriolis, vectors, optimize=True)
    return np.asarray(lost / (2.0 * rates + (omega[:, None] * turning).imag))


def _speed_by_speed(
    operators: Operators, omega: Array, count: int, tolerance: float, damping_ratio: float
) -> list[_Part]:
    """Solve each speed (k,) in full, its static state starting from the one before."""
    parts: list[_Part] = []
    state = None
    for speed in omega:
        modes = solve_modes(
            operators, float(speed), count + 1, start=state, damping_ratio=damping_ratio
        )
        state = modes.state
        rates = np.sqrt(modes.eigenvalues)[None, :count]
        shares = energy_shares(operators, modes.shapes[:, :count])[None]
        error = np.full_like(rates, CONVERGED)
        damping = modes.damping_ratios[None, :count]
        one = np.eye(modes.shapes.shape[1])[None]
        parts.append(_Part(rates, error, damping, shares, one, modes.shapes, False))
    return parts


def _likeness(operators: Operators, parts: list[_Part]) -> Array:
    """MAC (k - 1, q, q) between the modes at each speed and those at the next."""
    q = min(part.vectors.shape[2] for part in parts)
    steps = []
    for here, following in zip(parts, [*parts[1:], None], strict=True):
        vectors = here.vectors[:, :, :q]
        steps.append(np.swapaxes(vectors[:-1].conj(), 1, 2) @ vectors[1:])
        if following is not None:
            cross = here.basis.conj().T @ (operators.mass @ following.basis)
            steps.append((vectors[-1].conj().T @ cross @ following.vectors[0, :, :q])[None])
    return np.asarray(np.abs(np.concatenate(steps)) ** 2)
