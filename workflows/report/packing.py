"""Mode shapes packed for a page: few vectors, of which every shape is a sum, in 16-bit numbers."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Any

import numpy as np

from workflows.solve.records import Floats

ERROR = 1e-3
"""Largest departure of a packed displacement, in parts of the shape's largest."""


@dataclass(frozen=True, eq=False)
class Packed:
    """Shapes (count, n, 3) as sums of vectors: for each direction vectors (r, n) and shares (count, r)."""

    vectors: tuple[Floats, Floats, Floats]
    shares: tuple[Floats, Floats, Floats]

    @property
    def rank(self) -> int:
        """Vectors of all directions."""
        return sum(len(vectors) for vectors in self.vectors)


def packed(shapes: Floats) -> Packed:
    """The fewest vectors that give shapes (count, n, 3), of which the largest displacements are 1, to half of ERROR."""
    pairs = [_few(shapes[:, :, k]) for k in range(3)]
    vectors, shares = zip(*pairs, strict=True)
    return Packed(vectors, shares)


def _few(along: Floats) -> tuple[Floats, Floats]:
    """Vectors (r, n) and shares (count, r) whose product is `along` (count, n) to half of ERROR."""
    left, sizes, right = np.linalg.svd(along, full_matrices=False)
    shares = left * sizes
    rank = next((r for r in range(len(sizes) + 1) if _far(along, shares, right, r) <= 0.5 * ERROR), len(sizes))
    return right[:rank], shares[:, :rank]


def _far(along: Floats, shares: Floats, right: Floats, rank: int) -> float:
    return float(np.abs(along - shares[:, :rank] @ right[:rank]).max(initial=0.0))


def shorts(values: Floats, largest: float) -> str:
    """Numbers between -largest and largest as 16-bit integers, in base64."""
    return text(np.round(values * (32767.0 / (largest or 1.0))).astype("<i2"))


def whole(numbers: Any) -> str:
    """Numbers from 0 to 65535 as 16-bit integers, in base64."""
    return text(np.asarray(numbers).astype("<u2"))


def text(array: Any) -> str:
    """The bytes of an array in base64."""
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()


def vectors(found: Packed) -> list[dict[str, Any]]:
    """Vectors (scaled by `largest`) and shares (32-bit floats) of each direction, ready for JSON."""
    return [
        {
            "rank": len(along),
            "largest": float(np.abs(along).max(initial=0.0)),
            "vectors": shorts(along, float(np.abs(along).max(initial=0.0))),
            "shares": text(shares.astype("<f4")),
        }
        for along, shares in zip(found.vectors, found.shares, strict=True)
    ]
