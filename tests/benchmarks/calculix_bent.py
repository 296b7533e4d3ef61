"""Plates that their centrifugal load bends, out of their plane or in it, in CalculiX.

`python tests/benchmarks/calculix_bent.py` writes tests/fem/data/calculix_bent.csv anew (ten minutes): each case at
rest and at its speed on two meshes of C3D20R that shrink towards the edges, the finer one's frequencies and by how much
the two differ.
"""

from dataclasses import dataclass
from pathlib import Path

import calculix
import calculix_table
import numpy as np
from skfem import MeshQuad

from fem.meshes.mesh_sequence import crowded, graded

DATA = Path(__file__).parents[1] / "fem" / "data" / "calculix_bent.csv"

TITANIUM = 114e9, 0.33, 4430.0
STEEL = 200e9, 0.3, 7850.0
ALUMINIUM = 70e9, 0.33, 2700.0

COUNT = 6


def rectangle(n):
    """0.2 x 0.1 m, 2 n by n cells."""
    return graded(0.2, 0.1, 2 * n, n)


def swept(n):
    """0.2 x 0.08 m, its tip moved by 30 degrees towards y, 2 n by n cells."""
    mesh = graded(0.2, 0.08, 2 * n, n)
    x, y = mesh.p
    return MeshQuad(np.array([x, y + np.tan(np.radians(30.0)) * x]), mesh.t)


def ell(n):
    """An arm of 20 x 150 mm that carries, on one side, a tip of 50 x 120 mm."""
    along = np.concatenate([_between(0.0, 0.15, 2 * n), _between(0.15, 0.2, n)[1:]])
    across = np.concatenate([_between(-0.01, 0.01, max(n // 2, 2)), _between(0.01, 0.11, 2 * n)[1:]])
    whole = MeshQuad.init_tensor(along, across)
    x, y = whole.p[:, whole.t].mean(axis=1)
    return whole.restrict(np.flatnonzero((x > 0.15) | (y < 0.01)))


def _between(a, b, n):
    return a + 0.5 * (b - a) * (1.0 + crowded(n))


@dataclass(frozen=True)
class Case:
    """A planform, a thickness and a hub radius in m, a material (E, nu, rho), a speed in rpm, a stagger in degrees.

    mesh: its size and layers; the coarser one has three quarters and a half of them.
    """

    planform: object
    thickness: float
    material: tuple
    rpm: float
    hub: float
    stagger: float
    mesh: tuple

    @property
    def omega(self):
        """In rad/s."""
        return self.rpm * np.pi / 30.0


CASES = {
    "titanium 3 mm": Case(rectangle, 0.003, TITANIUM, 15000, 0.0, 45.0, (16, 4)),
    "titanium 2 mm": Case(rectangle, 0.002, TITANIUM, 9000, 0.0, 45.0, (16, 4)),
    "swept": Case(swept, 0.003, STEEL, 8000, 0.0, 45.0, (12, 2)),
    "L, slow": Case(ell, 0.004, ALUMINIUM, 3000, 0.05, 0.0, (12, 4)),
    "L, fast": Case(ell, 0.004, ALUMINIUM, 6000, 0.05, 0.0, (12, 4)),
}


def solve(case, rpm, n, layers):
    """CalculiX's frequencies (COUNT,) in Hz at a speed on a mesh n with layers of bricks."""
    return calculix.frequencies_on(
        case.planform(n),
        case.thickness,
        layers,
        case.material,
        rpm * np.pi / 30.0,
        hub=case.hub,
        stagger=np.radians(case.stagger),
        count=COUNT,
    )


def stored():
    """Frequencies (2, COUNT) in Hz at rest and at speed, and how much two meshes differ, by case."""
    return calculix_table.stored(DATA, CASES, COUNT)


if __name__ == "__main__":
    calculix_table.write(DATA, Path(__file__).name, CASES, solve)
