"""Following modes from speed to speed by the likeness of their shapes.

The modal assurance criterion in the mass, MAC_ij = |x_i' M y_j|² for mass-normalised shapes, pairs the modes
of neighbouring speeds. Where a pair is not clearly alike, two modes exchange their characters between the two
speeds (a veering) or the steps are too long to tell it from a crossing; this is reported, not decided. Two modes
that change places although alike enough have crossed if nothing couples them, as in a symmetric plate; if something
does, they have veered more sharply than the steps show, which is reported too.
Source: Allemang, Sound and Vibration 37 (2003) 14.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

CLEAR = 0.7
"""Likeness from which a pair counts as the same mode; no second one can then exceed 0.3."""


COUPLED = 1e-3
"""Coupling, relative to a mode's stiffness, from which modes that change places count as veering: about the gap that
they keep, relative to their frequency."""


@dataclass(frozen=True)
class Veering:
    """An ambiguous pairing between the speeds number step and step + 1.

    Attributes:
        modes: numbers (from 0, by frequency at the first of the two speeds) of the modes concerned.
        likeness: the best pair's MAC for each.
    """

    step: int
    modes: tuple[int, ...]
    likeness: tuple[float, ...]


def follow(
    alike: NDArray[np.float64], wanted: int, coupling: Callable[[int], NDArray[np.float64]]
) -> tuple[NDArray[np.int64], tuple[Veering, ...]]:
    """Follow modes by their likeness (k - 1, q, q) from each of k speeds to the next.

    coupling: from a step to what its change of speed does between the modes before it (wanted, q), relative to the
    stiffness of the first of each two.
    Returns branches (k, wanted): which branch, numbered by frequency at the first speed, each mode is on.
    """
    steps, q, _ = alike.shape
    straight = np.einsum("kii->ki", alike)[:, :wanted].min(axis=1) >= CLEAR
    branches = np.empty((steps + 1, q), dtype=np.int64)
    branches[0] = np.arange(q)
    veerings = []
    for step in range(steps):
        if straight[step]:
            branches[step + 1] = branches[step]
            continue
        pair, unclear = _pair(alike[step], wanted)
        branches[step + 1, pair] = branches[step]
        passed = np.argwhere(np.triu(pair[:wanted, None] > pair, 1))
        if passed.size:
            coupled = passed[coupling(step)[tuple(passed.T)] > COUPLED]
            unclear = np.union1d(unclear, coupled[coupled < wanted])
        if unclear.size:
            likeness = alike[step].max(axis=1)[unclear]
            veerings.append(Veering(step, tuple(unclear.tolist()), tuple(likeness.tolist())))
    return branches[:, :wanted], tuple(veerings)


def _pair(alike: NDArray[np.float64], wanted: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The partner of each mode at the next speed, and the wanted modes whose partner is not clear."""
    from scipy.optimize import linear_sum_assignment

    _, pair = linear_sum_assignment(-alike)
    sure = alike[np.arange(len(pair)), pair] >= CLEAR
    return pair.astype(np.int64), np.flatnonzero(~sure[:wanted])
