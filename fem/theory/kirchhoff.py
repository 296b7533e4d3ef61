"""The thin (Kirchhoff) plate with its membrane: U = (u - z w_x, v - z w_y, w), no transverse shear.

w needs continuous slopes. Rectangles carry the Bogner-Fox-Schmit element (1965), triangles Argyris's of degree
five (Argyris, Fried and Scharpf, Aeronaut. J. 72 (1968) 701); Morley's (Aeronaut. Quart. 19 (1968) 149) is the
cheapest and has discontinuous w, so its frequencies come from below. u and v are quadratic.

Their functions are combinations of monomials in each cell, all tabulated `together`: scikit-fem's `ElementGlobal`
evaluates every monomial anew for every function, which is most of an assembly's time, and compares the normals of all
edges on the boundary with one another, which on cells that share no edges are all edges.
"""

from functools import cache
from itertools import product
from typing import Any

import numpy as np

from fem.linalg import Ints
from fem.meshes.planform import root_facets
from fem.meshes.thickness import of
from fem.plate import Plate
from fem.theory.discretisation import Discretisation, Space, blocks, clamped, number
from fem.theory.fields import Fields
from fem.theory.sections import layers, of_layers, stretched, weighed
from fem.theory.springs import energies, springs

PIECE = 256
"""Cells whose combinations are found at once."""

ORDER = {"bfs": 7, "argyris": 8, "morley": 5}
"""Degree to which integrals are exact, by the elements for w."""


def discretise(plate: Plate, rotary_inertia: bool = True, element: str = "") -> Discretisation:
    """The Kirchhoff model of a plate.

    Args:
        plate: with its mesh.
        rotary_inertia: whether turning sections have inertia.
        element: by name; "": the best one for the mesh.

    Raises:
        ValueError: an element that the mesh does not allow.
    """
    from skfem import Basis, Dofs, ElementQuad2, ElementQuadBFS, ElementTriArgyris, ElementTriMorley, ElementTriP2
    from skfem.quadrature import get_quadrature

    element = element or ("bfs" if is_rectangles(plate.mesh) else "argyris")
    if element == "bfs" and not is_rectangles(plate.mesh):
        raise ValueError("the bfs element needs a mesh of rectangles along x and y; use argyris or morley")
    mesh = plate.mesh if element == "bfs" or plate.mesh.t.shape[0] == 3 else plate.mesh.to_meshtri()
    quadrature = get_quadrature(mesh.elem.refdom, ORDER[element])
    membrane = Basis(mesh, ElementQuad2() if element == "bfs" else ElementTriP2(), quadrature=quadrature)
    size = float(np.sqrt(membrane.dx.sum(axis=1).mean()))
    kind = {"bfs": ElementQuadBFS, "argyris": ElementTriArgyris, "morley": ElementTriMorley}[element]
    bending, root = Dofs(mesh, kind()), clamped(membrane, plate)
    fixed = bending.get_facet_dofs(root_facets(mesh), skip_dofnames=["u_xx"]).flatten()
    if plate.elastic_root is not None:
        fixed = fixed[:0]
    tables, total = number([(membrane, root), (membrane, root), (bending, fixed)])
    u, v = (Space(membrane, t) for t in tables[:2])
    w = _bending(mesh, kind, quadrature, size, tables[2])

    planar = np.asarray(membrane.global_coordinates())
    thickness = of(plate.thickness, planar)
    dx, elastic = weighed(np.asarray(membrane.dx), thickness), layers(thickness)
    slopes = ((0,), (1,))
    fields = ((u, ()), (v, ()), (w, ()), (w, (0,)), (w, (1,)))
    held_by = springs(plate.elastic_root, mesh, fields, total, conforming=element != "morley")
    bent, turned = (blocks((w,), d)[0] for d in ((*slopes, (0, 0), (0, 1), (1, 0), (1, 1)), ((), *slopes)))
    gradient = Fields((*blocks((u, v), slopes), stretched(bent, thickness, start=2)), dx, total)
    moved = (*blocks((u, v), ((),)), stretched(turned, thickness, start=1))
    return Discretisation(
        theory=f"kirchhoff/{element}",
        points=np.stack([planar[0], planar[1], np.zeros_like(planar[0])]),
        displacement=Fields(moved, dx, total),
        gradient=gradient,
        inertia=elastic if rotary_inertia else layers(thickness, flat=True),
        elastic=elastic,
        stiffness=plate.material.plane_stress,
        extra=held_by,
        energies=(of_layers(gradient, elastic, plate.material.plane_stress), *energies(held_by)),
        membrane=np.arange(1 + max(tables[0].max(), tables[1].max())),
        spaces=(u, v, w),
        mesh=mesh,
    )


def is_rectangles(mesh: Any) -> bool:
    """Whether every cell is a rectangle with sides along x and y."""
    if mesh.t.shape[0] != 4:
        return False
    sides = np.diff(mesh.p[:, mesh.t[[0, 1, 2, 3, 0]]], axis=1)
    return bool((np.abs(sides).min(axis=0) <= 1e-9 * np.abs(sides).max()).all())


