"""What a careful engineer would remark about a run, what it takes for granted, and how exact its frequencies are.

Numbers are found here; the sentences are the texts of the same names in `templates/remarks.toml`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, wraps
from itertools import groupby
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from damper import Outcome
from damper.contact import Contact
from damper.state import MODES
from fem.theory.registry import THEORIES, kind
from workflows.effects.selection import EFFECTS, OF_THE_PLATE, called_for
from workflows.formatting import turning, upwards
from workflows.report import templates
from workflows.scene import paper
from workflows.scene.damper import cavities_abreast
from workflows.scene.materials import KGF, KNOWN, OSMIUM, is_too_dense
from workflows.scene.scene import FINEST, Scene
from workflows.solve import coupling, limits
from workflows.solve.results import (
    Damping,
    ErrorParts,
    HitFigures,
    Reason,
    Reduced,
    Results,
    SpeedPoint,
    leading_mode,
)

Values: TypeAlias = dict[str, Any] | None
"""What a sentence says, by name; None where there is nothing to say."""

BEYOND, BEYOND_MEANS = "†", "† Beyond the amplitude that the structure endures"
NO_VERDICT, NO_VERDICT_MEANS = "‡", "‡ No verdict at this speed"
AT_REST, AT_REST_MEANS = (
    "*",
    "* Of a ball at rest: it stays at rest up to this amplitude. Unmarked: the last amplitude of the ring-down at which"
    " its ball moved.",
)
MARKS = BEYOND, NO_VERDICT, AT_REST
ROUGH = 0.5
"""Relative error from which on a damping ratio is known only roughly."""
LEVEL_MEANS = "Cut-off, SDC and hits are those of a level floor, as in the scene; the ball's damping includes its tilt."
"""Marks of numbers in tables, and what they stand for below."""


def said(text: str, results: Results, **values: Any) -> list[str]:
    """Sentences of a text on some values, and on what every one may name."""
    scene = results.scene
    known = {"carrier": carrier(scene), "strained": limits.strained(scene), "damper": scene.damper}
    return templates.said(text, scene.ball_count, **known, **values)


def phrase(text: str, results: Results, **values: Any) -> str:
    """The same in one line."""
    return " ".join(said(text, results, **values))


def worded(values: Callable[[Results], Values]) -> Callable[[Results], str | None]:
    """The sentence that the text of the same name makes of the values of a run."""

    @wraps(values)
    def words(results: Results) -> str | None:
        found = values(results)
        return None if found is None else phrase(f"remarks/{values.__name__}", results, **found)

    return words


def mark(results: Results, point: SpeedPoint) -> str:
    """What a table puts beside the damper's figures at a speed; empty where they are as good as the answer."""
    figures, verdict = point.damping_curve, point.verdict
    if figures is None or verdict is None:
        return ""
    if verdict.rank < 0 or (point.load_g == 0 and figures.peak > 0):
        return NO_VERDICT
    return BEYOND if limits.is_beyond(results, point) else ""


def legend(results: Results, *, cutoffs: bool = True, damping: bool = True) -> list[str]:
    """What the marks of a table over all speeds stand for, and what it leaves open: of cut-offs, of damping ratios."""
    points, means = results.speeds, {AT_REST: AT_REST_MEANS}
    marks = {cutoff_mark(results, p) for p in points if cutoffs} | {mark(results, p) for p in points if damping}
    beyond = [p.omega for p in points if limits.is_beyond(results, p)]
    means[BEYOND] = f"{beyond_means(results, beyond)}; the verdict uses the largest value within that limit."
    still = "; at 0 rpm no load presses a ball on its floor" if any(p.load_g == 0 for p in points) else ""
    means[NO_VERDICT] = f"{NO_VERDICT_MEANS}{still}."
    judged = [p for p in points if damping and p.verdict is not None and p.verdict.rank >= 0]
    rough = [p for p in judged if p.damping_curve is not None and p.damping_curve.error > ROUGH]
    lines = [line for each, line in means.items() if each in marks]
    lines += said("remarks/rough", results, points=rough) if rough else []
    tilts = any(p.damping_curve and p.damping_curve.tilted_cutoff_ratio is not None for p in points)
    return [*lines, LEVEL_MEANS] if cutoffs and damping and tilts and not results.scene.is_printed else lines


def beyond_means(results: Results, speeds: list[float]) -> str:
    """What the mark of amplitudes at these speeds [rad/s] stands for."""
    bears = limits.torn_above(results)
    small = all(omega <= bears and limits.deflection_governs(results, omega) for omega in speeds)
    return f"{BEYOND} Beyond small deflections" if small else BEYOND_MEANS


def cutoff_mark(results: Results, point: SpeedPoint) -> str:
    """What a table puts beside a cut-off that no ring-down shows."""
    return AT_REST if limits.cutoff(results, point).at_rest else ""


def beyond_of(results: Results, omega: float) -> str:
    """What a larger amplitude than the structure endures at a speed [rad/s] would do to it."""
    return phrase("phrases/beyond", results, by_deflection=limits.deflection_governs(results, omega))


