"""The colours of a drawing: placeholders in it, CSS variables in a page, and what they are on a light one.

So one picture serves light, dark and print.
"""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INK, MUTED, RULE, PAPER = "#010203", "#010204", "#010205", "#010206"
"""Text and axes, secondary text, grid, and the page itself."""

CATEGORIES = ("#0072b2", "#d55e00", "#009e73", "#a0568c", "#c48a00", "#3f9bd1", "#7f7f7f")
"""After Okabe and Ito (2008): told apart with any kind of colour vision."""

_WRITTEN = ("#0072b2", "#b34f00", "#00795a", "#a0568c", "#8a6000", "#2474a6", "#6b6b6b")
"""The same in a light page where words have them: with a contrast of 4.5 and more."""

MARKERS = ("o", "s", "^", "D", "v", "P", "X")

_FAMILIES = ("flap", "twist", "lag", "chord", "axial")
"""Families of modes in the order of the colours and markers; what else there may be has those that follow."""


def of_family(name: str) -> tuple[str, str]:
    """Colour and marker of a family of modes, the same in every diagram."""
    k = _FAMILIES.index(name) if name in _FAMILIES else len(_FAMILIES)
    return CATEGORIES[k], MARKERS[k]


VARIABLES = {INK: "--ink", MUTED: "--muted", RULE: "--rule", PAPER: "--paper"} | {
    colour: f"--line-{i}" for i, colour in enumerate(CATEGORIES)
}
LIGHT = {"--ink": "#1c1d20", "--muted": "#6b6d73", "--rule": "#e2dfd6", "--paper": "#ffffff"}
"""The colours of a light page."""


def standalone(drawn: str) -> str:
    """An SVG for a page as a file of its own, in the colours of a light page."""
    light = LIGHT | {"--sans": "sans-serif"} | {f"--line-{i}": colour for i, colour in enumerate(CATEGORIES)}
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
    known = {place: LIGHT[VARIABLES[place]] for place in (INK, MUTED, RULE, PAPER)}
    known |= {place: to_hex(colormaps["plasma"](step)) for place, step in zip(shades(count), steps, strict=False)}
    for artist in figure.findobj():
        for part in ("color", "edgecolor", "facecolor", "markeredgecolor", "markerfacecolor"):
            found: Any = getattr(artist, f"get_{part}", lambda: None)()
            with suppress(ValueError, TypeError):
                to = known.get(to_hex(found))
                if to is not None and to_rgba(found)[3] > 0:
                    getattr(artist, f"set_{part}")(to)
    figure.set_facecolor(LIGHT["--paper"])
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
