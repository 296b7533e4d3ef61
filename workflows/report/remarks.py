"""What a careful engineer would remark about a run, what it takes for granted, and how exact its frequencies are.

The parts of sentences that the verdict has too come first.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fem.rotor import in_rpm
from workflows.effects.selection import EFFECTS
from workflows.formatting import significant, span, upwards, whole
from workflows.scene import paper, plate_mesh
from workflows.scene.damper import cavities_abreast
from workflows.scene.materials import KGF, KNOWN, OSMIUM, is_too_dense
from workflows.solve import coupling, limits
from workflows.solve.results import Damping, ErrorParts, Reduced, Results, SpeedPoint

if TYPE_CHECKING:
    from damper.contact import Contact

PRINTED = "the equations as printed do not conserve energy"
WEIGHT = "the ball's weight, which is neglected, exceeds the load"

BEYOND, BEYOND_MEANS = "†", "† Beyond the amplitude or speed that the structure endures"
NO_VERDICT, NO_VERDICT_MEANS = "‡", "‡ No verdict at this speed"
AT_REST, AT_REST_MEANS = (
    "*",
    "* Amplitude up to which a ball at rest stays at rest; the ring-down itself shows no cut-off.",
)
"""Marks of numbers in tables, and what they stand for below."""


def at_load(point: SpeedPoint) -> str:
    """Where in the range of speeds, within a sentence."""
    return f"at {whole(point.rpm)} rpm" if point.load_g > 0 else "at rest"


def at_speed(point: SpeedPoint) -> str:
    """A speed with its load."""
    return f"{whole(point.rpm)} rpm ({whole(point.load_g)} g)"


def stretch(chosen: Sequence[SpeedPoint], points: Sequence[SpeedPoint]) -> str:
    """Where some of the points lie among all, in few words: up to, from, from ... to; both with rising load."""
    places = sorted(points, key=lambda point: point.load_g)
    at = sorted(places.index(point) for point in chosen)
    first, last = (at_speed(places[k]) for k in (at[0], at[-1]))
    if len(at) == 1:
        return f"at {first}"
    if at[-1] - at[0] >= len(at):
        among = f"at {len(at)} of {len(places)} speeds from {first} to {last}"
        return f"at {first} and {last}" if len(at) == 2 else among
    if len(at) == len(places) or (at[0] > 0 and at[-1] < len(places) - 1):
        return f"from {first} to {last}"
    return f"up to {last}" if at[0] == 0 else f"from {first} on"


def capital(text: str) -> str:
    """The text as the begin of a sentence."""
    return text[0].upper() + text[1:]


def millimetres(length: float) -> str:
    """A length [m] in mm."""
    return significant(1e3 * length, 2)


def percent(share: float) -> str:
    """A share in percent."""
    return significant(100 * share, 2)


def mark(results: Results, point: SpeedPoint) -> str:
    """What a table puts beside the damper's figures at a speed; empty where they are as good as the answer."""
    figures, verdict = point.damping_curve, point.verdict
    if figures is None or verdict is None:
        return ""
    if limits.is_beyond(results, point):
        return BEYOND
    return NO_VERDICT if verdict.rank < 0 or (point.load_g == 0 and figures.peak > 0) else ""


def legend(results: Results) -> list[str]:
    """What the marks of the damper's figures stand for, as far as a table over all speeds has them."""
    meanings = {
        BEYOND: f"{BEYOND_MEANS}; the verdict uses the largest value within these limits.",
        NO_VERDICT: f"{NO_VERDICT_MEANS}.",
    }
    marks = {mark(results, point) for point in results.speeds}
    return [meaning for each, meaning in meanings.items() if each in marks]


def cutoff_mark(results: Results, point: SpeedPoint) -> str:
    """What a table puts beside a cut-off that no ring-down shows."""
    return AT_REST if limits.cutoff(results, point).at_rest else ""


def cutoff_legend(results: Results) -> list[str]:
    """What the mark of cut-offs stands for, where a table has it."""
    return [AT_REST_MEANS] if any(cutoff_mark(results, point) for point in results.speeds) else []


def beyond(*, by_deflection: bool) -> str:
    """What a larger amplitude than the plate endures would do to it."""
    if by_deflection:
        return f"bend the plate by over {100 * limits.SMALL:g} % of its length, beyond the range of the theory"
    return f"strain the root by over {100 * limits.ENDURED:g} %, which no blade metal endures in vibration"


def beyond_of(results: Results) -> str:
    """The same, with the speed by which all are judged where the strain of a structure's root differs between them."""
    would = beyond(by_deflection=limits.deflection_governs(results))
    torn = limits.root_stress(results, 1.0) or 0.0
    held = [p for p in results.speeds if p.root_strain is not None and torn * p.omega**2 <= limits.STRONGEST]
    strains = [(p.root_strain or 0.0, p.rpm) for p in held]
    if not strains or max(strains)[0] <= _ALIKE * min(strains)[0]:
        return would
    return (
        f"{would} (at {whole(max(strains)[1])} rpm, where an amplitude strains the root most, which limits all speeds)"
    )


_ALIKE = 1.01
"""Ratio of strains at different speeds that is not worth a word."""


def torn_from(results: Results) -> str | None:
    """From which of the speeds on the plate would tear, and by what stress; None where it holds at all."""
    stress = limits.root_stress(results, 1.0) or 0.0
    torn = [point for point in results.speeds if stress * point.omega**2 > limits.STRONGEST]
    if not torn:
        return None
    first = min(torn, key=lambda point: point.omega)
    return torn_at(first.rpm, stress * first.omega**2)


