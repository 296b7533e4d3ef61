"""A forced response as a folder: JSON, netCDF, pictures, and one page for a person."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from damper import Regime
from fem.rotor import in_rpm
from workflows.formatting import DASH, aligned, fixed, listed, significant, whole
from workflows.io import provenance
from workflows.io.files import finite, global_attributes
from workflows.report import figures, plots, remarks, templates, verdict
from workflows.report.templates import capital, in_percent
from workflows.solve.engine_orders import Crossing
from workflows.solve.excitation import HELPS, endured, half_way, neighbours
from workflows.solve.limits import AIR, friction_needed, is_heavy, weight_at
from workflows.solve.results import ForceLevel, Reason, VibrationReduction
from workflows.studies import response as study
from workflows.studies.response import Passage, Response, Row, best_level, is_beyond, peak, rows, shows
from workflows.versions import versions

if TYPE_CHECKING:
    import xarray as xr


NAME = "response"


def tag(passage: Passage) -> str:
    """A crossing as part of a file name."""
    c = passage.crossing
    return f"order_{c.order}_mode_{c.branch + 1}_{c.rpm:.0f}rpm"


def dataset(result: Response) -> xr.Dataset:
    """All steady states: dimensions crossing, speed, force and start; units in the attributes."""
    import xarray as xr

    dims = ("crossing", "speed", "force", "start")
    passages, data = result.passages, xr.Dataset(attrs=global_attributes(result.results))
    most = max(len(passage.omega) for passage in passages)

    def padded(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Values over speed, nan (texts: empty) beyond those of a crossing with fewer than others."""
        beyond = (most - len(values), *values.shape[1:])
        return np.concatenate([values, np.full(beyond, "" if values.dtype == object else np.nan)])

    unit, kind = result.excitation.unit.replace("²", "2"), result.excitation.kind
    data = data.assign_coords(
        order=("crossing", [passage.crossing.order for passage in passages]),
        mode=("crossing", [passage.crossing.branch + 1 for passage in passages]),
        axis=("crossing", [t.axis + 1 for t in passages], {"long_name": "axis of the cavity of the amplitudes"}),
        force=("force", list(result.excitation.levels), {"units": unit, "long_name": f"height of the {kind}"}),
        start=("start", [str(start) for start in passages[0].states.starts]),
        rpm=(dims[:2], in_rpm(np.array([padded(t.omega) for t in passages])), {"units": "rpm"}),
    )
    for name, (unit, description) in templates.texts("response")["states"].items():
        values = np.array([padded(getattr(t.states, name)) for t in passages], dtype=float)
        data[name] = (dims, values, {"units": unit, "long_name": description})
    regimes = np.array([padded(t.states.regime).astype(str).astype(object) for t in passages])
    data["regime"] = (dims, regimes, {"long_name": "what the steady state is"})
    for name, description in (("without", "amplitude without the ball"), ("linear", "amplitude with the ball at rest")):
        values = np.abs([padded(getattr(passage.states, name)) for passage in passages])
        data[name] = (dims[:3], values, {"units": "m", "long_name": description})
    every = ([row.estimate for row in rows(result, passage)] for passage in passages)
    estimates = [[np.nan if each is None else each.amplitude for each in one] for one in every]
    description = "largest amplitude, whatever the speed, estimated from free vibration"
    data["shortcut"] = (dims[::2], estimates, {"units": "m", "long_name": description})
    return data


_MARKS = {"locked": "s", "periodic": "o", "modulated": "^", "chaotic": "D", "not settled": "x"}
"""What happens at a crossing, as a mark."""


@plots.style()
def campbell_plot(result: Response) -> str:
    """The run's diagram with what happens where orders cross modes; empty where the structure is given."""
    figure = figures.campbell(result.results)
    if figure is None:
        return ""
    (axes,), named = figure.axes, set[str]()
    for passage in result.passages:
        for kind in dict.fromkeys(row.regime for row in rows(result, passage)):
            look: dict[str, Any] = {"color": plots.INK, "mfc": "none", "mew": 0.8, "ls": "", "zorder": 4}
            label, size = None if kind in named else kind, 5 + 2 * list(_MARKS).index(kind)
            axes.plot(passage.crossing.rpm, passage.crossing.frequency_hz, _MARKS[kind], ms=size, label=label, **look)
            named.add(kind)
    for crossing, _ in result.not_followed:
        axes.plot(crossing.rpm, crossing.frequency_hz, "+", color=plots.MUTED, ms=6)
    plots.legend(figure, axes)
    return plots.svg(figure, "crossings", "Campbell diagram with what happens at the crossings")


