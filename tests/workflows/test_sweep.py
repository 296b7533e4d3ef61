"""Sweeps: what is varied, the points of a study, and that each is what a run of its scene gives."""

from __future__ import annotations

import json
import math
import tomllib

import numpy as np
import pytest
from scipy.stats import qmc

import spindamp
from tests.workflows.browser import findings
from workflows.errors import BadInput
from workflows.io import serialise
from workflows.scene.load import SHIPPED, load
from workflows.solve.results import Damping
from workflows.studies.sweep import plan as axes
from workflows.studies.sweep import report, study
from workflows.studies.sweep.plan import base, grid, of_a_point, sample, with_values

G = 9.80665


def axis(text):
    (found,) = axes.read([text], G)
    return found


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("damper.radius=1 mm:2 mm:3", [1e-3, 1.5e-3, 2e-3]),
        ("damper.mass_ratio=log:0.001:0.1:3", [1e-3, 1e-2, 1e-1]),
        ("damper.friction=0.1, 0.4", [0.1, 0.4]),
        ("rotor.speeds=3000 rpm", [100 * math.pi]),
        ("release.acceleration[0]=1 g,2 g", [G, 2 * G]),
        ("damper.count=1:4:4", [1, 2, 3, 4]),
        ("damper.ball_material=steel,lead", ["steel", "lead"]),
        ("effects.ball_slip=true,auto", [True, "auto"]),
        ("damper.clearance=0.1 mm:0.3 mm:2", [1e-4, 3e-4]),
        ("plate.thickness=5 mm,8 mm", [5e-3, 8e-3]),
        ("plate.root.stiffness=1e9 N/m/m", [1e9]),
    ],
)
def test_values_are_read_in_si(text, values):
    found = axis(text).values
    assert found == tuple(values) if isinstance(values[0], str | bool) else np.allclose(found, values, rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("damper.mas_ratio=1:2:3", "--vary damper.mas_ratio: unknown key: did you mean 'damper.mass_ratio'?"),
        ("mass_ratio=1:2:3", "did you mean 'damper.mass_ratio'?"),
        ("plate.radius=1:2:3", "did you mean"),
        ("rotor.speed=1:2:3", "did you mean 'rotor.speeds'?"),
        ("damper.diameter=2 mm,3 mm", "did you mean 'damper.radius'?"),
        ("damper.radius=1 kg:2 kg:3", "--vary damper.radius = '1 kg:2 kg:3': expected a length such as '20 cm'"),
        ("damper.radius=1:2 mm:3", "give both the unit, or none"),
        ("damper.radius=2 mm:1 mm:3", "expected a STOP above START"),
        ("damper.friction=log:0:1:3", "expected a START above 0"),
        ("damper.restitution=0.5:1.5:3", "expected at most 1"),
        ("damper.friction=0.1:0.5:x", "COUNT, not 'x'"),
        ("damper.restitution=0.5:0.7:1", "--vary damper.restitution = '0.5:0.7:1': a single value leaves STOP out"),
        ("damper.clearance=-1 mm:4 mm:3", "--vary damper.clearance = '-1 mm:4 mm:3': expected more than 0"),
        ("damper.clearance[1]=0 mm", "--vary damper.clearance[1] = '0 mm': expected more than 0"),
        ("damper.friction=0.1:0.5:0", "COUNT"),
        ("damper.friction=0.1,0.1", "every value once"),
        ("damper.friction=", "expected START:STOP:COUNT"),
        ("damper.friction", "expected START:STOP:COUNT"),
        ("damper.count=1:4:3", "whole numbers"),
        ("damper.ball_material=steal", "did you mean 'steel'?"),
        ("damper.ball_material=steel:lead:2", "has no numbers to range over"),
        ("damper.radius[0]=1 mm", "has no elements"),
        ("damper.cavity[2]=1 mm", "expected an element [0] or [1]"),
        ("release.cycles=auto,3", "numbers or words, not both"),
    ],
)
def test_errors_name_key_and_value(text, says):
    with pytest.raises(BadInput) as found:
        axes.read([text], G)
    assert says in str(found.value)


