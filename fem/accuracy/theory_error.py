"""How far the frequencies of a plate theory are from those of a solid, mode by mode.

To first order a mode's frequency is off by half of the part of its energy that the theory has wrong. Thin-plate theory
lacks the compliance of transverse shear, Q² / (5/6 G h), and the layer along free edges in which the twisting moment
falls to nothing, h / sqrt(10) wide (Reissner 1945; for a strip this is Saint-Venant's 1 - 0.63 h/b). A solid's clamped
root is stiffer (`fem.theory.clamp`). Of Mindlin's theory, the shear factor would have to be 5 / (6 - nu) where shear is
no matter of layers, and what its moved root leaves is known by comparison.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.meshes.planform import root_facets
from fem.meshes.thickness import SLOPE as SLOPING
from fem.meshes.thickness import of, slope
from fem.theory.clamp import STRETCHED, at_root, seeming
from fem.theory.kind import Kind, kind
from fem.theory.mindlin import SHEAR_CORRECTION

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.operators.assembly import Operators
    from fem.plate.given import Plate
    from fem.theory.discretisation import Discretisation

    Array = NDArray[np.float64]

LAYER = 10.0**-0.5
"""Width of the layer along free edges in thicknesses."""

SHEAR, LAYERED = (0.01, 0.09), 0.005
"""Part of the shear energy, without nu and by it, that Mindlin's theory has wrong, about nu / 6; and of the layers."""

MARGIN = 1.25
"""By how much more shear and layers may take than they do to first order, at corners that point inwards most."""

LEFT = {"kirchhoff": (1.2, 1.2 * STRETCHED), "mindlin": (1.2, 1.2 * STRETCHED), "mindlin/held": (0.22, 0.5)}
"""Part of what the clamp does, in bending and in stretching, that a theory lacks at most."""

STRETCH, SLOPE, TURN = slice(0, 4), slice(4, 6), slice(6, 10)
"""Fields of the gradient: of u and v, of w, and of the turning of sections."""


def theory_errors(operators: Operators, eigenvalues: Array, shapes: NDArray[np.generic]) -> Array:
    """Relative errors (count,) of frequencies against a solid, of mass-normalised shapes (n, count)."""
    slopes = sloping(operators)
    if np.iscomplexobj(shapes):
        parts = np.hstack([np.real(shapes), np.imag(shapes)])
        both = np.diag(doubt(operators, parts))
        return np.asarray((both[: eigenvalues.size] + both[eigenvalues.size :]) / eigenvalues + slopes)
    return np.asarray(np.diag(doubt(operators, np.real(shapes))) / eigenvalues + slopes)


def doubt(operators: Operators, basis: Array) -> Array:
    """Matrix E (r, r): a mode of mass-normalised shape basis @ y (n, r) has a relative error of y' E y / rate².

    Zero for solids, which are the reference.
    """
    model, plate = operators.model, operators.plate
    if kind(model.theory) is Kind.SOLID:
        return np.zeros((basis.shape[1],) * 2)
    gradient = _gradient(model, plate, basis)
    thin = kind(model.theory) is Kind.KIRCHHOFF
    unmoved = plate.elastic_root is not None and not thin  # "held" moves a clamp, not springs
    energy = _clamp(model, plate, gradient, LEFT["kirchhoff" if thin else "mindlin" if unmoved else model.theory])
    if thin:
        return 0.5 * energy + _thin(model, plate, gradient)
    wrong = SHEAR[0] + SHEAR[1] * abs(plate.material.poissons_ratio)
    energy += wrong * _shear(model, plate, gradient) + LAYERED * _layers(model, plate, gradient)
    return 0.5 * energy


def thin_errors(operators: Operators, eigenvalues: Array, shapes: Array) -> Array:
    """What thin-plate theory would be off by (count,), from the modes of a Mindlin plate."""
    model, plate = operators.model, operators.plate
    gradient = _gradient(model, plate, shapes)
    energy = 0.5 * _clamp(model, plate, gradient, LEFT["kirchhoff"]) + _thin(model, plate, gradient)
    return np.asarray(np.diag(energy) / eigenvalues + sloping(operators))


def sloping(operators: Operators) -> float:
    """What plate theories are off where faces slope."""
    plate = operators.plate
    if kind(operators.model.theory) is Kind.SOLID:
        return 0.0
    return SLOPING * slope(plate.thickness, plate.mesh) ** 2


def layers(operators: Operators, eigenvalues: Array, shapes: Array) -> Array:
    """What the layers along free edges lower frequencies by (count,), of mass-normalised shapes (n, count)."""
    model, plate = operators.model, operators.plate
    energy = _layers(model, plate, _gradient(model, plate, shapes))
    return np.asarray(0.5 * MARGIN * np.diag(energy) / eigenvalues)


