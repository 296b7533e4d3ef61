"""Motion at any time, from the event table of a ring-down."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from damper.model import Floats
from damper.state import AXIS, balls_of, laws_of

if TYPE_CHECKING:
    from damper.model import Record, Records
    from damper.motion import RingDown


@dataclass(frozen=True)
class History:
    """Motion at given times; the columns of the (n, 2) arrays are the axes x and y.

    Attributes:
        time: shape (n,) [s].
        displacement: of the structure, shape (n, 2) [m].
        velocity: of the structure, shape (n, 2) [m/s].
        relative_position: of the ball's centre from the cavity's centre, shape (n, 2) [m].
        relative_velocity: of the ball in the cavity, shape (n, 2) [m/s].
        spin: of the ball, as the speed of its surface about its centre, shape (n, 2) [m/s]; rolling, it is the
            relative velocity.
        regime: 0 stuck to the structure, 1 rolling, 2 slipping on the floor, shape (n, 2).
    """

    time: Floats
    displacement: Floats
    velocity: Floats
    relative_position: Floats
    relative_velocity: Floats
    spin: Floats
    regime: npt.NDArray[np.int64]


def sample(ringdown: RingDown, times: npt.ArrayLike) -> History:
    """The motion at `times` [s], shape (n,), exact to rounding; at an event, the state just after it.

    Raises:
        ValueError: the ring-down kept no events, or a time lies outside it.
    """
    if ringdown.rows is None:
        raise ValueError("the ring-down kept no events: call ringdown(..., keep_events=True)")
    time = np.atleast_1d(np.asarray(times, dtype=np.float64))
    if time.ndim != 1:
        raise ValueError(f"times must have shape (n,), got {time.shape}")
    if time.size and not (time.min() >= 0 and time.max() <= ringdown.duration * (1 + 1e-12)):
        raise ValueError(f"times must lie between 0 and the ring-down's end, {ringdown.duration:g} s")
    if ringdown.states is None:
        return _closed(ringdown, ringdown.rows, time)
    return _stepwise(ringdown, ringdown.rows, ringdown.states, time)


def _closed(ringdown: RingDown, rows: Records, time: Floats) -> History:
    """From the closed form of the flights."""
    from damper.history_kernel import evaluate

    laws, ball = laws_of(ringdown.damper.parameters)[0], _ball(ringdown)
    out = np.empty((5, time.size, 2))
    regime = np.empty((time.size, 2), np.int64)
    for i in range(2):
        events = rows[rows["axis"] == i]
        at = np.searchsorted(events["time"], time, side="right") - 1
        flights = np.zeros(time.size, AXIS)
        for name in ("u", "v", "s", "w", "spin", "regime", "direction"):
            flights[name] = events[name][at]
        flights["start"] = events["time"][at]
        evaluate(flights, laws[i], ball, time, out[:, :, i])
        regime[:, i] = flights["regime"]
    return History(time, out[0], out[1], out[2], out[3], out[4], regime)


def _stepwise(ringdown: RingDown, rows: Records, states: Floats, time: Floats) -> History:
    """From the states at the events, through the steps of the flights."""
    from damper.history_kernel import follow
    from damper.motion import flights, prepare
    from damper.state import Tables

    damper = ringdown.damper
    one = prepare(damper.parameters, np.zeros((1, 5, 2)), 1.0, 1.0)
    of = flights(damper, damper.parameters, one, ringdown.harmonic)
    order = np.argsort(time, kind="stable")
    out, regime = np.empty((5, time.size, 2)), np.empty((time.size, 2), np.int64)
    follow(of.runs[0], of.systems.flows[0], Tables(np.zeros((0, 2)), rows, states), time[order], out, regime)
    back = np.argsort(order)
    out = out[:, back]
    return History(time, out[0], out[1], out[2], out[3], out[4], regime[back])


def _ball(ringdown: RingDown) -> Record:
    ball: Record = balls_of(ringdown.damper.parameters, np.zeros(1))[0]
    return ball
