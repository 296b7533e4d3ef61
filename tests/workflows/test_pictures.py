"""The pictures as an engineer sees them: numbers that can be read, nothing cut off, nothing as a solid block."""

import re
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Any

import meshio
import numpy as np
import pytest
from matplotlib.patches import PathPatch
from matplotlib.text import Text

import workflows
from tests.workflows.browser import findings, needs_chromium
from tests.workflows.conftest import BALL, KNOWN, changed, measured_quickly
from tests.workflows.test_viewer import plate
from workflows.io.files import write_study
from workflows.report import figures as figures_of
from workflows.report import plots
from workflows.report.page import draw, render
from workflows.solve import damper as damper_stage
from workflows.solve.results import Results
from workflows.studies.work_precision import effects as effects_report
from workflows.studies.work_precision import report
from workflows.studies.work_precision.effects import EffectChange, EffectStudy
from workflows.studies.work_precision.timing import Choice, ConvergenceStudy, Setting, WorkPrecision

WORKING = [*np.geomspace(1e-3, 300.0, 8)]


@dataclass(frozen=True)
class Drawn:
    """A run, the pictures of its report, and the figures that they came from, laid out as they were drawn."""

    results: Results
    pictures: dict[str, Any]
    figures: list[Any]


@pytest.fixture(scope="module")
def captured():
    """The figures that are drawn, as matplotlib has them; of dampers whose curves are measured quickly."""
    drawn = []
    kept = plots.svg

    def keep(figure, *rest, **options):
        drawn.append(figure)
        return kept(figure, *rest, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plots, "svg", keep)
        patch.setattr(damper_stage, "damping_curve", measured_quickly)
        yield drawn


def drawn(captured, scene):
    captured.clear()
    results = workflows.run(scene)
    pictures = draw(results)
    assert captured
    return Drawn(results, pictures, list(captured))


@pytest.fixture(scope="module")
def spinning_up(captured):
    """A damper from rest on, where the ball moves as it likes for thousands of cycles, down to 0.1 g."""
    ball = {"damper__count": None, "damper__rolling_friction": "0.1 mm", "damper__damping_ratio": 0.0003}
    rotor = {"rotor__speeds": ["0 rpm", "20 rpm", "300 rpm", "10000 rpm"]}
    return drawn(captured, changed(KNOWN, **rotor, **ball, release={"displacement": ["20 mm", "5 mm"]}))


@pytest.fixture(scope="module")
def page_of_it(spinning_up):
    """Its report."""
    return render(spinning_up.results, spinning_up.pictures)


ROUGH = BALL | {"rolling_friction": "0.1 mm"}


@pytest.fixture(scope="module")
def with_a_hole(tmp_path_factory):
    """A mesh of triangles, of 20 cm by 8 cm without a square in its middle."""
    surface, path = plate(10, hole=True), tmp_path_factory.mktemp("mesh") / "hole.vtu"
    meshio.write(path, meshio.Mesh(surface.points, [surface.cells]))
    return path


@pytest.fixture(scope="module")
def holed(captured, with_a_hole):
    """A plate of triangles with a hole, and a damper off its middle."""
    scene = {
        "title": "Hole",
        "plate": {"mesh": str(with_a_hole), "thickness": "1 cm"},
        "material": {"youngs_modulus": "200 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"},
        "rotor": {"speeds": ["10 rpm", "3000 rpm"], "modes": 3},
        "damper": ROUGH | {"at": ["15 cm", "2 cm"], "mass": "2 g"},
        "release": {"displacement": ["4 mm", "0 mm"], "cycles": 100},
        "effects": {"coriolis": False, "large_deflection": False},
        "accuracy": {"frequency": 0.1},
    }
    return drawn(captured, scene)


LADDER = ConvergenceStudy(
    "whole pipeline: cut-off",
    "relative error of the cut-off at 10000 rpm",
    "the same scene",
    tuple(
        Setting(name, str(n), 10, time, (time, time), 1e-12 * 30.0**n)
        for name in ("pipeline", "thin plate, Argyris triangles, graded")
        for n, time in enumerate(WORKING)
    ),
)

SHORT = replace(LADDER, rows=tuple(replace(row, time_s=2.0 + n) for n, row in enumerate(LADDER.rows[:6])))
"""Within a decade, where each tick of a logarithmic axis has a label."""

AT = {"frequency_1": 9000.0, "impacts": 9000.0}