@plots.style()
def response(result: Response, passage: Passage, name: str, shades: Sequence[str]) -> str:
    """Amplitude over speed for each force: without the ball, and with it from the least cycle to the greatest."""
    figure, (axes,) = plots.canvas(3.3)
    rpm = in_rpm(passage.omega)
    states = passage.states
    least, mean, greatest = (getattr(states, key) for key in ("least", "mean", "greatest"))
    without = np.abs(states.without)
    for k, (force, colour) in enumerate(zip(passage.forces, shades, strict=True)):
        axes.plot(rpm, 1e3 * without[:, k], color=colour, lw=0.8, ls=(0, (4, 2)))
        low, high = 1e3 * least[:, k].min(axis=1), 1e3 * greatest[:, k].max(axis=1)
        axes.fill_between(rpm, low, high, color=colour, alpha=0.25, lw=0)
        for start in range(mean.shape[2]):
            label = f"{significant(force)} {result.excitation.unit}" if start == 0 else None
            axes.plot(rpm, 1e3 * mean[:, k, start], color=colour, lw=1.0, label=label)
    axes.set(yscale="log", xlabel="rotation speed, rpm", ylabel=f"amplitude along axis {passage.axis + 1}, mm")
    plots.legend(figure, axes, title=result.excitation.kind)
    return plots.svg(figure, f"response-{name}", "Amplitude over speed, without and with the ball")


@plots.style()
def damping(result: Response) -> str:
    """The ball's equivalent damping ratio over amplitude at each crossing, its working range, and what the air does."""
    every = [(passage.crossing, passage.figures) for passage in result.passages if passage.figures is not None]
    shown = [(c, figures) for c, figures in every if figures.amplitude.size]
    if not shown:
        return ""
    figure, (axes,) = plots.canvas(3.0)
    for (c, own), colour in zip(shown, plots.shades(len(shown)), strict=True):
        label = f"order {c.order}, {whole(c.rpm)} rpm"
        plots.damping_curve(axes, own.amplitude, own.damping_ratio, color=colour, label=label)
        low, high = (1e3 * end for end in own.range)
        if np.isfinite(low) and np.isfinite(high):
            axes.plot([low, high], [50 * own.peak] * 2, color=colour, lw=3, alpha=0.35)
    least = 100 * min(figures.peak for _, figures in shown) / 30
    plots.damping_axes(axes)
    axes.set_ylim(min(least, 50 * AIR[0]), None)
    plots.legend(figure, axes, ncols=1)
    return plots.svg(figure, "zeta", "Damping ratio by the ball over amplitude")


def sentences(result: Response) -> list[str]:
    """What the ball does at each order asked for, in plain sentences, where it does most first."""
    if (dense := remarks.too_dense(result.results)) is not None:
        return [f"No verdict: {dense[0]}.", dense[1]]
    not_followed = [each for each in result.results.reductions if each.reason == Reason.NOT_DRIVEN]
    reductions = *(confirmed(result, passage) for passage in result.passages), *not_followed
    answer = verdict.of_orders(replace(result.results, reductions=reductions))
    if any(not each.reason for each in reductions):
        answer[0] += "".join(
            f" {capital(each)}." for each in remarks.misfit(result.results.scene, result.results.speeds)
        )
    answer += _added(result)
    larger = [row for row in rows(result) if ratio_cell(result, row) != DASH and row.from_rest < _LESS * row.mean]
    answer += templates.said("response/from_rest", rows=larger, unit=result.excitation.unit)
    speeds = result.results.scene.rotor.speeds
    for passage in result.passages:
        largest = {peak(passage, force)[0] for force in range(len(passage.forces))} & {0, len(passage.omega) - 1}
        if largest and shows(passage, speeds):
            at_end = any(study.is_scene_end(float(passage.omega[k]), speeds) for k in largest)
            where = "the scene's speeds" if at_end else "the speeds followed"
            there = f"the largest amplitude is at the end of {where}"
            answer.append(f"{place(passage.crossing)}; {there}: the peak may lie outside them.")
    if any(math.isnan(passage.crossing.error or 0.0) for passage in result.passages):
        answer += templates.said("remarks/sentence", unknown=True, target=result.results.scene.accuracy.frequency)
    return answer


