"""Slip of the ball on the floor after a wall hit, until it rolls again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from workflows.effects.definition import NO_DAMPER, Assumption, Called, Case, Definition, Refusal

if TYPE_CHECKING:
    from workflows.scene.damper import Damper
    from workflows.scene.scene import Scene


def called_for(case: Case) -> Called:
    """Only where it is asked for."""
    if case.scene.damper is None:
        return NO_DAMPER
    return Called(False, "the paper's model: the ball rolls again at once after a wall hit")


def refused(scene: Scene) -> Refusal | None:
    """Slip needs a friction to slip against, and equations that know it."""
    damper = scene.damper
    if damper is None or scene.effects.ball_slip is not True:
        return None
    if damper.formulation == "printed":
        return Refusal("the printed equations know no slip", "[effects] ball_slip", True)
    if damper.friction == 0:
        return Refusal("ball_slip needs a friction above 0", "[damper] friction", 0)
    return None


def assumed(_: Scene, on: bool, __: str) -> Assumption:
    """How the ball moves on the floor."""
    if on:
        return Assumption(
            "The ball never lifts off the cavity's floor; after a wall hit it slides there until it rolls.", "ours"
        )
    return Assumption(
        "The ball rolls on the cavity's floor, never lifts off and never slides except at walls.", "paper, II.A"
    )


def arguments(given: Damper, omega: float, on: bool) -> dict[str, Any]:
    """The friction of the floor, which takes a load."""
    return {"floor_friction": given.friction if on and omega > 0 else None}


EFFECT = Definition("damper", called_for, "slip of the ball", refused=refused, assumed=assumed, arguments=arguments)
