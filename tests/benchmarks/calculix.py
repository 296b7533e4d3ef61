"""Spinning plates in CalculiX: writes the input, runs `ccx` and reads the frequencies.

20-node bricks with reduced integration (C3D20R); a static step with NLGEOM under CENTRIF, then a frequency
step with PERTURBATION, so that stress stiffening and spin softening are in, and Coriolis is not.
"""

import csv
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

COMMAND = "ccx"


def available():
    """Whether `ccx` is installed."""
    return shutil.which(COMMAND) is not None


def rows(path):
    """Of a table of answers, beside comments."""
    with path.open() as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def frequencies_on(
    mesh, thickness, layers, material, omega, *, hub=0.0, stagger=0.0, precone=0.0, count=6, timeout=None
):
    """Frequencies (count,) in Hz of a plate whose planform is a mesh of quadrilaterals (`skfem.MeshQuad`).

    It is clamped at its smallest x. thickness in m, or a function of x and y. layers: of bricks.
    material: (E, nu, rho). omega in rad/s, stagger in rad. precone in rad: the plate leaves the hub at this angle to
    the plane of rotation, towards the axis's positive end. timeout: seconds that `ccx` may take.
    """
    lines = deck(*extruded(mesh, thickness, layers), material, omega, hub, stagger, count, precone=precone)
    return solved(lines, count, timeout)


def solved(lines, count, timeout=None):
    """Frequencies (count,) in Hz of a deck."""
    with tempfile.TemporaryDirectory() as folder:
        return listed(job(lines, folder, ".dat", timeout).with_suffix(".dat").read_text())[:count]


def job(text, folder, wanted, timeout=None):
    """Run a deck in a folder; the path of what it leaves there, without the ending. wanted: an ending of that."""
    path = Path(folder) / "plate"
    path.with_suffix(".inp").write_text(text)
    environment = {"OMP_NUM_THREADS": "1", "PATH": "/usr/bin:/bin:/usr/local/bin"}
    done = subprocess.run(
        [COMMAND, path.name], cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=timeout
    )
    if not path.with_suffix(wanted).is_file():
        raise RuntimeError(f"ccx failed: {done.stdout[-800:]}")
    return path


def listed(listing):
    """The frequencies (n,) in Hz of the first frequency step in what `ccx` lists (.dat)."""
    first = listing.split("E I G E N V A L U E   O U T P U T")[1]
    rows = re.findall(r"^\s*\d+\s+(\S+)\s+(\S+)\s+(\S+)\s+(\S+)\s*$", first, re.M)
    return np.array([float(row[2]) for row in rows])


