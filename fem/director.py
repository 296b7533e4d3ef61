"""The Mindlin plate at finite rotations: a surface that carries a director of unit length.

A point (x, y, z) goes to r + z d, where r = (x + u, y + v, w) and d = (-theta_x, -theta_y, s), s² = 1 - theta².
Green's strains are those of r and d alone, so that turning the plate as a whole, however far, does not strain it:
    membrane (r,a . r,b - delta_ab) / 2,  bending (r,a . d,b + r,b . d,a) / 2,  shear r,a . d
and, of second order in z, d,a . d,b / 2, whose part that is even over the thickness joins the membrane's. What is
stretched gets thinner: bending strains are multiplied by what plane stress leaves of the thickness, whose square is
1 - 2 nu / (1 - nu) (E_xx + E_yy) of the membrane's; in shear, small beside them, that is left out. The assumed shear
(`fem.tying`) samples the covariant components of r,a . d. At small rotations this is `fem.mindlin`; a director
may turn by up to 90 degrees. The strains are those of Simo and Fox, Comput. Methods Appl. Mech. Engng 72 (1989) 267.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem.fields import Block, Fields

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.plate import Material
    from fem.strains import Terms

    Array = NDArray[np.float64]

TURNS = (6, 9)
"""Where theta_x and theta_y stand among a section's fields; their derivatives follow each."""


@dataclass(frozen=True, eq=False)
class Section:
    """Membrane and bending energy over the fields u,x u,y v,x v,y w,x w,y and theta_x, its derivatives, theta_y, its.

    material: in plane stress. thickness in m.
    """

    fields: Fields
    material: Material
    thickness: float

    def at(self, state: Array) -> SectionStress:
        """The energy at a state (n,); not a number where a director would turn beyond 90 degrees."""
        values = _pointwise(self.fields.evaluate(state))
        vectors, jacobian = _vectors(values)
        turned = np.tensordot(vectors, _forms(self.thickness), (1, 2))
        rest = np.array([0.5, 0.5, 0.0, 0.0, 0.0, 0.0])
        strain = 0.5 * (turned @ vectors[:, :, None])[:, :, 0] - rest
        return SectionStress(self, values, jacobian, turned, *self._law(strain))

    def _law(self, strain: Array) -> tuple[Array, Array]:
        """Stress (npoint, 6) and modulus (npoint, 6, 6) at strains (npoint, 6), of membrane and bending."""
        h, nu, plane = self.thickness, self.material.poissons_ratio, self.material.plane_stress
        thinner = -2.0 * nu / (1.0 - nu) * np.array([1.0, 1.0, 0.0])
        square = 1.0 + strain[:, :3] @ thinner
        moment = h**3 / 12.0 * strain[:, 3:] @ plane
        energy = 0.5 * (strain[:, 3:] * moment).sum(axis=1)
        stress = np.hstack([h * strain[:, :3] @ plane + energy[:, None] * thinner, square[:, None] * moment])
        modulus = np.empty((len(strain), 6, 6))
        modulus[:, :3, :3] = h * plane
        modulus[:, 3:, 3:] = h**3 / 12.0 * square[:, None, None] * plane
        modulus[:, :3, 3:] = thinner[:, None] * moment[:, None, :]
        modulus[:, 3:, :3] = modulus[:, :3, 3:].transpose(0, 2, 1)
        return stress, modulus


@dataclass(frozen=True, eq=False)
class SectionStress:
    """A section's energy at a state, by point.

    values: of the fields (npoint, 12). jacobian: of r,x r,y d,x d,y by the fields, (npoint, 12, 12). turned: of the
    strains by r,x r,y d,x d,y, (npoint, 6, 12). stress: (npoint, 6), and its derivative by the strain (npoint, 6, 6).
    """

    energy: Section
    values: Array
    jacobian: Array
    turned: Array
    stress: Array
    modulus: Array

    def force(self) -> Array:
        """The internal force (n,)."""
        felt = self.stress[:, None, :] @ self.turned
        return self.energy.fields.load(_fieldwise((felt @ self.jacobian)[:, 0], self.energy.fields))

    def terms(self) -> Terms:
        """Fields and coefficients of the tangent stiffness."""
        forms = _forms(self.energy.thickness)
        felt = (self.stress[:, None, :] @ self.turned)[:, 0]
        inner = self.turned.transpose(0, 2, 1) @ (self.modulus @ self.turned)
        inner += np.tensordot(self.stress, forms, 1)
        total = self.jacobian.transpose(0, 2, 1) @ inner @ self.jacobian
        for b, height in enumerate((felt[:, 8], felt[:, 11])):
            first, second = np.meshgrid(*[_lifting(b)] * 2, indexing="ij")
            total[:, first, second] += height[:, None, None] * _lift(self.values[:, _lifting(b)])[2]
        return ((self.energy.fields, _fieldwise(total, self.energy.fields)),)


