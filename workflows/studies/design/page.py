"""A design as files: `design.json`, the winning scene as `best.toml`, and one page."""

from __future__ import annotations

import json
from pathlib import Path

from workflows import wording
from workflows.output import store
from workflows.report import plots as plot
from workflows.report import templating
from workflows.studies.design import pictures, verdict
from workflows.studies.design.designed import Designed
from workflows.studies.sweep import maps

FILES = r"design\.json|best\.toml"
"""Names of what is written besides the page, as a regular expression."""


def write(found: Designed, out: Path) -> None:
    """Write all of it into `out`, or nothing.

    Raises:
        BadInput: `out` cannot be written.
    """
    page = render(found)
    with store.replacing(out) as folder:
        (folder / "design.json").write_text(dumps(found) + "\n", encoding="utf-8")
        (folder / "report.html").write_text(page, encoding="utf-8")
        if found.toml:
            (folder / "best.toml").write_text(found.toml, encoding="utf-8")


def dumps(found: Designed) -> str:
    """The machine-readable result."""
    return json.dumps(found.document(), indent=1, ensure_ascii=False, allow_nan=False)


def text(found: Designed) -> str:
    """The answer in a few lines."""
    return "\n".join([f"{verdict.verdict(found.space, found.found)}.", *_sentences(found)])


def in_short(found: Designed) -> str:
    """The answer and what it is due to, in one line."""
    return f"{verdict.verdict(found.space, found.found)}: {_sentences(found)[0]}"


def render(found: Designed) -> str:
    """The page."""
    from markupsafe import Markup

    return templating.page(
        "design.html.j2",
        {},
        plot.shades_css(maps.SHADES),
        title=found.space.source.scene.title,
        verdict=verdict.verdict(found.space, found.found),
        sentences=_sentences(found),
        figures=[(Markup(picture.svg), picture.caption) for picture in pictures.draw(found)],
        toml=found.toml,
        evaluations=wording.fixed(found.found.evaluations),
    )


def _sentences(found: Designed) -> list[str]:
    return verdict.sentences(found.space, found.found, found.holds)
