"""From the scene's [plate] to a meshed plate: grids of our own, or the file it names."""

import functools
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import fem
from fem.meshes.mesh_sequence import Planform
from fem.meshes.planform import PlaceError, clamped_length, locate
from fem.meshes.thickness import Nodal, Profile, spread
from fem.meshes.thickness import of as thickness_of
from workflows.errors import present
from workflows.scene.damper import misfit
from workflows.scene.load import SceneFile
from workflows.scene.plate import Plate, disproportion, extremes
from workflows.scene.quantities import LENGTH, unit_in_si
from workflows.scene.scene import Scene

GAUSS = 24
"""Points along each side for integrals: exact for polynomials up to a degree of 47."""


def profile(plate: Plate, form: Planform | None = None) -> float | Profile:
    """The thickness as `fem` takes it.

    Raises:
        ValueError: it is a field of the mesh file, and the planform is not given.
    """
    thickness = plate.thickness
    return thickness if isinstance(thickness, float) else thickness.profile(getattr(form, "thickness", None))


def sides(plate: Plate, form: Planform | None = None) -> tuple[float, float]:
    """Length and width [m].

    Raises:
        ValueError: they are those of a mesh, whose planform is not given.
    """
    if form is not None:
        return form.sides
    if plate.length is None or plate.width is None:
        raise ValueError("the planform of a plate from a mesh is needed")
    return plate.length, plate.width


def thickness_range(plate: Plate, form: Planform | None = None) -> tuple[float, float, float]:
    """Least, mean and greatest thickness [m].

    Raises:
        ValueError: it is not above 0 all over the plate, or a table does not cover it.
    """
    if isinstance(plate.thickness, float):
        return (plate.thickness,) * 3
    length, width = sides(plate, form)
    if form is not None and plate.length is None:
        return spread(profile(plate, form), form.mesh(form.sizes[0]))
    least, greatest = extremes(plate.thickness, length, width)
    return least, volume(plate)[0] / length / width, greatest


@functools.cache
def _gauss() -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Points and weights on [-1, 1]."""
    points, weights = np.polynomial.legendre.leggauss(GAUSS)
    return points, weights


def section(plate: Plate) -> float:
    """Area [m²] of a rectangle's section at the root."""
    return float(_across(plate, np.zeros(1)).sum())


def volume(plate: Plate) -> tuple[float, float]:
    """Volume [m³] of a rectangular plate, and its first moment [m^4] about the root."""
    length = plate.length or 0.0
    t, weights = _gauss()
    x = 0.5 * length * (1.0 + t)
    along = 0.5 * length * weights * _across(plate, x)
    return float(along.sum()), float((x * along).sum())


