"""What every plate theory hands to the rest: fields in the plane and how these move a point in space.

A point X = (x, y, z) moves by U = T(z) f, where f are the displacement fields of the plane, and the gradient
of U is H = D(z) g with the gradient fields g. A theory is its fields and its layers (z, weight, T, D); loads,
inertia, softening, Coriolis and prestress are then the same few integrals for every theory.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.linalg import Array, Ints
from fem.meshes.planform import root_facets
from fem.plate import Plate
from fem.theory.fields import CLAMPED, Block, Fields
from fem.theory.finite_rotation import Section, SectionStress, Shear, ShearStress
from fem.theory.sections import Layer, Quadratic, QuadraticStress

Energy = Quadratic | Section | Shear
"""A part of the elastic energy, and `at` a state the same there."""

Stressed = QuadraticStress | SectionStress | ShearStress
"""A part of the elastic energy at a state.

Each has its `stress`; its `force`, the energy's derivative; `ahead` of a step, the stress that this leads to, to first
order; and the `terms` of its tangent stiffness under a stress (see `gram`).
"""


@dataclass(frozen=True, eq=False)
class Space:
    """A scalar finite-element space: a scikit-fem basis and the numbers of its unknowns.

    Attributes:
        dofs: (ncell, ndof).
        height: for bricks, the reference height of the mid-surface in the first bricks.
        units: (2, ncell), lengths in m of the basis's own units of x and y in every cell; None: m.
        counted: (ncell, ndof), by what a cell's shape function counts an unknown: -1 where backwards, as normal slopes
            are on one of two neighbours.
        combined: (nbasis, ndof), what each unknown moves of the basis's own functions, where that is more than one.
    """

    basis: Any
    dofs: Ints
    height: float | None = None
    units: Array | None = None
    counted: Array | None = None
    combined: Array | None = None

    def table(self, derivatives: tuple[tuple[int, ...], ...]) -> Array:
        """Tabulate derivatives as the fields of a block: () the value, (0,) d/dx, (0, 1) d²/dxdy."""
        functions = [self.basis.basis[j][0] for j in range(self.basis.Nbfun)]
        return np.stack([self._tabulated(functions, each) for each in derivatives], axis=2)

    def values(self, reference: Array) -> Array:
        """Values (..., ndof) of the functions, the same in every cell, at reference points (d, ...)."""
        functions = [self.basis.elem.lbasis(reference, j)[0] for j in range(self.basis.Nbfun)]
        table = np.stack(functions, axis=-1)
        return table if self.combined is None else np.asarray(table @ self.combined)

    def probe(self, cells: Ints, reference: Array, derivative: tuple[int, ...] = ()) -> tuple[Array, Ints]:
        """Weights and unknowns (npoint, ndof) of a derivative at points of cells.

        Args:
            cells: numbers, shape (npoint,).
            reference: planar reference coordinates, shape (2, npoint).
            derivative: numbers of the coordinates to differentiate by; none: the value.
        """
        return self.weights(reference[:, :, None], derivative, cells)[:, 0], self.dofs[cells]

    def weights(self, at: Array, derivative: tuple[int, ...] = (), cells: Ints | None = None) -> Array:
        """Weights (ncell, npoint, ndof) of a derivative at planar reference points of some cells, or of all.

        at: (2, npoint), the same in every cell, or (2, ncell, npoint).
        """
        if self.height is not None:
            at = np.concatenate([at, np.full((1, *at.shape[1:]), self.height)])
        element, mapping = self.basis.elem, self.basis.mapping
        functions = [element.gbasis(mapping, at, j, tind=cells)[0] for j in range(self.basis.Nbfun)]
        return self._tabulated(functions, derivative, slice(None) if cells is None else cells)

    def _tabulated(self, functions: list[Any], derivative: tuple[int, ...], cells: Any = slice(None)) -> Array:
        """A derivative (ncell, npoint, ndof) of each unknown, from the basis's functions in some cells."""
        weights = np.stack([_component(f, derivative) for f in functions], axis=-1)
        if self.units is not None:
            weights = weights / self.units[list(derivative)].prod(axis=0)[cells, None, None]
        weights = weights if self.combined is None else weights @ self.combined
        return weights if self.counted is None else weights * self.counted[cells][:, None]


def _component(field: Any, derivative: tuple[int, ...]) -> Array:
    source = (np.asarray(field), field.grad, field.hess)[len(derivative)]
    return np.asarray(source[derivative] if derivative else source)


def blocks(spaces: tuple[Space, ...], derivatives: tuple[tuple[int, ...], ...]) -> list[Block]:
    """Derivatives in each of some spaces; those of the same basis have one table."""
    tables: dict[int, Array] = {}
    for space in spaces:
        if id(space.basis) not in tables:
            tables[id(space.basis)] = space.table(derivatives)
    return [Block(tables[id(space.basis)], space.dofs) for space in spaces]


def number(spaces: list[tuple[Any, Ints]]) -> tuple[list[Ints], int]:
    """Free unknowns of several bases in one numbering.

    Args:
        spaces: (basis, clamped unknowns of that basis).

    Returns:
        The (ncell, ndof) tables and the total.
    """
    tables, start = [], 0
    for basis, clamped in spaces:
        free = np.ones(basis.N, dtype=bool)
        free[clamped] = False
        numbers = np.where(free, start + np.cumsum(free) - 1, CLAMPED)
        tables.append(np.ascontiguousarray(numbers[basis.element_dofs].T))
        start += int(free.sum())
    return tables, start


def clamped(basis: Any, plate: Plate) -> Ints:
    """Unknowns of a scalar basis that the plate's root holds."""
    if plate.elastic_root is not None:
        return np.empty(0, dtype=np.int64)
    return np.asarray(basis.get_dofs(root_facets(basis.mesh)).flatten())


@dataclass(frozen=True, eq=False)
class Discretisation:
    """A plate in one theory.

    Attributes:
        points: (3, ncell, npoint) in m, z = 0 for plates.
        displacement, gradient: the fields f and g.
        inertia, elastic: layers that carry mass and stiffness.
        stiffness: elastic matrix of the direct strains, Voigt (3, 3) or (6, 6) in Pa.
        extra: further elastic terms (fields, coefficients) that take no prestress: transverse shear, springs at the
            root.
        energies: the parts of the elastic energy at large displacements; at small ones elastic and extra.
        membrane: numbers of the unknowns that a linear prestress may move.
        spaces: the spaces of u, v and w, for values at points.
        mesh: the planform they live on.
    """

    theory: str
    points: Array
    displacement: Fields
    gradient: Fields
    inertia: tuple[Layer, ...]
    elastic: tuple[Layer, ...]
    stiffness: Array
    extra: tuple[tuple[Fields, Array], ...]
    energies: tuple[Energy, ...]
    membrane: Ints
    spaces: tuple[Space, Space, Space]
    mesh: Any

    @property
    def dofs(self) -> int:
        """Number of free unknowns."""
        return self.displacement.dofs
