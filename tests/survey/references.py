"""CalculiX's frequencies of the plates: `python -m tests.survey.references` writes references.csv (an hour).

Each plate on two meshes, one half again as fine as the other, extrapolated: the error falls with a power of the size
of the cells between the second, of what is singular or wants an edge layer, and the fourth, of what is smooth. The
value is midway between what the two say, `error` half of what they differ by, and what extrapolation makes of
CalculiX's rounding, which is large where plates are thin: the coarser mesh is solved with its nodes in other orders and
its lengths in other units, and by as much as these differ each mesh may be off. Where that is too much, one layer of
bricks takes the place of two. It goes on where it was stopped; plates that have been changed are made anew.
"""

import hashlib
import sys
import time
from pathlib import Path

import numpy as np

from tests.benchmarks import calculix
from tests.survey import plates, spinning

DATA = Path(__file__).with_name("references.csv")
COLUMNS = "case", "digest", "mode", "frequency_hz", "error", "with_coriolis_hz", "with_coriolis_error"

HEADER = (
    "# CalculiX 2.20, C3D20R about the static state; made by `python -m tests.survey.references`, where it says how.",
    "# error: relative, of the reference itself. with_coriolis: with Coriolis forces, in CalculiX's matrices.",
)

FINENESS, ORDERS = (2, 3), (2, 4)
BEYOND = tuple(1.0 / ((FINENESS[1] / FINENESS[0]) ** order - 1.0) for order in reversed(ORDERS))
"""Of the two meshes' difference, what is left beyond the finer one by either order."""

THICK = 0.08
"""Thickness over the root's width from which the finer mesh has three layers of bricks, not two as the coarser."""

THIN, NUMBERINGS, TOLERABLE = 0.004, 3, 1e-4
"""Thickness over length up to which rounding is measured, in thicker plates it is below 1e-6; in how many numberings;
and what of it two layers of bricks may have."""


def digest(case):
    """Of what a plate's reference depends on."""
    what = case.planform, case.thickness, case.material, case.hub, case.stagger, case.tip, case.profile, case.rpm
    return hashlib.sha256(repr(what).encode()).hexdigest()[:12]


def solve(case, fineness, layers):
    """Frequencies (2, COUNT) in Hz, without Coriolis forces and with them."""
    found = spinning.matrices(case, fineness, layers)
    spin = case.omega * spinning.axis(case)
    return np.array([found.frequencies(plates.COUNT), found.complex_frequencies(plates.COUNT, spin)])


def reference(case):
    """Frequencies (2, COUNT) in Hz for cells without end, and how much they may be off, relatively."""
    layers = layers_of(case)
    coarse, fine = (solve(case, *mesh) for mesh in zip(FINENESS, layers, strict=True))
    least, greatest = ((fine - coarse) * share for share in BEYOND)
    return fine + 0.5 * (least + greatest), 0.5 * np.abs(greatest - least) / fine + magnified(rounding(case, layers[0]))


def layers_of(case):
    """Layers of bricks of both meshes."""
    if case.thickness > THICK * case.planform.root:
        return 2, 3
    return (1, 1) if rounding(case, 2).max() > TOLERABLE else (2, 2)


def rounding(case, layers):
    """How far apart, relatively, CalculiX's own frequencies (COUNT,) are on the coarser mesh, numbered otherwise."""
    if case.thickness > THIN * case.planform.sides[0]:
        return np.zeros(plates.COUNT)
    found = [spinning.own_frequencies(case, FINENESS[0], layers, number) for number in range(NUMBERINGS)]
    return np.ptp(found, axis=0) / np.min(found, axis=0)


def magnified(error):
    """What extrapolation makes of errors of both meshes, opposite at worst."""
    return (1.0 + sum(BEYOND)) * error


def stored():
    """Frequencies (2, COUNT) in Hz and their errors, by name, of the plates as they are."""
    digests = {case.name: digest(case) for case in plates.cases()}
    found = {}
    for row in _rows():
        if digests.get(row["case"]) == row["digest"]:
            tables = found.setdefault(row["case"], np.zeros((2, 2, plates.COUNT)))
            tables[:, :, int(row["mode"]) - 1] = np.array([float(row[name]) for name in COLUMNS[3:]]).reshape(2, 2).T
    return {name: (frequencies, errors) for name, (frequencies, errors) in found.items()}


def _rows():
    return calculix.rows(DATA) if DATA.is_file() else []


def _line(case, mode, values):
    f, error, turning, turning_error = values
    return f"{case.name},{digest(case)},{mode},{f:.7g},{error:.1e},{turning:.7g},{turning_error:.1e}\n"


def write(only=""):
    """Add what is missing to the table, a plate at a time; of those whose name holds a word."""
    known, rows = stored(), _rows()
    kept = [",".join(row[name] for name in COLUMNS) for row in rows if row["case"] in known]
    if not rows or len(kept) < len(rows):
        DATA.write_text("\n".join([*HEADER, ",".join(COLUMNS), *kept]) + "\n")
    for case in plates.cases():
        if only in case.name and case.name not in known:
            _add(case)


def _add(case):
    start = time.perf_counter()
    try:
        found, errors = reference(case)
    except (ArithmeticError, RuntimeError) as error:
        print(f"{case.name}: {error}", flush=True)
        return
    values = np.stack([found, errors], axis=1).reshape(4, -1).T
    with DATA.open("a") as file:
        file.writelines(_line(case, mode, row) for mode, row in enumerate(values, 1))
    seconds, turned = time.perf_counter() - start, np.abs(found[1] / found[0] - 1.0).max()
    print(f"{case.name}: {seconds:.0f} s, good to {errors.max():.1e}, Coriolis {turned:.1e}", flush=True)


if __name__ == "__main__":
    write(*sys.argv[1:])
