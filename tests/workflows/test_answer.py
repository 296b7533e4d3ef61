"""The words above the table must say what the table says."""

import math
import re
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

import spindamp
import workflows
from damper.curve_measurement import settled
from tests.workflows.conftest import BALL, BLADE, KNOWN, MESHES, QUIET, changed, on_mesh
from workflows import pipeline
from workflows.errors import BadInput
from workflows.report import remarks
from workflows.report import text as summary
from workflows.report.remarks import AT_REST, AT_REST_MEANS, BEYOND, BEYOND_MEANS, LEVEL_MEANS
from workflows.report.templates import stretch
from workflows.report.verdict import answer, of_orders
from workflows.scene.load import as_scene_file
from workflows.scene.scene import Excitation
from workflows.solve import excitation, limits, remedies
from workflows.solve.damper import verdict_damper
from workflows.solve.results import ErrorParts, ForceLevel, Grade, Mode, Reason, Verdict, VibrationReduction

pytestmark = pytest.mark.usefixtures("undrawn", "quickly")

COARSE = MESHES / "plate_coarse.msh"


@cache
def results(**changes):
    """A run, done once for all that look at it."""
    return workflows.run(base(**changes))


def base(speeds="3500 10000", cavity="2.5 2.4", release="20 5", **damper):
    """The known structure with its ball, held by a tenth of the load; speeds in rpm, lengths in mm."""
    held = {"rolling_friction": "0.1 mm", "damping_ratio": 0.01, "cavity": [f"{side} mm" for side in cavity.split()]}
    given = {name: float(value) if name != "count" else int(value) for name, value in damper.items()}
    return changed(
        KNOWN,
        title="words",
        rotor__speeds=[f"{each} rpm" for each in speeds.split()],
        damper=KNOWN["damper"] | held | given,
        release={"displacement": [f"{each} mm" for each in release.split()]},
    )


def text(found):
    said = answer(found)
    return " ".join([said.verdict, *said.sentences])


def moves(point):
    return point.damper is not None and point.damper.events > 0


def test_a_ball_that_rolls_without_hitting_moves():
    found = results(cavity="100 100")
    assert all(p.damper.impacts == 0 and moves(p) for p in found.speeds)
    assert "never move" not in text(found)


def test_a_release_that_does_not_set_the_ball_rolling():
    """The verdict speaks of the damper, the remark of the release."""
    found = results(release="2 0")
    assert [moves(p) for p in found.speeds] == [True, False]
    assert text(found) == text(results(release="20 0"))
    said = "From 10000 rpm on, this scene's release of 2 mm is below the 7.6 mm that set the balls rolling"
    assert any(note.startswith(said) for note in found.notes)


@pytest.mark.parametrize(("zeta", "release"), [("0", "20"), ("3e-4", "5"), ("5e-3", "0.1")])
def test_neither_release_nor_own_damping_moves_the_figures(zeta, release):
    """What the ring-downs lose to the ball from these releases is held against the figures in tests/damper."""
    plain = results()
    found = results(damping_ratio=zeta, release=f"{release} 0")
    assert text(found) == text(plain)
    for one, other in zip(found.speeds, plain.speeds, strict=True):
        assert one.damping_curve.peak == pytest.approx(other.damping_curve.peak, rel=0.05)
        assert one.damping_curve.range == pytest.approx(other.damping_curve.range, rel=0.05)


def test_the_verdict_in_words_and_numbers():
    """The record at each speed says what the answer says, which names a step between two loads."""
    found = results(speeds="3500 17500")
    most = 100 * found.speeds[0].verdict.damping_ratio
    assert answer(found).verdict == f"Of little use: at most {most:.2g} % equivalent damping ratio (at 3500 rpm)"
    for point, speed in zip(found.speeds, workflows.document(found)["speeds"], strict=True):
        own, verdict = point.damping_curve, speed["verdict"]
        assert verdict.pop("grade") == ("modest" if own.peak >= limits.AIR[0] / 10 else "negligible")
        figures = {"damping_ratio": own.peak, "amplitude": own.peak_amplitude, "useful_range": list(own.half)}
        assert verdict == figures | {"reason": ""}


@pytest.mark.parametrize(
    ("changes", "grade", "reason", "ratio"),
    [
        ({"count": "1"}, "inadmissible", "ball_density", None),
        ({"cavity": "2 2"}, "locked", "filled_cavity", 0.0),
        ({"speeds": "100 3500"}, "unknown", "slip", None),
        ({"speeds": "0 3500"}, "unknown", "ball_weight", None),
    ],
)
def test_no_verdict_has_no_figures(changes, grade, reason, ratio):
    verdict = workflows.document(results(**changes))["speeds"][0]["verdict"]
    nothing = {"damping_ratio": ratio, "amplitude": None, "useful_range": [None, None]}
    assert verdict == nothing | {"grade": grade, "reason": reason}


def test_standstill_does_not_decide():
    """A ball that nothing presses down takes much more: that says nothing of the plate that spins."""
    still = results(speeds="0 3500")
    assert still.speeds[0].damping_curve.peak > 2 * still.speeds[1].damping_curve.peak, (
        "chaotic, but far from the other"
    )
    assert text(still).replace("While the rotor turns,", "In a slowly growing vibration") == text(
        results(speeds="3500")
    )


def test_amplitudes_that_the_plate_does_not_endure_are_no_range(finished, document):
    """At 7500 rpm the paper's ball does half of its best from 9.6 mm on; 9.1 mm strain the root by 0.4 %."""
    said = " ".join(answer(workflows.load_results(finished)).sentences)
    half = document["speeds"][2]["working"]["half_range"]
    assert half[0] > 9.2e-3
    assert "at 7500 rpm at amplitudes" not in said
    assert "at 5000 rpm at amplitudes" in said
    page = (finished / "report.html").read_text(encoding="utf-8")
    best, endured = (document["speeds"][1]["verdict"][key] for key in ("amplitude", "useful_range"))
    cells = f"<td>{1e3 * best:.3g}</td>\n<td>&gt; {1e3 * endured[1]:.3g}</td>"
    assert cells.replace(".00<", "<") in page, "half of the best is left beyond what the plate endures"
    assert document["speeds"][1]["working"]["half_range"][1] > endured[1]


def test_of_a_ball_that_takes_nothing_rounding_leaves_nothing(document):
    """On each way to an amplitude the ball rests or rolls next to nothing somewhere: -1e-16 stood there."""
    ways = ("from_above", "slow_ramp", "abrupt_start")
    curves = [own for point in document["speeds"] for own in (point["working"], *map(point["working"].get, ways))]
    every = np.array([at["damping_ratio"] for own in curves if own is not None for at in own["curve"]])
    assert (every >= 0).all()
    assert not ((every > 0) & (every < 1e-15)).any()


def test_a_ratio_of_no_load_releases_nothing():
    """At rest nothing is released; at 3500 rpm half of what rolling takes is."""
    found = workflows.run(base("0 3500") | {"release": {"ratio": 0.05}})
    assert not any(moves(point) for point in found.speeds)
    assert any(note.startswith("From 3500 rpm on, this scene's release of 0.469 mm") for note in found.notes)
    assert "At 0 rpm there is no load, so a release given as a ratio of it is zero: nothing moves." in found.notes


def thick(*rpm, **changes):
    """A steel plate, 20 x 8 x 1 cm, whose load holds the ball at all that it endures from some speed on."""
    scene = {
        "plate": {"length": "20 cm", "width": "8 cm", "thickness": "1 cm", "theory": "kirchhoff"},
        "material": {"name": "steel"},
        "rotor": {"speeds": [f"{each} rpm" for each in rpm], "modes": 1},
        "damper": BALL
        | {"ball_density": 7850.0, "radius": "1.5 mm", "cavity": ["4 mm", "4 mm"], "rolling_friction": "0.2 mm"},
        "release": {"displacement": ["1 mm", "0 mm"], "cycles": 2},
        "effects": {"structural_modes": False, "floor_tilt": True, "cavity_mass": False, "coriolis": False},
        "accuracy": {"frequency": 0.02},
    }
    return changed(scene, **changes)


def moved(point, **curve):
    """The same speed with other figures of the damper, whose ball no other force moves."""
    return replace(point, damping_curve=replace(point.damping_curve, driven_from=None, **curve))


def sets_off(scene, limit):
    """Whether a ball moves that is let go at rest at the amplitude that the plate endures."""
    (point,) = workflows.run(changed(scene, release__displacement=[limit, 0.0])).speeds
    return moves(point)


