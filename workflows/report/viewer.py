"""What `view` shows: the surface, the modes and the facts of results, scenes and mesh files, as a page."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import fem
from fem.meshes.read import raw_mesh, surface_of
from fem.meshes.volume import SizeError, has_volume, volume_of
from workflows import pipeline
from workflows.errors import BadInput, present
from workflows.formatting import significant, whole
from workflows.io import serialise
from workflows.io.files import STUDIES
from workflows.io.folder import put
from workflows.progress import Stages
from workflows.report import figures, mode_viewer, plots, remarks
from workflows.report.templates import from_template, in_mm, said
from workflows.scene import load, quantities
from workflows.scene.scene import Scene
from workflows.solve import resources
from workflows.solve.results import Diagram, Floats, SpeedPoint, Surface, Theory, bare_surface, skin

_SHARP, _BLUNT = 20.0, 150.0
"""Angles [degrees] within which a cell is of a good shape."""


_ROOM = 12_000, 600_000
"""What a page of its own has room for: points, and bytes of vectors."""


def facts(text: str, values: dict[str, Any]) -> tuple[tuple[str, str], ...]:
    """Name and words of each thing that was read."""
    lines = said(f"view/{text}", sharp=_SHARP, blunt=_BLUNT, **values)
    return tuple((name, words) for name, _, words in (line.partition(" | ") for line in lines))


def numbers(surface: Surface) -> dict[str, Any]:
    """What was read of a plate as plain data: lengths in m, angles in degrees."""
    points, cells = surface.points[:, :2], surface.cells[1]
    corners = points[cells]
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    angles = _angles(corners)
    low, high = points.min(axis=0), points.max(axis=0)
    ends = points[surface.root]
    held = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    bad = (angles < _SHARP).any(axis=1) | (angles > _BLUNT).any(axis=1)
    return {
        "kind": surface.cells[0],
        "cells": len(cells),
        "points": len(points),
        "extent": {"x": [float(low[0]), float(high[0])], "y": [float(low[1]), float(high[1])]},
        "root": {"x": float(low[0]), "edges": len(ends), "length": float(held.sum())},
        "holes": 1 - len(points) + (cells.size + len(surface.outline)) // 2 - len(cells),  # by Euler's formula
        "edges": {"shortest": float(sides.min()), "median": float(np.median(sides)), "longest": float(sides.max())},
        "angles": {"least": float(angles.min()), "greatest": float(angles.max()), "odd_cells": int(bad.sum())},
        "aspect": float((sides.max(axis=1) / sides.min(axis=1)).max()),
    }


def _angles(corners: Floats) -> Floats:
    """Inner angles [degrees] of cells with corners (m, 3 or 4, 2)."""
    on, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cosine = (on * back).sum(axis=2) / np.linalg.norm(on, axis=2) / np.linalg.norm(back, axis=2)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


@dataclass(frozen=True, eq=False)
class ViewData:
    """What is shown.

    Attributes:
        title: in a line.
        surface: with or without shapes; `speeds` are those that `surface.at` counts.
        mark: where the damper is, (x, y) on a plate, (x, y, z) in space as it is drawn [m]; None where there is none.
        thickness: of the whole plate [m]; None where it varies or is not known.
        root: what the root is, in words; empty where none is known.
        facts: what was understood, name and words of each; `numbers` the same for programs.
        first: which of the speeds is shown first, and which of its modes, both from 0.
    """

    title: str
    surface: Surface
    facts: tuple[tuple[str, str], ...]
    numbers: dict[str, Any]
    root: str = ""
    speeds: tuple[SpeedPoint, ...] = ()
    mark: tuple[float, ...] | None = None
    thickness: float | None = None
    first: tuple[int, int] = (0, 0)

    @cached_property
    def view(self) -> mode_viewer.View:
        """The viewer's data, within the room that a page of its own has."""
        return mode_viewer.of_surface(self.surface, self.speeds, self.mark, self.thickness, self.first, *_ROOM)

    @property
    def thinned(self) -> str:
        """What to say where points were left out; nothing where none were."""
        drawn, of = whole(self.view.points), whole(self.view.of)
        return f"drawn with {drawn} of {of} points, all corners of the boundary kept" if self.view.thinned else ""


def of_plate(
    scene: Scene, surface: Surface, speeds: tuple[SpeedPoint, ...], known: tuple[tuple[str, str], ...]
) -> ViewData:
    """The plate of a scene that has one, as it was solved; `known` stands before what is said of its mesh."""
    known_of = {"points": len(surface.points)} if surface.frame is not None else numbers(surface)
    words = facts("surface", known_of) if surface.frame is None else ()
    mark = mode_viewer.damper_mark(scene, surface)
    place = mark if surface.mark is None else tuple(surface.mark.tolist())
    if place is not None:
        told = f"at {', '.join(map(in_mm, place))} mm"
        known = (*known, ("damper", "; ".join([told, *remarks.misfit(scene, speeds)])))
    root = figures.held(scene) if len(surface.root) else ""
    even = mode_viewer.even_thickness(scene)
    return ViewData(scene.title, surface, (*known, *words), {"damper": place, **known_of}, root, speeds, mark, even)


_LONGEST = 5.0
"""Plates [m] beyond which the file is more likely in millimetres."""


