"""The plate roughly, as a uniform cantilever: enough to say whether an effect on the ball counts."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from workflows.scene import thicknesses
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    from fem.meshes.mesh_sequence import Planform

SLOPE = 1.3765
"""Of a uniform cantilever's first mode at the tip, over w/L."""

_ROOT, SHARE = 1.8751, 0.25
"""Of that mode: first root of cos x cosh x = -1, and effective mass at the tip over the whole."""

STIFFENED = 1.19, 1.57
"""Growth of a uniform cantilever's first squared frequency with Omega², and with that times hub radius over length
(Southwell and Gough 1921)."""


class Beam(NamedTuple):
    """A uniform cantilever like the plate: length [m], mass [kg], squared first frequency at rest [1/s²]."""

    length: float
    mass: float
    square: float


def beam_like(scene: Scene, form: Planform | None) -> Beam:
    """The cantilever of a scene's plate, with its point mass."""
    plate, material = scene.plate, scene.material
    if plate is None or material is None:
        raise ValueError("the scene has no plate")
    if form is None and plate.mesh is not None:
        raise ValueError("the planform of a plate from a mesh is needed")
    length, width = (plate.length, plate.width) if form is None else form.sides
    thickness = thicknesses.spread(plate, form)[1]
    mass = material.density * float(length or 0.0) * float(width or 0.0) * thickness
    square = _ROOT**4 * material.youngs_modulus * thickness**2 / (12 * material.density * float(length or 1.0) ** 4)
    return Beam(float(length or 0.0), mass, square * SHARE * mass / (SHARE * mass + scene.point_mass))
