"""The page of a sight: the viewer, a still picture beneath it, and what was understood."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from workflows import wording
from workflows.looking.sight import Sight
from workflows.report import figures, mode_viewer, plots, templating

_ROOM = mode_viewer.Room(12_000, 600_000)
"""What a page of its own has room for."""


def view(sight: Sight, first: int = 0, mode: int = 0) -> mode_viewer.View:
    """The viewer's data, that shows a mode (from 0) at a speed of the run first."""
    return mode_viewer.of_surface(sight.surface, sight.speeds, sight.mark, sight.thickness, (first, mode), _ROOM)


def page(sight: Sight, first: int = 0, mode: int = 0) -> str:
    """The page as text."""
    from markupsafe import Markup

    seen = view(sight, first, mode)
    with plots.style():
        figure = figures.mesh_of(sight.surface, sight.mark, sight.root)
        still = plots.svg(figure, "mesh", figures.SHOWN["mesh"])
    words: dict[str, Callable[..., str]] = {"curly": wording.curly, "whole": wording.whole}
    return templating.page(
        "view.html.j2", words, sight=sight, view=seen, still=Markup(still), script=templating.script("viewer.js")
    )


def thinned(seen: mode_viewer.View) -> str:
    """What to say where points were left out; nothing where none were."""
    if not seen.thinned:
        return ""
    return (
        f"drawn with {wording.whole(seen.points)} of {wording.whole(seen.of)} points, the boundary's corners all kept"
    )


def write(sight: Sight, path: Path, first: int = 0, mode: int = 0) -> Path:
    """Put the page into a file, whole or not at all, and return the file.

    Raises:
        BadInput: it cannot be written.
    """
    from workflows.report.page import put

    return put(path, page(sight, first, mode), "--out")
