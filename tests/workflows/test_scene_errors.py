"""Scenes that are wrong: exit 2, one line that names file, key and value, no traceback, nothing written."""

import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fem.meshes.planform import MeshError, check_mesh
from tests.workflows.conftest import Command, Scene, changed, refused, write
from workflows import pipeline
from workflows.errors import BadInput
from workflows.report import remarks
from workflows.scene import quantities
from workflows.scene.load import parse
from workflows.studies.sweep import study

# What is changed in the paper's scene, the key that the message names, and a part of what it says.
MALFORMED: list[tuple[dict[str, Any], str, str]] = [
    (
        {"material__density": 7.85},
        "[material] density = 7.85",
        "at least 10 kg/m^3, the lightest foam: was '7.85 g/cm^3' m",
    ),
    (
        {"material__youngs_modulus": 113.8},
        "[material] youngs_modulus = 113.8",
        "expected at least 10000 Pa, of the softest rubber: 113.8 is in Pa; was '113.8 GPa' meant?",
    ),
    ({"plate__length": 150, "plate__width": 40}, "[plate] thickness", "; length = 150 is in m: was '150 mm' meant?"),
    ({"rotor__speeds": {"start": 0, "stop": 1, "count": 1}}, "[rotor] speeds", "for one speed give a list"),
    (
        {"rotor__speeds": ["0 rpm"], "release": {"ratio": 0.2}},
        "[release] ratio = 0.2",
        "at rest there is no load",
    ),
    (
        {"structure__floor_tilt": "7 1/m"},
        "[structure] floor_tilt",
        "on a plate the floor's tilt follows from the bending",
    ),
    ({"damper__mass_ratio": 11}, "[damper] mass_ratio = 11", "at most 10"),
    ({"damper__damping_ratio": 0.999}, "[damper] damping_ratio = 0.999", "at most 0.9"),
    ({"rotor__speeds": {"start": 0, "stop": 1, "steps": 2, "unit": "rpm"}}, "[rotor] speeds", "key 'steps', 'unit'"),
    (
        {"effects": {"large_deflection": True, "stress_stiffening": False}},
        "[effects] large_deflection = true",
        "needs stress_stiffening",
    ),
    ({"damper__length": 1}, "[damper] length", "it belongs in [plate]"),
    ({"rotor__twist": "20 deg"}, "[rotor] twist = '20 deg'", "a plate is flat: use a [blade] with a mesh"),
    ({"plate__camber": "20 deg"}, "[plate] camber", "a mesh of its volume; a camber up"),
    ({"rotor__blades": 12}, "[rotor] blades = 12", "unknown key: spindamp computes one blade"),
    ({"damper__diameter": "wide"}, "[damper] diameter", "by its radius, half its diameter"),
    (  # a housing frees the cavity of the plate's thickness, not of the axis 5 cm away
        {"damper__at": ["5 cm", 0], "damper__housing": "1 g", "damper__cavity": ["6 cm", "2.4 mm"]},
        "[damper] cavity = ['6 cm', '2.4 mm']",
        "the cavity is larger than its distance from the axis, 0.05 m",
    ),
    ({"plate__tip_mass_at": ["1 cm", 0], "plate__tip_mass": 1}, "[plate] tip_mass_at", "at the damper's place"),
    ({"plate__tip_mass_at": ["1 cm", 0]}, "[plate] tip_mass_at", "expected a tip_mass beside it"),
]


@pytest.fixture
def wrong(spindamp: Command, tmp_path: Path) -> Callable[..., str]:
    """Write a scene and have it refused, with the file, the key and a message; nothing is written."""

    def call(scene: Scene, key: str, message: str, *command: str) -> str:
        path = write(scene, tmp_path / "bad.toml")
        said = refused(spindamp(*(command or ("run", "--out", "out")), path), f"{path}: {key}", message)
        assert list(tmp_path.iterdir()) == [path]
        return said

    return call


