"""What a run takes for granted, in words, with the source of each assumption."""

from __future__ import annotations

from fem.theory.kind import Kind, kind
from workflows.scene import paper
from workflows.scene.materials import KNOWN
from workflows.scene.scene import Scene
from workflows.solve.records import Results

_FLAT = "The centrifugal stress is that of the flat plate; vibrations are small about it."
_BENT = "Vibrations are small about the plate as the load deflects it, by finite rotations; its material is linear."
_MODERATE = (
    "Vibrations are small about the plate as the load bends it, in von Kármán's theory of moderate deflections, which"
    " is off by about 0.4 θ² in frequency where the plate turns by θ."
)


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
            (_prestress(results), "ours"),
        ]
    if scene.damper is not None:
        if scene.damper.ball_material is not None:
            found.append((f"Density of {scene.damper.ball_material}.", KNOWN[scene.damper.ball_material].source))
        found += [
            _structure(results),
            _floor(results),
            ("The ball rolls on the cavity's floor, never lifts off and never slides except at walls.", "paper, II.A"),
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


def _structure(results: Results) -> tuple[str, str]:
    if results.effects["structural_modes"].on:
        text = (
            "The structure vibrates in the modes of the plate that the cavity feels, without Coriolis forces; the"
            " ball's own figures are those in the leading ones, the others damped by 0.1 % or more."
        )
        return text, "ours"
    if results.scene.structure is not None:
        return "The structure vibrates in one mode along each axis.", "paper, II.A"
    return (
        "The structure vibrates in its first bending mode alone, with the same frequency on both axes.",
        "paper, II.A",
    )


def _weight(results: Results) -> list[tuple[str, str]]:
    """What is left out that only a structure at rest would show."""
    if all(point.load_g > 0 for point in results.speeds):
        return []
    return [
        ("The ball's weight is left out: at 0 rpm nothing presses it to its floor, and nothing resists it.", "ours")
    ]


def _floor(results: Results) -> tuple[str, str]:
    if results.effects["floor_tilt"].on:
        return (
            "The cavity's floor tilts with the structure's slope, by small angles; the load is normal to it at rest.",
            "ours",
        )
    return "The cavity's floor stays perpendicular to the load.", "paper, II.A"


def _known(scene: Scene) -> list[tuple[str, str]]:
    """A material that the scene names."""
    name = None if scene.material is None else scene.material.name
    return [] if name is None else [(f"E, ν and ρ of {name}.", KNOWN[name].source)]


def _prestress(results: Results) -> str:
    if not results.effects["large_deflection"].on:
        return _FLAT
    return _MODERATE if results.theory is not None and kind(results.theory.name) is Kind.KIRCHHOFF else _BENT


def _thin(results: Results) -> list[tuple[str, str]]:
    if results.theory is None or results.theory.name != "kirchhoff":
        return []
    return [
        ("The plate is thin: no transverse shear.", "ours: Table II fits it to 0.04 %, and Mindlin's theory to 0.11 %")
    ]
