"""The cavity moves with the plate's own modes, along both axes, and not with one frequency on both."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from workflows.effects.definition import (
    GIVEN,
    NO_DAMPER,
    PRINTED,
    Assumption,
    Called,
    Case,
    Definition,
    Refusal,
    not_printed,
)
from workflows.effects.selection import SHARE, beam_like
from workflows.formatting import significant
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    from fem.meshes.mesh_sequence import Planform


def called_for(case: Case) -> Called:
    """The plate's own modes: called for where the motion leaves the bending plane, or hits feed other modes."""
    scene = case.scene
    damper, plate, release = scene.damper, scene.plate, scene.release
    if damper is None or release is None:
        return NO_DAMPER
    if scene.given is not None:
        return GIVEN
    if damper.formulation == "printed":
        return Called(False, PRINTED)
    if plate is None:
        return Called(True, "the modes are known: each moves the cavity along its axes as it does")
    if any(pair is not None and pair[1] != 0.0 for pair in (release.displacement, release.acceleration)):
        return Called(True, "the release moves the cavity across too, where the plate has frequencies of its own")
    if math.sin(2 * scene.rotor.stagger) != 0.0 and case.spins:
        return Called(True, "the stagger couples the ball's motion in the bending plane with that across")
    if plate.mesh is not None or (damper.on_plate is not None and damper.on_plate[1] != 0.0):
        return Called(True, "the cavity is not on the centre line of a rectangle: modes that twist move it too")
    ratio, asked = _mass_ratio(scene, case.form), scene.accuracy.damping
    said = f"the ball has about {significant(100 * ratio, 2)} % of the mass that it moves"
    if ratio > scene.budget.scattered:
        return Called(True, f"{said}: its hits scatter energy into modes beyond the first")
    return Called(
        False,
        f"release, load and cavity lie in the bending plane, and {said}: too light to scatter"
        f" {significant(100 * asked)} % into modes beyond the first",
    )


def refused(scene: Scene) -> Refusal | None:
    """A structure's own modes where none are known."""
    key, asked = "[effects] structural_modes", scene.effects.structural_modes
    if (found := not_printed("structural_modes")(scene)) is not None:
        return found
    if asked is True and scene.given is not None:
        return Refusal("the scene has no plate whose modes these could be", key, True)
    return None


def assumed(scene: Scene, on: bool, _: str) -> Assumption:
    """How the structure vibrates."""
    if on:
        text = (
            "The structure vibrates in those of its modes that the cavity feels, without Coriolis forces; the"
            " ball's own figures are those in the leading ones, the others damped by 0.1 % or more."
        )
        return Assumption(text, "ours")
    if scene.given is not None:
        return Assumption("The structure vibrates in one mode along each axis.", "paper, II.A")
    return Assumption(
        "The structure vibrates in its first bending mode alone, with the same frequency on both axes.", "paper, II.A"
    )


def _mass_ratio(scene: Scene, form: Planform | None) -> float:
    """Mass of all balls over the effective mass, roughly where a plate's is not known yet."""
    damper = scene.damper
    if damper is None:
        return 0.0
    if damper.mass_ratio is not None:
        return damper.mass_ratio
    return (damper.balls or 0.0) / (SHARE * beam_like(scene, form).mass + scene.point_mass)


EFFECT = Definition("damper", called_for, "modes of the plate", refused=refused, assumed=assumed)
