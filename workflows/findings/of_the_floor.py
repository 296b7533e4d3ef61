"""What a careful engineer would remark about the cavity's floor and the modes that move it; None where nothing is."""

from __future__ import annotations

import math

from workflows.solve import felt
from workflows.solve.records import Damping, Reduced, Results, SpeedPoint
from workflows.wording import significant, span, upwards, whole

_NOTABLE_TILT = 0.01
"""Share of the drive from which on the tilt of the floor is worth a sentence."""


def rung_down(results: Results) -> list[tuple[SpeedPoint, Reduced, Damping]]:
    """The speeds at which the damper was simulated."""
    return [(p, p.reduced, p.damping) for p in results.speeds if p.reduced is not None and p.damping is not None]


def level_floor(results: Results) -> str | None:
    """A scene that keeps the floor level, and what its tilt does to the cut-off, simulated."""
    rung = [(p, d) for p, _, d in rung_down(results) if p.tilted is not None and p.load_g > 0]
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


def turning_floor(results: Results) -> str | None:
    """The floor's turning, which is left out: (1/5) m (s' - r kappa u')² of the spin makes 2/5 r kappa of the drive."""
    damper, asked = results.scene.damper, results.scene.accuracy.damping
    if damper is None or not results.effects["floor_tilt"].on:
        return None
    share = max(
        (0.4 * damper.radius * abs(r.floor_tilt) for p, r, _ in rung_down(results) if p.load_g > 0), default=0.0
    )
    if share <= asked:
        return None
    return (
        f"As the floor turns it turns the ball too, which is left out: {significant(100 * share, 2)} % of the ball's"
        " drive, two fifths of its radius times the floor's slope over the displacement."
    )


_LINEAR = 0.3
"""Way over the radius of its path up to which a pendulum's frequency is off by 1 %: 1 - (s/rho)²/16 and the load's."""


def pendulum(results: Results) -> str | None:
    """What a hollow floor makes of the ball, and where it is no longer linear."""
    damper = results.scene.damper
    known = [p for p, _, _ in rung_down(results) if p.pendulum is not None and p.load_g > 0]
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


def scattered(results: Results) -> str | None:
    """Energy that hits leave in modes beyond those that the release sets going."""
    shares = []
    for point, _, damping in rung_down(results):
        leaders = {m.number for axis in range(2) if (m := felt.leading(point.cavity_modes, axis)) is not None}
        rest = sum(e for number, e in damping.modal_energies.items() if number not in leaders)
        if damping.energy.initial > 0 and damping.impacts > 0:
            shares.append((rest / damping.energy.initial, point.rpm))
    share, rpm = max(shares, default=(0.0, 0.0))
    if share <= results.scene.accuracy.damping:
        return None
    return (
        f"Hits scatter energy into modes that do not lead the motion: {significant(100 * share, 2)} % of the initial"
        f" energy is left there at the end at {whole(rpm)} rpm."
    )


def modes_left_out(results: Results) -> str | None:
    """Modes that hits feed but for which there is no room, or that were not looked for."""
    scene = results.scene
    worst = 0.0
    for point, reduced, damping in rung_down(results):
        kept = set(damping.modal_energies)
        ball = reduced.M1 - reduced.M2
        left = [ball * math.hypot(*m.shape) ** 2 for m in point.cavity_modes if m.number not in kept]
        worst = max([worst, *left])
    if worst <= scene.accuracy.damping or not results.effects["structural_modes"].on:
        return None
    return (
        "Modes that hits feed are left out, for want of room: each changes the damping by about"
        f" {significant(100 * worst, 2)} %, more than the {significant(100 * scene.accuracy.damping)} % asked for;"
        f" [accuracy] damping = {upwards(worst)} can be had."
    )


def still_across(results: Results) -> str | None:
    """No mode that was looked for moves the cavity across."""
    rung = [p for p, _, _ in rung_down(results) if p.cavity_modes]
    if not rung or any(felt.leading(p.cavity_modes, 1) is not None for p in rung):
        return None
    return (
        f"None of the {len(rung[0].cavity_modes)} modes moves the cavity across the plate, which there is still:"
        " its lag modes lie higher."
    )


def leaning_load(results: Results) -> str | None:
    """A load that does not point along the plate at the cavity, whose floor is taken to face it."""
    scene = results.scene
    if scene.damper is None or scene.damper.at is None or scene.plate is None or not rung_down(results):
        return None
    across = abs(scene.damper.at[1] * math.cos(scene.rotor.stagger))
    point = max((p for p, _, _ in rung_down(results)), key=lambda p: p.load_g)
    lean, rolls = across / point.radius, scene.damper.rolling_friction / scene.damper.radius
    if point.load_g == 0 or lean <= 0.1 * rolls:
        return None
    held = "would roll to a wall and lean on it" if lean > rolls else "would be held off the middle by it"
    return (
        f"At this place the load leans by {significant(math.degrees(math.atan(lean)), 2)}° from the plate's length,"
        f" away from its centre line: the cavity's floor is taken to face it. On one square to the length the ball"
        f" {held}, which is not what is simulated."
    )


def level_structure(results: Results) -> str | None:
    """What a scene without a plate does not tell."""
    structure = results.scene.structure
    if structure is None or any(structure.floor_tilt) or not any(p.load_g > 0 for p, _, _ in rung_down(results)):
        return None
    return (
        "This [structure] does not say how the cavity's floor tilts as it bends (floor_tilt), which on a plate raises"
        " the amplitude from which the ball moves, nor what amplitude it endures: the verdict is that of a level floor"
        " without limit."
    )


def tilt(results: Results, points: list[SpeedPoint]) -> str | None:
    """What the tilt of the cavity's floor has to do with the answer."""
    shares = [p.tilt_share for p in points]
    printed = results.scene.damper is not None and results.scene.damper.formulation == "printed"
    if printed or max(map(abs, shares)) < _NOTABLE_TILT:
        return None
    sizes = sorted(map(abs, shares))
    percent, begin = f"{span(100 * sizes[0], 100 * sizes[-1])} %", f"{as_it_moves(results)}, the cavity's floor tilts"
    if max(shares) <= 0:
        return f"{begin} the other way, and the slope adds {percent} to the ball's drive, which these figures count in."
    if min(shares) > 1:
        return (
            f"{begin} so far that it is the slope that drives the ball, with a pull of {percent} of the motion's own."
        )
    beyond = "; beyond 100 % it is the slope that drives the ball" if max(shares) > 1 else ""
    return (
        f"{begin} and the load pulls the ball back down the slope: these figures count in the {percent} of the ball's"
        f" drive that this opposes{beyond}."
    )


def as_it_moves(results: Results) -> str:
    """How a sentence on the tilt begins."""
    return "As the plate bends" if results.scene.structure is None else "As the structure moves"
