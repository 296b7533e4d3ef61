"""What bounds a damper, in numbers: the plate's strength, the floor's friction, the ball's density; and its verdict.

No sentence is made here: the report has them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from damper import contact as contacts
from damper.contact import Contact, Solid
from workflows.errors import present
from workflows.scene import plate_mesh
from workflows.scene.materials import KNOWN, is_too_dense
from workflows.scene.scene import Scene
from workflows.solve.results import ContactFigures, Grade, Pair, Reason, Results, SpeedPoint, Verdict, copy_fields

STRONGEST = 2.4e9
"""Mean stress [Pa] that no blade metal bears: the nominal 0.2 % proof stress of 18Ni2400, the strongest of the maraging
steels (Inco, 18 per cent nickel maraging steels, Nickel Development Institute, publication 4419). Ti-6Al-4V and nickel
alloys bear less than two thirds of it."""

AIR = (1.4e-3, 4.0e-3)
"""Damping ratios that the air alone gives free-standing turbine blades: 0.14 % (SO-3), 0.14 to 0.26 % (TFE731), 0.21 to
0.40 % (steam); compiled in Fatigue of Aircraft Structures 2022, doi 10.2478/fas-2022-0006, after Kielb and Abhari 2001
and Brown 1981."""

FRICTION_DAMPERS = (2e-3, 3.3e-2)
"""Damping ratios by friction dampers: amplification factors of blades with platform dampers of 15 to 250, of which ζ is
half the inverse (Experimental Techniques 2018, doi 10.1007/s40799-018-0248-z); amplitudes fall by 62 to 83 % (doi
10.2478/fas-2022-0006)."""

ENDURED = 4e-3
"""Largest vibratory strain that a blade metal endures: Ti-6Al-4V, among the most tolerant, has an endurance limit of
about 500 MPa over a modulus of 114 GPa; steels and aluminium reach half of that."""

NEGLIGIBLE_STRAIN = 1e-3 * ENDURED
"""Vibratory strain below which damping is left out, since no blade needs it there: 0.5 MPa in Ti-6Al-4V."""

SMALL = 0.25
"""Displacement of the tip over the plate's length up to which bending is linear, to 6 %: a cantilever under a load at
its tip, Bisshopp and Drucker, Quart. Appl. Math. 3 (1945) 272."""

DRY = 1.0
"""Friction that no dry pair of metals in air exceeds for long."""

WEIGHT = 1.0
"""Load over g below which the ball's own weight, which the model leaves out, presses it more than the load does."""

ROUNDING = 1e-12
"""Damping ratio up to which what a cycle takes is rounding of its energy."""


@dataclass(frozen=True)
class Best:
    """The most that the damper does at a speed and an amplitude that the plate endures.

    `limited` where the damper would do more beyond what the plate endures; `useful`: between which amplitudes it does
    at least half as much as its figures' best, as far as the plate endures them; nan where it does not.
    """

    damping_ratio: float
    amplitude: float
    limited: bool
    useful: Pair


def with_verdicts(results: Results) -> Results:
    """The same results with a verdict at each speed at which the damper has figures."""
    speeds = []
    for point in results.speeds:
        pressed = with_contact(results.scene, point)
        speeds.append(pressed if point.damping_curve is None else replace(pressed, verdict=verdict(results, point)))
    return replace(results, speeds=tuple(speeds))


def with_contact(scene: Scene, point: SpeedPoint) -> SpeedPoint:
    """A speed with what its load does to ball and floor, where both have a material."""
    pressed = contact(scene, point)
    return point if pressed is None else replace(point, contact=copy_fields(ContactFigures, pressed))


def solids(scene: Scene) -> tuple[Solid, Solid] | None:
    """What ball and floor are made of; None where the ball has no name, or neither the floor nor the structure.

    A floor without a name is of the structure's material, whose strength is then not known.
    """
    (ball, floor), own = scene.contact_materials, scene.material
    if ball is None or (floor is None and own is None):
        return None
    if floor is None:
        return solid(ball), Solid(present(own).youngs_modulus, present(own).poissons_ratio)
    return solid(ball), solid(floor)


