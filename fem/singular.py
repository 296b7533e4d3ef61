"""What keeps meshes from converging at their order: the layer along free edges, and point masses.

Along a free edge of a plate with shear the twisting moment is carried in a layer about as wide as the plate is thick
(Arnold and Falk, SIAM J. Math. Anal. 27 (1996) 486). Cells wider than it do not see it: the plate twists as a thin one,
and refinement changes that little until the cells have become as narrow.

A point mass loads the plate at a point. Its displacement in the plane, and across where there is shear, has no limit:
it grows with the logarithm of the distance that the mesh resolves (Timoshenko and Goodier, Theory of Elasticity, art.
36 for a force on an edge).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fem.locate import locate
from fem.mindlin import SHEAR_CORRECTION
from fem.operators import point_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.operators import Operators
    from fem.plate import Plate

    Array = NDArray[np.float64]

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

    apart: relative differences of the two. coarse, fine: what their edge cells miss of the layer, see `unseen`.
    whole: what the layer does to each frequency, see `fem.doubt.layers`.
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
    """By how many factors e cells around the point mass are wider than `SPOT` thicknesses; at least one.

    Nothing in a plate theory tells how wide the mass sits; as narrow as that, a solid's is no point either.
    """
    if plate.tip_mass == 0.0 or plate.tip_at is None:
        return 1.0
    corners = plate.mesh.p[:, plate.mesh.t[:, locate(plate.mesh, plate.tip_at)[0]]]
    width = float(np.ptp(corners, axis=1).mean())
    return max(1.0, float(np.log(width / (SPOT * plate.thickness_at(plate.tip_at)))))


def drift(operators: Operators, eigenvalues: Array, shapes: NDArray[Any]) -> Array:
    """How much frequencies (count,) still fall, relatively, as cells around the point mass get e times smaller.

    The compliance at a point of an edge grows by 2 / (pi E h) in the plane and, with shear, by 1 / (pi k G h) across;
    the mode's inertia force is m w² times its displacement there. At a point inside the plate it is half of that.
    """
    plate = operators.plate
    if plate.tip_mass == 0.0 or plate.tip_at is None:
        return np.zeros(eigenvalues.size)
    motion = np.abs(point_rows(operators.model, plate.tip_at) @ shapes) ** 2
    material, h = plate.material, plate.thickness_at(plate.tip_at)
    growth = (motion[0] + motion[1]) * 2.0 / (np.pi * material.youngs_modulus * h)
    if not operators.model.theory.startswith("kirchhoff"):
        growth += motion[2] / (np.pi * SHEAR_CORRECTION * material.shear_modulus * h)
    return np.asarray(0.5 * plate.tip_mass**2 * eigenvalues * growth)
