"""Parts of a scene that are solved by themselves: the plate at every speed, the damper at one."""

from __future__ import annotations

import math

from workflows.errors import BadInput
from workflows.scene.source import SceneFile
from workflows.scene.speeds import FASTEST, typed
from workflows.wording import whole


def plate_only(source: SceneFile) -> SceneFile:
    """The scene without its damper.

    Raises:
        BadInput: it has no plate.
    """
    if source.scene.plate is None:
        raise BadInput("the table is missing: campbell needs a plate", file=source.name, key="[plate]")
    return source.plate_alone()


def at_one_speed(source: SceneFile, rpm: float | None = None) -> SceneFile:
    """The scene at one speed [rev/min]; by default its middle one.

    Raises:
        BadInput: it has no damper, or nothing spins so fast.
    """
    if source.scene.damper is None:
        raise BadInput("the table is missing: ringdown needs a damper", file=source.name, key="[damper]")
    speeds = sorted(source.scene.rotor.speeds)
    omega = speeds[(len(speeds) - 1) // 2]
    if rpm is not None:
        if isinstance(rpm, bool) or not isinstance(rpm, int | float):
            raise BadInput("expected a number of revolutions per minute", key="--rpm", value=rpm)
        omega = rpm * math.pi / 30
        if not 0 <= omega <= FASTEST:
            most = FASTEST * 30 / math.pi
            raise BadInput(f"expected a rotation speed between 0 and {whole(most)} rpm", key="--rpm", value=typed(rpm))
    return source.changed(rotor=source.scene.rotor.model_copy(update={"speeds": (omega,)}))
