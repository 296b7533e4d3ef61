"""The short way to an amplitude at resonance: damping and frequency of free vibration, against amplitude.

In a cycle of amplitude A a force of height F, a quarter of a period ahead, puts in pi F A; free vibration loses
K A^2 Lambda(A) / 2. Where the motion stays near to one vibration of slowly varying amplitude the two are equal; off
resonance the spring and the inertia, M (omega(A)^2 - nu^2) A, stand beside. Several amplitudes may answer to one force.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from damper.parameters import number
from damper.ringdown import ringdown
from damper.working import undamped, working

if TYPE_CHECKING:
    from damper.arrays import Floats
    from damper.model import ParticleDamper

_SETTLING, _CYCLES = 12, 24
"""Cycles before and in which the period of free vibration is measured."""

_POINTS = 48
"""Amplitudes at which it is, at most."""

_SCAN = 2000
"""Amplitudes looked through for answers to a force."""


@dataclass(frozen=True, eq=False)
class Backbone:
    """Free vibration along x in the mode that yields most; amplitudes are the cavity's [m].

    Attributes:
        mass, stiffness, dashpot: of the mode with the ball stuck, scaled to 1 at the cavity [kg, N/m, N s/m].
        cutoff: amplitude up to which the ball stays at rest in the middle of its cavity [m].
        amplitude: ascending, shape (n,) [m].
        damping_ratio: by the ball alone, shape (n,) [-].
        frequency: shape (n,) [rad/s].
    """

    mass: float
    stiffness: float
    dashpot: float
    cutoff: float
    amplitude: Floats
    damping_ratio: Floats
    frequency: Floats

    def damping(self, amplitude: Floats) -> Floats:
        """Damping ratio by the ball: nothing at rest, and beyond what was measured falling as one over amplitude."""
        if not len(self.amplitude):
            return np.zeros_like(amplitude)
        inside = np.interp(np.log(amplitude), np.log(self.amplitude), self.damping_ratio)
        last = self.amplitude[-1]
        beyond = np.where(amplitude > last, inside * last / amplitude, inside)
        moving: Floats = np.where(amplitude > self.cutoff, beyond, 0.0)
        return moving

    def turns(self, amplitude: Floats) -> Floats:
        """Frequency of free vibration [rad/s]."""
        still = math.sqrt(self.stiffness / self.mass)
        if not len(self.amplitude):
            return np.full_like(amplitude, still)
        free = np.interp(np.log(amplitude), np.log(self.amplitude), self.frequency)
        turns: Floats = np.where(amplitude > self.cutoff, free, still)
        return turns

    def force(self, amplitude: Floats, frequency: float | None = None) -> Floats:
        """Height of the force at the cavity along x that keeps up these amplitudes [N]; None: at resonance."""
        omega = self.turns(amplitude)
        nu = omega if frequency is None else np.full_like(amplitude, frequency)
        lost = self.dashpot * nu + 2 * self.stiffness * self.damping(amplitude)
        force: Floats = amplitude * np.hypot(self.mass * (omega**2 - nu**2), lost)
        return force

    def amplitudes(self, force: float, frequency: float | None = None) -> tuple[float, ...]:
        """All amplitudes that a force keeps up, ascending [m]; none where nothing but the ball damps, and too little.

        Raises:
            ValueError: the force is not positive and finite.
        """
        if not 0 < number("force", force) < math.inf:
            raise ValueError(f"force must be positive and finite, got {force:g}")
        scan = self._scan(force, frequency)
        miss = np.log(self.force(scan, frequency) / force)
        crossed = np.flatnonzero((miss[:-1] < 0) != (miss[1:] < 0))
        share = miss[crossed] / (miss[crossed] - miss[crossed + 1])
        found = scan[crossed] * (scan[crossed + 1] / scan[crossed]) ** share
        return tuple(float(a) for a in found)

    def _scan(self, force: float, frequency: float | None) -> Floats:
        """Amplitudes between which all answers lie, closely; with both sides of the cut-off."""
        nu = math.sqrt(self.stiffness / self.mass) if frequency is None else frequency
        stiffest = self.stiffness + self.mass * nu**2 + self.dashpot * nu
        low = force / (2 * stiffest + 2 * self.stiffness * self.damping_ratio.max(initial=0.0))
        top = self.amplitude[-1] if len(self.amplitude) else low
        high = 2 * max(force / (self.dashpot * nu) if self.dashpot > 0 else 1e3 * top, low, top)
        near = [self.cutoff * (1 - 1e-12), self.cutoff * (1 + 1e-12)] if 0 < self.cutoff < math.inf else []
        return np.unique([*np.geomspace(low, high, _SCAN), *self.amplitude, *near])


def backbone(damper: ParticleDamper, *, threads: int | None = None) -> Backbone:
    """Measure a damper's free vibration: damping from sweeps through the amplitudes, periods from ring-downs.

    Args:
        damper: what is measured; the structure's own damping is set aside for it.
        threads: see :func:`damper.ringdowns`.
    """
    found = working(damper, threads=threads)
    bare = undamped(damper)
    which = np.unique(np.linspace(0, len(found.amplitude) - 1, min(_POINTS, len(found.amplitude))).astype(int))
    amplitude = found.amplitude[which]
    ratio = found.damping_ratio[which]
    frequency = np.array([_frequency(bare, a, r) for a, r in zip(amplitude, ratio, strict=True)])
    free = np.interp(np.log(found.amplitude), np.log(amplitude), frequency) if len(which) else np.zeros(0)
    return Backbone(
        mass=damper.stuck_mass,
        stiffness=damper.stiffness[0],
        dashpot=2 * _own(damper) * math.sqrt(damper.stiffness[0] * damper.modal_mass),
        cutoff=found.cutoff,
        amplitude=found.amplitude,
        damping_ratio=found.damping_ratio,
        frequency=free,
    )


def _own(damper: ParticleDamper) -> float:
    """Damping ratio of the structure along x."""
    own = None if damper.modes is None else damper.modes[damper.leading(0)].damping_ratio
    return damper.damping_ratio if own is None else own


def _frequency(bare: ParticleDamper, amplitude: float, ratio: float) -> float:
    """Of free vibration from an amplitude on, over cycles in which it falls by a third at most [rad/s]."""
    cycles = max(min(_CYCLES, int(0.4 / (2 * math.pi * ratio)) if ratio > 0 else _CYCLES), 2)
    modes = None if bare.modes is None else [0.0] * len(bare.modes)
    if modes is not None and bare.modes is not None:
        modes[bare.leading(0)] = amplitude / bare.modes[bare.leading(0)].shape[0]
    wait = min(_SETTLING, cycles)
    run = ringdown(bare, (amplitude, 0.0), wait + cycles + 1, amplitudes=None if modes is None else tuple(modes))
    times = run.peak_times[wait:]
    return 2 * math.pi * (len(times) - 1) / float(times[-1] - times[0])
