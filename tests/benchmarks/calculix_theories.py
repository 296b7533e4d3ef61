"""Plates at rest in CalculiX, thick and thin, of all shapes and Poisson's ratios, to hold plate theories against.

`python -m tests.benchmarks.calculix_theories` writes tests/fem/data/calculix_theories.csv anew (ten minutes): each on
two meshes of C3D20R that shrink towards edges and corners, extrapolated at the third order, and what that changes.
"""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from skfem import MeshQuad

from fem.meshes.mesh_sequence import Rectangle, crowded

DATA = Path(__file__).parents[1] / "fem" / "data" / "calculix_theories.csv"
COUNT = 6
YOUNG, DENSITY = 2e11, 7850.0


@dataclass(frozen=True)
class Oblong:
    """A rectangle of which the tip is so many times as wide, and moved by so much of the length towards y."""

    length: float
    width: float
    taper: float = 1.0
    sweep: float = 0.0

    def mesh(self, n):
        """A mesh of quadrilaterals for a size."""
        mesh = Rectangle(self.length, self.width).mesh(n)
        x, y = mesh.p
        return MeshQuad(np.stack([x, y * (1.0 - (1.0 - self.taper) * x / self.length) + self.sweep * x]), mesh.t)


@dataclass(frozen=True)
class Armed:
    """An arm (length, width) that carries a tip (length, width) on both sides, a T, or on one, an L."""

    arm: tuple
    tip: tuple
    shape: str

    def mesh(self, n):
        """A mesh of rectangles for a size."""
        (long, narrow), (more, wide) = self.arm, self.tip
        x = [(0.0, long, 2 * n), (long, long + more, n)]
        low = -0.5 * narrow if self.shape == "L" else -0.5 * wide
        middle = (-0.5 * narrow, 0.5 * narrow, 2 * (n // 2))
        y = [middle, (0.5 * narrow, low + wide, n)]
        if self.shape != "L":
            y = [(low, -0.5 * narrow, n), *y]
        whole = MeshQuad.init_tensor(_joined(x), _joined(y))
        a, b = whole.p[:, whole.t].mean(axis=1)
        return whole.restrict(np.flatnonzero((a > long) | (np.abs(b) < 0.5 * narrow)))


def _joined(stretches):
    """Ends of cells that shrink towards both ends of each stretch (from, to, count)."""
    parts = [a + 0.5 * (b - a) * (1.0 + crowded(count)) for a, b, count in stretches]
    return np.concatenate([parts[0], *(part[1:] for part in parts[1:])])


@dataclass(frozen=True)
class Case:
    """A planform, its thickness in m, Poisson's ratio, and the sizes of the two meshes."""

    planform: object
    thickness: float
    nu: float
    sizes: tuple = (5, 7)


CASES = {
    "wide": Case(Oblong(0.2, 0.15), 0.012, 0.3),
    "thick": Case(Oblong(0.2, 0.08), 0.01, 0.4),
    "thin": Case(Oblong(0.2, 0.1), 0.001, 0.3),
    "rubber": Case(Oblong(0.2, 0.08), 0.005, 0.49),
    "cork": Case(Oblong(0.2, 0.1), 0.01, 0.0),
    "tapered": Case(Oblong(0.2, 0.1, 0.5), 0.004, 0.4),
    "swept": Case(Oblong(0.2, 0.08, 1.0, 0.5), 0.005, 0.45),
    "T": Case(Armed((0.15, 0.02), (0.05, 0.2), "T"), 0.0026, 0.3, (6, 9)),
    "L": Case(Armed((0.15, 0.04), (0.05, 0.12), "L"), 0.004, 0.4, (6, 9)),
}


def stored():
    """Frequencies (COUNT,) in Hz and their relative errors, by case."""
    found = {name: np.zeros((2, COUNT)) for name in CASES}
    with DATA.open() as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            found[row["case"]][:, int(row["mode"]) - 1] = float(row["frequency_hz"]), float(row["error"])
    return found


def write():
    """Write the table."""
    from tests.benchmarks import calculix

    with DATA.open("w") as file:
        file.write(
            "# CalculiX 2.20, C3D20R, at rest; made by tests/benchmarks/calculix_theories.py, where the cases are.\n"
        )
        file.write("# error: relative, what the extrapolation from two meshes changes.\n")
        file.write("case,mode,frequency_hz,error\n")
        for name, case in CASES.items():
            layers = 2 if case.thickness < 0.002 else 4
            coarse, fine = (
                calculix.frequencies_on(
                    case.planform.mesh(n), case.thickness, layers, (YOUNG, case.nu, DENSITY), 0.0, count=COUNT
                )
                for n in case.sizes
            )
            error = (coarse / fine - 1.0) / ((case.sizes[1] / case.sizes[0]) ** 3 - 1.0)
            for mode, (f, e) in enumerate(zip(fine * (1.0 - error), np.abs(error), strict=True), 1):
                file.write(f"{name},{mode},{f:.4f},{e:.1e}\n")
            file.flush()


if __name__ == "__main__":
    write()
