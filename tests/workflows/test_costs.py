"""What accuracy and effects cost: ladders that are true, choices that are kept, effects paid for only when on."""

import csv
import json
import re
import tomllib
import xml.etree.ElementTree as ET
from dataclasses import replace
from pkgutil import resolve_name

import numpy as np
import pytest

import workflows
from damper import Formulation, ringdown, stepped_ringdown
from fem.solid import sweep
from meshes import make
from tests.damper import scenes
from tests.workflows.conftest import MESHES, QUIET, changed, measured_quickly, raising, refused, shipped_scene, stored
from workflows import pipeline
from workflows.effects.selection import NAMES, OF_THE_PLATE
from workflows.errors import BadInput
from workflows.scene import load
from workflows.solve import damper as damper_stage
from workflows.solve.results import Mode, SpeedPoint
from workflows.solve.structure import PlateSolution
from workflows.studies.work_precision import effects as effects_report
from workflows.studies.work_precision import report, timing
from workflows.studies.work_precision import study as studies
from workflows.studies.work_precision.effects import EffectChange, EffectStudy, changes, effect_study
from workflows.studies.work_precision.integration import Integration
from workflows.studies.work_precision.study import study
from workflows.studies.work_precision.timing import ConvergenceStudy, Setting, WorkPrecision, measure

RELEASE = (20e-3, 5e-3)


FEW_INTEGRATORS = {"RK45": (1e-3,), "DOP853": (1e-12,)}
REFINED = ("thin plate, BFS", "thin plate, Argyris", "Mindlin, Q2 rect", "Mindlin, P2", "solid, 2")
"""Methods of the plate that are tried on two meshes."""


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"formulation": Formulation.PRINTED},
        {"formulation": Formulation.PRINTED, "damping_ratio": 0.01},
        {"damping_ratio": 0.05, "friction": 0.0, "restitution": 0.9},
        {"rolling_friction": 0.0, "damping_ratio": 0.01},
        {"centrifugal_acceleration": 0.0, "restitution": 0.7},
    ],
)
def test_the_peer_and_the_exact_events_agree(changes):
    """Two programs that share no line, to a hundred times the tolerance of the integrator, which errs step by step."""
    damper = scenes.paper(**changes)
    exact, peer = ringdown(damper, RELEASE, 5), Integration(damper, RELEASE, 5, "DOP853", 1e-12)
    assert peer.impacts == exact.impacts > 0
    assert peer.final == pytest.approx(exact.energy.final, abs=1e-10 * exact.energy.initial)
    assert peer.structure == pytest.approx(exact.energy.structure, abs=1e-10 * exact.energy.initial)


@pytest.mark.parametrize(
    "field", [{"floor_friction": 0.3}, {"floor_tilt": (3.0, 0.0)}, {"floor_radius": (0.05, 0.06)}, {"rotation": 100.0}]
)
def test_the_peer_refuses_what_it_does_not_know(field):
    with pytest.raises(ValueError, match=next(iter(field))):
        Integration(scenes.paper(**field), RELEASE, 5, "DOP853", 1e-9)


@pytest.mark.parametrize(("seconds", "runs"), [(0.01, 6), (1.5, 2), (5.0, 1)])
def test_a_median_after_a_warm_up(monkeypatch, seconds, runs):
    clock, calls = [0.0], []

    def work():
        calls.append(1)
        clock[0] += seconds * (10 if len(calls) == 1 and seconds < 1 else 1)
        return 7

    monkeypatch.setattr(timing.time, "perf_counter", lambda: clock[0])
    found = timing.timed(work)
    assert (found.value, len(calls)) == (7, runs)
    assert found.median == pytest.approx(seconds)
    assert found.low <= found.median <= found.high


def test_what_fails_stays_in_the_table():
    gives_up = raising(ArithmeticError("the integrator gave up"))
    row, _ = measure("a method", "a setting", gives_up, lambda _: (1, 0.0))
    assert (row.failed, row.time_s, row.error) == ("the integrator gave up", None, None)
    row, _ = measure("a method", "a setting", lambda: 1, lambda _: (1, np.nan))
    assert row.failed == "no number was obtained"


def once(patch, **settings):
    """Everything is timed once, in a study of these settings."""
    patch.setattr(timing, "TOO_LONG", 0.0)
    for name, value in settings.items():
        patch.setattr(studies, name, value)


@pytest.fixture(scope="module")
def accuracy(tmp_path_factory):
    """The paper's plate with its damper at one speed, on few meshes, limits from coarser ones."""
    plain = {"coriolis": False, "large_deflection": False}
    source = load.load("paper").changed(rotor={"speeds": (500.0,), "modes": 2}, effects=plain)
    few = tuple(
        replace(method, finest=2 if method.name.startswith(REFINED) else 1)
        for method in studies.PLATE_METHODS
        if method.model != "solid/4"
    )
    limits = tuple(replace(method, finest=min(method.finest, 5)) for method in studies.LIMITS)
    with pytest.MonkeyPatch.context() as patch:
        once(patch, PLATE_METHODS=few, LIMITS=limits, SPEEDS=20, SOLID_AT_MOST=5_000)
        once(patch, ASKED=(1e-2, 1e-3), FINEST=1e-4, METHODS=FEW_INTEGRATORS, CYCLES=3)
        patch.setattr(damper_stage, "damping_curve", measured_quickly)
        return study(source, QUIET).document()


