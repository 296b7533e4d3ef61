"""Tables of CalculiX's frequencies, at rest and at speed, with what two meshes differ by."""

import csv

import numpy as np


def stored(path, names, count):
    """Frequencies (2, count) in Hz at rest and at speed, and how much two meshes differ, by case."""
    found = {name: np.zeros((2, 2, count)) for name in names}
    with path.open() as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            place = int(float(row["rpm"]) > 0), int(row["mode"]) - 1
            for table, key in zip(found[row["case"]], ("frequency_hz", "difference"), strict=True):
                table[place] = float(row[key])
    return {name: (frequencies, differences) for name, (frequencies, differences) in found.items()}


def write(path, script, cases, solve):
    """Write a table. solve: from a case, rpm, a mesh's size and layers to frequencies (count,) in Hz."""
    with path.open("w") as file:
        file.write("# CalculiX 2.20, C3D20R, *STATIC (NLGEOM) + CENTRIF, then *FREQUENCY with PERTURBATION; made by\n")
        file.write(f"# tests/benchmarks/{script}, where the cases and their meshes are. difference: relative, of\n")
        file.write("# the frequency from that on a coarser mesh.\n")
        file.write("case,rpm,mode,frequency_hz,difference\n")
        for name, case in cases.items():
            for rpm in (0.0, case.rpm):
                size, layers = case.mesh
                before, found = solve(case, rpm, 3 * size // 4, layers // 2), solve(case, rpm, size, layers)
                for mode, (f, d) in enumerate(zip(found, np.abs(before / found - 1.0), strict=True), 1):
                    file.write(f'"{name}",{rpm:g},{mode},{f:.4f},{d:.1e}\n')
                file.flush()
