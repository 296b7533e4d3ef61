"""`spindamp accuracy`: what accuracy costs in time."""

from __future__ import annotations

import typer

from workflows.cli.commands.options import Json, Out, SceneArgument


def accuracy(scene: SceneArgument = "paper", out: Out = None, json: Json = False) -> None:
    """What accuracy costs in time, as a table and as plots.

    Without --out nothing is written.
    """
    from workflows.cli.commands import kernels
    from workflows.output import store
    from workflows.scene import file as scene_file
    from workflows.stages import Stages
    from workflows.studies.costs import page
    from workflows.studies.costs.study import study

    source = scene_file.load(scene)
    if source.scene.damper is not None:
        kernels.say()
    if out is not None:
        store.check(out, r"accuracy\.(json|csv|svg)")
    with Stages() as stages:
        found = study(source, stages)
        if out is not None:
            page.write_accuracy(found, out)
    if json:
        typer.echo(page.dumps(found.document()))
        return
    typer.echo(page.accuracy_text(found))
    if out is not None:
        typer.echo(f"\nopen {out / 'report.html'}")
