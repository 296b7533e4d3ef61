"""How far a mesh is from the limit: frequencies on two meshes, extrapolated (Richardson 1911).

The error on an even mesh is taken to fall with the square of the cell size. Away from corners these elements do
better; the stress singularities at the ends of a clamped edge, and the edge layer of a Mindlin plate, hold them to
that. Graded meshes do better (`fem.meshes.ladder`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.meshes.thickness import Nodal
from fem.modes.solve import solve_modes
from fem.operators.assembly import assemble

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.modes.real import Modes
    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]

ORDER = 2
"""Order in the cell size to which errors are taken to fall on an even mesh."""


def coarser(mesh: Any) -> Any | None:
    """Leave out every second grid line; None where the mesh is no grid of quadrilaterals."""
    x, y = (np.unique(np.round(c / np.ptp(c), 12), return_index=True)[1] for c in mesh.p)
    if mesh.t.shape[0] != 4 or x.size * y.size != mesh.p.shape[1] or min(x.size, y.size) < 3:
        return None
    lines = [np.sort(c[k])[_every_second(k.size)] for c, k in zip(mesh.p, (x, y), strict=True)]
    return type(mesh).init_tensor(*lines)


def _every_second(count: int) -> NDArray[np.int64]:
    return np.unique(np.append(np.arange(0, count, 2), count - 1))


def extrapolated_errors(coarse_hz: Array, fine_hz: Array, growth: float) -> Array:
    """Relative errors (count,) of frequencies on the finer mesh, those on the coarser being growth times as large."""
    return np.asarray(np.abs(coarse_hz / fine_hz - 1.0) / (growth - 1.0))


def estimate_error(operators: Operators, modes: Modes) -> Array:
    """Relative error estimate (count,) of each frequency, by modes on a coarser mesh or else on a finer one.

    Costs about a quarter of the modes themselves on a grid, four times as much on other meshes.
    """
    plate = operators.plate
    mesh = None if isinstance(plate.thickness, Nodal) else coarser(plate.mesh)
    other = replace(plate, mesh=plate.mesh.refined() if mesh is None else mesh)
    neighbour = assemble(other, operators.rotor, operators.effects, operators.model.theory)
    again = solve_modes(neighbour, modes.omega, modes.eigenvalues.size).frequencies_hz
    if mesh is None:
        return 2.0**ORDER * extrapolated_errors(modes.frequencies_hz, again, 2.0**ORDER)
    cells = plate.mesh.t.shape[1] / mesh.t.shape[1]
    return extrapolated_errors(again, modes.frequencies_hz, float(cells ** (0.5 * ORDER)))
