"""The same scene gives the same bits, and every file says which scene and which versions it comes from."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
from pathlib import Path
from typing import Any

import pytest

from tests.workflows.conftest import Command, Scene, changed, python, write
from workflows.effects import selection
from workflows.io import provenance
from workflows.scene.load import parse
from workflows.solve.results import Results

TIMES = {"results.json": rb'"timings": \{[^}]*\},', "report.html": rb"Time in seconds: [^\n]*"}
"""What may differ between two runs."""


@pytest.fixture(scope="module")
def again(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The paper's scene once more, by a process of its own with another seed for its hashes."""
    folder = tmp_path_factory.mktemp("again")
    seed = "1" if os.environ.get("PYTHONHASHSEED") != "1" else "2"
    out, environment = folder / "out", os.environ | {"PYTHONHASHSEED": seed}
    assert python("-m", "workflows.cli", "run", "--out", out, env=environment).returncode == 0
    return folder / "out"


def test_same_scene_same_bits(finished: Path, again: Path) -> None:
    names = {path.name for path in finished.iterdir()}
    assert names == {path.name for path in again.iterdir()}
    assert {"results.json", "results.nc", "modes.vtu", "report.html"} < names
    for name in names:
        one, other = (folder / name for folder in (finished, again))
        times = TIMES.get(name)
        if times is None:
            assert one.read_bytes() == other.read_bytes(), name
        else:
            assert len(re.findall(times, one.read_bytes())) == 1
            assert re.sub(times, b"", one.read_bytes()) == re.sub(times, b"", other.read_bytes()), name


def test_every_file_says_where_it_comes_from(finished: Path, document: dict[str, Any]) -> None:
    import xarray as xr

    found = document["scene_sha256"]
    for name in ("results.json", "report.html", "modes.vtu"):
        text = (finished / name).read_text(encoding="utf-8")
        assert found in text, name
        assert document["versions"]["numpy"] in text, name
    with xr.open_dataset(finished / "results.nc", engine="h5netcdf") as data:
        assert data.attrs["scene_sha256"] == found
        assert f"numpy {document['versions']['numpy']}" in data.attrs["versions"]


def test_the_hash_can_be_checked_with_other_means(document: dict[str, Any]) -> None:
    canonical = json.dumps(document["scene"], sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    assert hashlib.sha256(canonical.encode()).hexdigest() == document["scene_sha256"]


def _hash(scene: Scene) -> str:
    given = parse(scene)
    return provenance.scene_sha256(Results(given, selection.resolve(given), speeds=()))


def test_a_scene_has_one_hash_however_it_is_written(structure: Scene) -> None:
    same = changed(structure, damper__radius=0.001, rotor__hub_radius="0 mm", damper__formulation="consistent")
    assert _hash(dict(reversed(same.items()))) == _hash(structure)
    assert _hash(changed(structure, damper__radius=0.0010000001)) != _hash(structure)
    assert _hash(changed(structure, effects={"impact_friction": False})) != _hash(structure)


def test_a_mesh_file_counts_by_its_bytes(tmp_path: Path, spindamp: Command) -> None:
    import xarray as xr

    mesh = Path(__file__).parents[2] / "meshes" / "blade.msh"
    shutil.copy(mesh, tmp_path / "blade.msh")
    scene = {
        "plate": {"mesh": "blade.msh", "thickness": 2e-3},
        "material": {"youngs_modulus": 1e11, "poissons_ratio": 0.3, "density": 4400.0},
        "rotor": {"speeds": [100.0], "modes": 1},
        "accuracy": {"frequency": 0.5},
    }
    out = tmp_path / "out"
    assert spindamp("run", write(scene, tmp_path / "scene.toml"), "--out", out).status == 0
    found = hashlib.sha256(mesh.read_bytes()).hexdigest()
    assert json.loads((out / "results.json").read_text(encoding="utf-8"))["mesh_sha256"] == found
    for name in ("report.html", "modes.vtu"):
        assert found in (out / name).read_text(encoding="utf-8"), name
    with xr.open_dataset(out / "results.nc", engine="h5netcdf") as data:
        assert data.attrs["mesh_sha256"] == found


def test_names_are_those_of_the_json(finished: Path, document: dict[str, Any]) -> None:
    import xarray as xr

    point = document["speeds"][0]
    names = {"rpm", "load_g", "duration", *point["modes"][0], *point["reduced"], *point["damper"]}
    names |= {*point["damper"]["cycles"][0], *(f"energy_{part}" for part in point["damper"]["energy"])}
    own = point["working"]
    names |= {*_flat(own), *(f"level_{name}" for name in _flat(own["level_floor"]))}
    names |= {f"from_above_{name}" for name in _flat(own["from_above"])}
    names |= {f"{floor}_{name}" for floor in ("level", "from_above") for name in ("amplitude", "damping_ratio")}
    names |= {f"error_{part}" for part in point["modes"][0]["error_parts"]}
    names |= {f"working_{name}" for name in ("error", "amplitude", "damping_ratio")}
    names |= {f"verdict_{name}" for name in _flat(point["verdict"])}
    with xr.open_dataset(finished / "results.nc", engine="h5netcdf") as data:
        assert set(data.variables) <= names
        assert names - set(data.variables) <= {"cycles", "energy", "branch", "error_parts"}


def _flat(figures: dict[str, Any]) -> list[str]:
    """Names of numbers; what is low and high has two."""
    plain = {
        name: value for name, value in figures.items() if name not in ("curve", "level_floor", "error", "from_above")
    }
    return [
        name + end for name, value in plain.items() for end in (("_low", "_high") if isinstance(value, list) else ("",))
    ]


def test_names_in_the_vtu_do_not_change_with_the_numbers(finished: Path, document: dict[str, Any]) -> None:
    import meshio

    expected = {
        f"mode_{number}_at_{point['rpm']:g}_rpm"
        for point in document["speeds"]
        for number in range(1, len(point["modes"]) + 1)
    }
    assert set(meshio.read(finished / "modes.vtu").point_data) == expected
