"""Equilibria and modes of a solid blade over speeds: a few are solved, and what lies between is interpolated.

State, eigenvalues and the space of the lowest modes are smooth functions of Omega², singular where a negative Omega²
would buckle the blade, at some -c. They are therefore polynomials in log(1 + Omega² / c), c by how much the ends'
frequencies differ, and go through points that are added one by one, each where the product of its distances from those
before is largest (Leja), out of Chebyshev-Lobatto points. The two ends are solved with factors of their own. At each
further point state and modes are sought among the modes of speeds that are solved, and what their states change by
speed, under the stiffness that is there: what this leaves of the frequencies is known by its residuals. Where it is too
much, the speed is solved with one factor, by Davidson's method from these modes (`fem.linalg.lowest_modes`). The modes
at each are turned, within their space, to be as like those of one speed as they can (Amsallem and Farhat, SIAM J. Sci.
Comput. 33 (2011) 2169): through these and their small stiffnesses the polynomials go, past crossings and veerings.

How far the frequencies at a new point are from those foretold is the error of the polynomial through those before,
about where it is largest. It does not fall evenly, and may be small by chance: points are added until half as much
again as the largest of the last three errors is within the tolerance.
"""

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import polar
from scipy.sparse import csc_array

from fem.linalg import Array, Ints, Solver, lowest_modes, orthonormal, perpendicular
from fem.modal_model import ModalModel, ModesAtSpeed, Place, Pull, Tracks, lagrange
from fem.modes import Divergence, solve_real
from fem.rotor import across
from fem.solid.assembly import SolidOperators
from fem.solid.mesh_error import mesh_errors
from fem.statics import NoEquilibrium, check_rest, equilibrium, settle, tangent, unbalanced

SPARE = 2
"""Modes solved beyond those asked for, so that one that comes down with speed is known before."""

MOST = 25
"""Points at most."""

PLACES = 96
"""Parts into which Chebyshev-Lobatto points divide the range, out of which these are taken."""

ENVELOPE = 1.5
"""Factor on the largest of the last three errors measured: their decay is not even, one may be small by chance.

Adding a point may raise the error between by a factor of six, to about the second last of those measured before.
"""

PROJECTED = 0.1
"""Part of the tolerance that may be left at a speed whose modes are sought among those of others."""

FAR = 0.1
"""Relative change of a squared frequency from what was predicted from which on a speed is solved without more ado."""

SPREAD = 5.0
"""What errors at the speeds known may become between them: Lebesgue's constant of up to 15 such points."""

CORRECTIONS = 3
"""Newton steps of a state among the modes of other speeds, with one stiffness."""

ALONE = 3
"""Speeds up to which each is solved by itself."""

SETTLED = 1e-10
"""Relative error of the eigenvalues that Davidson's method leaves."""

SETTLED_SPARE = 1e-6
"""The same of the spare modes."""

BALANCED = 1e-8
"""Energy of the last Newton step of a state between the ends, relative to that of the load; the square is left."""


FLOOR = 1e-7
"""Least relative error of frequencies that is claimed: of what Davidson's method and rounding leave."""

NEIGHBOURS = 5
"""Speeds by whose states, and their slopes, another state is predicted."""

LINEAR = 0.1
"""Growth of squared frequencies up to which a state is as good as linear in Omega²."""


