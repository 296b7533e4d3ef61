"""A folder of results is replaced whole or not at all, however a run ends: killed, interrupted, out of room."""

import os
import re
import resource
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

import workflows
from tests.limits import HANG
from tests.workflows.conftest import python, raising, refused
from workflows.errors import BadInput
from workflows.io import files, folder
from workflows.io.folder import MANIFEST, Terminated, _prefix, check
from workflows.scene.load import SHIPPED


@pytest.fixture
def endless(tmp_path):
    """A scene whose ring-down takes longer than anyone waits."""
    scene = tmp_path / "endless.toml"
    text = (SHIPPED / "structure.toml").read_text(encoding="utf-8")
    scene.write_text(text.replace("cycles = 20", "cycles = 2000000"), encoding="utf-8")
    return scene


def skip_where_ignored(number):
    if signal.getsignal(number) is signal.SIG_IGN:
        pytest.skip("ignored here, as below nohup and in the background, and so by what is started here")


def ended():
    """The number of a process that is gone."""
    process = subprocess.Popen([sys.executable, "-S", "-c", ""])
    process.wait(HANG)
    return process.pid


@pytest.mark.parametrize(("number", "status", "after"), [(signal.SIGHUP, 129, 0.35), (signal.SIGINT, 130, 2.0)])
def test_signals(number, status, after, endless, tmp_path):
    skip_where_ignored(number)
    command = [sys.executable, "-m", "workflows.cli", "ringdown", endless, "--out", "out"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=tmp_path) as process:
        time.sleep(after)
        process.send_signal(number)
        out, err = process.communicate(timeout=HANG)
    # Interrupted inside exec(), Python ends by the signal itself; a shell shows both as 130.
    assert process.returncode in (status, -number)
    assert out == b""
    if after > 1 or err:
        assert err.decode().endswith("no partial files are left; the same command starts over\n")
        assert len(err.splitlines()) == 1
    assert list(tmp_path.iterdir()) == [endless]


@pytest.mark.parametrize("where", ["cli.commands.app", "pipeline.structure", "report.page.publish"])
@pytest.mark.parametrize(
    ("error", "status"), [(KeyboardInterrupt(), 130), (Terminated("SIGTERM"), 143), (MemoryError(), 2)]
)
def test_wherever_it_happens(where, error, status, spindamp, monkeypatch, tmp_path):
    monkeypatch.setattr(f"workflows.{where}", raising(error))
    said = refused(spindamp("run", "structure", "--out", "out"), "", status=status)
    assert ("no partial files" in said) == (status != 2)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("number", "status", "says"),
    [(signal.SIGINT, 130, "stopped; no partial"), (signal.SIGTERM, 143, "ended by SIGTERM; no partial files are left")],
)
def test_an_error_that_a_signal_left_behind(number, status, says, spindamp, monkeypatch):
    """What a handler raises within a lock may end as an error of the lock."""
    skip_where_ignored(number)

    def unlucky(*_, **__):
        try:
            signal.raise_signal(number)
        except BaseException:
            raise RuntimeError("release unlocked lock") from None

    monkeypatch.setattr("workflows.cli.commands.app", unlucky)
    refused(spindamp("run", "structure"), "", says, status)


def test_signals_are_given_back(spindamp):
    before = signal.getsignal(signal.SIGTERM)
    assert spindamp("check", "paper").status == 0
    assert signal.getsignal(signal.SIGTERM) is before


def test_a_run_is_deaf_to_what_nohup_silenced(tmp_path):
    code = (
        "import os, signal, sys\nfrom workflows import cli\n"
        "signal.signal(signal.SIGHUP, signal.SIG_IGN)\n"
        "import workflows.io.provenance as r\nold = r.as_toml\n"
        "def hang_up(*a):\n    os.kill(os.getpid(), signal.SIGHUP)\n    return old(*a)\n"
        "r.as_toml = hang_up\nsys.exit(cli.main(['check', 'paper']))"
    )
    assert python("-c", code).returncode == 0


PUBLISHED = """
import atexit, os, signal, sys
from workflows import cli
from workflows.report import figures, text as summary
figures.report = lambda _: dict.fromkeys(figures.SHOWN, "")
before = summary.text
def both():
    for number in (signal.SIGINT, signal.SIGTERM):
        os.kill(os.getpid(), number)
def again(*given):
    both()
    return before(*given)
summary.text = again
atexit.register(both)
sys.exit(cli.main())
"""


