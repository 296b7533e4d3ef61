"""Sweeps: what is varied, the points of a study, and that each is what a run of its scene gives."""

import json
import math
import re
from functools import partial

import numpy as np
import pytest
import xarray as xr
from scipy.stats import norm, qmc

import spindamp
from tests.workflows.browser import findings
from tests.workflows.conftest import ROOT, changed, refused, shipped_scene, stored, table_of
from workflows.errors import BadInput
from workflows.io import serialise
from workflows.report import plots
from workflows.report.templates import said
from workflows.scene.load import SHIPPED, load, parse
from workflows.solve.results import Damping
from workflows.studies.sweep import evaluate, report, sensitivity, study
from workflows.studies.sweep import plan as axes
from workflows.studies.sweep.plan import base, grid, of_a_point, sample, with_values
from workflows.studies.sweep.report import HEADLINE

G = 9.80665
VARIED = table_of("varied")


def axis(text):
    (found,) = axes.read([text], G)
    return found


@pytest.mark.parametrize(("text", "values"), VARIED["read"])
def test_values_are_read_in_si(text, values):
    found = axis(text).values
    assert found == tuple(values) if isinstance(values[0], str | bool) else np.allclose(found, values, rtol=1e-12)


def test_a_deviation_is_no_number_of_points():
    """Of Young's modulus in Pa it is larger than any number of points may be."""
    found = axis("material.youngs_modulus=normal:182600000000:1826000000")
    assert (found.spread.mean, found.spread.deviation, found.values) == (182.6e9, 1.826e9, ())


@pytest.mark.parametrize(("text", "says"), VARIED["wrong"])
def test_errors_name_key_and_value(text, says):
    with pytest.raises(BadInput) as found:
        axes.read([text], G)
    assert says in str(found.value)


HUGE = 10**9
"""Values that would fill the memory before any point is computed."""


@pytest.mark.parametrize(
    ("vary", "sampled", "points"),
    [
        (["damper.friction=0.1:0.2:1000000000"], (), "4000000000"),
        (["damper.friction=0.1:0.2:100000", "damper.restitution=log:0.1:0.2:10000"], (), "4000000000"),
        (["damper.friction=0.1:0.2:1000000000", "rotor.speeds=1000 rpm,2000 rpm"], (), "2000000000"),
        (["damper.friction=0.1:0.2"], ("--sample", HUGE), "4000000000"),
        (["damper.friction=0.1:0.2:1000000000"], ("--sample", 10), "1000000000"),
        (["damper.friction=0.1:0.2", "rotor.speeds=1000 rpm:2000 rpm"], ("--sample", HUGE), "1000000000"),
        (["damper.friction=0.1:0.2"], ("--uncertain", "--sample", 2**30), "1.288490189e+10"),
    ],
)
def test_a_sweep_that_no_machine_would_end_is_refused_first(spindamp, tmp_path, vary, sampled, points):
    """With four speeds, unless they are varied; the values of a key are not computed before."""
    speeds = {"start": "1000 rpm", "stop": "4000 rpm", "count": 4}
    options = [each for text in vary for each in ("--vary", text)]
    done = spindamp("sweep", changed(shipped_scene("paper"), rotor__speeds=speeds), *options, *sampled, "--out", "out")
    refused(done, "", f"expected at most 10000000 points, all speeds counted, not {points}")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--workers", 0), "--workers = 0: expected a whole number of processes from 1 on"),
        (("--seed", -1), "--seed = -1: expected a whole number from 0 on"),
    ],
)
def test_a_refused_sweep_leaves_no_folder(spindamp, tmp_path, options, message):
    refused(spindamp("sweep", "structure", "--vary", "damper.restitution=0.3:0.5:3", *options, "--out", "out"), message)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("options", [("--sample", 2), ("--uncertain", "--sample", 8)])
def test_a_count_that_a_sample_ignores_is_remarked(spindamp, options):
    done = spindamp("sweep", "structure", "--vary", "damper.restitution=0.3:0.5:7", *options, "--quick", "--json")
    said = "WARNING: structure.toml: --vary damper.restitution=0.3:0.5:7: a sample covers the whole range and ignores"
    assert (done.status, said in " ".join(done.err.split())) == (0, True)


