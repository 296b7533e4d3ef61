"""The goal of a scene with a range of amplitudes: the least damping ratio over them, at the speed where it is least.

Where the load holds the ball at rest within these amplitudes, it is worth nothing; what is compared then is how far
the cut-off lies above the least amplitude.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from workflows.studies.design.scored import Scored
from workflows.studies.sweep.placed import QUICK, Placed, measured

if TYPE_CHECKING:
    from damper import ParticleDamper, Working

_POINTS = 65
"""Amplitudes, evenly in their logarithm, at which the damping is looked at."""

_NEVER = 50.0
"""What a design loses whose ball nothing drives."""


@dataclass(frozen=True)
class LeastDamping:
    """The most of the least damping ratio from a `low` amplitude at the cavity to a `high` one [m]."""

    low: float
    high: float
    speeds: tuple[float, ...]
    said: ClassVar[str] = "least damping ratio over the amplitudes, at the speed where it is least"

    def worth(self, placed: list[Placed], *, quick: bool) -> Scored:
        """What a damper is worth that is placed on its structure at every speed."""
        low, high = self.low, self.high
        dampers = [(each, each.judged) for each in placed]
        cutoff, worst = max((cutoff_of(damper), each.point.omega) for each, damper in dampers)
        bound = min(bound_of(damper, high) for _, damper in dampers)
        if cutoff >= low:
            lost = math.log(cutoff / low) if math.isfinite(cutoff) else _NEVER
            return Scored(0.0, -lost, bound, worst, low, cutoff, why="the load holds the ball at rest")
        values = []
        for each, damper in dampers:
            figures = measured(damper, {}, reach=high, **(QUICK if quick else {}))
            values.append((*least(figures, low, high), each.point.omega))
        value, amplitude, speed = min(values)
        why = "" if value > 0 else "the ball takes nothing"
        return Scored(value, value, bound, speed, amplitude, cutoff, why=why)


def least(figures: Working, low: float, high: float) -> tuple[float, float]:
    """The least damping ratio between two amplitudes, and where.

    Beyond the curve's upper end it goes on as of a ball that loses the same energy in each cycle, which is less than
    the ball does.
    """
    grid = np.geomspace(low, high, _POINTS)
    if not figures.amplitude.size:
        return 0.0, low
    at, ratio = np.log(figures.amplitude), figures.damping_ratio
    found = np.interp(np.log(grid), at, ratio)
    beyond = grid > figures.amplitude[-1]
    found[beyond] = ratio[-1] * (figures.amplitude[-1] / grid[beyond]) ** 2
    found[grid <= figures.cutoff] = 0.0
    k = int(np.argmin(found))
    return max(float(found[k]), 0.0), float(grid[k])


def cutoff_of(damper: ParticleDamper) -> float:
    """Amplitude up to which the ball stays at rest in the middle of a flat floor [m]; inf where nothing drives it."""
    left = abs(1 - damper.tilt_share[0])
    if left < 1e-3:
        return math.inf
    return damper.rolling_threshold / damper.stuck_frequency**2 / left


def bound_of(damper: ParticleDamper, amplitude: float) -> float:
    """The most that any ball of this mass in this room can do at an amplitude, as a damping ratio."""
    from damper import work_bound

    share = work_bound(damper, (amplitude, 0.0))
    return math.inf if share >= 1 else -math.log1p(-share) / (4 * math.pi)
