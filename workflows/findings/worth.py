"""What the damper is worth at a speed: its own figures with the tilt of its floor, within what the plate endures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from workflows.findings import possible
from workflows.scene import thicknesses
from workflows.solve.records import Results, SpeedPoint

AIR = (1.4e-3, 4.0e-3)
"""Damping ratios that the air alone gives free-standing turbine blades: 0.14 % (SO-3), 0.14 to 0.26 % (TFE731), 0.21 to
0.40 % (steam); compiled in Fatigue of Aircraft Structures 2022, doi 10.2478/fas-2022-0006, after Kielb and Abhari 2001
and Brown 1981."""

ENDURED = 4e-3
"""Largest vibratory strain that a blade metal endures: Ti-6Al-4V, among the most tolerant, has an endurance limit of
about 500 MPa over a modulus of 114 GPa; steels and aluminium reach half of that."""

SMALL = 0.25
"""Displacement of the tip over the plate's length up to which bending is linear, to 6 %: a cantilever under a load at
its tip, Bisshopp and Drucker, Quart. Appl. Math. 3 (1945) 272."""

MARK, MARKED = "†", "† At a larger amplitude, or a higher speed, than the plate endures"
"""Of a number in a table, and what it stands for below."""

DRY = 1.0
"""Friction that no dry pair of metals in air exceeds for long."""

UNSAID, UNSAID_MEANS = "‡", "‡ A speed that the answer gives no verdict on"
"""Of a number in a table at a speed that has no verdict, and what it stands for below."""

WEIGHT = 1.0
"""Load over g below which the ball's own weight, which the model leaves out, presses it more than the load does."""

_CANTILEVER = 1.8751040687
"""First root of cos x cosh x = -1: the first mode of a uniform cantilever."""


class Grade(IntEnum):
    """How much a damper does, in words; unknown where the model does not hold."""

    UNKNOWN = -1
    NO = 0
    HARDLY = 1
    MODESTLY = 2
    YES = 3


@dataclass(frozen=True)
class Best:
    """The most that the damper does at a speed and an amplitude that the plate endures.

    `limited` where the damper would do more beyond what the plate endures.
    """

    damping_ratio: float
    amplitude: float
    limited: bool


def best(results: Results, point: SpeedPoint) -> Best | None:
    """The most that the damper does at a speed; None where it does nothing."""
    figures = point.working
    if figures is None or not figures.peak > 0 or possible.torn(results, point):
        return None
    limit = endured(results)
    if limit is None or figures.peak_amplitude <= limit:
        return Best(figures.peak, figures.peak_amplitude, limited=False)
    within = figures.damping_ratio[figures.amplitude <= limit]
    if not within.size or within.max() <= 0:
        return None
    at = int(np.argmax(within))
    return Best(float(within[at]), float(figures.amplitude[at]), limited=True)


def grade(results: Results, point: SpeedPoint) -> Grade:
    """How much the damper does at a speed, beside what the air does: as much, a tenth of it, less, nothing.

    Unknown where the plate would tear, the ball's weight is more than the load, or the ball would slide; and of a ball
    that cannot be had.
    """
    if possible.is_refused(results, point):
        return Grade.UNKNOWN
    found = best(results, point)
    if found is None:
        return Grade.NO
    if weighs(point) or slides(results, point, found):
        return Grade.UNKNOWN
    if found.damping_ratio >= AIR[0]:
        return Grade.YES
    return Grade.MODESTLY if found.damping_ratio >= AIR[0] / 10 else Grade.HARDLY


def weighs(point: SpeedPoint) -> bool:
    """Whether the ball's own weight is more than the load."""
    return point.load_g < WEIGHT


def slides(results: Results, point: SpeedPoint, found: Best) -> bool:
    """Whether rolling at the best amplitude takes more friction than any dry pair of metals has."""
    return grip(results, point, found.amplitude) > DRY


def grip(results: Results, point: SpeedPoint, amplitude: float) -> float:
    """Friction on the floor that pure rolling needs at an amplitude, over the normal load; 0 without a load.

    A rolling ball lags behind its floor by 5/7 of what drives it, u'' + G κ u: friction gives it the other 2/7, and
    holds it against 5/7 of the rolling resistance.
    """
    damper = results.scene.damper
    if damper is None or point.reduced is None or point.load_g == 0:
        return 0.0
    drive = (2 * math.pi * point.reduced.f1_hz) ** 2 * abs(1 - point.tilt_share) * amplitude
    resistance = damper.rolling_friction / damper.radius if results.effects["rolling_resistance"].on else 0.0
    return (2 * drive / (point.omega**2 * point.radius) + 5 * resistance) / 7


