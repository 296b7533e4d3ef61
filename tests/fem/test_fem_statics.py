"""Large deflection: equilibria and the modes about them."""

import numpy as np
import pytest
from fem_cases import STEEL, distorted, paper_plate, rpm

from fem import Effects, Material, Plate, Rotor, assemble, displacement, equilibrium, rectangle, solve_modes
from fem.statics import _stressed, _unbalanced, tangent

BENT = Effects(large_deflection=True)


def staggered(theory="mindlin", h=0.004, angle=0.7, **keys):
    plate = Plate(rectangle(0.2, 0.08, 8, 4), h, STEEL)
    return assemble(plate, Rotor(0.1, angle), Effects(large_deflection=True, **keys), theory)


def unbalanced(operators, omega, state):
    return _unbalanced(operators, omega**2, state, _stressed(operators.model, state))


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "solid"])
def test_tangent_is_the_derivative_of_the_force(theory):
    operators = staggered(theory)
    rng = np.random.default_rng(0)
    omega = rpm(9000)
    state = equilibrium(operators, omega)
    step = rng.standard_normal(state.size) * np.abs(state).max() * 1e-5
    ahead, behind = (unbalanced(operators, omega, state + sign * step) for sign in (1.0, -1.0))
    difference, linear = 0.5 * (behind - ahead), tangent(operators, omega, state) @ step
    assert np.linalg.norm(difference - linear) < 1e-6 * np.linalg.norm(linear)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "solid"])
def test_equilibrium_balances(theory):
    operators = staggered(theory)
    omega = rpm(9000)
    residual = unbalanced(operators, omega, equilibrium(operators, omega))
    assert np.linalg.norm(residual) < 1e-8 * np.linalg.norm(omega**2 * operators.load)


def test_slow_is_linear():
    """At a low speed the state is the linear static solution, bending included."""
    operators = staggered(spin_softening=False)
    omega = 1.0
    state = equilibrium(operators, omega)
    linear = np.linalg.solve(operators.stiffness.toarray(), omega**2 * operators.load)
    np.testing.assert_allclose(state, linear, atol=1e-5 * np.abs(linear).max())


def test_turning_in_the_plane_strains_nothing():
    """A finite in-plane rotation of an unclamped sheet leaves no force, which von Karman's strains alone would."""
    operators = assemble(Plate(distorted(rectangle(0.2, 0.08, 4, 2), 0.01), 0.01, STEEL), Rotor(), BENT)
    blocks, points = operators.model.gradient.blocks, operators.model.points
    gradients = np.zeros((operators.model.gradient.size, *points.shape[1:]))
    c, s = np.cos(0.4) - 1.0, np.sin(0.4)
    gradients[0], gradients[1], gradients[2], gradients[3] = c, -s, s, c
    from fem.statics import _strain

    assert len(blocks) == 5
    for layer in operators.model.elastic:
        np.testing.assert_allclose(_strain(layer, gradients)[0], 0.0, atol=1e-15)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff"])
def test_stretch_without_bending_meets_the_linear_prestress(theory):
    """At stagger 0 the plate stays flat; linear and nonlinear prestress differ by the strain, 1e-3 of stiffening."""
    omega = rpm(10000)
    flat, bent = (assemble(paper_plate(8, 4), Rotor(), effects, theory) for effects in (Effects(), BENT))
    modes = solve_modes(bent, omega, 4)
    np.testing.assert_allclose(displacement(bent, modes.state)[:, 2], 0.0, atol=1e-12)
    np.testing.assert_allclose(modes.frequencies_hz, solve_modes(flat, omega, 4).frequencies_hz, rtol=1e-3)


def test_warm_start_finds_the_same_state():
    operators = staggered()
    near = equilibrium(operators, rpm(8000))
    cold, warm = equilibrium(operators, rpm(9000)), equilibrium(operators, rpm(9000), near)
    np.testing.assert_allclose(warm, cold, atol=1e-10 * np.abs(cold).max())


def test_scaling_of_modulus_and_speed():
    found = []
    for e in (1e11, 4e11):
        plate = Plate(rectangle(0.2, 0.08, 6, 3), 0.003, Material(e, 0.3, 7850.0))
        operators = assemble(plate, Rotor(0.1, 0.7), BENT)
        found.append(solve_modes(operators, 800.0 * np.sqrt(e / 1e11), 4).frequencies_hz / np.sqrt(e))
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9)


def test_a_thin_strip_untwists():
    """A strip free to twist turns its chord towards the plane of rotation, the more the faster (tennis racket)."""
    operators = staggered(h=0.001)
    twist = []
    for speed in (1000, 2000, 4000):
        moved = displacement(operators, equilibrium(operators, rpm(speed)))
        tip = np.isclose(operators.plate.mesh.p[0], 0.2)
        slope = np.polyfit(operators.plate.mesh.p[1, tip], moved[tip, 2], 1)[0]
        twist.append(-slope)
    # The chord lies at 0.7 rad to the plane of rotation; -w_y > 0 turns it back, and never past that plane.
    assert 0.0 < twist[0] < twist[1] < twist[2] < np.tan(0.7)


def test_needs_stiffening():
    with pytest.raises(ValueError, match="stress_stiffening"):
        Effects(large_deflection=True, stress_stiffening=False)
