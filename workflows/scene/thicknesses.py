"""The thickness that a scene gives its plate, at a place and over the planform.

`form` is the planform, needed where that is a mesh; of a rectangle the scene knows all.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from workflows.scene.thickness_table import extremes, thickness_at

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from fem.meshes.mesh_sequence import Planform
    from fem.meshes.thickness import Profile
    from workflows.scene.plate import Plate

GAUSS = 24
"""Points along each side for integrals: exact for polynomials up to a degree of 47."""


def profile(plate: Plate, form: Planform | None = None) -> float | Profile:
    """The thickness as `fem` takes it.

    Raises:
        ValueError: it is a field of the mesh file, and the planform is not given.
    """
    given = plate.thickness
    return given if isinstance(given, float) else given.profile(getattr(form, "thickness", None))


def at(plate: Plate, place: tuple[float, float], form: Planform | None = None) -> float:
    """The thickness [m] at a place (x, y) [m] on the plate."""
    return thickness_at(plate.thickness, place, getattr(form, "thickness", None))


def spread(plate: Plate, form: Planform | None = None) -> tuple[float, float, float]:
    """Least, mean and greatest thickness [m].

    Raises:
        ValueError: it is not above 0 all over the plate, or a table does not cover it.
    """
    if isinstance(plate.thickness, float):
        return (plate.thickness,) * 3
    if plate.length is not None and plate.width is not None:
        least, greatest = extremes(plate.thickness, plate.length, plate.width)
        return least, volume(plate)[0] / plate.length / plate.width, greatest
    if form is None:
        raise ValueError("the planform of a plate from a mesh is needed")
    from fem.meshes import thickness

    return thickness.spread(profile(plate, form), form.mesh(form.sizes[0]))


def slope_error(plate: Plate, form: Planform | None = None) -> float:
    """What plate theories are off, relatively in frequency, where faces slope; `form` as in `spread`."""
    if isinstance(plate.thickness, float):
        return 0.0
    from fem import Rectangle
    from fem.meshes import thickness

    if form is None:
        form = Rectangle(plate.length or 0.0, plate.width or 0.0)
    return thickness.SLOPE * thickness.slope(profile(plate, form), form.mesh(form.sizes[0])) ** 2


@functools.cache
def _gauss() -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Points and weights on [-1, 1]."""
    import numpy as np

    points, weights = np.polynomial.legendre.leggauss(GAUSS)
    return points, weights


def section(plate: Plate) -> float:
    """Area [m²] of a rectangle's section at the root."""
    return float((_across(plate, [0.0])[1]).sum())


def volume(plate: Plate) -> tuple[float, float]:
    """Volume [m³] of a rectangular plate, and its first moment [m^4] about the root."""
    length = plate.length or 0.0
    t, weights = _gauss()
    x, areas = _across(plate, 0.5 * length * (1.0 + t))
    along = 0.5 * length * weights * areas
    return float(along.sum()), float((x * along).sum())


def _across(plate: Plate, x: npt.ArrayLike) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Places along x (n,) [m], and the areas (n,) [m²] of a rectangle's sections there."""
    import numpy as np

    from fem.meshes.thickness import of

    if plate.width is None:
        raise ValueError("the plate is no rectangle")
    places, (t, weights) = np.asarray(x, dtype=float), _gauss()
    points = np.stack(np.meshgrid(places, 0.5 * plate.width * t, indexing="ij"))
    heights = np.broadcast_to(of(profile(plate), points), points.shape[1:])
    return places, 0.5 * plate.width * heights @ weights
