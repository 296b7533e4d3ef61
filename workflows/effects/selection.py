"""Which effects a scene has: each as it asks for it, or as the effect's own rule says, with the reason in words."""

from collections.abc import Mapping

from fem.meshes.mesh_sequence import Planform
from workflows.effects import ball, plate
from workflows.effects.definition import AT_REST, GIVEN, NO_DAMPER, Called, Case, Effect
from workflows.errors import BadInput
from workflows.scene.scene import Effects, Scene

EFFECTS = {name: (plate.EFFECTS | ball.EFFECTS)[name] for name in Effects.model_fields}
"""In the order of the scene's keys: those of the plate, then those of the ball."""

NAMES = tuple(EFFECTS)
"""Of all effects."""

OF_THE_PLATE = tuple(name for name, kind in EFFECTS.items() if kind.of == "plate")
OF_THE_DAMPER = tuple(name for name, kind in EFFECTS.items() if kind.of == "damper")


SOLID = {name: Called(True, "always on for solid blades") for name in OF_THE_PLATE} | {
    "large_deflection": Called(True, "the load bends and untwists a blade"),
    "coriolis": Called(False, "for solid blades it is only estimated, as an error of each frequency"),
}
"""What is settled for a solid blade; large deflection by its state where that is solved."""


def called_for(
    scene: Scene,
    form: Planform | None = None,
    names: tuple[str, ...] = NAMES,
    settled: Mapping[str, Called] | None = None,
) -> dict[str, Called]:
    """Whether the scene calls for each effect, and why (not).

    form: the planform of a plate from a mesh. settled: of a solid blade, beyond `SOLID`.
    """
    solid = {} if scene.blade is None else SOLID | dict(settled or {})
    calls: dict[str, Called] = {}
    on: dict[str, bool] = {}
    for name in sorted(names, key=lambda name: len(EFFECTS[name].after)):
        kind, case = EFFECTS[name], Case(scene, form, on)
        if kind.of == "damper" and scene.damper is None:
            calls[name] = NO_DAMPER
        elif kind.spins and name not in solid and not (scene.plate is not None and case.spins):
            calls[name] = GIVEN if scene.plate is None else AT_REST
        else:
            calls[name] = solid[name] if name in solid else kind.called_for(case)
        switch = getattr(scene.effects, name)
        on[name] = calls[name].called if switch == "auto" else switch is True
    return {name: calls[name] for name in names}


def resolve(
    scene: Scene,
    file: str | None = None,
    form: Planform | None = None,
    settled: Mapping[str, Called] | None = None,
    names: tuple[str, ...] = NAMES,
) -> dict[str, Effect]:
    """Every effect of the scene, decided. `form`: its planform, needed where that is a mesh; settled: see `called_for`.

    Raises:
        BadInput: the scene insists on an effect that its own values rule out.
    """
    _check_plate(scene, file)
    for name in names:
        if getattr(scene.effects, name) is True and (refusal := EFFECTS[name].refused(scene)) is not None:
            key = refusal.key or f"[effects] {name}"
            raise BadInput(refusal.problem, file=file, key=key, value=refusal.value)
    effects = {}
    for name, (called, why, moves) in called_for(scene, form, names, settled).items():
        switch = getattr(scene.effects, name)
        if switch == "auto":
            effects[name] = Effect(called, why, None if called else moves)
        elif switch is True:
            effects[name] = Effect(True, "requested by the scene" + ("" if called else f", although {why}"))
        else:
            effects[name] = Effect(False, "switched off by the scene" + (f", although {why}" if called else ""), moves)
    return effects


def _check_plate(scene: Scene, file: str | None) -> None:
    """The effects of a plate need one: a structure's frequency is taken as it is given."""
    for name in OF_THE_PLATE if scene.plate is None else ():
        switch = getattr(scene.effects, name)
        if scene.blade is not None and name != "large_deflection" and switch not in ("auto", SOLID[name].called):
            raise BadInput(f"{SOLID[name].why}: leave this out", file=file, key=f"[effects] {name}", value=switch)
        if scene.blade is None and switch is True:
            raise BadInput("the scene has no plate", file=file, key=f"[effects] {name}", value=True)