@cache
def twelve():
    """Twelve steel balls in the thick plate."""
    return workflows.run(thick(8000, 10000, damper__count=12))


@pytest.mark.parametrize("key", ["rolling_friction", "radius", "omega", "amplitude"])
def test_what_would_move_a_locked_ball_does(key):
    """One percent beyond each limit that the answer names, the motion itself sets off; one percent short it does not.

    Twelve steel balls, whose mass grows eightfold to the radius that moves them: the frequency falls with it.
    """
    found, point = twelve(), twelve().speeds[1]
    limit = limits.endured(found, point.omega)
    assert (point.verdict.grade, point.verdict.reason) == ("locked", "out_of_reach")
    value, own = getattr(remedies.what_moves(found, point), key), point.damping_curve
    if key == "amplitude":  # the motion counts no change of the load, which moves the ball a little before
        assert 0.97 * value < own.cutoff < value == own.drives_from

    def begins(near):
        if key == "omega":
            return sets_off(thick(near * 30 / math.pi, damper__count=12), limits.endured(found, near))
        wider = {"damper__cavity": [2 * near + 1e-3] * 2} if key == "radius" else {}
        other = {} if key == "amplitude" else {f"damper__{key}": near}
        return sets_off(thick(10000, damper__count=12, **other, **wider), near if key == "amplitude" else limit)

    assert [begins(f * value) for f in (0.99, 1.01)] == [
        key in ("rolling_friction", "omega"),
        key in ("radius", "amplitude"),
    ]


@pytest.mark.parametrize("eased", [0.98, 0.995, 0.9999])
def test_a_ball_that_moves_just_within_the_limit_is_not_locked(eased):
    """Though its damping is next to nothing there, at the curve's first amplitude or below it."""
    held = twelve()
    remedy = remedies.what_moves(held, held.speeds[1])
    found = workflows.run(thick(10000, damper__count=12, damper__rolling_friction=eased * remedy.rolling_friction))
    (point,) = found.speeds
    assert point.verdict.grade == "negligible"
    assert point.verdict.damping_ratio > 0
    assert answer(found).verdict.startswith("Not useful: at most ")
    assert not re.search("locked|never|would move", text(found))


def test_every_speed_whose_damping_is_known_only_roughly_is_named():
    """And an answer without damping is none of a ball that is held."""
    found = workflows.run(thick(3500, 5000, 7500))
    rough = [moved(p, error=0.8) for p in found.speeds[:2]]
    assert "up to 5000 rpm" in answer(replace(found, speeds=(*rough, found.speeds[2]))).verdict.rpartition("; ")[2]
    silent = replace(found.speeds[2], verdict=Verdict.without_figures(Grade.NEGLIGIBLE, Reason.NOT_FOUND, 0.0))
    verdict = answer(replace(found, speeds=(*found.speeds[:2], silent))).verdict
    assert "no damping by the ball was found at 7500 rpm" in verdict
    assert "locked" not in verdict


def test_a_locked_ball_has_a_way_out_in_one_sentence():
    """Right after the headline, locked at all speeds or at some; rounded to the side on which it moves."""
    some, every = (workflows.run(thick(*rpm)) for rpm in ((5000, 10000), (10000,)))
    for found in (some, every):
        sentence = answer(found).sentences[0]
        remedy = remedies.what_moves(found, found.speeds[-1])
        assert sentence.startswith("At 10000 rpm the ball moves above ")
        friction, radius = (
            float(re.search(rf"{words} ([0-9.]+) mm", sentence)[1])
            for words in ("a rolling friction below", "a ball radius above")
        )
        assert 0.99 < friction / (1e3 * remedy.rolling_friction) <= 1
        assert 1 <= radius / (1e3 * remedy.radius) < 1.01
        named = re.search(r"or below about ([0-9]+) rpm \(", sentence)
        assert (named is not None) == (found is some), "one speed does not tell how the frequency goes with it"
        assert sum("would move" in each for each in answer(found).sentences) == 1
    assert answer(every).verdict == "No: the ball never moves within what the plate endures"


def test_what_else_moves_a_locked_ball_has_sentences_of_its_own(monkeypatch):
    """Down to where it goes on, and the forces that its motion does not count: no parentheses in a row."""
    found = workflows.run(thick(10000))
    (point,) = found.speeds
    own = replace(point.damping_curve, driven_from=point.damping_curve.cutoff, cutoff=0.9 * point.damping_curve.cutoff)
    monkeypatch.setattr("workflows.report.verdict.goes_on", lambda *_: 8.3e-3)
    sentence = answer(replace(found, speeds=(replace(point, damping_curve=own),))).sentences[0]
    others = "Coriolis forces, a sideways pull or a varying load, which are not simulated, may move it above"
    said = f" Once it moves, it keeps moving down to 8.3 mm. {others} {1e3 * own.cutoff:.2g} mm."
    assert sentence.endswith(said)
    assert ") (" not in sentence


@pytest.mark.parametrize(
    ("limit", "starts", "moves", "rests"),
    [
        (3.709, {2000: 0.02822, 8000: 0.9112, 14000: 5.701}, 12000, 12400),
        (3.709, {12000: 3.372, 12400: 3.765, 14000: 5.701}, 12000, 12400),
        (7.932, {3000: 0.2241, 7500: 2.188, 12000: 15.57}, 10000, 10500),
        (7.932, {10000: 6.491, 10500: 8.050, 12000: 15.57}, 10000, 10500),
        (9.101, {2000: 0.6565, 10000: 18.25}, 7100, 7300),
    ],
)
def test_the_speed_below_which_a_ball_moves_is_as_coarse_speeds_know_it(limit, starts, moves, rests):
    """Amplitudes that move the balls of two twisted solid blades and of the thick plate, at speeds far apart and near.

    Solved at more speeds, the balls move at the limit up to some speed between the last two numbers. A line of the
    drive over the square of the speed had 12830 and 10750 rpm for the blades, one through f1 and tilt 11660 and 10050.
    """
    omega, about = _slower(starts, limit, tilt_at=math.inf)
    assert about == pytest.approx(moves, rel=1e-9)
    assert about <= omega < rests


@pytest.mark.parametrize(("slow", "fast"), [(1000, 3000), (1400, 2400), (1500, 6000)])
def test_the_speed_below_which_a_ball_moves_lies_below_that_at_which_the_tilt_takes_its_drive(slow, fast):
    """1 mm at Ω1 = 1000 rpm, Ω²/(1 - (Ω/Ω2)²) with Ω2 = 2200 rpm: 2 mm move the ball up to 1253 rpm, 3 mm to 1409."""
    starts = {rpm: (rpm / 1000) ** 2 / abs(1 - (rpm / 2200) ** 2) for rpm in (slow, fast)}
    for limit in (2.0, 3.0, 4.0):
        moves = 1000 * math.sqrt(limit / (1 + limit * (1000 / 2200) ** 2))
        omega, about = _slower(starts, limit, tilt_at=2200)
        assert math.isnan(omega) if moves < 0.5 * slow else 0.9 * moves < about <= omega <= moves * (1 + 1e-9)


def _slower(starts, limit, tilt_at):
    """The remedy [rpm] by the amplitudes [mm] that move a ball at some speeds, the tilt's share 1 at one of them."""
    first = twelve().speeds[0]
    tilt = (2 * math.pi * first.reduced.f1_hz) ** 2 / (first.pressing * (tilt_at * math.pi / 30) ** 2)
    reduced = replace(first.reduced, floor_tilt=tilt)
    points = [
        replace(moved(first, cutoff=1e-3 * start), rpm=rpm, omega=rpm * math.pi / 30, reduced=reduced)
        for rpm, start in starts.items()
    ]
    omega, about = remedies._slower(replace(twelve(), speeds=points), points[-1], lambda _: 1e-3 * limit)
    return 30 / math.pi * omega, 30 / math.pi * about


