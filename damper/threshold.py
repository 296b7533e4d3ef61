"""When the inertia of a stuck ball overcomes a threshold."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.flight import wave

if TYPE_CHECKING:
    from damper.arrays import Record

MARGIN = 1.0 + 1e-12
"""By which a threshold has to be exceeded: less is rounding, and a ball set off by it would turn back at once."""


@kernel
def drive(axis: Record, law: Record, damping: float, d: int) -> tuple[float, float]:
    """Coefficients of  d (K u + c v) / M1 = exp(-decay tau) (p C + q S)  in stuck motion; C, S: `damper.flight`."""
    v_cos = axis.b - law.decay * axis.a
    v_sin = -law.frequency * law.frequency * axis.a - law.decay * axis.b
    return d * (law.stiffness * axis.a + damping * v_cos) / law.mass, d * (
        law.stiffness * axis.b + damping * v_sin
    ) / law.mass


@kernel
def first_exceed(p: float, q: float, law: Record, threshold: float) -> float:
    """First tau ≥ 0 at which exp(-decay tau) (p C + q S) exceeds the threshold, inf if never."""
    decay: float = law.decay
    frequency: float = law.frequency
    if p > threshold * MARGIN:
        return 0.0
    if (frequency * p) ** 2 + q * q <= (frequency * threshold) ** 2:
        return np.inf
    turn = math.atan2(frequency * (q - decay * p), frequency * frequency * p + decay * q)
    high = (turn if turn > 0.0 else turn + 2.0 * math.pi) / frequency
    c, s = wave(law, high)
    top = math.exp(-decay * high) * (p * c + q * s)  # the peak to come
    if top <= threshold * MARGIN:
        return np.inf
    low, peak = max(high - math.pi / frequency, 0.0), high
    lag = math.atan2(decay, frequency)  # by which damping brings the peak forward
    tau = max(low, peak - (math.acos(threshold / top * math.cos(lag)) - lag) / frequency)
    for _ in range(100):
        c, s = wave(law, tau - peak)
        e = top * math.exp(decay * (peak - tau))
        f = e * (c + decay * s) - threshold
        if f > 0.0:
            high = tau
        else:
            low = tau
        slope = -e * law.square * s
        new: float = tau - f / slope if slope > 0.0 else low
        if abs(new - tau) <= 4e-16 * peak:
            return new
        tau = new if low < new < high else 0.5 * (low + high)
    return tau