def torn_from(results: Results) -> str | None:
    """Above which speed the plate would tear, and the stress at the first such; None where it holds at all."""
    endured = limits.torn_above(results)
    first = min((point.omega for point in results.speeds if point.omega > endured), default=None)
    if first is None:
        return None
    of = {"bears": turning(endured), "speed": turning(first), "stress": limits.root_stress(results, first)}
    return phrase("phrases/torn", results, **of)


def too_dense(results: Results) -> tuple[str, str] | None:
    """What of a ball is denser than any solid, and what would weigh as much; None where it is possible."""
    damper = results.scene.damper
    density = max((limits.ball_density(results, point) for point in results.speeds), default=0.0)
    if damper is None or not is_too_dense(density):
        return None
    volume = 4 / 3 * math.pi * damper.radius**3
    steel = math.ceil(density * volume * damper.count / (KNOWN["steel"].density * volume))
    values = {"radius": damper.radius, "mass": density * volume, "osmium": density / OSMIUM, "steel": steel}
    return phrase("remarks/too_dense", results, **values), phrase("remarks/of_steel", results, **values)


def _contacts(results: Results, points: Sequence[SpeedPoint]) -> list[tuple[SpeedPoint, Contact]]:
    """The contact of the resting ball at the points, where its materials are known."""
    return [(point, each) for point in points if (each := limits.contact(results.scene, point)) is not None]


def flows(results: Results, points: Sequence[SpeedPoint]) -> str:
    """That the contact of the resting ball flows at some speeds, and how flat it becomes."""
    return phrase("remarks/flows", results, contacts=[contact for _, contact in _contacts(results, points)])


@worded
def unknown_floor(results: Results) -> Values:
    """That nothing is known of what the floor bears, and what the ball asks of it where it presses most.

    Where the materials are not known, both are of steel for that, and it is said of what only some metals bear.
    """
    scene, speeds = results.scene, results.speeds
    if (made_of := limits.solids(scene)) is None:
        steel, speeds = limits.solid("steel"), tuple(p for p in speeds if limits.best(results, p) is not None)
        every = [(p, c) for p in speeds if (c := limits.contact(scene, p, (steel, steel))) is not None]
    else:
        unknown = math.isnan(made_of[1].hardness)
        every = [(p, c) for p, c in _contacts(results, speeds) if unknown and not c.hardness_ratio >= 1]
    point, most = max(every, key=lambda pair: pair[1].peak_pressure, default=(None, None))
    if most is None or (made_of is None and 2 / 3 * most.peak_pressure < _BORNE):
        return None
    return {"known": made_of is not None, "floor": scene.contact_materials[1], "point": point, "most": most, "kgf": KGF}


_BORNE = 1e9
"""Mean pressure [Pa] that the softest blade metals bear, about the hardness of annealed stainless steel."""


def ring_downs(results: Results) -> list[tuple[SpeedPoint, Reduced, Damping]]:
    """The speeds at which the damper was simulated."""
    return [(p, p.reduced, p.damper) for p in results.speeds if p.reduced is not None and p.damper is not None]


_NOTABLE_TILT = 0.01
"""Share of the drive from which on the tilt of the floor is worth a sentence."""


_ALONG_BOTH = 0.02
"""Share of the drive that is left along axis 2 beside axis 1 from which on it is said that the tilt's is of axis 1."""


def tilt(results: Results, points: list[SpeedPoint]) -> str | None:
    """What the tilt of the cavity's floor has to do with the answer."""
    shares = [p.tilt_share for p in points]
    if results.scene.is_printed or max(map(abs, shares)) < _NOTABLE_TILT:
        return None
    both = any(point.drive_left > abs(1 - point.tilt_share) + _ALONG_BOTH for point in points)
    return phrase("remarks/tilt", results, begin=as_it_moves(results), shares=shares, both=both)


def as_it_moves(results: Results) -> str:
    """How a sentence on the tilt begins."""
    return "As the structure moves" if results.scene.given is not None else f"As the {carrier(results.scene)} bends"


def lost_at_most(damping: Damping) -> float | None:
    """Share of its energy that a cycle loses at most: a ball that loses nothing only lends, and the rest is ζ's."""
    books, most = damping.energy, damping.peak_sdc
    by_the_ball = books.rolling + books.impact + books.slip
    return damping.intrinsic_sdc if most is not None and abs(by_the_ball) <= _NOTHING * books.initial else most


_NOTHING = 1e-4
"""Share of the initial energy that counts as nothing lost by the ball in a ring-down."""


def _share(damping: Damping) -> float:
    """The most that the ball takes in a cycle, without what the structure's own damping loses."""
    return 0.0 if damping.peak_sdc is None else 1 - (1 - damping.peak_sdc) / (1 - damping.intrinsic_sdc)


