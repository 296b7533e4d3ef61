"""Values in a report's figures: their titles are those of the results, and marks lead to modes."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path
from typing import Any

import pytest

from tests.workflows.browser import driven, needs_chromium
from workflows.solve.engine_orders import ENGINE_ORDERS

SHOWN = 6e-6
"""Relative rounding of what six digits show."""


def titles(page: Path, name: str) -> list[str]:
    """What the values of a figure say."""
    text = page.read_text(encoding="utf-8")
    start = text.index(f'<figure id="{name}">')
    return [unescape(title) for title in re.findall(r"<title>(.*?)</title>", text[start : text.index("</svg>", start)])]


def test_every_frequency_has_a_title(finished: Path, document: dict[str, Any]) -> None:
    modes = [
        (speed["rpm"], mode["frequency_hz"], number, mode)
        for speed in document["speeds"]
        for number, mode in enumerate(speed["modes"], 1)
    ]
    said, met = set(), 0
    for title in titles(finished / "report.html", "campbell"):
        head, rpm, hz, error = re.fullmatch(r"(.*): (\S+) rpm, (\S+) Hz(.*)", title).groups()  # type: ignore[union-attr]
        if "meets" in head:
            order, label = re.fullmatch(r"(\d+)× meets (\w+) \d+", head).groups()  # type: ignore[union-attr]
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


def test_damping_and_books_say_what_the_results_say(finished: Path, document: dict[str, Any]) -> None:
    curve = {
        (1e3 * point["amplitude"], 100 * point["damping_ratio"])
        for speed in document["speeds"]
        for point in speed["working"]["curve"]
    }
    damping = titles(finished / "report.html", "damping")
    assert len(damping) > 50
    for title in damping:
        mm, percent = re.fullmatch(r".*: (\S+) mm, (\S+) %", title).groups()  # type: ignore[union-attr]
        assert any((float(mm), float(percent)) == pytest.approx((a, z), rel=SHOWN) for a, z in curve)
    books = titles(finished / "report.html", "books")
    told = {
        (float(share), float(joule)) for title in books for share, joule in re.findall(r": (\S+) %, (\S+) J", title)
    }
    for speed in document["speeds"]:
        energy = speed["damper"]["energy"]
        part = energy["structure"]
        assert (float(f"{100 * part / energy['initial']:.6g}"), float(f"{part:.6g}")) in told


@needs_chromium
def test_titles_are_where_the_marks_are(finished: Path) -> None:
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
    far = driven(finished / "report.html", script)
    marks = [distance for distance in far if distance < 5]
    assert len(marks) > 80
    assert 99 not in far


@needs_chromium
def test_a_click_shows_that_mode_in_motion(finished: Path) -> None:
    script = """
    const plate = document.querySelector('figure.viewer');
    return [...document.querySelectorAll('#campbell a[data-mode]')].map(mark => {
      mark.dispatchEvent(new MouseEvent('click', { bubbles: true, cancelable: true }));
      return [mark.querySelector('title').textContent, plate.querySelector('output').textContent,
              document.querySelectorAll('#campbell .now').length];
    });
    """
    found = driven(finished / "report.html", script)
    assert len(found) >= 10
    for title, said, marked in found:
        rpm, hz = re.search(r": (\S+) rpm, (\S+) Hz", title).groups()  # type: ignore[union-attr]
        assert f"at {float(rpm):,.0f} rpm:".replace(",", "\u2009") in said
        assert float(said.split()[-2].replace("\u2009", "")) == pytest.approx(float(hz), abs=0.006)
        assert marked == 1
