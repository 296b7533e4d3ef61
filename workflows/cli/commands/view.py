"""`spindamp view`: mesh, clamped root, damper's place, modes in motion."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from workflows.cli.commands.options import Json


def view(
    what: Annotated[
        str, typer.Argument(metavar="DIR|SCENE|MESH", help="A folder of results, a scene, or a mesh file.")
    ] = "paper",
    rpm: Annotated[float | None, typer.Option("--rpm", help="Rotation speed; default: the middle one.")] = None,
    mode: Annotated[int, typer.Option("--mode", help="Number of the mode that is shown first.")] = 1,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="Write a page instead of opening a window.")
    ] = None,
    json: Json = False,
) -> None:
    """Look at mesh, clamped root, damper's place and modes in motion.

    In a window where there is a screen, else as a page, whose name is printed.
    """
    from workflows.looking import view_data, window
    from workflows.scene.load import slug

    if out is not None:
        _check(out)
    found = view_data.of(what, rpm)
    first, number = view_data.chosen(found, rpm, mode)
    if json:
        from json import dumps

        if out is not None:
            window.write(found, out, first, number)
        typer.echo(dumps({"title": found.title, **found.numbers}, indent=1, allow_nan=False))
        return
    for name, words in found.facts:
        typer.echo(f"{name:<14} {words}")
    if out is None and window.there_is() and window.shown(found, first, number, found.title):
        return
    if said := window.thinned(window.view(found, first, number)):
        typer.echo(said)
    path = out or Path(f"spindamp-view-{slug(found.title)}.html")
    window.write(found, path, first, number)
    typer.echo(f"\nopen {path}")


def _check(out: Path) -> None:
    """A page's name, in a folder that is there, before anything is solved."""
    from workflows.errors import BadInput
    from workflows.report.page import writable

    target = writable(out, "--out")
    if target.suffix.lower() != ".html":
        raise BadInput("a page is written: expected a name that ends in .html", key="--out", value=str(out))
    if not target.parent.is_dir():
        raise BadInput("no such folder: expected a file in one that is there", key="--out", value=str(out))