def deck(nodes, bricks, material, omega, hub, stagger, count, mass=None, precone=0.0):
    """Write the input deck of nodes (n, 3) and bricks (m, 20), clamped at the smallest x."""
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k + 1}, {x:.12g}, {y:.12g}, {z:.12g}" for k, (x, y, z) in enumerate(nodes)]
    lines += ["*ELEMENT, TYPE=C3D20R, ELSET=PLATE"]
    for k, brick in enumerate(bricks + 1):
        lines.append(f"{k + 1}, " + ", ".join(map(str, brick[:15])) + ",")
        lines.append(", ".join(map(str, brick[15:])))
    lines += ["*NSET, NSET=ROOT"] + [f"{k + 1}," for k in np.flatnonzero(nodes[:, 0] < nodes[:, 0].min() + 1e-9)]
    e, nu, rho = material
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{e:.12g}, {nu:.12g}", "*DENSITY", f"{rho:.12g}"]
    lines += ["*SOLID SECTION, ELSET=PLATE, MATERIAL=M"]
    loads = ["PLATE"]
    if mass is not None:
        kg, x, y = mass
        node = int(np.argmin(np.linalg.norm(nodes - [x, y, 0.0], axis=1))) + 1
        lines += ["*ELEMENT, TYPE=MASS, ELSET=BOB", f"{len(bricks) + 1}, {node}"]
        lines += ["*MASS, ELSET=BOB", f"{kg:.12g}"]
        lines += _softened(len(bricks) + 2, node, kg * omega**2, stagger, precone)
        loads.append("BOB")
    lines += ["*BOUNDARY", "ROOT, 1, 3"]
    if omega > 0.0:
        outwards, axis = (_in_the_plate(vector, stagger, precone) for vector in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
        axis = ", ".join(f"{value:.15g}" for value in (*(-hub * outwards), *axis))
        lines += ["*STEP, NLGEOM, INC=200", "*STATIC", "*DLOAD"]
        lines += [f"{name}, CENTRIF, {omega**2:.15g}, {axis}" for name in loads]
        lines += ["*END STEP", "*STEP, PERTURBATION"]
    else:
        lines += ["*STEP"]
    lines += ["*FREQUENCY", f"{count}", "*END STEP", ""]
    return "\n".join(lines)


def _softened(first, node, stiffness, stagger, precone):
    """Springs of negative stiffness (N/m) across the axis at a node, numbered from first.

    CalculiX pulls at a mass element, and gives it no spin softening as it does solid ones.
    """
    if stiffness == 0.0:
        return []
    x, y = (_in_the_plate(vector, stagger, precone) for vector in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    lines = ["*ORIENTATION, NAME=HUB", ", ".join(f"{value:.15g}" for value in (*x, *y))]
    for number, direction in enumerate((1, 2), first):
        lines += [f"*ELEMENT, TYPE=SPRING1, ELSET=SOFT{direction}", f"{number}, {node}"]
        lines += [f"*SPRING, ELSET=SOFT{direction}, ORIENTATION=HUB", f"{direction}", f"{-stiffness:.15g}"]
    return lines


def _in_the_plate(vector, stagger, precone):
    """The plate's coordinates of a vector given in the hub's: x outwards through the root, z along the axis.

    The plate is first laid along the hub's axes, then turned about its own x by the stagger, so that the axis leans
    towards its y, and then raised about the hub's y, so that its x points to the axis's end.
    """
    c, s = np.cos(precone), np.sin(precone)
    raised = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    c, s = np.cos(stagger), np.sin(stagger)
    turned = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    return (raised @ turned).T @ vector


def extruded(mesh, thickness, layers):
    """Nodes (n, 3) and 20-node bricks (m, 20), from 0, over a mesh of quadrilaterals."""
    corners = mesh.p.T
    middles = mesh.p[:, mesh.facets].mean(axis=1).T
    levels = np.arange(2 * layers + 1) / (2 * layers) - 0.5
    start, nodes = [], []
    for k, z in enumerate(levels):
        plane = corners if k % 2 else np.vstack([corners, middles])  # between two levels, corners alone
        start.append(sum(map(len, nodes)))
        nodes.append(np.column_stack([plane, np.full(len(plane), z) * _height(thickness, plane)]))
    cells = mesh.t.T
    # MeshQuad numbers a cell's facets as 0-1, 1-2, 2-3, 0-3; an edge of `facets` is the same either way round.
    edges = len(corners) + mesh.t2f.T
    first = np.diff(corners[cells[:, :3]], axis=1)
    left = first[:, 0, 0] * first[:, 1, 1] > first[:, 0, 1] * first[:, 1, 0]
    cells = np.where(left[:, None], cells, cells[:, ::-1])
    edges = np.where(left[:, None], edges, edges[:, [2, 1, 0, 3]])
    bricks = []
    for k in range(0, 2 * layers, 2):
        below, between, above = start[k : k + 3]
        bricks.append(np.hstack([below + cells, above + cells, below + edges, above + edges, between + cells]))
    return np.vstack(nodes), np.vstack(bricks)


def _height(thickness, plane):
    return thickness(*plane.T) if callable(thickness) else thickness
