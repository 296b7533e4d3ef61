"""Dampers on linear flights about to start: their systems, and the motion of structure and ball."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from damper.linear import couples, members_of, single_modes, structures_of, systems_of
from damper.parameters import level, spin_mass
from damper.system import MOTION

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.arrays import Floats, Integers, Records
    from damper.linear import Structures
    from damper.model import ParticleDamper
    from damper.modes import Harmonic
    from damper.parameters import Parameters

LEVEL, APART, COUPLED = 0, 1, 2
"""How a damper flies: as in the paper, in closed form; as linear flights of x and of y; of both together."""


@dataclass(frozen=True)
class Flights:
    """Systems and motions of n ring-downs alike, with n rows of each."""

    systems: Records
    motions: Records

    def energy(self, rows: Parameters, axes: Records) -> Floats:
        """Energy of structure and ball, shape (n,) [J]."""
        z, rate = self.motions["z"], self.motions["rate"]
        twice = np.einsum("ni,nij,nj->n", rate, self.systems["mass"], rate)
        twice += np.einsum("ni,nij,nj->n", z, self.systems["spring"], z)
        total: Floats = 0.5 * (twice + spin_mass(rows) * (axes["spin"] ** 2).sum(axis=1))
        return total

    def modal_energies(self, damper: ParticleDamper, rows: Parameters) -> Floats:
        """Kinetic and elastic energy of each mode, shape (n, k) [J]."""
        structures = structures_by(damper, rows)
        order = [m for group in members_of(rows, structures) for m in group]
        back = np.argsort(order)[: structures.mass.shape[1]]
        z, rate = self.motions["z"][:, back], self.motions["rate"][:, back]
        energies: Floats = 0.5 * (structures.spring * z**2 + structures.mass * rate**2)
        return energies


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
    axes: Records,
    harmonic: Harmonic | Sequence[Harmonic] | None = None,
    amplitudes: tuple[float, ...] | Floats | None = None,
) -> Flights:
    """Flights from the u, v, s and w in `axes`, shape (n, 2); all of one kind, driven alike or each by a harmonic.

    Several modes that a displacement of the cavity leaves open are displaced as by a force there, and set going as by a
    blow; `amplitudes`, shape (k,) or (n, k), are theirs instead.
    """
    structures = structures_by(damper, rows)
    systems = systems_of(rows, structures, harmonic)
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
    order = [m for group in members_of(rows, structures) for m in group]
    motions = np.zeros(n, MOTION)
    motions["z"][:, : k + 2], motions["rate"][:, : k + 2] = z[:, order], rate[:, order]
    return Flights(systems, motions)


def watch_harmonic(cycles: Records, harmonic: Harmonic) -> None:
    """Seek the velocity maxima of driven motion once per cycle of what drives it."""
    period = 2 * math.pi / harmonic.frequency
    cycles["period"], cycles["wait"], cycles["closes"] = period, 0.75 * period, 0.5 * period


def structures_by(damper: ParticleDamper, rows: Parameters) -> Structures:
    """The structures that rows of a damper vibrate on."""
    return single_modes(rows) if damper.modes is None else structures_of(rows, damper.modes)


def _spread(shape: Floats, weight: Floats, moved: Floats) -> Floats:
    """Least coordinates, by their weights, that move the cavity so, shape (n, k)."""
    light = shape.transpose(0, 2, 1) / weight[:, :, None]
    spread: Floats = (light @ np.linalg.pinv(shape @ light, hermitian=True) @ moved[:, :, None])[..., 0]
    return spread