@dataclass(frozen=True, eq=False)
class Shear:
    """Transverse shear energy of an assumed shear.

    samples: the fields u, v and w by the two reference coordinates and theta_x, theta_y, where the shear is sampled.
    sides: X, Y by the reference coordinates there, (2, 2, ncell, nsample). reduction: from the samples' covariant shear
    to the shear at the points, (ncell, npoint, 2, nsample, 2). modulus: (ncell, npoint) in N/m, dx in m².
    """

    samples: Fields
    sides: Array
    reduction: Array
    modulus: Array
    dx: Array

    def at(self, state: Array) -> ShearStress:
        """The energy at a state (n,); not a number where a director would turn beyond 90 degrees."""
        values = self.samples.evaluate(state)
        with np.errstate(invalid="ignore"):
            height = np.sqrt(1.0 - values[6] ** 2 - values[7] ** 2)
        director = np.stack([-values[6], -values[7], height])
        edges = values[:6].reshape(3, 2, *height.shape).copy()
        edges[:2] += self.sides
        covariant = np.einsum("kmcs,kcs->csm", edges, director)
        ncell, npoint = self.dx.shape
        shear = self._reduction @ covariant.reshape(ncell, -1, 1)
        stress = (self.modulus * self.dx)[:, :, None] * shear.reshape(ncell, npoint, 2)
        felt = stress.reshape(ncell, 1, -1) @ self._reduction
        return ShearStress(self, director, edges, felt.reshape(ncell, -1, 2).transpose(2, 0, 1))

    @property
    def _reduction(self) -> Array:
        ncell, npoint, _, nsample, _ = self.reduction.shape
        return self.reduction.reshape(ncell, 2 * npoint, 2 * nsample)


@dataclass(frozen=True, eq=False)
class ShearStress:
    """A shear energy at a state.

    director: (3, ncell, nsample). edges: r by the reference coordinates, (3, 2, ncell, nsample). felt: the energy's
    derivative by the samples' covariant shears, (2, ncell, nsample).
    """

    energy: Shear
    director: Array
    edges: Array
    felt: Array

    def force(self) -> Array:
        """The internal force (n,)."""
        return self.energy.samples.load(np.einsum("mfcs,mcs->fcs", self._variation, self.felt))

    def terms(self) -> Terms:
        """Fields and coefficients of the tangent stiffness."""
        dofs = np.concatenate([block.dofs for block in self.energy.samples.blocks], axis=1)
        block = Block(np.ascontiguousarray(self._table()), dofs)
        material = np.eye(2)[:, :, None, None] * self.energy.modulus
        fields = Fields((block,), self.energy.dx, self.energy.samples.dofs)
        return (fields, material), (self.energy.samples, self._curvature())

    @property
    def _variation(self) -> Array:
        """How the covariant shears vary with the samples' fields, (2, 8, ncell, nsample)."""
        found = np.zeros((2, 8, *self.felt.shape[1:]))
        for m in range(2):
            found[m, m:6:2] = self.director
            found[m, 6:] = self.edges[2, m] * self._slope - self.edges[:2, m]
        return found

    @property
    def _slope(self) -> Array:
        """How the director's height varies with the turns, (2, ncell, nsample)."""
        return np.asarray(self.director[:2] / self.director[2])

    def _table(self) -> Array:
        """The shear at the points for a unit of each unknown, (ncell, npoint, 2, ndof)."""
        ncell, npoint = self.energy.dx.shape
        variation, start, parts = self._variation.transpose(2, 3, 0, 1), 0, []
        for block in self.energy.samples.blocks:
            part = variation[..., start : start + block.size] @ block.table
            parts.append(part.reshape(ncell, -1, part.shape[-1]))
            start += block.size
        table = self.energy._reduction @ np.concatenate(parts, axis=-1)
        return np.asarray(table.reshape(ncell, npoint, 2, -1))

    def _curvature(self) -> Array:
        """What the shears' second derivatives carry, (8, 8, ncell, nsample)."""
        total = np.zeros((8, 8, *self.felt.shape[1:]))
        for m, felt in enumerate(self.felt):
            total[m, 6] = total[2 + m, 7] = -felt
            total[4 + m, 6:] = felt * self._slope
        total += total.transpose(1, 0, 2, 3)
        unit = np.eye(2)[:, :, None, None] / self.director[2]
        bend = unit + self._slope[:, None] * self._slope[None] / self.director[2]
        total[6:, 6:] -= (self.felt * self.edges[2]).sum(axis=0) * bend
        return total