def torn_at(rpm: float, stress: float) -> str:
    """That a plate tears from a speed on."""
    return (
        f"from {whole(rpm)} rpm on: the mean centrifugal stress at the root, {significant(stress / 1e6)} MPa, exceeds"
        f" what any blade metal endures ({significant(limits.STRONGEST / 1e6)} MPa)"
    )


def too_dense(results: Results) -> tuple[str, str] | None:
    """What of a ball is denser than any solid, and what would weigh as much; None where it is possible."""
    damper = results.scene.damper
    density = max((limits.ball_density(results, point) for point in results.speeds), default=0.0)
    if damper is None or not is_too_dense(density):
        return None
    volume = 4 / 3 * math.pi * damper.radius**3
    one, steel = density * volume, KNOWN["steel"].density
    together = one * damper.count
    return (
        f"a ball of radius {significant(1e3 * damper.radius)} mm and {significant(1e3 * one)} g would be"
        f" {significant(density / OSMIUM, 2)} times as dense as osmium, the densest solid",
        "The figures are those of feasible balls of the same total mass, such as"
        f" {math.ceil(together / (steel * volume))} of steel ([damper] count), each in a cavity"
        " of its own, moving in step.",
    )


def _contacts(results: Results, points: Sequence[SpeedPoint]) -> list[tuple[SpeedPoint, Contact]]:
    """The contact of the resting ball at the points, where its materials are known."""
    return [(point, each) for point in points if (each := limits.contact(results.scene, point)) is not None]


def flows(results: Results, points: Sequence[SpeedPoint]) -> str:
    """That the contact of the resting ball flows at some speeds, and how flat it becomes."""
    pressed = [contact.hardness_ratio for _, contact in _contacts(results, points)]
    if not pressed:
        return "ball or floor yields fully under the load"
    widest = max(contact.dent_radius for _, contact in _contacts(results, points))
    return (
        f"the mean contact pressure of the resting ball is {span(min(pressed), max(pressed), 2)} times the hardness of"
        f" the softer material, and the contact yields to a width of up to {significant(2e3 * widest, 2)} mm"
    )


def dents(results: Results) -> str | None:
    """What the resting ball does to its floor where that yields, or the floor to the ball."""
    damper, material = results.scene.damper, results.scene.material
    every = _contacts(results, results.speeds)
    pressed = [(point, c) for point, c in every if c.dent_radius > 0 and not c.hardness_ratio >= 1]
    if not pressed or damper is None:
        return None
    point, most = max(pressed, key=lambda pair: pair[1].yield_ratio)
    floor = damper.floor_material or (None if material is None else material.name)
    made_of = limits.solids(results.scene)
    flattened = made_of is not None and made_of[0].yield_strength < made_of[1].yield_strength
    yields = "The ball yields, with a flat" if flattened else "It leaves a dent"
    return (
        f"The resting {damper.ball_material} ball presses on the {floor} floor with up to"
        f" {significant(most.peak_pressure / 1e9, 3)} GPa ({at_load(point)}), under {significant(most.yield_ratio, 2)}"
        f" times the load of first yield. {yields} of at most {significant(1e3 * most.dent_radius, 2)} mm radius and"
        f" {significant(1e6 * most.dent_depth, 2)} µm depth; after elastic recovery its rim slopes by"
        f" {significant(limits.rim_slope(results.scene, point), 2)}."
    )


def unknown_floor(results: Results) -> str | None:
    """That nothing is known of what the floor bears, and what the ball asks of it where it presses most."""
    damper, material, made_of = results.scene.damper, results.scene.material, limits.solids(results.scene)
    every = [(point, c) for point, c in _contacts(results, results.speeds) if not c.hardness_ratio >= 1]
    if damper is None or made_of is None or not math.isnan(made_of[1].hardness) or not every:
        return None
    point, most = max(every, key=lambda pair: pair[1].peak_pressure)
    floor, mean = damper.floor_material or (None if material is None else material.name), 2 / 3 * most.peak_pressure
    return (
        f"The strength of the {floor} floor is not known. {capital(at_load(point))} the mean contact pressure of the"
        f" resting ball is {significant(mean / 1e9, 2)} GPa, which requires a hardness above {whole(mean / KGF)} HB."
    )


_BRIEF = 0.1
"""Share of a flight between hits that a hit may last without a word."""


def long_hits(results: Results) -> str | None:
    """That hits, which the model takes as instantaneous, last long beside the flights between them.

    At the amplitude A of the best: a ball crosses its clearance d in half a period, or, where it leaves a wall as this
    begins to slow down and rolls by (5/7) |1 - tau| A omega³ t³ / 6, in less; it hits at the mean speed of that.
    """
    from damper.contact import hit_time

    damper, made_of = results.scene.damper, limits.solids(results.scene)
    if damper is None or made_of is None:
        return None
    every: list[tuple[float, float, str]] = []
    gap = damper.cavity[0] - 2 * damper.radius
    for point in results.speeds:
        if (best := limits.best(results, point)) is None or point.reduced is None:
            continue
        omega, mass = 2 * math.pi * point.reduced.f1_hz, (point.reduced.M1 - point.reduced.M2) / damper.count
        jerk = 5 / 7 * abs(1 - point.tilt_share) * best.amplitude * omega**3
        flight = min(math.pi / omega, (6 * gap / jerk) ** (1 / 3))
        every.append((hit_time(gap / flight, mass, damper.radius, *made_of), flight, at_load(point)))
    hit, flight, where = max(every, key=lambda each: each[0] / each[1], default=(0.0, 1.0, ""))
    if hit <= _BRIEF * flight:
        return None
    return (
        f"A wall hit lasts {significant(1e6 * hit, 2)} µs (Hertz), {percent(hit / flight)} % of the"
        f" {significant(1e6 * flight, 2)} µs between hits {where} at the amplitude of largest damping. The model treats"
        " hits as instantaneous."
    )


