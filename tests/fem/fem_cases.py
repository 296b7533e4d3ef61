"""Plates that several tests share."""

import csv
from collections import defaultdict
from pathlib import Path

import numpy as np

from fem import Effects, Material, Plate, Rotor, assemble, families, rectangle, solve_modes

DATA = Path(__file__).parent / "data"
STEEL = Material(2e11, 0.3, 7850.0)
AT_REST = Effects(stress_stiffening=False, spin_softening=False)
"""Of plates that are looked at at rest alone: a prestress would be solved for and not used."""


def rpm(value):
    return value * np.pi / 30.0


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
    material = Material(2e11, 0.0, 7850.0)
    inertia = height**2 / 12.0 if family == "flap" else width**2 / 12.0
    unit = np.sqrt(material.youngs_modulus * inertia / material.density)
    mesh = rectangle(1.0, width, nx, ny)
    plate = Plate(mesh.to_meshtri() if triangles else mesh, height, material)
    operators = assemble(plate, Rotor(hub, stagger), Effects(), theory)
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
    rows, found = {}, defaultdict(list)
    with (DATA / "calculix_cases.csv").open() as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            rows.setdefault(row["case"], row)
            found[row["case"]].append(float(row["frequency_hz"]))
    return {name: (rows[name], np.array(found[name])) for name in rows}


def calculix():
    """CalculiX's frequencies by (stagger in degrees, with softening, rpm)."""
    table = defaultdict(list)
    with (DATA / "calculix_paper_plate.csv").open() as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            key = float(row["stagger_deg"]), row["softening"] == "1", int(row["rpm"])
            table[key].append(float(row["frequency_hz"]))
    return {key: np.array(values) for key, values in table.items()}
