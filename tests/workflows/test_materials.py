"""Materials by name, and balls by density: numbers beside names, and what they weigh."""

import math
import re
from dataclasses import replace
from functools import cache
from itertools import pairwise

import pytest

import damper.contact
import spindamp
import workflows
from fem.reduction.pulse import spectrum
from tests.workflows.conftest import BALL, ROOT, changed
from workflows.effects import selection
from workflows.errors import BadInput
from workflows.io import provenance
from workflows.progress import Stages
from workflows.report.verdict import answer
from workflows.scene.load import as_scene_file, parse
from workflows.scene.materials import BALLS, KNOWN, PLATES
from workflows.solve import coupling
from workflows.solve import limits as bounds
from workflows.solve.damper import particle_damper
from workflows.solve.structure import StructureSolver
from workflows.studies.design import report
from workflows.studies.design.study import design
from workflows.studies.sweep import executor

pytestmark = pytest.mark.usefixtures("quickly")

NUMBERS = {"material__youngs_modulus": None, "material__poissons_ratio": None, "material__density": None}


def named(paper, name):
    return changed(paper, **NUMBERS, material__name=name)


@pytest.mark.parametrize("name", PLATES)
def test_a_name_is_its_numbers(name, paper):
    material, known = parse(named(paper, name)).material, KNOWN[name]
    numbers = {key: getattr(known, key) for key in ("youngs_modulus", "poissons_ratio", "density")}
    assert numbers == {key: getattr(material, key) for key in numbers}
    written = parse(changed(paper, **{f"material__{key}": value for key, value in numbers.items()}))
    assert written.material.model_copy(update={"name": name}) == material


def test_every_material_has_a_source_and_sense():
    """Metals: sound travels along a bar at 4.5 to 5.3 km/s in each that plates are made of."""
    for name, known in KNOWN.items():
        assert len(known.source) > 10, name
        assert 1000 < known.density < 22_600
        if known.plate:
            assert 4.5e3 < math.sqrt(known.youngs_modulus / known.density) < 5.3e3
            assert 0.25 < known.poissons_ratio < 0.35
        if known.hardness is not None and known.yield_strength is not None:  # 3 Y, more where a metal hardens
            assert 2.5 < known.hardness / known.yield_strength < 6
            assert len(known.strength) > 10
    assert KNOWN["tungsten carbide"].density == pytest.approx(1e3 / (0.94 / 15.6 + 0.06 / 8.86), rel=5e-3)
    psi = 0.45359237 * 9.80665 / 0.0254**2
    assert KNOWN["Inconel 718"].youngs_modulus == pytest.approx(29.0e6 * psi, rel=1e-3)
    assert KNOWN["Inconel 718"].density == pytest.approx(0.297 * 0.45359237 / 0.0254**3, rel=1e-3)


def test_the_guide_lists_the_same():
    text = (ROOT / "docs" / "guide" / "scenes.md").read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.count("|") == 9]
    listed = {row[0].removesuffix(", for balls"): row[1:] for row in rows if row[3].isdigit()}
    assert list(listed) == list(KNOWN)
    for name, (*numbers, source, strength) in listed.items():
        known = KNOWN[name]
        assert (source, strength) == (known.source, known.strength)
        values = [float(number) if number else None for number in numbers]
        keys = ("youngs_modulus", "poissons_ratio", "density", "yield_strength", "hardness")
        for value, key, factor in zip(values, keys, (1e9, 1, 1, 1e6, 1e9), strict=True):
            given = getattr(known, key)
            assert value == (None if given is None else pytest.approx(given / factor, rel=5e-3))


def test_check_and_results_show_the_numbers_with_their_source(spindamp, paper, tmp_path):
    scene = named(paper, "Ti-6Al-4V")
    said = spindamp("check", scene).out
    assert "youngs_modulus = 113800000000.0 # Ti-6Al-4V: ASM" in said
    assert spindamp.json("check", scene)["scene"]["material"] == {
        "youngs_modulus": 113.8e9,
        "poissons_ratio": 0.342,
        "density": 4430.0,
    }
    (tmp_path / "again.toml").write_text(said, encoding="utf-8")
    again = spindamp("check", "again.toml").out
    assert "113800000000.0\npoissons_ratio = 0.342\ndensity = 4430.0" in again


