"""Writing a run: every file of a result folder, or none; or the report alone."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from workflows.errors import BadInput
from workflows.output import store
from workflows.progress import Stages
from workflows.report import page as report
from workflows.report.brief import shown
from workflows.report.mode_shape import Artist
from workflows.results import curves, kept
from workflows.results import document as results_json
from workflows.results import files as results_files
from workflows.solve import records
from workflows.solve.records import Results, expect


def save(results: Results, folder: str | os.PathLike[str]) -> Path:
    """Write all that `spindamp run` writes into a folder, which is replaced whole or not at all; returns the folder.

    Raises:
        BadInput: the folder cannot be written, or holds what is not ours.
        TypeError: not results, or not a folder's name.
    """
    expect(results, "save")
    out = _path("save", "folder", folder)
    try:
        target = store.check(out, curves.FILES)
        with artist(results) as drawing:
            publish(results, out, Stages(visible=False, spent=results.timings), drawing)
    except BadInput as error:
        raise BadInput(error.problem, key="folder", value=str(out)) from error
    return target


def save_report(results: Results, path: str | os.PathLike[str]) -> Path:
    """Write the report alone, a page without outside parts, into a file, which is replaced; returns the file.

    Raises:
        BadInput: the file cannot be written.
        TypeError: not results, or not a file's name.
    """
    expect(results, "save_report")
    _path("save_report", "file", path)
    writable(path)
    with artist(results) as drawing:
        drawings = _drawn(results, drawing)
    return put(path, report.render(results, drawings))


def put(path: str | os.PathLike[str], text: str, key: str = "path") -> Path:
    """Put a text in the place of a file, whole or not at all; returns the file, resolved.

    Raises:
        BadInput: it cannot be written; `key` is what named it.
    """
    out = writable(path, key)
    try:
        _replace(out, text)
    except OSError as error:
        raise BadInput(f"cannot be written: {error.strerror or error}", key=key, value=str(path)) from error
    return out


def load_results(folder: str | os.PathLike[str]) -> Results:
    """What `spindamp run --out` or `save` wrote into a folder, as it was when it was written.

    Raises:
        BadInput: there is no run of ours.
        TypeError: not the name of a folder.
    """
    return shown(kept.read(folder))


@contextmanager
def artist(results: Results) -> Iterator[Artist | None]:
    """Who draws the first mode at the speed shown, where there is a plate."""
    if results.surface is None:
        yield None
        return
    with Artist() as drawing:
        drawing.draw(results.surface, records.shown(results.speeds))
        yield drawing


def _drawn(results: Results, artist: Artist | None) -> report.Drawings:
    """The pictures of a report; the artist is asked last, who draws in a process of its own meanwhile."""
    drawings = report.draw(results)
    return drawings if artist is None else replace(drawings, shape=artist.picture())


def _path(who: str, what: str, given: object) -> Path:
    if not isinstance(given, str | os.PathLike):
        raise TypeError(f"{who} takes the name of a {what} second, got {type(given).__name__}")
    return Path(given)


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
    return target


def _replace(path: Path, text: str) -> None:
    """Put a text in the place of a file, whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(f".{path.name[:80]}.{secrets.token_hex(8)}")
    try:
        fresh.write_text(text, encoding="utf-8")
        os.replace(fresh, path)
    finally:
        fresh.unlink(missing_ok=True)


def publish(results: Results, out: Path, stages: Stages, artist: Artist | None = None) -> Results:
    """Write a run into `out` and return it with its final times.

    Raises:
        BadInput: `out` cannot be written.
    """
    with store.replacing(out) as folder:
        with stages("write"):
            results_files.write_csv(results, folder)
            results_files.write_netcdf(results, folder / "results.nc")
            if results.surface is not None:
                results_files.write_vtu(results.surface, results, folder / "modes.vtu")
        with stages("report"):
            drawings = _drawn(results, artist)
        # The times of the last two files cannot stand in them: they are left out, some hundredths of a second.
        finished = replace(results, timings=stages.timings())
        (folder / "report.html").write_text(report.render(finished, drawings), encoding="utf-8")
        kept.write(finished, folder / kept.NAME)
        (folder / "results.json").write_text(results_json.dumps(finished) + "\n", encoding="utf-8")
    return finished
