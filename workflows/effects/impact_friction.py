"""Friction where the ball hits a wall."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from workflows.effects.definition import NO_DAMPER, Called, Case, Definition

if TYPE_CHECKING:
    from workflows.scene.damper import Damper


def called_for(case: Case) -> Called:
    """Wherever walls have friction."""
    if case.scene.damper is None:
        return NO_DAMPER
    if case.scene.damper.friction == 0:
        return Called(False, "friction is 0")
    return Called(True, "friction is above 0: it acts where the ball moves along a wall as it hits it")


def arguments(given: Damper, _: float, on: bool) -> dict[str, Any]:
    """The cap on the tangential impulse."""
    return {"friction": given.friction if on else 0.0}


EFFECT = Definition("damper", called_for, "friction at the walls", arguments=arguments)
