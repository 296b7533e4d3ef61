"""The table of effects: the module of each key of [effects], found by its name."""

from __future__ import annotations

from importlib import import_module

from workflows.effects.definition import Definition
from workflows.scene.rotor import Effects


def _defined(name: str) -> Definition:
    found = import_module(f"workflows.effects.{name}").EFFECT
    if not isinstance(found, Definition):
        raise TypeError(f"workflows.effects.{name} has no EFFECT")
    return found


EFFECTS = {name: _defined(name) for name in Effects.model_fields}
"""In the order of the scene's keys: those of the plate, then those of the ball."""

NAMES = tuple(EFFECTS)
"""Of all effects."""

OF_THE_PLATE = tuple(name for name, kind in EFFECTS.items() if kind.of == "plate")
OF_THE_DAMPER = tuple(name for name, kind in EFFECTS.items() if kind.of == "damper")
