"""Slips of the paper, each shown by a number that the code computes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from workflows.scene.paper import TABLE_II
from workflows.studies.reproduction.study import RELEASE, SHOWN, Simulated

if TYPE_CHECKING:
    from damper import ParticleDamper

OSMIUM = 22_600.0
"""Density of the densest element [kg/m^3]."""


@dataclass(frozen=True)
class Slip:
    """What is wrong, the number that shows it, and what that number is."""

    where: str
    slip: str
    value: float
    unit: str
    meaning: str


def slips(study: Simulated) -> list[Slip]:
    """The slips found, in the order of the paper."""
    return [found(study) for found in (_inertia, _reaction, _energy, _wall, _rest, _gravity, _density, _tilt)]


def _inertia(study: Simulated) -> Slip:
    printed, consistent = study.system("printed"), study.system("consistent")
    return Slip(
        "eq. (2)",
        "Moments are taken about the contact, but the moment of inertia, 2/5 m r², about the centre.",
        printed.inertia_ratio / consistent.inertia_ratio,
        "",
        "times too large an acceleration of the rolling ball: 5/2 instead of 5/7",
    )


def _reaction(study: Simulated) -> Slip:
    printed = study.system("printed", damping_ratio=0.0)
    lossless = replace(printed, rolling_friction=0.0, friction=0.0, restitution=1.0, sticking_ratio=0.0)
    return Slip(
        "eq. (3)",
        "The reaction of the ball's inertia on the structure is missing.",
        _gain(lossless),
        "%",
        "change of energy in 20 cycles with elastic walls and neither friction nor damping, where none can be lost",
    )


def _energy(study: Simulated) -> Slip:
    return Slip(
        "eqs. (2)-(4)",
        "Together they make energy.",
        _gain(study.system("printed", damping_ratio=0.0)),
        "%",
        "energy gained in 20 cycles at 21932 g with the paper's parameters and ζ = 0",
    )


def _gain(system: ParticleDamper) -> float:
    """Energy after 20 cycles over that at the release, less one [%]."""
    from damper import ringdown

    energy = ringdown(system, RELEASE, 20).energy
    return 100 * (energy.final / energy.initial - 1)


def _wall(_study: Simulated) -> Slip:
    return Slip(
        "Table I",
        "The top wall's criterion reads u_x where it should read u_y.",
        1e3 * (RELEASE[0] - RELEASE[1]),
        "mm",
        "by which the wall would be misplaced at the release of 20 mm and 5 mm, in a cavity of 2.4 mm",
    )


def _rest(study: Simulated) -> Slip:
    slowest = study.plate[0].modes[0].frequency_hz
    return Slip(
        "III.A",
        "198 Hz at rest does not go with Table II.",
        math.sqrt(TABLE_II[0].frequency ** 2 - (slowest**2 - study.rest_hz**2)),
        "Hz",
        "at rest, by the first row of Table II less the computed stiffening",
    )


def _gravity(study: Simulated) -> Slip:
    point = study.plate[SHOWN]
    return Slip(
        "Table II",
        "g is 10 m/s², without saying so.",
        100 * (point.omega**2 * point.radius / 9.80665 / TABLE_II[SHOWN].load - 1),
        "%",
        "by which the load at 10000 rpm would differ with g = 9.80665 m/s²",
    )


def _density(study: Simulated) -> Slip:
    from damper import ball_density

    return Slip(
        "Figs. 3 to 7",
        "The effective particle is no ball.",
        ball_density(study.system("consistent"), 1) / OSMIUM,
        "",
        "times the density of osmium for a mass ratio of 0.6 % and a radius of 1 mm",
    )


def _tilt(study: Simulated) -> Slip:
    return Slip(
        "Fig. 1",
        "The cavity only shifts; on a bending plate its floor tilts, and the load pulls the ball back.",
        100 * study.plate[SHOWN].tilt_share,
        "%",
        "of the drive at 10000 rpm that the tilt would take away",
    )