def solid(name: str) -> Solid:
    """A material by its name."""
    known = KNOWN[name]
    strengths = known.yield_strength or math.nan, known.hardness or math.nan
    return Solid(known.youngs_modulus, known.poissons_ratio, *strengths)


def lever(scene: Scene, point: SpeedPoint) -> float:
    """Rolling friction at a speed, μ_r [m]: as given, or by elastic hysteresis."""
    rolling_friction = present(scene.damper).rolling_friction
    if isinstance(rolling_friction, float):
        return rolling_friction
    pressed = contact(scene, point)
    return 0.0 if pressed is None else contacts.rolling_lever(pressed)


def contact(scene: Scene, point: SpeedPoint, made_of: tuple[Solid, Solid] | None = None) -> Contact | None:
    """Of the ball at rest on its floor; None without a load, or where the materials are not known.

    A hollow floor is a sphere of the mean of its curvatures. `made_of`: ball and floor, instead of the scene's.
    """
    pressed = _pressed(scene, point, made_of)
    return None if pressed is None else contacts.resting(*pressed)


def rim_slope(scene: Scene, point: SpeedPoint) -> float:
    """Slope that the resting ball climbs to leave its dent; 0 where that is not known."""
    pressed = _pressed(scene, point)
    slope = 0.0 if pressed is None else contacts.rim_slope(*pressed)
    return 0.0 if math.isnan(slope) else slope


def _pressed(
    scene: Scene, point: SpeedPoint, made_of: tuple[Solid, Solid] | None = None
) -> tuple[float, float, Solid, Solid, float] | None:
    """Load [N], the ball's radius [m], ball, floor, and its radius [m]."""
    damper, made_of = scene.damper, made_of or solids(scene)
    if damper is None or point.reduced is None or point.omega == 0 or made_of is None:
        return None
    load = (point.reduced.M1 - point.reduced.M2) / damper.count * point.omega**2 * point.pressing
    floor = math.inf if damper.floor_radius is None else 2 / sum(1 / radius for radius in damper.floor_radius)
    return load, damper.radius, *made_of, floor


def verdict(results: Results, point: SpeedPoint) -> Verdict:
    """How much the damper does at a speed, beside what the air does: as much, a tenth of it, less, nothing.

    Unknown where the ball's weight is more than the load or the drive, or the ball would slide; inadmissible where the
    plate would tear, ball or floor would flow, no ball is as dense, or the equations do not conserve energy.
    """
    if (reason := inadmissible(results, point)) is not None:
        return Verdict.without_figures(Grade.INADMISSIBLE, reason)
    most = best(results, point)
    reason = Reason.NONE if most is not None else _idle(results, point)
    undriven = most is not None and weight_at(results, point, most.amplitude) > 1
    if undriven or (weight_governs(point) and reason != Reason.FILLED):
        return Verdict.without_figures(Grade.UNKNOWN, Reason.WEIGHT)
    if reason == Reason.SIDEWAYS:
        return Verdict.without_figures(Grade.UNKNOWN, reason)
    if most is None:
        moves = reason in (Reason.LOSSLESS, Reason.NOT_FOUND)
        return Verdict.without_figures(Grade.NEGLIGIBLE if moves else Grade.LOCKED, reason, 0.0)
    if slides(results, point, most.amplitude):
        return Verdict.without_figures(Grade.UNKNOWN, Reason.SLIP)
    grade = Grade.NEGLIGIBLE
    if most.damping_ratio >= AIR[0] / 10:
        grade = Grade.YES if most.damping_ratio >= AIR[0] else Grade.MODEST
    reason = Reason.ENDURANCE if most.limited else Reason.NONE
    return Verdict(grade, most.damping_ratio, most.amplitude, most.useful, reason)


def inadmissible(results: Results, point: SpeedPoint) -> Reason | None:
    """Why there is no verdict at a speed whatever the damper does there; None where there may be one."""
    if results.scene.is_printed:
        return Reason.PRINTED
    if is_too_dense(ball_density(results, point)):
        return Reason.DENSITY
    if is_torn(results, point):
        return Reason.ROOT_STRESS
    pressed = contact(results.scene, point)
    return Reason.CONTACT if pressed is not None and pressed.hardness_ratio >= 1 else None


