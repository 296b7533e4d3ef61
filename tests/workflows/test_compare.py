"""Runs side by side: folders, scenes and results."""

import csv
import io
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

import spindamp
from tests.workflows.conftest import changed, shipped_scene, stored, write
from workflows.errors import BadInput
from workflows.io.files import write_study
from workflows.report import remarks
from workflows.scene import load as loading
from workflows.studies import comparison as report

pytestmark = pytest.mark.usefixtures("quickly")
STRUCTURE = shipped_scene("structure")


@pytest.fixture(scope="module")
def soft_and_stiff(tmp_path_factory):
    soft = spindamp.run(changed(STRUCTURE, title="soft", damper__restitution=0.3))
    stiff = spindamp.run(changed(STRUCTURE, title="stiff", damper__restitution=0.7))
    folder = tmp_path_factory.mktemp("runs") / "stiff"
    spindamp.save(stiff, folder)
    return soft, stiff, folder


@pytest.fixture(scope="module")
def found(soft_and_stiff):
    soft, _, folder = soft_and_stiff
    return spindamp.compare(soft, folder)


def test_what_differs_is_what_was_changed(found, soft_and_stiff):
    assert found.names == ("soft", "stiff")
    assert found.differences == {"damper.restitution": (0.3, 0.7)}
    soft, stiff, _ = soft_and_stiff
    rows = report.rows(found)
    assert len(rows) == 2 * len(soft.speeds)
    for row, point in zip(rows[1::2], stiff.speeds, strict=True):
        assert row["damping_ratio_percent"] == pytest.approx(100 * point.damping_curve.peak, rel=1e-12)
        assert row["damping_ratio_error"] == point.damping_curve.error > 0
        assert row["verdict"] == point.verdict.grade
    assert rows[0]["damping_ratio_percent"] > rows[1]["damping_ratio_percent"], "softer walls take more"


def test_the_words_are_those_of_the_runs(found, soft_and_stiff):
    text = report.text(found)
    for name, results in zip(("soft", "stiff"), soft_and_stiff, strict=False):
        assert f"{name}: {report.headline(results)}" in text
        assert report.headline(results).removesuffix(".") in repr(results)
        of_run = [
            line.split()[-1] for line in text.splitlines() if line[:5].strip().isdecimal() and line.split()[1] == name
        ]
        assert of_run == [point.verdict.grade for point in results.speeds]
    assert "± %: estimated relative error of the figure to its left." in text
    assert "damper.restitution" in text


def test_files(found, tmp_path):
    write_study(found, tmp_path / "out")
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"compare.json", "compare.csv", "compare.svg", "report.html"} <= names
    table = csv.DictReader(io.StringIO((tmp_path / "out" / "compare.csv").read_text(encoding="utf-8")))
    for written, row in zip(table, stored(tmp_path / "out" / "compare.json")["rows"], strict=True):
        assert float(written["damping_ratio_percent"]) == pytest.approx(row["damping_ratio_percent"], rel=1e-9)
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert page.count("<svg") == 1
    assert "damper.restitution" in page


