"""The cut-off that tables show: the ring-down's; where that has none, the one known of a ball at rest."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import workflows
from tests.workflows.conftest import KNOWN, changed
from workflows.report import page
from workflows.report import text as summary
from workflows.report.remarks import AT_REST, AT_REST_MEANS, remarks
from workflows.solve import limits
from workflows.solve.results import Results

pytestmark = pytest.mark.usefixtures("undrawn")

CAP = "the cap on cycles was reached while the ball still moved"


def at(cycles: int | str, *rpm: float) -> Results:
    """A ball on a level floor at 20 cm, held by a tenth of the load."""
    scene = changed(
        KNOWN,
        rotor__speeds=[f"{each:g} rpm" for each in rpm],
        damper__rolling_friction="0.1 mm",
        damper__damping_ratio=0.01,
        release={"displacement": ["20 mm", "0 mm"], "cycles": cycles},
    )
    return workflows.run(scene)


def capped(found: Results, *which: int) -> Results:
    """The same, of which some ring-downs ended by their cap."""
    speeds = list(found.speeds)
    for k in which:
        ended = replace(speeds[k].damper, outcome=CAP, cutoff_g=None, cutoff_ratio=None)
        speeds[k] = replace(speeds[k], damper=ended)
    return replace(found, speeds=tuple(speeds))


def cells(found: Results) -> list[tuple[str, str]]:
    heads, *rows = summary.rows(found)
    return [(row[heads.index("cut-off g")], row[heads.index("/ load")]) for row in rows]


def _joined(text: str) -> str:
    """Text as it was before it was wrapped, at hyphens too."""
    return text.replace("-\n", "-").replace("\n", " ")


def test_a_ring_down_without_a_cut_off_shows_the_one_of_a_ball_at_rest() -> None:
    """mu_r/r = 0.1 of the load, whatever the speed; a ring-down that ended shows its own."""
    found, loads = at(3, 3500, 10000), [(rpm * math.pi / 30) ** 2 * 0.2 / 9.80665 for rpm in (3500, 10000)]
    assert [point.damper.cutoff_g for point in found.speeds] == [None, None]
    for (g, ratio), load in zip(cells(found), loads, strict=True):
        assert ratio == f"0.100{AT_REST}"
        assert float(g.removesuffix(AT_REST).replace("\u2009", "")) == pytest.approx(0.1 * load, rel=2e-3)
    assert AT_REST_MEANS in _joined(summary.text(found, None))
    whole = at("auto", 3500, 10000)
    assert not any(AT_REST in cell for row in cells(whole) for cell in row)
    assert AT_REST_MEANS not in _joined(summary.text(whole, None))


def test_the_page_shows_the_same() -> None:
    found = at(3, 3500)
    (row,) = page._tabulated(found)["rows"]
    assert row["cutoff"] == limits.cutoff(found, found.speeds[0])
    assert AT_REST_MEANS in page._tabulated(found)["at_rest"]


def test_no_load_has_no_cut_off() -> None:
    assert cells(at(3, 0)) == [("–", "–")]


def test_every_speed_whose_ring_down_was_cut_off_is_named() -> None:
    found = at("auto", 3500, 5000, 7500, 10000)
    assert not any(CAP in note for note in remarks(found))
    for which, where in (
        ((0, 1), "Up to 5000 rpm (5591 g)"),
        ((2,), "At 7500 rpm (12580 g)"),
        ((0, 2), "At 3500 rpm (2740 g) and 7500 rpm (12580 g)"),
    ):
        (said,) = (note for note in remarks(capped(found, *which)) if CAP in note)
        assert said == f"{where} {CAP}: the cut-offs marked {AT_REST} are those of a ball at rest."
