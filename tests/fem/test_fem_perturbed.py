"""Answers of every iterative solver to problems that differ by rounding alone; more by `python -m tests.perturbed`."""

import numpy as np
import pytest

from fem import linalg
from tests.perturbed.__main__ import trial
from tests.perturbed.cases import CASES


@pytest.mark.parametrize("name", CASES)
def test_answers_do_not_hang_on_rounding(name):
    """Processors, orders of unknowns and units round differently, and start vectors are arbitrary."""
    found = trial(CASES[name], times=1)
    assert not found.faults, str(found)


@pytest.mark.parametrize("wrong", [1e-6, np.nan])
def test_an_answer_that_hangs_on_the_start_is_noticed(monkeypatch, wrong):
    plain = linalg.lanczos

    def lanczos(*given):
        values, vectors = plain(*given)
        return (values if linalg.SEED == 0 else values * (1.0 + wrong)), vectors

    monkeypatch.setattr("fem.modes.lanczos", lanczos)
    assert len(trial(CASES["a mass of a million plates"], times=2).faults) == 2


def test_a_failure_on_another_start_is_noticed(monkeypatch):
    plain = linalg.lanczos

    def lanczos(*given):
        if linalg.SEED != 0:
            raise linalg.NotConverged
        return plain(*given)

    monkeypatch.setattr("fem.modes.lanczos", lanczos)
    (fault,) = trial(CASES["a mass of a million plates"], times=1).faults
    assert "ends with NotConverged, not with one" in fault