def test_counts_may_be_of_numpy(here):
    how = {"quick": True, "executor": here, "seed": np.int64(3)}
    once = {"damper.friction": (each for each in (0.1, 0.2))}
    assert spindamp.sweep("structure", once, **how).sizes["damper.friction"] == 2
    found = spindamp.sweep("structure", {"damper.friction": "0.1:0.2"}, sample=np.int64(2), **how)
    assert found.equals(spindamp.sweep("structure", {"damper.friction": "0.1:0.2"}, sample=2, **how))


@pytest.mark.parametrize("seed", [-1, 1.5, "a", True])
def test_seeds_are_whole_numbers(seed):
    for search in (partial(spindamp.design, "design"), partial(spindamp.sweep, "structure", "damper.friction=0.1,0.2")):
        with pytest.raises(BadInput, match=r"--seed = .*expected a whole number from 0 on"):
            search(seed=seed)


@pytest.mark.parametrize("count", [None, 10])
def test_python_refuses_it_too(count):
    vary = {"damper.friction": np.broadcast_to(0.1, HUGE)}
    with pytest.raises(BadInput, match=r"^vary.*: expected at most 10000000 points, all speeds counted, not \d+$"):
        spindamp.sweep("structure", vary, sample=count)


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
    for names, replaced in (
        (("damper.mass", "damper.ball_material"), "damper.mass_ratio"),
        (("damper.mass_ratio", "damper.radius", "rotor.speeds", "material.density"), None),
    ):
        assert {axes.find(name, "--vary").replaced(scene) for name in names} == {replaced}


@pytest.mark.usefixtures("no_workers")
def test_what_is_replaced_is_said_first(spindamp):
    vary = ("--vary", "damper.mass=0.1 g", "--vary", "rotor.speeds=5000 rpm")
    done = spindamp("sweep", "structure", *vary, "--quick", "--workers", 1, "--out", "out")
    assert done.status == 0, done.err
    assert done.out.splitlines()[0] == "damper.mass replaces the scene's damper.mass_ratio"
    assert ": 1 point (" in done.out.splitlines()[1]


def test_every_key_of_the_schema_is_known():
    published = stored(SHIPPED.parent / "scene.schema.json")["$defs"]
    for name in ("plate", "rotor", "damper", "release"):
        assert {f"{name}.{key}" for key in published[name.capitalize()]["properties"]} <= set(axes.every())


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
    shares = {axis.name: k for k, axis in enumerate(plan.axes)}
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
    spread = axis("damper.friction=normal:0.3:0.05").spread
    inner = norm.cdf(3) - norm.cdf(-3)
    shares = (norm.cdf([-1, 0, 1]) - norm.cdf(-3)) / inner
    assert np.allclose(spread.at(shares), [0.25, 0.3, 0.35], rtol=1e-12)


@pytest.mark.parametrize(
    ("values", "median", "deviation"), [("log:1:1000", 32, 226.9), ("normal:500:100", 500, 99), ("301:700", 500, 115)]
)
def test_whole_numbers_follow_the_law_of_their_range(values, median, deviation):
    shares = (np.arange(4000) + 0.5) / 4000
    drawn = axis(f"damper.count={values}").at(shares)
    assert {type(each) for each in drawn} == {int}
    assert (np.median(drawn), np.std(drawn)) == (pytest.approx(median, abs=1), pytest.approx(deviation, rel=0.02))


def test_a_floor_flat_along_one_axis_alone_is_refused():
    with pytest.raises(BadInput, match=r"a floor is flat along both axes: vary damper.floor_radius"):
        axis("damper.floor_radius[1]=flat,20 mm")
    hollow = axis("damper.floor_radius[1]=20 mm")
    with pytest.raises(BadInput, match=r"damper.floor_radius\[1\]: the floor is flat along the other axis: give"):
        hollow.key.put({"damper": {"radius": 1e-3}}, hollow.values[0])


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
        useful = [point.verdict_useful_range_low, point.verdict_useful_range_high]
        assert np.array_equal(useful, np.array(speed["verdict"]["useful_range"], float), equal_nan=True)
    limited = found.isel({"rotor.speeds": [1]})
    assert "restitution = 0.5, rotor.speeds = 5000 rpm: a damping ratio" in report.text(limited)
    low, high = (1e3 * float(limited[f"verdict_useful_range_{end}"][0]) for end in ("low", "high"))
    assert high < 1e3 * limited.range_high[0], "which the plate does not endure"
    page = " ".join(re.sub("<[^>]+>", " ", report.render(limited)).split())
    assert f"at least half of the peak from, mm {low:.3g} and up to, mm {high:.3g} " in page


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
    assert told["best_at_end"] == [], "of two values each is an end"
    assert "1 point has no verdict" in report.text(found)


