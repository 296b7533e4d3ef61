"""A plate about its static state under centrifugal load: CalculiX's matrices, and their modes.

CalculiX finds the state (C3D20R, *STATIC with NLGEOM under CENTRIF) and writes the stiffness about it, with stress
stiffening and spin softening, and the mass. Coriolis forces are added here: 2 Omega m n x v, with the mass matrix's
scalar part m, which is the matrix that CalculiX's own *COMPLEX FREQUENCY has, but it has it in a few modes only.

The matrices are written to 14 digits. Bricks are stiffer through a thin plate's thickness than the plate is in bending
by some 1e9, and what is cut off moves the lowest frequencies by up to a percent. CalculiX's own frequencies, of the
matrices before they are written, tell by how much, and the ones found here are corrected by it.
"""

import tempfile
from dataclasses import dataclass, field
from functools import cache

import numpy as np
import scipy.linalg
import scipy.sparse as sparse
import scipy.sparse.linalg as solvers

from tests.benchmarks import calculix
from tests.survey import plates

MORE = 6
"""Modes beyond those asked for that Coriolis forces may mix in; stiffer ones answer as to a static load."""

FIRST, SHALLOW = 0.15, 3.0
"""Part of the load that a plate is given first which it lifts by more than so many thicknesses; others take all."""

OTHER_UNIT = 0.3048
"""In metres; its powers are units of length in which numbers are rounded otherwise."""

TIGHT = "*CONTROLS, PARAMETERS=FIELD", "1e-6, 1e-4"
"""Residual force and last correction at which the static state counts as found, relatively; by default 5e-3, 1e-2."""

WRITTEN = """*STEP, PERTURBATION
*FREQUENCY, SOLVER=MATRIXSTORAGE
{count}
*END STEP
"""


@dataclass(frozen=True, eq=False)
class Matrices:
    """Stiffness and mass (3 n, 3 n), x, y and z of a node in turn, of what is not clamped.

    uncut: by what factor (COUNT,) the lowest frequencies were others before the matrices were written.
    """

    stiffness: sparse.csc_array
    mass: sparse.csc_array
    uncut: np.ndarray = field(default_factory=lambda: np.ones(plates.COUNT))

    def frequencies(self, count):
        """The lowest frequencies (count,) in Hz, without Coriolis forces."""
        return self._modes(count)[0] * self.uncut[:count] / (2.0 * np.pi)

    def complex_frequencies(self, count, spin):
        """The same with Coriolis forces; spin: angular velocity (3,) in rad/s.

        In the space of the plate's own modes and, twice over, what the Coriolis forces of these bend statically.
        """
        _, own, solve = self._modes(count + MORE)
        x, y, z = spin
        turn = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        coriolis = sparse.kron(2.0 * self.mass[::3, ::3], turn).tocsc()
        first = solve(coriolis @ own)
        space = np.hstack([own, first, solve(coriolis @ first)])
        scale = np.sqrt(self.stiffness.diagonal())[:, None]
        space = scipy.linalg.orth(space * scale / np.linalg.norm(space * scale, axis=0)) / scale
        k, m, g = (space.T @ (matrix @ space) for matrix in (self.stiffness, self.mass, coriolis))
        below = np.hstack([-np.linalg.solve(m, k), -np.linalg.solve(m, g)])
        rates = np.linalg.eigvals(np.vstack([np.hstack([np.zeros_like(k), np.eye(len(k))]), below])).imag
        return np.sort(rates[rates > 0.0])[:count] * self.uncut[:count] / (2.0 * np.pi)

    def _modes(self, count):
        factor = solvers.splu(
            self.stiffness, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
        inverse = solvers.LinearOperator(self.stiffness.shape, matvec=factor.solve)
        squares, shapes = solvers.eigsh(
            self.stiffness, count, self.mass, sigma=0.0, OPinv=inverse, v0=np.ones(len(factor.perm_c))
        )
        order = np.argsort(squares)
        if not squares[order[0]] > 0.0:
            raise ArithmeticError(f"the plate diverges: {squares[order[0]]:g} rad²/s²")
        return np.sqrt(squares[order]), shapes[:, order], factor.solve


def matrices(case, fineness, layers, timeout=600.0):
    """CalculiX's matrices of a plate at its speed."""
    text, column = _deck(case, fineness, layers)
    stiffness, mass, free, own = _written(text + WRITTEN.format(count=plates.COUNT), timeout)
    uncut = own / Matrices(stiffness, mass).frequencies(plates.COUNT)
    return Matrices(*_concentrated(case, stiffness, mass, free, column), uncut)


@cache
def own_frequencies(case, fineness, layers, number, timeout=600.0):
    """CalculiX's own lowest (COUNT,) in Hz, point masses apart, of nodes and bricks in another order and in another
    unit of length: with number 0 those that `matrices` corrects by, with others the same but for rounding."""
    text, _ = _deck(case, fineness, layers, number)
    return calculix.solved(text, plates.COUNT, timeout)


def axis(case):
    """Unit vector (3,) of the spin axis."""
    stagger = np.radians(case.stagger)
    return np.array([0.0, np.sin(stagger), np.cos(stagger)])


def _deck(case, fineness, layers, number=0):
    """The deck of a plate, and its point mass; number: of an order and a unit of length, 0 as it comes and metres."""
    nodes, bricks = calculix.extruded(case.planform.graded(fineness), 1.0, layers)
    nodes, bricks = _renumbered(nodes, bricks, number) if number else (nodes, bricks)
    column = _column(case, nodes, layers)
    nodes[:, 2] *= case.thickness_at(*nodes[:, :2].T)
    unit = OTHER_UNIT**number
    young, nu, density = case.material
    material = young * unit, nu, density * unit**3
    stagger = np.radians(case.stagger)
    text = calculix.deck(nodes / unit, bricks, material, case.omega, case.hub / unit, stagger, plates.COUNT)
    return _twice(_laden(text, len(bricks), column), case.lift > SHALLOW), column


def _renumbered(nodes, bricks, seed):
    """Nodes (n, 3) and bricks (m, 20) in a random order."""
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(nodes))
    return nodes[order], np.argsort(order)[rng.permutation(bricks)]


