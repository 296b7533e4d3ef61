"""Make the meshes of this folder: `python meshes/make.py`.

The mid-surfaces of plates are in metres, x outwards, y across; the root is the edge at x = 0. `Airfoil` is a solid
blade by its parameters, twisted and cambered; change its numbers for another one.
"""

from dataclasses import dataclass
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


def grid(length: float, width: float, nx: int, ny: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) of a rectangle with its root's middle at 0, along x first, and its nx by ny cells (m, 4)."""
    x, y = np.meshgrid(np.linspace(0.0, length, nx + 1), np.linspace(-width / 2, width / 2, ny + 1))
    corner = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    cells = np.column_stack([corner, corner + 1, corner + nx + 2, corner + nx + 1])
    return np.column_stack([x.ravel(), y.ravel()]), cells


def plate(nx: int, ny: int) -> meshio.Mesh:
    """Mesh the paper's plate by nx by ny quadrilaterals."""
    return surface(*grid(LENGTH, WIDTH, nx, ny))


def blade(nx: int = 24, ny: int = 8) -> meshio.Mesh:
    """Mesh a tapered, slightly swept blade by quadrilaterals."""
    square, cells = grid(1.0, 1.0, nx, ny)
    s, t = square.T
    chord = BLADE["root"] + (BLADE["tip"] - BLADE["root"]) * s
    return surface(np.column_stack([BLADE["length"] * s, BLADE["sweep"] * s**2 + chord * t]), cells)


def plate_with_hole(rings: int = 6) -> meshio.Mesh:
    """Mesh the paper's plate with a round hole near its tip by triangles: a ring of cells in a grid."""
    step, edge = 0.01, 0.14
    inside, cells = grid(edge, WIDTH, round(edge / step), round(WIDTH / step))

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
    n, start = len(around), len(inside)
    k = np.arange(n)
    ring_cells = [
        np.column_stack([r * n + k, r * n + (k + 1) % n, (r + 1) * n + (k + 1) % n, (r + 1) * n + k]) + start
        for r in range(rings)
    ]
    points, merged = merge(np.vstack([inside, ring]), np.vstack([cells, *ring_cells]))
    return surface(points, split(points, merged))


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


def surface(points: np.ndarray, cells: np.ndarray) -> meshio.Mesh:
    """Lay a mesh of triangles or quadrilaterals at z = 0, its cells counter-clockwise."""
    kind = {3: "triangle", 4: "quad"}[cells.shape[1]]
    x, y = points[cells].transpose(2, 0, 1)
    area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    upright = np.where(area[:, None] > 0.0, cells, cells[:, ::-1])
    tags = {name: [np.ones(len(cells), dtype=np.int32)] for name in ("gmsh:physical", "gmsh:geometrical")}
    return meshio.Mesh(np.column_stack([points, np.zeros(len(points))]), [(kind, upright)], cell_data=tags)


@dataclass(frozen=True)
class Airfoil:
    """A solid blade: twisted, cambered, tapered, swept and leaning. Lengths in m, angles in degrees.

    x is radial and measured from the spin axis, y runs across, z through the thickness. Along the span s = 0 ... 1 and
    the chord eta = -1 ... 1 the thickness is that of the section "flat", or of a "lens" thinner at its edges by `edge`;
    the camber line is a circular arc that turns by `camber`, on a straight chord. The section turns by `pretwist` s
    about x, and its middle lies at y = sweep s², z = lean s².
    """

    length: float = 0.24
    chord: float = 0.11
    thickness: float = 0.007
    chord_taper: float = 1.0
    thickness_taper: float = 1.0
    section: str = "lens"
    edge: float = 0.3
    pretwist: float = 0.0
    camber: float = 0.0
    sweep: float = 0.0
    lean: float = 0.0
    hub_radius: float = 0.1

    def points(self, s: np.ndarray, eta: np.ndarray, zeta: np.ndarray) -> np.ndarray:
        """Places (..., 3) of the blade at spans s, chords eta and thicknesses zeta = -1 ... 1."""
        chord = self.chord * (1.0 - (1.0 - self.chord_taper) * s)
        height = self.thickness * (1.0 - (1.0 - self.thickness_taper) * s)
        if self.section == "lens":
            height = height * (self.edge + (1.0 - self.edge) * (1.0 - eta**2))
        half = 0.5 * np.radians(self.camber)
        if half == 0.0:
            along, off, turn = 0.5 * chord * eta, np.zeros_like(eta), np.zeros_like(eta)
        else:
            radius, turn = chord / (2.0 * np.sin(half)), eta * half
            along, off = radius * np.sin(turn), radius * (np.cos(turn) - np.sin(half) / half)
        y = along + 0.5 * zeta * height * np.sin(turn)
        z = off + 0.5 * zeta * height * np.cos(turn)
        twist = np.radians(self.pretwist) * s
        return np.stack(
            [
                self.hub_radius + self.length * s,
                y * np.cos(twist) - z * np.sin(twist) + self.sweep * s**2,
                y * np.sin(twist) + z * np.cos(twist) + self.lean * s**2,
            ],
            axis=-1,
        )


