"""A few plates of the survey: every frequency within the error estimated beside it, as CalculiX has it."""

import pytest

from tests.survey import plates, references
from tests.survey.verdict import judge

CHEAP = "01 flat", "25 swept"


@pytest.mark.parametrize("name", CHEAP)
def test_every_mode_is_within_its_estimate(name):
    case = next(case for case in plates.cases() if case.name == name)
    verdict = judge(case, references.stored()[name])
    assert verdict.violations == [], f"true {verdict.true}, estimated {verdict.estimate}, reference {verdict.slack}"
