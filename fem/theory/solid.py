"""The plate as a solid: triquadratic bricks, the reference for the plate theories.

The planform is extruded into layers of 27-node bricks, an even number so that the mid-surface is a face
between bricks; more than two get thinner towards the surfaces. Triangles are first split into three quadrilaterals
each.

Unknowns off the mid-surface are displacements relative to the mid-surface below or above them. The stiffness through
the thickness exceeds that of bending by (L/h)^4 and would drown it in rounding; of displacements that a section has
in common it sees nothing, and shear is left, by (L/h)^2.

Solids are the reference on rectangles. On other cells, and so on triangles, thin ones lock: the transverse shear of
bricks does not vanish when they bend, and frequencies come out too high. On a square of 8 x 8 cells, inner nodes
moved by up to a quarter of a cell, the first three by at most 0.07 % at h/L = 0.1, 0.6 % at 0.01 and 7 % at 0.001; on
72 split triangles by 3 % and 60 % at 0.001 and 0.0001. Mindlin's theory does not lock there.
"""

from typing import Any

import numpy as np

from fem.linalg import Array, Ints
from fem.meshes.mesh_sequence import crowded
from fem.meshes.thickness import Profile, of
from fem.plate import Plate
from fem.theory.discretisation import Discretisation, Space, blocks, number
from fem.theory.fields import CLAMPED, Fields
from fem.theory.sections import Layer, of_layers
from fem.theory.springs import energies, face_springs

CORNERS = ((1, 1, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0))
"""Reference coordinates of a brick's vertices in the order of `skfem.ElementHex1`."""


def discretise(plate: Plate, layers: int = 2) -> Discretisation:
    """Make the solid model of a plate with an even number of layers of bricks."""
    from skfem import Basis, ElementHex2
    from skfem.quadrature import get_quadrature

    planform = quadrilaterals(plate.mesh)
    mesh = extrude(planform, plate.thickness, layers)
    element = ElementHex2()
    basis = Basis(mesh, element, quadrature=get_quadrature(mesh.elem.refdom, 5))
    x = mesh.p[0]
    root = mesh.facets_satisfying(lambda p: p[0] < x.min() + 1e-6 * np.ptp(x), boundaries_only=True)
    clamped = np.empty(0, dtype=np.int64) if plate.elastic_root is not None else basis.get_dofs(root).flatten()
    tables, total = number([(basis, clamped)] * 3)
    columns, combined = carried(element)
    spaces = tuple(
        Space(basis, relative(t, columns, planform.t.shape[1]), height=1.0, combined=combined) for t in tables
    )
    springs = face_springs(plate.elastic_root, planform, spaces, layers, total)
    dx = np.asarray(basis.dx)
    nine = np.eye(9).reshape(3, 3, 9)
    body = (Layer(0.0, 1.0, np.eye(3), nine, nine),)
    gradient = Fields(tuple(blocks(spaces, ((0,), (1,), (2,)))), dx, total)
    return Discretisation(
        theory=f"solid/{layers}",
        points=np.asarray(basis.global_coordinates()),
        displacement=Fields(tuple(blocks(spaces, ((),))), dx, total),
        gradient=gradient,
        inertia=body,
        elastic=body,
        stiffness=plate.material.elasticity,
        extra=springs,
        energies=(of_layers(gradient, body, plate.material.elasticity), *energies(springs)),
        membrane=np.arange(total),
        spaces=(spaces[0], spaces[1], spaces[2]),
        mesh=planform,
    )


def carried(element: Any) -> tuple[Ints, Array]:
    """Nodes on top of a brick (9,), and what an unknown at each of the 27 nodes, and then at a column's middle, moves.

    Columns are those of nodes above one another; an unknown in the middle of the plate carries all of its column
    along. Returns the nodes and the combinations (27, 27 + 9).
    """
    x, y, z = element.doflocs.T
    top = np.flatnonzero(z == 1.0)
    same = (x[:, None] == x[top]) & (y[:, None] == y[top])
    return top, np.hstack([np.eye(x.size), same])


def relative(table: Ints, top: Ints, cells: int) -> Ints:
    """Unknowns (nbrick, 27 + 9) of bricks whose own are (nbrick, 27), by what `carried` says they move.

    The first bricks, one a cell, lie just below the mid-surface.
    """
    middle = table[:cells, top]
    own = np.where(np.isin(table, middle), CLAMPED, table)
    return np.hstack([own, np.tile(middle, (len(table) // cells, 1))])


def quadrilaterals(mesh: Any) -> Any:
    """Return a mesh of quadrilaterals: itself, or each triangle in three, old vertices first."""
    from skfem import MeshQuad

    if mesh.t.shape[0] == 4:
        return mesh
    nvertices, nfacets = mesh.p.shape[1], mesh.facets.shape[1]
    middles = mesh.p[:, mesh.facets].mean(axis=1)
    centres = mesh.p[:, mesh.t].mean(axis=1)
    a, b, c = mesh.t
    ab, bc, ac = nvertices + mesh.t2f
    o = nvertices + nfacets + np.arange(mesh.t.shape[1])
    cells = np.hstack([[a, ab, o, ac], [b, bc, o, ab], [c, ac, o, bc]])
    return MeshQuad(np.hstack([mesh.p, middles, centres]), cells)


def extrude(mesh: Any, thickness: float | Profile, layers: int) -> Any:
    """Bricks on quadrilaterals, |z| <= thickness/2.

    Where the thickness varies they have 27 nodes each, which follow it.

    Args:
        mesh: of the mid-surface.
        thickness: [m], or one that varies.
        layers: an even number; the first bricks are those just below the mid-surface.
    """
    from skfem import MeshHex2

    if isinstance(thickness, float | int):
        return _bricks(mesh, thickness, layers)
    bricks = MeshHex2.from_mesh(_bricks(mesh, 1.0, layers))
    numbers, points = bricks.dofs.element_dofs, bricks.doflocs.copy()
    height = np.empty(points.shape[1])
    height[numbers] = np.asarray(of(thickness, points[:2, numbers.T])).T
    points[2] *= height
    return MeshHex2(points, bricks.t)


def _bricks(mesh: Any, thickness: float, layers: int) -> Any:
    from skfem import MeshHex

    n = mesh.p.shape[1]
    levels = 0.5 * thickness * crowded(layers)
    points = np.hstack([np.vstack([mesh.p, np.full(n, z)]) for z in levels])
    corner = {(0, 0): 0, (1, 0): 1, (1, 1): 2, (0, 1): 3}
    middle = layers // 2 - 1
    order = [middle, *(k for k in range(layers) if k != middle)]
    bricks = [np.stack([mesh.t[corner[i, j]] + n * (layer + k) for i, j, k in CORNERS]) for layer in order]
    return MeshHex(points, np.hstack(bricks))