def assumptions(results: Results) -> list[tuple[str, str]]:
    """Pairs of an assumption and where it comes from."""
    scene = results.scene
    theory = "" if results.theory is None else kind(results.theory.name).value
    words = templates.texts("assumptions")
    cases = {name: effect.assumed(scene, results.effects[name].on, theory) for name, effect in EFFECTS.items()}
    assumed = {name: words[name][case] for name, case in cases.items() if case in words.get(name, {})}
    strengths = dict.fromkeys(scene.contact_materials) if limits.solids(scene) is not None else ()
    of: dict[str, Any] = {
        "scene": scene,
        "effects": {of: [assumed[name] for name in assumed if EFFECTS[name].of == of] for of in ("plate", "damper")},
        "known": KNOWN,
        "strengths": [name for name in strengths if name is not None and KNOWN[name].strength],
        "table_two": paper.is_known(scene, (point.load_g for point in results.speeds)),
        "kirchhoff": _is(results, "kirchhoff"),
    }
    lines = templates.said("remarks/assumptions", **of)
    return [(text, source) for text, _, source in (line.partition(" | ") for line in lines)]


_BY_EFFECT = {name: EFFECTS[name].word for name in ("large_deflection", "coriolis")}
"""Parts of an error that an effect removes."""

PARTS = {
    "mesh": "mesh",
    "layers": "layers of the solid",
    "basis": "reduced basis",
    "theory": "theory",
    **{name: f"{effect} left out" for name, effect in _BY_EFFECT.items()},
    "cavity_mass": "cavities",
}
"""Parts of an error, as people call them."""

_OF_FILES = {"mesh": "file", "basis": "interpolation"}
"""The same of known modes."""

_WITHOUT_PART = tuple(name for name in OF_THE_PLATE if name not in _BY_EFFECT)
"""Effects of a plate that are on unless the scene switches them off; what they would move is not estimated."""


_NOTABLE_PART = 0.1
"""Share of the largest error from which on a part of it is named."""


class Worst(NamedTuple):
    """The largest error of a mode (its number, from 1) over the speeds, with its parts."""

    number: int
    whole: float
    parts: ErrorParts


@lru_cache(maxsize=1)  # asked by several sentences of one report
def worst(results: Results) -> list[Worst]:
    """Mode by mode, those whose error is known; nan where it is not between two speeds of files."""
    largest: dict[int, Worst] = {}
    for point in results.speeds:
        for number, mode in enumerate(point.modes, 1):
            parts = mode.error_parts
            whole = None if parts is None else parts.whole
            least = largest[number].whole if number in largest else -1.0
            if parts is not None and whole is not None and (whole > least or math.isnan(whole)):
                largest[number] = Worst(number, whole, parts)
    return [largest[number] for number in sorted(largest)]


def met(results: Results) -> bool:
    """Whether no error, as far as it is known, is beyond the accuracy asked for."""
    return all(mode.whole <= results.scene.accuracy.frequency for mode in worst(results))


def misfit(scene: Scene, points: Sequence[SpeedPoint]) -> list[str]:
    """That the cavity has to fit, which sticks out of a structure in space."""
    far = max((point.sticks_out for point in points), default=0.0)
    return templates.said("answer/misfit", scene.ball_count, carrier=carrier(scene), far=far) if far else []


def carrier(scene: Scene) -> str:
    """What carries the damper, in a word."""
    return "blade" if scene.blade is not None else "plate" if scene.plate is not None else "structure"


@worded
def sentence(results: Results) -> Values:
    """The whole error of the first frequency and of the worst, what most of that is, and what would mend it."""
    modes = worst(results)
    if not modes:
        return None
    target = results.scene.accuracy.frequency
    unknown = any(math.isnan(mode.whole) for mode in modes)
    if unknown:
        return {"unknown": unknown, "target": target}
    last = max(modes, key=lambda mode: mode.whole)
    named = PARTS if results.scene.known is None else PARTS | _OF_FILES
    sizes = {words: getattr(last.parts, name) or 0.0 for name, words in named.items()}
    parts = {words: size for words, size in sizes.items() if size >= _NOTABLE_PART * last.whole}
    calls = called_for(results.scene, names=_WITHOUT_PART)
    off = [EFFECTS[name].word for name in calls if calls[name].called and not results.effects[name].on]
    missed = {} if met(results) else cure(results)
    return {
        "unknown": unknown,
        "first": modes[0],
        "last": last,
        "parts": parts,
        "off": off,
        "target": target,
        "met": met(results),
        **missed,
    }


