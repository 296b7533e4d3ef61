"""What the damper is worth at a speed: its own figures with the tilt of its floor, within what the plate endures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from workflows.formatting import significant, whole
from workflows.scene import plate_mesh
from workflows.scene.materials import KNOWN, OSMIUM, is_too_dense
from workflows.solve.results import Floats, Reduced, Results, SpeedPoint, Surface

STRONGEST = 2.4e9
"""Mean stress [Pa] that no blade metal bears: the nominal 0.2 % proof stress of 18Ni2400, the strongest of the maraging
steels (Inco, 18 per cent nickel maraging steels, Nickel Development Institute, publication 4419). Ti-6Al-4V and nickel
alloys bear less than two thirds of it."""

PRINTED = "the equations as printed do not conserve energy"


def refused(results: Results) -> str | None:
    """Why there is no verdict at any speed; None where there may be one."""
    if _printed(results):
        return PRINTED
    dense = too_dense(results)
    return None if dense is None else dense[0]


def is_refused(results: Results, point: SpeedPoint) -> bool:
    """Whether there is no verdict at a speed whatever the damper does there: refused, or the plate torn."""
    return _printed(results) or is_too_dense(_density(results, point)) or torn(results, point)


def _printed(results: Results) -> bool:
    return results.scene.damper is not None and results.scene.damper.formulation == "printed"


def _density(results: Results, point: SpeedPoint) -> float:
    """Of a ball [kg/m³]; 0 without one."""
    damper = results.scene.damper
    if damper is None or point.reduced is None:
        return 0.0
    return damper.density(point.reduced.M1 - point.reduced.M2)


def too_dense(results: Results) -> tuple[str, str] | None:
    """What of a ball is denser than any solid, and what would weigh as much; None where it can be had."""
    damper = results.scene.damper
    density = max((_density(results, point) for point in results.speeds), default=0.0)
    if damper is None or not is_too_dense(density):
        return None
    volume = 4 / 3 * math.pi * damper.radius**3
    one, steel = density * volume, KNOWN["steel"].density
    together = one * damper.count
    return (
        f"a ball of radius {significant(1e3 * damper.radius)} mm and {significant(1e3 * one)} g would be"
        f" {significant(density / OSMIUM, 2)} times as dense as osmium, and nothing is denser",
        f"The figures are those of as heavy balls as can be had, such as {math.ceil(together / (steel * volume))} of"
        " steel ([damper] count), each in a cavity of its own, moving in step.",
    )


def torn(results: Results, point: SpeedPoint) -> bool:
    """Whether the centrifugal pull at the root is more than any blade metal bears."""
    return (pull(results, point.omega) or 0.0) > STRONGEST


def torn_from(results: Results) -> str | None:
    """From which of the speeds on that is so, and by what."""
    lost = [point for point in results.speeds if torn(results, point)]
    if not lost:
        return None
    first = min(lost, key=lambda point: point.omega)
    stress = pull(results, first.omega) or 0.0
    return (
        f"from {whole(first.rpm)} rpm on: there the centrifugal pull at the root, {significant(stress / 1e6)} MPa on"
        f" average, is more than any blade metal bears ({significant(STRONGEST / 1e6)} MPa)"
    )


def pull(results: Results, omega: float) -> float | None:
    """Mean stress over the root's section [Pa]: what hangs on it times its acceleration; None where it is not known."""
    plate, material, rotor = results.scene.plate, results.scene.material, results.scene.rotor
    hung = _hung(results)
    if plate is None or material is None or hung is None:
        return None
    (volume, moment), section = hung
    level = math.cos(rotor.precone)
    stress = material.density * omega**2 * level * (rotor.hub_radius * volume + level * moment) / section
    hangs = level * max(point.radius for point in results.speeds)
    return stress + results.scene.point_mass * omega**2 * hangs / section


def _hung(results: Results) -> tuple[tuple[float, float], float] | None:
    """Volume of the plate and its moment about the root [m³, m^4], and the root's section [m²]."""
    plate = results.scene.plate
    if plate is not None and plate.length is not None and plate.width is not None:
        return plate_mesh.volume(plate), plate_mesh.section(plate)
    if plate is None or results.surface is None:
        return None
    heights = results.surface.thickness
    if heights is None:
        if not isinstance(plate.thickness, float):
            return None
        heights = np.full(len(results.surface.points), plate.thickness)
    return _of_a_mesh(results.surface, heights)


