"""Pages and sentences from templates, and the filters by which templates turn values into words."""

import math
import re
import tomllib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import BaseLoader, Environment, FileSystemLoader, FunctionLoader, StrictUndefined, pass_context
from jinja2.runtime import Context

from workflows import formatting
from workflows.solve import limits
from workflows.solve.results import SpeedPoint

_TEMPLATES = Path(__file__).parents[1] / "templates"


def from_template(template: str, css: str = "", **values: Any) -> str:
    """A page as text.

    Args:
        template: its name.
        css: style beside that of every page.
        values: what it shows.
    """
    return _pages().get_template(template).render(css=_text("report.css") + css, **values)


def said(text: str, balls: int = 1, **values: Any) -> list[str]:
    """Sentences that a text makes of some values: its paragraphs, each on one line.

    Args:
        text: `file/name`: of `templates/<file>.toml`; only that text is compiled.
        balls: of `{ball|balls}` in a text, one ball has the first, more have the second, and `#` there is their number.
        values: what it shows; another text has them too: `say(name)`, of phrases.toml, or `say("file/name")`.
    """
    paragraphs = re.split(r"\n\s*\n", _texts(several=balls != 1).get_template(text).render(values, balls=balls))
    lines = [re.sub(r" *\n *([,;.:]?)", lambda gap: gap[1] or " ", each.strip()) for each in paragraphs]
    return [line for line in lines if line]


_BY_NUMBER = re.compile(r"(?<!\{)\{([^{}|%#]*)\|([^{}|]*)\}(?!\})")


@cache
def _pages() -> Environment:
    return _environment(FileSystemLoader(_TEMPLATES), autoescape=True)


@cache
def _texts(*, several: bool) -> Environment:
    def source(name: str) -> str:
        file, text = name.split("/")
        return _BY_NUMBER.sub(lambda of: of[2].replace("#", "{{ balls }}") if several else of[1], texts(file)[text])

    @pass_context
    def say(context: Context, name: str, **values: Any) -> str:
        text = environment.get_template(name if "/" in name else f"phrases/{name}")
        return text.render(context.get_all(), **values)

    environment = _environment(FunctionLoader(source), autoescape=False)
    environment.globals["say"] = say
    return environment


@cache
def texts(name: str) -> dict[str, Any]:
    """What a TOML file among the templates holds."""
    return tomllib.loads(_text(f"{name}.toml"))


def _text(name: str) -> str:
    """A file that stands beside the templates, such as a script in a page."""
    return (_TEMPLATES / name).read_text(encoding="utf-8")


def _environment(loader: BaseLoader, *, autoescape: bool) -> Environment:
    """Templates, each compiled once, with the filters that turn values into words."""
    environment = Environment(
        loader=loader, autoescape=autoescape, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {each.__name__: each for each in _FILTERS}
    environment.globals |= {"limits": limits, "AIR": limits.AIR, "inf": math.inf, "script": _text}
    return environment


def at_load(point: SpeedPoint) -> str:
    """Where in the range of speeds, within a sentence."""
    return f"at {formatting.turning(point.omega)}" if point.load_g > 0 else "at rest"


def at_speed(point: SpeedPoint) -> str:
    """A speed with its load."""
    return f"{formatting.turning(point.omega)} ({formatting.whole(point.load_g)} g)"


def stretch(chosen: Sequence[SpeedPoint], points: Sequence[SpeedPoint]) -> str:
    """Where some of the points lie among all, in few words: at, up to, from ... to; both with rising load."""
    places = sorted(points, key=lambda point: point.load_g)
    at = sorted(places.index(point) for point in chosen)
    first, last = (at_speed(places[k]) for k in (at[0], at[-1]))
    if first == last:
        return f"at {first}"
    if at[-1] - at[0] >= len(at):
        among = f"at {len(at)} of {len(places)} speeds from {first} to {last}"
        return f"at {first} and {last}" if len(at) == 2 else among
    return f"up to {last}" if at[0] == 0 and len(at) < len(places) else f"from {first} to {last}"


def capital(text: str) -> str:
    """The text as the begin of a sentence."""
    return text[0].upper() + text[1:]


def millimetres(length: float) -> str:
    """A length [m] in mm."""
    return formatting.significant(1e3 * length, 2)


def mm(length: float) -> str:
    """The same in more digits, with the unit."""
    return f"{formatting.significant(1e3 * length)} mm"


def in_mm(length: float) -> str:
    """A coordinate in mm."""
    return formatting.significant(1e3 * length, 4)


def in_percent(share: float) -> str:
    """A share in percent."""
    return formatting.significant(100 * share, 2)


def rounded(value: float, *, up: bool = False) -> str:
    """Three digits on the safe side."""
    if value == 0:
        return "0"
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return formatting.significant((math.ceil if up else math.floor)(value / unit) * unit, 3)


_FILTERS = (
    *(formatting.fixed, formatting.amount, formatting.significant, formatting.percent, formatting.prose),
    *(formatting.share, formatting.whole, formatting.span, formatting.turning),
    *(formatting.apart, formatting.beside, formatting.interval, formatting.listed),
    *(at_load, at_speed, stretch, capital, millimetres, mm, in_mm, in_percent, rounded),
)
