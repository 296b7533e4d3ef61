"""The solid blade: a volume mesh, its material, the nodes that are held, and the spin axis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.meshes.volume import VolumeMesh
    from fem.plate import Material

    Array = NDArray[np.float64]
    Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Blade:
    """A solid blade, clamped at some of its nodes.

    Attributes:
        mesh: of its volume, in m.
        material: what it is made of.
        root: numbers of the nodes that are held.
        axis: unit vector (3,) of the spin axis.
        origin: a point (3,) in m on it.
    """

    mesh: VolumeMesh
    material: Material
    root: Indices
    axis: Array
    origin: Array

    @property
    def projector(self) -> Array:
        """I - n n^T, (3, 3): the part of a vector that is perpendicular to the axis."""
        return np.asarray(np.eye(3) - np.outer(self.axis, self.axis))

    @property
    def spin(self) -> Array:
        """The matrix (3, 3) of v -> n x v."""
        x, y, z = self.axis
        return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
