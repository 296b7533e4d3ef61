"""Scenes to bend, and one real run that many tests read."""

import copy
import json
import math
import os
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from filelock import FileLock

import workflows
from tests.limits import HANG
from tests.workflows.browser import opened
from workflows import progress
from workflows.cli.main import main
from workflows.effects import selection
from workflows.report import figures
from workflows.scene import plate_mesh
from workflows.scene.load import SHIPPED, load
from workflows.solve import damper
from workflows.studies.sweep import executor

ROOT = Path(__file__).parents[2]
MESHES = ROOT / "meshes"
QUIET = progress.Stages(visible=False)


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    status: int
    out: str
    err: str


BALL = {
    "radius": "1 mm",
    "cavity": ["2.5 mm", "2.4 mm"],
    "restitution": 0.5,
    "friction": 0.3,
    "rolling_friction": "0.01 mm",
}
"""A table [damper] without its balls' mass."""

KNOWN = {
    "structure": {"frequency": "269.5 Hz", "mass": "1 kg"},
    "rotor": {"radius": "20 cm"},
    "damper": {"mass_ratio": 0.006, "count": 183} | BALL,
    "release": {"displacement": ["1 mm", "0 mm"], "cycles": 5},
}
"""A ball on a known structure at 20 cm, without speeds."""

BLADE = {
    "plate": {"length": "120 mm", "width": "50 mm", "thickness": "6 mm"},
    "material": {"name": "Ti-6Al-4V"},
    "rotor": {"modes": 2, "hub_radius": "150 mm"},
    "damper": {"count": 2, "ball_material": "steel", "radius": "2 mm", "cavity": ["4.6 mm", "5 mm"]}
    | {"restitution": 0.6, "friction": 0.2, "rolling_friction": "0.02 mm"},
}
"""The guide's blade with its damper, without speeds."""


def effects_of(source):
    """Every effect of a scene from a file, decided, its mesh read where one is named."""
    return selection.resolve(source.scene, source.name, None if source.mesh is None else plate_mesh.planform(source))


@pytest.fixture
def spindamp(capsys, monkeypatch, tmp_path):
    """The command line, run in an empty folder; scenes as plain data are written there, to scene.toml.

    Its method json: the document that a command prints.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(progress, "SILENT", math.inf)  # what is printed does not depend on how fast this machine is

    def call(*arguments):
        capsys.readouterr()
        given = (write(each, Path("scene.toml")) if isinstance(each, dict) else each for each in arguments)
        status = main([str(each) for each in given])
        found = capsys.readouterr()
        return Outcome(status, found.out, found.err)

    def document(*arguments):
        outcome = call(*arguments, "--json")
        assert outcome.status == 0, outcome.err
        return strict_json(outcome.out)

    call.json = document
    return call


@pytest.fixture
def undrawn(monkeypatch):
    """Reports without their figures, which take most of a report's time and are not looked at."""
    monkeypatch.setattr(figures, "report", lambda _: dict.fromkeys(figures.SHOWN, ""))


def measured_quickly(system, least=0.0):
    """The damper's own figures as `sweep --quick` has them, to about a percent."""
    from damper import damping_curve

    return damping_curve(system, least=least, **damper.QUICK)


@pytest.fixture
def quickly(monkeypatch):
    """Quick figures of the damper, where words are looked at, or what is not of the damper; not in sweeps."""
    import_module("workflows.studies.sweep.evaluate")  # has the others by then
    monkeypatch.setattr(damper, "damping_curve", measured_quickly)


def few(patch):
    """Forced responses follow a quarter of the speeds, the crossing's among them."""
    response = import_module("workflows.studies.response")
    patch.setattr(response, "SPEEDS", 9)
    patch.setattr(response, "ROUNDS", 1)


@pytest.fixture
def few_speeds(monkeypatch):
    """The same for a test."""
    few(monkeypatch)


@pytest.fixture(scope="module")
def here():
    """An executor without processes."""
    with ThreadPoolExecutor(1) as executor:
        yield executor