_NOTABLE_TILT = 0.01
"""Share of the drive from which on the tilt of the floor is worth a sentence."""


def ring_downs(results: Results) -> list[tuple[SpeedPoint, Reduced, Damping]]:
    """The speeds at which the damper was simulated."""
    return [(p, p.reduced, p.damper) for p in results.speeds if p.reduced is not None and p.damper is not None]


def level_floor(results: Results) -> str | None:
    """A scene that keeps the floor level, and what its tilt does to the cut-off, simulated."""
    pairs = [
        (ratio, d.cutoff_ratio)
        for p, _, d in ring_downs(results)
        if p.damping_curve and (ratio := p.damping_curve.tilted_cutoff_ratio) is not None and p.load_g > 0
    ]
    if not pairs:
        return None
    tilted = sorted(ratio for ratio, _ in pairs if not math.isnan(ratio))
    level = sorted(ratio for _, ratio in pairs if ratio is not None)
    text = (
        "The ring-downs of this scene keep the cavity's floor level. The verdict and the damping curve include its tilt"
        " as the structure bends"
    )
    if limits.is_printed(results):
        text = "The printed equations keep the cavity's floor level"
    if tilted and level:
        below, not_below = (span(ratios[0], ratios[-1], 3) for ratios in (tilted, level))
        text += f": simulated with the tilt, the cut-off is {below} of the load, and not {not_below}"
    never = sum(math.isnan(ratio) for ratio, _ in pairs)
    where = f"; at {never} of {len(pairs)} loads the ball never moves" if never else ""
    return f"{text}{where}."


def turning_floor(results: Results) -> str | None:
    """The floor's turning, which is left out: (1/5) m (s' - r kappa u')² of the spin makes 2/5 r kappa of the drive."""
    damper, target = results.scene.damper, results.scene.accuracy.damping
    if damper is None or not results.effects["floor_tilt"].on:
        return None
    tilts = [abs(r.floor_tilt) for p, r, _ in ring_downs(results) if p.load_g > 0]
    share = 0.4 * damper.radius * max(tilts, default=0.0)
    if share <= target:
        return None
    return (
        f"The tilting floor also spins the ball. This is neglected: {percent(share)} % of the ball's drive, two fifths"
        " of its radius times the floor's slope over the displacement."
    )


_FORESHORTENED = 1.2
"""Rate at which the tip of a cantilever comes nearer to its root, in u u' over its length: its first mode."""


def sideways(results: Results) -> str | None:
    """Coriolis forces on the ball, which are left out: by chordwise motion beside the load, by foreshortening.

    A cavity that moves by v in the plane of rotation across the radius changes the load by 2 Omega v; one that comes
    nearer to the axis by 1.2 u u' / L pushes the ball sideways by 2 Omega times that, beside its rolling resistance.
    """
    scene, length, surface = results.scene, limits.span(results), results.surface
    if surface is not None and surface.frame is not None:
        length = float(np.ptp(surface.points @ surface.frame[0]))
    if scene.damper is None or length is None or limits.is_printed(results):
        return None
    chord, along = (0.0, ""), (0.0, "")
    for point in results.speeds:
        best = limits.best(results, point)
        if best is None or point.reduced is None or point.load_g == 0:
            continue
        speed, at = 2 * math.pi * point.reduced.f1_hz * best.amplitude, at_load(point)
        tip = point.omega * point.radius
        stagger = scene.rotor.stagger if point.stagger is None else point.stagger
        chord = max(chord, (2 * speed * abs(math.sin(stagger)) / tip, at))
        rolls = limits.lever(scene, point) / scene.damper.radius
        pushed = _FORESHORTENED * speed * best.amplitude / length / tip
        along = max(along, (pushed / rolls if rolls > 0 else 0.0, at))
    notable = [
        f"{percent(share)} % of {what} ({at})"
        for (share, at), what in (
            (chord, "the load from chordwise motion"),
            (along, f"the rolling resistance from the shortening of the bent {carrier(results)}"),
        )
        if share > scene.accuracy.damping
    ]
    if not notable:
        return None
    return (
        f"Coriolis forces on the ball are neglected: up to {' and '.join(notable)} at the amplitude of largest damping."
    )


_LINEAR = 0.3
"""Way over the radius of its path up to which a pendulum's frequency is off by 1 %: 1 - (s/rho)²/16 and the load's."""


def pendulum(results: Results) -> str | None:
    """What a hollow floor makes of the ball, and where it is no longer linear."""
    damper = results.scene.damper
    swings = (
        p.damping_curve.pendulum for p, _, _ in ring_downs(results) if p.damping_curve is not None and p.load_g > 0
    )
    pendulum = next(filter(None, swings), None)
    if damper is None or damper.floor_radius is None or pendulum is None:
        return None
    along, across = (significant(order, 3) for order in pendulum.order)
    tuned = f"order {along}" if along == across else f"orders {along} and {across}"
    text = (
        f"In its hollow floor the ball is a pendulum of engine {tuned}, at all speeds, along the bending direction and"
        " across"
    )
    reach = max(
        (side / 2 - damper.radius) / (radius - damper.radius)
        for side, radius in zip(damper.cavity, damper.floor_radius, strict=True)
    )
    if reach <= _LINEAR:
        return f"{text}."
    return (
        f"{text}, for small swings. The cavity allows {significant(reach, 2)} radii of its path; beyond {_LINEAR:g}"
        " radii its frequency falls by more than 1 %, which is neglected."
    )


