"""Trial meshes of a planform: their matrices and frequencies at a few speeds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fem.accuracy.edge_layer import drift, folds
from fem.accuracy.theory_selection import layers
from fem.linalg import factorise, lowest_modes
from fem.modes.real import Divergence, Modes, check_count, solve_real
from fem.modes.solve import solve_modes
from fem.operators.assembly import transfer
from fem.statics import NoEquilibrium, linearise, settle, tangent
from fem.theory.registry import Kind, kind

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.linalg import Solver
    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]
    from fem.meshes.mesh_sequence import Planform
    from fem.plate import Plate


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
    operators: Operators, speeds: tuple[float, ...], count: int, exact: float, starts: tuple[Array | None, ...] = ()
) -> list[Probed]:
    """Find the count lowest modes at speeds in rad/s, ascending, up to the first at which the plate has none.

    exact: relative, of squared frequencies. starts: states (n,) near those of large deflections, for each speed.

    Raises:
        ValueError: as `solve_modes` does.
        Divergence, NoEquilibrium: at the first speed.
        Unresolved: the plate is too thin for its theory in double precision.
    """
    return _climb(operators, speeds, count, exact, starts, _from)


def alone(
    operators: Operators, speeds: tuple[float, ...], count: int, exact: float, starts: tuple[Array | None, ...] = ()
) -> list[Probed]:
    """The same as `probe`, every speed solved by itself."""
    return _climb(operators, speeds, count, exact, starts, _by_itself)


def _climb(
    operators: Operators,
    speeds: tuple[float, ...],
    count: int,
    exact: float,
    starts: tuple[Array | None, ...],
    further: Callable[[Operators, Modes, float, float, Array | None], Probed],
) -> list[Probed]:
    each = dict(zip(speeds, starts, strict=False))
    first = _solve(operators, speeds[0], count, exact, each.get(speeds[0]))
    found = [_kept(first)]
    for speed in speeds[1:]:
        try:
            found.append(further(operators, first, speed, exact, each.get(speed)))
        except (Divergence, NoEquilibrium):
            break
    return found


def complete(operators: Operators, speed: float, modes: Probed) -> bool:
    """Whether modes at a speed in rad/s are the lowest, none left out: by the inertia of a shifted stiffness."""
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


def _by_itself(operators: Operators, known: Modes, speed: float, exact: float, start: Array | None) -> Probed:
    """As many modes at a speed in rad/s as are known at another, not made from these."""
    return _kept(_solve(operators, speed, known.eigenvalues.size, exact, start))


def _from(operators: Operators, known: Modes, speed: float, exact: float, start: Array | None) -> Probed:
    """Modes at a speed in rad/s from those at another, or by themselves where they differ too much."""
    if operators.gyroscopic is None:
        stiffness, start, factor = _near(operators, known, speed, exact, start)
        near = lowest_modes(stiffness, operators.mass, known.shapes, factor, exact)
        if near is not None and near[0][0] > 0.0:
            return Probed(*near, start)
    return _kept(solve_modes(operators, speed, known.eigenvalues.size, start=start))


def _near(
    operators: Operators, known: Modes, speed: float, exact: float, start: Array | None
) -> tuple[csc_array, Array | None, Solver]:
    """The stiffness (n, n) at a speed, the state it is taken about, and the factor of a similar one."""
    if not operators.effects.large_deflection:
        return operators.at(speed), None, known.factor
    state, factor = settle(operators, speed, start, BENT * exact)
    return tangent(operators, speed, state), state, factor


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
