"""When a scene calls for an effect on the ball: a rule each, and the reason in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from workflows.scene import thicknesses
from workflows.scene.scene import Scene
from workflows.wording import significant, whole

if TYPE_CHECKING:
    from workflows.scene.plate_mesh import Planform

Called = tuple[bool, str]

_NONE = False, "no damper in the scene"
_PRINTED = "the printed equations know one mode along each axis and a level floor"

_SLOPE = 1.3765
"""Of a uniform cantilever's first mode at the tip, over w/L."""

_ROOT, _SHARE = 1.8751, 0.25
"""Of that mode: first root of cos x cosh x = -1, and effective mass at the tip over the whole."""

_STIFFENED = 1.19, 1.57
"""Growth of a uniform cantilever's first squared frequency with Omega², and with that times hub radius over length
(Southwell and Gough 1921)."""

SCATTERED = 2.0
"""Relative change of the damping by a structural mode beyond the leading ones, over the ball's mass over the mode's at
the cavity: at most 1.75, 0.15 in the median, by `python -m tests.benchmarks.modes_needed`."""

_DOUBT = 0.1
"""Part of the accuracy from which a share of a beam's drive calls for the tilt: the plate's own is not known before."""


def rolling_resistance(scene: Scene, _: Planform | None = None) -> Called:
    """The load resists rolling."""
    if scene.damper is None:
        return _NONE
    if scene.damper.rolling_friction == 0:
        return False, "rolling_friction is 0"
    if not _spins(scene):
        return False, "nothing spins: no load presses the ball on the floor"
    return True, "rolling_friction is above 0 and the load presses the ball on the floor"


def impact_friction(scene: Scene, _: Planform | None = None) -> Called:
    """Friction in wall hits."""
    if scene.damper is None:
        return _NONE
    if scene.damper.friction == 0:
        return False, "friction is 0"
    return True, "friction is above 0: it acts where the ball moves along a wall as it hits it"


def ball_slip(scene: Scene, _: Planform | None = None) -> Called:
    """Slip after a wall hit."""
    if scene.damper is None:
        return _NONE
    return False, "the paper's model: the ball rolls again at once after a wall hit"


def floor_tilt(scene: Scene, form: Planform | None = None) -> Called:
    """The cavity's floor tilts: called for where that takes more of the ball's drive than `accuracy.damping`."""
    if scene.damper is None:
        return _NONE
    if not _spins(scene):
        return False, "nothing spins: no load pulls the ball down a slope"
    if scene.damper.formulation == "printed":
        return False, _PRINTED
    asked = scene.accuracy.damping
    share, omega = max((_tilt_share(scene, form, speed), speed) for speed in scene.rotor.speeds)
    if share == 0.0:
        return False, "structure.floor_tilt is 0"
    about = "about " if scene.structure is None else ""
    at = f"{whole(omega * 30 / math.pi)} rpm"
    said = f"the load pulls the ball down the slope by {about}{significant(100 * share, 2)} % of its drive at {at}"
    if share > asked * (_DOUBT if scene.structure is None else 1.0):
        return True, f"as the structure bends, the floor tilts, and {said}"
    return False, f"{said}, less than the {significant(100 * asked)} % asked for"


def structural_modes(scene: Scene, form: Planform | None = None) -> Called:
    """The plate's own modes: called for where the motion leaves the bending plane, or hits feed other modes."""
    damper, plate, release = scene.damper, scene.plate, scene.release
    if damper is None or release is None:
        return _NONE
    if plate is None:
        return False, "the structure's frequency is given"
    if damper.formulation == "printed":
        return False, _PRINTED
    if any(pair is not None and pair[1] != 0.0 for pair in (release.displacement, release.acceleration)):
        return True, "the release moves the cavity across too, where the plate has frequencies of its own"
    if math.sin(2 * scene.rotor.stagger) != 0.0 and _spins(scene):
        return True, "the stagger couples the ball's motion in the bending plane with that across"
    if plate.mesh is not None or (damper.at is not None and damper.at[1] != 0.0):
        return True, "the cavity is not on the centre line of a rectangle: modes that twist move it too"
    ratio, asked = _mass_ratio(scene, form), scene.accuracy.damping
    said = f"the ball has about {significant(100 * ratio, 2)} % of the mass that it moves"
    if SCATTERED * ratio > asked:
        return True, f"{said}: its hits scatter energy into modes beyond the first"
    return False, (
        f"release, load and cavity lie in the bending plane, and {said}: too light to scatter"
        f" {significant(100 * asked)} % into modes beyond the first"
    )


def _spins(scene: Scene) -> bool:
    return any(speed > 0 for speed in scene.rotor.speeds)


class _Beam(NamedTuple):
    """A uniform cantilever like the plate: length [m], mass [kg], squared first frequency at rest [1/s²]."""

    length: float
    mass: float
    square: float


def _beam(scene: Scene, form: Planform | None) -> _Beam:
    plate, material = scene.plate, scene.material
    if plate is None or material is None:
        raise ValueError("the scene has no plate")
    if form is None and plate.mesh is not None:
        raise ValueError("the planform of a plate from a mesh is needed")
    length, width = (plate.length, plate.width) if form is None else np.ptp(form.mesh(form.sizes[0]).p, axis=1)
    thickness = thicknesses.spread(plate, form)[1]
    mass = material.density * float(length or 0.0) * float(width or 0.0) * thickness
    square = _ROOT**4 * material.youngs_modulus * thickness**2 / (12 * material.density * float(length or 1.0) ** 4)
    return _Beam(float(length or 0.0), mass, square * _SHARE * mass / (_SHARE * mass + scene.point_mass))


def _tilt_share(scene: Scene, form: Planform | None, omega: float) -> float:
    """Share of the ball's drive that the load takes down the slope; of a plate roughly, as of a beam."""
    structure, rotor = scene.structure, scene.rotor
    if structure is not None and rotor.radius is not None:
        shares = [
            omega**2 * rotor.radius * abs(slope) / (2 * math.pi * frequency) ** 2
            for slope, frequency in zip(structure.floor_tilt, structure.frequency, strict=True)
        ]
        return max(shares)
    beam, (own, hub) = _beam(scene, form), _STIFFENED
    square = beam.square + omega**2 * (own + hub * rotor.hub_radius / beam.length)
    return omega**2 * (rotor.hub_radius + beam.length) * _SLOPE / beam.length / square


def _mass_ratio(scene: Scene, form: Planform | None) -> float:
    """Mass of all balls over the effective mass, roughly where a plate's is not known yet."""
    damper = scene.damper
    if damper is None:
        return 0.0
    if damper.mass_ratio is not None:
        return damper.mass_ratio
    return (damper.balls or 0.0) / (_SHARE * _beam(scene, form).mass + scene.point_mass)
