"""Pictures of many speeds: curves that are told apart, an axis that is used, words that can be read."""

from __future__ import annotations

from dataclasses import replace

import pytest
from matplotlib.figure import Figure

import workflows
from tests.workflows.conftest import KNOWN, changed
from workflows.report import figures
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