def _vectors(values: Array) -> tuple[Array, Array]:
    """Return r,x r,y d,x d,y (npoint, 12) and their derivatives by the fields (npoint, 12, 12)."""
    vectors, jacobian = np.zeros((2, len(values), 12, 12))
    vectors = vectors[:, :, 0]
    for b in range(2):
        for k in range(3):
            jacobian[:, 3 * b + k, 2 * k + b] = 1.0
        for k, turn in enumerate(TURNS):
            jacobian[:, 6 + 3 * b + k, turn + 1 + b] = -1.0
    vectors[:] = (jacobian @ values[:, :, None])[:, :, 0]
    vectors[:, [0, 4]] += 1.0
    for b in range(2):
        vectors[:, 8 + 3 * b], jacobian[:, 8 + 3 * b, _lifting(b)], _ = _lift(values[:, _lifting(b)])
    return vectors, jacobian


def _lifting(b: int) -> list[int]:
    """The fields that the height's derivative by x (b = 0) or y is made of: theta_x, theta_y and their derivatives."""
    return [*TURNS, *(turn + 1 + b for turn in TURNS)]


def _lift(values: Array) -> tuple[Array, Array, Array]:
    """The height's derivative s' = -t.t' / s at turns t and t' (npoint, 4), its gradient and second derivatives."""
    turn, slope = values[:, :2], values[:, 2:]
    with np.errstate(invalid="ignore"):
        height = np.sqrt(1.0 - (turn**2).sum(axis=1))[:, None]
    along = (turn * slope).sum(axis=1)[:, None]
    lift = -along / height
    gradient = np.hstack([lift * turn / height**2 - slope / height, -turn / height])
    unit, outer = np.eye(2), turn[:, :, None] * turn[:, None, :]
    height, along = height[:, :, None], along[:, :, None]
    mixed = -unit / height - outer / height**3
    cross = turn[:, :, None] * slope[:, None, :]
    both = -(cross + cross.transpose(0, 2, 1) + along * unit) / height**3 - 3.0 * along * outer / height**5
    second = np.concatenate([np.concatenate([both, mixed], 2), np.concatenate([mixed, np.zeros_like(both)], 2)], 1)
    return lift[:, 0], gradient, second


def _forms(thickness: float) -> Array:
    """The strains (Voigt; membrane, then bending) as forms (6, 12, 12): half their products with r,x r,y d,x d,y."""
    x, y = np.eye(2)
    pairs = [np.outer(x, x), np.outer(y, y), np.outer(x, y) + np.outer(y, x)]
    even, odd = np.diag([1.0, thickness**2 / 12.0]), np.array([[0.0, 1.0], [1.0, 0.0]])
    return np.array([np.kron(part, np.kron(pair, np.eye(3))) for part in (even, odd) for pair in pairs])


def _pointwise(values: Array) -> Array:
    """From fields (nfield, ncell, npoint) to (ncell npoint, nfield)."""
    return np.ascontiguousarray(values.reshape(len(values), -1).T)


def _fieldwise(values: Array, fields: Fields) -> Array:
    """From (ncell npoint, ...) to (..., ncell, npoint)."""
    return np.moveaxis(values.reshape(*fields.dx.shape, *values.shape[1:]), (0, 1), (-2, -1))