def test_damping_at_amplitudes_that_strain_next_to_nothing_is_no_use():
    """0.19 % next to the cut-off, at 0.15 um, where the root is strained by 1e-7: "useful" was said of it."""
    pressed = {"ball_material": "hardened steel", "floor_material": "Ti-6Al-4V"}
    pressed |= {"restitution": "auto", "rolling_friction": "auto"}
    scene = changed(BLADE, rotor__speeds=["1500 rpm"], damper=BLADE["damper"] | pressed)
    found = workflows.run(scene)
    (point,) = found.speeds
    strain = 3e-3 * 3.516 / 0.12**2  # of a cantilever's root, over the amplitude of its tip
    assert point.damping_curve.cutoff * strain < 1e-7
    assert point.damping_curve.amplitude[0] * strain == pytest.approx(4e-6, rel=0.1)
    assert point.verdict.grade == Grade.MODEST
    assert point.verdict.damping_ratio < 1e-3
    (said,) = (each for each in remarks.remarks(found) if "left out" in each)
    assert said == (
        "The damping at amplitudes below 0.0051 mm is left out: they strain the root by less than 0.0004 %, "
        "a thousandth of what blade metals endure."
    )
    frequency = 2 * math.pi * point.reduced.f1_hz
    assert point.damper.peak_sdc_at_g * 9.80665 / frequency**2 * strain < 4e-6, "let go next to the cut-off"
    faint = f"At 1500 rpm ({point.load_g:.0f} g) the largest specific damping capacity of the ring-down"
    assert sum(each.startswith(faint) and "hardly strains the root" in each for each in remarks.remarks(found)) == 1
    released = workflows.run(changed(scene, release={"displacement": ["1 mm", "0 mm"]}))
    assert released.speeds[0].damper.peak_sdc_at_g > 1.0
    assert "hardly strains" not in " ".join(remarks.remarks(released))


@pytest.mark.parametrize("slips", [True, False])
def test_elastic_hits_dissipate_where_the_ball_slips_after_them(slips):
    """Without slip nothing is lost; with it the ring-down loses all, while "dissipate nothing" was the answer."""
    elastic = KNOWN["damper"] | {"restitution": 1.0, "rolling_friction": 0.0}
    scene = {"damper": elastic, "effects": {"ball_slip": slips}, "release": {"displacement": ["1 mm", "0 mm"]}}
    found = workflows.run(changed(KNOWN, rotor__speeds=["3000 rpm"], **scene))
    verdict, said = found.speeds[0].verdict, answer(found).verdict
    assert (verdict.reason == Reason.LOSSLESS) == ("dissipate nothing" in said) == (not slips)
    assert (verdict.damping_ratio > 1e-4) == (found.speeds[0].damper.energy.slip > 0) == slips


def test_a_ball_that_fills_its_cavity_along_one_axis_may_move_along_the_other():
    """It hits the walls across all along: "never moves" was said of it."""
    damper = BLADE["damper"] | {"cavity": ["4 mm", "5 mm"], "rolling_friction": "0.001 mm"}
    scene = changed(BLADE, rotor__speeds=["3000 rpm"], rotor__stagger="45 deg", rotor__modes=3, damper=damper)
    found = workflows.run(scene | {"release": {"displacement": ["2 mm", "0 mm"], "cycles": 300}})
    assert found.speeds[0].damper.impacts > 0
    assert answer(found).verdict == "No: along the bending direction the balls cannot move"
    filled = changed(scene, damper=damper | {"cavity": ["4 mm", "4 mm"]})
    assert answer(workflows.run(filled)).verdict == "No: the balls never move"


def test_a_capacity_below_the_cut_off_is_of_a_ball_that_still_bounces():
    """Twelve balls, held at rest up to about 3000 g."""
    found = twelve()
    point = found.speeds[0]
    begins = (2 * math.pi * point.reduced.f1_hz) ** 2 * point.damping_curve.cutoff / found.scene.rotor.gravity
    bounced = replace(point.damper, impacts=9, peak_sdc=0.15, energy=replace(point.damper.energy, impact=1.0))
    low, high = (replace(point, damper=replace(bounced, peak_sdc_at_g=g)) for g in (500.0, 1e4))
    assert 1e3 < begins < 1e4
    still = replace(low, damper=replace(low.damper, impacts=0))
    for none in (high, still, replace(low, damper=replace(low.damper, peak_sdc=1e-15))):
        assert remarks.bouncing_capacity(replace(found, speeds=[none])) is None
    assert remarks.faint_capacity(replace(found, speeds=[low, high])) is None
    said = remarks.bouncing_capacity(replace(found, speeds=[low, high]))
    assert said
    assert said.startswith(f"At 8000 rpm ({point.load_g:.0f} g) the largest specific damping")
    assert said.endswith(
        f"15 %, is of a cycle at 500 g, below the {begins / 100:.0f}00 g at which balls at rest begin to roll: "
        "the verdict counts on no balls that still bounce there."
    )


def test_the_most_within_the_limit_may_be_at_the_limit():
    """Between two points of a curve that rises: the lower one counted, a third less."""
    found = twelve()
    point, limit = found.speeds[0], limits.endured(found, found.speeds[0].omega)
    amplitude, ratio = limit * np.array([0.5, 0.8, 1.2]), np.array([1e-4, 2e-4, 4e-4])
    rising = {"amplitude": amplitude, "damping_ratio": ratio, "peak": 4e-4, "peak_amplitude": 1.2 * limit}
    best = limits.best(found, moved(point, cutoff=0.4 * limit, **rising))
    assert (best.limited, best.amplitude) == (True, limit)
    assert best.damping_ratio == pytest.approx(3e-4)


def test_amplitudes_without_damping_end_at_the_limit_and_a_ball_out_of_reach_never_moves():
    """Damping was denied at any amplitude beside a table that shows some beyond what the plate endures."""
    found = twelve()
    point, limit = found.speeds[0], limits.endured(found, found.speeds[0].omega)
    for cutoff, words in (
        (0.5 * limit, "at any of the amplitudes searched, from {} that the plate endures"),
        (2 * limit, "No: the balls never move within what the plate endures"),
    ):
        none = {"peak": 1e-15, "damping_ratio": np.zeros(2), "amplitude": cutoff * np.array([1.0, 4.0])}
        said = text(limits.with_verdicts(replace(found, speeds=(moved(point, cutoff=cutoff, **none),))))
        assert words.format(f"{1e3 * cutoff:.2g} mm to the {1e3 * limit:.2g} mm") in said


def test_a_mesh_has_room_for_balls_up_to_its_thickness(paper):
    """A radius of 6.75 mm was advised in a plate of 3 mm; where the thickness varies, none is."""
    plate = {"mesh": str(COARSE), "thickness": "3 mm"}
    assert limits.room(as_scene_file(changed(paper, plate=plate)).scene) == 3e-3
    varied = {"mesh": str(COARSE), "thickness": {"x": ["0 mm", "200 mm"], "values": ["6 mm", "3 mm"]}}
    assert limits.room(as_scene_file(changed(paper, plate=varied)).scene) == 0.0


def test_no_way_out_by_a_ball_thicker_than_the_plate():
    """Of a given mass, the ball moves from a radius on that its plate has no room for; a housing on it has."""
    light = {"damper__ball_density": None, "damper__mass_ratio": 5e-4}
    inside, outside = (workflows.run(thick(17500, **light, **at)) for at in ({}, {"damper__housing": "1 g"}))
    assert math.isnan(remedies.what_moves(inside, inside.speeds[0]).radius)
    assert remedies.what_moves(outside, outside.speeds[0]).radius > 5e-3
    assert "radius" not in answer(inside).sentences[0]
    assert "a ball radius above" in answer(outside).sentences[0]


def test_a_crossing_that_holds_the_ball_names_the_friction_that_does_not():
    """One percent below it the same crossing sees the ball move at what the plate endures, one above it does not."""

    def crossed(friction):
        shaken = {"excitation": {"orders": [3], "force": ["1 N"]}, "damper__damping_ratio": 1e-3}
        return workflows.run(thick(3000, 5000, damper__rolling_friction=friction, **shaken))

    held = crossed(0.6e-3)
    (found,) = held.reductions
    friction = remedies.friction_that_moves(held, found)
    holds = "the load holds the ball at rest up to"
    words = rf"{holds} [0-9.]+ N; it would move with a rolling friction below ([0-9.]+) mm$"
    said = re.search(words, answer(held).verdict)
    assert 0.99 < float(said[1]) / (1e3 * friction) <= 1
    assert [holds in answer(crossed(factor * friction)).verdict for factor in (0.99, 1.01)] == [False, True]


def test_a_locked_ball_in_its_dent_moves_with_the_rolling_friction_that_is_named():
    """A dent holds with its slope, whatever that friction is: one percent below it moves, one above it does not."""
    pressed = {"damper__ball_density": None, "damper__ball_material": "hardened steel", "material__name": "Ti-6Al-4V"}
    found = workflows.run(thick(10000, **pressed))
    (point,), limit = found.speeds, limits.endured(found)
    assert limits.rim_slope(found.scene, point) > 0
    friction = remedies.what_moves(found, point).rolling_friction
    said = re.search(r"at the [0-9.]+ mm that the plate endures, .* a rolling friction below ([0-9.]+) mm", text(found))
    assert 0.99 < float(said[1]) / (1e3 * friction) <= 1
    moved = [sets_off(thick(10000, **pressed, damper__rolling_friction=f * friction), limit) for f in (0.99, 1.01)]
    assert moved == [True, False]