@dataclass(frozen=True, eq=False)
class BladeSweep:
    """A blade's states and modes over a range of speeds.

    Attributes:
        squares: Omega² (m,) of the speeds that were solved, ascending, in rad²/s².
        bend: c, in rad²/s².
        states: displacements (m, n) at rest in the turning frame there, in m.
        shapes: modes (m, n, q) there, mass-normalised, turned within their space to be alike.
        stiffness: their small stiffness (m, q, q), in 1/s².
        products: of shapes at two of the speeds in the mass, (m, q, m, q).
        turned: of shapes at two of the speeds in the Coriolis matrix, (m, q, m, q); None without it.
        beyond: what Coriolis forces add to the modal mass through the modes that are not solved, by Omega², (m, q, q).
        count: modes that are wanted.
        errors: estimated relative errors (count,) of frequencies between the solved speeds; inf where they are unknown.
    """

    squares: Array
    bend: float
    states: Array
    shapes: Array
    stiffness: Array
    products: Array
    turned: Array | None
    beyond: Array | None
    count: int
    errors: Array

    def state(self, omega: float) -> Array:
        """Static displacement (n,) [m] at a speed [rad/s]."""
        return np.asarray(self.weights(omega) @ self.states)

    def modes(self, omega: float, *, spare: bool = False) -> tuple[Array, Array]:
        """Squared circular frequencies (count,) [rad²/s²] and mass-normalised shapes (n, count) at a speed.

        Args:
            omega: speed [rad/s].
            spare: with the modes solved beyond those asked for.
        """
        values, vectors = self.reduced(omega, spare=spare)
        return values, np.asarray(np.tensordot(self.weights(omega), self.shapes, 1) @ vectors)

    def reduced(self, omega: float, *, spare: bool = False) -> tuple[Array, Array]:
        """The modes as in `modes`, with shapes (q, count) in coordinates of the interpolated ones."""
        weights = self.weights(omega)
        values, vectors = np.linalg.eigh(np.tensordot(weights, self.stiffness, 1))
        mass = np.einsum("i,iajb,j->ab", weights, self.products, weights)
        count = None if spare else self.count
        values, vectors = values[:count], vectors[:, :count]
        return values, vectors / np.sqrt(np.einsum("ak,ab,bk->k", vectors, mass, vectors))

    def covers(self, omega: float) -> bool:
        """Whether the modes are known at a speed in rad/s."""
        slack = SAME * max(float(self.squares[-1]), omega**2)
        if np.isinf(self.errors).any():
            return bool((np.abs(self.squares - omega**2) <= slack).any())
        return bool(self.squares[0] - slack <= omega**2 <= self.squares[-1] + slack)

    def coriolis_shifts(self, omega: float) -> Array:
        """Relative shifts (count,) of the frequencies by Coriolis forces at a speed [rad/s].

        The modes that are not solved follow statically, which adds to the modal mass of those that are.

        Raises:
            ValueError: the operators have no Coriolis matrix.
        """
        if self.turned is None or self.beyond is None:
            raise ValueError("the operators were assembled without Coriolis forces")
        weights = self.weights(omega)
        values, vectors = np.linalg.eigh(np.tensordot(weights, self.stiffness, 1))
        turned = vectors.T @ np.einsum("i,iajb,j->ab", weights, self.turned, weights) @ vectors
        rates = np.sqrt(np.maximum(values, np.finfo(float).tiny))
        heavier, axes = np.linalg.eigh(vectors.T @ np.tensordot(weights, self.beyond, 1) @ vectors)
        light = axes / np.sqrt(1.0 + omega**2 * np.maximum(heavier, 0.0)) @ axes.T
        # of (x, w / rate x) in the modes' energies: w z = ((-i Omega G, diag(rate)), (diag(rate), 0)) z
        drag, cross = -1j * omega * light @ turned @ light, light * rates
        eigenvalues = np.linalg.eigvalsh(np.block([[drag, cross], [cross.T, np.zeros_like(cross)]]))
        return np.asarray(np.abs(np.sort(eigenvalues[eigenvalues > 0.0])[: self.count] / rates[: self.count] - 1.0))

    @cached_property
    def _tracks(self) -> Tracks:
        low, high = self.squares[[0, -1]] ** 0.5
        return Tracks.followed(lambda omega: self.reduced(omega)[1], low, high)

    def tracks(self, omega: float) -> Ints:
        """The mode of the lowest speed that each mode at a speed [rad/s] continues, (count,)."""
        return self._tracks.of(omega, self.reduced(omega)[1])

    def apart(self, most: int) -> Ints:
        """Numbers (p,) of at most so many of the solved speeds, those nearest to Chebyshev-Lobatto points."""
        if self.squares.size <= most:
            return np.arange(self.squares.size)
        places = _place(self.squares, self.squares[0], self.bend)
        wanted = places[-1] * (0.5 - 0.5 * np.cos(np.pi * np.arange(most) / (most - 1)))
        return np.unique(np.abs(places[:, None] - wanted).argmin(axis=0))

    def weights(self, omega: float) -> Array:
        """Weights (m,) of the solved speeds in the interpolation at another speed [rad/s]."""
        return _weights(self.squares, omega**2, self.bend)


