"""How a figure of the report is drawn: one style, and SVG that takes its colours and type from the page.

Colours are placeholders in the drawing and CSS variables in the page, so that one picture serves light, dark and
print. Each figure is drawn twice, for a page and for a phone; the page's style sheet shows one of them. matplotlib is
used without pyplot, and imported here only when something is drawn.
"""

from __future__ import annotations

import io
import json
import logging
import re
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from workflows.report import ticks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK, MUTED, RULE, PAPER = "#010203", "#010204", "#010205", "#010206"
"""Text and axes, secondary text, grid, and the page itself."""

CATEGORIES = ("#0072b2", "#d55e00", "#009e73", "#a0568c", "#c48a00", "#3f9bd1", "#7f7f7f")
"""After Okabe and Ito (2008): told apart with any kind of colour vision."""

_WRITTEN = ("#0072b2", "#b34f00", "#00795a", "#a0568c", "#8a6000", "#2474a6", "#6b6b6b")
"""The same in a light page where words have them: with a contrast of 4.5 and more."""

MARKERS = ("o", "s", "^", "D", "v", "P", "X")

_VARIABLES = {INK: "--ink", MUTED: "--muted", RULE: "--rule", PAPER: "--paper"} | {
    colour: f"--line-{i}" for i, colour in enumerate(CATEGORIES)
}
_LIGHT = {"--ink": "#1c1d20", "--muted": "#6b6d73", "--rule": "#e2dfd6", "--paper": "#ffffff"}
"""The colours of a light page."""

_HUNDREDTHS = re.compile(r"(\.\d\d)\d+")
"""Coordinates beyond hundredths of a point, which nobody sees."""


@dataclass(frozen=True)
class Sheet:
    """What a figure is drawn on. The page scales it to its column.

    Attributes:
        name: its class in the page's style sheet.
        width: in inches.
    """

    name: str
    width: float


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
    """A legend of the curves of `axes` beside the figure, or below it on a narrow sheet."""
    curves = axes.get_legend_handles_labels()
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
    drawn = _for_a_page(out.getvalue(), f"{name}-{sheet.name[0]}", description)
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


def standalone(drawn: str) -> str:
    """An SVG for a page as a file of its own, in the colours of a light page."""
    light = _LIGHT | {"--sans": "sans-serif"} | {f"--line-{i}": colour for i, colour in enumerate(CATEGORIES)}
    light |= {f"--text-{i}": colour for i, colour in enumerate(_WRITTEN)}
    for variable, colour in light.items():
        drawn = drawn.replace(f"var({variable})", colour)
    width, height = re.findall(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', drawn)[0]
    ground = f'<rect width="{width}" height="{height}" fill="#ffffff"/>'
    start = drawn.index(">", drawn.index("<svg")) + 1
    return drawn[: start - 1] + ' xmlns="http://www.w3.org/2000/svg">' + ground + drawn[start:] + "\n"


def coloured(figure: Figure, count: int) -> Figure:
    """The figure with the colours of a light page in the place of placeholders, `count` of them shades."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex, to_rgba

    steps = [0.05 + 0.71 * i / max(count - 1, 1) for i in range(min(count, 256))]
    known = {place: _LIGHT[_VARIABLES[place]] for place in (INK, MUTED, RULE, PAPER)}
    known |= {place: to_hex(colormaps["plasma"](step)) for place, step in zip(shades(count), steps, strict=False)}
    for artist in figure.findobj():
        for part in ("color", "edgecolor", "facecolor", "markeredgecolor", "markerfacecolor"):
            found: Any = getattr(artist, f"get_{part}", lambda: None)()
            with suppress(ValueError, TypeError):
                to = known.get(to_hex(found))
                if to is not None and to_rgba(found)[3] > 0:
                    getattr(artist, f"set_{part}")(to)
    figure.set_facecolor(_LIGHT["--paper"])
    return figure


def shades(count: int) -> list[str]:
    """Colours for an ordered family of curves, dark to bright; placeholders like the others."""
    return [f"#0203{i:02x}" for i in range(min(count, 256))] + ["#0203ff"] * (count - 256)


def shades_css(count: int) -> str:
    """The variables behind :func:`shades`, for a light and for a dark page."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    def block(low: float, high: float) -> str:
        steps = [low + (high - low) * i / max(count - 1, 1) for i in range(min(count, 256))]
        colours = (to_hex(colormaps["plasma"](step)) for step in steps)
        return ":root{" + "".join(f"--shade-{i}:{colour};" for i, colour in enumerate(colours)) + "}"

    return f"{block(0.05, 0.76)}@media screen and (prefers-color-scheme: dark){{{block(0.34, 0.97)}}}"


def _for_a_page(text: str, name: str, description: str) -> str:
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.S)
    text = re.sub(r'\sxmlns(:\w+)?="[^"]*"', "", text)
    text = text.replace("xlink:href", "href")
    text = re.sub(r"(font(?:-family)?:[^;\"]*?)'DejaVu Sans'(?:, sans-serif)?", r"\1var(--sans)", text)
    text = re.sub(r' (?:d|x|y)="[^"]*"', lambda path: _HUNDREDTHS.sub(r"\1", path[0]), text)
    for colour, variable in _VARIABLES.items():
        text = text.replace(colour, f"var({variable})")
    text = re.sub(r'(<text style="[^"]*)var\(--line-', r"\1var(--text-", text)
    text = re.sub(r"#0203([0-9a-f]{2})", lambda found: f"var(--shade-{int(found[1], 16)})", text)
    text = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", text, count=1)
    text = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", text, count=1)
    return _styled(_compact(_named(text, name)), name).replace("<svg", f'<svg role="img" aria-label="{description}"', 1)