def test_without_a_plate_only_the_amplitude_is_known():
    found = results(speeds="17500")
    (point,) = found.speeds
    remedy = remedies.what_moves(found, point)
    omega, load = 2 * math.pi * 269.5, (17500 * math.pi / 30) ** 2 * 0.2
    assert remedy.amplitude == pytest.approx(0.1 * load / omega**2)
    assert all(map(math.isnan, remedy[1:]))
    assert remedies.what_moves(found, results(speeds="0").speeds[0]) is None


def test_no_load_ends_when_the_vibration_has_died_out():
    damping = results(speeds="0").speeds[0].damper
    assert "died out" in damping.outcome
    assert damping.cutoff_g is None
    assert damping.peak_sdc < 0.5
    assert len(damping.sdc) < 1000


def test_a_ball_that_loses_nothing_lends(structure):
    """At e = 1 the structure's energy swings by a percent from cycle to cycle, all of which the ball gives back.

    What is left is the structure's own, 1 - exp(-4 pi zeta omega_2/omega_1 M2/M1) with the ball's mass on it.
    """
    scene = changed(structure, damper__restitution=1, damper__friction=0, damper__rolling_friction=0)
    scene = changed(scene, damper__sticking_ratio=1e-9, release__displacement=["2 mm", 0], rotor__speeds=["0 rpm"])
    for zeta, loses in ((0.0, "0"), (0.001, f"{-100 * math.expm1(-4e-3 * math.pi / 1.006**0.5):.3g}")):
        run = workflows.run(changed(scene, damper__damping_ratio=zeta))
        (point,) = run.speeds
        assert point.damper.peak_sdc > point.damper.intrinsic_sdc + 0.005
        heads, row = summary.rows(run)
        assert row[heads.index("SDC %")] == loses
        assert any(note.startswith("Balls and structure exchange energy") for note in run.notes)
    assert not any("exchange" in note for note in workflows.run(structure).notes)


@pytest.mark.parametrize(
    ("friction", "begin"), [(0, "They neither"), (0.3, "Along the bending direction they neither")]
)
def test_a_ball_that_loses_nothing(friction, begin, structure):
    """At e = 1 without rolling resistance nothing is lost along one axis; no hit is so slow as to stick."""
    scene = changed(structure, damper__restitution=1, damper__friction=friction, damper__rolling_friction=0)
    run = workflows.run(changed(scene, damper__sticking_ratio=1e-9, release__displacement=["20 mm", 0]))
    energy = run.speeds[0].damper.energy
    assert energy.final == pytest.approx(energy.initial, rel=1e-9)
    said = answer(run)
    assert said.verdict == "No: the balls dissipate nothing"
    assert run.speeds[0].verdict.reason == "no_loss"
    assert said.sentences[0].startswith(begin)


def test_damping_that_was_not_found_is_not_denied(structure):
    """So light a ball takes less than rounding leaves, though it hits walls with e = 0.5."""
    run = workflows.run(changed(structure, damper__mass_ratio=1e-20, damper__count=None))
    assert run.speeds[0].damper.impacts > 0
    assert "neither rolls" not in text(run)
    assert answer(run).verdict == "Undecided: no damping by the ball was found"
    assert "at any of the amplitudes searched, from 7.6 mm on, which does not prove that there is none" in text(run)


@pytest.mark.parametrize(
    ("tilt", "rpm", "said"),
    [
        (6.9, (10000,), "which cancels 53 % of the balls' drive; the figures include it."),
        (6.9, (10000, 20000), "cancels 53 to 210 % of the balls' drive; the figures include it; above 100 % the slope"),
        (300, (10000,), "the slope drives the balls, with 2300 % of the drive by inertia."),
        (-6.9, (10000,), "the slope adds 53 % to the balls' drive"),
    ],
)
def test_the_slope_of_the_floor_in_one_sentence(tilt, rpm, said, structure):
    """The load's pull over the motion's: Omega² R kappa / omega_1² = 0.0765 kappa at 10,000 rpm, kappa in 1/m."""
    speeds = [f"{value} rpm" for value in rpm]
    run = workflows.run(changed(structure, structure__floor_tilt=tilt, rotor__speeds=speeds))
    told = [sentence for sentence in answer(run).sentences if "slope" in sentence]
    assert len(told) == 1
    assert told[0].startswith("As the structure moves, the cavity's floor tilts")
    assert said in told[0]
    assert ("cancels" in told[0]) == (0 < tilt < 10)


HOLLOW = {
    "structure": {"frequency": "213 Hz", "mass": "1 kg"},
    "rotor": {"speeds": ["4261 rpm"], "radius": "20 cm"},
    "damper": BALL
    | {"mass_ratio": 0.01, "cavity": ["8 mm", "8 mm"], "floor_radius": "20 mm"}
    | {"rolling_friction": "0.005 mm", "damping_ratio": 0.001},
    "release": {"ratio": 0.15},
    "accuracy": {"damping": 0.02},
}
"""A pendulum near the structure's frequency: the ball takes energy and gives it back."""


def test_what_a_ball_holds_and_gives_back_is_not_lost():
    """The capacity of a cycle in the table, and the answer above it; and down to where a ball in motion goes on."""
    found = workflows.run(HOLLOW)
    (point,) = found.speeds
    own, rung = point.damping_curve, point.damper
    assert np.nanmin(rung.sdc) < 0, "the ball gives back"
    peak = own.from_above.peak
    assert rung.peak_sdc > 2 * -math.expm1(-4 * math.pi * peak)
    last = 1e3 * rung.cutoff_g * found.scene.rotor.gravity / (2 * math.pi * 213) ** 2
    assert last < 0.8e3 * own.cutoff
    assert f"below {1e3 * own.cutoff:.2g} mm (a moving ball keeps moving down to {last:.2g} mm)" in text(found)


@pytest.mark.parametrize(("release", "damping"), [(0.6, 0.5), (0.6, 0.9), (30.0, 0.6)])
def test_near_critical_damping_does_not_keep_a_ball_moving(release, damping):
    """On a level floor without a dent no amplitude below a_r / (omega_1^2 - E) drives it by more than the floor holds.

    The structure comes to rest within the cycle in which the ball, thrown by the release, rolls on.
    """
    ball = {"radius": "2 mm", "cavity": ["5 mm", "5 mm"], "ball_density": "7850 kg/m^3", "count": 10}
    found = workflows.run(
        {
            "structure": {"frequency": "200 Hz", "mass": "1 kg", "floor_tilt": "5 1/m"},
            "rotor": {"speeds": ["5000 rpm"], "radius": "20 cm"},
            "damper": BALL | ball | {"rolling_friction": "0.02 mm", "damping_ratio": damping},
            "release": {"displacement": [f"{release} mm", "0 mm"]},
        }
    )
    load = (5000 * math.pi / 30) ** 2 * 0.2
    held = 0.01 * load / ((2 * math.pi * 200) ** 2 - 5 * load)
    last = found.speeds[0].damper.cutoff_g * found.scene.rotor.gravity / (2 * math.pi * 200) ** 2
    assert last < 0.8 * held, "the velocity's maximum after which it moved last"
    said = text(found)
    assert f"below {1e3 * held:.2g} mm" in said
    assert "moving" not in said


def test_a_verdict_on_rolling_says_what_it_rests_on():
    """Slippery walls; little load, or a vibration of 1 MHz, where no floor keeps the ball rolling."""
    rests = (
        "Of little use: at most 0.049 % equivalent damping ratio (at 3500 rpm), provided that the balls roll without"
        " slip, which at the amplitude of largest damping requires a friction coefficient of "
    )
    slides = "No verdict: the balls would slide, since rolling requires a friction coefficient of "
    for speeds, frequency, friction, says in (
        ("3500", "269.5 Hz", "0.1", rests),
        ("100", "269.5 Hz", "0.3", slides),
        ("3500", "1 MHz", "0.3", slides),
    ):
        scene = changed(base(speeds, release="0.001 0", friction=friction), structure__frequency=frequency)
        said = answer(workflows.run(scene))
        verdict = said.verdict
        assert verdict.startswith(says), verdict
        assert (said.sentences == ()) == (says is slides), "one reason for all"
        assert verdict.endswith(", and the scene has 0.1") == (says is rests)
        assert (", provided that " in verdict) == (says is rests)


