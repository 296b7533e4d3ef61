"""The metal that the cavities take out of the plate: it has no inertia, and does not pull."""

from __future__ import annotations

from workflows.effects.definition import GIVEN, NO_DAMPER, Assumption, Called, Case, Definition, Refusal
from workflows.effects.selection import SHARE, beam_like
from workflows.formatting import significant
from workflows.scene.scene import Scene

HOUSED = "the housing holds the cavities outside the plate"
"""Why a plate loses nothing."""

IN_THE_MESH = "the mesh says whether the cavities are cut into the blade"
"""Why a solid blade loses nothing."""


def called_for(case: Case) -> Called:
    """Where it shifts a frequency, as a beam's, by more than a tenth of the accuracy: other modes move more."""
    scene = case.scene
    damper, material = scene.damper, scene.material
    if damper is None:
        return NO_DAMPER
    if scene.in_space:
        return Called(False, IN_THE_MESH if scene.blade is not None else "the modes are known")
    if material is None:
        return GIVEN
    if damper.housing:
        return Called(False, HOUSED)
    beam, mass = beam_like(scene, case.form), material.density * damper.cut
    shift = mass / (2 * (SHARE * beam.mass + scene.point_mass))
    why = f"the cavities take {significant(1e3 * mass, 2)} g out of the plate, about {significant(100 * shift, 2)} %"
    return Called(shift > scene.budget.rough_shift, f"{why} of its lowest frequency, if they are at its tip")


def refused(scene: Scene) -> Refusal | None:
    """What has no plate out of which metal could be taken."""
    damper = scene.damper
    if scene.effects.cavity_mass is not True or damper is None:
        return None
    key = "[effects] cavity_mass"
    if scene.plate is None:
        return Refusal(IN_THE_MESH if scene.blade is not None else "the scene has no plate", key, True)
    return Refusal(HOUSED, key, True) if damper.housing else None


def assumed(scene: Scene, on: bool, _: str) -> Assumption | None:
    """What the cavities take out."""
    if scene.plate is None or scene.damper is None or not scene.damper.cut:
        return None
    if not on:
        return Assumption("The plate is as heavy as if no cavities were cut into it.", "ours")
    return Assumption(
        "The metal of the cavities is taken out of what is nearest to the damper's place; the stiffness stays.", "ours"
    )


EFFECT = Definition(
    "damper",
    called_for,
    "mass of the cavities",
    refused=refused,
    assumed=assumed,
    costs=("fem.operators.assembly.footprint",),
)
