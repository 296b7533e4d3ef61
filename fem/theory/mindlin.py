"""The Mindlin plate with its membrane: u, v, w and the rotations, all quadratic, with assumed shear.

U = (u - z theta_x, v - z theta_y, w). Direct strains in plane stress; transverse shear g = grad w - theta
with the correction factor 5/6 (Reissner 1945; Mindlin, J. Appl. Mech. 18 (1951) 31). Quadrilaterals carry Q2
throughout, triangles P2 with a cubic bubble in the rotations. The shear strains are sampled at the
points of a `Tying` and interpolated from there, which keeps thin plates from locking.

`held` is the same plate clamped where a solid seems to be: a little outside its root. What is bent or stretched along x
contracts through the thickness. At its root a solid cannot, which no plate theory sees, and within about a thickness of
the root it is stiffer for it: it vibrates like a plate whose root is moved outwards by c h. c grows with the square of
the contraction that is held, as nu² / (1 - nu).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.linalg import Array
from fem.meshes.planform import root, root_facets
from fem.meshes.thickness import Nodal, Profile, of
from fem.plate import Plate
from fem.theory import springs as root_springs
from fem.theory.discretisation import Discretisation, Space, blocks, clamped, number
from fem.theory.fields import Block, Fields
from fem.theory.finite_rotation import Section, Shear
from fem.theory.sections import layers, stretched, weighed

GAUSS2 = np.array([0.5 - 0.5 / np.sqrt(3.0), 0.5 + 0.5 / np.sqrt(3.0)])
"""Two-point Gauss abscissae on [0, 1]."""


@dataclass(frozen=True, eq=False)
class Tying:
    """A reduction on the reference cell.

    Attributes:
        points: (2, nsample), where covariant shear is sampled.
        functionals: (n, nsample, 2), the weights of its two components in each functional.
        space: maps reference points (2, m) to the n spanning fields of the edge space there, (n, 2, m).
    """

    points: Array
    functionals: Array
    space: Callable[[Array], Array]

    def reduction(self, points: Array) -> Array:
        """Return R, (m, 2, nsample, 2): reduced covariant shear at points (2, m) from the samples."""
        unisolvence = np.einsum("fsb,kbs->fk", self.functionals, self.space(self.points))
        dual = np.linalg.solve(unisolvence.T, self.space(points).reshape(len(unisolvence), -1))
        nodal = dual.reshape(len(unisolvence), 2, -1)
        return np.asarray(np.einsum("fam,fsb->masb", nodal, self.functionals))


def quadrilateral() -> Tying:
    """Q12 x Q21 on the unit square: two Gauss points on each of three lines a direction."""
    lines = np.array([0.0, 0.5, 1.0])
    along, across = (a.ravel() for a in np.meshgrid(GAUSS2, lines, indexing="ij"))
    points = np.hstack([np.vstack([along, across]), np.vstack([across, along])])
    functionals = np.zeros((12, 12, 2))
    functionals[np.arange(6), np.arange(6), 0] = 1.0
    functionals[np.arange(6, 12), np.arange(6, 12), 1] = 1.0

    def space(at: Array) -> Array:
        x, y = at
        zero = np.zeros_like(x)
        first = [x**i * y**j for i in range(2) for j in range(3)]
        second = [y**i * x**j for i in range(2) for j in range(3)]
        return np.array([[p, zero] for p in first] + [[zero, p] for p in second])

    return Tying(points, functionals, space)


def triangle() -> Tying:
    """Second-order Nédélec space of the first kind: two Gauss points an edge and the cell's mean."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTri

    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    edges = [(0, 1), (1, 2), (0, 2)]
    inner, weights = get_quadrature(RefTri, 5)
    on_edges = [corners[a] + s * (corners[b] - corners[a]) for a, b in edges for s in GAUSS2]
    points = np.hstack([np.array(on_edges).T, inner])
    functionals = np.zeros((8, points.shape[1], 2))
    for k, (a, b) in enumerate(edges):
        functionals[2 * k, 2 * k] = functionals[2 * k + 1, 2 * k + 1] = corners[b] - corners[a]
    functionals[6, 6:, 0] = functionals[7, 6:, 1] = weights

    def space(at: Array) -> Array:
        x, y = at
        zero, one = np.zeros_like(x), np.ones_like(x)
        linear = [[p, zero] for p in (one, x, y)] + [[zero, p] for p in (one, x, y)]
        return np.array([*linear, [-x * y, x * x], [-y * y, x * y]])

    return Tying(points, functionals, space)