def energy_loss(damping_ratio: float) -> float:
    """Share of a vibration's energy that a damping ratio takes in a cycle."""
    return -math.expm1(-4 * math.pi * damping_ratio)


def _idle(results: Results, point: SpeedPoint) -> Reason:
    """Why the damper does nothing at a speed."""
    damper, figures = present(results.scene.damper), present(point.damping_curve)
    if damper.fills(0):
        return Reason.FILLED
    limit = endured(results, point.omega)
    if figures.cutoff < limit <= figures.drives_from:
        return Reason.SIDEWAYS
    if math.isinf(figures.drives_from):
        return Reason.TILT
    if figures.cutoff >= limit:
        return Reason.OUT_OF_REACH
    loses = results.effects["ball_slip"].on or (damper.damping_ratio > 0 and len(point.cavity_modes) > 1)
    return Reason.LOSSLESS if damper.lossless and not loses and figures.cutoff == 0 else Reason.NOT_FOUND


def best(results: Results, point: SpeedPoint) -> Best | None:
    """The most that the damper does at a speed; None where it does nothing."""
    figures = point.damping_curve
    if figures is None or not figures.peak > ROUNDING or is_torn(results, point):
        return None
    limit = endured(results, point.omega)
    if limit <= figures.drives_from:
        return None
    low, high = figures.half
    useful = (low, min(high, limit)) if low < limit else (math.nan, math.nan)
    if figures.peak_amplitude <= limit:
        return Best(figures.peak, figures.peak_amplitude, limited=False, useful=useful)
    begins = figures.amplitude[0] > figures.cutoff  # the damping rises from nothing there
    known = np.append(figures.cutoff, figures.amplitude) if begins else figures.amplitude
    amplitude = np.append(known[known < limit], limit)
    within = np.interp(amplitude, known, np.append(np.zeros(int(begins)), figures.damping_ratio))
    at = int(np.argmax(within))
    if within[at] <= ROUNDING:
        return None
    return Best(float(within[at]), float(amplitude[at]), limited=True, useful=useful)


def ball_density(results: Results, point: SpeedPoint) -> float:
    """Of a ball [kg/m³]; 0 without one."""
    damper = results.scene.damper
    if damper is None or point.reduced is None:
        return 0.0
    return damper.density(point.reduced.M1 - point.reduced.M2)


def torn_above(results: Results) -> float:
    """Speed [rad/s] above which the centrifugal pull at the root is more than any blade metal bears."""
    stress = root_stress(results, 1.0)
    return math.sqrt(STRONGEST / stress) if stress else math.inf


def is_torn(results: Results, point: SpeedPoint) -> bool:
    """Whether the centrifugal pull at the root is more than any blade metal bears."""
    return point.omega > torn_above(results)


HEAVY = 0.05
"""Mass of the balls over the structure's from which on an estimate from free vibration is rough: up to there it was off
by 7 % in examples, with a tenth by 32 %."""


def is_heavy(point: SpeedPoint) -> bool:
    """Whether the balls are so heavy beside the structure that their forced motion is estimated roughly."""
    return point.reduced is not None and point.reduced.M1 - point.reduced.M2 > HEAVY * point.reduced.M2


def weight_governs(point: SpeedPoint) -> bool:
    """Whether the ball's own weight is more than the load."""
    return point.load_g < WEIGHT


def weight_share(results: Results, point: SpeedPoint) -> float:
    """The ball's own weight over what drives it along the floor at the amplitude of largest damping; 0 without one."""
    most = best(results, point)
    return 0.0 if most is None else weight_at(results, point, most.amplitude)


def weight_at(results: Results, point: SpeedPoint, amplitude: float, hertz: float | None = None) -> float:
    """The same at an amplitude; `hertz`: as of `friction_demand`. In a hollow floor the load holds the ball: 0."""
    damper, drive = results.scene.damper, _drive(point, hertz) * amplitude
    if damper is None or damper.floor_radius is not None:
        return 0.0
    return results.scene.rotor.gravity / drive if drive > 0 else 0.0


