"""As a notebook uses it: scenes in any form, results that show themselves in brief, and calls that write."""

import json
import os
import re
import shutil
import tomllib
from base64 import b64decode
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import FunctionType

import numpy as np
import pytest
from matplotlib import pyplot

import spindamp
import workflows
from tests.limits import HANG
from tests.workflows.browser import Reader
from tests.workflows.conftest import MESHES, ROOT, changed, on_mesh, raising, stored, write
from workflows.formatting import revolutions
from workflows.io.folder import ALWAYS_OURS, MANIFEST
from workflows.studies import response
from workflows.studies.comparison import Comparison
from workflows.studies.design.report import DesignResult
from workflows.studies.reproduction import Reproduction
from workflows.studies.response import Response
from workflows.studies.sweep import executor
from workflows.studies.work_precision.effects import EffectStudy
from workflows.studies.work_precision.timing import WorkPrecision

pytestmark = pytest.mark.usefixtures("undrawn")

GUIDE = ROOT / "docs" / "guide"


@pytest.fixture(scope="module")
def damper():
    return workflows.run("structure")


def _numbers(results):
    return {name: value for name, value in workflows.document(results).items() if name != "timings"}


def test_a_scene_in_every_form(damper, structure, tmp_path):
    path = write(structure, tmp_path / "scene.toml")
    for form in (path, str(path), structure, workflows.parse(structure), workflows.load("structure")):
        assert _numbers(workflows.run(form)) == _numbers(damper)
    assert _numbers(workflows.run(scene=structure)) == _numbers(damper)


def test_the_face_for_people(damper, coarse, paper, structure, tmp_path):
    """What `import spindamp` offers does what the packages beneath it do."""
    assert _numbers(spindamp.run(structure)) == _numbers(damper)
    one = spindamp.ringdown("structure", rpm=5000)
    assert [point.rpm for point in one.speeds] == [pytest.approx(5000)]
    alone = changed(paper, rotor__speeds=["0 rad/s", "500 rad/s"], rotor__modes=3, accuracy__frequency=0.05)
    found = spindamp.campbell(alone)
    assert found.scene.damper is None
    for mine, theirs in zip(found.speeds, coarse.speeds, strict=True):
        assert [m.frequency_hz for m in mine.modes] == pytest.approx([m.frequency_hz for m in theirs.modes], rel=1e-6)
    assert spindamp.report(one, tmp_path / "page.html").read_text(encoding="utf-8").startswith("<!doctype html>")
    assert stored(spindamp.save(one, tmp_path / "out") / "results.json")
    assert spindamp.dataset(one).sizes["rpm"] == 1
    with pytest.raises(spindamp.BadInput, match="ringdown needs a damper"):
        spindamp.ringdown(found.scene)
    with pytest.raises(spindamp.BadInput, match="campbell needs a plate"):
        spindamp.campbell("structure")
    with pytest.raises(spindamp.BadInput, match=r"^rpm = -1: expected a rotation speed between 0 and"):
        spindamp.ringdown("structure", rpm=-1)
    assert set(spindamp.__all__) <= set(dir(spindamp))


@pytest.mark.parametrize(
    "kind",
    [Response, Reproduction, WorkPrecision, EffectStudy, Comparison, DesignResult],
    ids=lambda kind: kind.__name__,
)
def test_the_result_of_a_study_prints_as_its_command_does(kind, monkeypatch):
    """It was an object's address, or all of its arrays."""
    report = import_module(kind.REPORT)
    assert isinstance(report.text, FunctionType)
    result = kind.__new__(kind)
    monkeypatch.setattr(report, "text", lambda it: "as `typed`" if it is result else None)
    assert str(result) == repr(result) == "as typed"


def test_what_is_no_scene(damper):
    for wrong in (None, 3, ["paper"], b"paper", damper):
        with pytest.raises(TypeError, match=f"a dict, a Scene or what load returns, got {_kind(wrong)}$"):
            workflows.run(wrong)
    for wrong in (None, [("rotor", {})], "paper"):
        with pytest.raises(TypeError, match=f"parse takes a dict of the scene's tables, got {_kind(wrong)}"):
            workflows.parse(wrong)
    with pytest.raises(TypeError, match="load takes a scene's name or path, got dict"):
        workflows.load({})
    with pytest.raises(workflows.BadInput, match="did you mean 'paper'"):
        workflows.run("papper")
    with pytest.raises(workflows.BadInput, match=r"^scene: \[rotor\]: missing"):
        workflows.run({})


def _kind(value):
    return type(value).__name__


def test_values_of_numpy_and_paths(structure, paper):
    """What a notebook computes goes into a scene as it is."""
    speeds = np.array([100.0, 200.0])
    given = changed(structure, rotor__speeds=speeds, damper__cavity=(np.float64(2.5e-3), np.float32(3e-3)))
    assert workflows.parse(given).rotor.speeds == (100.0, 200.0)
    assert workflows.parse(changed(paper, rotor__modes=np.int64(3))).rotor.modes == 3
    mesh = changed(on_mesh(paper, ""), plate__mesh=Path("a") / "b.msh")
    assert workflows.parse(mesh).plate.mesh == str(Path("a") / "b.msh")
    with pytest.raises(workflows.BadInput, match=r"\[rotor\] modes = 3.5: expected a whole number"):
        workflows.parse(changed(paper, rotor__modes=np.float64(3.5)))