def cure(results: Results) -> dict[str, Any]:
    """Which keys would reduce the error, and which part of it; and the error that is left, beyond the target.

    That with any setting (`least`), and with any mesh (`left`).

    What the whole error would be is not known: the mesh is chosen anew, without room for the part of the cavities,
    which depends on it and on the theory. A solid, which is dear, is named only where no mesh would do without it.
    """
    modes, target = worst(results), results.scene.accuracy.frequency
    sizes = {name: np.array([getattr(mode.parts, name) or 0.0 for mode in modes]) for name in PARTS}
    remedies = {name: _remedy(results, name) for name in PARTS if sizes[name].any()}
    least = float(sum((sizes[name] for name, key in remedies.items() if key is None), np.zeros(len(modes))).max())
    left = sum((sizes[name] for name, key in remedies.items() if key != _FINER), np.zeros(len(modes)))
    thin = results.scene.plate is not None and results.scene.plate.theory == "kirchhoff"  # knows no large deflection
    keys: dict[str, str] = {}
    whole = np.array([mode.whole for mode in modes])
    missed = whole > target
    notable = [name for name in remedies if (sizes[name] >= _NOTABLE_PART * whole)[missed].any()]
    for name in sorted(notable, key=lambda name: (thin and name != "theory", -sizes[name].max())):
        key = remedies[name]
        if key and key != _FINER and left.max() > (target if name == "theory" else target / 2):
            keys[key], left = _BY_EFFECT.get(name, "the theory"), left - sizes[name]
    if not keys and (key := _refining(results)):
        keys[key] = "the mesh"
    rest = float(left.max())
    return {"least": least if least > target else None, "left": rest if rest > target else None, "keys": keys}


def _attainable(error: float) -> str | None:
    """The accuracy that an error would meet, in one digit; None from 1 on, which a scene cannot ask for."""
    digit = upwards(error)
    return digit if float(digit) < 1 else None


_FINER = "a finer mesh"
"""What reduces the part of the mesh and of a solid's layers."""


_REFINES = 1 / 3
"""Part of an accuracy that always refines the mesh, whose tolerance is at least 0.38 of it (`Budget.mesh`)."""


def _refining(results: Results) -> str | None:
    """The key that refines the mesh of a plate; None where it may change the theory for the worse."""
    from fem.accuracy.theory_selection import DEAR

    plate, finer = results.scene.plate, _REFINES * results.scene.accuracy.frequency
    if plate is None or plate.mesh is not None or finer < FINEST:
        return None
    if plate.theory == "auto" and _is(results, "solid") and finer < DEAR:
        return None
    return f"[accuracy] frequency = {finer:.2g}"


def _remedy(results: Results, part: str) -> str | None:
    """The key that reduces a part of the error, with its value; empty where some may, None where none does."""
    from fem.accuracy.theory_selection import DEAR

    scene, plate = results.scene, results.scene.plate
    if part in ("mesh", "layers"):
        return _FINER if scene.known is None else None
    if part == "cavity_mass":  # whose mass is little where it is left out
        return None if plate is None or results.effects[part].on else ""
    if part in EFFECTS:
        return None if scene.in_space or results.effects[part].on else f"[effects] {part} = true"
    if part != "theory" or plate is None:
        return None
    if plate.mesh is not None:
        return '[plate] theory = "mindlin"' if _is(results, "kirchhoff") else ""
    off = max(mode.parts.theory for mode in worst(results)) > scene.budget.sheared
    requested = plate.theory != "auto" and not results.effects["large_deflection"].on
    return f'[plate] theory = "{"auto" if off and requested and scene.accuracy.frequency >= DEAR else "solid"}"'


def _is(results: Results, theory: str) -> bool:
    return results.theory is not None and results.theory.name == theory


FIRST = 5
"""Remarks beside the answer; the rest stand at the end."""

_REMARKS: list[Callable[[Results], str | None]] = []
"""In the order of their functions below: most important first; the last is long and has its own table."""


def remark(values: Callable[[Results], Values]) -> Callable[[Results], str | None]:
    """A remark that a run may call for, in the words of the text of the same name."""
    _REMARKS.append(worded(values))
    return _REMARKS[-1]


def remarks(results: Results) -> tuple[str, ...]:
    """The remarks that the run calls for, those that bear most on the answer first."""
    texts = (remark(results) for remark in _REMARKS)
    return tuple(text for text in texts if text)


def remarked(results: Results) -> Results:
    """The same results with the remarks that the run calls for among their notes."""
    return replace(results, notes=(*results.notes, *remarks(results)))


@remark
def divergence(results: Results) -> Values:
    """Speeds that have no answer."""
    diagram = results.diagram
    return None if diagram is None or not diagram.lost else {"lost": diagram.lost, "critical": diagram.critical}


_WIDE = 2.0
"""Width over length of a mesh from which on it is asked whether it is meant."""


@remark
def wide(results: Results) -> Values:
    """A mesh that is clamped along its long edge, which may be one laid the wrong way round."""
    plate, surface = results.scene.plate, results.surface
    if plate is None or plate.mesh is None or surface is None:
        return None
    length, width = (float(1e3 * side) for side in np.ptp(surface.points[:, :2], axis=0))
    return {"width": width, "length": length} if width > _WIDE * length else None


_CAPS = Outcome.CYCLE_CAP, Outcome.EVENT_CAP
"""What ends a ring-down before its ball has come to rest."""


@remark
def capped(results: Results) -> Values:
    """All speeds whose ring-down ended before its ball did."""
    rung = [(p, d.outcome) for p, _, d in ring_downs(results)]
    ended = {outcome: [p for p, own in rung if own == outcome] for _, outcome in rung if outcome in _CAPS}
    marked = {outcome: any(cutoff_mark(results, p) for p in points) for outcome, points in ended.items()}
    return {"ended": ended, "marked": marked, "mark": AT_REST, "points": [p for p, _ in rung]} if ended else None


