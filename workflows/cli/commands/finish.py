"""What run, campbell and ringdown have in common: solve, write, say what was found."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import typer

from workflows import pipeline
from workflows.cli.commands import kernels
from workflows.output import folder
from workflows.progress import Stages
from workflows.report import text as summary
from workflows.report.mode_viewer import Artist
from workflows.results import files, serialise
from workflows.scene.load import SceneFile
from workflows.solve import resources
from workflows.solve.model_choice import decide
from workflows.solve.results import middle


def complete(source: SceneFile, out: Path | None, as_json: bool) -> None:
    """Run a scene, write it to `out` if there is one, and print the result."""
    resources.check(source)
    if out is not None:
        folder.check(out, files.FILES)
    if source.scene.damper is not None:
        kernels.say()
    with ExitStack() as stack:
        stages = stack.enter_context(Stages())
        drawn = out is not None and source.scene.plate is not None
        artist = stack.enter_context(Artist()) if drawn else None
        decided = decide(source, stages)
        found = pipeline.structure(source, stages, shapes=drawn, decided=decided)
        if artist is not None and found.plate is not None and found.plate.surface is not None:
            artist.draw(found.plate.surface, middle(found.points))
        results = pipeline.results(pipeline.damped(found, stages), stages)
        if out is not None:
            from workflows.report.page import publish

            results = publish(results, out, stages, artist)
    typer.echo(serialise.dumps(results) if as_json else summary.text(results, out, source.remarks))
