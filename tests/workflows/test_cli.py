"""The command line: what it prints where, and how it ends."""

import ast
import contextlib
import errno
import io
import json
import os
import re
import subprocess
import sys
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from importlib.metadata import version
from inspect import isfunction
from pathlib import Path

import numpy as np
import psutil
import pytest

import fem
import spindamp
from tests.limits import HANG
from tests.workflows.conftest import (
    ROOT,
    Outcome,
    changed,
    python,
    raising,
    refused,
    shipped_scene,
    stored,
    strict_json,
    write,
)
from workflows import cli, progress
from workflows.cli.commands import COMMANDS
from workflows.progress import Stages
from workflows.solve import resources

pytestmark = pytest.mark.usefixtures("undrawn")

USAGE = [
    ((), "missing command: expected one of run, campbell, "),
    (("rnu",), "rnu"),
    (("run", "--outt", "x"), "--outt"),
    (("run", "a", "b"), "b"),
    (("check",), "SCENE"),
    (("ringdown", "--rpm", "fast"), "--rpm"),
    (("ringdown", "--rpm", "-5"), "--rpm = -5: expected a rotation speed"),
    (("ringdown", "--rpm", "nan"), "--rpm"),
    (("ringdown", "campbell"), "[damper]: the table is missing"),
    (("campbell", "structure"), "[plate]: the table is missing"),
]


@pytest.mark.parametrize(("arguments", "message"), USAGE)
def test_usage_errors(arguments, message, spindamp, tmp_path):
    refused(spindamp(*arguments), "", message)
    assert not list(tmp_path.iterdir())


@pytest.fixture
def soon(paper):
    """The paper's plate at one speed, on a coarse mesh."""
    return changed(paper, rotor__speeds=["10000 rpm"], rotor__modes=2, accuracy__frequency=0.05)


def test_a_slow_start_is_explained(spindamp, soon, monkeypatch):
    monkeypatch.setattr("damper.compiled.CACHED", False)
    assert "compiled code cannot be stored" in spindamp("ringdown", "structure").err
    assert spindamp("campbell", soon).err == ""
    monkeypatch.setattr("damper.compiled.COMPILES", False)
    (line,) = spindamp("ringdown", "structure").err.splitlines()
    assert "run as plain Python" in line
    assert "do not wait for their self-check" in line


def test_a_first_start_is_explained_on_a_terminal(spindamp, monkeypatch):
    monkeypatch.setattr("damper.compiled.fresh", lambda: True)
    assert spindamp("ringdown", "structure", "--json").err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert "compiling the damper's kernels, once for an installation" in spindamp("ringdown", "structure", "--json").err
    assert "compiling" not in spindamp("check", "campbell").err


def test_help_names_every_command(spindamp):
    outcome = spindamp("--help")
    assert outcome.status == 0
    assert all(command.__name__ in outcome.out for command in COMMANDS)
    assert spindamp("run", "--help").status == 0


def test_version(spindamp):
    assert spindamp("--version") == Outcome(0, f"spindamp {version('spindamp')}\n", "")


@pytest.mark.parametrize("command", ["run", "campbell", "ringdown"])
def test_json_is_all_that_is_printed(command, spindamp, tmp_path, soon):
    outcome = spindamp(command, soon, "--json")
    assert (outcome.status, outcome.err) == (0, "")
    document = strict_json(outcome.out)
    assert document["schema_version"] == 1
    point = document["speeds"][0]
    assert ("damper" in point) == ("reduced" in point) == (command != "campbell")
    uncut = "before the cavities take 5.5 g out of it, which `run` includes where [effects] cavity_mass is on."
    assert any(uncut in note for note in document["notes"]) == (command == "campbell")
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


def test_ringdown_takes_one_speed(spindamp):
    assert [point["rpm"] for point in spindamp.json("ringdown", "structure", "--rpm", "5000")["speeds"]] == [5000]


def test_a_ring_down_does_not_speak_of_engine_orders(spindamp):
    """Which cross no mode at one speed, and were not asked for; nor are balls that ring down said never to move.

    Of the scene's speeds it takes the middle one.
    """
    said = " ".join(spindamp("ringdown", "paper").out.split())
    assert "No: the balls never move within what the plate endures. At 10000 rpm the balls move above" in said
    assert "ngine order" not in said


def test_json_is_what_is_written(spindamp, tmp_path):
    outcome = spindamp("run", "structure", "--json", "--out", "out")
    assert json.loads(outcome.out) == stored(tmp_path / "out" / "results.json")