def _place(square: Array | float, low: float, bend: float) -> Array:
    """Where an Omega² lies, from the lowest on, for interpolation: what is interpolated is smoother over this."""
    return np.log1p((np.asarray(square) - low) / bend)


def _weights(squares: Array, square: float, bend: float) -> Array:
    """Weights (m,) of what is known at Omega² (m,) in what is wanted at another."""
    nodes, at = (_place(each, squares[0], bend) for each in (squares, square))
    return lagrange(nodes, float(at))


SAME = 1e-9
"""Relative difference of squared speeds that are the same."""


@dataclass(eq=False)
class _Solved:
    """The speeds solved so far, by Omega²: states, eigenvalues and modes."""

    states: dict[float, Array] = field(default_factory=dict)
    values: dict[float, Array] = field(default_factory=dict)
    shapes: dict[float, Array] = field(default_factory=dict)
    slopes: dict[float, Array] = field(default_factory=dict)
    beyond: dict[float, Array] = field(default_factory=dict)

    def add(self, square: float, state: Array, slope: Array | None, values: Array, shapes: Array) -> None:
        """Know a speed; slope: what the state (n,) changes by Omega², of one that is solved."""
        self.states[square], self.values[square], self.shapes[square] = state, values, shapes
        if slope is not None:
            self.slopes[square] = slope

    def near(self, square: float) -> list[float]:
        """Squares of the solved speeds nearest to another, the nearest first [rad²/s²]."""
        low, bend = min(self.states), self.bend
        return sorted(self.slopes, key=lambda each: abs(np.log((bend + each - low) / (bend + square - low))))[
            :NEIGHBOURS
        ]

    def space(self, square: float, mass: csc_array) -> tuple[Array, Array]:
        """Orthonormal vectors (n, k), and their mass, of the modes and slopes at the solved speeds near another."""
        near = sorted(self.near(square))
        some = np.column_stack([self.shapes[each] for each in near] + [self.slopes[each] for each in near])
        return orthonormal(some, mass)[:2]

    def predicted(self, square: float) -> Array:
        """Static displacement (n,) [m] at another speed, by the Hermite polynomial of the solved states."""
        near, low, bend = self.near(square), min(self.states), self.bend
        at, nodes = (_place(np.array(each), low, bend) for each in (square, near))
        weights, off = lagrange(nodes, float(at)) ** 2, at - nodes
        apart = nodes[:, None] - nodes[None, :]
        np.fill_diagonal(apart, np.inf)
        states, slopes = (np.array([every[each] for each in near]) for every in (self.states, self.slopes))
        turned = weights * off * (bend + np.array(near) - low)
        return np.asarray(weights * (1.0 - 2.0 * off * (1.0 / apart).sum(axis=1)) @ states + turned @ slopes)

    def aligned(self, mass: csc_array) -> tuple[list[float], list[Array], Array]:
        """The speeds, turns (q, q) that make their modes like those in the middle, and the stiffness between these."""
        squares = sorted(self.states)
        heavy = mass @ self.shapes[squares[len(squares) // 2]]
        turns = [polar(self.shapes[each].T @ heavy)[0] for each in squares]
        small = [turn.T @ (self.values[each][:, None] * turn) for each, turn in zip(squares, turns, strict=True)]
        return squares, turns, np.array(small)

    def guess(self, square: float, mass: csc_array) -> Array:
        """Squared circular frequencies (q,) at another speed, by the polynomial through those known."""
        squares, _, small = self.aligned(mass)
        weights = _weights(np.array(squares), square, self.bend)
        return np.asarray(np.linalg.eigvalsh(np.tensordot(weights, small, 1)))

    @property
    def bend(self) -> float:
        """Omega² above the lowest that doubles an eigenvalue, by the modes at both ends [rad²/s²]."""
        low, high = min(self.values), max(self.values)
        growth = float((self.values[high] / self.values[low]).max())
        return (high - low) / max(growth - 1.0, LINEAR) if high > low else 1.0


def sweep_blade(
    operators: SolidOperators,
    speeds: Array,
    count: int = 6,
    *,
    tolerance: float = 2e-4,
) -> BladeSweep:
    """Equilibria and modes of a blade over a range of speeds.

    Args:
        operators: of the blade.
        speeds: shape (k,) [rad/s]; the range is from the lowest to the highest.
        count: number of modes.
        tolerance: relative, of frequencies between the speeds that are solved.

    Raises:
        NoEquilibrium, Divergence: the blade has no stable state at the highest speed.
    """
    requested = np.unique(np.abs(np.asarray(speeds, dtype=float)))
    known = _Solved()
    alone = requested if requested.size <= ALONE else requested[[0, -1]]
    for omega in map(float, alone):
        _solve_alone(operators, omega, count, known)
    if requested.size <= ALONE:
        return _gathered(operators, known, count, np.full(count, np.inf))
    low, high, bend = float(requested[0] ** 2), float(requested[-1] ** 2), known.bend
    missed, left, errors = [np.inf] * 2, 0.0, np.full(count, np.inf)
    for place in _places():
        square = low + bend * float(np.expm1(_place(high, low, bend) * place))
        guess = known.guess(square, operators.mass)[:count]
        off = _project(operators, square, known, guess)
        if not off <= PROJECTED * tolerance:
            _solve_between(operators, square, count, known)
            off = 0.0
        left = max(left, off)
        missed.append(float(np.abs(np.sqrt(np.abs(guess / known.values[square][:count])) - 1.0).max()))
        errors = np.full(count, FLOOR + SPREAD * left + ENVELOPE * max(missed[-3:]))
        if errors.max() <= tolerance:
            break
    return _gathered(operators, known, count, errors)


def _places() -> list[float]:
    """Where points between 0 and 1 are added one by one."""
    grid, places = 0.5 + 0.5 * np.cos(np.pi * np.arange(1, PLACES) / PLACES), [0.0, 1.0]
    while len(places) < MOST:
        apart = np.abs(grid[:, None] - places).prod(axis=1)
        places.append(float(grid[np.round(apart / apart.max(), 9).argmax()]))
    return places[2:]


def _solve_alone(operators: SolidOperators, omega: float, count: int, known: _Solved) -> None:
    """Solve a speed with factors of its own."""
    start = known.states[max(known.states)] if known.states else None
    if omega == 0.0:
        state = np.zeros_like(operators.load)
    else:
        if start is None:  # at rest the stiffness is positive: its factor serves the steps from there
            operators.solver(operators.stiffness)
        state = _rest(operators, omega, start if start is not None and start.any() else None)
    wanted = min(count + SPARE, operators.load.size)
    modes = next((each for each in operators.solved if each.omega == omega and each.eigenvalues.size >= wanted), None)
    if modes is None:
        modes = solve_real(operators, omega, _about(operators, omega, state), wanted, state)
    operators.known[:] = [modes.factor]
    known.add(omega**2, state, _slope(operators, state, modes.factor), modes.eigenvalues, modes.shapes)
    if operators.gyroscopic is not None:
        dragged = operators.gyroscopic @ modes.shapes
        within = modes.shapes.T @ dragged
        whole = dragged.T @ modes.factor.solve(dragged)
        known.beyond[omega**2] = whole - within.T @ (within / modes.eigenvalues[:, None])


def _rest(operators: SolidOperators, omega: float, start: Array | None) -> Array:
    """The state (n,) at a speed in rad/s; start: one like it.

    Raises:
        Divergence: under the stress of the linear state the stiffness is indefinite.
        NoEquilibrium: it is not, and no state was found all the same.
    """
    if operators.prestress is not None:
        return omega**2 * operators.prestress
    try:
        return equilibrium(operators, omega, start)
    except NoEquilibrium:  # far beyond a critical load Newton's method need not meet the unstable state
        linear = omega**2 * operators.solver(operators.stiffness).solve(operators.load)
        solve_real(operators, omega, tangent(operators, omega, linear), 1, linear)
        raise


def _about(operators: SolidOperators, omega: float, state: Array) -> csc_array:
    """The stiffness (n, n) at a speed in rad/s, whose state is (n,)."""
    if omega == 0.0 or operators.prestress is not None:
        return operators.at(omega)
    return tangent(operators, omega, state)


def _slope(operators: SolidOperators, state: Array, solver: Solver) -> Array:
    """What a state (n,) changes by Omega², by what solves the stiffness about it."""
    if operators.prestress is not None:
        return operators.prestress
    load = operators.load
    return solver.solve(load if operators.softening is None else load + operators.softening @ state)


def _project(operators: SolidOperators, square: float, known: _Solved, guess: Array) -> float:
    """Know a speed by state and modes among the modes and slopes of solved speeds, and what these lack there.

    Returns the largest relative error that this leaves of a wanted frequency, to first order; infinity where the modes
    are far from those predicted. guess: their squares (wanted,).
    """
    omega, mass = square**0.5, operators.mass
    basis, image = known.space(square, mass)
    linear = operators.prestress is not None
    count, wanted = known.shapes[max(known.shapes)].shape[1], guess.size
    state = known.predicted(square)
    if not linear:
        reduced = basis.T @ (tangent(operators, omega, state) @ basis)
        for _ in range(CORRECTIONS):
            residual = unbalanced(operators, square, state, operators.stressed(state))
            state = state + basis @ np.linalg.solve(reduced, basis.T @ residual)
    pushed = _about(operators, omega, state) @ basis
    values, vectors = np.linalg.eigh(basis.T @ pushed)
    values, vectors = values[:count], vectors[:, :count]
    shapes = basis @ vectors
    known.add(square, state, None, values, shapes)
    if np.abs(values[:wanted] / guess - 1.0).max() > FAR:
        return np.inf
    residuals = (pushed @ vectors - (image @ vectors) * values)[:, :wanted]
    changes = np.abs(np.einsum("nk,nk->k", residuals, operators.known[-1].solve(residuals)))
    if not linear:
        step = operators.known[-1].solve(unbalanced(operators, square, state, operators.stressed(state)))
        changes += np.abs(np.diagonal(operators.bending(state, step, shapes[:, :wanted])))
    return float((0.5 * changes / values[:wanted]).max())


def _solve_between(operators: SolidOperators, square: float, count: int, known: _Solved) -> None:
    """Solve a speed from what is known of it by others, with one factor for state and modes."""
    omega, start = square**0.5, known.shapes[square]
    operators.known.clear()
    state = known.states[square]
    if operators.prestress is None:
        state, _ = settle(operators, omega, state, BALANCED)
    stiffness = _about(operators, omega, state)
    solver = operators.solver(stiffness)
    slope = _slope(operators, state, solver)
    settled = np.where(np.arange(start.shape[1]) < count, SETTLED, SETTLED_SPARE)
    pairs = lowest_modes(stiffness, operators.mass, start, operators.known[-1], settled)
    if pairs is None:
        modes = solve_real(operators, omega, stiffness, start.shape[1], state)
        pairs = modes.eigenvalues, modes.shapes
    known.add(square, state, slope, *pairs)


def _gathered(operators: SolidOperators, known: _Solved, count: int, errors: Array) -> BladeSweep:
    """What goes through all that is solved."""
    squares, turns, small = known.aligned(operators.mass)
    shapes = np.array([known.shapes[each] @ turn for each, turn in zip(squares, turns, strict=True)])
    beside = shapes.swapaxes(0, 1).reshape(shapes.shape[1], -1)
    sides = (len(squares), shapes.shape[2]) * 2
    products = (beside.T @ (operators.mass @ beside)).reshape(sides)
    turned = beyond = None
    if operators.gyroscopic is not None:
        turned = (beside.T @ (operators.gyroscopic @ beside)).reshape(sides)
        alone = {
            square: turn.T @ known.beyond[square] @ turn
            for square, turn in zip(squares, turns, strict=True)
            if square in known.beyond
        }
        beyond = np.array([alone.get(square, alone[squares[-1]]) for square in squares])
    states = np.array([known.states[each] for each in squares])
    return BladeSweep(np.array(squares), known.bend, states, shapes, small, products, turned, beyond, count, errors)


MILD = 1.0
"""Energy of the step that follows the linear state, over that of the load, up to which what it does to modes is
worked out; beyond, the blade is bent too much."""

SAFETY = 2.0
"""Factor on the estimate: with it none of 8 modes of six blades at speeds up to their highest moves by more."""


def deflection_shifts(operators: SolidOperators, omega: float, count: int) -> Array | None:
    """Estimated relative shifts of frequencies by large deflection.

    One Newton step is taken from the linear state. The modes of the stiffness there are sought among those with the
    linear prestress; what these lack is added, by their residuals.

    Args:
        operators: without large deflection; they keep the modes at this speed.
        omega: speed [rad/s].
        count: number of modes.

    Returns:
        Shape (count,) [-]; None where the blade bends too much for one step, or has no modes with a linear prestress.

    Raises:
        Unresolved: it is all but loose at rest.
    """
    operators.solver(operators.stiffness)
    if not operators.known:  # it is not positive at rest
        check_rest(operators)
    square, (first, *_) = omega**2, operators.known
    state = square * np.asarray(operators.prestress)
    left = unbalanced(operators, square, state, operators.stressed(state))
    if not abs(left @ first.solve(left)) <= MILD * square * (operators.load @ state):
        return None
    wanted = min(count + SPARE, state.size)
    try:
        modes = solve_real(operators, omega, operators.at(omega), wanted, state)
    except Divergence:
        return None
    operators.known[:], operators.solved[:] = [modes.factor], [modes]
    pushed = tangent(operators, omega, state + modes.factor.solve(left)) @ modes.shapes
    values, vectors = np.linalg.eigh(modes.shapes.T @ pushed)
    residuals = (pushed - operators.mass @ modes.shapes @ (modes.shapes.T @ pushed)) @ vectors
    lacking = np.einsum("nk,nk->k", residuals, modes.factor.solve(residuals)) / np.abs(values)
    shifts = SAFETY * (np.abs(np.sqrt(np.abs(values) / modes.eigenvalues) - 1.0) + np.abs(lacking))
    return np.asarray(shifts[:count])


MORE = 5
"""Speeds that a range is swept by at least, so that what lies between is known with its error."""

KEPT = 64
"""Speeds of which the shapes are kept, for who asks again."""

PULLED = 4
"""Speeds at which a ball's pull is solved for, at most: between, it is off by 0.3 % in first modes of three blades."""

PLACES_KEPT = 4
"""Places of a ball of which that is kept."""


class SolvedBlade:
    """A solid blade with its modes over a range of speeds, which grows where speeds beyond it are asked for.

    Attributes:
        operators: its matrices.
        sweep: what is solved so far.
        errors: estimated relative errors (count,) of frequencies by the mesh.
    """

    def __init__(self, operators: SolidOperators, speeds: Array, count: int, tolerance: float) -> None:
        """Solve for the count lowest modes at speeds (k,) in rad/s; tolerance: see `sweep_blade`.

        Raises:
            NoEquilibrium, Divergence: where the blade has no stable state at the highest speed.
        """
        self.operators, self.tolerance = operators, tolerance
        self.sweep: BladeSweep = sweep_blade(operators, speeds, count, tolerance=tolerance)
        ends = [(float(self.sweep.squares[k]) ** 0.5, self.sweep.states[k]) for k in (0, -1)]
        solved = [(*self.sweep.modes(omega, spare=True), state) for omega, state in ends[: self.sweep.squares.size]]
        every = [mesh_errors(operators, shapes, values, state) for values, shapes, state in solved]
        self.errors: Array = np.vstack(every).max(axis=0)[:count]
        self._at = lru_cache(KEPT)(self._solved)
        self._strained = lru_cache(KEPT)(self._root_strain)
        self._stiffened_at = lru_cache(PLACES_KEPT)(self._stiffened)

    @cached_property
    def model(self) -> ModalModel:
        """The blade, with its modes at the lowest speed."""
        blade = self.operators.blade
        lowest = self.at(float(self.sweep.squares[0]) ** 0.5)
        mesh = blade.mesh
        return ModalModel(mesh.points, (lowest,), blade.axis, blade.origin, mesh.cells, mesh.sets, mesh.labels)

    def root_strain(self, modes: ModesAtSpeed, number: int) -> float | None:
        """Largest strain over the root's section in a mode, numbered from 0, by bending and pull [m^-1 per kg^1/2 m].

        By what the moving masses, and the load on them, ask of the clamp, and by Navier's linear stress: that needs no
        mesh which resolves how rotation draws the bending of thin blades into a layer at the root. It is the stress
        over E, as of plates, whatever width the clamp holds. None where the root has no section.
        """
        return self._strained(modes, number)

    def _root_strain(self, modes: ModesAtSpeed, number: int) -> float | None:
        blade, masses = self.operators.blade, self.operators.masses[:, None]
        if blade.bending is None:
            return None
        shape, still = modes.shapes[number], 0.0 if modes.static is None else modes.static
        middle, normal, second, at = blade.bending
        place = blade.mesh.points + still
        arm = perpendicular(place - blade.origin, blade.axis)
        swing = masses * (modes.squares[number] * shape + modes.omega**2 * perpendicular(shape, blade.axis))
        moment = np.cross(place - middle, swing) + np.cross(shape, masses * modes.omega**2 * arm)
        bent = np.linalg.pinv(second, rcond=1e-9) @ np.cross(normal, moment.sum(axis=0))
        pulled = swing.sum(axis=0) @ normal / np.linalg.norm(blade.section)
        stress = pulled + (at - perpendicular(middle, normal)) @ bent
        return float(np.abs(stress).max() / blade.material.youngs_modulus)

    def at(self, omega: float) -> ModesAtSpeed:
        """The blade's modes at a speed [rad/s].

        Raises:
            NoEquilibrium, Divergence: the blade has no stable state there.
        """
        self._reach(omega)
        return self._at(omega)

    def coriolis_shifts(self, omega: float) -> Array:
        """Relative shifts (count,) of the frequencies by Coriolis forces, which the modes leave out."""
        self._reach(omega)
        return self.sweep.coriolis_shifts(omega)

    def _reach(self, omega: float) -> None:
        """Solve a range that holds a speed."""
        if self.sweep.covers(omega):
            return
        known = np.sqrt(np.append(self.sweep.squares, omega**2))
        speeds = np.linspace(known.min(), known.max(), MORE)
        self.sweep = sweep_blade(self.operators, speeds, self.sweep.count, tolerance=self.tolerance)
        self._at.cache_clear()
        self._stiffened_at.cache_clear()

    def pull(self, at: Place) -> Pull:
        """What the load of 1 kg at a place does, by the stress that its pull causes in the blade."""

        def stiffening(modes: ModesAtSpeed) -> Array:
            self._reach(modes.omega)
            sweep, (squares, small) = self.sweep, self._stiffened_at(at)
            basis = np.tensordot(sweep.weights(modes.omega), sweep.shapes, 1)
            shapes = np.column_stack([self.operators.gathered(shape) for shape in modes.shapes])
            own = np.linalg.lstsq(basis, shapes, rcond=None)[0]
            weights = _weights(squares, modes.omega**2, sweep.bend)
            return np.asarray(own.T @ np.tensordot(weights, small, 1) @ own)

        return Pull(at, self.operators.blade.axis, stiffening)

    def _stiffened(self, at: Place) -> tuple[Array, Array]:
        """Omega² (p,) of some of the solved speeds, and what the load of 1 kg adds to their small stiffness (p, q, q).

        Over Omega², to first order: the load displaces the equilibrium, about which the blade then vibrates.
        """
        sweep, operators, blade = self.sweep, self.operators, self.operators.blade
        linear, step, small = operators.prestress is not None, None, []
        numbers = sweep.apart(PULLED)
        for number in numbers:
            state = sweep.states[number]
            if step is None or not linear:
                point = at.point if linear else at.point + at.value @ operators.spread(state)[at.nodes]
                load = operators.force_at(at, (point - blade.origin) @ across(blade.axis))
                omega = 0.0 if linear else float(sweep.squares[number]) ** 0.5
                step = operators.factorise(_about(operators, omega, state)).solve(load)
            small.append(operators.bending(state, step, sweep.shapes[number]))
        return sweep.squares[numbers], np.array(small)

    def _solved(self, omega: float) -> ModesAtSpeed:
        sweep, operators = self.sweep, self.operators
        values, shapes = sweep.modes(omega)
        moved = np.moveaxis(operators.spread(shapes), 2, 0)
        exact = np.isinf(sweep.errors).any()
        return ModesAtSpeed(
            omega=omega,
            frequencies_hz=np.sqrt(values) / (2.0 * np.pi),
            shapes=moved,
            static=operators.spread(sweep.state(omega)),
            errors=self.errors,
            interpolation=np.zeros(sweep.count) if exact else sweep.errors,
            drawn=np.einsum("kni,n->ki", moved, operators.masses),
            tracks=sweep.tracks(omega),
        )