def modes_left_out(results: Results) -> str | None:
    """Modes that hits feed but for which there is no room, or that were not looked for."""
    scene = results.scene
    left_out = (
        (reduced.M1 - reduced.M2) * math.hypot(*mode.shape) ** 2
        for point, reduced, damping in ring_downs(results)
        for mode in point.cavity_modes
        if mode.number not in damping.modal_energies
    )
    worst = max(left_out, default=0.0)
    if worst <= scene.accuracy.damping or not results.effects["structural_modes"].on:
        return None
    return (
        f"Modes that wall hits excite are left out: each would change the damping by about {percent(worst)} %, more"
        f" than the {significant(100 * scene.accuracy.damping)} % asked for. [accuracy] damping = {upwards(worst)} is"
        " attainable."
    )


def still_across(results: Results) -> str | None:
    """No mode that was looked for moves the cavity across."""
    rung = [p for p, _, _ in ring_downs(results) if p.cavity_modes]
    if not rung or any(coupling.leading_mode(p.cavity_modes, 1) is not None for p in rung):
        return None
    known = results.scene.known is not None
    why = "such modes are not in the file, or beyond those requested" if known else "the lag modes lie higher"
    return (
        f"None of the {len(rung[0].cavity_modes)} modes moves the cavity along its axis 2, so the cavity is treated as"
        f" fixed in that direction: {why}."
    )


def leaning_load(results: Results) -> str | None:
    """A load that does not point along the plate at the cavity, whose floor is taken to face it."""
    scene = results.scene
    if scene.damper is not None and scene.damper.normal is not None and ring_downs(results):
        return _leaning_ball(results)
    if scene.damper is None or scene.damper.on_plate is None or scene.plate is None or not ring_downs(results):
        return None
    across = abs(scene.damper.on_plate[1] * math.cos(scene.rotor.stagger))
    point = max((p for p, _, _ in ring_downs(results)), key=lambda p: p.load_g)
    lean, rolls = across / point.radius, limits.lever(scene, point) / scene.damper.radius
    if point.load_g == 0 or lean <= 0.1 * rolls:
        return None
    consequence = "would roll to a wall" if lean > rolls else "would come to rest off the middle"
    return (
        f"At this place the load points {significant(math.degrees(math.atan(lean)), 2)}° away from the plate's length."
        " The cavity's floor is assumed perpendicular to the load; on a floor perpendicular to the length, the ball"
        f" {consequence}, which is not simulated."
    )


def _leaning_ball(results: Results) -> str:
    """A floor that does not face the load: where a ball at rest is, and what that takes."""
    scene = results.scene
    point = max((p for p, _, _ in ring_downs(results)), key=lambda p: math.hypot(*p.lean) / p.pressing)
    assert scene.damper is not None
    slope, rolls = math.hypot(*point.lean) / point.pressing, limits.lever(scene, point) / scene.damper.radius
    rests = "leans on a wall" if slope > rolls else "stays where it is, held by its rolling resistance"
    return (
        f"The load leans from the normal of the cavity's floor by {significant(math.degrees(math.atan(slope)), 2)}°"
        f" {at_load(point)}: a ball at rest {rests}, which is simulated."
    )


def level_structure(results: Results) -> str | None:
    """What a scene without a plate does not tell."""
    structure = results.scene.given
    if structure is None or any(structure.floor_tilt) or not any(p.load_g > 0 for p, _, _ in ring_downs(results)):
        return None
    return (
        "This [structure] has no floor tilt (floor_tilt) and no limit of amplitude: the verdict assumes a level floor"
        " and unlimited strength. On a plate the tilt raises the amplitude at which the ball begins to move."
    )


def tilt(results: Results, points: list[SpeedPoint]) -> str | None:
    """What the tilt of the cavity's floor has to do with the answer."""
    shares = [p.tilt_share for p in points]
    if limits.is_printed(results) or max(map(abs, shares)) < _NOTABLE_TILT:
        return None
    sizes = sorted(map(abs, shares))
    share, begin = f"{span(100 * sizes[0], 100 * sizes[-1])} %", f"{as_it_moves(results)}, the cavity's floor tilts"
    if max(shares) <= 0:
        return f"{begin} the other way, and the slope adds {share} to the ball's drive; the figures include it."
    if min(shares) > 1:
        return f"{begin} so far that the slope drives the ball, with {share} of the drive by inertia."
    beyond = "; above 100 % the slope drives the ball" if max(shares) > 1 else ""
    return (
        f"{begin} and the load pulls the ball back down the slope, which cancels {share} of the ball's drive; the"
        f" figures include it{beyond}."
    )


def as_it_moves(results: Results) -> str:
    """How a sentence on the tilt begins."""
    return "As the structure moves" if results.scene.given is not None else f"As the {carrier(results)} bends"


_LIGHT = 10.0
"""Load over g down from which the ball's weight is worth a word: a tenth of it."""

_NOTHING = 1e-9
"""Share of the initial energy that rounding may book as lost."""


