"""Which effects a scene calls for: one written rule each, and the reason in words."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from workflows.decisions import bending, of_the_ball, theorising, turning
from workflows.decisions.left_out import Called, LeftOut
from workflows.decisions.theorising import Theory
from workflows.errors import BadInput
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    from workflows.scene.file import SceneFile
    from workflows.scene.plate_mesh import Planform
OF_THE_PLATE = ("stress_stiffening", "spin_softening", "coriolis", "large_deflection", "rotary_inertia")


@dataclass(frozen=True)
class Effect:
    """Whether an effect is simulated, why (not), and what it would move where it is not, as far as that is known."""

    on: bool
    why: str
    left_out: LeftOut | None = field(default=None, repr=False, compare=False)


def theory(scene: Scene, form: Planform | None = None, large_deflection: bool = False) -> Theory | None:
    """The plate theory of a scene; None without a plate. `form`: its planform, needed where that is a mesh.

    Raises:
        ValueError: the planform is a mesh, and is not given.
    """
    plate = scene.plate
    if plate is None:
        return None
    if form is None and plate.mesh is not None:
        raise ValueError("the planform of a plate from a mesh is needed")
    return theorising.theory(scene, form, large_deflection)


def called_for(scene: Scene, form: Planform | None = None) -> dict[str, Called]:
    """Whether the scene calls for each effect, and why (not). `form`: the planform of a plate from a mesh."""
    found = {name: Called(*rule(scene)) for name, rule in RULES.items()}
    found |= {name: Called(*rule(scene, form)) for name, rule in OF_THE_BALL.items()}
    found["large_deflection"] = _large_deflection(scene, form)
    asked = scene.effects.large_deflection
    found["coriolis"] = _coriolis(scene, form, found["large_deflection"][0] if asked == "auto" else asked is True)
    return {name: found[name] for name in NAMES}


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
    _check_large_deflection(scene, file)
    _check_slip(scene, file)
    _check_beyond_the_paper(scene, file)
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
    if scene.plate is not None:
        return
    for name in OF_THE_PLATE:
        if getattr(scene.effects, name) is True:
            raise BadInput("the scene has no plate", file=file, key=f"[effects] {name}", value=True)


def _check_large_deflection(scene: Scene, file: str | None) -> None:
    """The bent state is found from the stresses that stiffen it."""
    if scene.effects.large_deflection is True and scene.effects.stress_stiffening is False:
        raise BadInput(
            "needs stress_stiffening, of which it is a part, and that is false",
            file=file,
            key="[effects] large_deflection",
            value=True,
        )


def _check_slip(scene: Scene, file: str | None) -> None:
    """Slip on the floor needs a friction to slip against, and equations that know it."""
    damper = scene.damper
    if damper is None or scene.effects.ball_slip is not True:
        return
    if damper.formulation == "printed":
        raise BadInput("the printed equations know no slip", file=file, key="[effects] ball_slip", value=True)
    if damper.friction == 0:
        raise BadInput("ball_slip needs a friction above 0", file=file, key="[damper] friction", value=0)


def _check_beyond_the_paper(scene: Scene, file: str | None) -> None:
    """What the printed equations do not know, and a structure's own modes where none are known."""
    damper, effects = scene.damper, scene.effects
    for name in ("floor_tilt", "structural_modes"):
        if getattr(effects, name) is True and damper is not None and damper.formulation == "printed":
            problem = "the printed equations know one mode along each axis and a level floor"
            raise BadInput(problem, file=file, key=f"[effects] {name}", value=True)
    pair = () if scene.structure is None else scene.structure.frequency
    if effects.structural_modes is False and len(set(pair)) > 1:
        problem = "belongs to a plate; a pair as [structure] frequency says that the axes differ: leave one of them out"
        raise BadInput(problem, file=file, key="[effects] structural_modes", value=False)
    if effects.structural_modes is True and scene.plate is None:
        problem = "the scene has no plate whose modes these could be"
        raise BadInput(problem, file=file, key="[effects] structural_modes", value=True)


def _spins(scene: Scene) -> bool:
    return any(speed > 0 for speed in scene.rotor.speeds)


def _stress_stiffening(scene: Scene) -> tuple[bool, str]:
    if scene.plate is None:
        return False, "the structure's frequency is given"
    if not _spins(scene):
        if scene.effects.large_deflection is True:
            return True, "nothing spins, but large_deflection, which the scene asks for, needs it"
        return False, "nothing spins"
    return True, "the plate spins, and the centrifugal pull stiffens it"


def _spin_softening(scene: Scene) -> tuple[bool, str]:
    if scene.plate is None:
        return False, "the structure's frequency is given"
    if not _spins(scene):
        return False, "nothing spins"
    if abs(math.sin(scene.rotor.stagger)) > 1e-9:
        return True, "the plate is staggered: its bending moves across the spin axis"
    if abs(math.sin(scene.rotor.precone)) > 1e-9:
        return True, "the plate is coned: its bending moves across the spin axis"
    return (
        True,
        "in-plane modes and, a little, the turning cross-sections of bending move across the spin axis",
    )


def _coriolis(scene: Scene, form: Planform | None, large_deflection: bool) -> Called:
    if scene.plate is None or scene.material is None or not _spins(scene):
        return Called(False, "nothing spins" if scene.plate is not None else "the structure's frequency is given")
    return turning.coriolis(scene, form, large_deflection)


def _large_deflection(scene: Scene, form: Planform | None = None) -> Called:
    if scene.plate is None:
        return Called(False, "the structure's frequency is given")
    if not _spins(scene):
        return Called(False, "nothing spins")
    if scene.effects.stress_stiffening is False:
        return Called(False, "stress_stiffening is off, of which it is a part")
    return bending.large_deflection(scene, form)


def _rotary_inertia(scene: Scene) -> tuple[bool, str]:
    if scene.plate is None:
        return False, "the structure's mass is given"
    return True, "the cross-sections of a thick plate turn as they bend"


RULES = {
    "stress_stiffening": _stress_stiffening,
    "spin_softening": _spin_softening,
    "rotary_inertia": _rotary_inertia,
}
OF_THE_BALL = {
    "rolling_resistance": of_the_ball.rolling_resistance,
    "impact_friction": of_the_ball.impact_friction,
    "ball_slip": of_the_ball.ball_slip,
    "floor_tilt": of_the_ball.floor_tilt,
    "structural_modes": of_the_ball.structural_modes,
}
"""One rule per effect: whether the scene calls for it, and why (not). Large deflection and Coriolis forces, which need
the plate solved, have two of their own."""

NAMES = (*OF_THE_PLATE, *OF_THE_BALL)
