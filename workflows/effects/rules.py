"""Which effects a scene has: each as it asks for it, or as the effect's own rule says, with the reason in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workflows.effects.definition import Case
from workflows.effects.effect import Effect
from workflows.effects.left_out import Called
from workflows.effects.table import EFFECTS, NAMES, OF_THE_PLATE
from workflows.errors import BadInput
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    from fem.meshes.mesh_sequence import Planform
    from workflows.scene.source import SceneFile


def called_for(scene: Scene, form: Planform | None = None, names: tuple[str, ...] = NAMES) -> dict[str, Called]:
    """Whether the scene calls for each effect, and why (not). `form`: the planform of a plate from a mesh."""
    found: dict[str, Called] = {}
    on: dict[str, bool] = {}
    for name in sorted(names, key=lambda name: len(EFFECTS[name].after)):
        found[name] = EFFECTS[name].called_for(Case(scene, form, on))
        asked = getattr(scene.effects, name)
        on[name] = found[name].called if asked == "auto" else asked is True
    return {name: found[name] for name in names}


def of(source: SceneFile) -> dict[str, Effect]:
    """Every effect of a scene from a file, its mesh read where one is named; see `resolve`."""
    from workflows.scene import plate_mesh

    return resolve(source.scene, source.name, None if source.mesh is None else plate_mesh.planform(source))


def resolve(scene: Scene, file: str | None = None, form: Planform | None = None) -> dict[str, Effect]:
    """Every effect of the scene, decided. `form`: its planform, needed where that is a mesh.

    Raises:
        BadInput: the scene insists on an effect that its own values rule out.
    """
    _check_plate(scene, file)
    for kind in EFFECTS.values():
        if (refusal := kind.refused(scene)) is not None:
            raise BadInput(refusal.problem, file=file, key=refusal.key, value=refusal.value)
    decided = {}
    for name, (called, why, moves) in called_for(scene, form).items():
        asked = getattr(scene.effects, name)
        if asked == "auto":
            decided[name] = Effect(called, why, None if called else moves)
        elif asked is True:
            decided[name] = Effect(True, "asked for by the scene" + ("" if called else f", although {why}"))
        else:
            decided[name] = Effect(False, "switched off by the scene" + (f", although {why}" if called else ""), moves)
    return decided


def _check_plate(scene: Scene, file: str | None) -> None:
    """The effects of a plate need one: a structure's frequency is taken as it is given."""
    for name in OF_THE_PLATE if scene.plate is None else ():
        if getattr(scene.effects, name) is True:
            raise BadInput("the scene has no plate", file=file, key=f"[effects] {name}", value=True)
