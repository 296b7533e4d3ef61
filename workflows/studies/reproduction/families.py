"""The families of curves behind figures 3 to 7: the ball over load, mass, cavity, release and radius."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from workflows.studies.reproduction.study import FORMULATIONS, DampingCurve, Simulated

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

    def family(make: Callable[[str], Iterator[DampingCurve]]) -> Family:
        return {formulation: list(make(formulation)) for formulation in FORMULATIONS}

    def load(formulation: str) -> Iterator[DampingCurve]:
        for point in study.points[formulation]:
            d = point.damping
            if d is not None:
                part = d.sdc - d.intrinsic_sdc
                yield DampingCurve(f"{point.load_g:.0f} g", d.amplitude_g, d.sdc, part, d.cutoff_g, 0.0)

    def mass(formulation: str) -> Iterator[DampingCurve]:
        for ratio in MASS_RATIOS:
            yield study.curve(f"{100 * ratio:.1f} %", study.system(formulation, mass_ratio=ratio))

    def cavity(formulation: str) -> Iterator[DampingCurve]:
        for clearance in CLEARANCES:
            side = 2e-3 + clearance
            system = study.system(formulation, mass_ratio=0.012, cavity=(side, side))
            yield study.curve(f"{1e3 * clearance:g} mm", system)

    def release(formulation: str) -> Iterator[DampingCurve]:
        for x in RELEASES:
            yield study.curve(f"{1e3 * x:g} mm", study.system(formulation), (x, x / 4))

    def radius(formulation: str) -> Iterator[DampingCurve]:
        for r in RADII:
            system = study.system(formulation, mass_ratio=0.01, ball_radius=r)
            yield study.curve(f"{1e3 * r:g} mm", system)

    return Sweeps(family(load), family(mass), family(cavity), family(release), family(radius))