def _of_a_mesh(surface: Surface, heights: Floats) -> tuple[tuple[float, float], float]:
    """The same of a mesh: each cell as triangles about its first corner, exact for even thickness."""
    points, cells = surface.points[:, :2], surface.cells[1]
    x = points[:, 0] - points[:, 0].min()
    triangles = np.vstack([cells[:, [0, k, k + 1]] for k in range(1, cells.shape[1] - 1)])
    one, other = (points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))
    volumes = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2 * heights[triangles].mean(axis=1)
    lengths = np.linalg.norm(np.diff(points[surface.root], axis=1)[:, 0], axis=1)
    section = float((lengths * heights[surface.root].mean(axis=1)).sum())
    return (float(volumes.sum()), float((volumes * x[triangles].mean(axis=1)).sum())), section


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
    if figures is None or not figures.peak > 0 or torn(results, point):
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
    if is_refused(results, point):
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
    return torn(results, point) or (limit is not None and own.peak_amplitude > limit)


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
        return plate_mesh.plate_thickness(plate, (0.0, 0.0)) if plate.length is not None else None
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


_NOTABLE = 1e-3
"""Relative shift of a frequency from which on it is worth a word, whatever the accuracy."""


class Missing(NamedTuple):
    """Mass [kg] that is not there, and the largest relative shift of the first bending frequency over the speeds."""

    mass: float
    shift: float


def sentence(results: Results) -> str | None:
    """What the frequencies leave out, in words; None where that is nothing, or hardly anything."""
    hole, damper = missing(results), results.scene.damper
    if hole is None or damper is None or abs(hole.shift) <= min(_NOTABLE, results.scene.accuracy.frequency):
        return None
    cut = "its cavity is cut" if damper.count == 1 else f"its {damper.count} cavities are cut"
    return (
        f"That is of the plate before {cut}: {significant(1e3 * hole.mass, 2)} g less"
        f" {'raise' if hole.shift > 0 else 'lower'} its first bending frequency by up to about"
        f" {significant(100 * abs(hole.shift), 2)} %."
    )


def missing(results: Results) -> Missing | None:
    """What the cavities take out of the plate; None where there are none in it.

    A hole is a negative point mass where the damper is; the stiffness that goes with it hardly counts where the plate
    hardly bends, as near its tip. Along the radius a cavity holds its ball.
    """
    damper, material = results.scene.damper, results.scene.material
    reduced = [point.reduced for point in results.speeds if point.reduced is not None]
    if damper is None or material is None or damper.housing or not reduced:
        return None
    mass = material.density * damper.count * 2 * damper.radius * damper.cavity[0] * damper.cavity[1]
    return Missing(mass, max((_shift(each, mass) for each in reduced), key=abs))


def _shift(reduced: Reduced, mass: float) -> float:
    """To first order in the mass: less inertia, and less pull, of which the ball's own mass shows how it stiffens."""
    ball = reduced.M1 - reduced.M2
    pull = (reduced.K1 - reduced.K2) / reduced.K2 / ball if ball > 0 else 0.0
    return mass / 2 * (1 / reduced.M2 - pull)


AT_REST, MEANS = "*", "* Up to there a ball at rest stays at rest; the ring-down itself shows no cut-off."
"""Of a number in a table, and what it stands for below."""


class Shown(NamedTuple):
    """Acceleration over g, that over the load, and the mark of one that no ring-down shows; None where not known."""

    g: float | None
    ratio: float | None
    mark: str


def in_g(results: Results, reduced: Reduced, amplitude: float) -> float:
    """Acceleration over g of a vibration of that amplitude [m]."""
    return (2 * math.pi * reduced.f1_hz) ** 2 * amplitude / results.scene.rotor.gravity


def shown(results: Results, point: SpeedPoint) -> Shown:
    """The cut-off at a speed, on the floor of the scene's ring-down."""
    damping, own, reduced = point.damping, point.level or point.working, point.reduced
    if damping is not None and damping.cutoff_g is not None:
        return Shown(damping.cutoff_g, damping.cutoff_ratio, "")
    if own is None or reduced is None or not 0 < own.cutoff < math.inf or point.load_g == 0:
        return Shown(None, None, "")
    g = in_g(results, reduced, own.cutoff)
    return Shown(g, g / point.load_g, AT_REST)


def cutoff_legend(results: Results) -> list[str]:
    """What the mark stands for, where a table has it."""
    return [MEANS] if any(shown(results, point).mark for point in results.speeds) else []
