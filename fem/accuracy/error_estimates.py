"""Errors of frequencies, estimated from those on coarser meshes of the same planform (Richardson 1911).

Two meshes are taken to follow the planform's usual order, three show it. Where cells do not see the layer along the
edges (`fem.accuracy.edge_layer`), errors are divided into the layer's part, which is known as far as a factor, and the
rest.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fem.accuracy.edge_layer import drift, layer_and_rest, layer_errors, unseen
from fem.accuracy.theory_selection import layers
from fem.assembly import Operators, transfer
from fem.linalg import Array, factorise, lowest_modes
from fem.meshes.mesh_sequence import Planform, enough_cells
from fem.modes import Divergence, Modes, check_count, solve_modes, solve_real
from fem.statics import NoEquilibrium, linearise, settle, tangent
from fem.theory.registry import Kind, kind

ROUGH = 1e-4
"""Largest residual of the modes at the first speed; the error of their frequencies is of the order of its square."""


BENT = 1e-3
"""Energy of Newton's last step to a large deflection as part of what squared frequencies need; its square is left."""


SAME = 1e-5
"""Relative difference of eigenvalues that count as the same."""


class Probed(NamedTuple):
    """Modes at one speed.

    Attributes:
        eigenvalues: (count,) in rad²/s², ascending.
        shapes: (n, count), mass-normalised.
        state: the displacement (n,) vibrated about, where the deflection is large.
    """

    eigenvalues: Array
    shapes: NDArray[Any]
    state: Array | None


def probe(
    operators: Operators,
    speeds: tuple[float, ...],
    count: int,
    exact: float,
    starts: Mapping[float, Array | None] | None = None,
    *,
    alone: bool = False,
) -> list[Probed]:
    """The lowest modes at several speeds, up to the first at which the plate has none.

    Args:
        operators: of the plate.
        speeds: ascending [rad/s].
        count: of modes.
        exact: relative tolerance of squared frequencies.
        starts: by speed, states (n,) near those of large deflections.
        alone: every speed is solved by itself, not from the modes at the first.

    Raises:
        ValueError: as `solve_modes` does.
        Divergence, NoEquilibrium: at the first speed.
        Unresolved: the plate is too thin for its theory in double precision.
    """
    near = starts or {}
    first = _solve(operators, speeds[0], count, exact, near.get(speeds[0]))
    probes = [_kept(first)]
    for speed in speeds[1:]:
        try:
            if alone:
                probes.append(_kept(_solve(operators, speed, count, exact, near.get(speed))))
            else:
                probes.append(_from(operators, first, speed, exact, near.get(speed)))
        except (Divergence, NoEquilibrium):
            break
    return probes


def complete(operators: Operators, speed: float, modes: Probed) -> bool:
    """Whether modes are the lowest, none left out, by the inertia of a shifted stiffness.

    Args:
        operators: of the plate.
        speed: [rad/s].
        modes: solved at this speed.
    """
    if operators.gyroscopic is not None:
        return True
    stiffness = operators.at(speed) if modes.state is None else tangent(operators, speed, modes.state)
    shift = float(modes.eigenvalues[-1]) * (1.0 - SAME)
    below = np.count_nonzero(modes.eigenvalues < shift)
    return factorise((stiffness - shift * operators.mass).tocsc()).negative == below


def _solve(operators: Operators, speed: float, count: int, exact: float, start: Array | None) -> Modes:
    if operators.gyroscopic is not None:
        return solve_modes(operators, speed, count, start=start)
    check_count(operators, count)
    stiffness, state = linearise(operators, speed, start)
    return solve_real(operators, speed, stiffness, count, state, tolerance=min(ROUGH, exact**0.5))


def _kept(modes: Modes) -> Probed:
    return Probed(modes.eigenvalues, modes.shapes, modes.state)


def _from(operators: Operators, known: Modes, speed: float, exact: float, start: Array | None) -> Probed:
    """Modes at a speed in rad/s from those at another, or by themselves where they differ too much."""
    if operators.gyroscopic is None:
        if operators.effects.large_deflection:
            start, factor = settle(operators, speed, start, BENT * exact)
            near = lowest_modes(tangent(operators, speed, start), operators.mass, known.shapes, factor, exact)
        else:
            near = lowest_modes(operators.at(speed), operators.mass, known.shapes, known.factor, exact)
        if near is not None and near[0][0] > 0.0:
            return Probed(*near, start)
    return _kept(solve_modes(operators, speed, known.eigenvalues.size, start=start))


