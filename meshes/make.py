"""Make the meshes of this folder: `python meshes/make.py`.

Each is a mid-surface in metres, x outwards from the hub's surface, y across; the root is the edge at x = 0.
"""

from pathlib import Path

import meshio
import numpy as np

HERE = Path(__file__).parent
LENGTH, WIDTH = 0.20, 0.08
RESOLUTIONS = {"coarse": (10, 4), "medium": (20, 8), "fine": (40, 16)}


def grid(nx: int, ny: int) -> meshio.Mesh:
    """Mesh the paper's plate as nx by ny quadrilaterals."""
    x, y = np.meshgrid(np.linspace(0.0, LENGTH, nx + 1), np.linspace(-WIDTH / 2, WIDTH / 2, ny + 1))
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    corner = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    cells = np.column_stack([corner, corner + 1, corner + nx + 2, corner + nx + 1])
    return meshio.Mesh(points, [("quad", cells)])


def main() -> None:
    """Write every mesh beside this file."""
    for name, (nx, ny) in RESOLUTIONS.items():
        grid(nx, ny).write(HERE / f"plate_{name}.msh", file_format="gmsh22", binary=False)


if __name__ == "__main__":
    main()