def test_no_error_on_the_mesh_of_the_reference(monkeypatch):
    """What shares the reference's mesh shares its error, and looks better than it is."""
    once(monkeypatch, ASKED=(0.5, 1e-4), FINEST=1e-4)
    few = {"speeds": (500.0, 1000.0), "modes": 1}
    source = load.load("campbell").changed(rotor=few, accuracy={"frequency": 0.5})
    with QUIET("pipeline", 3) as step:
        (ladder,), chosen = studies.pipeline_studies(source, step)
    coarse, same = ladder.rows
    assert 0.0 < coarse.error < 0.5
    assert (same.error, same.failed) == (None, "the reference's own mesh")
    assert "good to about" in ladder.reference
    assert chosen["pipeline: first frequency"].error == coarse.error


def rows(document, stage, method):
    (ladder,) = [ladder for ladder in document["ladders"] if ladder["stage"] == stage]
    return [row for row in ladder["rows"] if row["method"].startswith(method)]


def test_ladders_have_what_was_promised(accuracy):
    assert {"processor", "cores"} <= accuracy["machine"].keys()
    stages = [ladder["stage"] for ladder in accuracy["ladders"]]
    assert stages[:4] == ["plate", "plate, with the error of the theory", "speeds", "damper"]
    for ladder in accuracy["ladders"]:
        assert ladder["reference"]
        assert ladder["rows"]
        for row in ladder["rows"]:
            assert row.keys() >= {"method", "setting", "unknowns", "time_s", "error"}
            assert "failed" in row or (row["time_s"] > 0 and row["error"] >= 0)
    assert accuracy["chosen"].keys() >= {"plate", "speeds", "damper", "pipeline: first frequency"}
    for chosen in accuracy["chosen"].values():
        assert chosen.keys() == {"method", "setting", "error_estimate", "error"}
    json.dumps(accuracy, allow_nan=False)


@pytest.mark.parametrize("method", REFINED)
def test_finer_meshes_are_better(accuracy, method):
    coarse, fine = rows(accuracy, "plate", method)
    assert fine["error"] < coarse["error"]
    assert fine["unknowns"] > coarse["unknowns"]


def test_theories_stop_at_their_own_error(accuracy):
    """Against the solid, thin-plate theory keeps 5 % in twist; Mindlin's is within 1 %."""
    stage = "plate, with the error of the theory"
    assert rows(accuracy, stage, "thin plate, BFS")[-1]["error"] == pytest.approx(0.05, abs=0.01)
    assert rows(accuracy, stage, "Mindlin, Q2 rect")[-1]["error"] < 0.01


def test_the_damper_ladder(accuracy):
    """What the ball takes: the paper's 40 steps a cycle miss it altogether."""
    steps = {row["setting"]: row["error"] for row in rows(accuracy, "damper", "fixed step")}
    assert len(steps) == 10
    assert steps["40 a cycle"] > 0.5
    assert steps["10240 a cycle"] < 0.01
    (exact,) = rows(accuracy, "damper", "exact")
    assert exact["error"] < 1e-8
    assert exact["error"] < 10 * accuracy["chosen"]["damper"]["error_estimate"]
    assert rows(accuracy, "damper", "solve_ivp, DOP853")[-1]["error"] < 1e-7


def test_the_structures_own_damping_hides_nothing():
    """The error of a step is that of the ball's energy, as rolling and impacts have it in the books."""
    damper, shown = scenes.paper(damping_ratio=0.01), SpeedPoint(0.0, 0.0, 0.2, 1.0, ())
    with QUIET("damper", 40) as step, pytest.MonkeyPatch.context() as patch:
        once(patch, METHODS={}, STEPS=(40,))
        ladder, _ = studies.damper_study(damper, RELEASE, shown, step)
    books, stepped = ringdown(damper, RELEASE, 20).energy, stepped_ringdown(damper, RELEASE, 20, 40)
    ball = books.rolling + books.impact
    assert ball < 0.02 * books.structure
    # The dashpot's work from the sampled velocities, by the trapezoidal rule.
    c = 2 * 0.01 * np.sqrt(damper.stiffness[0] * damper.modal_mass)
    work = c * np.trapezoid((stepped.velocity**2).sum(axis=1), stepped.time)
    expected = abs((stepped.initial - stepped.final - work) / ball - 1.0)
    assert ladder.rows[0].error == pytest.approx(expected, rel=0.1)
    assert ladder.rows[0].error > 0.5


def test_no_ladder_where_the_ball_takes_nothing(structure, tmp_path, spindamp):
    still = changed(structure, release={"displacement": ["1e-9 m", "0 m"], "cycles": 20})
    outcome = spindamp("accuracy", still, "--out", "out")
    refused(outcome, "", "the ball dissipates nothing in 20 cycles", status=3)
    assert not (tmp_path / "out").exists()