SHEAR_CORRECTION = 5.0 / 6.0
"""Reissner's factor for a homogeneous section."""

SHEAR_FLOOR = 1e-5
"""Least shear compliance, as (a/h)² of the cell size a that is added to 1.

The shear stiffness of a thin plate exceeds the bending stiffness by (a/h)² on a cell and drowns it in
rounding (2e-4 of a frequency at h/L = 1e-5). Capping it makes a plate no softer in shear than one of thickness
0.003 a, an error that falls with the mesh and stays orders below that of the mesh.
"""


def discretise(plate: Plate, rotary_inertia: bool = True) -> Discretisation:
    """Make the Mindlin model of a plate."""
    from skfem import Basis, ElementQuad2, ElementTriP2, ElementTriP2B
    from skfem.quadrature import get_quadrature

    mesh = plate.mesh
    quads = mesh.t.shape[0] == 4
    element = ElementQuad2() if quads else ElementTriP2()
    quadrature = get_quadrature(mesh.elem.refdom, 5)
    basis = Basis(mesh, element, quadrature=quadrature)
    rotation = basis if quads else Basis(mesh, ElementTriP2B(), quadrature=quadrature)
    bases = [basis, basis, basis, rotation, rotation]
    tables, total = number([(b, clamped(b, plate)) for b in bases])
    spaces = u, v, w, tx, ty = tuple(Space(b, t) for b, t in zip(bases, tables, strict=True))

    dx = np.asarray(basis.dx)
    value, gradient = ((),), ((0,), (1,))
    places, reduction = _reduction(basis)
    planar = np.asarray(basis.global_coordinates())
    thickness = of(plate.thickness, planar)
    shear = Fields((_shear(w, tx, ty, places, reduction),), dx, total)
    floor = 1.0 + SHEAR_FLOOR * np.abs(basis.mapping.detDF(basis.X)) / thickness**2
    modulus = SHEAR_CORRECTION * plate.material.shear_modulus * thickness / floor
    elastic, whole = layers(thickness), weighed(dx, thickness)
    moved, strained = blocks(spaces, value), blocks(spaces, gradient)
    turned = Fields((*strained[:3], *blocks((tx, ty), (*value, *gradient))), dx, total)
    for fields in (moved, strained):
        fields[3:] = [stretched(block, thickness) for block in fields[3:]]
    springs = root_springs.springs(plate.elastic_root, mesh, tuple((space, ()) for space in spaces), total)
    samples = _samples(spaces, places, total)
    return Discretisation(
        theory="mindlin",
        points=np.stack([planar[0], planar[1], np.zeros_like(planar[0])]),
        displacement=Fields(tuple(moved), whole, total),
        gradient=Fields(tuple(strained), whole, total),
        inertia=elastic if rotary_inertia else layers(thickness, flat=True),
        elastic=elastic,
        stiffness=plate.material.plane_stress,
        extra=((shear, np.eye(2)[:, :, None, None] * modulus), *springs),
        energies=(
            Section(turned, plate.material, thickness),
            Shear(samples, basis.mapping.DF(places), reduction.reshape(len(dx), 2 * dx.shape[1], -1), modulus, dx),
            *root_springs.energies(springs),
        ),
        membrane=np.arange(1 + max(tables[0].max(), tables[1].max())),
        spaces=(u, v, w),
        mesh=mesh,
    )


def _reduction(basis: Any) -> tuple[Array, Array]:
    """Places of the shear samples (2, nsample), and what makes of their covariant shears those at the points.

    The latter is (ncell, npoint, 2, nsample, 2).
    """
    rule = quadrilateral() if basis.mesh.t.shape[0] == 4 else triangle()
    covariant = rule.reduction(basis.X)
    return rule.points, np.einsum("abcm,masn->cmbsn", basis.mapping.invDF(basis.X), covariant, optimize=True)


