"""What accuracy and effects have in common: a study of one scene, written as a page, said as text or JSON."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol, TypeVar

import typer

from workflows.cli.commands import kernels
from workflows.output import folder
from workflows.progress import Stages
from workflows.scene import load as scene_file
from workflows.scene.load import SceneFile


class Found(Protocol):
    """What a study found."""

    def document(self) -> dict[str, Any]:
        """The machine-readable result."""


F = TypeVar("F", bound=Found)


def complete(
    scene: str,
    out: Path | None,
    files: str,
    solve: Callable[[SceneFile, Stages], F],
    write: Callable[[F, Path], object],
    text: Callable[[F], str],
) -> tuple[F, str]:
    """Solve, and write into `out` if there is one; what was found, and what a person reads of it.

    `files`: names of what is written besides the page, as a regular expression.
    """
    source = scene_file.load(scene)
    if source.scene.damper is not None:
        kernels.say()
    if out is not None:
        folder.check(out, files)
    with Stages() as stages:
        found = solve(source, stages)
        if out is not None:
            write(found, out)
    there = "" if out is None else f"\nopen {out / 'report.html'}"
    return found, text(found) + there


def say(found: Found, text: str, *, as_json: bool) -> None:
    """Print what was found."""
    from workflows.studies.work_precision import report

    typer.echo(report.dumps(found.document()) if as_json else text)
