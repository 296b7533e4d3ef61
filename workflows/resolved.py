"""A scene with every default filled in and every choice made, in SI: a scene that can be run again."""

from __future__ import annotations

import json
from typing import Any

from workflows.effects import Effect, Theory
from workflows.scene import Scene


def scene(given: Scene, effects: dict[str, Effect], theory: Theory | None) -> dict[str, Any]:
    """The resolved scene as plain data."""
    data = given.model_dump(mode="json", exclude_none=True)
    data["effects"] = {name: effect.on for name, effect in effects.items()}
    if theory is not None:
        data["plate"]["theory"] = theory.name
    return data


def document(given: Scene, effects: dict[str, Effect], theory: Theory | None) -> dict[str, Any]:
    """What `check --json` prints: the scene and why each effect is on or off."""
    why = {name: {"on": effect.on, "why": effect.why} for name, effect in effects.items()}
    if theory is not None:
        return {"scene": scene(given, effects, theory), "effects": why, "theory": vars(theory)}
    return {"scene": scene(given, effects, theory), "effects": why}


def as_toml(given: Scene, effects: dict[str, Effect], theory: Theory | None) -> str:
    """The resolved scene as TOML, the reasons in comments."""
    lines: list[str] = []
    data = scene(given, effects, theory)
    reasons = {("effects", name): effect.why for name, effect in effects.items()}
    if theory is not None:
        reasons["plate", "theory"] = theory.why
    for key, value in data.items():
        if isinstance(value, dict):
            lines += ["", f"[{key}]"]
            lines += [_line(name, item, reasons.get((key, name))) for name, item in value.items()]
        else:
            lines.append(_line(key, value, None))
    return "\n".join(lines)


def _line(key: str, value: object, reason: str | None) -> str:
    # TOML and JSON write numbers, strings, booleans and lists alike.
    text = f"{key} = {json.dumps(value, ensure_ascii=False)}"
    return f"{text:<28} # {reason}" if reason else text
