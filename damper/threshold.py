"""When the inertia of a stuck ball overcomes a threshold."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel

if TYPE_CHECKING:
    from damper.arrays import Record

MARGIN = 1.0 + 1e-12
"""By which a threshold has to be exceeded: less is rounding, and a ball set off by it would turn back at once."""


@kernel
def drive(axis: Record, law: Record, damping: float, d: int) -> tuple[float, float]:
    """Coefficients of  d (K u + c v) / M1 = exp(-decay tau) (p cos + q sin)  in stuck motion."""
    v_cos = law.frequency * axis.b - law.decay * axis.a
    v_sin = -law.frequency * axis.a - law.decay * axis.b
    return d * (law.stiffness * axis.a + damping * v_cos) / law.mass, d * (
        law.stiffness * axis.b + damping * v_sin
    ) / law.mass


@kernel
def first_exceed(p: float, q: float, decay: float, frequency: float, threshold: float) -> float:
    """First tau ≥ 0 at which exp(-decay tau) (p cos + q sin) exceeds the threshold, inf if never."""
    if p > threshold * MARGIN:
        return 0.0
    if p * p + q * q <= threshold * threshold:
        return np.inf
    radius, phase = math.sqrt(p * p + q * q), math.atan2(q, p)
    lag = math.atan2(decay, frequency)  # by which damping brings the peak forward
    turn = phase - lag if phase > lag else phase - lag + 2.0 * math.pi
    high = turn / frequency
    radius *= math.exp(-decay * high)  # of the peak to come
    if radius * math.cos(lag) <= threshold * MARGIN:
        return np.inf
    low, peak = max(high - math.pi / frequency, 0.0), high
    tau = max(low, peak - (math.acos(threshold / radius) - lag) / frequency)
    for _ in range(100):
        angle = frequency * (tau - peak) - lag
        e = radius * math.exp(decay * (peak - tau))
        f = e * math.cos(angle) - threshold
        if f > 0.0:
            high = tau
        else:
            low = tau
        slope = -e * (frequency * math.sin(angle) + decay * math.cos(angle))
        new = tau - f / slope if slope > 0.0 else low
        if abs(new - tau) <= 4e-16 * peak:
            return new
        tau = new if low < new < high else 0.5 * (low + high)
    return tau
