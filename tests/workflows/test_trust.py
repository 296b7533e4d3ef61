"""An accuracy that is not met comes with what would meet it, which is tried."""

from __future__ import annotations

from dataclasses import replace

import pytest

import workflows
from tests.workflows.conftest import Scene, changed
from workflows.report import remarks
from workflows.solve.results import Results


def _plate(paper: Scene, **changes: object) -> Scene:
    alone = {table: paper[table] for table in ("title", "plate", "material")}
    alone["rotor"] = {"speeds": ["3000 rpm"], "modes": 2}
    return changed(alone, **changes)


@pytest.mark.parametrize(("accuracy", "theory"), [(1e-2, "auto"), (2e-3, "solid")])
def test_the_theory_that_would_do_does(paper: Scene, accuracy: float, theory: str) -> None:
    """Thin-plate theory is off by 5 % in the paper's twist, whatever the mesh."""
    scene = _plate(paper, accuracy__frequency=accuracy)
    said = remarks.sentence(workflows.run(scene))
    assert said is not None
    assert said.endswith(f'asked for; [plate] theory = "{theory}" would do.')
    mended = workflows.run(changed(scene, plate__theory=theory))
    assert remarks.met(mended)
    assert "would do" not in str(remarks.sentence(mended))


def test_the_effects_that_would_do_do(paper: Scene) -> None:
    """Bending in the plane of rotation is lowered by 0.4 % by Coriolis forces at 17500 rpm, and strained by 0.3 %."""
    scene = _plate(paper, accuracy__frequency=3e-3, plate__theory="mindlin", rotor__stagger="90 deg")
    scene = changed(scene, rotor__speeds=["17500 rpm"], effects={"coriolis": False})
    said = remarks.sentence(workflows.run(scene))
    assert said is not None
    assert said.endswith("asked for; [effects] coriolis = true and [effects] large_deflection = true would do.")
    assert remarks.met(workflows.run(changed(scene, effects={"coriolis": True, "large_deflection": True})))


def _with_basis(results: Results, error: float) -> Results:
    (point,) = results.speeds
    modes = tuple(replace(mode, error_parts=replace(mode.error_parts, basis=error)) for mode in point.modes)
    return replace(results, speeds=(replace(point, modes=modes),))


def test_where_nothing_would_do_it_says_what_can_be_had(paper: Scene) -> None:
    """What rounding leaves in a reduced basis, no key takes away."""
    found = _with_basis(workflows.run(_plate(paper, plate__theory="mindlin", accuracy__frequency=4e-3)), 6.2e-3)
    said = remarks.sentence(found)
    assert said is not None
    assert said.endswith("no setting achieves this, but [accuracy] frequency = 0.009 would be met.")
    assert max(mode.whole for mode in remarks.worst(found)) <= 9e-3
