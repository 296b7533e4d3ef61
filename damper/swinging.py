"""What bounds the drive of a stuck ball from here on: the modes in which the structure swings with it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from damper.arrays import Floats
    from damper.structures import Structures


class Swinging(NamedTuple):
    """`deflection`, `swing`, shape (n, N, N), `reach` and `bias`, shape (n, 2, N), of `damper.system.SYSTEM`."""

    deflection: Floats
    swing: Floats
    reach: Floats
    bias: Floats


def swinging(structures: Structures, pull: Floats, curve: Floats, ball: Floats, members: list[list[int]]) -> Swinging:
    """In the coordinates (q, s), N of them.

    In the modes v_k of M + m Phi'Phi and K, the structure swings about where the ball's place holds it; its dashpots
    add to the accelerations.
    """
    n, k = structures.mass.shape
    deflection, swing = np.zeros((n, k + 2, k + 2)), np.zeros((n, k + 2, k + 2))
    reach, bias = np.zeros((n, 2, k + 2)), np.zeros((n, 2, k + 2))
    sag = ball * pull.transpose(0, 2, 1) / structures.spring[:, :, None]  # q = -sag s at rest
    bias[:, :, k:] = pull @ sag - curve
    for group in members:
        modes = [z for z in group if z < k]
        if not modes:
            continue
        shape, force = structures.shape[:, :, modes], pull[:, :, modes]
        diagonal = np.eye(len(modes))
        mass = structures.mass[:, modes, None] * diagonal + ball * (shape.transpose(0, 2, 1) @ shape)
        root = np.linalg.inv(np.linalg.cholesky(mass))
        square, vectors = np.linalg.eigh(root @ (structures.spring[:, modes, None] * root.transpose(0, 2, 1)))
        v, rate = root.transpose(0, 2, 1) @ vectors, np.sqrt(square)
        projected = v.transpose(0, 2, 1) @ mass
        here = np.ix_(range(n), modes, modes)
        swing[here], deflection[here] = projected, rate[:, :, None] * projected
        for axis in range(2):
            deflection[:, modes, k + axis] = (deflection[here] @ sag[:, modes, axis, None])[..., 0]
        still = rate[:, None, :] * (shape @ v) - force @ v / rate[:, None, :]
        moving = shape @ v @ (v.transpose(0, 2, 1) @ (structures.dashpot[:, modes, None] * v))
        reach[:, :, modes] = np.hypot(still, moving)
    return Swinging(deflection, swing, reach, bias)
