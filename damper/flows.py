"""Flights as power series: where structure and ball are within a step after an event.

The coordinates z of a group obey z'' = - stiffness z - damping z' + resistance + force cos(nu t + phase). Their Taylor
series follow term by term; there is nothing to diagonalise: equal and vanishing frequencies are no special case. They
are linear in what a flight begins with, so that the terms are worked out once, here, for each of these sources:

    z, z' times the step, the resistance along each axis, cosine and sine of the harmonic's phase;

for each of these series:

    z, the displacement u of the cavity along each axis, the drive of a ball stuck along it, the harmonic and its force.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from damper.linear import REGIMES
from damper.system import TERMS

if TYPE_CHECKING:
    from damper.arrays import Floats
    from damper.linear import Equations


def flows_of(equations: Equations, members: list[list[int]], spans: Floats) -> Floats:
    """Terms of all series of flights, shape (n, flows, series, sources, TERMS).

    Flow 3 (x) + (y) belongs to a pair of regimes where all coordinates are one group, else flow 3 g + (regime).
    """
    if len(members) == 1:
        return _flows(equations, members[0], [0, 1], spans[:, 0], range(REGIMES**2))
    parts = [
        _flows(equations, members[0], [0], spans[:, 0], range(0, REGIMES**2, REGIMES)),
        _flows(equations, members[1], [1], spans[:, 1], range(REGIMES)),
    ]
    series, sources = (max(part.shape[k] for part in parts) for k in (2, 3))
    flows = np.zeros((len(spans), 2 * REGIMES, series, sources, TERMS))
    for g, part in enumerate(parts):
        flows[:, REGIMES * g : REGIMES * (g + 1), : part.shape[2], : part.shape[3]] = part
    return flows


def _flows(equations: Equations, group: list[int], axes: list[int], span: Floats, pairs: range) -> Floats:
    """Of one group, in the flows of its regimes, shape (n, len(pairs), series, sources, TERMS)."""
    size, sources = len(group), 2 * len(group) + len(axes) + 2
    step = span[:, None, None, None]
    one = np.ix_(range(len(span)), pairs, group, group)
    stiffness, damping = equations.stiffness[one] * step**2, equations.damping[one] * step
    wave = _wave(equations.frequency * span, sources)
    pushed = (equations.force[:, pairs][..., group] * step[..., 0] ** 2)[..., None]
    terms = np.zeros((TERMS + 2, len(span), len(pairs), size, sources))
    terms[0, ..., :size], terms[1, ..., size : 2 * size] = np.eye(size), np.eye(size)
    for k in range(TERMS):
        terms[k + 2] = pushed * wave[k] - stiffness @ terms[k] - (k + 1) * damping @ terms[k + 1]
        if k == 0:
            resistance = equations.resistance[:, pairs][:, :, axes][..., group] * step**2
            terms[2, ..., 2 * size : 2 * size + len(axes)] += np.swapaxes(resistance, 2, 3)
        terms[k + 2] /= (k + 1) * (k + 2)
    shape, pull = (each[:, None, axes][..., group] for each in (equations.shape, equations.pull))
    cavity = shape @ terms
    order = np.arange(1, TERMS + 1) * np.arange(2, TERMS + 2)
    drive = -cavity[2:] * (order[:, None, None, None, None] / step**2) - pull @ terms[:-2]
    drive += equations.sway[:, None, axes, None] * wave[:TERMS]
    force = equations.power[:, None, None, group] @ terms[:-2]
    harmonic = np.broadcast_to(wave[:TERMS], force.shape)
    series = np.concatenate([terms[:-2], cavity[:-2], drive, harmonic, force], axis=3)
    return np.ascontiguousarray(np.moveaxis(series, 0, -1))


def _wave(turn: Floats, sources: int) -> Floats:
    """Terms of cos(turn x + phase) from cosine and sine of the phase, shape (TERMS + 2, n, 1, 1, sources)."""
    wave = np.zeros((TERMS + 2, len(turn), 1, 1, sources))
    wave[0, ..., -2], wave[1, ..., -1] = 1.0, -turn[:, None, None]
    for k in range(TERMS):
        wave[k + 2] = -(turn[:, None, None, None] ** 2) * wave[k] / ((k + 1) * (k + 2))
    return wave
