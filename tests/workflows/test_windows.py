"""Systems without what Linux has: some signals, /proc, UTF-8 as the encoding of files and pipes."""

from __future__ import annotations

import errno
import io
import os
import runpy
import signal
import sys
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest

from tests.workflows.conftest import Command, python
from workflows.solve import resources

pytestmark = pytest.mark.usefixtures("undrawn")


def test_signals_that_are_not_there(spindamp: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("SIGHUP", "SIGPIPE", "SIGKILL", "SIGALRM", "setitimer"):
        monkeypatch.delattr(signal, name)
    assert spindamp("check", "paper").status == 0


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
    done = python("-c", TWICE, cwd=tmp_path, env=environment)
    assert done.returncode == 0, done.stderr
    ours = [line for line in done.stderr.splitlines() if "EncodingWarning" in line and "site-packages" not in line]
    assert not ours
