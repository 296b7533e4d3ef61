"""Speeds at which the model does not hold have no verdict: nothing in the answer comes from them."""

from __future__ import annotations

import math
from typing import Any

import pytest

import workflows
from tests.workflows.conftest import KNOWN
from workflows.report import remarks
from workflows.report import text as summary
from workflows.report.remarks import assumptions, stretch
from workflows.report.verdict import answer
from workflows.solve import limits
from workflows.solve.results import Results

pytestmark = pytest.mark.usefixtures("undrawn", "quickly")


def at(*rpm: float, **damper: Any) -> Results:
    """Results at these speeds."""
    rotor = KNOWN["rotor"] | {"speeds": [f"{each:g} rpm" for each in rpm]}
    return workflows.run(KNOWN | {"rotor": rotor, "damper": KNOWN["damper"] | damper})


def load(rpm: float) -> float:
    """Centrifugal acceleration at 20 cm over g."""
    return (rpm * math.pi / 30) ** 2 * 0.2 / 9.80665


def needed(results: Results, k: int) -> float:
    """2/7 of the drive over the load and 5/7 of the rolling resistance: the friction of pure rolling."""
    amplitude = results.speeds[k].working.peak_amplitude
    drive = (2 * math.pi * 269.5) ** 2 * amplitude / 9.80665
    return 2 / 7 * drive / load(results.speeds[k].rpm) + 5 / 7 * 0.01


def test_a_ball_that_slides_supplies_no_best() -> None:
    """At 80 and 100 rpm, of which both are named, rolling takes more friction than any dry metal has."""
    found = at(80, 100, 3500)
    assert needed(found, 0) > needed(found, 1) > limits.DRY > needed(found, 2)
    assert [point.verdict.grade for point in found.speeds] == ["unknown", "unknown", "yes"]
    said = answer(found)
    assert said.verdict == (
        "Useful from 3500 rpm (2740 g) on; no verdict up to 100 rpm (2.24 g): there the ball would slide, since rolling"
        f" requires a friction of {needed(found, 1):.2g} to {needed(found, 0):.2g} at the amplitude of its best"
    )
    told = " ".join(said.sentences)
    assert "At its best, at 3500 rpm" in told
    assert "80 rpm" not in told
    assert "100 rpm" not in told


def test_where_all_slide_there_is_one_reason() -> None:
    said = answer(at(80, 100))
    assert said.verdict.startswith("No verdict: the ball would slide, since rolling requires a friction of")
    assert said.sentences == ()


def test_a_middle_of_speeds_has_both_its_ends() -> None:
    """Slow enough to slide, then good, then too fast for as much."""
    assert answer(at(100, 500, 1000, 3500, 17500)).verdict.startswith(
        "Useful from 500 rpm (55.9 g) to 3500 rpm (2740 g), of little use from 17500 rpm (68492 g) on; no verdict at"
        " 100 rpm"
    )


def test_friction_beyond_the_given_names_every_speed() -> None:
    """Less than dry metals have, more than the scene's 0.3."""
    found = at(250, 300, 3500)
    assert limits.DRY > needed(found, 0) > needed(found, 1) > 0.3 > needed(found, 2)
    assert answer(found).verdict.endswith(
        "if the ball rolls without slip, which at the amplitude of its best takes a friction of"
        f" {needed(found, 1):.2g} to {needed(found, 0):.2g} up to 300 rpm (20.1 g): 0.3 is given for the walls"
    )


def test_ring_downs_that_would_slip_are_all_named() -> None:
    found = at(400, 600, 3500)
    demands = [point.damper.largest_rolling_demand for point in found.speeds]
    assert demands[0] > demands[1] > 0.3 > demands[2]
    (said,) = (note for note in found.notes if "olling without slip" in note)
    assert f"a friction of {demands[1]:.2g} to {demands[0]:.2g} up to 600 rpm" in said


def test_below_a_load_of_1_g_the_weight_rules() -> None:
    found = at(40, 60, 3500)
    assert load(60) < 1
    verdict = answer(found).verdict
    assert (
        "; no verdict up to 60 rpm (0.805 g): there the ball's weight, which is left out, is more than the" in verdict
    )
    assert "60 rpm" not in " ".join(answer(found).sentences)
    assert answer(at(40, 60)).verdict == "No verdict: the ball's weight, which is left out, is more than the load"
    for rpm in (0, 1e-3):
        assert answer(at(rpm)).verdict == "No verdict: the ball's weight, which is left out, is more than the load"


@pytest.mark.parametrize(("rpm", "share"), [(80, 0.699), (200, 0.112), (220, None)])
def test_the_weight_is_remarked_on_down_from_10_g(rpm: float, share: float | None) -> None:
    """Weight over load: 1/load in g."""
    found = at(rpm, 3500)
    notes = [note for note in found.notes if "weight" in note]
    taken = [text for text, _ in assumptions(found) if "weight" in text]
    assert len(notes) == len(taken) == (share is not None)
    if share is not None:
        assert 1 / load(rpm) == pytest.approx(share, abs=1e-3)
        assert f"{100 / load(rpm):.2g} % of the load at {rpm} rpm" in notes[0]
        assert "once a revolution" in notes[0]


def test_rows_without_a_verdict_are_marked() -> None:
    found = at(0, 100, 3500)
    heads, *rows = summary.rows(found)
    column = heads.index("ball ζ %")
    assert [row[column].endswith(remarks.NO_VERDICT) for row in rows] == [True, True, False]
    assert remarks.NO_VERDICT_MEANS in summary.text(found, None)
    assert remarks.NO_VERDICT_MEANS not in summary.text(at(3500), None)


def test_a_stretch_of_speeds() -> None:
    found = at(400, 600, 3500, 5000).speeds
    for chosen, said in (
        ((0, 1), "up to 600 rpm (80.5 g)"),
        ((2, 3), "from 3500 rpm (2740 g) on"),
        ((1, 2), "from 600 rpm (80.5 g) to 3500 rpm (2740 g)"),
        ((0,), "at 400 rpm (35.8 g)"),
        ((0, 3), "at 400 rpm (35.8 g) and 5000 rpm (5591 g)"),
        ((0, 2, 3), "at 3 of 4 speeds from 400 rpm (35.8 g) to 5000 rpm (5591 g)"),
        ((0, 1, 2, 3), "from 400 rpm (35.8 g) to 5000 rpm (5591 g)"),
    ):
        assert stretch([found[k] for k in chosen], found) == said
