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

from damper.linear import REGIMES, Equations
from damper.system import TERMS

if TYPE_CHECKING:
    from damper.arrays import Floats, Integers


_ROOM = 2**26
"""Bytes that the terms of flights may take at once; working them out takes four times that."""


def at_once(modes: int, *, coupled: bool) -> int:
    """How many dampers' terms there is room for."""
    flows, size, axes = (REGIMES**2, modes + 2, 2) if coupled else (2 * REGIMES, modes + 1, 1)
    return max(1, _ROOM // (flows * (size + 2 * axes + 2) * (2 * size + axes + 2) * TERMS * 8))


def flows_of(equations: Equations, members: list[list[int]], spans: Floats) -> Floats:
    """Terms of all series of flights, shape (n, flows, series, sources, TERMS).

    Flow 3 (x) + (y) belongs to a pair of regimes where all coordinates are one group, else flow 3 g + (regime).
    """
    n, driven = len(spans), 2 * bool((equations.frequency > 0.0).any())
    if len(members) == 1:
        parts = [(members[0], [0, 1], range(REGIMES**2))]
    else:
        parts = [(members[0], [0], range(0, REGIMES**2, REGIMES)), (members[1], [1], range(REGIMES))]
    series, sources = (
        max(k * len(z) + each * len(axes) + driven for z, axes, _ in parts) for k, each in ((1, 2), (2, 1))
    )
    flows = np.zeros((n, sum(len(pairs) for *_, pairs in parts), series, sources, TERMS))
    for g, (group, axes, pairs) in enumerate(parts):
        found = _flows(_chosen(equations, group, axes, pairs), spans[:, g], driven)
        first = g * len(pairs)
        flows[:, first : first + len(pairs), : found.shape[2], : found.shape[3]] = np.moveaxis(found, (0, -1), (-1, 0))
    return flows


def _flows(of: Equations, step: Floats, driven: int) -> Floats:
    """Of one group, shape (TERMS, flows, series, sources, n)."""
    pairs, size = of.force.shape[:2]
    pressed = slice(2 * size, 2 * size + len(of.sway))
    sources = pressed.stop + driven
    wave = _wave(of.frequency * step, sources, driven)
    terms = np.zeros((TERMS + 2, pairs, size, sources, len(step)))
    for m in range(size):
        terms[0, :, m, m] = terms[1, :, m, size + m] = 1.0
    stiffness, damping, force = of.stiffness * step**2, of.damping * step, of.force * step**2
    for k in range(TERMS):
        terms[k + 2] = force[:, :, None] * wave[k] - _product(stiffness, terms[k])
        terms[k + 2] -= (k + 1) * _product(damping, terms[k + 1])
        if k == 0:
            terms[2, :, :, pressed] += of.resistance.swapaxes(1, 2) * step**2
        terms[k + 2] /= (k + 1) * (k + 2)
    order = (np.arange(1, TERMS + 1) * np.arange(2, TERMS + 2))[:, None, None, None, None]
    cavity, here = _product(of.shape, terms), terms[:TERMS]
    drive = of.sway[:, None] * wave[:TERMS] - cavity[2:] * (order / step**2) - _product(of.pull, here)
    series = [here, cavity[:TERMS], drive]
    if driven:
        power = _product(of.power[None], here)
        series += [np.broadcast_to(wave[:TERMS], power.shape), power]
    return np.concatenate(series, axis=2)


def _chosen(equations: Equations, group: list[int], axes: list[int], pairs: range) -> Equations:
    """The equations of a group, one damper beside the other: their axis last."""
    matrix, vector, moved = np.ix_(pairs, group, group), np.ix_(pairs, group), np.ix_(axes, group)

    def cut(each: Floats, places: tuple[Integers, ...]) -> Floats:
        return each[(slice(None), *places)]  # type: ignore[arg-type]

    part = Equations(
        stiffness=cut(equations.stiffness, matrix),
        damping=cut(equations.damping, matrix),
        resistance=cut(equations.resistance, np.ix_(pairs, axes, group)),
        force=cut(equations.force, vector),
        shape=cut(equations.shape, moved),
        pull=cut(equations.pull, moved),
        sway=equations.sway[:, axes],
        power=equations.power[:, group],
        frequency=equations.frequency,
        phase=equations.phase,
    )
    return Equations(*(np.ascontiguousarray(np.moveaxis(each, 0, -1)) for each in part))


def _product(matrices: Floats, terms: Floats) -> Floats:
    """Of matrices (…, a, b, n) with (…, b, sources, n), where few numbers stand in each of many."""
    total = matrices[..., :, 0, None, :] * terms[..., None, 0, :, :]
    for m in range(1, matrices.shape[-2]):
        total += matrices[..., :, m, None, :] * terms[..., None, m, :, :]
    product: Floats = total
    return product


def _wave(turn: Floats, sources: int, driven: int) -> Floats:
    """Terms of cos(turn x + phase) from cosine and sine of the phase, shape (TERMS + 2, 1, 1, sources, n)."""
    wave = np.zeros((TERMS + 2, 1, 1, sources, len(turn)))
    if driven:
        wave[0, ..., -2, :], wave[1, ..., -1, :] = 1.0, -turn
        for k in range(TERMS):
            wave[k + 2] = -(turn**2) * wave[k] / ((k + 1) * (k + 2))
    return wave