def _bending(mesh: Any, kind: Any, quadrature: Any, size: float, dofs: Ints) -> Space:
    """The space of w, of a scikit-fem class derived from `ElementGlobal`, over unknowns (ncell, ndof).

    The shape functions are computed cell by cell in coordinates centred on the cell and measured in its sides, or in
    cell sizes, where the monomials they are made of are far better conditioned than in global ones. Rectangles are all
    the same square there. Slopes are unknowns per cell size.
    """
    from skfem import Basis

    corners = mesh.p[:, mesh.t]
    count, ncell = mesh.t.shape
    units = np.ptp(corners, axis=1) if count == 4 else np.full((2, ncell), size)
    local = (corners - corners.mean(axis=1, keepdims=True)) / units[:, None]
    if count == 4:
        local = np.copysign(0.5, local)  # the square to the last bit, as it is kept from one mesh for the next
    numbers = np.arange(count * ncell).reshape(ncell, count).T
    apart = type(mesh)(local.transpose(0, 2, 1).reshape(2, -1), np.ascontiguousarray(numbers))
    basis = Basis(apart, together(kind), quadrature=quadrature)
    counted = np.ones((ncell, basis.Nbfun))
    if count == 4:
        x, y = units / size
        counted = np.tile(np.stack([np.ones(ncell), x, y, x * y], axis=1), count)
    else:
        # Apart, every edge is on the boundary and its normal points outwards, out of both neighbours.
        second = mesh.f2t[1, mesh.t2f] == np.arange(ncell)
        counted[:, -3:] = np.where(second, -1.0, 1.0).T
    return Space(basis, dofs, units=units, counted=counted)


@cache
def _monomials(kind: Any) -> Any:
    """Of a scikit-fem class derived from `ElementGlobal`, with their derivatives."""
    element = kind()
    element._pbasis_init(element.maxdeg, element.dim, element.derivatives, element.tensorial_basis)
    return element._pbasis


COMBINATIONS: dict[tuple[Any, bytes], Any] = {}
"""Combinations of monomials in meshes whose cells are all alike, by element and corners: rectangles are."""


def together(kind: Any) -> Any:
    """Make an element of a scikit-fem class derived from `ElementGlobal`, its functions computed together.

    It is for meshes whose cells share no points. What cells of the same shape have in common is computed once.
    """
    from skfem.element import DiscreteField

    class Together(kind):  # type: ignore[misc]
        _places: tuple[Any, ...] = ()
        _functions: tuple[Any, ...] = ()
        _alike = _first = np.zeros(0, dtype=np.int64)

        def gbasis(self, mapping: Any, X: Any, i: int, tind: Any = None) -> tuple[Any]:
            places = (mapping, X, tind)
            if len(self._places) != 3 or any(a is not b for a, b in zip(places, self._places, strict=True)):
                self._functions = self._tabulate(mapping, X, tind)
                self._places = places
            return (self._functions[i],)

        def _combine(self, mesh: Any) -> None:
            """Find the combinations V (shapes, n, n) of monomials in cells of every shape."""
            corners = mesh.p[:, mesh.t]
            local = (corners - corners.mean(axis=1, keepdims=True)).reshape(-1, mesh.t.shape[1]).round(12)
            _, self._first, self._alike = np.unique(local, axis=1, return_index=True, return_inverse=True)
            self._pbasis = _monomials(kind)
            shape = kind, local[:, self._first].tobytes()
            if shape in COMBINATIONS:
                self.V = COMBINATIONS[shape]
                return
            pieces = np.split(self._first, range(PIECE, self._first.size, PIECE))
            self.V = np.linalg.inv(np.concatenate([self._eval_dofs(mesh.restrict(piece)) for piece in pieces]))
            if self._first.size == 1:
                COMBINATIONS[shape] = self.V

        def _tabulate(self, mapping: Any, X: Any, tind: Any) -> tuple[Any, ...]:
            if not self._first.size:
                self._combine(mapping.mesh)
            shapes = self._alike if tind is None else self._alike[tind]
            if same_places := X.ndim == 2:
                present, spread = np.unique(shapes, return_inverse=True)
                combinations, at = self.V[present], mapping.F(X, tind=self._first[present])
            else:
                combinations, at = self.V[shapes], mapping.F(X, tind=tind)
            combinations = np.swapaxes(combinations, 1, 2)
            tables = []
            for order in range(self.derivatives + 1):
                parts = {}
                for along in product(range(self.dim), repeat=order):
                    monomials = np.stack([monomial(*at) for monomial in self._pbasis[along]], axis=1)
                    parts[along] = combinations @ monomials
                table = np.stack(list(parts.values())).reshape((self.dim,) * order + parts[along].shape)
                tables.append(np.moveaxis(table[..., spread, :, :] if same_places else table, -2, 0))
            return tuple(DiscreteField(value=u, grad=du, hess=ddu) for u, du, ddu in zip(*tables, strict=True))

    return Together()