def test_what_is_wrong_at_the_cavity_names_the_scene(paper, spindamp):
    """One mode of a wide plate does not move its cavity across, as the release does."""
    wide = changed(paper, plate__width="18 cm", rotor__modes=1, rotor__speeds=["3500 rpm"], effects=None)
    refused(spindamp("accuracy", wide), "scene.toml: [rotor] modes = 1: none of these modes moves the cavity across")


def test_mindlins_plate_is_clamped_as_in_a_run_on_all_meshes():
    """A little outside its root: the shift of the clamp, up to 0.2 % here, is no error of the mesh chosen."""
    bare = {"rotor": {"speeds": (0.0,), "modes": 3}, "plate": {"theory": "mindlin"}, "damper": None, "release": None}
    source = load.load("paper").changed(**bare, accuracy={"frequency": 1e-3})
    few = tuple(method for method in studies.PLATE_METHODS if method.name == "Mindlin, Q2 rectangles")
    limits = tuple(method for method in studies.LIMITS if method.model == "mindlin")
    with pytest.MonkeyPatch.context() as patch:
        once(patch, PLATE_METHODS=few, LIMITS=limits, SPEEDS=20, ASKED=(1e-2,), FINEST=1e-3)
        chosen = study(source, QUIET).document()["chosen"]["plate"]
    assert 0.0 < chosen["error"] <= 1.5 * chosen["error_estimate"] < 1e-3


def test_choices_keep_their_word(accuracy):
    chosen, asked = accuracy["chosen"], accuracy["asked"]["frequency"]
    assert chosen["plate"]["error"] <= asked
    assert chosen["plate"]["error"] / 3 <= chosen["plate"]["error_estimate"] <= max(3 * chosen["plate"]["error"], asked)
    assert chosen["speeds"]["error"] <= chosen["speeds"]["error_estimate"] <= 1e-6
    assert chosen["pipeline: first frequency"]["error"] <= asked
    assert chosen["pipeline: first frequency"]["setting"] == chosen["plate"]["setting"]


def test_accuracy_of_a_known_structure(spindamp, tmp_path, monkeypatch):
    """Without a plate there is the damper's ladder alone; files are whole."""
    once(monkeypatch, METHODS=FEW_INTEGRATORS, CYCLES=3)
    outcome = spindamp("accuracy", "structure", "--out", "out")
    assert outcome.status == 0
    assert "exact events" in outcome.out
    folder = tmp_path / "out"
    assert {p.name for p in folder.iterdir()} >= {"accuracy.json", "accuracy.csv", "accuracy.svg", "report.html"}
    found = stored(folder / "accuracy.json")
    assert [ladder["stage"] for ladder in found["ladders"]] == ["damper"]
    assert ET.fromstring((folder / "accuracy.svg").read_text()).tag.endswith("svg")
    assert "var(" not in (folder / "accuracy.svg").read_text()
    page = (folder / "report.html").read_text()
    left_out = "Only the damper is compared: no plate, no speeds and no whole pipeline, since the structure is given."
    assert all(left_out in said for said in (outcome.out, page, found["left_out"]))
    assert "pipeline’s first" not in page
    assert "estimate: what rounding misplaces, true: against solve_ivp" in outcome.out


FAN = MESHES / "fan_blade.toml"
"""A solid blade with a damper."""


def test_nothing_to_compare_on_a_solid_blade_alone():
    alone = load.load(str(FAN)).changed(damper=None, release=None)
    with pytest.raises(BadInput, match=r"\[damper\]: the table is missing: nothing to compare, since the blade's mesh"):
        study(alone, QUIET)


def judged(method, time_s, error, uncertainty=0.0):
    return Setting(method, "8 × 4", 100, time_s, (time_s, time_s), error, uncertainty)


def spoken(*ladders):
    return report.verdict(WorkPrecision("", {"frequency": 1e-3, "damping": 1e-3}, ladders, {}))


@pytest.mark.parametrize(
    ("cheap", "dear", "uncertainty", "is_open"),
    [
        (2e-3, 5e-4, 1e-4, False),
        (1.2e-3, 1e-5, 4e-4, True),  # the cheaper one may be good enough
        (2e-3, 9e-4, 2e-4, True),  # the winner may not be
        (2e-3, 5e-4, 1e-2, True),
    ],
)
def test_the_verdict_knows_its_reference(cheap, dear, uncertainty, is_open):
    rows = judged("a", 0.01, cheap, uncertainty), judged("b", 0.02, dear, uncertainty), judged("c", 9.0, 1e-3, 1e-2)
    (sentence,) = spoken(ConvergenceStudy("speeds", "", "", rows))
    assert "b (8 × 4) is the cheapest" in sentence
    assert ("leaves this open" in sentence) is is_open


def test_the_verdict_says_when_nothing_will_do():
    (sentence,) = spoken(ConvergenceStudy("damper", "", "", (judged("a", 0.01, 0.1), judged("b", 0.01, 0.2))))
    assert sentence == "Damper: nothing meets 0.1 %."


