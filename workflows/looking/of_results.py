"""A folder of results to look at: the run that it keeps, or else the files that other programs read."""

from __future__ import annotations

import contextlib
import io
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from workflows.errors import BadInput
from workflows.looking.mesh_facts import facts
from workflows.looking.sight import Sight, of_plate
from workflows.results import kept
from workflows.scene import plate_mesh
from workflows.solve.plate_records import bare
from workflows.solve.records import Mode, SpeedPoint, Surface


def sight(folder: Path) -> Sight:
    """The plate that a run left in a folder, with its modes.

    Raises:
        BadInput: the folder holds no results of a plate.
    """
    return _of_run(folder) if (folder / kept.NAME).is_file() else _of_files(folder)


def _of_run(folder: Path) -> Sight:
    """Of the run as it was, complex modes with their phases."""
    path = folder / kept.NAME
    try:
        found = kept.read(path)
    except BadInput as error:
        raise BadInput(error.problem, file=str(path)) from error
    if found.surface is None or found.diagram is None or found.theory is None:
        raise _no_plate(folder)
    known = (("mesh", found.diagram.mesh), ("theory", found.theory.name))
    return of_plate(found.scene, found.surface, found.speeds, known)


def _no_plate(folder: Path) -> BadInput:
    return BadInput("holds results without a plate: there is no shape to show", file=str(folder))


def _of_files(folder: Path) -> Sight:
    """Of the files that other programs read; `modes.vtu` has the part of complex modes that is in phase."""
    found = _document(folder)
    points = _points(found["speeds"])
    surface = _surface(folder, points)
    scene = found["scene"]
    plate, damper = scene["plate"], scene.get("damper")
    mark = None
    if damper is not None:
        x, y = damper.get("at") or plate_mesh.tip(surface.points.T[:2])
        mark = (float(x), float(y))
    thickness = plate["thickness"]
    words, numbers = facts(surface)
    if any("damping_ratio" in mode for speed in found["speeds"] for mode in speed["modes"]):
        words = (*words, ("shapes", f"without {kept.NAME} only what swings in phase: the modes are complex"))
    return Sight(
        title=str(found["title"]),
        surface=surface,
        speeds=points,
        mark=mark,
        thickness=float(thickness) if isinstance(thickness, int | float) else None,
        root="root on springs" if plate.get("root") else "clamped root",
        facts=words,
        numbers=numbers,
    )


def _document(folder: Path) -> dict[str, Any]:
    path = folder / "results.json"
    if not path.is_file():
        problem = "holds no results.json: expected a folder that a run of spindamp has written"
        raise BadInput(problem, file=str(folder))
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(found, dict) or "speeds" not in found or "scene" not in found:
            raise ValueError
    except (OSError, ValueError) as error:
        raise BadInput("is no results.json of spindamp, or is damaged", file=str(path)) from error
    if "plate" not in found["scene"] or not (folder / "modes.vtu").is_file():
        raise _no_plate(folder)
    return found


def _points(speeds: list[dict[str, Any]]) -> tuple[SpeedPoint, ...]:
    """The speeds' modes; a mode goes on at other speeds as the one of the same number in its family."""
    branches: dict[tuple[str, int], int] = {}
    return tuple(_point(speed, branches) for speed in speeds)


def _point(speed: dict[str, Any], branches: dict[tuple[str, int], int]) -> SpeedPoint:
    rpm, families = float(speed["rpm"]), [str(mode["family"]) for mode in speed["modes"]]
    modes = []
    for k, mode in enumerate(speed["modes"]):
        name = (families[k], families[:k].count(families[k]))
        branch = branches.setdefault(name, len(branches))
        modes.append(Mode(float(mode["frequency_hz"]), families[k], branch=branch))
    return SpeedPoint(rpm * np.pi / 30, rpm, 0.0, float(speed["load_g"] or 0.0), tuple(modes))


def _surface(folder: Path, points: tuple[SpeedPoint, ...]) -> Surface:
    import meshio
    from skfem import MeshQuad, MeshTri

    path = folder / "modes.vtu"
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            file = meshio.read(path)
        cells = file.cells[0]
        kind = MeshQuad if cells.type == "quad" else MeshTri
        mesh = kind(np.ascontiguousarray(file.points[:, :2].T, dtype=float), np.ascontiguousarray(cells.data.T))
        surface = bare(mesh)
    except (Exception, SystemExit) as error:  # whatever a damaged file makes the reader stumble over
        problem = f"is no modes.vtu of spindamp, or is damaged ({type(error).__name__})"
        raise BadInput(problem, file=str(path)) from error
    names = [[f"mode_{k + 1}_at_{p.rpm:.13g}_rpm" for k in range(len(p.modes))] for p in points]
    kept = tuple(row for row, of_speed in enumerate(names) if of_speed and all(n in file.point_data for n in of_speed))
    if not kept:
        return replace(surface, thickness=file.point_data.get("thickness"))
    count = min(len(names[row]) for row in kept)
    shapes = np.array([[file.point_data[name] for name in names[row][:count]] for row in kept], dtype=float)
    return replace(surface, shapes=shapes, at=kept, thickness=file.point_data.get("thickness"))