_LIGHT = 10.0
"""Load over g, or what else acts on the ball, down from which its weight is worth a word: a tenth of it."""


@remark
def weight(results: Results) -> Values:
    """The ball's own weight, where it is not small beside the load, or beside what holds or drives the ball."""
    loaded = [p for p, _, _ in ring_downs(results) if p.load_g > 0]
    points = sorted((p for p in loaded if p.load_g < _LIGHT), key=lambda p: p.load_g)
    ruled = [p for p in points if limits.weight_governs(p)]
    beside: dict[str, tuple[float, SpeedPoint | None]] = {}
    for name, share in (("hold", limits.weight_over_hold), ("drive", limits.weight_share)):
        every = [(share(results, p), p) for p in loaded if p not in ruled]
        most, point = max(every, key=lambda pair: pair[0], default=(0.0, None))
        beside |= {name: (most, point)} if most > 1 / _LIGHT else {}
    return {"points": points, "ruled": ruled, "beside": beside} if points or beside else None


EXPLAINED = 1e-9
"""Share of the initial energy that the books may leave unexplained without a word."""


@remark
def books(results: Results) -> Values:
    """Energy that appears or vanishes without a cause."""
    shares = [d.energy.residual / d.energy.initial for _, _, d in ring_downs(results) if d.energy.initial > 0]
    worst = max(shares, key=abs, default=0.0)
    return {"share": worst, "printed": results.scene.is_printed} if abs(worst) > EXPLAINED else None


@remark
def leaning_load(results: Results) -> Values:
    """A load that does not point along the plate at the cavity, whose floor is taken to face it; or a floor that leans.

    Such a floor does not face the load: the remark is on where a ball at rest is.
    """
    scene, points = results.scene, [p for p, _, _ in ring_downs(results)]
    if scene.damper is None or not points:
        return None
    if scene.damper.normal is not None:
        point = max(points, key=lambda p: math.hypot(*p.lean) / p.pressing)
        slope = math.hypot(*point.lean) / point.pressing
    elif scene.damper.on_plate is not None and scene.plate is not None:
        point = max(points, key=lambda p: p.load_g)
        aside = abs(scene.damper.on_plate[1] * math.cos(scene.rotor.stagger))
        slope = aside / math.sqrt(point.radius**2 - aside**2)
    else:
        return None
    rolls, simulated = limits.lever(scene, point) / scene.damper.radius, scene.damper.normal is not None
    if not simulated and (point.load_g == 0 or slope <= 0.1 * rolls):
        return None
    angle = math.degrees(math.atan(slope))
    return {"point": point, "angle": angle, "rolls_off": slope > rolls, "simulated": simulated}


@remark
def other_mode(results: Results) -> Values:
    """A cavity whose axis 1 is moved most by another than the first mode: which, from the first speed of each on."""
    every = sorted(results.speeds if results.scene.in_space else (), key=lambda p: p.omega)
    points = [p for p in every if p.reduced is not None and p.modes]
    runs = [(number, next(run)) for number, run in groupby(points, key=lambda point: point.followed)]
    return {"runs": runs} if any(number != 0 for number, _ in runs) else None


@remark
def level_floor(results: Results) -> Values:
    """A scene that keeps the floor level, and what its tilt does to the cut-off, simulated."""
    pairs = [
        (ratio, d.cutoff_ratio)
        for p, _, d in ring_downs(results)
        if p.damping_curve and (ratio := p.damping_curve.tilted_cutoff_ratio) is not None and p.load_g > 0
        if p.verdict is None or p.verdict.reason != Reason.LOSSLESS  # which moves, and has no cut-off
    ]
    tilted = [ratio for ratio, _ in pairs if not math.isnan(ratio)]
    level = [ratio for _, ratio in pairs if ratio is not None]
    of = {"count": len(pairs), "never": len(pairs) - len(tilted), "printed": results.scene.is_printed}
    return {"tilted": tilted, "level": level, **of} if pairs else None


@remark
def level_structure(results: Results) -> Values:
    """What a scene without a plate does not tell."""
    structure = results.scene.given
    loaded = any(p.load_g > 0 for p, _, _ in ring_downs(results))
    return {} if structure is not None and structure.level and loaded else None


@remark
def dents(results: Results) -> Values:
    """What the resting ball does to its floor where that yields, or the floor to the ball."""
    made_of = limits.solids(results.scene)
    every = _contacts(results, results.speeds)
    pressed = [(point, c) for point, c in every if c.dent_radius > 0 and not c.hardness_ratio >= 1]
    if not pressed:
        return None
    point, most = max(pressed, key=lambda pair: pair[1].yield_ratio)
    ball, floor = results.scene.contact_materials
    flattened = made_of is not None and made_of[0].yield_strength < made_of[1].yield_strength
    of = {"ball": ball, "floor": floor, "point": point, "most": most, "flattened": flattened}
    return of | {"slope": limits.rim_slope(results.scene, point)}


_BRIEF = 0.1
"""Share of a flight between hits that a hit, or the sliding after it, may last without a word."""


