"""Errors of frequencies, estimated from those on coarser meshes of the same planform (Richardson 1911).

Two meshes are taken to follow the planform's usual order, three show it. Where cells do not see the layer along the
edges (`fem.accuracy.edge_layer`), errors are divided into the layer's part, which is known as far as a factor, and the
rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.accuracy.edge_layer import drift, folds, layer_and_rest, layer_errors, unseen
from fem.accuracy.probing import Probed, alone, complete, probe
from fem.accuracy.theory_error import layers
from fem.modes.real import Divergence
from fem.operators.transfer import transfer
from fem.statics.large_deflection import NoEquilibrium

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from fem.meshes.ladder import Planform
    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]

CELLS_PER_MODE = 10
"""Cells for each mode wanted of a mesh that counts as more than the coarsest."""

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

SURELY = 3.0
"""Ratio of the sizes of two meshes at which a plate diverges that makes it believed; coarse ones may do so alone."""

MISSED = 0.1
"""Part of the edge layer that a mesh misses if its errors fall slowly for that reason."""


def enough_cells(planform: Planform, size: int, count: int) -> bool:
    """Whether a mesh has enough cells for a number of modes to be more than the coarsest."""
    return int(planform.mesh(size).t.shape[1]) >= CELLS_PER_MODE * count


class Estimates:
    """Matrices and frequencies of the meshes tried so far, at a few speeds (probes, rad/s), and their errors.

    tried: each size with its largest estimated error. slow: whether the errors seen last hardly fall; finer meshes are
    then not worth their price, and the estimate says what is left. lost: why there are no modes, where there are none.
    """

    def __init__(
        self, planform: Planform, build: Callable[[int], Operators], probes: tuple[float, ...], count: int, exact: float
    ) -> None:
        self.probes = probes
        self.tried: dict[int, float] = {}
        self.slow = False
        self.lost: ArithmeticError | None = None
        self._planform = planform
        self._build = build
        self._count = count
        self._exact = exact
        self._operators: dict[int, Operators] = {}
        self._frequencies: dict[int, Array] = {}
        self._drifts: dict[int, Array] = {}
        self._layers: dict[int, Array] = {}
        self._alone = False
        self._states: dict[int, tuple[Array | None, ...]] = {}
        self._latest: int | None = None

    def errors(self, coarse: int, fine: int) -> tuple[Array, Array]:
        """Estimated relative errors (probes, count) on a coarse mesh and on a finer one.

        Infinite at speeds at which one of them has modes and the other none, or where none is not yet believed; zero
        where none is.
        """
        apart = self._apart(coarse, fine)
        errors = self._errors(apart, coarse, fine)
        self.tried[coarse], self.tried[fine] = float((apart + errors).max()), float(errors.max())
        return apart + errors, errors

    def doubted(self, errors: Array, coarse: int, fine: int) -> Array:
        """Errors (probes, count) that rest on two meshes, where the next coarser shows that they fall more slowly.

        Shapes that the coarser of two cells hardly resolve, as the chordwise ones of a thin plate whose tension leaves
        layers along the edges, are not yet at their order. Three meshes have shown it; errors are then as they were.
        That coarser mesh has too few cells to show an order below `SLOW`.
        """
        below = max((size for size in self._planform.sizes if size < coarse), default=None)
        if below is None or self._before(coarse) is not None or not self.alive(below, coarse, fine).any():
            return errors
        known = self.alive(below, coarse, fine)
        first, second = self._apart(below, coarse)[known], self._apart(coarse, fine)[known]
        seen = _falling(first, second, (below, coarse, fine), self._usual)
        found = errors.copy()
        found[known] = np.maximum(errors[known], second / ((fine / coarse) ** np.maximum(seen, SLOW) - 1.0))
        self.tried[fine] = float(found.max())
        return found

    def frequencies(self, size: int) -> Array:
        """Frequencies (probes, count) in Hz, NaN at speeds that have none."""
        if size not in self._frequencies:
            operators = self._operators[size] = self._build(size)
            found = self._modes(operators)
            frequencies, drifts, layered = (
                np.full((len(self.probes), self._count), empty) for empty in (np.nan, 0.0, 0.0)
            )
            for row, (omega, modes) in enumerate(zip(self.probes, found, strict=False)):
                frequencies[row] = np.sqrt(modes.eigenvalues) / (2.0 * np.pi)
                drifts[row] = drift(operators, modes.eigenvalues, modes.shapes, omega)
                if operators.model.theory.startswith("mindlin"):
                    layered[row] = layers(operators, modes.eigenvalues, modes.shapes)
            self._frequencies[size], self._drifts[size], self._layers[size] = frequencies, drifts, layered
            self._states[size], self._latest = tuple(modes.state for modes in found), size
        return self._frequencies[size]

    def drifts(self, size: int) -> Array:
        """How much frequencies (probes, count) of a mesh tried still fall for the sake of a point mass."""
        return self._drifts[size] * folds(self._operators[size].plate)

    def alive(self, *sizes: int) -> NDArray[np.bool_]:
        """Probes (k,) at which all of some meshes have modes."""
        found = [np.isfinite(self.frequencies(size)).all(axis=1) for size in sizes]
        return np.asarray(np.logical_and.reduce(found))

    def operators(self, size: int) -> Operators:
        """The matrices of a mesh tried."""
        return self._operators[size]

    def states(self, size: int) -> tuple[tuple[float, Array], ...]:
        """Speeds in rad/s with the state (n,) in which a mesh tried rests there, where the deflection is large."""
        known = zip(self.probes, self._states[size], strict=False)
        return tuple((speed, state) for speed, state in known if state is not None)

    def unknowns(self, size: int) -> int:
        """How many unknowns a mesh tried has."""
        return int(self._operators[size].mass.shape[0])

    @property
    def theory(self) -> str:
        """The theory of the meshes tried."""
        return next(iter(self._operators.values())).model.theory

    def _modes(self, operators: Operators) -> list[Probed]:
        """Modes at each probe; that none is missed is seen on the first mesh, and holds for its like."""
        starts, first = self._starts(operators), self._latest is None
        try:
            if not self._alone:
                found = probe(operators, self.probes, self._count, self._exact, starts)
                further = list(zip(self.probes, found, strict=False))[1:]
                self._alone = first and not all(complete(operators, speed, modes) for speed, modes in further)
            return alone(operators, self.probes, self._count, self._exact, starts) if self._alone else found
        except (Divergence, NoEquilibrium) as error:
            self.lost = error
            return []

    def _starts(self, operators: Operators) -> tuple[Array | None, ...]:
        """Where large deflections begin: at those on the mesh tried last."""
        if self._latest is None:
            return ()
        known, states = self._operators[self._latest], self._states[self._latest]
        return tuple(
            None if state is None or speed == 0.0 else transfer(state, known, operators)
            for speed, state in zip(self.probes, states, strict=False)
        )

    def _apart(self, coarse: int, fine: int) -> Array:
        """Relative differences (probes, count) between two meshes, apart from what never ends under a point mass."""
        there, here = self.frequencies(coarse), self.frequencies(fine)
        apart = np.abs(there / here - 1.0 - self._drifts[fine] * np.log(fine / coarse))
        none = ~self.alive(coarse) & ~self.alive(fine)
        apart[~self.alive(coarse, fine)] = np.inf
        apart[none & self._diverges()] = 0.0
        return np.asarray(apart)

    def _diverges(self) -> NDArray[np.bool_]:
        """Probes (k,) at which the plate, and not a coarse mesh alone, is believed to have no modes."""
        sizes = np.array([np.where(self.alive(size), np.nan, size) for size in self._frequencies])
        with np.errstate(invalid="ignore"):
            return np.asarray(np.fmax.reduce(sizes) >= SURELY * np.fmin.reduce(sizes))

    def _errors(self, apart: Array, coarse: int, fine: int) -> Array:
        """Errors (probes, count) on the finer of two meshes that are so far apart.

        Where a mesh tried had no modes, two that have are not enough.
        """
        errors = self._by_two(apart, coarse, fine)
        errors[self.alive(coarse, fine) & ~self.alive(*self._frequencies)] = np.inf
        before = self._before(coarse)
        if before is not None and (known := self.alive(before, coarse, fine)).any():
            errors[known] = self._by_three(self._apart(before, coarse)[known], apart[known], before, coarse, fine)
        return errors

    def _by_two(self, apart: Array, coarse: int, fine: int) -> Array:
        return self._fallen(apart, self._usual, coarse, fine)

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
            return np.maximum(layer_and_rest((first, second), missed, sizes, most), cornered)
        each = _falling(first, second, sizes, most)
        together = float(_falling(first.max(), second.max(), sizes, most))
        self.slow = bool((each < SLOW)[second >= LARGE * second.max()].any())
        fallen = self._fallen(second, np.where(each < SLOW, each, max(together, least)), coarse, fine)
        return np.maximum(fallen, cornered)

    def _fallen(self, apart: Array, order: float | Array, coarse: int, fine: int) -> Array:
        """Errors on the finer of two meshes that fall at an order, no less than the layer along the edges leaves."""
        layer = layer_errors(apart, self._unseen(coarse), self._unseen(fine), self._layers[fine][: len(apart)])
        return np.asarray(np.maximum(apart / ((fine / coarse) ** order - 1.0), layer))

    def _before(self, coarse: int) -> int | None:
        """The mesh tried before a coarse one that shows the order with it, unless there was none but the coarsest."""
        sizes = [size for size in self._frequencies if size < coarse]
        return max((s for s in sizes if self._pointed or enough_cells(self._planform, s, self._count)), default=None)

    @property
    def _usual(self) -> float:
        """The order that two meshes alone are taken to follow."""
        least, most = self._orders
        return min(least + USUAL * (most - least), self._singular)

    @property
    def _orders(self) -> tuple[float, float]:
        """Least and greatest order at which errors fall."""
        least, most = self._planform.orders
        return (min(SOLID, least), most) if self.theory.startswith("solid") else (least, most)

    @property
    def _singular(self) -> float:
        """Order at which errors fall at an inward corner and under a point mass; infinite without."""
        return min(self._planform.corner, POINT if self._pressed else np.inf)

    @property
    def _pressed(self) -> bool:
        """Whether a point mass presses on the plate."""
        return next(iter(self._operators.values())).plate.tip_mass > 0.0

    @property
    def _pointed(self) -> bool:
        """Whether a point mass pulls at a solid: its displacement there grows with the cells' inverse size."""
        return self.theory.startswith("solid") and self._pressed

    def _unseen(self, size: int) -> float:
        """Part of the layer along the edges that a mesh misses, in a theory that has one."""
        if self.theory.startswith("kirchhoff"):
            return 0.0
        return unseen(self._planform.edge(size), self._operators[size].plate.mean_thickness)


def _falling(first: Array, second: Array, sizes: tuple[int, int, int], most: float) -> Array:
    """Orders, from `LEAST` to a greatest, at which the differences of three meshes fall, those of any shape."""
    before, coarse, fine = sizes
    orders = np.linspace(LEAST, most, 36)
    falls = ((coarse / before) ** orders - 1.0) / (1.0 - (coarse / fine) ** orders)
    nearest = np.abs(falls * np.asarray(second)[..., None] - np.asarray(first)[..., None]).argmin(axis=-1)
    return np.asarray(orders[nearest])
