"""The amplitude at resonance by a balance: what a force puts in is what free vibration loses.

pi F A = pi A² (c omega + 2 K zeta(A)), zeta the damping ratio by the ball alone. A ball that the load holds well
hits the walls, of which the damping over amplitude tells, or rolls to and fro between them; both may go on side by
side.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from workflows.studies.design.crossed import Crossed
from workflows.studies.sweep.placed import QUICK, measured

if TYPE_CHECKING:
    from damper import ParticleDamper, Working
    from workflows.solve.records import Floats

_HELD, _HELD_IN_A_BOWL = 0.3, 1.0
"""Cut-off over half the clearance from which on the balance speaks for a ball on a flat floor, and in a hollow one."""

_SCAN = 2000
"""Amplitudes looked through."""


def speaks(system: ParticleDamper) -> bool:
    """Whether the load holds a ball well: one that swings freely in a bowl, or rolls far, has other motions as well."""
    gap, left = system.half_gap[0], abs(1 - system.tilt_share[0])
    held = system.rolling_threshold / system.stuck_frequency**2
    return gap > 0 and held >= (_HELD if system.floor_radius is None else _HELD_IN_A_BOWL) * gap * left


def amplitude(here: Crossed, resting: float, *, quick: bool) -> float:
    """The greatest amplitude at a crossing, which is `resting` with the ball at rest [m]."""
    own = here.force / (2 * resting * here.system.stiffness[0])
    figures = measured(here.system, {}, reach=2 * resting, **(QUICK if quick else {}))
    return max(hitting(figures, own, resting), rolling(here.system, own, resting))


def hitting(figures: Working, own: float, resting: float) -> float:
    """The greatest amplitude with a ball that hits the walls [m]; `own`: damping ratio with the ball at rest."""
    if not figures.amplitude.size or resting <= figures.cutoff:
        return resting
    scan = np.geomspace(resting * own / (own + figures.peak), resting, _SCAN)
    ratio = np.interp(np.log(scan), np.log(figures.amplitude), figures.damping_ratio)
    ratio *= np.minimum(1.0, figures.amplitude[-1] / scan)
    ratio[scan <= figures.cutoff] = 0.0
    return _greatest(scan, ratio, own, resting)


def rolling(system: ParticleDamper, own: float, resting: float) -> float:
    """The amplitude with a ball that rolls to and fro and reaches no wall [m]; 0 where it reaches one.

    In a cycle it goes four times as far as `reach` says, and loses 4 m f / beta times that.
    """
    omega, beta = system.stuck_frequency, system.inertia_ratio
    drive = beta * abs(1 - system.tilt_share[0]) * omega**2  # per amplitude
    resistance = beta * system.rolling_threshold
    if drive * resting <= resistance:
        return 0.0
    scan = np.geomspace(resistance / drive, resting, _SCAN)
    reach = scan * drive / omega**2 * reaches(resistance / (drive * scan))
    lost = 4 * reach * system.ball_mass * system.rolling_threshold
    found = _greatest(scan, lost / (2 * math.pi * system.stiffness[0] * scan**2), own, resting)
    return found if np.interp(found, scan, reach) <= system.half_gap[0] else 0.0


def reaches(friction: Floats) -> Floats:
    """How far to either side a mass with dry friction goes on a shaken floor, over what it would without friction.

    Den Hartog (Trans. ASME 53, 1931), `friction` over the largest drive: sqrt(1 - (pi f / 2)²) while it never stops;
    from 1 / sqrt(1 + (pi / 2)²) on it waits at each end, sets off where the drive is f, and stops a while later.
    """
    begin = np.arcsin(np.minimum(friction, 1.0))
    low, high = math.pi - begin, math.pi + begin
    for _ in range(50):
        middle = 0.5 * (low + high)
        moving = np.cos(begin) - np.cos(middle) > friction * (middle - begin)
        low, high = np.where(moving, middle, low), np.where(moving, high, middle)
    turned = low - begin
    way = np.cos(begin) * turned - np.sin(low) + np.sin(begin) - 0.5 * friction * turned**2
    waits = friction * math.hypot(1.0, 0.5 * math.pi) > 1
    return np.where(waits, 0.5 * way, np.sqrt(np.maximum(1 - (0.5 * math.pi * friction) ** 2, 0.0)))


def _greatest(scan: Floats, ratio: Floats, own: float, resting: float) -> float:
    """The greatest of the amplitudes that a force does not only keep up but would raise further."""
    raised = np.flatnonzero(scan * (own + ratio) <= own * resting * (1 + 1e-12))
    return float(scan[raised[-1]]) if raised.size else float(scan[0])
