"""The verdicts on the paper's statements, pinned: they would change if a figure moved."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from tests.workflows.browser import findings, needs_chromium
from tests.workflows.conftest import measured_quickly, stored, table_of
from workflows.io.files import write_study
from workflows.solve import damper
from workflows.studies.reproduction import FORMULATIONS, RELEASE, SHOWN, Verdict, of_figures, of_table_two, reproduce

VERDICTS = table_of("verdicts")


@pytest.fixture(scope="module")
def found():
    """All of it, with the damping ratios of quick figures."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(damper, "damping_curve", measured_quickly)
        return reproduce()


@pytest.fixture(scope="module")
def claims(found):
    return {claim.id: claim for claim in found.claims}


def test_verdicts(claims):
    assert len(claims) >= 25
    assert {name: claim.verdict for name, claim in claims.items()} == VERDICTS


def test_every_claim_says_why(found):
    """Among them what no computation judges."""
    for claim in found.claims:
        assert claim.why
        assert claim.source
        assert claim.paper
        assert claim.why.startswith("Not computed: ") or claim.verdict is not Verdict.UNTESTABLE


def test_figures_behind_the_verdicts(claims):
    """Numbers with a witness: the paper's table, exact relations of the model, an independent dense solution."""
    assert claims["T2-frequencies"].consistent == pytest.approx(
        [208.9, 218.8, 241.3, 269.5, 301.7, 336.7, 373.5], rel=1e-3
    )
    assert claims["T2-rest"].consistent == pytest.approx(198.97, abs=0.1)  # what the table's rows extrapolate to
    assert all(0.09 <= ratio <= 0.112 for ratio in claims["T2-ratio"].consistent)
    assert claims["S2-threshold"].consistent == pytest.approx(0.1, rel=1e-9)
    assert claims["S2-energy"].printed == pytest.approx(6.8, abs=0.1)  # the equations as printed make energy
    assert claims["S2-energy"].consistent == pytest.approx(-0.86, abs=0.01)
    assert claims["F4-linear"].consistent > 0.999
    assert claims["F5-weak"].consistent > 200, "the ball's own part grows with the clearance"


def test_closure(found):
    """The 40-step integrator and ζ reach the paper's level; no exact solution of its equations does."""
    table = {frozenset(a.name for a in line.assumptions): line for line in found.closure}
    assert table[frozenset()].consistent < table[frozenset()].work_bound
    assert table[frozenset({"mass"})].consistent < table[frozenset({"mass"})].work_bound
    assert table[frozenset({"ζ", "steps"})].printed > 13
    assert table[frozenset({"ζ", "mass", "steps"})].printed > 14
    exact = [line for names, line in table.items() if "steps" not in names]
    assert max(max(line.printed, line.consistent) for line in exact) < 12


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_the_damper_of_the_figures_is_that_of_the_run(found, formulation):
    """Figs. 4 to 7 change one thing at a time of the very motion that Figs. 2 and 3 show."""
    damping = found.study.points[formulation][SHOWN].damper
    curve = found.study.curve("as it is", found.study.system(formulation))
    assert curve.sdc.tolist() == damping.sdc.tolist()
    assert curve.amplitude_g.tolist() == damping.amplitude_g.tolist()


def test_the_bound_of_the_closure_is_that_of_both_axes(found):
    """In a run that the structure's own damping slows, the bound rises with what is left of the amplitude."""
    table = {frozenset(a.name for a in line.assumptions): line for line in found.closure}
    still, damped = table[frozenset()], table[frozenset({"ζ"})]
    release = math.hypot(*RELEASE)
    leading = 100 * 4 * 0.006 * math.hypot(0.5e-3, 0.4e-3) / release
    assert still.work_bound == pytest.approx(leading, rel=2e-2)  # 20 cycles take 0.9 % of the energy
    # A falls by exp(-2 pi zeta) in a cycle; the mean of 1/A over 19 of them.
    growth = np.exp(2 * np.pi * 0.01 * np.arange(19)).mean()
    assert damped.work_bound == pytest.approx(leading * growth, rel=4e-2)


def _another(study, **changes):
    """The study as it would be if every ring-down had come out otherwise."""
    points = {
        formulation: tuple(replace(p, damper=replace(p.damper, **changes)) for p in points if p.damper is not None)
        for formulation, points in study.points.items()
    }
    return replace(study, points=points)