def weight(results: Results) -> str | None:
    """The ball's own weight, where it is not small beside the load."""
    points = [p for p, _, _ in ring_downs(results) if 0 < p.load_g < _LIGHT]
    if not points:
        return None
    light = sorted(points, key=lambda point: point.load_g)
    ruled = [p for p in light if limits.weight_governs(p)]
    if len(ruled) == len(light):
        share = f"more than the load up to {whole(ruled[-1].rpm)} rpm" if ruled[1:] else "more than the load"
    else:
        seen = light[len(ruled)]
        share = f"{significant(100 / seen.load_g, 2)} % of the load at {whole(seen.rpm)} rpm"
    return (
        f"The ball's weight is neglected: it is {share}. On a horizontal shaft its direction in the cavity rotates once"
        " per revolution; on a vertical one it pulls the ball to one side."
    )


def at_rest(results: Results) -> str | None:
    """Where nothing turns there is no load: what works by it does nothing, and the answer leaves that speed out."""
    damper, loads = results.scene.damper, [p.load_g for p, _, _ in ring_downs(results)]
    if damper is None or 0.0 not in loads:
        return None
    idle = [key for key in ("rolling_friction", "floor_radius") if getattr(damper, key)]
    text = "At 0 rpm no load presses the ball on its floor: it is free between the walls"
    text += f", and {' and '.join(idle)} {'has' if len(idle) == 1 else 'have'} no effect" if idle else ""
    return f"{text}. The verdict covers the other speeds." if any(loads) else f"{text}."


def lost_at_most(damping: Damping) -> float | None:
    """Share of its energy that a cycle loses at most: a ball that loses nothing only lends, and the rest is ζ's."""
    books, most = damping.energy, damping.peak_sdc
    by_the_ball = books.rolling + books.impact + books.slip
    return damping.intrinsic_sdc if most is not None and abs(by_the_ball) <= _NOTHING * books.initial else most


def lent(results: Results) -> str | None:
    """A cycle of a ring-down that takes more than a steady vibration loses, since the ball may give some of it back."""
    if limits.is_printed(results):
        return None
    borrowed = [(_share(d), p) for p, _, d in ring_downs(results) if lost_at_most(d) != d.peak_sdc and d.impacts]
    if borrowed:
        share, point = max(borrowed, key=lambda pair: pair[0])
        return (
            f"Ball and structure exchange energy without loss: at {whole(point.rpm)} rpm the ball takes up to"
            f" {percent(share)} % in a cycle and returns it later. The table excludes this exchange; the curve over"
            " amplitude includes it, by the paper's definition."
        )
    return None


def _share(damping: Damping) -> float:
    """The most that the ball takes in a cycle, without what the structure's own damping loses."""
    return 0.0 if damping.peak_sdc is None else 1 - (1 - damping.peak_sdc) / (1 - damping.intrinsic_sdc)


def assumptions(results: Results) -> list[tuple[str, str]]:
    """Pairs of an assumption and where it comes from."""
    scene = results.scene
    entries: list[tuple[str, str]] = []
    if scene.plate is not None:
        root = "perfectly clamped" if scene.plate.root is None else "held by linear springs"
        entries.append((f"The plate is linear elastic and {root} at the root.", "assumption"))
    if scene.blade is not None:
        entries.append(
            (
                "The blade is linear elastic and perfectly clamped at the root. It vibrates about its equilibrium under"
                " the load, without Coriolis forces.",
                "assumption",
            )
        )
    if scene.material is not None and (name := scene.material.name) is not None:
        entries.append((f"E, ν and ρ of {name}.", KNOWN[name].source))
    if scene.plate is not None:
        entries += _of_effects(results, "plate")
    if scene.damper is not None:
        hits = "constant e" if isinstance(scene.damper.restitution, float) else "e by the impact speed"
        if scene.damper.ball_material is not None:
            entries.append((f"Density of {scene.damper.ball_material}.", KNOWN[scene.damper.ball_material].source))
        plate = None if scene.material is None else scene.material.name
        names = dict.fromkeys((scene.damper.ball_material, scene.damper.floor_material or plate))
        entries += [
            (f"Yield strength and hardness of {name}.", KNOWN[name].strength)
            for name in names
            if name is not None and KNOWN[name].strength and limits.solids(scene) is not None
        ]
        entries += [
            *_of_effects(results, "damper"),
            ("Rolling resistance is μ_r N / r on each axis, whatever the speed of rolling.", "paper, eq. 2"),
            (f"Wall hits are instantaneous, with {hits} and constant μ.", "paper, eqs. 6 to 11"),
            (
                "Restitution, friction, rolling friction, damping ratio and clearance are as given, and rarely known"
                " well: `spindamp sweep SCENE --uncertain` gives the interval of the damping ratio that follows.",
                "assumption",
            ),
            ("Several balls move in step, each in a cavity of its own.", "assumption"),
            ("The ball's weight is neglected.", "assumption"),
            ("The load and the rotation speed do not change during a ring-down.", "paper, II.A"),
        ]
        consistent = (
            "The moment of inertia is taken about the contact (7/5 m r²), and the structure feels the whole reaction of"
            " the ball.",
            "Newton's laws, which the printed equations violate",
        )
        printed = ("Equations 2 to 4 as printed, which do not conserve energy.", "paper, eqs. 2 to 4")
        entries.append(consistent if scene.damper.formulation == "consistent" else printed)
    if any(paper.row(scene, point.load_g) for point in results.speeds):
        entries += [
            ("Rotation speeds, hub radius 0 and g = 10 m/s².", "read back from the loads of Table II, to every digit"),
            ("E/ρ of the plate, for ν = 0.3.", "fitted to the seven frequencies of Table II"),
        ]
        if _is(results, "kirchhoff"):
            source = "agrees with Table II to 0.04 %, Mindlin's theory to 0.11 %"
            entries.append(("The plate is thin: no transverse shear.", source))
        if scene.damper is not None and scene.damper.damping_ratio:
            entries.append(
                (f"ζ = {scene.damper.damping_ratio:g} of the structure.", "assumption: the paper prints none")
            )
    return entries