_LESS = 0.5
"""Amplitude from rest over the largest, below which it is worth a sentence."""


def _added(result: Response) -> list[str]:
    """Why levels are evaluated that nobody asked for, and whether the motion does there what was predicted."""
    unit, near, above, sentences = result.excitation.unit, list[float](), list[float](), list[str]()
    for level in sorted({*result.excitation.levels} - {*result.requested_levels}):
        here = [row for row in rows(result) if row.force == level and best_level(row.passage.reduction) == level]
        predicted = [1.0 if row.estimate is None else row.estimate.ratio for row in here]
        tenth = [(1 - study.NEAR_BEST) * (1 - ratio) for ratio in predicted]
        missed = [row for row, p, most in zip(here, predicted, tenth, strict=True) if abs(row.ratio - p) > most]
        near += [level] if here and not missed else []
        above += [] if here else [level]
        sentences += templates.said("response/missed", rows=missed, unit=unit)
    sentences += templates.said("response/above", levels=above, unit=unit)
    return [*templates.said("response/near_best", levels=near, unit=unit), *sentences]


_OF_MOTION = (Reason.OTHER_MODE, Reason.SWINGS, Reason.SLIP)
"""Why free vibration does not tell what the motion does."""


def confirmed(result: Response, passage: Passage) -> VibrationReduction:
    """What the ball does at a crossing by the motion followed; its range is of levels that were."""
    estimate, mine = passage.reduction, rows(result, passage)
    damper = result.results.scene.damper
    if estimate.reason and estimate.reason not in _OF_MOTION:
        return estimate
    if not shows(passage, result.results.scene.rotor.speeds):
        return replace(estimate, reason=Reason.OTHER_MODE, detail=HIDDEN)
    levels = [ForceLevel(row.force, row.ratio, row.greatest, not is_beyond(result, row)) for row in mine]
    borne = [each for each in levels if each.endured] or levels
    moved = [each for each in borne if each.level >= passage.least_force]
    best = min(moved or borne, key=lambda each: each.ratio)
    hertz = None if passage.figures is not None else passage.crossing.frequency_hz
    needed = friction_needed(result.results, passage.at, best.amplitude, hertz)
    if weight_at(result.results, passage.at, best.amplitude, hertz) > 1:
        return replace(estimate, reason=Reason.WEIGHT)
    if damper is not None and damper.friction == 0 and needed > 0:
        return replace(estimate, reason=Reason.SLIP)
    enough = min(half_way(best.ratio), HELPS)
    useful = [each in moved and each.endured and each.ratio <= enough for each in levels]
    followed = np.array([each.level for each in levels])
    unknown = next(row.ratio_error for row in mine if row.force == best.level)
    rough = [] if unknown is None else [f"± {in_percent(unknown)} percentage points: the motion has not settled"]
    many = "s" if len(borne) > 1 else ""
    every = f"the level{many} followed, {listed([each.level for each in borne])} {result.excitation.unit}"
    around = neighbours(followed, np.flatnonzero(useful), levels.index(best)) if any(useful) else (math.nan, math.nan)
    return replace(
        estimate,
        ratio=best.ratio,
        level=best.level,
        range=around,
        moves_from=passage.least_force,
        driven_from=passage.driven_from,
        friction_needed=needed,
        levels=tuple(each for each in levels if each.level in result.requested_levels),
        loose=bool(rough),
        reason=Reason.NONE,
        detail=" ".join(rough if rough and any(useful) else [every, *(f"({each})" for each in rough)]),
    )


HIDDEN = "another mode moves the cavity more throughout, beside which this one does not show"
"""Why the motion at a crossing says nothing of its mode."""


def place(c: Crossing) -> str:
    """Where an order meets a mode."""
    return f"Order {c.order} meets the {c.family} mode at {whole(c.rpm)} rpm without a ball"


