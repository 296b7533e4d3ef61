"""Matrices of a solid blade on a rotor, and its elastic forces and stiffness at large displacements.

Total Lagrangian: Green's strain, St. Venant and Kirchhoff's stress S = lambda tr(E) I + 2 mu E, forces of F S on the
reference configuration; rotations and displacements may be of any size. The centrifugal load is that of the displaced
mass, Omega² rho (I - n n^T)(X + u). All cells of a kind are integrated together (batched products over cells and
points), and summed into blocks of 3 x 3 whose places are found once.

Points of integration are by default those of CalculiX: hexahedra of 20 nodes have 2 x 2 x 2 for stiffness and mass
(C3D20R), which do not lock where cells are thin; "full" is 3 x 3 x 3 (C3D20). Tetrahedra of 10 nodes have 4 (C3D10),
wedges of 15 nodes 9 (C3D15), hexahedra of 8 nodes 2 x 2 x 2 and of 27 nodes 3 x 3 x 3. Rules of triangles and
tetrahedra: Zienkiewicz, Taylor and Zhu, The Finite Element Method, 7th ed., tables 3.2 and 3.3.

Nodes are numbered by nested dissection of the mesh's graph (METIS, where pymetis is installed), so that factors are
made in the natural order: at 60 000 unknowns in half of the time that the general orderings take.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array, csc_array

from fem import linalg
from fem.linalg import Array, Factor, Ints, Nearby, Solver, symmetric
from fem.meshes.cells import cell
from fem.modes import Modes
from fem.rotor import Effects, across, turning
from fem.solid.blade import Blade

if TYPE_CHECKING:
    from fem.modal_model import Place

Rule = tuple[Array, Array]


AT_ONCE = 2_000_000
"""Pairs of nodes, nine numbers each, whose stiffness is summed at once."""

IN_CACHE = 20_000
"""Pairs of nodes of cells that are integrated at once: what lies between points and stiffness stays in the cache."""


def rule(kind: str, full: bool = False) -> Rule:
    """Quadrature for stiffness and mass: points (npoint, 3) and weights (npoint,) on the reference cell of a kind."""
    if kind.startswith("hexahedron"):
        return _gauss(3 if kind == "hexahedron27" or (full and kind == "hexahedron20") else 2)
    if kind.startswith("wedge"):
        return _wedge(3 if kind == "wedge15" else 2)
    a, b = (5.0 + 3.0 * 5.0**0.5) / 20.0, (5.0 - 5.0**0.5) / 20.0
    return np.array([(b, b, b), (a, b, b), (b, a, b), (b, b, a)]), np.full(4, 1.0 / 24.0)


def _gauss(order: int) -> Rule:
    x, w = np.polynomial.legendre.leggauss(order)
    points = np.array([(a, b, c) for c, b, a in product(x, repeat=3)])
    return points, np.array([a * b * c for c, b, a in product(w, repeat=3)])


def _wedge(line: int) -> Rule:
    z, w = np.polynomial.legendre.leggauss(line)
    triangle = np.array([(1.0, 1.0), (4.0, 1.0), (1.0, 4.0)]) / 6.0
    points = np.array([(*at, height) for height in z for at in triangle])
    return points, np.repeat(w, 3) / 6.0


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of one kind at the points of their stiffness.

    Attributes:
        kind: as in `fem.meshes.cells`.
        nodes: (ncell, nnode) in the mesh's numbers.
        gradients: derivatives of the shape functions in m, (ncell, npoint, 3, nnode).
        weights: volumes of the points in m³, (ncell, npoint).
    """

    kind: str
    nodes: Ints
    gradients: Array
    weights: Array

    def parts(self, numbers: int, whole: slice | None = None) -> Iterator[slice]:
        """Slices of the cells, or of some of them, that have so many pairs of nodes."""
        begin, end, _ = (whole or slice(None)).indices(len(self.nodes))
        step = max(numbers // self.nodes.shape[1] ** 2, 1)
        for first in range(begin, end, step):
            yield slice(first, min(first + step, end))


def mapped(kind: str, corners: Array, points: Array, weights: Array) -> tuple[Array, Array, Array]:
    """Shape functions, their gradients, and volumes at points of cells.

    Args:
        kind: of the cells, as in `fem.meshes.cells`.
        corners: coordinates of all nodes of each cell, (ncell, nnode, 3) [m].
        points: on the reference cell, (npoint, 3).
        weights: of the points, (npoint,).

    Returns:
        Shape functions (npoint, nnode), gradients (ncell, npoint, 3, nnode) [1/m] and volumes (ncell, npoint) [m³].
    """
    slopes = cell(kind).slopes(points).swapaxes(1, 2)
    jacobian = np.einsum("pan,cnk->cpak", slopes, corners, optimize=True)
    return cell(kind).shape(points), np.linalg.solve(jacobian, slopes), np.linalg.det(jacobian) * weights


@dataclass(frozen=True, eq=False)
class Pattern:
    """Where cells' blocks go in a matrix of free nodes.

    Attributes:
        number: of each node among the free ones in the order of the matrices, -1 where it is held.
        places: of each kind of cells the block (ncell, nnode, nnode) that a pair of nodes belongs to; the last, one
            beyond, is of pairs with a node that is held.
        count: of blocks.
        indptr, indices, source: of the matrix in compressed columns, and which number of the blocks each entry is.
    """

    number: Ints
    places: tuple[Ints, ...]
    count: int
    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    source: NDArray[np.int32]

    @property
    def free(self) -> int:
        """Number of free nodes."""
        return (len(self.indptr) - 1) // 3

    def blocks(self, cells: list[Array]) -> Array:
        """Sums (nblock,) of cells' numbers (ncell, nnode, nnode) for each pair of nodes."""
        total = np.zeros(self.count + 1)
        for places, values in zip(self.places, cells, strict=True):
            total += np.bincount(places.ravel(), values.ravel(), total.size)
        return total[:-1]

    def matrix(self, blocks: Array) -> csc_array:
        """The matrix of blocks of 3 x 3, (9, nblock)."""
        return csc_array((blocks.ravel()[self.source], self.indices, self.indptr), shape=(3 * self.free,) * 2)


def pattern(tables: list[Ints], free: NDArray[np.bool_]) -> Pattern:
    """The sparsity pattern of a blade's matrices.

    Args:
        tables: nodes of the cells of each kind, (ncell, nnode).
        free: which nodes are not clamped, (nnode,).
    """
    number = np.where(free, np.cumsum(free) - 1, -1)
    n = int(free.sum())
    keys = _distinct([_pairs(number[nodes], n) for nodes in tables])
    number = np.where(free, _dissected(keys // n, keys % n, n)[number], -1)
    blocks = [_pairs(number[nodes], n) for nodes in tables]
    keys = _distinct(blocks)
    places = tuple(np.where(pairs >= 0, np.searchsorted(keys, pairs), keys.size) for pairs in blocks)
    column, row = np.divmod(keys, n)
    begin = np.concatenate([[0], np.cumsum(np.bincount(column, minlength=n))])
    source = np.arange(9 * keys.size, dtype=np.int32).reshape(3, 3, -1).transpose(2, 1, 0)  # by block, column and row
    columns = bsr_array((source, row.astype(np.int32), begin.astype(np.int32)), shape=(3 * n, 3 * n)).tocsr()
    return Pattern(number, places, keys.size, columns.indptr, columns.indices, columns.data)


def _distinct(pairs: list[Ints]) -> Ints:
    """The keys of pairs of free nodes, ascending; numpy's `unique` takes ten times as long."""
    keys = np.sort(np.concatenate([each[each >= 0] for each in pairs]))
    return np.asarray(keys[np.append(True, keys[1:] != keys[:-1])])


def _pairs(numbers: Ints, n: int) -> Ints:
    """Keys (ncell, nnode, nnode) of pairs, column first; -1 where one is held."""
    free = numbers >= 0
    both = free[:, :, None] & free[:, None, :]
    return np.where(both, numbers[:, None, :] * n + numbers[:, :, None], -1)


def _dissected(row: Ints, column: Ints, n: int) -> Ints:
    """The place of each of n nodes in an order that leaves the factor of their graph thin."""
    try:
        import pymetis
    except ImportError:  # no wheel for this platform: reverse Cuthill and McKee's order, with twice the fill
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import reverse_cuthill_mckee

        graph = coo_array((np.ones(row.size), (row, column)), shape=(n, n)).tocsr()
        order = reverse_cuthill_mckee(graph, symmetric_mode=True)
        return np.asarray(np.argsort(order))
    apart = row != column
    begin = np.concatenate([[0], np.cumsum(np.bincount(row[apart], minlength=n))])
    neighbours = pymetis.CSRAdjacency(begin.astype(np.int32), column[apart].astype(np.int32))
    ordered = pymetis.nested_dissection(neighbours)
    return np.asarray(np.argsort(np.asarray(ordered[0], dtype=np.int64)))


@dataclass(frozen=True, eq=False)
class SolidState:
    """Deformation and stress of a blade at a displacement, lists over kinds of cells.

    Attributes:
        deformation: F, (ncell, npoint, 3, 3).
        stress: second Piola-Kirchhoff, in Pa, (ncell, npoint, 3, 3).
    """

    operators: SolidOperators
    deformation: list[Array]
    stress: list[Array]

    def force(self) -> Array:
        """The internal force (n,) in N."""
        total = np.zeros((self.operators.nodes, 3))
        for cells, f, s in zip(self.operators.cells, self.deformation, self.stress, strict=True):
            first = (f @ s) * cells.weights[..., None, None]
            own = np.einsum("cpik,cpkn->cni", first, cells.gradients, optimize=True)
            _add(total, cells.nodes, own)
        return self.operators.gathered(total)

    def ahead(self, step: Array) -> list[Array]:
        """Stress after a step (n,) [m], to first order."""
        moved = self.operators.spread(step)
        ahead = []
        for cells, f, s in zip(self.operators.cells, self.deformation, self.stress, strict=True):
            ahead.append(s + self.operators.stress(symmetric(f.swapaxes(-1, -2) @ _gradient(cells, moved))))
        return ahead

    def stiffness(self, stress: list[Array] | None = None) -> csc_array:
        """The tangent stiffness (n, n) in N/m, or that under another stress."""
        under = self.stress if stress is None else stress
        operators = self.operators
        blocks = np.zeros((9, operators.pattern.count + 1))
        for number, (cells, f, s) in enumerate(zip(operators.cells, self.deformation, under, strict=True)):
            for part in cells.parts(AT_ONCE):
                places = operators.pattern.places[number][part]
                own = np.empty((9, *places.shape))
                for few in cells.parts(IN_CACHE, part):
                    own[:, few.start - part.start : few.stop - part.start] = _cell_stiffness(
                        cells, few, f[few], s[few], operators.blade.material.lame
                    )
                for total, values in zip(blocks, own, strict=True):
                    total += np.bincount(places.ravel(), values.ravel(), total.size)
        return operators.pattern.matrix(blocks[:, :-1])


def _cell_stiffness(cells: Cells, part: slice, f: Array, s: Array, lame: tuple[float, float]) -> Array:
    """Stiffness (9, ncell, nnode, nnode) of cells with deformation F and stress S."""
    slopes, weights = cells.gradients[part], cells.weights[part]
    first, second = (value * weights[..., None, None] for value in lame)
    ncell, npoint, _, nnode = slopes.shape
    # dP_iJ / dF_jL = lambda F_iJ F_jL + mu (F_iL F_jJ + (F F')_ij delta_JL) + delta_ij S_JL,
    # rows (J), columns (i, j, L)
    across = np.einsum("cpiJ,cpjL->cpJijL", first * f, f)
    across += np.einsum("cpiL,cpjJ->cpJijL", second * f, f)
    left = second * (f @ f.swapaxes(-1, -2))
    under = s * weights[..., None, None]
    for k in range(3):
        across[:, :, k, :, :, k] += left
        across[:, :, :, k, k, :] += under
    moved = across.reshape(ncell, npoint, 27, 3) @ slopes
    moved = moved.reshape(ncell, npoint * 3, 9 * nnode)
    flat = slopes.reshape(ncell, npoint * 3, nnode)
    own = np.matmul(flat.swapaxes(1, 2), moved).reshape(ncell, nnode, 9, nnode)
    return np.asarray(own.transpose(2, 0, 1, 3))


def _gradient(cells: Cells, moved: Array) -> Array:
    """Displacement gradients (ncell, npoint, 3, 3), du_i / dX_k, of nodes moved (nnode, 3)."""
    return np.asarray(np.einsum("cpkn,cni->cpik", cells.gradients, moved[cells.nodes], optimize=True))


def _add(total: Array, nodes: Ints, own: Array) -> None:
    """Add cells' vectors (ncell, nnode, 3) to those of all nodes (n, 3)."""
    for axis in range(3):
        total[:, axis] += np.bincount(nodes.ravel(), own[..., axis].ravel(), len(total))


@dataclass(frozen=True, eq=False)
class SolidOperators:
    """A blade's matrices over its n free unknowns, three a node, SI units; Omega in rad/s.

    The same names as of `fem.Operators`: what that says of them holds here too.

    Attributes:
        blade: what is moved; effects: what counts.
        cells: at the points of their stiffness; pattern: where they go.
        softening, gyroscopic: None where the effect is left out.
        load: the centrifugal load (n,) per Omega².
        masses: of the nodes, those held included, (nnode,) in kg: what a unit acceleration of the root draws on.
    """

    blade: Blade
    effects: Effects
    cells: tuple[Cells, ...]
    pattern: Pattern
    stiffness: csc_array
    mass: csc_array
    softening: csc_array | None
    gyroscopic: csc_array | None
    load: Array
    masses: Array
    known: list[Factor] = field(default_factory=list, init=False, repr=False)
    solved: list[Modes] = field(default_factory=list, init=False, repr=False)

    theory = "solid"

    @property
    def nodes(self) -> int:
        """Number of nodes, those held included."""
        return len(self.blade.mesh.points)

    def spread(self, unknowns: NDArray[Any]) -> NDArray[Any]:
        """Displacements (nnode, 3, ...) of all nodes for unknowns (n, ...)."""
        moved = np.zeros((self.nodes, 3, *unknowns.shape[1:]), dtype=unknowns.dtype)
        free = self.pattern.number >= 0
        moved[free] = unknowns.reshape(-1, 3, *unknowns.shape[1:])[self.pattern.number[free]]
        return moved

    def force_at(self, at: Place, force: Array) -> Array:
        """The load (n,) of a force (3,) at a place."""
        nodal = np.zeros((self.nodes, 3))
        nodal[at.nodes] = np.outer(at.value, force)
        return self.gathered(nodal)

    def gathered(self, nodal: Array) -> Array:
        """The unknowns (n,) of nodes' vectors (nnode, 3)."""
        rows = np.empty((self.pattern.free, 3))
        free = self.pattern.number >= 0
        rows[self.pattern.number[free]] = nodal[free]
        return rows.ravel()

    def stress(self, strain: Array) -> Array:
        """Stress (..., 3, 3) in Pa of strains (..., 3, 3)."""
        first, second = self.blade.material.lame
        spherical = first * np.trace(strain, axis1=-2, axis2=-1)
        return np.asarray(2.0 * second * strain + spherical[..., None, None] * np.eye(3))

    def stressed(self, state: Array) -> SolidState:
        """Deformation and stress at a displacement (n,) [m]."""
        moved = self.spread(state)
        deformation, stress = [], []
        for cells in self.cells:
            f = _gradient(cells, moved) + np.eye(3)
            deformation.append(f)
            stress.append(self.stress(0.5 * (f.swapaxes(-1, -2) @ f - np.eye(3))))
        return SolidState(self, deformation, stress)

    def bending(self, state: Array, step: Array, shapes: Array) -> Array:
        """First-order change (k, k) of the modal stiffness of shapes (n, k) by a step (n,) from a state (n,) [m]."""
        rest, moved, waves = self.spread(state), self.spread(step), self.spread(shapes)
        count = shapes.shape[1]
        total = np.zeros((count, count))
        for cells in self.cells:
            for part in cells.parts(AT_ONCE):
                slopes, nodes = cells.gradients[part], cells.nodes[part]
                back, turned = (
                    np.einsum("cpjn,cni->cpji", slopes, each[nodes], optimize=True) for each in (rest, moved)
                )
                back = back + np.eye(3)  # F transposed
                under = self.stress(symmetric(back @ turned.swapaxes(-1, -2)))
                wave = np.einsum("cpjn,cnik->kcpij", slopes, waves[nodes], optimize=True)
                weighted = cells.weights[part][..., None, None]
                strain = weighted * self.stress(symmetric(back @ wave))
                more = symmetric(turned @ wave)
                both = strain.reshape(count, -1) @ more.reshape(count, -1).T
                total += both + both.T + (wave @ (weighted * under)).reshape(count, -1) @ wave.reshape(count, -1).T
        return total

    def factorise(self, matrix: csc_array) -> Factor:
        """Factor of a matrix of this pattern, in the order of its unknowns."""
        return linalg.factorise(matrix, ordered=True)

    def solver(self, matrix: csc_array) -> Solver:
        """Solver of a stiffness: its factor, or conjugate gradients preconditioned by the last factor known."""
        if self.known:
            return Nearby(matrix, self.known[-1], lambda own: self.keep(self.factorise(own)))
        return self.keep(self.factorise(matrix))

    def keep(self, factor: Factor) -> Factor:
        """Keep a factor, by which other stiffnesses are solved if it is positive, and return it."""
        if not factor.negative:
            self.known[:] = [factor]
        return factor

    @cached_property
    def prestress(self) -> Array | None:
        """Linear static displacement (n,) per Omega² [m s²/rad²]; None with large deflection, which has its own."""
        return None if self.effects.large_deflection else self.solver(self.stiffness).solve(self.load)

    def at(self, omega: float) -> csc_array:
        """K(Omega) (n, n) [N/m], with the linear prestress in the deformed shape, as CalculiX has it without NLGEOM.

        With large deflection it has neither; `tangent` has both.
        """
        total = self.stiffness
        if self.prestress is not None and omega != 0.0:
            state = omega**2 * self.prestress
            total = self.stressed(state).stiffness(self.stressed(np.zeros_like(state)).ahead(state))
        if self.softening is not None:
            total = linalg.less(total, omega**2, self.softening)
        return total

    def with_deflection(self, large: bool) -> SolidOperators:
        """The operators with large deflection or without, with the last factor known."""
        operators = replace(self, effects=replace(self.effects, large_deflection=large))
        operators.known[:] = self.known
        return operators


def assemble_solid(blade: Blade, effects: Effects | None = None, *, full: bool = False) -> SolidOperators:
    """Matrices of a solid blade.

    Args:
        blade: with its mesh and material.
        effects: by default stress stiffening at large deflection, and spin softening.
        full: integrate hexahedra of 20 nodes at 3 x 3 x 3 points, instead of 2 x 2 x 2, which do not lock where cells
            are thin.
    """
    effects = Effects(large_deflection=True) if effects is None else effects
    cells, heavy = [], []
    mesh = blade.mesh
    load, masses = np.zeros((len(mesh.points), 3)), np.zeros((len(mesh.points), 3))
    for kind, nodes in mesh.cells:
        values, slopes, volumes = mapped(kind, mesh.points[nodes], *rule(kind, full))
        cells.append(Cells(kind, nodes, slopes, volumes))
        own = np.einsum("pa,cp,pb->cab", values, blade.material.density * volumes, values, optimize=True)
        heavy.append(own)
        _add(load, nodes, own @ blade.arms[nodes])
        _add(masses, nodes, own @ np.ones((*nodes.shape, 3)))
    places = pattern([each.nodes for each in cells], ~blade.clamped)
    inertia = places.blocks(heavy)

    def through(matrix: Array) -> csc_array:
        return places.matrix(np.asarray(np.outer(matrix, inertia), dtype=np.float64))

    mass = through(np.eye(3)).copy()
    mass.eliminate_zeros()
    bare = SolidOperators(
        blade,
        effects,
        tuple(cells),
        places,
        stiffness=mass,
        mass=mass,
        softening=through(across(blade.axis)) if effects.spin_softening else None,
        gyroscopic=through(2.0 * turning(blade.axis)) if effects.coriolis else None,
        load=np.empty(0),
        masses=masses[:, 0],
    )
    stiffness = bare.stressed(np.zeros(3 * places.free)).stiffness()
    return replace(bare, stiffness=stiffness, load=bare.gathered(load))