def _of_effects(results: Results, of: str) -> list[tuple[str, str]]:
    """What effects of the plate, or of the damper, take for granted, on or off."""
    from fem.theory.registry import kind

    theory = "" if results.theory is None else kind(results.theory.name).value
    words = tomllib.loads(_ASSUMPTIONS.read_text(encoding="utf-8"))
    cases = {
        name: effect.assumed(results.scene, results.effects[name].on, theory)
        for name, effect in EFFECTS.items()
        if effect.of == of
    }
    return [tuple(words[name][case]) for name, case in cases.items() if case in words.get(name, {})]


_ASSUMPTIONS = Path(__file__).parents[1] / "templates" / "assumptions.toml"


PARTS = {
    "mesh": "mesh",
    "layers": "layers of the solid",
    "basis": "reduced basis",
    "theory": "theory",
    **{name: f"{EFFECTS[name].word} left out" for name in ("large_deflection", "coriolis")},
    "cavity_mass": "cavities",
}
"""Parts of an error, as people call them."""


class Worst(NamedTuple):
    """The largest error of a mode (its number, from 1) over the speeds, with its parts."""

    number: int
    whole: float
    parts: ErrorParts


@lru_cache(maxsize=1)  # asked by several sentences of one report
def worst(results: Results) -> list[Worst]:
    """Mode by mode, those whose error is known."""
    largest: dict[int, Worst] = {}
    for point in results.speeds:
        for number, mode in enumerate(point.modes, 1):
            whole, parts = mode.error_estimate, mode.error_parts
            if whole is not None and parts is not None and (number not in largest or whole > largest[number].whole):
                largest[number] = Worst(number, whole, parts)
    return [largest[number] for number in sorted(largest)]


def met(results: Results) -> bool:
    """Whether no error, as far as it is known, is beyond the accuracy asked for."""
    return all(mode.whole <= results.scene.accuracy.frequency for mode in worst(results))


def carrier(results: Results) -> str:
    """What carries the damper, in a word."""
    scene = results.scene
    return "blade" if scene.blade is not None else "plate" if scene.plate is not None else "structure"


def _led_by(results: Results) -> tuple[int, SpeedPoint] | None:
    """Number of the mode that yields most along axis 1 and the first speed where it is not the first bending mode."""
    for point in results.speeds:
        if results.scene.in_space and point.reduced is not None and point.modes:
            off = [abs(mode.frequency_hz - point.reduced.f2_hz) for mode in point.modes]
            number = off.index(min(off))
            if number != [*(mode.family for mode in point.modes), "flap"].index("flap"):
                return number + 1, point
    return None


def other_mode(results: Results) -> str | None:
    """A cavity whose axis 1 is moved most by another than the first bending mode."""
    led = _led_by(results)
    if led is None or (reduced := led[1].reduced) is None:
        return None
    number, point = led
    return (
        f"Mode {number} ({point.modes[number - 1].family}, {significant(reduced.f2_hz)} Hz {at_load(point)}) moves the"
        " cavity most along its axis 1: amplitudes, cut-offs and damping ratios are those of this mode."
    )


def sentence(results: Results) -> str | None:
    """The whole error of the first frequency and of the worst, what most of that is, and what would mend it."""
    modes = worst(results)
    if not modes:
        return None
    last, target = max(modes, key=lambda mode: mode.whole), results.scene.accuracy.frequency
    wanted = f"{significant(100 * target)} %"
    verdict = f"within the {wanted} asked for" if met(results) else f"{wanted} was asked for; {cure(results)}"
    first = f"Mode {modes[0].number} is accurate to {percent(modes[0].whole)} %"
    others = "" if last is modes[0] else f", mode {last.number}, the least accurate, to {percent(last.whole)} %"
    return f"{first}{others} ({_largest(last)}): {verdict}."


def cure(results: Results) -> str:
    """Which keys would bring every error within the accuracy asked for; or, where none would, what is attainable.

    The mesh is only as fine as what the rest leaves of the accuracy makes worth while, and else would be finer.
    """
    modes, target = worst(results), results.scene.accuracy.frequency
    left = {mode.number: mode.whole for mode in modes}
    sizes = {name: [getattr(mode.parts, name) or 0.0 for mode in modes] for name in PARTS}
    keys = []
    for name in sorted(PARTS, key=lambda name: -max(sizes[name])):
        if max(sizes[name]) > 0.0 and max(left.values()) > target and (key := _remedy(results, name)) is not None:
            keys.append(key)
            left = {mode.number: left[mode.number] - size for mode, size in zip(modes, sizes[name], strict=True)}
    rest = max(left[mode.number] - (mode.parts.mesh or 0.0) for mode in modes)
    thin = _is(results, "kirchhoff") and not any("theory" in key for key in keys)
    if keys and rest <= target / 2 and not (thin and _DEFLECTED in keys):
        return f"{' and '.join(keys)} would achieve it"
    attainable = upwards(max(mode.whole for mode in modes))
    return f"no setting achieves this, but [accuracy] frequency = {attainable} would be met"


_DEFLECTED = "[effects] large_deflection = true"
"""What thin-plate theory does not know."""