def text(result: Response) -> str:
    """What a person reads on the terminal."""
    every, unit = rows(result), f"{result.excitation.kind}, {result.excitation.unit}"
    heads = ("order", "mode", "largest at, rpm", unit, "without, mm", "with, mm", "ratio", "regime", "hits")
    table = aligned([(*heads, "estimated ratio", "estimate off, %"), *(_cells(result, row) for row in every)])
    damper = result.results.scene.damper
    zeta = 0.0 if damper is None else damper.damping_ratio
    values = {"rows": best_rows(result), "zeta": zeta, "unit": result.excitation.unit}
    added = templates.said("response/added", result.results.scene.ball_count, **values) if zeta else []
    return "\n".join(
        [result.results.scene.title, *sentences(result), "", *table, *legend(result, every), *captions(result), *added]
    )


def legend(result: Response, table: list[Row]) -> list[str]:
    """What the mark of amplitudes stands for, where a table has it."""
    beyond = [row.passage.crossing.omega for row in table if is_beyond(result, row)]
    return [f"{remarks.beyond_means(result.results, beyond)}."] if beyond else []


def captions(result: Response) -> list[str]:
    """Where balls at rest leave less, where estimated ratios are rough, and where amplitudes are along axis 2."""
    passages = [each for each in result.passages if each.reduction.loose]
    loose, heavy = [each.crossing for each in passages], any(is_heavy(each.at) for each in passages)
    across, balls = [each.crossing for each in result.passages if each.axis == 1], result.results.scene.ball_count
    said = templates.said("response/rough", balls, crossings=loose, heavy=heavy) if loose else []
    held = [row for row in rows(result) if row.regime == Regime.LOCKED and row.force >= row.passage.least_force]
    said += templates.said("response/held", balls) if any(row.ratio < _UNCHANGED for row in held) else []
    return said + (templates.said("response/across", crossings=across) if across else [])


_UNCHANGED = 0.98
"""Ratio of amplitudes below which it takes a word why there is one although the ball is at rest."""


def best_rows(result: Response) -> list[Row]:
    """Of each crossing at which the headline calls the ball useful, the row it names, unless its ball stays at rest.

    A ball that is set off nearer to the resonance reduces the peak, though the largest amplitude left is one at rest.
    """
    best = []
    for passage in result.passages:
        answer = confirmed(result, passage)
        if not answer.reason and math.isfinite(answer.range[0]):
            named = [row for row in rows(result, passage) if row.force == answer.level]
            best += [row for row in named if row.regime != Regime.LOCKED or row.force >= row.passage.least_force]
    return best


def ratio_cell(result: Response, row: Row) -> str:
    """The ratio of a row, with its error where the motion has not settled; a dash where it answers nothing."""
    if confirmed(result, row.passage).reason:
        return DASH
    error = "" if row.ratio_error is None else f" ± {significant(row.ratio_error, 2)}"
    return f"{significant(row.ratio, 4)}{error}"


def _cells(result: Response, row: Row) -> tuple[str, ...]:
    c, ratio = row.passage.crossing, ratio_cell(result, row)
    return (
        str(c.order),
        f"{c.family} {c.branch + 1}",
        whole(in_rpm(row.omega)),
        significant(row.force),
        significant(1e3 * row.without, 4),
        f"{significant(1e3 * row.mean, 4)}{remarks.BEYOND if is_beyond(result, row) else ''}",
        ratio,
        row.regime,
        significant(row.hits_per_cycle),
        significant(None if row.estimate is None else row.estimate.ratio, 4),
        fixed(None if row.difference is None or ratio == DASH else 100 * row.difference, 1),
    )


def document(result: Response) -> dict[str, Any]:
    """The machine-readable result: numbers are finite, an unknown one is None, SI unless a name says otherwise."""
    results = result.results
    return {
        "title": results.scene.title,
        "scene": provenance.resolved_scene(results.scene, results.effects, results.theory),
        **provenance.hashes(results),
        "versions": versions(),
        "timings": results.timings,
        "notes": list(results.notes),
        "headline": sentences(result),
        "excitation": {"kind": result.excitation.kind, "unit": result.excitation.unit},
        "aerodynamic_damping_ratio": list(AIR),
        "crossings": entries(result),
        "dampers": [_damper(result, passage) for passage in result.passages],
        "not_followed": [_crossing(c) | {"why": why} for c, why in result.not_followed],
    }


