"""Speeds that are solved beside those asked for, so that modes can be followed: only as many as they are worth."""

import numpy as np
import pytest

import workflows
from tests.workflows.conftest import changed


@pytest.fixture
def bases(monkeypatch):
    """How many speeds each reduced basis that is grown is for."""
    from fem.sweep import reduced_basis as adaptive

    speeds = []
    plain = adaptive.grow

    def counted(question, omega, *arguments):
        speeds.append(omega.size)
        return plain(question, omega, *arguments)

    monkeypatch.setattr(adaptive, "grow", counted)
    return speeds


def test_two_speeds_far_apart_take_no_hundred(paper, bases):
    """The first frequency grows fiftyfold between them: no one basis answers what lies between."""
    thin = {"plate__thickness": "0.3 mm", "plate__theory": "mindlin", "accuracy__frequency": 0.05}
    scene = changed(paper, **thin, rotor__speeds=["0 rpm", "17500 rpm"], damper=None, release=None)
    slow, fast = workflows.run(scene).speeds
    assert fast.modes[0].frequency_hz > 45 * slow.modes[0].frequency_hz
    assert bases == [14], "one try"
    assert [mode.branch for mode in fast.modes[:2]] == [0, 1]


def test_steps_between_speeds_grow_with_the_stiffness():
    """Where modes are stiffened much, their squared frequencies grow by like factors from step to step."""
    from workflows.solve.structure import steps

    assert len(steps(0.0, 100.0, np.array([[100.0], [300.0]]))) == 100
    assert len(steps(0.0, 100.0, np.full((1, 1), np.nan))) == 100
    found = steps(10.0, 100.0, np.array([[1.0, 2.0], [40.0, 3.0]]))
    assert len(found) == 12
    squares = 1.0 + (1600.0 - 1.0) * (found**2 - 10.0**2) / (100.0**2 - 10.0**2)
    np.testing.assert_allclose(squares[1:] / squares[:-1], 1600.0 ** (1 / 13), rtol=1e-9)
