"""`spindamp run`: the main job."""

from __future__ import annotations

from pathlib import Path

from workflows.cli.commands.options import Json, Out, SceneArgument


def run(scene: SceneArgument = "paper", out: Out = None, json: Json = False) -> None:
    """Plate at every speed, damper, results and report.

    Without --out the folder is named after the scene's title; with --json and no --out nothing is written.
    """
    from workflows.cli.commands.finish import complete
    from workflows.scene import load as scene_file

    source = scene_file.load(scene)
    if out is None and not json:
        out = Path(f"spindamp-{scene_file.slug(source.scene.title)}")
    complete(source, out, json)
