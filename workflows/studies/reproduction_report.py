"""The reproduction of the paper: its claims judged, and as files: JSON, CSV and one page for a person."""

import json
from collections.abc import Iterable
from typing import Any

from pydantic_core import to_json

from workflows import formatting
from workflows.io.files import as_table
from workflows.report import plots
from workflows.report.templates import from_template
from workflows.scene.paper import SDC_RANGE
from workflows.studies.reproduction import FORMULATIONS, SHOWN, TEXTS, Family, Reproduction, Value
from workflows.studies.sweep.report import Picture
from workflows.versions import versions

NAME = "reproduce"


def document(reproduction: Reproduction) -> dict[str, Any]:
    """The machine-readable result."""
    parts = {name: getattr(reproduction, name) for name in ("claims", "slips", "closure")}
    return {
        "versions": versions(),
        **json.loads(to_json(parts, inf_nan_mode="null")),
        "assumptions": TEXTS["assumptions"],
    }


@plots.style()
def draw(reproduction: Reproduction) -> list[Picture]:
    """All six."""
    families = enumerate(reproduction.sweeps.values(), 3)
    drawn = [_velocity(reproduction), *(_capacity(family, number) for number, family in families)]
    captions = zip(drawn, TEXTS["figures"], strict=True)
    return [Picture(svg, f"As Fig. {k} of the paper. {caption}") for k, (svg, caption) in enumerate(captions, 2)]


def _velocity(reproduction: Reproduction) -> str:
    figure, panels = plots.canvas(2.3, 2)
    for axes, formulation, dampings in zip(panels, FORMULATIONS, reproduction.study.dampings, strict=True):
        history, stopped = dampings[SHOWN].history, dampings[SHOWN].stopped
        assert history is not None
        for axis, name in enumerate("xy"):
            colour = plots.CATEGORIES[axis]
            axes.plot(1e3 * history.t, history.velocity[:, axis], color=colour, lw=0.8, label=name)
        axes.set(title=formulation, xlabel="time, ms")
        if stopped is not None:
            axes.axvline(1e3 * stopped, color=plots.INK, lw=0.8, ls=plots.DASHED)
    panels[0].set_ylabel("velocity, m/s")
    panels[0].legend(loc="upper right", ncols=2)
    return plots.svg(figure, "fig2", "Velocity of the structure over time")


def _capacity(family: Family, number: int) -> str:
    """Damping capacity over dimensionless acceleration, the structure's own part dashed."""
    figure, panels = plots.canvas(2.9, 2)
    curves = [curve for formulation in FORMULATIONS for curve in family[formulation]]
    low, high = (f(100 * float(f(c.sdc[1:])) for c in curves) for f in (min, max))
    if number == 3:
        high = max(high, 100 * SDC_RANGE[1])
    margin = 0.06 * (high - low)
    for axes, formulation in zip(panels, FORMULATIONS, strict=True):
        for curve, colour in zip(family[formulation], plots.shades(len(family[formulation])), strict=True):
            axes.plot(curve.amplitude_g, 100 * curve.sdc, color=colour, marker="o", ms=2.2, lw=1.1, label=curve.label)
        curve = family[formulation][0]
        axes.axhline(100 * float(curve.sdc[-1] - curve.ball[-1]), color=plots.MUTED, lw=0.8, ls=plots.DASHED)
        if number == 3:
            axes.axhspan(100 * SDC_RANGE[0], 100 * SDC_RANGE[1], color=plots.RULE, lw=0)
        axes.set(title=formulation, ylim=(low - margin, high + margin), xlabel="amplitude Γ, g")
        if number == 3:
            axes.set_xscale("log")
    panels[0].set_ylabel("specific damping capacity, %")
    plots.legend(figure, panels[1])
    return plots.svg(figure, f"fig{number}", f"Specific damping capacity over amplitude, as in Fig. {number}")


def files(reproduction: Reproduction) -> dict[str, str | bytes]:
    """The files beside `reproduce.json`."""
    entries = document(reproduction)
    claims = entries["claims"]
    lines = [
        line | {"assumptions": _joined(each["name"] for each in line["assumptions"])} for line in entries["closure"]
    ]
    return {
        "reproduce.csv": as_table(claims[0], claims),
        "closure.csv": as_table(lines[0], lines),
        "report.html": render(reproduction),
    }


def text(reproduction: Reproduction) -> str:
    """The verdicts, a line each, and how many there are of which."""
    lines = [f"{claim.verdict:<15} {claim.id:<16} {claim.claim}" for claim in reproduction.claims]
    counts = ", ".join(f"{count} {verdict}" for verdict, count in reproduction.count.items())
    return "\n".join([*lines, "", counts])


def render(reproduction: Reproduction) -> str:
    """The page."""
    return from_template(
        "reproduce.html.j2",
        plots.shades_css(7),
        value=value,
        result=reproduction,
        figures=draw(reproduction),
        closure=[(_joined(each.text for each in line.assumptions), line) for line in reproduction.closure],
        assumptions=TEXTS["assumptions"],
    )


def value(number: Value) -> str:
    """A claim's value in words."""
    if number is None:
        return "–"
    if isinstance(number, list):
        return ", ".join(value(item) for item in number)
    size = abs(number)
    if size >= 1000:
        return formatting.fixed(number).replace("\N{THIN SPACE}", "\N{NARROW NO-BREAK SPACE}")
    if size >= 100:
        return formatting.fixed(number, 1)
    return formatting.significant(number, 2 if size < 1e-3 else 3)


def _joined(assumptions: Iterable[str]) -> str:
    return " + ".join(assumptions) or "none"
