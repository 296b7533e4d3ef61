"""`results.plot`: axes and views of modes that hold what the results hold, and that a notebook shows."""

import itertools
from base64 import b64encode
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

import workflows
from workflows.io import files
from workflows.report import figures, plots
from workflows.solve import limits


def test_campbell_has_the_frequencies(coarse, tmp_path):
    axes = coarse.plot.campbell()
    drawn = [line.get_xydata() for line in axes.get_lines()]
    for track in files.campbell(coarse):
        assert any(np.array_equal(np.column_stack([track.x, track.y]), line) for line in drawn)
    assert axes.get_xlabel() == "rotation speed, rpm"
    path = tmp_path / "campbell.png"
    axes.figure.savefig(path)
    assert path.stat().st_size > 5000


def test_a_mode_keeps_its_name_from_the_lowest_speed(coarse, monkeypatch):
    """A flap that is a twist at all speeds but the first; the marks of the diagram say where."""
    for other in ("mesh", "velocity", "capacity", "damping_ratio", "cavity_path"):
        monkeypatch.setattr(figures, other, lambda _: None)
    order = sorted(coarse.speeds, key=lambda point: point.rpm)
    numbers = {point.rpm: next(k for k, m in enumerate(point.modes) if m.branch == 0) for point in order}

    def renamed(point):
        family = "flap" if point in order[:1] else "twist"
        modes = list(point.modes)
        modes[numbers[point.rpm]] = replace(modes[numbers[point.rpm]], family=family)
        return replace(point, modes=tuple(modes))

    changing = replace(coarse, speeds=tuple(map(renamed, coarse.speeds)))
    assert "campbell_flap_1" in [track.name for track in files.campbell(changing)]
    page = figures.report(changing)["campbell"]
    assert page.count("flap 1 (twist here), mode ") == len(order) - 1 > 0
    assert "here), mode " not in figures.report(coarse)["campbell"]


def test_damping_has_the_curves_pale_beyond_what_the_structure_endures(coarse):
    def drawn(results):
        lines = results.plot.damping().get_lines()
        return [[each.get_xydata() for each in lines if (each.get_alpha() is None) is full] for full in (True, False)]

    for strain in (1e-3, 1.0):  # by which no amplitude is too large, and some are
        speeds = tuple(replace(point, root_strain=strain * 4.0) for point in coarse.speeds)
        strained = replace(coarse, speeds=speeds)
        full, pale = drawn(strained)
        for line, point in zip(files.damping_ratio(strained), speeds, strict=True):
            limit, shown = limits.endured(strained, point.omega), line.y > 0
            curve = np.column_stack([1e3 * line.x, 100 * line.y])[shown]
            within = curve[:, 0] <= 1e3 * limit
            rest = curve[max(int(within.sum()) - 1, 0) :]
            assert not within.any() or any(np.array_equal(curve[within], each) for each in full)
            assert within.all() or any(np.array_equal(rest, each) for each in pale)
        assert (pale != []) == (strain == 1.0)


def test_ringdown_and_mesh_are_axes(coarse):
    assert coarse.plot.ringdown().get_xlabel() == "time, ms"
    axes = coarse.plot.mesh()
    at = coarse.scene.damper.at
    marks = [line.get_xydata() for line in axes.get_lines() if line.get_label() == "damper"]
    assert marks[0] == pytest.approx(1e3 * np.array([at]))


@pytest.mark.parametrize("name", ["campbell", "damping", "ringdown", "mesh"])
def test_a_notebook_shows_the_figure_of_a_plot(coarse, name):
    """Which goes by pyplot's current figure, and is no new one where axes are named."""
    before = pyplot.get_fignums()
    axes = getattr(coarse.plot, name)()
    assert pyplot.gcf() is axes.figure
    assert len(pyplot.get_fignums()) == len(before) + 1
    labels = {text.get_text() for text in axes.figure.findobj(Text)}
    pyplot.close(axes.figure)
    figure, (left, right) = pyplot.subplots(1, 2)
    left.plot([1, 2], [3, 4])
    assert getattr(coarse.plot, name)(ax=right) is right
    assert right.get_xlabel() == axes.get_xlabel()
    assert len(right.lines) + len(right.patches) == len(axes.lines) + len(axes.patches) > 0
    assert {text.get_text() for text in right.findobj(Text)} >= {label for label in labels if label.isalpha()}
    assert len(left.lines) == 1
    assert left.get_legend() is None
    assert figure.legends == []
    pyplot.close(figure)
    assert pyplot.get_fignums() == before


