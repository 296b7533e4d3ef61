"""Uncertain parameters: percentiles and Sobol' indices, against functions whose own are known."""

from __future__ import annotations

import json
import math
import tomllib
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import spindamp
from tests.workflows.conftest import changed
from workflows.errors import BadInput
from workflows.scene.load import SHIPPED, load
from workflows.studies.sweep import plan as axes
from workflows.studies.sweep import report, sensitivity

A, B = 7.0, 0.1


def ishigami(x):
    """Ishigami and Homma 1990: sin x1 + 7 sin² x2 + 0.1 x3⁴ sin x1 on angles from -π to π."""
    return np.sin(x[0]) + A * np.sin(x[1]) ** 2 + B * x[2] ** 4 * np.sin(x[0])


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


def test_indices_of_ishigami():
    plan = sensitivity.plan(angles(), (1.0,), 4096, seed=3)
    columns = plan.columns(0, plan.count)
    values = ishigami(np.array([columns[axis.name] for axis in plan.drawn]))
    found = sensitivity.indices(values, 3, seed=3)
    first, total = known_indices()
    assert np.allclose(first, [0.3139, 0.4424, 0.0], atol=1e-4)
    assert np.all(np.abs(found["S1"] - first) <= 1.5 * found["S1_conf"])
    assert np.all(np.abs(found["ST"] - total) <= 1.5 * found["ST_conf"])
    assert found["ST_conf"].max() < 0.06
    known = sensitivity.independent(values, 3)
    assert known.mean() == pytest.approx(A / 2, abs=0.1)


def test_points_without_answer_take_their_base_point_along():
    plan = sensitivity.plan(angles(), (1.0,), 512, seed=3)
    columns = plan.columns(0, plan.count)
    values = ishigami(np.array([columns[axis.name] for axis in plan.drawn]))
    values[::37] = np.nan
    found = sensitivity.indices(values, 3, seed=3)
    assert np.all(np.abs(found["ST"] - known_indices()[1]) <= 2 * found["ST_conf"])
    assert np.isnan(sensitivity.indices(np.full_like(values, np.nan), 3, seed=3)["S1"]).all()
    assert not sensitivity.indices(np.full_like(values, 2.0), 3, seed=3)["S1"].any()


def test_what_is_uncertain_has_a_verdict(here):
    """Balls denser than osmium, and amplitudes that the plate does not endure, have no part in what is said."""
    dense = changed(tomllib.loads((SHIPPED / "structure.toml").read_text(encoding="utf-8")), damper__count=1)
    for scene, says in ((dense, "no verdict"), (at_full_speed(), "No ball takes anything at an amplitude that the")):
        found = spindamp.sweep(
            scene, {"damper.friction": "0.2:0.4"}, uncertain=True, sample=8, quick=True, executor=here
        )
        assert (found.damping_ratio_peak > 0).all()
        assert not (found.percentiles.sel(quantity="best_damping_ratio") > 0).any()
        assert report.document(found)["best"] is None
        assert says in report.text(found)
        assert "largest damping ratio" not in report.text(found)
        said = report.render(found)
        assert says in said
        assert ">nan" not in said


def test_few_points_with_a_verdict(here):
    """The ball's weight is more than the load at 50 rpm; above 0.095 g the ball is denser than osmium."""
    scene = changed(
        tomllib.loads((SHIPPED / "structure.toml").read_text(encoding="utf-8")),
        damper__count=1,
        damper__mass_ratio=None,
        damper__mass="0.05 g",
        rotor__speeds=["50 rpm", "9000 rpm", "10000 rpm"],
    )
    found = spindamp.sweep(scene, {"damper.mass": "0.05 g:0.4 g"}, uncertain=True, sample=8, quick=True, executor=here)
    shares = found.percentiles.sel(quantity="best_damping_ratio").values
    assert np.isnan(shares[:, 0]).all()
    assert (shares[:, 1:] > 0).all()
    assert not any(line.strip() == "" for line in report.text(found).splitlines())
    assert "nan" not in report.text(found)
    assert ">nan" not in report.render(found)


def at_full_speed():
    scene = tomllib.loads((SHIPPED / "paper.toml").read_text(encoding="utf-8"))
    scene["effects"] = {"structural_modes": False}
    return changed(scene, rotor__speeds=["17500 rpm"])


def test_what_is_uncertain_unless_it_is_said():
    found = {axis.name: axis.spread for axis in sensitivity.defaults(load("paper").scene)}
    assert found["damper.restitution"].low == pytest.approx(0.3)
    assert (found["damper.rolling_friction"].low, found["damper.rolling_friction"].high) == pytest.approx((1e-5, 1e-3))
    assert found["damper.clearance[0]"].high == pytest.approx(0.55e-3)
    assert "damper.damping_ratio" in found
    assert "damper.damping_ratio" not in {axis.name for axis in sensitivity.defaults(load("structure").scene)}


def test_errors():
    scene = load("structure").scene
    with pytest.raises(BadInput, match="expected a distribution"):
        sensitivity.axes(["damper.friction=0.1,0.2"], scene)
    with pytest.raises(BadInput, match="power of two"):
        sensitivity.plan(sensitivity.defaults(scene), (1.0,), 100, 0)


def test_the_cutoff_depends_on_rolling_friction_alone():
    """a_r / omega_1² with a_r = Omega² R mu_r / r: an exact answer, spread as its one parameter is."""
    with ThreadPoolExecutor(1) as here:
        vary = {"damper.rolling_friction": "0.05 mm:0.15 mm", "damper.friction": "0.2:0.4"}
        found = spindamp.sweep("structure", vary, uncertain=True, sample=8, quick=True, executor=here)
    cutoff = found.sel(quantity="cutoff").isel({"rotor.speeds": 0})
    total = dict(zip(cutoff.parameter.values, cutoff.ST.values, strict=True))
    assert total["damper.rolling_friction"] == pytest.approx(1.0, abs=0.4)
    assert total["damper.friction"] == 0.0
    per_metre = float((found.cutoff / found["damper.rolling_friction"])[0, 0])
    assert np.allclose(found.cutoff[:, 0], per_metre * found["damper.rolling_friction"], rtol=1e-12)
    assert float(cutoff.percentiles[2]) == pytest.approx(per_metre * 1e-4, rel=0.1)


def test_from_the_command_line(spindamp, tmp_path):
    arguments = ("--uncertain", "--sample", 8, "--quick", "--workers", 1, "--out", tmp_path / "out", "--json")
    done = spindamp("sweep", "structure", "--vary", "damper.restitution=normal:0.5:0.05", *arguments)
    assert done.status == 0, done.err
    (entry, *_) = json.loads(done.out)["uncertain"]
    assert entry["quantity"] == "damping_ratio_peak"
    assert entry["percentiles"]["5.0"] < entry["percentiles"]["95.0"]
    assert "worth measuring" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
