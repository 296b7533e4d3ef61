"""What a given mesh leaves of a solid blade's frequencies, by recovered stresses.

The stress of a mode is taken at the points where it is most exact, carried to the nodes by a linear function in each
cell and averaged there; how far the stress in the cells lies from this smooth one is the error in energy (Zienkiewicz
and Zhu, Int. J. Numer. Methods Engrg 24 (1987) 337), and a frequency's relative error is half of its share of the
mode's energy. In tetrahedra and wedges of second order the true error is about twice that. In thin hexahedra it is too
much where spurious shear is seen, away from the points of integration, and too little at these: the estimate is the
geometric mean of both. In blades of one cell through the thickness these points have no neighbours to differ from, and
the first alone counts; of hexahedra of 20 nodes its root, for what spurious shear it sees grows as the thickness falls.
Factors are fitted to trials.

Where a blunt section has one cell or two across, the stress of torsion and shear is smooth but wrong: it does not
vanish on the free faces. The energy of what these carry, through their cells, tells that error; the larger one counts.

Errors are relative to the true frequency. A mode that comes down as the mesh is refined may pass others, those above
the ones that are known too, for which the last stands: the error of the k-th frequency reaches down to the k-th of the
lower ends. Where modes come so near to each other on the way, they mix, and each may have the error of the other, but
does not come below where the other may come: a high mode that is hardly known says nothing of the first.
"""

from itertools import product

import numpy as np

from fem.linalg import Array, symmetric
from fem.meshes.cells import cell
from fem.solid.assembly import AT_ONCE, Cells, SolidOperators, mapped, rule

SIMPLICES = frozenset({"tetra10", "wedge15"})
"""Cells of which the stress at the points of integration tells the error."""

SAFETY = {"simplices": 4.2, "one layer": 0.16, "layers": 2.8, "others": 3.3}
"""Factors on the estimate, fitted at rest on 8 modes of six blades (against frequencies that CalculiX' meshes lead
to) and of over 100 random ones (against 24 x 12 x 2 hexahedra). No true error on 6 x 3 x 1 cells or finer was more than
the estimate, nor of 80 others twisted by up to 95 degrees; of 640 of these on 4 x 2 x 1 three were, by up to 1.06. The
median of these on 8 x 4 x 1 is a quarter of it in the first mode, a seventh in eight.
"""

COARSE = 0.6
"""Factor on the share itself, in one layer of hexahedra: on meshes so coarse that they show 4 %, errors go with it."""

MIXED = 2.5
"""Estimated errors within which modes come near each other."""


def mesh_errors(operators: SolidOperators, shapes: Array, values: Array, state: Array | None = None) -> Array:
    """Estimated relative errors of the lowest frequencies by the mesh.

    Args:
        operators: of the blade.
        shapes: mass-normalised, shape (n, k).
        values: squared circular frequencies (k,) [rad²/s²], ascending.
        state: static displacement (n,) [m] about which the blade vibrates; None: undeformed.

    Returns:
        Shape (k,) [-].
    """
    moved = operators.spread(shapes)
    rest = operators.spread(np.zeros(shapes.shape[0]) if state is None else state)
    total, weight = np.zeros((operators.nodes, *moved.shape[2:], 3, 3)), np.zeros(operators.nodes)
    for cells in operators.cells:
        _average(operators, cells, moved, rest, total, weight)
    smooth = total / weight[:, None, None, None]
    missed = np.zeros((2, shapes.shape[1]))
    for cells in operators.cells:
        for number, (points, weights) in enumerate((rule(cells.kind), cell(cells.kind).rule)):
            for part in cells.parts(AT_ONCE):
                nodes = cells.nodes[part]
                shape, slopes, volumes = mapped(cells.kind, operators.blade.mesh.points[nodes], points, weights)
                rough = _stress(operators, slopes, moved[nodes], rest[nodes])
                off = np.einsum("pn,cnkij->cpkij", shape, smooth[nodes], optimize=True) - rough
                missed[number] += np.einsum("cp,cpkij,cpkij->k", volumes, off, _strain(operators, off), optimize=True)
    errors = np.maximum(_fitted(operators, 0.5 * missed / values), _carried(operators, smooth) / values)
    rates = np.sqrt(values)
    low = rates / (1.0 + MIXED * errors)
    near = low <= rates[:, None]
    reach = np.minimum(errors, rates[:, None] / low - 1.0)
    lowered = np.sort(np.append(rates / (1.0 + errors), rates[-1] / (1.0 + errors.max())))[: rates.size]
    return np.asarray(np.maximum(np.where(near & near.T, reach, 0.0).max(axis=1), rates / lowered - 1.0))


