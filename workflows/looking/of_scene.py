"""A scene to look at: its plate, solved at every speed or at one."""

from __future__ import annotations

import math

from workflows import pipeline
from workflows.errors import BadInput
from workflows.looking.sight import Sight, of_plate
from workflows.progress import Stages
from workflows.scene import file as scene_file
from workflows.scene.source import SceneFile
from workflows.scene.speeds import FASTEST, typed
from workflows.solve import resources
from workflows.wording import whole


def sight(scene: str, rpm: float | None) -> Sight:
    """The plate of a scene with its modes.

    Raises:
        BadInput, NoAnswer: as a run of it would; also where it has no plate.
    """
    source = scene_file.load(scene)
    if source.scene.plate is None:
        raise BadInput("the table is missing: view needs a plate", file=source.name, key="[plate]")
    if rpm is not None:
        source = _at(source, rpm)
    resources.check(source)
    with Stages() as stages:
        found = pipeline.structure(source, stages)
    if found.plate is None or found.plate.surface is None:
        raise ValueError("a plate was solved without its surface")
    known = (("mesh", found.plate.diagram.mesh), ("theory", found.plate.theory.name))
    return of_plate(source.scene, found.plate.surface, found.points, known)


def _at(source: SceneFile, rpm: float) -> SceneFile:
    omega = rpm * math.pi / 30
    if not 0 <= omega <= FASTEST:
        most = whole(FASTEST * 30 / math.pi)
        raise BadInput(f"expected a rotation speed between 0 and {most} rpm", key="--rpm", value=typed(rpm))
    return source.changed(rotor=source.scene.rotor.model_copy(update={"speeds": (omega,)}))
