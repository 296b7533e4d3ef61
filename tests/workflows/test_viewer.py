"""The plate in three dimensions: what is packed into a page, and what a browser makes of it."""

import base64
import dataclasses
import json
import re
from pathlib import Path

import numpy as np
import pytest

from tests.workflows.browser import NO_GL, VIEWER, driven, needs_chromium
from workflows.report import mode_viewer
from workflows.report.page import load_results
from workflows.solve.results import SMOOTH, Mode, SpeedPoint, Surface, bare_surface

LENGTH, WIDTH, HOLE = 0.2, 0.08, 0.02
SPEEDS = (0.0, 3000.0, 6000.0)
SCRIPT = Path(mode_viewer.__file__).parents[1] / "templates" / "viewer.js"

COUNT_COLOURS = """
const count = () => {
  const seen = pixels(), found = new Set();
  let drawn = 0, sum = 0;
  for (let i = 0; i < seen.length; i += 4) if (seen[i + 3]) {
    drawn++; sum = (31 * sum + i + seen[i] + seen[i + 1] * 7 + seen[i + 2] * 13) % 1000003;
    found.add(seen[i] >> 4 << 8 | seen[i + 1] >> 4 << 4 | seen[i + 2] >> 4);
  }
  return { share: drawn / (seen.length / 4), colours: found.size, sum };
};
"""


