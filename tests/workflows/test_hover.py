"""Values under the pointer in a report's figures: those of the results, and clicks that lead to a mode."""

from __future__ import annotations

import dataclasses
import math
import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from tests.workflows.browser import driven, needs_chromium
from workflows.results import crossings
from workflows.results.crossings import ENGINE_ORDERS

POINT = """
const at = (figure, s, k) => {
  const { hover } = figure, box = figure.querySelector('.live-box'), tip = figure.querySelector('.tip');
  const svg = [...box.querySelectorAll('svg[data-axes]')].find(svg => svg.getBoundingClientRect().width > 0);
  const place = hover.place([s, k]);
  if (!place) return null;
  const shown = svg.getBoundingClientRect(), scale = shown.width / svg.viewBox.baseVal.width;
  const [clientX, clientY] = [shown.left + place[0] * scale, shown.top + place[1] * scale];
  const spot = { clientX, clientY, bubbles: true };
  const say = () => [...tip.children].map(line => line.textContent);
  return { move: () => { box.dispatchEvent(new PointerEvent('pointermove', spot)); return say(); },
           click: () => box.dispatchEvent(new MouseEvent('click', spot)) };
};
const every = figure => figure.hover.data.series.flatMap((one, s) => one.x.map((x, k) => {
  const spot = at(figure, s, k);
  return spot && [one.name, ...spot.move()];
})).filter(said => said);
"""


SHOWN = 6e-6
"""Relative rounding of what six digits show."""


@pytest.mark.parametrize("order", [1, 3])
@pytest.mark.parametrize(("f0", "share"), [(100.0, 0.4), (50.0, 2.5)])
def test_crossings_of_a_mode_that_keeps_its_shape_are_exact(order: int, f0: float, share: float) -> None:
    """f² = f0² + s (Ω/2π)² and f = k Ω/2π give Ω/2π = f0 / √(k² - s), wherever k² > s."""
    if order**2 <= share:
        meeting = crossings._meeting(order, (0.0, f0), (60_000.0, math.hypot(f0, 1000 * math.sqrt(share))))
        assert meeting is None
        return
    exact = 60 * f0 / math.sqrt(order**2 - share)
    for low, high in ((0.0, 3 * exact), (0.9 * exact, 1.5 * exact)):
        ends = [(rpm, math.sqrt(f0**2 + share * (rpm / 60) ** 2)) for rpm in (low, high)]
        assert crossings._meeting(order, *ends) == pytest.approx(exact, rel=1e-12)
    beyond = [(rpm, math.sqrt(f0**2 + share * (rpm / 60) ** 2)) for rpm in (1.1 * exact, 2 * exact)]
    assert crossings._meeting(order, *beyond) is None


def test_a_crossing_at_a_speed_of_the_run_is_counted_once() -> None:
    points = [(0.0, 100.0), (6000.0, 100.0), (9000.0, 100.0)]
    met = [crossings._meeting(1, *pair) for pair in pairwise(points)]
    assert [rpm for rpm in met if rpm is not None] == [pytest.approx(6000.0)]


@needs_chromium
def test_the_campbell_diagram_says_what_the_results_say(finished: Path, document: dict[str, Any]) -> None:
    found = driven(finished / "report.html", POINT + "return every(document.querySelector('#campbell'))")
    modes = [
        (speed["rpm"], mode["frequency_hz"], number, mode)
        for speed in document["speeds"]
        for number, mode in enumerate(speed["modes"], 1)
    ]
    said = set()
    for _, head, values, note, *_ in found:
        rpm, hz = re.fullmatch(r"(\S+) rpm, (\S+) Hz", values).groups()  # type: ignore[union-attr]
        if head == "crossing":
            order, label = re.fullmatch(r"(\d+)× meets (\w+) \d+", note).groups()  # type: ignore[union-attr]
            assert int(order) in ENGINE_ORDERS
            assert float(hz) == pytest.approx(int(order) * float(rpm) / 60, rel=1e-4)
            assert label in {mode["family"] for *_, mode in modes}
            continue
        ((number, mode),) = [
            (number, mode)
            for at, frequency, number, mode in modes
            if (float(rpm), float(hz)) == pytest.approx((at, frequency), rel=SHOWN)
        ]
        assert head.startswith(mode["family"])
        assert note.startswith(f"mode {number}, ± ")
        assert float(note.split()[3]) == pytest.approx(100 * mode["error_estimate"], rel=0.06)
        said.add((rpm, hz))
    assert len(said) > 0.9 * len(modes), "but for points that lie on one another"


