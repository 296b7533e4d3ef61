"""What a careful engineer would remark about a run: one function a remark, None where there is nothing to say.

Remarks on the damper are here, those on the plate in :mod:`workflows.findings.of_the_plate`.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from workflows.findings import of_the_plate as notes_plate
from workflows.scene import thicknesses
from workflows.scene.cavity import beside
from workflows.scene.checks import OSMIUM
from workflows.solve import damper_stage as ringdowns
from workflows.solve import felt
from workflows.solve.records import Damping, Reduced, Results, SpeedPoint
from workflows.wording import significant, span, whole

STEEL = 7_850.0
"""kg/m³."""

EXPLAINED = 1e-9
"""Share of the initial energy that the books may leave unexplained without a word."""


def remarks(results: Results) -> tuple[str, ...]:
    """The remarks that the run calls for, those that bear most on the answer first."""
    found = (remark(results) for remark in REMARKS)
    return tuple(text for text in found if text)


def _rung(results: Results) -> list[tuple[SpeedPoint, Reduced, Damping]]:
    """The speeds at which the damper was simulated."""
    return [(p, p.reduced, p.damping) for p in results.speeds if p.reduced is not None and p.damping is not None]


def _capped(results: Results) -> str | None:
    for point, _, damping in _rung(results):
        if "cap" in damping.outcome:
            return f"At {whole(point.rpm)} rpm {damping.outcome}."
    return None


def _nothing_released(results: Results) -> str | None:
    release = results.scene.release
    still = [p.rpm for p, _, _ in _rung(results) if p.load_g == 0]
    if release is None or release.ratio is None or not still:
        return None
    return f"At {whole(still[0])} rpm there is no load, so that a ratio of it releases nothing: nothing moves there."


def _level_floor(results: Results) -> str | None:
    """A scene that keeps the floor level, and what its tilt does to the cut-off, simulated."""
    rung = [(p, d) for p, _, d in _rung(results) if p.tilted is not None and p.load_g > 0]
    if not rung:
        return None
    found = [(p.tilted.ratio, d.cutoff_ratio) for p, d in rung if p.tilted is not None]
    tilted, level = ([pair[k] for pair in found if pair[k] is not None] for k in (0, 1))
    text = (
        "This scene keeps the cavity's floor level, and so do its ring-downs below. The verdict and the ball's own"
        " figures are those of a floor that tilts as the structure bends"
    )
    if results.scene.damper is not None and results.scene.damper.formulation == "printed":
        text = "The printed equations keep the cavity's floor level"
    if tilted and level:
        text += (
            f": simulated with the tilt, the ball rests below {_span(tilted)} of the load, and not below {_span(level)}"
        )
    never = sum(ratio is None for ratio, _ in found)
    where = f"; at {never} of {len(found)} loads it never moves" if never else ""
    return f"{text}{where}."


def _span(ratios: list[float | None]) -> str:
    known = sorted(ratio for ratio in ratios if ratio is not None)
    return span(known[0], known[-1], 3)


def _turning_floor(results: Results) -> str | None:
    """The floor's turning, which is left out: (1/5) m (s' - r kappa u')² of the spin makes 2/5 r kappa of the drive."""
    damper, asked = results.scene.damper, results.scene.accuracy.damping
    if damper is None or not results.effects["floor_tilt"].on:
        return None
    share = max((0.4 * damper.radius * abs(r.floor_tilt) for p, r, _ in _rung(results) if p.load_g > 0), default=0.0)
    if share <= asked:
        return None
    return (
        f"As the floor turns it turns the ball too, which is left out: {significant(100 * share, 2)} % of the ball's"
        " drive, two fifths of its radius times the floor's slope over the displacement."
    )


_LINEAR = 0.3
"""Way over the radius of its path up to which a pendulum's frequency is off by 1 %: 1 - (s/rho)²/16 and the load's."""


def _pendulum(results: Results) -> str | None:
    """What a hollow floor makes of the ball, and where it is no longer linear."""
    damper = results.scene.damper
    known = [p for p, _, _ in _rung(results) if p.pendulum is not None and p.load_g > 0]
    if damper is None or damper.floor_radius is None or not known:
        return None
    pendulum = known[0].pendulum
    if pendulum is None:
        return None
    orders = [significant(order, 3) for order in pendulum.order]
    tuned = (
        f"of engine order {orders[0]}" if orders[0] == orders[1] else f"of engine orders {orders[0]} and {orders[1]}"
    )
    text = f"In its hollow floor the ball is a pendulum {tuned}, at all speeds, along the bending direction and across"
    reach = max(
        (side / 2 - damper.radius) / (radius - damper.radius)
        for side, radius in zip(damper.cavity, damper.floor_radius, strict=True)
    )
    if reach <= _LINEAR:
        return f"{text}."
    return (
        f"{text}, for small ways: the cavity lets it go {significant(reach, 2)} radii of its path, and beyond"
        f" {_LINEAR:g} of one its frequency falls by more than a percent, which is left out."
    )


