"""Coriolis forces: complex modes against a dense solver and closed forms; what modes without them tell of them."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from fem_cases import STEEL, frequencies, paper_plate, rpm

from fem import Effects, Material, Plate, Rectangle, Rotor, assemble, campbell, rectangle, solve_modes
from fem.accuracy.neglected_effects import turned
from fem.assembly import with_coriolis

CORIOLIS = Effects(coriolis=True)


@pytest.mark.parametrize("stagger", [0.0, 0.7])
def test_dense_reference(stagger):
    """Of a mass without rotary inertia; with it, of all theories, in test_fem_laws.py."""
    operators = assemble(paper_plate(4, 2), Rotor(0.1, stagger), Effects(coriolis=True, rotary_inertia=False))
    omega = 1800.0
    found = 2.0 * np.pi * solve_modes(operators, omega, 6).frequencies_hz
    m, g, k = (a.toarray() for a in (operators.mass, omega * operators.gyroscopic, operators.at(omega)))
    zero, eye = np.zeros_like(m), np.eye(len(m))
    values = scipy.linalg.eigvals(np.block([[zero, eye], [-k, -g]]), scipy.linalg.block_diag(eye, m))
    upper = np.sort(values.imag[np.isfinite(values) & (values.imag > 1.0)])[:6]
    np.testing.assert_allclose(found, upper, rtol=1e-7)  # the QZ algorithm's own accuracy with a singular mass


def test_counted_in_later_they_are_the_same():
    """Those of the plate's own point mass too."""
    plate = Plate(rectangle(0.2, 0.08, 4, 2), 0.01, STEEL, 0.3, (0.13, 0.02))
    at_once, plain = (assemble(plate, Rotor(0.1, 0.4), effects) for effects in (CORIOLIS, Effects()))
    later = with_coriolis(plain)
    assert later.effects == CORIOLIS
    assert abs(later.gyroscopic - at_once.gyroscopic).max() <= 1e-15 * abs(at_once.gyroscopic).max()


def test_heavy_bob_in_the_plane():
    """A heavy mass on a light plate has two in-plane modes with (k_u - m(w² + O²))(k_v - m(w² + O²)) = (2 m O w)².

    The stiffnesses k_u, k_v come from the plate's static compliance at the mass.
    """
    mass, omega = 1e4, 40.0
    plate = Plate(rectangle(0.1, 0.05, 4, 2), 0.01, Material(2e11, 0.3, 1.0), mass, (0.1, 0.0))
    operators = assemble(plate, Rotor(), Effects(stress_stiffening=False, coriolis=True))
    rows = operators.at_place((0.1, 0.0)).rows[0].toarray()
    compliance = rows @ np.linalg.solve(operators.stiffness.toarray(), rows.T)
    ku, kv = 1.0 / compliance[0, 0], 1.0 / compliance[1, 1]
    a, b = ku / mass - omega**2, kv / mass - omega**2
    total = a + b + 4.0 * omega**2
    expected = np.sqrt((total + np.array([-1.0, 1.0]) * np.sqrt(total**2 - 4.0 * a * b)) / 2.0)
    modes = solve_modes(operators, omega, 3)
    moved = np.abs(rows[2] @ modes.shapes) > np.abs(rows[0] @ modes.shapes)
    found = 2.0 * np.pi * modes.frequencies_hz[~moved]
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_conservative_modes_are_normalised_and_solve_the_problem():
    operators = assemble(paper_plate(6, 3), Rotor(0.1, 0.5), CORIOLIS)
    omega = rpm(15000)
    modes = solve_modes(operators, omega, 6)
    assert np.abs(modes.damping_ratios).max() < 1e-12
    x, w = modes.shapes, np.sqrt(modes.eigenvalues)
    np.testing.assert_allclose(np.einsum("ij,ij->j", x.conj(), operators.mass @ x).real, 1.0, rtol=1e-10)
    stiff = operators.at(omega) @ x
    residual = stiff + 1j * omega * w * (operators.gyroscopic @ x) - w**2 * (operators.mass @ x)
    assert (np.linalg.norm(residual, axis=0) < 1e-7 * np.linalg.norm(stiff, axis=0)).all()


def test_damping_is_shared_out():
    """Coriolis mixes modes of equal ratio, so each keeps about that ratio; the sweep agrees to first order."""
    operators = assemble(paper_plate(6, 3), Rotor(0.1, 0.5), CORIOLIS)
    omega = rpm(15000)
    modes = solve_modes(operators, omega, 5, damping_ratio=0.01)
    np.testing.assert_allclose(modes.damping_ratios, 0.01, rtol=1e-2)
    swept = campbell(operators, np.array([0.0, omega]), 5, damping_ratio=0.01)
    np.testing.assert_allclose(swept.damping_ratios[-1], modes.damping_ratios, rtol=1e-3)
    np.testing.assert_allclose(swept.damping_ratios[0], 0.01, rtol=1e-12)


def test_a_mode_that_does_not_oscillate_is_not_left_out(monkeypatch):
    """A ratio that spinning modes reach but the check lets pass is refused where the modes are found."""
    monkeypatch.setattr("fem.modes.check_damping", lambda ratio: None)
    operators = assemble(paper_plate(4, 2), Rotor(), CORIOLIS)
    with pytest.raises(ValueError, match="does not oscillate"):
        solve_modes(operators, 100.0, 3, damping_ratio=2.0)


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
    found = turned(Plate(planform.mesh(3), thickness, STEEL), rotor, effects, (rpm(speed),), 6)
    fine = Plate(planform.mesh(5), thickness, STEEL)
    turning, still = (frequencies(fine, rotor, replace(effects, coriolis=on), omega=rpm(speed)) for on in (True, False))
    true = np.abs(turning / still - 1.0)
    assert (found.shifts[0] > 0.95 * true - 2e-6).all()
    assert found.shifts.max() < 1.6 * true.max()  # of modes that may be nearer to one another than on the coarse mesh


@pytest.mark.parametrize(("large", "tolerance"), [(False, 1e-3), (True, 2e-2)])
def test_speeds_between_those_solved(large, tolerance):
    """The modes at a few speeds, and at large deflection a polynomial for the stiffness, stand for those between."""
    plate, rotor = Plate(Rectangle(0.2, 0.08).mesh(2), 0.006, STEEL), Rotor(0.1, 1.2)
    effects = Effects(large_deflection=large)
    speeds = tuple(np.linspace(0.0, rpm(9000), 12))
    found = turned(plate, rotor, effects, speeds, 6)
    assert found.shifts.shape == (12, 6)
    assert (found.shifts[0] == 0.0).all()
    for number in (3, 7, 10):
        alone = turned(plate, rotor, effects, speeds[number : number + 1], 6)
        np.testing.assert_allclose(found.shifts[number], alone.shifts[0], rtol=tolerance, atol=1e-5 * tolerance)
    assert found.largest == (found.shifts.max(), speeds[int(found.shifts.max(axis=1).argmax())])


def test_past_the_critical_speed_there_is_nothing_to_shift():
    given = Plate(Rectangle(0.2, 0.2).mesh(2), 0.001, STEEL), Rotor(0.0, np.pi / 2), Effects(stress_stiffening=False)
    assert turned(*given, (rpm(60000),), 3) is None
    found = turned(*given, (rpm(100), rpm(60000)), 3)
    np.testing.assert_array_equal(found.omega, [rpm(100)])
