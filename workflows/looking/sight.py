"""A thing to look at: its surface, its modes, and what is known of it in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from workflows.errors import BadInput
from workflows.looking.mesh_facts import facts
from workflows.report import figures
from workflows.scene import plate_mesh
from workflows.scene.scene import Scene
from workflows.scene.speeds import typed
from workflows.solve.records import SpeedPoint, Surface
from workflows.wording import amount

_SAME = 1e-3
"""Relative difference up to which two speeds are one."""


@dataclass(frozen=True, eq=False)
class Sight:
    """What is shown.

    Attributes:
        title: in a line.
        surface: with or without shapes; `speeds` are those that `surface.at` counts.
        mark: where the damper is (x, y) [m]; None where there is none.
        thickness: of the whole plate [m]; None where it varies or is not known.
        root: what the root is, in words.
        facts: what was understood, name and words of each; `numbers` the same for programs.
    """

    title: str
    surface: Surface
    speeds: tuple[SpeedPoint, ...]
    mark: tuple[float, float] | None
    thickness: float | None
    root: str
    facts: tuple[tuple[str, str], ...]
    numbers: dict[str, Any]


def of_plate(
    scene: Scene, surface: Surface, speeds: tuple[SpeedPoint, ...], known: tuple[tuple[str, str], ...]
) -> Sight:
    """The plate of a scene that has one, as it was solved; `known` stands before what is said of its mesh."""
    thickness = None if scene.plate is None else scene.plate.thickness
    words, numbers = facts(surface)
    return Sight(
        title=scene.title,
        surface=surface,
        speeds=speeds,
        mark=None if scene.damper is None else plate_mesh.damper_at(scene, surface.points.T[:2]),
        thickness=thickness if isinstance(thickness, float) else None,
        root=figures.held(scene),
        facts=(*known, *words),
        numbers=numbers,
    )


def chosen(sight: Sight, rpm: float | None, mode: int) -> tuple[int, int]:
    """Which speed of the run (`SpeedPoint`) and which mode, from 0, are asked for; the middle speed by default.

    Raises:
        BadInput: there is no such mode, or no shape was kept at that speed.
    """
    at = sight.surface.at
    if not at:
        if rpm is not None:
            raise BadInput("a mesh alone has no speeds: leave it out", key="--rpm", value=typed(rpm))
        return 0, 0
    kept = [sight.speeds[number].rpm for number in at]
    row = (len(at) - 1) // 2
    if rpm is not None:
        row = min(range(len(at)), key=lambda k: abs(kept[k] - rpm))
        if abs(kept[row] - rpm) > _SAME * max(rpm, 1.0):
            shown = ", ".join(map(amount, kept))
            raise BadInput(f"expected a speed with shapes: {shown} rpm", key="--rpm", value=typed(rpm))
    count = sight.surface.shapes.shape[1]
    if not 1 <= mode <= count:
        raise BadInput(f"expected a mode from 1 to {count}", key="--mode", value=mode)
    return at[row], mode - 1
