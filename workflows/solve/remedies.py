"""What would set a resting ball rolling: less rolling friction, a larger ball, a lower speed, a larger amplitude."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from fem.rotor import in_rpm
from workflows.errors import present
from workflows.scene.damper import Damper
from workflows.solve.limits import endured, lever, rim_slope, room
from workflows.solve.results import Reduced, Results, SpeedPoint, VibrationReduction


class Remedy(NamedTuple):
    """What would set a resting ball rolling at a speed, each by itself; nan where it would not.

    Attributes:
        amplitude: above which the simulated forces move the ball [m].
        rolling_friction: up to which they move it at the amplitude that the plate endures [m]; nan where its dent, or
            a floor that leans, holds it.
        radius: of the ball, from which on it does with the same clearance [m]; nan where the plate is too thin for it.
        omega: speed up to which it does [rad/s], nan at one speed alone; about: the same in two digits, rounded down.
        without_dent: amplitude from which on it moves where it lies in no dent [m]; nan where it does not.
    """

    amplitude: float
    rolling_friction: float = math.nan
    radius: float = math.nan
    omega: float = math.nan
    about: float = math.nan
    without_dent: float = math.nan


def what_moves(results: Results, point: SpeedPoint) -> Remedy | None:
    """What would set a resting ball rolling at a speed; None where no load holds it, or nothing drives it.

    It rolls on a level floor where w1² A |1 - tau| > a_c b / r: the acceleration of the structure with the ball stuck,
    without the share of it that the tilt takes, is above the load times the rolling friction over the radius. Without a
    plate no amplitude is known to be the greatest, and there is the least amplitude alone.
    """
    damper, figures, reduced = results.scene.damper, point.damping_curve, point.reduced
    limit = endured(results, point.omega)
    if damper is None or figures is None or reduced is None or not 0 < figures.cutoff < math.inf:
        return None
    if limit == math.inf:
        return Remedy(figures.drives_from)
    ease = limit / figures.drives_from
    dent, lean, rolls = _dent(results, point), _lean(damper, point), lever(results.scene, point) / damper.radius
    slope = dent + lean
    grows = damper.ball_density is not None
    radius = math.nan if slope > 0 else damper.radius * _larger(reduced, point.tilt_share, ease, grows=grows)
    return Remedy(
        figures.drives_from,
        _eased(results, point, ease),
        radius if 2 * radius < room(results.scene) else math.nan,
        *_slower(results, point, partial(endured, results)),
        figures.drives_from * (rolls + lean) / (rolls + slope) if dent > 0 else math.nan,
    )


def friction_that_moves(results: Results, reduction: VibrationReduction) -> float:
    """Rolling friction up to which the ball moves at a crossing, at the greatest level that the plate endures [m].

    With the ball at rest the amplitude goes with the level, and the one that moves it with the rolling friction.
    """
    near = min(results.speeds, key=lambda point: abs(point.omega - reduction.omega))
    return _eased(results, near, reduction.endured_level / reduction.driven_from)


def _dent(results: Results, point: SpeedPoint) -> float:
    """Slope of the dent that holds a ball at rest, as far as it is counted in."""
    return rim_slope(results.scene, point) if results.effects["indentation"].on else 0.0


def _lean(damper: Damper, point: SpeedPoint) -> float:
    """Slope of the load along a floor that does not face it, by which it holds a ball at a wall."""
    rises = 0.0  # the slope of a hollow floor at the wall
    if damper.floor_radius is not None:
        rises = (damper.cavity[0] / 2 - damper.radius) / (damper.floor_radius[0] - damper.radius)
    return max(abs(point.lean[0]) / point.pressing - rises, 0.0)


def _eased(results: Results, point: SpeedPoint, ease: float) -> float:
    """Rolling friction with which so much of the force that moves a resting ball would do [m]; nan: not even none."""
    damper = present(results.scene.damper)
    rolls, slope = lever(results.scene, point) / damper.radius, _dent(results, point) + _lean(damper, point)
    left = ease * (rolls + slope) - slope
    return damper.radius * left if left > 0 or slope == 0 else math.nan


def _larger(reduced: Reduced, tilt_share: float, ease: float, *, grows: bool) -> float:
    """Ratio of radii from which on a ball moves whose drive is so much of what it takes; nan where none does.

    The drive falls where the mass `grows` with the radius: (w1² - G kappa)(ratio), by which the ratio is divided again,
    rises to the smallest solution.
    """
    if not grows or tilt_share >= 1:
        return 1 / ease
    ball, stiffer = reduced.M1 - reduced.M2, reduced.K1 - reduced.K2
    pull = tilt_share * reduced.K1 / reduced.M1
    drive, ratio = (1 - tilt_share) * reduced.K1 / reduced.M1, 1 / ease
    for _ in range(_ROUNDS):
        heavier = ratio**3
        now = (reduced.K2 + stiffer * heavier) / (reduced.M2 + ball * heavier) - pull
        if now <= 0:
            return math.nan
        last, ratio = ratio, drive / now / ease
        if abs(ratio - last) <= 1e-9 * ratio:
            return ratio
    return math.nan


_ROUNDS = 200
"""After which a ratio of radii that still grows has no end."""


def _slower(results: Results, point: SpeedPoint, limit: Callable[[float], float]) -> tuple[float, float]:
    """Speed up to which a ball moves at an amplitude [rad/s], and the same in two digits; nan at one speed alone.

    Drive over resistance, which is the load over the amplitude that moves it, goes with the square of the speed as
    between this speed and its neighbour, and beyond the speed at which the tilt takes all of it is negative. Between a
    speed at which it moves and the next one it lies below that line where a twisted blade untwists: there the amplitude
    goes with a power of the speed, and the lower speed counts. `limit`: the amplitude at a speed [m].
    """
    curves = {each.omega: each.damping_curve for each in results.speeds}
    left = {each.omega: 1 - each.tilt_share for each in results.speeds}
    ease = {w: limit(w) / own.drives_from for w, own in curves.items() if own is not None and own.drives_from > 0}
    if len(ease) < 2 or ease[point.omega] >= 1:
        return math.nan, math.nan
    one, slow = point.omega, max((each for each in ease if each < point.omega and ease[each] > 1), default=0.0)
    other = slow or min((each for each in ease if each != one), key=lambda each: abs(each - one))
    if slow:
        one = min(each for each in ease if each > slow)
    drive, driven = (math.copysign(ease[each] * each**2, left[each]) for each in (one, other))
    slope = (drive - driven) / (one**2 - other**2)
    square = (drive - slope * one**2) / (1 - slope)
    if not 0 < square < point.omega**2:
        return math.nan, math.nan
    omega = math.sqrt(square)
    if slow:
        power = math.log(one / slow) / math.log(ease[slow] / ease[one])
        omega = min(omega, slow * ease[slow] ** power)
    turns = in_rpm(omega)
    unit = 10 ** (math.floor(math.log10(turns)) - 1)
    return omega, max(slow, omega * (unit * (turns // unit) / turns))