def test_ladders_say_what_they_leave_out(monkeypatch):
    """They are without large deflection and Coriolis forces; a scene that has them on is told so."""
    once(monkeypatch, PLATE_METHODS=(replace(studies.PLATE_METHODS[0], finest=1),), SPEEDS=7)
    once(monkeypatch, limits=lambda *_: {}, pipeline_studies=lambda *_: ([], {}))
    source = load.load("paper").changed(damper=None, release=None)
    thin = {"thickness": 0.002}  # which the load bends under stagger
    for stagger, coriolis, words in (
        (0.5, True, "without large deflection and Coriolis forces, which the scene has on"),
        (0.0, True, "without Coriolis forces, which the scene has on"),
        (0.0, False, ""),
    ):
        rotor = {"speeds": (300.0,), "modes": 1, "stagger": stagger}
        for ladder in study(source.changed(plate=thin, rotor=rotor, effects={"coriolis": coriolis}), QUIET).studies:
            assert ladder.reference.endswith(words)
            assert ("which the scene has on" in ladder.reference) == bool(words)


@pytest.mark.usefixtures("hasty")
def test_effects_are_what_theory_says(paper, spindamp, monkeypatch):
    """In the plane of rotation softening takes n² off f²; stress stiffening and its absence; rotary inertia lowers."""
    switch_alone(monkeypatch, "spin_softening", "stress_stiffening", "rotary_inertia", "rolling_resistance")
    rotor = paper["rotor"] | {"speeds": ["10000 rpm"], "stagger": "90 deg", "modes": 2}
    alone = changed(paper, rotor=rotor, effects__coriolis=False, plate__theory="mindlin", accuracy__frequency=0.02)
    found = {row["effect"]: row for row in spindamp.json("effects", alone)["rows"]}
    assert list(found) == list(NAMES)
    frequency, n = spindamp.json("campbell", alone)["speeds"][0]["modes"][0]["frequency_hz"], 10000 / 60
    expected = frequency / np.sqrt(frequency**2 + n**2) - 1
    assert found["spin_softening"]["changes"]["frequency_1"] == pytest.approx(expected, rel=1e-3)
    assert found["stress_stiffening"]["changes"]["frequency_1"] > 0.1
    assert -0.01 < found["rotary_inertia"]["changes"]["frequency_1"] < 0
    assert found["rolling_resistance"]["changes"]["frequency_1"] == 0
    assert all(row.keys() >= {"called_for", "why", "changes", "time_s", "time_share"} for row in found.values())


COSTS = {
    "stress_stiffening": ("fem.assembly._held", "fem.assembly._stiffening"),
    "spin_softening": ("fem.rotor.Rotor.projector",),
    "coriolis": ("fem.assembly.with_coriolis", "fem.modes.solve_gyroscopic"),
    "large_deflection": ("fem.statics.equilibrium", "fem.statics.newton"),
    "cavity_mass": ("fem.assembly.footprint",),
    "structural_modes": ("fem.reduction.modal.modes_at", "fem.modes_at"),
}
"""The functions that only an effect calls, apart from the estimate of its shift on a coarse mesh where it is off."""


@pytest.mark.parametrize("effect", COSTS)
@pytest.mark.parametrize("on", [False, True])
def test_an_effect_that_is_off_costs_nothing(effect, on, monkeypatch):
    """Counted in calls; and switched on it does make them, or the count would mean nothing."""
    calls = []
    for target in COSTS[effect]:
        head, _, name = target.rpartition(".")
        owner = resolve_name(head)
        plain = getattr(owner, name)
        if isinstance(plain, property):
            counted = property(lambda self, get=plain.fget, name=name: (calls.append(name), get(self))[1])
        else:
            counted = lambda *a, work=plain, name=name, **k: (calls.append(name), work(*a, **k))[1]  # noqa: E731
        monkeypatch.setattr(owner, name, counted)
    switches = dict.fromkeys(OF_THE_PLATE, False) | {effect: on}
    switches["stress_stiffening"] |= effect == "large_deflection" and on
    rotor = {"speeds": (500.0,), "modes": 2, "stagger": 0.3}
    kept = {} if effect in ("cavity_mass", "structural_modes") else {"damper": None, "release": None}
    scene = load.load("paper").changed(effects=switches, rotor=rotor, accuracy={"frequency": 0.05}, **kept)
    pipeline.structure(scene, QUIET, shapes=False)
    assert bool(calls) == on


def untimed(work, _):
    """Work that is done once, as if it took 3 s and the other 2 s."""
    return timing.Timing(work(), 1.0, 0.5, 2.0), 3.0, 2.0


def switch_alone(patch, *effects):
    """Only these effects are switched, untimed; rows of the others have no numbers."""

    def compared(work, other):
        if not work.keywords.keys() & set(effects):
            raise ValueError("not switched here")
        return untimed(work, other)

    patch.setattr("workflows.studies.work_precision.effects.compared", compared)


def hurry(patch):
    """Times, scatter and damping ratios that nobody reads: each effect is switched once, in quick figures."""
    patch.setattr("workflows.studies.work_precision.effects.compared", untimed)
    patch.setattr("workflows.studies.work_precision.effects.scatter_of", lambda *_: {})
    patch.setattr(damper_stage, "damping_curve", measured_quickly)


def rows_of(scene):
    """All effects of a scene."""
    return {row.effect: row for row in effect_study(load.as_scene_file(scene), QUIET).rows}


@pytest.fixture
def hasty(monkeypatch):
    """The same for a test."""
    hurry(monkeypatch)


