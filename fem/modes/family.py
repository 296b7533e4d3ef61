"""Names for modes, read from their shapes.

The kinetic energy of a shape is split into what lies in the plane and what leaves it. Out of the plane, each
chordwise strip of the plate is fitted by a rigid chord: what moves evenly is flap, what turns about the
chord's middle is twist, the rest bends the chord. In the plane, motion across is lag, along is axial.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.modes.real import Modes
    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]

STRIPS = 16
"""Strips along x in which a chord is fitted."""

FAMILIES = ("flap", "twist", "chord", "lag", "axial")


def families(operators: Operators, modes: Modes) -> list[str]:
    """Name each mode by the largest share of its kinetic energy, one of `FAMILIES`."""
    shares = energy_shares(operators, modes.shapes)
    return [FAMILIES[k] for k in shares.argmax(axis=0)]


def energy_shares(operators: Operators, shapes: NDArray[Any]) -> Array:
    """Shares (5, count) of kinetic energy in each of `FAMILIES`, for shapes (n, count) real or complex."""
    if np.iscomplexobj(shapes):
        both = np.hstack([shapes.real, shapes.imag])
        energy = np.einsum("fii->fi", share_matrices(operators, both))
        energy = energy[:, : shapes.shape[1]] + energy[:, shapes.shape[1] :]
    else:
        energy = np.einsum("fii->fi", share_matrices(operators, shapes))
    return np.asarray(energy / energy.sum(axis=0))


def share_matrices(operators: Operators, basis: Array) -> Array:
    """Matrices E (5, r, r): the energy of basis @ y (n, r) in family f is y' E_f y, up to one factor."""
    model = operators.model
    weight = np.sqrt(model.displacement.dx.ravel())[:, None]
    u, v, w = (weight * moved.reshape(weight.size, -1) for moved in model.displacement.evaluate(basis)[:3])
    flap, twist = _chordwise(model.points[0].ravel(), model.points[1].ravel(), w, weight)
    return np.stack([flap, twist, w.T @ w - flap - twist, v.T @ v, u.T @ u])


def _chordwise(x: Array, y: Array, w: Array, weight: Array) -> tuple[Array, Array]:
    """Energy matrices (r, r) of what in w (npoint, r) is even along the chord, and linear in it."""
    edges = np.linspace(x.min(), x.max(), STRIPS + 1)[1:-1]
    strip = np.searchsorted(edges, x)
    even, linear = [], []
    for k in np.unique(strip):
        here = strip == k
        a, b = x[here] - x[here].mean(), y[here] - y[here].mean()
        ordered = np.stack([np.ones_like(a), a, b, a * b], axis=1) * weight[here]
        content = np.linalg.qr(ordered)[0].T @ w[here]
        even.append(content[:2])
        linear.append(content[2:])
    flap, twist = np.vstack(even), np.vstack(linear)
    return flap.T @ flap, twist.T @ twist