@pytest.mark.parametrize("name", BALLS)
@pytest.mark.parametrize("count", [1, 60])
def test_balls_weigh_their_volume(name, count, paper, structure):
    """On a plate and on a structure that is given; a steel ball of radius 1 mm weighs 0.0329 g."""
    for scene in (paper, structure):
        by_name = changed(scene, damper__mass_ratio=None, damper__ball_material=name, damper__count=count)
        parsed = parse(by_name)
        expected = count * 4.18879020478639e-9 * KNOWN[name].density
        assert coupling.ball_mass(parsed, 1.0) == pytest.approx(expected, rel=1e-12)
        again = parse(changed(by_name, damper__ball_material=None, damper__ball_density=KNOWN[name].density))
        assert coupling.ball_mass(again, 1.0) == coupling.ball_mass(parsed, 1.0)
    if name == "steel" and count == 1:
        assert expected == pytest.approx(0.0329e-3, rel=1e-3)


def test_a_given_mass_is_that_of_all_balls(structure):
    for changes in ({"damper__mass_ratio": 0.006}, {"damper__mass_ratio": None, "damper__mass": "6 g"}):
        for count in (1, 60):
            scene = parse(changed(structure, **changes, damper__count=count))
            assert coupling.ball_mass(scene, 1.0) == pytest.approx(0.006, rel=1e-14)


def test_check_says_what_the_balls_weigh(spindamp, paper):
    scene = changed(paper, damper__mass_ratio=None, damper__ball_material="tungsten carbide", damper__count=60)
    said = spindamp("check", scene).out
    assert "ball_density = 14900.0" in said
    assert "# tungsten carbide: WC with 6 % cobalt" in said
    assert "60 balls together weigh 3.74 g" in said


def test_the_resolved_scene_has_no_names_but_those_that_tell_strength(paper):
    """Read again it says the same."""
    for ball, density in (("steel", 7_850.0), ("lead", None)):
        scene = parse(changed(named(paper, "steel"), damper__mass_ratio=None, damper__ball_material=ball))
        plain = provenance.resolved_scene(scene, selection.resolve(scene), None)
        assert "name" not in plain["material"]
        assert plain["damper"].get("ball_density") == density
        assert plain["damper"].get("floor_material") == (None if density else "steel")
        again = parse(plain).damper
        assert again.balls == scene.damper.balls


def pressed(ball, diameter, **changes):
    """A ball of a material on a floor of titanium, on a structure of 0.5 kg at 236 Hz, in 1 mm of clearance."""
    radius = float(diameter) / 2
    damper = BALL | {"ball_material": ball, "floor_material": "Ti-6Al-4V"}
    damper |= {"radius": f"{radius} mm", "cavity": [f"{2 * radius + 1} mm"] * 2}
    rotor = {"speeds": ["5000 rpm", "15000 rpm"], "radius": "20 cm"}
    return {"structure": {"frequency": "236 Hz", "mass": "0.5 kg"}, "rotor": rotor, "damper": damper, **changes}


@cache
def ran(ball, diameter):
    """Such a ball's run."""
    return workflows.run(pressed(ball, diameter))


def test_a_sweep_has_what_a_run_says_of_the_contact(here):
    scene = pressed("hardened steel", "4")
    found = spindamp.sweep(scene, {"damper.restitution": [0.5]}, quick=True, executor=here).squeeze()
    for k, point in enumerate(ran("hardened steel", "4").speeds):
        row = found.isel({"rotor.speeds": k})
        for name in ("yield_ratio", "hardness_ratio"):
            assert row[f"contact_{name}"] == getattr(point.contact, name)


def test_a_ball_that_flows_has_no_verdict():
    """Lead of 6 mm at 5000 rpm becomes a flat of 0.7 mm radius; steel of 4 mm lies in a dent, and is said to."""
    (slow, fast) = ran("lead", "6").speeds
    assert (slow.verdict.grade, slow.verdict.reason) == ("inadmissible", "contact") == (fast.verdict.grade, "contact")
    assert slow.contact.dent_radius == pytest.approx(0.7e-3, rel=0.02)
    found = ran("hardened steel", "4")
    assert [point.verdict.reason for point in found.speeds] == ["", ""]
    load = 7800 * 4 / 3 * math.pi * 2e-3**3 * found.speeds[1].omega ** 2 * 0.2
    dent = math.sqrt(load / (math.pi * 349 * 9.80665e6))
    assert found.speeds[1].contact.dent_radius == pytest.approx(dent)
    (said,) = (note for note in found.notes if "leaves a dent of at most" in note)
    assert f"of at most {1e3 * dent:.2g} mm radius" in said
    assert answer(ran("lead", "6")).verdict.startswith("No verdict: the mean contact pressure of the resting ball is ")


