"""Scenes that are right: every key and every alternative of the contract."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import get_args

import jsonschema
import numpy as np
import pytest

import fem
import workflows
from fem.meshes import read as meshfile
from fem.theory.registry import THEORIES
from tests.soak import plates
from tests.workflows.conftest import KNOWN, MESHES, QUIET, changed, on_mesh, refused, shipped_scene, stored
from workflows import pipeline
from workflows.effects import ball, plate, selection
from workflows.effects.selection import EFFECTS
from workflows.errors import BadInput
from workflows.io import provenance
from workflows.pipeline import run
from workflows.report.remarks import assumptions
from workflows.scene import plate_mesh
from workflows.scene.damper import Release
from workflows.scene.load import SHIPPED, as_scene_file, load, parse, schema, shipped
from workflows.scene.plate import Plate
from workflows.scene.scene import Effects
from workflows.solve import model_choice

pytestmark = pytest.mark.usefixtures("undrawn")

PUBLISHED = Path(workflows.__file__).with_name("scene.schema.json")


def test_shipped_scenes_load():
    """By name and by path; without either the paper's."""
    for name in shipped():
        assert load(name).scene == load(SHIPPED / f"{name}.toml").scene == parse(shipped_scene(name))
    assert load().scene == load("paper").scene


def test_speeds_as_a_ladder(paper):
    ladder = {"start": "0 rpm", "stop": "17500 rpm", "count": 36}
    speeds = parse(changed(paper, rotor__speeds=ladder)).rotor.speeds
    assert speeds == pytest.approx([500 * k * math.pi / 30 for k in range(36)])


BARE = [
    ([6000], "6000 is 57295.8 rpm. Was '6000 rpm' meant?"),
    ([0, "3500 rpm", 100.5], "100.5 is 959.704 rpm"),
    ({"start": 0, "stop": 1800, "count": 4}, "1800 is 17188.7 rpm"),
    ({"start": 100, "stop": "9000 rpm", "count": 4}, "100 is 954.93 rpm"),
    ([0], None),
    (["6000 rpm", "0 rad/s"], None),
    ({"start": 0, "stop": "9000 rpm", "count": 4}, None),
]


@pytest.mark.parametrize(("speeds", "remark"), BARE)
def test_speeds_without_a_unit_are_remarked_on(speeds, remark, structure, spindamp, tmp_path):
    scene = changed(structure, rotor__speeds=speeds)
    checked, remarks = spindamp("check", scene), spindamp.json("check", scene)["remarks"]
    assert spindamp("ringdown", scene, "--json").err == checked.err, "of every command"
    assert len(remarks) == (remark is not None)
    for said in (checked.err, checked.out):
        assert ("Speeds without a unit are in rad/s" in said) == (remark is not None)
    assert remark is None or remark in checked.out.splitlines()[1]
    (tmp_path / "again.toml").write_text(checked.out, encoding="utf-8")
    assert "without a unit" not in spindamp("check", "again.toml").out
    assert load("again.toml").scene.rotor.speeds == parse(scene).rotor.speeds


def test_a_run_says_its_speeds_first_and_remarks(structure, spindamp, tmp_path):
    bare = spindamp("ringdown", changed(structure, rotor__speeds=[1000])).out
    assert bare.splitlines()[0] == "A known structure: 9549.3 rpm"
    assert bare.splitlines()[1] == "Speeds without a unit are in rad/s: 1000 is 9549.3 rpm. Was '1000 rpm' meant?"
    assert bare.count("without a unit") == 1
    written = spindamp("run", "scene.toml", "--out", "out").out
    assert written.splitlines()[1] == bare.splitlines()[1]
    assert "without a unit" in stored(tmp_path / "out" / "results.json")["notes"][0]
    many = changed(shipped_scene("campbell"), rotor__modes=2, accuracy__frequency=0.05)
    assert spindamp("campbell", many).out.startswith(
        "Campbell diagram of the paper's plate: 36 speeds from 0 to 17500 rpm\n"
    )


def test_where_nothing_is_left_the_speeds_are_asked_about(paper, spindamp):
    changes = {"rotor__stagger": "90 deg", "effects__stress_stiffening": False}
    done = spindamp("campbell", changed(paper, rotor__speeds=[6000], **changes))
    warning, _, message = done.err.partition("\n")
    assert "WARNING" in warning
    refused(replace(done, err=message), "", "Was '6000 rpm' meant?", status=3)