def test_signals_after_the_results_are_in_place(tmp_path):
    """The run is done, whatever arrives while it says so and while Python ends."""
    done = python("-c", PUBLISHED, "run", "structure", "--out", "out", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.endswith("open out/report.html\n")


LOSING = """
import atexit, os, signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where the tests run in the background
from workflows import cli
import workflows.solve.damper as stage
looked_up, me = stage._look_up, os.getpid()
class Last:
    def __del__(self):
        os.kill(me, signal.SIGINT)
def in_a_finaliser():
    Last()
def in_a_library():
    try:
        os.kill(me, signal.SIGTERM)
        time.sleep(1)
    except BaseException:
        pass
def meanwhile(act):
    stage._look_up = lambda *given: (act(), looked_up(*given))[1]
for lose in (in_a_finaliser, in_a_library):
    meanwhile(lose)
    print(cli.main(sys.argv[1:]))
atexit.register(os.kill, me, signal.SIGINT)
meanwhile(lambda: os.kill(me, signal.SIGTERM))
sys.exit(cli.main())
"""


def test_signals_that_are_lost_or_come_twice(endless, tmp_path):
    """What a handler raises goes nowhere while an object is given up, or where a library passes over everything.

    Such a signal comes again; a second one, while Python ends, does not garble the end.
    """
    done = python("-c", LOSING, "ringdown", endless, "--out", "out", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (143, "130\n143\n"), done.stderr
    rest = "no partial files are left; the same command starts over"
    ends = ["stopped", "ended by SIGTERM", "ended by SIGTERM"]
    assert done.stderr.splitlines() == [f"spindamp: {end}; {rest}" for end in ends]
    assert list(tmp_path.iterdir()) == [endless]


@pytest.mark.usefixtures("undrawn")
def test_no_room_left(tmp_path, monkeypatch):
    """At sizes at which one after the other of the files that a run writes no longer fits: the old ones stay."""
    monkeypatch.chdir(tmp_path)
    results = workflows.run("structure")
    workflows.save(results, "out")
    there = {path: path.read_bytes() for path in Path("out").iterdir()}
    room = resource.getrlimit(resource.RLIMIT_FSIZE)
    for most in (0, 3000, 9000, 60000):
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, room[1]))
        try:
            with pytest.raises(BadInput, match=r"^folder = 'out': cannot be written: File too large$"):
                workflows.save(results, "out")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, room)
        assert {path: path.read_bytes() for path in Path("out").iterdir()} == there
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_many_writers_at_once(tmp_path):
    """Without the lock, one run takes another's files for the user's and carries them over."""
    code = """
import sys
from pathlib import Path
from workflows.io import folder as store
me = sys.argv[2]
for turn in range(40):
    with store.replacing(Path(sys.argv[1])) as scratch:
        (scratch / "results.json").write_text(me)
        (scratch / f"only_{me}_{turn}.csv").write_text(me)
"""
    out = tmp_path / "place" / "out"
    writers = [subprocess.Popen([sys.executable, "-c", code, str(out), name]) for name in "abc"]
    assert [writer.wait(HANG) for writer in writers] == [0, 0, 0]
    me = (out / "results.json").read_text()
    assert _content(out) == dict.fromkeys(("results.json", f"only_{me}_39.csv"), me)
    assert list(out.parent.iterdir()) == [out]


def test_killed_between_the_two_steps_of_a_swap(tmp_path, monkeypatch):
    """Where a system cannot exchange two folders in one step, the next run brings the old results back first."""
    out, dead = tmp_path / "out", ended()
    aside = tmp_path / f"{_prefix(out)}{dead}-abc{folder.ASIDE}"
    aside.mkdir()
    (aside / "results.json").write_text("old")
    (aside / folder.MANIFEST).write_text("results.json\n")
    (tmp_path / f"{_prefix(out)}{dead}-abc").mkdir()
    with pytest.raises(RuntimeError, match="broke"), folder.replacing(out):
        raise RuntimeError("broke")
    assert (out / "results.json").read_text() == "old"
    assert list(tmp_path.iterdir()) == [out]


@pytest.mark.parametrize(
    ("command", "closed"),
    [("check structure", closed) for closed in (">&- 2>&-", "| true", "> /dev/full")]
    + [("ringdown structure --json", "| head -c 1 >/dev/null")],
)
def test_closed_streams(command, closed, tmp_path):
    line = f"{sys.executable} -m workflows.cli {command} {closed}"
    done = subprocess.run(line, shell=True, capture_output=True, text=True, check=False, cwd=tmp_path, timeout=HANG)
    assert "Traceback" not in done.stderr
    assert "defect" not in done.stderr
    assert done.stderr == ("spindamp: cannot write or read: No space left on device\n" if "full" in closed else "")
    assert done.returncode == (2 if "full" in closed else 0)


@pytest.mark.parametrize("name", ["x" * 250, "ä" * 120])
def test_names_as_long_as_they_may_be(name, tmp_path):
    for _ in range(2):
        _publish(tmp_path / name, "new", "results.json")
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_no_room_for_the_message(tmp_path):
    for command in ("check nowhere.toml", "run --foo"):
        line = f"{sys.executable} -m workflows.cli {command} 2>/dev/full"
        assert subprocess.run(line, shell=True, cwd=tmp_path, check=False, timeout=HANG).returncode == 2


def _fill(place, text, *names):
    for name in names:
        (place / name).write_text(text)


def _publish(place, text, *names):
    with folder.replacing(place) as scratch:
        _fill(scratch, text, *names)


def _content(place):
    return {path.name: path.read_text() for path in place.iterdir() if path.name != MANIFEST}