def test_a_floor_of_unknown_strength_is_not_promised_to_bear_the_ball():
    """Plain aluminium has no hardness: the answer names the one that Hertz's mean pressure asks for."""
    scene = pressed("tungsten carbide", "4")
    scene["damper"]["floor_material"] = "aluminium"
    found = workflows.run(scene)
    assert all(math.isnan(point.contact.hardness_ratio) for point in found.speeds)
    stiff = 1 / ((1 - 0.22**2) / 630e9 + (1 - 0.3**2) / 70e9)
    load = KNOWN["tungsten carbide"].density * 4 / 3 * math.pi * 2e-3**3 * found.speeds[1].omega ** 2 * 0.2
    mean = (6 * load * stiff**2 / (math.pi**3 * 2e-3**2)) ** (1 / 3) / 1.5
    (said,) = (each for each in answer(found).sentences if "is not known" in each)
    assert "The strength of the aluminium floor is not known. At 15000 rpm" in said
    assert f"is {mean / 1e9:.2g} GPa, which requires a hardness above {mean / 9.80665e6:.0f} HB; dents" in said
    assert not any("is not known" in each for each in answer(ran("steel", "4")).sentences)


@pytest.mark.parametrize(("share", "end"), [(0.9, "still beyond the"), (1.1, "its own dent holds it, and a harder")])
def test_a_dent_is_blamed_where_the_ball_would_move_without_it(share, end):
    """Without a dent it moves from a_r / (w1² |1 - tau|) on, at tau = 1.2: if that is endured, the dent is to blame."""
    square, pull = (2 * math.pi * 236) ** 2, (15000 * math.pi / 30) ** 2 * 0.2
    structure = {"frequency": "236 Hz", "mass": "0.5 kg", "floor_tilt": 1.2 * square / pull}
    rotor = {"speeds": ["15000 rpm"], "radius": "20 cm"}
    found = workflows.run(pressed("hardened steel", "4", structure=structure, rotor=rotor))
    without = 0.005 * pull / (square * 0.2)
    strained = replace(found.speeds[0], root_strain=bounds.ENDURED / (share * without))
    held = bounds.with_verdicts(replace(found, speeds=(strained,)))
    assert held.speeds[0].verdict.reason == "out_of_reach"
    (said, *_) = answer(held).sentences
    assert end in said
    assert (f"without its dent it would move above {1e3 * without:.2g} mm" in said) is (share < 1)


def test_what_is_not_known_of_ball_and_floor_is_said_beside_the_verdict():
    """A floor given by its numbers has Hertz's pressure, but no strength; without materials steel stands for both."""
    load = KNOWN["tungsten carbide"].density * 4 / 3 * math.pi * 2e-3**3 * 0.2
    numbers = {"youngs_modulus": "113.8 GPa", "poissons_ratio": 0.342, "density": "4430 kg/m^3"}
    plate = {"length": "0.2 m", "width": "50 mm", "thickness": "6 mm"}
    scene = pressed("tungsten carbide", "4")
    del scene["structure"], scene["damper"]["floor_material"]
    scene["rotor"].pop("radius")
    scene |= {"plate": plate, "material": numbers}
    found = workflows.run(scene)
    fastest = found.speeds[-1]
    stiff = 1 / ((1 - 0.22**2) / 630e9 + (1 - 0.342**2) / 113.8e9)
    radius = (3 * load * fastest.omega**2 * 2e-3 / (4 * stiff)) ** (1 / 3)
    assert fastest.contact.hertz_radius == pytest.approx(radius, rel=1e-6)
    assert math.isnan(fastest.contact.hardness_ratio)
    said = " ".join(answer(found).sentences)
    assert "The strength of the floor is not known." in said
    assert "dents that hold the ball are not counted" in said
    del scene["damper"]["ball_material"]
    scene["damper"]["ball_density"] = "14900 kg/m^3"
    said = " ".join(answer(workflows.run(scene)).sentences)
    steel = (1 - 0.3**2) / 210e9
    mean = 2 / 3 / math.pi * (6 * load * fastest.omega**2 / (2e-3 * 2 * steel) ** 2) ** (1 / 3)
    assert (
        "Whether ball and floor bear the load is not checked: this requires ball_material and floor_material." in said
    )
    assert f"between steel and steel would be {1e-9 * mean:.2g} GPa" in said


