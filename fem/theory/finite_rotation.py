"""The Mindlin plate at finite rotations: a surface that carries a director of unit length.

A point (x, y, z) goes to r + z d, where r = (x + u, y + v, w) and d = (-theta_x, -theta_y, s), s² = 1 - theta².
Green's strains are those of r and d alone, so that turning the plate as a whole, however far, does not strain it:
    membrane (r,a . r,b - delta_ab) / 2,  bending (r,a . d,b + r,b . d,a) / 2,  shear r,a . d
and, of second order in z, d,a . d,b / 2, whose part that is even over the thickness joins the membrane's. What is
stretched gets thinner: bending strains are multiplied by what plane stress leaves of the thickness, whose square is
1 - 2 nu / (1 - nu) (E_xx + E_yy) of the membrane's; in shear, small beside them, that is left out. At small rotations
this is `fem.theory.mindlin`; a director may turn by up to 90 degrees. The strains are those of Simo and Fox, Comput.
Methods Appl. Mech. Engng 72 (1989) 267. `Section` has the membrane and bending strains, `Shear`
the transverse shear.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fem.linalg import Array
from fem.plate import Material
from fem.theory.fields import Block, Fields
from fem.theory.sections import Terms

TURNS = (6, 9)
"""Where theta_x and theta_y stand among a section's fields; their derivatives follow each."""


def _forms() -> Array:
    x, y = np.eye(2)
    pairs = [np.outer(x, x), np.outer(y, y), np.outer(x, y) + np.outer(y, x)]
    even, odd = np.diag([1.0, 1.0 / 12.0]), np.array([[0.0, 1.0], [1.0, 0.0]])
    return np.array([np.kron(part, np.kron(pair, np.eye(3))) for part in (even, odd) for pair in pairs])


FORMS = _forms()
"""The strains (Voigt; membrane, then bending times the thickness h) as forms (6, 12, 12): half their products with
r,x r,y h d,x h d,y."""

FLAT = np.array([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, *[0.0] * 6])
"""r,x r,y h d,x h d,y at rest, h the thickness."""


@dataclass(frozen=True, eq=False)
class Section:
    """Membrane and bending energy over the fields u,x u,y v,x v,y w,x w,y and theta_x, its derivatives, theta_y, its.

    Attributes:
        material: in plane stress. thickness in m, one or (ncell, npoint).
    """

    fields: Fields
    material: Material
    thickness: float | Array

    def at(self, state: Array) -> SectionStress:
        """The energy at a state (n,); not a number where a director would turn beyond 90 degrees."""
        known = self.fields.evaluate(state)
        values, thickness = _pointwise(known), np.broadcast_to(self.thickness, known.shape[1:]).reshape(-1, 1)
        moved, jacobian = _vectors(values, thickness)
        rest, added = FORMS @ FLAT, np.tensordot(moved, FORMS, (1, 2))
        # not half of r,a . r,b - delta_ab, of which rounding would leave nothing where strains are small
        strain = ((rest + 0.5 * added) @ moved[:, :, None])[:, :, 0]
        return SectionStress(self, thickness, values, jacobian, rest + added, *self._law(strain, thickness))

    def _law(self, strain: Array, h: Array) -> tuple[Array, Array]:
        """Stress (npoint, 6) and modulus (npoint, 6, 6) at strains (npoint, 6), of membrane and bending."""
        nu, plane = self.material.poissons_ratio, self.material.plane_stress
        thinner = -2.0 * nu / (1.0 - nu) * np.array([1.0, 1.0, 0.0])
        square = 1.0 + strain[:, :3] @ thinner
        moment = h / 12.0 * (strain[:, 3:] @ plane)
        energy = 0.5 * (strain[:, 3:] * moment).sum(axis=1)
        stress = np.hstack([h * (strain[:, :3] @ plane) + energy[:, None] * thinner, square[:, None] * moment])
        modulus = np.empty((len(strain), 6, 6))
        modulus[:, :3, :3] = h[:, :, None] * plane
        modulus[:, 3:, 3:] = (h[:, 0] / 12.0 * square)[:, None, None] * plane
        modulus[:, :3, 3:] = thinner[:, None] * moment[:, None, :]
        modulus[:, 3:, :3] = modulus[:, :3, 3:].transpose(0, 2, 1)
        return stress, modulus