def test_check_says_why(spindamp):
    said = spindamp("check", "paper").out
    assert "stress_stiffening = true" in said
    assert "the centrifugal load stiffens it" in said
    found = spindamp.json("check", "paper")
    assert found["effects"]["coriolis"]["on"] is True
    assert found["scene"]["plate"]["theory"] == found["theory"]["name"]


def test_divergence_is_no_answer(spindamp, tmp_path, paper):
    rotor = paper["rotor"] | {"speeds": ["20000 rpm", "30000 rpm"], "stagger": "90 deg"}
    soft = changed(paper, rotor=rotor, effects__stress_stiffening=False, accuracy__frequency=0.05)
    refused(spindamp("campbell", soft, "--out", "out"), "", "20000 rpm", status=3)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


def test_speeds_below_the_critical_one_have_answers(spindamp, paper):
    """Without prestress the plate in the plane of rotation diverges where the rotor turns as fast as it vibrates."""
    changes = {"rotor__speeds": ["30000 rpm", "0 rpm"], "rotor__stagger": "90 deg", "effects__stress_stiffening": False}
    found = spindamp.json("campbell", changed(paper, **changes, accuracy__frequency=0.05))
    assert [point["rpm"] for point in found["speeds"]] == [0]
    (note,) = [note for note in found["notes"] if "diverges at 30000 rpm" in note]
    critical = float(note.split("critical speed is ")[1].split(" rpm")[0])
    assert critical == pytest.approx(60 * found["speeds"][0]["modes"][0]["frequency_hz"], rel=1e-3)


def test_a_defect_is_one_line_and_a_traceback_on_request(spindamp, monkeypatch):
    monkeypatch.setattr("workflows.scene.load.load", raising(ZeroDivisionError("a bug\nof ours")))
    said = refused(spindamp("run"), "an internal error: ZeroDivisionError: a bug of ours", status=1)
    assert "report it" in said
    monkeypatch.setenv("SPINDAMP_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        cli.main(["run"])


def test_lines_where_there_is_no_terminal(monkeypatch, capsys):
    """None in the first half minute; then one for each stage that lasts and one a minute, with the time left."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "perf_counter", lambda: now[0])
    with Stages(visible=False, lines=True) as stages:
        with stages("modes") as step:
            step.advance("1 of 2 speeds")
        with stages("damper", 100) as step:
            for _ in range(100):
                now[0] += 2.0
                step.advance("order 3")
        with stages("design") as step:
            step.advance("32 designs")
        for name in ("modes", "reduction") * 20:
            with stages(name):
                now[0] += 1.0
    assert capsys.readouterr().err.splitlines() == [
        "spindamp: damper: order 3; 15 of 100 steps, 170 s remaining",
        "spindamp: damper: order 3; 45 of 100 steps, 110 s remaining",
        "spindamp: damper: order 3; 75 of 100 steps, 50 s remaining",
        "spindamp: design",
        *(f"spindamp: {name}" for name in ("modes", "reduction", "modes")),
    ]


def test_the_time_remaining_does_not_count_what_is_done_once(monkeypatch, capsys):
    """As compilation in the first step: no time after it; then that of the others, which may come several at once."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "perf_counter", lambda: now[0])
    with Stages(visible=False, lines=True) as stages, stages("damper", 600, done=100) as step:
        for seconds, steps in ((70.0, 2), (60.0, 6), (66.0, 15)):
            now[0] += seconds
            step.advance("order 3", steps)
    assert capsys.readouterr().err.splitlines() == [
        "spindamp: damper: order 3; 102 of 600 steps",
        "spindamp: damper: order 3; 108 of 600 steps, 4920 s remaining",
        "spindamp: damper: order 3; 123 of 600 steps, 2862 s remaining",
    ]


def test_progress_only_on_a_terminal(soon, tmp_path):
    pty = pytest.importorskip("pty")
    ours, theirs = pty.openpty()
    scene = write(soon, tmp_path / "scene.toml")
    command = [sys.executable, "-m", "workflows.cli", "campbell", scene, "--json"]
    with ThreadPoolExecutor(1) as reader:  # a terminal holds 4 KB that nobody has read, and the run then waits
        shown = reader.submit(_all_shown, ours)
        try:
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=theirs, check=True, timeout=HANG)
        finally:
            os.close(theirs)
    os.close(ours)
    assert "modes" in shown.result()
    json.loads(done.stdout)


def _all_shown(terminal):
    """What a terminal shows until nobody writes to it any more, which Linux says by an error."""
    shown = b""
    with contextlib.suppress(OSError):
        while part := os.read(terminal, 4096):
            shown += part
    return shown.decode()


