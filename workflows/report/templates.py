"""Pages and sentences from templates, and the filters by which templates turn values into words."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows import formatting
from workflows.formatting import significant, whole
from workflows.solve import limits
from workflows.solve.results import SpeedPoint

if TYPE_CHECKING:
    from jinja2 import Environment, Template

_TEMPLATES = Path(__file__).parents[1] / "templates"


def from_template(template: str, css: str = "", **values: Any) -> str:
    """A page as text.

    Args:
        template: its name.
        css: style beside that of every page.
        values: what it shows.
    """
    style = (_TEMPLATES / "report.css").read_text(encoding="utf-8") + css
    return _environment(autoescape=True).get_template(template).render(css=style, **values)


def sentences(template: str, macro: str, *values: Any) -> list[str]:
    """Sentences that a macro of a text template makes of some values: its paragraphs, each on one line."""
    return _paragraphs(getattr(_macros(template), macro)(*values))


def said(name: str, text: str, **values: Any) -> list[str]:
    """Sentences that a text of `templates/<name>.toml` makes of some values, likewise; only that text is compiled."""
    return _paragraphs(_text(name, text).render(values))


def _macros(template: str) -> Any:
    return _environment(autoescape=False).get_template(template).module


@cache
def _text(name: str, text: str) -> Template:
    source = _texts(name)[text]
    shared = {"say": _macros("phrases.txt.j2")} if "say." in source else {}
    return _environment(autoescape=False).from_string(source, shared)


@cache
def _texts(name: str) -> dict[str, str]:
    return tomllib.loads((_TEMPLATES / f"{name}.toml").read_text(encoding="utf-8"))


def _paragraphs(text: str) -> list[str]:
    """The paragraphs of a text, each on one line."""
    paragraphs = re.split(r"\n\s*\n", text)
    lines = [re.sub(r" *\n *([,;.:]?)", lambda gap: gap[1] or " ", each.strip()) for each in paragraphs]
    return [line for line in lines if line]


@cache
def _environment(*, autoescape: bool) -> Environment:
    """Templates, each compiled once, with the filters that turn values into words."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=autoescape,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {each.__name__: each for each in _FILTERS}
    environment.globals |= {"limits": limits, "AIR": limits.AIR, "inf": math.inf}
    return environment


def script(name: str) -> str:
    """A script that stands in a page."""
    return (_TEMPLATES / name).read_text(encoding="utf-8")


def at_load(point: SpeedPoint) -> str:
    """Where in the range of speeds, within a sentence."""
    return f"at {whole(point.rpm)} rpm" if point.load_g > 0 else "at rest"


def at_speed(point: SpeedPoint) -> str:
    """A speed with its load."""
    return f"{whole(point.rpm)} rpm ({whole(point.load_g)} g)"


def stretch(chosen: Sequence[SpeedPoint], points: Sequence[SpeedPoint]) -> str:
    """Where some of the points lie among all, in few words: up to, from, from ... to; both with rising load."""
    places = sorted(points, key=lambda point: point.load_g)
    at = sorted(places.index(point) for point in chosen)
    first, last = (at_speed(places[k]) for k in (at[0], at[-1]))
    if len(at) == 1:
        return f"at {first}"
    if at[-1] - at[0] >= len(at):
        among = f"at {len(at)} of {len(places)} speeds from {first} to {last}"
        return f"at {first} and {last}" if len(at) == 2 else among
    if len(at) == len(places) or (at[0] > 0 and at[-1] < len(places) - 1):
        return f"from {first} to {last}"
    return f"up to {last}" if at[0] == 0 else f"from {first} on"


def capital(text: str) -> str:
    """The text as the begin of a sentence."""
    return text[0].upper() + text[1:]


def millimetres(length: float) -> str:
    """A length [m] in mm."""
    return significant(1e3 * length, 2)


def in_percent(share: float) -> str:
    """A share in percent."""
    return significant(100 * share, 2)


def rounded(value: float, *, up: bool = False) -> str:
    """Three digits on the safe side."""
    if value == 0:
        return "0"
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return significant((math.ceil if up else math.floor)(value / unit) * unit, 3)


def listed(items: Sequence[float | str], joint: str = "and") -> str:
    """A few levels, or texts, in words."""
    texts = [each if isinstance(each, str) else significant(each) for each in items]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} {joint} {texts[-1]}"


_FILTERS = (
    *(formatting.fixed, formatting.amount, formatting.significant, formatting.percent, formatting.prose),
    *(formatting.share, formatting.whole, formatting.span, formatting.turning, formatting.upwards),
    *(at_load, at_speed, stretch, capital, millimetres, in_percent, rounded, listed),
)
