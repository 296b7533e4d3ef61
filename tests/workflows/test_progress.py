"""What a person who waits sees, on a terminal and nowhere else."""

from __future__ import annotations

import re
import time

import numpy as np
import pytest

import fem
from workflows.progress import Stages


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rich takes the captured stream for a terminal."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")


@pytest.mark.usefixtures("terminal")
def test_counted_work_has_a_time_remaining(capsys: pytest.CaptureFixture[str]) -> None:
    with Stages(visible=True) as stages, stages("modes", 1000, done=990) as step:
        for number in range(3):
            step.advance(f"{number} of 1000")
            time.sleep(0.15)
    shown = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", capsys.readouterr().err)
    assert "2 of 1000" in shown
    assert re.search(r"remaining +00:0[0-3]\b", shown), shown


@pytest.mark.usefixtures("terminal")
def test_work_that_is_not_counted_has_none(capsys: pytest.CaptureFixture[str]) -> None:
    with Stages(visible=True) as stages, stages("mesh"):
        time.sleep(0.15)
    shown = capsys.readouterr().err
    assert "mesh" in shown
    assert "remaining" not in shown


def test_speeds_are_counted_where_each_is_solved_by_itself() -> None:
    plate = fem.Plate(fem.rectangle(0.2, 0.08, 3, 2), 0.003, fem.Material(1e11, 0.3, 7e3))
    operators = fem.assemble(plate, fem.Rotor(0.1, 0.3), fem.Effects(large_deflection=True))
    told: list[int] = []
    found = fem.campbell(operators, np.array([100.0, 50.0, 200.0]), 2, progress=told.append)
    assert told == [1, 2, 3]
    assert found.omega.size == 3
