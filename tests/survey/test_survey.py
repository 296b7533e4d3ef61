"""A few plates of the survey: every frequency within the error estimated beside it, as CalculiX has it."""

import re
import subprocess
from dataclasses import replace

import numpy as np
import pytest

import workflows
from tests.benchmarks import calculix
from tests.survey import __main__ as survey
from tests.survey import plates, references, scenes, spinning
from tests.survey.planforms import Hole, ell, eyed, marked, rectangle
from tests.survey.verdict import judge, static_state

CHEAP = "01 flat", "25 swept"


@pytest.mark.parametrize("name", CHEAP)
def test_every_mode_is_within_its_estimate(name):
    case = next(case for case in plates.cases() if case.name == name)
    verdict = judge(case, references.stored()[name])
    assert verdict.violations == [], f"true {verdict.true}, estimated {verdict.estimate}, reference {verdict.slack}"


def test_all_sixty_are_scenes_that_the_command_asks_for(tmp_path):
    """Those of varying thickness among them; CalculiX has answered for the plates as they are."""
    asked = [case for case, _ in survey.answered("")]
    assert len(asked) == len(plates.cases()) == 60
    for case in asked:
        scene = workflows.load(scenes.write(case, tmp_path)).scene
        assert isinstance(scene.plate.thickness, float) != bool(case.profile)


live = pytest.mark.skipif(not calculix.available(), reason="CalculiX (ccx) is not installed")

UPRIGHT = plates.Case("steel", rectangle(0.2, 0.08), 0.0142, (2e11, 0.3, 7850.0), 0.1, 90.0, 1e-3, 0.0, rpm=8000.0)
"""Twist and lag nearly coincide: Coriolis forces part them by 0.8 %."""

COMPLEX = """
*STEP, PERTURBATION
*FREQUENCY, STORAGE=YES
30
*END STEP
*STEP, PERTURBATION
*COMPLEX FREQUENCY, CORIOLIS
6
*DLOAD
{load}
*END STEP
"""


def complex_frequencies(deck, folder):
    """CalculiX's own (6,) in Hz, in thirty modes."""
    head, _, _ = deck.partition("*STEP, PERTURBATION")
    load = next(line for line in deck.splitlines() if line.startswith("PLATE, CENTRIF"))
    (folder / "plate.inp").write_text(head.rstrip() + COMPLEX.format(load=load))
    subprocess.run([calculix.COMMAND, "plate"], cwd=folder, capture_output=True, check=True, timeout=120)
    text = (folder / "plate.dat").read_text().split("E I G E N V A L U E   O U T P U T")[-1]
    return np.array([float(row[1]) for row in re.findall(r"^\s+\d+\s+(\S+)\s+(\S+)\s+(\S+)$", text, re.M)])[:6]


@live
def test_the_matrices_have_the_frequencies_of_calculix(tmp_path):
    corrected = spinning.matrices(UPRIGHT, 1, 1)
    found = spinning.Matrices(corrected.stiffness, corrected.mass)
    nodes, bricks = calculix.extruded(UPRIGHT.planform.graded(1), UPRIGHT.thickness, 1)
    deck = calculix.deck(
        nodes, bricks, UPRIGHT.material, UPRIGHT.omega, UPRIGHT.hub, np.radians(UPRIGHT.stagger), plates.COUNT
    )
    own = calculix.solved(deck, plates.COUNT, 120)
    np.testing.assert_allclose(found.frequencies(plates.COUNT), own, rtol=2e-6)
    turning = complex_frequencies(deck, tmp_path)
    assert np.abs(turning / own - 1.0).max() > 5e-3
    spin = UPRIGHT.omega * spinning.axis(UPRIGHT)
    np.testing.assert_allclose(found.complex_frequencies(plates.COUNT, spin), turning, rtol=1e-4)


STRIP = plates.Case("strip", rectangle(0.2, 0.02, cells=12), 0.0002, (3e9, 0.0, 1200.0), 0.0, 0.0, 0.0, 0.0)


def beam_frequency(thickness):
    """The first in Hz of the strip, by Euler and Bernoulli."""
    return 1.875104068711961**2 / (2.0 * np.pi) * np.sqrt(3e9 / (12.0 * 1200.0)) * thickness / 0.2**2


@live
def test_what_the_written_matrices_lack_is_made_up_for():
    """A strip of h/L = 0.001, nu = 0, at rest, against a beam: their fourteen digits are too few for it."""
    found, beam = spinning.matrices(STRIP, 2, 2), beam_frequency(STRIP.thickness)
    assert found.frequencies(1)[0] == pytest.approx(beam, rel=1e-3)
    assert abs(spinning.Matrices(found.stiffness, found.mass).frequencies(1)[0] / beam - 1.0) > 2e-3


@live
def test_what_rounding_takes_is_told_by_other_numberings():
    """A strip of h/L = 0.0005, nu = 0, at rest, against a beam: in two layers of bricks up to 1 % is lost."""
    strip, beam = replace(STRIP, thickness=0.0001), beam_frequency(0.0001)
    found = np.array([spinning.own_frequencies(strip, 2, 2, number)[0] for number in range(references.NUMBERINGS)])
    off = np.abs(found / beam - 1.0).max()
    assert 5e-4 < off < references.magnified(references.rounding(strip, 2)[0])
    assert references.layers_of(strip) == (1, 1)
    assert references.layers_of(replace(STRIP, thickness=0.001)) == (2, 2)


@live
def test_a_point_mass_is_softened():
    """A mass on a massless blade: w² falls by Omega² where its motion turns into the plane of rotation."""
    blade = replace(
        UPRIGHT,
        planform=replace(marked(0.2, 0.1, (0.2, 0.0)), cells=12),
        thickness=0.05,
        material=(2e7, 0.0, 1e-3),
        hub=1.0,
        tip=(1.0, 0.2, 0.0),
    )
    across, along = (
        spinning.matrices(replace(blade, stagger=stagger, rpm=60.0), 1, 1).frequencies(1)[0] for stagger in (0.0, 90.0)
    )
    assert across**2 - along**2 == pytest.approx(1.0, rel=0.02)  # in (rpm / 60)²


def test_planforms_are_what_they_are_called():
    arm = ell(0.2, 0.12, 0.15, 0.02)
    hole = eyed(0.2, 0.1, Hole(0.1, 0.0, 0.02))
    octagon = 8.0 * np.tan(np.pi / 8.0) * 0.02**2
    for planform, area in ((arm, 0.15 * 0.02 + 0.05 * 0.12), (hole, 0.02 - octagon)):
        for mesh in (planform.even(1), planform.graded(3)):
            x, y = mesh.p[:, mesh.t]
            shoelace = 0.5 * (x * np.roll(y, -1, axis=0) - y * np.roll(x, -1, axis=0)).sum(axis=0)
            assert np.abs(shoelace).sum() == pytest.approx(area, rel=1e-12)
            assert np.ptp(np.sign(shoelace)) == 0.0


def test_one_plate_is_turned_by_three_tenths():
    swept = next(case for case in plates.cases() if case.name == "15 swept")
    assert static_state(swept, swept.omega).rotation == pytest.approx(0.3, abs=0.01)
