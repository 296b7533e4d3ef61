"""How far the mesh is from the limit: frequencies on two meshes, extrapolated (Richardson 1911).

The error is taken to fall with the square of the cell size. Away from corners these elements do better; the
stress singularities at the ends of a clamped edge, and the edge layer of a Mindlin plate, hold them to that.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.modes import solve_modes
from fem.operators import assemble

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.modes import Modes
    from fem.operators import Operators

ORDER = 2
"""Order in the cell size to which errors are taken to fall."""


def coarser(mesh: Any) -> Any | None:
    """Leave out every second grid line; None where the mesh is no grid of quadrilaterals."""
    x, y = (np.unique(np.round(c / np.ptp(c), 12), return_index=True)[1] for c in mesh.p)
    if mesh.t.shape[0] != 4 or x.size * y.size != mesh.p.shape[1] or min(x.size, y.size) < 3:
        return None
    lines = [np.sort(c[k])[_every_second(k.size)] for c, k in zip(mesh.p, (x, y), strict=True)]
    return type(mesh).init_tensor(*lines)


def _every_second(count: int) -> NDArray[np.int64]:
    return np.unique(np.append(np.arange(0, count, 2), count - 1))


def companion(operators: Operators) -> Operators:
    """Matrices of the same plate on a coarser mesh, or on a finer one where the mesh is no grid."""
    plate = operators.plate
    mesh = coarser(plate.mesh)
    other = replace(plate, mesh=plate.mesh.refined() if mesh is None else mesh)
    return assemble(other, operators.rotor, operators.effects, operators.model.theory)


def estimate_error(operators: Operators, modes: Modes, other: Operators | None = None) -> NDArray[np.float64]:
    """Relative error estimate (count,) of each frequency, by modes on a coarser mesh or else on a finer one.

    other: the `companion` of the operators, where it serves several speeds. Costs about a quarter of the modes
    themselves on a grid, four times as much on other meshes.
    """
    other = companion(operators) if other is None else other
    again = solve_modes(other, modes.omega, modes.eigenvalues.size)
    difference = np.abs(again.frequencies_hz / modes.frequencies_hz - 1.0)
    cells = cell_ratio(other.plate.mesh, operators.plate.mesh)
    finer = cells < 1.0
    factor = (2.0 if finer else np.sqrt(cells)) ** ORDER
    return np.asarray(difference * (factor / (factor - 1.0) if finer else 1.0 / (factor - 1.0)))


def cell_ratio(coarse: Any, fine: Any) -> float:
    """Cells of a fine mesh for each cell of a coarse one."""
    return float(fine.t.shape[1] / coarse.t.shape[1])
