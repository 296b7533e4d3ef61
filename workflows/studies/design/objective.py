"""What a design is worth: the least damping ratio over the amplitudes asked for, at the speed where that is least.

Where the load holds the ball at rest within these amplitudes, it is worth nothing; what is compared then is how far
the cut-off lies above the least amplitude, and of designs beyond a limit, how far beyond.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from workflows.studies.design import space as spaces
from workflows.studies.design.space import Space
from workflows.studies.sweep import blocks, plans, quantities
from workflows.studies.sweep.blocks import QUICK, Placed, Reasons
from workflows.studies.sweep.plates import Plates

if TYPE_CHECKING:
    from damper import ParticleDamper, Working
    from workflows.studies.design.space import Floats

_POINTS = 65
"""Amplitudes, evenly in their logarithm, at which the damping is looked at."""

_BEYOND, _NONE = 100.0, 200.0
"""What a design loses that exceeds a limit, and one that makes no sense."""


@dataclass(frozen=True)
class Scored:
    """What a design is worth.

    Attributes:
        value: the least damping ratio; 0 where the ball rests, or a limit is exceeded.
        score: what is searched for the most of: the value, or less than 0 where that is 0.
        bound: the least of the work bound over the same amplitudes and speeds, as a damping ratio; nan without.
        speed: at which the value is taken [rad/s]; amplitude: at which [m].
        cutoff: the largest over the speeds [m].
        mass: of all balls [kg].
        used: shares of the limits.
        why: why it is worth nothing; empty where it is worth something.
    """

    value: float
    score: float
    bound: float = math.nan
    speed: float = math.nan
    amplitude: float = math.nan
    cutoff: float = math.nan
    mass: float = math.nan
    used: tuple[tuple[str, float], ...] = ()
    why: str = ""

    @property
    def impossible(self) -> bool:
        """Whether it exceeds a limit, or makes no sense."""
        return self.score <= -_BEYOND


def scored(space: Space, shares: Floats, plates: Plates, *, quick: bool) -> list[Scored]:
    """The designs at rows of shares."""
    plan = space.plan(shares)
    speeds = len(space.source.scene.rotor.speeds)
    rows, reasons = quantities.empty(plans.size(plan)), Reasons()
    placed: list[list[Placed]] = [[] for _ in shares]
    for each in blocks.all_placed(space.source, plan, 0, plans.size(plan), plates, rows, reasons):
        placed[each.number // speeds].append(each)
    found = []
    for number, mine in enumerate(placed):
        missing = rows["reason"][number * speeds : (number + 1) * speeds]
        if (missing >= 0).any():
            found.append(Scored(0.0, -_NONE, why=reasons.texts[int(missing.max())]))
        else:
            found.append(_one(space, mine, quick=quick))
    return found


def _one(space: Space, placed: list[Placed], *, quick: bool) -> Scored:
    """A design on its structure at every speed."""
    design, scene = space.design, placed[0].scene
    mass = max(each.damper.ball_mass for each in placed)
    used = tuple(spaces.used(design, scene, mass).items())
    over = spaces.misfit(design, scene, mass)
    if over is not None:
        name, ratio = over
        return Scored(0.0, -_BEYOND - math.log(ratio), mass=mass, used=used, why=f"beyond the limit of {name}")
    low, high = design.amplitude
    dampers = [(each, each.judged) for each in placed]
    cutoff, worst = max((cutoff_of(damper), each.point.omega) for each, damper in dampers)
    bound = min(bound_of(damper, high) for _, damper in dampers)
    if cutoff >= low:
        lost = math.log(cutoff / low) if math.isfinite(cutoff) else _BEYOND / 2
        return Scored(0.0, -lost, bound, worst, low, cutoff, mass, used, "the load holds the ball at rest")
    values = []
    for each, damper in dampers:
        figures = blocks.measured(damper, {}, reach=high, **(QUICK if quick else {}))
        values.append((*least(figures, low, high), each.point.omega))
    value, amplitude, speed = min(values)
    why = "" if value > 0 else "the ball takes nothing"
    return Scored(value, value, bound, speed, amplitude, cutoff, mass, used, why)


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
