"""A scene with every default filled in and every choice made, in SI: a scene that can be run again."""

from __future__ import annotations

import json
from typing import Any

from workflows.cavity import PICTURE
from workflows.effects import Effect
from workflows.errors import one_line
from workflows.materials import KNOWN
from workflows.scene import Scene
from workflows.scene_file import SceneFile
from workflows.theorising import Theory
from workflows.wording import revolutions, significant


def scene(given: Scene, effects: dict[str, Effect], theory: Theory | None) -> dict[str, Any]:
    """The resolved scene as plain data; a material is its numbers, whatever its name."""
    data = given.model_dump(mode="json", exclude_none=True)
    for table, name in (("material", "name"), ("damper", "ball_material")):
        data.get(table, {}).pop(name, None)
    data["effects"] = {name: effect.on for name, effect in effects.items()}
    if theory is not None:
        data["plate"]["theory"] = theory.name
    return data


def document(source: SceneFile, effects: dict[str, Effect], theory: Theory | None, mesh: Any = None) -> dict[str, Any]:
    """What `check --json` prints: the scene, why each effect is on or off, radii [m], remarks on how it is written."""
    root, place, _ = radii(source, mesh)
    found: dict[str, Any] = {
        "scene": scene(source.scene, effects, theory),
        "effects": {name: {"on": effect.on, "why": effect.why} for name, effect in effects.items()},
        "radii": {"root": root, "damper": place},
        "remarks": list(source.remarks),
    }
    return found if theory is None else found | {"theory": vars(theory)}


def heading(source: SceneFile, mesh: Any = None) -> list[str]:
    """What is asked in the words of a person, as comments: speeds in rpm, radii, and how the damper lies."""
    given, (root, place, at) = source.scene, radii(source, mesh)
    lines = [f"{one_line(given.title)}: {revolutions(given.rotor.speeds)}", *source.remarks]
    what = "damper" if given.damper is not None else "tip mass" if given.point_mass else "tip"
    clamped = "" if root is None else f"{_mm(root)} at the clamped root, "
    lines.append(f"Radii from the axis: {clamped}{_mm(place)} at the {what}{at}")
    if given.damper is not None and given.plate is not None:
        lines += ["", *PICTURE.splitlines()]
    return [f"# {line}".rstrip() for line in lines]


def radii(source: SceneFile, mesh: Any) -> tuple[float | None, float, str]:
    """Radii [m] of the clamped root, which a [structure] has not, and of the damper; and its place on the plate."""
    hub = source.scene.rotor.hub_radius
    if source.scene.plate is None:
        return None, source.scene.rotor.radius or 0.0, ""
    from workflows.plate_mesh import root_and_place

    root, (x, y) = root_and_place(source, mesh)
    return hub, hub + (x - root), f" (x = {_mm(x)}, y = {_mm(y)})"


def as_toml(given: Scene, effects: dict[str, Effect], theory: Theory | None) -> str:
    """The resolved scene as TOML, the reasons in comments."""
    lines: list[str] = []
    data = scene(given, effects, theory)
    data["rotor"]["speeds"] = [f"{speed!r} rad/s" for speed in given.rotor.speeds]
    reasons = _sources(given) | {("effects", name): effect.why for name, effect in effects.items()}
    reasons["rotor", "speeds"] = revolutions(given.rotor.speeds)
    if theory is not None:
        reasons["plate", "theory"] = theory.why
    for key, value in data.items():
        if isinstance(value, dict):
            lines += ["", f"[{key}]"]
            lines += [_line(name, item, reasons.get((key, name))) for name, item in value.items()]
        else:
            lines.append(_line(key, value, None))
    return "\n".join(lines)


def _sources(given: Scene) -> dict[tuple[str, str], str]:
    """Where the numbers of materials are from, and what balls of a density weigh."""
    found: dict[tuple[str, str], str] = {}
    material, damper = given.material, given.damper
    if material is not None and material.name is not None:
        found["material", "youngs_modulus"] = f"{material.name}: {KNOWN[material.name].source}"
    if damper is not None and damper.ball_density is not None:
        name = damper.ball_material
        known = "" if name is None else f"{name}: {KNOWN[name].source}; "
        balls = "the ball weighs" if damper.count == 1 else f"{damper.count} balls together weigh"
        found["damper", "ball_density"] = f"{known}{balls} {significant(1e3 * (damper.balls or 0.0))} g"
    return found


def _line(key: str, value: object, reason: str | None) -> str:
    # TOML and JSON write numbers, strings, booleans and lists alike.
    text = f"{key} = {json.dumps(value, ensure_ascii=False)}"
    return f"{text:<28} # {reason}" if reason else text


def _mm(length: float) -> str:
    return f"{1e3 * length:.6g} mm"
