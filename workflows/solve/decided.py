"""What a scene calls for, before any of it is solved; settled once, and handed on."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING

from workflows.effects import rules
from workflows.effects.effect import Effect
from workflows.scene import plate_mesh
from workflows.scene.source import SceneFile
from workflows.solve import theorising
from workflows.solve.answering import answering
from workflows.solve.structure_records import Theory
from workflows.stages import Stages

if TYPE_CHECKING:
    from fem.meshes.ladder import Planform


@dataclass(frozen=True, eq=False)
class Decided:
    """A scene's planform and the theory of its plate, None without one; its effects; the digest of its mesh file.

    seconds: that it took to decide.
    """

    form: Planform | None
    effects: dict[str, Effect]
    theory: Theory | None = None
    mesh_sha256: str | None = None
    seconds: float = 0.0

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
    began, scene = perf_counter(), source.scene
    if scene.plate is None:
        return Decided(None, rules.resolve(scene, source.name))
    with stages("mesh"):
        sha256, form = source.mesh_sha256, plate_mesh.planform(source)
    with stages("prestress"), answering(source):
        found = rules.resolve(scene, source.name, form)
        theory = theorising.theory(scene, form, found["large_deflection"].on)
    return Decided(form, found, theory, sha256, perf_counter() - began)
