"""The damper's stage: reduced structure and scene in, one ring-down per speed out."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from workflows.decisions.effects import Effect
from workflows.errors import BadInput
from workflows.scene.scene import Scene
from workflows.solve.records import Damping, Energy, History, Reduced, SpeedPoint
from workflows.stages import Stages
from workflows.wording import whole

if TYPE_CHECKING:
    import damper

_SAMPLES_PER_CYCLE = 40
_SAMPLES_AT_MOST = 4000


def known_structure(scene: Scene, omega: float) -> SpeedPoint:
    """The speed point of a scene without a plate: its frequency and mass are given (K1 = K2 = M1 ω1²)."""
    structure, rotor = scene.structure, scene.rotor
    if structure is None or rotor.radius is None:
        raise ValueError("the scene has no [structure]")
    m2 = structure.mass
    m1 = m2 + ball_mass(scene, m2)
    stiffness = m1 * (2 * math.pi * structure.frequency) ** 2
    f2 = math.sqrt(stiffness / m2) / (2 * math.pi)
    reduced = Reduced(structure.frequency, m1, stiffness, f2, m2, stiffness)
    load = omega**2 * rotor.radius / rotor.gravity
    return SpeedPoint(omega, rpm(omega), rotor.radius, load, reduced=reduced)


def ball_mass(scene: Scene, m2: float) -> float:
    """Mass of all balls together [kg] at an effective mass M2."""
    damper = scene.damper
    if damper is None:
        return 0.0
    return damper.balls if damper.balls is not None else (damper.mass_ratio or 0.0) * m2


def rpm(omega: float) -> float:
    """Revolutions per minute, without the last digits that the conversion leaves behind."""
    return float(f"{omega * 30 / math.pi:.13g}")


def simulate(
    scene: Scene,
    effects: dict[str, Effect],
    points: tuple[SpeedPoint, ...],
    stages: Stages,
    shown: int | None = None,
) -> tuple[SpeedPoint, ...]:
    """Ring down and measure the damper at every speed; the point number `shown` keeps its time history."""
    from damper import working

    with stages("damper", len(points)) as step:
        done = []
        for number, point in enumerate(points):
            system = particle_damper(scene, effects, point)
            damping = _one(scene, system, point, keep=number == shown)
            done.append(replace(point, damping=damping, working=working(system)))
            step.advance(f"{whole(point.rpm)} rpm")
    return tuple(done)


def particle_damper(scene: Scene, effects: dict[str, Effect], point: SpeedPoint) -> damper.ParticleDamper:
    """The damper of a scene on the structure of a speed point.

    The stiffness is K1: the ball, rolling or not, presses on the cavity's floor and stiffens the plate.
    """
    from damper import Formulation, ParticleDamper

    given, reduced = scene.damper, point.reduced
    if given is None or reduced is None:
        raise ValueError("the scene has no [damper]")
    try:
        return ParticleDamper(
            modal_mass=reduced.M2,
            stiffness=(reduced.K1, reduced.K1),
            ball_mass=ball_mass(scene, reduced.M2),
            ball_radius=given.radius,
            cavity=given.cavity,
            centrifugal_acceleration=point.omega**2 * point.radius,
            restitution=given.restitution,
            friction=given.friction if effects["impact_friction"].on else 0.0,
            rolling_friction=given.rolling_friction if effects["rolling_resistance"].on else 0.0,
            damping_ratio=given.damping_ratio,
            sticking_ratio=given.sticking_ratio,
            formulation=Formulation(given.formulation),
            floor_friction=given.friction if effects["ball_slip"].on and point.omega > 0 else None,
        )
    except ValueError as error:
        raise BadInput(str(error), key="[damper]") from error


def released_at(scene: Scene, point: SpeedPoint) -> tuple[float, float]:
    """Displacements [m] at which the structure is let go; accelerations are turned by ω1 with the ball stuck."""
    release, reduced = scene.release, point.reduced
    if release is None or reduced is None:
        raise ValueError("the scene has no [release]")
    if release.displacement is not None:
        return release.displacement
    square = (2 * math.pi * reduced.f1_hz) ** 2
    if release.acceleration is not None:
        return release.acceleration[0] / square, release.acceleration[1] / square
    return (release.ratio or 0.0) * point.omega**2 * point.radius / square, 0.0


def _one(scene: Scene, system: damper.ParticleDamper, point: SpeedPoint, *, keep: bool) -> Damping:
    from damper import capacity, ringdown

    release = released_at(scene, point)
    cycles = scene.release.cycles if scene.release is not None else "auto"
    motion = ringdown(system, release, None if isinstance(cycles, str) else cycles, keep_events=keep, progress=_look_up)
    found, gravity = capacity(motion), scene.rotor.gravity
    best = int(np.nanargmax(found.sdc)) if np.isfinite(found.sdc).any() else None
    cutoff = None if found.cutoff is None else found.cutoff / gravity
    books = motion.energy
    return Damping(
        outcome=str(motion.outcome),
        impacts=motion.impacts,
        events=motion.events,
        duration=motion.duration,
        stopped=motion.last_motion if motion.rested else None,
        ball_mass=system.ball_mass,
        release=release,
        intrinsic_sdc=found.intrinsic_sdc,
        peak_sdc=None if best is None else float(found.sdc[best]),
        peak_sdc_at_g=None if best is None else float(found.amplitude[best]) / gravity,
        cutoff_g=cutoff,
        cutoff_ratio=cutoff / point.load_g if cutoff is not None and point.load_g > 0 else None,
        largest_rolling_demand=motion.largest_rolling_demand,
        amplitude_g=found.amplitude / gravity,
        sdc=found.sdc,
        peak_velocity=found.peak_velocity,
        energy=Energy(
            books.initial, books.final, books.structure, books.rolling, books.impact, books.slip, books.residual
        ),
        history=_history(motion) if keep else None,
    )


def _history(motion: damper.RingDown) -> History:
    from damper import sample

    period = 2 * math.pi / motion.damper.stuck_frequency
    end = min(motion.duration, _SAMPLES_AT_MOST / _SAMPLES_PER_CYCLE * period)
    count = max(2, math.ceil(end / period * _SAMPLES_PER_CYCLE) + 1)
    found = sample(motion, np.linspace(0.0, end, count))
    return History(found.time, found.velocity)


def _look_up(_: float) -> None:
    """Called now and then from inside a ring-down, so that Ctrl-C is heard."""