def _gradient(model: Discretisation, plate: Plate, basis: Array) -> Array:
    """Fields of the gradient (10, ncell, npoint, r), those of the turning as such, not in parts of the thickness."""
    found = model.gradient.evaluate(basis)
    if isinstance(plate.thickness, float | int):
        return found
    return np.concatenate([found[: TURN.start], found[TURN] / _heights(model, plate)[:, :, None]])


def _heights(model: Discretisation, plate: Plate) -> Array:
    """The thickness (ncell, npoint) in m."""
    return np.asarray(np.broadcast_to(of(plate.thickness, model.points[:2]), model.points.shape[1:]))


def _thin(model: Discretisation, plate: Plate, gradient: Array) -> Array:
    """What the frequencies of thin-plate theory are too high by: (r, r)."""
    return 0.5 * MARGIN * (_shear(model, plate, gradient) + _layers(model, plate, gradient))


def _clamp(model: Discretisation, plate: Plate, gradient: Array, left: tuple[float, float]) -> Array:
    """What the root of a solid has in energy beyond that of a theory with so much of it left: (r, r)."""
    facets = root_facets(model.mesh)
    lengths, _ = _along(model, facets)
    total = np.zeros((gradient.shape[-1],) * 2)
    h = at_root(plate)
    for part, fields, per_strain in zip(left, (TURN, STRETCH), (h**3 / 12.0, h), strict=True):
        xx, xy, yx, yy = _on(model, facets, gradient[fields])
        strains = np.stack([xx, yy, xy + yx])
        stresses = np.tensordot(plate.material.plane_stress, strains, 1)
        total += np.einsum("sfk,f,sfm->km", strains, part * seeming(plate) * per_strain * lengths, stresses)
    return total


def _layers(model: Discretisation, plate: Plate, gradient: Array) -> Array:
    """The twist in the layers along free edges: (r, r)."""
    facets = np.setdiff1d(model.mesh.boundary_facets(), root_facets(model.mesh))
    lengths, tangent = _along(model, facets)
    (xx, xy), (yx, yy) = _slopes(model, model.mesh.f2t[0, facets], gradient[SLOPE])
    x, y = tangent[:, :, None]
    twist = 0.5 * (xy + yx) * (x**2 - y**2) + (yy - xx) * x * y
    nu, h = plate.material.poissons_ratio, _heights(model, plate).mean(axis=1)[model.mesh.f2t[0, facets]]
    rigidity = plate.material.youngs_modulus * h**3 / 12.0 / (1.0 - nu**2)
    return np.asarray(np.einsum("fk,f,fm->km", twist, 2.0 * (1.0 - nu) * rigidity * LAYER * h * lengths, twist))


def _shear(model: Discretisation, plate: Plate, gradient: Array) -> Array:
    """The energy of the shear forces D grad (theta_x,x + theta_y,y), in which layers have no part: (r, r)."""
    cells = np.arange(model.mesh.t.shape[1])
    xx, _, _, yy = gradient[TURN]
    material, h = plate.material, _heights(model, plate)
    rigidity = material.youngs_modulus * h**3 / 12.0 / (1.0 - material.poissons_ratio**2)
    (steep,) = np.moveaxis(_slopes(model, cells, (rigidity[:, :, None] * (xx + yy))[None]), 1, 0)
    area = model.gradient.dx / (1.0 if isinstance(plate.thickness, float | int) else h)
    weights = (area / (SHEAR_CORRECTION * material.shear_modulus * h)).sum(axis=1)
    return np.asarray(np.einsum("ack,c,acm->km", steep, weights, steep))


def _along(model: Discretisation, facets: NDArray[np.int64]) -> tuple[Array, Array]:
    """Lengths (nfacet,) and unit tangents (2, nfacet)."""
    a, b = model.mesh.p[:, model.mesh.facets[:, facets]].transpose(1, 0, 2)
    lengths = np.linalg.norm(b - a, axis=0)
    return lengths, (b - a) / lengths


def _slopes(model: Discretisation, cells: NDArray[np.int64], values: Array) -> Array:
    """Derivatives (2, nfield, ncell, r) in some cells of fields (nfield, all cells, npoint, r), by least squares."""
    places = model.points[:2][:, cells].transpose(1, 2, 0)
    places = places - places.mean(axis=1, keepdims=True)
    turned = places.transpose(0, 2, 1)
    apart = np.linalg.solve(turned @ places, turned)
    return np.asarray(np.einsum("cap,fcpk->afck", apart, values[:, cells]))


def _on(model: Discretisation, facets: NDArray[np.int64], values: Array) -> Array:
    """Fields (nfield, all cells, npoint, r) in the middle of facets: (nfield, nfacet, r)."""
    cells = model.mesh.f2t[0, facets]
    middle = model.mesh.p[:, model.mesh.facets[:, facets]].mean(axis=1)
    off = middle - model.points[:2][:, cells].mean(axis=2)
    return np.asarray(values[:, cells].mean(axis=2) + np.einsum("ac,afck->fck", off, _slopes(model, cells, values)))
