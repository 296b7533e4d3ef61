"""The cheapest mesh of a planform's ladder whose frequencies are good to a tolerance.

Two coarse meshes give an estimate of the error (Richardson 1911), the estimate predicts the mesh that is needed, and
that mesh together with the one before confirms it. Coarse meshes cost next to nothing, so that the search adds
little to the mesh it ends with.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from fem.modes import Divergence, solve_modes
from fem.singular import drift, layer_errors, unseen
from fem.statics import NoEquilibrium

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from fem.levels import Planform
    from fem.modes import Modes
    from fem.operators import Operators

    Array = NDArray[np.float64]

CELLS_PER_MODE = 10
"""Cells of the second mesh tried, for each mode wanted."""

MARGIN = 1.25
"""Factor on the error by which the next mesh is chosen, so that one step is mostly enough."""

STEP = 2.0
"""Largest ratio of sizes from one mesh to the next: estimates from coarse meshes reach no further."""

SLOWEST, SLOW = 0.5, 1.0
"""Orders: the least an error is taken to fall at, and that below which three meshes are believed to show it."""

EARLY_SLOWEST, EARLY_SLOW = 2.5, 3.0
"""The same for the first three meshes, the coarsest of which may have come close by chance."""

MISSED = 0.1
"""Part of the edge layer that a mesh misses if its errors fall slowly for that reason."""

PATIENCE = 4
"""Meshes tried before errors that hardly fall end the search: coarse ones may not show yet how they fall."""

FIRST = 0.6
"""Part of the tolerance that an estimate must meet while it rests on two meshes, its order not measured yet."""

MOST_UNKNOWNS = {"mindlin": 100_000, "kirchhoff": 100_000, "solid": 60_000}
"""Unknowns beyond which no finer mesh is tried, by theory: a factor then takes seconds and some gigabytes."""


@dataclass(frozen=True, eq=False)
class Choice:
    """A plate on the mesh chosen, and what is known of its errors.

    size: in the planform's ladder. probes: (k,) speeds in rad/s at which errors were estimated, ascending.
    errors: (k, count) relative, of the frequencies, NaN where there is only one mesh. tolerance: asked for. tried: each
    size with its largest error.
    """

    operators: Operators
    size: int
    probes: Array
    errors: Array
    tolerance: float
    tried: tuple[tuple[int, float], ...] = field(default=())

    @property
    def met(self) -> bool:
        """Whether the estimates are known and within the tolerance; otherwise the finest mesh allowed was taken."""
        return bool(self.errors.max() <= self.tolerance)

    def errors_at(self, omega: float) -> Array:
        """Estimated relative errors (count,) at a speed in rad/s, between the probes linear in its square."""
        return np.array([np.interp(omega**2, self.probes**2, column) for column in self.errors.T])


def choose_mesh(
    planform: Planform, build: Callable[[int], Operators], speeds: tuple[float, ...], count: int, tolerance: float
) -> Choice:
    """Choose the mesh on which the count lowest frequencies are good to a relative tolerance.

    build: from a size of the planform's ladder to matrices. speeds: in rad/s; errors are estimated at the lowest and
    at the highest, or where the plate diverges there at the lowest alone.
    Raises Divergence or NoEquilibrium when there is no mode at the lowest speed, ValueError for a tolerance of 0 or
    less.
    """
    if not tolerance > 0.0:
        raise ValueError(f"tolerance must be above 0, got {tolerance!r}")
    search = _Search(planform, build, tuple(sorted({min(speeds), max(speeds)})), count)
    if len(planform.sizes) == 1:
        return search.unknown(tolerance)
    coarse, fine = _first_pair(planform, count)
    while True:
        before, errors = search.errors(coarse, fine)
        search.tried[coarse], search.tried[fine] = float(before.max()), float(errors.max())
        safe = tolerance * search.trust
        if search.tried[coarse] <= safe:
            return search.end(coarse, before, tolerance)
        following = _next(planform, search.unknowns(fine), search.theory, fine, search.hoped / tolerance)
        if search.tried[fine] <= safe or following is None or (search.slow and len(search.tried) > PATIENCE):
            return search.end(fine, errors, tolerance)
        coarse, fine = fine, following


def _first_pair(planform: Planform, count: int) -> tuple[int, int]:
    """The meshes to begin with: the first with some cells for each mode, and one of half its size or less."""
    sizes = planform.sizes
    fine = next((size for size in sizes[1:] if planform.mesh(size).t.shape[1] >= CELLS_PER_MODE * count), sizes[-1])
    return max(size for size in sizes if size <= max(fine / 2, sizes[0])), fine


def _next(planform: Planform, unknowns: int, theory: str, size: int, excess: float) -> int | None:
    """The size that should bring an error down by a factor, the largest that may be tried, or None."""
    most = MOST_UNKNOWNS[theory.partition("/")[0]]
    finer = [other for other in planform.sizes if other > size and unknowns * (other / size) ** 2 <= most]
    wanted = size * min(max(MARGIN, (MARGIN * excess) ** (2.0 / sum(planform.orders))), STEP)
    return next((other for other in finer if other >= wanted), finer[-1] if finer else None)


class _Search:
    """Matrices and frequencies of the sizes tried so far."""

    def __init__(
        self, planform: Planform, build: Callable[[int], Operators], probes: tuple[float, ...], count: int
    ) -> None:
        self._planform = planform
        self._build = build
        self._probes = probes
        self._count = count
        self._operators: dict[int, Operators] = {}
        self._frequencies: dict[int, Array] = {}
        self._drifts: dict[int, Array] = {}
        self.tried: dict[int, float] = {}
        self.slow = False
        self.hoped = np.inf

    @property
    def trust(self) -> float:
        """Part of the tolerance that an estimate must meet."""
        if len(self.tried) > 2:
            return 1.0
        return 0.0 if self._pointed else FIRST

    @property
    def _pointed(self) -> bool:
        """Whether a point mass pulls at a solid: its displacement there grows with the cells' inverse size."""
        return self.theory.startswith("solid") and next(iter(self._operators.values())).plate.tip_mass > 0.0

    @property
    def theory(self) -> str:
        return next(iter(self._operators.values())).model.theory

    def unknowns(self, size: int) -> int:
        return int(self._operators[size].mass.shape[0])

    def errors(self, coarse: int, fine: int) -> tuple[Array, Array]:
        """Estimated errors (probes, count) on a coarse mesh and on a finer one."""
        apart, orders = self._apart(coarse, fine), self._orders(coarse, fine)
        usual = np.maximum(orders, self._planform.orders[0]) if self._early(coarse) else orders
        layer = self._layer(apart, coarse, fine)
        likely, errors = (np.maximum(apart / ((fine / coarse) ** order - 1.0), layer) for order in (usual, orders))
        self.hoped = float(likely.max())
        return apart + errors, errors

    def _layer(self, apart: Array, coarse: int, fine: int) -> Array:
        """What the cells of the finer mesh miss of the layer along the edges."""
        slenderness = self._operators[fine].plate.thickness / min(self._planform.sides)
        return layer_errors(apart, self._unseen(coarse), self._unseen(fine), slenderness)

    def _unseen(self, size: int) -> float:
        """Part of the layer along the edges that a mesh misses, in a theory that has one."""
        if self.theory.startswith("kirchhoff"):
            return 0.0
        return unseen(self._planform.edge(size), self._operators[size].plate.thickness)

    def end(self, size: int, errors: Array, tolerance: float) -> Choice:
        probes = np.array(self._probes[: len(errors)])
        errors = np.maximum(errors, self._drifts[size][: len(errors)])
        return Choice(self._operators[size], size, probes, errors, tolerance, tuple(sorted(self.tried.items())))

    def unknown(self, tolerance: float) -> Choice:
        """The only mesh there is, with errors that nothing tells."""
        size = self._planform.sizes[0]
        return self.end(size, np.full_like(self._solve(size), np.nan), tolerance)

    def _orders(self, coarse: int, fine: int) -> Array:
        """The order (probes, count) at which each error falls, by the size tried before; the least without one.

        All together are taken to fall within the planform's range. A single error may fall more slowly.
        """
        least, most = self._planform.orders
        second = self._apart(coarse, fine)
        before = [size for size in self._frequencies if size < coarse]
        if not before:
            return np.full_like(second, least)
        first = self._apart(max(before), coarse)[: len(second)]
        slowest, slow = (EARLY_SLOWEST, EARLY_SLOW) if self._early(coarse) else (SLOWEST, SLOW)
        orders = np.linspace(slowest, most, 36)
        falls = ((coarse / max(before)) ** orders - 1.0) / (1.0 - (coarse / fine) ** orders)
        each = orders[np.abs(falls * second[..., None] - first[..., None]).argmin(axis=-1)]
        together = orders[np.abs(falls * second.max() - first.max()).argmin()]
        if not self._early(coarse) and self._unseen(coarse) > MISSED:  # slow for a reason that has an estimate
            self.slow = False
            return np.full_like(each, max(together, least))
        # Where the largest errors hardly fall, finer meshes are not worth their price: the estimate says what is left.
        self.slow = bool((each < slow)[second >= 0.3 * second.max()].any())
        return np.asarray(np.where(each < slow, each, max(together, least)))

    def _early(self, coarse: int) -> bool:
        """Whether no more than one mesh came before this one, and orders are hardly known."""
        return sum(size < coarse for size in self._frequencies) < 2 and not self._pointed

    def _apart(self, coarse: int, fine: int) -> Array:
        """Relative differences (probes, count) between two meshes, apart from what never ends under a point mass."""
        there, here = self._solve(coarse), self._solve(fine)
        common = min(len(there), len(here))
        drift = self._drifts[fine][:common] * np.log(fine / coarse)
        return np.asarray(np.abs(there[:common] / here[:common] - 1.0 - drift))

    def _solve(self, size: int) -> Array:
        """Frequencies (probes, count) in Hz, for as many probes as have any."""
        if size not in self._frequencies:
            operators = self._operators[size] = self._build(size)
            found: list[Modes] = []
            for speed in self._probes:
                try:
                    found.append(solve_modes(operators, speed, self._count))
                except (Divergence, NoEquilibrium):
                    if not found:
                        raise
            self._frequencies[size] = np.array([modes.frequencies_hz for modes in found])
            self._drifts[size] = np.array([drift(operators, modes) for modes in found])
        return self._frequencies[size]