def test_speeds_without_a_picture_are_named(here):
    """Between those at which the weight is more than the load and those at which the root is torn, some are drawn."""
    varied = {"damper.restitution": [0.2, 0.8], "damper.friction": [0.1, 0.4]}
    speeds = ["0 rpm", "20 rpm", "4000 rpm", "60000 rpm"]
    scene = changed(shipped_scene("paper"), rotor__modes=2, release__cycles=2, accuracy__frequency=0.05)
    found = spindamp.sweep(scene, varied | {"rotor.speeds": speeds}, quick=True, executor=here)
    said = report.map_caption(found, report.HEADLINE, "damper.restitution", "damper.friction")
    assert "Not drawn: 0 rpm to 20 rpm, 60000 rpm, where no ball has a verdict or adds damping" in said


def test_divergence_is_a_reason(here):
    """Spin softening takes the stiffness of a plate that spins across its thickness, beyond its first frequency."""
    scene = shipped_scene("paper")
    scene["rotor"] |= {"stagger": "90 deg", "speeds": ["3000 rpm"], "modes": 1}
    scene["effects"] = {"stress_stiffening": False, "large_deflection": False, "coriolis": False}
    scene["accuracy"] = {"frequency": 0.05}
    found = spindamp.sweep(scene, {"rotor.speeds": ["3000 rpm", "60000 rpm"]}, executor=here, quick=True)
    assert str(found.reason.values[0]) == ""
    assert "diverges" in str(found.reason.values[1])


def test_a_sample_has_its_keys_as_coordinates(here):
    varied = {"damper.friction": "0:1", "rotor.speeds": "3000 rpm:9000 rpm"}
    found = spindamp.sweep("structure", varied, sample=3, quick=True, executor=here)
    assert found.sizes == {"sample": 3}
    assert found["damper.friction"].dims == found["rpm"].dims == ("sample",)


def test_nothing_to_vary():
    for scene, varied, says in (
        ("structure", {}, "nothing is varied"),
        ("structure", ["damper.friction=0:1"], "needs its COUNT"),
        ("structure", ["plate.thickness=5 mm,6 mm"], r"no \[plate\]"),
        ("campbell", ["rotor.modes=4,5"], "sweep needs a damper"),
    ):
        with pytest.raises(BadInput, match=says):
            study.of_scene(scene, varied)


@pytest.mark.usefixtures("no_workers")
def test_from_the_command_line(spindamp, tmp_path):
    vary = ("--vary", "damper.friction=0.1:0.3:2", "--vary", "damper.clearance=0.2 mm:1 mm:2")
    command = ("sweep", "structure", *vary, "--quick", "--workers", "1", "--out", "out")
    found = spindamp.json(*command)
    assert found == stored(tmp_path / "out" / "sweep.json") == spindamp.json(*command)
    assert (tmp_path / "out" / "report.html").read_text(encoding="utf-8").count("<svg") >= 1
    assert findings(tmp_path / "out" / "report.html") == []
    refused(spindamp("sweep", "structure", "--vary", "damper.frictoin=1,2"), "", "did you mean 'damper.friction'?")


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
        study.of_scene("structure", given)


@pytest.mark.parametrize("varied", ["damper.clearance=1 m:4 m:5", "damper.clearance=0.0001:1:5", "damper.mass=1:4:5"])
def test_lengths_that_may_be_meant_are_taken(varied):
    assert study.of_scene("structure", [varied]).plan.axes[0].values


def test_a_quick_sweep_promises_the_same_in_python_as_in_the_guide():
    guide = (ROOT / "docs" / "guide" / "sweeps.md").read_text(encoding="utf-8")
    for text in (guide, spindamp.sweep.__doc__):
        said_of_it = " ".join(text.lower().split())
        for promise in (
            "half to two thirds of the time",
            "three in four",
            "within 1 %",
            "tens of percent",
        ):
            assert promise in said_of_it


