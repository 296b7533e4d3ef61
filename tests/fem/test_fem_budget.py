"""What causes of an error may add makes no more than the error asked for."""

import numpy as np
import pytest

from fem.accuracy.tolerances import FIRST, SURE, Budget

ASKED = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6)


@pytest.mark.parametrize("asked", ASKED)
def test_parts_make_no_more_than_the_whole(asked):
    """A mesh that takes the part of its tolerance that meshes take, beside any theory and effects left out."""
    budget = Budget(asked)
    for theory in np.linspace(0.0, budget.sheared, 7):
        for left_out in np.linspace(0.0, asked - theory, 7):
            mesh = budget.mesh(theory, left_out)
            assert 0.0 < mesh <= asked
            if theory + left_out <= 0.75 * asked * (1 - 1e-9):
                assert theory + left_out + min(FIRST, 0.65) * mesh <= asked * (1 + 1e-12)


@pytest.mark.parametrize("asked", ASKED)
def test_no_cause_alone_takes_all(asked):
    budget = Budget(asked, asked)
    for part in (budget.thin, budget.sheared, budget.layers, budget.left_out, budget.rough_drive, budget.scattered):
        assert 0.0 < part < asked
    assert 1e-7 <= budget.basis <= max(1e-3 * asked, 1e-7)
    assert 0.0 < FIRST < SURE < 1.0


def test_a_scene_s_budget_is_what_it_asks_for():
    from workflows.scene.load import load

    scene = load("paper").scene
    assert scene.budget == Budget(scene.accuracy.frequency, scene.accuracy.damping)
