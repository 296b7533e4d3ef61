"""The best damper: what is free, what it is worth, that nothing better was overlooked, and why none works."""

from __future__ import annotations

import json
import math
import tomllib
from itertools import product

import numpy as np
import pytest

import spindamp
from damper import Working, work_bound, working
from tests.workflows.browser import AXE, findings
from tests.workflows.conftest import CHROMIUM, changed
from workflows.errors import BadInput
from workflows.scene.file import load, opened, parse
from workflows.studies.design import objective, search, study, verdict
from workflows.studies.design import space as spaces
from workflows.studies.sweep import crew
from workflows.studies.sweep.plates import Plates

FREE = {
    "ball_material": ["steel", "tungsten carbide", "lead"],
    "ball_diameter": ["2 mm", "3 mm", "4 mm"],
    "clearance": ["0.5 mm", "1 mm", "2 mm"],
    "mass": "0.4 g",
    "amplitude": ["4 mm", "8 mm"],
}


@pytest.fixture
def slow(structure):
    """A structure that spins slowly enough, with the table [design]."""
    return changed(structure, rotor__speeds=["4000 rpm"], structure__mass="0.3 kg") | {"design": dict(FREE)}


def space_of(scene, **design):
    return spaces.of(opened(scene | {"design": scene["design"] | design}))


def test_a_pair_is_a_range_and_a_longer_list_a_choice(slow):
    space = space_of(slow, ball_diameter=["2 mm", "6 mm"], clearance=["0.1 mm", "4 mm"], floor_radius=["flat", "8 mm"])
    axes = {axis.name: axis for axis in space.axes}
    assert (axes["damper.radius"].spread.low, axes["damper.radius"].spread.high) == (1e-3, 3e-3)
    assert axes["damper.radius"].spread.law == "even"
    assert axes["damper.clearance"].spread.law == "log"
    assert axes["damper.ball_material"].values == ("steel", "tungsten carbide", "lead")
    assert axes["damper.floor_radius"].values == (math.inf, 8e-3)
    ends = [space.values(np.full(len(space.axes), share))["damper.radius"] for share in (0.0, 1.0)]
    assert ends == [1e-3, 3e-3]


@pytest.mark.parametrize(
    ("design", "says"),
    [
        ({"amplitude": ["2 mm", "1 mm"]}, "[design] amplitude"),
        ({"ball_material": ["steal"]}, "did you mean 'steel'?"),
        ({"ball_diameter": ["6 mm", "2 mm"]}, "[design] ball_diameter"),
        ({"floor_radius": ["flt"]}, "[design] floor_radius"),
        ({"count": [0]}, "whole numbers from 1 on"),
        ({"balls": 3}, "unknown key"),
        (dict.fromkeys(("ball_material", "ball_diameter", "clearance")), "nothing is free"),
    ],
)
def test_errors_name_the_key(slow, design, says):
    scene = changed(slow, **{f"design__{name}": value for name, value in design.items()})
    with pytest.raises(BadInput) as found:
        parse(scene)
    assert says in str(found.value)


def test_design_needs_its_table():
    with pytest.raises(BadInput, match=r"\[design\].*missing"):
        spindamp.design("structure")


def curve(amplitude, ratio, cutoff=0.0):
    best = int(np.argmax(ratio))
    ends = (amplitude[0], amplitude[-1])
    return Working(np.array(amplitude), np.array(ratio), cutoff, ratio[best], amplitude[best], ends, ends, 0.01)


def test_the_least_damping_of_a_known_curve():
    """A curve that rises as A and falls as 1/A: least at the ends."""
    amplitude = np.geomspace(1e-3, 1e-2, 200)
    ratio = np.minimum(amplitude, 9e-6 / amplitude)
    found = curve(list(amplitude), list(ratio))
    assert objective.least(found, 2e-3, 5e-3) == (pytest.approx(9e-6 / 5e-3, rel=1e-3), pytest.approx(5e-3))
    assert objective.least(found, 1.1e-3, 4e-3) == (pytest.approx(1.1e-3, rel=1e-3), pytest.approx(1.1e-3))
    assert objective.least(curve(list(amplitude), list(ratio), cutoff=3e-3), 2e-3, 5e-3)[0] == 0.0
    assert objective.least(found, 5e-3, 2e-2)[0] == pytest.approx(9e-4 / 4, rel=0.02)


def score_of(space):
    plates = Plates()
    return lambda shares, quick=True: objective.scored(space, np.asarray(shares), plates, quick=quick)


def test_limits_bound_and_cutoff(slow):
    space = space_of(slow, mass="0.05 g")
    (heavy,) = score_of(space)([[0.9, 0.9, 0.5]])
    assert heavy.value == 0.0
    assert "mass" in heavy.why
    assert dict(heavy.used)["mass"] == pytest.approx(11300 * 4 / 3 * math.pi * 8e-9 / 5e-5)
    space = space_of(slow)
    (good,) = score_of(space)([[0.1, 0.5, 0.5]])
    assert 0 < good.value < good.bound
    ball = 7850 * 4 / 3 * math.pi * 1.5e-3**3
    share = 4 * ball / 0.3 * 1e-3 / 8e-3
    assert good.bound == pytest.approx(-math.log1p(-share) / (4 * math.pi), rel=1e-9)
    load = (4000 * math.pi / 30) ** 2 * 0.2
    assert good.cutoff == pytest.approx(1e-4 / 1.5e-3 * load / (2 * math.pi * 269.5) ** 2, rel=1e-9)


