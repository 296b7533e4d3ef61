"""Plates like blades in CalculiX: a thickness that varies along and across, and precone.

`python tests/benchmarks/calculix_blades.py` writes tests/fem/data/calculix_blades.csv anew (half an hour): each case at
rest and at its speed on two meshes of C3D20R that shrink towards the edges, the finer one's frequencies and by how much
the two differ.
"""

from dataclasses import dataclass
from pathlib import Path

import calculix
import calculix_table
import numpy as np

from fem.meshes.mesh_sequence import graded
from fem.meshes.thickness import Polynomial

DATA = Path(__file__).parents[1] / "fem" / "data" / "calculix_blades.csv"

TITANIUM = 114e9, 0.33, 4430.0
STEEL = 200e9, 0.3, 7850.0

COUNT = 6

TAPERED = Polynomial(((6e-3, 0.0, -0.8), (-15e-3,)))
"""6 mm in the middle of the root, 3 mm in that of the tip, and 1.28 mm less at the edges of 0.08 m."""

THIN = Polynomial(((3e-3, 0.0, -0.4), (-7e-3,)))
"""Half as thick."""

THICK = Polynomial(((16e-3, 0.0, -2.0), (-40e-3,)))
"""16 mm in the middle of the root, 8 mm in that of the tip, and 3.2 mm less at the edges."""


@dataclass(frozen=True)
class Case:
    """0.2 x 0.08 m: thickness, material (E, nu, rho), rpm, hub radius in m, stagger and precone in degrees."""

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


def even(thickness):
    """A constant thickness."""
    return Polynomial(((thickness,),))


CASES = {
    "tapered": Case(TAPERED, TITANIUM, 12000, 0.1),
    "tapered, thick": Case(THICK, TITANIUM, 15000, 0.1),
    "tapered, staggered": Case(THIN, TITANIUM, 9000, 0.05, stagger=45.0),
    "precone": Case(even(4e-3), STEEL, 5000, 0.05, precone=3.0),
    "precone, staggered": Case(even(4e-3), STEEL, 4000, 0.05, stagger=30.0, precone=20.0),
    "precone, in the plane": Case(even(4e-3), STEEL, 5000, 0.1, stagger=90.0, precone=10.0),
    "precone, tapered": Case(TAPERED, TITANIUM, 8000, 0.1, stagger=20.0, precone=-5.0),
}


def mesh(n):
    """0.2 x 0.08 m, 2 n by n cells."""
    return graded(0.2, 0.08, 2 * n, n)


def solve(case, rpm, n, layers):
    """CalculiX's frequencies (COUNT,) in Hz at a speed on a mesh n with layers of bricks."""
    return calculix.frequencies_on(
        mesh(n),
        lambda x, y: case.thickness.at(np.array([x, y])),
        layers,
        case.material,
        rpm * np.pi / 30.0,
        hub=case.hub,
        stagger=np.radians(case.stagger),
        precone=np.radians(case.precone),
        count=COUNT,
    )


def stored():
    """Frequencies (2, COUNT) in Hz at rest and at speed, and how much two meshes differ, by case."""
    return calculix_table.stored(DATA, CASES, COUNT)


if __name__ == "__main__":
    calculix_table.write(DATA, Path(__file__).name, CASES, solve)
