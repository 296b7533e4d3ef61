"""The Mindlin plate clamped where a solid seems to be: a little outside its root.

What is bent or stretched along x contracts through the thickness. At its root a solid cannot, which no plate theory
sees, and within about a thickness of the root it is stiffer for it: it vibrates like a plate whose root is moved
outwards by c h. c grows with the square of the contraction that is held, as nu² / (1 - nu).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.meshes.planform import root, root_facets
from fem.meshes.thickness import Nodal
from fem.theory import mindlin

if TYPE_CHECKING:
    from fem.meshes.thickness import Profile
    from fem.plate import Plate
    from fem.theory.discretisation import Discretisation

HELD = 0.11
"""c (1 - nu) / nu². CalculiX on rectangles, tapered and swept plates and arms, nu from 0.3 to 0.49: 0.09 to 0.12 in
bending; 0.07 to 0.18 in stretching, the less the stouter the root."""

STRETCHED = 1.3
"""How much more of it than in bending, at most, is left in stretching."""

REACH = 2.0
"""Thicknesses from the root within which the plate is shortened."""


def discretise(plate: Plate, rotary_inertia: bool = True) -> Discretisation:
    """Make the Mindlin model of a plate that is clamped a little outside its root; loads stay where they are."""
    mesh = shortened(plate)
    shorter = replace(plate, mesh=mesh, thickness=_carried(plate, mesh), tip_mass=0.0, tip_at=None)
    model = mindlin.discretise(shorter, rotary_inertia)
    planar = np.asarray(plate.mesh.mapping().F(model.spaces[0].basis.X))
    points = np.stack([planar[0], planar[1], np.zeros_like(planar[0])])
    return replace(model, theory="mindlin/held", points=points, mesh=plate.mesh)


def shift(plate: Plate) -> float:
    """How far outside its root (m) a solid seems to be clamped; nothing where springs hold it and let it contract."""
    return 0.0 if plate.elastic_root is not None else seeming(plate)


def seeming(plate: Plate) -> float:
    """The same (m) of springs too, as far as they hold the root from contracting: by k / (k + E)."""
    nu, springs = plate.material.poissons_ratio, plate.elastic_root
    held = 1.0 if springs is None else springs.stiffness / (springs.stiffness + plate.material.youngs_modulus)
    return HELD * nu**2 / (1.0 - nu) * held * at_root(plate)


def at_root(plate: Plate) -> float:
    """Mean thickness (m) at the root."""
    if isinstance(plate.thickness, float | int):
        return float(plate.thickness)
    mesh = plate.mesh
    middles = mesh.p[:, mesh.facets[:, root_facets(mesh)]].mean(axis=1)
    return float(np.mean([plate.thickness_at((x, y)) for x, y in middles.T]))


def shortened(plate: Plate) -> Any:
    """The mesh with its root moved outwards, and less what lies behind it, to nothing `REACH` thicknesses away."""
    x, y = plate.mesh.p
    left = np.clip(1.0 - (x - root(plate.mesh)) / (REACH * at_root(plate)), 0.0, None)
    return replace(plate.mesh, doflocs=np.stack([x + shift(plate) * left**2, y]))


def _carried(plate: Plate, mesh: Any) -> float | Profile:
    """The thickness on the shortened mesh: values at points go with them."""
    known = plate.thickness
    if not isinstance(known, Nodal):
        return known
    values = np.empty(mesh.p.shape[1])
    values[plate.mesh.t.T] = known.at(plate.mesh.p[:, plate.mesh.t].transpose(0, 2, 1))
    return Nodal(mesh, values)