def test_a_mesh_is_looked_for_from_the_current_folder(paper, tmp_path, monkeypatch):
    alone = changed(paper, rotor__speeds=[0], rotor__modes=1, damper=None, release=None)
    scene = changed(alone, plate__length=None, plate__width=None, plate__mesh="plate_coarse.msh")
    monkeypatch.chdir(tmp_path)
    for form in (scene, workflows.parse(scene)):
        with pytest.raises(workflows.BadInput, match=r"^scene: \[plate\] mesh = 'plate_coarse.msh': no such file"):
            workflows.run(form)
    shutil.copy(MESHES / "plate_coarse.msh", tmp_path)
    results = workflows.run(scene)
    assert results.mesh_sha256 is not None
    assert results.speeds[0].modes[0].frequency_hz == pytest.approx(198.97, rel=2e-2)


def test_results_in_brief(damper, coarse):
    for results in (damper, coarse, replace(damper, speeds=damper.speeds[:1]), replace(coarse, speeds=())):
        assert len(repr(results)) < 500
        assert len(repr(results).splitlines()) <= 3
        assert repr(results).startswith(f"{results.scene.title}: {revolutions(results.scene.rotor.speeds)}\n")
    assert "rpm" in repr(damper)
    for part in (damper.speeds[0], damper.speeds[0].damper, coarse.surface, coarse.speeds[1].damper):
        assert len(repr(part)) < 3000


def test_results_as_a_table(damper, coarse, structure):
    for results in (damper, coarse):
        page = Reader(results._repr_html_())
        assert page.open == []
        assert page.tags.count("table") == 1
        assert page.tags.count("tr") == 1 + len(results.speeds)
        assert len(results._repr_html_()) < 5000
    many = replace(damper, speeds=damper.speeds * 100)
    assert Reader(many._repr_html_()).tags.count("tr") < 20
    assert "more speeds" in many._repr_html_()
    assert Reader(replace(coarse, speeds=())._repr_html_()).open == []
    hostile = workflows.run(changed(structure, title="<script>alert(1)</script> & co"))
    assert "script" not in Reader(hostile._repr_html_()).tags