def remark(speed, rpm):
    return f"Speeds without a unit are in rad/s: {speed} is {rpm} rpm. Was '{speed} rpm' meant?"


@pytest.mark.parametrize(
    ("own", "varied", "remarks"),
    [
        (["3000 rpm"], "rotor.speeds=100,200", [remark(200, "1909.86")]),
        (["3000 rpm"], "rotor.speeds=100, 2000 rpm", [remark(100, "954.93")]),
        (["3000 rpm"], "rotor.speeds=log:100:200:3", [remark(200, "1909.86")]),
        (["3000 rpm"], {"rotor.speeds": np.array([100, 200])}, [remark(200, "1909.86")]),
        ([100, 600], "rotor.speeds=100,200", [remark(200, "1909.86")]),
        ([100, 600], "rotor.speeds=0:2000 rpm:3", []),
        ([100, 600], "damper.restitution=0.4,0.5", [remark(600, "5729.58")]),
    ],
)
def test_speeds_without_a_unit_that_are_varied_are_remarked_on(own, varied, remarks):
    """In place of those of the scene, which are not used."""
    scene = changed(shipped_scene("structure"), rotor__speeds=own)
    found = study.of_scene(scene, [varied] if isinstance(varied, str) else varied)
    assert list(found.source.remarks) == remarks


@pytest.mark.usefixtures("no_workers")
def test_a_sweep_warns_of_speeds_without_a_unit(spindamp):
    varied = ("sweep", "structure", "--vary", "rotor.speeds=100,200", "--quick", "--json")
    assert f"spindamp: WARNING: structure.toml: {remark(200, '1909.86')}" in spindamp(*varied).err.splitlines()


A, B = 7.0, 0.1


def known_indices():
    """First order and total, by hand."""
    one = 0.5 * (1 + B * math.pi**4 / 5) ** 2
    two = A**2 / 8
    both = 8 * B**2 * math.pi**8 / 225
    whole = one + two + both
    return np.array([one, two, 0.0]) / whole, np.array([one + both, two, both]) / whole


def angles():
    """Three axes of a sample, each from -π to π whatever its name."""
    keys = [axes.find(name, "--vary") for name in ("damper.friction", "damper.restitution", "damper.damping_ratio")]
    return [axes.Axis(key, (), axes.Spread(-math.pi, math.pi)) for key in keys]


def ishigami(base):
    """Ishigami and Homma 1990: sin x1 + 7 sin² x2 + 0.1 x3⁴ sin x1 on Saltelli's design of so many base points."""
    plan = sensitivity.plan(angles(), (1.0,), base, seed=3)
    columns = plan.columns(0, plan.size)
    x = np.array([columns[axis.name] for axis in angles()])
    return np.sin(x[0]) + A * np.sin(x[1]) ** 2 + B * x[2] ** 4 * np.sin(x[0])


def test_indices_of_ishigami():
    values = ishigami(4096)
    found = sensitivity.indices(values, 3, seed=3)
    first, total = known_indices()
    assert np.allclose(first, [0.3139, 0.4424, 0.0], atol=1e-4)
    assert np.all(np.abs(found["S1"] - first) <= 1.5 * found["S1_conf"])
    assert np.all(np.abs(found["ST"] - total) <= 1.5 * found["ST_conf"])
    assert found["ST_conf"].max() < 0.06
    known = sensitivity.independent(values, 3)
    assert known.mean() == pytest.approx(A / 2, abs=0.1)


def test_points_without_answer_take_their_base_point_along():
    values = ishigami(512)
    values[::37] = np.nan
    found = sensitivity.indices(values, 3, seed=3)
    assert np.all(np.abs(found["ST"] - known_indices()[1]) <= 2 * found["ST_conf"])
    assert np.isnan(sensitivity.indices(np.full_like(values, np.nan), 3, seed=3)["S1"]).all()
    assert not sensitivity.indices(np.full_like(values, 2.0), 3, seed=3)["S1"].any()


def test_confidence_is_resampled_alike():
    """By the same seed, also by 0, which SALib takes for none."""
    values = np.sin(np.arange(8 * 5))
    for seed in (0, 3):
        first, again = (sensitivity.indices(values, 3, seed)["ST_conf"] for _ in range(2))
        assert np.array_equal(first, again)


