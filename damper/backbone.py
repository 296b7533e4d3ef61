"""Amplitude at resonance without a simulation: damping and frequency of free vibration.

In a cycle of amplitude A a force of height F, a quarter of a period ahead, puts in pi F A; free vibration loses
K A^2 Lambda(A) / 2. Where the motion stays near to one vibration of slowly varying amplitude the two are equal; off
resonance the spring and the inertia, M (omega(A)^2 - nu^2) A, stand beside. The ball may be at rest, roll to and fro
without reaching a wall, or hit the walls, at one and the same amplitude: each is a branch, and may have its answer.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from damper.curve_measurement import damping_curve, in_one_mode, in_wide_cavity, rolling, swinging, undamped
from damper.curves import DampingCurve
from damper.model import number, table
from damper.ringdown import ringdown

if TYPE_CHECKING:
    import numpy.typing as npt

    from damper.model import Floats, ParticleDamper
    from damper.motion import RingDown

_SETTLING, _CYCLES = 12, 24
"""Cycles before and in which the period of free vibration is measured."""

_FIRST, _FEW = 3, 4
"""The same for a ball that rolls to and fro, which begins as it goes on."""

_POINTS = 48
"""Amplitudes at which it is, at most."""

_LOWEST = 1e-3
"""Least amplitude over half the clearance at which a ball that nothing holds is looked at."""

_FAR = 16
"""Largest amplitude over the least at which a ball that loses nothing is looked at while it bounces."""

_SCAN = 1000
"""Amplitudes of a branch looked through for answers to a force."""


class Way(StrEnum):
    """What the ball does."""

    RESTS = "rests"
    ROLLS = "rolls to and fro"
    HITS = "hits the walls"


@dataclass(frozen=True, eq=False)
class Branch:
    """Free vibration while the ball keeps to one way; amplitudes are the cavity's along x [m].

    Attributes:
        way: what the ball does.
        amplitude: ascending, shape (n,) [m].
        damping_ratio: by the ball alone, shape (n,) [-]; below the first amplitude it is as there, beyond the
            last it falls as A^(-4/3): carried by a wall, the ball crosses the gap g in (12 g / A)^(1/3) of a radian.
        frequency: shape (n,) [rad/s]; beyond the last amplitude its distance from the one at rest falls as 1 / A.
        range: amplitudes between which there is such a motion [m].
        at_rest: frequency with the ball at rest [rad/s].
    """

    way: Way
    amplitude: Floats
    damping_ratio: Floats
    frequency: Floats
    range: tuple[float, float]
    at_rest: float

    def at(self, amplitude: Floats) -> tuple[Floats, Floats]:
        """Damping ratio and frequency."""
        place, known = np.log(amplitude), np.log(self.amplitude)
        beyond = np.minimum(1.0, self.amplitude[-1] / amplitude)
        ratio = np.interp(place, known, self.damping_ratio) * beyond ** (4 / 3)
        return ratio, self.at_rest + (np.interp(place, known, self.frequency) - self.at_rest) * beyond


@dataclass(frozen=True, eq=False)
class Backbone:
    """Free vibration along x in the mode that yields most, scaled to 1 at the cavity.

    Attributes:
        mass, stiffness, dashpot: with the ball stuck [kg, N/m, N s/m].
        branches: what the ball may do.
    """

    mass: float
    stiffness: float
    dashpot: float
    branches: tuple[Branch, ...]

    def force(self, branch: Branch, amplitude: Floats, frequency: float | None = None) -> Floats:
        """Height of the force at the cavity along x that keeps up these amplitudes [N]; None: at resonance."""
        ratio, omega = branch.at(amplitude)
        nu = omega if frequency is None else np.full_like(amplitude, frequency)
        lost = self.dashpot * nu + 2 * self.stiffness * ratio
        return np.asarray(amplitude * np.hypot(self.mass * (omega**2 - nu**2), lost))

    def answers(self, force: float, frequency: float | None = None) -> tuple[tuple[float, float], ...]:
        """All amplitudes that a force keeps up, ascending, each with the frequency of free vibration at it.

        Args:
            force: height at the cavity along x [N].
            frequency: of the force [rad/s]; None: at resonance, whatever frequency that is.

        Raises:
            ValueError: the force is not positive and finite.
        """
        if not 0 < number("force", force) < math.inf:
            raise ValueError(f"force must be positive and finite, got {force:g}")
        found: list[tuple[float, float]] = []
        for branch in self.branches:
            scan = self._scan(branch, force, frequency)
            if len(scan) < 2:
                continue
            miss = np.log(self.force(branch, scan, frequency) / force)
            crossed = np.flatnonzero((miss[:-1] < 0) != (miss[1:] < 0))
            share = miss[crossed] / (miss[crossed] - miss[crossed + 1])
            amplitudes = scan[crossed] * (scan[crossed + 1] / scan[crossed]) ** share
            found += zip(amplitudes.tolist(), branch.at(amplitudes)[1].tolist(), strict=True)
        return tuple(sorted(found))

    def peaks(self, force: npt.ArrayLike) -> Floats:
        """The largest amplitude that forces keep up at any frequency [m], shape (n,).

        At resonance an amplitude takes least force: whatever takes no more there than a force gives is met beside it.

        Args:
            force: heights at the cavity along x, shape (n,) [N].

        Raises:
            ValueError: they are not numbers.
        """
        forces = table("force", force)
        largest = np.zeros(len(forces))
        for branch in self.branches:
            scans = [self._scan(branch, each, None) for each in (float(forces.min()), float(forces.max()))]
            ends = [end for end in branch.range if 0 < end < math.inf]
            scan = np.unique(np.concatenate([*scans, branch.amplitude, ends]))
            scan = scan[(scan >= branch.range[0]) & (scan <= branch.range[1])]
            needed = self.force(branch, scan)
            least = np.minimum.accumulate(needed[::-1])[::-1]  # that this amplitude or a larger one takes
            last = np.searchsorted(least, forces, side="right") - 1
            after = np.minimum(last + 1, len(scan) - 1)
            with np.errstate(divide="ignore", invalid="ignore"):
                share = np.log(forces / needed[last]) / np.log(needed[after] / needed[last])
            share = np.where(after > last, np.clip(share, 0.0, 1.0), 0.0)
            amplitude = scan[last] * (scan[after] / scan[last]) ** share
            largest = np.maximum(largest, np.where(last >= 0, amplitude, 0.0))
        return largest

    def _scan(self, branch: Branch, force: float, frequency: float | None) -> Floats:
        """Amplitudes of a branch between which all answers lie, closely."""
        nu = branch.frequency.max() if frequency is None else frequency
        stiffest = self.stiffness + self.mass * nu**2 + self.dashpot * nu
        low: float = 0.5 * force / (stiffest + self.stiffness * branch.damping_ratio.max())
        linear = force / (self.dashpot * branch.frequency.min()) if self.dashpot > 0 else 0.0
        high = 2 * max(linear, force / stiffest, 1e3 * branch.amplitude[-1] if self.dashpot == 0 else low)
        low, high = max(low, branch.range[0]), min(high, branch.range[1])
        if not low < high:
            return np.zeros(0)
        inside = branch.amplitude[(branch.amplitude > low) & (branch.amplitude < high)]
        return np.unique([*np.geomspace(low, high, _SCAN), *inside])


def backbone(damper: ParticleDamper, *, threads: int | None = None) -> Backbone:
    """Measure a damper's free vibration: damping from sweeps through the amplitudes, periods from ring-downs.

    Args:
        damper: what is measured; the structure's own damping is set aside for it.
        threads: see :func:`damper.ringdowns`.
    """
    growing, bare = damping_curve(damper, threads=threads), undamped(damper)
    branch = growing.descending
    still = np.array([damper.stuck_frequency])
    resting = Branch(Way.RESTS, still / still, 0.0 * still, still, (0.0, growing.cutoff), damper.stuck_frequency)
    rests, rolls = [resting] if growing.cutoff > 0 else [], _rolling(bare, branch.cutoff, threads)
    known = max((each.range[1] for each in rests + rolls), default=0.0)
    if branch.peak == 0 and math.isfinite(branch.cutoff + known):  # bounces and loses nothing
        low = max(known, _LOWEST * bare.half_gap[0])
        branch = DampingCurve(np.geomspace(low, _FAR * low, _POINTS), np.zeros(_POINTS), branch.cutoff)
    hits = [_hitting(bare, branch, known)] if branch.amplitude.size else []
    return Backbone(
        mass=damper.stuck_mass,
        stiffness=damper.stiffness[0],
        dashpot=2 * _own(damper) * math.sqrt(damper.stiffness[0] * damper.modal_mass),
        branches=tuple(rests + hits + rolls) or (resting,),
    )


def _own(damper: ParticleDamper) -> float:
    """Damping ratio of the structure along x."""
    own = None if damper.modes is None else damper.modes[damper.leading(0)].damping_ratio
    return damper.damping_ratio if own is None else own


def _hitting(bare: ParticleDamper, curve: DampingCurve, known: float) -> Branch:
    """What sweeps down through the amplitudes meet, and down to the last amplitude of other motions, `known` [m]."""
    which = np.unique(np.linspace(0, len(curve.amplitude) - 1, _POINTS).astype(int))
    frequency = []
    for amplitude, ratio in zip(curve.amplitude[which], curve.damping_ratio[which], strict=True):
        cycles = max(min(_CYCLES, int(0.4 / (2 * math.pi * ratio)) if ratio > 0 else _CYCLES), 2)
        run = _released(bare, amplitude, min(_SETTLING, cycles) + cycles + 1, (0.0, 0.0))
        frequency.append(_turns(run, min(_SETTLING, cycles)))
    free = np.interp(np.log(curve.amplitude), np.log(curve.amplitude[which]), frequency)
    low = min(max(curve.cutoff, float(curve.amplitude[0]) * (1 - 1e-9)), known)
    return Branch(Way.HITS, curve.amplitude, curve.damping_ratio, free, (low, math.inf), bare.stuck_frequency)


def _rolling(bare: ParticleDamper, cutoff: float, threads: int | None) -> list[Branch]:
    """A ball that rolls to and fro about the middle and reaches no wall, if there is one.

    Up to the amplitude at which its even motion reaches the walls, it is followed without these: as it begins, it may
    meet them at less. Where the load draws it to a wall before, it goes on up to there; in a bowl, up to its first hit.
    """
    gap, share = bare.half_gap[0], bare.inertia_ratio * (1 - bare.tilt_share[0])
    if gap == 0 or bare.lateral_pull[0] != 0 or abs(share) < _LOWEST or not math.isfinite(cutoff):
        return []
    low, high = max(cutoff, _LOWEST * gap), 2 * max(gap / abs(share), cutoff)
    ball = rolling(bare, low, threads)
    if ball.is_centred:
        high, bare = ball.ends, in_wide_cavity(bare, high)
    elif bare.restoring[0, 0] < 0:  # the load draws it to a wall
        high = min(high, ball.last)
    if not low < high:
        return []
    points = []
    amplitudes = np.geomspace(low * (1 + 1e-9), high, _POINTS)
    for amplitude, place, velocity in zip(amplitudes, *swinging(bare, amplitudes), strict=True):
        run = _released(bare, amplitude, _FIRST + _FEW, (place, velocity))
        if run.impacts:
            break
        decrement = np.log(run.peak_velocities[_FIRST] / run.peak_velocities[-1])
        ratio = float(decrement) / (2 * math.pi * (len(run.peak_velocities) - 1 - _FIRST))
        points.append((amplitude, max(ratio, 0.0), _turns(run, _FIRST)))
    if len(points) < 2:
        return []
    amplitude, ratio, frequency = np.array(points).T
    begin = cutoff if cutoff < low else float(amplitude[0])  # a ball that is hardly held rolls at less, too
    return [Branch(Way.ROLLS, amplitude, ratio, frequency, (begin, float(amplitude[-1])), bare.stuck_frequency)]


def _released(bare: ParticleDamper, amplitude: float, cycles: int, ball: tuple[float, float]) -> RingDown:
    """Let go in the mode that yields most along x, the ball in a place and with a velocity along x."""
    place, velocity = ((value, 0.0) for value in ball)
    modes = in_one_mode(bare, np.array([amplitude]))
    each = None if modes is None else tuple(modes[0])
    return ringdown(bare, (amplitude, 0.0), cycles, ball_position=place, ball_velocity=velocity, amplitudes=each)


def _turns(run: RingDown, wait: int) -> float:
    """Frequency of the vibration after so many of its maxima [rad/s]."""
    times = run.peak_times[wait:]
    return 2 * math.pi * (len(times) - 1) / float(times[-1] - times[0])
