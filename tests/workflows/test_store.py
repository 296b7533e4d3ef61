"""A folder of results is replaced whole or not at all."""

from __future__ import annotations

import os
import re
import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from tests.limits import HANG
from tests.workflows.conftest import Command, refused
from workflows.errors import BadInput
from workflows.io import files
from workflows.io import folder as folders
from workflows.io.folder import MANIFEST, _prefix, check, replacing


def _fill(folder: Path, text: str, *names: str) -> None:
    for name in names:
        (folder / name).write_text(text)


def _publish(folder: Path, text: str, *names: str) -> None:
    with replacing(folder) as scratch:
        _fill(scratch, text, *names)


def _publish_and_raise(folder: Path, error: Exception) -> None:
    with replacing(folder) as scratch:
        _fill(scratch, "half", "results.json")
        raise error


def _content(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir() if path.name != MANIFEST}


def test_new_results_replace_old_ones(tmp_path: Path) -> None:
    out = tmp_path / "deep" / "out"
    _publish(out, "old", "results.json", "old.csv")
    _publish(out, "new", "results.json", "new.csv")
    assert _content(out) == {"results.json": "new", "new.csv": "new"}
    assert list(out.parent.iterdir()) == [out]


def test_a_failure_leaves_the_old_results(tmp_path: Path) -> None:
    out = tmp_path / "out"
    _publish(out, "old", "results.json")
    with pytest.raises(RuntimeError, match="broke"):
        _publish_and_raise(out, RuntimeError("broke"))
    assert _content(out) == {"results.json": "old"}
    assert list(tmp_path.iterdir()) == [out]


def test_files_of_the_user_stay(tmp_path: Path) -> None:
    out = tmp_path / "out"
    _publish(out, "old", "results.json", "sdc.csv")
    _fill(out, "mine", "notes.md", "measured.csv")
    (out / "photos").mkdir()
    _fill(out / "photos", "mine", "one.jpg")
    (out / "link").symlink_to("notes.md")
    _publish(out, "new", "results.json")
    assert (out / "photos" / "one.jpg").read_text() == "mine"
    assert (out / "link").readlink() == Path("notes.md")
    assert (out / "notes.md").read_text() == "mine"
    assert (out / "measured.csv").read_text() == "mine"
    assert (out / "results.json").read_text() == "new"
    assert not (out / "sdc.csv").exists()


@pytest.mark.parametrize("mode", [0o700, 0o2775, 0o555])
def test_permissions_of_a_folder_stay(mode: int, tmp_path: Path) -> None:
    out = tmp_path / "out"
    _publish(out, "old", "results.json")
    out.chmod(mode)
    _publish(out, "new", "results.json")
    assert stat.S_IMODE(out.stat().st_mode) == mode
    assert _content(out) == {"results.json": "new"}