EFFECTS = EffectStudy(
    90 * "T",
    1e-3,
    (
        EffectChange("stress_stiffening", True, "", True, {"frequency_1": 0.4}, AT, time_s=0.1, time_share=0.2),
        EffectChange("spin_softening", True, "", True, {"frequency_1": -2e-4}, AT, time_s=0.1, time_share=0.1),
        EffectChange("coriolis", False, "", False, {"frequency_1": 3e-6}, AT, time_s=0.1, time_share=0.9),
        EffectChange("rotary_inertia", False, "", False, {"frequency_1": 1e-14}, AT, time_s=0.1, time_share=0.9),
        EffectChange("large_deflection", False, "", False, failed=40 * "no plate, "),
        EffectChange("ball_slip", False, "", False, remarks=("no cut-off without it",) * 9, time_share=0.3),
        EffectChange("impact_friction", True, "", True, {"impacts": 5e3}, AT, time_s=0.1, time_spread_s=(-1, 1)),
    ),
)


@pytest.fixture(scope="module")
def costs(captured):
    """What accuracy and effects cost."""
    captured.clear()
    report.study_plot(SHORT, "ladder0", 1e-3)
    report.study_plot(LADDER, "ladder1", 1e-3)
    report.overview([LADDER, LADDER], 1e-3)
    effects_report.draw(EFFECTS)
    return list(captured)


@pytest.fixture(scope="module")
def odd(captured):
    """One cycle of a nanometre, at loads eleven powers of ten apart."""
    release = {"displacement": (1e-9, 0.0), "cycles": 1}
    return drawn(captured, workflows.load("structure").changed(release=release, rotor={"speeds": (0.1, 3e4)}))


@pytest.fixture(params=["spinning_up", "holed", "odd", "costs"])
def figures(request):
    found = request.getfixturevalue(request.param)
    with plots.style():  # labels are made anew where they are asked for
        yield list(found.figures if isinstance(found, Drawn) else found)


def shown(axis):
    """Tick values and labels of an axis that are in view, in their order."""
    low, high = sorted(axis.get_transform().transform(axis.get_view_interval()))
    ticks = [
        *zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=True),
        *zip(axis.get_minorticklocs(), axis.get_minorticklabels(), strict=False),
    ]
    places = axis.get_transform().transform(np.array([value for value, _ in ticks]))
    slack = 1e-9 * (high - low)
    seen = [
        (value, label) for (value, label), at in zip(ticks, places, strict=True) if low - slack <= at <= high + slack
    ]
    return sorted((pair for pair in seen if pair[1].get_text()), key=lambda pair: pair[0])


def number(label):
    """What a label says, as matplotlib sets it."""
    plain = re.sub(r"[${}]|\\mathdefault", "", label).replace("\N{MINUS SIGN}", "-").replace("\\times", "e")
    mantissa, _, power = plain.replace("e10^", "e").replace("10^", "1e").partition("e")
    return float(f"{mantissa}e{power or 0}")


def test_every_tick_says_its_number(figures):
    for figure in figures:
        for axes in figure.axes:
            for axis in (axes.xaxis, axes.yaxis):
                ticks = [(value, label.get_text()) for value, label in shown(axis)]
                if all(re.search("(?<![\\\\a-z])[a-z]{3}", label) for _, label in ticks):
                    continue  # names, not numbers
                assert len(ticks) >= 2
                assert len({label for _, label in ticks}) == len(ticks)
                for value, label in ticks:
                    factor = number(axis.get_offset_text().get_text() or "1")
                    assert number(label) * factor == pytest.approx(value, rel=1e-9, abs=1e-300), (label, value)


def test_nothing_is_cut_off_and_no_labels_touch(figures):
    for figure in figures:
        paper, unseen = figure.bbox, outside_view(figure)
        for text in figure.findobj(lambda artist: isinstance(artist, Text) and artist.get_visible()):
            if not text.get_text().strip() or text in unseen:
                continue
            box = text.get_window_extent()
            assert min(box.x0 - paper.x0, paper.x1 - box.x1, box.y0 - paper.y0, paper.y1 - box.y1) >= -0.5, text
        for axes in figure.axes:
            for axis in (axes.xaxis, axes.yaxis):
                boxes = [label.get_window_extent() for _, label in shown(axis)]
                assert not any(one.overlaps(other) for one, other in pairwise(boxes)), axis


