"""Where things lie: ball and cavity in the plate, housings, roots wherever a mesh draws them, units of a mesh."""

import meshio
import numpy as np
import pytest

import workflows
from tests.workflows.conftest import QUIET, changed, quads, refused, shipped_scene, write
from workflows import pipeline
from workflows.scene.load import load, parse


def drawn(path, x=0.0, scale=1.0, taper=0.0, noise=0.0):
    """A mesh file of a blade 120 mm long and 50 mm wide at its root, which is at x [m]; narrower at its tip.

    noise: how far every other point of the root lies off its line [m].
    """
    points, cells = quads(np.linspace(0.0, 1.0, 9), np.linspace(-0.5, 0.5, 5))
    points = np.column_stack([x + 0.12 * points[:, 0], 0.05 * (1 - taper * points[:, 0]) * points[:, 1], points[:, 2]])
    points[1:5:2, 0] += noise
    tags = {name: [np.ones(len(cells), dtype=np.int32)] for name in ("gmsh:physical", "gmsh:geometrical")}
    meshio.write(
        path, meshio.Mesh(scale * points, [("quad", cells)], cell_data=tags), file_format="gmsh22", binary=False
    )
    return path


def blade(paper, **changes):
    """The paper's damper on a blade from a mesh file, 150 mm from the axis to the root; roughly, as places go."""
    mesh = {"length": None, "width": None, "mesh": "blade.msh", "thickness": "6 mm", "theory": "mindlin"}
    base = changed(paper, **{f"plate__{key}": value for key, value in mesh.items()}, damper__at=None)
    base = changed(base, accuracy__frequency=0.01)
    here = {"rotor__hub_radius": "150 mm", "rotor__speeds": ["12000 rpm"], "rotor__modes": 2, "release__cycles": 3}
    return changed(base, release__displacement=["1 mm", "0 mm"], **(here | changes))


def solved(scene, folder):
    """What the damper of a scene feels of its plate."""
    source = load(write(scene, folder / "scene.toml"))
    point = pipeline.structure(source, QUIET, shapes=False).points[0]
    return {
        "frequencies": [mode.frequency_hz for mode in point.modes],
        "load": point.load_g,
        "felt": [point.reduced.M1, point.reduced.K1, point.reduced.floor_tilt],
    }


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """The same blade for all, drawn in metres from 0 on."""
    paper = shipped_scene("paper")
    folder = tmp_path_factory.mktemp("plain")
    drawn(folder / "blade.msh")
    return solved(blade(paper, damper__at=["110 mm", "5 mm"], plate__tip_mass="2 g"), folder)


@pytest.mark.parametrize(("x", "unit"), [(0.15, None), (-0.06, None), (0.15, "mm"), (0.0, "inch")])
def test_a_blade_is_the_same_wherever_and_in_whatever_unit_it_is_drawn(x, unit, plain, paper, tmp_path):
    """It was 67 631 g instead of 43 477 g where the mesh began at the radius of the hub."""
    scale = {None: 1.0, "mm": 1e3, "inch": 1 / 0.0254}[unit]
    drawn(tmp_path / "blade.msh", x, scale)
    moved = [f"{1e3 * x + 110} mm", "5 mm"]
    same = solved(blade(paper, damper__at=moved, plate__tip_mass="2 g", plate__mesh_unit=unit), tmp_path)
    assert plain["load"] == pytest.approx((12000 * np.pi / 30) ** 2 * np.hypot(0.26, 5e-3) / 10, rel=1e-12)
    for name, values in plain.items():
        assert same[name] == pytest.approx(values, rel=1e-8), name


def test_check_says_the_radii(spindamp, paper, tmp_path):
    drawn(tmp_path / "blade.msh", 0.15)
    said = spindamp("check", blade(paper)).out
    assert "150 mm at the clamped root, 270 mm at the damper (x = 270 mm, y = 0 mm)" in said
    assert spindamp.json("check", "scene.toml")["radii"] == {"root": 0.15, "damper": pytest.approx(0.27)}
    assert "Radii from the axis: 200 mm at the damper" in spindamp("check", "structure").out


def test_a_root_with_noise_is_clamped_all_along(spindamp, paper, tmp_path):
    """A micrometre off its line in edges of 12.5 mm: it was refused, or clamped in part."""
    drawn(tmp_path / "blade.msh", noise=1e-6)
    scene = blade(paper, damper=None, release=None)
    assert "Clamped root: 50 mm long" in spindamp("check", scene).out
    assert spindamp.json("check", scene)["root_length"] == pytest.approx(0.05, rel=1e-9)
    found = spindamp.json("run", scene)
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
def test_what_fits_or_has_a_housing(changes, paper):
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
def test_what_does_not_fit_a_mesh(changes, key, spindamp, paper, tmp_path):
    drawn(tmp_path / "blade.msh", taper=0.6)
    for command in ("check", "run"):
        said = refused(spindamp(command, blade(paper, **changes)), f"scene.toml: [damper] {key}")
        assert "expected" in said


def test_a_housing_is_carried_like_a_tip_mass(paper, tmp_path):
    place = {"damper__at": ["15 cm", "1 cm"], "rotor__speeds": ["8000 rpm"], "release__cycles": 3}
    here = changed(paper, **place, accuracy__frequency=0.05)
    housed = solved(changed(here, damper__housing="12 g", plate__tip_mass="8 g"), tmp_path)
    heavy = solved(changed(here, plate__tip_mass="20 g"), tmp_path)
    bare = solved(here, tmp_path)
    assert housed == heavy
    assert bare["frequencies"][0] > 1.001 * heavy["frequencies"][0]


def test_the_plate_alone_keeps_its_housing(spindamp, paper):
    """`campbell` leaves the balls out, not what holds them; and says a scene that can be run again."""
    changes = {"damper__at": ["15 cm", "1 cm"], "rotor__speeds": ["8000 rpm"], "damper__housing": "12 g"}
    scene = changed(paper, **changes, accuracy__frequency=0.05)
    with_balls, alone = spindamp.json("ringdown", scene), spindamp.json("campbell", scene)
    assert alone["speeds"][0]["modes"] == with_balls["speeds"][0]["modes"]
    assert alone["scene"]["plate"]["tip_mass"] == 0.012
    repeated = spindamp.json("campbell", alone["scene"])
    for speed in (*repeated["speeds"], *alone["speeds"]):
        for mode in speed["modes"]:  # what the scene itself switches off is no error of its model
            del mode["error_estimate"], mode["error_parts"]["coriolis"], mode["error_parts"]["large_deflection"]
    assert repeated["speeds"] == alone["speeds"]


@pytest.mark.usefixtures("quickly")
def test_rows_of_cavities_are_remarked_on(paper):
    """Four layers in 10 mm and 33 side by side across 80 mm: 132 cavities of 2.5 × 2.4 mm."""
    rough = changed(paper, rotor__speeds=["8000 rpm"], release__cycles=3, accuracy__frequency=0.05)
    none, (said,) = (
        [note for note in workflows.run(changed(rough, damper__count=count)).notes if "side by side" in note]
        for count in (132, 133)
    )
    assert none == []
    assert "At most 132 of the 133" in said
    assert "2 rows along the radius, 4 mm deep" in said
