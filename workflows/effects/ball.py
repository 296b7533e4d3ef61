"""The effects of a ball and its cavity: when each is called for, what rules it out, its words and terms."""

import math
from typing import Any, NamedTuple

from workflows.effects.definition import GIVEN, PRINTED, Called, Case, Definition, Refusal, not_printed
from workflows.formatting import beside, significant, turning
from workflows.scene import plate_mesh
from workflows.scene.damper import Damper
from workflows.scene.materials import KNOWN
from workflows.scene.scene import Scene

SLOPE = 1.3765
"""Of a uniform cantilever's first mode at the tip, over w/L."""

_ROOT, SHARE = 1.8751, 0.25
"""Of that mode: first root of cos x cosh x = -1, and effective mass at the tip over the whole."""

STIFFENED = 1.19, 1.57
"""Growth of a uniform cantilever's first squared frequency with Omega², and with that times hub radius over length
(Southwell and Gough 1921)."""


class Beam(NamedTuple):
    """A uniform cantilever like the plate: length [m], mass [kg], squared first frequency at rest [1/s²]."""

    length: float
    mass: float
    square: float


def beam_like(case: Case) -> Beam:
    """The cantilever of a scene's plate, with its point mass."""
    plate, material = case.plate
    length, width = plate_mesh.sides(plate, case.form)
    thickness = plate_mesh.thickness_range(plate, case.form)[1]
    mass = material.density * length * width * thickness
    square = _ROOT**4 * material.youngs_modulus * thickness**2 / (12 * material.density * length**4)
    return Beam(length, mass, square * SHARE * mass / (SHARE * mass + case.scene.point_mass))


def _rolling_resistance(case: Case) -> Called:
    """Wherever a load presses the ball on a floor that resists."""
    damper = case.damper
    if damper.rolling_friction == 0:
        return Called(False, "rolling_friction is 0")
    if not case.spins:
        return Called(False, "the rotor is at rest: no load presses the ball on the floor")
    return Called(True, "rolling_friction is above 0 and the load presses the ball on the floor")


def _rolling_arguments(damper: Damper, _: float, on: bool) -> dict[str, Any]:
    """The lever arm of the resistance, where a scene gives it."""
    lever = damper.rolling_friction
    return {"rolling_friction": lever if on and isinstance(lever, float) else 0.0}


def _impact_friction(case: Case) -> Called:
    """Wherever walls have friction."""
    if case.damper.friction == 0:
        return Called(False, "friction is 0")
    return Called(True, "friction is above 0: it acts where the ball moves along a wall as it hits it")


def _slip_refused(scene: Scene) -> Refusal | None:
    """Slip needs a friction to slip against, and equations that know it."""
    if not_printed(scene):
        return Refusal("the printed equations have no slip")
    slips = scene.damper is None or scene.damper.friction != 0
    return None if slips else Refusal("ball_slip needs a friction above 0", "[damper] friction", 0)


def _floor_tilt(case: Case) -> Called:
    """The cavity's floor tilts: called for where that takes more of the ball's drive than `accuracy.damping`."""
    scene = case.scene
    if not case.spins:
        return Called(False, "the rotor is at rest: no load pulls the ball down a slope")
    if scene.is_printed:
        return Called(False, PRINTED)
    if scene.in_space:
        return Called(True, "as the structure bends, the floor tilts, and the load pulls the ball down the slope")
    target = scene.accuracy.damping
    share, omega = max((_tilt_share(case, speed), speed) for speed in scene.rotor.speeds)
    if share == 0.0:
        return Called(False, "structure.floor_tilt is 0")
    about = "about " if scene.given is None else ""
    at = turning(omega) + (", estimated for a beam" if scene.given is None else "")
    reason = (
        f"the load pulls the ball down the slope by {about}{beside(100 * share, 100 * target)} % of its drive at {at}"
    )
    if share > (scene.budget.rough_drive if scene.given is None else scene.budget.drive):
        return Called(True, f"as the structure bends, the floor tilts, and {reason}")
    return Called(False, f"{reason}, less than the {significant(100 * target)} % requested")


def _tilt_share(case: Case, omega: float) -> float:
    """Share of the ball's drive that the load takes down the slope; of a plate roughly, as of a beam."""
    structure, rotor = case.scene.given, case.scene.rotor
    if structure is not None and rotor.radius is not None:
        shares = [
            omega**2 * rotor.radius * abs(slope) / (2 * math.pi * frequency) ** 2
            for slope, frequency in zip(structure.floor_tilt, structure.frequency, strict=True)
        ]
        return max(shares)
    beam, (own, hub) = beam_like(case), STIFFENED
    square = beam.square + omega**2 * (own + hub * rotor.hub_radius / beam.length)
    return omega**2 * (rotor.hub_radius + beam.length) * SLOPE / beam.length / square


def _indentation(case: Case) -> Called:
    """Where a load presses the ball on its floor, and the strength of one of the two is known."""
    scene = case.scene
    if not case.spins:
        return Called(False, "the rotor is at rest: no load presses the ball on the floor")
    known = [KNOWN[name] for name in scene.contact_materials if name is not None]
    if len(known) < 2:
        return Called(False, "the materials of ball and floor are not given by name")
    if all(each.hardness is None for each in known):
        return Called(False, "the strength of ball and floor is unknown")
    return Called(True, "where the load makes ball or floor yield, the ball lies in a dent")