def _column(case, nodes, layers):
    """Of a point mass: nodes through the thickness, from 1, and the kg of each, by Simpson's rule; else none."""
    if case.tip is None:
        return {}
    kg, *at = case.tip
    found = np.flatnonzero(np.linalg.norm(nodes[:, :2] - at, axis=1) < 1e-9)
    found = found[np.argsort(nodes[found, 2])]
    weights = np.zeros(2 * layers + 1)
    for k in range(layers):
        weights[2 * k : 2 * k + 3] += np.array([1.0, 4.0, 1.0]) / (6.0 * layers)
    return dict(zip((found + 1).tolist(), kg * weights, strict=True))


def _laden(text, bricks, column):
    """The deck with its mass elements, and the load on them."""
    load = next((line for line in text.splitlines() if line.startswith("PLATE, CENTRIF")), "")
    for k, (node, kg) in enumerate(column.items()):
        element = f"*ELEMENT, TYPE=MASS, ELSET=BOB{k}\n{bricks + k + 1}, {node}\n*MASS, ELSET=BOB{k}\n{kg:.12g}\n"
        text = text.replace("*BOUNDARY", element + "*BOUNDARY", 1)
        text = text.replace(load, load + "\n" + load.replace("PLATE", f"BOB{k}"), 1)
    return text


def _twice(text, deep):
    """The deck with its static step once more, to the last digits."""
    head, step, rest = text.partition("*STEP, NLGEOM")
    static, end, rest = rest.partition("*END STEP\n")
    again = step + static.replace("*STATIC", "\n".join([*TIGHT, "*STATIC"])) + end
    if deep:
        static = static.replace("*STATIC", f"*STATIC\n{FIRST}, 1.0")
    return head + step + static + end + again + rest


def _written(text, timeout):
    """Stiffness, mass, the node of every third row, and CalculiX's own frequencies in Hz."""
    with tempfile.TemporaryDirectory() as folder:
        job = calculix.job(text, folder, ".sti", timeout)
        stiffness, mass = (_symmetric(job.with_suffix(end)) for end in (".sti", ".mas"))
        unknowns = np.array([row.split(".") for row in job.with_suffix(".dof").read_text().split()], dtype=int)
        own = calculix.listed(job.with_suffix(".dat").read_text())
    if not (unknowns[:, 1].reshape(-1, 3) == [1, 2, 3]).all():
        raise RuntimeError("ccx: a node that is clamped in part")
    return stiffness, mass, unknowns[::3, 0], own


def _symmetric(path):
    """A matrix (n, n) of which the file has the upper triangle, as lines of row, column, value."""
    rows, columns, values = np.loadtxt(path).T
    upper = sparse.coo_array((values, (rows.astype(int) - 1, columns.astype(int) - 1))).tocsc()
    return (upper + sparse.triu(upper, 1).T).tocsc()


def _concentrated(case, stiffness, mass, free, column):
    """The matrices with the column's masses moving as their mean, as a point does, and softened as CalculiX's are not.

    Masses one above the other would turn with the section, and CalculiX gives a mass element no spin softening.
    """
    if not column:
        return stiffness, mass
    kg = np.array(list(column.values()))
    rows = np.searchsorted(free, list(column))
    joint = np.zeros((len(free), 1))
    joint[rows, 0] = kg / np.sqrt(kg.sum())
    joint = sparse.csc_array(joint)
    point = joint @ joint.T
    lumped = sparse.csc_array((kg, (rows, rows)), shape=point.shape)
    across = np.eye(3) - np.outer(axis(case), axis(case))
    softened = stiffness - case.omega**2 * sparse.kron(point, across)
    return softened.tocsc(), (mass + sparse.kron(point - lumped, np.eye(3))).tocsc()
