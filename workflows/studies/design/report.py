"""A design as files: `design.json`, the winning scene as `best.toml`, and one page."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from damper import DampingCurve, ParticleDamper
from fem.rotor import in_rpm
from workflows import formatting
from workflows.formatting import significant, whole
from workflows.io.files import as_json, finite, write_study
from workflows.report import plots, remarks
from workflows.report.page import from_template
from workflows.scene.load import SceneFile
from workflows.solve.limits import AIR
from workflows.solve.results import Floats
from workflows.studies import response_report
from workflows.studies.design import objectives
from workflows.studies.design import space as spaces
from workflows.studies.design.objectives import LeastAmplitude, LeastDamping
from workflows.studies.design.space import NAMES, Optimum, Scored, Space
from workflows.studies.response import Response, rows
from workflows.studies.sweep import evaluate
from workflows.studies.sweep import plan as plans
from workflows.studies.sweep.evaluate import PlateCache, measured
from workflows.studies.sweep.plan import Spread
from workflows.studies.sweep.report import SHADES, Picture, colour_key, contour_levels, hatch, map_spread, mark, scale


@dataclass(frozen=True, eq=False)
class Curve:
    """The damper at a speed [rev/min], and its figures."""

    rpm: float
    damper: ParticleDamper
    damping_curve: DampingCurve


def of(space: Space, optimum: Optimum, goal: LeastDamping) -> list[Curve]:
    """A curve for each speed at which the best ball takes anything, up to the highest amplitude of the goal."""
    plan = space.plan(np.asarray(optimum.shares)[None])
    size = plans.size(plan)
    cases = evaluate.all_placed(space.source, plan, 0, PlateCache(), evaluate.empty(size), [])
    curves = []
    for each in cases:
        damper = each.judged
        figures = measured(damper, {}, reach=goal.high)
        if figures.amplitude.size:
            curves.append(Curve(each.point.rpm, damper, figures))
    return curves


_HELD = 0.02
"""Share of a range from its end, and of a limit, from which on it counts as what holds the design."""

_FURTHER = 0.05
"""By which a range is taken further, to see what that would give."""


Score: TypeAlias = "Callable[[Space, Floats, bool], list[Scored]]"
"""Scores rows of shares in a space, quickly or with the figures at their full accuracy."""


@dataclass(frozen=True)
class Holds:
    """What keeps the best design from being better.

    Attributes:
        name: what [design] calls it.
        said: in words.
        gain: of the value by taking it 5 % further, relative; None where that is not known.
    """

    name: str
    said: str
    gain: float | None = None


def holds(space: Space, optimum: Optimum, score: Score) -> tuple[Holds, ...]:
    """The ends of ranges, and the limits, at which the best design lies."""
    constraints = [
        Holds(name, f"{100 * share:.0f} % of the {name} allowed is used")
        for name, share in optimum.scored.used
        if share > 1 - _HELD
    ]
    values = space.values(optimum.shares)
    for k in space.continuous:
        share, axis = optimum.shares[k], space.axes[k]
        if _HELD < share < 1 - _HELD or axis.spread is None:
            continue
        end = "least" if share < 0.5 else "greatest"
        at_end = f"{spaces.in_words(axis.name, values[axis.name])} is the {end} allowed"
        constraints.append(Holds(spaces.NAMES[axis.name], at_end, _gain(space, optimum, score, k, upwards=share > 0.5)))
    return tuple(constraints)


def _gain(space: Space, optimum: Optimum, score: Score, k: int, *, upwards: bool) -> float | None:
    """What the best design would gain by going on beyond the end of a range."""
    spread = space.axes[k].spread
    if spread is None or not optimum.scored.works:
        return None
    low, high = (spread.low, spread.high * (1 + _FURTHER)) if upwards else (spread.low / (1 + _FURTHER), spread.high)
    wider = replace(space.axes[k], spread=Spread(low, high, spread.law))
    axes = (*space.axes[:k], wider, *space.axes[k + 1 :])
    shares = optimum.shares.copy()
    shares[k] = 1.0 if upwards else 0.0
    (further,) = score(replace(space, axes=axes), shares[None], False)
    return further.value / optimum.scored.value - 1 if further.works else None


@plots.style()
def draw(designed: Designed) -> list[Picture]:
    """All pictures there are."""
    pictures, goal = [], designed.space.goal
    if isinstance(goal, LeastDamping):
        curves = of(designed.space, designed.optimum, goal)
        if curves:
            pictures.append(Picture(_curves(goal, curves), _OF_CURVES))
    if designed.response is not None:
        for number, through in enumerate(designed.response.passed):
            shades = map_spread(len(through.forces) + 1)[:-1]
            drawn = response_report.response(designed.response, through, str(number), shades)
            pictures.append(Picture(drawn, f"{response_report.place(through.crossing)}. {_OF_A_RESPONSE}"))
    if designed.grid is not None and np.isfinite(designed.grid.values).any():
        caption = _OF_DAMPING if isinstance(goal, LeastDamping) else _OF_AMPLITUDES
        pictures.append(Picture(_map(designed, designed.grid), f"{caption} {_OF_THE_MAP}"))
    return pictures


_OF_CURVES = (
    "Damping ratio by the ball of the best damper over the amplitude at the cavity, at each speed. Dashed: the range"
    " that counts. Dotted: the bound for any ball of its mass and clearance."
    f" Grey: air alone on turbine blades, {100 * AIR[0]:.2f} to {100 * AIR[1]:.2f} %."
)
_OF_A_RESPONSE = (
    "Amplitude over speed with the best damper, from the least cycle to the greatest. Dashed: without a ball."
)
_OF_DAMPING = "The least damping ratio over the range,"
_OF_AMPLITUDES = "The greatest amplitude at the crossings,"
_OF_THE_MAP = (
    "with two of the free lengths varied and all else as in the best design (cross). White: no such damper helps,"
    " mostly because the load holds the ball at rest. Hatched: a limit is exceeded."
)


def _curves(goal: LeastDamping, curves: list[Curve]) -> str:
    figure, (axes,) = plots.canvas(3.1)
    colours = map_spread(len(curves) + 1)
    for curve, colour in zip(curves, colours, strict=False):
        shown = curve.damping_curve.damping_ratio > 0
        at, ratio = curve.damping_curve.amplitude[shown], curve.damping_curve.damping_ratio[shown]
        axes.plot(1e3 * at, 100 * ratio, color=colour, label=f"{whole(curve.rpm)} rpm")
        grid = np.geomspace(goal.low, goal.high, 30)
        bound = [objectives.bound_of(curve.damper, float(amplitude)) for amplitude in grid]
        axes.plot(1e3 * grid, [100 * b if math.isfinite(b) else math.nan for b in bound], ":", color=colour, lw=1.0)
    axes.axhspan(100 * AIR[0], 100 * AIR[1], color=plots.RULE, lw=0)
    for end in (goal.low, goal.high):
        axes.axvline(1e3 * end, color=plots.INK, lw=0.8, ls=plots.DASHED)
    axes.set(xscale="log", yscale="log", xlabel="amplitude at the cavity, mm", ylabel="damping ratio by the ball, %")
    top = max(100 * curve.damping_curve.peak for curve in curves)
    axes.set_ylim(1e-3 * top, 4 * max(top, 100 * AIR[1]))
    plots.legend(figure, axes, title="speed")
    return plots.svg(figure, "best", "Damping ratio of the best damper over amplitude")


def _map(designed: Designed, grid: Grid) -> str:
    of_damping = isinstance(designed.space.goal, LeastDamping)
    factor, name = (100.0, "least damping ratio, %") if of_damping else (1e3, "greatest amplitude, mm")
    figure, (axes,) = plots.canvas(3.4)
    xs, ys = _shown(grid.x, grid.xs), _shown(grid.y, grid.ys)
    values = factor * grid.values
    levels = contour_levels([values]) if of_damping else contour_levels([values], least=0.0)
    colours = map_spread(len(levels) - 1)
    axes.contourf(
        xs, ys, np.clip(values, levels[0], levels[-1]), levels, colors=colours if of_damping else colours[::-1]
    )
    if grid.beyond.any():
        hatch(axes, xs, ys, grid.beyond)
    best = designed.space.values(designed.optimum.shares)
    at = _shown(grid.x, best[grid.x]), _shown(grid.y, best[grid.y])
    mark(axes, *at)
    scales: dict[str, Any] = {"xscale": scale(grid.xs), "yscale": scale(grid.ys)}
    axes.set(xlabel=_label(grid.x), ylabel=_label(grid.y), **scales)
    axes.grid(visible=False)
    idle = "beyond a limit" if grid.beyond.any() else ""
    colour_key(figure, levels, colours if of_damping else colours[::-1], name, idle=idle)
    return plots.svg(figure, "around", f"The {name.partition(',')[0]} around the best design")


def _shown(name: str, value: Any) -> Any:
    """In mm; of a ball its diameter."""
    return 1e3 * np.asarray(value, dtype=float) * (2 if name == "damper.radius" else 1)


def _label(name: str) -> str:
    return f"{NAMES[name].replace('_', ' ')}, mm"


def best(space: Space, winner: Optimum) -> str:
    """The best design, key by key."""
    return ", ".join(spaces.in_words(name, value) for name, value in space.values(winner.shares).items())


def _speed(omega: float) -> str:
    """A speed in revolutions."""
    return f"{whole(float(np.round(in_rpm(omega), 9)))} rpm"


def amplitude_verdict(optimum: Optimum) -> str:
    """The answer in a line."""
    scored = optimum.scored
    if not scored.works:
        return "No design in this space reduces the vibration at the crossings"
    cut = significant(100 * (1 - scored.value / scored.without), 2)
    more = f", and more than the structure endures ({_mm(scored.endured)} mm)" * (scored.value > scored.endured)
    return (
        f"The greatest amplitude at the crossings is {_mm(scored.value)} mm, {cut} % less than without a damper{more}"
    )


def amplitude_sentences(optimum: Optimum, goal: LeastAmplitude) -> list[str]:
    """What carries it."""
    scored, level = optimum.scored, _level(goal)
    lines = [
        f"Under {level} it is largest at order {scored.order} and {_speed(scored.speed)}: {_mm(scored.value)} mm;"
        f" without a ball, the largest at any crossing is {_mm(scored.without)} mm."
    ]
    if scored.bound > 0:
        part = significant(100 * (scored.without - scored.value) / (scored.without - scored.bound), 2)
        lines.append(
            f"No ball of this mass and clearance can bring it below {_mm(scored.bound)} mm, since its travel is too"
            f" short to balance more of the force. The design achieves {part} % of the possible reduction."
        )
    else:
        lines.append(
            "Mass and clearance set no bound: a ball that crosses its cavity in phase could balance the whole force."
        )
    return lines


def no_amplitude_because(space: Space, optimum: Optimum, goal: LeastAmplitude) -> list[str]:
    """Why nothing helps, from the design that comes nearest."""
    scored, damper = optimum.scored, space.source.scene.damper
    place = f"At order {scored.order} and {_speed(scored.speed)}, under {_level(goal)},"
    if scored.grows < 1:
        able = significant(100 * (1 - scored.bound / scored.without), 2)
        left = significant(100 * scored.value / scored.without, 4)
        lines = [
            f"{place} the ball of the best design moves, but {left} % of the amplitude remains, {_mm(scored.without)}"
            f" mm. No ball of its mass and clearance can remove more than {able} %: a larger mass or clearance is"
            " needed."
        ]
        return [*lines, f"The best of {optimum.evaluations} designs evaluated has {best(space, optimum)}."]
    if not math.isfinite(scored.grows):
        return [f"{place} the tilt of the floor cancels the drive of every ball."]
    lines = [
        f"{place} the structure vibrates by {_mm(scored.without)} mm, and the load holds every ball at rest up to"
        f" {significant(scored.grows, 3)} times as much or more."
    ]
    if damper is not None and isinstance(damper.rolling_friction, float) and damper.rolling_friction > 0:
        lines.append(_to_roll(damper.rolling_friction, 1 / scored.grows, "that much more force"))
    return [*lines, f"The first ball to move, of {optimum.evaluations} designs evaluated, has {best(space, optimum)}."]


def _to_roll(friction: float, share: float, instead: str) -> str:
    """What would set the ball rolling: so much of its rolling friction, or something else instead."""
    return (
        "A ball begins to roll where its inertia exceeds rolling friction over radius times the load. This requires"
        f" a rolling friction of {_mm(friction * share)} mm instead of {_mm(friction)} mm, or {instead}."
    )


def _level(goal: LeastAmplitude) -> str:
    return f"{significant(max(goal.excitation.levels))} {goal.excitation.unit}"


def _mm(length: float) -> str:
    return significant(1e3 * length)


def damping_verdict(optimum: Optimum, goal: LeastDamping) -> str:
    """The answer in a line."""
    scored = optimum.scored
    if not scored.works:
        return "No design in this space damps over the whole range of amplitudes"
    grade = "as much as the air" if scored.value >= AIR[0] else "less than the air"
    limit = f", where the structure endures it: up to {significant(1e3 * scored.endured)} mm" * (
        goal.high > scored.endured
    )
    return (
        f"The best design adds an equivalent damping ratio of at least {_percent(scored.value)} %, {grade} gives a"
        f" blade{limit}"
    )


def damping_sentences(space: Space, optimum: Optimum, goal: LeastDamping) -> list[str]:
    """What carries it."""
    scored = optimum.scored
    low, high = 1e3 * goal.low, 1e3 * goal.high
    lines = [
        f"From {significant(low)} to {significant(high)} mm, its damping ratio is least at {_speed(scored.speed)}"
        f" and {significant(1e3 * scored.amplitude)} mm: {_percent(scored.value)} %. Below"
        f" {significant(1e3 * scored.cutoff)} mm the load holds its ball at rest.",
    ]
    if scored.falling > (1 + space.source.scene.accuracy.damping) * scored.value:
        lines.append(
            "This holds as the vibration grows slowly from a ball at rest. As the vibration decays, the ball keeps"
            f" bouncing and adds at least {_percent(scored.falling)} %."
        )
    if math.isfinite(scored.bound):
        lines.append(
            f"No ball of this mass and clearance can add more than {_percent(scored.bound)} % over the whole range;"
            f" this design reaches {100 * scored.value / scored.bound:.0f} % of that."
        )
    lines += _carried(scored)
    if space.source.scene.excitation is not None:
        lines.append(
            "Designs were compared by their least damping over [design] amplitude; without that key, they are compared"
            " by the amplitude at the crossings of [excitation]."
        )
    return lines


def _carried(scored: Scored) -> list[str]:
    """That ball and floor carry the load, where their materials are known."""
    used = dict(scored.used)
    if "hardness" not in used:
        return [
            "The contact of ball and floor is not checked: this requires ball_material and [damper] floor_material."
        ]
    yields = used.get("first yield")
    of_yield = "" if yields is None else f", the load {_percent(yields)} % of the load allowed by yield_ratio"
    return [
        f"Ball and floor carry the load at all speeds: the mean contact pressure is {_percent(used['hardness'])} % of"
        f" the pressure allowed{of_yield}."
    ]


def no_damping_because(space: Space, optimum: Optimum, goal: LeastDamping) -> list[str]:
    """Why nothing works, from the design that comes nearest."""
    scored, damper = optimum.scored, space.source.scene.damper
    if not math.isfinite(scored.cutoff):
        return [f"At {_speed(scored.speed)} the tilt of the floor cancels the drive of every ball."]
    lines = [
        f"At {_speed(scored.speed)} the load holds every ball at rest below {significant(1e3 * scored.cutoff)} mm or"
        f" more, but damping is required from {significant(1e3 * goal.low)} mm on.",
    ]
    rolling_friction = None if damper is None else damper.rolling_friction
    if isinstance(rolling_friction, float) and rolling_friction > 0 and scored.cutoff > goal.low:
        share = goal.low / scored.cutoff
        lines.append(_to_roll(rolling_friction, share, "a least amplitude above the cut-off"))
    return [*lines, f"The lowest cut-off of {optimum.evaluations} designs evaluated has {best(space, optimum)}."]


def _percent(ratio: float) -> str:
    return significant(100 * ratio)


def verdict(space: Space, optimum: Optimum) -> str:
    """The answer in a line."""
    goal = space.goal
    return damping_verdict(optimum, goal) if isinstance(goal, LeastDamping) else amplitude_verdict(optimum)


def sentences(designed: Designed) -> list[str]:
    """What carries it, and what holds it; or why nothing works."""
    space, optimum, scored, goal = designed.space, designed.optimum, designed.optimum.scored, designed.space.goal
    if not scored.works:
        return _why_none(space, optimum)
    lines = [
        f"Best of {optimum.evaluations} designs evaluated: {best(space, optimum)}; its balls weigh"
        f" {significant(1e3 * scored.mass)} g."
    ]
    if isinstance(goal, LeastDamping):
        lines += damping_sentences(space, optimum, goal)
    elif isinstance(goal, LeastAmplitude):
        lines += amplitude_sentences(optimum, goal)
    what = "damping" if isinstance(goal, LeastDamping) else "amplitude"
    for each in designed.holds:
        gain = "" if each.gain is None else f"; 5 % further would change the {what} by {100 * each.gain:+.1f} %"
        lines.append(f"Limited by: {each.said}{gain}.")
    if not designed.holds:
        lines.append("No limit is active: the best design lies inside all ranges.")
    return lines


def obstacle(scored: Scored) -> str:
    """Why a design is worth nothing, in words; empty where it is worth something."""
    why = scored.why
    if why is None:
        return ""
    at = f"at {whole(why.rpm)} rpm" if math.isfinite(why.rpm) else ""
    endured = remarks.beyond(by_deflection=why.kind == "deflection")
    return {
        "held": "the load holds the ball at rest",
        "lossless": "the ball dissipates nothing",
        "useless": "the ball does not help",
        "undriven": "nothing drives the damper's place at the crossings",
        "limit": f"beyond the limit of {why.text}",
        "weight": f"{at} {remarks.WEIGHT}",
        "root_stress": remarks.torn_at(why.rpm, why.value) if why.kind == "root_stress" else "",
        "strain": f"even the lowest amplitude of the range would {endured}",
        "deflection": f"even the lowest amplitude of the range would {endured}",
        "slip": f"{at} every ball would slide: rolling requires a friction coefficient of {significant(why.value, 2)}"
        " at the largest amplitude of the range",
    }.get(why.kind, why.text)


def _why_none(space: Space, optimum: Optimum) -> list[str]:
    goal = space.goal
    if optimum.scored.impossible:
        return [f"The closest design is not feasible: {obstacle(optimum.scored)}."]
    if isinstance(goal, LeastDamping):
        return no_damping_because(space, optimum, goal)
    return no_amplitude_because(space, optimum, goal) if isinstance(goal, LeastAmplitude) else []


@dataclass(frozen=True, eq=False)
class Designed:
    """What a search found.

    Attributes:
        space: what it searched.
        optimum: the best design; where none works, the one that comes nearest.
        holds: what keeps it from being better.
        scene: the scene with the best damper, without [design].
        toml: the same as a file that `run` and `response` take; empty where none works.
        grid: the map around the best: names of the axes, their values in SI, and what designs are worth there.
        response: of the best, where designs are compared by the amplitude at the crossings.
    """

    space: Space
    optimum: Optimum
    holds: tuple[Holds, ...]
    scene: SceneFile
    toml: str
    grid: Grid | None
    response: Response | None

    def document(self) -> dict[str, Any]:
        """The machine-readable result."""
        scored, design = self.optimum.scored, self.space.design
        values = self.space.values(self.optimum.shares)
        damper = self.scene.scene.damper
        best: dict[str, Any] = {name.partition(".")[2]: plans.said([value])[0] for name, value in values.items()}
        entries = {
            "schema_version": 1,
            "title": self.space.source.scene.title,
            "objective": self.space.goal.said,
            "constraints": design.model_dump(mode="json", exclude_none=True),
            "best": best | {"cavity": None if damper is None else list(damper.cavity)},
            "works": scored.works,
            "value": scored.value,
            "at": {"speed": finite(scored.speed), "amplitude": finite(scored.amplitude), "order": scored.order},
            "without": finite(scored.without),
            "bound": finite(scored.bound),
            "cutoff": finite(scored.cutoff),
            "ball_mass": finite(scored.mass),
            "holds": [vars(each) for each in self.holds],
            "evaluations": self.optimum.evaluations,
            "verdict": verdict(self.space, self.optimum),
            "why": sentences(self),
        }
        if self.response is not None:
            entries |= {"confirmed": self.confirmed, "crossings": response_report.entries(self.response)}
        return entries

    @property
    def confirmed(self) -> float | None:
        """The greatest mean amplitude at the crossings, followed as `response` does [m]; None without."""
        return None if self.response is None else max(row.mean for row in rows(self.response))


@dataclass(frozen=True, eq=False)
class Grid:
    """A map: names and values (SI) along x and y, and what the design there is worth, rows of y."""

    x: str
    xs: Floats
    y: str
    ys: Floats
    scored: tuple[tuple[Scored, ...], ...]

    @property
    def values(self) -> Floats:
        """Shape (y, x); nan where a design works nowhere or exceeds a limit."""
        return np.array([[each.value if each.works else np.nan for each in row] for row in self.scored])

    @property
    def beyond(self) -> npt.NDArray[np.bool_]:
        """Where a limit is exceeded, shape (y, x)."""
        return np.array([[each.impossible for each in row] for row in self.scored])


def write(designed: Designed, out: Path) -> None:
    """Write all of it into `out`, or nothing.

    Raises:
        BadInput: `out` cannot be written.
    """
    contents = {"design.json": dumps(designed) + "\n", "report.html": render(designed)}
    write_study(out, contents | ({"best.toml": designed.toml} if designed.toml else {}))


def dumps(designed: Designed) -> str:
    """The machine-readable result."""
    return as_json(designed.document())


def text(designed: Designed) -> str:
    """The answer in a few lines."""
    return "\n".join([f"{verdict(designed.space, designed.optimum)}.", *sentences(designed)])


def in_short(designed: Designed) -> str:
    """The answer and what it is due to, in one line."""
    return f"{verdict(designed.space, designed.optimum)}: {sentences(designed)[0]}"


def render(designed: Designed) -> str:
    """The page."""
    return from_template(
        "design.html.j2",
        plots.shades_css(SHADES),
        title=designed.space.source.scene.title,
        verdict=verdict(designed.space, designed.optimum),
        sentences=sentences(designed),
        figures=draw(designed),
        toml=designed.toml,
        evaluations=formatting.fixed(designed.optimum.evaluations),
    )
