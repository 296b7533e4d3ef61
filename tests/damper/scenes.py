"""Dampers that several tests share: the paper's, and random ones over the sensible ranges, each with a number."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from damper import Formulation, ParticleDamper, RingDown, ringdown


def paper(load: float = 21932, frequency: float = 269.5, mass_ratio: float = 0.006, **changes: Any) -> ParticleDamper:
    """The damper of the paper's Fig. 3 on a structure of 1 kg; load in g of 10 m/s², frequency in Hz."""
    stiffness = (1 + mass_ratio) * (2 * math.pi * frequency) ** 2
    sides = (2.5e-3, 2.4e-3)
    base = ParticleDamper(1.0, (stiffness, stiffness), mass_ratio, 1e-3, sides, 10.0 * load, 0.5, 0.3, 1e-4)
    return replace(base, **changes)


def simple(**changes: Any) -> ParticleDamper:
    """A ball that nothing presses, in 1 m of room to either side, on a structure of 1 kg and 1 rad/s."""
    base = ParticleDamper(1.0, (1.0, 1.0), 0.05, 1.0, (4.0, 4.0), 0.0, 0.6)
    return replace(base, **changes)


def let_go(damper: ParticleDamper, amplitudes: tuple[float, ...], cycles: float, **more: Any) -> RingDown:
    """A ring-down with its events, of a damper with modes or without."""
    release = {"release": amplitudes} if damper.modes is None else {"release": (0.0, 0.0), "amplitudes": amplitudes}
    return ringdown(damper, cycles=cycles, keep_events=True, **release, **more)


def random_scene(seed: int, slip: float | None = None) -> tuple[ParticleDamper, tuple[float, float]]:
    """A damper and a release, in SI with everything about unit size but for what is drawn.

    With slip, the floor's friction, it obeys the consistent equations.
    """
    rng = np.random.default_rng(seed)
    modal_mass = 10 ** rng.uniform(-2, 1)
    ball_mass = modal_mass * 10 ** rng.uniform(-4, 0)
    omega = 2 * math.pi * 10 ** rng.uniform(1, 3)
    stiffness = (modal_mass + ball_mass) * omega**2
    largest = 10 ** rng.uniform(-4, -2)
    ratio = rng.choice([0.0, rng.uniform(0, 1)], p=[0.15, 0.85])
    radius = 1e-3
    gaps = largest * 10 ** rng.uniform(-2.5, 0.7, 2)
    lever = rng.uniform(0.0, 0.2) * radius
    # the rolling threshold, as a fraction of the largest acceleration at release
    fraction = rng.choice([0.0, 10 ** rng.uniform(-2, 0.1)], p=[0.1, 0.9])
    acceleration = fraction * omega**2 * largest
    load = acceleration * radius / lever if fraction > 0 else rng.choice([0.0, 1e4])
    damper = ParticleDamper(
        modal_mass=modal_mass,
        stiffness=(stiffness, stiffness * rng.choice([1.0, rng.uniform(0.5, 2.0)])),
        ball_mass=ball_mass,
        ball_radius=radius,
        cavity=(2 * (radius + gaps[0]), 2 * (radius + gaps[1])),
        centrifugal_acceleration=float(load),
        restitution=float(rng.choice([0.0, 1.0, rng.uniform(0, 1)], p=[0.05, 0.1, 0.85])),
        friction=float(rng.choice([0.0, rng.uniform(0, 0.6)], p=[0.2, 0.8])),
        rolling_friction=lever if fraction > 0 else 0.0,
        damping_ratio=float(rng.choice([0.0, 10 ** rng.uniform(-4, -0.7)], p=[0.3, 0.7])),
        sticking_ratio=float(rng.choice([1e-2, 10 ** rng.uniform(-4, -1)])),
        formulation=Formulation.CONSISTENT if rng.random() < 0.6 else Formulation.PRINTED,
    )
    if slip is not None:
        damper = replace(damper, formulation=Formulation.CONSISTENT, floor_friction=slip)
    return damper, (largest, ratio * largest)
