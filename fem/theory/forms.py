"""The forms of a spinning elastic body, each a small coefficient matrix over the fields of a theory.

In the frame that turns with the rotor about the axis n, P = I - n n^T, and at Omega = 1:
mass rho U.U, softening rho U.P U, Coriolis 2 rho U.(n x U), centrifugal load rho P X, and the geometric
stiffness S_ab H_ka H_kb of a stress S (the second-order part of the Green-Lagrange strain; in a plate it
holds N:(grad w grad w), N:(grad u grad u), which carries the in-plane modes, and the rotary part).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.meshes.planform import root
from fem.theory.fields import gram
from fem.theory.sections import products, strain_matrix

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.rotor import Rotor
    from fem.theory.discretisation import Discretisation

    Array = NDArray[np.float64]


def elastic_stiffness(model: Discretisation) -> csc_array:
    """Return the linear elastic stiffness, N/m."""
    strains = [(layer.weight, strain_matrix(layer)) for layer in model.elastic]
    coefficients = np.sum([w * b.T @ model.stiffness @ b for w, b in strains], axis=0)
    return gram((model.gradient, coefficients), *model.extra)


def elastic_energies(model: Discretisation, shapes: Array) -> Array:
    """Twice the energies (k, k) of shapes (n, k) with one another at small strains.

    From the strains at the points: the stiffness's entries are as large as the stiffest strain makes them, and their
    rounding drowns the softest.
    """
    strains = [(layer.weight, strain_matrix(layer)) for layer in model.elastic]
    gradients = model.gradient.evaluate(shapes)
    found = np.zeros((shapes.shape[1],) * 2)
    for weight, matrix in strains:
        strain = np.einsum("sg,gcpk->scpk", matrix, gradients)
        found += _energies(weight * model.stiffness, strain, model.gradient.dx)
    for fields, coefficients in model.extra:
        found += _energies(coefficients, fields.evaluate(shapes), fields.dx)
    return found


def _energies(coefficients: Array, strain: Array, dx: Array) -> Array:
    """Integrals (k, k) of c_ij e_i e_j, c pointwise or the same everywhere, of strains (n, ncell, npoint, k)."""
    everywhere = np.broadcast_to(
        coefficients.reshape(*coefficients.shape, *(1,) * (4 - coefficients.ndim)), (*coefficients.shape[:2], *dx.shape)
    )
    stress = np.einsum("ijcp,cp,jcpk->icpk", everywhere, dx, strain, optimize=True)
    return np.asarray(np.tensordot(strain, stress, ((0, 1, 2), (0, 1, 2))))


def energy_densities(model: Discretisation, shapes: Array) -> Array:
    """Twice the elastic energy of shapes (n, k) per volume, (ncell, npoint, k), on average through the thickness."""
    gradients = model.gradient.evaluate(shapes)
    total = np.zeros(gradients.shape[1:])
    for layer in model.elastic:
        strain = np.einsum("sg,gcpk->scpk", strain_matrix(layer), gradients)
        stress = np.einsum("st,tcpk->scpk", model.stiffness, strain)
        total += layer.weight * np.real(strain.conj() * stress).sum(axis=0)
    return total / sum(layer.weight for layer in model.elastic)


def inertia(model: Discretisation, density: float, through: Array) -> csc_array:
    """Return the matrix of density * U.(through U): mass (identity), softening (P), Coriolis (2 n x)."""
    layers = [(layer.weight, layer.displacement) for layer in model.inertia]
    coefficients = density * np.sum([w * t.T @ through @ t for w, t in layers], axis=0)
    return gram((model.displacement, coefficients))


def centrifugal_load(model: Discretisation, density: float, rotor: Rotor) -> Array:
    """Load vector (dofs,) of density * P X at 1 rad/s."""
    total = np.zeros((model.displacement.size, *model.points.shape[1:]))
    for layer in model.inertia:
        from_axis = model.points + (rotor.hub_radius * rotor.outwards)[:, None, None]
        from_axis[0] -= root(model.mesh)
        from_axis[2] += layer.z
        force = layer.weight * density * layer.displacement.T @ rotor.projector
        total += np.einsum("fk,kcp->fcp", force, from_axis)
    return model.displacement.load(total)


def uniform_load(model: Discretisation, density: float | Array, direction: Array) -> Array:
    """Load vector (dofs,) of a force per volume along a direction (3,), the same through the thickness.

    density: its size, one or at every point (ncell, npoint) [N/m³].
    """
    along = np.sum(
        [layer.weight * (layer.displacement.T @ direction)[:, None, None] for layer in model.inertia], axis=0
    )
    return model.displacement.load(along * density * np.ones(model.points.shape[1:]))


def linear_stress(model: Discretisation, unknowns: Array) -> list[Array]:
    """Stress (nstrain, ncell, npoint) in Pa at each elastic layer, to first order in the displacement."""
    gradients = model.gradient.evaluate(unknowns)
    return [np.einsum("sg,gcp->scp", model.stiffness @ strain_matrix(layer), gradients) for layer in model.elastic]


def geometric_stiffness(model: Discretisation, stress: list[Array]) -> csc_array:
    """Return the geometric stiffness of a stress given at each elastic layer, N/m."""
    n = model.gradient.size
    coefficients = np.zeros((n, n, *model.gradient.dx.shape))
    for layer, s in zip(model.elastic, stress, strict=True):
        second = products(layer)
        i, j = np.nonzero(second.any(axis=0))
        coefficients[i, j] += np.tensordot(layer.weight * second[:, i, j].T, s, 1)
    return gram((model.gradient, coefficients))