def test_a_ball_that_took_all_would_be_said_to_make_the_decay(found):
    """Which verdict F2-decay gets rests on the energy books and on the velocity."""
    damping = found.study.plate[SHOWN].damper
    taken = replace(damping.energy, rolling=damping.energy.structure, structure=damping.energy.rolling)
    lasting = np.full_like(damping.peak_velocity, damping.peak_velocity[0])
    for changes, verdict in (
        ({}, Verdict.PARTLY),
        ({"energy": taken}, Verdict.REPRODUCED),
        ({"peak_velocity": lasting}, Verdict.NOT),
        ({"peak_velocity": lasting, "energy": taken}, Verdict.NOT),
    ):
        claims = of_figures(_another(found.study, **changes), found.sweeps)
        assert next(claim for claim in claims if claim.id == "F2-decay").verdict is verdict


def test_a_ball_that_took_as_much_as_the_paper_says_would_be_called_effective(found):
    """Which verdict A-effective gets rests on where the ball moves and on what it takes there."""
    for changes, verdict in (
        ({}, Verdict.PARTLY),
        ({"peak_sdc": 0.9}, Verdict.REPRODUCED),
        ({"cutoff_g": 1.0}, Verdict.NOT),
        ({"cutoff_g": None}, Verdict.NOT),
    ):
        claims = of_table_two(_another(found.study, **changes))
        assert next(claim for claim in claims if claim.id == "A-effective").verdict is verdict


def test_what_is_not_the_best_is_not_called_so(claims):
    """A-effective has the ring-down from the release; the largest damping at any amplitude is that of T2-tilt."""
    why = claims["A-effective"].why
    assert "in the ring-down from the release" in why
    assert "at best" not in why


def test_the_angle_of_the_rolling_ball_has_one_sign(found):
    """Newton for a sphere on a floor that moves by u: with s'' = -r a'' of eq. (4), eq. (2) has the sign printed."""
    r, m, accelerated = 1e-3, 2e-3, 7.0
    # Unknowns: s'', a'', the floor's force F; momentum, moments about the centre, eq. (4).
    equations = [[m, 0, -1], [0, 0.4 * m * r**2, -r], [1, r, 0]]
    _, angle, _ = np.linalg.solve(equations, [-m * accelerated, 0, 0])
    assert 1.4 * m * r**2 * angle == pytest.approx(r * m * accelerated, rel=1e-12)
    assert "eqs. (4), (5)" not in {slip.where for slip in found.slips}


def test_slips_are_numbers(found):
    assert len(found.slips) >= 7
    values = {slip.where: slip.value for slip in found.slips}
    assert values["eq. (2)"] == pytest.approx((5 / 2) / (5 / 7), rel=1e-12)
    assert values["Table I"] == pytest.approx(20 - 5)
    assert values["Table II"] == pytest.approx(100 * (10 / 9.80665 - 1), abs=0.01)
    # The table's own rows, as if f² were straight over n², which it nearly is.
    slow, fast = (208.9, 3500 / 60), (373.5, 17500 / 60)
    slope = (fast[0] ** 2 - slow[0] ** 2) / (fast[1] ** 2 - slow[1] ** 2)
    assert values["III.A"] == pytest.approx((slow[0] ** 2 - slope * slow[1] ** 2) ** 0.5, abs=0.5)
    assert values["Figs. 3 to 7"] > 1  # denser than any element
    assert values["eqs. (2)-(4)"] > 0
    assert abs(values["eq. (3)"]) > 0.1


@pytest.fixture(scope="module")
def written(found, tmp_path_factory):
    folder = tmp_path_factory.mktemp("reproduction") / "out"
    write_study(found, folder)
    return folder


@needs_chromium
def test_nothing_hinders_a_reader(written):
    assert findings(written / "report.html") == []


def test_files(written):
    document = stored(written / "reproduce.json")
    assert {tuple(claim) for claim in document["claims"]} == {
        ("id", "source", "claim", "paper", "printed", "consistent", "verdict", "why")
    }
    html = (written / "report.html").read_text()
    assert not re.search(r"(src|href)=[\"'](https?:)?//", html)
    assert html.count("<svg") == 6
    assert (written / "reproduce.csv").read_text().count("\n") >= len(VERDICTS)