def point(rpm, *modes):
    return SpeedPoint(rpm * np.pi / 30, rpm, 0.2, 1.0, tuple(Mode(frequency, family) for family, frequency in modes))


def test_modes_are_compared_with_their_like():
    """A flap that climbs past a twist stays a flap; what has no like has no number, but a word."""
    own = (point(1000, ("flap", 110.0), ("twist", 150.0), ("flap", 300.0)),)
    other = (point(1000, ("twist", 100.0), ("flap", 100.0), ("lag", 300.0)),)
    found = changes(own, other, own_has_it=True, judged={})
    assert found.changes["frequency_1"] == pytest.approx(0.1)
    assert found.changes["frequency_2"] == pytest.approx(0.5)
    assert found.changes["frequency_3"] is None
    assert found.remarks == ("frequency_3 has no partner of its family at 1000 rpm",)
    assert changes(own, other, own_has_it=False, judged={}).changes["frequency_2"] == pytest.approx(-1 / 3)


def test_a_ratio_to_rounding_is_none():
    """A ball that loses nothing at one of two speeds: the change is that of the other."""
    first = workflows.run("structure").speeds[0]
    damping = first.damper

    def both(*sdc):
        speeds = (first, replace(first, omega=2 * first.omega, rpm=2 * first.rpm))
        return tuple(
            replace(each, damper=replace(damping, peak_sdc=one)) for each, one in zip(speeds, sdc, strict=True)
        )

    found = changes(both(0.12, 3e-3), both(0.15, 2e-16), own_has_it=True, judged={})
    assert found.changes["peak_sdc"] == pytest.approx(-0.2)
    assert found.rpm["peak_sdc"] == first.rpm
    assert found.one_sided == {"peak_sdc": "only with it"}
    assert found.remarks == (f"no peak_sdc without it, at {2 * first.rpm:.0f} rpm",)
    gone = changes(both(3e-17, 2e-16), both(-4e-16, 1e-16), own_has_it=True, judged={})
    assert (gone.changes["peak_sdc"], gone.remarks) == (0.0, ())


def test_speeds_are_compared_with_their_like():
    """The plate diverges at the first speed of one run: the others keep their partners."""
    slow, fast = point(1000, ("flap", 100.0)), point(12000, ("flap", 500.0))
    found = changes((fast, slow), (point(1000, ("flap", 80.0)),), own_has_it=True, judged={})
    assert found.changes == {"frequency_1": pytest.approx(0.25)}
    assert found.remarks == ("without it the plate diverges at 12000 rpm",)
    swapped = changes((slow,), (fast, slow), own_has_it=True, judged={})
    assert swapped.changes == {"frequency_1": 0.0}
    assert swapped.remarks == ("with it the plate diverges at 12000 rpm",)


def test_the_largest_change_is_at_a_speed_with_a_verdict():
    """Which is named; where no speed has one all are looked at."""
    own = point(0, ("flap", 200.0)), point(1000, ("flap", 110.0)), point(2000, ("flap", 105.0))
    other = tuple(point(rpm, ("flap", 100.0)) for rpm in (0, 1000, 2000))
    for judged, change, rpm in (((1000, 2000), 0.1, 1000), ((2000,), 0.05, 2000), ((), 1.0, 0)):
        found = changes(own, other, own_has_it=True, judged=dict.fromkeys(judged, 1))
        assert (found.changes, found.rpm) == ({"frequency_1": pytest.approx(change)}, {"frequency_1": rpm})


@pytest.mark.usefixtures("hasty")
def test_divergence_without_stiffening_is_said(paper, monkeypatch):
    """In the plane of rotation softening wins over bending stiffness at high speed, once nothing stiffens the plate."""
    switch_alone(monkeypatch, "stress_stiffening")
    plate = {"rotor__speeds": ["30000 rpm", "1000 rpm"], "rotor__stagger": "90 deg", "rotor__modes": 1}
    plate["accuracy__frequency"] = 0.05
    row = rows_of(changed(paper, **plate, damper=None, release=None))["stress_stiffening"]
    assert "without it the plate diverges at 30000 rpm" in row.remarks
    assert 0.0 < (row.changes["frequency_1"] or 0.0) < 0.01  # at 1000 rpm, the only speed that both have


@pytest.mark.usefixtures("hasty")
def test_what_appears_has_no_number(structure, tmp_path, spindamp, monkeypatch):
    """Without rolling resistance nothing stops the ball: there is no cut-off to compare with."""
    switch_alone(monkeypatch, "rolling_resistance")
    outcome = spindamp("effects", changed(structure, release__cycles="auto"), "--out", "out")
    assert outcome.status == 0, outcome.err
    rows = stored(tmp_path / "out" / "effects.json")["rows"]
    (row,) = [row for row in rows if row["effect"] == "rolling_resistance"]
    assert row["changes"]["cutoff_g"] is None
    assert "no cutoff_g without it, at 10000 rpm" in row["remarks"]
    assert "no cutoff_g without it" in outcome.out
    with (tmp_path / "out" / "effects.csv").open() as file:
        (cells,) = [row for row in csv.DictReader(file) if row["effect"] == "rolling_resistance"]
    assert cells["cutoff_g"] == ""
    assert "no cutoff_g without it" in cells["remarks"]