def plate(cells, kind="triangle", hole=False):
    """A rectangle of cells along, with a square hole of twice HOLE in its middle or not."""
    from fem.meshes.planform import rectangle

    mesh = rectangle(LENGTH, WIDTH, cells, 2 * (cells // 5))
    if kind == "triangle":
        mesh = mesh.to_meshtri()
    if hole:
        middle = mesh.p[:, mesh.t].mean(axis=1)
        mesh = mesh.remove_elements(np.flatnonzero((abs(middle[0] - LENGTH / 2) < HOLE) & (abs(middle[1]) < HOLE)))
    return bare_surface(mesh)


def swinging(surface, modes=4):
    """The same with bending and stretching shapes that change from speed to speed."""
    x, y = surface.points.T[:2] / LENGTH
    shapes = np.zeros((len(SPEEDS), modes, len(x), 3))
    for i in range(len(SPEEDS)):
        for k in range(modes):
            shapes[i, k, :, 2] = x**2 * np.cos((k + 0.1 * i) * x) * (1 + 0.3 * (k % 2) * y)
            shapes[i, k, :, 1] = 0.1 * k * x**2
    return dataclasses.replace(surface, shapes=shapes, at=tuple(range(len(SPEEDS))))


def points_of(speeds=SPEEDS, modes=4):
    named = tuple(Mode(100.0 * (k + 1), f"flap{k}", branch=k) for k in range(modes))
    return tuple(SpeedPoint(rpm * np.pi / 30, rpm, LENGTH, 0.0, named) for rpm in speeds)


def area(points, triangles):
    a, b, c = points[triangles].transpose(1, 2, 0)[:, :2]
    return 0.5 * np.abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def read(data, number):
    """A packed displacement (n, 3), as the page's script reads it."""
    found = []
    for along in data["shapes"]:
        n = len(base64.b64decode(data["points"])) // 4
        if not along["rank"]:
            found.append(np.zeros(n))
            continue
        vectors = np.frombuffer(base64.b64decode(along["vectors"]), "<i2").reshape(along["rank"], -1)
        shares = np.frombuffer(base64.b64decode(along["shares"]), "<f4").reshape(-1, along["rank"])
        found.append(shares[number] @ vectors * along["largest"] / 32767)
    return np.column_stack(found)


@pytest.mark.parametrize("kind", ["triangle", "quad"])
def test_what_is_packed_is_what_was_there(kind):
    surface = swinging(plate(20, kind))
    view = mode_viewer.of_surface(surface, points_of())
    data = json.loads(view.data)
    assert not view.thinned
    places = np.frombuffer(base64.b64decode(data["points"]), "<u2").reshape(-1, 2) / 65535 * data["span"] + data["low"]
    assert np.abs(places - surface.points[:, :2]).max() < 1e-5 * LENGTH
    for number, shape in enumerate(surface.shapes.reshape(-1, *surface.shapes.shape[2:])):
        size = np.linalg.norm(shape, axis=1).max()
        found = read(data, number)
        assert np.linalg.norm(found, axis=1).max() == pytest.approx(1.0, abs=2 * mode_viewer.ERROR)
        sign = np.sign((found * shape).sum())
        assert np.abs(sign * found * size - shape).max() <= 2 * mode_viewer.ERROR * size


def test_motion_a_quarter_of_a_period_behind_is_kept():
    surface = swinging(plate(20))
    behind = np.roll(surface.shapes, 1, axis=-1)
    view = mode_viewer.of_surface(dataclasses.replace(surface, behind=behind), points_of())
    data = json.loads(view.data)
    count = len(SPEEDS) * 4
    for number in range(count):
        shape, late = (found.reshape(count, -1, 3)[number] for found in (surface.shapes, behind))
        size = np.sqrt((shape**2 + late**2).sum(axis=1).max())
        swing, lag = read(data, number), read(data, count + number)
        sign = np.sign((swing * shape).sum())
        assert np.abs(sign * swing * size - shape).max() <= 2 * mode_viewer.ERROR * size
        assert np.abs(sign * lag * size - late).max() <= 2 * mode_viewer.ERROR * size


@pytest.mark.parametrize("hole", [False, True])
@pytest.mark.parametrize("kind", ["triangle", "quad"])
def test_a_thinned_surface_is_the_plate_still(kind, hole):
    surface = plate(100, kind, hole)
    drawn = mode_viewer.thinned(surface, 600)
    assert 300 < len(drawn.kept) < 900
    assert drawn.edges is None, "triangles of our own are not passed off as cells"
    places = surface.points[drawn.kept]
    whole = LENGTH * WIDTH - 4 * HOLE**2 * hole
    assert area(places, drawn.triangles).sum() == pytest.approx(whole, rel=2e-3)
    x, y = places[:, 0], places[:, 1]
    on_rim = np.isclose(x, 0) | np.isclose(x, LENGTH) | np.isclose(np.abs(y), WIDTH / 2)
    rim = np.zeros(len(places), bool)
    rim[drawn.outline] = True
    assert rim[on_rim].all(), "the boundary is the plate's"
    lengths = np.linalg.norm(np.diff(places[drawn.outline], axis=1)[:, 0], axis=1)
    around = 2 * (LENGTH + WIDTH) + 8 * HOLE * hole
    assert lengths.sum() == pytest.approx(around, rel=1e-2), "and no scribble"
    assert np.allclose(places[drawn.root][..., 0], 0.0)
    held = np.linalg.norm(np.diff(places[drawn.root], axis=1)[:, 0], axis=1).sum()
    assert held == pytest.approx(WIDTH, rel=1e-9)


def test_a_million_unknowns_are_thinned():
    view = mode_viewer.of_surface(swinging(plate(640)), points_of())
    assert view.of > 160_000, "three unknowns each, and two slopes: a million"
    assert view.thinned
    assert view.points <= 1.5 * mode_viewer.POINTS
    assert len(view.data) < 150_000


def test_a_surface_in_space_is_thinned_to_points_of_its_own_without_a_dent():
    """Of a lens, bent and twisted, a fifth of the points enclose the same volume, by the divergence theorem."""
    turn, along = np.meshgrid(np.linspace(0, 2 * np.pi, 60, endpoint=False), np.linspace(0, 0.3, 40))
    y, z = 0.05 * np.cos(turn), 0.004 * np.sin(turn) + 0.01 * np.cos(turn) ** 2
    c, s = np.cos(2 * along), np.sin(2 * along)
    ring = np.stack([along, c * y - s * z, s * y + c * z], axis=2)
    points = np.vstack([ring.reshape(-1, 3), ring[0].mean(axis=0), ring[-1].mean(axis=0)])
    number = np.arange(40 * 60).reshape(40, 60)
    a, b, u, v = number[:-1], np.roll(number, -1, axis=1)[:-1], number[1:], np.roll(number, -1, axis=1)[1:]
    ends = [(2400, number[0, k], number[0, k - 1]) for k in range(60)]
    ends += [(2401, number[-1, k - 1], number[-1, k]) for k in range(60)]
    triangles = np.vstack(
        [np.stack([a, b, v], axis=2).reshape(-1, 3), np.stack([a, v, u], axis=2).reshape(-1, 3), ends]
    )
    held = np.column_stack([number[0], np.roll(number[0], -1)])
    none = np.zeros((0, 0, len(points), 3))
    surface = Surface(points, ("triangle", triangles), held, held, none, (), frame=np.eye(3))
    drawn = mode_viewer.thinned(surface, 480)

    def enclosed(corners):
        return float(abs(np.linalg.det(corners).sum())) / 6

    assert 300 < len(drawn.kept) <= 500
    assert np.isin(drawn.root, np.flatnonzero(np.isin(drawn.kept, [*number[0], 2400]))).all()
    assert len(drawn.root) > 5
    assert enclosed(points[drawn.kept][drawn.triangles]) == pytest.approx(enclosed(points[triangles]), rel=0.02)


def test_the_script_is_small_and_fetches_nothing():
    text = SCRIPT.read_text(encoding="utf-8")
    assert len(text) < 60_000
    assert not re.search(r"https?:|fetch\(|XMLHttpRequest|import\s*\(|eval\(|</script", text)


def test_a_report_stays_small(finished):
    assert (finished / "report.html").stat().st_size < 500_000


def test_a_coarse_mesh_is_looked_at_between_its_points(finished):
    surface = load_results(finished).surface
    fine = surface.finer
    assert len(surface.points) < 0.5 * len(fine.points) <= 0.75 * SMOOTH
    data = json.loads((mode_viewer.view(load_results(finished)) or pytest.fail("a plate")).data)
    assert len(base64.b64decode(data["points"])) == 4 * len(fine.points)
    assert len(base64.b64decode(data["edges"])) == 4 * len(fine.lines), "the cells are the mesh's, not their parts"
    there = {tuple(place) for place in np.round(fine.points[:, :2], 9).tolist()}
    assert {tuple(place) for place in np.round(surface.points[:, :2], 9).tolist()} <= there
    assert fine.shapes.shape[:2] == surface.shapes.shape[:2]
    place = {tuple(place): k for k, place in enumerate(np.round(fine.points[:, :2], 9).tolist())}
    at = [place[tuple(each)] for each in np.round(surface.points[:, :2], 9).tolist()]
    largest = np.abs(surface.shapes).max(axis=(2, 3), keepdims=True)
    for drawn, found in ((fine.shapes, surface.shapes), (fine.behind, surface.behind)):
        assert np.abs((drawn[:, :, at] - found) / largest).max() <= 2.0**-15, "16 bits"
    assert (finished / "results.nc").stat().st_size < 650_000, "no more digits than a picture shows"


@needs_chromium
def test_the_plate_is_drawn_and_turns(standing):
    script = """
    figure.viewer.play(true);  // frames by hand: a page that is only written out has none
    const now = performance.now(); figure.viewer.frame(now + 60); const before = count();
    figure.viewer.frame(now + 160); const after = count();
    figure.viewer.play(false);
    const first = count();
    const press = key => canvas.dispatchEvent(new KeyboardEvent('keydown', { key }));
    press('ArrowLeft'); const by_key = count();
    const drag = (name, x) => canvas.dispatchEvent(new PointerEvent(name, { pointerId: 1, clientX: x, clientY: 9 }));
    drag('pointerdown', 10); drag('pointermove', 70); drag('pointerup', 70); const by_hand = count();
    press('Home'); const home = count();
    press(' '); const plays = form.play.textContent;
    return { live: figure.classList.contains('live'), moves: before.sum !== after.sum, first, by_key, by_hand,
             home, plays,
             remark: figure.querySelector('.viewer-remark').textContent };
    """
    found = standing.returned(VIEWER + COUNT_COLOURS + script)
    assert found["live"]
    assert found["moves"]
    assert found["remark"] == ""
    assert 0.05 < found["first"]["share"] < 0.6
    assert found["first"]["colours"] > 100
    assert len({found[name]["sum"] for name in ("first", "by_key", "by_hand")}) == 3
    assert found["home"] == found["first"]
    assert found["plays"] == "pause"


@needs_chromium
def test_every_mode_at_every_speed_is_there(standing, document):
    script = """
    figure.viewer.play(false);
    const found = [];
    for (let at = 0; at < form.speed.options.length; at++) {
      figure.viewer.show(at, 0);
      for (let mode = 0; mode < form.mode.options.length; mode++) {
        form.mode.selectedIndex = mode; form.mode.dispatchEvent(new Event('change'));
        found.push([figure.querySelector('output').textContent, count().sum]);
      }
    }
    figure.viewer.show(0, 3); const family = figure.querySelector('output').textContent.split(' ')[0];
    form.speed.selectedIndex = form.speed.options.length - 1; form.speed.dispatchEvent(new Event('change'));
    return { found, family, then: figure.querySelector('output').textContent.split(' ')[0] };
    """
    found = standing.returned(VIEWER + COUNT_COLOURS + script)
    rpm = [f"{speed['rpm']:,.0f}".replace(",", "\u2009") for speed in document["speeds"]]
    said = [
        f"{mode['family']} mode at {at} rpm: {mode['frequency_hz']:.2f} Hz"
        for at, speed in zip(rpm, document["speeds"], strict=True)
        for mode in speed["modes"]
    ]
    assert [text for text, _ in found["found"]] == said
    assert len({drawn for _, drawn in found["found"]}) == len(said), "no two look alike"
    assert found["family"] == found["then"], "another speed shows the mode that this one has become"


@needs_chromium
def test_without_webgl_the_still_picture_stands_and_the_page_says_so(finished):
    script = VIEWER + "return [figure.querySelector('.viewer-remark').textContent, form.hidden,"
    script += " getComputedStyle(figure.querySelector('img')).display, getComputedStyle(canvas).display]"
    said, hidden, still, moving = driven(finished / "report.html", script, before=NO_GL)
    assert "not support WebGL2" in said
    assert hidden
    assert still == "block"
    assert moving == "none"


@needs_chromium
def test_in_print_the_still_picture_stands(standing):
    paper = standing.file("Page.printToPDF", printBackground=True)
    assert paper.startswith(b"%PDF")
    assert b"/Subtype /Image" in paper or b"/Subtype/Image" in paper
