"""A reduced basis for a range of speeds: small matrices that answer for every speed in it.

The matrices are affine: K(Omega) = K_r + (Omega² - Omega_r²) K_1, with one factor, at a reference speed r. The
basis V, orthonormal in K_r, starts with the modes there; in the axes of K_1 the small stiffness is diagonal at every
speed, so that the lowest frequencies keep their digits however stiff the highest. Unknowns that no matrix couples, as
those in the plane of a flat plate and out of it, share no vector: each group of vectors is solved by itself. Everything
a residual can be made of lies in span(V, K_r^-1 K_1 V, K_r^-1 M V, K_r^-1 G V); with the Gram matrix of these vectors
in K_r, dual norms of residuals cost r³ at any speed. New vectors are the dominant parts of the residuals' own
representers.

It grows until it answers every speed of a range within a tolerance, and answers other speeds, or the same without
Coriolis forces, wherever its bounds meet the tolerance there, too. Trained at a few speeds, it takes in the
representers of the residuals there until the bounds meet the tolerance, and is then tried at all speeds. Where no gap
is found above the wanted modes, more modes are known at the reference speed; where the basis would grow too large, the
range is halved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray
from scipy.linalg import polar
from scipy.sparse import csc_array
from scipy.sparse.csgraph import connected_components

from fem.assembly import Operators
from fem.linalg import Array, Ints, forms, orthonormal, rounding, symmetric
from fem.modes import Modes, share_matrices, solve_real

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
        groups: numbers of the vectors that are coupled with one another.
        stretches: eigenvalues (r,) of V'K_1 V, and axes (r, r) its eigenvectors, both group by group.
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
    groups: tuple[Ints, ...]
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

    @property
    def alone(self) -> ReducedBasis:
        """The basis as it solves, without what only growing needs."""
        return replace(self, images=(), representers=())

    @property
    def without_coriolis(self) -> ReducedBasis:
        """The basis for the same plate without Coriolis forces."""
        spanned, outside = 3 * self.size, 2 * self.size
        return replace(
            self.alone,
            coriolis=None,
            gram=self.gram[:spanned, :spanned],
            outside=self.outside[:outside, :outside],
        )

    def held(self, omega: Array) -> Array:
        """Eigenvalues (k, r) of V'K(Omega) V: the stiffness at each speed over that at the reference."""
        return np.asarray(1.0 + self.shift(omega)[:, None] * self.stretches)


def begin(operators: Operators, stiffness: csc_array, modes: Modes) -> ReducedBasis:
    """The basis of the real modes at the reference speed.

    Args:
        operators: of the plate.
        stiffness: K_r, shape (n, n) [N/m].
        modes: of this stiffness; the last of them only says what lies above the basis.
    """
    shapes = modes.shapes[:, :-1] / np.sqrt(modes.eigenvalues[:-1])
    blocks = []
    for part in _uncoupled(operators):
        own = np.where(part[:, None], shapes, 0.0)
        own = own[:, np.einsum("nk,nk->k", own, stiffness @ own) > LEAST_PART]
        block, energy, _, coupling = orthonormal(own, stiffness)
        # back to the modes: in a mixture the large representer of a soft one drowns a stiff one's
        back = polar(coupling[:, : len(coupling)])[0]
        blocks.append((block @ back, energy @ back))
    return _with_blocks(operators, stiffness, modes, blocks)


LEAST_PART = 1e-3
"""Energy of a mode among unknowns of a part, relative to the mode's, from which it is not what the iteration left."""


def _uncoupled(operators: Operators) -> list[NDArray[np.bool_]]:
    """Which unknowns (n,) belong to each of the parts that no matrix couples."""
    coupled: csc_array = abs(operators.stiffness) + abs(operators.mass) + abs(operators.spinning)
    if operators.gyroscopic is not None:
        coupled = coupled + abs(operators.gyroscopic)
    coupled.eliminate_zeros()
    count, part = connected_components(coupled, directed=False)
    return [part == number for number in range(count)]


