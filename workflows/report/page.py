"""The report: one self-contained HTML page for a person; and writing a run, every file of its folder or none."""

from __future__ import annotations

import base64
import json
import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from workflows.errors import BadInput
from workflows.io import files, provenance, serialise
from workflows.io.folder import check, replacing, replacing_file, unwritable
from workflows.progress import Stages
from workflows.report import figures, mode_viewer, plots, remarks, verdict
from workflows.report.templates import from_template, script
from workflows.report.text import shown
from workflows.scene import paper
from workflows.solve import limits
from workflows.solve.results import BallPath, Floats, Results, SpeedPoint, middle_speed, require_results
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
        "frequency": 1e-3 * figures.frequency(point),
        "radius": 1e3 * spec.radius,
        "ball": _packed(path.ball),
        "structure": _packed(path.structure),
        "moving": [files.moving_axes(path.ball), files.moving_axes(path.structure)],
        "regime": "".join(str(3 * a + b) for a, b in path.regime.tolist()),
        "events": events(path),
    }
    return json.dumps(content, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


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


_MODES_AT_MOST = 7
"""Columns of the table of a plate without a damper."""


@dataclass(frozen=True)
class Drawings:
    """The pictures of a report: SVG elements by name (empty for nothing to draw), a mode as PNG and in motion."""

    figures: dict[str, str]
    css: str
    shape: bytes | None
    view: mode_viewer.View | None


def draw(results: Results) -> Drawings:
    """Make the figures; the slow part of a report."""
    surface, css = results.surface, plots.shades_css(len(results.speeds))
    with plots.style():
        drawn = figures.report(results)
        shape = None if surface is None else figures.mode_picture(surface, surface.row(middle_speed(results.speeds)), 1)
    return Drawings(drawn, css, shape, mode_viewer.view(results))


def render(results: Results, drawings: Drawings) -> str:
    """The page. Everything that comes from a scene is escaped."""
    shape, answer = drawings.shape, verdict.answer(results)
    return from_template(
        "report.html.j2",
        drawings.css,
        results=results,
        scene=results.scene,
        answer=answer,
        notes=answer.besides(results.notes),
        followed=verdict.followed_mode(results),
        held=figures.held(results.scene) if results.surface is None or len(results.surface.root) else "",
        carrier=remarks.carrier(results.scene),
        assumptions=remarks.assumptions(results),
        versions=versions(),
        hashes=provenance.hashes(results),
        toml=provenance.as_toml(results.scene, results.effects, results.theory),
        rows=[_row(results, point) for point in results.speeds],
        errors=remarks.worst(results),
        error_parts=remarks.PARTS,
        mode_columns=min(len(results.speeds[0].modes), _MODES_AT_MOST),
        tilts=any(p.damping_curve and p.damping_curve.tilted_cutoff_ratio is not None for p in results.speeds),
        first_notes=remarks.FIRST,
        has_table=any(paper.row(results.scene, p.load_g) for p in results.speeds),
        air=limits.AIR,
        endured=limits.endured(results),
        beyond=remarks.beyond_of(results),
        marks=remarks.legend(results, cutoffs=False),
        at_rest=remarks.legend(results, damping=False),
        cells_drawn=results.surface is not None and figures.cells_are_drawn(results.surface),
        fast=any(figures.is_fast(track) for p in results.speeds for track in files.velocity(p)),
        bands=any(figures.is_band(p.damper.sdc) for p in results.speeds if p.damper),
        shown=next((p for p in results.speeds if p.damper and p.damper.history), None),
        playing=data(results) if drawings.figures["path"] else "",
        playing_script=script("player.js"),
        way_shown=figures.path_shown(results),
        shape=None if shape is None else base64.b64encode(shape).decode(),
        shape_point=results.speeds[middle_speed(results.speeds)] if results.surface is not None else None,
        view=drawings.view,
        script=script("viewer.js"),
        **drawings.figures,
    )


def _row(results: Results, point: SpeedPoint) -> dict[str, Any]:
    """A line of the tables."""
    return {
        "point": point,
        "frequency": verdict.first_frequency(point),
        "paper": paper.row(results.scene, point.load_g),
        "mark": remarks.mark(results, point),
        "cutoff": limits.cutoff(results, point),
        "cutoff_mark": remarks.cutoff_mark(results, point),
        "share": limits.energy_loss(point.damping_curve.peak) if point.damping_curve else 0.0,
        "damper": point.damper,
        "lost": None if point.damper is None else remarks.lost_at_most(point.damper),
    }


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
    return put(path, render(results, draw(results)))


def put(path: str | os.PathLike[str], text: str, key: str = "path") -> Path:
    """Put a text in the place of a file, whole or not at all; returns the file, resolved.

    Raises:
        BadInput: it cannot be written; `key` is what named it.
    """
    out = writable(path, key)
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        with replacing_file(out) as fresh:
            fresh.write_text(text, encoding="utf-8")
    except OSError as error:
        raise BadInput(f"cannot be written: {error.strerror or error}", key=key, value=str(path)) from error
    return out


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


def writable(path: str | os.PathLike[str], key: str = "path") -> Path:
    """The path of a file, resolved; BadInput where there can be none."""
    try:
        target = Path(path).resolve()
        taken, special = target.is_dir(), target.exists() and not target.is_file()
    except (OSError, ValueError, RuntimeError) as error:  # RuntimeError: a loop of links
        problem = f"cannot be a file: {getattr(error, 'strerror', None) or error}"
        raise BadInput(problem, key=key, value=str(path)) from error
    if taken or os.fspath(path).endswith(("/", os.sep)):
        raise BadInput("is a folder: expected a file, such as 'report.html'", key=key, value=str(path))
    if special:
        raise BadInput(
            "is no file that could be replaced: expected one such as 'report.html'", key=key, value=str(path)
        )
    if (why := unwritable(target)) is not None:
        raise BadInput(why, key=key, value=str(path))
    return target


def publish(results: Results, out: Path, stages: Stages) -> Results:
    """Write a run into `out` and return it with its final times.

    Raises:
        BadInput: `out` cannot be written.
    """
    with replacing(out) as folder:
        with stages("write"):
            files.write_csv(results, folder)
            files.write_netcdf(results, folder / "results.nc")
            if results.surface is not None:
                files.write_vtu(results.surface, results, folder / "modes.vtu")
        with stages("report"):
            drawings = draw(results)
        # The times of the last two files cannot stand in them: they are left out, some hundredths of a second.
        finished = replace(results, timings=stages.timings())
        (folder / "report.html").write_text(render(finished, drawings), encoding="utf-8")
        (folder / "results.json").write_text(serialise.dumps(finished) + "\n", encoding="utf-8")
    return finished
