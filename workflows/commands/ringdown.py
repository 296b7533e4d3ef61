"""`spindamp ringdown`: the damper only, at one speed."""

from __future__ import annotations

import math
from typing import Annotated

import typer

from workflows.commands.options import Json, Out, SceneArgument
from workflows.wording import whole


def ringdown(
    scene: SceneArgument = "paper",
    rpm: Annotated[float | None, typer.Option("--rpm", help="Rotation speed; default: the scene's middle one.")] = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """The damper only, at one speed.

    Without --out nothing is written.
    """
    from workflows import scene_file
    from workflows.commands.finish import complete
    from workflows.errors import BadInput
    from workflows.scene_fields import FASTEST

    source = scene_file.load(scene)
    if source.scene.damper is None:
        raise BadInput("the table is missing: ringdown needs a damper", file=source.name, key="[damper]")
    speeds = sorted(source.scene.rotor.speeds)
    omega = speeds[(len(speeds) - 1) // 2]
    if rpm is not None:
        omega = rpm * math.pi / 30
        if not 0 <= omega <= FASTEST:
            most = FASTEST * 30 / math.pi
            raise BadInput(f"expected a rotation speed between 0 and {whole(most)} rpm", key="--rpm", value=rpm)
    rotor = source.scene.rotor.model_copy(update={"speeds": (omega,)})
    complete(source.changed(rotor=rotor), out, json)