def test_release_alternatives(paper):
    scene = parse(changed(paper, release={"acceleration": ["6000 g", 5.0]}))
    assert scene.release.acceleration == (60_000.0, 5.0)
    default = parse(changed(paper, rotor__gravity=None, release={"acceleration": ["1 g", "0 g"]}))
    assert default.release.acceleration == (9.80665, 0.0)
    assert parse(changed(paper, release={"ratio": 0.3, "cycles": 20})).release is not None


def test_a_scene_without_a_release_lets_the_structure_go_where_the_ball_moves():
    """By hand: mu_r / r of the load, in the frequency with the ball stuck, 1.5 times; at rest, by the gap of 5/7 u."""
    scene = changed(KNOWN, release=None, rotor__speeds=["0 rpm", "3500 rpm", "10000 rpm"])
    assert parse(changed(scene, release={"cycles": 20})).release == Release(cycles=20)
    for point in workflows.run(scene).speeds:
        load, square = 0.2 * point.omega**2, (2 * math.pi * 269.5) ** 2
        free = 0.25e-3  # with no load the ball does not roll: it stays where it is, and the wall comes to it
        assert point.damper.release == pytest.approx((1.5 * (0.01 * load / square or free), 0))
        assert point.damper.events > 0


def test_a_plate_may_have_every_theory_that_there_is():
    known = get_args(Plate.model_fields["theory"].annotation)
    assert sorted(known) == sorted(("auto", *THEORIES))


@pytest.mark.parametrize("name", shipped())
def test_resolved_scene_is_a_scene_that_means_the_same(name):
    scene = load(name).scene
    decided = selection.resolve(scene)
    theory = None if scene.plate is None else model_choice.chosen_theory(scene)[0]
    again = parse(provenance.resolved_scene(scene, decided, theory))
    assert again.model_copy(update={"effects": scene.effects, "plate": scene.plate}) == scene


@pytest.fixture(scope="module")
def published():
    return stored(PUBLISHED)


def test_published_schema_comes_from_the_model(published):
    assert published == schema(), "run python -m workflows.scene.load"
    jsonschema.Draft202012Validator.check_schema(published)


def test_every_key_of_the_schema_says_what_it_is_and_in_what_unit(published):
    found = published
    keys = {(name, key): entry for name, table in found["$defs"].items() for key, entry in table["properties"].items()}
    keys |= {("", key): entry for key, entry in found["properties"].items()}
    assert len(keys) > 55
    for where, entry in keys.items():
        said = entry.get("description", "")
        assert len(said) >= 8, where
        units = set(re.findall(r'"x-si": "([^"]+)"', json.dumps(entry, ensure_ascii=False)))
        assert len(units) <= 1, where
        for unit in units:
            assert said.endswith(f"a number without a unit is in {unit}"), where
        plain = {part.get("type") for part in (entry, *entry.get("anyOf", []))}
        if not units and plain & {"number", "integer"}:
            assert "dimensionless" in said or "number of" in said, where


@pytest.mark.parametrize(
    ("material", "valid"), [({"name": "steel"}, True), ({}, False), ({"name": "stel"}, False), ({"density": 1}, False)]
)
def test_the_schema_knows_both_ways_to_give_a_material(material, valid, paper, published):
    scene = changed(paper, material=material)
    assert jsonschema.Draft202012Validator(published).is_valid(scene) is valid


@pytest.mark.parametrize("name", shipped())
def test_shipped_scenes_meet_the_published_schema(name, published):
    scene = shipped_scene(name)
    validator = jsonschema.Draft202012Validator(published)
    validator.validate(scene)
    with pytest.raises(jsonschema.ValidationError):
        validator.validate(changed(scene, rotor__sped=1))