@remark
def long_hits(results: Results) -> Values:
    """That hits, which the model takes as instantaneous, last long beside the flights between them."""
    most = _most_of_hits(results, lambda hit: hit.duration / hit.flight)
    return most if most is not None and most["share"] > _BRIEF else None


def _most_of_hits(results: Results, share: Callable[[HitFigures], float]) -> Values:
    """The hits of which a share is largest, the share, and their speed; None without any."""
    every = [(share(point.hits), point) for point in results.speeds if point.hits is not None]
    most, at = max(every, key=lambda pair: pair[0], default=(0.0, None))
    return None if at is None else {"share": most, "hit": at.hits, "point": at}


_LOWERED = 0.03
"""By how much balls at rest lower the frequency, relatively, that is worth a word."""


@remark
def lowered(results: Results) -> Values:
    """That balls at rest lower the frequency that tables and diagram have without them."""
    every = [(1 - p.reduced.f1_hz / p.reduced.f2_hz, p) for p in results.speeds if p.reduced is not None]
    share, point = max(every, key=lambda each: each[0], default=(0.0, None))
    return None if point is None or share <= _LOWERED or results.scene.given else {"share": share, "point": point}


@remark
def slides_after_hits(results: Results) -> Values:
    """That a ball slides after a hit for longer than a part of its flight, which the figures leave out."""
    if results.effects["ball_slip"].on or results.scene.is_printed:
        return None
    most = _most_of_hits(results, lambda hit: (hit.sliding or 0.0) / hit.flight)
    return most if most is not None and most["share"] > _BRIEF else None


_LITTLE = 0.1
"""What hits may scatter into modes that are not simulated, over what restitution takes, without a word."""

_GROWS_BY = 0.6
"""Most that the damping of growing vibration gains, relatively, over what is scattered beside what restitution takes.

Of 32 random dampers with a second mode to a seventh more, where it is 5 % or more; falling vibration mostly loses, up
to 3.4 times that (`tests/benchmarks/modes_needed.py`).
"""


@remark
def scattering(results: Results) -> Values:
    """That hits scatter energy into modes of the structure that are not simulated."""
    scene, switched = results.scene, results.effects["structural_modes"].on
    most = _most_of_hits(results, scattered)
    if most is None or not most["share"] > _LITTLE or scene.is_printed:
        return None
    simulated = coupling.damper_modes(scene, most["point"]) if switched else ()
    return most | {"more": _GROWS_BY * most["share"], "simulated": len(simulated), "most": MODES}


def scattered(hit: HitFigures) -> float:
    """What a hit scatters into modes that are not simulated, over what restitution takes; 0 where it is not known."""
    if hit.scattered is None or not hit.scattered > 0:
        return 0.0
    return hit.scattered / hit.dissipated if hit.dissipated > 0 else math.inf


@remark
def still_across(results: Results) -> Values:
    """No mode that was looked for moves the cavity across."""
    rung = [p for p, _, _ in ring_downs(results) if p.cavity_modes]
    if not rung or any(leading_mode(p.cavity_modes, 1) is not None for p in rung):
        return None
    return {"modes": len(rung[0].cavity_modes), "known": results.scene.known is not None}


@remark
def root_stress(results: Results) -> Values:
    """The centrifugal pull at the root, where the answer does not speak of it."""
    scene, fastest = results.scene, max(results.scene.rotor.speeds)
    stress = limits.root_stress(results, fastest)
    if stress is None or not 1e7 <= stress <= limits.STRONGEST:
        return None
    return {"omega": fastest, "stress": stress, "strength": _yield_strength(scene)}


def _yield_strength(scene: Scene) -> float | None:
    """Of the structure's material [Pa]; None where it is not known."""
    name = None if scene.material is None else scene.material.name
    return None if name is None else KNOWN[name].yield_strength


@remark
def unknown_strain(results: Results) -> Values:
    """That amplitudes of known modes have no limit, as their strain is not known."""
    scene = results.scene
    judged = scene.known is None or scene.damper is None or limits.largest_strain(results) is not None
    return None if judged else {}


_ROUNDED_TURN = 1e-6
"""Rotation of a tip [rad] that is rounding: files give displacements in six digits, which are smaller than a chord."""


@remark
def deflection(results: Results) -> Values:
    """How far the load bends and untwists a solid blade, where it does the most."""
    point = max(results.speeds, key=lambda p: p.static_displacement or 0.0)
    if not point.static_displacement:
        return None
    turned = abs(point.tip_rotation or 0.0)
    shown = math.degrees(turned) if turned > _ROUNDED_TURN else None
    return {"omega": point.omega, "displacement": point.static_displacement, "turned": shown}


