"""Coriolis forces: decided from the coupling of the modes found on a coarse mesh; with them modes are complex."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from fem.rotor import in_rpm
from workflows.effects.definition import AT_REST, CELLS_PER_MODE, GIVEN, Called, Case, Definition, LeftOut, everywhere
from workflows.formatting import significant
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    from fem.accuracy.neglected_effects import Turned
    from fem.meshes.mesh_sequence import Planform


def called_for(case: Case) -> Called:
    """Where they move a frequency of a plate that spins by more than the accuracy asked for.

    What moves in the plane of rotation is coupled to the plate's stretching, at w = (pi / 2) (E / rho)^1/2 / L, which
    lowers it by 2 (Omega / w)², two modes in the limit of a low one. Where that is less, and the scene leaves it open,
    the modes are found.

    Raises:
        ValueError: the planform is a mesh, and is not given.
    """
    scene = case.scene
    if scene.plate is None or scene.material is None:
        return GIVEN
    return _moves(scene, case.form, case.on["large_deflection"]) if case.spins else AT_REST


def _moves(scene: Scene, form: Planform | None, large_deflection: bool) -> Called:
    asked, fastest = scene.accuracy.frequency, max(scene.rotor.speeds)
    moved = _by_stretching(scene, form)
    if moved > asked:
        why = f"it lowers frequencies of motion in the plane of rotation by about {_percent(moved)} % at most"
        return Called(
            True,
            f"{why}, more than the {significant(100 * asked)} % asked for",
            everywhere(fastest, moved, scene.rotor.modes),
        )
    if scene.effects.coriolis != "auto":  # what is settled costs nothing
        return Called(False, f"coupled to the plate's stretching it moves frequencies by {_percent(moved)} % at most")
    try:
        found = _solved(scene, form, large_deflection)
    except (ArithmeticError, ValueError, RuntimeError) as error:  # it then also ends the run, with its key
        return Called(False, f"the modes have no solution on a coarse mesh: {error}")
    if found is None:
        return Called(False, "the plate diverges without it")
    largest, omega = found.largest
    why = f"at {in_rpm(omega):.0f} rpm it moves frequencies by up to {_percent(largest)} %"
    beside = f"{'more' if largest > asked else 'less'} than the {significant(100 * asked)} % asked for"
    return Called(largest > asked, f"{why}, {beside}", LeftOut(found.omega, found.shifts))


def _by_stretching(scene: Scene, form: Planform | None) -> float:
    plate, material = scene.plate, scene.material
    length = None if plate is None else plate.length
    if form is not None:
        length = form.sides[0]
    if length is None or material is None:
        raise ValueError("the length of a plate from a mesh is needed")
    stretching = 0.5 * math.pi * math.sqrt(material.youngs_modulus / material.density) / length
    return 2.0 * (max(scene.rotor.speeds) / stretching) ** 2


def _solved(scene: Scene, form: Planform | None, large_deflection: bool) -> Turned | None:
    from fem import Effects
    from fem.accuracy.neglected_effects import turned
    from workflows.scene import plate_mesh

    source = SceneFile(scene, "scene", Path())
    ladder = form or plate_mesh.planform(source)
    mesh = plate_mesh.coarse(ladder, CELLS_PER_MODE * scene.rotor.modes)
    names = ("stress_stiffening", "spin_softening", "rotary_inertia")
    switches = {name: getattr(scene.effects, name) is not False for name in names}
    theory = scene.plate.theory if scene.plate is not None else "auto"
    return turned(
        plate_mesh.plate(source, mesh, ladder),
        plate_mesh.rotor(scene),
        Effects(**switches, large_deflection=large_deflection),
        scene.rotor.speeds,
        scene.rotor.modes,
        "kirchhoff" if theory == "kirchhoff" else "mindlin",
    )


def _percent(part: float) -> str:
    return significant(100 * part, 1)


EFFECT = Definition(
    "plate",
    called_for,
    "Coriolis forces",
    after=("large_deflection",),
    on_the_mesh=False,  # whose errors hardly depend on them, and which they make many times dearer
    costs=("fem.rotor.Rotor.spin", "fem.modes.solve.solve_gyroscopic"),
)
