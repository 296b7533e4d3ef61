"""Where things lie: ball and cavity in the plate, housings, roots wherever a mesh draws them, units of a mesh."""

import json
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import workflows
from tests.workflows.conftest import Command, Scene, changed, shipped_scene, write
from workflows import pipeline
from workflows.progress import Stages
from workflows.scene.load import load, parse


def drawn(path: Path, x: float = 0.0, scale: float = 1.0, taper: float = 0.0, noise: float = 0.0) -> Path:
    """A mesh file of a blade 120 mm long and 50 mm wide at its root, which is at x [m]; narrower at its tip.

    noise: how far every other point of the root lies off its line [m].
    """
    s, t = np.meshgrid(np.linspace(0.0, 1.0, 9), np.linspace(-0.5, 0.5, 5))
    points = np.column_stack([(x + 0.12 * s).ravel(), (0.05 * (1 - taper * s) * t).ravel(), 0 * s.ravel()])
    points[9:45:18, 0] += noise
    corner = (np.arange(4)[:, None] * 9 + np.arange(8)).ravel()
    cells = np.column_stack([corner, corner + 1, corner + 10, corner + 9])
    tags = {name: [np.ones(len(cells), dtype=np.int32)] for name in ("gmsh:physical", "gmsh:geometrical")}
    meshio.write(
        path, meshio.Mesh(scale * points, [("quad", cells)], cell_data=tags), file_format="gmsh22", binary=False
    )
    return path


def blade(paper: Scene, **changes: Any) -> Scene:
    """The paper's damper on a blade from a mesh file, 150 mm from the axis to the root; roughly, as places go."""
    mesh = {"length": None, "width": None, "mesh": "blade.msh", "thickness": "6 mm", "theory": "mindlin"}
    base = changed(paper, **{f"plate__{key}": value for key, value in mesh.items()}, damper__at=None)
    base = changed(base, accuracy__frequency=0.01)
    here = {"rotor__hub_radius": "150 mm", "rotor__speeds": ["12000 rpm"], "rotor__modes": 2, "release__cycles": 3}
    return changed(base, release__displacement=["1 mm", "0 mm"], **(here | changes))


