"""Dampers on linear flights about to start: their systems, and the motion of structure and ball."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from damper.modes import Harmonic
from damper.parameters import level, spin_mass
from damper.records import SHARED
from damper.structures import couples, structures_by
from damper.system import LINEAR
from damper.systems import systems_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.arrays import Floats, Integers, Records
    from damper.model import ParticleDamper
    from damper.parameters import Parameters
    from damper.prepare import Prepared
    from damper.systems import Systems

LEVEL, APART, COUPLED = 0, 1, 2
"""How a damper flies: as in the paper, in closed form; as linear flights of x and of y; of both together."""


@dataclass(frozen=True)
class Flights:
    """Runs of n ring-downs alike, dtype `damper.system.LINEAR`, and the systems that they share.

    The constants of a run name the terms of its flights, among `systems.flows`.
    """

    runs: Records
    systems: Systems

    def energy(self, rows: Parameters) -> Floats:
        """Energy of structure and ball, shape (n,) [J]."""
        system, z, rate = self.runs["system"], self.runs["motion"]["z"], self.runs["motion"]["rate"]
        twice = np.einsum("ni,nij,nj->n", rate, system["mass"], rate)
        twice += np.einsum("ni,nij,nj->n", z, system["spring"], z)
        total: Floats = 0.5 * (twice + spin_mass(rows) * (self.runs["axes"]["spin"] ** 2).sum(axis=1))
        return total

    def modal_energies(self, damper: ParticleDamper, rows: Parameters) -> Floats:
        """Kinetic and elastic energy of each mode, shape (n, k) [J]."""
        structures = structures_by(damper, rows)
        back = np.argsort(self.systems.order)[: structures.mass.shape[1]]
        z, rate = self.runs["motion"]["z"][:, back], self.runs["motion"]["rate"][:, back]
        energies: Floats = 0.5 * (structures.spring * z**2 + structures.mass * rate**2)
        return energies

    def give_back(self, prepared: Prepared) -> None:
        """Put where the runs are into what they were prepared from."""
        for name, *_ in SHARED:
            prepared.runs[name] = self.runs[name]


def kinds(damper: ParticleDamper, rows: Parameters, harmonic: Harmonic | None = None) -> Integers:
    """How each of the rows flies, shape (n,)."""
    if harmonic is None and damper.modes is None and level(rows).all():
        return np.full(len(rows), LEVEL)
    kind = np.where(couples(rows, structures_by(damper, rows)), COUPLED, APART)
    if harmonic is None and damper.modes is None:
        kind[level(rows)] = LEVEL
    elif rows["printed"].any():
        raise ValueError("the printed equations know one free mode only; use the consistent formulation")
    return kind


def flights(
    damper: ParticleDamper,
    rows: Parameters,
    prepared: Prepared,
    harmonic: Harmonic | Sequence[Harmonic] | None = None,
    amplitudes: tuple[float, ...] | Floats | None = None,
) -> Flights:
    """Flights of what is prepared, from its u, v, s and w; all of one kind, driven alike or each by a harmonic.

    Several modes that a displacement of the cavity leaves open are displaced as by a force there, and set going as by a
    blow; `amplitudes`, shape (k,) or (n, k), are theirs instead.
    """
    alike = harmonic is None or isinstance(harmonic, Harmonic)
    first, which = _distinct(rows) if alike else (np.arange(len(rows)), np.arange(len(rows)))
    if harmonic is None and len(first) == 1 and rows[0] == damper.parameters[0]:
        systems = _free(damper)
    else:
        systems = systems_of(rows[first], structures_by(damper, rows[first]), harmonic)
    runs, axes = np.zeros(len(rows), LINEAR), prepared.axes
    for name, *_ in SHARED:
        runs[name] = prepared.runs[name]
    runs["system"] = systems.constants[which]
    structures = structures_by(damper, rows)
    n, k = structures.mass.shape
    z, rate = np.zeros((n, k + 2)), np.zeros((n, k + 2))
    if damper.modes is None:
        z[:, :k], rate[:, :k] = axes["u"], axes["v"]
    else:
        z[:, :k] = _spread(structures.shape, structures.spring, axes["u"])
        rate[:, :k] = _spread(structures.shape, structures.mass, axes["v"])
    if amplitudes is not None:
        z[:, :k] = amplitudes
    z[:, k:], rate[:, k:] = axes["s"], axes["w"]
    runs["motion"]["z"][:, : k + 2], runs["motion"]["rate"][:, : k + 2] = z[:, systems.order], rate[:, systems.order]
    if isinstance(harmonic, Harmonic):
        _watch(runs["cycle"], harmonic)
    return Flights(runs, systems)


@lru_cache(maxsize=4)
def _free(damper: ParticleDamper) -> Systems:
    """The system of a damper that nothing drives, worked out once for all that is let go on it."""
    return systems_of(damper.parameters, structures_by(damper, damper.parameters))


def _distinct(rows: Parameters) -> tuple[Integers, Integers]:
    """Where each of the rows that differ stands first, and which of these every row is."""
    numbers: dict[bytes, int] = {}
    which = np.array([numbers.setdefault(row.tobytes(), len(numbers)) for row in rows], np.int64)
    return np.unique(which, return_index=True)[1], which


def _watch(cycles: Records, harmonic: Harmonic) -> None:
    """Seek the velocity maxima of driven motion once per cycle of what drives it."""
    period = 2 * math.pi / harmonic.frequency
    cycles["period"], cycles["wait"], cycles["closes"] = period, 0.75 * period, 0.5 * period


def _spread(shape: Floats, weight: Floats, moved: Floats) -> Floats:
    """Least coordinates, by their weights, that move the cavity so, shape (n, k)."""
    light = shape.transpose(0, 2, 1) / weight[:, :, None]
    spread: Floats = (light @ np.linalg.pinv(shape @ light, hermitian=True) @ moved[:, :, None])[..., 0]
    return spread
