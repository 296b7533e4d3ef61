"""A study ends as if undisturbed, whatever happens on the way, or refuses."""

import errno
import os
import shutil
import time
import warnings
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from threading import Barrier

import pytest
import xarray as xr
import zarr

from tests.workflows.conftest import MESHES, QUIET, changed, on_mesh, python, write
from workflows.errors import BadInput
from workflows.io import folder
from workflows.scene.load import load
from workflows.studies.sweep import evaluate, executor, store, study
from workflows.studies.sweep.executor import external

VARY = {"damper.friction": [0.1, 0.2, 0.4], "damper.restitution": [0.3, 0.6]}


BLOCKS = 3
"""Of at most three points, one dimension whole; each is one part."""

COORDINATES, ARRAYS = 4, len(evaluate.QUANTITIES) + 2
"""Writings before the first block, and those of each block."""


COMPUTED = {}
"""The rows of each region of the one study here, which are computed once for all tests."""


class Here(Executor):
    """Computes when it is asked, and does badly when it is told to: the nth tasks die."""

    def __init__(self, dies=(), stops=None):
        self.count, self.dies, self.stops = 0, dies, stops

    def submit(self, task, region):
        self.count += 1
        future = Future()
        if self.count == self.stops:
            raise KeyboardInterrupt
        if self.count in self.dies:
            future.set_exception(BrokenExecutor("killed"))
        else:
            place = region.begin, region.end
            if place not in COMPUTED:
                COMPUTED[place] = task(region)
            future.set_result(COMPUTED[place])
        return future


def finished(out):
    """Points that are done."""
    with xr.open_zarr(out / store.DATA) as data:
        return int(data[store.DONE].sum())


def in_blocks(patch, least=3, parts=BLOCKS):
    """Regions of at most so many points, in at most so many parts."""
    patch.setattr(study, "LEAST", least)
    patch.setattr(study, "PARTS", parts)


@pytest.fixture(autouse=True)
def _small_blocks(monkeypatch):
    in_blocks(monkeypatch)


@pytest.fixture(scope="module")
def asked():
    return study.of_scene("structure", VARY, quick=True)


def complete(asked, out, executor=None, size=2):
    study.complete(asked, out, external(executor or Here(), size), QUIET)
    return contents(out)


def contents(out):
    return {
        path.relative_to(out).as_posix(): path.read_bytes()
        for path in sorted(Path(out).rglob("*"))
        if path.is_file() and path.name != store.LOCK
    }


