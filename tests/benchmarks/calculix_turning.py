"""Plates that their centrifugal load bends, that taper or leave the hub at an angle, in CalculiX.

`python -m tests.benchmarks.calculix_turning bent` writes tests/fem/data/calculix_bent.csv anew (ten minutes), `blades`
tests/fem/data/calculix_blades.csv (half an hour): each case at rest and at its speed on two meshes of C3D20R that
shrink towards the edges, the finer one's frequencies and by how much the two differ.
"""

import csv
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from skfem import MeshQuad

from fem.meshes.mesh_sequence import crowded, graded
from fem.meshes.thickness import Polynomial
from tests.benchmarks import calculix

DATA = Path(__file__).parents[1] / "fem" / "data"

TITANIUM = 114e9, 0.33, 4430.0
STEEL = 200e9, 0.3, 7850.0
ALUMINIUM = 70e9, 0.33, 2700.0

COUNT = 6

TAPERED = Polynomial(((6e-3, 0.0, -0.8), (-15e-3,)))
"""6 mm in the middle of the root, 3 mm in that of the tip, and 1.28 mm less at the edges of 0.08 m."""

THIN = Polynomial(((3e-3, 0.0, -0.4), (-7e-3,)))
"""Half as thick."""

THICK = Polynomial(((16e-3, 0.0, -2.0), (-40e-3,)))
"""16 mm in the middle of the root, 8 mm in that of the tip, and 3.2 mm less at the edges."""


def even(thickness):
    """A constant thickness."""
    return Polynomial(((thickness,),))


def rectangle(n, width=0.1):
    """0.2 m long, 2 n by n cells."""
    return graded(0.2, width, 2 * n, n)


def narrow(n):
    """0.2 x 0.08 m."""
    return rectangle(n, 0.08)


def swept(n):
    """0.2 x 0.08 m, its tip moved by 30 degrees towards y."""
    x, y = narrow(n).p
    return MeshQuad(np.array([x, y + np.tan(np.radians(30.0)) * x]), narrow(n).t)


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
    """A planform, its thickness and hub radius in m, material (E, nu, rho), rpm, stagger and precone in degrees.

    mesh: its size and layers; the coarser one has three quarters and a half of them.
    """

    planform: object
    thickness: Polynomial
    material: tuple
    rpm: float
    hub: float
    stagger: float = 0.0
    precone: float = 0.0
    mesh: tuple = (12, 2)

    @property
    def omega(self):
        """In rad/s."""
        return self.rpm * np.pi / 30.0


BENT = {
    "titanium 3 mm": Case(rectangle, even(0.003), TITANIUM, 15000, 0.0, 45.0, mesh=(16, 4)),
    "titanium 2 mm": Case(rectangle, even(0.002), TITANIUM, 9000, 0.0, 45.0, mesh=(16, 4)),
    "swept": Case(swept, even(0.003), STEEL, 8000, 0.0, 45.0),
    "L, slow": Case(ell, even(0.004), ALUMINIUM, 3000, 0.05, mesh=(12, 4)),
    "L, fast": Case(ell, even(0.004), ALUMINIUM, 6000, 0.05, mesh=(12, 4)),
}

BLADES = {
    "tapered": Case(narrow, TAPERED, TITANIUM, 12000, 0.1),
    "tapered, thick": Case(narrow, THICK, TITANIUM, 15000, 0.1),
    "tapered, staggered": Case(narrow, THIN, TITANIUM, 9000, 0.05, 45.0),
    "precone": Case(narrow, even(4e-3), STEEL, 5000, 0.05, precone=3.0),
    "precone, staggered": Case(narrow, even(4e-3), STEEL, 4000, 0.05, 30.0, 20.0),
    "precone, in the plane": Case(narrow, even(4e-3), STEEL, 5000, 0.1, 90.0, 10.0),
    "precone, tapered": Case(narrow, TAPERED, TITANIUM, 8000, 0.1, 20.0, -5.0),
}

TABLES = {"bent": BENT, "blades": BLADES}


def solve(case, rpm, n, layers):
    """CalculiX's frequencies (COUNT,) in Hz at a speed on a mesh n with layers of bricks."""
    return calculix.frequencies_on(
        case.planform(n),
        lambda x, y: case.thickness.at(np.array([x, y])),
        layers,
        case.material,
        rpm * np.pi / 30.0,
        hub=case.hub,
        stagger=np.radians(case.stagger),
        precone=np.radians(case.precone),
        count=COUNT,
    )


def stored(table):
    """Frequencies (2, COUNT) in Hz at rest and at speed, and how much two meshes differ, by case of a table."""
    found = {name: np.zeros((2, 2, COUNT)) for name in TABLES[table]}
    with (DATA / f"calculix_{table}.csv").open() as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            place = int(float(row["rpm"]) > 0), int(row["mode"]) - 1
            for values, key in zip(found[row["case"]], ("frequency_hz", "difference"), strict=True):
                values[place] = float(row[key])
    return {name: (frequencies, differences) for name, (frequencies, differences) in found.items()}


def write(table):
    """Write a table."""
    with (DATA / f"calculix_{table}.csv").open("w") as file:
        file.write("# CalculiX 2.20, C3D20R, *STATIC (NLGEOM) + CENTRIF, then *FREQUENCY with PERTURBATION; made by\n")
        file.write(
            "# tests/benchmarks/calculix_turning.py, where the cases and their meshes are. difference: relative,\n"
        )
        file.write("# of the frequency from that on a coarser mesh.\n")
        file.write("case,rpm,mode,frequency_hz,difference\n")
        for name, case in TABLES[table].items():
            for rpm in (0.0, case.rpm):
                size, layers = case.mesh
                before, found = solve(case, rpm, 3 * size // 4, layers // 2), solve(case, rpm, size, layers)
                for mode, (f, d) in enumerate(zip(found, np.abs(before / found - 1.0), strict=True), 1):
                    file.write(f'"{name}",{rpm:g},{mode},{f:.4f},{d:.1e}\n')
                file.flush()


if __name__ == "__main__":
    write(*sys.argv[1:])