def _remedy(results: Results, part: str) -> str | None:
    """The key that takes a part of the error away, with its value; None where nothing in a scene does."""
    from fem.accuracy.theory_selection import DEAR

    if results.scene.in_space:
        return "a finer mesh" if part == "mesh" and results.scene.blade is not None else None
    if part in EFFECTS:
        return None if results.effects[part].on else f"[effects] {part} = true"
    plate, deflected = results.scene.plate, results.effects["large_deflection"].on
    if part != "theory" or _is(results, "solid") or plate is None or plate.mesh is not None or deflected:
        return None
    return f'[plate] theory = "{"auto" if results.scene.accuracy.frequency >= DEAR else "solid"}"'


def _is(results: Results, theory: str) -> bool:
    return results.theory is not None and results.theory.name == theory


def _largest(mode: Worst) -> str:
    """The parts that make up most of an error."""
    sizes = {phrase: getattr(mode.parts, name) or 0.0 for name, phrase in PARTS.items()}
    shown = [phrase for phrase, size in sizes.items() if size >= 0.1 * mode.whole]
    return ", ".join(f"{phrase} {percent(sizes[phrase])} %" for phrase in shown)


_WIDE = 2.0
"""Width over length of a mesh from which on it is asked whether it is meant."""


def root_stress(results: Results) -> str | None:
    """The centrifugal pull at the root, where the answer does not speak of it."""
    fastest = max(results.scene.rotor.speeds)
    stress = limits.root_stress(results, fastest)
    if stress is None or not 1e7 <= stress <= limits.STRONGEST:
        return None
    return (
        f"At {whole(in_rpm(fastest))} rpm the mean centrifugal stress at the root is {significant(stress / 1e6)} MPa:"
        " compare it with the yield strength of the material."
    )


def wide(results: Results) -> str | None:
    """A mesh that is clamped along its long edge, which may be one laid the wrong way round."""
    plate, surface = results.scene.plate, results.surface
    if plate is None or plate.mesh is None or surface is None:
        return None
    length, width = (float(1e3 * side) for side in np.ptp(surface.points[:, :2], axis=0))
    if width <= _WIDE * length:
        return None
    return (
        f"The mesh is {significant(width)} mm wide and {significant(length)} mm long: its root, at the smallest x, is a"
        " long edge. If the short edge is the root, rotate the mesh so that its length lies along x."
    )


def frequency_error(results: Results) -> str | None:
    """How far the frequencies can be trusted, and by what they are off."""
    from fem.theory.registry import THEORIES

    if results.diagram is None or results.theory is None:
        return None
    own = THEORIES[results.theory.name].against_solid
    plate = results.scene.plate
    if plate is not None and plate.mesh is not None and results.theory.name == "solid":
        own += " A thin solid on cells that are not rectangles is too stiff until the mesh is fine; Mindlin's is not."
    if results.scene.point_mass > 0:
        own = (
            "Under a point mass frequencies fall with every refinement: the estimate covers cells down to a tenth of"
            f" the thickness. {own}"
        )
    mesh, accuracy = results.diagram.mesh, sentence(results)
    if accuracy is None:
        unknown = f"The error of the mesh ({mesh}) is not known: it is too large to be compared with a finer one."
        return f"{unknown} {own}"
    return f"{accuracy} The mesh: {mesh}. {own}"


def real_modes(results: Results) -> str | None:
    """What Coriolis forces do to the mode that the damper feels, where that is more than the accuracy asked for."""
    if not results.effects["coriolis"].on:
        return None
    moved = []
    for point in results.speeds:
        flap = next((mode for mode in point.modes if mode.family == "flap"), None)
        if point.reduced is not None and flap is not None:
            moved.append(flap.frequency_hz / point.reduced.f2_hz - 1)
    most = max(moved, key=abs, default=0.0)
    if abs(most) <= results.scene.accuracy.frequency:
        return None
    return (
        f"Coriolis forces move the first bending mode by {percent(most)} %. The structure at the damper (M1, K1, M2,"
        " K2) is that of the real mode, without them."
    )


def divergence(results: Results) -> str | None:
    """Speeds that have no answer."""
    if results.diagram is None or not results.diagram.lost:
        return None
    lost, critical = results.diagram.lost, results.diagram.critical
    which = f"{whole(lost[0])} rpm"
    if len(lost) > 1:
        which = f"{len(lost)} of the speeds asked for, from {which} on"
    where = "" if critical is None else f" Its critical speed is {critical:.6g} rpm."
    return f"The plate diverges at {which}: it leaves its equilibrium without oscillating and has no frequency.{where}"


def veering(results: Results) -> str | None:
    """Where modes could not be followed for certain."""
    if results.diagram is None or not results.diagram.veerings:
        return None
    crossings = results.diagram.veerings
    places = [f"{whole(low)} and {whole(high)} rpm ({', '.join(names)})" for low, high, names in crossings]
    more = f", and {len(places) - 4} times more" if len(places) > 4 else ""
    return (
        f"Between {'; between '.join(places[:4])}{more} modes change too much to be followed with certainty: they veer,"
        " or cross at a sharper angle than the steps resolve. A curve of the Campbell diagram may continue as another"
        " mode."
    )


EXPLAINED = 1e-9
"""Share of the initial energy that the books may leave unexplained without a word."""


def remarked(results: Results) -> Results:
    """The same results with the remarks that the run calls for among their notes."""
    return replace(results, notes=(*results.notes, *remarks(results)))


