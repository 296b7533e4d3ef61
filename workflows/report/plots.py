"""The plot helper of all pages: one style, one size that scales, and SVG in the colours and type of its page.

A figure is drawn once. Its text is legible on a phone, where the page scales it by about 1, and on a wide screen, where
the style sheet limits its width. Pages are drawn without pyplot, and matplotlib is imported only when something is
drawn.
"""

from __future__ import annotations

import html
import io
import json
import logging
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from workflows.solve.limits import AIR
from workflows.solve.results import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 4.5
"""Width of a figure [in]."""

INK, MUTED, RULE, PAPER = "#010203", "#010204", "#010205", "#010206"
"""Text and axes, secondary text, grid, and the page itself: placeholders, which a page replaces by its variables."""

_TEMPLATES = Path(__file__).parents[1] / "templates"
_CSS = (_TEMPLATES / "report.css").read_text(encoding="utf-8")
_LIGHT = dict(re.findall(r"(--[\w-]+): (#\w+)", _CSS.partition("@media")[0])) | {"--paper": "#ffffff"}
"""The colours of a light page, whose style sheet is their one source; a picture by itself lies on white."""

CATEGORIES = tuple(colour for name, colour in _LIGHT.items() if name.startswith("--line-"))
"""After Okabe and Ito (2008): told apart with any kind of colour vision; `--text-N` are the same for text."""

MARKERS = ("o", "s", "^", "D", "v", "P", "X")

DASHED, DOTTED = (0, (4, 3)), (0, (1, 2))

_FAMILIES = ("flap", "twist", "lag", "chord", "axial")
"""Families of modes in the order of the colours and markers; any other has those that follow."""

_VARIABLES = {INK: "--ink", MUTED: "--muted", RULE: "--rule", PAPER: "--paper"} | {
    colour: f"--line-{i}" for i, colour in enumerate(CATEGORIES)
}

_NAMED_AT_MOST, _NAMED_OF_MANY = 16, 9
"""Curves that a legend names all, and how many it names of more: from the first to the last, evenly."""

_APART = 2.0
"""Points between two values that have a title each."""

_REACH = 5.0
"""Radius in points around a value within which the pointer shows its title."""


@dataclass(frozen=True)
class Value:
    """A value in the first axes of a figure that says itself under the pointer.

    Attributes:
        x, y: its place, in the units of the axes.
        title: what it says.
        mode: the speed kept and the mode, both from 0, that it leads to in the viewer; None: it leads nowhere.
    """

    x: float
    y: float
    title: str
    mode: tuple[int, int] | None = None