@pytest.mark.parametrize(
    "pair",
    [
        ("damper.friction=0.1,0.2", "damper.friction=0.3"),
        ("damper.mass=1 g,2 g", "damper.mass_ratio=0.1,0.2"),
        ("damper.cavity=3 mm,4 mm", "damper.clearance=1 mm,2 mm"),
        ("damper.cavity[0]=3 mm,4 mm", "damper.cavity=3 mm,4 mm"),
    ],
)
def test_what_says_the_same_is_varied_once(pair):
    with pytest.raises(BadInput, match=r"once|one of them"):
        axes.read(pair, G)


def test_the_key_that_another_takes_the_place_of():
    scene = load("paper").scene
    replaced = {name: axes.find(name, "--vary").displaced(scene) for name in ("damper.mass", "damper.ball_material")}
    assert set(replaced.values()) == {"damper.mass_ratio"}
    for name in ("damper.mass_ratio", "damper.radius", "rotor.speeds", "material.density"):
        assert axes.find(name, "--vary").displaced(scene) is None


@pytest.mark.usefixtures("no_workers")
def test_what_is_replaced_is_said_first(spindamp):
    vary = ("--vary", "damper.mass=0.1 g", "--vary", "rotor.speeds=5000 rpm")
    done = spindamp("sweep", "structure", *vary, "--quick", "--workers", 1, "--out", "out")
    assert done.status == 0, done.err
    assert done.out.splitlines()[0] == "damper.mass takes the place of the scene's damper.mass_ratio"
    assert ": 1 point (" in done.out.splitlines()[1]


def test_every_key_of_the_schema_is_known():
    published = json.loads((SHIPPED.parent / "scene.schema.json").read_text(encoding="utf-8"))
    tables = {name: published["$defs"][name.capitalize()] for name in ("plate", "rotor", "damper", "release")}
    for name, table in tables.items():
        assert {f"{name}.{key}" for key in table["properties"]} <= set(axes.every())


def scene_with(name, **values):
    source = load(name)
    found = {axes.find(key.replace("__", "."), "--vary"): value for key, value in values.items()}
    data = with_values(base(source, list(found)), found)
    return of_a_point(source, data, source.scene.rotor.speeds).scene


def test_a_value_takes_the_place_of_what_says_the_same():
    assert scene_with("paper", damper__ball_material="steel").damper.mass_ratio is None
    assert scene_with("paper", release__ratio=0.3).release.displacement is None
    assert scene_with("paper", material__name="steel").material.density == 7850.0


def test_clearances_add_to_the_diameter():
    damper = scene_with("paper", damper__clearance=1e-3, damper__radius=2e-3).damper
    assert damper.cavity == (5e-3, 5e-3)


def test_what_is_not_varied_stays():
    for name in ("paper", "structure", "printed"):
        source = load(name)
        assert of_a_point(source, base(source, []), source.scene.rotor.speeds).scene == source.scene


def test_a_sample_is_the_sobol_sequence():
    given = axes.read(["damper.friction=0:1", "damper.radius=log:0.1 mm:1 mm"], G)
    plan = sample(given, (100.0, 200.0), 64, seed=7)
    shares = {axis.name: k for k, axis in enumerate(plan.drawn)}
    expected = qmc.Sobol(2, scramble=True, rng=7).random(64)
    every = plan.columns(0, 128)
    assert np.array_equal(every["damper.friction"][::2], expected[:, shares["damper.friction"]])
    assert np.allclose(np.log10(every["damper.radius"][::2]), -4 + expected[:, shares["damper.radius"]])
    assert every["rotor.speeds"][:4] == [100.0, 200.0, 100.0, 200.0]
    parts = [plan.columns(begin, min(begin + 5, 128)) for begin in range(0, 128, 5)]
    assert [value for part in parts for value in part["damper.radius"]] == every["damper.radius"]


def test_a_grid_puts_plates_first_and_speeds_last():
    given = axes.read(["damper.friction=0,1", "damper.mass_ratio=0.1,0.2", "plate.thickness=5 mm,6 mm"], G)
    names = list(grid(given, (1.0, 2.0)).dimensions)
    assert names == ["plate.thickness", "damper.mass_ratio", "damper.friction", "rotor.speeds"]


