"""Results that come back from their folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import spindamp
import workflows
from tests.workflows.conftest import Scene, changed

pytestmark = pytest.mark.usefixtures("undrawn")


def test_what_comes_back_is_what_was_written(finished: Path, document: dict[str, Any], tmp_path: Path) -> None:
    """Every number of results.json, its picture of the mode, and the page made anew."""
    back = spindamp.load_results(finished)
    again = json.loads(json.dumps(workflows.document(back)))
    assert again == document
    assert repr(back).startswith("The paper's plate")
    page = spindamp.report(back, tmp_path / "again.html").read_text(encoding="utf-8")
    theirs = (finished / "report.html").read_text(encoding="utf-8")
    verdict = theirs.partition('class="verdict">')[2].partition("<")[0]
    assert verdict
    assert verdict in page
    assert "data:image/png" in page


def test_names_and_varying_thickness_survive(paper: Scene, tmp_path: Path) -> None:
    scene = changed(
        paper,
        material={"name": "Ti-6Al-4V"},
        plate__thickness={"x": [0, 0.2], "values": [[0.01], [0.008]]},
        rotor__speeds=["5000 rpm"],
        damper__mass_ratio=None,
        damper__ball_material="tungsten carbide",
        effects=None,
    )
    found = spindamp.run(scene)
    spindamp.save(found, tmp_path / "out")
    back = spindamp.load_results(tmp_path / "out" / "run.npz")
    assert back.scene == found.scene
    assert back.effects == found.effects
    assert back.speeds[0].cavity_modes == found.speeds[0].cavity_modes
    np.testing.assert_array_equal(back.surface.shapes, found.surface.shapes)
    np.testing.assert_array_equal(back.surface.thickness, found.surface.thickness)


@pytest.mark.parametrize("content", [None, b"", b"PK\x03\x04 no", "pickle", "other version", "not a run"])
def test_what_is_no_run_says_so(content: object, tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    texts = {"other version": '{"version": 99, "run": 0}', "not a run": '{"version": 1, "run": {"record": "os"}}'}
    if content == "pickle":
        np.savez(path, tree=np.array([object()]))
    elif isinstance(content, str):
        np.savez(path, tree=np.frombuffer(texts[content].encode(), np.uint8))
    elif isinstance(content, bytes):
        path.write_bytes(content)
    with pytest.raises(workflows.BadInput, match=r"folder = .*run|run"):
        spindamp.load_results(tmp_path)
    with pytest.raises(TypeError):
        spindamp.load_results(3)  # type: ignore[arg-type]
