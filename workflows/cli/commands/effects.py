"""`spindamp effects`: what each effect changes, and what it costs."""

from __future__ import annotations

from workflows.cli.commands.options import Json, Out, SceneArgument


def effects(scene: SceneArgument = "paper", out: Out = None, json: Json = False) -> None:
    """What each effect changes, and what it costs.

    Without --out nothing is written.
    """
    from workflows.cli.commands import costly
    from workflows.studies.costs import page
    from workflows.studies.costs.switching import switching

    files = r"effects\.(json|csv|svg)"
    found, text = costly.complete(scene, out, files, switching, page.write_effects, page.effects_text)
    costly.say(found, text, as_json=json)