@contextmanager
def style() -> Iterator[None]:
    """The look of all figures; whatever is drawn, is drawn inside."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it remarks on a home that cannot be written
    import matplotlib as mpl

    interactive = mpl.is_interactive()
    try:
        with mpl.rc_context(mpl.rc_params_from_file(_TEMPLATES / "plots.mplstyle", use_default_template=False)):
            try:
                yield
            finally:
                interactive = mpl.is_interactive()  # pyplot's backend of a notebook, loaded inside, switches it on
    finally:
        mpl.interactive(interactive)


class Target(NamedTuple):
    """Where a figure is drawn: on a figure for a page, on a new current figure of pyplot, or into axes that exist."""

    pyplot: bool = False
    ax: Axes | None = None


PAGE = Target()
"""A figure for a page."""


def canvas(height: float, panels: int = 1, target: Target = PAGE) -> tuple[Figure, list[Axes]]:
    """A figure with panels one below the other, each `height` inches high; or the axes of the target, for one panel.

    Margins are measured once all is drawn, so that whatever labels come out have room.
    """
    if target.ax is not None:
        whole: Any = target.ax.get_figure(root=True)
        return whole, [target.ax]
    size = (WIDTH, panels * height)
    if target.pyplot:
        from matplotlib import pyplot

        figure = pyplot.figure(figsize=size)
    else:
        from matplotlib.figure import Figure

        figure = Figure(figsize=size)
    figure.set_layout_engine("constrained", hspace=0.08)
    axes = [figure.add_subplot(panels, 1, i + 1) for i in range(panels)]
    for each in axes:
        each.locator_params(axis="x", nbins=6)
    return figure, axes


def legend(figure: Figure, axes: Axes, target: Target = PAGE, **how: Any) -> None:
    """A legend of the curves of `axes` below the figure, or inside axes that existed; of many it names some."""
    curves = axes.get_legend_handles_labels()
    if (count := len(curves[0])) > _NAMED_AT_MOST:
        named = [round(k * (count - 1) / (_NAMED_OF_MANY - 1)) for k in range(_NAMED_OF_MANY)]
        curves = [curves[0][k] for k in named], [curves[1][k] for k in named]
        how["title"] = f"{how.get('title', 'curves')}, {_NAMED_OF_MANY} of {count}"
    if target.ax is not None:
        axes.legend(*curves, title=how.get("title"))
        return
    loc, ncols = how.pop("loc", "outside lower left"), how.pop("ncols", 3)
    figure.legend(*curves, loc=loc, ncols=ncols, alignment="left", **how)


def air(axes: Axes) -> None:
    """What the air does on turbine blades, as a band of damping ratios in %."""
    axes.axhspan(100 * AIR[0], 100 * AIR[1], color=RULE, lw=0)


def damping_axes(axes: Axes) -> None:
    """Logarithmic axes of the damping ratio by the ball [%] over the amplitude [mm], beside what the air does."""
    axes.set(xscale="log", yscale="log", xlabel="amplitude at the cavity, mm", ylabel="damping ratio by the ball, %")
    air(axes)


def damping_curve(axes: Axes, amplitude: Floats, damping_ratio: Floats, **how: Any) -> None:
    """A curve in such axes, where it damps: amplitudes [m] and damping ratios, (n,)."""
    shown = damping_ratio > 0
    axes.plot(1e3 * amplitude[shown], 100 * damping_ratio[shown], **how)


def note(
    axes: Axes, text: str, place: tuple[float, float], offset: tuple[float, float], coords: Any = "data", **how: Any
) -> None:
    """Words so many points beside a place; coords: what its x and y are in, as matplotlib calls it."""
    axes.annotate(text, place, offset, xycoords=coords, textcoords="offset points", **how)


def plain(drawn: Iterable[Axes]) -> None:
    """Plain numbers on logarithmic axes, where matplotlib would have powers of ten; 1, 2, 5 of few decades."""
    from matplotlib.ticker import LogLocator, NullFormatter

    for axes in drawn:
        for axis in (axes.xaxis, axes.yaxis):
            if axis.get_scale() == "log" and axis.isDefault_majfmt:
                low, high = sorted(axis.get_view_interval())  # an axis may run backwards
                if 0 < high < _FEW_DECADES * low:
                    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
                    axis.set_minor_formatter(NullFormatter())
                axis.set_major_formatter("{x:g}")


_FEW_DECADES = 1e3
"""End over begin of a logarithmic axis up to which 1, 2 and 5 of each decade are labelled."""


def svg(figure: Figure, name: str, description: str, values: Iterable[Value] = (), *, frames: bool = False) -> str:
    """The figure as an SVG element for a page.

    Args:
        figure: as matplotlib has it.
        name: keeps its ids apart from those of other figures.
        description: what it shows, for readers who do not see it.
        values: those that have a title.
        frames: whether it carries the places of its axes, so that a script finds the place of a value.

    Returns:
        The element, in the variables of the page's style sheet.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    plain(figure.axes)
    out = io.StringIO()
    canvas: Any = FigureCanvasSVG(figure)
    canvas.print_svg(out, metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    titles = _titles(figure, values)
    role = "group" if "<a " in titles else "img"
    axes = f" data-axes='{json.dumps(_frames(figure))}'" if frames else ""
    drawn = _for_a_page(out.getvalue(), name)
    drawn = drawn.replace("<svg", f'<svg role="{role}" aria-label="{html.escape(description)}"{axes}', 1)
    return drawn.replace("</svg>", f"{titles}</svg>")


def standalone(drawn: str, count: int = 1) -> str:
    """An SVG for a page as a file of its own, in the colours of a light page, `count` of them shades."""
    light = _LIGHT | {"--sans": "sans-serif"}
    light |= {f"--shade-{i}": colour for i, colour in enumerate(_plasma(_ON_LIGHT, count))}
    for variable, colour in light.items():
        drawn = drawn.replace(f"var({variable})", colour)
    width, height = re.findall(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', drawn)[0]
    ground = f'<rect width="{width}" height="{height}" fill="#ffffff"/>'
    start = drawn.index(">", drawn.index("<svg")) + 1
    return drawn[: start - 1] + ' xmlns="http://www.w3.org/2000/svg">' + ground + drawn[start:] + "\n"


def coloured(drawn: Figure | Axes, count: int) -> None:
    """Replace placeholders in a figure, or in axes, by the colours of a light page, `count` of them shades."""
    from matplotlib.colors import to_hex, to_rgba

    known = {place: _LIGHT[_VARIABLES[place]] for place in (INK, MUTED, RULE, PAPER)}
    known |= dict(zip(shades(count), _plasma(_ON_LIGHT, count), strict=False))
    for artist in drawn.findobj():
        for part in ("color", "edgecolor", "facecolor", "markeredgecolor", "markerfacecolor"):
            colour: Any = getattr(artist, f"get_{part}", lambda: None)()
            with suppress(ValueError, TypeError):
                to = known.get(to_hex(colour))
                if to is not None and to_rgba(colour)[3] > 0:
                    getattr(artist, f"set_{part}")(to)


def of_family(name: str) -> tuple[str, str]:
    """Colour and marker of a family of modes, the same in every diagram."""
    k = _FAMILIES.index(name) if name in _FAMILIES else len(_FAMILIES)
    return CATEGORIES[k], MARKERS[k]


def shades(count: int) -> list[str]:
    """Colours for an ordered family of curves, dark to bright; placeholders like the others."""
    return [f"#0203{i:02x}" for i in range(min(count, 256))] + ["#0203ff"] * (count - 256)


_ON_LIGHT = 0.05, 0.76
"""Part of the map of colours whose shades are told apart on a light page."""


def shades_css(count: int) -> str:
    """The variables behind :func:`shades`, for a light and for a dark page."""

    def block(part: tuple[float, float]) -> str:
        colours = _plasma(part, count)
        return ":root{" + "".join(f"--shade-{i}:{colour};" for i, colour in enumerate(colours)) + "}"

    return f"{block(_ON_LIGHT)}@media screen and (prefers-color-scheme: dark){{{block((0.34, 0.97))}}}"


def _plasma(part: tuple[float, float], count: int) -> list[str]:
    """Colours from a part of the map of that name, 256 at most."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    low, high = part
    steps = [low + (high - low) * i / max(count - 1, 1) for i in range(min(count, 256))]
    return [to_hex(colour) for colour in colormaps["plasma"](steps)]


def _titles(figure: Figure, values: Iterable[Value]) -> str:
    """A group of shapes that are not painted, each with a title that a browser shows under the pointer."""
    height, shapes, taken = 72.0 * figure.get_figheight(), list[str](), set()
    for value in values:
        axes = figure.axes[0]
        (x, y), box = axes.transData.transform((value.x, value.y)).tolist(), axes.bbox
        place = round(x / _APART), round(y / _APART)
        inside = box.x0 - 1 <= x <= box.x1 + 1 and box.y0 - 1 <= y <= box.y1 + 1
        if inside and place not in taken:
            taken.add(place)
            shape = f'<circle cx="{x:.1f}" cy="{height - y:.1f}" r="{_REACH:g}"/>'
            tag = "g" if value.mode is None else f'a href="#plate" data-mode="{value.mode[0]},{value.mode[1]}"'
            shapes.append(f"<{tag}><title>{html.escape(value.title)}</title>{shape}</{tag[0]}>")
    if not shapes:
        return ""
    return '<g class="values" fill="none" pointer-events="all">\n' + "\n".join(shapes) + "\n</g>\n"


def _frames(figure: Figure) -> list[dict[str, Any]]:
    """Where the axes are in the drawing (left, right, top, bottom), and what they run over."""
    width, height = (72.0 * side for side in figure.get_size_inches())
    frames = []
    for axes in figure.axes:
        box = axes.get_position()
        sides = (box.x0 * width, box.x1 * width, (1 - box.y1) * height, (1 - box.y0) * height)
        ends = {"x": [float(end) for end in axes.get_xlim()], "y": [float(end) for end in axes.get_ylim()]}
        frames.append({"box": [round(float(side), 2) for side in sides]} | ends)
    return frames


def _for_a_page(text: str, name: str) -> str:
    """What matplotlib writes as an element of a page: without a size, in the page's colours and type, and small."""
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r'\sxmlns(:\w+)?="[^"]*"', "", text).replace("xlink:href", "href")
    text = re.sub(r' (?:width|height)="[^"]*"', "", text, count=2)  # the first are those of the whole
    text = re.sub(r"'DejaVu Sans'(?:, sans-serif)?", "var(--sans)", text)
    text = re.sub(r' (?:d|x|y)="[^"]*"', lambda path: re.sub(r"(\.\d\d)\d+", r"\1", path[0]), text)
    text = re.sub(r'(?<= d=")[^"]*', lambda path: re.sub(r"\s*([A-Za-z\n])\s*", r"\1", path[0].strip()), text)
    for colour, variable in _VARIABLES.items():
        text = text.replace(colour, f"var({variable})")
    text = re.sub(r'(<text style="[^"]*)var\(--line-', r"\1var(--text-", text)
    text = re.sub(r"#0203([0-9a-f]{2})", lambda shade: f"var(--shade-{int(shade[1], 16)})", text)
    text = re.sub(r">\s+<", ">\n<", text)
    return _styled(_named(text, name), name)


def _named(text: str, name: str) -> str:
    """Ids that something refers to as `name` and a number; the others are left out."""
    short = {old: f"{name}{k}" for k, old in enumerate(dict.fromkeys(re.findall(r"[(\"]#([^)\"]+)", text)))}
    text = re.sub(r' id="([^"]*)"', lambda old: f' id="{short[old[1]]}"' if old[1] in short else "", text)
    return re.sub(r'([("])#([^)"]+)', lambda old: f"{old[1]}#{short[old[2]]}", text)


def _styled(text: str, name: str) -> str:
    """Styles that occur more than twice as classes, `name` and a number, said once in the drawing."""
    often = [style for style, times in Counter(re.findall(r' style="([^"]*)"', text)).items() if times > 2]
    classes = {style: f"{name}-{number}" for number, style in enumerate(often)}
    text = re.sub(r' style="([^"]*)"', lambda old: f' class="{classes[old[1]]}"' if old[1] in classes else old[0], text)
    rules = "".join(f".{each}{{{style}}}\n" for style, each in classes.items())
    return text.replace("</style>", f"\n{rules}</style>", 1)
