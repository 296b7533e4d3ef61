"""The report: one file, for a person, that loads nothing and runs only what stands in it."""

import re
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest

import spindamp
import workflows
from tests.workflows.browser import PHONE, Reader, findings, needs_axe, needs_chromium, opened
from tests.workflows.conftest import changed, shipped_scene
from workflows import formatting
from workflows.io import serialise
from workflows.report import text, verdict
from workflows.report.page import load_results, save
from workflows.scene.load import parse
from workflows.solve import engine_orders, limits
from workflows.solve.engine_orders import ENGINE_ORDERS

TEMPLATES = Path(workflows.__file__).parent / "templates"


@pytest.fixture(scope="module")
def page(finished):
    return (finished / "report.html").read_text(encoding="utf-8")


def test_self_contained(page):
    reader = Reader(page)
    assert not reader.open
    assert all(load.startswith("data:") for load in reader.loads)
    assert len(reader.ids) == len(set(reader.ids))
    assert {reference[1:] for reference in reader.references} <= set(reader.ids)
    assert not set(reader.tags) & {"iframe", "object", "embed"}
    assert not re.search(r"https?:|@import|url\((?!#)|fetch\(|XMLHttpRequest|\beval\(", page)


def test_what_is_typed_is_code_on_a_page_and_plain_elsewhere(page, finished):
    """A page may hold backticks in its scripts alone; a scene's text stays escaped."""
    said = "The ball's own: rely on `spindamp response`, <b>not</b> on this."
    code = "The ball’s own: rely on <code>spindamp response</code>, &lt;b&gt;not&lt;/b&gt; on this."
    assert formatting.prose(said) == code
    assert formatting.plain(said) == said.replace("`", "")
    assert "<code>spindamp response</code> computes the forced motion." in page
    assert "`" not in re.sub(r"<(script|style).*?</\1>", "", page, flags=re.DOTALL)
    results = load_results(finished)
    assert "`" in " ".join(verdict.answer(results).sentences)
    assert "`" not in repr(results) + results._repr_html_()


def test_each_speed_has_its_own_limit(coarse):
    """The root of a structure may be strained more at one speed than at another."""
    slow, fast = coarse.speeds
    apart = replace(coarse, speeds=(replace(slow, root_strain=1.0), replace(fast, root_strain=1.3)))
    least, middle, most = (
        limits.endured(apart, omega) for omega in (fast.omega, 0.5 * (slow.omega + fast.omega), slow.omega)
    )
    assert least == limits.endured(apart) == limits.ENDURED / 1.3
    assert least < middle < most == limits.ENDURED


_MINUS_NOTHING = re.compile(r"(?<![\d.\w])[-−]0(\.0*)?(?![\d.])")


@pytest.mark.usefixtures("undrawn")
def test_no_table_prints_minus_nothing(coarse, tmp_path):
    """Losses that are -0.0, or below 0 by rounding alone, in the printed table, every CSV, and on the page."""
    point = next(each for each in coarse.speeds if each.damper is not None)
    own = point.damping_curve
    books = replace(point.damper.energy, structure=-0.0, rolling=-0.0, impact=-1e-20, slip=-0.0, residual=-0.0)
    for loss in (-0.0, -1e-15):
        none = replace(point.damper, energy=books, peak_sdc=loss, intrinsic_sdc=loss, cutoff_g=-0.0, cutoff_ratio=-0.0)
        curve = replace(own, damping_ratio=np.append(loss, own.damping_ratio[1:]))
        mine = replace(point, damper=none, damping_curve=curve)
        results = replace(coarse, speeds=tuple(mine if each is point else each for each in coarse.speeds))
        printed = "\n".join(" ".join(row) for row in text.rows(results))
        assert "199.12 0 0 0 " in printed
        assert not _MINUS_NOTHING.findall(printed)
        out = save(results, tmp_path / "out")
        for path in out.glob("*.csv"):
            assert not _MINUS_NOTHING.findall(path.read_text(encoding="utf-8")), path.name
        cells = re.findall(r"<td[^>]*>([^<]*)", (out / "report.html").read_text(encoding="utf-8"))
        assert not [cell for cell in cells if _MINUS_NOTHING.fullmatch(cell.strip())]


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("name", ["campbell", "structure", "printed"])
def test_other_scenes_have_reports_too(name, spindamp, tmp_path):
    scene = shipped_scene(name)
    roughly = {"accuracy": {"frequency": 0.05}, "rotor__modes": 2} if "plate" in scene else {}
    few = changed(scene, rotor__speeds=["3500 rpm", "10000 rpm"], **roughly)
    assert spindamp("run", few, "--out", "out").status == 0
    reader = Reader((tmp_path / "out" / "report.html").read_text(encoding="utf-8"))
    assert not reader.open
    assert ("img" in reader.tags) == (name != "structure")


