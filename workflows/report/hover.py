"""What a reader's pointer finds in a figure (templates/hover.js): points with their values, and where a click leads."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from workflows.report import figure_books
from workflows.results import curves
from workflows.results.crossings import Crossing, crossings
from workflows.solve.records import Mode, Results
from workflows.wording import amount, significant

_DIGITS = 7


@dataclass(frozen=True)
class Series:
    """Points under one name.

    Attributes:
        name: of all of them.
        x, y: in the units of the axes; `panel` says of which.
        notes: a line for each point, or none.
        leads: the speed kept and the mode, both from 0, that a click on each shows; None where it leads nowhere.
    """

    name: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    notes: tuple[str, ...] = ()
    leads: tuple[tuple[int, int] | None, ...] = ()
    panel: int = 0


def campbell(results: Results) -> str:
    """Frequencies with their errors, and crossings with engine orders; a click leads to the mode."""
    found = [_branch(results, branch) for branch in curves.branches(results)]
    meetings = crossings(results)
    if meetings:
        found.append(_crossings(meetings))
    return _json(found, ("{} rpm", "{} Hz"))


def working(results: Results) -> str:
    """The damping ratio by the ball over the amplitude at each load."""
    lines = curves.damping_ratio(results)
    return _json(
        (Series(line.label, tuple(1e3 * line.x), tuple(100 * line.y)) for line in lines if (line.y > 0).any()),
        ("{} mm", "{} %"),
    )


def books(results: Results) -> str:
    """Shares of the energy at the start, each in the middle of its bar in either panel."""
    found = []
    for panel, parts in enumerate((figure_books.PARTS, figure_books.PARTS[1:4])):
        for place, (rpm, energy) in enumerate(figure_books.rows(results)):
            begun = 0.0
            for name, label in parts:
                part = getattr(energy, name)
                share = 100 * part / energy.initial
                middle = begun + share / 2
                begun += share
                note = f"{amount(rpm)} rpm: {share:.6g} %, {part:.6g} J"
                found.append(Series(label, (middle,), (float(place),), (note,), panel=panel))
    return _json(found, None)


def _branch(results: Results, branch: curves.Branch) -> Series:
    modes = [results.speeds[at].modes[number] for at, number in branch.places]
    kept = () if results.surface is None else results.surface.at
    return Series(
        name=branch.label,
        x=tuple(results.speeds[at].rpm for at, _ in branch.places),
        y=tuple(mode.frequency_hz for mode in modes),
        notes=tuple(_error(mode, number) for mode, (_, number) in zip(modes, branch.places, strict=True)),
        leads=tuple((kept.index(at), number) if at in kept else None for at, number in branch.places),
    )


def _error(mode: Mode, number: int) -> str:
    named = f"mode {number + 1}"
    return named if mode.error_estimate is None else f"{named}, ± {significant(100 * mode.error_estimate, 2)} %"


def _crossings(meetings: list[Crossing]) -> Series:
    return Series(
        name="crossing",
        x=tuple(meeting.rpm for meeting in meetings),
        y=tuple(meeting.frequency_hz for meeting in meetings),
        notes=tuple(f"{meeting.order}× meets {meeting.label}" for meeting in meetings),
    )


def _json(series: Iterable[Series], units: tuple[str, str] | None) -> str:
    """The series for a page, with the units of x and y, None where the notes say it all; it ends no script element."""
    told: list[dict[str, Any]] = []
    for each in series:
        entry: dict[str, Any] = {"name": each.name, "x": _short(each.x), "y": _short(each.y), "panel": each.panel}
        told.append(entry | {"notes": each.notes, "leads": each.leads})
    return json.dumps({"units": units, "series": told}, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def _short(values: Iterable[float]) -> list[float]:
    return [float(f"{value:.{_DIGITS}g}") for value in values]