def _structural_modes(case: Case) -> Called:
    """The plate's own modes: called for where the motion leaves the bending plane, or hits feed other modes."""
    scene = case.scene
    damper, plate, release = case.damper, scene.plate, scene.release
    if scene.given is not None:
        return GIVEN
    if scene.is_printed:
        return Called(False, PRINTED)
    if plate is None:
        return Called(True, "the modes are known, with their motion along both axes")
    released = () if release is None else (release.displacement, release.acceleration)
    if any(pair is not None and pair[1] != 0.0 for pair in released):
        return Called(True, "the release also moves the cavity across, where the plate has other frequencies")
    if math.sin(2 * scene.rotor.stagger) != 0.0 and case.spins:
        return Called(True, "the stagger couples the ball's motion in the bending plane with its motion across")
    if plate.mesh is not None or (damper.on_plate is not None and damper.on_plate[1] != 0.0):
        return Called(True, "the cavity is not on the centre line of a rectangle: twist modes also move it")
    ratio, target = _mass_ratio(case), scene.accuracy.damping
    reason = f"the ball has about {significant(100 * ratio, 2)} % of the mass that it moves"
    if ratio > scene.budget.scattered:
        return Called(True, f"{reason}: its hits scatter energy into modes beyond the first")
    light = f"too light to scatter {significant(100 * target)} % into modes beyond the first"
    return Called(False, f"release, load and cavity lie in the bending plane, and {reason}: {light}")


def _modes_refused(scene: Scene) -> Refusal | None:
    """A structure's own modes where none are known."""
    return not_printed(scene) or (None if scene.given is None else Refusal("the scene has no plate"))


def _modes_assumed(scene: Scene, on: bool, _: str) -> str:
    """How the structure vibrates."""
    return "on" if on else "off" if scene.given is None else "given"


def _mass_ratio(case: Case) -> float:
    """Mass of all balls over the effective mass, roughly where a plate's is not known yet."""
    damper = case.damper
    if damper.mass_ratio is not None:
        return damper.mass_ratio
    return (damper.balls or 0.0) / (SHARE * beam_like(case).mass + case.scene.point_mass)


HOUSED = "the housing holds the cavities outside the plate"
"""Why a plate loses nothing."""

IN_THE_MESH = (
    "the mesh is solved as it is; the frequency shift by cavities missing from the mesh is part of the errors of the"
    " frequencies"
)
"""Why a solid blade loses nothing."""


def _cavity_mass(case: Case) -> Called:
    """Where it shifts a frequency, as a beam's, by more than a tenth of the accuracy: other modes move more."""
    scene, damper = case.scene, case.damper
    if scene.in_space:
        return Called(False, IN_THE_MESH if scene.blade is not None else "the modes are known")
    if scene.material is None:
        return GIVEN
    if damper.housing:
        return Called(False, HOUSED)
    beam, mass = beam_like(case), scene.material.density * damper.cut
    shift = mass / (2 * (SHARE * beam.mass + scene.point_mass))
    why = f"the cavities take {significant(1e3 * mass, 2)} g out of the plate: at its tip that raises"
    percent = significant(100 * shift, 2)
    return Called(shift > scene.budget.rough_shift, f"{why} the first frequency by about {percent} %")


def _cavity_refused(scene: Scene) -> Refusal | None:
    """What has no plate out of which metal could be taken."""
    if scene.damper is not None and scene.plate is None:
        return Refusal(IN_THE_MESH if scene.blade is not None else "the scene has no plate")
    return Refusal(HOUSED) if scene.damper is not None and scene.damper.housing else None


def _cavity_assumed(scene: Scene, on: bool, _: str) -> str:
    """What the cavities take out."""
    cut = scene.plate is not None and scene.damper is not None and scene.damper.cut
    return ("on" if on else "off") if cut else ""


EFFECTS = {
    "rolling_resistance": Definition("damper", _rolling_resistance, "rolling resistance", arguments=_rolling_arguments),
    "impact_friction": Definition(
        "damper",
        _impact_friction,
        "friction at the walls",
        arguments=lambda damper, _, on: {"friction": damper.friction if on else 0.0},
    ),
    "ball_slip": Definition(
        "damper",
        lambda _: Called(False, "the paper's model: the ball rolls again at once after a wall hit"),
        "slip of the ball",
        refused=_slip_refused,
        arguments=lambda damper, omega, on: {"floor_friction": damper.friction if on and omega > 0 else None},
    ),
    "floor_tilt": Definition("damper", _floor_tilt, "tilt of the floor", refused=not_printed),
    "indentation": Definition("damper", _indentation, "indentation"),
    "structural_modes": Definition(
        "damper", _structural_modes, "modes of the plate", refused=_modes_refused, assumed=_modes_assumed
    ),
    "cavity_mass": Definition(
        "damper", _cavity_mass, "mass of the cavities", refused=_cavity_refused, assumed=_cavity_assumed
    ),
}
"""By their keys of a scene."""
