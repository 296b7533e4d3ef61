"""`spindamp ringdown`: the damper only, at one speed."""

from __future__ import annotations

from typing import Annotated

import typer

from workflows.cli.commands.options import Json, Out, SceneArgument


def ringdown(
    scene: SceneArgument = "paper",
    rpm: Annotated[float | None, typer.Option("--rpm", help="Rotation speed; default: the scene's middle one.")] = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """The damper only, at one speed.

    Without --out nothing is written.
    """
    from workflows import pipeline
    from workflows.cli.commands.finish import complete
    from workflows.scene import load as scene_file

    complete(pipeline.at_one_speed(scene_file.load(scene), rpm), out, json)