def test_rules_of_effects(paper, structure):
    decided = selection.resolve(parse(changed(paper, effects=None)))
    on = {name for name, effect in decided.items() if effect.on}
    plate = {"stress_stiffening", "spin_softening", "coriolis", "rotary_inertia"}
    assert on == plate | {"rolling_resistance", "impact_friction", "floor_tilt", "structural_modes", "cavity_mass"}
    assert all(effect.why for effect in decided.values())

    still = selection.resolve(parse(changed(paper, effects=None, rotor__speeds=[0])))
    on = {name for name, effect in still.items() if effect.on}
    assert on == {"rotary_inertia", "impact_friction", "structural_modes", "cavity_mass"}

    one = changed(paper, effects=None, rotor__modes=1)
    assert selection.resolve(parse(one))["spin_softening"].on  # cross-sections turn across the axis
    assert selection.resolve(parse(changed(one, rotor__stagger="90 deg")))["spin_softening"].on

    smooth = selection.resolve(parse(changed(structure, damper__friction=0, damper__rolling_friction=0)))
    assert not any(effect.on for effect in smooth.values())


@pytest.mark.parametrize(
    ("accuracy", "rpm", "on", "moved"),
    [
        (1e-2, 17500, False, "0.44 %"),
        (1e-3, 17500, True, "0.5 %"),
        (1e-3, 5000, False, "0.036 %"),
        (1e-4, 5000, True, "0.04 %"),
    ],
)
def test_coriolis_is_called_for_where_it_shows(paper, accuracy, rpm, on, moved):
    """It lowers the lag mode at 17500 rpm by 0.43 %; a rule without modes says 0.5; with the square of the speed."""
    scene = changed(paper, rotor__speeds=[f"{rpm} rpm"], accuracy={"frequency": accuracy})
    effect = selection.resolve(parse(scene))["coriolis"]
    assert effect.on is on
    assert moved in effect.why


@pytest.mark.parametrize(("thickness", "hub", "moved"), [("14.2 mm", "10 cm", "1 %"), ("14.8 mm", "0 m", "1.8 %")])
def test_coriolis_is_called_for_where_modes_nearly_coincide(paper, thickness, hub, moved):
    """Twist and lag of a steel plate in the plane of rotation: it moves them by 0.77 and 1.8 %, flap by 0.09 %."""
    steel = {"youngs_modulus": 2e11, "poissons_ratio": 0.3, "density": 7850}
    scene = changed(paper, damper=None, release=None, material=steel, plate__theory="auto", plate__thickness=thickness)
    scene = changed(scene, rotor__speeds=["8000 rpm"], rotor__hub_radius=hub, rotor__stagger="90 deg")
    effect = selection.resolve(parse(scene))["coriolis"]
    assert effect.on
    assert moved in effect.why
    assert not selection.resolve(parse(changed(scene, rotor__modes=1)))["coriolis"].on


def frequencies(scene, switches):
    """The six lowest with these effects; None where the plate diverges."""
    given, metal = scene.plate, scene.material
    material = fem.Material(metal.youngs_modulus, metal.poissons_ratio, metal.density)
    body = fem.Plate(fem.Rectangle(given.length, given.width).mesh(3), given.thickness, material)
    operators = fem.assemble(body, fem.Rotor(scene.rotor.hub_radius, scene.rotor.stagger), switches)
    try:
        return fem.solve_modes(operators, scene.rotor.speeds[0], 6).frequencies_hz
    except (fem.Divergence, fem.NoEquilibrium):
        return None


def test_what_is_left_out_moves_no_frequency_by_more_than_the_accuracy():
    """Random plates at one speed each, on a mesh finer than the one it was decided on."""
    left_out = 0
    for seed in range(5):
        scene = parse(plates.sensible(seed))
        decided = {name: selection.resolve(scene)[name].on for name in ("coriolis", "large_deflection")}
        known = frequencies(scene, fem.Effects(**decided))
        for name in (name for name, on in decided.items() if not on):
            other = frequencies(scene, fem.Effects(**decided | {name: True}))
            assert (known is None) == (other is None)
            if known is not None and other is not None:
                assert np.abs(other / known - 1.0).max() <= scene.accuracy.frequency, (seed, name)
                left_out += 1
    assert left_out > 5


def test_the_length_of_a_mesh_is_read():
    source = load(MESHES / "blade.toml")
    form = plate_mesh.planform(source)
    assert form.sides[0] == pytest.approx(0.25)
    assert "requested" in selection.resolve(source.scene, source.name, form)["coriolis"].why
    with pytest.raises(ValueError, match="planform of a plate from a mesh is needed"):
        selection.resolve(source.scene)


