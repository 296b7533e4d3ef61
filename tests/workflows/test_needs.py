"""What a run would need is said before any of it is done."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.limits import HANG
from tests.workflows.conftest import Outcome, Scene, changed, write
from workflows import needs
from workflows.scene_file import load, shipped

GB = 1e9


@pytest.fixture
def work(monkeypatch: pytest.MonkeyPatch) -> None:
    """Any work fails the test."""

    def begun(*_: object, **__: object) -> None:
        raise AssertionError("work has begun")

    monkeypatch.setattr("workflows.pipeline.structure", begun)
    monkeypatch.setattr("fem.read_mesh", begun)
    monkeypatch.setattr(needs, "available", lambda: 16 * GB)


@pytest.mark.parametrize("name", shipped())
def test_shipped_scenes_need_little(name: str) -> None:
    assert needs.memory(load(name)) < GB


MANY = {"start": "0 rpm", "stop": "9000 rpm", "count": 100_000}
TOO_MUCH: list[tuple[dict[str, Any], str, str]] = [
    ({"release__cycles": 1_000_000_000}, "[release] cycles = 1000000000.0: ", "ask for fewer cycles"),
    ({"rotor__speeds": MANY, "release__cycles": 1000}, "[rotor] speeds", "fewer speeds"),
    ({"rotor__speeds": MANY, "rotor__modes": 200}, "[rotor] speeds", "fewer speeds"),
    (
        {"rotor__modes": 200, "plate__theory": "solid", "rotor__speeds": {"start": 0, "stop": 1, "count": 60_000}},
        "",
        "",
    ),
]


@pytest.mark.usefixtures("work")
@pytest.mark.parametrize("command", ["check", "run", "campbell"])
@pytest.mark.parametrize(("changes", "key", "advice"), TOO_MUCH)
def test_too_much(
    changes: dict[str, Any],
    key: str,
    advice: str,
    command: str,
    paper: Scene,
    spindamp: Callable[..., Outcome],
    tmp_path: Path,
) -> None:
    if command == "campbell" and "release__cycles" in changes:
        pytest.skip("the plate alone has no cycles")
    write(changed(paper, **changes), tmp_path / "scene.toml")
    _refused(spindamp(command, "scene.toml"), f"scene.toml: {key}", advice)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


@pytest.mark.usefixtures("work")
@pytest.mark.parametrize("size", [700_000_000, 10**13])
def test_a_mesh_of_ten_million_cells(size: int, paper: Scene, spindamp: Callable[..., Outcome], tmp_path: Path) -> None:
    with (tmp_path / "fine.msh").open("wb") as file:
        file.write(b"$MeshFormat\n")
        file.truncate(size)  # takes no room on the disk
    scene = changed(paper, plate__length=None, plate__width=None, plate__mesh="fine.msh", damper__at=None)
    write(scene, tmp_path / "scene.toml")
    for command in ("check", "run"):
        outcome = spindamp(command, "scene.toml")
        _refused(outcome, "scene.toml: [plate] mesh = 'fine.msh': ", "coarsen the mesh")


def _refused(outcome: Outcome, start: str, advice: str) -> None:
    assert outcome.status == 2, outcome
    assert outcome.out == ""
    assert len(outcome.err.splitlines()) == 1
    assert outcome.err.startswith(f"spindamp: {start}")
    assert re.search(r"this needs about [0-9.]+ [GT]B of memory, and 16 GB are there: ", outcome.err)
    assert advice in outcome.err


def test_too_long(monkeypatch: pytest.MonkeyPatch, paper: Scene, spindamp: Callable[..., Outcome]) -> None:
    monkeypatch.setattr(needs, "available", lambda: float("inf"))
    write(changed(paper, release__cycles=1e9, rotor__speeds={"start": 1, "stop": 2, "count": 100}), Path("long.toml"))
    outcome = spindamp("run", "long.toml")
    assert outcome.status == 2
    assert re.search(r"long.toml: \[release\] cycles = 1000000000.0: this takes about \d+ days: ", outcome.err)


def test_the_limit_is_that_of_the_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    import resource

    before = needs.available()
    assert 1e7 < before < 1e15
    monkeypatch.setattr(resource, "getrlimit", lambda _: (1 << 20, -1))
    assert needs.available() == 0, "less than this very process has taken"


LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, (int(float(sys.argv.pop())),) * 2)
from workflows import cli
sys.exit(cli.main())
"""


@pytest.mark.parametrize(("modes", "limit", "status"), [(6, 1e9, 0), (100, 1.5e9, 2)])
def test_a_limit_of_address_space(modes: int, limit: float, status: int, paper: Scene, tmp_path: Path) -> None:
    """Six modes take 0.63 GB of addresses, a hundred 2.8 GB: refused at once, not after half a minute of work."""
    write(changed(paper, rotor__speeds=["5000 rpm"], rotor__modes=modes), tmp_path / "scene.toml")
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, "campbell", "scene.toml", str(limit)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        timeout=HANG,
    )
    assert done.returncode == status, done.stderr
    assert ("[rotor] modes = 100: this needs about" in done.stderr) == (status == 2)


def test_the_same_scene_passes_where_there_is_room(
    monkeypatch: pytest.MonkeyPatch, spindamp: Callable[..., Outcome]
) -> None:
    needed = needs.memory(load("paper"))
    monkeypatch.setattr(needs, "available", lambda: 1.01 * needed)
    assert spindamp("check", "paper").status == 0
    monkeypatch.setattr(needs, "available", lambda: 0.99 * needed)
    assert spindamp("check", "paper").status == 2


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin", "solid", "auto"])
def test_a_plate_grows_no_further_than_its_mesh(
    theory: str, monkeypatch: pytest.MonkeyPatch, paper: Scene, tmp_path: Path
) -> None:
    """The search for a mesh ends at a number of unknowns: the estimate takes that very number."""
    from fem import choice

    source = load(write(changed(paper, plate__theory=theory, rotor__modes=200), tmp_path / "scene.toml"))
    before = needs.memory(source)
    monkeypatch.setattr(choice, "MOST_UNKNOWNS", {name: most // 20 for name, most in choice.MOST_UNKNOWNS.items()})
    assert needs.memory(source) < 0.8 * before


def test_the_estimate_of_a_cycle_is_of_the_right_size(structure: Scene, tmp_path: Path) -> None:
    """The arrays and objects of a cycle alone, without the text made from them."""
    import json
    import tracemalloc

    import workflows

    source = load(write(changed(structure, release__cycles=3000), tmp_path / "scene.toml"))
    workflows.run(source)  # compiles and loads, which is not counted
    tracemalloc.start()
    try:
        results = workflows.run(source)
        text = json.dumps(workflows.document(results), indent=1)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert text
    cycles = max(part.memory for part in needs.parts(source) if "cycles" in part.key)
    assert 0.3 < cycles / most < 3
