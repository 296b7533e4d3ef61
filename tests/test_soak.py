"""The soak in short, and that it notices what it is there to notice."""

import dataclasses
import tomllib
from pathlib import Path

import numpy as np
import pytest

import workflows
from damper import Outcome
from tests.compiler import needs_compiler
from tests.soak import rings
from tests.soak.__main__ import main
from tests.soak.dice import Seeded
from tests.workflows.conftest import text_of


@needs_compiler
def test_short_soak(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    status = main(["--ringdowns", "300", "--plates", "5", "--seed", "1", "--out", str(tmp_path)])
    said = capsys.readouterr().out
    assert status == 0, said
    assert "scenes tried: 300 ring-downs, 5 plates" in said
    assert "failures: 0" in said
    assert list(tmp_path.iterdir()) == []


def test_faults_are_noticed() -> None:
    dice = Seeded(3)
    kind = rings.Kind("consistent", False, 2.0)
    scenes = [rings.scene(dice, kind) for _ in range(3)]
    batch = rings.run(scenes)
    assert [rings.faults(batch, k, scenes[k]) for k in range(3)] == [[], [], []]
    broken = {
        "final": (np.nan, "final is nan"),
        "impact": (1e-6, "the energy books miss"),
        "structure": (-1e-6, "structure gives"),
    }
    for name, (value, message) in broken.items():
        wrong = dataclasses.replace(batch, **{name: getattr(batch, name) + value * batch.initial})
        assert any(message in fault for k in range(3) for fault in rings.faults(wrong, k, scenes[k]))
    capped = np.array([Outcome.EVENT_CAP] * 3, dtype=object)
    stalled = dataclasses.replace(batch, outcome=capped, events=10 * batch.impacts + 3000)
    assert any("stalls" in fault for fault in rings.faults(stalled, 1, scenes[1]))


def test_a_scene_written_down_is_the_scene(tmp_path: Path) -> None:
    """What a failure leaves is read by the commands, and stands for the very same damper."""
    dice = Seeded(5)
    for _ in range(5):
        kind = rings.kind(dice)
        scene = rings.scene(dice, kind)
        path = tmp_path / "scene.toml"
        path.write_text(text_of(scene))
        assert workflows.load(path).scene.damper is not None
        assert rings.damper_of(tomllib.loads(path.read_text())) == rings.damper_of(scene)