def test_a_normal_distribution_has_its_quantiles():
    from scipy.stats import norm

    spread = axis("damper.friction=normal:0.3:0.05").spread
    inner = norm.cdf(3) - norm.cdf(-3)
    shares = (norm.cdf([-1, 0, 1]) - norm.cdf(-3)) / inner
    assert np.allclose(spread.at(shares), [0.25, 0.3, 0.35], rtol=1e-12)


def test_points_are_what_runs_give(document, here):
    """Bit for bit: the same plate at the same speeds, the same damper."""
    headlines = {each.name for each in serialise.quantities(Damping) if each.headline}
    assert headlines >= {"events", "peak_sdc", "cutoff_ratio"}
    found = spindamp.sweep("paper", {"damper.restitution": [0.5]}, executor=here).isel({"damper.restitution": 0})
    for k, speed in enumerate(document["speeds"]):
        point = found.isel({"rotor.speeds": k})
        assert point.f1_hz == speed["reduced"]["f1_hz"]
        for name in headlines:
            assert point[name] == speed["damper"][name], name
        assert point.damping_ratio_peak == speed["working"]["damping_ratio_peak"]
        assert point.range_high == speed["working"]["range"][1]


def test_quick_figures_are_within_a_percent(here):
    varied = {"damper.clearance": ["0.2 mm", "1 mm"], "damper.restitution": [0.3, 0.8]}
    fine, quick = (spindamp.sweep("structure", varied, quick=q, executor=here) for q in (False, True))
    assert np.allclose(quick.damping_ratio_peak, fine.damping_ratio_peak, rtol=0.02)
    assert not np.array_equal(quick.damping_ratio_peak, fine.damping_ratio_peak)


def test_a_point_without_answer_is_a_row_with_its_reason(here):
    found = spindamp.sweep("structure", {"damper.radius": ["1 mm", "1.3 mm"]}, executor=here, quick=True)
    assert "does not fit" in str(found.reason.values[1, 0])
    assert np.isnan(found.damping_ratio_peak.values[1, 0])
    assert str(found.reason.values[0, 0]) == ""
    assert found.damping_ratio_peak.values[0, 0] > 0


def test_the_best_is_one_that_can_be_had(here):
    """Half a gram of radius 1 mm is five times as dense as osmium: it has its figures, but no verdict."""
    grams = [5e-5, 5e-4]
    found = spindamp.sweep("structure", {"damper.mass": grams, "damper.count": 1}, executor=here, quick=True)
    heavy, light = found.isel({"damper.mass": 1}), found.isel({"damper.mass": 0})
    assert (heavy.damping_ratio_peak > light.damping_ratio_peak).all()
    assert (heavy.grade == -1).all()
    assert np.isnan(heavy.best_damping_ratio).all()
    assert (light.grade >= 0).all()
    told = report.document(found)
    assert told["best"]["keys"]["damper.mass"] == grams[0]
    assert (told["without_verdict"], told["without_answer"]) == (1, 0)
    assert "1 point has no verdict" in report.text(found)


def test_speeds_without_a_picture_are_named(here):
    """Between those at which the weight is more than the load and those at which the root is torn, some are drawn."""
    varied = {"damper.restitution": [0.2, 0.8], "damper.friction": [0.1, 0.4]}
    speeds = ["0 rpm", "20 rpm", "4000 rpm", "60000 rpm"]
    found = spindamp.sweep("paper", varied | {"rotor.speeds": speeds}, quick=True, executor=here)
    said = report.in_words(found, report._best(found), "damper.restitution", "damper.friction")
    assert "Nothing to draw at 0 rpm to 20 rpm, 60000 rpm: there, no ball has a verdict, or takes anything" in said


