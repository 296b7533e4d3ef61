"""Pictures of many speeds: curves that are told apart, an axis that is used, words that can be read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

import workflows
from tests.workflows.conftest import KNOWN, changed
from workflows.io.files import Curve
from workflows.report import figures, plots
from workflows.solve.results import Results

pytestmark = pytest.mark.usefixtures("undrawn", "quickly")


@pytest.fixture(scope="module")
def slow() -> Results:
    """A ball that next to nothing holds: its cut-off lies far below the amplitudes at which it does anything."""
    scene = changed(KNOWN, rotor__speeds=["100 rpm"], damper__rolling_friction="0.1 um")
    return workflows.run(scene)


def many(found: Results, count: int) -> Results:
    """As at so many speeds, each with a load of its own."""
    (point,) = found.speeds
    loads = [1.0 * (k + 1) for k in range(count)]
    return replace(found, speeds=tuple(replace(point, rpm=load, load_g=load) for load in loads))


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for each in figure.legends for text in each.get_texts()]


@pytest.mark.parametrize(("count", "named"), [(3, 3), (16, 16), (17, 9), (120, 9)])
def test_a_legend_names_all_curves_or_some_from_end_to_end(count: int, named: int, slow: Results) -> None:
    found = many(slow, count)
    for figure in (figures.damping_ratio(found), figures.capacity(found)):
        said = legend(figure)
        assert len(said) == named
        assert {said[0], said[-1]} == {"1 g", f"{count} g"}
        (title,) = (each.get_title().get_text() for each in figure.legends)
        assert title == ("load" if named == count else f"load, {named} of {count}")


def test_the_axis_of_amplitudes_is_that_of_the_curves(slow: Results) -> None:
    (point,) = slow.speeds
    own, figure = point.working, figures.damping_ratio(slow)
    shown = own.amplitude[own.damping_ratio > 0]
    assert own.cutoff < 1e-2 * shown.min()
    low, high = figure.axes[0].get_xlim()
    assert low >= 0.09e3 * shown.min()
    assert high >= 1e3 * shown.max()


def test_a_tick_within_a_decade_of_its_curve_is_on_the_axis(slow: Results) -> None:
    (point,) = slow.speeds
    least = float(point.working.amplitude[point.working.damping_ratio > 0].min())
    near = replace(point, working=replace(point.working, cutoff=least / 5))
    figure = figures.damping_ratio(replace(slow, speeds=(near,)))
    assert figure.axes[0].get_xlim()[0] < 1e3 * least / 5


def test_no_dashed_line_crosses_the_words() -> None:
    """Lines at these shares of the axis, drawn upon each other, each with words of its own."""
    shares = (0.05, 0.3, 0.5, 0.6, 0.75, 0.9, 0.97)
    with plots.style():
        figure, (axes,) = plots.canvas(3.1)
        axes.set(xscale="log", yscale="log", xlim=(1e-2, 1e2), ylim=(1e-3, 1))
        for share in shares:
            figures._beside(axes, 1e-3 * 10 ** (4 * share - 2))
        figure.draw_without_rendering()
    frame = axes.get_window_extent()
    for share, words, line in zip(shares, axes.texts, axes.lines, strict=True):
        box = words.get_window_extent()
        x = axes.transData.transform((line.get_xdata()[0], 1e-2))[0]
        assert not box.x0 <= x <= box.x1, share
        assert frame.x0 <= box.x0, share
        assert box.x1 <= frame.x1, share


def test_a_family_looks_the_same_in_every_diagram() -> None:
    """Whatever order they come in."""
    looks = []
    for names in (["flap 1", "lag 1", "twist 1"], ["flap 1", "twist 1", "chord 1", "lag 1"]):
        tracks = [Curve("", name, "", "", np.arange(3.0), np.arange(3.0)) for name in names]
        _, (axes,) = plots.canvas(3.0)
        for track in tracks:
            figures._branch(axes, track)
        looks.append(
            {name: (line.get_color(), line.get_marker()) for name, line in zip(names, axes.lines, strict=True)}
        )
    assert all(looks[0][name] == looks[1][name] for name in looks[0])
    assert len({*looks[0].values(), *looks[1].values()}) == 4
    assert plots.of_family("flap") == (plots.CATEGORIES[0], "o")