def _with_blocks(
    operators: Operators,
    stiffness: csc_array,
    modes: Modes,
    blocks: list[tuple[Array, Array]],
    basis: ReducedBasis | None = None,
) -> ReducedBasis:
    """A basis, or none, with blocks of orthonormal vectors (n, k) added, each with its image under K_r (n, k)."""
    vectors, energy = (np.hstack(each) for each in zip(*blocks, strict=True))
    images = [energy, operators.mass @ vectors, operators.spinning @ vectors]
    if operators.gyroscopic is not None:
        images.append(operators.gyroscopic @ vectors)
    loads = [images[2], images[1], *images[3:]]
    representers = np.split(modes.factor.solve(np.hstack(loads)), len(loads), axis=1)
    uncertain = rounding(stiffness, vectors, np.ones(vectors.shape[1]))
    if basis is not None:
        vectors, uncertain = np.hstack([basis.vectors, vectors]), np.append(basis.rounding, uncertain)
        images, representers = (
            [np.hstack(pair) for pair in zip(old, new, strict=True)]
            for old, new in ((basis.images, images), (basis.representers, representers))
        )
    energy, heavy, spinning, *turning = images
    r = vectors.shape[1]
    span = np.hstack([vectors, *representers])
    gram = symmetric(span.T @ np.hstack([energy, spinning, heavy, *turning]))
    outside = gram[r:, r:] - gram[r:, :r] @ gram[:r, r:]
    left = representers[0] - vectors @ gram[:r, r : 2 * r]
    groups, stretches, axes = _groups(gram, r), np.empty(r), np.zeros((r, r))
    for group in groups:
        stretches[group], axes[np.ix_(group, group)] = np.linalg.eigh(gram[:r, r : 2 * r][np.ix_(group, group)])
    return ReducedBasis(
        reference=modes.omega,
        vectors=vectors,
        images=tuple(images),
        representers=tuple(representers),
        mass=symmetric(vectors.T @ heavy),
        coriolis=vectors.T @ turning[0] if turning else None,
        groups=groups,
        stretches=stretches,
        axes=axes,
        gram=gram,
        outside=outside,
        known=modes.eigenvalues,
        stretch_outside=SAFETY * max(map(abs, _extremes(left.T @ (operators.spinning @ left), outside[:r, :r]))),
        rounding=uncertain,
    )


def _groups(gram: Array, r: int) -> tuple[Ints, ...]:
    """Numbers of the vectors (r,) that are coupled with one another, themselves or by their representers."""
    count, group = connected_components((gram[:r] != 0.0).reshape(r, -1, r).any(axis=1), directed=False)
    return tuple(np.flatnonzero(group == number) for number in range(count))


def _extremes(a: Array, b: Array) -> tuple[float, float]:
    """Smallest and largest eigenvalue of the pencil (a, b), with b's null space left out."""
    values, vectors = np.linalg.eigh(symmetric(b))
    keep = values > 1e-12 * max(values[-1], 0.0)
    if not keep.any():
        return 0.0, 0.0
    whitened = vectors[:, keep] / np.sqrt(values[keep])
    eigenvalues = np.linalg.eigvalsh(whitened.T @ symmetric(a) @ whitened)
    return float(eigenvalues[0]), float(eigenvalues[-1])


LEAST = float(np.finfo(float).eps)
"""What counts as no stiffness; a speed that leaves less has no lowest frequency."""


