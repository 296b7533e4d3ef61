"""Rolling resistance: the load resists the ball's rolling."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from workflows.effects.definition import NO_DAMPER, Called, Case, Definition

if TYPE_CHECKING:
    from workflows.scene.damper import Damper


def called_for(case: Case) -> Called:
    """Wherever a load presses the ball on a floor that resists."""
    damper = case.scene.damper
    if damper is None:
        return NO_DAMPER
    if damper.rolling_friction == 0:
        return Called(False, "rolling_friction is 0")
    if not case.spins:
        return Called(False, "nothing spins: no load presses the ball on the floor")
    return Called(True, "rolling_friction is above 0 and the load presses the ball on the floor")


def arguments(given: Damper, _: float, on: bool) -> dict[str, Any]:
    """The lever arm of the resistance, where a scene gives it."""
    lever = given.rolling_friction
    return {"rolling_friction": lever if on and isinstance(lever, float) else 0.0}


EFFECT = Definition("damper", called_for, "rolling resistance", arguments=arguments)
