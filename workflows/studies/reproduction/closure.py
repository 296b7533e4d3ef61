"""What could make 14 to 18 % of damping: each thing the paper leaves unsaid, alone and together."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from workflows.scene import thicknesses
from workflows.studies.reproduction.study import FORMULATIONS, RELEASE, Floats, Simulated

if TYPE_CHECKING:
    from damper import ParticleDamper

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
        whole = material.density * thicknesses.volume(plate)[0]
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
