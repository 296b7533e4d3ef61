"""What keeps meshes from converging at their order: the layer along free edges, and point masses.

Along a free edge of a plate with shear the twisting moment is carried in a layer about as wide as the plate is thick
(Arnold and Falk, SIAM J. Math. Anal. 27 (1996) 486). Cells wider than it do not see it: the plate twists as a thin one,
and refinement changes that little until the cells have become as narrow.

A point mass loads the plate at a point. Its displacement in the plane, and across where there is shear, has no limit:
it grows with the logarithm of the distance that the mesh resolves (Timoshenko and Goodier, Theory of Elasticity, art.
36 for a force on an edge).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.assembly import AtPlace, Operators
from fem.linalg import Array, quadratic_forms
from fem.meshes.planform import locate
from fem.plate import Plate
from fem.theory.mindlin import SHEAR_CORRECTION
from fem.theory.registry import Kind, kind

SPOT = 0.1
"""Thicknesses that a point mass is taken to be wide at least."""


def unseen(edge: float, thickness: float) -> float:
    """Part of the edge layer's effect that quadratic cells of a width (m) miss; between 0 and 1.

    In the layer the twist falls off as e^(-d/l), l = h / sqrt(12 k) with the shear correction k, as the twisting
    stiffness E h³ / (24 (1 + nu)) and the shear stiffness k G h have it. A row of equal quadratic elements without end
    is stiffer at the edge: the stiffness z of v'' = v obeys z = a - b² / (z + a), one more element in front, where a
    and b are an element's once its middle is eliminated. With w = edge / l, 1 - 1/z² is w⁴ / ((12 + w²)(60 + w²)).
    """
    square = 12.0 * SHEAR_CORRECTION * (edge / thickness) ** 2
    lost = square**2 / ((12.0 + square) * (60.0 + square))
    return float(lost / (1.0 + np.sqrt(1.0 - lost)))


def layer_errors(apart: Array, coarse: float, fine: float, whole: Array) -> Array:
    """Relative errors on the finer of two meshes, as far as they are the layer's.

    Args:
        apart: relative differences of the two.
        coarse: what the edge cells of the one miss of the layer, see `unseen`.
        fine: what those of the other miss.
        whole: what the layer does to each frequency, see `fem.accuracy.theory_selection.layers`.
    """
    if fine == 0.0:
        return np.zeros_like(apart)
    return np.minimum(apart * fine / max(coarse - fine, np.finfo(float).tiny), whole * fine)


def layer_and_rest(
    apart: tuple[Array, Array], missed: tuple[float, ...], sizes: tuple[int, ...], order: float
) -> Array:
    """Errors on the finest of three meshes, of which one part falls as the layer is seen and the rest at an order.

    apart: relative differences of the first two and of the last two meshes. missed: of the layer, on each mesh, see
    `unseen`. sizes: inverse to the cells. Neither part is negative.
    """
    rest = np.array(sizes, dtype=float) ** -order
    (a, c), (b, d) = -np.diff(missed), -np.diff(rest)
    first, second = apart
    with np.errstate(divide="ignore", invalid="ignore"):
        layer = (first * d - second * b) / (a * d - c * b)
        other = (second * a - first * c) / (a * d - c * b)
        alone = np.where(layer > 0.0, second / c * missed[2], second / d * rest[2])
    both = layer * missed[2] + other * rest[2]
    return np.asarray(np.where((layer > 0.0) & (other > 0.0), both, alone))


def folds(plate: Plate) -> float:
    """Number of factors e by which cells around the point mass exceed `SPOT` thicknesses; at least one.

    Nothing in a plate theory tells how wide the mass sits; as narrow as that, a solid's is no point either.
    """
    if plate.tip_mass == 0.0 or plate.tip_at is None:
        return 1.0
    return max(1.0, float(np.log(_width(plate, plate.tip_at) / (SPOT * plate.thickness_at(plate.tip_at)))))


def drift(operators: Operators, eigenvalues: Array, shapes: NDArray[Any], omega: float = 0.0) -> Array:
    """Relative drop of frequencies left as cells around a point mass shrink e times.

    The compliance at a point of an edge grows by 2 / (pi E h) in the plane and, with shear, by 1 / (pi k G h) across.
    At a point inside the plate it is half of that across, and in the plane (1 + nu) (3 - nu) / (4 pi E h) (Kelvin's
    solution in plane stress).

    Args:
        operators: of the plate.
        eigenvalues: squared circular frequencies, shape (count,) [rad²/s²].
        shapes: mass-normalised modes, shape (n, count).
        omega: speed [rad/s].

    Returns:
        Shape (count,).
    """
    plate = operators.plate
    if plate.tip_mass == 0.0 or plate.tip_at is None:
        return np.zeros(eigenvalues.size)
    place = operators.at_place(plate.tip_at)
    along, across = _growth(plate, place.at)
    if kind(operators.model.theory) is Kind.KIRCHHOFF:
        across = 0.0
    pull = _pull(place, omega)
    motion, by_x, by_y = (rows @ shapes for rows in place.rows)
    # the pull stays as it is, and where the plate turns, the stress that it makes there carries a part of it sideways
    force = np.abs(_inertia(place, eigenvalues, motion, omega) - pull[0] * by_x - pull[1] * by_y) ** 2
    work = (force[0] + force[1]) * along + force[2] * across
    size = np.linalg.norm(pull)
    if size > 0.0 and operators.pulled is not None:
        # where the mass gives way to its pull it moves with another part of the plate, stretches what is between, and
        # pulls more: by so much do squared frequencies rise per metre
        further = pull[0] / size * by_x + pull[1] / size * by_y
        stiffer = omega**2 * quadratic_forms(operators.pulled, shapes)
        radius = np.linalg.norm(operators.rotor.projector @ operators.from_axis(place.at))
        less = 2.0 * np.real((motion.conj() * _inertia(place, eigenvalues, further, omega)).sum(axis=0))
        rise = stiffer / radius + size * (np.abs(further) ** 2).sum(axis=0) - less
        work = work + np.linalg.norm(pull[:2]) * along * np.abs(rise)
    return np.asarray(0.5 * work / eigenvalues)


def _growth(plate: Plate, place: tuple[float, float]) -> tuple[float, float]:
    """By how much the compliance (m/N) at a place grows in the plane and across as cells get e times smaller."""
    material, h = plate.material, plate.thickness_at(place)
    nu, inside = material.poissons_ratio, _is_inside(plate, place)
    along = 0.25 * (1.0 + nu) * (3.0 - nu) if inside else 2.0
    across = 0.5 if inside else 1.0
    return (
        along / (np.pi * material.youngs_modulus * h),
        across / (np.pi * SHEAR_CORRECTION * material.shear_modulus * h),
    )


def _pull(place: AtPlace, omega: float) -> Array:
    """The centrifugal force (3,) in N of the point mass, none where nothing asks for it."""
    operators = place.operators
    if operators.prestress is None:
        return np.zeros(3)
    return np.asarray(operators.plate.tip_mass * omega**2 * operators.rotor.projector @ operators.from_axis(place.at))


def _inertia(place: AtPlace, eigenvalues: Array, motion: NDArray[Any], omega: float) -> NDArray[Any]:
    """Force (3, count) in N of the point mass where it moves (3, count), turning with the plate."""
    operators = place.operators
    force = eigenvalues * motion
    if operators.effects.spin_softening:
        force = force + omega**2 * operators.rotor.projector @ motion
    return np.asarray(operators.plate.tip_mass * force)


def _is_inside(plate: Plate, place: tuple[float, float]) -> bool:
    """Whether a place is farther from the plate's edges than the cell that it is in is wide."""
    mesh = plate.mesh
    a, b = mesh.p[:, mesh.facets[:, mesh.boundary_facets()]].transpose(1, 0, 2)
    from_a = np.array(place)[:, None] - a
    part = np.clip((from_a * (b - a)).sum(axis=0) / ((b - a) ** 2).sum(axis=0), 0.0, 1.0)
    away = np.linalg.norm(from_a - part * (b - a), axis=0).min()
    return bool(away > _width(plate, place))


def _width(plate: Plate, place: tuple[float, float]) -> float:
    """How wide (m) the cell is that a place is in, on average of both directions."""
    corners = plate.mesh.p[:, plate.mesh.t[:, locate(plate.mesh, place)[0]]]
    return float(np.ptp(corners, axis=1).mean())
