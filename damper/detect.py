"""When the next event of an axis comes: isolate on monotone pieces, then polish.

Ties and edges, decided once: a velocity that touches zero has reached it; a wall that is touched is hit; a ball
that was just set off has a relative acceleration along its direction, whatever rounding says; a drive is above a
threshold only when it exceeds it by more than 1e-12 of it (`damper.threshold`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.flight import wave
from damper.records import NOTHING, ROLLING, SLIPPING, START, STUCK
from damper.rolling import end_of_roll
from damper.slip import end_of_pressing, end_of_slip
from damper.threshold import MARGIN, drive, first_exceed

if TYPE_CHECKING:
    from damper.arrays import Record, Records


@kernel
def schedule(axis: Record, laws: Records, ball: Record, horizon: float) -> None:
    """Write into `axis` when its next event happens (inf if not before time `horizon`) and what it is.

    A flight is looked through for a while only, since a hit of the other axis may cut it short: where nothing was
    found yet, the event is NOTHING, and `look` goes on from there.
    """
    axis.looked = 0.0
    look(axis, laws, ball, horizon)


@kernel
def look(axis: Record, laws: Records, ball: Record, horizon: float) -> None:
    """Go on looking for the next event of a flight."""
    left = horizon - axis.start
    if axis.regime == ROLLING:
        axis.heading = axis.direction
        tau, kind = end_of_roll(axis, laws[ROLLING], left)
    elif axis.regime == SLIPPING:
        tau, kind = end_of_slip(axis, laws[SLIPPING], left)
    elif axis.spin == 0.0:
        tau, kind = _set_off(axis, laws, ball), START
    else:
        tau, kind = end_of_pressing(axis, laws[STUCK], ball)
    axis.next, axis.due = axis.start + tau, tau
    axis.kind = kind if tau < np.inf else NOTHING


@kernel
def departure(axis: Record, laws: Records, ball: Record) -> int:
    """Direction in which a ball at relative rest sets off now: -1, 1, or 0 if it stays.

    It leaves when the structure's acceleration exceeds the threshold (eq. 1 and Table I) and the rolling motion
    that follows (eqs. 2-4) really sets off that way; the two differ where the two laws have different dashpots.
    """
    mass = laws[STUCK].mass
    stuck = (laws[STUCK].stiffness * axis.u + laws[STUCK].damping * axis.v) / mass
    rolling = (laws[ROLLING].stiffness * axis.u + laws[ROLLING].damping * axis.v) / mass
    least = MARGIN * ball.threshold
    for d in (-1, 1):
        if d * axis.s < axis.half_gap and d * stuck > least and d * rolling > least:
            return d
    return 0


@kernel
def _set_off(axis: Record, laws: Records, ball: Record) -> float:
    """First tau at which a stuck ball leaves: its drive exceeds the threshold away from any wall it rests on."""
    first = np.inf
    for d in (-1, 1):
        if d * axis.s < axis.half_gap:
            tau = _both_exceed(axis, laws, d, ball.threshold)
            if tau < first:
                first, axis.heading = tau, d
    return first


@kernel
def _both_exceed(axis: Record, laws: Records, d: int, threshold: float) -> float:
    """First tau at which both drives, by the stuck and by the rolling law's dashpot, exceed the threshold."""
    law = laws[STUCK]
    p1, q1 = drive(axis, law, law.damping, d)
    if laws[ROLLING].damping == law.damping:
        return first_exceed(p1, q1, law, threshold)
    p2, q2 = drive(axis, law, laws[ROLLING].damping, d)
    above = threshold - 1e-13 * (abs(p1) + abs(q1))
    tau = 0.0
    for _ in range(8):  # whichever comes second decides; each peak passed is lower than the one before
        tau += first_exceed(*_turned(p1, q1, law, tau), law, threshold)
        if tau == np.inf or _turned(p2, q2, law, tau)[0] >= above:
            return tau
        tau += first_exceed(*_turned(p2, q2, law, tau), law, threshold)
        if tau == np.inf or _turned(p1, q1, law, tau)[0] >= above:
            return tau
    return np.inf


@kernel
def _turned(p: float, q: float, law: Record, tau: float) -> tuple[float, float]:
    """Coefficients of exp(-decay t) (p C + q S) counted from t = tau; the first is its value there."""
    e, (c, s) = math.exp(-law.decay * tau), wave(law, tau)
    return e * (p * c + q * s), e * (q * c - law.frequency * law.frequency * p * s)
