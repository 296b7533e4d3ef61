"""Make the meshes of this folder: `python meshes/make.py`.

Each is a mid-surface in metres, x outwards, y across; the root is the edge at x = 0.
"""

from itertools import pairwise
from pathlib import Path

import meshio
import numpy as np

HERE = Path(__file__).parent

LENGTH, WIDTH = 0.20, 0.08
"""The paper's plate."""

RESOLUTIONS = {"coarse": (10, 4), "medium": (20, 8), "fine": (40, 16)}

BLADE = {"length": 0.25, "root": 0.10, "tip": 0.05, "sweep": 0.02}
"""A tapered blade: length, chords, and how far the tip's middle lies off the axis."""

HOLE, RADIUS = np.array([0.17, 0.0]), 0.006
"""Centre and radius of the hole in the paper's plate."""


def quads(nx: int, ny: int) -> np.ndarray:
    """Cells of a grid of nx by ny quadrilaterals whose points run along x first."""
    corner = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    return np.column_stack([corner, corner + 1, corner + nx + 2, corner + nx + 1])


def plate(nx: int, ny: int) -> meshio.Mesh:
    """Mesh the paper's plate by nx by ny quadrilaterals."""
    x, y = np.meshgrid(np.linspace(0.0, LENGTH, nx + 1), np.linspace(-WIDTH / 2, WIDTH / 2, ny + 1))
    return surface(np.column_stack([x.ravel(), y.ravel()]), "quad", quads(nx, ny))


def blade(nx: int = 24, ny: int = 8) -> meshio.Mesh:
    """Mesh a tapered, slightly swept blade by quadrilaterals."""
    s, t = np.meshgrid(np.linspace(0.0, 1.0, nx + 1), np.linspace(-0.5, 0.5, ny + 1))
    chord = BLADE["root"] + (BLADE["tip"] - BLADE["root"]) * s
    points = np.column_stack([(BLADE["length"] * s).ravel(), (BLADE["sweep"] * s**2 + chord * t).ravel()])
    return surface(points, "quad", quads(nx, ny))


def plate_with_hole(rings: int = 6) -> meshio.Mesh:
    """Mesh the paper's plate with a round hole near its tip by triangles: a ring of cells in a grid."""
    step, edge = 0.01, 0.14
    nx, ny = round(edge / step), round(WIDTH / step)
    x, y = np.meshgrid(np.linspace(0.0, edge, nx + 1), np.linspace(-WIDTH / 2, WIDTH / 2, ny + 1))
    grid, cells = np.column_stack([x.ravel(), y.ravel()]), quads(nx, ny)

    low, high = np.array([edge, -WIDTH / 2]), np.array([LENGTH, WIDTH / 2])
    corners = [low, [high[0], low[1]], high, [low[0], high[1]], low]
    outer = []
    for a, b in pairwise(corners):
        pieces = round(np.linalg.norm(np.subtract(b, a)) / step)
        outer += [np.add(a, np.subtract(b, a) * k / pieces) for k in range(pieces)]
    around = np.array(outer)
    away = around - HOLE
    inner = HOLE + RADIUS * away / np.linalg.norm(away, axis=1)[:, None]
    # Rings grow outwards so that the cells at the hole are as wide as they are long.
    growth = (np.geomspace(1.0, 4.0, rings + 1) - 1.0) / 3.0
    ring = np.vstack([around + (inner - around) * g for g in 1.0 - growth[::-1]])
    n, start = len(around), len(grid)
    k = np.arange(n)
    ring_cells = [
        np.column_stack([r * n + k, r * n + (k + 1) % n, (r + 1) * n + (k + 1) % n, (r + 1) * n + k]) + start
        for r in range(rings)
    ]
    points, merged = merge(np.vstack([grid, ring]), np.vstack([cells, *ring_cells]))
    return surface(points, "triangle", split(points, merged))


def merge(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Join points at the same place."""
    _, first, number = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    return points[first], number.reshape(-1)[cells]


def split(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Split quadrilaterals along their shorter diagonals."""
    a, b, c, d = cells.T
    short = np.linalg.norm(points[a] - points[c], axis=1) <= np.linalg.norm(points[b] - points[d], axis=1)
    one = np.where(short, np.stack([a, b, c]), np.stack([a, b, d]))
    two = np.where(short, np.stack([a, c, d]), np.stack([b, c, d]))
    return np.hstack([one, two]).T


def surface(points: np.ndarray, kind: str, cells: np.ndarray) -> meshio.Mesh:
    """Lay a mesh at z = 0, its cells counter-clockwise."""
    x, y = points[cells].transpose(2, 0, 1)
    area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    upright = np.where(area[:, None] > 0.0, cells, cells[:, ::-1])
    tags = {name: [np.ones(len(cells), dtype=np.int32)] for name in ("gmsh:physical", "gmsh:geometrical")}
    return meshio.Mesh(np.column_stack([points, np.zeros(len(points))]), [(kind, upright)], cell_data=tags)


def main() -> None:
    """Write every mesh beside this file."""
    meshes = {f"plate_{name}": plate(*cells) for name, cells in RESOLUTIONS.items()}
    meshes |= {"blade": blade(), "plate_with_hole": plate_with_hole()}
    for name, mesh in meshes.items():
        meshio.write(HERE / f"{name}.msh", mesh, file_format="gmsh22", binary=False)


if __name__ == "__main__":
    main()