def weight_over_hold(results: Results, point: SpeedPoint) -> float:
    """The ball's own weight over what holds it at rest on a flat floor: rolling resistance, dent; 0 without either."""
    damper = results.scene.damper
    if damper is None or damper.floor_radius is not None or point.load_g == 0:
        return 0.0
    slope = _rolling_slope(results, point)
    slope += rim_slope(results.scene, point) if results.effects["indentation"].on else 0.0
    return 1 / (slope * point.load_g) if slope > 0 else 0.0


def _drive(point: SpeedPoint, hertz: float | None = None) -> float:
    """What drives a ball along the floor, both axes together, over the amplitude [1/s²]; `hertz`: of another mode."""
    if hertz is not None:
        return (2 * math.pi * hertz) ** 2
    return (2 * math.pi * present(point.reduced).f1_hz) ** 2 * point.drive_left


def _rolling_slope(results: Results, point: SpeedPoint) -> float:
    """Slope that rolling resistance holds a ball on, μ_r / r."""
    on = results.effects["rolling_resistance"].on
    return lever(results.scene, point) / present(results.scene.damper).radius if on else 0.0


def friction_demand(results: Results, point: SpeedPoint, amplitude: float, hertz: float | None = None) -> float:
    """Friction on the floor that pure rolling needs at an amplitude, over the normal load; 0 without a load.

    A rolling ball lags behind its floor by 5/7 of what drives it, u'' + G κ u: friction gives it the other 2/7, and
    holds it against 5/7 of the rolling resistance. `hertz`: of another mode than that which leads along axis 1, with
    which the floor is taken not to tilt.
    """
    if results.scene.damper is None or point.reduced is None or point.load_g == 0:
        return 0.0
    drive = _drive(point, hertz) * amplitude
    return (2 * drive / (point.omega**2 * point.pressing) + 5 * _rolling_slope(results, point)) / 7


def friction_needed(results: Results, point: SpeedPoint, amplitude: float, hertz: float | None = None) -> float:
    """The same where it is more than the friction of the scene; nan where that is enough."""
    needed = friction_demand(results, point, amplitude, hertz)
    return needed if needed > present(results.scene.damper).friction else math.nan


def slides(results: Results, point: SpeedPoint, amplitude: float, hertz: float | None = None) -> bool:
    """Whether rolling needs more friction than any dry floor has; any at all where the scene has none."""
    most = DRY if present(results.scene.damper).friction > 0 else 0.0
    return friction_demand(results, point, amplitude, hertz) > most


def root_stress(results: Results, omega: float) -> float | None:
    """Mean stress over the root's section [Pa]: what hangs on it times its acceleration; None where it is not known."""
    fastest = max(results.speeds, key=lambda point: point.omega, default=None)
    if fastest is not None and fastest.root_stress is not None and fastest.omega > 0:
        return fastest.root_stress * (omega / fastest.omega) ** 2
    if (hung := _hung(results)) is None:
        return None
    (volume, moment), section = hung
    density, rotor = present(results.scene.material).density, results.scene.rotor
    level = math.cos(rotor.precone)
    stress = density * omega**2 * level * (rotor.hub_radius * volume + level * moment) / section
    hangs = level * max((point.radius for point in results.speeds), default=0.0)
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
    # Each cell as triangles about its first corner, exact for even thickness.
    points, triangles = results.surface.points[:, :2], results.surface.triangles
    x = points[:, 0] - points[:, 0].min()
    one, other = (points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))
    volumes = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2 * heights[triangles].mean(axis=1)
    lengths = np.linalg.norm(np.diff(points[results.surface.root], axis=1)[:, 0], axis=1)
    section = float((lengths * heights[results.surface.root].mean(axis=1)).sum())
    return (float(volumes.sum()), float((volumes * x[triangles].mean(axis=1)).sum())), section


def endured(results: Results, omega: float | None = None) -> float:
    """Amplitude at the cavity [m] that strains the structure by what metals endure; inf where the strain is not known.

    Of a plate so thin that it would bend beyond small deflections first, the amplitude at which it does. `omega`: speed
    [rad/s]; None: the least over those of `largest_strain`.
    """
    strain, length = largest_strain(results, omega), span(results)
    if strain is None:
        return math.inf
    if length is None:
        return ENDURED / strain
    return min(ENDURED / strain, SMALL * length / (_largest(results, "tip_motion", omega) or 1.0))


