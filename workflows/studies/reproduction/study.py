"""The simulations that the claims are judged by: the paper's plate once, and ring-downs on it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from workflows import pipeline
from workflows.effects.effect import Effect
from workflows.progress import Stages
from workflows.scene import file as scene_file
from workflows.scene.scene import Scene
from workflows.scene.source import SceneFile
from workflows.solve import damper_stage as ringdowns
from workflows.solve.records import SpeedPoint

if TYPE_CHECKING:
    from damper import ParticleDamper

Floats = npt.NDArray[np.float64]

FORMULATIONS = ("printed", "consistent")
SHOWN = 3
"""10000 rpm, or 21932 g, which the paper calls 22000 g and draws Figs. 2 and 4 to 7 for."""

RELEASE = (20e-3, 5e-3)


@dataclass(frozen=True, eq=False)
class DampingCurve:
    """One curve of a figure: a value per vibration cycle, from the release to rest.

    `amplitude_g` is the paper's Gamma, `ball` the capacity beyond the structure's own, `sdc` all of it,
    `clearance_g` the paper's dimensionless clearance Delta_x.
    """

    label: str
    amplitude_g: Floats
    sdc: Floats
    ball: Floats
    cutoff_g: float | None
    clearance_g: float


@dataclass(frozen=True, eq=False)
class Simulated:
    """The paper's scene, its structure at the seven speeds, and the ring-downs there in both formulations."""

    scene: Scene
    effects: dict[str, Effect]
    points: dict[str, tuple[SpeedPoint, ...]]
    rest_hz: float

    @property
    def plate(self) -> tuple[SpeedPoint, ...]:
        """The seven speeds, consistent formulation; the structure is the same in both."""
        return self.points["consistent"]

    @property
    def gravity(self) -> float:
        """The paper's g [m/s^2]."""
        return self.scene.rotor.gravity

    def system(self, formulation: str, *, mass_ratio: float | None = None, **changes: Any) -> ParticleDamper:
        """The damper that the run simulates at 10000 rpm, changed.

        Its stiffness is kept, so that curves differ by what was changed alone.
        """
        scene = _with(self.scene, formulation=formulation)
        if mass_ratio is not None:
            scene = _with(scene, mass_ratio=mass_ratio)
        return replace(ringdowns.particle_damper(scene, self.effects, self.plate[SHOWN]), **changes)

    def curve(self, label: str, system: ParticleDamper, release: tuple[float, float] = RELEASE) -> DampingCurve:
        """Ring a damper down to rest, cycle by cycle."""
        from damper import capacity, ringdown

        found = capacity(ringdown(system, release, max_cycles=20_000))
        clearance = system.stuck_frequency**2 * 2 * system.half_gap[0] / self.gravity
        cutoff = None if found.cutoff is None else found.cutoff / self.gravity
        return DampingCurve(
            label, found.amplitude / self.gravity, found.sdc, found.sdc - found.intrinsic_sdc, cutoff, clearance
        )


def study(stages: Stages) -> Simulated:
    """Solve the paper's plate once and ring both formulations down at every speed."""
    source = scene_file.load("paper")
    structure = pipeline.structure(source, stages, shapes=False)
    points = {}
    for formulation in FORMULATIONS:
        scene = _with(source.scene, formulation=formulation)
        points[formulation] = ringdowns.simulate(scene, structure.effects, structure.points, stages, SHOWN)
    rest = pipeline.structure(_at_rest(source), stages, shapes=False).points[0].modes[0].frequency_hz
    return Simulated(source.scene, structure.effects, points, rest)


def _at_rest(source: SceneFile) -> SceneFile:
    return source.changed(rotor=source.scene.rotor.model_copy(update={"speeds": (0.0,)}), damper=None, release=None)


def _with(scene: Scene, **changes: object) -> Scene:
    if scene.damper is None:
        raise ValueError("the paper's scene has a damper")
    return scene.model_copy(update={"damper": scene.damper.model_copy(update=changes)})


def moving(curve: DampingCurve) -> DampingCurve:
    """The part of a curve in which the ball moved, the first cycle and the one of the cut-off left out."""
    level = curve.cutoff_g or 0.0
    keep = curve.amplitude_g > level * (1 + 1e-9)
    keep[0] = False
    return replace(curve, amplitude_g=curve.amplitude_g[keep], sdc=curve.sdc[keep], ball=curve.ball[keep])


def level(curve: DampingCurve) -> float:
    """Average of the ball's part while it moved [-]."""
    part = moving(curve).ball
    return float(part.mean()) if len(part) else math.nan
