"""The verdicts on the paper's statements, pinned: they would change if a figure moved."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.workflows.conftest import PHONE, needs_chromium, width_on_a_phone
from workflows.reproduction import Claim, Reproduction, Verdict, page, reproduce

VERDICTS = {
    "T2-loads": Verdict.REPRODUCED,
    "T2-frequencies": Verdict.REPRODUCED,
    "T2-stiffening": Verdict.REPRODUCED,
    "T2-rest": Verdict.PARTLY,
    "T2-cutoff-high": Verdict.REPRODUCED,
    "T2-cutoff-low": Verdict.NOT,
    "T2-ratio": Verdict.REPRODUCED,
    "T2-cutoff-rises": Verdict.REPRODUCED,
    "A-effective": Verdict.PARTLY,
    "S1-rolls": Verdict.PARTLY,
    "S2-threshold": Verdict.REPRODUCED,
    "S2-momentum": Verdict.REPRODUCED,
    "S2-restitution": Verdict.REPRODUCED,
    "S2-cap": Verdict.REPRODUCED,
    "S2-epsilon": Verdict.REPRODUCED,
    "S2-steps": Verdict.NOT,
    "S2-measure": Verdict.PARTLY,
    "S2-energy": Verdict.PARTLY,
    "S2-rotation": Verdict.REPRODUCED,
    "F2-decay": Verdict.PARTLY,
    "F3-level": Verdict.NOT,
    "F3-trend": Verdict.PARTLY,
    "F3-stops": Verdict.REPRODUCED,
    "F4-linear": Verdict.REPRODUCED,
    "F4-rises": Verdict.REPRODUCED,
    "F5-weak": Verdict.PARTLY,
    "F5-sense": Verdict.NOT,
    "F5-overlap": Verdict.PARTLY,
    "F6-weak": Verdict.REPRODUCED,
    "F7-radius": Verdict.NOT,
    "A-experiments": Verdict.UNTESTABLE,
}


@pytest.fixture(scope="module")
def found() -> Reproduction:
    return reproduce()


@pytest.fixture(scope="module")
def claims(found: Reproduction) -> dict[str, Claim]:
    return {claim.id: claim for claim in found.claims}


def test_verdicts(claims: dict[str, Claim]) -> None:
    assert len(claims) >= 25
    assert {name: claim.verdict for name, claim in claims.items()} == VERDICTS


def test_every_claim_says_why(found: Reproduction) -> None:
    for claim in found.claims:
        assert claim.why
        assert claim.source
        assert claim.paper


def test_figures_behind_the_verdicts(claims: dict[str, Claim]) -> None:
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


def test_closure(found: Reproduction) -> None:
    """The 40-step integrator and ζ reach the paper's level; no exact solution of its equations does."""
    table = {frozenset(a.name for a in line.assumptions): line for line in found.closure}
    assert table[frozenset()].consistent < table[frozenset()].work_bound
    assert table[frozenset({"mass"})].consistent < table[frozenset({"mass"})].work_bound
    assert table[frozenset({"ζ", "steps"})].printed > 13
    assert table[frozenset({"ζ", "mass", "steps"})].printed > 14
    exact = [line for names, line in table.items() if "steps" not in names]
    assert max(max(line.printed, line.consistent) for line in exact) < 12


def test_slips_are_numbers(found: Reproduction) -> None:
    assert len(found.slips) >= 7
    assert {slip.where for slip in found.slips} >= {"eq. (2)", "eq. (3)", "Table I", "Table II", "III.A"}


@needs_chromium
def test_a_phone_shows_it_whole(found: Reproduction, tmp_path: Path) -> None:
    page.write(found, tmp_path / "out")
    assert width_on_a_phone(tmp_path / "out" / "report.html", tmp_path) <= PHONE


def test_files(found: Reproduction, tmp_path: Path) -> None:
    page.write(found, tmp_path / "out")
    document = json.loads((tmp_path / "out" / "reproduce.json").read_text())
    assert {tuple(claim) for claim in document["claims"]} == {
        ("id", "source", "claim", "paper", "printed", "consistent", "verdict", "why")
    }
    html = (tmp_path / "out" / "report.html").read_text()
    assert not re.search(r"(src|href)=[\"'](https?:)?//", html)
    assert html.count('<svg class="wide-sheet"') == html.count('<svg class="narrow-sheet"') == 6
    assert (tmp_path / "out" / "reproduce.csv").read_text().count("\n") >= len(VERDICTS)
