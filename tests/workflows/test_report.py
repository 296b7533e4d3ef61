"""The report: one file, for a person, that loads nothing and runs only what stands in it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import workflows
from tests.workflows.browser import PHONE, Reader, findings, needs_axe, needs_chromium, picture
from tests.workflows.conftest import Command, Scene, changed, write
from workflows.report import mode_viewer
from workflows.scene.load import parse
from workflows.solve import engine_orders

TEMPLATES = Path(workflows.__file__).parent / "templates"


@pytest.fixture(scope="module")
def page(finished: Path) -> str:
    return (finished / "report.html").read_text(encoding="utf-8")


def test_self_contained(page: str) -> None:
    reader = Reader(page)
    assert not reader.open
    assert all(load.startswith("data:") for load in reader.loads)
    assert len(reader.ids) == len(set(reader.ids))
    assert {reference[1:] for reference in reader.references} <= set(reader.ids)
    assert not set(reader.tags) & {"iframe", "object", "embed"}
    assert not re.search(r"https?:|@import|url\((?!#)|fetch\(|XMLHttpRequest|\beval\(", page)


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("name", ["campbell", "structure", "printed"])
def test_other_scenes_have_reports_too(name: str, spindamp: Command, tmp_path: Path) -> None:
    assert spindamp("run", name, "--out", "out").status == 0
    reader = Reader((tmp_path / "out" / "report.html").read_text(encoding="utf-8"))
    assert not reader.open
    assert ("img" in reader.tags) == (name != "structure")


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("broken", ["import sys; sys.exit(3)", "import os; os.abort()", "import time; time.sleep(60)"])
def test_without_vtk_the_report_still_has_its_picture(
    broken: str, spindamp: Command, monkeypatch: pytest.MonkeyPatch, paper: Scene, tmp_path: Path
) -> None:
    monkeypatch.setattr(mode_viewer, "COMMAND", ["-c", broken])
    monkeypatch.setattr(mode_viewer, "PATIENCE", 0.5)
    scene = write(changed(paper, rotor__speeds=["10000 rpm"], damper=None, release=None), tmp_path / "scene.toml")
    assert spindamp("run", scene, "--out", "out").status == 0
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "Drawn without VTK" in page
    assert "data:image/png;base64," in page


@needs_chromium
@pytest.mark.parametrize("width", [1200, PHONE])
def test_chromium_opens_it_without_a_word(finished: Path, width: int) -> None:
    assert len(picture(finished / "report.html", width=width)) > 30_000


@needs_chromium
def test_nothing_hinders_a_reader(finished: Path) -> None:
    assert findings(finished / "report.html", ("light", "dark")) == []


@needs_chromium
@needs_axe
def test_what_hinders_a_reader_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    page.write_text(
        '<!doctype html><html lang="en"><title>a</title><body><main><h1>a</h1><img src="data:,">'
        '<p style="color: #ccc; background: #fff; width: 500px">pale</p></main></body></html>',
        encoding="utf-8",
    )
    assert {found.split()[1] for found in findings(page)} >= {"pixels", "image-alt", "color-contrast"}


def luminance(colour: str) -> float:
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    red, green, blue = (c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def test_words_in_figures_stand_out_of_the_page() -> None:
    """WCAG 2.1 asks for a contrast of 4.5; what a browser cannot tell within a drawing is reckoned here."""
    css = (TEMPLATES / "report.css").read_text(encoding="utf-8")
    for look in (css[: css.index("@media")], css[css.index("@media") : css.index("* {")]):
        paper, *_ = re.findall(r"--paper: (#\w+)", look)
        words = re.findall(r"--(ink|muted|accent|text-\d): (#\w+)", look)
        assert len(words) == 10
        for name, colour in words:
            low, high = sorted((luminance(paper), luminance(colour)))
            assert (high + 0.05) / (low + 0.05) >= 4.5, name


def test_no_word_of_a_figure_has_the_colour_of_a_line(finished: Path) -> None:
    page = (finished / "report.html").read_text(encoding="utf-8")
    pale = re.findall(r"(\.[\w-]+)\{[^}]*fill:var\(--line-", page)
    texts = re.findall(r'<text[^>]*(?:class="([\w-]+)"|style="([^"]*)")', page)
    assert len(texts) > 100
    assert not {f".{name}" for name, _ in texts} & set(pale)
    assert not [style for _, style in texts if "var(--line-" in style]


def test_engine_orders_are_answered_in_the_report(finished: Path, document: dict[str, Any], paper: Scene) -> None:
    """Each crossing is where an order of the scene meets the first bending mode, and its row is that of the results."""
    page = (finished / "report.html").read_text(encoding="utf-8")
    text = re.sub(r"(<[^>]+>|[ \n])+", " ", page[page.index("Under engine orders") :])
    assert "spindamp response" in text
    assert {each["order"] for each in document["reductions"]} <= set(paper["excitation"]["orders"])
    first = [speed["modes"][0]["frequency_hz"] for speed in document["speeds"]]
    for each in document["reductions"]:
        assert each["frequency_hz"] == pytest.approx(each["order"] * each["rpm"] / 60, rel=1e-9)
        assert min(first) < each["frequency_hz"] < max(first)
        row = f"{each['order']} flap {each['mode']} {each['rpm']:,.0f} {100 * (1 - each['ratio']):.2g} "
        assert row.replace(",", "\u2009") in text


def test_a_diagram_has_the_orders_of_its_scene(paper: Scene) -> None:
    scene = parse(changed(paper, excitation__orders=[5, 2]))
    assert engine_orders.orders(scene) == (1, 2, 3, 4, 5, 6, 8, 12, 16)
    assert engine_orders.orders(scene.model_copy(update={"excitation": None})) == engine_orders.ENGINE_ORDERS