def test_a_log_says_what_is_decided_and_how_long_it_takes(spindamp, tmp_path):
    """On standard error or in a file, and for that command alone; what is printed else stays."""
    plain = spindamp("ringdown", "structure", "--json")
    told = spindamp("-v", "--log", "log.txt", "ringdown", "structure", "--json")
    times = re.compile(r'"timings": \{[^}]*\}')
    assert times.sub("", told.out) == times.sub("", plain.out)
    lines, log = told.err, (tmp_path / "log.txt").read_text(encoding="utf-8")
    assert set(lines.splitlines()) < set(log.splitlines())
    for text in (lines, log):
        assert "effect rolling_resistance on: rolling_friction is above 0" in text
        assert re.search(r"damper: \d+\.\d+ s", text)
    assert spindamp("check", "structure", "--json").err == ""
    assert (tmp_path / "log.txt").read_text(encoding="utf-8") == log
    refused(spindamp("--log", tmp_path, "check", "structure"), f"--log {tmp_path}: cannot be written: ")


def test_check_takes_what_it_prints(spindamp, tmp_path, structure):
    """A frequency along each axis comes back as a pair; the scene printed again is the same."""
    scene = changed(structure, structure__frequency=["269.5 Hz", "1400 Hz"])
    first = spindamp("check", scene)
    (tmp_path / "printed.toml").write_text(first.out, encoding="utf-8")
    again = spindamp("check", "printed.toml")
    assert (first.status, again.status) == (0, 0), again.err
    assert "frequency = [269.5, 1400.0]" in first.out
    assert tomllib.loads(again.out) == tomllib.loads(first.out)


def test_an_option_given_twice_is_refused(spindamp):
    """Of which one value would be ignored; flags may be repeated, and so may what takes several values."""
    refused(spindamp("ringdown", "structure", "--rpm", 5000, "--rpm", 6000), "--rpm: given 2 times: expected once")
    refused(spindamp("sweep", "structure", "--out", "a", "--out=b"), "--out: given 2 times: expected once")
    refused(spindamp("--log", "a", "--log", "b", "check", "structure"), "--log: given 2 times: expected once")
    assert spindamp("check", "structure", "--json", "--json").status == 0
    outcome = spindamp("sweep", "structure", "--vary", "damper.friction=a", "--vary", "damper.restitution=0.5")
    assert "given 2 times" not in outcome.err


@pytest.mark.parametrize("module", ["workflows.cli", "spindamp"])
def test_shells_complete_commands(module, tmp_path):
    """What bash asks for when the tab key is pressed behind `spindamp re`; `python -m spindamp` is the command, too."""
    asked = {"_SPINDAMP_COMPLETE": "complete_bash", "COMP_WORDS": "spindamp re", "COMP_CWORD": "1"}
    done = python("-m", module, env=os.environ | asked, cwd=tmp_path)
    assert (done.returncode, done.stdout.split()) == (0, ["response", "reproduce"])


