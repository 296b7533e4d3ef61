"""What Coriolis forces would do, told from modes without them on a coarse mesh: against complex modes on a finer."""

from dataclasses import replace

import numpy as np
import pytest
from fem_cases import STEEL, rpm

from fem import Effects, Plate, Rectangle, Rotor, assemble, solve_modes
from fem.accuracy.neglected_effects import turned

COUNT = 6


def true_shifts(planform, thickness, rotor, effects, omega):
    plate = Plate(planform.mesh(5), thickness, STEEL)
    turning, still = (
        solve_modes(assemble(plate, rotor, replace(effects, coriolis=on)), omega, COUNT).frequencies_hz
        for on in (True, False)
    )
    return np.abs(turning / still - 1.0)


@pytest.mark.parametrize(
    ("thickness", "hub", "stagger", "speed", "large"),
    [
        (0.0142, 0.1, 90.0, 8000, False),  # twist and lag nearly coincide
        (0.0148, 0.0, 90.0, 8000, False),
        (0.01, 0.0, 0.0, 17500, False),  # lag, coupled to stretching
        (0.012, 0.1, 80.0, 4000, False),
        (0.003, 0.0, 45.0, 9000, True),
    ],
)
def test_shifts_are_those_of_complex_modes(thickness, hub, stagger, speed, large):
    planform, rotor = Rectangle(0.2, 0.08), Rotor(hub, np.radians(stagger))
    effects = Effects(large_deflection=large)
    found = turned(Plate(planform.mesh(3), thickness, STEEL), rotor, effects, (rpm(speed),), COUNT)
    true = true_shifts(planform, thickness, rotor, effects, rpm(speed))
    assert (found.shifts[0] > 0.95 * true - 2e-6).all()
    assert found.shifts.max() < 1.6 * true.max()  # of modes that may be nearer to one another than on the coarse mesh


@pytest.mark.parametrize(("large", "tolerance"), [(False, 1e-3), (True, 2e-2)])
def test_speeds_between_those_solved(large, tolerance):
    """The modes at a few speeds, and at large deflection a polynomial for the stiffness, stand for those between."""
    plate, rotor, effects = Plate(Rectangle(0.2, 0.08).mesh(2), 0.006, STEEL), Rotor(0.1, 1.2), Effects()
    effects = replace(effects, large_deflection=large)
    speeds = tuple(np.linspace(0.0, rpm(9000), 12))
    found = turned(plate, rotor, effects, speeds, COUNT)
    assert found.shifts.shape == (12, COUNT)
    assert (found.shifts[0] == 0.0).all()
    for number in (3, 7, 10):
        alone = turned(plate, rotor, effects, speeds[number : number + 1], COUNT)
        np.testing.assert_allclose(found.shifts[number], alone.shifts[0], rtol=tolerance, atol=1e-5 * tolerance)
    assert found.largest == (found.shifts.max(), speeds[int(found.shifts.max(axis=1).argmax())])


def test_past_the_critical_speed_there_is_nothing_to_shift():
    plate, rotor = Plate(Rectangle(0.2, 0.2).mesh(2), 0.001, STEEL), Rotor(0.0, np.pi / 2)
    assert turned(plate, rotor, Effects(stress_stiffening=False), (rpm(60000),), 3) is None
    found = turned(plate, rotor, Effects(stress_stiffening=False), (rpm(100), rpm(60000)), 3)
    np.testing.assert_array_equal(found.omega, [rpm(100)])