def data_of_mesh(path: Path, unit: str | None = None) -> ViewData:
    """The mesh of a file.

    unit: of its coordinates, such as "mm"; None: m, or mm where a volume in m would be too large or too small.

    Raises:
        BadInput: it is no mesh of a plate's mid-surface, nor of a volume; the message says what is wrong.
    """
    try:
        scale = quantities.unit_in_si(unit, quantities.LENGTH)
    except quantities.UnitError as error:
        raise BadInput("expected a unit of length such as 'mm'", key="--unit", value=unit) from error
    try:
        raw = raw_mesh(path)
        if has_volume(raw):
            return _data_of_volume(path, raw, unit, scale)
        mesh = surface_of(raw)[0].scaled(scale)
    except SizeError as error:
        raise BadInput(str(error), file=str(path), key="--unit", value=unit) from error
    except fem.MeshError as error:
        raise BadInput(str(error), file=str(path)) from error
    surface = bare_surface(mesh)
    read = numbers(surface)
    side = float(max(mesh.p.max(axis=1) - mesh.p.min(axis=1)))
    long = f"; {significant(side, 3)} m is long: --unit mm?" if unit is None and side > _LONGEST else ""
    known = (*facts("surface", read), ("unit", _unit("m", unit, "[plate] mesh_unit") + long))
    return ViewData(path.name, surface, known, read, "clamped root")


def _data_of_volume(path: Path, raw: Any, given: str | None, scale: float) -> ViewData:
    """The surface of a volume mesh, in its file's axes.

    Raises:
        MeshError: no blade can be made of it.
    """
    unit = given or "m"
    try:
        mesh = volume_of(path, raw, scale)
    except SizeError as error:
        try:
            unit, mesh = given or "mm", volume_of(path, raw, scale if given is not None else 1e-3)
        except SizeError:
            raise error from None
    surface = replace(skin(mesh.points, mesh.cells)[0], frame=np.eye(3))
    ends = [(float(one), float(other)) for one, other in zip(mesh.points.min(0), mesh.points.max(0), strict=True)]
    taken = _unit(unit, given, "[blade] unit")
    values = {
        "cells": {kind: len(nodes) for kind, nodes in mesh.cells},
        "points": len(mesh.points),
        "extent": dict(zip("xyz", ends, strict=True)),
        "sets": list(mesh.sets),
        "unit": unit,
    }
    return ViewData(path.name, surface, facts("volume", values | {"taken": taken}), values)


def _unit(unit: str, given: str | None, key: str) -> str:
    """What the coordinates are in, and who says so."""
    if given is not None:
        return f"{given}, as --unit says"
    return f"coordinates taken as {unit}, an assumption: --unit sets another, in a scene {key}"


def data_of_results(folder: Path) -> ViewData:
    """The plate that a run left in a folder, with its modes.

    Raises:
        BadInput: the folder holds no results of a plate.
    """
    try:
        results = serialise.read(folder)
    except BadInput as error:
        raise BadInput(error.problem, file=str(folder)) from error
    if results.surface is None or results.diagram is None:
        raise BadInput("contains results without a plate: there is no shape to show", file=str(folder))
    return of_plate(results.scene, results.surface, results.speeds, _known(results.diagram, results.theory))


def _known(diagram: Diagram, theory: Theory | None) -> tuple[tuple[str, str], ...]:
    """Mesh and theory, in words."""
    return (("mesh", diagram.mesh), *((("theory", theory.name),) if theory is not None else ()))


def data_of_scene(scene: str, omega: float | None) -> ViewData:
    """The plate of a scene with its modes.

    Raises:
        BadInput, NoAnswer: as a run of it would; also where it has no plate.
    """
    source = load.load(scene)
    if source.scene.given is not None:
        raise source.wrong("the table is missing: view needs a plate, a blade or known modes", "[plate]")
    if omega is not None:
        source = source.changed(rotor={"speeds": (omega,)})
    resources.check(source)
    with Stages() as stages:
        state = pipeline.structure(source, stages)
    told = tuple(("remark", each) for each in source.remarks)
    known = (*told, *_known(present(state.diagram), state.theory))
    return of_plate(source.scene, present(state.surface), state.points, known)


def page_of_study(target: str) -> Path | None:
    """The report of a folder that a study, not a run, has written; None where it is none."""
    folder = Path(target)
    try:
        whose = any((folder / f"{name}.json").is_file() for name in STUDIES) and not (folder / serialise.NAME).exists()
    except (OSError, ValueError):
        return None
    page = folder / "report.html"
    return page if whose and page.is_file() else None


def of(target: str, omega: float | None = None, unit: str | None = None) -> ViewData:
    """What a folder of results, a scene or a mesh file shows.

    omega: the one speed that a scene is solved at [rad/s]; unit: of the coordinates of a mesh file, see `data_of_mesh`.

    Raises:
        BadInput: it is none of these, or it has no plate.
        NoAnswer: the scene's physics has none.
    """
    path = Path(target)
    try:
        folder, file = path.is_dir(), path.is_file()
    except (OSError, ValueError) as error:
        raise BadInput("expected a folder of results, a scene or a mesh file", file=target) from error
    if file and path.suffix.lower() != ".toml":
        return data_of_mesh(path, unit)
    if unit is not None:
        raise BadInput("belongs to a mesh file: results and scenes have their unit", key="--unit", value=unit)
    if folder:
        return data_of_results(path)
    if not file and path.suffix.lower() not in ("", ".toml"):
        raise BadInput("no such folder of results, scene or mesh file", file=target)
    return data_of_scene(target, omega)


def page(view_data: ViewData) -> str:
    """The page as text."""
    with plots.style():
        figure = figures.mesh_of(view_data.surface, view_data.mark, view_data.root)
        still = plots.svg(figure, "mesh", figures.SHOWN["mesh"])
    carrier = "plate" if view_data.surface.frame is None else "structure"
    return from_template("view.html.j2", view_data=view_data, view=view_data.view, still=still, carrier=carrier)


def write(view_data: ViewData, path: Path) -> Path:
    """Put the page into a file, whole or not at all, and return the file.

    Raises:
        BadInput: it cannot be written.
    """
    return put(path, lambda fresh: fresh.write_text(page(view_data), encoding="utf-8"), "--out")
