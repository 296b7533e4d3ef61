"""From the table [design] to what is searched: axes, and the goal."""

from __future__ import annotations

import math
from typing import Any

from workflows.errors import BadInput
from workflows.findings import possible
from workflows.progress import Stages
from workflows.scene.design import FLAT
from workflows.scene.source import SceneFile
from workflows.studies.design import amplitude
from workflows.studies.design.damping import LeastDamping
from workflows.studies.design.space import NAMES, Space
from workflows.studies.response.solved import shaken
from workflows.studies.response.study import checked
from workflows.studies.sweep import keys
from workflows.studies.sweep.axes import Axis, Spread

_WIDE = 4.0
"""Ratio of a range's ends from which on it is searched in its logarithm."""


def space(source: SceneFile, stages: Stages | None = None) -> Space:
    """The designs that a scene allows.

    With a range of amplitudes they are compared by the least damping over it, else by the amplitude at the crossings.

    Raises:
        BadInput: it has no [design] or no damper to begin with, or one by the printed equations; see also
            :func:`amplitude.of`.
        NoAnswer: the plate has none.
    """
    scene = source.scene
    for name in ("damper", "design"):
        if getattr(scene, name) is None:
            raise BadInput("the table is missing: design needs it", file=source.name, key=f"[{name}]")
    design = scene.design
    if design is None or scene.damper is None:
        raise ValueError("the scene has no [design]")
    if scene.damper.formulation == "printed":
        problem = f"no design makes sense: {possible.PRINTED}; expected 'consistent'"
        raise BadInput(problem, file=source.name, key="[damper] formulation", value=scene.damper.formulation)
    if design.place is not None and scene.plate is None:
        raise BadInput("belongs to a plate", file=source.name, key="[design] place")
    found = []
    for name, table_name in NAMES.items():
        given = getattr(design, table_name)
        if given is not None:
            found.append(_axis(name, given))
    axes = tuple(found)
    if design.amplitude is not None:
        return Space(source, design, axes, LeastDamping(*design.amplitude, tuple(sorted(scene.rotor.speeds))), source)
    checked(source)
    as_shaken = shaken(source)
    return Space(source, design, axes, amplitude.of(as_shaken, stages or Stages(visible=False)), as_shaken)


def _axis(name: str, given: tuple[Any, ...]) -> Axis:
    """A pair is a range, any other list a choice; a ball is drawn by its radius."""
    key = keys.find(name, "[design]")
    values = [math.inf if value == FLAT else value for value in given]
    if name == "damper.radius":
        values = [value / 2 for value in values]
    numbers = all(isinstance(value, int | float) and math.isfinite(value) for value in values)
    if len(values) == 2 and numbers and values[0] < values[1]:
        low, high = map(float, values)
        return Axis(key, (), Spread(low, high, "log" if high > _WIDE * low and not key.whole else "even"))
    return Axis(key, tuple(values))
