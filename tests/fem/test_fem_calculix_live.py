"""CalculiX beside this code in one go, where it is installed."""

import numpy as np
import pytest
from fem_cases import STEEL, rpm

from fem import Effects, Plate, Rotor, assemble, rectangle, solve_modes
from tests.benchmarks import calculix
from tests.limits import HANG

pytestmark = pytest.mark.skipif(not calculix.available(), reason="CalculiX (ccx) is not installed")


def test_a_heavy_mass_is_softened():
    """What moves in the plane of rotation has a square lower by Omega²: flap at stagger 90°, lag at 0 (Southwell).

    CalculiX softens the plate alone, of a fiftieth of the mass.
    """
    size, omega, kg = (0.1, 0.04, 0.01), rpm(3000), 15.0
    nodes, bricks = calculix.grid(size, (10, 4, 2))
    material = (STEEL.youngs_modulus, STEEL.poissons_ratio, STEEL.density)

    def squares(stagger, mass):
        deck = calculix.deck(nodes, bricks, material, omega, 0.0, stagger, 2, mass)
        return calculix.solved(deck, 2, HANG) ** 2

    flat, upright = (squares(stagger, (kg, 0.1, 0.0)) for stagger in (0.0, np.pi / 2))
    np.testing.assert_allclose((flat - upright) * [1, -1], (omega / (2 * np.pi)) ** 2, rtol=0.02)


@pytest.mark.parametrize(("stagger", "hub"), [(0.0, 0.1), (0.4, 0.05)])
def test_a_plate_nobody_tabulated(stagger, hub):
    size, omega = (0.16, 0.06, 0.006), rpm(8000)
    material = (STEEL.youngs_modulus, STEEL.poissons_ratio, STEEL.density)
    expected = calculix.frequencies(size, material, (16, 6, 2), omega, hub=hub, stagger=stagger, count=4, timeout=HANG)
    plate = Plate(rectangle(0.16, 0.06, 16, 6), 0.006, STEEL)
    operators = assemble(plate, Rotor(hub, stagger), Effects(large_deflection=stagger > 0.0))
    np.testing.assert_allclose(solve_modes(operators, omega, 4).frequencies_hz, expected, rtol=4e-3)
