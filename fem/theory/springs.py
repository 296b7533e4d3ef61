"""A root that yields: springs along the root edge in place of the clamp.

Their energy per length is k (u² + v² + w²) / 2 + c (theta_x² + theta_y²) / 2, in the mid-surface's displacements and
the section's rotations. It is part of the elastic energy, the root's unknowns are free, and the balance of forces there
follows as a natural boundary condition. In a solid the springs are spread over the root's face such that a section that
stays plane feels the same forces and moments: k / h on displacements at each of its points, h the thickness, and what
then lacks to c, which may be negative, on the mean rotation (12 / h³) integral of z u.
"""

from typing import Any

import numpy as np

from fem.linalg import Array, Ints
from fem.meshes.planform import lengths, root_facets
from fem.plate import ElasticRoot
from fem.theory.discretisation import Space
from fem.theory.fields import Block, Fields
from fem.theory.sections import Quadratic, Terms

Sampled = tuple[Space, tuple[int, ...]]

GAUSS = 5
"""Points on each edge and through each brick: exact for products of quintics."""

TRAPEZOID = np.array([0.0, 1.0]), np.array([0.5, 0.5])
MIDPOINT = np.array([0.5]), np.array([1.0])


def edge(mesh: Any, rule: tuple[Array, Array]) -> tuple[Ints, Array, Array]:
    """The root edge of a mesh of triangles or quadrilaterals.

    Args:
        mesh: of the mid-surface.
        rule: points and weights on [0, 1].

    Returns:
        Its cells (nedge,), reference points in these (2, nedge, npoint), and weights (nedge, npoint) [m].
    """
    facets = root_facets(mesh)
    cells = mesh.f2t[0, facets]
    local = [(mesh.t[:, cells] == ends).argmax(axis=0) for ends in mesh.facets[:, facets]]
    start, end = (mesh.elem.refdom.p[:, k] for k in local)
    t, weights = rule
    return cells, start[:, :, None] + (end - start)[:, :, None] * t, lengths(mesh, facets)[:, None] * weights


def springs(
    root: ElasticRoot | None, mesh: Any, fields: tuple[Sampled, ...], total: int, conforming: bool = True
) -> Terms:
    """Fields and stiffness of an elastic root of a plate.

    An element for w that does not conform is sampled where neighbours agree: w at nodes, slopes in the middle of edges.

    Args:
        root: its springs; None: the clamp.
        mesh: of the mid-surface.
        fields: u, v, w and two rotations, as spaces and derivatives.
        total: number of unknowns.
        conforming: whether the element for w conforms.
    """
    if root is None:
        return ()
    ends, middle = (_gauss(), _gauss()) if conforming else (TRAPEZOID, MIDPOINT)
    return (
        _sampled(root.stiffness, mesh, fields[:2], total, _gauss()),
        _sampled(root.stiffness, mesh, fields[2:3], total, ends),
        _sampled(root.rotational, mesh, fields[3:], total, middle),
    )


def _sampled(
    stiffness: float, mesh: Any, fields: tuple[Sampled, ...], total: int, rule: tuple[Array, Array]
) -> tuple[Fields, Array]:
    cells, reference, dx = edge(mesh, rule)
    every, flat = np.repeat(cells, dx.shape[1]), reference.reshape(2, -1)
    blocks = []
    for space, derivative in fields:
        weights, _ = space.probe(every, flat, derivative)
        blocks.append(Block(weights.reshape(*dx.shape, 1, -1), space.dofs[cells]))
    return Fields(tuple(blocks), dx, total), stiffness * np.eye(len(blocks))


def face_springs(root: ElasticRoot | None, planform: Any, spaces: tuple[Space, ...], layers: int, total: int) -> Terms:
    """The same on the root's face of a solid: u, v and w at its points, and the two mean rotations.

    The stiffness of each point is part of its weight.

    Args:
        root: its springs; None: the clamp.
        planform: mesh of the mid-surface.
        spaces: of u, v and w.
        layers: of bricks through the thickness.
        total: number of unknowns.
    """
    if root is None:
        return ()
    zeta, weights = _gauss()
    cells, along, dx = edge(planform, (zeta, weights))
    nedge, npoint = dx.shape
    basis, ncell = spaces[0].basis, planform.t.shape[1]
    bricks = cells + ncell * np.arange(layers)[:, None]
    reference = np.empty((3, nedge, npoint, GAUSS))
    reference[:2], reference[2] = along[:, :, :, None], zeta
    flat = reference.reshape(3, nedge, -1)
    low, high = flat.copy(), flat.copy()
    low[2], high[2] = 0.0, 1.0
    z, bottom, top = (_heights(basis, points, bricks) for points in (flat, low, high))
    dz = (top - bottom) * weights
    h = dz.sum(axis=(0, 3))

    table = spaces[0].values(flat).reshape(nedge, npoint, GAUSS, -1)
    everywhere = np.broadcast_to(table, (layers, *table.shape)).reshape(layers * nedge, npoint * GAUSS, 1, -1)
    points = Fields(
        tuple(Block(everywhere, space.dofs[bricks.ravel()]) for space in spaces),
        (dz * (root.stiffness / h * dx)[:, :, None]).reshape(layers * nedge, -1),
        total,
    )
    mean = np.einsum("lepk,epkd->eldp", 12.0 * dz * z / h[:, :, None] ** 3, table).reshape(nedge, -1, npoint)
    turned = np.ascontiguousarray(mean.transpose(0, 2, 1)[:, :, None])
    rotations = Fields(
        tuple(Block(turned, space.dofs[bricks].transpose(1, 0, 2).reshape(nedge, -1)) for space in spaces[:2]),
        (root.rotational - root.stiffness * h**2 / 12.0) * dx,
        total,
    )
    return (points, np.eye(3)), (rotations, np.eye(2))


def energies(terms: Terms) -> tuple[Quadratic, ...]:
    """The energies of springs, whose forces stay linear at large displacements: the fields are the strains."""
    return tuple(
        Quadratic(fields, stiffness, np.eye(fields.size), np.zeros((fields.size,) * 3)) for fields, stiffness in terms
    )


def _gauss() -> tuple[Array, Array]:
    t, weights = np.polynomial.legendre.leggauss(GAUSS)
    return 0.5 * (1.0 + t), 0.5 * weights


def _heights(basis: Any, reference: Array, bricks: Ints) -> Array:
    """Heights (layer, nedge, npoint, GAUSS) in m at reference points (3, nedge, npoint GAUSS) of bricks."""
    heights = [basis.mapping.F(reference, tind=layer)[2] for layer in bricks]
    return np.stack(heights).reshape(*bricks.shape, -1, GAUSS)
