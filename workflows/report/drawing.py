"""How a figure of the report is drawn: one style, and SVG that takes its colours and type from the page.

Each figure is drawn twice, for a page and for a phone; the page's style sheet shows one of them. matplotlib is
used without pyplot, and imported here only when something is drawn.
"""

from __future__ import annotations

import io
import json
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from workflows.report import ticks
from workflows.report.compact import for_a_page
from workflows.report.palette import INK, MUTED, RULE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Sheet:
    """What a figure is drawn on. The page scales it to its column.

    Attributes:
        name: its class in the page's style sheet.
        width: in inches.
    """

    name: str
    width: float


_NAMED_AT_MOST, _NAMED_OF_MANY = 16, 9
"""Curves that a legend names all, and how many it names of more: from the first to the last, evenly."""

WIDE, NARROW = Sheet("wide-sheet", 6.6), Sheet("narrow-sheet", 3.7)

_STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "spindamp",
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.0,
    "axes.labelsize": 8.0,
    "axes.titlesize": 8.0,
    "axes.titlelocation": "left",
    "axes.titlepad": 8.0,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.facecolor": "none",
    "figure.facecolor": "none",
    "grid.color": RULE,
    "grid.linewidth": 0.5,
    "text.color": INK,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "legend.title_fontsize": 7.5,
    "lines.linewidth": 1.3,
    "path.simplify_threshold": 0.25,
    "lines.markersize": 3.2,
}


@contextmanager
def style() -> Iterator[None]:
    """The look of all figures; whatever is drawn, is drawn inside."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it remarks on a home that cannot be written
    import matplotlib as mpl

    with mpl.rc_context(_STYLE):
        yield


def canvas(sheet: Sheet, height: float, panels: int = 1) -> tuple[Figure, list[Axes]]:
    """A figure with panels `height` inches high: side by side, or on a narrow sheet one below the other.

    Margins are measured once all is drawn, so that whatever labels come out have room.
    """
    from matplotlib.figure import Figure

    rows, columns = (1, panels) if sheet is WIDE else (panels, 1)
    figure = Figure(figsize=(sheet.width, rows * height))
    figure.set_layout_engine("constrained", hspace=0.08)
    return figure, [figure.add_subplot(rows, columns, i + 1) for i in range(panels)]


def beside(sheet: Sheet, side: float, panels: int) -> tuple[Figure, list[Axes]]:
    """A figure with a square `side` inches wide, and beside it, on a narrow sheet below it, panels upon each other."""
    from matplotlib.figure import Figure

    wide = sheet is WIDE
    shape = (sheet.width, 1.15 * side) if wide else (sheet.width, side + 1.5 * panels)
    figure = Figure(figsize=shape)
    figure.set_layout_engine("constrained", hspace=0.08, wspace=0.06)
    if wide:
        grid = figure.add_gridspec(panels, 2, width_ratios=(side, sheet.width - side))
        square, places = grid[:, 0], [grid[k, 1] for k in range(panels)]
    else:
        grid = figure.add_gridspec(panels + 1, 1, height_ratios=(side, *([1.25] * panels)))
        square, places = grid[0], [grid[k + 1] for k in range(panels)]
    first = figure.add_subplot(square)
    return figure, [first, *(figure.add_subplot(place) for place in places)]


def key(figure: Figure, axes: Axes, sheet: Sheet, **how: Any) -> None:
    """A legend of the curves of `axes` beside the figure, or below it on a narrow sheet; of many it names some."""
    curves = axes.get_legend_handles_labels()
    if (count := len(curves[0])) > _NAMED_AT_MOST:
        named = [round(k * (count - 1) / (_NAMED_OF_MANY - 1)) for k in range(_NAMED_OF_MANY)]
        curves = [curves[0][k] for k in named], [curves[1][k] for k in named]
        how["title"] = f"{how.get('title', 'curves')}, {_NAMED_OF_MANY} of {count}"
    if sheet is WIDE:
        figure.legend(*curves, loc="outside right center", **how)
    else:
        figure.legend(*curves, loc="outside lower left", ncols=how.pop("ncols", 3), **how)


def both(draw: Callable[[Sheet], str]) -> str:
    """A figure on either sheet; nothing where there is nothing to draw."""
    return draw(WIDE) + draw(NARROW)


def svg(figure: Figure, sheet: Sheet, name: str, description: str, *, live: bool = False) -> str:
    """The figure as an SVG element for a page; `name` keeps its ids apart from other figures'.

    `live`: with its axes, so that a script finds the place of a value.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    ticks.label(figure)
    out = io.StringIO()
    canvas: Any = FigureCanvasSVG(figure)
    canvas.print_svg(out, metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    drawn = for_a_page(out.getvalue(), f"{name}-{sheet.name[0]}", description)
    axes = f" data-axes='{json.dumps(_frames(figure))}'" if live else ""
    return drawn.replace("<svg", f'<svg class="{sheet.name}"{axes}', 1)


def _frames(figure: Figure) -> list[dict[str, Any]]:
    """Where the axes are in the drawing (left, right, top, bottom), what they run over, and which are logarithmic."""
    width, height = (72.0 * side for side in figure.get_size_inches())
    found = []
    for axes in figure.axes:
        box = axes.get_position()
        sides = (box.x0 * width, box.x1 * width, (1 - box.y1) * height, (1 - box.y0) * height)
        found.append(
            {
                "box": [round(float(side), 2) for side in sides],
                "x": [float(end) for end in axes.get_xlim()],
                "y": [float(end) for end in axes.get_ylim()],
                "log": [axes.get_xscale() == "log", axes.get_yscale() == "log"],
            }
        )
    return found