@pytest.mark.usefixtures("hasty")
def test_what_needs_each_other_is_switched_together(paper, monkeypatch):
    plate = {"rotor__speeds": ["3000 rpm"], "rotor__stagger": "30 deg", "rotor__modes": 1, "accuracy__frequency": 0.05}
    both = changed(paper, **plate, damper=None, release=None, effects={"large_deflection": True})
    neither = changed(both, effects={"stress_stiffening": False})
    for scene, effect, words in (
        (both, "stress_stiffening", "together with large_deflection, which needs it"),
        (neither, "large_deflection", "together with stress_stiffening, which it needs"),
    ):
        switch_alone(monkeypatch, effect)
        row = rows_of(scene)[effect]
        assert (row.changes["frequency_1"] or 0.0) > 0
        assert words in row.remarks
        assert row.failed is None


@pytest.mark.usefixtures("hasty")
def test_no_row_is_lost(structure, tmp_path, spindamp):
    """A row without numbers says why in the text, in the CSV file and in the figure, beside the rule's reason."""
    printed = changed(structure, damper__formulation="printed", release__displacement=["20 mm", "15 mm"])
    outcome = spindamp("effects", printed, "--out", "out")
    assert outcome.status == 0
    assert "the paper's model: the ball rolls again" in outcome.out
    assert "printed equations have no slip" in outcome.out
    found = {row["effect"]: row for row in stored(tmp_path / "out" / "effects.json")["rows"]}
    assert "printed equations have no slip" in found["ball_slip"]["failed"]
    assert all(found[name]["changes"] == {} for name in OF_THE_PLATE)
    assert any(found["impact_friction"]["changes"].values())
    with (tmp_path / "out" / "effects.csv").open() as file:
        cells = {row["effect"]: row["failed"] for row in csv.DictReader(file)}
    assert cells["coriolis"] == "no plate in the scene"
    assert "have no slip" in cells["ball_slip"]
    assert cells["impact_friction"] == ""
    drawn = (tmp_path / "out" / "effects.svg").read_text()
    assert all(name.replace("_", " ") in drawn for name in NAMES)
    assert drawn.count("no plate in the scene") == len(OF_THE_PLATE)
    assert "on: [effects] ball_slip = true: the printed equations have no slip" in drawn
    assert "accuracy, 0.001" in drawn


@pytest.mark.usefixtures("hasty")
def test_large_deflection_of_a_solid_blade(tmp_path, monkeypatch):
    """The one way in which solid blades are solved otherwise; either run is a run, with nothing kept from the other."""
    make.write_inp(tmp_path / "fan.inp", make.solid(make.FAN, (12, 6, 1)), "fan")
    few = {"damper": None, "blade__mesh": str(tmp_path / "fan.inp"), "rotor__speeds": ["9000 rpm"], "rotor__modes": 2}
    source = load.as_scene_file(changed(tomllib.loads(FAN.read_text(encoding="utf-8")), **few))
    solved = []
    plain = sweep.SolvedBlade.__init__
    monkeypatch.setattr(sweep.SolvedBlade, "__init__", lambda *given: (solved.append(given), plain(*given))[1])
    rows = rows_of(source)
    assert len(solved) == 2
    assert rows["rotary_inertia"].failed == "solid blades are solved one way alone"
    runs = [workflows.run(source.changed(effects={"large_deflection": on})) for on in (True, False)]
    (with_it, without) = ([mode.frequency_hz for mode in run.speeds[0].modes] for run in runs)
    expected = [a / b - 1 for a, b in zip(with_it, without, strict=True)]
    assert list(rows["large_deflection"].changes.values()) == pytest.approx(expected, rel=1e-6)
    assert max(map(abs, expected)) > 1e-3


@pytest.fixture(scope="module")
def tilting():
    """A known structure whose floor tilts, let go by as much as sets the ball rolling."""
    release = {"displacement": None, "cycles": 50}
    return load.load("structure").changed(structure={"floor_tilt": (8.0, 0.0)}, release=release)


@pytest.fixture(scope="module")
def tilted(tilting):
    """Its effects."""
    with pytest.MonkeyPatch.context() as patch:
        hurry(patch)
        return rows_of(tilting)


@pytest.mark.usefixtures("hasty")
def test_the_damping_ratio_is_that_of_a_run(tilting, tilted):
    """A verdict counts the tilt either way; without it there is a curve of falling vibration, held against its like."""
    rows = tilted
    on, off = (workflows.run(tilting.changed(effects={"floor_tilt": tilt})).speeds[0] for tilt in (True, False))
    assert rows["floor_tilt"].changes["ball_damping_ratio"] == on.damping_curve.peak / off.damping_curve.peak - 1 == 0
    falling = on.damping_curve.from_above.peak / off.level.peak - 1
    assert rows["floor_tilt"].changes["falling_damping_ratio"] == pytest.approx(falling, rel=1e-9)
    assert falling < -0.5
    assert any("is the verdict's, with the tilt either way" in remark for remark in rows["floor_tilt"].remarks)
    assert not any("falling_damping_ratio" in row.changes for name, row in rows.items() if name != "floor_tilt")