def test_divergence_is_a_reason(here):
    """Spin softening takes the stiffness of a plate that spins across its thickness, beyond its first frequency."""
    scene = tomllib.loads((SHIPPED / "paper.toml").read_text(encoding="utf-8"))
    scene["rotor"] |= {"stagger": "90 deg", "speeds": ["3000 rpm"]}
    scene["effects"] = {"stress_stiffening": False, "large_deflection": False, "coriolis": False}
    found = spindamp.sweep(scene, {"rotor.speeds": ["3000 rpm", "60000 rpm"]}, executor=here, quick=True)
    assert str(found.reason.values[0]) == ""
    assert "diverges" in str(found.reason.values[1])


def test_a_sample_has_its_keys_as_coordinates(here):
    varied = {"damper.friction": "0:1", "rotor.speeds": "3000 rpm:9000 rpm"}
    found = spindamp.sweep("structure", varied, sample=3, quick=True, executor=here)
    assert found.sizes == {"sample": 3}
    assert found["damper.friction"].dims == found["rpm"].dims == ("sample",)


def test_nothing_to_vary():
    with pytest.raises(BadInput, match="nothing is varied"):
        study.asked("structure", {})
    with pytest.raises(BadInput, match="needs its COUNT"):
        study.asked("structure", ["damper.friction=0:1"])
    with pytest.raises(BadInput, match=r"no \[plate\]"):
        study.asked("structure", ["plate.thickness=5 mm,6 mm"])
    with pytest.raises(BadInput, match="sweep needs a damper"):
        study.asked("campbell", ["rotor.modes=4,5"])


def test_from_the_command_line(spindamp, tmp_path):
    vary = ("--vary", "damper.friction=0.1:0.3:2", "--vary", "damper.clearance=0.2 mm:1 mm:2")
    done = spindamp("sweep", "structure", *vary, "--quick", "--workers", "1", "--out", tmp_path / "out", "--json")
    assert done.status == 0, done.err
    assert json.loads(done.out) == json.loads((tmp_path / "out" / "sweep.json").read_text(encoding="utf-8"))
    assert (tmp_path / "out" / "report.html").read_text(encoding="utf-8").count("<svg") >= 1
    assert findings(tmp_path / "out" / "report.html") == []
    again = spindamp("sweep", "structure", *vary, "--quick", "--workers", "1", "--out", tmp_path / "out", "--json")
    assert (again.status, again.out) == (0, done.out)
    wrong = spindamp("sweep", "structure", "--vary", "damper.frictoin=1,2")
    assert wrong.status == 2
    assert "did you mean 'damper.friction'?" in wrong.err


@pytest.mark.usefixtures("no_workers")
def test_a_sweep_in_which_no_point_has_an_answer(spindamp, tmp_path):
    """Five cavities of metres, 0.2 m from the axis: one cause, however many numbers it comes with."""
    varied = ("sweep", "structure", "--vary", "damper.clearance=1 m:4 m:5")
    ended = spindamp(*varied, "--out", "out")
    assert ended.status == 3
    cause = "5 × [damper] cavity: the cavity is larger than its distance from the axis, 0.2 m"
    assert ended.err.splitlines()[-1] == f"spindamp: structure.toml: no point has an answer: {cause}"
    assert ended.out.count("larger than its distance") == 1
    assert (tmp_path / "out" / "report.html").is_file()
    told = json.loads(spindamp(*varied, "--out", "out", "--json").out)
    assert told["reasons"] == [{"reason": cause.removeprefix("5 × "), "points": 5}]


@pytest.mark.parametrize(
    "varied",
    ["damper.clearance=1:4:5", "damper.cavity[0]=log:3:6:4", "damper.radius=1,2", {"damper.radius": [1.0, 2.0]}],
)
def test_lengths_without_a_unit_that_are_nearer_in_millimetres_are_questioned(varied):
    given = [varied] if isinstance(varied, str) else varied
    with pytest.raises(BadInput, match=r"a length without a unit is in m, and the scene has .* mm' meant"):
        study.asked("structure", given)


@pytest.mark.parametrize("varied", ["damper.clearance=1 m:4 m:5", "damper.clearance=0.0001:1:5", "damper.mass=1:4:5"])
def test_lengths_that_may_be_meant_are_taken(varied):
    assert study.asked("structure", [varied]).plan.axes[0].values