def test_a_study_without_a_point_gives_way_to_another(tmp_path, asked):
    """Its workers could not be reached, say; another study in that folder was refused for ever."""

    @contextmanager
    def unreachable():
        raise BadInput("no scheduler answers there", key="--dask")
        yield

    out = tmp_path / "out"
    with pytest.raises(BadInput, match="no scheduler"):
        study.complete(asked, out, unreachable(), QUIET)
    other = study.of_scene("structure", ["damper.restitution=0.2,0.3"], quick=True)
    complete(other, out)
    assert finished(out) == 2
    with pytest.raises(BadInput, match="differs in its"):
        complete(asked, out)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of a study that nothing disturbed."""
    out = tmp_path_factory.mktemp("study") / "out"
    with pytest.MonkeyPatch.context() as patch:
        in_blocks(patch)
        complete(study.of_scene("structure", VARY, quick=True), out)
    return out


@pytest.fixture(scope="module")
def undisturbed(whole):
    return contents(whole)


@pytest.fixture(scope="module")
def in_parts(tmp_path_factory):
    """The contents of a study of one region in parts of one point."""
    with pytest.MonkeyPatch.context() as patch:
        in_blocks(patch, 256, 64)
        return complete(study.of_scene("structure", VARY, quick=True), tmp_path_factory.mktemp("parts") / "out")


@pytest.fixture
def out(whole, tmp_path):
    """A copy of it."""
    return Path(shutil.copytree(whole, tmp_path / "out"))


def test_the_order_of_the_work_is_not_seen(asked, undisturbed, tmp_path):
    COMPUTED.clear()
    assert complete(asked, tmp_path / "out", size=7) == undisturbed
    assert len([name for name in undisturbed if name.startswith("sweep.zarr/done/c/")]) == BLOCKS


@contextmanager
def stopping(monkeypatch, calls):
    """What is inside is stopped, at the latest after so many writings of an array."""
    left, real = iter(range(calls)), zarr.Array.__setitem__

    def stopped(*arguments):
        if next(left, None) is None:
            raise KeyboardInterrupt
        return real(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(zarr.Array, "__setitem__", stopped)
        with pytest.raises(KeyboardInterrupt):
            yield


@pytest.mark.parametrize("call", [0, COORDINATES + ARRAYS - 1, COORDINATES + ARRAYS])
def test_stopped_while_a_block_is_written(asked, undisturbed, tmp_path, monkeypatch, call):
    """A block is done when all of its arrays are there, whichever was the last."""
    with stopping(monkeypatch, call):
        complete(asked, tmp_path / "out")
    assert folder.restart_advice() == "finished points are kept; the same command resumes"
    second = Here()
    assert complete(asked, tmp_path / "out", second) == undisturbed
    assert second.count == BLOCKS - max(call - COORDINATES, 0) // ARRAYS


def test_stopped_and_started_again_computes_nothing_twice(asked, undisturbed, tmp_path):
    first = Here(stops=3)
    with pytest.raises(KeyboardInterrupt):
        complete(asked, tmp_path / "out", first, size=1)
    assert folder.restart_advice() == "finished points are kept; the same command resumes"
    with folder.orderly_end(to_the_end=False):
        assert folder.restart_advice().endswith("starts over")
    blocks = finished(tmp_path / "out") // 2
    assert 0 < blocks < BLOCKS
    second = Here()
    assert complete(asked, tmp_path / "out", second) == undisturbed
    assert second.count == BLOCKS - blocks
    third = Here()
    assert complete(asked, tmp_path / "out", third) == undisturbed
    assert third.count == 0


@pytest.mark.parametrize(("seldom", "calls"), [(1e9, 0), (0.0, 0), (0.0, COORDINATES + ARRAYS)])
def test_a_sweep_smaller_than_a_region_keeps_its_finished_points(in_parts, tmp_path, monkeypatch, seldom, calls):
    """Six points are one region, in parts of one. It ends as the fourth is handed out, or while one is written."""
    in_blocks(monkeypatch, 256, 64)
    monkeypatch.setattr(store, "SELDOM", seldom)
    asked = study.of_scene("structure", VARY, quick=True)
    assert [len(asked.parts(region)) for region in asked.regions()] == [6]
    out = tmp_path / "out"
    with stopping(monkeypatch, calls or 10**9):
        complete(asked, out, Here(stops=4), size=1)
    points = finished(out)
    assert points == ((calls - COORDINATES) // ARRAYS if calls else 2)
    second = Here()
    assert complete(asked, out, second) == in_parts
    assert second.count == 6 - points


def test_a_plate_is_solved_at_sampled_speeds_of_a_whole_region_whatever_its_parts(monkeypatch):
    """Each part at its own speeds took four times as long, and gave other last digits."""
    in_blocks(monkeypatch, 256, 64)
    asked, seen = study.of_scene("structure", ["rotor.speeds=3000 rpm:9000 rpm"], count=8, quick=True), []
    monkeypatch.setattr(evaluate, "block", lambda *known, **_: seen.append(known[4]))
    (region,) = asked.regions()
    for part in asked.parts(region):
        study.compute(asked, part)
    assert len(seen) == len(set(seen[0])) == 8
    assert set(seen) == {asked.plan.speeds(0, 8)}


def test_workers_that_die_cost_their_tasks_alone(asked, undisturbed, tmp_path):
    executor = Here(dies={1, 3})
    assert complete(asked, tmp_path / "out", executor) == undisturbed
    assert executor.count == BLOCKS + 2


def test_all_workers_of_an_executor_are_used():
    """Four tasks wait for each other: with fewer at a time none would end."""
    together = Barrier(4, timeout=20)
    with ThreadPoolExecutor(4) as pool, executor.workers_of(executor=pool) as workers:
        assert sorted(executor.results(workers, lambda _: together.wait() >= 0, range(8))) == [
            (k, True) for k in range(8)
        ]


def test_workers_that_always_die_end_the_study(asked, tmp_path):
    with pytest.raises(BadInput, match="end at once"):
        complete(asked, tmp_path / "out", Here(dies=range(1000)))


@pytest.mark.parametrize(
    ("name", "damage"),
    [
        ("f1_hz", lambda whole: whole[: len(whole) // 2]),
        ("f1_hz", None),
        ("reason", lambda _: b""),
        ("done", lambda whole: whole[:9] + bytes([whole[9] ^ 1]) + whole[10:]),
    ],
)
def test_a_damaged_block_is_computed_again(asked, undisturbed, out, name, damage):
    chunk = out / "sweep.zarr" / name / "c" / "1" / "0" / "0"
    if damage is None:
        chunk.unlink()
    else:
        chunk.write_bytes(damage(chunk.read_bytes()))
    executor = Here()
    assert complete(asked, out, executor) == undisturbed
    assert executor.count == 1


def test_what_describes_the_data_is_put_right(asked, undisturbed, out):
    for name in ("f1_hz/zarr.json", "damper.friction/c/0"):
        (out / "sweep.zarr" / name).write_bytes(b"")
    executor = Here()
    assert complete(asked, out, executor) == undisturbed
    assert executor.count == 0


def test_what_was_half_written_goes(asked, undisturbed, out):
    (out / "sweep.zarr" / "f1_hz" / "c" / "0" / "0" / "0.1234.partial").write_bytes(b"half")
    (out / ".partial-sweep.zarr").mkdir()
    assert complete(asked, out) == undisturbed


@pytest.mark.parametrize("writes", [1, 30])
def test_a_full_disk_refuses_and_can_be_helped(asked, undisturbed, tmp_path, monkeypatch, writes):
    left, real = iter(range(writes)), Path.replace

    def full(*arguments):
        if next(left, None) is None:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", full)
        patch.chdir(tmp_path)
        says = r"^--out = 'out': cannot be written: No space left on device; finished points are kept"
        with pytest.raises(BadInput, match=says):
            complete(asked, Path("out"))
    for _ in range(100):  # a thread of zarr's that was writing at the time takes its own away
        if not (left_behind := list((tmp_path / "out").rglob("*.partial"))):
            break
        time.sleep(0.05)
    assert not left_behind
    assert complete(asked, tmp_path / "out") == undisturbed


def test_two_writers_are_refused(asked, tmp_path):
    with (
        store.open_folder(tmp_path / "out", asked.plan, asked.size, asked.attributes),
        pytest.raises(BadInput, match="another sweep is writing into it"),
    ):
        complete(asked, tmp_path / "out")


def test_another_study_is_refused(asked, out):
    before = contents(out)
    for other, what in (
        (study.of_scene("structure", VARY), "quick"),
        (study.of_scene("structure", {"damper.friction": [0.1]}, quick=True), "points"),
        (study.of_scene("paper", VARY, quick=True), "scene"),
    ):
        with pytest.raises(BadInput, match=what):
            complete(other, out)
    keys = study.of_scene("structure", {"damper.friction": [0.1, 0.2, 0.3]}, quick=True)
    with pytest.raises(BadInput, match="differs in its points and keys: use another folder"):
        complete(keys, out)
    assert contents(out) == before


@pytest.mark.parametrize("varied", ["plate.mesh=a.msh,b.msh", "damper.friction=0.1,0.2"])
def test_a_study_of_other_files_is_another(tmp_path, paper, varied):
    """Of meshes that are tried, and of files of modes, which count by what is in them."""
    for name in ("a.msh", "b.msh"):
        shutil.copy(MESHES / "plate_coarse.msh", tmp_path / name)
    (tmp_path / "modes.npz").write_bytes(b"first")
    given = {"structure": {"modes": {"0 rpm": "modes.npz"}}, "plate": None, "material": None, "effects": None}
    given |= {"damper__at": ["1 m", "0 m", "0 m"], "damper__ball_material": "steel", "damper__mass_ratio": None}
    scene = on_mesh(paper, "a.msh") if "mesh" in varied else changed(paper, **given)
    write(scene, tmp_path / "scene.toml")
    studies = [study.of_scene(tmp_path / "scene.toml", [varied]).attributes for _ in range(2)]
    (tmp_path / "b.msh").write_bytes((MESHES / "plate_medium.msh").read_bytes())
    (tmp_path / "modes.npz").write_bytes(b"other")
    studies.append(study.of_scene(tmp_path / "scene.toml", [varied]).attributes)
    assert studies[0] == studies[1]
    differ = {name for name, each in studies[0].items() if studies[2][name] != each}
    assert differ == {"files_sha256", "study"}


def test_plates_of_the_same_name_are_not_taken_for_each_other(tmp_path, paper):
    """Studies of one process, as a worker of a cluster has them: the same scene beside a mesh that is rewritten."""
    hertz = []
    for mesh in ("plate_coarse", "plate_medium", "plate_coarse"):
        shutil.copy(MESHES / f"{mesh}.msh", tmp_path / "p.msh")
        scene = load(write(changed(on_mesh(paper, "p.msh"), rotor__speeds=["3000 rpm"]), tmp_path / "scene.toml"))
        hertz.append(evaluate.PLATES.state(scene).points[0].modes[0].frequency_hz)
    assert hertz[0] == hertz[2]
    assert hertz[0] != hertz[1]


def test_other_code_is_refused(asked, out, monkeypatch):
    monkeypatch.setattr("workflows.studies.sweep.executor.digest", lambda: "other")
    with pytest.raises(BadInput, match="differs in its code and versions"):
        complete(study.of_scene("structure", VARY, quick=True), out)
    with pytest.raises(BadInput, match="a worker runs other code"):
        study.compute(asked, asked.regions()[0])


def test_the_digest_sees_every_module():
    assert len(executor.digest()) == 64
    assert executor.identity()["sources_sha256"] == executor.digest()


def test_a_folder_with_other_things_is_refused(asked, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(BadInput, match=r"holds a mine.txt and no study"):
        complete(asked, tmp_path / "out")


def test_the_data_set_is_read_back(whole):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = xr.open_dataset(whole / "sweep.zarr", engine="zarr")
        assert found.identical(xr.open_zarr(whole / "sweep.zarr"))
    assert found.done.all()
    assert dict(found.sizes) == {"damper.friction": 3, "damper.restitution": 2, "rotor.speeds": 1}
    assert list(found["damper.friction"].values) == VARY["damper.friction"]
    assert found.damping_ratio_peak.attrs["units"] == "1"


def test_a_cluster_gives_the_same_bits(asked, undisturbed, tmp_path):
    """A real scheduler and a worker, in threads of this process."""
    distributed = pytest.importorskip("distributed")
    how = {"n_workers": 1, "threads_per_worker": 1, "processes": False, "dashboard_address": ":0"}
    with distributed.LocalCluster(**how) as cluster:
        study.complete(asked, tmp_path / "out", executor.cluster(cluster.scheduler_address), QUIET)
    assert contents(tmp_path / "out") == undisturbed


def test_no_cluster(asked, tmp_path):
    pytest.importorskip("distributed")
    with pytest.raises(BadInput, match="no scheduler answers there"):
        study.complete(asked, tmp_path / "out", executor.cluster("nonsense://there:1"), QUIET)


def test_processes_give_the_same_bits_to_a_script_without_a_guard(in_parts, tmp_path):
    """One real process of this machine: spawned, one thread, its own caches; it does not run the script again."""
    script = tmp_path / "study.py"
    call = f'spindamp.sweep("structure", {VARY}, quick=True, workers=1, out="out")'
    script.write_text(f"import spindamp\nprint(dict({call}.sizes))\n", encoding="utf-8")
    done = python(script, cwd=tmp_path)
    sizes = "{'damper.friction': 3, 'damper.restitution': 2, 'rotor.speeds': 1}\n"
    assert (done.returncode, done.stdout) == (0, sizes), done.stderr
    assert contents(tmp_path / "out") == in_parts