def _compact(text: str) -> str:
    """The same drawing without remarks and blanks, the style of markers said once."""
    text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r' transform="rotate\(-0 [^"]*"', "", text)
    text = re.sub(r'(?<= d=")[^"]*', lambda path: re.sub(r"\s*([A-Za-z\n])\s*", r"\1", path[0].strip()), text)
    text = re.sub(r' style="[^"]*"', lambda style: re.sub(r"([:;]) ", r"\1", style[0]), text)
    text = re.sub(r"(opacity:0\.\d\d)\d+", r"\1", text)
    text = _drawn_once(re.sub(r">\s+<", "><", text))
    text = re.sub(r'(?:<use [^>]*? style="[^"]*"/>){2,}', _markers, text)
    while (plain := re.sub(r"<g>(<(?:path|use|text)\b[^>]*(?:/>|>[^<]*</\w+>))</g>", r"\1", text)) != text:
        text = plain
    return text.replace("><", ">\n<")


def _drawn_once(text: str) -> str:
    """Shapes that are defined and then used once, as those of a map are, drawn where they stand."""
    times = Counter(re.findall(r'href="#([^"]+)"', text))

    def plain(found: re.Match[str]) -> str:
        name, path, clip, x, y, style = found.groups()
        if times[name] > 1:
            return str(found[0])
        return f'<g clip-path="{clip}"><g transform="translate({x} {y})"><path {path}{style}/></g></g>'

    text = re.sub(
        r'<g><defs><path id="([^"]+)" (d="[^"]*")/></defs><g clip-path="([^"]+)">'
        r'<use href="#\1" x="([^"]*)" y="([^"]*)"( style="[^"]*")/></g></g>',
        plain,
        text,
    )
    return re.sub(r'(?:<g clip-path="[^"]+"><g transform="[^"]+"><path [^>]*/></g></g>){2,}', _together, text)


def _together(run: re.Match[str]) -> str:
    """Shapes one after another; where they are cut and moved alike, in one group."""
    heads = set(re.findall(r"<g clip-path[^>]*><g transform[^>]*>", run[0]))
    if len(heads) > 1:
        return str(run[0])
    head = str(heads.pop())
    return head + str(run[0]).replace(head, "").replace("</g></g>", "") + "</g></g>"


def _named(text: str, name: str) -> str:
    """Ids that something refers to as `name` and a number; the others are left out."""
    found = dict.fromkeys(re.findall(r"[(\"]#([^)\"]+)", text))
    short = {old: f"{name}{number}" for number, old in enumerate(found)}
    text = re.sub(r' id="([^"]*)"', lambda old: f' id="{short[old[1]]}"' if old[1] in short else "", text)
    return re.sub(r'([("])#([^)"]+)', lambda old: f"{old[1]}#{short[old[2]]}", text)


def _styled(text: str, name: str) -> str:
    """Styles that occur again and again as classes, `name` and a number, said once in the drawing."""
    often = [style for style, times in Counter(re.findall(r' style="([^"]*)"', text)).items() if times > 2]
    classes = {style: f"{name}-{number}" for number, style in enumerate(often)}
    text = re.sub(r' style="([^"]*)"', lambda old: f' class="{classes[old[1]]}"' if old[1] in classes else old[0], text)
    rules = "".join(f".{each}{{{style}}}\n" for style, each in classes.items())
    return text.replace("</style>", f"\n{rules}</style>", 1)


def _markers(run: re.Match[str]) -> str:
    """Markers one after another; where they have one style, in a group that has it."""
    styles = set(re.findall(r' style="([^"]*)"', run[0]))
    if len(styles) > 1:
        return run[0]
    bare = re.sub(r' style="[^"]*"', "", run[0])
    return f'<g style="{styles.pop()}">{bare}</g>'
