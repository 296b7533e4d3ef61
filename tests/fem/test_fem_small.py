"""Plates of so few unknowns that their modes fill the whole space, against dense eigenvalue problems."""

import numpy as np
import pytest
import scipy.linalg as la
from scipy.sparse import csc_array

from fem import Effects, Material, Plate, Rotor, assemble, rectangle, solve_modes
from fem.linalg import orthonormal

STEEL = Material(200e9, 0.3, 7850.0)


@pytest.mark.parametrize("n", [2, 5, 12, 40])
@pytest.mark.parametrize("known", ["all", "all but one"])
def test_no_more_vectors_are_orthonormal_than_there_are_dimensions(n, known):
    random = np.random.default_rng(n)
    root = random.standard_normal((n, n))
    weight = csc_array(root @ root.T + np.diag(10.0 ** random.uniform(-3, 3, n)))
    empty = np.empty((n, 0))
    m = n if known == "all" else n - 1
    basis, image, _, _ = orthonormal(random.standard_normal((n, m)), empty, empty, weight)
    assert basis.shape == (n, m)
    vectors, _, _, _ = orthonormal(random.standard_normal((n, 4)), basis, image, weight)
    assert vectors.shape[1] == n - m
    assert np.abs(image.T @ vectors).max(initial=0.0) < 1e-6


@pytest.mark.parametrize("seed", range(8))
def test_directions_without_weight_are_dropped(seed):
    random = np.random.default_rng(seed)
    n, rank = 30, 18
    weight = csc_array(np.diag(np.where(np.arange(n) < rank, 10.0 ** random.uniform(-4, 4, n), 0.0)))
    flexible = np.linalg.inv((root := random.standard_normal((n, n))) @ root.T + 1e-3 * np.eye(n))
    empty = np.empty((n, 0))
    basis, image, _, _ = orthonormal(flexible @ (weight @ random.standard_normal((n, 4))), empty, empty, weight)
    while basis.shape[1] < rank:
        block, heavy, _, _ = orthonormal(flexible @ image[:, -4:], basis, image, weight)
        basis, image = np.hstack([basis, block]), np.hstack([image, heavy])
    assert basis.shape == (n, rank)
    assert np.abs(basis.T @ image - np.eye(rank)).max() < 1e-6
    assert orthonormal(flexible @ image[:, -4:], basis, image, weight)[0].shape == (n, 0)


def test_modes_of_unknowns_without_mass_are_not_made_up():
    plate = Plate(rectangle(0.2, 0.1, 2, 1), 0.01, STEEL)
    operators = assemble(plate, Rotor(0.1), Effects(rotary_inertia=False), "mindlin")
    massive = np.linalg.matrix_rank(operators.mass.toarray(), hermitian=True)
    inverse = la.eigh(operators.mass.toarray(), operators.stiffness.toarray(), eigvals_only=True)[::-1]
    found = solve_modes(operators, 0.0, operators.mass.shape[0])
    assert found.eigenvalues.size == massive < operators.mass.shape[0]
    assert found.eigenvalues == pytest.approx(1.0 / inverse[:massive], rel=1e-7)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "kirchhoff/morley", "kirchhoff/argyris"])
@pytest.mark.parametrize("fewer", [0, 2, 5])
def test_complex_modes_of_all_unknowns(theory, fewer):
    plate = Plate(rectangle(0.2, 0.1, 1, 1), 0.01, STEEL)
    operators = assemble(plate, Rotor(0.1, 0.4), Effects(coriolis=True), theory)
    n, omega = operators.mass.shape[0], 500.0
    stiffness, mass, gyroscopic = (
        each.toarray() for each in (operators.at(omega), operators.mass, operators.gyroscopic)
    )
    still = np.zeros((n, n))
    energy = la.block_diag(stiffness, mass)
    turned = np.block([[-1j * omega * gyroscopic, mass], [mass, still]])
    rates = np.sort(1.0 / la.eigh(turned, energy, eigvals_only=True)[n:])
    found = solve_modes(operators, omega, n - fewer)
    assert np.sqrt(found.eigenvalues) == pytest.approx(rates[: n - fewer], rel=1e-7)
