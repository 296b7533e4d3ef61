"""What run, campbell and ringdown have in common: solve, write, say what was found."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import typer

from workflows import pipeline
from workflows.cli.commands import kernels
from workflows.findings.remarks import remarked
from workflows.output import folder
from workflows.progress import Stages
from workflows.report import text as summary
from workflows.report.mode_viewer import Artist
from workflows.results import files
from workflows.results import serialise as results_json
from workflows.scene.load import SceneFile
from workflows.solve import resources
from workflows.solve import results as records


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
        state = pipeline.structure(source, stages, shapes=drawn)
        if artist is not None and state.surface is not None:
            artist.draw(state.surface, records.shown(state.points))
        results = remarked(pipeline.results(pipeline.damped(state, stages), stages))
        if out is not None:
            from workflows.report.page import publish

            results = publish(results, out, stages, artist)
    typer.echo(results_json.dumps(results) if as_json else summary.text(results, out, source.remarks))