def modes_within(basis: ReducedBasis, omega: Array, count: int, coriolis: Array | None) -> tuple[Array, NDArray[Any]]:
    """Modes within the basis, group by group.

    Args:
        basis: of r vectors.
        omega: speeds (k,) [rad/s].
        count: number of modes.
        coriolis: V'G V, shape (r, r); None: without Coriolis forces.

    Returns:
        Circular frequencies (k, count) [rad/s], ascending, and mass-normalised vectors (k, r, count), complex with
        Coriolis forces.
    """
    rates, rows = [], []
    soft = np.maximum(basis.held(omega), LEAST) ** -0.5  # roots (k, r) of the small stiffness's inverse, along the axes
    for group in basis.groups:
        own = np.ix_(group, group)
        axes = basis.axes[own]
        mass, alone = axes.T @ basis.mass[own] @ axes, soft[:, group]
        if coriolis is None or not coriolis[own].any():
            values, vectors = _still(alone, mass, count)
        else:
            values, vectors = _turning(alone, mass, omega, axes.T @ coriolis[own] @ axes, count)
        turned = vectors.transpose(0, 2, 1).reshape(-1, group.size) @ axes.T  # one product, not k
        row = np.zeros((*values.shape, basis.size), dtype=float if coriolis is None else complex)
        row[:, :, group] = turned.reshape(*values.shape, -1)
        rates.append(values)
        rows.append(row)
    every = np.concatenate(rates, axis=1)
    order = every.argsort(axis=1)[:, :count]
    chosen = np.take_along_axis(np.concatenate(rows, axis=1), order[:, :, None], axis=1)
    return np.take_along_axis(every, order, axis=1), chosen.transpose(0, 2, 1)


def _still(soft: Array, mass: Array, count: int) -> tuple[Array, Array]:
    """Frequencies (k, q) and vectors (k, r, q) along the axes by the softness (k, r) and the mass (r, r) in them."""
    values, vectors = np.linalg.eigh(soft[:, :, None] * mass * soft[:, None, :])
    rates = _inverse(values[:, : -count - 1 : -1]) ** 0.5
    return rates, soft[:, :, None] * vectors[:, :, : -count - 1 : -1] * rates[:, None, :]


def _turning(soft: Array, mass: Array, omega: Array, coriolis: Array, count: int) -> tuple[Array, NDArray[Any]]:
    """The same with Coriolis forces, Omega times A'V'G V A (r, r) along the axes A."""
    r = soft.shape[1]
    squares, directions = np.linalg.eigh(mass)
    root = np.sqrt(np.maximum(squares, 0.0))[:, None] * directions.T

    def matrices(rows: Any) -> NDArray[Any]:
        own = soft[rows]
        state = np.zeros((len(own), 2 * r, 2 * r), dtype=complex)
        state[:, :r, :r] = -1j * own[:, :, None] * (omega[rows, None, None] * coriolis) * own[:, None, :]
        state[:, r:, :r] = root * own[:, None, :]
        state[:, :r, r:] = state[:, r:, :r].transpose(0, 2, 1)
        return state

    def times(vectors: NDArray[Any]) -> NDArray[Any]:
        moved, low = soft[:, :, None] * vectors[:, :r], vectors[:, r:]
        dragged = -1j * omega[:, None, None] * (coriolis @ moved)
        return np.concatenate([soft[:, :, None] * (dragged + root.T @ low), root @ moved], axis=1)

    values, vectors = _largest(matrices, times, omega, min(count, r))
    rates, speeds = _inverse(values), np.linalg.norm(vectors[:, r:], axis=1)
    return rates, soft[:, :, None] * vectors[:, :r] * (rates / speeds)[:, None, :]


MANY = 200
"""Matrices from which on eigenvectors are interpolated between speeds."""

NODES = 24
"""Speeds between which they are interpolated."""

INTERPOLATED = 1e-10
"""Residual, relative to the eigenvalue, up to which interpolated eigenvectors count as exact."""

ORTHONORMAL = 1e-8
"""Product of two interpolated vectors up to which one step makes them orthonormal."""


