"""Plates of so few unknowns that their modes fill the whole space, against dense eigenvalue problems."""

import numpy as np
import pytest
import scipy.linalg as la

from fem import Effects, Material, Plate, Rotor, assemble, rectangle, solve_modes

STEEL = Material(200e9, 0.3, 7850.0)


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
