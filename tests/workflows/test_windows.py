"""What Windows does otherwise, simulated: nothing here has been tried there.

Its fsync wants a file opened to write; it opens no folders, locks none, exchanges none; a signal 0 ends a process; it
has other signals; what another program holds open cannot be renamed; its files and pipes are not in UTF-8 by default.
"""

from __future__ import annotations

import errno
import fcntl
import io
import math
import os
import runpy
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import filelock  # noqa: F401
import psutil
import pytest

from tests.workflows.conftest import Outcome
from workflows.errors import BadInput
from workflows.output import folder as folders
from workflows.output import folder as store
from workflows.output import signals
from workflows.solve import resources

pytestmark = pytest.mark.usefixtures("undrawn")


def _publish(folder: Path, text: str) -> None:
    with store.replacing(folder) as scratch:
        (scratch / "results.json").write_text(text, encoding="utf-8")


def _found(folder: Path) -> str:
    return (folder / "results.json").read_text(encoding="utf-8")


@pytest.fixture
def windows(monkeypatch: pytest.MonkeyPatch) -> None:
    """The system calls as they are there."""
    monkeypatch.setattr(folders, "WINDOWS", True)
    monkeypatch.setattr(folders, "exchange", lambda one, other: False)
    monkeypatch.setitem(sys.modules, "fcntl", None)  # filelock has seen it already
    monkeypatch.delattr(os, "chown")
    monkeypatch.setattr(shutil, "_use_fd_functions", False)
    opened, synced = os.open, os.fsync

    def open_(path: str | Path, flags: int, *more: int, **named: int) -> int:
        if os.path.isdir(path):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        return opened(path, flags, *more, **named)

    def fsync(handle: int) -> None:
        if fcntl.fcntl(handle, fcntl.F_GETFL) & os.O_ACCMODE == os.O_RDONLY:
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        synced(handle)

    def kill(process: int, number: int) -> None:
        raise AssertionError("0 is CTRL_C_EVENT")

    monkeypatch.setattr(os, "open", open_)
    monkeypatch.setattr(os, "fsync", fsync)
    monkeypatch.setattr(os, "kill", kill)
    monkeypatch.setattr(psutil, "pid_exists", lambda process: process == os.getpid())


@pytest.mark.usefixtures("windows")
def test_results_are_replaced(tmp_path: Path) -> None:
    out = tmp_path / "out"
    for text in ("old", "new"):
        _publish(out, text)
        assert _found(out) == text
    assert [path.name for path in tmp_path.iterdir() if path.name != folders.LOCK] == ["out"]


@pytest.mark.usefixtures("windows")
def test_what_killed_runs_left_is_told_from_what_others_write(tmp_path: Path) -> None:
    """Whether a process lives is asked, without a signal to it."""
    out = tmp_path / "out"
    dead, alive = (tmp_path / f"{store._prefix(out)}{number}-abc" for number in (os.getpid() + 1, os.getpid()))
    dead.mkdir()
    alive.mkdir()
    _publish(out, "new")
    assert not dead.exists()
    assert alive.exists()


def test_processes_here() -> None:
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    assert store._alive(os.getpid())
    assert not store._alive(ended.pid)


@pytest.mark.usefixtures("windows")
def test_a_new_folder_inherits_its_permissions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """mkdtemp shuts all others out there, for good, and chmod makes a folder that cannot be removed."""

    def refused(*_: object, **__: object) -> None:
        raise AssertionError("not on Windows")

    monkeypatch.setattr(tempfile, "mkdtemp", refused)
    monkeypatch.setattr(Path, "chmod", refused)
    _publish(tmp_path / "out", "old")
    _publish(tmp_path / "out", "new")
    assert _found(tmp_path / "out") == "new"


class InUse:
    """Renaming as it is while a virus scanner or a spreadsheet has a file of a folder open."""

    def __init__(self, name: str, times: float) -> None:
        self.name, self.times, self.rename = name, times, os.rename

    def __call__(self, old: str | Path, new: str | Path) -> None:
        if Path(old).match(self.name) and self.times > 0:
            self.times -= 1
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        self.rename(old, new)


@pytest.mark.usefixtures("windows")
def test_a_folder_in_use_for_a_moment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "out"
    _publish(out, "old")
    slept: list[float] = []
    monkeypatch.setattr(folders.time, "sleep", slept.append)
    for name, text in (("out", "new"), (".out.*", "newer")):
        monkeypatch.setattr(os, "rename", InUse(name, 2))
        _publish(out, text)
        assert _found(out) == text
    monkeypatch.setattr(os, "rename", InUse(".other.*", 2))
    _publish(tmp_path / "other", "first")
    assert _found(tmp_path / "other") == "first"
    assert len(slept) == 6
    assert 0 < sum(slept) < 2


@pytest.mark.usefixtures("windows")
def test_a_folder_in_use_costs_no_results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What took hours to compute is put beside, whole, and the message says where."""
    out = tmp_path / "out"
    _publish(out, "old")
    (tmp_path / "out-1").mkdir()
    monkeypatch.setattr(folders.time, "sleep", lambda _: None)
    monkeypatch.setattr(os, "rename", InUse("out", math.inf))
    with pytest.raises(BadInput, match=r"another program.*the new results are in .*out-2$") as caught:
        _publish(out, "new")
    assert caught.value.key == "--out"
    assert (_found(out), _found(tmp_path / "out-2")) == ("old", "new")
    names = {path.name for path in tmp_path.iterdir()} - {folders.LOCK}
    assert names == {"out", "out-1", "out-2"}
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInput, match=r"the new results are in out-3$"):
        _publish(Path("out"), "newest")


@pytest.mark.parametrize("name", ["a:b", "what?", "deep/more*/out", 'say "this"', "dot.", "blank "])
def test_names_that_no_folder_can_have(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They are refused before the work, not after it."""
    monkeypatch.setattr(folders, "WINDOWS", True)
    with pytest.raises(BadInput, match=r"--out.*cannot be a folder"):
        store.check(tmp_path / name)
    store.check(tmp_path / "a name, in which (nearly) all goes")


