"""What a scene calls for, before any of it is solved; settled once, and handed on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from workflows.effects import rules
from workflows.effects.effect import Effect
from workflows.progress import Stages
from workflows.scene import plate_mesh, thicknesses
from workflows.scene.source import SceneFile
from workflows.solve import theorising
from workflows.solve.answering import answering
from workflows.solve.structure_records import Theory

if TYPE_CHECKING:
    from fem.meshes.mesh_sequence import Planform


@dataclass(frozen=True, eq=False)
class Decided:
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


def decide(source: SceneFile, stages: Stages) -> Decided:
    """Read the scene's mesh, decide its effects and choose the theory of its plate.

    Raises:
        BadInput: the mesh or an effect asked for is no good.
        NoAnswer: the plate is too thin for its theory in double precision.
    """
    scene = source.scene
    if scene.plate is None:
        return Decided(None, rules.resolve(scene, source.name))
    with stages("mesh"):
        sha256, form = source.mesh_sha256, plate_mesh.planform(source)
    with stages("prestress"), answering(source):
        found = rules.resolve(scene, source.name, form)
        theory = theorising.theory(scene, form, found["large_deflection"].on)
    return Decided(form, found, theory, sha256)


def model(source: SceneFile, decided: Decided) -> str:
    """Name of the theory that the scene's plate is solved in, with the layers of a solid."""
    return with_layers(source, *decided.plate)[0]


def with_layers(source: SceneFile, form: Planform, theory: Theory) -> tuple[str, float]:
    """The theory's name with the layers of a solid, and the error that these leave."""
    from fem.theory.registry import solid_theory

    scene = source.scene
    if theory.name != "solid" or scene.plate is None:
        return theorising.model(theory.name, scene), 0.0
    return solid_theory(form.sides[0], thicknesses.spread(scene.plate, form)[2], scene.budget.layers)