def _fitted(operators: SolidOperators, share: Array) -> Array:
    """Errors (k,) by half of the shares in energy (2, k) at points of integration and at others."""
    kinds = {cells.kind for cells in operators.cells}
    if kinds <= SIMPLICES:
        return np.asarray(SAFETY["simplices"] * share[0])
    alike = kinds == {"hexahedron20"}
    if _one_layer(operators):
        worst = np.maximum(SAFETY["one layer"] * np.sqrt(share[1]), COARSE * share[1])
        return np.asarray(worst if alike else SAFETY["others"] * share[1])
    return np.asarray(SAFETY["layers" if alike else "others"] * np.sqrt(share.prod(axis=0)))


CARRIED = {"tetra10": 0.28, "wedge15": 0.14}
"""Factor on the energy of what free faces carry, over that of the mode, fitted at rest on 18 bars and blades with
thicknesses of 2 to 100 % of the chord, of 1 x 1 to 6 x 2 cells in the section; 0.12 for other cells."""


def _carried(operators: SolidOperators, smooth: Array) -> Array:
    """Errors (k,), times squared rates, by the stress (nnode, k, 3, 3) that the free faces of cells carry."""
    blade, total = operators.blade, np.zeros(smooth.shape[1])
    material, mesh = blade.material, blade.mesh
    softness = np.array([2.0 * (1.0 + material.poissons_ratio), 1.0]) / material.youngs_modulus
    digits = operators.nodes ** np.arange(3)
    outer = np.concatenate([np.sort(mesh.corners(faces))[:, :3] @ digits for faces in mesh.boundary()])
    for cells in operators.cells:
        volumes, factor = cells.weights.sum(axis=1), CARRIED.get(cells.kind, 0.12)
        for ring, part in product(cell(cells.kind).faces, cells.parts(AT_ONCE)):
            faces = cells.nodes[part][:, ring]
            free = np.isin(np.sort(mesh.corners(faces))[:, :3] @ digits, outer) & ~blade.clamped[faces].all(axis=1)
            at = mesh.points[mesh.corners(faces[free])]
            normals = 0.5 * np.cross(at[:, 2] - at[:, 0], at[:, -1] - at[:, 1])
            areas = np.linalg.norm(normals, axis=1)
            pull = np.einsum("fnkij,fj->fnki", smooth[faces[free]], normals / areas[:, None], optimize=True)
            across = np.einsum("fnki,fi->fnk", pull, normals / areas[:, None], optimize=True) ** 2
            squares = np.stack([(pull**2).sum(axis=-1) - across, across]).mean(axis=2)
            total += 0.5 * factor * np.einsum("s,f,sfk->k", softness, volumes[part][free], squares, optimize=True)
    return total


def _one_layer(operators: SolidOperators) -> bool:
    """Whether every corner of the cells lies on the boundary."""
    mesh = operators.blade.mesh
    rings = [cells.nodes[:, ring] for cells in operators.cells for ring in cell(cells.kind).faces]
    every, outer = ([mesh.corners(faces).ravel() for faces in found] for found in (rings, mesh.boundary()))
    return bool(np.isin(np.concatenate(every), np.concatenate(outer)).all())


def _stress(operators: SolidOperators, slopes: Array, moved: Array, rest: Array) -> Array:
    """Stress (ncell, npoint, k, 3, 3) of modes whose nodes move by (ncell, nnode, 3, k) about a state."""
    turned = np.einsum("cpan,cnik->cpkia", slopes, moved, optimize=True)
    deformation = np.einsum("cpan,cni->cpia", slopes, rest, optimize=True) + np.eye(3)
    turned = np.einsum("cpia,cpkib->cpkab", deformation, turned, optimize=True)
    return operators.stress(symmetric(turned))


def _strain(operators: SolidOperators, stress: Array) -> Array:
    """Strains of stresses (..., 3, 3)."""
    material = operators.blade.material
    spherical = material.poissons_ratio * np.trace(stress, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)
    return np.asarray(((1.0 + material.poissons_ratio) * stress - spherical) / material.youngs_modulus)


def _average(operators: SolidOperators, cells: Cells, moved: Array, rest: Array, total: Array, weight: Array) -> None:
    """Add the cells' stresses at their nodes, weighed by volume."""
    points, _ = rule(cells.kind)
    nodes = cell(cells.kind).nodes
    terms = [np.column_stack([np.ones(len(at)), at]) for at in (points, nodes)]
    if cells.kind.startswith("hexahedron"):
        terms = [np.column_stack([t, t[:, [1, 2, 3]] * t[:, [2, 3, 1]], t[:, 1:].prod(axis=1)]) for t in terms]
    carried = terms[1] @ np.linalg.pinv(terms[0])
    for part in cells.parts(AT_ONCE):
        numbers = cells.nodes[part]
        stress = _stress(operators, cells.gradients[part], moved[numbers], rest[numbers])
        volume = cells.weights[part].sum(axis=1)
        at_nodes = np.einsum("np,cpkij,c->cnkij", carried, stress, volume, optimize=True)
        np.add.at(total, numbers, at_nodes)
        np.add.at(weight, numbers, volume[:, None])
