"""Slips of the paper, each shown by a number that the code computes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from workflows.paper import TABLE_II
from workflows.reproduction.study import RELEASE, SHOWN, Study

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


def slips(study: Study) -> list[Slip]:
    """The slips found."""
    from damper import ball_density, ringdown

    printed, consistent = (study.system(f, damping_ratio=0.0) for f in ("printed", "consistent"))
    gain = ringdown(printed, RELEASE, 20).energy
    reaction = replace(printed, rolling_friction=0.0, friction=0.0, restitution=1.0, sticking_ratio=0.0)
    free = ringdown(reaction, RELEASE, 20).energy
    point = study.plate[SHOWN]
    rest = TABLE_II[0].frequency ** 2 - (point_frequency(study, 0) ** 2 - study.rest_hz**2)
    wrong_top = RELEASE[0] - RELEASE[1]
    return [
        Slip(
            "eq. (2)",
            "Moments are taken about the contact, but the moment of inertia, 2/5 m r², about the centre.",
            printed.inertia_ratio / consistent.inertia_ratio,
            "",
            "times too large an acceleration of the rolling ball: 5/2 instead of 5/7",
        ),
        Slip(
            "eq. (3)",
            "The reaction of the ball's inertia on the structure is missing.",
            100 * (free.final / free.initial - 1),
            "%",
            "change of energy in 20 cycles with elastic walls and neither friction nor damping, where none can be lost",
        ),
        Slip(
            "eqs. (2)-(4)",
            "Together they make energy.",
            100 * (gain.final / gain.initial - 1),
            "%",
            "energy gained in 20 cycles at 21932 g with the paper's parameters and ζ = 0",
        ),
        Slip(
            "Table I",
            "The top wall's criterion reads u_x where it should read u_y.",
            1e3 * wrong_top,
            "mm",
            "by which the wall would be misplaced at the release of 20 mm and 5 mm, in a cavity of 2.4 mm",
        ),
        Slip(
            "III.A",
            "198 Hz at rest does not go with Table II.",
            math.sqrt(rest),
            "Hz",
            "at rest, by the first row of Table II less the computed stiffening",
        ),
        Slip(
            "Table II",
            "g is 10 m/s², without saying so.",
            100 * (point.omega**2 * point.radius / 9.80665 / TABLE_II[SHOWN].load - 1),
            "%",
            "by which the load at 10000 rpm would differ with g = 9.80665 m/s²",
        ),
        Slip(
            "Figs. 3 to 7",
            "The effective particle is no ball.",
            ball_density(consistent, 1) / OSMIUM,
            "",
            "times the density of osmium for a mass ratio of 0.6 % and a radius of 1 mm",
        ),
        Slip(
            "Fig. 1",
            "The cavity only shifts; on a bending plate its floor tilts, and the load pulls the ball back.",
            100 * study.plate[SHOWN].tilt_share,
            "%",
            "of the drive at 10000 rpm that the tilt would take away",
        ),
    ]


def point_frequency(study: Study, number: int) -> float:
    """First frequency at a speed [Hz]."""
    return study.plate[number].modes[0].frequency_hz
