"""Plates that several tests share."""

import csv
from collections import defaultdict
from pathlib import Path

import numpy as np

from fem import Material, Plate, rectangle

DATA = Path(__file__).parent / "data"
STEEL = Material(2e11, 0.3, 7850.0)


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


def calculix():
    """CalculiX's frequencies by (stagger in degrees, with softening, rpm)."""
    table = defaultdict(list)
    with (DATA / "calculix_paper_plate.csv").open() as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            key = float(row["stagger_deg"]), row["softening"] == "1", int(row["rpm"])
            table[key].append(float(row["frequency_hz"]))
    return {key: np.array(values) for key, values in table.items()}
