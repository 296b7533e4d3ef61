"""Tick labels: as many digits as they need, and no more."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workflows.report import ticks

THIN, MINUS = "\u2009", "\u2212"


@pytest.mark.parametrize(
    ("values", "labels"),
    [
        ([0, 0.1, 0.2], ["0.0", "0.1", "0.2"]),
        ([-20, 0, 20], [f"{MINUS}20", "0", "20"]),
        ([0, 5000, 10000], ["0", f"5{THIN}000", f"10{THIN}000"]),
        ([0, 2.5, 5, 7.5], ["0.0", "2.5", "5.0", "7.5"]),
        ([5890.25, 5890.5], [f"5{THIN}890.25", f"5{THIN}890.50"]),
        ([-1e-17, 0.5], ["0.0", "0.5"]),
        ([0, 2e-9, 4e-9], ["0", "2·10⁻⁹", "4·10⁻⁹"]),
        ([0, 5e8, 1e9], ["0", "0.5·10⁹", "1.0·10⁹"]),
        ([0.0], ["0"]),
        ([0.3], ["0.3"]),
        ([], []),
    ],
)
def test_even(values: list[float], labels: list[str]) -> None:
    assert ticks.even(values) == labels


@pytest.mark.parametrize(
    ("values", "labels"),
    [
        ([0.01, 0.1, 1, 10], ["0.01", "0.1", "1", "10"]),
        ([1, 3, 10000], ["1", "3", f"10{THIN}000"]),
        ([1e-11, 1e-3, 10], ["10⁻¹¹", "10⁻³", "10¹"]),
        ([2e-6, 5e-6, 1e-5], ["2·10⁻⁶", "5·10⁻⁶", "10⁻⁵"]),
        ([1e3, 1e7], ["10³", "10⁷"]),
    ],
)
def test_logarithmic(values: list[float], labels: list[str]) -> None:
    assert ticks.logarithmic(values) == labels


@given(st.integers(-300, 300), st.integers(1, 9), st.integers(-12, 12))
def test_no_two_ticks_read_alike(power: int, step: int, first: int) -> None:
    values = [float(f"{(first + k) * step}e{power}") for k in range(6)]
    labels = ticks.even(values)
    assert len(set(labels)) == 6
    for value, label in zip(values, labels, strict=True):
        assert (value == 0) == (set(label) <= set("0.") or label == "0")