def test_what_a_verdict_rests_on_stands_with_what_it_qualifies():
    """On walls of 0.05, before where the balls are locked."""
    slippery = {"damper__friction": 0.05, "damper__count": 12, "release__cycles": 2}
    verdict = answer(workflows.run(thick(1000, 12000, **slippery))).verdict
    proviso = (
        r", provided that the balls roll without slip, which .* friction coefficient of 0\.27 at 1000 rpm \(224 g\)"
    )
    assert re.search(rf"\(at 1000 rpm\){proviso}, and the scene has 0\.05; the balls are locked at 12000 rpm", verdict)


def test_without_friction_no_ball_rolls():
    """However little friction rolling needs: 2/7 of the drive over the load, without rolling resistance."""
    found = results(friction="0", rolling_friction="0")
    demands = [limits.friction_demand(found, p, p.damping_curve.peak_amplitude) for p in found.speeds]
    assert 0 < max(demands) < 0.02
    assert [point.verdict.reason for point in found.speeds] == ["slip", "slip"]
    assert re.fullmatch(
        r"No verdict: the balls would slide, since rolling requires a friction coefficient of 0\.0013 to 0\.011 at the"
        r" amplitude of largest damping, and the scene has 0",
        answer(found).verdict,
    )
    assert answer(results(friction="0.02", rolling_friction="0")).verdict.startswith("Useful")


@pytest.mark.parametrize(
    ("count", "wrong"), [(1, r"\bballs\b|\bthey\b"), (12, r"\b(the|this) ball\b|\bit (moves|keeps|adds)\b")]
)
def test_several_balls_are_several_in_every_sentence(count, wrong):
    """Of a damper that works at one speed and is locked at the other, under orders too weak and too strong for it."""
    levels = {"excitation": {"orders": [3, 13], "force": ["0.001 N", "1 N", "200 N"]}, "damper__damping_ratio": 1e-3}
    found = workflows.run(thick(1000, 12000, damper__count=count, damper__friction=0.05, **levels))
    told = " ".join([text(found), *remarks.remarks(found)])
    for part in (
        "without hitting a wall",
        "hold",
        "move above",
        "at rest;",
        "provided that",
        "Estimated",
        "spins the",
        "slip.",
    ):
        assert part in told.replace("moves", "move"), part
    assert not re.findall(f".{{30}}(?:{wrong}).{{20}}", told)


def test_equal_ranges_are_told_once():
    """Without rolling friction a level floor knows no load: the same at both speeds."""
    (said,) = (
        each for each in answer(results(friction="0.3", rolling_friction="0")).sentences if "half of their" in each
    )
    assert said.startswith("At 3500 rpm and at 10000 rpm the balls give at least half of their largest damping at ")
    assert said.count("amplitudes") == 1


def test_a_thin_plate_bends_little_before_it_is_strained():
    """A ruler's root takes 0.4 % only where its tip is out by half of its length, far beyond small deflections."""
    paper = workflows.load("paper")
    ruler = paper.changed(plate={"length": 0.5, "width": 0.01, "thickness": 0.001}, damper={"at": None})
    at_rest = SimpleNamespace(
        omega=0.0, radius=0.5, root_stress=None, root_strain=0.5e-3 * 3.516 / 0.5**2, tip_motion=1.0
    )
    found = SimpleNamespace(scene=ruler.scene, surface=None, speeds=(at_rest,))
    assert limits.ENDURED / limits.largest_strain(found) > 0.5
    assert limits.endured(found) == pytest.approx(0.125)
    beyond = remarks.phrase("phrases/beyond", found, by_deflection=limits.deflection_governs(found))
    assert beyond.startswith("bend the plate by over 25 % of its length")
    necked = ruler.scene.plate.model_copy(update={"mesh": "necked.msh"})
    shapes = (ruler.scene, ruler.scene.model_copy(update={"plate": necked}))
    assert [limits.strained(each) for each in shapes] == ["root", "plate"]
    assert remarks.beyond_means(found, [0.0]) == f"{BEYOND} Beyond small deflections"
    assert remarks.phrase("phrases/bounds", found, by_deflection=True) == "small deflections"
    assert remarks.phrase("phrases/bounds", found, by_deflection=False) == "what the plate endures"


def test_the_friction_that_rolling_needs_is_that_of_a_ring_down():
    """From the amplitude of the best: what the engine met on the way."""
    damper = HOLLOW["damper"]
    flat = {name: each for name, each in damper.items() if name != "floor_radius"}
    flat |= {"rolling_friction": "0.0001 mm", "cavity": ["2.5 mm", "2.5 mm"]}
    whole = workflows.run(HOLLOW | {"damper": flat})
    (first,) = whole.speeds
    amplitude = first.damping_curve.peak_amplitude
    release = {"displacement": [amplitude, 0.0], "cycles": 3}
    again = workflows.run(HOLLOW | {"damper": flat, "release": release}).speeds[0]
    demand = again.damper.largest_rolling_demand
    assert limits.friction_demand(whole, first, amplitude) == pytest.approx(demand, rel=0.02)


def test_nothing_presses_a_ball_at_rest():
    remarks = [
        [note for note in results(speeds=speeds).notes if note.startswith("At 0 rpm no load")]
        for speeds in ("3500", "0 3500", "0")
    ]
    assert remarks[0] == []
    free = "At 0 rpm no load presses the balls on their floors: they are free between the walls"
    free += ", and rolling_friction has no effect."
    assert remarks[1] == [f"{free} The verdict covers the other speeds."]
    assert remarks[2] == [free]


def test_a_ball_denser_than_any_solid_has_no_verdict():
    """6 g in a ball of radius 1 mm: 1.43e6 kg/m³, where osmium has 22 600; 183 of steel are 7820 each."""
    said = answer(results(count="1"))
    assert said.verdict == (
        "No verdict: a ball of radius 1 mm and 6 g would be 63 times as dense as osmium, the densest solid"
    )
    assert "such as 183 of steel ([damper] count)" in said.sentences[0]
    assert answer(results(count="63")).verdict.startswith("No verdict: a ball")
    assert answer(results(count="64")).verdict.startswith("Of little use: at most ")


@pytest.mark.parametrize(
    ("changes", "verdict", "reason"),
    [
        (
            {"formulation": "printed"},
            "the equations as printed do not cons",
            "the equations as printed do not support a force",
        ),
        ({"count": 1}, "a ball of radius 1 mm and 1", "no solid is as dense as this ball"),
    ],
)
def test_a_damper_that_is_refused_has_no_estimate_at_engine_orders(changes, verdict, reason, paper, monkeypatch):
    """Orders 2 and 3 meet modes within the speeds; where, is not solved."""
    monkeypatch.setattr(excitation, "solved_crossings", lambda *_: pytest.fail("crossings were solved"))
    scene = changed(paper, rotor__speeds=["3500 rpm", "10000 rpm"], release__cycles=2, accuracy__frequency=0.05)
    said = answer(workflows.run(changed(scene, **{f"damper__{key}": value for key, value in changes.items()})))
    assert said.verdict.startswith(f"No verdict: {verdict}")
    assert [each for each in said.sentences if "ngine order" in each] == [
        f"Engine orders 2 and 3: no estimate, since {reason}."
    ]