def solid(shape: Airfoil, cells: tuple[int, int, int] = (12, 6, 1), grade: float = 4.0) -> meshio.Mesh:
    """Mesh a blade by 20-node hexahedra, so many along span, chord and thickness; the set NROOT is its root.

    grade: how many times longer the cells at the tip are than those at the root, about.
    """
    n = [2 * count + 1 for count in cells]
    even = np.linspace(0.0, 1.0, cells[0] + 1)
    ends = even if grade == 1.0 else (grade**even - 1.0) / (grade - 1.0)
    span = np.empty(n[0])
    span[::2], span[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
    grid = np.meshgrid(span, np.linspace(-1.0, 1.0, n[1]), np.linspace(-1.0, 1.0, n[2]), indexing="ij")
    points = shape.points(*grid).reshape(-1, 3)
    number = np.arange(len(points)).reshape(n)
    around = [(0, 0), (2, 0), (2, 2), (0, 2)]
    between = [(1, 0), (2, 1), (1, 2), (0, 1)]
    places = [(*at, 0) for at in around] + [(*at, 2) for at in around]
    places += [(*at, 0) for at in between] + [(*at, 2) for at in between] + [(*at, 1) for at in around]
    i, j, k = (2 * index.ravel() for index in np.meshgrid(*(np.arange(count) for count in cells), indexing="ij"))
    bricks = np.stack([number[i + a, j + b, k + c] for a, b, c in places], axis=1)
    used, renumbered = np.unique(bricks, return_inverse=True)
    root = np.flatnonzero(np.isin(used, number[0]))
    return meshio.Mesh(points[used], [("hexahedron20", renumbered.reshape(bricks.shape))], point_sets={"NROOT": root})


def write_inp(path: Path, mesh: meshio.Mesh, heading: str) -> None:
    """Write a solid mesh as an input file of Abaqus and CalculiX."""
    lines = ["*HEADING", heading, "*NODE,NSET=NALL"]
    lines += [f"{k},{x:.9g},{y:.9g},{z:.9g}" for k, (x, y, z) in enumerate(mesh.points, 1)]
    lines.append("*ELEMENT,TYPE=C3D20R,ELSET=EALL")
    for k, cell in enumerate(mesh.cells[0].data + 1, 1):
        numbers = [str(each) for each in (k, *cell)]
        lines += [",".join(numbers[:11]) + ",", ",".join(numbers[11:])]
    lines.append("*NSET,NSET=NROOT")
    root = mesh.point_sets["NROOT"] + 1
    lines += [",".join(map(str, root[k : k + 10])) for k in range(0, len(root), 10)]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


FAN = Airfoil(0.24, 0.11, 0.007, 0.95, 0.45, pretwist=42.0, camber=12.0, sweep=0.01, lean=0.004)
"""A small fan blade of titanium: the example to start from."""


def main() -> None:
    """Write every mesh beside this file."""
    write_inp(HERE / "fan_blade.inp", solid(FAN, (16, 8, 2)), "A twisted fan blade in m, x from the spin axis")
    meshes = {f"plate_{name}": plate(*cells) for name, cells in RESOLUTIONS.items()}
    meshes |= {"blade": blade(), "plate_with_hole": plate_with_hole()}
    for name, mesh in meshes.items():
        meshio.write(HERE / f"{name}.msh", mesh, file_format="gmsh22", binary=False)


if __name__ == "__main__":
    main()
