"""Plates that several tests share, and what is asked of them."""

from collections import defaultdict
from itertools import product
from pathlib import Path

import numpy as np
import scipy.linalg

from fem import Effects, Material, Plate, Rotor, assemble, families, rectangle, solve_modes
from fem.meshes.cells import cell
from fem.meshes.volume import VolumeMesh
from fem.rotor import from_rpm
from fem.theory.fields import gram
from tests.benchmarks.calculix import rows

rpm = from_rpm
DATA = Path(__file__).parent / "data"
STEEL = Material(2e11, 0.3, 7850.0)
STRIP = Material(2e11, 0.0, 7850.0)
"""Of strips, which are beams."""
FLAT, BENT = Effects(), Effects(large_deflection=True)
AT_REST = Effects(stress_stiffening=False, spin_softening=False)
"""Of plates that are looked at at rest alone: a prestress would be solved for and not used."""

# Wright, Smith, Thresher and Wang, J. Appl. Mech. 49 (1982) 197, beam without a hub: first flap at gamma 0 to 12.
WRIGHT = np.array(
    [3.5160, 3.6816, 4.1373, 4.7973, 5.5850, 6.4495, 7.3604, 8.2996, 9.2568, 10.2257, 11.2023, 12.1843, 13.1702]
)


def frequencies(plate, rotor=None, effects=FLAT, theory="mindlin", omega=0.0, count=6):
    """In Hz, of a plate at a speed in rad/s."""
    return solve_modes(assemble(plate, rotor or Rotor(), effects, theory), omega, count).frequencies_hz


def builder(planform, thickness, theory="mindlin", rotor=None, effects=FLAT, material=STEEL, log=None):
    """What builds the matrices of a plate on a planform's meshes by their size, and notes these in a log."""

    def build(size):
        if log is not None:
            log.append(size)
        return assemble(Plate(planform.mesh(size), thickness, material), rotor or Rotor(), effects, theory)

    return build


def unit_of(height):
    """sqrt(EI / rho A L^4) of a strip of length 1."""
    return np.sqrt(STRIP.youngs_modulus * height**2 / 12.0 / STRIP.density)


def complex_rates(operators, omega):
    """All circular frequencies with Coriolis forces, ascending, by a dense solver of the states."""
    stiffness, mass, turning = (a.toarray() for a in (operators.at(omega), operators.mass, operators.gyroscopic))
    turned = np.block([[-1j * omega * turning, mass], [mass, np.zeros_like(mass)]])
    inverse = scipy.linalg.eigh(turned, scipy.linalg.block_diag(stiffness, mass), eigvals_only=True)
    return 1.0 / inverse[: len(mass) - 1 : -1]


def check_tangent(model, size, step, tolerance, seed):
    """That the stiffness is the force's derivative, by differences over a step, at a random state of a size."""
    state, step = np.random.default_rng(seed).standard_normal((2, model.dofs)) * [[size], [step]]
    forces = [sum(part.at(state + sign * step).force() for part in model.energies) for sign in (1.0, -1.0)]
    states = [part.at(state) for part in model.energies]
    expected = gram(*(term for at in states for term in at.terms(at.stress))) @ step
    np.testing.assert_allclose(0.5 * (forces[0] - forces[1]), expected, atol=tolerance * np.abs(expected).max())


def paper_plate(nx=20, ny=8, material=STEEL, **keys):
    return Plate(rectangle(0.2, 0.08, nx, ny), 0.01, material, **keys)


def distorted(mesh, amount, seed=0):
    """The mesh with its inner points moved at random by up to amount."""
    points = mesh.p.copy()
    outer = np.unique(mesh.facets[:, mesh.boundary_facets()])
    inner = np.setdiff1d(np.arange(points.shape[1]), outer)
    points[:, inner] += amount * np.random.default_rng(seed).uniform(-1.0, 1.0, (2, inner.size))
    return type(mesh)(points, mesh.t)


def beam_rates(theory, family, gammas, *, stagger=0.0, hub=0.0, width=0.01, height=0.001, nx=40, ny=1, triangles=False):
    """Frequencies of a narrow plate of length 1 with nu = 0, in units of sqrt(EI / rho A L^4), at speeds gamma."""
    unit, mesh = unit_of(height if family == "flap" else width), rectangle(1.0, width, nx, ny)
    plate = Plate(mesh.to_meshtri() if triangles else mesh, height, STRIP)
    operators = assemble(plate, Rotor(hub, stagger), FLAT, theory)
    for gamma in gammas:
        modes = solve_modes(operators, gamma * unit, 8)
        named = zip(modes.frequencies_hz, families(operators, modes), strict=True)
        yield np.array([2.0 * np.pi * f / unit for f, name in named if name == family])