def test_every_unknown_key_is_named(paper: Scene, wrong: Callable[..., str]) -> None:
    """In one line, with what was probably meant; what is missing for their sake is not said as well."""
    changes = {
        "plate__lenght": "20 cm",
        "plate__length": None,
        "rotor__rpm": 3,
        "damper__diameter": "2 mm",
        "damper__radius": None,
        "accuracy__frequenzy": 1e-3,
        "wings": {"a": 1},
        "colour": "red",
    }
    error = wrong(changed(paper, **changes), "[plate] lenght = '20 cm'", "unknown key: did you mean 'length'?")
    for said in (
        "also unknown: ",
        "[rotor] rpm",
        "[damper] diameter (a ball is given by its radius, here radius = '1 mm')",
        "[accuracy] frequenzy (did you mean 'frequency'?)",
        "[wings]",
        "colour",
    ):
        assert said in error
    assert "more" not in error


def test_a_thousand_unknown_keys_are_counted(paper: Scene, wrong: Callable[..., str]) -> None:
    scene = changed(paper, plate={f"{'x' * 500}{i}": 1 for i in range(1000)})
    assert len(wrong(scene, "[plate] xxx", "and 979 more", "check")) < 3000


STRUCTURE_ONLY: list[tuple[dict[str, Any], str, str]] = [
    ({"rotor__modes": 5}, "[rotor] modes = 5", "belongs to a plate"),
    ({"accuracy": {"frequency": 1e-2}}, "[accuracy] frequency = 0.01", "belongs to a plate"),
    ({"damper__housing": "1 g"}, "[damper] housing", "belongs to a plate; the mass of a [structure] includes it"),
    ({"effects__coriolis": True}, "[effects] coriolis = true", "the scene has no plate"),
    (
        {"structure__floor_tilt": "7 1/m", "damper__formulation": "printed"},
        "[structure] floor_tilt",
        "the printed equations support a level floor only",
    ),
    ({"effects__floor_tilt": True}, "[effects] floor_tilt = true", "structure.floor_tilt is 0: give the slope"),
    (
        {"damper__mass_ratio": None, "damper__mass": "1000 kg"},
        "[damper] mass = '1000 kg'",
        "at most 10 times the structure's mass, 1 kg; these weigh 1000 kg",
    ),
    (
        {
            "damper__mass_ratio": None,
            "damper__ball_material": "steel",
            "damper__radius": "60 mm",
            "damper__cavity": ["0.13 m", "0.13 m"],
            "damper__count": 2,
        },
        "[damper] ball_material = 'steel'",
        "these weigh 14.2",
    ),
    (
        {"damper__count": 10**9},
        "[damper] count = 1000000000",
        "expected at most 143239 of radius 0.001 m that weigh 0.006 kg together",  # 0.006 / (4.18879e-9 · 10)
    ),
    (
        {"damper__radius": "25 cm", "damper__cavity": ["60 cm", "60 cm"], "damper__count": None},
        "[damper] radius = '25 cm'",
        "the ball is larger than its distance from the axis, 0.2 m",
    ),
    (
        {"damper__cavity": ["2.5 mm", "60 cm"]},
        "[damper] cavity = ['2.5 mm', '60 cm']",
        "the cavity is larger than its distance from the axis, 0.2 m",
    ),
    (
        {"release__displacement": ["0 mm", "-30 cm"]},
        "[release] displacement = ['0 mm', '-30 cm']",
        "expected at most the damper's distance from the axis, 0.2 m",
    ),
    ({"structure__floor_tilt": "7 deg"}, "[structure] floor_tilt", "a slope over a displacement such as '6.9 1/m'"),
]


@pytest.mark.parametrize(
    ("scene", "changes", "key", "message"),
    [*(("paper", *case) for case in MALFORMED), *(("structure", *case) for case in STRUCTURE_ONLY)],
)
def test_malformed_scene(
    scene: str,
    changes: dict[str, Any],
    key: str,
    message: str,
    wrong: Callable[..., str],
    request: pytest.FixtureRequest,
) -> None:
    wrong(changed(request.getfixturevalue(scene), **changes), key, message)


