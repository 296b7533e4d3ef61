"""Scenes that are wrong: exit 2, one line that names file, key and value, no traceback, nothing written."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from tests.workflows.conftest import changed, refused, shipped_scene, table_of, write
from tests.workflows.test_blades import TAPER
from workflows import pipeline
from workflows.errors import BadInput
from workflows.report import remarks
from workflows.scene.load import parse
from workflows.studies.sweep import study

REFUSED = table_of("wrong_scenes")
SCENES = {"taper": TAPER}
SCENES |= {name: shipped_scene(name) for name in ("paper", "structure")}


@pytest.fixture
def wrong(spindamp, tmp_path):
    """Write a scene and have it refused, with the file, the key and a message; nothing is written."""

    def call(scene, key, message, *command):
        path = write(scene, tmp_path / "bad.toml")
        said = refused(spindamp(*(command or ("run", "--out", "out")), path), f"{path}: {key}", message)
        assert list(tmp_path.iterdir()) == [path]
        return said

    return call


def test_every_unknown_key_is_named(paper, wrong):
    """In one line, with what was probably meant; what is missing for their sake is not said as well."""
    changes = {"plate__lenght": "20 cm", "rotor__rpm": 3, "damper__diameter": "2 mm", "accuracy__frequenzy": 1e-3}
    changes |= {"plate__length": None, "damper__radius": None, "wings": {"a": 1}, "colour": "red"}
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


def test_a_thousand_unknown_keys_are_counted(paper, wrong):
    scene = changed(paper, plate={f"{'x' * 500}{i}": 1 for i in range(1000)})
    assert len(wrong(scene, "[plate] xxx", "and 979 more", "check")) < 3000


@pytest.mark.parametrize(("base", "case"), [(base, case) for base, cases in REFUSED.items() for case in cases])
def test_wrong_scene(base, case, wrong):
    changes = case.get("change", {}) | dict.fromkeys(case.get("without", ()))
    scene = changed(SCENES[base], **{key.replace(".", "__"): value for key, value in changes.items()})
    wrong(scene, case["key"], case["says"])


def test_every_error_is_named(structure):
    wrong = changed(structure, rotor__speeds=["60 Hz"], damper__friction=-1, damper__restitution=2)
    with pytest.raises(BadInput) as found:
        parse(wrong)
    said = str(found.value)
    for key, problem in (("speeds", "of frequency"), ("friction", "expected at least 0"), ("restitution", "at most 1")):
        assert re.search(rf"{key}\b.*{problem}", said), said
    assert "more)" not in said


def test_a_place_on_the_edge_has_no_room(paper):
    with pytest.raises(BadInput, match="no room for a cavity") as found:
        parse(changed(paper, damper__at=["20 cm", "4 cm"]))
    assert "[damper] at" in str(found.value)
    assert "less than 0" not in str(found.value)


@pytest.mark.parametrize(("asked", "taken"), [(1e-14, False), (0.9e-10, False), (1e-10, True)])
def test_no_more_is_asked_than_double_precision_gives(asked, taken, paper):
    scene = changed(paper, accuracy={"frequency": asked})
    if taken:
        assert parse(scene).accuracy.frequency == asked
    else:
        with pytest.raises(BadInput, match=r"accuracy\] frequency.*at least 1e-10"):
            parse(scene)


@pytest.mark.parametrize(
    ("length", "width", "said"), [(30, 200, True), (30, 61, True), (30, 59, False), (200, 30, False)]
)
def test_a_mesh_clamped_along_its_long_edge_is_remarked_on(length, width, said):
    points = 1e-3 * np.array([[0, 0, 0], [length, 0, 0], [length, width, 0], [0, width, 0]])
    plate = SimpleNamespace(mesh="m.msh", length=None, thickness=0.01)
    scene = SimpleNamespace(plate=plate, blade=None, damper=None, ball_count=1)
    found = SimpleNamespace(scene=scene, surface=SimpleNamespace(points=points), speeds=())
    note = remarks.wide(found)
    assert (note is not None) is said
    if note is not None:
        assert f"{width:g} mm wide" in note
        assert f"{length:g} mm long" in note
        assert "long edge" in note
    plate.mesh = None
    assert remarks.wide(found) is None


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