@needs_chromium
def test_chromium_opens_it_without_a_word(finished):
    with opened(finished / "report.html") as page:
        for width in (1200, PHONE):
            page.resize(width)
            assert len(page.file("Page.captureScreenshot")) > 30_000


@needs_chromium
def test_nothing_hinders_a_reader(finished):
    assert findings(finished / "report.html", ("light", "dark")) == []


@needs_chromium
@needs_axe
def test_what_hinders_a_reader_is_found(tmp_path):
    page = tmp_path / "page.html"
    page.write_text(
        '<!doctype html><html lang="en"><title>a</title><body><main><h1>a</h1><img src="data:,">'
        '<p style="color: #ccc; background: #fff; width: 500px">pale</p></main></body></html>',
        encoding="utf-8",
    )
    assert {found.split()[1] for found in findings(page)} >= {"pixels", "image-alt", "color-contrast"}


def luminance(colour):
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    red, green, blue = (c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def test_words_in_figures_stand_out_of_the_page():
    """WCAG 2.1 asks for a contrast of 4.5; what a browser cannot tell within a drawing is reckoned here."""
    css = (TEMPLATES / "report.css").read_text(encoding="utf-8")
    for look in (css[: css.index("@media")], css[css.index("@media") : css.index("* {")]):
        paper, *_ = re.findall(r"--paper: (#\w+)", look)
        words = re.findall(r"--(ink|muted|accent|text-\d): (#\w+)", look)
        assert len(words) == 10
        for name, colour in words:
            low, high = sorted((luminance(paper), luminance(colour)))
            assert (high + 0.05) / (low + 0.05) >= 4.5, name


def test_no_word_of_a_figure_has_the_colour_of_a_line(page):
    pale = re.findall(r"(\.[\w-]+)\{[^}]*fill:var\(--line-", page)
    texts = re.findall(r'<text[^>]*(?:class="([\w-]+)"|style="([^"]*)")', page)
    assert len(texts) > 100
    assert not {f".{name}" for name, _ in texts} & set(pale)
    assert not [style for _, style in texts if "var(--line-" in style]


def test_engine_orders_are_answered_in_the_report(page, document, paper):
    """Each crossing is where an order of the scene meets the first bending mode, and its row is that of the results.

    All sentences on them stand before their table.
    """
    told, _, text = re.sub(r"(<[^>]+>|[ \n])+", " ", page).partition("Under engine orders")
    assert "spindamp response computes the forced motion" in told
    assert len(re.findall(r"At engine order \d", told)) == len(document["reductions"])
    assert not re.search("At engine order|Estimated from free vibration[;,]|rough estimate", text)
    assert {each["order"] for each in document["reductions"]} <= set(paper["excitation"]["orders"])
    first = [speed["modes"][0]["frequency_hz"] for speed in document["speeds"]]
    for each in document["reductions"]:
        assert each["frequency_hz"] == pytest.approx(each["order"] * each["rpm"] / 60, rel=1e-9)
        assert min(first) < each["frequency_hz"] < max(first)
        row = f"{each['order']} flap {each['mode']} {each['rpm']:,.0f} {100 * (1 - each['ratio']):.2g} "
        assert row.replace(",", "\u2009").replace("-", "\u2212") in text


def test_a_crossing_is_met_as_closely_as_is_said(document, paper):
    """By the plate solved at its speed."""
    meaning = serialise.schema()["$defs"]["VibrationReduction"]["properties"]["rpm"]["description"]
    tolerance = float(re.findall(r"\d+e-\d+", meaning)[0])
    met = document["reductions"]
    speeds = [*paper["rotor"]["speeds"], *(f"{each['rpm']} rpm" for each in met)]
    found = spindamp.campbell(changed(paper, rotor__speeds=speeds)).speeds[-len(met) :]
    for each, point in zip(met, found, strict=True):
        assert point.modes[each["mode"] - 1].frequency_hz == pytest.approx(each["frequency_hz"], rel=tolerance)


def test_a_diagram_has_the_orders_of_its_scene(paper):
    scene = parse(changed(paper, excitation__orders=[5, 2]))
    assert engine_orders.orders(scene) == (1, 2, 3, 4, 5, 6, 8, 12, 16)
    assert engine_orders.orders(scene.model_copy(update={"excitation": None})) == engine_orders.ENGINE_ORDERS


SHOWN = 6e-6
"""Relative rounding of what six digits show."""


def titles(page, name):
    """What the values of a figure say."""
    text = page.read_text(encoding="utf-8")
    start = text.index(f'<figure id="{name}">')
    return [unescape(title) for title in re.findall(r"<title>(.*?)</title>", text[start : text.index("</svg>", start)])]


def test_every_frequency_has_a_title(finished, document):
    modes = [
        (speed["rpm"], mode["frequency_hz"], number, mode)
        for speed in document["speeds"]
        for number, mode in enumerate(speed["modes"], 1)
    ]
    said, met = set(), 0
    for title in titles(finished / "report.html", "campbell"):
        head, rpm, hz, error = re.fullmatch(r"(.*): (\S+) rpm, (\S+) Hz(.*)", title).groups()
        if "meets" in head:
            order, label = re.fullmatch(r"(\d+)× meets (\w+) \d+", head).groups()
            assert int(order) in ENGINE_ORDERS
            assert float(hz) == pytest.approx(int(order) * float(rpm) / 60, rel=1e-4)
            assert label in {mode["family"] for *_, mode in modes}
            met += 1
            continue
        ((number, mode),) = [
            (number, mode)
            for at, frequency, number, mode in modes
            if (float(rpm), float(hz)) == pytest.approx((at, frequency), rel=SHOWN)
        ]
        assert head.startswith(mode["family"])
        assert head.endswith(f", mode {number}")
        assert float(error.split()[2]) == pytest.approx(100 * mode["error_estimate"], rel=0.06)
        said.add((rpm, hz))
    assert met > 5
    assert len(said) > 0.9 * len(modes), "but for points that lie on one another"


def test_damping_says_what_the_results_say(finished, document):
    curve = [
        (1e3 * point["amplitude"], 100 * point["damping_ratio"])
        for speed in document["speeds"]
        for point in speed["working"]["curve"]
    ]
    damping = titles(finished / "report.html", "damping")
    assert len(damping) > 50
    for title in damping:
        mm, percent = re.fullmatch(r".*: (\S+) mm, (\S+) %", title).groups()
        assert np.isclose(curve, (float(mm), float(percent)), rtol=SHOWN, atol=0.0).all(axis=1).any()


@needs_chromium
def test_titles_are_where_the_marks_are(standing):
    """Every marker of a branch lies under a value, which the pointer finds."""
    script = """
    const svg = document.querySelector('#campbell svg');
    svg.scrollIntoView();
    const middle = each => {
      const { left, right, top, bottom } = each.getBoundingClientRect();
      return [(left + right) / 2, (top + bottom) / 2];
    };
    const values = [...svg.querySelectorAll('.values > *')];
    return [...svg.querySelectorAll('use')].map(use => {
      const [x, y] = middle(use);
      const apart = ([a, b]) => Math.hypot(a - x, b - y);
      return Math.min(...values.map(value => apart(middle(value.lastChild))));
    }).concat(values.map(value => {
      const [x, y] = middle(value.lastChild);
      return value.parentNode.contains(document.elementFromPoint(x, y)) ? 0 : 99;
    }));
    """
    far = standing.returned(script)
    marks = [distance for distance in far if distance < 5]
    assert len(marks) > 80
    assert 99 not in far


@needs_chromium
def test_a_click_shows_that_mode_in_motion(standing):
    script = """
    const plate = document.querySelector('figure.viewer');
    return [...document.querySelectorAll('#campbell a[data-mode]')].map(mark => {
      mark.dispatchEvent(new MouseEvent('click', { bubbles: true, cancelable: true }));
      return [mark.querySelector('title').textContent, plate.querySelector('output').textContent,
              document.querySelectorAll('#campbell .now').length];
    });
    """
    found = standing.returned(script)
    assert len(found) >= 10
    for title, said, marked in found:
        rpm, hz = re.search(r": (\S+) rpm, (\S+) Hz", title).groups()
        assert f"at {float(rpm):,.0f} rpm:".replace(",", "\u2009") in said
        assert float(said.split()[-2].replace("\u2009", "")) == pytest.approx(float(hz), abs=0.006)
        assert marked == 1