def test_hits_that_scatter_into_modes_beyond_those_simulated_are_remarked():
    """What a pulse on the mesh leaves there is the sum over modes of another solution, as far as it goes."""

    def scene(modes, **keys):
        plate = {"length": "120 mm", "width": "50 mm", "thickness": "6 mm"}
        ball = {"ball_material": "steel", "radius": "2 mm", "cavity": ["4.6 mm", "5 mm"], "rolling_friction": "0.02 mm"}
        rotor = {"speeds": ["1500 rpm"], "modes": modes, "hub_radius": "150 mm"}
        material = {"name": "Ti-6Al-4V"}
        return {"plate": plate, "material": material, "rotor": rotor, "damper": ball | {"friction": 0.2} | keys}

    few = workflows.run(scene(4, restitution=0.6))
    (point,) = few.speeds
    (said,) = (note for note in few.notes if "also excite structural modes" in note)
    assert f"{100 * point.hits.scattered:.2g} % of a ball's kinetic energy into" in said
    assert point.hits.dissipated == pytest.approx(1 - 0.6**2)
    slide = 2 / 7 * 1.6 * 0.6e-3 / point.hits.flight / (0.2 * (1500 * math.pi / 30) ** 2 * 0.27)
    assert point.hits.sliding == pytest.approx(slide)
    (told,) = (note for note in few.notes if "ball_slip = true simulates the sliding" in note)
    assert (
        f"slides on its floor for {round(1e6 * slide, -1):.0f} µs, {100 * slide / point.hits.flight:.2g} % of the"
        in told
    )
    slipping = workflows.run(scene(4, restitution=0.6) | {"effects": {"ball_slip": True}})
    assert not [note for note in slipping.notes if "simulates the sliding" in note]
    (dents,) = workflows.run(scene(4, restitution=[["0.1 m/s", 0.9]])).speeds  # above its last pair the law falls
    assert dents.hits.dissipated == pytest.approx(1 - 0.81 * (0.1 / (0.6e-3 / dents.hits.flight)) ** 0.5)
    wide = {"count": 1, "radius": "3 mm", "cavity": ["8 mm", "8 mm"], "housing": "40 g"}
    (rolls,) = workflows.run(scene(4, restitution=0.8, **wide)).speeds  # at its best it meets no wall
    assert rolls.hits is None
    assert 0 < rolls.damping_curve.peak_amplitude < 0.5 * rolls.damping_curve.folds[1]
    ball = damper.contact.Solid(210e9, 0.3), damper.contact.Solid(113.8e9, 0.342)
    mass, clearance = point.damper.ball_mass, 0.6e-3
    assert point.hits.duration == pytest.approx(
        damper.contact.hit_time(clearance / point.hits.flight, mass, 2e-3, *ball)
    )
    (whole,) = StructureSolver(as_scene_file(scene(40, restitution=0.6)), Stages()).at(followed=False).points
    used = {each.number for each in coupling.damper_modes(few.scene, point)}
    rates = [math.sqrt(each.stiffness) for each in whole.cavity_modes]
    parts = (spectrum(rates, point.hits.duration) * [each.shape[0] for each in whole.cavity_modes]) ** 2
    left = sum(part for k, part in enumerate(parts, 1) if k not in used)
    impulse = (1 + 0.6) / (1 + mass * parts.sum())
    assert point.hits.scattered == pytest.approx(mass * left * impulse**2, rel=0.1)
    assert not [note for note in workflows.run(scene(4, restitution=0.1)).notes if "also excite" in note]


def test_hits_that_last_long_beside_the_flights_are_remarked():
    """Hertz's hit of 2.94 d/v, d = (15 m v² / 16 sqrt(r) E*)^0.4 (Johnson, eq. 11.24), against the time of a flight."""
    scene = pressed("hardened steel", "4")
    scene["structure"]["frequency"], scene["damper"]["cavity"] = "5 kHz", ["4.02 mm", "4.02 mm"]
    found = workflows.run(scene)
    (said,) = (note for note in found.notes if "hits as instantaneous" in note)
    numbers = re.search(r"lasts ([\d.]+) µs \(Hertz\), ([\d.]+) % of the ([\d.]+) µs between hits", said)
    assert numbers is not None, said
    stiff = 1 / ((1 - 0.3**2) / 210e9 + (1 - 0.342**2) / 113.8e9)
    shares = []
    for point in found.speeds:
        omega = 2 * math.pi * point.reduced.f1_hz
        drive = 5 / 7 * point.damping_curve.peak_amplitude * omega**3
        flight = min(math.pi / omega, (6 * 0.02e-3 / drive) ** (1 / 3))
        speed = 0.02e-3 / flight
        depth = (15 * (point.reduced.M1 - point.reduced.M2) * speed**2 / (16 * math.sqrt(2e-3) * stiff)) ** 0.4
        shares.append((2.94 * depth / speed / flight, 2.94e6 * depth / speed, 1e6 * flight))
    share, hit, flight = max(shares)
    assert share > 0.1
    assert (float(numbers[1]), float(numbers[3])) == pytest.approx((hit, flight), rel=0.05)
    assert float(numbers[2]) == pytest.approx(100 * share, rel=0.05)
    assert not any("instantaneous" in note for note in ran("hardened steel", "4").notes)


