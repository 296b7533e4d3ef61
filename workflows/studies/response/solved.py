"""The structure of a scene at whatever speeds, all on one mesh, as a forced response needs it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from workflows.errors import read_from
from workflows.progress import Stages
from workflows.scene.scene import Scene
from workflows.scene.source import SceneFile
from workflows.solve import damper_stage, felt, plate_records
from workflows.solve import plate_stage as plate
from workflows.solve.answering import answering
from workflows.solve.decided import Decided, decide
from workflows.solve.plate_records import Discrete
from workflows.solve.records import CavityMode, Floats, SpeedPoint, Surface

if TYPE_CHECKING:
    import damper

_ACROSS, _FEW_ACROSS = 61, 13
"""Speeds over the whole range, by which crossings are found; fewer where each speed is solved by itself."""


def shaken(source: SceneFile) -> SceneFile:
    """The scene as its forced response is computed, whatever its [effects]: the answer is about the blade.

    The floor of the cavity tilts, and a plate moves in its own modes.
    """
    structure = source.scene.structure
    tilts: bool | str = True if structure is None or any(structure.floor_tilt) else "auto"
    modes: bool | str = True if source.scene.plate is not None else "auto"
    effects = source.scene.effects.model_copy(update={"floor_tilt": tilts, "structural_modes": modes})
    return source.changed(effects=effects)


class Solved:
    """The structure of a scene at whatever speeds, on one mesh."""

    def __init__(self, source: SceneFile, stages: Stages) -> None:
        self.source, self.stages = source, stages
        self.decided: Decided = decide(source, stages)
        self.discrete: Discrete | None = None
        if self.decided.form is not None:
            with answering(source), stages("modes"):
                self.discrete = plate.discretise(source, self.decided, stages)
        self.surface: Surface | None = None

    @property
    def scene(self) -> Scene:
        """What is asked."""
        return self.source.scene

    @property
    def dear(self) -> bool:
        """Whether every speed of the plate is solved by itself."""
        return self.discrete is not None and plate.one_by_one(self.scene, self.discrete.choice.operators)

    def across(self) -> tuple[SpeedPoint, ...]:
        """The structure over the whole range of speeds."""
        speeds = self.scene.rotor.speeds
        return self.at(np.linspace(min(speeds), max(speeds), _FEW_ACROSS if self.dear else _ACROSS))

    def at(self, omega: Floats) -> tuple[SpeedPoint, ...]:
        """Modes and what the damper feels at speeds [rad/s]."""
        if self.discrete is None:
            return tuple(felt.known_structure(self.scene, float(speed)) for speed in omega)
        speeds = tuple(float(speed) for speed in omega)
        source = self.source.changed(rotor=self.scene.rotor.model_copy(update={"speeds": speeds}))
        points, diagram, numbers = plate.points_on(source, self.decided, self.discrete, self.stages)
        if self.surface is None:
            self.surface = plate_records.surface(self.discrete.choice.operators, diagram, numbers[:1], 1)
        return points

    def damper(self, point: SpeedPoint, only: Sequence[CavityMode] | None) -> damper.ParticleDamper:
        """The damper of the scene at a point, on some of the plate's modes."""
        with read_from(self.source.name):
            return damper_stage.particle_damper(self.scene, self.decided.effects, point, only)