@needs_chromium
def test_a_click_shows_that_mode_in_motion(finished: Path, document: dict[str, Any]) -> None:
    script = (
        POINT
        + """
    const figure = document.querySelector('#campbell'), plate = document.querySelector('figure.viewer'), found = [];
    for (const [s, one] of figure.hover.data.series.entries()) for (const k of [0, one.x.length - 1]) {
      if (!one.leads[k]) continue;
      const spot = at(figure, s, k);
      spot.click();
      const said = plate.querySelector('output').textContent;
      found.push([one.x[k], one.y[k], said, figure.querySelectorAll('.now').length]);
    }
    const box = figure.querySelector('.live-box');
    figure.hover.choose(null);
    for (const key of ['ArrowRight', 'ArrowRight', 'ArrowUp', 'Enter'])
      box.dispatchEvent(new KeyboardEvent('keydown', { key }));
    return { found, keys: plate.querySelector('output').textContent };
    """
    )
    found = driven(finished / "report.html", script)
    assert len(found["found"]) >= 10
    for rpm, hz, said, marked in found["found"]:
        assert f"at {rpm:,.0f} rpm: {hz:.2f} Hz".replace(",", "\u2009") in said
        assert marked == 2, "in the wide drawing and in the narrow one"
    second = document["speeds"][1]
    assert f"{second['rpm']:,.0f}".replace(",", "\u2009") in found["keys"]
    assert any(f"{mode['frequency_hz']:.2f}" in found["keys"] for mode in second["modes"])


@needs_chromium
def test_damping_and_books_say_what_the_results_say(finished: Path, document: dict[str, Any]) -> None:
    script = POINT + "return ['#damping', '#books'].map(name => every(document.querySelector(name)))"
    damping, books = driven(finished / "report.html", script)
    curve = {
        (1e3 * point["amplitude"], 100 * point["damping_ratio"])
        for speed in document["speeds"]
        for point in speed["working"]["curve"]
    }
    assert len(damping) > 50
    for _, _, values, *_ in damping:
        mm, percent = re.fullmatch(r"(\S+) mm, (\S+) %", values.replace("·10^−", "e-")).groups()  # type: ignore[union-attr]
        assert any((float(mm), float(percent)) == pytest.approx((a, z), rel=SHOWN) for a, z in curve)
    told = {
        (float(share), float(joule)) for *_, note in books for share, joule in re.findall(r": (\S+) %, (\S+) J", note)
    }
    for speed in document["speeds"]:
        energy = speed["damper"]["energy"]
        part = energy["structure"]
        assert (float(f"{100 * part / energy['initial']:.6g}"), float(f"{part:.6g}")) in told


def test_axes_in_the_drawing_are_where_the_curves_are(finished: Path) -> None:
    """A marker of the first branch stands where the axes put its values."""
    import json

    page = (finished / "report.html").read_text(encoding="utf-8")
    drawn = re.search(
        r'<svg[^>]*aria-label="Campbell[^>]*data-axes=\'([^\']*)\'|data-axes=\'([^\']*)\'',
        page[page.index('id="campbell"') :],
    )
    assert drawn is not None
    frame = json.loads(drawn[1] or drawn[2])[0]
    data = json.loads(re.search(r'class="points">(.*?)</script>', page[page.index('id="campbell"') :], re.S)[1])  # type: ignore[index]
    one, (left, right, top, bottom) = data["series"][0], frame["box"]
    x = left + (one["x"][1] - frame["x"][0]) / (frame["x"][1] - frame["x"][0]) * (right - left)
    y = bottom + (one["y"][1] - frame["y"][0]) / (frame["y"][1] - frame["y"][0]) * (top - bottom)
    svg = page[page.index("<svg", page.index('id="campbell"')) :].split("</svg>")[0]
    places = [(float(a), float(b)) for a, b in re.findall(r'<use [^>]*?x="([\d.]+)" y="([\d.]+)"', svg)]
    assert any(math.hypot(a - x, b - y) < 0.1 for a, b in places)


def test_results_without_modes_have_no_crossings(finished: Path) -> None:
    from workflows.scene.file import load
    from workflows.solve.records import Results, SpeedPoint

    scene = load("structure").scene
    results = Results(scene=scene, effects={}, speeds=(SpeedPoint(0.0, 0.0, 0.1, 0.0),))
    assert crossings.crossings(results) == []
    assert crossings.crossings(dataclasses.replace(results, speeds=())) == []
