"""`spindamp accuracy`: what accuracy costs in time."""

from __future__ import annotations

from workflows.cli.commands.options import Json, Out, SceneArgument


def accuracy(scene: SceneArgument = "paper", out: Out = None, json: Json = False) -> None:
    """What accuracy costs in time, as a table and as plots.

    Without --out nothing is written.
    """
    from workflows.cli.commands import costly
    from workflows.studies.work_precision import report
    from workflows.studies.work_precision.study import study

    files = r"accuracy\.(json|csv|svg)"
    found, text = costly.complete(scene, out, files, study, report.write_accuracy, report.accuracy_text)
    costly.say(found, text, as_json=json)
