"""The self-check: its digits, by integrators without our code where these are quick; when it runs, and what it does."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from damper import LawViolation, compiled, forced, ringdown, self_check, starts
from damper.curve_measurement import falling, samples_of
from damper.self_check import leave, stamp
from tests.compiler import COMPILED, needs_compiler
from tests.damper import digits

RUNS: dict[str, Callable[..., Any]] = {
    "ring-downs": ringdown,
    "sweeps": samples_of,
    "curves": falling,
    "forced": forced,
}


@needs_compiler
@pytest.mark.parametrize("family", self_check.FAMILIES)
def test_the_kernels_reproduce_the_digits(family: str) -> None:
    for line in self_check.lines(family, RUNS[family]):
        assert line.error < 1e-10, line


@needs_compiler
@pytest.mark.parametrize("name", self_check.RINGDOWNS)
def test_the_digits_are_those_of_other_integrators(name: str) -> None:
    """Sweeps and the steady state take minutes: `python -m tests.damper.digits`."""
    found = digits.ringdown(name, 1024)
    for figure, value in self_check.RINGDOWNS[name].figures.items():
        assert found[figure] == pytest.approx(value, abs=5e-11), figure


@pytest.fixture
def nothing_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """As on a new machine; the names of the motions that were run."""
    ran: list[str] = []
    right = self_check.figures_of
    names = {id(motion): name for motions in self_check.FAMILIES.values() for name, motion in motions.items()}
    monkeypatch.setattr(compiled, "FOLDER", tmp_path)
    monkeypatch.setattr(compiled, "COMPILES", True)
    monkeypatch.setattr(self_check, "checked", set())
    monkeypatch.setattr(
        self_check, "figures_of", lambda motion, run: (ran.append(names[id(motion)]), right(motion, run))[1]
    )
    return ran


@needs_compiler
def test_it_runs_once_for_a_machine(
    nothing_checked: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before the first result of a family, in this process and, by its stamp, in others; again for other versions."""
    motion = self_check.RINGDOWNS["level floor"]
    for _ in range(2):
        ringdown(motion.damper, motion.arguments["release"], 1)
    assert nothing_checked == list(self_check.RINGDOWNS)
    assert [path.name.split(".")[0] for path in tmp_path.iterdir()] == ["kernels-ring-downs"]
    monkeypatch.setattr(self_check, "checked", set())
    ringdown(motion.damper, motion.arguments["release"], 1)
    assert nothing_checked == list(self_check.RINGDOWNS)
    monkeypatch.setattr(self_check, "checked", set())
    monkeypatch.setattr(compiled, "versions", lambda: ("a new one",))
    ringdown(motion.damper, motion.arguments["release"], 1)
    assert nothing_checked == 2 * list(self_check.RINGDOWNS)
    assert len(list(tmp_path.iterdir())) == 1


@needs_compiler
def test_nothing_leaves_kernels_that_fail(
    nothing_checked: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion = self_check.RINGDOWNS["level floor"]
    monkeypatch.setitem(motion.figures, "energy left", motion.figures["energy left"] + 1e-8)
    for _ in range(2):
        with pytest.raises(
            LawViolation, match=r"'level floor' comes out as computed independently.* energy left"
        ) as caught:
            ringdown(motion.damper, motion.arguments["release"], 1)
        assert caught.value.__notes__ == ["in the self-check of the compiled kernels"]
    assert not list(tmp_path.iterdir())


def test_stamps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One for each name; other sources or versions have another; without a place it is the user's cache, or none."""
    package = tmp_path / "package"
    (package / "__pycache__").mkdir(parents=True)
    (package / "module.py").write_text("x = 1\n")
    first = stamp("plates", package, ("1",))
    assert first.parent == package / "__pycache__"
    leave(first)
    other = stamp("plates", package, ("2",))
    leave(stamp("plates-more", package, ("1",)))
    leave(other)
    assert not first.exists()
    assert len(list(first.parent.iterdir())) == 2
    (package / "module.py").write_text("x = 2\n")
    assert stamp("plates", package, ("2",)) != other
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr("os.access", lambda *_: False)
    assert stamp("plates", package, ("1",)).parent == tmp_path / "cache" / "spindamp"
    leave(package / "module.py" / "no-folder.0.checked")


def test_plain_python_is_not_checked(nothing_checked: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "COMPILES", False)
    self_check.once("ring-downs", ringdown)
    assert not nothing_checked
    assert COMPILED or not compiled.CACHED


@needs_compiler
def test_a_wrong_answer_without_the_ball_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    right = starts.without_ball
    monkeypatch.setattr(starts, "without_ball", lambda *given: right(*given) * 1.001)
    assert [line.figure for line in self_check.lines("forced", forced) if line.error > self_check.EXACT] == [
        "amplitude without the ball"
    ]
