"""The dent under a resting ball holds it until the structure's acceleration lifts it over the rim."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workflows.effects.definition import NO_DAMPER, Assumption, Called, Case, Definition
from workflows.scene.materials import KNOWN

if TYPE_CHECKING:
    from workflows.scene.scene import Scene


def called_for(case: Case) -> Called:
    """Where a load presses the ball on its floor, and the strength of one of the two is known."""
    scene = case.scene
    if scene.damper is None:
        return NO_DAMPER
    if not case.spins:
        return Called(False, "nothing spins: no load presses the ball on the floor")
    plate = None if scene.material is None else scene.material.name
    names = scene.damper.ball_material, scene.damper.floor_material or plate
    known = [KNOWN[name] for name in names if name is not None]
    if len(known) < 2 or any(each.youngs_modulus is None for each in known):
        return Called(False, "the materials of ball and floor are not known by name")
    if all(each.hardness is None for each in known):
        return Called(False, "the strength of neither ball nor floor is known")
    return Called(True, "where the load makes ball or floor yield, the ball lies in a dent")


def assumed(_: Scene, on: bool, __: str) -> Assumption:
    """What holds a ball at rest."""
    if on:
        return Assumption(
            "A ball at rest lies in its dent, out of which it is lifted before it rolls: in the figures of the way up"
            " and the cut-off, not in ring-downs and forced motion, in which the ball moves.",
            "Johnson, Contact Mechanics (1985), section 6.3, less elastic recovery",
        )
    return Assumption("The floor stays as smooth as it was made: no dent holds the ball.", "ours")


EFFECT = Definition("damper", called_for, "indentation", assumed=assumed)
