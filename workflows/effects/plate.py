"""The effects of a plate: when each is called for, what rules it out, its words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

import fem
from fem.meshes.mesh_sequence import Planform
from workflows.effects.definition import AT_REST, GIVEN, Called, Case, Definition, LeftOut, Refusal
from workflows.formatting import beside, share, significant, turning
from workflows.scene import plate_mesh
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    from fem.accuracy.neglected_effects import Bent, Turned


CELLS_PER_MODE = 10
"""Cells for each mode of a mesh on which rates are good to a percent (`fem.accuracy.neglected_effects.UNCERTAIN`)."""


def _stress_stiffening(case: Case) -> Called:
    """Wherever a plate spins."""
    if case.scene.plate is None:
        return GIVEN
    if not case.spins:
        if case.scene.effects.large_deflection is True:
            return Called(True, "the rotor is at rest, but large_deflection, which the scene requests, needs it")
        return AT_REST
    return Called(True, "the plate spins, and the centrifugal load stiffens it")


def _spin_softening(case: Case) -> Called:
    """Wherever a plate spins."""
    rotor = case.scene.rotor
    for angle, tilted in ((rotor.stagger, "staggered"), (rotor.precone, "coned")):
        if abs(math.sin(angle)) > 1e-9:
            return Called(True, f"the plate is {tilted}: its bending has a component perpendicular to the spin axis")
    return Called(
        True, "in-plane modes and, slightly, the rotating cross-sections in bending move perpendicular to the spin axis"
    )


def _coriolis(case: Case) -> Called:
    """Where they move a frequency of a plate that spins by more than the accuracy asked for, on a coarse mesh.

    In the plane of rotation bending across the width is coupled to stretching alone, at w = (pi / 2) (E / rho)^1/2 / L,
    which lowers it by 2 (Omega / w)² in the limit of a low mode. Where that decides, no modes are found, unless the
    scene leaves the forces out, whose part of every frequency's error is then needed.

    Raises:
        ValueError: the planform is a mesh, and is not given.
    """
    scene, (plate, material) = case.scene, case.plate
    target, rotor = scene.accuracy.frequency, scene.rotor
    wave = math.sqrt(material.youngs_modulus / material.density)
    moved = 2.0 * (max(rotor.speeds) / (0.5 * math.pi * wave / plate_mesh.sides(plate, case.form)[0])) ** 2
    if rotor.stagger == rotor.precone == 0.0 and scene.effects.coriolis is not False and moved > target:
        most = (
            f"{beside(100 * moved, 100 * target, 1)} % at most, more than the {significant(100 * target)} % requested"
        )
        return Called(True, f"it lowers frequencies of motion in the plane of rotation by about {most}")
    try:
        shift = _solved_with_coriolis(scene, case.form, case.on["large_deflection"])
    except (ArithmeticError, ValueError, RuntimeError) as error:  # it then also ends the run, with its key
        return Called(False, f"the modes have no solution on a coarse mesh: {error}")
    if shift is None:
        return Called(False, "the plate diverges without it")
    largest, omega = shift.largest
    why = f"at {turning(omega)} it moves frequencies by up to {beside(100 * largest, 100 * target)} %"
    compared = f"{'more' if largest > target else 'less'} than the {significant(100 * target)} % requested"
    return Called(largest > target, f"{why}, {compared}", LeftOut(shift.omega, shift.shifts))


def _solved_with_coriolis(scene: Scene, form: Planform | None, large_deflection: bool) -> Turned | None:
    from fem.accuracy.neglected_effects import turned

    names = ("stress_stiffening", "spin_softening", "rotary_inertia")
    switches = {name: getattr(scene.effects, name) is not False for name in names}
    theory = "kirchhoff" if scene.plate is not None and scene.plate.theory == "kirchhoff" else "mindlin"
    effects = fem.Effects(**switches, large_deflection=large_deflection)
    coarse = plate_mesh.coarse_plate(scene, form, CELLS_PER_MODE)
    return turned(*coarse, effects, scene.rotor.speeds, scene.rotor.modes, theory)


THINNER, LEAST = 0.88, 0.29
"""What the strain at the root does to the six lowest modes of a flat blade, by Poisson's ratio (times nu (1 + nu), the
contraction of the thickness where the root holds the width) and without it. The largest of 400 random rectangles in the
plane of rotation, 1 to 16 times as long as wide and up to 0.13 widths thick: 0.87 nu (1 + nu), 0.28."""

SLENDER, THIN, LOWEST = (1.0, 16.0), 0.13, 6
"""Where that holds: length over width, thickness over width, and number of modes."""


def _large_deflection(case: Case) -> Called:
    """Where the load of a plate that spins moves a frequency by more than the accuracy asked for.

    A blade that lies in the plane of rotation and is hardly strained is told by its strain alone; others are solved on
    a coarse mesh.

    Raises:
        ValueError: the planform is a mesh, and is not given.
    """
    scene, target = case.scene, case.scene.accuracy.frequency
    if scene.effects.stress_stiffening is False:
        return Called(False, "it is part of stress_stiffening, which is off")
    plate_mesh.sides(case.plate[0], case.form)  # those of a mesh have to be given
    strain = strain_of_a_flat_blade(scene)
    if strain is not None and (moved := moved_by_strain(scene, strain)) <= target:
        reason = (
            f"the load lies in the plate's own plane and strains it by {share(strain, 2)} %, which moves frequencies by"
            f" {beside(100 * moved, 100 * target)} % at most, less than the {significant(100 * target)} % requested"
        )
        every = LeftOut(np.array([max(scene.rotor.speeds)]), np.full((1, scene.rotor.modes), moved))
        return Called(False, reason, every)
    try:
        bent = _solved_with_deflection(scene, case.form)
    except (ArithmeticError, ValueError, RuntimeError) as error:  # it then also ends the run, with its key
        return Called(True, f"the static state has no solution on a coarse mesh: {error}")
    if bent is None:
        return Called(False, "the plate diverges with it and without it")
    if math.isinf(bent.shift):
        return Called(True, f"at {turning(bent.omega)} the plate diverges either with it or without it")
    state = (
        f"at {turning(bent.omega)} the load turns parts of the plate by up to {significant(bent.rotation, 2)} rad and"
        f" strains it by up to {share(bent.strain, 2)} %, which moves frequencies by at most about"
        f" {beside(100 * bent.shift, 100 * target)} %"
    )
    moves = LeftOut(np.array([bent.omega]), bent.shifts[None])
    if bent.shift > scene.budget.left_out:
        return Called(True, f"{state}; the modes are those about that state", moves)
    return Called(False, f"{state}, less than the {significant(100 * target)} % requested", moves)


def _deflection_refused(scene: Scene) -> Refusal | None:
    """The bent state is found from the stresses that stiffen it."""
    stiffened = scene.effects.stress_stiffening is not False
    return None if stiffened else Refusal("needs stress_stiffening, which is false")


def _deflection_assumed(scene: Scene, on: bool, theory: str) -> str:
    """The state that the modes are those about."""
    if scene.plate is None:
        return ""
    return "off" if not on else "moderate" if theory == "kirchhoff" else "on"


def strain_of_a_flat_blade(scene: Scene) -> float | None:
    """Strain at the root of a rectangle in the plane of rotation, of those for which `THINNER` holds."""
    plate, material, rotor = scene.plate, scene.material, scene.rotor
    if plate is None or material is None or plate.length is None or plate.width is None:
        return None
    if not isinstance(plate.thickness, float) or plate.root is not None:
        return None
    shaped = SLENDER[0] <= plate.length / plate.width <= SLENDER[1] and plate.thickness <= THIN * plate.width
    if not shaped or rotor.stagger != 0.0 or rotor.precone != 0.0 or scene.point_mass > 0.0 or rotor.modes > LOWEST:
        return None
    reach = (rotor.hub_radius + plate.length) ** 2 - rotor.hub_radius**2
    return 0.5 * material.density * max(rotor.speeds) ** 2 * reach / material.youngs_modulus


def moved_by_strain(scene: Scene, strain: float) -> float:
    """By how much that strain moves a frequency, relative, at most."""
    nu = scene.material.poissons_ratio if scene.material is not None else 0.0
    return max(THINNER * nu * (1.0 + nu), LEAST) * strain


def _solved_with_deflection(scene: Scene, form: Planform | None) -> Bent | None:
    from fem.accuracy.neglected_effects import bent

    effects = fem.Effects(spin_softening=scene.effects.spin_softening is not False)
    coarse = plate_mesh.coarse_plate(scene, form, CELLS_PER_MODE)
    return bent(*coarse, effects, scene.rotor.speeds, scene.rotor.modes)


def _rotary_inertia(case: Case) -> Called:
    """Wherever there is a plate."""
    if case.scene.plate is None:
        return Called(False, "the structure's mass is given")
    return Called(True, "the cross-sections of a thick plate turn as they bend")


EFFECTS = {
    "stress_stiffening": Definition("plate", _stress_stiffening, "stress stiffening"),
    "spin_softening": Definition("plate", _spin_softening, "spin softening", spins=True),
    "coriolis": Definition("plate", _coriolis, "Coriolis forces", after=("large_deflection",), spins=True),
    "large_deflection": Definition(
        "plate",
        _large_deflection,
        "large deflection",
        refused=_deflection_refused,
        part_of="stress_stiffening",
        spins=True,
        assumed=_deflection_assumed,
    ),
    "rotary_inertia": Definition("plate", _rotary_inertia, "rotary inertia"),
}
"""By their keys of a scene."""
