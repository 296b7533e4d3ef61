"""A few plates of the survey: every frequency within the error estimated beside it, as CalculiX has it."""

import pytest

import workflows
from tests.survey import __main__ as survey
from tests.survey import plates, references, scenes
from tests.survey.verdict import judge

CHEAP = "01 flat", "25 swept"


@pytest.mark.parametrize("name", CHEAP)
def test_every_mode_is_within_its_estimate(name):
    case = next(case for case in plates.cases() if case.name == name)
    verdict = judge(case, references.stored()[name])
    assert verdict.violations == [], f"true {verdict.true}, estimated {verdict.estimate}, reference {verdict.slack}"


def test_all_sixty_are_scenes_that_the_command_asks_for(tmp_path):
    """Those of varying thickness among them."""
    asked = [case for case, _ in survey._answered("")]
    assert len(asked) == 60
    for case in asked:
        scene = workflows.load(scenes.write(case, tmp_path)).scene
        assert isinstance(scene.plate.thickness, float) != bool(case.profile)
