"""The plate: material, mid-surface, thickness, tip mass and elastic root."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.meshes.planform import check_mesh, locate
from fem.meshes.thickness import Profile, spread


def _positive(name: str, value: float, unit: str) -> None:
    if not (isfinite(value) and value > 0.0):
        raise ValueError(f"{name} must be a positive number of {unit}, got {value!r}")


@dataclass(frozen=True)
class Material:
    """An isotropic linear elastic material.

    youngs_modulus in Pa, poissons_ratio (-1 < nu < 0.5), density in kg/m³.

    Raises:
        ValueError: for values no such material has.
    """

    youngs_modulus: float
    poissons_ratio: float
    density: float

    def __post_init__(self) -> None:
        _positive("youngs_modulus", self.youngs_modulus, "Pa")
        _positive("density", self.density, "kg/m³")
        if not -1.0 < self.poissons_ratio < 0.5:
            raise ValueError(f"poissons_ratio must lie between -1 and 0.5, got {self.poissons_ratio!r}")

    @property
    def shear_modulus(self) -> float:
        """G = E / 2(1 + nu), in Pa."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))

    @property
    def lame(self) -> tuple[float, float]:
        """Lamé's constants lambda and mu, in Pa."""
        shear, nu = self.shear_modulus, self.poissons_ratio
        return 2.0 * shear * nu / (1.0 - 2.0 * nu), shear

    @property
    def plane_stress(self) -> NDArray[Any]:
        """Plane-stress stiffness (3, 3) in Pa for the strains xx, yy and 2xy."""
        e, nu = self.youngs_modulus, self.poissons_ratio
        return e / (1.0 - nu**2) * np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])

    @property
    def elasticity(self) -> NDArray[Any]:
        """Three-dimensional stiffness (6, 6) in Pa for the strains xx, yy, zz, 2yz, 2xz and 2xy."""
        first, shear = self.lame
        c = np.zeros((6, 6))
        c[:3, :3] = first
        c[np.arange(6), np.arange(6)] += shear * np.array([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])
        return c


@dataclass(frozen=True, eq=False)
class Plate:
    """A flat plate, held where its mid-surface has the smallest x: clamped, or by the springs of an elastic root.

    Attributes:
        mesh: a scikit-fem mesh of the mid-surface, triangles or quadrilaterals, in m; x points outwards, y across, z
            through the thickness.
        thickness: in m, or one that varies (`fem.meshes.thickness`).
        material: what it is made of.
        tip_mass: a point mass in kg.
        tip_at: its place (x, y) in m on the mid-surface.
        elastic_root: springs of the root; None is the clamp.

    Raises:
        ValueError: for a non-positive thickness anywhere, a negative mass, a mass without a place or a place off the
            plate.
        TypeError: for a material or a thickness that is none.
        MeshError: for a mesh that no plate can be made of.
    """

    mesh: Any
    thickness: float | Profile
    material: Material
    tip_mass: float = 0.0
    tip_at: tuple[float, float] | None = None
    elastic_root: ElasticRoot | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.material, Material):
            raise TypeError(f"material must be a fem.Material, got {self.material!r}")
        if isinstance(self.thickness, float | int):
            _positive("thickness", self.thickness, "m")
        elif not hasattr(self.thickness, "at"):
            raise TypeError(f"thickness must be a number or one of fem.meshes.thickness, got {self.thickness!r}")
        if not (isfinite(self.tip_mass) and self.tip_mass >= 0.0):
            raise ValueError(f"tip_mass must be zero or more kg, got {self.tip_mass!r}")
        if self.tip_mass > 0.0 and self.tip_at is None:
            raise ValueError("tip_mass needs tip_at = (x, y), the place where it sits")
        check_mesh(self.mesh)
        if self.tip_at is not None:
            locate(self.mesh, self.tip_at)
        _ = self._spread

    @property
    def sides(self) -> tuple[float, float]:
        """Extent of the mid-surface along x and across, in m."""
        x, y = self.mesh.p
        return float(x.max() - x.min()), float(y.max() - y.min())

    @property
    def mean_thickness(self) -> float:
        """Mean thickness over the planform, in m."""
        return self._spread[1]

    @property
    def thickest(self) -> float:
        """Greatest thickness in m."""
        return self._spread[2]

    def thickness_at(self, place: tuple[float, float]) -> float:
        """Thickness in m at a place (x, y) in m."""
        return self.thickness if isinstance(self.thickness, float | int) else self.thickness.near(place)

    @cached_property
    def _spread(self) -> tuple[float, float, float]:
        return spread(self.thickness, self.mesh)


@dataclass(frozen=True)
class ElasticRoot:
    """Stiffness per length of the root against displacement (N/m per m) and against rotation (N m/rad per m).

    Raises:
        ValueError: unless both are positive and finite: without either the plate could move as a rigid body.
    """

    stiffness: float
    rotational: float

    def __post_init__(self) -> None:
        _positive("stiffness", self.stiffness, "N/m²")
        _positive("rotational", self.rotational, "N m/rad per m")