def _scattered(results: Results) -> str | None:
    """Energy that hits leave in modes beyond those that the release sets going."""
    shares = []
    for point, _, damping in _rung(results):
        leaders = {m.number for axis in range(2) if (m := felt.leading(point.cavity_modes, axis)) is not None}
        rest = sum(e for number, e in damping.modal_energies.items() if number not in leaders)
        if damping.energy.initial > 0:
            shares.append((rest / damping.energy.initial, point.rpm))
    share, rpm = max(shares, default=(0.0, 0.0))
    if share <= results.scene.accuracy.damping:
        return None
    return (
        f"Hits scatter energy into modes that do not lead the motion: {significant(100 * share, 2)} % of the initial"
        f" energy is left there at the end at {whole(rpm)} rpm."
    )


def _modes_left_out(results: Results) -> str | None:
    """Modes that hits feed but for which there is no room, or that were not looked for."""
    scene = results.scene
    worst = 0.0
    for point, reduced, damping in _rung(results):
        kept = set(damping.modal_energies)
        ball = reduced.M1 - reduced.M2
        left = [ball * math.hypot(*m.shape) ** 2 for m in point.cavity_modes if m.number not in kept]
        worst = max([worst, *left])
    if worst <= scene.accuracy.damping or not results.effects["structural_modes"].on:
        return None
    return (
        f"Modes that hits feed are left out, for want of room: each changes the damping by about"
        f" {significant(100 * worst, 2)} %, more than the {significant(100 * scene.accuracy.damping)} % asked for."
    )


def _still_across(results: Results) -> str | None:
    """No mode that was looked for moves the cavity across."""
    rung = [p for p, _, _ in _rung(results) if p.cavity_modes]
    if not rung or any(felt.leading(p.cavity_modes, 1) is not None for p in rung):
        return None
    return (
        f"None of the {len(rung[0].cavity_modes)} modes moves the cavity across the plate, which there is still:"
        " its lag modes lie higher."
    )


def _level_structure(results: Results) -> str | None:
    """What a scene without a plate does not tell."""
    structure = results.scene.structure
    if structure is None or any(structure.floor_tilt) or not any(p.load_g > 0 for p, _, _ in _rung(results)):
        return None
    return (
        "This [structure] does not say how the cavity's floor tilts as it bends (floor_tilt), which on a plate raises"
        " the amplitude from which the ball moves, nor what amplitude it endures: the verdict is that of a level floor"
        " without limit."
    )


def _held(results: Results) -> str | None:
    """Ring-downs in which the release is too small to set the ball rolling."""
    rung = [(p, d, p.level or p.working) for p, _, d in _rung(results) if p.load_g > 0 and d.events == 0]
    held = [(p, d, own) for p, d, own in rung if own is not None and own.peak > 0]
    if not held:
        return None
    point, damping, own = min(held, key=lambda entry: entry[0].load_g)
    lift = significant(1e3 * math.hypot(*damping.release))
    needed = significant(1e3 * own.cutoff, 2)
    return (
        f"From {point.load_g:.0f} g on, this scene's release of {lift} mm does not set the ball rolling, which takes"
        f" {needed} mm there: those ring-downs show the structure alone."
    )


def _books(results: Results) -> str | None:
    shares = [d.energy.residual / d.energy.initial for _, _, d in _rung(results) if d.energy.initial > 0]
    worst = max(shares, key=abs, default=0.0)
    if abs(worst) <= EXPLAINED:
        return None
    what = "appears from nowhere" if worst < 0 else "is lost without a cause"
    printed = results.scene.damper is not None and results.scene.damper.formulation == "printed"
    why = ": the printed equations do not conserve energy" if printed else ""
    return f"Up to {significant(100 * abs(worst), 2)} % of the initial energy {what}{why}."


def _work_bound(results: Results) -> str | None:
    from damper import work_bound

    damper = results.scene.damper
    if damper is None or damper.formulation == "printed":
        return None  # the bound rests on conservation of energy
    bounds = []
    for point, _, damping in _rung(results):
        if damping.cutoff_g:
            system = ringdowns.particle_damper(results.scene, results.effects, point)
            amplitude = damping.cutoff_g * results.scene.rotor.gravity / system.stuck_frequency**2
            bound = work_bound(system, amplitude)
            limit = f"{significant(100 * bound, 2)} %" if bound <= 1 else "no bound"
            bounds.append(f"{limit} at {whole(point.load_g)} g")
    if not bounds:
        return None
    ends = bounds if len(bounds) == 1 else [bounds[0], bounds[-1]]
    return (
        "However often it bounces, the ball can take at most 4 (m_p/M2) (clearance/amplitude) of a cycle's energy, both"
        " axes taken together and to leading order in m_p/M2; this is largest at the cut-off:"
        f" {', '.join(ends)}. Any damping beyond that is the structure's own."
    )


