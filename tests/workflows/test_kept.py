"""Results that come back from their folder."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import Any

import h5netcdf
import numpy as np
import pytest

import spindamp
import workflows
from tests.workflows.conftest import Scene, changed, python

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
    back = spindamp.load_results(tmp_path / "out")
    assert back.scene == found.scene
    assert back.effects == found.effects
    assert back.speeds[0].cavity_modes == found.speeds[0].cavity_modes
    np.testing.assert_array_equal(back.surface.shapes, found.surface.shapes)
    np.testing.assert_array_equal(back.surface.thickness, found.surface.thickness)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("results.json", None),
        ("results.json", b""),
        ("results.json", b"[]"),
        ("results.json", b"[" * 100_000),
        ("results.json", b'{"schema_version": 1}'),
        ("results.json", b'{"schema_version": 99}'),
        ("results.nc", None),
        ("results.nc", b""),
        ("results.nc", b"no HDF5"),
    ],
)
def test_what_is_no_run_says_so(finished: Path, name: str, content: bytes | None, tmp_path: Path) -> None:
    for each in ("results.json", "results.nc"):
        shutil.copy(finished / each, tmp_path / each)
    if content is None:
        (tmp_path / name).unlink()
    else:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(workflows.BadInput, match=r"folder = [^\n]*(no run|is damaged|version 99)[^\n]*$"):
        spindamp.load_results(tmp_path)
    with pytest.raises(TypeError):
        spindamp.load_results(3)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["results.json", "results.nc"])
def test_a_pipe_is_not_waited_for(name: str, finished: Path, tmp_path: Path) -> None:
    for each in ("results.json", "results.nc"):
        shutil.copy(finished / each, tmp_path / each)
    (tmp_path / name).unlink()
    os.mkfifo(tmp_path / name)
    done = python("-c", f"import spindamp; spindamp.load_results({str(tmp_path)!r})")
    assert f"expected a file {name}, found a pipe: run it again" in done.stderr.splitlines()[-1]


def test_rubbish_within_hdf5_is_one_line(finished: Path, tmp_path: Path) -> None:
    """A byte in a thousand turned over, so that what lists the groups is wrong, or what they hold."""
    shutil.copy(finished / "results.json", tmp_path)
    content = bytearray((finished / "results.nc").read_bytes())
    for place in range(200, len(content), 997):
        content[place] ^= 0xFF
    (tmp_path / "results.nc").write_bytes(content)
    done = python("-m", "workflows.cli", "view", tmp_path, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert len(done.stderr.splitlines()) == 1, done.stderr


def test_an_older_folder_is_refused_by_its_version(finished: Path, tmp_path: Path) -> None:
    """Before the third version a file of its own kept the run."""
    shutil.copy(finished / "results.json", tmp_path)
    with h5netcdf.File(tmp_path / "results.nc", "w") as file:
        file.attrs["title"] = "older"
    with pytest.raises(workflows.BadInput, match=r"folder = [^\n]*version 2 [^\n]*expected 3; run it again$"):
        spindamp.load_results(tmp_path)