def test_hertz_are_no_speed() -> None:
    """60 turns a second are 3600 rpm."""
    for text, rpm in (("60 Hz", "3600"), ("0.06 kHz", "3600")):
        with pytest.raises(quantities.UnitError, match=f"of frequency.*as revolutions.*'{rpm} rpm'"):
            quantities.to_si(text, quantities.ROTATION)
    assert quantities.to_si("60 Hz", quantities.FREQUENCY) == 60


def test_every_error_is_named(structure: Scene) -> None:
    wrong = changed(structure, rotor__speeds=["60 Hz"], damper__friction=-1, damper__restitution=2)
    with pytest.raises(BadInput) as found:
        parse(wrong)
    said = str(found.value)
    for key, problem in (("speeds", "of frequency"), ("friction", "expected at least 0"), ("restitution", "at most 1")):
        assert re.search(rf"{key}\b.*{problem}", said), said
    assert "more)" not in said


def test_a_place_on_the_edge_has_no_room(paper: Scene) -> None:
    with pytest.raises(BadInput, match="no room for a cavity") as found:
        parse(changed(paper, damper__at=["20 cm", "4 cm"]))
    assert "[damper] at" in str(found.value)
    assert "less than 0" not in str(found.value)


@pytest.mark.parametrize(("asked", "taken"), [(1e-14, False), (0.9e-10, False), (1e-10, True)])
def test_no_more_is_asked_than_double_precision_gives(asked: float, taken: bool, paper: Scene) -> None:
    scene = changed(paper, accuracy={"frequency": asked})
    if taken:
        assert parse(scene).accuracy.frequency == asked
    else:
        with pytest.raises(BadInput, match=r"accuracy\] frequency.*at least 1e-10"):
            parse(scene)


def _unmerged() -> Any:
    """Two squares with nodes of their own along the side that they share."""
    from skfem import MeshQuad

    x = np.array([[0, 1, 1, 0, 1, 2, 2, 1], [0, 0, 1, 1, 0, 0, 1, 1]], dtype=float)
    return MeshQuad(x, np.array([[0, 1, 2, 3], [4, 5, 6, 7]]).T)


def test_points_that_are_not_merged_are_why_a_mesh_falls_apart() -> None:
    with pytest.raises(MeshError, match=r"2 points coincide with others, the first one at \(1, [01]\): merge them"):
        check_mesh(_unmerged())


@pytest.mark.parametrize(
    ("length", "width", "said"), [(30, 200, True), (30, 61, True), (30, 59, False), (200, 30, False)]
)
def test_a_mesh_clamped_along_its_long_edge_is_remarked_on(length: float, width: float, said: bool) -> None:
    points = 1e-3 * np.array([[0, 0, 0], [length, 0, 0], [length, width, 0], [0, width, 0]])
    plate = SimpleNamespace(mesh="m.msh")
    found: Any = SimpleNamespace(scene=SimpleNamespace(plate=plate), surface=SimpleNamespace(points=points))
    note = remarks.wide(found)
    assert (note is not None) is said
    if note is not None:
        assert f"{width:g} mm wide" in note
        assert f"{length:g} mm long" in note
        assert "long edge" in note
    plate.mesh = None
    assert remarks.wide(found) is None


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
        study.of_scene("structure", [f"damper.clearance={typed}"])
    assert f"damper.clearance = '{typed}'" in str(found.value)


def test_the_weight_left_out_is_said(structure):
    found = remarks.assumptions(pipeline.run(changed(structure, release__cycles=2)))
    assert any("weight is neglected" in text for text, _ in found)


def test_balls_as_heavy_as_the_structure_are_taken(structure):
    assert parse(changed(structure, damper__mass_ratio=10)).damper.mass_ratio == 10