def outside_view(figure):
    """Labels of ticks beyond the axes' ends, which are not drawn."""
    every = [getattr(axes, f"{name}axis") for axes, name in product(figure.axes, "xy")]
    labels = {label for axis in every for label in (*axis.get_majorticklabels(), *axis.get_minorticklabels())}
    return labels - {label for axis in every for _, label in shown(axis)}


def test_nothing_is_a_solid_block(spinning_up):
    """A line turns at most thirty times an inch; 100 swings across a page, or chaos at rest, do so more often."""
    longest = max(len(p.damper.sdc) for p in spinning_up.results.speeds if p.damper)
    assert longest > 1000
    for figure in spinning_up.figures:
        for axes in figure.axes:
            for line in axes.lines:
                x, y = line.get_xydata().T
                steps = np.diff(y)
                turns = np.count_nonzero(np.diff(np.sign(steps[steps != 0])))
                along = np.ptp(axes.transData.transform(np.column_stack([x, y]))[:, 0]) / figure.dpi
                assert turns <= 30 * max(along, 0.1), axes.get_xlabel()


def test_envelopes_hold_the_curve(spinning_up):
    """What is drawn instead of every cycle reaches as far as the cycles do, and its mean is theirs."""
    damping = spinning_up.results.speeds[0].damper
    x, y = damping.amplitude_g, damping.sdc
    found = figures_of.envelope(x, y, np.geomspace(x.min(), x.max(), 81))
    assert found.high.max() == y.max()
    assert found.low.min() == y.min()
    assert (found.low <= found.mean).all()
    assert (found.mean <= found.high).all()
    assert len(found.x) <= 80
    assert (np.diff(found.x) > 0).all()
    one = figures_of.envelope(x, y, np.array([x.min(), x.max()]))
    assert one.mean[0] == pytest.approx(y.mean())
    assert one.x[0] == pytest.approx(x.mean())


def test_small_loads_have_digits(spinning_up, page_of_it):
    """20 rpm at 20 cm are 0.0895 g: no 0 in the table or the legend, and no two loads alike."""
    figures = spinning_up.figures
    assert spinning_up.results.speeds[1].load_g == pytest.approx((20 * np.pi / 30) ** 2 * 0.2 / 9.80665)
    assert "<td>0.0895</td>" in page_of_it
    legends = [
        sorted(text.get_text() for text in legend.get_texts()) for figure in figures for legend in figure.legends
    ]
    assert ["0 g", "0.0895 g", "20.1 g", "22\u2009365 g"] in legends
    assert ["0 rpm", "10\u2009000 rpm", "20 rpm", "300 rpm"] in legends


def test_a_cut_history_says_so(spinning_up, page_of_it):
    point = next(point for point in spinning_up.results.speeds if point.damper and point.damper.history)
    page = " ".join(page_of_it.split())
    assert point.damper.history.t[-1] < 0.5 * point.damper.duration
    assert f", the first {point.damper.history.t[-1]:.3g} s of {point.damper.duration:.3g} s" in page


def boundary(cells):
    """Edges of one cell only."""
    edges = [tuple(sorted((int(a), int(b)))) for cell in cells for a, b in pairwise([*cell, cell[0]])]
    return {(a, b) for a, b in edges if edges.count((a, b)) == 1}


def test_the_plate_at_rest_is_its_outline(holed, with_a_hole):
    """The mesh's boundary, the hole's among it."""
    surface = holed.results.surface
    mesh = meshio.read(with_a_hole)
    cells = surface.cells[1]
    assert len(cells) == len(mesh.get_cells_type("triangle"))
    expected = boundary(cells)
    assert len(expected) == len(boundary(mesh.get_cells_type("triangle")))
    assert {tuple(sorted(edge)) for edge in surface.outline.tolist()} == expected