def test_a_speed_that_no_blade_metal_bears_has_no_verdict(paper):
    """The paper's plate bears ρ Ω² L²/2 on average: 527 MPa at 17500 rpm, 2475 MPa at 37923."""
    scene = changed(paper, rotor__speeds=["3500 rpm", "37000 rpm", "38000 rpm"], release__cycles=2)
    scene["accuracy"] = {"frequency": 0.02}  # the pull is the same on every mesh
    del scene["excitation"]
    stresses = [7850 * (rpm * math.pi / 30) ** 2 * 0.2**2 / 2 / 1e6 for rpm in (37000, 38000)]
    assert stresses == pytest.approx([2357, 2486], abs=1)
    found = workflows.run(scene)
    verdict = answer(found).verdict
    assert verdict.startswith("Of little use: at most ")
    assert "; the balls are locked at 37000 rpm (300255 g); no verdict above " in verdict
    limit = re.search(r"no verdict above (\d+) rpm: at 38000 rpm the mean .* at the root, 2490 MPa, exceeds", verdict)
    assert float(limit[1]) == pytest.approx(math.sqrt(2 * 2400e6 / 7850) / 0.2 * 30 / math.pi, rel=2e-3)
    assert "38000" not in " ".join(answer(found).sentences)
    assert [limits.is_torn(found, point) for point in found.speeds] == [False, False, True]
    assert [point.verdict.reason for point in found.speeds[1:]] == ["out_of_reach", "root_stress"]
    assert [remarks.mark(found, point) for point in found.speeds] == ["", BEYOND, remarks.NO_VERDICT]
    torn = workflows.run(changed(scene, rotor__speeds=["38000 rpm"]))
    assert answer(torn).verdict.startswith(f"No verdict above {limit[1]} rpm: at 38000 rpm")
    alone = {table: scene[table] for table in ("title", "plate", "material", "rotor", "accuracy")}
    assert f"; it cannot run above {limit[1]} rpm: at 38000 rpm the" in answer(workflows.run(alone)).verdict
    barely = workflows.run(changed(alone, rotor__speeds=[f"{float(limit[1]) + 2} rpm"]))
    stress = re.search(r"root, ([\d.]+) MPa, exceeds what any blade metal endures \(2400 MPa\)", answer(barely).verdict)
    assert 2400 < float(stress[1]) < 2401
    slow = workflows.run(changed(alone, rotor__speeds=["3500 rpm"]))
    assert (
        answer(slow).sentences[0]
        == f"The first frequency is {slow.speeds[0].modes[0].frequency_hz:.5g} Hz at 3500 rpm."
    )


def test_a_damping_ratio_of_rounding_counts_as_none():
    """Of 1e-15 no verdict speaks as of a little."""
    found = results()
    points = tuple(moved(p, damping_ratio=1e-12 * p.damping_curve.damping_ratio, peak=1e-15) for p in found.speeds)
    said = answer(limits.with_verdicts(replace(found, speeds=points)))
    assert said.verdict == "Undecided: no damping by the balls was found"


def test_the_pull_is_that_of_a_mesh_as_well(paper):
    """The same plate: ρ Ω² L²/2."""
    plate = {"mesh": str(COARSE), "thickness": "1 cm", "theory": "kirchhoff"}
    rotor = {"speeds": ["17500 rpm"], "modes": 1}
    found = workflows.run(
        {"plate": plate, "material": paper["material"], "rotor": rotor, "accuracy": {"frequency": 0.5}}
    )
    expected = 7850 * (17500 * math.pi / 30) ** 2 * 0.2**2 / 2
    assert limits.root_stress(found, found.speeds[0].omega) == pytest.approx(expected, rel=1e-9)


def test_rows_beyond_what_the_plate_endures_are_marked_alike(finished):
    """From 7500 rpm on the paper's ball is best at more than the 9.1 mm that the root endures."""
    found = workflows.load_results(finished)
    assert [limits.is_beyond(found, point) for point in found.speeds] == [False, False, True, True, True, True, True]
    printed = summary.text(found, None)
    marked = [line for line in printed.splitlines() if BEYOND in line]
    assert len(marked) == 6
    assert BEYOND_MEANS in " ".join(printed.split())
    assert LEVEL_MEANS in " ".join(printed.split()), "the scene keeps the floor level; the damping ratios do not"
    assert LEVEL_MEANS not in " ".join(summary.text(results(friction="0.3"), None).split())
    assert BEYOND_MEANS in found._repr_html_(), "in a notebook"
    page = (finished / "report.html").read_text(encoding="utf-8")
    assert page.count(f"{BEYOND}</td>") == 5
    assert BEYOND_MEANS in page


def test_a_run_without_pictures_knows_what_a_given_mesh_endures():
    """The shapes of the modes are drawn or not; the strength of the root is judged in either case."""
    scene = on_mesh(thick(3500, rotor__modes=1, accuracy={"frequency": 0.5}), COARSE)
    drawn, undrawn = (
        limits.endured(pipeline.structure(as_scene_file(scene), QUIET, shapes=shapes).results())
        for shapes in (True, False)
    )
    assert undrawn is not None
    assert undrawn == drawn


SPEEDS = (0, 1e-3, 40, 60, 80, 100, 200, 220, 400, 500, 600, 700, 1000, 3500, 5000, 17500, 20000)


@cache
def at_all_speeds():
    """On a known structure a speed knows nothing of the others."""
    return workflows.run(KNOWN | {"rotor": KNOWN["rotor"] | {"speeds": [f"{each:g} rpm" for each in SPEEDS]}})


def at(*rpm):
    """Results at these speeds, with their remarks."""
    every = at_all_speeds()
    speeds = tuple(every.speeds[SPEEDS.index(each)] for each in rpm)
    scene = every.scene.changed(rotor={"speeds": tuple(point.omega for point in speeds)})
    found = replace(every, scene=scene, speeds=speeds)
    return replace(found, notes=remarks.remarks(found))


def load(rpm):
    """Centrifugal acceleration at 20 cm over g."""
    return (rpm * math.pi / 30) ** 2 * 0.2 / 9.80665


def needed(results, k):
    """2/7 of the drive over the load and 5/7 of the rolling resistance: the friction of pure rolling."""
    amplitude = results.speeds[k].damping_curve.peak_amplitude
    drive = (2 * math.pi * 269.5) ** 2 * amplitude / 9.80665
    return 2 / 7 * drive / load(results.speeds[k].rpm) + 5 / 7 * 0.01


def test_a_ball_that_slides_supplies_no_best():
    """At 80 and 100 rpm, of which both are named, rolling takes more friction than any dry metal has."""
    found = at(80, 100, 3500)
    assert needed(found, 0) > needed(found, 1) > limits.DRY > needed(found, 2)
    assert [point.verdict.grade for point in found.speeds] == ["unknown", "unknown", "yes"]
    said = answer(found)
    assert said.verdict == (
        "Useful at 3500 rpm (2740 g); no verdict up to 100 rpm (2.24 g): there the balls would slide, since"
        f" rolling requires a friction coefficient of {needed(found, 1):.2g} to {needed(found, 0):.2g} at the amplitude"
        " of largest damping"
    )
    told = " ".join(said.sentences)
    assert "%, at 3500 rpm" in told
    assert "80 rpm" not in told
    assert "100 rpm" not in told


def test_a_middle_of_speeds_has_both_its_ends():
    """Slow enough to slide, then weak at one speed, then good, then too fast for as much."""
    verdict = answer(at(100, 700, 1000, 3500, 17500)).verdict
    assert verdict.startswith(
        "Of little use at 700 rpm (110 g), useful from 1000 rpm (224 g) to 3500 rpm (2740 g), of little use at"
        " 17500 rpm (68492 g)"
    )
    assert "; no verdict at 100 rpm" in verdict


def test_a_verdict_ends_where_the_contact_yields():
    """What is of little use at one speed is not so from it on, where nothing is said of those above."""
    found = at(1000, 17500, 20000)
    end = replace(found.speeds[2], verdict=Verdict.without_figures(Grade.INADMISSIBLE, Reason.CONTACT))
    assert answer(replace(found, speeds=(*found.speeds[:2], end))).verdict.startswith(
        "Useful at 1000 rpm (224 g), of little use at 17500 rpm (68492 g); no verdict at 20000 rpm"
    )
    end = replace(found.speeds[2], verdict=Verdict.without_figures(Grade.LOCKED, Reason.OUT_OF_REACH, 0.0))
    assert answer(replace(found, speeds=(*found.speeds[:2], end))).verdict == (
        "Useful at 1000 rpm (224 g), of little use at 17500 rpm (68492 g); the balls are locked at 20000 rpm (89460 g)"
    )


def reduction(*levels):
    """At a crossing, with forces in N, the share of the amplitude that each leaves, and whether the root endures it."""
    own = tuple(ForceLevel(force, ratio, 1e-3, borne) for force, ratio, borne in levels)
    return VibrationReduction(4, 1, "flap", 5000.0, 333.0, 0.32, 3.0, (1.7, 7.7), 40.0, 0.8, own)


def under_orders(run, *orders, forces=(1.0,), **given):
    """The same run of a scene that has these engine orders."""
    excitation = Excitation.model_validate({"orders": orders, "force": [f"{force:g} N" for force in forces]})
    return replace(run, scene=run.scene.changed(excitation=excitation), **given)


