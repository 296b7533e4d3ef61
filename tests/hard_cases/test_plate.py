"""Plates that lock, lose digits or lose modes in finite elements; more of them in tests/fem."""

import numpy as np
import pytest
import scipy.linalg

from fem import (
    Divergence,
    Effects,
    Material,
    NoEquilibrium,
    Plate,
    Rotor,
    assemble,
    campbell,
    equilibrium,
    rectangle,
    solve_modes,
)

STEEL = Material(2e11, 0.3, 7850.0)


@pytest.mark.parametrize("omega", [0.0, 500.0])
def test_pairs_of_modes(omega: float) -> None:
    """A square section: bending modes come in pairs of nearly one frequency."""
    plate = Plate(rectangle(1.0, 0.02, 12, 1), 0.02, Material(2e11, 0.0, 7850.0))
    operators = assemble(plate, Rotor(), Effects(), "solid")
    dense = scipy.linalg.eigh(operators.at(omega).toarray(), operators.mass.toarray(), eigvals_only=True)[:8]
    found = solve_modes(operators, omega, 8).eigenvalues
    np.testing.assert_allclose(found, dense, rtol=1e-6)  # the dense solver rounds at 1e-7 here
    assert omega or found[[0, 2]] == pytest.approx(found[[1, 3]], rel=1e-2)


def test_point_mass_far_heavier_than_the_plate() -> None:
    """A point mass a million times as heavy as the plate: the plate is a spring, its own modes are far above."""
    size, weight = (0.2, 0.05, 0.004), 7850.0 * 0.2 * 0.05 * 0.004
    plate = Plate(rectangle(size[0], size[1], 10, 3), size[2], Material(2e11, 0.0, 7850.0), 1e6 * weight, (0.2, 0.0))
    found = solve_modes(assemble(plate, Rotor(), Effects()), 0.0, 1).eigenvalues[0]
    beam = 3 * 2e11 * size[1] * size[2] ** 3 / 12 / size[0] ** 3  # 3 EI / L^3 of a beam
    assert found == pytest.approx(beam / (1e6 * weight), rel=2e-2)


@pytest.mark.parametrize("coriolis", [False, True])
def test_hardly_spinning(coriolis: bool) -> None:
    """Omega -> 0: differences between spinning and resting plate drown in rounding."""
    plate = Plate(rectangle(0.2, 0.08, 8, 4), 0.01, STEEL)
    operators = assemble(plate, Rotor(0.1, 0.5), Effects(coriolis=coriolis))
    rest = solve_modes(operators, 0.0, 5).frequencies_hz
    for omega in (1e-300, 1e-150, 1e-12, 1e-6):
        np.testing.assert_allclose(solve_modes(operators, omega, 5).frequencies_hz, rest, rtol=1e-9)
    swept = campbell(operators, np.array([0.0, 1e-12, 1e-6]), 5)
    np.testing.assert_allclose(swept.frequencies_hz, np.tile(rest, (3, 1)), rtol=1e-8)


@pytest.mark.parametrize(
    ("thickness", "omega", "stagger", "expected"),
    [(1e-3, 3e4, 0.7, NoEquilibrium), (1e-4, 100.0, np.pi / 2, Divergence)],
)
def test_pressed_beyond_equilibrium(
    thickness: float, omega: float, stagger: float, expected: type[ArithmeticError]
) -> None:
    """Large deflection, pressed inwards beyond what the plate can carry: Newton's method has nothing to find."""
    plate = Plate(rectangle(0.2, 0.08, 6, 3), thickness, STEEL)
    operators = assemble(plate, Rotor(-0.2, stagger), Effects(large_deflection=True))
    with pytest.raises(expected) as caught:
        solve_modes(operators, omega, 2)
    assert caught.value.omega == omega
    slow = equilibrium(operators, 1.0)
    assert np.isfinite(slow).all()