@pytest.mark.usefixtures("hasty")
def test_a_release_does_not_change_with_an_effect(tilting, tilted):
    """An automatic release is larger the more the floor tilts: without the tilt it is kept as large."""
    row = tilted["floor_tilt"]
    own = workflows.run(tilting).speeds[0].damper
    level = tilting.changed(effects={"floor_tilt": False})
    smaller = workflows.run(level).speeds[0].damper
    other = workflows.run(level.changed(release={"displacement": own.release})).speeds[0].damper
    assert smaller.release[0] < 0.5 * own.release[0] == 0.5 * other.release[0]
    assert row.changes["impacts"] == own.impacts / other.impacts - 1 != own.impacts / smaller.impacts - 1


@pytest.mark.usefixtures("hasty")
def test_a_dent_changes_the_amplitude_up_to_which_a_ball_rests(tilting):
    """And nothing else of a ball that once moves."""
    level = workflows.run(tilting).speeds[0]
    dented = replace(level, damping_curve=replace(level.damping_curve, cutoff=1.5 * level.damping_curve.cutoff))
    found = changes((dented,), (level,), own_has_it=True, judged={})
    assert {name: change for name, change in found.changes.items() if change} == {"rest_amplitude": pytest.approx(0.5)}


@pytest.mark.usefixtures("hasty")
def test_damping_is_compared_where_the_ball_moves(paper):
    """At 10000 rpm the plate endures nothing that moves it; without stiffening the tilt takes most of the drive."""
    source = load.as_scene_file(changed(paper, rotor__speeds=["5000 rpm", "10000 rpm"], accuracy__frequency=0.05))
    own, soft = (workflows.run(source.changed(effects={"stress_stiffening": on})).speeds for on in (True, False))
    ranks = {point.rpm: point.verdict.rank for point in own if point.verdict}
    assert list(ranks.values()) == [1, 0]
    assert soft[1].tilt_share > 0.9
    found = changes(own, soft, own_has_it=True, judged=ranks)
    assert found.rpm["ball_damping_ratio"] == own[0].rpm
    assert found.rpm["impacts"] == own[1].rpm
    assert changes(own, soft, own_has_it=True, judged={}).changes["ball_damping_ratio"] > 1000


@pytest.mark.usefixtures("hasty")
def test_effects_draw_no_plate(paper, monkeypatch):
    """Whose strength needs its surface only where its mesh is given."""
    alone = {"damper": None, "release": None, "rotor__speeds": ["5000 rpm"], "accuracy__frequency": 0.05}
    monkeypatch.setattr(PlateSolution, "surface", lambda *_, **__: pytest.fail("a surface is drawn"))
    assert any(row.changes for row in rows_of(changed(paper, **alone)).values())


def test_a_manifold_change_is_a_factor():
    rows = [EffectChange("coriolis", True, "", True, {"impacts": size}, {"impacts": 1000.0}) for size in (9.5, 1150.0)]
    assert [effects_report.text(EffectStudy("", 1e-3, (row,))).count(" 950 %") for row in rows] == [1, 0]
    assert [effects_report.text(EffectStudy("", 1e-3, (row,))).count(" × 1150 ") for row in rows] == [0, 1]


@pytest.mark.usefixtures("hasty")
def test_no_change_is_taken_from_a_speed_without_a_verdict(tilting, monkeypatch):
    """At 50 rpm the ball weighs more than its load."""
    switch_alone(monkeypatch, "floor_tilt")
    speeds = tuple(rpm * np.pi / 30 for rpm in (50, 10000))
    switches = effect_study(tilting.changed(rotor={"speeds": speeds}), QUIET)
    (row,) = [row for row in switches.rows if row.effect == "floor_tilt"]
    assert {round(rpm) for rpm in row.rpm.values()} == {10000}
    said = f"{row.largest[0]} at 10000 rpm"
    assert said in effects_report.text(switches)
    written = effects_report.files(switches)
    page, table = (str(written[name]) for name in ("report.html", "effects.csv"))
    assert said.replace("_", " ") in page
    assert f"{row.largest[0]}_rpm" in table
    assert "% at 10000 rpm" in str(written["effects.svg"])


