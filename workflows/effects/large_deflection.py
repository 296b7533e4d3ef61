"""Large deflection: the modes are those about the plate as the load bends or twists it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fem.rotor import in_rpm
from workflows.effects.definition import (
    AT_REST,
    CELLS_PER_MODE,
    GIVEN,
    Assumption,
    Called,
    Case,
    Definition,
    LeftOut,
    Refusal,
    everywhere,
)
from workflows.formatting import significant
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    from fem.accuracy.neglected_effects import Bent
    from fem.meshes.mesh_sequence import Planform

THINNER, LEAST = 0.88, 0.29
"""What the strain at the root does to the six lowest modes of a flat blade, by Poisson's ratio (times nu (1 + nu), the
contraction of the thickness where the root holds the width) and without it. The largest of 400 random rectangles in the
plane of rotation, 1 to 16 times as long as wide and up to 0.13 widths thick: 0.87 nu (1 + nu), 0.28."""

SLENDER, THIN, LOWEST = (1.0, 16.0), 0.13, 6
"""Where that holds: length over width, thickness over width, and number of modes."""


def called_for(case: Case) -> Called:
    """Where the load of a plate that spins moves a frequency by more than the accuracy asked for.

    A blade that lies in the plane of rotation and is hardly strained is told by its strain alone; others are solved on
    a coarse mesh.

    Raises:
        ValueError: the planform is a mesh, and is not given.
    """
    if case.scene.plate is None:
        return GIVEN
    if not case.spins:
        return AT_REST
    if case.scene.effects.stress_stiffening is False:
        return Called(False, "stress_stiffening is off, of which it is a part")
    return _moves(case.scene, case.form)


def refused(scene: Scene) -> Refusal | None:
    """The bent state is found from the stresses that stiffen it."""
    if scene.effects.large_deflection is not True or scene.effects.stress_stiffening is not False:
        return None
    problem = "needs stress_stiffening, of which it is a part, and that is false"
    return Refusal(problem, "[effects] large_deflection", True)


def assumed(scene: Scene, on: bool, theory: str) -> Assumption | None:
    """The state that the modes are those about."""
    if scene.plate is None:
        return None
    if not on:
        return Assumption("The centrifugal stress is that of the flat plate; vibrations are small about it.", "ours")
    if theory == "kirchhoff":
        text = (
            "Vibrations are small about the plate as the load bends it, in von Kármán's theory of moderate deflections,"
            " which is off by about 0.4 θ² in frequency where the plate turns by θ."
        )
        return Assumption(text, "ours")
    text = "Vibrations are small about the plate as the load deflects it, by finite rotations; its material is linear."
    return Assumption(text, "ours")


def _moves(scene: Scene, form: Planform | None) -> Called:
    asked = scene.accuracy.frequency
    strain = strain_of_a_flat_blade(scene)
    if form is None and scene.plate is not None and scene.plate.mesh is not None:
        raise ValueError("the planform of a plate from a mesh is needed")
    if strain is not None and (moved := moved_by_strain(scene, strain)) <= asked:
        said = (
            f"the load lies in the plate's own plane and strains it by {_percent(strain)} %, which moves frequencies by"
            f" {_percent(moved)} % at most, less than the {significant(100 * asked)} % asked for"
        )
        return Called(False, said, everywhere(max(scene.rotor.speeds), moved, scene.rotor.modes))
    try:
        found = _solved(scene, form)
    except (ArithmeticError, ValueError, RuntimeError) as error:  # it then also ends the run, with its key
        return Called(True, f"the static state has no solution on a coarse mesh: {error}")
    if found is None:
        return Called(False, "the plate diverges with it and without it")
    if math.isinf(found.shift):
        return Called(True, f"at {_rpm(found)} rpm the plate diverges either with it or without it")
    state = (
        f"at {_rpm(found)} rpm the load turns parts of the plate by up to {significant(found.rotation, 2)} rad and"
        f" strains it by up to {_percent(found.strain)} %, which moves frequencies by up to {_percent(found.shift)} %"
    )
    moves = LeftOut(np.array([found.omega]), found.shifts[None])
    if found.shift > scene.budget.left_out:
        return Called(True, f"{state}; the modes are those about that state", moves)
    return Called(False, f"{state}, less than the {significant(100 * asked)} % asked for", moves)


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


def _solved(scene: Scene, form: Planform | None) -> Bent | None:
    from fem import Effects
    from fem.accuracy.neglected_effects import bent
    from workflows.scene import plate_mesh

    source = SceneFile(scene, "scene", Path())
    ladder = form or plate_mesh.planform(source)
    mesh = plate_mesh.coarse(ladder, CELLS_PER_MODE * scene.rotor.modes)
    effects = Effects(spin_softening=scene.effects.spin_softening is not False)
    rotor = plate_mesh.rotor(scene)
    return bent(plate_mesh.plate(source, mesh, ladder), rotor, effects, scene.rotor.speeds, scene.rotor.modes)


def _percent(part: float) -> str:
    return significant(100 * part, 2)


def _rpm(found: Bent) -> str:
    return f"{in_rpm(found.omega):.0f}"


EFFECT = Definition(
    "plate",
    called_for,
    "large deflection",
    refused=refused,
    part_of="stress_stiffening",
    assumed=assumed,
    costs=("fem.statics.equilibrium", "fem.statics.newton"),
)