def test_the_mesh_is_what_was_solved(holed):
    """Every cell, the clamped edges at the smallest x, and the damper where the scene has it, in mm."""
    surface = holed.results.surface
    (axes,) = (each.axes[0] for each in holed.figures if each.axes[0].get_xlabel().startswith("x, radial, mm"))
    paths = [patch.get_path() for patch in axes.patches if isinstance(patch, PathPatch)]
    cells, outline, root = (path.vertices.reshape(-1, n, 2) for path, n in zip(paths, (4, 2, 2), strict=True))
    points, triangles = 1e3 * surface.points[:, :2], surface.cells[1]
    assert np.allclose(cells[:, :3], points[triangles])
    assert np.array_equal(cells[:, 0], cells[:, 3])
    assert len(outline) == len(boundary(triangles))
    assert np.abs(root[:, :, 0]).max() < 1e-9
    assert np.linalg.norm(np.diff(root, axis=1), axis=2).sum() == pytest.approx(80.0)
    (damper,) = [line for line in axes.lines if line.get_label() == "damper"]
    assert damper.get_xydata().tolist() == [[150.0, 20.0]]
    assert axes.get_ylabel() == "y, across, mm"


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("damped", [True, False])
def test_every_plate_shows_its_mesh(damped, paper, tmp_path, spindamp, monkeypatch):
    for name in ("campbell", "velocity", "capacity", "damping_ratio", "cavity_path"):
        monkeypatch.setattr(figures_of, name, lambda _: None)
    taken = {} if damped else {"damper": None, "release": None}
    scene = changed(paper, rotor__speeds=["3500 rpm"], rotor__modes=1, accuracy__frequency=0.05, **taken)
    assert spindamp("run", scene, "--out", "out").status == 0
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    (figure,) = re.findall(r'<svg[^>]*aria-label="Mesh of the plate from above[^>]*>.*?</svg>', page, re.S)
    assert "clamped root" in figure
    assert ("damper" in re.sub("<[^>]+>", "", figure)) is damped
    assert "quadrilaterals, finer towards the edges; 10 mm thick" in " ".join(page.split())


def study():
    chosen = Choice("thin plate, Bogner-Fox-Schmit rectangles", f"40 × 16 {30 * 'rectangles'}", 1.2e-4, 1.1e-4)
    return WorkPrecision(90 * "T", {"frequency": 1e-3, "damping": 1e-3}, (LADDER,), {"plate": chosen})


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    write_study(study(), folder / "accuracy")
    write_study(EFFECTS, folder / "effects")
    return {name: folder / name / "report.html" for name in ("accuracy", "effects")}


def test_pages_and_files_have_one_drawing(pages):
    for name, path in pages.items():
        page = path.read_text(encoding="utf-8")
        assert page.count("<svg") == 1
        drawn = path.with_name(f"{name}.svg").read_text(encoding="utf-8")
        assert drawn.count("<svg") == 1
        assert "var(" not in drawn


@needs_chromium
def test_nothing_hinders_a_reader(pages):
    for path in pages.values():
        assert findings(path) == []


@pytest.fixture(scope="module")
def slow():
    """A ball that next to nothing holds: its cut-off lies far below the amplitudes at which it does anything."""
    scene = changed(KNOWN, rotor__speeds=["100 rpm"], damper__rolling_friction="0.1 um")
    return workflows.run(scene)


def many(found, count):
    """As at so many speeds, each with a load of its own."""
    (point,) = found.speeds
    loads = [1.0 * (k + 1) for k in range(count)]
    return replace(found, speeds=tuple(replace(point, rpm=load, load_g=load) for load in loads))


def legend(figure):
    return [text.get_text() for each in figure.legends for text in each.get_texts()]


@pytest.mark.parametrize(("count", "named"), [(3, 3), (16, 16), (17, 9), (120, 9)])
def test_a_legend_names_all_curves_or_some_from_end_to_end(count, named, slow):
    found = many(slow, count)
    for drawing, name, unit in ((figures_of.damping_ratio, "speed", "rpm"), (figures_of.capacity, "load", "g")):
        figure = drawing(found)
        said = legend(figure)
        assert len(said) == named
        assert {said[0], said[-1]} == {f"1 {unit}", f"{count} {unit}"}
        (title,) = (each.get_title().get_text() for each in figure.legends)
        assert title == (name if named == count else f"{name}, {named} of {count}")


def test_the_axis_of_amplitudes_is_that_of_the_curves(slow):
    (point,) = slow.speeds
    own, figure = point.damping_curve, figures_of.damping_ratio(slow)
    shown = own.amplitude[own.damping_ratio > 0]
    assert own.cutoff < 1e-2 * shown.min()
    low, high = figure.axes[0].get_xlim()
    assert low >= 0.09e3 * shown.min()
    assert high >= 1e3 * shown.max()


def test_a_tick_within_a_decade_of_its_curve_is_on_the_axis(slow):
    (point,) = slow.speeds
    least = float(point.damping_curve.amplitude[point.damping_curve.damping_ratio > 0].min())
    near = replace(point, damping_curve=replace(point.damping_curve, cutoff=least / 5))
    figure = figures_of.damping_ratio(replace(slow, speeds=(near,)))
    assert figure.axes[0].get_xlim()[0] < 1e3 * least / 5