def endured(results: Results) -> float | None:
    """Amplitude at the cavity [m] that strains the plate's root by what metals endure; None without a plate.

    Of a plate so thin that it would bend beyond small deflections first, the amplitude at which it does.
    """
    strain, length = root_strain(results, 1.0), span(results)
    if strain is None or length is None:
        return None
    return min(ENDURED / strain, SMALL * length / _tip(results, 1.0, length))


def is_beyond(results: Results, point: SpeedPoint) -> bool:
    """Whether the damper's peak lies at an amplitude, or at a speed, that the plate does not endure."""
    limit, own = endured(results), point.working
    if own is None or not own.peak > 0:
        return False
    return possible.torn(results, point) or (limit is not None and own.peak_amplitude > limit)


def mark(results: Results, point: SpeedPoint) -> str:
    """What a table puts beside the damper's figures at a speed; empty where they are as good as the answer."""
    if is_beyond(results, point):
        return MARK
    still = point.load_g == 0 and point.working is not None and point.working.peak > 0
    return UNSAID if still or grade(results, point) is Grade.UNKNOWN else ""


def legend(results: Results) -> list[str]:
    """What the marks in a table over all speeds stand for."""
    met = {mark(results, point) for point in results.speeds if point.working is not None}
    said = {MARK: f"{MARKED}; what is left below that is in the answer above.", UNSAID: f"{UNSAID_MEANS}."}
    return [text for each, text in said.items() if each in met]


def beyond(results: Results) -> str:
    """What a larger amplitude than the plate endures would do to it."""
    strain, limit = root_strain(results, 1.0), endured(results)
    if strain is not None and limit is not None and limit * strain < ENDURED * (1 - 1e-9):
        return f"bend the plate by over {100 * SMALL:g} % of its length, beyond what it can be computed for"
    return f"strain the plate's root by over {100 * ENDURED:g} %, which no blade metal endures in vibration"


def root_strain(results: Results, amplitude: float) -> float | None:
    """Bending strain at the root for an amplitude at the cavity [-], as in a uniform cantilever's first mode at rest.

    The curvature at the root is 3.516 w/L², w the tip's amplitude; where the cavity is not at the tip, the mode's shape
    leads from one to the other. A plate that gets thinner outwards is strained less there, by a third where it tapers
    to half of its thickness.
    """
    plate, damper = results.scene.plate, results.scene.damper
    length, thickness = span(results), _root_thickness(results)
    if plate is None or damper is None or length is None or thickness is None:
        return None
    return thickness / 2 * _CANTILEVER**2 * _tip(results, amplitude, length) / length**2


def _tip(results: Results, amplitude: float, length: float) -> float:
    """Amplitude at the tip for one at the cavity [m]."""
    damper = results.scene.damper
    if damper is None or damper.at is None:
        return amplitude
    inward = min(max(_from_root(results, damper.at[0]) / length, 1e-3), 1.0)
    return amplitude * _shape(1.0) / _shape(inward)


def _root_thickness(results: Results) -> float | None:
    """The greatest thickness at the root [m]; None where it is a mesh's and that is not kept."""
    plate, surface = results.scene.plate, results.surface
    if plate is None:
        return None
    if isinstance(plate.thickness, float):
        return plate.thickness
    if surface is None or surface.thickness is None:
        return thicknesses.at(plate, (0.0, 0.0)) if plate.length is not None else None
    return float(surface.thickness[surface.root].max())


def span(results: Results) -> float | None:
    """The plate's extent from its root outwards [m]."""
    plate = results.scene.plate
    if plate is None or plate.length is not None:
        return None if plate is None else plate.length
    return None if results.surface is None else float(np.ptp(results.surface.points[:, 0]))


def _from_root(results: Results, x: float) -> float:
    return x if results.surface is None else x - float(results.surface.points[:, 0].min())


def _shape(x: float) -> float:
    """First mode of a uniform cantilever at a share x of its length, up to a factor."""
    k = _CANTILEVER
    ratio = (math.cosh(k) + math.cos(k)) / (math.sinh(k) + math.sin(k))
    return math.cosh(k * x) - math.cos(k * x) - ratio * (math.sinh(k * x) - math.sin(k * x))