def _largest(
    matrices: Callable[[Any], NDArray[Any]],
    times: Callable[[NDArray[Any]], NDArray[Any]],
    speeds: Array,
    count: int,
) -> tuple[Array, NDArray[Any]]:
    """The largest eigenvalues (k, count), descending, and vectors (k, m, count) of Hermitian matrices (k, m, m).

    Of many, the space of the vectors is interpolated between a few speeds, at each speed the Ritz vectors are taken in
    it, and matrices whose residuals show that this does not do are solved by themselves.

    Args:
        matrices: gives those of some rows.
        times: gives the products of all with vectors (k, m, count).
        speeds: on which they depend smoothly, (k,).
        count: of eigenvalues.
    """
    if speeds.size < MANY:
        return _topmost(matrices(slice(None)), count)
    places = 2.0 * (speeds - speeds.min()) / np.ptp(speeds) - 1.0
    nodes = np.unique(np.abs(places[:, None] - np.cos(np.linspace(0.0, np.pi, NODES))).argmin(axis=0))
    spaces = _topmost(matrices(nodes), count)[1]
    left, _, right = np.linalg.svd(spaces.conj().swapaxes(1, 2) @ spaces[len(nodes) // 2])
    spaces = spaces @ (left @ right)  # orthonormal bases that change smoothly
    known, wanted = (chebvander(each, len(nodes) - 1) for each in (places[nodes], places))
    near = (np.linalg.solve(known.T, wanted.T).T @ spaces.reshape(len(nodes), -1)).reshape(-1, *spaces.shape[1:])
    skew = near.conj().swapaxes(1, 2) @ near - np.eye(count)
    near = near - 0.5 * near @ skew
    moved = times(near)
    values, turned = _topmost(near.conj().swapaxes(1, 2) @ moved, count)
    vectors = near @ turned
    residuals = np.linalg.norm(moved @ turned - vectors * values[:, None], axis=1) / np.abs(values)
    exact = (residuals.max(axis=1) <= INTERPOLATED) & (np.abs(skew).max(axis=(1, 2)) <= ORTHONORMAL)
    alone = np.flatnonzero(~exact)
    values[alone], vectors[alone] = _topmost(matrices(alone), count)
    return values, vectors


def _topmost(matrices: NDArray[Any], count: int) -> tuple[Array, NDArray[Any]]:
    """The largest eigenvalues (k, count), descending, and vectors (k, m, count), each matrix by itself."""
    values, vectors = np.linalg.eigh(matrices)
    return values[:, : -count - 1 : -1], vectors[:, :, : -count - 1 : -1]


def _inverse(values: Array) -> Array:
    return np.asarray(1.0 / np.maximum(values, np.finfo(float).tiny))


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
        bounds: (k, wanted) on the relative error of the frequencies; inf where none can be shown.
        rounding: (k, wanted), what double precision leaves uncertain, which the bounds contain.
        floor: (k,), least ratio of the stiffness to that at the reference speed; not positive where the plate diverges.
    """

    omega: Array
    rates: Array
    vectors: NDArray[Any]
    bounds: Array
    rounding: Array
    floor: Array

    def within(self, tolerance: float) -> NDArray[np.bool_]:
        """Which speeds (k,) have every frequency within a relative tolerance, or as exact as rounding allows."""
        return np.asarray((self.bounds <= np.maximum(tolerance, ROUNDED * self.rounding)).all(axis=1))


def solve(basis: ReducedBasis, omega: Array, wanted: int) -> ReducedModes:
    """The lowest modes within the basis, with bounds on their errors against the full model.

    Args:
        basis: of r vectors.
        omega: speeds (k,) [rad/s].
        wanted: number of modes that bounds are wanted for.
    """
    q = min(basis.known.size, basis.size) - 1
    rates, vectors = modes_within(basis, omega, q + 1, basis.coriolis)
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
    return ReducedModes(omega, rates, vectors, bounds, rounding[:, :wanted], floor)


def _errors(rates: Array, amount: Array, last: Ints, inside: NDArray[np.bool_]) -> Array:
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


def _gap(basis: ReducedBasis, omega: Array, rates: Array, last: Ints) -> Array:
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


def representatives(basis: ReducedBasis, modes: ReducedModes, wanted: int, tolerance: float) -> list[Array]:
    """The fewest vectors that hold the residuals' representers K_r^-1 r of the wanted modes.

    Args:
        basis: of the modes.
        modes: solved within it.
        wanted: number of modes.
        tolerance: on the sum of the squares of what the vectors leave out, relative to the modes.

    Returns:
        Vectors (n, m) of each group that has any.
    """
    coefficients = _coefficients(basis, modes.omega, modes.rates, modes.vectors)[:, :wanted]
    size = np.sqrt(2.0) * modes.rates[:, :wanted, None]
    flat = (coefficients / size).reshape(-1, coefficients.shape[2]).T
    flat = np.hstack([flat.real, flat.imag]) if np.iscomplexobj(flat) else flat
    span, parts = np.hstack([basis.vectors, *basis.representers]), []
    for group in basis.groups:
        own = np.where(np.isin(np.arange(len(flat)) % basis.size, group)[:, None], flat, 0.0)
        weights, directions = np.linalg.eigh(own.T @ basis.gram @ own)
        parts.append((np.maximum(weights, 0.0), own @ directions))
    every = np.sort(np.concatenate([weights for weights, _ in parts]))
    least = every[np.searchsorted(every.cumsum(), tolerance, side="right") :].min(initial=np.inf)
    more = [span @ directions[:, weights >= least] for weights, directions in parts]
    return [each for each in more if each.size]


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
    squared = forms(basis.gram[None], c)[0]
    lost = PRECISION * (np.abs(c) @ np.sqrt(np.maximum(np.diagonal(basis.gram), 0.0))) ** 2
    states = basis.held(omega)
    energy = rates**2
    if basis.coriolis is not None:
        energy = 0.5 * (energy + (states[:, :, None] * np.abs(basis.axes.T @ vectors) ** 2).sum(axis=1))
    floor = states.min(axis=1)[:, None]
    squared = (np.maximum(squared, 0.0) + lost) / (2.0 * energy * np.maximum(floor, LEAST))
    return np.asarray(np.sqrt(np.where(floor > 0.0, squared, np.inf)))


def _count_below(basis: ReducedBasis, omega: Array, rates: Array) -> Ints:
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
class Question:
    """What is asked of a plate at every speed.

    Attributes:
        operators: of the plate.
        count: number of modes.
        tolerance: relative, of each frequency.
        damping_ratio: of the modes without Coriolis forces [-].
    """

    operators: Operators
    count: int
    tolerance: float
    damping_ratio: float = 0.0


@dataclass(frozen=True, eq=False)
class Swept:
    """Modes at k speeds.

    Attributes:
        omega: the speeds (k,) in rad/s.
        rates: circular frequencies (k, count) in rad/s.
        bounds: on their relative error.
        damping: ratios (k, count).
        shares: (k, 5, count), see `fem.modes`. The shapes are basis (n, r) @ vectors (k, r, q), q >= count.
        reduced: the reduced basis they are from; None: they were solved in full.
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
    reduced: ReducedBasis | None
    met: NDArray[np.bool_]
    state: Array | None = None

    def only(self, rows: Ints) -> Swept:
        """The modes at some of the speeds, by their indices."""
        names = ("omega", "rates", "bounds", "damping", "shares", "vectors", "met")
        return replace(self, **{name: getattr(self, name)[rows] for name in names})


def answer_again(question: Question, omega: Array, bases: Iterable[ReducedBasis]) -> Swept | None:
    """Modes at speeds (k,) [rad/s] from the first basis of these matrices that meets the tolerance; None: none does."""
    for basis in bases:
        if min(basis.size, basis.known.size) > question.count:
            solved = solve(basis, omega, question.count)
            if solved.within(question.tolerance).all():
                return _collect(question, basis, solved)
    return None


def answer(question: Question, omega: Array) -> list[Swept]:
    """Modes at many speeds from one reduced basis, or from one for each part of the range.

    Args:
        question: what is asked; the bounds say what was achieved of its tolerance.
        omega: speeds (k,) [rad/s], ascending; up to `FEW` have a single basis.

    Raises:
        Divergence: when a speed is found to be beyond the critical one.
    """
    few = omega.size <= FEW
    parts, open_ranges = [], [(omega, 0 if few else HALVINGS)]
    while open_ranges:
        speeds, left = open_ranges.pop()
        for spare in SPARES[:1] if few else SPARES:
            basis, solved, gapless = grow(question, speeds, spare)
            done = solved.within(question.tolerance).all() or speeds.size == 1
            if done or not gapless:
                break
        if done or left == 0:
            parts.append(_collect(question, basis, solved))
        else:
            half = int(np.searchsorted(speeds, 0.5 * (speeds[0] + speeds[-1]), side="right"))
            open_ranges += [(speeds[half:], left - 1), (speeds[:half], left - 1)]
    return parts


def grow(question: Question, omega: Array, spare: int) -> tuple[ReducedBasis, ReducedModes, bool]:
    """Grow a basis for a range of speeds.

    Args:
        question: what is asked.
        omega: speeds (k,) [rad/s], ascending.
        spare: modes beyond those asked for with which the basis begins.

    Returns:
        The basis, its modes at the speeds, and whether it lacks a gap above the wanted modes.
    """
    operators, count, tolerance = question.operators, question.count, question.tolerance
    reference = float(omega[0] + REFERENCE * (omega[-1] - omega[0]))
    known = count + spare + 1
    stiffness = operators.at(reference)
    modes = solve_real(operators, reference, stiffness, known, tolerance=ROUGH)
    basis = begin(operators, stiffness, modes)
    training = np.linspace(omega[0], omega[-1], TRAINING)
    for _ in range(ROUNDS):
        trial = solve(basis, training, count)
        if trial.within(AIM * tolerance).all():
            solved = solve(basis, omega, count)
            if solved.within(tolerance).all():
                return basis, solved, False
            training = np.append(training, omega[np.argsort(-solved.bounds.max(axis=1))[:2]])
            trial = solve(basis, training, count)
        if (trial.floor <= 0.0).any():
            worst = float(training[trial.floor <= 0.0][0])
            solve_real(operators, worst, operators.at(worst), count)
        finest = AIM * tolerance / (2 * count)
        more = representatives(basis, trial, count, finest)
        if not more:  # the mode above the wanted ones may stand in the way of their bounds
            more = representatives(basis, trial, count + 1, finest)
        if not more or sum(each.shape[1] for each in more) + basis.size > known + LARGEST:
            break
        blocks = [orthonormal(each, stiffness, basis.vectors, basis.images[0])[:2] for each in more]
        basis = _with_blocks(operators, stiffness, modes, blocks, basis)
    gapless = np.isinf(trial.bounds).any(axis=1) & (trial.floor > NEAR)
    return basis, solve(basis, omega, count), bool(gapless.any())


def _collect(question: Question, basis: ReducedBasis, solved: ReducedModes) -> Swept:
    rates, vectors = solved.rates[:, : question.count], solved.vectors[:, :, : question.count]
    shares = forms(share_matrices(question.operators, basis.vectors), vectors.transpose(0, 2, 1)).swapaxes(0, 1)
    damping = np.full(rates.shape, question.damping_ratio)
    if basis.coriolis is not None and question.damping_ratio > 0.0:
        damping = _shared_damping(basis, basis.coriolis, solved.omega, rates, vectors, question.damping_ratio)
    parts = shares / shares.sum(axis=1, keepdims=True)
    met = solved.within(question.tolerance)
    return Swept(solved.omega, rates, solved.bounds, damping, parts, solved.vectors, basis.vectors, basis.alone, met)


def _shared_damping(
    basis: ReducedBasis, coriolis: Array, omega: Array, rates: Array, vectors: NDArray[Any], ratio: float
) -> Array:
    """Damping ratios (k, count) to first order: x' C x / (2 w x' M x - i Omega x' G x) for C = 2 ratio K^(1/2)."""
    own, shapes = modes_within(basis, omega, basis.size, None)
    along = np.abs(shapes.transpose(0, 2, 1) @ basis.mass @ vectors) ** 2
    lost = 2.0 * ratio * np.einsum("kr,krc->kc", own, along)
    turning = np.einsum("krc,rs,ksc->kc", vectors.conj(), coriolis, vectors, optimize=True)
    return np.asarray(lost / (2.0 * rates + (omega[:, None] * turning).imag))