@dataclass(frozen=True, eq=False)
class SectionStress:
    """A section's energy at a state, by point.

    Attributes:
        thickness: (npoint, 1) in m.
        values: of the fields (npoint, 12).
        jacobian: of r,x r,y h d,x h d,y by the fields, (npoint, 12, 12).
        turned: of the strains by these, (npoint, 6, 12).
        stress: (npoint, 6), and its derivative by the strain (npoint, 6, 6).
    """

    energy: Section
    thickness: Array
    values: Array
    jacobian: Array
    turned: Array
    stress: Array
    modulus: Array

    def force(self) -> Array:
        """The internal force (n,)."""
        forces = self.stress[:, None, :] @ self.turned
        return self.energy.fields.load(_fieldwise((forces @ self.jacobian)[:, 0], self.energy.fields))

    def ahead(self, step: Array) -> Array:
        """The stress (npoint, 6) that a step (n,) leads to, to first order."""
        moved = _pointwise(self.energy.fields.evaluate(step))[:, :, None]
        return np.asarray(self.stress + (self.modulus @ (self.turned @ (self.jacobian @ moved)))[:, :, 0])

    def terms(self, stress: Array) -> Terms:
        """Fields and coefficients of the tangent stiffness under a stress, its own or another."""
        normal_force = (stress[:, None, :] @ self.turned)[:, 0] * self.thickness
        inner = self.turned.transpose(0, 2, 1) @ (self.modulus @ self.turned)
        inner += np.tensordot(stress, FORMS, 1)
        total = self.jacobian.transpose(0, 2, 1) @ inner @ self.jacobian
        for b, height in enumerate((normal_force[:, 8], normal_force[:, 11])):
            first, second = np.meshgrid(*[_lifting(b)] * 2, indexing="ij")
            total[:, first, second] += height[:, None, None] * _lift(self.values[:, _lifting(b)])[2]
        return ((self.energy.fields, _fieldwise(total, self.energy.fields)),)


def _vectors(values: Array, thickness: Array) -> tuple[Array, Array]:
    """Return by how much r,x r,y h d,x h d,y differ from `FLAT` (npoint, 12), and their derivatives by the fields."""
    jacobian = np.zeros((len(values), 12, 12))
    for b in range(2):
        for k in range(3):
            jacobian[:, 3 * b + k, 2 * k + b] = 1.0
        for k, turn in enumerate(TURNS):
            jacobian[:, 6 + 3 * b + k, turn + 1 + b] = -1.0
    vectors = (jacobian @ values[:, :, None])[:, :, 0]
    for b in range(2):
        vectors[:, 8 + 3 * b], jacobian[:, 8 + 3 * b, _lifting(b)], _ = _lift(values[:, _lifting(b)])
    vectors[:, 6:] *= thickness
    jacobian[:, 6:] *= thickness[:, :, None]
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


def _pointwise(values: Array) -> Array:
    """From fields (nfield, ncell, npoint) to (ncell npoint, nfield)."""
    return np.ascontiguousarray(values.reshape(len(values), -1).T)


def _fieldwise(values: Array, fields: Fields) -> Array:
    """From (ncell npoint, ...) to (..., ncell, npoint)."""
    return np.moveaxis(values.reshape(*fields.dx.shape, *values.shape[1:]), (0, 1), (-2, -1))


