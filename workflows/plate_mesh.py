"""From the scene's [plate] to a meshed plate: a grid of our own choosing, or the file it names."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.errors import BadInput
from workflows.scene_checks import disproportion
from workflows.scene_file import SceneFile

if TYPE_CHECKING:
    import fem

CELLS_ALONG = (20, 40)
"""Ladder of grids; the coarsest whose estimated error is below the one asked for is taken."""

_MOST_SLENDER = 16
"""Cells are kept square up to plates this many times longer than wide, or wider than long."""


def ladder(source: SceneFile) -> tuple[int, ...]:
    """Grids to try in turn, as cells along the plate; the mesh of a file stands alone, as 0."""
    return CELLS_ALONG if source.mesh is None else (0,)


def build(source: SceneFile, cells: int) -> tuple[fem.Plate, str]:
    """The plate on a grid of so many cells along (0: on the scene's mesh file), and the mesh in words.

    Raises:
        BadInput: the mesh file is no good.
    """
    from fem import Material, Plate, rectangle

    given, material = source.scene.plate, source.scene.material
    if given is None or material is None:
        raise ValueError("the scene has no plate")
    if source.mesh is not None:
        mesh = _from_file(source)
        kind = "quadrilaterals" if mesh.t.shape[0] == 4 else "triangles"
        described = f"{mesh.t.shape[1]} {kind} from {given.mesh}"
    else:
        length, width = given.length or 0.0, given.width or 0.0
        square = cells * min(max(width / length, 1 / _MOST_SLENDER), _MOST_SLENDER)
        across = max(2, 2 * math.ceil(round(square) / 2))
        mesh = rectangle(length, width, cells, across)
        described = f"{cells} × {across} quadrilaterals"
    tip = place(source, mesh) if given.tip_mass else None
    substance = Material(material.youngs_modulus, material.poissons_ratio, material.density)
    return Plate(mesh, given.thickness, substance, given.tip_mass, tip), described


def place(source: SceneFile, mesh: Any) -> tuple[float, float]:
    """The damper's place (x, y) in m in the mesh's coordinates: as given, or the middle of the tip."""
    damper = source.scene.damper
    if damper is not None and damper.at is not None:
        return damper.at
    x, y = mesh.p
    tip = np.isclose(x, x.max(), rtol=0, atol=1e-9 * np.ptp(x))
    return float(x.max()), float(0.5 * (y[tip].min() + y[tip].max()))


def check(source: SceneFile) -> None:
    """Read the mesh file that a scene names and see that it can be a plate with the damper on it.

    Raises:
        BadInput: it cannot.
    """
    from fem.locate import locate

    mesh = _from_file(source)
    try:
        locate(mesh, place(source, mesh))
    except ValueError as error:
        raise off_the_plate(source, error) from error


def off_the_plate(source: SceneFile, error: ValueError) -> BadInput:
    """The error of a damper that is not where the plate is, or not where it moves."""
    damper = source.scene.damper
    value = None if damper is None or damper.at is None else list(damper.at)
    return BadInput(str(error), file=source.name, key="[damper] at", value=value)


def _from_file(source: SceneFile) -> Any:
    from fem import MeshError, read_mesh

    if source.mesh is None:
        raise ValueError("the scene names no mesh")
    try:
        mesh = read_mesh(source.mesh)
    except MeshError as error:
        value = source.scene.plate.mesh if source.scene.plate else None
        text = str(error).removeprefix(f"{source.mesh}: ")
        raise BadInput(text, file=source.name, key="[plate] mesh", value=value) from error
    _check_proportions(source, mesh)
    return mesh


def _check_proportions(source: SceneFile, mesh: Any) -> None:
    if source.scene.plate is None:
        return
    thickness = source.scene.plate.thickness
    odd = disproportion(thickness, *(float(extent) for extent in np.ptp(mesh.p, axis=1)))
    if odd is not None:
        key, problem = odd
        value = thickness if key == "thickness" else source.scene.plate.mesh
        raise BadInput(
            f"{problem} (a mesh is in metres)",
            file=source.name,
            key="[plate] thickness" if key == "thickness" else "[plate] mesh",
            value=value,
        )
