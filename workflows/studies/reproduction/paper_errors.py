"""Slips of the paper, each shown by a number that the code computes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from workflows.scene import plate_mesh
from workflows.scene.paper import TABLE_II
from workflows.studies.reproduction.claims import FORMULATIONS, RELEASE, SHOWN, Floats, Simulated

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


_CYCLES = 20
_STEPS = 40


@dataclass(frozen=True)
class Assumption:
    """An unprinted assumption and its source."""

    name: str
    text: str


ZETA = Assumption("ζ", "ζ = 0.01 of the structure (ours)")
MASS = Assumption("mass", "mass ratio against the whole plate, not its effective mass (ours)")
STEPS = Assumption("steps", "40 steps a cycle, events noticed after the fact (paper, II.B)")
SIGN = Assumption("sign", "friction against the structure's motion instead of the relative one (ours)")
AMPLITUDE = Assumption("component", "amplitude of one axis instead of the resultant (ours)")


@dataclass(frozen=True)
class Closure:
    """A line of the table: damping by everything in % of the energy a cycle, or None where it cannot be had."""

    assumptions: tuple[Assumption, ...]
    printed: float
    consistent: float
    work_bound: float


CASES: tuple[tuple[Assumption, ...], ...] = (
    (),
    (ZETA,),
    (MASS,),
    (STEPS,),
    (STEPS, SIGN),
    (AMPLITUDE,),
    (MASS, STEPS),
    (MASS, STEPS, SIGN),
    (ZETA, STEPS),
    (ZETA, MASS),
    (ZETA, MASS, STEPS),
    (ZETA, MASS, STEPS, SIGN, AMPLITUDE),
)


def closure(study: Simulated) -> list[Closure]:
    """Damping at 21932 g and 20 mm, averaged over 20 cycles or those before rest, for every case."""
    table = []
    for case in CASES:
        printed, consistent = (_velocity(_system(study, formulation, case), case) for formulation in FORMULATIONS)
        bound = _bound(_system(study, "consistent", case), consistent)
        table.append(Closure(case, _damping(printed, case), _damping(consistent, case), bound))
    return table


def _system(study: Simulated, formulation: str, case: tuple[Assumption, ...]) -> ParticleDamper:
    system = study.system(formulation, damping_ratio=0.01 if ZETA in case else 0.0)
    if MASS in case:
        scene, m2 = study.scene, system.modal_mass
        plate, material = scene.plate, scene.material
        if plate is None or material is None or plate.length is None or plate.width is None:
            raise ValueError("the paper's scene has a rectangular plate")
        whole = material.density * plate_mesh.volume(plate)[0]
        system = replace(system, ball_mass=system.ball_mass * whole / m2)
    return system


def _velocity(system: ParticleDamper, case: tuple[Assumption, ...]) -> Floats:
    """The structure's velocity along both axes, shape (cycles, times, 2) [m/s]."""
    from damper import ringdown, sample, stepped_ringdown

    if STEPS in case:
        run = stepped_ringdown(system, RELEASE, _CYCLES, _STEPS, friction_opposes_structure=SIGN in case)
        return run.velocity[1:].reshape(_CYCLES, _STEPS, 2)
    exact = ringdown(system, RELEASE, _CYCLES, keep_events=True)
    fine = 100 * _STEPS
    times = np.linspace(0, exact.duration, _CYCLES * fine + 1)[1:]
    return sample(exact, times).velocity.reshape(_CYCLES, fine, 2)


def _damping(velocity: Floats, case: tuple[Assumption, ...]) -> float:
    """Mean over the cycles of 1 - (V next / V)^2, in %."""
    peaks = np.abs(velocity[:, :, 0]).max(axis=1) if AMPLITUDE in case else _peaks(velocity)
    return 100 * float(np.mean(1 - (peaks[1:] / peaks[:-1]) ** 2))


def _bound(system: ParticleDamper, velocity: Floats) -> float:
    """Mean over the same cycles of the most that the ball can take, in %."""
    from damper import work_bound

    return 100 * float(np.mean([work_bound(system, v / system.stuck_frequency) for v in _peaks(velocity)[:-1]]))


def _peaks(velocity: Floats) -> Floats:
    return np.asarray(np.hypot(velocity[:, :, 0], velocity[:, :, 1]).max(axis=1))
