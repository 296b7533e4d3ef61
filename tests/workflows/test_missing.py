"""The material that a cavity takes out of the plate: to first order a negative mass, which a positive one witnesses."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import workflows
from tests.workflows.conftest import Scene, changed
from workflows import pipeline
from workflows.progress import Stages
from workflows.report import remarks
from workflows.scene.load import opened
from workflows.solve import limits


def _frequency(scene: Scene) -> float:
    (point,) = pipeline.structure(opened(scene), Stages(visible=False), shapes=False).points
    return point.reduced.f2_hz


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("rpm", [0, 17500])
def test_as_much_mass_more_lowers_what_the_hole_raises(paper: Scene, rpm: int) -> None:
    """Half of the difference between a tip mass of m and one of 2 m from none: the second order cancels.

    At 17500 rpm the mass pulls too, and stiffens what it slows: a fifth of the shift at rest is left.
    """
    scene = changed(paper, rotor__speeds=[f"{rpm} rpm"], release__cycles=1)
    run = workflows.run(scene)
    hole, (point,) = limits.cavity_mass(run), run.speeds
    assert hole.mass == pytest.approx(7850 * 58 * 2.5e-3 * 2.4e-3 * 2e-3)
    one, two = (_frequency(changed(scene, plate__tip_mass=k * hole.mass)) for k in (1, 2))
    none = point.reduced.f2_hz
    slope = (-3 * none + 4 * one - two) / 2 / none
    assert hole.shift == pytest.approx(-slope, rel=0.02)


@pytest.mark.usefixtures("quickly")
def test_what_is_said(paper: Scene) -> None:
    said = remarks.sentence(workflows.run(changed(paper, rotor__speeds=[0], release__cycles=1)))
    assert said is not None
    assert "That is of the plate before its 58 cavities are cut: 5.5 g less raise its first bending frequency" in said
    few = changed(paper, rotor__speeds=[0], release__cycles=1, damper__count=1)
    assert "cut" not in str(remarks.sentence(workflows.run(few))), "0.015 %"
    housed = changed(paper, rotor__speeds=[0], release__cycles=1, damper__housing="5 g")
    assert limits.cavity_mass(workflows.run(housed)) is None, "it stands out of the plate"


def test_none_without_a_plate() -> None:
    scene = SimpleNamespace(damper=SimpleNamespace(housing=None), material=None)
    assert limits.cavity_mass(SimpleNamespace(scene=scene, speeds=np.empty(0))) is None  # type: ignore[arg-type]