def test_levels_beside_the_range_have_their_own_numbers():
    """A level outside the range of the best may still reach more than half of it."""
    rows = ((1.0, 0.57, True), (2.0, 0.3, True), (9.0, 0.9, True), (50.0, 1.0, False), (0.5, 1.0, True))
    found = reduction(*rows)
    run = under_orders(at(1000), 4, reductions=(found,))
    assert of_orders(run)[0] == (
        "At engine order 4 (5000 rpm, flap mode): up to 68 % less vibration at 3 N, at least half of that between 1.7"
        " and 7.7 N. At 50 N the structure would be overstressed. At 0.5 N the load holds the balls at rest; they"
        " move from 0.8 N on. At 1 N the reduction is 43 %. At 2 N the reduction is 70 %. At 9 N the reduction is 10 %."
    )
    assert of_orders(replace(run, reductions=(replace(found, loose=True),)))[0].endswith(
        ": roughly up to 68 % less vibration at 3 N, at least half of that roughly between 1.7 and 7.7 N. At 50 N"
        " the structure would be overstressed. At 0.5 N the load holds the balls at rest; they move from 0.8 N on."
        " At 1 N the reduction is roughly 43 %. At 2 N the reduction is roughly 70 %."
    )
    worse = reduction((9.0, 0.9, True), (30.0, 1.002, True))
    assert of_orders(replace(run, reductions=(worse,)))[0].endswith(
        " At 30 N the balls do not reduce the amplitude. At 9 N the reduction is 10 %."
    )
    leaning = replace(run, speeds=tuple(replace(point, lean=(0.1, 0.0)) for point in run.speeds))
    assert "the load holds the balls at rest; they move, first to a wall, from 0.8 N on" in of_orders(leaning)[0]


def test_the_ends_of_a_range_do_not_read_like_the_levels_beside_them():
    found = replace(reduction((1.7, 0.67, True), (7.7, 0.5, True)), range=(1.7046, 7.7))
    (said,) = of_orders(under_orders(at(1000), 4, reductions=(found,)))
    assert "at least half of that between 1.705 and 7.7 N" in said


def test_a_rough_estimate_is_named():
    """Of two crossings one is rough, of another nothing is estimated."""
    firm = reduction((1.0, 0.5, True))
    rough = replace(firm, order=6, rpm=3300.0, loose=True)
    idle = VibrationReduction(3, 1, "flap", 7000.0, 350.0, reason=Reason.SWINGS)
    run = under_orders(at(1000), 3, 4, 6)
    for reductions, caution in (
        (
            (firm, rough, idle),
            "roughly at engine order 6 (3300 rpm), where the load holds these balls loosely: there rely on",
        ),
        ((rough, idle), "A rough estimate from free vibration, since the load holds these balls loosely: rely on"),
        ((firm, idle), "Estimated from free vibration; `spindamp response` computes"),
    ):
        said = " ".join(answer(replace(run, reductions=reductions)).sentences)
        assert caution in said
        assert said.count("free vibration") == 1
        assert "(7000 rpm, flap mode): no estimate, since the balls swing freely in their hollow floor;" in said


def test_estimates_for_heavy_balls_are_rough():
    """Balls of a twelfth of the plate's mass there; with a tenth the ratio simulated was up to a third off."""
    air = {"damper__damping_ratio": 1e-3}
    few, many = (
        workflows.run(changed(BLADE, rotor__speeds=["5 krpm", "7 krpm"], excitation=SHAKEN, damper__count=count, **air))
        for count in (2, 12)
    )
    assert [limits.is_heavy(found.speeds[0]) for found in (few, many)] == [False, True]
    assert [[each.loose for each in found.reductions] for found in (few, many)] == [[False], [True]]
    lower = 1 - many.speeds[0].reduced.f1_hz / many.speeds[0].reduced.f2_hz
    (note,) = (note for note in remarks.remarks(many) if "in their cavities the frequency is" in note)
    assert f"{100 * lower:.2g} % lower than that of the plate without balls" in note
    assert not any("in their cavities the frequency" in note for note in remarks.remarks(few))
    said = [" ".join(answer(found).sentences) for found in (few, many)]
    assert ["since these balls are heavy beside the structure" in each for each in said] == [False, True]
    assert "roughly up to" in answer(many).verdict


SHAKEN = {"orders": [4], "force": ["1 N", "3 N"]}


def test_levels_at_which_the_ball_is_of_no_use_come_first():
    """Held at rest, or more than the root endures: what it does at other levels comes after."""
    found = reduction((0.5, 1.0, True), (50.0, 0.4, False), (0.9, 0.995, True))
    run = under_orders(at(1000), 4, forces=(0.5, 50.0, 0.9), reductions=(found,))
    assert answer(run).verdict.startswith(
        "At engine order 4 (5000 rpm, flap mode): not useful at 0.5, 50 and 0.9 N, but up to 68 % less vibration at 3 N"
    )


@pytest.mark.parametrize(
    ("error", "said"), [(0.02, "and may do so within this range, since frequencies are accurate to 2 %"), (0.01, "")]
)
def test_an_order_that_may_meet_its_mode_within_the_error_is_not_denied(error, said):
    """A mode of 200 Hz meets order 3 at 4000 rpm, 1.3 % beyond the speeds."""
    run = at(1000, 3500)
    modes = (Mode(200.0, "flap", ErrorParts(error, 0.0, 0.0, 0.0, None, None)),)
    speeds = tuple(
        replace(point, modes=modes, rpm=rpm, omega=rpm * math.pi / 30)
        for point, rpm in zip(run.speeds, (1000.0, 3950.0), strict=True)
    )
    (sentence,) = of_orders(under_orders(run, 3, speeds=speeds, reductions=()))
    assert sentence.startswith(
        "Engine order 3 meets no mode between 1000 and 3950 rpm; it would meet the first near 4000"
    )
    assert sentence.endswith(f" rpm, {said}." if said else "4000 rpm.")


def test_a_frequency_between_files_of_modes_is_known_only_roughly():
    """The mesh's part is not known there, that of interpolation is."""
    run = at(1000)
    modes = (Mode(200.0, "flap", ErrorParts(None, 0.0, 0.33, 0.0, None, None)),)
    speeds = tuple(replace(point, modes=modes) for point in run.speeds)
    assert "the first frequency is known only to 33 %" in answer(replace(run, speeds=speeds)).verdict


def test_friction_beyond_the_given_names_every_speed():
    """Less than dry metals have, more than the scene's 0.3."""
    found = at(400, 500, 3500)
    assert limits.DRY > needed(found, 0) > needed(found, 1) > 0.3 > needed(found, 2)
    assert answer(found).verdict.endswith(
        "provided that the balls roll without slip, which at the amplitude of largest damping requires a friction"
        f" coefficient of {needed(found, 1):.2g} to {needed(found, 0):.2g} up to 500 rpm (55.9 g), and the scene has"
        " 0.3"
    )


def test_friction_just_beyond_the_given_reads_otherwise():
    """Both would read 0.3 or so in two digits; the ring-down's too."""
    found = at(500, 3500)
    for given, says in (
        (needed(found, 0), lambda of: answer(of).verdict),
        (found.speeds[0].damper.largest_rolling_demand, remarks.rolling),
    ):
        friction = float(f"{0.9998 * given:.5g}")
        said = says(replace(found, scene=found.scene.changed(damper={"friction": friction})))
        demand, has = re.search(r"of (?:up to )?([\d.]+)[ ,].*(?:scene has|more than the) ([\d.]+)", said).groups()
        assert float(demand) > float(has) == friction


def test_ring_downs_that_would_slip_are_all_named():
    found = at(400, 600, 3500)
    demands = [point.damper.largest_rolling_demand for point in found.speeds]
    assert demands[0] > demands[1] > 0.3 > demands[2]
    (said,) = (note for note in found.notes if "olling without slip" in note)
    assert f"a friction coefficient of up to {demands[0]:.2g} (at 400 rpm), and more than the 0.3" in said
    assert "given for wall hits up to 600 rpm" in said
    (alone,) = (note for note in at(600, 3500).notes if "olling without slip" in note)
    assert alone.startswith(
        "In the ring-down at 600 rpm (80.5 g), released at 1 mm, rolling without slip requires a friction"
    )
    assert f"of up to {demands[1]:.2g}, more than the 0.3 given for wall hits: unless floor friction" in alone
    assert alone.count("600 rpm") == 1


def test_below_a_load_of_1_g_the_weight_rules():
    found = at(40, 60, 3500)
    assert load(60) < 1
    verdict = answer(found).verdict
    assert "; no verdict up to 60 rpm (0.805 g): there the balls' weight, which is neglected, exceeds the" in verdict
    assert "60 rpm" not in " ".join(answer(found).sentences)
    assert answer(at(40, 60)).verdict == "No verdict: the balls' weight, which is neglected, exceeds the load"
    for rpm in (0, 1e-3):
        assert answer(at(rpm)).verdict == "No verdict: the balls' weight, which is neglected, exceeds the load"