@pytest.fixture
def no_workers(monkeypatch, here):
    """Commands that hire workers have a thread of this process in their place."""
    monkeypatch.setattr(executor, "local", lambda *_: executor.external(here, 1))


def shipped_scene(name):
    """A shipped scene as plain data."""
    return tomllib.loads((SHIPPED / f"{name}.toml").read_text(encoding="utf-8"))


def table_of(name):
    """What a TOML file beside the tests holds."""
    return tomllib.loads(Path(__file__).with_name(f"{name}.toml").read_text(encoding="utf-8"))


@pytest.fixture
def paper():
    """The paper's scene as plain data."""
    return shipped_scene("paper")


@pytest.fixture
def structure():
    """The structure-only scene as plain data."""
    return shipped_scene("structure")


def changed(scene, **changes):
    """A copy with keys set (table__key=value) or, by None, taken out."""
    new = copy.deepcopy(scene)
    for path, value in changes.items():
        *tables, key = path.split("__")
        place = new
        for table in tables:
            place = place.get(table, {}) if value is None else place.setdefault(table, {})
        if value is None:
            place.pop(key, None)
        else:
            place[key] = value
    return new


class Raw(str):
    """A value that is TOML already, which may be anything that a file can hold."""


def toml(value):
    """A value as TOML."""
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False)


def text_of(scene):
    """A scene as TOML."""
    lines = [f"{key} = {toml(value)}" for key, value in scene.items() if not isinstance(value, dict)]
    for name, table in scene.items():
        if isinstance(table, dict):
            lines += [f"[{name}]", *(f"{key} = {toml(value)}" for key, value in table.items())]
    return "\n".join(lines) + "\n"


def write(scene, path):
    """Write a scene as a TOML file."""
    path.write_text(text_of(scene), encoding="utf-8")
    return path


def on_mesh(scene, mesh, **changes):
    """A copy whose plate comes from a mesh file, its damper at the tip unless the changes have a place."""
    drawn = {"plate__length": None, "plate__width": None, "plate__mesh": str(mesh), "damper__at": None}
    return changed(scene, **drawn | changes)


def quads(x, y):
    """Points (n, 3) and quadrilaterals (m, 4) between places along and across."""
    points = np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros((len(x), len(y)))], axis=2).reshape(-1, 3)
    corner = (len(y) * np.arange(len(x) - 1)[:, None] + np.arange(len(y) - 1)).ravel()
    return points, corner[:, None] + [0, len(y), len(y) + 1, 1]


def python(*arguments, **options):
    """What a process of its own says that runs Python with these arguments, and how it ends."""
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=HANG, **options)


def raising(error):
    """A function that does nothing else."""

    def call(*_, **__):
        raise error

    return call


def stored(file):
    """A document that a command has written."""
    return json.loads(file.read_text(encoding="utf-8"))


def strict_json(text):
    """A document without NaN and infinity, which are not JSON."""
    return json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} in JSON"))


def refused(outcome, start, message="", status=2):
    """What a command says in the one line on standard error with which it ends; nothing else is said."""
    assert (outcome.status, outcome.out) == (status, ""), outcome
    assert outcome.err.endswith("\n")
    assert len(outcome.err.splitlines()) == 1
    assert outcome.err.startswith(f"spindamp: {start}"), outcome.err
    assert message in outcome.err
    assert "Traceback" not in outcome.err
    return outcome.err


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """The folder of one real run of the paper's scene, one for all processes of the tests."""
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "run"
    with FileLock(f"{folder}.lock"):
        assert folder.exists() or main(["run", "--out", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def standing(finished):
    """Its report in a browser."""
    with opened(finished / "report.html", motion="reduce") as page:
        yield page


@pytest.fixture(scope="session")
def coarse():
    """The paper's plate and damper at rest and at 500 rad/s, three modes on a coarse mesh."""
    source = load("paper")
    return workflows.run(source.changed(rotor={"speeds": (0.0, 500.0), "modes": 3}, accuracy={"frequency": 0.05}))


@pytest.fixture(scope="session")
def document(finished):
    """Its results.json, in which there is no NaN."""
    return strict_json((finished / "results.json").read_text(encoding="utf-8"))
