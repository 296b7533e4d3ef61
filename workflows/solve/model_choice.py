"""What a scene calls for, before any of it is solved; settled once, and handed on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from workflows.effects import selection
from workflows.effects.definition import Effect
from workflows.progress import Stages
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene
from workflows.solve.error_translation import translated_errors
from workflows.solve.results import Theory

if TYPE_CHECKING:
    from fem.meshes.mesh_sequence import Planform


CELLS_PER_MODE = 5
"""Cells for each mode of a mesh on which the error of a theory is good to some ten percent of itself."""


def theory_model(theory: str, scene: Scene) -> str:
    """What a scene's theory is in `fem`: Mindlin's plates are clamped as solids are, on a root that holds them."""
    clamped = scene.plate is not None and scene.plate.root is None
    return "mindlin/held" if theory == "mindlin" and clamped else theory


def chosen_theory(scene: Scene, form: Planform | None = None, large_deflection: bool = False) -> Theory | None:
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


@dataclass(frozen=True, eq=False)
class ModelChoice:
    """A scene's planform and the theory of its plate, None without one; its effects; the digest of its mesh file."""

    form: Planform | None
    effects: dict[str, Effect]
    theory: Theory | None = None
    mesh_sha256: str | None = None

    @property
    def plate(self) -> tuple[Planform, Theory]:
        """The planform and the theory of a scene that has a plate.

        Raises:
            ValueError: it has none.
        """
        if self.form is None or self.theory is None:
            raise ValueError("the scene has no plate")
        return self.form, self.theory


def choose_model(source: SceneFile, stages: Stages) -> ModelChoice:
    """Read the scene's mesh, decide its effects and choose the theory of its plate.

    Raises:
        BadInput: the mesh or an effect asked for is no good.
        NoAnswer: the plate is too thin for its theory in double precision.
    """
    scene = source.scene
    if scene.plate is None:
        return ModelChoice(None, selection.resolve(scene, source.name))
    with stages("mesh"):
        sha256, form = source.mesh_sha256, plate_mesh.planform(source)
    with stages("prestress"), translated_errors(source):
        found = selection.resolve(scene, source.name, form)
        theory = chosen_theory(scene, form, found["large_deflection"].on)
    return ModelChoice(form, found, theory, sha256)


def model(source: SceneFile, decided: ModelChoice) -> str:
    """Name of the theory that the scene's plate is solved in, with the layers of a solid."""
    return with_layers(source, *decided.plate)[0]


def with_layers(source: SceneFile, form: Planform, theory: Theory) -> tuple[str, float]:
    """The theory's name with the layers of a solid, and the error that these leave."""
    from fem.theory.registry import solid_theory

    scene = source.scene
    if theory.name != "solid" or scene.plate is None:
        return theory_model(theory.name, scene), 0.0
    return solid_theory(form.sides[0], plate_mesh.spread(scene.plate, form)[2], scene.budget.layers)
