"""What a run may leave on its way: its velocity maxima, its events, the states at them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from damper.records import EVENT

if TYPE_CHECKING:
    from damper.arrays import Floats, Records


class Tables(NamedTuple):
    """Times and speeds of velocity maxima (n, 2); events (m,); in linear flights z and its rate there (m, 2, N)."""

    peaks: Floats
    rows: Records
    states: Floats


def nothing_kept() -> Tables:
    """Tables of a run that leaves nothing."""
    return Tables(np.zeros((0, 2)), np.zeros(0, EVENT), np.zeros((0, 2, 0)))
