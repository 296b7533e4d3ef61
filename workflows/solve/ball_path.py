"""The stretch of a ring-down that shows what the ball does: its way through the cavity, every event kept."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from workflows.solve.records import BallPath, Floats

if TYPE_CHECKING:
    import damper

CYCLES = 8
"""Vibration cycles from the ball's first motion on."""

_A_CYCLE = 60
"""Times a cycle: a straight line between two departs from a swing by 0.14 % of its amplitude at most."""

EVENTS_AT_MOST = 1000
"""Events after which the stretch ends, where a ball chatters."""

KINDS = ("release", "start", "reversal", "hit", "rub", "grip")
"""Names of the kinds of event by their numbers in `damper.state`."""


def ball_path(motion: damper.RingDown) -> BallPath | None:
    """The ball's way in the first cycles in which it moves, from a ring-down with its events; None if it never does."""
    from damper import sample

    rows = motion.rows
    if rows is None or motion.last_motion is None:
        return None
    period = 2 * math.pi / motion.damper.stuck_frequency
    moving = np.flatnonzero(rows["regime"] != 0)
    begin = max(0.0, float(rows["time"][moving[0]]) - period / 4) if moving.size else 0.0
    end = min(motion.duration, begin + CYCLES * period)
    inside = np.flatnonzero((rows["time"] >= begin) & (rows["time"] <= end))
    if len(inside) > EVENTS_AT_MOST:
        inside = inside[:EVENTS_AT_MOST]
        end = float(rows["time"][inside[-1]])
    count = max(2, math.ceil((end - begin) / period * _A_CYCLE) + 1)
    events: Floats = rows["time"][inside]
    times = np.union1d(np.linspace(begin, end, count), events)
    found = sample(motion, times)
    return BallPath(
        t=times,
        ball=found.relative_position,
        structure=found.displacement,
        regime=found.regime,
        at=np.searchsorted(times, events),
        kind=tuple(KINDS[kind] for kind in rows["kind"][inside].tolist()),
        axis=rows["axis"][inside].astype(np.int64),
    )