@pytest.mark.parametrize("at_once", [True, False])
def test_new_results_replace_old_ones(at_once, tmp_path, monkeypatch):
    """In one step, or where a system cannot exchange two folders so."""
    if not at_once:
        monkeypatch.setattr(folder, "exchange", lambda one, other: False)
    out = tmp_path / "deep" / "out"
    _publish(out, "old", "results.json", "old.csv")
    _publish(out, "new", "results.json", "new.csv")
    assert _content(out) == {"results.json": "new", "new.csv": "new"}
    assert list(out.parent.iterdir()) == [out]


def test_files_of_the_user_stay(tmp_path):
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
def test_permissions_of_a_folder_stay(mode, tmp_path):
    out = tmp_path / "out"
    _publish(out, "old", "results.json")
    out.chmod(mode)
    _publish(out, "new", "results.json")
    assert stat.S_IMODE(out.stat().st_mode) == mode
    assert _content(out) == {"results.json": "new"}


def test_permissions_of_a_new_folder(tmp_path):
    before = os.umask(0o027)
    try:
        _publish(tmp_path / "out", "new", "results.json")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "out").stat().st_mode) == 0o750


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives a folder away")
def test_the_owner_of_a_folder_stays(tmp_path):
    out = tmp_path / "out"
    out.mkdir(mode=0o700)
    os.chown(out, 12345, 23456)
    _publish(out, "new", "results.json")
    found = out.stat()
    assert (found.st_uid, found.st_gid, stat.S_IMODE(found.st_mode)) == (12345, 23456, 0o700)


def test_two_runs_in_one_folder(tmp_path):
    out = tmp_path / "out"
    with folder.replacing(out) as first:
        _fill(first, "first", "results.json")
        _publish(out, "second", "results.json")
    assert _content(out) == {"results.json": "first"}
    assert list(tmp_path.iterdir()) == [out]


def test_places_that_cannot_be(tmp_path, monkeypatch):
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


def test_a_link_to_a_folder_stays_a_link(tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    _publish(tmp_path / "link", "new", "results.json")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real" / "results.json").read_text() == "new"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_without_permission(tmp_path):
    tmp_path.chmod(0o555)
    try:
        with pytest.raises(BadInput, match="cannot be written"):
            check(tmp_path / "out")
    finally:
        tmp_path.chmod(0o755)


def test_a_read_only_folder_is_not_replaced(tmp_path, monkeypatch):
    """It was, and what it had held stayed beside it under a hidden name."""
    (tmp_path / "out").mkdir()
    check(tmp_path / "out")
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path).name != "out")  # root may write anywhere
    with pytest.raises(BadInput, match="is read-only"):
        check(tmp_path / "out")


def test_a_scene_among_results_is_not_replaced_by_its_own(tmp_path):
    """`best.toml` of a design, with what the user changed in it, was gone after a run into the same folder."""
    out = tmp_path / "out"
    _publish(out, "# best", "best.toml")
    scene = str(out / "best.toml")
    with pytest.raises(BadInput, match=r"holds best.toml, the scene of this run"):
        check(out, "", scene)
    check(tmp_path / "other", "", scene)
    (out / "own.toml").write_text("")
    check(out, "", str(out / "own.toml"))


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
def test_killed_while_writing(tmp_path, with_what):
    skip_where_ignored(with_what)
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


def test_what_another_run_writes_stays(tmp_path):
    """Only what processes that are gone have left is removed."""
    out = tmp_path / "out"
    alive, dead = (tmp_path / f"{_prefix(out)}{number}-abc" for number in (os.getpid(), ended()))
    alive.mkdir()
    dead.mkdir()
    _publish(out, "new", "results.json")
    assert alive.exists()
    assert not dead.exists()


def test_a_users_own_report_is_not_overwritten(tmp_path):
    """A folder that no run wrote is the user's, even where a file has the name of one of ours."""
    out = tmp_path / "out"
    out.mkdir()
    _fill(out, "mine", "report.html")
    with pytest.raises(BadInput, match=r"report\.html that no run wrote"):
        _publish(out, "new", "results.json", "report.html")
    assert _content(out) == {"report.html": "mine"}


NAMES = {"campbell": "campbell_flap_1.csv", "run": "velocity_x_10000rpm.csv", "ringdown": "sdc_12.5rpm.csv"}
NAMES |= {"accuracy": "accuracy.svg", "effects": "effects.json", "reproduce": "closure.csv"}


@pytest.mark.parametrize("command", NAMES)
def test_a_users_own_file_is_seen_before_the_work(command, spindamp, tmp_path, monkeypatch):
    studies = ("work_precision.study.study", "work_precision.effects.effect_study", "reproduction.reproduce")
    for work in ("pipeline.structure", *(f"studies.{name}" for name in studies)):
        monkeypatch.setattr(f"workflows.{work}", lambda *_, **__: pytest.fail("work has begun"))
    (tmp_path / "out").mkdir()
    _fill(tmp_path / "out", "mine", "campbell.md", NAMES[command])
    refused(spindamp(command, "--out", "out"), "", f"holds a {NAMES[command]} that no run wrote")


def test_every_curve_has_a_name_that_is_looked_for(finished):
    found = [path.name for path in finished.glob("*.csv")]
    assert len(found) > 8
    assert all(re.fullmatch(files.FILES, name) for name in found)
