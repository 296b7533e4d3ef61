"""`spindamp campbell`: the plate only."""

from __future__ import annotations

from workflows.cli.commands.options import Json, Out, SceneArgument


def campbell(scene: SceneArgument = "paper", out: Out = None, json: Json = False) -> None:
    """The plate only: frequencies over speed.

    Without --out nothing is written.
    """
    from workflows import pipeline
    from workflows.cli.commands.finish import complete
    from workflows.scene import load as scene_file

    complete(pipeline.plate_only(scene_file.load(scene)), out, json)
