"""The meshes of a planform that have been tried: their matrices and frequencies at a few speeds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.accuracy.edge_layer import drift, folds
from fem.accuracy.probing import Probed, alone, complete, probe
from fem.accuracy.theory_error import layers
from fem.modes.real import Divergence
from fem.operators.transfer import transfer
from fem.statics.large_deflection import NoEquilibrium
from fem.theory.kind import Kind, kind

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from fem.meshes.ladder import Planform
    from fem.operators.assembly import Operators
    from fem.plate.given import Plate

    Array = NDArray[np.float64]

SURELY = 3.0
"""Ratio of the sizes of two meshes at which a plate diverges that makes it believed; coarse ones may do so alone."""


class Tried:
    """Solves each mesh once, when it is first asked for.

    Attributes:
        probes: speeds in rad/s.
        count: of modes.
        exact: relative accuracy of their squared frequencies.
        lost: why there are no modes, where there are none.
    """

    def __init__(
        self, planform: Planform, build: Callable[[int], Operators], probes: tuple[float, ...], count: int, exact: float
    ) -> None:
        self.planform = planform
        self.probes = probes
        self.count = count
        self.lost: ArithmeticError | None = None
        self._build = build
        self._exact = exact
        self._operators: dict[int, Operators] = {}
        self._frequencies: dict[int, Array] = {}
        self._drifts: dict[int, Array] = {}
        self._layers: dict[int, Array] = {}
        self._alone = False
        self._states: dict[int, tuple[Array | None, ...]] = {}
        self._latest: int | None = None

    @property
    def sizes(self) -> tuple[int, ...]:
        """Of the meshes tried."""
        return tuple(self._frequencies)

    @property
    def plate(self) -> Plate:
        """On any of the meshes tried."""
        return next(iter(self._operators.values())).plate

    @property
    def theory(self) -> str:
        """The theory of the meshes tried."""
        return next(iter(self._operators.values())).model.theory

    def frequencies(self, size: int) -> Array:
        """Frequencies (probes, count) in Hz, NaN at speeds that have none."""
        if size not in self._frequencies:
            operators = self._operators[size] = self._build(size)
            found = self._modes(operators)
            frequencies, drifts, layered = (
                np.full((len(self.probes), self.count), empty) for empty in (np.nan, 0.0, 0.0)
            )
            for row, (omega, modes) in enumerate(zip(self.probes, found, strict=False)):
                frequencies[row] = np.sqrt(modes.eigenvalues) / (2.0 * np.pi)
                drifts[row] = drift(operators, modes.eigenvalues, modes.shapes, omega)
                if kind(operators.model.theory) is Kind.MINDLIN:
                    layered[row] = layers(operators, modes.eigenvalues, modes.shapes)
            self._frequencies[size], self._drifts[size], self._layers[size] = frequencies, drifts, layered
            self._states[size], self._latest = tuple(modes.state for modes in found), size
        return self._frequencies[size]

    def drifts(self, size: int) -> Array:
        """How much frequencies (probes, count) of a mesh tried still fall for the sake of a point mass."""
        return self._drifts[size] * folds(self._operators[size].plate)

    def layers(self, size: int) -> Array:
        """Compliance (probes, count) of the layer along the edges in each mode; zero in theories without one."""
        return self._layers[size]

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

    def apart(self, coarse: int, fine: int) -> Array:
        """Relative differences (probes, count) between two meshes, apart from what never ends under a point mass."""
        there, here = self.frequencies(coarse), self.frequencies(fine)
        apart = np.abs(there / here - 1.0 - self._drifts[fine] * np.log(fine / coarse))
        none = ~self.alive(coarse) & ~self.alive(fine)
        apart[~self.alive(coarse, fine)] = np.inf
        apart[none & self.diverging()] = 0.0
        return np.asarray(apart)

    def diverging(self) -> NDArray[np.bool_]:
        """Probes (k,) at which the plate, and not a coarse mesh alone, is believed to have no modes."""
        sizes = np.array([np.where(self.alive(size), np.nan, size) for size in self.sizes])
        with np.errstate(invalid="ignore"):
            return np.asarray(np.fmax.reduce(sizes) >= SURELY * np.fmin.reduce(sizes))

    def _modes(self, operators: Operators) -> list[Probed]:
        """Modes at each probe; that none is missed is seen on the first mesh, and holds for its like."""
        starts, first = self._starts(operators), self._latest is None
        try:
            if not self._alone:
                found = probe(operators, self.probes, self.count, self._exact, starts)
                further = list(zip(self.probes, found, strict=False))[1:]
                self._alone = first and not all(complete(operators, speed, modes) for speed, modes in further)
            return alone(operators, self.probes, self.count, self._exact, starts) if self._alone else found
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