def test_permissions_of_a_new_folder(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        _publish(tmp_path / "out", "new", "results.json")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "out").stat().st_mode) == 0o750


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives a folder away")
def test_the_owner_of_a_folder_stays(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir(mode=0o700)
    os.chown(out, 12345, 23456)
    _publish(out, "new", "results.json")
    found = out.stat()
    assert (found.st_uid, found.st_gid, stat.S_IMODE(found.st_mode)) == (12345, 23456, 0o700)


def test_without_an_atomic_exchange(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(folders, "exchange", lambda one, other: False)
    out = tmp_path / "out"
    _publish(out, "old", "results.json")
    _publish(out, "new", "results.json")
    assert _content(out) == {"results.json": "new"}
    assert list(tmp_path.iterdir()) == [out]


def test_two_runs_in_one_folder(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with replacing(out) as first:
        _fill(first, "first", "results.json")
        _publish(out, "second", "results.json")
    assert _content(out) == {"results.json": "first"}
    assert list(tmp_path.iterdir()) == [out]


def test_places_that_cannot_be(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    Path("loop").symlink_to("loop")
    taken = (tmp_path / "file", tmp_path / "file" / "below", Path(), Path(".."), Path("/"))
    for place in (*taken, "x" * 300, "a/" + "x" * 300, "/dev/null", "/dev/null/out", "loop", "nul\0"):
        with pytest.raises(BadInput, match="--out"):
            check(Path(place))
    assert (tmp_path / "file").read_text() == "mine"
    assert list(Path().iterdir()) == [Path("loop")]


def test_a_link_to_a_folder_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    _publish(tmp_path / "link", "new", "results.json")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real" / "results.json").read_text() == "new"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_without_permission(tmp_path: Path) -> None:
    tmp_path.chmod(0o555)
    try:
        with pytest.raises(BadInput, match="cannot be written"):
            check(tmp_path / "out")
    finally:
        tmp_path.chmod(0o755)


WRITER = """
import sys, time
from pathlib import Path
from workflows.io.folder import replacing
with replacing(Path(sys.argv[1])) as scratch:
    (scratch / "results.json").write_text("half")
    print("writing", flush=True)
    time.sleep(60)
"""


@pytest.mark.parametrize("with_what", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_killed_while_writing(tmp_path: Path, with_what: signal.Signals) -> None:
    if signal.getsignal(with_what) is signal.SIG_IGN:
        pytest.skip("ignored here, as below nohup and in the background")
    out = tmp_path / "out"
    _publish(out, "old", "results.json")
    with subprocess.Popen(
        [sys.executable, "-c", WRITER, str(out)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as process:
        assert process.stdout.readline() == b"writing\n"
        process.send_signal(with_what)
        process.wait(HANG)
    assert _content(out) == {"results.json": "old"}
    _publish(out, "new", "results.json")
    assert _content(out) == {"results.json": "new"}
    assert list(tmp_path.iterdir()) == [out]


def test_what_another_run_writes_stays(tmp_path: Path) -> None:
    """Only what processes that are gone have left is removed."""
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait(HANG)
    out = tmp_path / "out"
    alive, dead = (tmp_path / f"{_prefix(out)}{number}-abc" for number in (os.getpid(), ended.pid))
    alive.mkdir()
    dead.mkdir()
    _publish(out, "new", "results.json")
    assert alive.exists()
    assert not dead.exists()


def test_a_users_own_report_is_not_overwritten(tmp_path: Path) -> None:
    """A folder that no run wrote is the user's, even where a file has the name of one of ours."""
    out = tmp_path / "out"
    out.mkdir()
    _fill(out, "mine", "report.html")
    with pytest.raises(BadInput, match=r"report\.html that no run of ours wrote"):
        _publish(out, "new", "results.json", "report.html")
    assert _content(out) == {"report.html": "mine"}


NAMES = {"campbell": "campbell_flap_1.csv", "run": "velocity_x_10000rpm.csv", "ringdown": "sdc_12.5rpm.csv"}
NAMES |= {"accuracy": "accuracy.svg", "effects": "effects.json", "reproduce": "closure.csv"}


@pytest.mark.parametrize("command", NAMES)
def test_a_users_own_file_is_seen_before_the_work(
    command: str, spindamp: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def begun(*_: object, **__: object) -> None:
        raise AssertionError("work has begun")

    for work in (
        "pipeline.structure",
        "studies.work_precision.study.study",
        "studies.work_precision.effects.switching",
        "studies.reproduction.reproduce",
    ):
        monkeypatch.setattr(f"workflows.{work}", begun)
    (tmp_path / "out").mkdir()
    _fill(tmp_path / "out", "mine", "campbell.md", NAMES[command])
    refused(spindamp(command, "--out", "out"), "", f"holds a {NAMES[command]} that no run of ours wrote")


def test_every_curve_has_a_name_that_is_looked_for(finished: Path) -> None:
    found = [path.name for path in finished.glob("*.csv")]
    assert len(found) > 8
    assert all(re.fullmatch(files.FILES, name) for name in found)
