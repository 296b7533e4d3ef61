"""What a scene is told in the words it was written in: units of slopes, a range, weight at rest, a misspelt choice."""

from __future__ import annotations

import pytest

from tests.workflows.conftest import changed
from workflows.errors import BadInput
from workflows.scene import quantities
from workflows.scene.load import parse
from workflows.studies.sweep import study


@pytest.mark.parametrize(
    ("text", "value"),
    [("6.9 1/m", 6.9), ("6.9 rad/m", 6.9), ("0.4 deg/mm", 6.98131700798), ("400 deg/m", 6.98131700798), (3, 3.0)],
)
def test_a_slope_may_be_an_angle_over_a_length(text, value):
    assert quantities.to_si(text, quantities.SLOPE) == pytest.approx(value, rel=1e-9)


@pytest.mark.parametrize("text", ["0.4 deg", "0.4 deg/s", "0.4 deg^2/m"])
def test_other_angles_are_no_slopes(text):
    with pytest.raises(quantities.UnitError, match=r"6\.9 1/m"):
        quantities.to_si(text, quantities.SLOPE)


@pytest.mark.parametrize("typed", ["0.1 mm:4 mm", "log:100 um:4e-1 cm"])
def test_a_range_is_quoted_as_it_was_typed(typed):
    with pytest.raises(BadInput, match="needs its COUNT") as found:
        study.asked("structure", [f"damper.clearance={typed}"])
    assert f"damper.clearance = '{typed}'" in str(found.value)


def test_the_weight_left_out_is_said(structure):
    from workflows import pipeline
    from workflows.report import remarks

    for rpm, said in (("0 rpm", True), ("4000 rpm", False)):
        scene = changed(structure, rotor__speeds=[rpm], release__cycles=2)
        found = remarks.assumptions(pipeline.run(scene))
        assert any("weight is left out: at 0 rpm" in text for text, _ in found) is said


def test_a_misspelt_floor(structure):
    free = {"floor_radius": ["flatt", "8 mm"], "amplitude": ["1 mm", "2 mm"]}
    with pytest.raises(BadInput, match="did you mean 'flat'"):
        parse(structure | {"design": free})


def test_balls_as_heavy_as_the_structure_are_taken(structure):
    assert parse(changed(structure, damper__mass_ratio=10)).damper.mass_ratio == 10
