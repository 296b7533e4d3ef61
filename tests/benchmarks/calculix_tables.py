"""Plates at rest and turning in CalculiX, to hold theories and large deflection against.

`python -m tests.benchmarks.calculix_tables NAME` writes tests/fem/data/calculix_NAME.csv anew (ten minutes to half an
hour), for NAME theories (thick and thin plates of all shapes and Poisson's ratios, at rest), bent (plates that their
load turns far) or blades (tapered, or leaving the hub at an angle): each case on two meshes of C3D20R that shrink
towards the edges. Theories' frequencies are extrapolated at the third order, and `error` is what that changes; the
others are those of the finer mesh, and `error` is how much the two differ.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fem.meshes.thickness import Polynomial
from tests.benchmarks import calculix
from tests.survey.planforms import Planform, ell, rectangle, tee

DATA = Path(__file__).parents[1] / "fem" / "data"
COUNT = 6

TITANIUM = 114e9, 0.33, 4430.0
STEEL = 200e9, 0.3, 7850.0
ALUMINIUM = 70e9, 0.33, 2700.0

TAPERED = Polynomial(((6e-3, 0.0, -0.8), (-15e-3,)))
"""6 mm in the middle of the root, 3 mm in that of the tip, and 1.28 mm less at the edges of 0.08 m."""

THIN = Polynomial(((3e-3, 0.0, -0.4), (-7e-3,)))
"""Half as thick."""

THICK = Polynomial(((16e-3, 0.0, -2.0), (-40e-3,)))
"""16 mm in the middle of the root, 8 mm in that of the tip, and 3.2 mm less at the edges."""


@dataclass(frozen=True)
class Case:
    """A planform, its thickness in m, material (E, nu, rho), rpm, hub radius in m, stagger and precone in degrees.

    layers: of bricks, on the finer mesh.
    """

    planform: Planform
    thickness: float | Polynomial
    material: tuple
    rpm: float = 0.0
    hub: float = 0.0
    stagger: float = 0.0
    precone: float = 0.0
    layers: int = 2

    @property
    def omega(self):
        """In rad/s."""
        return self.rpm * np.pi / 30.0


def steel(nu):
    """Steel of another Poisson's ratio."""
    return 2e11, nu, 7850.0


NARROW, WIDE = rectangle(0.2, 0.08), rectangle(0.2, 0.1)

TABLES = {
    "theories": {
        "wide": Case(rectangle(0.2, 0.15), 0.012, steel(0.3), layers=4),
        "thick": Case(NARROW, 0.01, steel(0.4), layers=4),
        "thin": Case(WIDE, 0.001, steel(0.3)),
        "rubber": Case(NARROW, 0.005, steel(0.49), layers=4),
        "cork": Case(WIDE, 0.01, steel(0.0), layers=4),
        "tapered": Case(rectangle(0.2, 0.1, taper=0.5), 0.004, steel(0.4), layers=4),
        "swept": Case(rectangle(0.2, 0.08, sweep=np.degrees(np.arctan(0.5))), 0.005, steel(0.45), layers=4),
        "T": Case(tee(0.2, 0.2, 0.15, 0.02), 0.0026, steel(0.3), layers=4),
        "L": Case(ell(0.2, 0.12, 0.15, 0.04), 0.004, steel(0.4), layers=4),
    },
    "bent": {
        "titanium 3 mm": Case(WIDE, 0.003, TITANIUM, 15000, 0.0, 45.0, layers=4),
        "titanium 2 mm": Case(WIDE, 0.002, TITANIUM, 9000, 0.0, 45.0, layers=4),
        "swept": Case(rectangle(0.2, 0.08, sweep=30.0), 0.003, STEEL, 8000, 0.0, 45.0),
        "L, slow": Case(ell(0.2, 0.12, 0.15, 0.02), 0.004, ALUMINIUM, 3000, 0.05, layers=4),
        "L, fast": Case(ell(0.2, 0.12, 0.15, 0.02), 0.004, ALUMINIUM, 6000, 0.05, layers=4),
    },
    "blades": {
        "tapered": Case(NARROW, TAPERED, TITANIUM, 12000, 0.1),
        "tapered, thick": Case(NARROW, THICK, TITANIUM, 15000, 0.1),
        "tapered, staggered": Case(NARROW, THIN, TITANIUM, 9000, 0.05, 45.0),
        "precone": Case(NARROW, 4e-3, STEEL, 5000, 0.05, precone=3.0),
        "precone, staggered": Case(NARROW, 4e-3, STEEL, 4000, 0.05, 30.0, 20.0),
        "precone, in the plane": Case(NARROW, 4e-3, STEEL, 5000, 0.1, 90.0, 10.0),
        "precone, tapered": Case(NARROW, TAPERED, TITANIUM, 8000, 0.1, 20.0, -5.0),
    },
}


def solve(case, rpm, fineness, layers):
    """CalculiX's frequencies (COUNT,) in Hz at a speed, with layers of bricks."""
    varies = isinstance(case.thickness, Polynomial)
    return calculix.frequencies_on(
        case.planform.graded(fineness),
        (lambda x, y: case.thickness.at(np.array([x, y]))) if varies else case.thickness,
        layers,
        case.material,
        rpm * np.pi / 30.0,
        hub=case.hub,
        stagger=np.radians(case.stagger),
        precone=np.radians(case.precone),
        count=COUNT,
    )


def stored(table):
    """Frequencies in Hz and their relative errors, each (2, COUNT), at rest and at speed, by case of a table."""
    found = {name: np.full((2, 2, COUNT), np.nan) for name in TABLES[table]}
    for row in calculix.rows(DATA / f"calculix_{table}.csv"):
        place = int(float(row["rpm"]) > 0), int(row["mode"]) - 1
        for values, key in zip(found[row["case"]], ("frequency_hz", "error"), strict=True):
            values[place] = float(row[key])
    return {name: tuple(both) for name, both in found.items()}


def write(table):
    """Write a table."""
    with (DATA / f"calculix_{table}.csv").open("w") as file:
        file.write("# CalculiX 2.20, C3D20R, *STATIC (NLGEOM) + CENTRIF, then *FREQUENCY with PERTURBATION; made by\n")
        file.write("# tests/benchmarks/calculix_tables.py, where the cases are, and what error is.\n")
        file.write("case,rpm,mode,frequency_hz,error\n")
        for name, case in TABLES[table].items():
            for rpm in sorted({0.0, case.rpm}):
                coarse, fine = solve(case, rpm, 2, (case.layers + 1) // 2), solve(case, rpm, 3, case.layers)
                error = coarse / fine - 1.0
                if table == "theories":
                    error /= (3 / 2) ** 3 - 1.0
                    fine *= 1.0 - error
                for mode, (f, e) in enumerate(zip(fine, np.abs(error), strict=True), 1):
                    file.write(f'"{name}",{rpm:g},{mode},{f:.4f},{e:.1e}\n')
                file.flush()


if __name__ == "__main__":
    write(*sys.argv[1:])
