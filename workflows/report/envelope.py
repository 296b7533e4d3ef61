"""Curves with more turns than a picture can show: the least, the mean and the most of each piece of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workflows.solve.records import Floats


@dataclass(frozen=True, eq=False)
class Envelope:
    """What a curve does in each piece that it passes through: mean x; least, mean and most of y; all (pieces,)."""

    x: Floats
    low: Floats
    mean: Floats
    high: Floats


def envelope(x: Floats, y: Floats, edges: Floats) -> Envelope:
    """The pieces of a curve, x and y (n,), between ascending `edges`; what lies beyond belongs to the outermost."""
    piece = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    order = np.argsort(piece, kind="stable")
    first = np.flatnonzero(np.diff(piece[order], prepend=-1))
    count = np.diff(first, append=len(x))
    along, up = x[order], y[order]
    return Envelope(
        x=np.add.reduceat(along, first) / count,
        low=np.minimum.reduceat(up, first),
        mean=np.add.reduceat(up, first) / count,
        high=np.maximum.reduceat(up, first),
    )


def oscillations(y: Floats) -> int:
    """How often a curve swings up and down through zero."""
    signs = np.sign(y[y != 0.0])
    return int(np.count_nonzero(np.diff(signs))) // 2