def _shear(w: Space, tx: Space, ty: Space, places: Array, reduction: Array) -> Block:
    """Tabulate the assumed shear strain as one block over the unknowns of w and theta."""
    slope, turn = _slopes(w, places), tx.values(places)
    jacobian = w.basis.mapping.DF(places)
    from_w = np.einsum("cmbsn,snj->cmbj", reduction, slope, optimize=True)
    from_turn = np.einsum("cmbsn,kncs,sj->kcmbj", reduction, jacobian, turn, optimize=True)
    table = np.concatenate([from_w, -from_turn[0], -from_turn[1]], axis=-1)
    dofs: NDArray[Any] = np.concatenate([w.dofs, tx.dofs, ty.dofs], axis=1)
    return Block(np.ascontiguousarray(table), dofs)


def _samples(spaces: tuple[Space, ...], places: Array, total: int) -> Fields:
    """The fields u, v, w by the reference coordinates and the turns where shear is sampled, for the director."""
    ncell = len(spaces[0].dofs)
    tables = [*(_slopes(s, places) for s in spaces[:3]), *(s.values(places)[:, None] for s in spaces[3:])]
    blocks = (Block(np.broadcast_to(t, (ncell, *t.shape)), s.dofs) for t, s in zip(tables, spaces, strict=True))
    return Fields(tuple(blocks), np.ones((ncell, places.shape[1])), total)


def _slopes(space: Space, places: Array) -> Array:
    """Derivatives (nplace, 2, ndof) of a space's functions by the reference coordinates."""
    basis = space.basis
    slopes = np.stack([basis.elem.lbasis(places, j)[1] for j in range(basis.Nbfun)], axis=-1)
    return np.ascontiguousarray(slopes.transpose(1, 0, 2))


HELD = 0.11
"""c (1 - nu) / nu². CalculiX on rectangles, tapered and swept plates and arms, nu from 0.3 to 0.49: 0.09 to 0.12 in
bending; 0.07 to 0.18 in stretching, the less the stouter the root."""

STRETCHED = 1.3
"""How much more of it than in bending, at most, is left in stretching."""

REACH = 2.0
"""Thicknesses from the root within which the plate is shortened."""


def held(plate: Plate, rotary_inertia: bool = True) -> Discretisation:
    """The Mindlin model of a plate that is clamped a little outside its root.

    Loads stay where they are.
    """
    mesh = shortened(plate)
    shorter = replace(plate, mesh=mesh, thickness=_carried(plate, mesh), tip_mass=0.0, tip_at=None)
    model = discretise(shorter, rotary_inertia)
    planar = np.asarray(plate.mesh.mapping().F(model.spaces[0].basis.X))
    points = np.stack([planar[0], planar[1], np.zeros_like(planar[0])])
    return replace(model, theory="mindlin/held", points=points, mesh=plate.mesh)


def shift(plate: Plate) -> float:
    """How far outside its root [m] a solid seems to be clamped; 0 where springs let it contract."""
    return 0.0 if plate.elastic_root is not None else seeming(plate)


def seeming(plate: Plate) -> float:
    """The same (m) of springs too, as far as they hold the root from contracting: by k / (k + E)."""
    nu, springs = plate.material.poissons_ratio, plate.elastic_root
    share = 1.0 if springs is None else springs.stiffness / (springs.stiffness + plate.material.youngs_modulus)
    return HELD * nu**2 / (1.0 - nu) * share * at_root(plate)


def at_root(plate: Plate) -> float:
    """Mean thickness (m) at the root."""
    if isinstance(plate.thickness, float | int):
        return float(plate.thickness)
    mesh = plate.mesh
    middles = mesh.p[:, mesh.facets[:, root_facets(mesh)]].mean(axis=1)
    return float(np.mean([plate.thickness_at((x, y)) for x, y in middles.T]))


def shortened(plate: Plate) -> Any:
    """The mesh with its root moved outwards, and less what lies behind it, to nothing `REACH` thicknesses away."""
    x, y = plate.mesh.p
    left = np.clip(1.0 - (x - root(plate.mesh)) / (REACH * at_root(plate)), 0.0, None)
    return replace(plate.mesh, doflocs=np.stack([x + shift(plate) * left**2, y]))


def _carried(plate: Plate, mesh: Any) -> float | Profile:
    """The thickness on the shortened mesh: values at points go with them."""
    known = plate.thickness
    if not isinstance(known, Nodal):
        return known
    values = np.empty(mesh.p.shape[1])
    values[plate.mesh.t.T] = known.at(plate.mesh.p[:, plate.mesh.t].transpose(0, 2, 1))
    return Nodal(mesh, values)