def test_what_is_uncertain_has_a_verdict(here):
    """Balls denser than osmium, and amplitudes that the plate does not endure, have no part in what is said."""
    dense = changed(shipped_scene("structure"), damper__count=1, release__cycles=2)
    for scene, says in ((dense, "no verdict"), (at_full_speed(), "No point adds damping at an amplitude that the")):
        vary = {"damper.friction": "0.2:0.4"}
        found = spindamp.sweep(scene, vary, uncertain=True, sample=8, quick=True, executor=here)
        assert (found.damping_ratio_peak > 0).all()
        assert not (found.percentiles.sel(quantity="best_damping_ratio") > 0).any()
        assert report.document(found)["best"] is None
        assert says in report.text(found)
        assert "largest damping ratio" not in report.text(found)
        said = report.render(found)
        assert says in said
        assert ">nan" not in said


def test_the_text_has_a_line_for_each_statement():
    values = {"best_damping_ratio": 1e-3, "best_amplitude": 2e-3, "friction_needed": None, "sticks_out": None}
    reasons = [{"points": 1, "reason": "too wide"}, {"points": 1, "reason": "too heavy"}]
    result = {"title": "T", "points": 4, "dimensions": {"a": 4}, "best": {"values": values}, "reasons": reasons}
    result |= {"without_verdict": 1, "without_answer": 2, "without_friction": 0, "best_at_end": [], "as_good": 0}
    spread = {
        "judged": 1.0,
        "rpm": 1000.0,
        "percentiles": [0.001, 0.002, 0.003, 0.004, 0.005],
        "ranked": [("k", 0.5, 0.1)],
    }
    best = "The best point is a = 1 mm: a damping ratio of 0.1 % at an amplitude of 2 mm"
    known = {"result": result, "best": {"a": "1 mm"}, "error": 0.01}
    assert said("sweep/text", spread=None, **known)[:2] == ["T: 4 points (4 a)", best]
    held = {"best": {"values": values | {"sticks_out": 1.3e-3}}, "best_at_end": ["a"], "as_good": 1}
    assert said("sweep/text", spread=None, **known | {"result": result | held})[1] == (
        f"{best}, provided that the cavity fits: it sticks out of the structure by up to 1.3 mm; it lies at an end of"
        " a; within the stated errors 1 other point is as good"
    )
    half = said("sweep/text", spread=spread | {"judged": 0.375}, **known)[1]
    assert "a median of 0.3 %, of the 38 % of the sample that have a verdict; share of" in half
    roughly = best.replace("0.1 %", "0.1 % (±20 %)")
    assert said("sweep/text", spread=None, **known | {"error": 0.2})[1] == roughly
    assert said("sweep/text", spread=spread, **known) == [
        "T: 4 points (4 a)",
        "At 1000 rpm the largest damping ratio is 0.1 to 0.5 % in 90 % of the cases, with a median of 0.3 %; share of"
        " the variance by parameter, interactions included: k 50 ± 10 %",
        "1 point has no verdict: `spindamp run` of such a point gives the reason",
        "2 points have no answer:",
        "1 × too wide",
        "1 × too heavy",
    ]


def test_a_point_that_rests_on_more_friction_than_it_has_says_so(here):
    """Of points alike the best is one whose friction is enough."""
    scene = changed(shipped_scene("structure"), release__cycles=2)
    found = spindamp.sweep(scene, {"damper.friction": [1e-9, 0.01, 0.9]}, quick=True, executor=here)
    least, _, enough = (found.isel({"damper.friction": k}) for k in range(3))
    assert (least.best_damping_ratio == enough.best_damping_ratio).all()
    assert (least.friction_needed > 0.01).all()
    assert np.isnan(enough.friction_needed).all()
    assert report.document(found)["best"]["keys"]["damper.friction"] == 0.9
    count = 2 * found.sizes["rotor.speeds"]
    assert f"{count} points rest on balls that roll without slip" in report.text(found)
    assert "provided" not in report.text(found)
    assert report.document(found)["best_at_end"] == []
    rising = found.assign(best_damping_ratio=found.best_damping_ratio * [[1.0], [1.1], [1.2]])
    assert report.document(rising)["best_at_end"] == ["damper.friction"]
    assert report.document(rising.isel({"damper.friction": [2, 1, 0]}))["best_at_end"] == ["damper.friction"]
    assert "; it lies at an end of damper.friction" in report.text(rising)
    assert report.document(rising)["as_good"] == 0
    unsure = rising.assign(working_error=rising.working_error.copy(data=[[0.04], [0.05], [0.05]]))
    assert report.document(unsure)["as_good"] == 1, "1.1 of 1.2 within 5 % of each, 1.0 not within 4 %"
    alone = found.isel({"damper.friction": [0]})
    needed = report.document(alone)["best"]["values"]["friction_needed"]
    says = f"which requires a friction coefficient of {needed:.2g} there, more than the point has"
    assert says in report.text(alone)
    assert "rests on balls that roll without slip" in report.render(alone)


