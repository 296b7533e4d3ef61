"""`spindamp response`: forced response through the crossings of engine orders and modes, without and with the ball."""

from __future__ import annotations

import typer

from workflows.cli.commands.options import Json, Out, SceneArgument


def response(scene: SceneArgument = "paper", out: Out = None, json: Json = False) -> None:
    """Forced response where engine orders cross modes, without and with the ball.

    Takes the forces from the scene's table [excitation]. Without --out nothing is written.
    """
    from workflows.cli.commands import kernels
    from workflows.output import folder
    from workflows.progress import Stages
    from workflows.scene import load as scene_file
    from workflows.studies.response import report
    from workflows.studies.response.study import respond

    source = scene_file.load(scene)
    if source.scene.damper is not None:
        kernels.say()
    if out is not None:
        folder.check(out, report.FILES)
    with Stages() as stages:
        found = respond(source, stages)
        if out is not None:
            report.write(found, out)
    if json:
        typer.echo(report.dumps(found))
        return
    typer.echo(report.text(found))
    if out is not None:
        typer.echo(f"\nopen {out / 'report.html'}")
