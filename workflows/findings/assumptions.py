"""What a run takes for granted, in words, with the source of each assumption."""

from __future__ import annotations

from fem.theory.registry import kind
from workflows.effects.table import EFFECTS
from workflows.findings import of_the_ball
from workflows.scene import paper
from workflows.scene.materials import KNOWN
from workflows.scene.scene import Scene
from workflows.solve.records import Results


def _held(scene: Scene) -> str:
    if scene.plate is None or scene.plate.root is None:
        return "perfectly clamped"
    return "held by linear springs"


def assumptions(results: Results) -> list[tuple[str, str]]:
    """Pairs of an assumption and where it comes from."""
    scene = results.scene
    found: list[tuple[str, str]] = []
    if scene.plate is not None:
        found += [
            (f"The plate is linear elastic and {_held(scene)} at the root.", "ours"),
            *_known(scene),
            *_of_effects(results, "plate"),
        ]
    if scene.damper is not None:
        if scene.damper.ball_material is not None:
            found.append((f"Density of {scene.damper.ball_material}.", KNOWN[scene.damper.ball_material].source))
        found += [
            *_of_effects(results, "damper"),
            ("Rolling resistance is μ_r N / r on each axis, whatever the speed of rolling.", "paper, eq. 2"),
            ("Wall hits are instantaneous, with constant e and μ.", "paper, eqs. 6 to 11"),
            ("Several balls move in step, each in a cavity of its own.", "ours"),
            *_weight(results),
            ("The load and the rotation speed do not change during a ring-down.", "paper, II.A"),
        ]
        if scene.damper.formulation == "consistent":
            found.append(
                (
                    "The moment of inertia is taken about the contact (7/5 m r²), and the structure feels the whole"
                    " reaction of the ball.",
                    "ours: Newton's laws, where the printed equations do not keep them",
                )
            )
        else:
            found.append(("Equations 2 to 4 as printed, which do not conserve energy.", "paper, eqs. 2 to 4"))
    if any(paper.row(scene, point.load_g) for point in results.speeds):
        found += [
            ("Rotation speeds, hub radius 0 and g = 10 m/s².", "read back from the loads of Table II, to every digit"),
            ("E/ρ of the plate, for ν = 0.3.", "ours: one number fitted to the seven frequencies of Table II"),
            *_thin(results),
        ]
        if scene.damper is not None and scene.damper.damping_ratio:
            found.append((f"ζ = {scene.damper.damping_ratio:g} of the structure.", "ours: the paper prints none"))
    return found


def _weight(results: Results) -> list[tuple[str, str]]:
    """What is left out that a structure shows at rest, or where it turns slowly."""
    if all(point.load_g > 0 for point in results.speeds):
        said = of_the_ball.weight(results)
        return [] if said is None else [(said, "ours")]
    return [
        ("The ball's weight is left out: at 0 rpm nothing presses it to its floor, and nothing resists it.", "ours")
    ]


def _of_effects(results: Results, of: str) -> list[tuple[str, str]]:
    """What effects of the plate, or of the damper, take for granted, on or off."""
    theory = "" if results.theory is None else kind(results.theory.name).value
    found = [
        effect.assumed(results.scene, results.effects[name].on, theory)
        for name, effect in EFFECTS.items()
        if effect.of == of
    ]
    return [(each.text, each.source) for each in found if each is not None]


def _known(scene: Scene) -> list[tuple[str, str]]:
    """A material that the scene names."""
    name = None if scene.material is None else scene.material.name
    return [] if name is None else [(f"E, ν and ρ of {name}.", KNOWN[name].source)]


def _thin(results: Results) -> list[tuple[str, str]]:
    if results.theory is None or results.theory.name != "kirchhoff":
        return []
    return [
        ("The plate is thin: no transverse shear.", "ours: Table II fits it to 0.04 %, and Mindlin's theory to 0.11 %")
    ]
