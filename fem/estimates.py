"""Errors of frequencies, estimated from those on coarser meshes of the same planform (Richardson 1911).

Two meshes are taken to follow the planform's usual order, three show it. Where cells do not see the layer along the
edges (`fem.singular`), errors are divided into the layer's part, which is known as far as a factor, and the rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.probing import probe
from fem.singular import drift, layer_and_rest, layer_errors, unseen
from fem.transfer import transfer

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from fem.levels import Planform
    from fem.operators import Operators

    Array = NDArray[np.float64]

CELLS_PER_MODE = 10
"""Cells for each mode wanted of a mesh that counts as more than the coarsest."""

USUAL = 0.3
"""Where in the planform's range of orders the one lies that two meshes alone are taken to follow."""

LEAST, SLOW = 0.5, 1.0
"""Orders: the least an error is taken to fall at, and that below which three meshes are believed to show it."""

LARGE = 0.3
"""Part of the largest difference from which one counts for whether errors hardly fall."""

MISSED = 0.1
"""Part of the edge layer that a mesh misses if its errors fall slowly for that reason."""


def enough_cells(planform: Planform, size: int, count: int) -> bool:
    """Whether a mesh has enough cells for a number of modes to be more than the coarsest."""
    return int(planform.mesh(size).t.shape[1]) >= CELLS_PER_MODE * count


class Estimates:
    """Matrices and frequencies of the meshes tried so far, at a few speeds (probes, rad/s), and their errors.

    tried: each size with its largest estimated error. slow: whether the errors seen last hardly fall; finer meshes are
    then not worth their price, and the estimate says what is left.
    """

    def __init__(
        self, planform: Planform, build: Callable[[int], Operators], probes: tuple[float, ...], count: int, exact: float
    ) -> None:
        self.probes = probes
        self.tried: dict[int, float] = {}
        self.slow = False
        self._planform = planform
        self._build = build
        self._count = count
        self._exact = exact
        self._operators: dict[int, Operators] = {}
        self._frequencies: dict[int, Array] = {}
        self._drifts: dict[int, Array] = {}
        self._latest: tuple[Operators, tuple[Array | None, ...]] | None = None

    def errors(self, coarse: int, fine: int) -> tuple[Array, Array]:
        """Estimated relative errors (probes, count) on a coarse mesh and on a finer one."""
        apart = self._apart(coarse, fine)
        errors = self._errors(apart, coarse, fine)
        self.tried[coarse], self.tried[fine] = float((apart + errors).max()), float(errors.max())
        return apart + errors, errors

    def frequencies(self, size: int) -> Array:
        """Frequencies (probes, count) in Hz, for as many probes as have any."""
        if size not in self._frequencies:
            operators = self._operators[size] = self._build(size)
            found = probe(operators, self.probes, self._count, self._exact, self._starts(operators))
            self._frequencies[size] = np.array([np.sqrt(modes.eigenvalues) / (2.0 * np.pi) for modes in found])
            self._drifts[size] = np.array([drift(operators, modes.eigenvalues, modes.shapes) for modes in found])
            self._latest = operators, tuple(modes.state for modes in found)
        return self._frequencies[size]

    def drifts(self, size: int) -> Array:
        """What `fem.singular.drift` says (probes, count) of a mesh tried."""
        return self._drifts[size]

    def operators(self, size: int) -> Operators:
        """The matrices of a mesh tried."""
        return self._operators[size]

    def unknowns(self, size: int) -> int:
        """How many unknowns a mesh tried has."""
        return int(self._operators[size].mass.shape[0])

    @property
    def theory(self) -> str:
        """The theory of the meshes tried."""
        return next(iter(self._operators.values())).model.theory

    @property
    def pointed(self) -> bool:
        """Whether a point mass pulls at a solid: its displacement there grows with the cells' inverse size."""
        return self.theory.startswith("solid") and next(iter(self._operators.values())).plate.tip_mass > 0.0

    def _starts(self, operators: Operators) -> tuple[Array | None, ...]:
        """Where large deflections begin: at those on the mesh tried last."""
        if self._latest is None:
            return ()
        known, states = self._latest
        return tuple(None if state is None else transfer(state, known, operators) for state in states)

    def _apart(self, coarse: int, fine: int) -> Array:
        """Relative differences (probes, count) between two meshes, apart from what never ends under a point mass."""
        there, here = self.frequencies(coarse), self.frequencies(fine)
        common = min(len(there), len(here))
        drift = self._drifts[fine][:common] * np.log(fine / coarse)
        return np.asarray(np.abs(there[:common] / here[:common] - 1.0 - drift))

    def _errors(self, apart: Array, coarse: int, fine: int) -> Array:
        """Errors (probes, count) on the finer of two meshes that are so far apart."""
        least, most = self._planform.orders
        missed = self._unseen(coarse), self._unseen(fine)
        before = self._before(coarse)
        if before is not None and missed[0] > MISSED:
            self.slow = False  # for a reason that the estimate knows
            both = self._apart(before, coarse)[: len(apart)], apart
            return layer_and_rest(both, (self._unseen(before), *missed), (before, coarse, fine), most)
        usual = least + USUAL * (most - least)
        order = usual if before is None else self._orders(apart, before, coarse, fine)
        slenderness = self._operators[fine].plate.thickness / min(self._planform.sides)
        layer = layer_errors(apart, *missed, slenderness)
        return np.asarray(np.maximum(apart / ((fine / coarse) ** order - 1.0), layer))

    def _orders(self, second: Array, before: int, coarse: int, fine: int) -> Array:
        """The order (probes, count) at which each error falls, by three meshes of which the last two are so far apart.

        All together are taken to fall within the planform's range. A single error may fall more slowly.
        """
        least, most = self._planform.orders
        first = self._apart(before, coarse)[: len(second)]
        orders = np.linspace(LEAST, most, 36)
        falls = ((coarse / before) ** orders - 1.0) / (1.0 - (coarse / fine) ** orders)
        each = orders[np.abs(falls * second[..., None] - first[..., None]).argmin(axis=-1)]
        together = orders[np.abs(falls * second.max() - first.max()).argmin()]
        self.slow = bool((each < SLOW)[second >= LARGE * second.max()].any())
        return np.asarray(np.where(each < SLOW, each, max(together, least)))

    def _before(self, coarse: int) -> int | None:
        """The mesh tried before a coarse one that shows the order, unless there was none but the coarsest."""
        sizes = [size for size in self._frequencies if size < coarse]
        return max((s for s in sizes if self.pointed or enough_cells(self._planform, s, self._count)), default=None)

    def _unseen(self, size: int) -> float:
        """Part of the layer along the edges that a mesh misses, in a theory that has one."""
        if self.theory.startswith("kirchhoff"):
            return 0.0
        return unseen(self._planform.edge(size), self._operators[size].plate.thickness)