@dataclass(frozen=True, eq=False)
class Shear:
    """Transverse shear energy of an assumed shear.

    Attributes:
        samples: the fields u, v and w by the two reference coordinates and theta_x, theta_y, where the shear is
            sampled.
        sides: X, Y by the reference coordinates there, (2, 2, ncell, nsample).
        reduction: from the samples' covariant shear to the shear at the points, (ncell, 2 npoint, 2 nsample).
        modulus: (ncell, npoint) in N/m, dx in m².
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
        return ShearStress(self, director, edges, self.felt(covariant))

    def felt(self, covariant: Array) -> Array:
        """The energy's derivative by the samples' covariant shears (ncell, nsample, 2): (2, ncell, nsample)."""
        ncell, npoint = self.dx.shape
        shear = self.reduction @ covariant.reshape(ncell, -1, 1)
        stress = (self.modulus * self.dx)[:, :, None] * shear.reshape(ncell, npoint, 2)
        felt = stress.reshape(ncell, 1, -1) @ self.reduction
        return np.asarray(felt.reshape(ncell, -1, 2).transpose(2, 0, 1))


@dataclass(frozen=True, eq=False)
class ShearStress:
    """A shear energy at a state.

    Attributes:
        director: (3, ncell, nsample).
        edges: r by the reference coordinates, (3, 2, ncell, nsample).
        stress: the energy's derivative by the samples' covariant shears, (2, ncell, nsample).
    """

    energy: Shear
    director: Array
    edges: Array
    stress: Array

    def force(self) -> Array:
        """The internal force (n,)."""
        return self.energy.samples.load(np.einsum("mfcs,mcs->fcs", self._variation, self.stress))

    def ahead(self, step: Array) -> Array:
        """What the samples would feel after a step (n,), to first order: (2, ncell, nsample)."""
        moved = np.einsum("mfcs,fcs->csm", self._variation, self.energy.samples.evaluate(step))
        return self.stress + self.energy.felt(moved)

    def terms(self, stress: Array) -> Terms:
        """Fields and coefficients of the tangent stiffness where the samples feel a stress, their own or another."""
        samples = self.energy.samples
        blocks = tuple(Block(t, block.dofs) for t, block in zip(self._tables(), samples.blocks, strict=True))
        fields = Fields(blocks, self.energy.dx, samples.dofs)
        material = np.tile(np.eye(2), 2 * [len(blocks)])[:, :, None, None] * self.energy.modulus
        return (fields, material), (samples, self._curvature(stress))

    @property
    def _variation(self) -> Array:
        """How the covariant shears vary with the samples' fields, (2, 8, ncell, nsample)."""
        variation = np.zeros((2, 8, *self.stress.shape[1:]))
        for m in range(2):
            variation[m, m:6:2] = self.director
            variation[m, 6:] = self.edges[2, m] * self._slope - self.edges[:2, m]
        return variation

    @property
    def _slope(self) -> Array:
        """How the director's height varies with the turns, (2, ncell, nsample)."""
        return np.asarray(self.director[:2] / self.director[2])

    def _tables(self) -> Iterator[Array]:
        """What each block's unknowns add to the shear at the points, for a unit of each: (ncell, npoint, 2, ndof)."""
        ncell, npoint = self.energy.dx.shape
        variation, start = self._variation.transpose(2, 3, 0, 1), 0
        for block in self.energy.samples.blocks:
            part = variation[..., start : start + block.size] @ block.table
            shear = self.energy.reduction @ part.reshape(ncell, -1, part.shape[-1])
            yield shear.reshape(ncell, npoint, 2, -1)
            start += block.size

    def _curvature(self, forces: Array) -> Array:
        """What the shears' second derivatives carry where the samples feel (2, ncell, nsample): (8, 8, ...)."""
        total = np.zeros((8, 8, *forces.shape[1:]))
        for m, part in enumerate(forces):
            total[m, 6] = total[2 + m, 7] = -part
            total[4 + m, 6:] = part * self._slope
        total += total.transpose(1, 0, 2, 3)
        unit = np.eye(2)[:, :, None, None] / self.director[2]
        bend = unit + self._slope[:, None] * self._slope[None] / self.director[2]
        total[6:, 6:] -= (forces * self.edges[2]).sum(axis=0) * bend
        return total
