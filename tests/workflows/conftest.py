"""Scenes to bend, and one real run that many tests read."""

import copy
import json
import math
import os
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock

import workflows
from tests.limits import HANG
from tests.workflows.browser import Page, opened
from workflows import progress
from workflows.cli.main import main
from workflows.effects import selection
from workflows.effects.definition import Effect
from workflows.report import figures
from workflows.scene import plate_mesh
from workflows.scene.load import SHIPPED, SceneFile, load
from workflows.solve import damper
from workflows.solve.results import Results
from workflows.studies.sweep import executor

Scene = dict[str, Any]


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    status: int
    out: str
    err: str


Command = Callable[..., Outcome]
"""The command line, called by a test."""


BALL: Scene = {
    "radius": "1 mm",
    "cavity": ["2.5 mm", "2.4 mm"],
    "restitution": 0.5,
    "friction": 0.3,
    "rolling_friction": "0.01 mm",
}
"""A table [damper] without its balls' mass."""

KNOWN: Scene = {
    "structure": {"frequency": "269.5 Hz", "mass": "1 kg"},
    "rotor": {"radius": "20 cm"},
    "damper": {"mass_ratio": 0.006, "count": 183} | BALL,
    "release": {"displacement": ["1 mm", "0 mm"], "cycles": 5},
}
"""A ball on a known structure at 20 cm, without speeds."""


def effects_of(source: SceneFile) -> dict[str, Effect]:
    """Every effect of a scene from a file, decided, its mesh read where one is named."""
    return selection.resolve(source.scene, source.name, None if source.mesh is None else plate_mesh.planform(source))


@pytest.fixture
def spindamp(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Command:
    """The command line, run in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(progress, "SILENT", math.inf)  # what is printed does not depend on how fast this machine is

    def call(*arguments: object) -> Outcome:
        capsys.readouterr()
        status = main([str(argument) for argument in arguments])
        found = capsys.readouterr()
        return Outcome(status, found.out, found.err)

    return call


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reports without their figures, which take most of a report's time and are not looked at."""
    monkeypatch.setattr(figures, "report", lambda _: dict.fromkeys(figures.SHOWN, ""))


def measured_quickly(system: Any, least: float = 0.0) -> Any:
    """The damper's own figures as `sweep --quick` has them, to about a percent."""
    from damper import damping_curve

    return damping_curve(system, least=least, **damper.QUICK)


@pytest.fixture
def quickly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Quick figures of the damper, where words are looked at, or what is not of the damper; not in sweeps."""
    import_module("workflows.studies.sweep.evaluate")  # has the others by then
    monkeypatch.setattr(damper, "damping_curve", measured_quickly)


@pytest.fixture(scope="module")
def here() -> Iterator[ThreadPoolExecutor]:
    """An executor without processes."""
    with ThreadPoolExecutor(1) as executor:
        yield executor


@pytest.fixture
def no_workers(monkeypatch: pytest.MonkeyPatch, here: ThreadPoolExecutor) -> None:
    """Commands that hire workers have a thread of this process in their place."""
    monkeypatch.setattr(executor, "local", lambda *_: executor.external(here, 1))


def shipped_scene(name: str) -> Scene:
    """A shipped scene as plain data."""
    return tomllib.loads((SHIPPED / f"{name}.toml").read_text(encoding="utf-8"))


@pytest.fixture
def paper() -> Scene:
    """The paper's scene as plain data."""
    return shipped_scene("paper")


@pytest.fixture
def structure() -> Scene:
    """The structure-only scene as plain data."""
    return shipped_scene("structure")


def changed(scene: Scene, **changes: Any) -> Scene:
    """A copy with keys set (table__key=value) or, by None, taken out."""
    new = copy.deepcopy(scene)
    for path, value in changes.items():
        *tables, key = path.split("__")
        place = new
        for table in tables:
            place = place.setdefault(table, {})
        if value is None:
            place.pop(key, None)
        else:
            place[key] = value
    return new


def toml(value: Any) -> str:
    """A value as TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False)


def text_of(scene: Scene) -> str:
    """A scene as TOML."""
    lines = [f"{key} = {toml(value)}" for key, value in scene.items() if not isinstance(value, dict)]
    for name, table in scene.items():
        if isinstance(table, dict):
            lines += [f"[{name}]", *(f"{key} = {toml(value)}" for key, value in table.items())]
    return "\n".join(lines) + "\n"


def write(scene: Scene, path: Path) -> Path:
    """Write a scene as a TOML file."""
    path.write_text(text_of(scene), encoding="utf-8")
    return path


def on_mesh(scene: Scene, mesh: Path | str, **changes: Any) -> Scene:
    """A copy whose plate comes from a mesh file, its damper at the tip unless the changes have a place."""
    drawn = {"plate__length": None, "plate__width": None, "plate__mesh": str(mesh), "damper__at": None}
    return changed(scene, **drawn | changes)


def python(*arguments: object, **options: Any) -> subprocess.CompletedProcess[str]:
    """What a process of its own says that runs Python with these arguments, and how it ends."""
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=HANG, **options)


def strict_json(text: str) -> dict[str, Any]:
    """A document without NaN and infinity, which are not JSON."""
    found: dict[str, Any] = json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} in JSON"))
    return found


def refused(outcome: Outcome, start: str, message: str = "", status: int = 2) -> str:
    """What a command says in the one line on standard error with which it ends; nothing else is said."""
    assert (outcome.status, outcome.out) == (status, ""), outcome
    assert outcome.err.endswith("\n")
    assert len(outcome.err.splitlines()) == 1
    assert outcome.err.startswith(f"spindamp: {start}"), outcome.err
    assert message in outcome.err
    assert "Traceback" not in outcome.err
    return outcome.err


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of one real run of the paper's scene, one for all processes of the tests."""
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "run"
    with FileLock(f"{folder}.lock"):
        assert folder.exists() or main(["run", "--out", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def standing(finished: Path) -> Iterator[Page]:
    """Its report in a browser."""
    with opened(finished / "report.html", motion="reduce") as page:
        yield page


@pytest.fixture(scope="session")
def coarse() -> Results:
    """The paper's plate and damper at rest and at 500 rad/s, three modes on a coarse mesh."""
    source = load("paper")
    return workflows.run(source.changed(rotor={"speeds": (0.0, 500.0), "modes": 3}, accuracy={"frequency": 0.05}))


@pytest.fixture(scope="session")
def document(finished: Path) -> dict[str, Any]:
    """Its results.json, in which there is no NaN."""
    return strict_json((finished / "results.json").read_text(encoding="utf-8"))