def promise_kept(choice, build, finer, tolerance, order=None):
    """Whether a chosen mesh is within the tolerance of one so fine, and its estimate within a factor of three.

    order: at which errors fall from the one to the other, and so beyond; else the finer mesh is the limit.
    """
    assert choice.met
    count, fine = choice.errors.shape[1], build(finer)
    limit, found = (
        np.array([solve_modes(operators, speed, count).frequencies_hz for speed in choice.probes])
        for operators in (fine, choice.operators)
    )
    true = np.abs(found / limit - 1.0).max() / (1.0 - (0.0 if order is None else (choice.size / finer) ** order))
    assert true <= tolerance
    assert true / 3.0 <= choice.errors.max() <= 3.0 * true
    return true


def calculix_cases():
    """CalculiX's other plates: name -> (row of the first mode, frequencies)."""
    first, found = {}, defaultdict(list)
    for row in rows(DATA / "calculix_cases.csv"):
        first.setdefault(row["case"], row)
        found[row["case"]].append(float(row["frequency_hz"]))
    return {name: (first[name], np.array(found[name])) for name in first}


def calculix():
    """CalculiX's frequencies by (stagger in degrees, with softening, rpm)."""
    table = defaultdict(list)
    for row in rows(DATA / "calculix_paper_plate.csv"):
        key = float(row["stagger_deg"]), row["softening"] == "1", int(row["rpm"])
        table[key].append(float(row["frequency_hz"]))
    return {key: np.array(values) for key, values in table.items()}


def box(kind, n=(2, 2, 2), sides=(1.0, 0.8, 0.6), distorted=0.0):
    """A box of cells of a kind, its inner corners moved, middles of edges, faces and cells between their corners."""
    grid = np.stack(np.meshgrid(*(np.arange(k + 1) for k in n), indexing="ij"), axis=-1).reshape(-1, 3)
    inner = ((grid > 0) & (grid < n)).all(axis=1)
    points = grid / n * sides
    points[inner] += distorted * np.random.default_rng(0).uniform(-1, 1, (inner.sum(), 3)) * np.array(sides) / n
    at = {tuple(place): number for number, place in enumerate(grid)}
    cube = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    hexes = [[at[tuple(np.add(cell, k))] for k in cube] for cell in product(*(range(k) for k in n))]
    parts = {
        "hexahedron": [range(8)],
        "wedge": [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)],
        "tetra": [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)],
    }
    base = next(name for name in parts if kind.startswith(name))
    corners = np.array([[own[k] for k in part] for own in hexes for part in parts[base]])
    shape = cell(base).shape(cell(kind).nodes)  # the nodes of the kind between its corners
    every = np.einsum("nk,ckd->cnd", shape, points[corners])
    _, first, number = np.unique(np.round(every.reshape(-1, 3), 9), axis=0, return_index=True, return_inverse=True)
    return VolumeMesh(every.reshape(-1, 3)[first], ((kind, number.reshape(every.shape[:2])),))


def beam(length, thickness, at, speed=0.0, hub=0.0, parts=200):
    """First flap frequency [Hz] of a turning beam of steel; strain along it and motion of its tip over w at a place.

    By Euler and Bernoulli's elements under the pull of what lies farther out, turns times their size.
    """
    size, places = length / parts, np.linspace(0.0, length, parts + 1)
    middle = places[:-1] + 0.5 * size
    height, rho = thickness(middle), STEEL.density
    load = rho * speed**2 * height * (hub + middle) * size
    pull = np.cumsum(load[::-1])[::-1] - 0.5 * load
    bending = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) / size**3
    tension = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]]) / (30 * size)
    inertia = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) * size / 420
    stiffness, mass = np.zeros((2, 2 * parts + 2, 2 * parts + 2))
    for k in range(parts):
        own = slice(2 * k, 2 * k + 4)
        stiffness[own, own] += STEEL.youngs_modulus * height[k] ** 3 / 12 * bending + pull[k] * tension
        mass[own, own] += rho * height[k] * inertia
    squares, shape = scipy.linalg.eigh(stiffness[2:, 2:], mass[2:, 2:], subset_by_index=[0, 0])
    w, turn = np.append([0.0, 0.0], shape[:, 0]).reshape(-1, 2).T
    moment = height**3 * (6 * np.diff(w) - 4 * turn[:-1] - 2 * turn[1:]) / size**2  # at the beginning of each
    moved = np.interp(at, places, w)
    strain = np.abs(0.5 * moment / thickness(places[:-1]) ** 2 / moved)
    return np.sqrt(squares[0]) / (2 * np.pi), strain, abs(w[-1] / moved)
