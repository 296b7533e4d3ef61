"""Pages from templates: one environment, in which everything that comes from a scene is escaped."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

_TEMPLATES = Path(__file__).parents[1] / "templates"


def page(template: str, words: Mapping[str, Callable[..., str]], css: str = "", **values: Any) -> str:
    """A page as text.

    Args:
        template: its name.
        words: the filters by which it turns values into words.
        css: style beside that of every page.
        values: what it shows.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= words
    style = (_TEMPLATES / "report.css").read_text(encoding="utf-8") + css
    return environment.get_template(template).render(css=Markup(style), **values)


def script(name: str) -> str:
    """A script that stands in a page."""
    return (_TEMPLATES / name).read_text(encoding="utf-8")
