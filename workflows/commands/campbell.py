"""`spindamp campbell`: the plate only."""

from __future__ import annotations

from workflows.commands.options import Json, Out, SceneArgument


def campbell(scene: SceneArgument = "paper", out: Out = None, json: Json = False) -> None:
    """The plate only: frequencies over speed.

    Without --out nothing is written.
    """
    from workflows import parts, scene_file
    from workflows.commands.finish import complete

    complete(parts.plate_only(scene_file.load(scene)), out, json)
