"""A run as Python calls it: results that show themselves."""

from __future__ import annotations

from workflows import pipeline
from workflows.errors import lawful
from workflows.findings.remarks import remarked
from workflows.progress import Stages
from workflows.report.text import Shown, shown
from workflows.scene.load import DEFAULT, SceneLike


@lawful()
def run(scene: SceneLike = DEFAULT, stages: Stages | None = None) -> Shown:
    """The whole of a run with its remarks, nothing written.

    Args:
        scene: the name of a shipped scene, the path of a file, a dict, a Scene or what `load` returns.
        stages: the clock to go by, if not one of its own.

    Raises:
        ImpossibleResult: a figure violates a law of physics.
        BadInput, NoAnswer, TypeError: see :func:`workflows.pipeline.run`.
    """
    return shown(remarked(pipeline.run(scene, stages)))
