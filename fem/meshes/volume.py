"""Volume meshes of solid blades: nodes, cells of first or second order, named sets of nodes; read from files.

Files are read by meshlane, a maintained continuation of meshio: it knows the second-order wedges (Abaqus C3D15,
CalculiX) that meshio stumbles over, and keeps node sets.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class VolumeMesh:
    """A mesh of a volume.

    Attributes:
        points: (npoint, 3) in m.
        cells: kinds of cells by the name that `fem.meshes.cells` has, and their points (ncell, nnode).
        sets: points by the names of sets.
    """

    points: Array
    cells: tuple[tuple[str, Indices], ...]
    sets: dict[str, Indices] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Number of cells."""
        return sum(len(cells) for _, cells in self.cells)

    @cached_property
    def size(self) -> float:
        """Largest extent in m."""
        return float(np.ptp(self.points, axis=0).max())
