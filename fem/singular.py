"""What keeps meshes from converging at their order: the layer along free edges, and point masses.

Along a free edge of a plate with shear the twisting moment is carried in a layer about as wide as the plate is thick
(Arnold and Falk, SIAM J. Math. Anal. 27 (1996) 486). Cells wider than it do not see it: the plate twists as a thin one,
and refinement changes that little until the cells have become as narrow.

A point mass loads the plate at a point. Its displacement in the plane, and across where there is shear, has no limit:
it grows with the logarithm of the distance that the mesh resolves (Timoshenko and Goodier, Theory of Elasticity, art.
36 for a force on an edge).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.mindlin import SHEAR_CORRECTION
from fem.operators import point_rows
from fem.theories import TORSION

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.modes import Modes
    from fem.operators import Operators

    Array = NDArray[np.float64]

HALF_SEEN = 4.7
"""Width over thickness of edge cells that see half of the layer (Q2 cells; plates of h/b from 1/70 to 1/700)."""


def unseen(edge: float, thickness: float) -> float:
    """Part of the edge layer's effect that edge cells of a width (m) miss; between 0 and 1."""
    square = (edge / thickness) ** 2
    return square / (square + HALF_SEEN**2)


def layer_errors(apart: Array, coarse: float, fine: float, slenderness: float) -> Array:
    """Relative errors on the finer of two meshes, as far as they are the layer's.

    apart: relative differences of the two. coarse, fine: what their edge cells miss of the layer, see `unseen`.
    slenderness: thickness over width; the whole layer lowers twist by TORSION times that.
    """
    largest = TORSION * slenderness * fine
    return np.minimum(apart * fine / max(coarse - fine, np.finfo(float).tiny), largest)


def drift(operators: Operators, modes: Modes) -> Array:
    """How much frequencies (count,) still fall, relatively, as cells around the point mass get e times smaller.

    The compliance at a point of an edge grows by 2 / (pi E h) in the plane and, with shear, by 1 / (pi k G h) across;
    the mode's inertia force is m w² times its displacement there. At a point inside the plate it is half of that.
    """
    plate = operators.plate
    if plate.tip_mass == 0.0 or plate.tip_at is None:
        return np.zeros(modes.eigenvalues.size)
    motion = np.abs(point_rows(operators.model, plate.tip_at) @ modes.shapes) ** 2
    material, h = plate.material, plate.thickness
    growth = (motion[0] + motion[1]) * 2.0 / (np.pi * material.youngs_modulus * h)
    if not operators.model.theory.startswith("kirchhoff"):
        growth += motion[2] / (np.pi * SHEAR_CORRECTION * material.shear_modulus * h)
    return np.asarray(0.5 * plate.tip_mass**2 * modes.eigenvalues * growth)