def least_amplitude(point: SpeedPoint) -> float:
    """Amplitude at the cavity [m] from which on damping counts at a speed; 0 where the strain is not known."""
    return NEGLIGIBLE_STRAIN / point.root_strain if point.root_strain else 0.0


def strained(scene: Scene) -> str:
    """What is strained most, in a word: a rectangle of constant thickness at its root, others anywhere."""
    if scene.plate is not None:
        return "root" if isinstance(scene.plate.thickness, float) and scene.plate.mesh is None else "plate"
    return "blade" if scene.blade is not None else "structure"


def room(scene: Scene) -> float:
    """What a ball's diameter has to stay below [m]: the plate's thickness where the cavity is in it; else inf.

    0 where a mesh's thickness varies: it is not known there.
    """
    damper, plate = scene.damper, scene.plate
    if damper is None or plate is None or damper.housing is not None:
        return math.inf
    if plate.length is None:
        return plate.thickness if isinstance(plate.thickness, float) else 0.0
    return plate.thickness_at(damper.on_plate or (plate.length, 0.0))


def deflection_governs(results: Results, omega: float | None = None) -> bool:
    """Whether a plate would bend beyond small deflections before it is strained by what metals endure.

    `omega`: as of `endured`.
    """
    strain = largest_strain(results, omega)
    return strain is not None and endured(results, omega) * strain < ENDURED * (1 - 1e-9)


def is_beyond(results: Results, point: SpeedPoint) -> bool:
    """Whether the damper's peak lies at an amplitude that the plate does not endure."""
    own = point.damping_curve
    return own is not None and own.peak > 0 and own.peak_amplitude > endured(results, point.omega)


def largest_strain(results: Results, omega: float | None = None) -> float | None:
    """Largest strain over the amplitude at the cavity [1/m]; None where it is not known.

    That of a plate is by bending, that of a structure in space the largest in its mesh. Between two speeds it is
    interpolated over the square of the speed, with which the centrifugal load grows.

    Args:
        results: with the strains at their speeds.
        omega: speed [rad/s]; None: the largest over the speeds whose load does not tear the root, or over all where
            each does.
    """
    return _largest(results, "root_strain", omega)


def _largest(results: Results, name: str, omega: float | None) -> float | None:
    """A field of the speeds, see `largest_strain`; None where it is not known."""
    known = sorted((p.omega, value) for p in results.speeds if (value := getattr(p, name)) is not None)
    if not known:
        return None
    if omega is not None:
        squares, values = zip(*((speed**2, value) for speed, value in known), strict=True)
        return float(np.interp(omega**2, squares, values))
    most = torn_above(results)
    return float(max([value for speed, value in known if speed <= most] or [value for _, value in known]))


def span(results: Results) -> float | None:
    """The plate's extent from its root outwards [m]."""
    plate = results.scene.plate
    if plate is None or plate.length is not None:
        return None if plate is None else plate.length
    return None if results.surface is None else float(np.ptp(results.surface.points[:, 0]))


class TableCutOff(NamedTuple):
    """Acceleration over g, and over the load; None where not known. `at_rest`: not of a ring-down."""

    g: float | None
    ratio: float | None
    at_rest: bool


def in_g(results: Results, point: SpeedPoint, amplitude: float) -> float:
    """Acceleration over g of a vibration of that amplitude [m], with the ball stuck."""
    return (2 * math.pi * present(point.reduced).f1_hz) ** 2 * amplitude / results.scene.rotor.gravity


def cutoff(results: Results, point: SpeedPoint) -> TableCutOff:
    """The cut-off at a speed, on the floor of the scene's ring-down."""
    damping, own = point.damper, point.level or point.damping_curve
    if damping is not None and damping.cutoff_g is not None:
        return TableCutOff(damping.cutoff_g, damping.cutoff_ratio, at_rest=False)
    if own is None or not 0 < own.cutoff < math.inf or point.load_g == 0:
        return TableCutOff(None, None, at_rest=False)
    g = in_g(results, point, own.cutoff)
    return TableCutOff(g, g / point.load_g, at_rest=True)
