"""A forced response as a folder: JSON, netCDF, tables, pictures, and one page for a person."""

from __future__ import annotations

import json
import os
from functools import partial
from pathlib import Path
from typing import Any

from workflows import wording
from workflows.findings import worth
from workflows.output import store
from workflows.report import plots as plot
from workflows.report import templating
from workflows.studies.response import files, peaks, plots, told
from workflows.studies.response.document import document
from workflows.studies.response.records import Response, Through

FILES = r"response\.(json|nc)|campbell\.svg|response_\w+\.(csv|svg)"
"""What is written beside the usual files, as a regular expression."""


def dumps(found: Response) -> str:
    """The machine-readable result."""
    return json.dumps(document(found), indent=1, ensure_ascii=False, allow_nan=False)


def write(found: Response, out: str | os.PathLike[str]) -> Path:
    """Write `response.json`, `response.nc`, tables, pictures and `report.html` into `out`, or nothing; returns `out`.

    Raises:
        BadInput: `out` cannot be written.
    """
    page, out = render(found), Path(out)
    with store.replacing(out) as folder:
        (folder / "response.json").write_text(dumps(found) + "\n", encoding="utf-8")
        files.dataset(found).to_netcdf(folder / "response.nc", engine="h5netcdf")
        files.write_csv(found, folder)
        campbell = plot.standalone(plots.campbell(found))
        (folder / "campbell.svg").write_text(campbell, encoding="utf-8")
        for number, through in enumerate(found.passed):
            shades = plot.shades(len(through.forces))
            drawn = plot.standalone(plots.response(found, through, str(number), shades), len(shades))
            (folder / f"response_{files.tag(through)}.svg").write_text(drawn, encoding="utf-8")
        (folder / "report.html").write_text(page, encoding="utf-8")
    return out


def render(found: Response) -> str:
    """The page. Everything that comes from a scene is escaped."""
    from markupsafe import Markup

    shades = plot.shades(len(found.excitation.levels))
    sections = [_section(found, number, through, shades) for number, through in enumerate(found.passed)]
    words = (wording.fixed, wording.amount, wording.significant, wording.percent, wording.curly, wording.whole)
    return templating.page(
        "response.html.j2",
        {word.__name__: word for word in words},
        plot.shades_css(max(len(found.excitation.levels), len(found.passed), 1)),
        found=found,
        unit=found.excitation.unit,
        sentences=told.sentences(found),
        sections=sections,
        campbell=Markup(plots.campbell(found)),
        damping=Markup(plots.damping(found)),
        air=worth.AIR,
        is_beyond=partial(peaks.is_beyond, found),
        mark=worth.MARK,
        marked=worth.MARKED,
    )


def _section(found: Response, number: int, through: Through, shades: list[str]) -> dict[str, Any]:
    """What the page has of a crossing."""
    from markupsafe import Markup

    mine = [row for row in peaks.rows(found) if row.through is through]
    return {
        "through": through,
        "crossing": through.crossing,
        "rows": mine,
        "response": Markup(plots.response(found, through, str(number), shades)),
        "ratios": Markup(plots.ratios(found, through, str(number))),
        "path": Markup(plots.path(found, through, str(number))),
        "endured": peaks.endured(found, through),
        "beyond": any(peaks.is_beyond(found, row) for row in mine),
    }
