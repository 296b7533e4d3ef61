"""The report: one self-contained HTML page for a person; and writing a run, every file of its folder or none."""

from __future__ import annotations

import base64
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from workflows.errors import BadInput, present
from workflows.io import files, provenance, serialise
from workflows.io.folder import check, put, replacing, writable
from workflows.progress import Stages
from workflows.report import figures, mode_viewer, plots, remarks, verdict
from workflows.report.templates import from_template
from workflows.report.text import shown
from workflows.scene import paper
from workflows.solve.results import BallPath, Floats, Results, middle_speed, require_results
from workflows.versions import versions

_WORDS = {"start": "sets off", "reversal": "turns back", "hit": "hits the wall", "grip": "rolls without slip again"}
"""Kinds of event that are told; the release and the rubbing that belongs to a hit are not."""

_STOPS = {"reversal": "comes to rest", "hit": "hits the wall and stays"}
"""The same where the ball rests in the cavity afterwards."""


def data(results: Results) -> str:
    """The player's data as JSON that may stand in a page; nothing where no ball moved."""
    shown_path, spec = figures.path_shown(results), results.scene.damper
    if shown_path is None or spec is None:
        return ""
    path, point = shown_path
    begin = float(path.t[0])
    content: dict[str, Any] = {
        "begin": 1e3 * begin,
        "t": mode_viewer.base64_of((1e3 * (path.t - begin)).astype("<f4")),
        "frequency": 1e-3 * present(point.reduced).f1_hz,
        "radius": 1e3 * spec.radius,
        "ball": _packed(path.ball),
        "structure": _packed(path.structure),
        "moving": [files.moving_axes(path.ball), files.moving_axes(path.structure)],
        "regime": "".join(str(3 * a + b) for a, b in path.regime.tolist()),
        "events": events(path),
    }
    return mode_viewer.for_a_page(content)


def events(path: BallPath) -> list[tuple[int, str, int]]:
    """What happens: at which time of the path, in words, along which axis (1 or 2)."""
    rows = []
    for at, kind, axis in zip(path.at.tolist(), path.kind, path.axis.tolist(), strict=True):
        words = _STOPS if path.regime[at, axis] == 0 and kind in _STOPS else _WORDS
        if kind in words:
            rows.append((at, words[kind], axis + 1))
    return rows


def _packed(motion: Floats) -> dict[str, Any]:
    """Places (n, 2) in mm as 16-bit integers of the largest, one axis after the other."""
    largest = float(np.abs(motion).max())
    return {"largest": 1e3 * largest, "places": mode_viewer.shorts(motion.T, largest)}


def draw(results: Results) -> dict[str, Any]:
    """What the page shows that takes time to make, by the names of its template: figures, a mode still and in motion.

    Figures are SVG elements, empty for nothing to draw; the still picture is a PNG in base64.
    """
    surface, shape = results.surface, None
    with plots.style():
        drawn = figures.report(results)
        if surface is not None:
            picture = figures.mode_picture(surface, surface.row(middle_speed(results.speeds)), 1)
            shape = base64.b64encode(picture).decode()
    drawn["playing"] = data(results) if drawn["path"] else ""
    css = plots.shades_css(len(results.speeds))
    return {**drawn, "shape": shape, "view": mode_viewer.view(results), "css": css}


def render(results: Results, drawings: dict[str, Any]) -> str:
    """The page, whose template asks for what it shows. Everything that comes from a scene is escaped."""
    modules = (figures, paper, provenance, remarks, verdict)
    known: dict[str, Any] = {each.__name__.rpartition(".")[2]: each for each in modules}
    return from_template(
        "report.html.j2",
        results=results,
        versions=versions(),
        tilts=any(p.damping_curve and p.damping_curve.tilted_cutoff_ratio is not None for p in results.speeds),
        fast=any(figures.is_fast(track) for p in results.speeds for track in files.velocity(p)),
        bands=any(figures.is_band(p.damper.sdc) for p in results.speeds if p.damper),
        shown=next((p for p in results.speeds if p.damper and p.damper.history), None),
        shape_point=results.speeds[middle_speed(results.speeds)],
        **known | drawings,
    )


def save(results: Results, folder: str | os.PathLike[str]) -> Path:
    """Write all that `spindamp run` writes into a folder, which is replaced whole or not at all; returns the folder.

    Raises:
        BadInput: the folder cannot be written, or holds what is not ours.
        TypeError: not results, or not a folder's name.
    """
    require_results(results, "save")
    out = _path("save", "folder", folder)
    try:
        target = check(out, files.FILES)
        publish(results, out, Stages(visible=False, spent=results.timings))
    except BadInput as error:
        raise BadInput(error.problem, key="folder", value=str(out)) from error
    return target


def save_report(results: Results, path: str | os.PathLike[str]) -> Path:
    """Write the report alone, a page without outside parts, into a file, which is replaced; returns the file.

    Raises:
        BadInput: the file cannot be written.
        TypeError: not results, or not a file's name.
    """
    require_results(results, "save_report")
    _path("save_report", "file", path)
    writable(path)
    return put(path, lambda fresh: fresh.write_text(render(results, draw(results)), encoding="utf-8"))


def load_results(folder: str | os.PathLike[str]) -> Results:
    """What `spindamp run --out` or `save` wrote into a folder, as it was when it was written.

    Raises:
        BadInput: the folder has no run.
        TypeError: not the name of a folder.
    """
    return shown(serialise.read(folder))


def _path(who: str, what: str, value: object) -> Path:
    if not isinstance(value, str | os.PathLike):
        raise TypeError(f"{who} takes the name of a {what} second, got {type(value).__name__}")
    return Path(value)


def publish(results: Results, out: Path, stages: Stages) -> Results:
    """Write a run into `out` and return it with its final times.

    Raises:
        BadInput: `out` cannot be written.
    """
    with replacing(out) as folder:
        with stages("write"):
            files.write_data(results, folder)
            if results.surface is not None:
                files.write_vtu(results.surface, results, folder / "modes.vtu")
        with stages("report"):
            drawings = draw(results)
        # The times of the last two files cannot stand in them: they are left out, some hundredths of a second.
        finished = replace(results, timings=stages.timings())
        (folder / "report.html").write_text(render(finished, drawings), encoding="utf-8")
        (folder / "results.json").write_text(serialise.dumps(finished) + "\n", encoding="utf-8")
    return finished