def solved(scene: Scene, folder: Path) -> dict[str, Any]:
    """What the damper of a scene feels of its plate."""
    source = load(write(scene, folder / "scene.toml"))
    point = pipeline.structure(source, Stages(visible=False), shapes=False).points[0]
    return {
        "frequencies": [mode.frequency_hz for mode in point.modes],
        "load": point.load_g,
        "felt": [point.reduced.M1, point.reduced.K1, point.reduced.floor_tilt],
    }


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The same blade for all, drawn in metres from 0 on."""
    paper = shipped_scene("paper")
    folder = tmp_path_factory.mktemp("plain")
    drawn(folder / "blade.msh")
    return solved(blade(paper, damper__at=["110 mm", "5 mm"], plate__tip_mass="2 g"), folder)


@pytest.mark.parametrize(("x", "unit"), [(0.15, None), (-0.06, None), (0.15, "mm"), (0.0, "inch")])
def test_a_blade_is_the_same_wherever_and_in_whatever_unit_it_is_drawn(
    x: float, unit: str | None, plain: dict[str, Any], paper: Scene, tmp_path: Path
) -> None:
    """It was 67 631 g instead of 43 477 g where the mesh began at the radius of the hub."""
    scale = {None: 1.0, "mm": 1e3, "inch": 1 / 0.0254}[unit]
    drawn(tmp_path / "blade.msh", x, scale)
    moved = [f"{1e3 * x + 110} mm", "5 mm"]
    same = solved(blade(paper, damper__at=moved, plate__tip_mass="2 g", plate__mesh_unit=unit), tmp_path)
    assert plain["load"] == pytest.approx((12000 * np.pi / 30) ** 2 * np.hypot(0.26, 5e-3) / 10, rel=1e-12)
    for name, values in plain.items():
        assert same[name] == pytest.approx(values, rel=1e-8), name


def test_check_says_the_radii(spindamp: Command, paper: Scene, tmp_path: Path) -> None:
    drawn(tmp_path / "blade.msh", 0.15)
    scene = write(blade(paper), tmp_path / "scene.toml")
    said = spindamp("check", scene).out
    assert "150 mm at the clamped root, 270 mm at the damper (x = 270 mm, y = 0 mm)" in said
    found = json.loads(spindamp("check", scene, "--json").out)
    assert found["radii"] == {"root": 0.15, "damper": pytest.approx(0.27)}
    assert "Radii from the axis: 200 mm at the damper" in spindamp("check", "structure").out


def test_a_root_with_noise_is_clamped_all_along(spindamp: Command, paper: Scene, tmp_path: Path) -> None:
    """A micrometre off its line in edges of 12.5 mm: it was refused, or clamped in part."""
    drawn(tmp_path / "blade.msh", noise=1e-6)
    scene = write(blade(paper, damper=None, release=None), tmp_path / "scene.toml")
    assert "Clamped root: 50 mm long" in spindamp("check", scene).out
    assert json.loads(spindamp("check", scene, "--json").out)["root_length"] == pytest.approx(0.05, rel=1e-9)
    found = json.loads(spindamp("run", scene, "--json").out)
    assert found["root_length"] == pytest.approx(0.05, rel=1e-9)
    assert any("root of 50 mm" in note for note in found["notes"])


THICK = {"plate__thickness": "6 mm", "damper__radius": "10 mm", "damper__cavity": ["25 mm", "25 mm"]}


@pytest.mark.parametrize(
    "changes",
    [
        {"damper__cavity": ["9.9 mm", "79.9 mm"]},
        {"damper__at": ["20 cm", "38.7 mm"]},
        {"damper__count": 4 * 33 * 100},
        THICK | {"damper__housing": "80 g"},
        {"damper__at": ["20 cm", "40 mm"], "damper__housing": "1 g"},
    ],
)
def test_what_fits_or_has_a_housing(changes: dict[str, Any], paper: Scene) -> None:
    assert parse(changed(paper, **changes)).damper is not None


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"damper__cavity": ["6 mm", "3 mm"]}, "cavity"),
        ({"damper__cavity": ["3 mm", "25 mm"]}, "cavity"),  # the tip is 20 mm wide
        ({"damper__at": ["60 mm", "17 mm"], "damper__cavity": ["3 mm", "2 mm"]}, "cavity"),  # 35 mm wide there
        ({"damper__at": ["1.9 mm", "0 mm"]}, "radius"),
        ({"damper__count": 10**6}, "count"),
    ],
)
def test_what_does_not_fit_a_mesh(
    changes: dict[str, Any], key: str, spindamp: Command, paper: Scene, tmp_path: Path
) -> None:
    drawn(tmp_path / "blade.msh", taper=0.6)
    scene = write(blade(paper, **changes), tmp_path / "scene.toml")
    for command in ("check", "run"):
        outcome = spindamp(command, scene)
        assert outcome.status == 2
        assert outcome.out == ""
        assert f"[damper] {key}" in outcome.err
        assert "expected" in outcome.err


def test_a_housing_is_carried_like_a_tip_mass(paper: Scene, tmp_path: Path) -> None:
    place = {"damper__at": ["15 cm", "1 cm"], "rotor__speeds": ["8000 rpm"], "release__cycles": 3}
    here = changed(paper, **place, accuracy__frequency=0.05)
    housed = solved(changed(here, damper__housing="12 g", plate__tip_mass="8 g"), tmp_path)
    heavy = solved(changed(here, plate__tip_mass="20 g"), tmp_path)
    bare = solved(here, tmp_path)
    assert housed == heavy
    assert bare["frequencies"][0] > 1.001 * heavy["frequencies"][0]


def test_the_plate_alone_keeps_its_housing(spindamp: Command, paper: Scene, tmp_path: Path) -> None:
    """`campbell` leaves the balls out, not what holds them; and says a scene that can be run again."""
    changes = {"damper__at": ["15 cm", "1 cm"], "rotor__speeds": ["8000 rpm"], "damper__housing": "12 g"}
    scene = write(changed(paper, **changes, accuracy__frequency=0.05), tmp_path / "scene.toml")
    with_balls = json.loads(spindamp("ringdown", scene, "--json").out)
    alone = json.loads(spindamp("campbell", scene, "--json").out)
    assert alone["speeds"][0]["modes"] == with_balls["speeds"][0]["modes"]
    assert alone["scene"]["plate"]["tip_mass"] == 0.012
    again = write(alone["scene"], tmp_path / "again.toml")
    repeated = json.loads(spindamp("campbell", again, "--json").out)
    for speed in (*repeated["speeds"], *alone["speeds"]):
        for mode in speed["modes"]:  # what the scene itself switches off is no error of its model
            del mode["error_estimate"], mode["error_parts"]["coriolis"], mode["error_parts"]["large_deflection"]
    assert repeated["speeds"] == alone["speeds"]


@pytest.mark.usefixtures("quickly")
def test_rows_of_cavities_are_remarked_on(paper: Scene) -> None:
    """Four layers in 10 mm and 33 side by side across 80 mm: 132 cavities of 2.5 × 2.4 mm."""
    rough = changed(paper, accuracy__frequency=0.05)
    results = [
        workflows.run(changed(rough, damper__count=count, rotor__speeds=["8000 rpm"], release__cycles=3))
        for count in (132, 133)
    ]
    remarks = [[note for note in found.notes if "side by side" in note] for found in results]
    assert remarks[0] == []
    assert "At most 132 of the 133" in remarks[1][0]
    assert "2 rows along the radius, 4 mm deep" in remarks[1][0]
