"""A design as files: `design.json`, the winning scene as `best.toml`, and one page; sentences in `design.toml`."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from damper import DampingCurve, damping_curve
from workflows.formatting import significant, turning
from workflows.io.files import StudyResult, finite
from workflows.report import plots, templates
from workflows.scene.load import SceneFile
from workflows.scene.materials import KNOWN
from workflows.solve import excitation
from workflows.solve.limits import AIR
from workflows.solve.results import Floats
from workflows.studies import response_report
from workflows.studies.design import objectives
from workflows.studies.design.objectives import Evaluation, LeastDamping, Obstacle
from workflows.studies.design.space import NAMES, Deviation, Optimum, Space, formatted, has_thickness, in_mm
from workflows.studies.response import Response, rows
from workflows.studies.sweep.evaluate import DamperCase, damper_cases
from workflows.studies.sweep.plan import Axis, Spread, Value, as_plain
from workflows.studies.sweep.report import SHADES, Picture, colour_key, contour_levels, map_spread, mark, paint

_AT_END = 0.02
"""Share of a range from its end, and of a limit, from which on it counts as an active constraint."""

_FURTHER = 0.05
"""By which a range is extended to see what that would give."""

Score: TypeAlias = "Callable[[Space, Floats, bool], list[Evaluation]]"
"""Scores rows of shares in a space, quickly or with the figures at their full accuracy."""


@dataclass(frozen=True)
class ActiveConstraint:
    """What keeps the best design from being better.

    Attributes:
        name: what [design] calls it.
        said: in words.
        gain: of the value by taking it 5 % further, a count by one, relative; None where that is not known.
    """

    name: str
    said: str
    gain: float | None = None


def active_constraints(space: Space, optimum: Optimum, score: Score) -> tuple[ActiveConstraint, ...]:
    """The limits at which the best design lies, and the ends of ranges and lists beyond which it would be better.

    And of the range of amplitudes, the end at which damping is least.
    """
    constraints = [
        ActiveConstraint(name, f"{100 * share:.0f} % of the {name} allowed is used")
        for name, share in optimum.evaluation.used
        if share > 1 - _AT_END and _varies(space, optimum, score, name)
    ]
    for k in space.continuous:
        if not _AT_END < optimum.shares[k] < 1 - _AT_END:
            constraints += _range_end(space, optimum, score, k)
    for axis in space.axes:
        if not axis.is_continuous:
            constraints += _list_end(space, optimum, score, axis)
    constraints += _fit_constraint(space, optimum, score)
    return (*constraints, *_amplitude_constraint(space, optimum, score))


def _varies(space: Space, optimum: Optimum, score: Score, limit: str) -> bool:
    """Whether another value of anything free uses another share of a limit than the best design."""
    values, used = space.values(optimum.shares), dict(optimum.evaluation.used)[limit]
    for k, axis in enumerate(space.axes):
        near = optimum.shares[k] + (_FURTHER if optimum.shares[k] < 0.5 else -_FURTHER)
        others = axis.at(np.array([near])) if axis.is_continuous else axis.choices
        for other in others:
            if other != values[axis.name]:
                share = dict(_with_value(space, optimum, axis, other, score).used).get(limit, used)
                if not math.isclose(share, used, rel_tol=1e-9):
                    return True
    return False


def _with_value(
    space: Space, optimum: Optimum, axis: Axis, value: Value, score: Score, *, quick: bool = True
) -> Evaluation:
    """The best design with another value along one of its axes."""
    (other,) = _with_values(space, optimum, {axis.name: (value,)}, score, quick=quick)
    return other


def _with_values(
    space: Space, optimum: Optimum, others: dict[str, tuple[Value, ...]], score: Score, *, quick: bool = False
) -> list[Evaluation]:
    """The best design with other values of some of its keys, once for each of these values."""
    best, count = space.values(optimum.shares), max(map(len, others.values()))
    axes = tuple(replace(each, spread=None, values=others.get(each.name, (best[each.name],))) for each in space.axes)
    shares = np.repeat((np.arange(count)[:, None] + 0.5) / count, len(axes), axis=1)
    return score(replace(space, axes=axes), shares, quick)


def _is_better(optimum: Optimum, further: Evaluation) -> bool:
    """Whether a design is possible, and better than the best by more than that scatters."""
    return not further.impossible and further.score > np.fmax(optimum.evaluation.score, optimum.evaluation.greatest)


def _gain(optimum: Optimum, further: Evaluation) -> float | None:
    """Of the value by a design beyond, relative; None where that is not known."""
    if further.impossible or not optimum.evaluation.works:
        return None
    return further.value / optimum.evaluation.value - 1


def _list_end(space: Space, optimum: Optimum, score: Score, axis: Axis) -> list[ActiveConstraint]:
    """The end of a list, or of a range of whole numbers, beyond which the best design would be better.

    Beyond it lies the next whole number, or a length that is 5 % further.
    """
    numbers = [each for each in axis.choices if isinstance(each, int | float) and math.isfinite(each)]
    value = space.values(optimum.shares)[axis.name]
    if len(numbers) < 2 or not isinstance(value, int | float) or value not in (min(numbers), max(numbers)):
        return []
    least = value == min(numbers)
    beyond = value * (1 + _FURTHER) ** (-1 if least else 1)
    if axis.key.whole:
        beyond = int(value) + (-1 if least else 1)
    further = _with_value(space, optimum, axis, beyond, score, quick=False) if beyond > 0 else None
    if further is None or not _is_better(optimum, further):
        return []
    end = f"{'least' if least else 'greatest'} {'of the list' if axis.spread is None else 'allowed'}"
    return [ActiveConstraint(NAMES[axis.name], f"{formatted(axis.name, value)} is the {end}", _gain(optimum, further))]


def _fit_constraint(space: Space, optimum: Optimum, score: Score) -> list[ActiveConstraint]:
    """That the cavity has to lie within a solid blade, where that keeps the best design from being better."""
    better = list[tuple[float, ActiveConstraint]]()
    for axis in space.axes:
        if axis.name not in ("damper.radius", "damper.clearance"):
            continue
        length = float(space.values(optimum.shares)[axis.name])
        near = _with_value(space, optimum, axis, length * (1 + _AT_END), score)
        if near.why is None or near.why.kind != "sticks_out":
            continue
        free = replace(space, has_to_fit=False)
        further = _with_value(free, optimum, axis, length * (1 + _FURTHER), score, quick=False)
        gain = _gain(optimum, further)
        if gain is None or _is_better(optimum, further):
            said = f"the cavity has to lie within the blade, which limits the {NAMES[axis.name].replace('_', ' ')}"
            better.append((further.score, ActiveConstraint("fit", said, gain)))
    return [max(better, key=lambda each: each[0])[1]] if better else []


def worst_deviation(space: Space, optimum: Optimum, score: Score) -> Deviation | None:
    """What is left of the best design if one of its lengths is a little off, the least; None: it has none, or fails.

    Lengths of lists are as little exact as those of ranges; a floor that is flat has none.
    A ball that is off lies in the cavity that was made for the best one. A deviation beyond a limit, as of the mass,
    does not count.
    """
    if not optimum.evaluation.works:
        return None
    deviations, best = [], space.values(optimum.shares)
    for axis in space.axes:
        value = best[axis.name]
        if axis.key.whole or isinstance(value, str) or not math.isfinite(value):
            continue
        ends = (value / (1 + OFF), value * (1 + OFF))
        off: dict[str, tuple[Value, ...]] = {axis.name: ends}
        if axis.name == "damper.radius" and "damper.clearance" in best:
            off["damper.clearance"] = tuple(float(best["damper.clearance"]) + 2 * (value - radius) for radius in ends)
        both = _with_values(space, optimum, off, score)
        deviations += [Deviation(NAMES[axis.name], off, each) for off, each in zip((-OFF, OFF), both, strict=True)]
    possible = [each for each in deviations if not each.evaluation.impossible]
    return min(possible, key=lambda each: each.evaluation.score, default=None)


OFF = 0.02
"""Relative deviation of a length, as wear and manufacture leave it."""


def _amplitude_constraint(space: Space, optimum: Optimum, score: Score) -> list[ActiveConstraint]:
    """The end of the range of amplitudes at which the best design damps least, and what a narrower range gains."""
    evaluation, goal = optimum.evaluation, space.goal
    if not isinstance(goal, LeastDamping) or not evaluation.works:
        return []
    for end, name, narrower in (
        (goal.low, "least", replace(goal, low=goal.low * (1 + _FURTHER))),
        (goal.high, "greatest", replace(goal, high=goal.high / (1 + _FURTHER))),
    ):
        if abs(evaluation.amplitude / end - 1) < _AT_END and narrower.low < narrower.high:
            said = f"the damping is least at the {name} amplitude required, {significant(1e3 * end)} mm"
            (further,) = score(replace(space, goal=narrower), optimum.shares[None], False)
            return [ActiveConstraint("amplitude", said, _gain(optimum, further))]
    return []


def _range_end(space: Space, optimum: Optimum, score: Score, k: int) -> list[ActiveConstraint]:
    """The end of a range at which the best design lies, and what it would gain beyond; none where that is no better."""
    axes, shares, evaluation = list(space.axes), optimum.shares.copy(), optimum.evaluation
    name, spread = axes[k].name, axes[k].spread
    assert spread is not None
    shares[k] = round(shares[k])
    here, last = (formatted(name, space.values(each)[name]) for each in (optimum.shares, shares))
    end = f"the {'greatest' if shares[k] else 'least'} allowed"
    if here != last:
        end = f"close to {end}, {last.removeprefix(NAMES[name].replace('_', ' ')).strip()}"
    end = f"{here} is {end}"
    if not evaluation.works:
        return [ActiveConstraint(NAMES[name], end)]
    low, high = (spread.low, spread.high * (1 + _FURTHER)) if shares[k] else (spread.low / (1 + _FURTHER), spread.high)
    axes[k] = replace(axes[k], spread=Spread(low, high, spread.law))
    (further,) = score(replace(space, axes=tuple(axes)), shares[None], False)
    gain = _gain(optimum, further)
    return [ActiveConstraint(NAMES[name], end, gain)] if gain is None or _is_better(optimum, further) else []


_CONFIRMED, _REDUCTION = 0.01, 0.1
"""Difference up to which the forced motion confirms an amplitude, relative to it and to the reduction."""


def confirmed(optimum: Optimum, response: Response) -> Optimum:
    """The best design with its forced motion, under the largest force that the scene has.

    The amplitude without a ball is that of the motion. Where the motion refutes the search, its figures take their
    place, and the worst deviation, by the search, is gone.
    """
    level, evaluation = max(response.requested_levels), optimum.evaluation
    every = [row for row in rows(response) if row.force == level]
    row, without = max(every, key=lambda row: row.mean), max(row.without for row in every)
    value, crossing = evaluation.value, row.passage.crossing
    evaluation = replace(evaluation, speed=crossing.omega, order=crossing.order, without=without)
    optimum = replace(optimum, evaluation=evaluation, confirmed=row.mean, search_value=value)
    why = None if row.mean <= excitation.HELPS * without else Obstacle("useless")
    most = min(_CONFIRMED * row.mean, _REDUCTION * abs(without - row.mean)) + row.error
    if why is None and abs(row.mean - value) <= most:
        return optimum
    score = evaluation.score - math.log(row.mean / value)
    return replace(
        optimum, evaluation=replace(evaluation, value=row.mean, amplitude=row.mean, score=score, why=why), worst=None
    )


@dataclass(frozen=True, eq=False)
class Grid:
    """A map: names and values (SI) along x and y.

    Attributes:
        values: of designs, (y, x); nan where one exceeds a limit, as `beyond` says; 0 for a damping that fails.
    """

    x: str
    xs: Floats
    y: str
    ys: Floats
    values: Floats
    beyond: npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False, repr=False)
class DesignResult(StudyResult):
    """What a search came to.

    Attributes:
        space: of the designs.
        optimum: the best design; where none works, the closest one.
        active_constraints: what keeps it from being better.
        scene: the scene with the best damper, without [design].
        toml: the same as a file that `run` and `response` take; empty where none works.
        grid: the map around the best.
        response: of the best, where designs are compared by the amplitude at the crossings.
    """

    REPORT = __name__
    space: Space
    optimum: Optimum
    active_constraints: tuple[ActiveConstraint, ...]
    scene: SceneFile
    toml: str
    grid: Grid | None
    response: Response | None


NAME = "design"


def document(result: DesignResult) -> dict[str, Any]:
    """The machine-readable result."""
    evaluation, design, worst = result.optimum.evaluation, result.space.design, result.optimum.worst
    values = result.space.values(result.optimum.shares)
    damper = result.scene.scene.damper
    at = {name: finite(getattr(evaluation, name)) for name in ("speed", "amplitude")}
    off = worst and {"name": worst.name, "relative": worst.relative, "value": worst.evaluation.value}
    best: dict[str, Any] = {name.partition(".")[2]: as_plain([value])[0] for name, value in values.items()}
    entries = {
        "title": result.space.source.scene.title,
        "objective": result.space.goal.objective,
        "constraints": design.model_dump(mode="json", exclude_none=True),
        "best": best | {"cavity": None if damper is None else list(damper.cavity)},
        "works": evaluation.works,
        "value": evaluation.value,
        "greatest": finite(evaluation.greatest),
        "at": at | {"order": evaluation.order},
        **{name: finite(getattr(evaluation, name)) for name in ("without", "bound", "cutoff")},
        "ball_mass": finite(evaluation.mass),
        "holds": [vars(each) for each in result.active_constraints],
        "worst_deviation": off,
        "evaluations": result.optimum.evaluations,
        "verdict": verdict(result.space, result.optimum),
        "why": sentences(result),
    }
    if result.response is not None:
        entries |= {"confirmed": result.optimum.confirmed, "search_value": result.optimum.search_value}
        entries["crossings"] = response_report.entries(result.response)
    return entries


def verdict(space: Space, optimum: Optimum) -> str:
    """The answer in a line."""
    return " ".join(_said("verdict", space, optimum))


def sentences(result: DesignResult) -> list[str]:
    """What carries the answer, and what limits it; or why nothing works."""
    text = "sentences" if result.optimum.evaluation.works else "reasons"
    more = {"constraints": result.active_constraints, "has_thickness": has_thickness}
    return _said(text, result.space, result.optimum, **more)


def infeasible(limit: str, share: float, nearest: Evaluation) -> str:
    """That no design is within a limit, of which the closest one uses a share; else why none is worth anything."""
    return " ".join(templates.said("design/infeasible", limit=limit, share=share, why=nearest.why))


def _said(text: str, space: Space, optimum: Optimum, **values: Any) -> list[str]:
    """Sentences of a text on a space and its best design."""
    known: dict[str, Any] = {"space": space, "goal": space.goal, "optimum": optimum, "best": optimum.evaluation}
    known |= {"worst": optimum.worst, "unknown": _unknown_contact(space, optimum)}
    return templates.said(f"design/{text}", space.count(optimum.shares), **known, **values)


def _unknown_contact(space: Space, optimum: Optimum) -> list[str] | None:
    """Materials of ball and floor of which no hardness is known by which their contact is checked."""
    ball, floor = space.source.scene.contact_materials
    ball = str(space.values(optimum.shares).get("damper.ball_material", ball or "")) or None
    if ball is None or floor is None:
        return None
    names = list(dict.fromkeys((ball, floor)))
    return names if all(KNOWN[name].hardness is None for name in names) else None


def draw(result: DesignResult) -> list[Picture]:
    """All pictures there are."""
    pictures, goal, of = [], result.space.goal, (result.space, result.optimum)
    if isinstance(goal, LeastDamping) and (curves := damping_curves(*of, goal)):
        pictures.append(Picture(_curves(goal, curves), *_said("of_curves", *of)))
    if result.response is not None:
        for number, passage in enumerate(result.response.passages):
            shades = map_spread(len(passage.forces) + 1)[:-1]
            drawn = response_report.response(result.response, passage, str(number), shades)
            pictures.append(Picture(drawn, *_said("of_response", *of, place=response_report.place(passage.crossing))))
    if result.grid is not None and result.optimum.evaluation.works:
        pictures.append(Picture(_map(result, result.grid), *_said("of_map", *of)))
    return pictures


def damping_curves(space: Space, optimum: Optimum, goal: LeastDamping) -> list[tuple[DamperCase, DampingCurve]]:
    """A curve for each speed at which the best ball moves below the highest amplitude of the goal, up to there."""
    cases = damper_cases(space.source, space.plan(optimum.shares[None]))
    moving = [each for each in cases if objectives.cutoff_of(each.verdict_damper) < goal.high]
    curves = [(each, damping_curve(each.verdict_damper, threads=1, reach=goal.high)) for each in moving]
    return [(each, curve) for each, curve in curves if curve.amplitude.size]


@plots.style()
def _curves(goal: LeastDamping, curves: list[tuple[DamperCase, DampingCurve]]) -> str:
    figure, (axes,) = plots.canvas(3.1)
    grid = np.geomspace(goal.low, goal.high, 30)
    for (case, curve), colour in zip(curves, map_spread(len(curves) + 1), strict=False):
        label = turning(case.point.omega)
        plots.damping_curve(axes, curve.amplitude, curve.damping_ratio, color=colour, label=label)
        bound = [objectives.bound_of(case.verdict_damper, float(amplitude)) for amplitude in grid]
        axes.plot(1e3 * grid, [100 * b if math.isfinite(b) else math.nan for b in bound], ":", color=colour, lw=1.0)
    plots.damping_axes(axes)
    for end in (goal.low, goal.high):
        axes.axvline(1e3 * end, color=plots.INK, lw=0.8, ls=plots.DASHED)
    top = max(100 * curve.peak for _, curve in curves)
    axes.set_ylim(1e-3 * top, 4 * max(top, 100 * AIR[1]))
    plots.legend(figure, axes, title="speed")
    return plots.svg(figure, "best", "Damping ratio of the damper over amplitude")


@plots.style()
def _map(result: DesignResult, grid: Grid) -> str:
    of_damping = result.space.goal.of_damping
    factor, name = (100.0, "least damping ratio, %") if of_damping else (1e3, "greatest amplitude, mm")
    figure, (axes,) = plots.canvas(3.4)
    xs, ys, values = in_mm(grid.x, grid.xs), in_mm(grid.y, grid.ys), factor * grid.values
    levels = contour_levels([values]) if of_damping else contour_levels([values], least=0.0)
    colours = map_spread(len(levels) - 1)[:: 1 if of_damping else -1]
    paint(axes, xs, ys, values, levels, colours, grid.beyond)
    best = result.space.values(result.optimum.shares)
    mark(axes, in_mm(grid.x, best[grid.x]), in_mm(grid.y, best[grid.y]))
    xlabel, ylabel = (f"{NAMES[key].replace('_', ' ')}, mm" for key in (grid.x, grid.y))
    axes.set(xlabel=xlabel, ylabel=ylabel)
    colour_key(figure, levels, colours, name, idle="beyond a limit" if grid.beyond.any() else "")
    return plots.svg(figure, "around", f"The {name.partition(',')[0]} around the best design")


def files(result: DesignResult) -> dict[str, str | bytes]:
    """The files beside `design.json`."""
    return {"report.html": render(result), **({"best.toml": result.toml} if result.toml else {})}


def text(result: DesignResult) -> str:
    """The answer in a few lines."""
    return "\n".join([f"{verdict(result.space, result.optimum)}.", *sentences(result)])


def in_short(result: DesignResult) -> str:
    """The answer and what it is due to, in one line."""
    return f"{verdict(result.space, result.optimum)}: {sentences(result)[0]}"


def render(result: DesignResult) -> str:
    """The page."""
    pictures = draw(result)
    return templates.from_template(
        "design.html.j2",
        plots.shades_css(SHADES) if pictures else "",
        title=result.space.source.scene.title,
        works=result.optimum.evaluation.works,
        verdict=verdict(result.space, result.optimum),
        sentences=sentences(result),
        figures=pictures,
        toml=result.toml,
        evaluations=result.optimum.evaluations,
    )