def entries(result: Response) -> list[dict[str, Any]]:
    """The crossings, each under every force."""
    return [_entry(result, row) for row in rows(result)]


def _crossing(c: Crossing) -> dict[str, Any]:
    mode = {"order": c.order, "mode": c.branch + 1, "family": c.family}
    return mode | {"rpm": c.rpm, "frequency_hz": c.frequency_hz}


def _entry(result: Response, row: Row) -> dict[str, Any]:
    c, target, estimate = row.passage.crossing, result.results.scene.accuracy.damping, None
    ratio = None if ratio_cell(result, row) == DASH else row.ratio
    if row.estimate is not None and row.difference is not None:
        off = None if ratio is None else row.difference
        estimate = {"amplitude": row.estimate.amplitude, "ratio": row.estimate.ratio, "difference": off}
        estimate["suffices"] = off is not None and abs(off) <= target
    return _crossing(c) | {
        "frequency_error": finite(c.error),
        "basis_error": finite(c.basis),
        "force": row.force,
        "axis": row.passage.axis + 1,
        "peak_rpm": in_rpm(row.omega),
        "peak_frequency_hz": row.frequency,
        "amplitude_without": row.without,
        "amplitude": {name: getattr(row, name) for name in ("least", "mean", "rms", "greatest")},
        "amplitude_error": row.error,
        "smallest_answer": row.smallest,
        "amplitude_from_rest": finite(row.from_rest),
        "ratio": ratio,
        **{name: getattr(row, name) for name in ("stress_without", "stress_with", "regime", "hits_per_cycle")},
        "power_in": finite(row.power_in),
        "power_lost": finite(row.power_lost),
        "shortcut": estimate,
        "shortcut_reason": row.passage.reduction.reason or None,
    }


def _damper(result: Response, passage: Passage) -> dict[str, Any]:
    """The force from which the damper moves at a crossing, and its own figures where the mode leads along axis 1."""
    c, own, spec = passage.crossing, passage.figures, result.results.scene.damper
    return {
        "order": c.order,
        "mode": c.branch + 1,
        "least_force": finite(passage.least_force),
        "structure_damping_ratio": None if spec is None else spec.damping_ratio,
        "endured_amplitude": finite(endured(result.results, c)),
        "damping_ratio_peak": own and own.peak,
        "at_amplitude": own and finite(own.peak_amplitude),
        "range": own and [finite(end) for end in own.range],
        "cutoff": own and finite(own.cutoff),
        "curve": own and {"amplitude": own.amplitude.tolist(), "damping_ratio": own.damping_ratio.tolist()},
    }


def draw(result: Response) -> dict[str, str]:
    """The pictures by the names of their files; the diagram is empty where the structure is given."""
    shades = plots.shades(len(result.excitation.levels))
    drawn = {"campbell": campbell_plot(result)}
    for number, passage in enumerate(result.passages):
        drawn[f"response_{tag(passage)}"] = response(result, passage, str(number), shades)
    return drawn


def files(result: Response) -> dict[str, str | bytes]:
    """The files beside `response.json`."""
    drawn, count = draw(result), len(result.excitation.levels)
    return {
        "response.nc": bytes(dataset(result).to_netcdf(engine="h5netcdf")),  # in memory: HDF5 dies on a full disk
        "report.html": render(result, drawn),
        **{f"{name}.svg": plots.standalone(svg, count) for name, svg in drawn.items() if svg},
    }


def render(result: Response, drawn: dict[str, str] | None = None) -> str:
    """The page, of pictures that are drawn. Everything that comes from a scene is escaped."""
    return templates.from_template(
        "response.html.j2",
        plots.shades_css(max(len(result.excitation.levels), len(result.passages), 1)),
        result=result,
        drawn=drawn or draw(result),
        damping=damping(result),
        mark=remarks.BEYOND,
        **{each.__name__: each for each in (captions, endured, is_beyond, legend, ratio_cell, rows, sentences, tag)},
    )