def remarks(results: Results) -> tuple[str, ...]:
    """The remarks that the run calls for, those that bear most on the answer first."""
    texts = (remark(results) for remark in REMARKS)
    return tuple(text for text in texts if text)


def _capped(results: Results) -> str | None:
    """All speeds whose ring-down ended before its ball did."""
    rung = [(p, d) for p, _, d in ring_downs(results)]
    ended = dict.fromkeys(d.outcome for _, d in rung if "cap" in d.outcome)
    parts = []
    for outcome in ended:
        there = [p for p, d in rung if d.outcome == outcome]
        marked = any(cutoff_mark(results, p) for p in there)
        known = f": the cut-offs marked {AT_REST} are those of a ball at rest" if marked else ""
        parts.append(f"{capital(stretch(there, [p for p, _ in rung]))} {outcome}{known}.")
    return " ".join(parts) or None


def _nothing_released(results: Results) -> str | None:
    release = results.scene.release
    still = [p.rpm for p, _, _ in ring_downs(results) if p.load_g == 0]
    if release is None or release.ratio is None or not still:
        return None
    return f"At {whole(still[0])} rpm there is no load, so a release by its ratio is zero: nothing moves there."


def _held(results: Results) -> str | None:
    """Ring-downs in which the release is too small to set the ball rolling."""
    rung = [(p, d, p.level or p.damping_curve) for p, _, d in ring_downs(results) if p.load_g > 0 and d.events == 0]
    peaks = [(p, d, own) for p, d, own in rung if own is not None and own.peak > 0]
    if not peaks:
        return None
    point, damping, own = min(peaks, key=lambda entry: entry[0].load_g)
    lift = significant(1e3 * math.hypot(*damping.release))
    needed = significant(1e3 * own.cutoff, 2)
    return (
        f"From {whole(point.rpm)} rpm on, this scene's release of {lift} mm is below the {needed} mm that set the ball"
        " rolling: those ring-downs show the structure alone."
    )


def _books(results: Results) -> str | None:
    shares = [d.energy.residual / d.energy.initial for _, _, d in ring_downs(results) if d.energy.initial > 0]
    worst = max(shares, key=abs, default=0.0)
    if abs(worst) <= EXPLAINED:
        return None
    what = "appears without a source" if worst < 0 else "is lost without a cause"
    why = ": the printed equations do not conserve energy" if limits.is_printed(results) else ""
    return f"Up to {percent(abs(worst))} % of the initial energy {what}{why}."


def _rows(results: Results) -> str | None:
    """Cavities that do not lie side by side: the innermost ones feel less load and less motion."""
    plate, damper = results.scene.plate, results.scene.damper
    if plate is None or plate.width is None or damper is None or damper.housing:
        return None
    place = damper.on_plate or (plate.length or 0.0, 0.0)
    most = cavities_abreast(damper, plate_mesh.plate_thickness(plate, place), plate.width)
    if damper.count <= most:
        return None
    rows = math.ceil(damper.count / most)
    return (
        f"At most {most} of the {damper.count} cavities fit side by side in a section of the plate: they need {rows}"
        f" rows along the radius, {significant(2e3 * damper.radius * rows)} mm deep. The model places all of them at"
        " one point; nearer the root, load and motion are smaller."
    )


def _rolling(results: Results) -> str | None:
    damper = results.scene.damper
    demands_of = ((p, math.hypot(*d.release), d.largest_rolling_demand or 0.0) for p, _, d in ring_downs(results))
    rolled = [each for each in demands_of if each[2] > 0]
    beyond = [] if damper is None else [each for each in rolled if each[2] > damper.friction]
    if damper is None or not beyond:
        return None
    points, lifts, demands = zip(*beyond, strict=True)
    lift, most = span(1e3 * min(lifts), 1e3 * max(lifts), 3), max(demands)
    return (
        f"In the ring-downs (release {lift} mm), rolling without slip requires a friction coefficient of up to"
        f" {significant(most, 2)} (at {points[demands.index(most)].rpm:.6g} rpm), and more than the {damper.friction:g}"
        f" given for wall hits {stretch(points, [p for p, _, _ in rolled])}: unless the floor grips better, the ball"
        " would slip."
    )


def _release_stress(results: Results) -> str | None:
    material, rung = results.scene.material, ring_downs(results)
    if material is None or not rung:
        return None
    lift, at = max((abs(damping.release[0]), at_load(point)) for point, _, damping in rung)
    strain = limits.root_strain(results, lift)
    if strain is None or material.youngs_modulus * strain < 1e8:
        return None
    stress = material.youngs_modulus * strain
    large = ", far outside small deflections and, for most metals, outside the elastic range" if stress > 4e8 else ""
    return (
        f"A release of {significant(1e3 * lift)} mm at the cavity ({at}) bends the root to about"
        f" {significant(stress / 1e6, 2)} MPa{large}."
    )


FIRST = 5
"""Remarks beside the answer; the rest stand at the end."""

REMARKS: tuple[Callable[[Results], str | None], ...] = (
    divergence,
    wide,
    _capped,
    weight,
    _books,
    leaning_load,
    other_mode,
    level_floor,
    level_structure,
    dents,
    long_hits,
    still_across,
    root_stress,
    _rolling,
    _held,
    _nothing_released,
    _release_stress,
    pendulum,
    turning_floor,
    sideways,
    modes_left_out,
    lent,
    _rows,
    at_rest,
    real_modes,
    veering,
    frequency_error,
)
"""Most important first; the last, on the errors of the frequencies, is long and has its own table."""