SURELY = 3.0
"""Ratio of the sizes of two meshes at which a plate diverges that makes it believed; coarse ones may do so alone."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A mesh tried.

    Attributes:
        operators: the matrices on it.
        frequencies: (probes, count) in Hz, NaN at speeds that have none.
        drifts: relative drop (probes, count) of frequencies as cells around a point mass shrink e times.
        layers: compliance (probes, count) of the layer along the edges in each mode, zero in theories without one.
        states: speeds [rad/s] and static displacements (n,) [m], where the deflection is large.
    """

    operators: Operators
    frequencies: Array
    drifts: Array
    layers: Array
    states: tuple[tuple[float, Array], ...]

    @property
    def unknowns(self) -> int:
        """How many it has."""
        return int(self.operators.mass.shape[0])


@dataclass(eq=False)
class TrialMeshes:
    """Solves each mesh once, when it is first asked for.

    Attributes:
        build: matrices for a size of the planform.
        probes: speeds in rad/s.
        count: of modes.
        exact: relative accuracy of their squared frequencies.
        lost: why there are no modes, where there are none.
        tried: the meshes tried by size, the last one last.
    """

    planform: Planform
    build: Callable[[int], Operators]
    probes: tuple[float, ...]
    count: int
    exact: float
    lost: ArithmeticError | None = field(default=None, init=False)
    tried: dict[int, Trial] = field(default_factory=dict, init=False)
    _alone: bool = field(default=False, init=False)

    def at(self, size: int) -> Trial:
        """What is known on a mesh."""
        if size not in self.tried:
            self.tried[size] = self._solved(self.build(size))
        return self.tried[size]

    @property
    def operators(self) -> Operators:
        """On any of the meshes tried: all have one plate, but for its mesh, and one theory."""
        return next(iter(self.tried.values())).operators

    def alive(self, *sizes: int) -> NDArray[np.bool_]:
        """Probes (k,) at which all of some meshes have modes."""
        finite = [np.isfinite(self.at(size).frequencies).all(axis=1) for size in sizes]
        return np.asarray(np.logical_and.reduce(finite))

    def apart(self, coarse: int, fine: int) -> Array:
        """Relative differences (probes, count) between two meshes, less the endless drop under a point mass."""
        there, here = self.at(coarse), self.at(fine)
        apart = np.abs(there.frequencies / here.frequencies - 1.0 - here.drifts * np.log(fine / coarse))
        none = ~self.alive(coarse) & ~self.alive(fine)
        apart[~self.alive(coarse, fine)] = np.inf
        apart[none & self.diverging()] = 0.0
        return np.asarray(apart)

    def diverging(self) -> NDArray[np.bool_]:
        """Probes (k,) at which the plate, and not a coarse mesh alone, is believed to have no modes."""
        sizes = np.array([np.where(self.alive(size), np.nan, size) for size in self.tried])
        with np.errstate(invalid="ignore"):
            return np.asarray(np.fmax.reduce(sizes) >= SURELY * np.fmin.reduce(sizes))

    def _solved(self, operators: Operators) -> Trial:
        probes = self._modes(operators)
        frequencies = np.full((len(self.probes), self.count), np.nan)
        drifts, layered = np.zeros((2, *frequencies.shape))
        states = []
        for row, (omega, modes) in enumerate(zip(self.probes, probes, strict=False)):
            frequencies[row] = np.sqrt(modes.eigenvalues) / (2.0 * np.pi)
            drifts[row] = drift(operators, modes.eigenvalues, modes.shapes, omega)
            if kind(operators.theory) is Kind.MINDLIN:
                layered[row] = layers(operators, modes.eigenvalues, modes.shapes)
            if modes.state is not None:
                states.append((omega, modes.state))
        return Trial(operators, frequencies, drifts, layered, tuple(states))

    def _modes(self, operators: Operators) -> list[Probed]:
        """Modes at each probe; that none is missed is seen on the first mesh, and holds for its like."""
        starts = self._starts(operators)
        try:
            if not self._alone:
                probed = probe(operators, self.probes, self.count, self.exact, starts)
                further = list(zip(self.probes, probed, strict=False))[1:]
                self._alone = not (self.tried or all(complete(operators, speed, modes) for speed, modes in further))
            if self._alone:
                return probe(operators, self.probes, self.count, self.exact, starts, alone=True)
            return probed
        except (Divergence, NoEquilibrium) as error:
            self.lost = error
            return []

    def _starts(self, operators: Operators) -> dict[float, Array | None]:
        """Where large deflections begin: at those on the mesh tried last."""
        if not self.tried:
            return {}
        latest = next(reversed(self.tried.values()))
        return {speed: transfer(state, latest.operators, operators) for speed, state in latest.states if speed != 0.0}


