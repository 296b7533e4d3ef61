"""Numbers in columns and sentences."""

from __future__ import annotations

import pytest

from workflows import formatting


@pytest.mark.parametrize(
    ("share", "said"),
    [
        (0.0, "0.000"),
        (-0.0, "0.000"),
        (-1e-15, "0.000"),
        (-3e-7, "−0.00003"),
        (-2.34e-4, "−0.023"),
        (3e-7, "0.000"),
        (0.12136, "12.136"),
    ],
)
def test_a_loss_that_rounds_to_nothing_has_no_sign(share: float, said: str) -> None:
    """One below 0 that is more than what rounding leaves keeps its digits."""
    assert formatting.percent(share, 3) == said


@pytest.mark.parametrize(("value", "said"), [(-0.4, "0"), (-0.6, "−1"), (-12345.0, "−12\u2009345"), (-0.0, "0")])
def test_no_whole_number_is_minus_nothing(value: float, said: str) -> None:
    assert formatting.fixed(value) == said
