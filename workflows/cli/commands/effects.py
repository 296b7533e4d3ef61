"""`spindamp effects`: what each effect changes, and what it costs."""

from __future__ import annotations

from workflows.cli.commands.options import Json, Out, SceneArgument


def effects(scene: SceneArgument = "paper", out: Out = None, json: Json = False) -> None:
    """What each effect changes, and what it costs.

    Without --out nothing is written.
    """
    from workflows.cli.commands import costly
    from workflows.studies.work_precision import report
    from workflows.studies.work_precision.effects import switching

    files = r"effects\.(json|csv|svg)"
    found, text = costly.complete(scene, out, files, switching, report.write_effects, report.effects_text)
    costly.say(found, text, as_json=json)
