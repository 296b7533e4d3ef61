"""`spindamp campbell`: the plate only."""

from __future__ import annotations

from workflows.commands.options import Json, Out, SceneArgument


def campbell(scene: SceneArgument = "paper", out: Out = None, json: Json = False) -> None:
    """The plate only: frequencies over speed.

    Without --out nothing is written.
    """
    from workflows import scene_file
    from workflows.commands.finish import complete
    from workflows.errors import BadInput

    source = scene_file.load(scene)
    if source.scene.plate is None:
        raise BadInput("the table is missing: campbell needs a plate", file=source.name, key="[plate]")
    complete(source.plate_alone(), out, json)