def test_few_points_with_a_verdict(here):
    """The ball's weight is more than the load at 50 rpm; above 0.095 g the ball is denser than osmium."""
    scene = changed(shipped_scene("structure"), damper__count=1, damper__mass_ratio=None, damper__mass="0.05 g")
    scene = changed(scene, rotor__speeds=["50 rpm", "9000 rpm"], release__cycles=2)
    found = spindamp.sweep(scene, {"damper.mass": "0.05 g:0.4 g"}, uncertain=True, sample=8, quick=True, executor=here)
    shares = found.percentiles.sel(quantity="best_damping_ratio").values
    assert np.isnan(shares[:, 0]).all()
    assert (shares[:, 1:] > 0).all()
    assert not any(line.strip() == "" for line in report.text(found).splitlines())
    assert "nan" not in report.text(found)
    assert ">nan" not in report.render(found)


def at_full_speed():
    scene = shipped_scene("paper")
    scene["effects"] = {"structural_modes": False}
    return changed(scene, rotor__speeds=["17500 rpm"], rotor__modes=2, release__cycles=2, accuracy__frequency=0.05)


def test_what_is_uncertain_unless_it_is_said():
    found = {axis.name: axis.spread for axis in sensitivity.defaults(load("paper").scene)}
    assert found["damper.restitution"].low == pytest.approx(0.3)
    assert (found["damper.rolling_friction"].low, found["damper.rolling_friction"].high) == pytest.approx((1e-5, 1e-3))
    assert found["damper.clearance[0]"].high == pytest.approx(0.55e-3)
    assert "damper.damping_ratio" in found
    assert "damper.damping_ratio" not in {axis.name for axis in sensitivity.defaults(load("structure").scene)}


def test_what_follows_from_materials_is_uncertain_too():
    """A 4 mm steel ball on titanium keeps 0.77 of 10 m/s and all of 0.1 m/s; rolling takes more than hysteresis."""
    scene = shipped_scene("structure")
    auto = {"restitution": "auto", "rolling_friction": "auto", "radius": "2 mm", "cavity": ["4.8 mm", "4.8 mm"]}
    scene["damper"] = {"ball_material": "hardened steel", "floor_material": "Ti-6Al-4V", "friction": 0.2, **auto}
    found = {axis.name: axis.spread for axis in sensitivity.defaults(parse(scene))}
    assert (found["damper.restitution"].low, found["damper.restitution"].high) == pytest.approx((0.77, 1.0), abs=0.01)
    assert (found["damper.rolling_friction"].low, found["damper.rolling_friction"].high) == pytest.approx((2e-7, 2e-5))


def test_what_is_no_distribution():
    scene = load("structure").scene
    with pytest.raises(BadInput, match="expected a distribution"):
        sensitivity.axes(["damper.friction=0.1,0.2"], scene)
    with pytest.raises(BadInput, match="power of two"):
        sensitivity.plan(sensitivity.defaults(scene), (1.0,), 100, 0)


def test_the_cutoff_depends_on_rolling_friction_alone(here):
    """a_r / omega_1² with a_r = Omega² R mu_r / r: an exact answer, spread as its one parameter is."""
    vary = {"damper.rolling_friction": "0.05 mm:0.15 mm", "damper.friction": "0.2:0.4"}
    found = spindamp.sweep("structure", vary, uncertain=True, sample=8, quick=True, executor=here)
    cutoff = found.sel(quantity="cutoff").isel({"rotor.speeds": 0})
    total = dict(zip(cutoff.parameter.values, cutoff.ST.values, strict=True))
    assert total["damper.rolling_friction"] == pytest.approx(1.0, abs=0.4)
    assert total["damper.friction"] == 0.0
    per_metre = float((found.cutoff / found["damper.rolling_friction"])[0, 0])
    assert np.allclose(found.cutoff[:, 0], per_metre * found["damper.rolling_friction"], rtol=1e-12)
    assert float(cutoff.percentiles[2]) == pytest.approx(per_metre * 1e-4, rel=0.1)


