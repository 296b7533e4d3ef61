"""Where a point of the plane lies in a mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

TOLERANCE = 1e-6
"""How far outside a cell, in its own coordinates, a point still counts as in it."""


class PlaceError(ValueError):
    """A place that is not on the plate, or where what is asked for does not move; the message says which."""


def locate(mesh: Any, point: tuple[float, float]) -> tuple[int, NDArray[np.float64]]:
    """Cell that holds a point (x, y) in m, and the reference coordinates (2,) there.

    Raises:
        PlaceError: for a point off the plate.
        ValueError: for one that is none.
    """
    target = np.asarray(point, dtype=float)
    if target.shape != (2,):
        raise ValueError(f"a place on the plate is (x, y) in m, got {point!r}")
    corners = mesh.p[:, mesh.t]
    low, high = corners.min(axis=1), corners.max(axis=1)
    margin = TOLERANCE * (high - low).max(axis=0)
    near = ((low - margin <= target[:, None]) & (target[:, None] <= high + margin)).all(axis=0)
    best, where, excess = -1, np.zeros(2), np.inf
    for cell in np.flatnonzero(near):
        reference = _invert(corners[:, :, cell], target)
        outside = _outside(reference, mesh.t.shape[0])
        if outside < excess:
            best, where, excess = int(cell), reference, outside
    if excess > TOLERANCE:
        raise PlaceError(f"the point ({point[0]:.6g}, {point[1]:.6g}) m does not lie on the plate")
    return best, where


def _invert(corners: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """Find the reference coordinates of a target by Newton's method; exact in one step for triangles."""
    p = corners
    at = np.full(2, 1.0 / 3.0 if p.shape[1] == 3 else 0.5)
    for _ in range(50):
        x, y = at
        if p.shape[1] == 3:
            value = p[:, 0] * (1 - x - y) + p[:, 1] * x + p[:, 2] * y
            jacobian = np.stack([p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]], axis=1)
        else:
            value = p @ np.array([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y])
            jacobian = p @ np.array([[y - 1, x - 1], [1 - y, -x], [y, x], [-y, 1 - x]])
        step = np.linalg.solve(jacobian, target - value)
        at = at + step
        if np.abs(step).max() < 1e-14:
            break
    return at


def _outside(reference: NDArray[np.float64], corners: int) -> float:
    x, y = reference
    upper = x + y - 1.0 if corners == 3 else max(x, y) - 1.0
    return float(max(-x, -y, upper, 0.0))