def test_marks_units_and_titles_are_those_of_a_report(soft_and_stiff, tmp_path):
    """A folder's name is no title; a mark of a run's table stands in this one, with its meaning."""
    other = changed(STRUCTURE, title="slow", rotor__speeds=["9000 rpm"], damper__radius="1.1 mm", damper__count=None)
    other["release"] = {"displacement": ["0.1 mm", "0 mm"]}
    other["design"] = {"clearance": ["0.1 mm", "4 mm"], "amplitude": ["1 mm", "2 mm"]}
    found = spindamp.compare(soft_and_stiff[2], other)
    write_study(found, tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "<h1>stiff · slow</h1>" in page
    for text in (report.text(found).replace("\n", " "), page):
        assert "damper.radius, mm" in text
        assert "design.clearance, mm" in text
        assert "rotor.speeds, rpm" in text
        assert "9000" in text
        assert "*" in text
        assert remarks.AT_REST_MEANS in text
    rows = stored(tmp_path / "out" / "compare.json")["rows"]
    speeds = {row["rpm"] for row in rows if row["run"] == "stiff"}
    assert [row["rpm"] for row in rows if row["run"] == "slow"] == [9000.0], "no row at a speed that a run lacks"
    assert len(rows) == len(speeds) + 1
    assert (9000.0, "slow") in {(row["rpm"], row["run"]) for row in rows if row["cutoff_at_rest"]}
    with (tmp_path / "out" / "compare.csv").open(encoding="utf-8", newline="") as table:
        written = [row["cutoff_at_rest"] for row in csv.DictReader(table)]
    assert written == [str(row["cutoff_at_rest"]) for row in rows]


def test_every_engine_order_of_a_run_is_said():
    """The best order does not hide that the ball is of no use at another."""
    orders = {"orders": [2, 3, 50], "force": ["1 N", "2 N"]}
    excited = changed(STRUCTURE, damper__damping_ratio=1e-3, rotor__speeds=["5000 rpm", "10000 rpm"], excitation=orders)
    said = report.text(spindamp.compare(excited, STRUCTURE)).replace("\n", " ")
    for order in orders["orders"]:
        assert re.search(rf"engine order {order}\b", said, re.IGNORECASE)


def test_runs_of_the_same_name_are_numbered(soft_and_stiff):
    soft, _, _ = soft_and_stiff
    found = spindamp.compare(soft, soft)
    assert found.names == ("soft (1)", "soft (2)")
    assert found.differences == {}
    assert "The scenes are the same." in report.text(found)
    numbered = replace(soft, scene=soft.scene.model_copy(update={"title": "soft (1)"}))
    assert spindamp.compare(soft, soft, numbered).names == ("soft (2)", "soft (3)", "soft (1)")


def test_a_material_is_no_difference_where_its_density_is_the_same():
    """Its name is kept only where its strength is known too; by it or as a number, the density is the same."""
    bare = changed(STRUCTURE, damper__mass_ratio=None, damper__count=100, release__cycles=2, rotor__speeds=["3500 rpm"])
    named = changed(bare, damper__ball_material="steel")
    floored = changed(named, damper__floor_material="Ti-6Al-4V", effects__indentation=False)
    by_number = changed(bare, damper__ball_density=7850.0)
    found = spindamp.compare(named, floored, by_number)
    assert [each.scene.damper.ball_density for each in found.results] == [7850.0, 7850.0, 7850.0]
    assert found.differences.keys() == {"damper.floor_material"}
    other = spindamp.compare(named, changed(bare, damper__ball_material="lead"))
    assert other.differences["damper.ball_density"] == (7850.0, 11300.0)
    mass = 100 * 7850 * 4 / 3 * math.pi * found.results[0].scene.damper.radius ** 3
    weighed = spindamp.compare(by_number, changed(bare, damper__mass=mass))
    assert weighed.differences.keys() <= {"damper.mass"}


def test_runs_without_a_verdict_are_drawn_hollow(soft_and_stiff):
    """Below 1 g there is no verdict."""
    slow = spindamp.run(changed(STRUCTURE, rotor__speeds=["40 rpm", "3500 rpm"], release__cycles=2))
    for found, hollow in ((spindamp.compare(slow, slow), 2), (spindamp.compare(*soft_and_stiff[:2]), 0)):
        files = report.files(found)
        marks = re.findall(r'<use [^>]*style="(fill-opacity: 0)?[^"]*var\(--line-[01]\)"', report.draw(found))
        assert [mark != "" for mark in marks].count(True) == hollow
        assert len(marks) == sum(len(each.speeds) for each in found.results) + 2  # of the legend
        assert ("hollow: marked in the table" in files["report.html"]) == bool(hollow)
        assert sum(row["no_verdict"] for row in report.document(found)["rows"]) == hollow


def test_each_scene_is_read_once(spindamp, monkeypatch):
    """By the command, which has its remarks before it runs it."""
    quick = changed(STRUCTURE, rotor__speeds=["3500 rpm"], release__cycles=2)
    for name in ("one", "two"):
        write(changed(quick, title=f"of {name}"), Path(f"{name}.toml"))
    reads, read = [], loading.load
    monkeypatch.setattr(loading, "load", lambda where: reads.append(where) or read(where))
    names = [run["name"] for run in spindamp.json("compare", "one.toml", "two.toml")["runs"]]
    assert (names, reads) == (["one", "two"], ["one.toml", "two.toml"])


def test_what_cannot_be_compared(soft_and_stiff, tmp_path):
    with pytest.raises(BadInput, match="at least two runs"):
        spindamp.compare(soft_and_stiff[0])
    with pytest.raises(BadInput, match="holds no run"):
        spindamp.compare(soft_and_stiff[0], tmp_path)


def test_all_runs_are_read_before_any_scene_is_run(monkeypatch):
    monkeypatch.setattr(report, "solved", lambda *_: pytest.fail("a scene was run"))
    with pytest.raises(BadInput, match="no such scene"):
        spindamp.compare("structure", "nowhere.toml")


def test_a_run_is_not_replaced_by_its_own_comparison(spindamp, soft_and_stiff):
    folder = soft_and_stiff[2]
    done = spindamp("compare", folder, folder, "--out", folder)
    assert (done.status, "is one of the runs that are read: expected another folder" in done.err) == (2, True)
    assert (folder / "results.json").exists()
