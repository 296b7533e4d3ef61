"""From the scene's [plate] to a meshed plate: grids of our own, or the file it names."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.errors import BadInput
from workflows.scene_checks import disproportion
from workflows.scene_file import SceneFile

if TYPE_CHECKING:
    import fem


def given(source: SceneFile) -> fem.Given:
    """The planform of a scene that names a mesh.

    Raises:
        BadInput: the mesh file is no good.
    """
    from fem import Given

    return Given(_from_file(source))


def planform(source: SceneFile) -> fem.Rectangle | fem.Given:
    """The scene's planform as a ladder of meshes.

    Raises:
        BadInput: the mesh file is no good.
    """
    from fem import Rectangle

    plate = source.scene.plate
    if plate is None:
        raise ValueError("the scene has no plate")
    if source.mesh is not None:
        return given(source)
    form = Rectangle(plate.length or 0.0, plate.width or 0.0)
    return _with_a_node_in_the_middle(form) if plate.tip_mass else form


def _with_a_node_in_the_middle(form: fem.Rectangle) -> fem.Rectangle:
    """Only grids with an even number of cells across: a point mass on a node and one between two are two problems."""
    return replace(form, sizes=tuple(size for size in form.sizes if form.cells(size)[1] % 2 == 0))


def plate(source: SceneFile, mesh: Any) -> fem.Plate:
    """The scene's plate on a mesh."""
    from fem import Material, Plate

    given, material = source.scene.plate, source.scene.material
    if given is None or material is None:
        raise ValueError("the scene has no plate")
    tip = place(source, mesh) if given.tip_mass else None
    substance = Material(material.youngs_modulus, material.poissons_ratio, material.density)
    return Plate(mesh, given.thickness, substance, given.tip_mass, tip)


def in_words(source: SceneFile, form: fem.Rectangle | fem.Given, size: int) -> str:
    """The mesh of a size of a planform's ladder, for people."""
    from fem import Rectangle

    if isinstance(form, Rectangle):
        along, across = form.cells(size)
        return f"{along} × {across} quadrilaterals, finer towards the edges"
    mesh = form.mesh(size)
    kind = "quadrilaterals" if mesh.t.shape[0] == 4 else "triangles"
    name = source.scene.plate.mesh if source.scene.plate else source.mesh
    parts = "" if size == 1 else f", each edge split in {size}"
    return f"{mesh.t.shape[1]} {kind} from {name}{parts}"


def place(source: SceneFile, mesh: Any) -> tuple[float, float]:
    """The damper's place (x, y) in m in the mesh's coordinates: as given, or the middle of the tip."""
    damper = source.scene.damper
    if damper is not None and damper.at is not None:
        return damper.at
    x, y = mesh.p
    tip = np.isclose(x, x.max(), rtol=0, atol=1e-9 * np.ptp(x))
    return float(x.max()), float(0.5 * (y[tip].min() + y[tip].max()))


def check(source: SceneFile) -> tuple[float, float]:
    """The sides [m] of the mesh that a scene names, once it is seen to be a plate with the damper on it.

    Raises:
        BadInput: it cannot.
    """
    from fem.locate import locate

    mesh = _from_file(source)
    length, width = np.ptp(mesh.p, axis=1)
    x, y = place(source, mesh)
    try:
        locate(mesh, (x, y))
        if x <= mesh.p[0].min() + 1e-9 * length:
            raise ValueError(f"expected a place that moves: ({x:g}, {y:g}) m is on the clamped root")
    except ValueError as error:
        raise off_the_plate(source, error) from error
    return float(length), float(width)


def off_the_plate(source: SceneFile, error: ValueError) -> BadInput:
    """The error of a damper that is not where the plate is, or not where it moves."""
    damper = source.scene.damper
    value = None if damper is None or damper.at is None else list(damper.at)
    return BadInput(str(error), file=source.name, key="[damper] at", value=value)


def _from_file(source: SceneFile) -> Any:
    from fem import MeshError, read_mesh
    from fem.planform import check_root

    if source.mesh is None:
        raise ValueError("the scene names no mesh")
    try:
        mesh = read_mesh(source.mesh)
        check_root(mesh, source.scene.rotor.hub_radius)
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