def _across(plate: Plate, x: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Areas (n,) [m²] of a rectangle's sections at places along x (n,) [m]."""
    half, (t, weights) = 0.5 * present(plate.width), _gauss()
    points = np.stack(np.meshgrid(x, half * t, indexing="ij"))
    heights = np.broadcast_to(thickness_of(profile(plate), points), points.shape[1:])
    return np.asarray(half * heights @ weights)


def planform(source: SceneFile) -> Planform:
    """The scene's planform as a ladder of meshes.

    Raises:
        BadInput: the mesh file is no good.
    """
    plate = present(source.scene.plate)
    if source.mesh is not None:
        return _from_file(source)
    form = fem.Rectangle(plate.length or 0.0, plate.width or 0.0)
    if not source.scene.point_mass:
        return form
    # A mass on a node and one off it are two problems; even numbers of cells across have a node in the middle anyway.
    even = tuple(size for size in form.sizes if form.cells(size)[1] % 2 == 0)
    return replace(form, sizes=even, node=given_place(source.scene))


def plate(source: SceneFile, mesh: Any, form: Planform) -> fem.Plate:
    """The scene's plate on a mesh of its planform."""
    spec, material, mass = present(source.scene.plate), present(source.scene.material), source.scene.point_mass
    laden = place(source, mesh) if mass else None
    substance = fem.Material(material.youngs_modulus, material.poissons_ratio, material.density)
    springs = None if spec.root is None else fem.ElasticRoot(spec.root.stiffness, spec.root.rotational_stiffness)
    return fem.Plate(mesh, profile(spec, form), substance, mass, laden, springs)


def rotor(scene: Scene) -> fem.Rotor:
    """How the scene's plate sits on its axis."""
    return fem.Rotor(scene.rotor.hub_radius, scene.rotor.stagger, scene.rotor.precone)


def coarse_plate(scene: Scene, form: Planform | None, cells_per_mode: int) -> tuple[fem.Plate, fem.Rotor]:
    """The plate on the coarsest mesh of its ladder with so many cells for each mode, or on the finest; and its rotor.

    form: its planform, needed where that is a mesh.
    """
    source = SceneFile(scene, "scene", Path())
    ladder, cells = form or planform(source), cells_per_mode * scene.rotor.modes
    meshes = (ladder.mesh(size) for size in ladder.sizes)
    mesh = next((mesh for mesh in meshes if mesh.t.shape[1] >= cells), None)
    return plate(source, ladder.mesh(ladder.sizes[-1]) if mesh is None else mesh, ladder), rotor(scene)


def describe_mesh(source: SceneFile, form: Planform, size: int) -> str:
    """The mesh of a size of a planform's ladder, for people."""
    if isinstance(form, fem.Rectangle):
        along, across = form.cells(size)
        return f"{along} × {across} quadrilaterals, finer towards the edges"
    mesh = form.mesh(size)
    kind = "quadrilaterals" if mesh.t.shape[0] == 4 else "triangles"
    name = present(source.scene.plate).mesh
    parts = "" if size == 1 else f", each edge split in {size}"
    length, width = 1e3 * np.ptp(mesh.p, axis=1)
    size_in_words = f"{length:.4g} × {width:.4g} mm, root of {1e3 * clamped_length(mesh):.6g} mm"
    return f"{mesh.t.shape[1]} {kind} from {name}{parts}, {size_in_words}"


def given_place(scene: Scene) -> tuple[float, float] | None:
    """The place (x, y) in m that a scene gives its damper, or else its tip mass."""
    plate, damper = scene.plate, scene.damper
    if damper is not None:
        return damper.on_plate
    return None if plate is None else plate.tip_mass_at


def place(source: SceneFile, mesh: Any) -> tuple[float, float]:
    """The damper's place (x, y) in m in the mesh's coordinates: as given, or the middle of the tip.

    Where nothing sits on the plate and the middle of its tip is in a slit, it is the tip's point next to it.
    """
    at = damper_at(source.scene, mesh.p)
    if source.scene.damper is not None or source.scene.point_mass:
        return at

    try:
        locate(mesh, at)
    except PlaceError:
        x, y = mesh.p[:, _outermost(mesh.p)]
        nearest = np.abs(y - at[1]).argmin()
        return float(x[nearest]), float(y[nearest])
    return at


def damper_at(scene: Scene, points: np.ndarray) -> tuple[float, float]:
    """The same on a mesh of which the points (2, n) are known."""
    place = given_place(scene)
    if place is not None:
        return place
    x, y = points[:, _outermost(points)]
    return float(x.max()), float(0.5 * (y.min() + y.max()))


def _outermost(points: np.ndarray) -> np.ndarray:
    """Which of a plate's points (2, n) lie on its tip, (n,)."""
    x = points[0]
    return np.asarray(np.isclose(x, x.max(), rtol=0, atol=1e-9 * np.ptp(x)))


def root_and_place(source: SceneFile, mesh: Any) -> tuple[float, tuple[float, float]]:
    """In the plate's coordinates: x [m] of the clamped root, and the place (x, y) of the damper or of the tip's middle.

    `mesh` is one of the planform's, None where the scene names none.
    """
    if mesh is not None:
        return float(mesh.p[0].min()), place(source, mesh)
    plate = present(source.scene.plate)
    return 0.0, given_place(source.scene) or (present(plate.length), 0.0)


def placed(source: SceneFile) -> AbstractContextManager[None]:
    """A damper, or else a tip mass, that is not where the plate is, or not where it moves, is at fault."""
    key = "[damper] at" if source.scene.damper is not None else "[plate] tip_mass_at"
    return source.blaming(key, given_place(source.scene), fem.PlaceError)


def _from_file(source: SceneFile) -> fem.Given:
    """The mesh that a scene names, in m, once it is seen to be a plate with the damper on it."""
    from fem.meshes.read import FieldError, read_field

    plate = present(source.scene.plate)
    field = None if isinstance(plate.thickness, float) else plate.thickness.field
    of_mesh = source.blaming("[plate] mesh", plate.mesh, fem.MeshError)
    with of_mesh, source.blaming("[plate] thickness.field", field, FieldError):
        mesh, values = read_field(present(source.mesh), field)
    scale = unit_in_si(plate.mesh_unit, LENGTH)
    if scale != 1.0:
        mesh = mesh.scaled(scale)
    form = fem.Given(mesh, thickness=None if values is None else Nodal(mesh, scale * values))
    _check_proportions(source, plate, form)
    _check_place(source, form)
    return form


def _check_proportions(source: SceneFile, plate: Plate, form: fem.Given) -> None:
    with source.blaming("[plate] thickness", None, ValueError):
        least, _, greatest = thickness_range(plate, form)
    odd = disproportion(least, greatest, *form.sides)
    if odd is not None:
        key, problem = odd
        unit = (
            f"mesh_unit = {plate.mesh_unit!r}"
            if plate.mesh_unit
            else "a mesh is in metres, unless mesh_unit says otherwise"
        )
        thickness = plate.thickness if isinstance(plate.thickness, float) else None
        at = ("[plate] thickness", thickness) if key == "thickness" else ("[plate] mesh", plate.mesh)
        raise source.wrong(f"{problem} ({unit})", *at)


def _check_place(source: SceneFile, form: fem.Given) -> None:
    """The damper, or else the point mass, is on the plate and not on its root; and the damper fits in there."""
    plate, damper, mesh = source.scene.plate, source.scene.damper, form.given
    at = place(source, mesh)
    reach, (length, width) = at[0] - float(mesh.p[0].min()), np.ptp(mesh.p, axis=1)
    with placed(source):
        locate(mesh, at)
        if reach <= 1e-9 * length:
            raise PlaceError(f"expected a place that moves: ({at[0]:g}, {at[1]:g}) m is on the clamped root")
    if plate is None or damper is None:
        return
    odd = misfit(damper, plate.thickness_at(at, form.thickness), float(width), float(reach), room_across(mesh, at))
    if odd is not None:
        key, problem = odd
        raise source.wrong(problem, f"[damper] {key}", getattr(damper, key))


def room_across(mesh: Any, at: tuple[float, float]) -> float:
    """How wide the plate is at a place on it [m], as far as it reaches to both sides alike."""
    ends = mesh.p[:, mesh.facets[:, mesh.boundary_facets()]]
    (xa, xb), (ya, yb) = ends
    margin = 1e-9 * np.ptp(mesh.p[0])
    x = np.clip(at[0], mesh.p[0].min() + margin, mesh.p[0].max() - margin)
    met = (np.minimum(xa, xb) <= x) & (x < np.maximum(xa, xb))
    edges = ya[met] + (x - xa[met]) / (xb - xa)[met] * (yb - ya)[met]
    return 2.0 * float(np.abs(edges - at[1]).min())