def _assumed_damping(results: Results) -> str | None:
    damper, rung = results.scene.damper, _rung(results)
    if damper is None or damper.damping_ratio == 0 or not rung:
        return None
    share = significant(100 * rung[0][2].intrinsic_sdc)
    return (
        f"The structure's own damping, ζ = {damper.damping_ratio:g}, is an input and alone loses {share} % in a cycle;"
        " the specific damping capacity includes it, as the paper's definition does."
    )


def _impossible_ball(results: Results) -> str | None:
    damper, rung = results.scene.damper, _rung(results)
    if damper is None or not rung:
        return None
    heaviest = max(damping.ball_mass for _, _, damping in rung)
    volume = 4 / 3 * math.pi * damper.radius**3
    density = heaviest / damper.count / volume
    if density <= OSMIUM:
        return None
    grams = significant(1e3 * heaviest / damper.count)
    return (
        f"A ball of radius {1e3 * damper.radius:g} mm and {grams} g would have {significant(density, 2)} kg/m³,"
        f" {significant(density / OSMIUM, 2)} times osmium: read the mass as an effective one, such as"
        f" {math.ceil(heaviest / (STEEL * volume))} steel balls, each in a cavity of its own, moving in step."
    )


def _rows(results: Results) -> str | None:
    """Cavities that do not lie side by side: the innermost ones feel less load and less motion."""
    plate, damper = results.scene.plate, results.scene.damper
    if plate is None or plate.width is None or damper is None or damper.housing:
        return None
    place = damper.at or (plate.length or 0.0, 0.0)
    most = beside(damper, thicknesses.at(plate, place), plate.width)
    if damper.count <= most:
        return None
    rows = math.ceil(damper.count / most)
    return (
        f"At most {most} of the {damper.count} cavities lie side by side in a section of the plate: they take {rows}"
        f" rows along the radius, {significant(2e3 * damper.radius * rows)} mm deep. The model has all of them at one"
        " place; further in there is less load and less motion."
    )


def _rolling(results: Results) -> str | None:
    damper = results.scene.damper
    demands = [(d.largest_rolling_demand, p.rpm) for p, _, d in _rung(results) if d.largest_rolling_demand is not None]
    demand, rpm = max(demands, default=(0.0, 0.0))
    if damper is None or demand <= damper.friction:
        return None
    return (
        f"Rolling without slip needs a friction of {significant(demand, 2)} at {whole(rpm)} rpm, more than the"
        f" {damper.friction:g} given for wall hits: unless the floor grips better, the ball would slip."
    )


def _release_stress(results: Results) -> str | None:
    plate, material, rung = results.scene.plate, results.scene.material, _rung(results)
    if plate is None or material is None or plate.length is None or not rung:
        return None
    lift = max(abs(damping.release[0]) for _, _, damping in rung)
    # Root curvature of a uniform cantilever in its first mode: 3.516 w/L².
    thickness = thicknesses.at(plate, (0.0, 0.0))
    stress = material.youngs_modulus * thickness / 2 * 3.516 * lift / plate.length**2
    if stress < 1e8 and lift < thickness:
        return None
    large = ", far outside small deflections and, for most metals, outside the elastic range" if stress > 4e8 else ""
    return (
        f"A release of {significant(1e3 * lift)} mm is {significant(lift / thickness, 2)} plate thicknesses and"
        f" bends the root to about {significant(stress / 1e6, 2)} MPa{large}."
    )


def _two_axes(results: Results) -> str | None:
    if results.scene.plate is None or not any(damping.release[1] for _, _, damping in _rung(results)):
        return None
    if results.effects["structural_modes"].on:
        return None
    lags = [mode.frequency_hz for point in results.speeds for mode in point.modes if mode.family == "lag"]
    known = f"; this plate's first lag mode is at about {significant(min(lags))} Hz" if lags else ""
    return f"As in the paper, both axes have the frequency of the first bending mode{known}."


REMARKS: tuple[Callable[[Results], str | None], ...] = (
    notes_plate.divergence,
    _capped,
    _nothing_released,
    _held,
    _level_floor,
    _turning_floor,
    _pendulum,
    _scattered,
    _modes_left_out,
    _still_across,
    _level_structure,
    _books,
    _work_bound,
    _assumed_damping,
    _impossible_ball,
    _rows,
    _rolling,
    _release_stress,
    notes_plate.root_stress,
    _two_axes,
    notes_plate.stiffness_with_ball,
    notes_plate.real_modes,
    notes_plate.veering,
    notes_plate.frequency_error,
)
"""In the order in which they are reported."""
