"""Tilt of the cavity's floor as the structure bends: the load then pulls the ball down the slope."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fem.rotor import in_rpm
from workflows.effects.definition import NO_DAMPER, PRINTED, Assumption, Called, Case, Definition, not_printed
from workflows.effects.selection import SLOPE, STIFFENED, beam_like
from workflows.formatting import significant, whole
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    from fem.meshes.mesh_sequence import Planform


def called_for(case: Case) -> Called:
    """The cavity's floor tilts: called for where that takes more of the ball's drive than `accuracy.damping`."""
    scene = case.scene
    if scene.damper is None:
        return NO_DAMPER
    if not case.spins:
        return Called(False, "nothing spins: no load pulls the ball down a slope")
    if scene.damper.formulation == "printed":
        return Called(False, PRINTED)
    if scene.in_space:
        return Called(True, "as the structure bends, the floor tilts, and the load pulls the ball down the slope")
    asked = scene.accuracy.damping
    share, omega = max((_tilt_share(scene, case.form, speed), speed) for speed in scene.rotor.speeds)
    if share == 0.0:
        return Called(False, "structure.floor_tilt is 0")
    about = "about " if scene.given is None else ""
    at = f"{whole(in_rpm(omega))} rpm" + (", estimated for a beam" if scene.given is None else "")
    said = f"the load pulls the ball down the slope by {about}{significant(100 * share, 2)} % of its drive at {at}"
    if share > (scene.budget.rough_drive if scene.given is None else scene.budget.drive):
        return Called(True, f"as the structure bends, the floor tilts, and {said}")
    return Called(False, f"{said}, less than the {significant(100 * asked)} % asked for")


def assumed(_: Scene, on: bool, __: str) -> Assumption:
    """How the floor lies."""
    if on:
        return Assumption(
            "The cavity's floor tilts with the structure's slope, by small angles; the load is normal to it at rest.",
            "ours",
        )
    return Assumption("The cavity's floor stays perpendicular to the load.", "paper, II.A")


def _tilt_share(scene: Scene, form: Planform | None, omega: float) -> float:
    """Share of the ball's drive that the load takes down the slope; of a plate roughly, as of a beam."""
    structure, rotor = scene.given, scene.rotor
    if structure is not None and rotor.radius is not None:
        shares = [
            omega**2 * rotor.radius * abs(slope) / (2 * math.pi * frequency) ** 2
            for slope, frequency in zip(structure.floor_tilt, structure.frequency, strict=True)
        ]
        return max(shares)
    beam, (own, hub) = beam_like(scene, form), STIFFENED
    square = beam.square + omega**2 * (own + hub * rotor.hub_radius / beam.length)
    return omega**2 * (rotor.hub_radius + beam.length) * SLOPE / beam.length / square


EFFECT = Definition("damper", called_for, "tilt of the floor", refused=not_printed("floor_tilt"), assumed=assumed)
