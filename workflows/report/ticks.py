"""Tick labels that are plain numbers: never 0 for 0.1, no factor hidden in a corner, no two that touch.

matplotlib is imported where an axis is labelled.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows import wording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

_MOST_DECIMALS = 6
_LARGEST_PLAIN = 1e7
_DECADES = (1e-3, 1e5)
"""Least and most that a logarithmic axis says without powers of ten."""

_INSIDE = 0.68
"""What margins leave of a figure's width, at least."""

_DIGIT, _GAP = 4.8, 8.0
"""Points that a digit takes, and that are to be between two labels."""

_MANY = 8
"""Labels along an axis that is not too short for them."""

Labels = Callable[[Sequence[float]], list[str]]


def even(values: Sequence[float]) -> list[str]:
    """Labels of evenly spaced ticks: all with as many decimals as tell them apart."""
    apart = np.diff(np.unique(values))
    largest = max((abs(value) for value in values), default=0.0)
    step = float(apart.min()) if apart.size else largest
    if step == 0.0:
        return ["0" for _ in values]
    places = next((n for n in range(_MOST_DECIMALS + 1) if all(_ends_at(v, n, step) for v in values)), None)
    if places is not None and largest < _LARGEST_PLAIN:
        return [wording.fixed(round(value, places) + 0.0, places) for value in values]
    power = math.floor(math.log10(largest))
    mantissas = [value / 10.0**power for value in values]
    places = next((n for n in range(15) if all(_ends_at(m, n, step / 10.0**power) for m in mantissas)), 15)
    return [f"{wording.fixed(m + 0.0, places)}·{_power(power)}" if m else "0" for m in mantissas]


def logarithmic(values: Sequence[float]) -> list[str]:
    """Labels of ticks on a logarithmic axis: plain numbers, or all of them powers of ten."""
    if all(_DECADES[0] * 0.999 <= value <= _DECADES[1] * 1.001 for value in values):
        return [wording.fixed(value, max(0, -_exponent(value))) for value in values]
    return [_scientific(value) for value in values]


def label(figure: Figure) -> None:
    """Label all axes of a figure that count in numbers; those with names of their own keep them."""
    for axes in figure.axes:
        for axis, points in ((axes.xaxis, _points(axes)), (axes.yaxis, None)):
            if axis.isDefault_majfmt:
                _label(axis, points)


def _label(axis: Axis, points: float | None) -> None:
    """Ticks and labels of an axis, where labels side by side must do with so many points."""
    from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

    low, high = sorted(axis.get_view_interval())
    if axis.get_scale() == "log":
        axis.set_minor_formatter(NullFormatter())
        if high >= 10.0 * low:
            room = _MANY if points is None else int(points / (6 * _DIGIT))
            axis.set_major_locator(LogLocator(subs=_steps(math.log10(high / low), room), numticks=room))
            axis.set_major_formatter(_formatter(logarithmic))
            return
        axis.set_major_locator(MaxNLocator(_MANY // 2, steps=[1, 2, 5, 10]))
    if points is not None:
        locators = [MaxNLocator(bins, steps=[1, 2, 5, 10]) for bins in range(_MANY, 1, -1)]
        fitting = (
            locator for locator in locators if _width(_seen(locator.tick_values(low, high), low, high)) <= points
        )
        axis.set_major_locator(next(fitting, locators[-1]))
    axis.set_major_formatter(_formatter(even))


def _seen(values: Sequence[float], low: float, high: float) -> list[float]:
    slack = 1e-9 * (high - low)
    return [value for value in values if low - slack <= value <= high + slack]


def _width(values: Sequence[float]) -> float:
    """Points that the labels of ticks take side by side."""
    return sum(_DIGIT * len(label) + _GAP for label in even(values))


def _steps(decades: float, room: int) -> tuple[float, ...]:
    """Which parts of each decade have room for a label."""
    return next((steps for steps in ((1.0, 2.0, 5.0), (1.0, 3.0)) if len(steps) * decades <= room), (1.0,))


def _formatter(labels: Labels) -> Any:
    from matplotlib.ticker import Formatter

    class Seen(Formatter):
        """Labels by what is in view: a locator offers a tick beyond either end as well."""

        def format_ticks(self, values: Sequence[float]) -> list[str]:
            seen = _seen(values, *sorted(self.axis.get_view_interval()))  # type: ignore[union-attr]
            named = dict(zip(seen, labels(seen), strict=True))
            return [named.get(value, "") for value in values]

        def __call__(self, x: float, pos: int | None = None) -> str:
            return labels([x])[0]

    return Seen()


def _points(axes: Axes) -> float:
    """How long the x axis will be, margins guessed."""
    place, figure = axes.get_subplotspec(), axes.get_figure()
    if place is None or figure is None:
        raise ValueError("expected axes in a grid of a figure")
    return float(_INSIDE * 72.0 * figure.get_figwidth() / place.get_gridspec().ncols)  # type: ignore[union-attr]


def _ends_at(value: float, places: int, step: float) -> bool:
    return abs(round(value, places) - value) < 1e-3 * step


def _exponent(value: float) -> int:
    return math.floor(math.log10(value) + 1e-9)


def _scientific(value: float) -> str:
    power = _exponent(value)
    mantissa = wording.significant(value / 10.0**power, 2)
    return _power(power) if mantissa == "1" else f"{mantissa}·{_power(power)}"


def _power(exponent: int) -> str:
    return f"10{str(exponent).translate(wording.RAISED)}"