@pytest.fixture
def terminal(monkeypatch):
    """Rich takes the captured stream for a terminal."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")


@pytest.mark.usefixtures("terminal")
def test_counted_work_has_a_time_remaining(capsys):
    with Stages(visible=True) as stages, stages("modes", 1000, done=990) as step:
        for number in range(3):
            step.advance(f"{number} of 1000")
            time.sleep(0.15)
    shown = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", capsys.readouterr().err)
    assert "2 of 1000" in shown
    assert re.search(r"remaining +00:0[0-3]\b", shown), shown


@pytest.mark.usefixtures("terminal")
def test_work_that_is_not_counted_has_none(capsys):
    with Stages(visible=True) as stages, stages("mesh"):
        time.sleep(0.15)
    shown = capsys.readouterr().err
    assert "mesh" in shown
    assert "remaining" not in shown


def test_speeds_are_counted_where_each_is_solved_by_itself():
    plate = fem.Plate(fem.rectangle(0.2, 0.08, 3, 2), 0.003, fem.Material(1e11, 0.3, 7e3))
    operators = fem.assemble(plate, fem.Rotor(0.1, 0.3), fem.Effects(large_deflection=True))
    told = []
    found = fem.campbell(operators, np.array([100.0, 50.0, 200.0]), 2, progress=told.append)
    assert told == [1, 2, 3]
    assert found.omega.size == 3


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="this system has no /proc")
@pytest.mark.parametrize("command", ["run", "effects", "design", "reproduce", "view x.html", "modes x.npz"])
def test_where_nothing_can_be_written_nothing_is_computed(command, spindamp):
    """Not even by one who may write everywhere."""
    name, _, file = command.partition(" ")
    refused(spindamp(name, "--out", f"/proc/{file or 'x'}"), f"--out = '/proc/{file or 'x'}': /proc cannot be written")


def test_memory_where_there_is_no_proc(monkeypatch):
    there = psutil.virtual_memory()
    monkeypatch.setattr(psutil, "virtual_memory", lambda: there)
    monkeypatch.setattr(Path, "read_text", raising(FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))))
    monkeypatch.delattr(os, "sysconf")
    monkeypatch.setitem(sys.modules, "resource", None)
    assert resources.available() == there.available


@pytest.mark.parametrize("encoding", ["cp1252", "ascii"])
def test_output_into_a_file_of_another_encoding(encoding, soon, tmp_path, monkeypatch):
    """Not every letter of ours is in it; what is printed last must not fail a run that is done."""
    write(soon, tmp_path / "scene.toml")
    monkeypatch.chdir(tmp_path)
    for line in ("campbell scene.toml", "check structure", "ringdown structure --json"):
        out = io.BytesIO()
        monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(out, encoding=encoding, errors="strict"))
        assert cli.main(line.split()) == 0, line
    assert out.getvalue().rstrip().endswith(b"}")


def test_output_into_a_file_is_utf_8(monkeypatch):
    """JSON is: whatever letters a console there knows."""
    monkeypatch.setattr(sys, "platform", "win32")
    for asked, encoding in ((None, "utf-8"), ("cp1252", "cp1252")):
        monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="cp1252"))
        if asked:
            monkeypatch.setenv("PYTHONIOENCODING", asked)
        sys.modules["workflows.cli.main"]._open_streams()
        assert (sys.stdout.encoding, sys.stdout.errors) == (encoding, "backslashreplace")


PACKAGES = ("fem", "damper", "workflows")


@pytest.mark.parametrize("package", PACKAGES)
def test_public_names_are_complete(package):
    module = import_module(package)
    tree = ast.parse((ROOT / package / "__init__.py").read_text(encoding="utf-8"))
    offered = {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(package)
        for alias in node.names
    }
    assert list(module.__all__) == sorted(module.__all__)
    assert set(module.__all__) == offered
    for name in module.__all__:
        assert getattr(module, name) is not None
    with pytest.raises(AttributeError):
        module.nonsense  # noqa: B018


def test_what_a_command_does_python_can_call():
    """All but what shows something and returns nothing."""
    functions = {name for name, found in vars(spindamp).items() if isfunction(found) and found.__module__ == "spindamp"}
    assert functions <= set(spindamp.__all__)
    assert {command.__name__ for command in COMMANDS} - functions == {"view", "check"}


HEAVY = "h5netcdf h5py jinja2 llvmlite matplotlib meshio numba pandas pint pyvista rich scipy skfem vtkmodules xarray"

COMMANDS_IN_TURN = """
import sys
import damper, fem, workflows
from workflows.cli.main import main
for line in ("--version", "--help", "check paper", "check paper --json"):
    main(line.split())
def loaded():
    print(f"\\nloaded: {' '.join(sys.modules)}")
loaded()
assert main(["design", "locked.toml", "--out", "out"]) == 3
loaded()
assert main(["ringdown", "structure", "--json"]) == 0
loaded()
"""


def test_commands_load_what_they_need_and_no_more(tmp_path):
    """One after the other in one process.

    Packages and light commands load nothing heavy: what solves, draws and compiles takes longer to load than a check
    of a rectangle takes. A design space that the load locks starts no worker, compiles no kernel and draws no chart
    on its page: a formula answers. A damper alone loads no plate.
    """
    scene = shipped_scene("structure")
    scene["design"] = {"ball_diameter": ["2 mm", "4 mm"], "clearance": ["0.5 mm"], "amplitude": ["1 um", "2 um"]}
    alone = {"release": None, "damper__ball_density": "7850 kg/m^3", "damper__mass_ratio": None, "damper__count": None}
    write(changed(scene, **alone), tmp_path / "locked.toml")
    done = python("-c", COMMANDS_IN_TURN, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    light, design, ringdown = (set(line.split()) for line in done.stdout.splitlines() if line.startswith("loaded: "))
    assert not light & set(HEAVY.split())
    assert not design & {"loky", "matplotlib", "numba", "scipy.sparse", "skfem"}
    assert not ringdown & {"skfem", "matplotlib", "xarray", "pyvista"}
    assert "numba" in ringdown
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "the load holds every ball at rest" in page
    assert "<svg" not in page