@remark
def rolling(results: Results) -> Values:
    """Ring-downs in which rolling requires more friction than the walls have."""
    damper = results.scene.damper
    rolled = [(p, d, d.largest_rolling_demand) for p, _, d in ring_downs(results) if d.largest_rolling_demand]
    beyond = [] if damper is None else [each for each in rolled if each[2] > damper.friction]
    if damper is None or not beyond:
        return None
    point, _, most = max(beyond, key=lambda each: each[2])
    lifts = [1e3 * math.hypot(*d.release) for _, d, _ in beyond]
    points, among = ([p for p, _, _ in each] for each in (beyond, rolled))
    return {"lifts": lifts, "most": most, "at": point, "points": points, "among": among}


@remark
def held(results: Results) -> Values:
    """Ring-downs in which the release is too small to set the ball rolling."""
    rung = [(p, d, p.level or p.damping_curve) for p, _, d in ring_downs(results) if p.load_g > 0 and d.events == 0]
    peaks = [(p, d, own.cutoff) for p, d, own in rung if own is not None and own.peak > 0]
    if not peaks:
        return None
    point, damping, cutoff = min(peaks, key=lambda entry: entry[0].load_g)
    return {"point": point, "lift": math.hypot(*damping.release), "needed": cutoff}


@remark
def negligible_strain(results: Results) -> Values:
    """Amplitudes above the cut-off that are left out, since they hardly strain the structure."""
    least = [
        limits.least_amplitude(p)
        for p in results.speeds
        if (own := p.damping_curve) is not None and own.peak > 0 and own.cutoff < limits.least_amplitude(p)
    ]
    return {"least": max(least)} if least else None


@remark
def faint_capacity(results: Results) -> Values:
    """Largest capacities of ring-downs that are those of a vibration which hardly strains the structure."""
    return _taken_below(results, [(p, d, limits.least_amplitude(p)) for p, _, d in ring_downs(results)])


@remark
def bouncing_capacity(results: Results) -> Values:
    """The same at amplitudes at which the load holds a ball at rest."""
    held = []
    for p, _, d in ring_downs(results):
        own, least = p.level or p.damping_curve, limits.least_amplitude(p)
        bounces = own is not None and own.cutoff < math.inf and p.load_g > 0 and d.impacts > 0
        if own is not None and bounces and (d.peak_sdc_at_g or 0.0) >= limits.in_g(results, p, least):
            held.append((p, d, own.cutoff))
    return _taken_below(results, held)


_WORTH_A_WORD = 1e-3
"""Share of the energy that a ball takes in a cycle from which on a remark is on it."""


def _taken_below(results: Results, each: list[tuple[SpeedPoint, Damping, float]]) -> Values:
    """The most that balls take in a cycle, where that is at less than an amplitude [m]."""
    taken = [
        (p, d, needed)
        for p, d, amplitude in each
        if d.peak_sdc_at_g is not None
        and lost_at_most(d) == d.peak_sdc
        and _share(d) >= _WORTH_A_WORD
        and d.peak_sdc_at_g < (needed := limits.in_g(results, p, amplitude))
    ]
    if not taken:
        return None
    point, most, needed = max(taken, key=lambda each: _share(each[1]))
    points, among = [p for p, _, _ in taken], [p for p, _, _ in ring_downs(results)]
    return {"points": points, "among": among, "share": most.peak_sdc, "most": most, "at": point, "needed": needed}


@remark
def nothing_released(results: Results) -> Values:
    """A release by a ratio of a load that is not there."""
    release = results.scene.release
    still = [p for p, _, _ in ring_downs(results) if p.load_g == 0]
    return {"point": still[0]} if still and release is not None and release.ratio is not None else None


@remark
def release_stress(results: Results) -> Values:
    """What stress the release causes."""
    scene, material, rung = results.scene, results.scene.material, ring_downs(results)
    if material is None or not rung:
        return None
    point, _, damping = max(rung, key=lambda each: (abs(each[2].release[0]), templates.at_load(each[0])))
    lift = abs(damping.release[0])
    stress = material.youngs_modulus * (limits.largest_strain(results, point.omega) or 0.0) * lift
    known = {"lift": lift, "point": point, "stress": stress, "strength": _yield_strength(scene)}
    return known if stress >= 1e8 else None


_LINEAR = 0.3
"""Way over the radius of its path up to which a pendulum's frequency is off by 1 %: 1 - (s/rho)²/16 and the load's."""


@remark
def pendulum(results: Results) -> Values:
    """What a hollow floor makes of the ball, and where it is no longer linear."""
    damper = results.scene.damper
    loaded = (p.damping_curve for p, _, _ in ring_downs(results) if p.load_g > 0)
    pendulum = next((figures.pendulum for figures in loaded if figures is not None and figures.pendulum), None)
    if damper is None or damper.floor_radius is None or pendulum is None:
        return None
    sides = zip(damper.cavity, damper.floor_radius, strict=True)
    reach = max((side / 2 - damper.radius) / (radius - damper.radius) for side, radius in sides)
    return {"orders": pendulum.order, "reach": reach, "linear": _LINEAR}


@remark
def turning_floor(results: Results) -> Values:
    """The floor's turning, which is left out: (1/5) m (s' - r kappa u')² of the spin makes 2/5 r kappa of the drive."""
    damper, target = results.scene.damper, results.scene.accuracy.damping
    if damper is None or not results.effects["floor_tilt"].on:
        return None
    tilts = [abs(reduced.floor_tilt) for p, reduced, _ in ring_downs(results) if p.load_g > 0]
    share = 0.4 * damper.radius * max(tilts, default=0.0)
    return {"share": share} if share > target else None


