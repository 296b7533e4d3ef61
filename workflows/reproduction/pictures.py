"""Figures 2 to 7 in the paper's own axes, a panel for each formulation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from workflows import drawing, wording
from workflows.paper import SDC_RANGE
from workflows.reproduction.study import FORMULATIONS, SHOWN, Curve

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from workflows.reproduction.reproduce import Reproduction
    from workflows.reproduction.sweeps import Family


@dataclass(frozen=True)
class Figure:
    """A figure of the page: the paper's number, what it shows, and the picture as SVG."""

    number: int
    caption: str
    svg: str


def draw(found: Reproduction) -> list[Figure]:
    """All six."""
    families = found.sweeps
    with drawing.style():
        return [
            Figure(2, "Velocity over time at 10000 rpm.", _velocity(found)),
            Figure(3, "Seven centrifugal loads; the grey band is what the paper reports.", _capacity(families.load, 3)),
            Figure(4, "Mass ratios at 21932 g.", _capacity(families.mass, 4)),
            Figure(5, "Clearances of the cavity at 21932 g, mass ratio 1.2 %.", _capacity(families.cavity, 5)),
            Figure(6, "Initial displacements at 21932 g, mass ratio 0.6 %.", _capacity(families.release, 6)),
            Figure(7, "Radii of the particle at 21932 g, mass ratio 1 %.", _capacity(families.radius, 7)),
        ]


def _velocity(found: Reproduction) -> str:
    figure, panels = drawing.canvas(2.3, 2, left=0.085, right=0.985, top=0.88, bottom=0.18, wspace=0.2)
    for axes, formulation in zip(panels, FORMULATIONS, strict=True):
        damping = found.study.points[formulation][SHOWN].damping
        if damping is None or damping.history is None:
            continue
        for axis, name in enumerate("xy"):
            colour = drawing.CATEGORIES[axis]
            axes.plot(1e3 * damping.history.t, damping.history.velocity[:, axis], color=colour, lw=0.8, label=name)
        axes.set(title=formulation, xlabel="time, ms")
        if damping.stopped is not None:
            axes.axvline(1e3 * damping.stopped, color=drawing.INK, lw=0.8, ls=(0, (4, 3)))
    panels[0].set_ylabel("velocity, m/s")
    panels[0].legend(loc="upper right", ncols=2)
    return drawing.svg(figure, "fig2", "Velocity of the structure over time")


def _capacity(family: Family, number: int) -> str:
    """Damping capacity over dimensionless acceleration, the structure's own part dashed."""
    figure, panels = drawing.canvas(2.9, 2, left=0.085, right=0.86, top=0.90, bottom=0.155, wspace=0.2)
    curves = [curve for formulation in FORMULATIONS for curve in family[formulation]]
    low, high = (f(100 * float(f(c.sdc[1:])) for c in curves) for f in (min, max))
    if number == 3:
        high = max(high, 100 * SDC_RANGE[1])
    margin = 0.06 * (high - low)
    for axes, formulation in zip(panels, FORMULATIONS, strict=True):
        for curve, colour in zip(family[formulation], drawing.shades(len(family[formulation])), strict=True):
            axes.plot(curve.amplitude_g, 100 * curve.sdc, color=colour, marker="o", ms=2.2, lw=1.1, label=curve.label)
        _guides(axes, family[formulation][0], number)
        axes.set(title=formulation, ylim=(low - margin, high + margin), xlabel="amplitude Γ, g")
        if number == 3:
            axes.set_xscale("log")
        axes.xaxis.set_major_formatter(lambda value, _: wording.fixed(value))
    panels[0].set_ylabel("specific damping capacity, %")
    panels[1].legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
    return drawing.svg(figure, f"fig{number}", f"Specific damping capacity over amplitude, as in Fig. {number}")


def _guides(axes: Axes, curve: Curve, number: int) -> None:
    own = 100 * float(curve.sdc[-1] - curve.ball[-1])
    axes.axhline(own, color=drawing.MUTED, lw=0.8, ls=(0, (4, 3)))
    if number == 3:
        axes.axhspan(100 * SDC_RANGE[0], 100 * SDC_RANGE[1], color=drawing.RULE, lw=0)
