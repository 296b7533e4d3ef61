"""Every effect has a definition under its key, and a word for people."""

from __future__ import annotations

import pytest

from tests.workflows.conftest import Scene, changed
from workflows.effects import ball, plate, selection
from workflows.effects.selection import EFFECTS
from workflows.errors import BadInput
from workflows.pipeline import run
from workflows.report.remarks import assumptions
from workflows.scene.load import parse
from workflows.scene.scene import Effects


def test_every_key_has_a_definition_and_every_definition_a_key() -> None:
    assert [*plate.EFFECTS, *ball.EFFECTS] == list(Effects.model_fields) == list(EFFECTS)
    assert {kind.of for kind in plate.EFFECTS.values()} == {"plate"}
    assert {kind.of for kind in ball.EFFECTS.values()} == {"damper"}


@pytest.mark.parametrize("name", EFFECTS)
def test_words_of_an_effect_are_its_own(name: str) -> None:
    words = [kind.word for kind in EFFECTS.values()]
    assert words.count(EFFECTS[name].word) == 1
    assert EFFECTS[name].part_of in {"", *EFFECTS}
    assert set(EFFECTS[name].after) <= EFFECTS.keys() - {name}


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("ball_slip", {"damper__friction": 0}),
        ("ball_slip", {"damper__formulation": "printed"}),
        ("structural_modes", {}),
        ("coriolis", {}),
    ],
)
def test_what_rules_an_effect_out_is_said_with_its_key(structure: Scene, name: str, changes: dict[str, object]) -> None:
    scene = parse(changed(structure, **changes, **{f"effects__{name}": True}))
    with pytest.raises(BadInput, match=rf"{name}|friction"):
        selection.resolve(scene, "scene.toml")


def test_a_ball_that_slips_is_not_said_to_roll(structure: Scene) -> None:
    """What is taken for granted goes with the effects."""
    for slips, said in ((False, "never slides except at walls"), (True, "slides there until it rolls")):
        found = run(changed(structure, effects__ball_slip=slips, release__cycles=2))
        assert said in " ".join(text for text, _ in assumptions(found))