@remark
def neglected_forces(results: Results) -> Values:
    """Forces on the ball that its motion leaves out: by chordwise motion, and by the shortening of the bent blade.

    A cavity that moves by v in the plane of rotation across the radius changes the load by 2 Omega v; one that comes
    nearer to the axis by c u u' pushes the ball sideways by 2 Omega times that, beside its rolling resistance, and
    changes the load by c (u'² + u u'').
    """
    scene = results.scene
    if scene.damper is None or scene.given is not None or results.scene.is_printed:
        return None
    chord, along, load = (0.0, ""), (0.0, ""), (0.0, "")
    for point in results.speeds:
        best = limits.best(results, point)
        if best is None or point.reduced is None or point.load_g == 0:
            continue
        speed, at = 2 * math.pi * point.reduced.f1_hz * best.amplitude, templates.at_load(point)
        tip = point.omega * point.radius
        chord = max(chord, (2 * speed * abs(math.sin(point.stagger or 0.0)) / tip, at))
        rolls = limits.lever(scene, point) / scene.damper.radius
        nearer = abs(coupling.shortening(point)) * speed
        along = max(along, (nearer * best.amplitude / tip / rolls if rolls > 0 else 0.0, at))
        load = max(load, (nearer * speed / (point.omega * tip), at))
    shares = {"chord": chord, "load": load, "along": along}
    notable = {name: each for name, each in shares.items() if each[0] > scene.accuracy.damping}
    return {"notable": notable} if notable else None


@remark
def modes_left_out(results: Results) -> Values:
    """Modes that hits feed but for which there is no room, or that were not looked for."""
    target = results.scene.accuracy.damping
    left_out = (
        (reduced.M1 - reduced.M2) * math.hypot(*mode.shape) ** 2
        for point, reduced, damping in ring_downs(results)
        for mode in point.cavity_modes
        if all(mode.number != each.mode for each in damping.modal_energies)
    )
    worst = max(left_out, default=0.0)
    notable = worst > target and results.effects["structural_modes"].on
    return {"worst": worst, "target": target, "attainable": _attainable(worst)} if notable else None


@remark
def lent(results: Results) -> Values:
    """A cycle of a ring-down that takes more than a steady vibration loses, since the ball may give some of it back."""
    rung = [] if results.scene.is_printed else ring_downs(results)
    borrowed = [(_share(d), p) for p, _, d in rung if lost_at_most(d) != d.peak_sdc and d.impacts]
    share, point = max(borrowed, key=lambda pair: pair[0], default=(0.0, None))
    return {"share": share, "point": point} if borrowed else None


@remark
def rows(results: Results) -> Values:
    """Cavities that do not lie side by side: the innermost ones feel less load and less motion."""
    plate, damper = results.scene.plate, results.scene.damper
    if plate is None or plate.width is None or damper is None or damper.housing:
        return None
    place = damper.on_plate or (plate.length or 0.0, 0.0)
    most = cavities_abreast(damper, plate.thickness_at(place), plate.width)
    rows = math.ceil(damper.count / most)
    return {"most": most, "count": damper.count, "rows": rows, "depth": 2 * damper.radius * rows} if rows > 1 else None


@remark
def at_rest(results: Results) -> Values:
    """Where nothing turns there is no load: what works by it does nothing, and the answer leaves that speed out."""
    damper, loads = results.scene.damper, [p.load_g for p, _, _ in ring_downs(results)]
    if damper is None or 0.0 not in loads:
        return None
    return {"idle": [key for key in ("rolling_friction", "floor_radius") if getattr(damper, key)], "turns": any(loads)}


@remark
def real_modes(results: Results) -> Values:
    """What Coriolis forces do to the mode that the damper feels, where that is more than the accuracy asked for."""
    moved = [
        point.modes[followed].frequency_hz / point.reduced.f2_hz - 1
        for point in (results.speeds if results.effects["coriolis"].on else ())
        if point.reduced is not None and (followed := point.followed) is not None
    ]
    most = max(moved, key=abs, default=0.0)
    return {"most": most} if abs(most) > results.scene.accuracy.frequency else None


@remark
def veering(results: Results) -> Values:
    """Where modes could not be followed for certain."""
    veerings = () if results.diagram is None else results.diagram.veerings
    return {"veerings": veerings} if veerings else None


@remark
def frequency_error(results: Results) -> Values:
    """How far the frequencies can be trusted, and by what they are off."""
    if results.diagram is None or results.theory is None:
        return None
    plate, own = results.scene.plate, THEORIES[results.theory.name].against_solid
    slanted = results.theory.name == "solid" and plate is not None and plate.mesh is not None
    of = {"accuracy": sentence(results), "mesh": results.diagram.mesh, "own": own, "slanted": slanted}
    return of | {"laden": results.scene.point_mass > 0}