ROUND = 1.6
"""Order of convergence from which on a corner is flat (200°), as those of a round edge made of straight ones."""

USUAL = 0.3
"""Where in the planform's range of orders the one lies that two meshes alone are taken to follow."""

SOLID = 2.0
"""The least order of bricks, which thin plates' coarse meshes converge at."""

LEAST, SLOW = 0.5, 1.0
"""Orders: the least an error is taken to fall at, and that below which three meshes are believed to show it."""

POINT = 2.0
"""Order under a point force, where the deflection of a plate goes as r² log r."""

LARGE = 0.3
"""Part of the largest difference from which one counts for whether errors hardly fall."""

MISSED = 0.1
"""Part of the edge layer that a mesh misses if its errors fall slowly for that reason."""


@dataclass(eq=False)
class Estimates:
    """Errors of the frequencies of meshes tried, at their probes.

    Attributes:
        largest: each size with its largest estimated error.
        slow: whether the errors seen last hardly fall; finer meshes are then not worth their price, and the estimate
            says what is left.
    """

    meshes: TrialMeshes
    largest: dict[int, float] = field(default_factory=dict, init=False)
    slow: bool = field(default=False, init=False)

    def errors(self, coarse: int, fine: int) -> tuple[Array, Array]:
        """Estimated relative errors (probes, count) on a coarse mesh and on a finer one.

        Infinite at speeds at which one of them has modes and the other none, or where none is not yet believed; zero
        where none is.
        """
        apart = self.meshes.apart(coarse, fine)
        errors = self._errors(apart, coarse, fine)
        self.largest[coarse], self.largest[fine] = float((apart + errors).max()), float(errors.max())
        return apart + errors, errors

    def doubted(self, errors: Array, coarse: int, fine: int) -> Array:
        """Errors (probes, count) from two meshes, corrected where a coarser one shows a slower decrease.

        Shapes that the coarser of two cells hardly resolve, as the chordwise ones of a thin plate whose tension leaves
        layers along the edges, are not yet at their order. Three meshes have shown it; errors are then as they were.
        That coarser mesh has too few cells to show an order below `SLOW`.
        """
        below = max((size for size in self.meshes.planform.sizes if size < coarse), default=None)
        if below is None or self._before(coarse) is not None or not self.meshes.alive(below, coarse, fine).any():
            return errors
        known = self.meshes.alive(below, coarse, fine)
        first, second = self.meshes.apart(below, coarse)[known], self.meshes.apart(coarse, fine)[known]
        seen = _falling(first, second, (below, coarse, fine), self._usual)
        total = errors.copy()
        total[known] = np.maximum(errors[known], second / ((fine / coarse) ** np.maximum(seen, SLOW) - 1.0))
        self.largest[fine] = float(total.max())
        return total

    def _errors(self, apart: Array, coarse: int, fine: int) -> Array:
        """Errors (probes, count) on the finer of two meshes that are so far apart.

        Where a mesh tried had no modes, two that have are not enough.
        """
        errors = self._fallen(apart, self._usual, coarse, fine)
        errors[self.meshes.alive(coarse, fine) & ~self.meshes.alive(*self.meshes.tried)] = np.inf
        before = self._before(coarse)
        if before is not None and (known := self.meshes.alive(before, coarse, fine)).any():
            errors[known] = self._by_three(self.meshes.apart(before, coarse)[known], apart[known], before, coarse, fine)
        return errors

    def _by_three(self, first: Array, second: Array, before: int, coarse: int, fine: int) -> Array:
        """Errors (k, count) on the finest of three meshes, of which the first two and the last two are so far apart.

        All together are taken to fall at an order within the theory's range. A single error may fall more slowly.
        """
        least, most = self._orders
        if self._pressed:
            self.slow = False
            return self._fallen(second, POINT, coarse, fine)
        sizes = (before, coarse, fine)
        missed = tuple(self._unseen(size) for size in sizes)
        cornered = np.zeros_like(second)
        if self._singular < most:
            cornered = layer_and_rest((first, second), tuple(size**-self._singular for size in sizes), sizes, most)
        if missed[1] > MISSED:
            self.slow = False  # for a reason that the estimate knows
            layered = layer_and_rest((first, second), missed, sizes, most)
            return layered + cornered if self._is_cornered else np.maximum(layered, cornered)
        each = _falling(first, second, sizes, most)
        together = float(_falling(first.max(), second.max(), sizes, most))
        self.slow = bool((each < SLOW)[second >= LARGE * second.max()].any())
        fallen = self._fallen(second, np.where(each < SLOW, each, max(together, least)), coarse, fine)
        return np.maximum(fallen, cornered)

    def _fallen(self, apart: Array, order: float | Array, coarse: int, fine: int) -> Array:
        """Errors on the finer of two meshes that fall at an order, no less than the layer along the edges leaves.

        At a singular corner what has fallen is the corner's, and the layer's comes on top.
        """
        layer = layer_errors(apart, self._unseen(coarse), self._unseen(fine), self.meshes.at(fine).layers[: len(apart)])
        fallen = np.asarray(apart / ((fine / coarse) ** order - 1.0))
        return fallen + layer if self._is_cornered else np.maximum(fallen, layer)

    def _before(self, coarse: int) -> int | None:
        """The mesh tried before a coarse one that shows the order with it, unless there was none but the coarsest."""
        sizes = [size for size in self.meshes.tried if size < coarse]
        # where a point mass pulls at a solid, its displacement there grows with the cells' inverse size
        if not (self._pressed and kind(self.meshes.operators.theory) is Kind.SOLID):
            sizes = [size for size in sizes if enough_cells(self.meshes.planform, size, self.meshes.count)]
        return max(sizes, default=None)

    @property
    def _is_cornered(self) -> bool:
        """Whether the planform has a singular corner, and not only the many flat ones of a round edge."""
        return self.meshes.planform.corner < ROUND

    @property
    def _usual(self) -> float:
        """The order that two meshes alone are taken to follow; the least where a corner is singular."""
        least, most = self._orders
        if self._is_cornered:
            return least
        return min(least + USUAL * (most - least), self._singular)

    @property
    def _orders(self) -> tuple[float, float]:
        """Least and greatest order at which errors fall."""
        least, most = self.meshes.planform.orders
        return (min(SOLID, least), most) if kind(self.meshes.operators.theory) is Kind.SOLID else (least, most)

    @property
    def _singular(self) -> float:
        """Order at which errors fall at an inward corner and under a point mass; infinite without."""
        return min(self.meshes.planform.corner, POINT if self._pressed else np.inf)

    @property
    def _pressed(self) -> bool:
        """Whether a point mass presses on the plate."""
        return self.meshes.operators.plate.tip_mass > 0.0

    def _unseen(self, size: int) -> float:
        """Part of the layer along the edges that a mesh misses, in a theory that has one."""
        if kind(self.meshes.operators.theory) is Kind.KIRCHHOFF:
            return 0.0
        return unseen(self.meshes.planform.edge(size), self.meshes.at(size).operators.plate.mean_thickness)


def _falling(first: Array | float, second: Array | float, sizes: tuple[int, int, int], most: float) -> Array:
    """Orders, from `LEAST` to a greatest, at which the differences of three meshes fall, those of any shape."""
    before, coarse, fine = sizes
    orders = np.linspace(LEAST, most, 36)
    falls = ((coarse / before) ** orders - 1.0) / (1.0 - (coarse / fine) ** orders)
    nearest = np.abs(falls * np.asarray(second)[..., None] - np.asarray(first)[..., None]).argmin(axis=-1)
    return np.asarray(orders[nearest])