def test_switches_override_the_rules(paper):
    decided = selection.resolve(parse(changed(paper, effects={"stress_stiffening": False, "spin_softening": True})))
    assert not decided["stress_stiffening"].on
    assert "switched off by the scene" in decided["stress_stiffening"].why
    assert decided["spin_softening"].why == "requested by the scene"


def test_large_deflection_goes_with_stress_stiffening(paper):
    off = {"stress_stiffening": False}
    bent = selection.resolve(parse(changed(paper, rotor__stagger="30 deg", effects=off)))["large_deflection"]
    assert (bent.on, bent.why) == (False, "it is part of stress_stiffening, which is off")
    on = selection.resolve(parse(changed(paper, rotor__speeds=[0], effects={"large_deflection": True})))
    assert on["large_deflection"].on
    assert on["stress_stiffening"].on


@pytest.mark.parametrize("command", [["run", "--json"], ["campbell", "--json"], ["check"]])
def test_a_mesh_file_is_read_once(command, paper, spindamp, monkeypatch):
    """What a big mesh costs to read is paid once, and all of a run is about one state of the file.

    It is split all the same: to know how good it is takes one that is finer.
    """
    few = {"rotor__speeds": ["3500 rpm"], "rotor__modes": 2, "release__cycles": 2}
    scene = on_mesh(paper, MESHES / "plate_coarse.msh", **few)
    reads, read = [], meshfile.read_field
    monkeypatch.setattr(meshfile, "read_field", lambda *given: reads.append(given) or read(*given))
    outcome = spindamp(*command, scene)
    assert outcome.status == 0, outcome.err
    assert len(reads) == 1


@pytest.mark.parametrize("path", sorted(MESHES.glob("*.toml")), ids=lambda path: path.stem)
def test_scenes_with_meshes_are_solved(path):
    """The mesh is found beside the scene, split until it is fine enough, and says so."""
    source = load(path)
    at_rest = source.changed(rotor={"speeds": (0.0,)}, damper=None, release=None, accuracy={"frequency": 0.05})
    results = pipeline.run(at_rest, QUIET)
    assert path.stem in results.diagram.mesh
    parts = [mode.error_parts for mode in results.speeds[0].modes if mode.error_parts is not None]
    assert len(parts) == 6
    assert all(part.mesh is not None and 0 < part.mesh <= 0.05 for part in parts)


def test_every_key_has_a_definition_and_every_definition_a_key():
    assert [*plate.EFFECTS, *ball.EFFECTS] == list(Effects.model_fields) == list(EFFECTS)
    assert {kind.of for kind in plate.EFFECTS.values()} == {"plate"}
    assert {kind.of for kind in ball.EFFECTS.values()} == {"damper"}


def test_words_of_an_effect_are_its_own():
    assert len({kind.word for kind in EFFECTS.values()}) == len(EFFECTS)
    for name, kind in EFFECTS.items():
        assert kind.part_of in {"", *EFFECTS}
        assert set(kind.after) <= EFFECTS.keys() - {name}


def test_a_ball_that_slips_is_not_said_to_roll(structure):
    """What is taken for granted goes with the effects."""
    for slips, said in ((False, "never slides except at walls"), (True, "slides there until it rolls")):
        found = run(changed(structure, effects__ball_slip=slips, release__cycles=2))
        assert said in " ".join(text for text, _ in assumptions(found))


class Quantity:
    """As of a library of units, whose scalars have `tolist` and do not."""

    def __init__(self, number, unit):
        self.number, self.unit = number, unit

    def __str__(self):
        return f"{self.number} {self.unit}"

    def tolist(self):
        raise AttributeError("'float' does not support tolist")


def test_quantities_of_another_library_are_read_as_text():
    scene = shipped_scene("structure")
    for unit in ("mm", "millimeter"):
        assert parse(changed(scene, damper__radius=Quantity(0.9, unit))).damper.radius == pytest.approx(0.9e-3)
    assert as_scene_file(changed(scene, rotor__speeds=[Quantity(350.0, "rad/s")])).remarks == ()
    with pytest.raises(BadInput, match=r"\[damper\] radius = '0.9 kg': expected a length"):
        parse(changed(scene, damper__radius=Quantity(0.9, "kg")))