@pytest.mark.parametrize(("rpm", "share"), [(80, 0.699), (200, 0.112), (220, None)])
def test_the_weight_is_remarked_on_down_from_10_g(rpm, share):
    """Weight over load: 1/load in g; over what holds a ball at rest, mu_r / r = 1/100 of the load, 100 times that."""
    found = at(rpm, 3500)
    (note,) = (note for note in found.notes if "weight" in note)
    assert ("% of the load at" in note) == (share is not None)
    assert f" {100 / load(rpm):.2g} times what holds them at rest at {rpm} rpm" in note
    assert "once per revolution" in note
    if share is not None:
        assert 1 / load(rpm) == pytest.approx(share, abs=1e-3)
        assert f"{100 / load(rpm):.2g} % of the load at {rpm} rpm" in note


WIND = {
    "structure": {"frequency": "0.53 Hz", "mass": "20 t"},
    "rotor": {"speeds": ["13 rpm"], "radius": "61.5 m"},
    "damper": BALL
    | {"count": 200, "ball_material": "steel", "radius": "50 mm", "cavity": ["200 mm", "150 mm"]}
    | {"rolling_friction": "0.1 mm"},
}
"""A blade of a wind turbine: a load of 12 g, beside which its slow vibration hardly drives a ball."""


def test_a_ball_whose_weight_is_more_than_its_drive_has_no_verdict():
    """A omega² (1 - tau) of the amplitude A of largest damping is a tenth of g, whatever the load.

    By a pull of 0.09 g, that of the weight on a shaft that leans by 5 degrees, the damping there is gone.
    """
    found = workflows.run(WIND)
    (point,) = found.speeds
    own = point.damping_curve
    drive = own.peak_amplitude * (2 * math.pi * point.reduced.f1_hz) ** 2 * (1 - point.tilt_share)
    assert 5 < 9.80665 / drive < 20
    assert point.load_g > 10
    assert (point.verdict.grade, point.verdict.reason) == ("unknown", "ball_weight")
    what = "exceeds what drives them at the amplitude of largest damping"
    assert answer(found).verdict == f"No verdict: the balls' weight, which is neglected, {what}"
    system = verdict_damper(found.scene, found.effects, point)
    pulled = replace(system, lateral_acceleration=(9.80665 * math.sin(math.radians(5)), 0.0))
    assert settled(pulled, own.peak_amplitude) < 0.1 * settled(system, own.peak_amplitude)


def test_estimates_and_designs_know_of_the_weight():
    """At the amplitude that a force leaves the drive is less than g, as at the least amplitude of a design's range."""
    shaken = {"rotor__speeds": ["13 rpm", "20 rpm"], "damper__damping_ratio": 5e-3}
    forced = changed(WIND, **shaken, excitation={"orders": [2], "force": ["3 kN"]})
    found = workflows.run(forced)
    (reduction,) = found.reductions
    assert reduction.reason == Reason.WEIGHT
    assert "weight, which is neglected, exceeds the load, or what drives them there" in " ".join(of_orders(found))
    faster = {"structure__frequency": "10 Hz", "excitation__orders": [40]}
    (reduction,) = workflows.run(changed(forced, **faster)).reductions
    assert reduction.reason != Reason.WEIGHT
    wanted = {"amplitude": ["50 mm", "90 mm"], "ball_diameter": ["60 mm", "100 mm"], "clearance": ["50 mm", "100 mm"]}
    with pytest.raises(BadInput, match="weight, which is neglected, exceeds the load, or what drives"):
        spindamp.design(changed(WIND, design=wanted))


def test_a_weight_that_is_a_tenth_of_the_drive_is_in_the_headline():
    found = workflows.run(changed(WIND, structure__frequency="3 Hz"))
    share = limits.weight_share(found, found.speeds[0])
    assert 0.1 < share < 1
    said = f"the balls' weight, which is neglected, is up to {100 * share:.2g} % of what drives them"
    assert said in answer(found).verdict


def test_rows_without_a_verdict_are_marked():
    found = at(0, 100, 3500)
    heads, *rows = summary.rows(found)
    column = heads.index("ball ζ %")
    assert [row[column].endswith(remarks.NO_VERDICT) for row in rows] == [True, True, False]
    standstill = "; at 0 rpm no load presses a ball on its floor."
    assert f"{remarks.NO_VERDICT_MEANS}{standstill}" in summary.text(found, None)
    assert f"{remarks.NO_VERDICT_MEANS}." in summary.text(at(100, 3500), None)
    assert remarks.NO_VERDICT_MEANS not in summary.text(at(3500), None)


def test_a_stretch_of_speeds():
    found = at(400, 600, 3500, 5000).speeds
    for chosen, said in (
        ((0, 1), "up to 600 rpm (80.5 g)"),
        ((2, 3), "from 3500 rpm (2740 g) to 5000 rpm (5591 g)"),
        ((1, 2), "from 600 rpm (80.5 g) to 3500 rpm (2740 g)"),
        ((0,), "at 400 rpm (35.8 g)"),
        ((0, 3), "at 400 rpm (35.8 g) and 5000 rpm (5591 g)"),
        ((0, 2, 3), "at 3 of 4 speeds from 400 rpm (35.8 g) to 5000 rpm (5591 g)"),
        ((0, 1, 2, 3), "from 400 rpm (35.8 g) to 5000 rpm (5591 g)"),
    ):
        assert stretch([found[k] for k in chosen], found) == said


CAP = "the cap on cycles was reached while the ball still moved"


def capped(found, *which):
    """The same, of which some ring-downs ended by their cap."""
    speeds = list(found.speeds)
    for k in which:
        ended = replace(speeds[k].damper, outcome=CAP, cutoff_g=None, cutoff_ratio=None)
        speeds[k] = replace(speeds[k], damper=ended)
    return replace(found, speeds=tuple(speeds))


def cells(found):
    heads, *rows = summary.rows(found)
    return [(row[heads.index("cut-off g")], row[heads.index("/ load")]) for row in rows]


def _joined(text):
    """Text as it was before it was wrapped, at hyphens too."""
    return text.replace("-\n", "-").replace("\n", " ")


def test_a_ring_down_without_a_cut_off_shows_the_one_of_a_ball_at_rest():
    """mu_r/r = 0.1 of the load, whatever the speed; a ring-down that ended shows its own."""
    found = workflows.run(changed(base(release="20 0"), release__cycles=3))
    assert [point.damper.cutoff_g for point in found.speeds] == [None, None]
    for (g, ratio), rpm in zip(cells(found), (3500, 10000), strict=True):
        assert ratio == f"0.1{AT_REST}"
        assert float(g.removesuffix(AT_REST).replace("\u2009", "")) == pytest.approx(0.1 * load(rpm), rel=2e-3)
    assert AT_REST_MEANS in _joined(summary.text(found, None))
    whole = results(release="20 0")
    assert not any(AT_REST in cell for row in cells(whole) for cell in row)
    assert AT_REST_MEANS not in _joined(summary.text(whole, None))
    loose = replace(whole.speeds[0], damper=replace(whole.speeds[0].damper, cutoff_ratio=2.3e-4))
    assert cells(replace(whole, speeds=(loose,)))[0][1] == "0.00023"


def test_no_cut_off_without_a_load_or_in_a_filled_cavity(tmp_path):
    assert cells(results(speeds="0")) == [("–", "–")]
    filled = results(cavity="2 2.4", release="20 0")
    assert [point.verdict.reason for point in filled.speeds] == ["filled_cavity", "filled_cavity"]
    assert cells(filled) == [("–", "–"), ("–", "–")]
    again = workflows.load_results(workflows.save(filled, tmp_path / "out"))
    assert [each.damping_curve.cutoff for run in (filled, again) for each in run.speeds] == [math.inf] * 4


def test_every_speed_whose_ring_down_was_cut_off_is_named():
    found = results(speeds="3500 5000 7500 10000", release="20 0")
    assert not any(CAP in note for note in remarks.remarks(found))
    for which, where in (
        ((0, 1), "Up to 5000 rpm (5591 g)"),
        ((2,), "At 7500 rpm (12580 g)"),
        ((0, 2), "At 3500 rpm (2740 g) and 7500 rpm (12580 g)"),
    ):
        (said,) = (note for note in remarks.remarks(capped(found, *which)) if CAP in note)
        assert said == f"{where} {CAP}: the cut-offs marked {AT_REST} are those of a ball at rest."