def test_no_file_of_a_run_is_still_open_when_it_takes_its_place(
    spindamp: Callable[..., Outcome], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file held open there keeps its folder where it is."""
    swap, held = folders.swap, []

    def watched(scratch: Path, target: Path) -> None:
        held.extend(f.path for f in psutil.Process().open_files() if Path(f.path).is_relative_to(scratch))
        swap(scratch, target)

    monkeypatch.setattr(folders, "swap", watched)
    assert spindamp("run", "structure", "--out", "out").status == 0
    assert spindamp("campbell", "paper", "--out", "out").status == 0
    assert held == []


WRITERS = """
import sys
import filelock
from pathlib import Path
sys.modules["fcntl"] = None
from workflows.output import folder as folders
from workflows.output import folder as store
folders.exchange = lambda one, other: False
me = sys.argv[2]
for turn in range(25):
    with store.replacing(Path(sys.argv[1])) as scratch:
        (scratch / "results.json").write_text(me)
        (scratch / f"only_{me}_{turn}.csv").write_text(me)
"""


def test_many_writers_without_locks_on_folders(tmp_path: Path) -> None:
    out = tmp_path / "place" / "out"
    writers = [subprocess.Popen([sys.executable, "-c", WRITERS, str(out), name]) for name in "abc"]
    assert [writer.wait(120) for writer in writers] == [0, 0, 0]
    names = {path.name for path in out.iterdir()}
    assert names == {"results.json", store.MANIFEST, f"only_{_found(out)}_24.csv"}
    assert {path.name for path in out.parent.iterdir()} - {folders.LOCK} == {"out"}


def test_signals_that_are_not_there(spindamp: Callable[..., Outcome], monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("SIGHUP", "SIGPIPE", "SIGKILL"):
        monkeypatch.delattr(signal, name)
    assert spindamp("check", "paper").status == 0


def test_a_signal_that_is_only_there(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-Break ends a run as Ctrl-C does."""
    monkeypatch.setattr(signal, "SIGBREAK", signal.SIGUSR2, raising=False)
    with pytest.raises(signals.Terminated), signals.heard(to_the_end=False):
        signal.raise_signal(signal.SIGUSR2)
    assert signal.getsignal(signal.SIGUSR2) == signal.SIG_DFL


def test_memory_where_there_is_no_proc(monkeypatch: pytest.MonkeyPatch) -> None:
    there = psutil.virtual_memory()
    monkeypatch.setattr(psutil, "virtual_memory", lambda: there)

    def missing(*_: object, **__: object) -> str:
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))

    monkeypatch.setattr(Path, "read_text", missing)
    monkeypatch.delattr(os, "sysconf")
    monkeypatch.setitem(sys.modules, "resource", None)
    assert resources.available() == there.available


@pytest.mark.parametrize("encoding", ["cp1252", "ascii"])
def test_output_into_a_file_of_another_encoding(encoding: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not every letter of ours is in it; what is printed last must not fail a run that is done."""
    from workflows import cli

    for line in ("campbell paper", "check structure", "ringdown structure --json"):
        out = io.BytesIO()
        monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(out, encoding=encoding, errors="strict"))
        assert cli.main(line.split()) == 0, line
    assert out.getvalue().rstrip().endswith(b"}")


def test_output_into_a_file_is_utf_8(monkeypatch: pytest.MonkeyPatch) -> None:
    """JSON is: whatever letters a console there knows."""

    for asked, encoding in ((None, "utf-8"), ("cp1252", "cp1252")):
        monkeypatch.setattr(sys, "platform", "win32")
        monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="cp1252"))
        if asked:
            monkeypatch.setenv("PYTHONIOENCODING", asked)
        sys.modules["workflows.cli.main"]._open_streams()
        assert sys.stdout.encoding == encoding
        assert sys.stdout.errors == "backslashreplace"


def test_the_command_that_go_py_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """A program that is named with its folder is not looked for under its name with .exe there."""
    go = SimpleNamespace(**runpy.run_path(str(Path(__file__).parents[2] / "go.py")))
    assert go.program("spindamp").name == "spindamp"
    monkeypatch.setattr(os, "name", "nt")
    assert go.program("spindamp").name == "spindamp.exe"


TWICE = """
from workflows import cli
from workflows.report import figures
assert cli.main(["run", "structure", "--out", "out"]) == 0
figures.report = lambda _: dict.fromkeys(figures.SHOWN, "")  # as it was
assert cli.main(["run", "structure", "--out", "out"]) == 0
"""


def test_every_text_file_says_its_encoding(tmp_path: Path) -> None:
    """A file name, a title or a reason may hold letters that the system's own encoding has not."""
    environment = os.environ | {"PYTHONWARNDEFAULTENCODING": "1", "PYTHONWARNINGS": "always::EncodingWarning"}
    done = subprocess.run(
        [sys.executable, "-c", TWICE], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    ours = [line for line in done.stderr.splitlines() if "EncodingWarning" in line and "site-packages" not in line]
    assert not ours
