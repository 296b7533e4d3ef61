"""Specific damping capacity of ring-downs, its cut-off and its bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from damper import laws
from damper.model import Floats, number, pair, stuck_decay, whole
from damper.motion import Outcome, RingDown

if TYPE_CHECKING:
    from damper.model import ParticleDamper


@dataclass(frozen=True, eq=False)
class Capacity:
    """Damping cycle by cycle; a cycle runs from one velocity maximum V to the one a vibration period later.

    Attributes:
        peak_velocity: V at each cycle's start, shape (n,) [m/s].
        amplitude: V omega_1, the dynamic acceleration, shape (n,) [m/s^2]; over g it is the paper's Gamma.
        sdc: specific damping capacity 1 - (V_next / V)^2, shape (n,) [-], section II.C of the paper; nan where the
            ball gave the structure more energy than it had: that is a new start, no cycle of a ring-down.
        intrinsic_sdc: what the structure's own damping alone would give [-].
        cutoff: amplitude of the last cycle in which the ball moved [m/s^2]; None if it never moved or never rested.
    """

    peak_velocity: Floats
    amplitude: Floats
    sdc: Floats
    intrinsic_sdc: float
    cutoff: float | None


def capacity(ringdown: RingDown) -> Capacity:
    """Evaluate a ring-down cycle by cycle; cycles that the run did not complete are left out.

    Raises:
        TypeError: what is given is no ring-down.
    """
    if not isinstance(ringdown, RingDown):
        raise TypeError(f"capacity takes what ringdown returns, got {type(ringdown).__name__}")
    damper = ringdown.damper
    v = ringdown.peak_velocities
    start, end = v[:-1], v[1:]
    anew, alive = end > math.sqrt(2.0) * start, start > 0
    sdc = np.where(anew, np.nan, 0.0)
    sdc[alive & ~anew] = 1.0 - (end[alive & ~anew] / start[alive & ~anew]) ** 2
    amplitude = start * damper.stuck_frequency
    cutoff = None
    if ringdown.rested and ringdown.last_motion is not None and len(amplitude):
        last = int(np.searchsorted(ringdown.peak_times[:-1], ringdown.last_motion, side="right")) - 1
        cutoff = float(amplitude[max(last, 0)])
        if ringdown.harmonic is None and ringdown.outcome is Outcome.AT_REST:
            laws.check_cutoff(damper, float(v[max(last, 0) + 1]))
    return Capacity(start, amplitude, sdc, intrinsic_sdc(damper), cutoff)


def intrinsic_sdc(damper: ParticleDamper) -> float:
    """1 - exp(-4 pi decay / frequency) of the structure with the ball stuck [-]."""
    decay, frequency = stuck_decay(damper.parameters)
    return -math.expm1(-4 * math.pi * float(decay[0] / frequency[0]))


def work_bound(damper: ParticleDamper, amplitude: float | tuple[float, float]) -> float:
    """Most that the ball can take of the energy in a cycle at a displacement amplitude [-].

    In the structure's frame the ball feels -m_p u''. From one velocity maximum to the next but one this does the work
    m_p * integral of s du'' (by parts; u'' is zero there). On either axis |s| is at most half the clearance d, and u''
    sweeps four times its amplitude omega^2 A: in all 2 m_p omega_x^2 A_x d_x + 2 m_p omega_y^2 A_y d_y, to leading
    order in m_p / M2, whatever restitution, friction or the number of bounces. Out of (K_x A_x^2 + K_y A_y^2) / 2 that
    is 4 (m_p / M2) d / A for motion along one axis. Of all directions the worst is that in which the amplitudes are as
    the clearances: 4 (m_p / M2) |d| / |A| with equal stiffness on both axes (Cauchy and Schwarz). It is attained in the
    limit of a narrow cavity and a rolling threshold just below the largest acceleration. Kinetic energy that the ball
    keeps from one cycle to another comes on top in the one and is missing in the other.

    Where the floor tilts, or the ball is drawn outwards, it feels -m_p (u'' + E u), which sweeps |1 - tau| of that
    (`ParticleDamper.tilt_share`). A curved floor's pull is a spring of its own and does no work over a cycle.

    Args:
        damper: what is simulated.
        amplitude: along x and along y [m]; or, where the direction is not known, the amplitude along x that has the
            energy of both, such as the largest speed over omega_1: with equal stiffness that of the resultant.

    Raises:
        ValueError: the amplitude is not positive and finite.
    """
    stiffness, clearance = np.array(damper.stiffness), 2 * np.array(damper.half_gap)
    weight = stiffness / stiffness[0]
    # drive of the ball along each axis, in units of omega_x^2, per amplitude along x and y
    drive = np.abs(np.diag(weight) - damper.pull * damper.stuck_mass / stiffness[0])
    share = 4 * damper.ball_mass / damper.modal_mass
    if isinstance(amplitude, tuple):
        size = np.abs(pair("amplitude", amplitude))
        largest = _positive(float(size.max()))
        size = size / largest
        return float(share * clearance @ drive @ size / (weight @ size**2) / largest)
    worst = math.sqrt((clearance @ drive) ** 2 @ (1 / weight))
    return float(share * worst / _positive(number("amplitude", amplitude)))


def _positive(amplitude: float) -> float:
    if not 0 < amplitude < math.inf:
        raise ValueError(f"amplitude must be positive and finite, got {amplitude:g}")
    return amplitude


def ball_density(damper: ParticleDamper, count: int) -> float:
    """Density that each of `count` equal balls must have [kg/m^3]; the densest element has 22,600.

    Raises:
        ValueError: the count is not a whole number from 1 on.
    """
    return damper.ball_mass / whole("count", count) / (4 / 3 * math.pi * damper.ball_radius**3)
