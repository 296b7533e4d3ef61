"""Which plate theory a scene takes: the cheapest that is close enough to a solid in the modes asked for."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from workflows.scene import plate_mesh
from workflows.scene.scene import Scene
from workflows.scene.source import SceneFile
from workflows.solve.structure_records import Theory

if TYPE_CHECKING:
    from fem.meshes.mesh_sequence import Planform

CELLS_PER_MODE = 5
"""Cells for each mode of a mesh on which the error of a theory is good to some ten percent of itself."""


def model(theory: str, scene: Scene) -> str:
    """What a scene's theory is in `fem`: Mindlin's plates are clamped as solids are, on a root that holds them."""
    clamped = scene.plate is not None and scene.plate.root is None
    return "mindlin/held" if theory == "mindlin" and clamped else theory


def theory(scene: Scene, form: Planform | None = None, large_deflection: bool = False) -> Theory | None:
    """The plate theory of a scene: as given, or chosen; None without a plate.

    `form`: the plate's planform, needed where that is a mesh.

    Raises:
        ValueError: the planform is a mesh, and is not given.
    """
    given = scene.plate
    if given is None:
        return None
    if form is None and given.mesh is not None:
        raise ValueError("the planform of a plate from a mesh is needed")
    if given.theory != "auto":
        return Theory(given.theory, "asked for by the scene")
    from fem import Effects
    from fem.accuracy.theory_selection import choose_theory

    source = SceneFile(scene, "scene", Path())
    ladder = form or plate_mesh.planform(source)
    plate = plate_mesh.plate(source, plate_mesh.coarse(ladder, CELLS_PER_MODE * scene.rotor.modes), ladder)
    rotor = plate_mesh.rotor(scene)
    stiffened = scene.effects.stress_stiffening is not False
    effects = Effects(stress_stiffening=stiffened, large_deflection=large_deflection and stiffened)
    chosen = choose_theory(plate, rotor, effects, scene.rotor.speeds, scene.rotor.modes, scene.accuracy.frequency)
    return Theory(chosen.name, chosen.why, chosen.model_error)