@pytest.mark.parametrize("wrong", [Figure(), np.array([None, None]), 3])
def test_a_plot_takes_axes_alone(coarse, wrong):
    with pytest.raises(TypeError, match=rf"^ax must be axes of matplotlib, .* got {type(wrong).__name__}$"):
        coarse.plot.damping(ax=wrong)


@pytest.mark.parametrize("name", ["campbell", "damping", "ringdown", "mesh"])
def test_no_placeholder_of_a_page_is_left(coarse, name):
    from matplotlib.colors import to_hex

    places = {plots.INK, plots.MUTED, plots.RULE, plots.PAPER, *plots.shades(len(coarse.speeds))}
    figure = getattr(coarse.plot, name)().figure
    pyplot.close(figure)
    for artist in figure.findobj():
        for part in ("color", "edgecolor", "facecolor"):
            found = getattr(artist, f"get_{part}", lambda: None)()
            try:
                colour = to_hex(found)
            except (TypeError, ValueError):
                continue
            assert colour not in places, (artist, part)


def test_a_mode_moves_as_its_shape(coarse):
    plotter = coarse.plot.mode(2, rpm=0).plotter()
    try:
        plate = next(mesh for mesh in plotter.meshes if mesh.n_cells == len(coarse.surface.cells[1]))
        moved = np.asarray(plate.points) - coarse.surface.points
        shape = coarse.surface.shapes[0, 1]
        assert np.abs(moved / np.abs(moved).max() - shape / np.abs(shape).max()).max() < 1e-4
    finally:
        plotter.close()


def test_a_notebook_shows_a_mode_as_a_picture(coarse, monkeypatch, tmp_path):
    """Also where no screen is, and of the mode that was asked for."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    pictures = [coarse.plot.mode(number, rpm=0) for number in (1, 2)]
    first, second = (Image.open(BytesIO(view._repr_png_())).convert("RGBA") for view in pictures)
    assert first.size != second.size or first.tobytes() != second.tobytes()
    page = pictures[1]._repr_html_()
    assert b64encode(pictures[1]._repr_png_()).decode() in page
    assert f"mode 2, {coarse.speeds[0].modes[1].family}, {coarse.speeds[0].modes[1].frequency_hz:.2f} Hz" in page
    path = pictures[1].screenshot(tmp_path / "mode.png")
    assert path.read_bytes() == pictures[1]._repr_png_()
    with pytest.raises(workflows.BadInput, match="no screen to open a window on: expected screenshot"):
        pictures[1].show()


def test_a_mode_within_the_plane_is_drawn_without_a_warning(coarse):
    surface = coarse.surface.finer or coarse.surface
    flat = replace(surface, shapes=surface.shapes * [1.0, 1.0, 0.0], finer=None)
    assert Image.open(BytesIO(figures.mode_picture(flat, 0, 1))).convert("L").getextrema()[0] < 200


def test_what_is_not_there_is_said(coarse):
    for number, rpm, says in (
        (4, 0, "expected a mode from 1 to 3"),
        (1.5, 0, "expected a mode from 1 to 3"),
        (1.0, 0, "expected a mode from 1 to 3"),
        (1, "4000 rpm", "expected a number of revolutions per minute"),
        (1, 12345, "expected a speed with shapes"),
        (1, 10, r"^rpm = 10: expected a speed with shapes"),
    ):
        with pytest.raises(workflows.BadInput, match=says):
            coarse.plot.mode(number, rpm=rpm)
    structure = workflows.run("structure")
    for name in ("campbell", "mesh", "mode"):
        with pytest.raises(workflows.BadInput, match="nothing to draw"):
            getattr(structure.plot, name)()


@pytest.mark.parametrize("ends", [(1.0, 1e-9), (0.5, 2e-6), (1e-3, 1e-8), (2e-2, 1e-3), (1e-9, 1.0)])
def test_a_logarithmic_axis_has_a_few_numbers_that_do_not_overlap(ends):
    """Also one that runs backwards, as that of errors does."""
    with plots.style():
        figure, (axes,) = plots.canvas(3.0)
        axes.set(xscale="log", xlim=ends)
        plots.plain([axes])
        figure.canvas.draw()
        boxes = [label.get_window_extent() for label in axes.get_xticklabels() if label.get_text()]
        low, high = sorted(axes.get_window_extent().intervalx)
        inside = sorted((box.x0, box.x1) for box in boxes if low - 1 <= (box.x0 + box.x1) / 2 <= high + 1)
    assert len(inside) >= 2
    assert all(one[1] < other[0] for one, other in itertools.pairwise(inside))