@pytest.mark.usefixtures("no_workers")
def test_uncertain_from_the_command_line(spindamp, tmp_path):
    arguments = ("--uncertain", "--sample", 8, "--quick", "--workers", 1, "--out", "out")
    found = spindamp.json("sweep", "structure", "--vary", "damper.restitution=normal:0.5:0.05", *arguments)
    (entry, *_) = found["uncertain"]
    assert entry["quantity"] == "damping_ratio_peak"
    assert entry["percentiles"]["5.0"] < entry["percentiles"]["95.0"]
    assert "worth measuring" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")


RPM = (3000.0, 5000.0, 7000.0, 9000.0)


def tabulated():
    """Damping that grows with mass and clearance, less at each speed, and none from the third on or in a corner."""
    mass, clearance = np.geomspace(1e-3, 1e-2, 6), np.geomspace(1e-4, 4e-3, 5)
    share = np.array([1.0, 0.4, 0.0, 0.0])
    ratio = mass[:, None, None] * (clearance[:, None] / 4e-3) * share
    ratio[:2, 0, :] = 0.0
    omega = np.array(RPM) * math.pi / 30
    dims = ("damper.mass_ratio", "damper.clearance", "rotor.speeds")
    found = {name: (dims, np.full(ratio.shape, np.nan)) for name in evaluate.empty(1).dtype.names if name != "reason"}
    found |= {HEADLINE: (dims, ratio), "cutoff": (dims, np.broadcast_to(1e-9 * omega**2, ratio.shape))}
    coords = dict(zip(dims, (mass, clearance, omega), strict=True)) | {"rpm": ("rotor.speeds", list(RPM))}
    data = xr.Dataset(found, coords)
    data["damper.clearance"].attrs["units"] = "m"
    data["rotor.speeds"].attrs["units"] = "rad/s"
    return data


@pytest.fixture
def data():
    """The same, to be changed."""
    return tabulated()


@pytest.fixture(scope="module")
def picture():
    """Its only map."""
    (found,) = report.draw(tabulated())
    return found


def test_panels_are_of_speeds_at_which_a_ball_works(data, picture):
    assert report.panels(data, ("damper.mass_ratio", "damper.clearance")) == ("rotor.speeds", [0, 1])
    assert "3000 rpm" in picture.svg
    assert "5000 rpm" in picture.svg
    assert "7000 rpm" not in picture.svg
    assert "Not drawn: 7000 rpm to 9000 rpm" in picture.caption
    assert "The load holds the ball at rest below 0.099 mm at 3000 rpm, 0.27 mm at 5000 rpm." in picture.caption
    assert "It lies at an end of mass ratio and clearance" in picture.caption


def test_what_takes_nothing_is_hatched_and_named(data, picture):
    assert "no damping, or no verdict" in picture.svg
    data[HEADLINE] = data[HEADLINE].where(data[HEADLINE] > 0, 1e-5)
    (full,) = report.draw(data)
    assert "no damping, or no verdict" not in full.svg


def test_what_is_hatched_begins_where_the_colours_end():
    """Between a point that damps and one that does not nothing is left white."""
    _, (axes,) = plots.canvas(2.0)
    idle = np.array([[False, False, True]] * 2)
    report.paint(axes, np.arange(3.0), np.arange(2.0), np.zeros((2, 3)), [], [], idle)
    (hatched,) = axes.collections
    covered = [any(path.contains_point((x, 0.5)) for path in hatched.get_paths()) for x in (0.9, 1.1, 1.9)]
    assert covered == [False, True, True]
    assert hatched.get_zorder() < axes.contourf(np.ones((2, 2))).get_zorder()


def test_a_cut_off_that_varies_has_a_map(data):
    data["cutoff"] = data["cutoff"] * (1 + 1e3 * data["damper.clearance"])
    assert len(report.draw(data)) == 2
