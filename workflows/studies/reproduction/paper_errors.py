"""Errors of the paper, each shown by a number, and what the assumptions that it leaves unsaid make of its damping."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from workflows.scene import plate_mesh
from workflows.scene.materials import OSMIUM
from workflows.scene.paper import TABLE_II
from workflows.studies.reproduction.claims import gain
from workflows.studies.reproduction.simulation import FORMULATIONS, RELEASE, SHOWN, TEXTS, Floats, Simulated

if TYPE_CHECKING:
    from damper import ParticleDamper


@dataclass(frozen=True)
class Slip:
    """What is wrong, the number that shows it, and what that number is."""

    where: str
    slip: str
    value: float
    unit: str
    meaning: str


def slips(study: Simulated) -> tuple[Slip, ...]:
    """The slips, in the order of the paper."""
    from damper import ball_density

    printed, consistent = study.system("printed"), study.system("consistent")
    undamped = study.system("printed", damping_ratio=0.0)
    lossless = replace(undamped, rolling_friction=0.0, friction=0.0, restitution=1.0, sticking_ratio=0.0)
    slowest, shown = study.plate[0].modes[0].frequency_hz, study.plate[SHOWN]
    values = (
        printed.inertia_ratio / consistent.inertia_ratio,
        100 * gain(lossless),
        100 * gain(undamped),
        1e3 * (RELEASE[0] - RELEASE[1]),
        math.sqrt(TABLE_II[0].frequency ** 2 - (slowest**2 - study.rest_hz**2)),
        100 * (shown.omega**2 * shown.radius / 9.80665 / TABLE_II[SHOWN].load - 1),
        ball_density(consistent, 1) / OSMIUM,
        100 * shown.tilt_share,
    )
    return tuple(Slip(value=value, **words) for value, words in zip(values, TEXTS["slips"], strict=True))


_CYCLES = 20
_STEPS = 40


@dataclass(frozen=True)
class Assumption:
    """An unprinted assumption and its source."""

    name: str
    text: str


ZETA, MASS, STEPS, SIGN, AMPLITUDE = (Assumption(name, text) for name, text in TEXTS["closure"].items())


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


def closure(study: Simulated) -> tuple[Closure, ...]:
    """Damping at 21932 g and 20 mm, averaged over 20 cycles or those before rest, for every case."""
    table = []
    for case in CASES:
        printed, consistent = (_velocity(_system(study, formulation, case), case) for formulation in FORMULATIONS)
        bound = _bound(_system(study, "consistent", case), consistent)
        table.append(Closure(case, _damping(printed, case), _damping(consistent, case), bound))
    return tuple(table)


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
