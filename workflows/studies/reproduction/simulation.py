"""The paper's scene simulated in both formulations, and the families of curves behind its figures."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from workflows import pipeline
from workflows.effects.definition import Effect
from workflows.progress import Stages
from workflows.scene import load as scene_file
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene
from workflows.solve import damper
from workflows.solve.results import SpeedPoint

if TYPE_CHECKING:
    from damper import ParticleDamper


Floats = npt.NDArray[np.float64]

FORMULATIONS = ("printed", "consistent")
SHOWN = 3
"""10000 rpm, or 21932 g, which the paper calls 22000 g and draws Figs. 2 and 4 to 7 for."""

RELEASE = (20e-3, 5e-3)

TEXTS: dict[str, Any] = tomllib.loads(
    (Path(__file__).parents[2] / "templates" / "paper.toml").read_text(encoding="utf-8")
)
"""Statements, slips and assumptions in words."""


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
        scene, point = _with(self.scene, formulation=formulation), self.plate[SHOWN]
        if mass_ratio is not None and point.reduced is not None:
            changes["ball_mass"] = mass_ratio * point.reduced.M2
        return replace(damper.particle_damper(scene, self.effects, point), **changes)

    def curve(self, label: str, system: ParticleDamper, release: tuple[float, float] = RELEASE) -> DampingCurve:
        """Ring a damper down to rest, cycle by cycle."""
        from damper import capacity, ringdown

        cycles = capacity(ringdown(system, release, max_cycles=20_000))
        clearance = system.stuck_frequency**2 * 2 * system.half_gap[0] / self.gravity
        cutoff = None if cycles.cutoff is None else cycles.cutoff / self.gravity
        ball = cycles.sdc - cycles.intrinsic_sdc
        return DampingCurve(label, cycles.amplitude / self.gravity, cycles.sdc, ball, cutoff, clearance)


def study(stages: Stages) -> Simulated:
    """Solve the paper's plate once and ring both formulations down at every speed."""
    source = scene_file.load("paper")
    structure = pipeline.structure(source, stages, shapes=False)
    points = {}
    for formulation in FORMULATIONS:
        scene = _with(source.scene, formulation=formulation)
        points[formulation] = damper.simulate(scene, structure.effects, structure.points, stages, SHOWN)
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


Family = dict[str, list[DampingCurve]]
"""Curves by formulation."""

MASS_RATIOS = (0.003, 0.006, 0.009, 0.012)
CLEARANCES = (0.25e-3, 0.5e-3, 0.75e-3, 1.0e-3, 1.25e-3)
RELEASES = (12e-3, 16e-3, 20e-3, 24e-3)
RADII = (0.6e-3, 0.8e-3, 1.0e-3, 1.1e-3)


@dataclass(frozen=True, eq=False)
class Sweeps:
    """The families of curves behind Figs. 3 to 7."""

    load: Family
    mass: Family
    cavity: Family
    release: Family
    radius: Family


def sweeps(study: Simulated) -> Sweeps:
    """Compute every curve."""

    def family(curves: Callable[[str], Iterator[DampingCurve]]) -> Family:
        return {formulation: list(curves(formulation)) for formulation in FORMULATIONS}

    def varied(label: str, values: tuple[float, ...], changes: Callable[[float], dict[str, Any]]) -> Family:
        """A curve at 10000 rpm for each value; the label shows it scaled."""
        return family(
            lambda formulation: (
                study.curve(label.format(1e3 * value, 100 * value), study.system(formulation, **changes(value)))
                for value in values
            )
        )

    def load(formulation: str) -> Iterator[DampingCurve]:
        for point in study.points[formulation]:
            d = point.damper
            if d is not None:
                part = d.sdc - d.intrinsic_sdc
                yield DampingCurve(f"{point.load_g:.0f} g", d.amplitude_g, d.sdc, part, d.cutoff_g, 0.0)

    def release(formulation: str) -> Iterator[DampingCurve]:
        return (study.curve(f"{1e3 * x:g} mm", study.system(formulation), (x, x / 4)) for x in RELEASES)

    return Sweeps(
        load=family(load),
        mass=varied("{1:.1f} %", MASS_RATIOS, lambda ratio: {"mass_ratio": ratio}),
        cavity=varied("{0:g} mm", CLEARANCES, lambda gap: {"mass_ratio": 0.012, "cavity": (2e-3 + gap, 2e-3 + gap)}),
        release=family(release),
        radius=varied("{0:g} mm", RADII, lambda radius: {"mass_ratio": 0.01, "ball_radius": radius}),
    )