def test_pairs_in_turns(monkeypatch):
    """A machine that slows down slows both: the difference of pairs is true where that of medians is not."""
    clock, calls = [0.0], []

    def job(name, seconds):
        def work():
            calls.append(name)
            clock[0] += seconds * (1 + len(calls) // 2)
            return name

        return work

    monkeypatch.setattr(timing.time, "perf_counter", lambda: clock[0])
    extra, seconds, others = timing.compared(job("with", 0.03), job("without", 0.02))
    assert calls == ["with"] + ["with", "without"] * 7
    assert extra.value == "with"
    assert 0 < extra.low < extra.median < extra.high
    assert seconds > others


def test_what_is_within_noise_is_called_so():
    ends = ((-0.01, 0.05), (0.002, 0.14), (-0.03, -0.01))
    timed = EffectChange("coriolis", False, "", False, time_s=0.02, time_share=0.1)
    rows = tuple(replace(timed, time_spread_s=each) for each in ends)
    assert [row.within_noise for row in rows] == [True, False, False]
    for drawn in (effects_report.text, effects_report.draw):
        assert drawn(EffectStudy("", 1e-3, rows)).count("within noise") == 1
        assert drawn(EffectStudy("", 1e-3, rows[1:])).count("within noise") == 0


def test_scatter_of_chaotic_motion_is_no_effect(monkeypatch):
    """A free ball's largest loss in a cycle changes by percents with any hair's breadth, which no effect does.

    Whatever is switched, a change is an effect's only beyond twice that; the damper's own figures do not scatter.
    """
    switch_alone(monkeypatch, "floor_tilt")
    scene = shipped_scene("structure")
    free = {"damper__rolling_friction": "0.01 mm", "damper__restitution": 0.8, "damper__ball_density": "7850 kg/m^3"}
    free |= {"rotor__speeds": ["400 rpm"], "release__displacement": ["3 mm", "0 mm"], "release__cycles": 2000}
    scene = changed(scene, damper__count=5, damper__mass_ratio=None, **free)
    rows = rows_of(scene)
    scatter = rows["floor_tilt"].scatter  # of the scene's own state, as there is no tilt
    assert scatter["peak_sdc"] > 1e-3, "a billionth of the cavity moves it by thousandths"
    assert scatter["ball_damping_ratio"] < 1e-6
    for change, beyond in ((1.9 * scatter["peak_sdc"], False), (2.1 * scatter["peak_sdc"], True)):
        row = replace(rows["floor_tilt"], changes={"peak_sdc": -change, "ball_damping_ratio": 1e-5}, error={})
        assert row.largest == (("peak_sdc", -change) if beyond else ("ball_damping_ratio", 1e-5))
        said = effects_report.text(EffectStudy("", 1e-3, (row,)))
        assert ("within the scatter of chaotic motion: peak_sdc" in said) is not beyond


def test_either_side_may_scatter(monkeypatch):
    """A ball that rolls without resistance bounces at random, which the scene's own state does not."""
    switch_alone(monkeypatch, "floor_tilt", "rolling_resistance")
    rows = rows_of(load.load("structure"))
    assert rows["floor_tilt"].scatter["ball_damping_ratio"] < 1e-6
    assert rows["rolling_resistance"].scatter["ball_damping_ratio"] > 1e-5


def test_a_change_within_the_error_of_its_sides_is_none():
    """The damping ratio of either run has an error of its own, which may be half of it."""
    own = workflows.run("structure").speeds[0]
    curve = own.damping_curve
    for factor, error, beyond in ((0.7, 0.43, False), (0.6, 0.43, True), (0.7, 0.3, True)):
        other = replace(own, damping_curve=replace(curve, peak=factor * curve.peak, error=error))
        for has_it in (True, False):
            found = changes((own,), (other,), own_has_it=has_it, judged={})
            row = EffectChange("ball_slip", True, "", True, found.changes, found.rpm, found.error)
            # The two values reach each other, whichever of them is the reference.
            assert (curve.peak * (1 - curve.error) > factor * curve.peak * (1 + error)) is beyond
            assert row.largest == (("ball_damping_ratio", found.changes["ball_damping_ratio"]) if beyond else None)
            said = effects_report.text(EffectStudy("", 1e-3, (row,)))
            assert ("within the error that run estimates: ball_damping_ratio" in said) is not beyond


def test_a_row_without_a_largest_change_says_why():
    cases = [
        ("no numbers", {"failed": "no plate in the scene"}),
        ("none", {"changes": {"frequency_1": 0.0, "frequency_2": -2e-12 / 3}}),
        ("within scatter", {"changes": {"peak_sdc": 0.1, "impacts": 0.0}, "scatter": {"peak_sdc": 0.06}}),
        ("within error", {"changes": {"ball_damping_ratio": 0.1}, "error": {"ball_damping_ratio": 0.4}}),
        ("none", {"changes": {"cutoff_g": None, "impacts": 0.0}}),
        ("only with it", {"changes": {"cutoff_g": None, "impacts": 0.0}, "one_sided": {"cutoff_g": "only with it"}}),
    ]
    words = [word for word, _ in cases]
    rows = [
        EffectChange("coriolis", False, "slow", False, rpm=dict.fromkeys(found.get("changes", {}), 1000.0), **found)
        for _, found in cases
    ]
    switches = EffectStudy("", 1e-3, tuple(rows))
    lines = [line for line in effects_report.text(switches).splitlines() if line.startswith("coriolis")]
    assert [re.split(r"\s{2,}", line)[3] for line in lines] == words
    page = str(effects_report.files(switches)["report.html"])
    assert re.findall(r'<td class="number">([a-z ]+)<div', page) == words


@pytest.mark.usefixtures("hasty")
def test_times_are_those_of_the_effect(monkeypatch):
    """Switched off, the other run is what an effect that is on saves; switched on, what one that is off would take."""
    switch_alone(monkeypatch, "impact_friction", "ball_slip")
    rows = rows_of(load.load("structure"))
    on, off = rows["impact_friction"], rows["ball_slip"]
    assert (on.on, on.time_s, on.time_spread_s, on.time_share) == (True, -1.0, (-2.0, -0.5), -0.5)
    assert (off.on, off.time_s, off.time_spread_s, off.time_share) == (False, 1.0, (0.5, 2.0), 1 / 3)