def test_save(damper, coarse, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert workflows.save(damper, "out") == tmp_path / "out"
    assert workflows.save(coarse, Path("out")) == tmp_path / "out"
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names >= ALWAYS_OURS
    assert list(tmp_path.iterdir()) == [tmp_path / "out"]
    document = stored(tmp_path / "out" / "results.json")
    assert {name: value for name, value in document.items() if name != "timings"} == _numbers(coarse)
    times = document["timings"]
    assert times["modes"] == coarse.timings["modes"]
    assert times["total"] > coarse.timings["total"]
    assert {"write", "report"} <= set(times)
    html = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "data:image/png;base64," in html, "the mode shape is drawn"


def test_a_saved_run_is_that_of_the_command(damper, tmp_path, spindamp):
    outcome = spindamp("run", "structure", "--out", "one")
    assert outcome.status == 0
    workflows.save(damper, "two")
    for folder in ("one", "two"):
        document = stored(tmp_path / folder / "results.json")
        del document["timings"]
        (tmp_path / folder / "results.json").write_text(json.dumps(document), encoding="utf-8")
    for name in ("results.json", MANIFEST):
        assert (tmp_path / "one" / name).read_text() == (tmp_path / "two" / name).read_text()


def test_a_report_that_fails_leaves_the_old_one(damper, tmp_path, monkeypatch):
    path = workflows.save_report(damper, tmp_path / "report.html")
    before = path.read_text(encoding="utf-8")
    monkeypatch.setattr(os, "replace", raising(PermissionError(13, "Permission denied")))
    with pytest.raises(workflows.BadInput, match=r"path = .*: cannot be written: Permission denied"):
        workflows.save_report(replace(damper, speeds=damper.speeds[:1]), path)
    assert path.read_text(encoding="utf-8") == before
    assert list(tmp_path.iterdir()) == [path]


def test_places_where_nothing_can_be_saved(damper, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    for place in (".", "file"):
        with pytest.raises(workflows.BadInput, match=r"^folder = '"):
            workflows.save(damper, place)
    for place in (".", "folder", "file/report.html", "nul\0", "x" * 300):
        with pytest.raises(workflows.BadInput, match=r"^path = '"):
            workflows.save_report(damper, place)
    for call in (workflows.save, workflows.save_report):
        for given in (("out", damper), (damper, None), (damper, 3)):
            with pytest.raises(TypeError, match=f"{call.__name__} takes"):
                call(*given)
    for ask in (workflows.dataset, workflows.document):
        with pytest.raises(TypeError, match=f"{ask.__name__} takes what run returns, got str"):
            ask("paper")
    assert {path.name for path in tmp_path.iterdir()} == {"file", "folder"}


def test_in_a_thread(tmp_path):
    """A widget's callback and a server's worker run there."""
    with ThreadPoolExecutor(1) as pool:
        results = pool.submit(workflows.run, "structure").result(120)
        assert pool.submit(workflows.save, results, tmp_path / "out").result(120).is_dir()


def _blocks(page, language):
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)


def _executed(cells, folder):
    """Cells as a notebook in a folder, after its kernel has run them."""
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    nbclient.NotebookClient(notebook, timeout=HANG, resources={"metadata": {"path": str(folder)}}).execute()
    return [cell.outputs for cell in notebook.cells]


QUICKLY = """
from damper import damping_curve
from workflows.report import figures
from workflows.solve import damper as stage
figures.report = lambda _: dict.fromkeys(figures.SHOWN, "")
stage.damping_curve = lambda system, **how: damping_curve(system, **stage.QUICK, **how)
"""
"""Quick figures of the damper, and pages without pictures; those of `results.plot` are drawn."""


@pytest.mark.filterwarnings("default")  # of the notebook's client: those of the cells are on their stderr
def test_the_cells_of_the_guide_run_in_a_notebook_and_show_their_pictures(paper, tmp_path):
    """The page on Python, on a machine without a screen; each cell that draws shows one picture.

    The folder has a scene of its own by the name of the paper's, of fewer speeds and modes.
    """
    rotor = paper["rotor"] | {"speeds": paper["rotor"]["speeds"][:4], "modes": 2}
    write(changed(paper, rotor=rotor, accuracy={"frequency": 0.05}, excitation=None), tmp_path / "paper")
    cells = _blocks(GUIDE / "python.md", "python")
    outputs = _executed([QUICKLY, *cells], tmp_path)[1:]
    for cell, shown in zip(cells, outputs, strict=True):
        assert not [each for each in shown if each.get("name") == "stderr"], cell
        pictures = [each.data["image/png"] for each in shown if "image/png" in each.get("data", {})]
        assert len(pictures) == (1 if "results.plot." in cell else 0), cell
        assert all(b64decode(picture).startswith(b"\x89PNG") and len(picture) > 5000 for picture in pictures), cell
    table = next(each.data["text/html"] for each in outputs[0] if "text/html" in each.get("data", {}))
    assert Reader(table).tags.count("tr") == 5
    assert {"out", "report.html", "campbell.pdf"} <= {path.name for path in tmp_path.iterdir()}
    assert sum("results.plot." in cell for cell in cells) >= 3


OTHERWISE = ("python.md", "modes.md")
"""Pages whose code is run by tests of their own."""


@pytest.mark.parametrize("page", [*sorted(GUIDE.glob("*.md")), ROOT / "README.md"], ids=lambda page: page.stem)
def test_the_snippets_of_readme_and_guide(page, tmp_path, monkeypatch):
    """Each runs as it stands, beside the scene of its page."""
    for scene in _blocks(page, "toml")[:1]:
        (tmp_path / "mine.toml").write_text(scene, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(executor, "local", lambda *_: executor.external(ThreadPoolExecutor(1), 1))
    monkeypatch.setattr(response, "SPEEDS", 21)
    for number, text in enumerate(_blocks(page, "python") if page.name not in OTHERWISE else []):
        exec(compile(text, f"{page.name}, snippet {number + 1}", "exec"), {"__name__": "__main__"})
    pyplot.close("all")


def test_the_tables_of_the_guide_are_accepted():
    """A scene alone, and the tables that other pages add to it or put in the place of a key."""
    scene, thickness, root = (tomllib.loads(block) for block in _blocks(GUIDE / "scenes.md", "toml"))
    (excitation,) = (tomllib.loads(block) for block in _blocks(GUIDE / "response.md", "toml"))
    (design,) = (tomllib.loads(block) for block in _blocks(GUIDE / "design.md", "toml"))
    assert workflows.parse(scene).damper is not None
    damped = scene | excitation | {"damper": scene["damper"] | excitation["damper"]}
    assert workflows.parse(damped).excitation is not None
    assert workflows.parse(scene | design).design is not None
    for table in (thickness, root):
        given = workflows.parse(scene | {"plate": scene["plate"] | table["plate"]})
        assert (given.plate.root is None) == ("root" not in table["plate"])


def test_a_report_replaces_plain_files_alone(damper, tmp_path):
    """Not what a program reads from, nor a device."""
    if not hasattr(os, "mkfifo"):
        pytest.skip("no named pipes here")
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(workflows.BadInput, match="is not a regular file"):
        workflows.save_report(damper, tmp_path / "pipe")
    assert (tmp_path / "pipe").is_fifo()
    with pytest.raises(workflows.BadInput, match="is a folder"):
        workflows.save_report(damper, f"{tmp_path}/x.html/")
    wrong = "3000 rpm"
    with pytest.raises(workflows.BadInput, match=r"^rpm = .*number of revolutions"):
        spindamp.ringdown("structure", rpm=wrong)
    with pytest.raises(workflows.BadInput, match="expected a rotation speed between 0"):
        spindamp.ringdown("structure", rpm=10**400)
