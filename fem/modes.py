"""Modes at one speed, real and complex; their families; the critical speed.

`solve_modes` finds the modes at a speed: `solve_real` those of a stiffness without Coriolis forces, `solve_gyroscopic`
those with them, (K + i w Omega G - w² M) x = 0. `families` tells flap, twist, lag and chord modes apart by where their
energy is.

With Coriolis forces by Davidson's method: a space that begins with the plate's own modes takes in the residuals, solved
for with the factor of K, until these are small. Residuals are those of the full matrices, so that nothing hangs on the
rounding of a recurrence. Vectors are orthonormal in K + shift M, which next to the critical speed stays as regular as
elsewhere, and the small problem is solved for 1 / w in the energy x'Kx + w² x'Mx, in which it is Hermitian: stiff modes
cost the soft ones no digits. Sources: Meirovitch, AIAA J. 12 (1974) 1337; Davidson, J. Comput. Phys. 17 (1975) 87.
Structural damping, given as a ratio for each mode of the plate, is added in the space of these modes.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from fem import linalg
from fem.assembly import Body, Operators, elastic_energies
from fem.linalg import (
    CONVERGED,
    Array,
    Factor,
    Ints,
    NotConverged,
    SingularMatrix,
    factorise,
    krylov,
    lanczos,
    orthonormal,
    random_block,
    rounding,
    symmetric,
)
from fem.meshes import thickness
from fem.modal_model import FAMILIES
from fem.rotor import in_rpm
from fem.statics import LOST, Unresolved, check_rest, linearise, positive
from fem.theory.sections import products, strain_matrix

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

    def __init__(self, omega: float, eigenvalue: float, count: int = 1, body: str = "structure") -> None:
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
    """The lowest modes of a stiffness without Coriolis forces.

    Args:
        operators: of the plate or blade.
        omega: speed [rad/s].
        stiffness: at this speed, shape (n, n).
        count: of modes; there are fewer where fewer directions have mass.
        state: static displacement (n,) [m], where the deflection is large.
        tolerance: relative, of residuals.

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
    negative = factor.negative_pivots
    negative = int((values < 0.0).sum()) if negative is None else negative
    if negative:
        check_rest(operators)
        value = lowest(stiffness, operators.mass, values, operators.factorise)
        raise Divergence(omega, value, negative, body)
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
    corrected, mixed = np.linalg.eigh(symmetric(energies))
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
    """The lowest of eigenvalues that reach below zero, by shifting all above it.

    Args:
        stiffness: shape (n, n).
        mass: shape (n, n).
        values: eigenvalues known so far, shape (k,).
        factor_of: makes the factor of a matrix.
    """
    shift = 2.0 * float(np.abs(values).max())
    while (factor := factor_of((stiffness + shift * mass).tocsc())).negative:
        shift *= 4.0
    return float(lanczos(factor, mass, 1, SHIFTED)[0][0] - shift)


STRIPS = 16
"""Strips along x in which a chord is fitted."""

_LAYER = 1.5
"""Thicknesses that a strip is wide at which stresses are taken: in a narrower one a solid shows those of its clamp."""

_PARTS = 3
"""Of such a strip, beyond the root's: where the thickness varies, a wider one would level its strains."""


def families(operators: Operators, modes: Modes) -> list[str]:
    """The family of each mode, one of `FAMILIES`, by the largest share of its kinetic energy."""
    shares = energy_shares(operators, modes.shapes)
    return [FAMILIES[k] for k in shares.argmax(axis=0)]


def energy_shares(operators: Operators, shapes: NDArray[Any]) -> Array:
    """Shares of kinetic energy in each of `FAMILIES`.

    Args:
        operators: of the plate.
        shapes: real or complex, shape (n, count).

    Returns:
        Shape (5, count).
    """
    parts = (shapes.real, shapes.imag) if np.iscomplexobj(shapes) else (shapes,)
    energy = np.sum([np.einsum("fii->fi", share_matrices(operators, part)) for part in parts], axis=0)
    return np.asarray(energy / energy.sum(axis=0))


def share_matrices(operators: Operators, basis: Array) -> Array:
    """Matrices of the kinetic energy in each family, for shapes in a basis.

    Args:
        operators: of the plate.
        basis: shape (n, r).

    Returns:
        E, shape (5, r, r): the energy of basis @ y in family f is y' E_f y, up to one factor.
    """
    model = operators.model
    weight = np.sqrt(model.displacement.dx.ravel())[:, None]
    u, v, w = (weight * moved.reshape(weight.size, -1) for moved in model.displacement.evaluate(basis)[:3])
    x, y, z = (each.ravel() for each in model.points)
    flap, twist = _chordwise(x, y, w, weight)
    chord, lag = w.T @ w - flap - twist, v.T @ v
    if z.any():  # where a solid's section turns, it moves along y as well
        turning = _chordwise(x, z, v, weight)[1]
        twist, lag = twist + turning, lag - turning
    return np.stack([flap, twist, chord, lag, u.T @ u])