def test_the_plates_thickness_is_room():
    space = spaces.of(load("design"))
    shares = [0.1, 1.0, 1.0, 0.1]  # 6 mm of ball and 4 mm of clearance in 10 mm of plate
    (found,) = objective.scored(space, np.array([shares]), Plates(), quick=True)
    assert found.value == 0.0
    assert "cavity" in found.why or "thickness" in found.why


def test_the_cutoff_is_that_of_the_damper():
    from workflows.studies.design import curves

    space = spaces.of(load("design"))
    shares = np.array([0.5, 0.8, 0.5, 0.0])
    found = search.Found(shares, objective.scored(space, shares[None], Plates(), quick=True)[0], 1)
    for each in curves.of(space, found):
        assert objective.cutoff_of(each.damper) == each.working.cutoff == working(each.damper, threads=1).cutoff
        assert each.damper.floor_tilt[0] > 1.0
        ratio = objective.bound_of(each.damper, 3e-3)
        assert -math.expm1(-4 * math.pi * ratio) == pytest.approx(work_bound(each.damper, (3e-3, 0.0)))


def test_the_search_finds_a_known_optimum(slow):
    """A hill with a known top over two ranges and a choice."""
    space = space_of(slow, ball_diameter=["2 mm", "6 mm"], clearance=["0.1 mm", "4 mm"])
    top = np.array([0.5, 0.3, 0.7])

    def score(shares, _):
        away = np.asarray(shares) - top
        away[:, 0] = np.floor(3 * np.asarray(shares)[:, 0]) - 1
        return [objective.Scored(v, v) for v in np.exp(-(away**2).sum(axis=1))]

    found = search.search(space, score, seed=1, progress=lambda _: None)
    assert found.scored.value == pytest.approx(1.0, abs=1e-4)
    assert np.allclose(found.shares[1:], top[1:], atol=0.01)
    again = search.search(space, score, seed=1, progress=lambda _: None)
    assert np.array_equal(found.shares, again.shares)


def test_nothing_better_among_all_designs(slow, here):
    """27 designs, each tried with full figures: the search finds the best of them."""
    found = spindamp.design(slow, executor=here)
    shares = [[(a + 0.5) / 3, (b + 0.5) / 3, (c + 0.5) / 3] for a, b, c in product(range(3), repeat=3)]
    every = score_of(found.space)(shares, quick=False)
    best = max(every, key=lambda each: each.value)
    assert found.found.scored.value == best.value > 0
    assert found.document()["value"] == best.value
    assert best.value < found.found.scored.bound
    again = study.design(slow, hired=crew.given(here, 3))
    assert again.document() == found.document(), "the number of workers has a part in it"
    scene = parse(tomllib.loads(found.toml))
    assert scene.design is None
    assert scene.damper.radius == found.space.values(found.found.shares)["damper.radius"]
    point = spindamp.run(scene).speeds[0]
    assert objective.least(point.working, 4e-3, 8e-3)[0] == pytest.approx(best.value, rel=0.02)
    assert verdict.verdict(found.space, found.found).startswith("At least a damping ratio")


def test_why_none_works(slow, here):
    """The remedy that is named is the right one: just beyond it, the ball moves."""
    scene = slow | {"design": FREE | {"amplitude": ["0.1 mm", "1 mm"]}}
    found = spindamp.design(scene, executor=here)
    assert found.found.scored.value == 0.0
    said = " ".join(found.document()["why"])
    assert "the load holds every ball at rest below" in said
    needed = 1e-4 * 1e-4 / found.found.scored.cutoff
    for factor, moves in ((0.999, True), (1.001, False)):
        other = space_of(changed(scene, damper__rolling_friction=factor * needed))
        (again,) = objective.scored(other, found.found.shares[None], Plates(), quick=True)
        assert (again.cutoff < 1e-4) is moves
    assert found.grid is None


def test_from_the_command_line(spindamp, slow, tmp_path):
    from tests.workflows.conftest import write

    free = {"ball_material": ["steel"], "ball_diameter": ["2 mm", "4 mm", "5 mm"], "clearance": ["1 mm"]}
    scene = write(slow | {"design": FREE | free}, tmp_path / "a.toml")
    done = spindamp("design", scene, "--workers", 1, "--out", tmp_path / "out", "--json")
    assert done.status == 0, done.err
    found = json.loads(done.out)
    assert found == json.loads((tmp_path / "out" / "design.json").read_text(encoding="utf-8"))
    assert found["best"]["radius"] == 2e-3, "the heaviest that the mass allows"
    assert "<svg" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    if CHROMIUM is not None and AXE is not None:
        assert findings(tmp_path / "out" / "report.html", tmp_path) == []
    assert spindamp("check", tmp_path / "out" / "best.toml").status == 0
    wrong = spindamp("design", "structure")
    assert wrong.status == 2
    assert "[design]" in wrong.err