@pytest.mark.parametrize(
    ("limits", "diameter", "limit"), [({}, 4.0, ""), ({"yield_ratio": 9.0}, 2.0, "first yield"), ({}, 0.0, "")]
)
def test_designs_keep_to_what_the_floor_carries(limits, diameter, limit, here):
    """Lead is denser and would win, but flows; a limit on first yield keeps the ball small; nothing but lead fails."""
    balls = ["hardened steel", "lead"] if diameter else ["lead"]
    free = {"ball_material": balls, "ball_diameter": ["2 mm", "3 mm", "4 mm"], "amplitude": ["3 mm", "5 mm"]}
    scene = pressed("lead", "4", design=free | limits, effects={"indentation": False})
    scene["damper"]["cavity"] = ["5 mm", "5 mm"]
    if not diameter:
        with pytest.raises(BadInput, match="the floor supports none of these balls"):
            design(scene, pool=executor.external(here, 1))
        return
    found = design(scene, pool=executor.external(here, 1))
    best = found.scene.scene.damper
    assert (best.ball_material, 2e3 * best.radius) == ("hardened steel", pytest.approx(diameter))
    assert all(share <= 1 for _, share in found.optimum.evaluation.used)
    told = " ".join(report.sentences(found))
    assert "Ball and floor carry the load at all speeds" in told
    assert (limit in dict(found.optimum.evaluation.used)) is ("allowed by yield_ratio" in told) is bool(limit)


def system(**changes):
    """The damper of a steel ball on titanium at 15000 rpm, with other keys."""
    scene = pressed("hardened steel", "4")
    scene["damper"] = {key: value for key, value in (scene["damper"] | changes).items() if value is not None}
    given = parse(scene)
    return particle_damper(given, selection.resolve(given), ran("hardened steel", "4").speeds[1])


def test_hits_and_rolling_follow_from_the_materials():
    """Restitution by the dents of hits, which tends to Johnson's power; rolling by hysteresis; a dent that holds."""
    found = system(restitution="auto", rolling_friction="auto")
    (onset, first), *_, (last, lowest) = found.restitution_by_speed
    ball = damper.contact.Solid(210e9, 0.3, 2e9, 700 * 9.80665e6)
    floor = damper.contact.Solid(113.8e9, 0.342, 880e6, 349 * 9.80665e6)
    assert onset == pytest.approx(damper.contact.yield_speed(found.ball_mass, 2e-3, ball, floor))
    assert 0.98 < first == found.restitution < 1
    hit = found.ball_mass, 2e-3, ball, floor
    assert damper.contact.restitution(16 * last, *hit) == pytest.approx(0.5 * lowest, rel=0.03)
    for (speed, e), (further, less) in pairwise(found.restitution_by_speed):
        middle = damper.contact.restitution(math.sqrt(speed * further), *hit)
        assert 0.5 * (e + less) == pytest.approx(middle, rel=0.02)
    load = found.ball_mass * found.centrifugal_acceleration
    pressed_floor = damper.contact.resting(load, 2e-3, ball, floor)
    assert found.rolling_friction == pytest.approx(3 / 16 * 0.016 * pressed_floor.hertz_radius)
    assert found.break_away == pytest.approx(damper.contact.rim_slope(load, 2e-3, ball, floor))
    assert 0 < found.break_away < pressed_floor.dent_slope
    table = system(restitution=[["0.1 m/s", 0.9], ["10 m/s", 0.5]])
    assert (table.restitution, table.restitution_by_speed) == (0.9, ((0.1, 0.9), (10.0, 0.5)))
    assert table.rolling_friction == 1e-5


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"restitution": "auto", "floor_material": None}, "requires named materials of ball and floor"),
        ({"rolling_friction": "auto", "floor_material": None}, "requires named materials of ball and floor"),
        ({"restitution": "automatic"}, "expected a number from 0 to 1, 'auto', or pairs"),
        ({"restitution": [["2 m/s", 0.9], ["1 m/s", 0.5]]}, "expected impact speeds above 0, in ascending order"),
        ({"restitution": [["2 m/s", 1.9]]}, "expected at most 1"),
        ({"rolling_friction": "-1 mm"}, "expected at least 0"),
    ],
)
def test_what_materials_cannot_tell(changes, problem):
    with pytest.raises(BadInput, match=re.escape(problem)):
        system(**changes)