def _chordwise(x: Array, y: Array, w: Array, weight: Array) -> tuple[Array, Array]:
    """Energy matrices (r, r) of what in w (npoint, r) is even along the chord y, and linear in it."""
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


def bending_strains(operators: Operators, shapes: NDArray[Any], state: Array | None = None) -> Array:
    """Largest bending stress along x at the plate's faces, over the modulus, in each of some shapes.

    In each strip along x the stress is taken to be linear in z and along the chord, and counts at the worse end of the
    chord: a swept root is strained most at its inner corner, and the corners of a clamp, which are singular, count by
    what is beside them. The root's strain is extrapolated from the two strips next to it as a power of x: rotation
    holds a plate straight but for a layer there, of a few times its thickness if it is thin and fast.

    Args:
        operators: of the plate.
        shapes: real or complex, shape (n, k).
        state: static displacement (n,) [m] about which the plate moves, where the deflection is large.

    Returns:
        Shape (k,) [-].
    """
    model = operators.model
    gradients = model.gradient.evaluate(shapes)
    along = model.stiffness[0] / operators.plate.material.youngs_modulus
    strains = [np.einsum("g,gcpk->cpk", along @ strain_matrix(layer), gradients) for layer in model.elastic]
    if state is not None:
        at_rest = model.gradient.evaluate(state[:, None])[..., 0]
        for layer, strain in zip(model.elastic, strains, strict=True):
            turned = np.einsum("s,sgh->gh", along, products(layer))
            strain += np.einsum("gh,gcp,hcpk->cpk", turned, at_rest, gradients, optimize=True)
    sides = [1.0, -1.0]
    if len(strains) > 1:  # of plates: what the mid-surface has is stretching
        middle = sum(strains) / len(strains)
        strains = [strain - middle for strain in strains]
    else:
        sides = [(model.points[2] / np.sqrt(np.mean(model.points[2] ** 2)))[..., None]]
    x, y, volumes = model.points[0].ravel(), model.points[1].ravel(), model.gradient.dx.ravel()
    squares = sum(np.abs(strain) ** 2 for strain in strains).reshape(volumes.size, -1) / len(strains)
    bends = sum(side * strain for side, strain in zip(sides, strains, strict=True)).reshape(volumes.size, -1)
    bends = bends / len(strains)

    def faces(strip: Ints) -> tuple[Array, Array]:
        """Where strips lie, shape (strips,), and the strain at their worse ends, shape (strips, k)."""
        there, number = np.unique(strip, return_inverse=True)

        def mean(values: NDArray[Any]) -> NDArray[Any]:
            sums = np.zeros((len(there), *values.shape[1:]), values.dtype)
            np.add.at(sums, number, (values.T * volumes).T)
            return (sums.T / np.bincount(number, volumes)).T

        across, level = y - mean(y)[number], mean(bends)
        spread = mean(across**2)
        spread[spread == 0.0] = np.inf  # of one point there is no slope
        slope = np.sqrt(3.0 / spread)[:, None] * mean(across[:, None] * bends)
        ends = np.maximum(np.abs(level + slope), np.abs(level - slope))
        more = ends**2 - np.abs(level) ** 2 - np.abs(slope) ** 2 / 3.0
        return mean(x), np.sqrt(3.0 * (mean(squares) + np.maximum(more, 0.0)))

    strip = _strips(operators)
    place, wide = faces(strip // _PARTS)
    root = wide[0] * (wide[0] / wide[1]) ** ((place[0] - model.mesh.p[0].min()) / (place[1] - place[0]))
    narrow = faces(strip)[1][np.unique(strip) >= _PARTS]
    return np.asarray(np.maximum(root, np.maximum(wide.max(axis=0), narrow.max(axis=0))))


def _strips(operators: Operators) -> Ints:
    """In which strip along x each point of a plate's rule lies, from 0 at the root, shape (points,).

    `_PARTS` of them are `_LAYER` times as wide as the plate is thick there, or the plate has `STRIPS` times as many.
    """
    points = operators.model.points
    x, depth = points[0].ravel(), np.empty(points[0].size)
    height = np.broadcast_to(thickness.of(operators.plate.thickness, points[:2]), points[0].shape).ravel()
    order = np.argsort(x, kind="stable")
    depth[order] = np.cumsum(np.diff(x[order], prepend=x.min()) / height[order])  # in thicknesses
    count = _PARTS * max(STRIPS, round(float(depth.max()) / _LAYER))
    return np.asarray(np.minimum((depth * (count / depth.max())).astype(np.int64), count - 1))


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
    """The lowest complex modes of a stiffness with Coriolis forces.

    Args:
        operators: of the plate, with its Coriolis matrix.
        omega: speed [rad/s].
        stiffness: at this speed, shape (n, n).
        count: of modes.
        state: static displacement (n,) [m], where the deflection is large.
        damping_ratio: viscous damping of each mode without Coriolis forces [-].

    Raises:
        Divergence: the stiffness is not positive: Coriolis forces may hold such a plate, but no damped one.
        ValueError: damping leaves one of these modes no frequency.
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
    weight = (stiffness + shift * mass).tocsc()
    nothing = np.empty((mass.shape[0], 0))
    span, more = _Span(nothing, nothing, nothing, nothing), still.shapes
    while True:
        block, image, _, _ = orthonormal(more, weight, span.vectors, span.weighed)
        fresh = (block, image, mass @ block, coriolis @ block)
        span = _Span(*(np.hstack(pair) for pair in zip(span, fresh, strict=True)))
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


def _small(span: _Span, shift: float, count: int) -> tuple[Array, NDArray[Any]]:
    """The count lowest frequencies in rad/s that a span has, and mass-normalised coordinates (r, count) in it.

    With z = (x, w x) the problem is diag(K, M) z = w ((-i Omega G, M), (M, 0)) z.
    """
    squares, axes = np.linalg.eigh(symmetric(span.vectors.T @ span.heavy))
    soft = np.maximum(1.0 - shift * squares, np.finfo(float).eps) ** -0.5
    turning = axes.T @ (span.vectors.T @ span.turned) @ axes
    heavy = np.diag(soft * np.sqrt(np.maximum(squares, 0.0)))
    gyroscopic = -0.5j * soft[:, None] * (turning - turning.T) * soft
    inverse, vectors = np.linalg.eigh(np.block([[gyroscopic, heavy], [heavy, np.zeros_like(heavy)]]))
    count = min(count, squares.size)
    parts = soft[:, None] * vectors[: squares.size, : -count - 1 : -1]
    sizes = np.sqrt(np.maximum(squares, 0.0) @ np.abs(parts) ** 2)
    return 1.0 / inverse[: -count - 1 : -1], axes @ (parts / sizes)


def _product(real: Array, other: NDArray[Any]) -> NDArray[Any]:
    """Product of a real matrix and a complex one; numpy would make both complex."""
    return np.asarray(real @ other.real + 1j * (real @ other.imag))


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
    span = np.hstack([complex_shapes.real, complex_shapes.imag, still.shapes])
    basis, _, _, _ = orthonormal(span, stiffness)
    heavy = mass @ basis
    overlap = heavy.T @ still.shapes
    rates = damping_ratio * np.sqrt(still.eigenvalues)
    damping = basis.T @ (coriolis @ basis) + 2.0 * (overlap * rates) @ overlap.T
    # In energy coordinates, of x and of the velocity, the largest 1 / lambda are the lowest frequencies.
    squares, directions = np.linalg.eigh(symmetric(basis.T @ heavy))
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
    never = below = NEVER * float(np.sqrt(rest))
    while (factor := positive(operators, operators.at(below))) is None:
        below = below / RUNG if below**2 * NEVER**2 > rest else 0.0
    if below == never:
        return np.inf
    loss = -operators.spinning
    start = factor.solve(loss @ random_block(loss.shape[0]))
    values, _ = krylov(lambda x, _: factor.solve(loss @ x), operators.at(below), start, 1, np.asarray)
    if values[0] <= 0.0:
        raise NotConverged(f"rounding hides the critical speed above {below:.6g} rad/s")
    return float(np.sqrt(below**2 + 1.0 / values[0]))


def solve_modes(
    operators: Operators,
    omega: float,
    count: int = 6,
    *,
    start: Array | None = None,
    state: Array | None = None,
    damping_ratio: float = 0.0,
) -> Modes:
    """The lowest modes of a plate at one speed.

    Rounding takes some digits of a thin plate, most of its lowest frequency. `fem.linalg.rounding`
    estimates how much, some twenty times too cautiously, and the `bounds` of `campbell` contain it. On a square of 8
    x 8 cells it is 1e-5 for a solid of h/L = 1e-4, and grows with (L/h)²; for Mindlin's plates it is below 1e-6, for
    Kirchhoff's below 1e-10, at any thickness. Finer meshes, strips, and speeds next to the critical one lose more.

    Args:
        operators: of the plate.
        omega: speed [rad/s].
        count: of modes.
        start: static displacement (n,) [m] at a neighbouring speed, from which a large deflection is sought.
        state: static displacement (n,) [m] at this speed, if known.
        damping_ratio: viscous damping of each mode, below 1, which Coriolis forces then share out [-].

    Raises:
        ValueError: a speed that is not one finite number, a count that the plate does not have, or a ratio at which
            modes do not oscillate.
        Divergence: past the critical speed.
        NoEquilibrium: a large deflection has none.
        Unresolved: the plate is too thin for the theory.
    """
    check_count(operators, count)
    check_damping(damping_ratio)
    stiffness, state = linearise(operators, omega, start, state)
    if operators.gyroscopic is not None and omega != 0.0:
        return solve_gyroscopic(operators, omega, stiffness, count, state, damping_ratio)
    modes = solve_real(operators, omega, stiffness, count, state)
    return replace(modes, damping_ratios=np.full(modes.eigenvalues.size, damping_ratio))
