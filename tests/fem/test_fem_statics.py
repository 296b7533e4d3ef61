"""Large deflection: equilibria and the modes about them."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from fem_cases import BENT, FLAT, STEEL, distorted, frequencies, paper_plate, rpm
from scipy.spatial.transform import Rotation
from skfem import MeshQuad

from fem import Plate, Rotor, assemble, assembly, campbell, displacement, equilibrium, rectangle, solve_modes, statics
from fem.statics import tangent, unbalanced


def staggered(theory="mindlin", h=0.004, effects=BENT):
    return assemble(Plate(rectangle(0.2, 0.08, 8, 4), h, STEEL), Rotor(0.1, 0.7), effects, theory)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "solid"])
def test_the_state_balances_and_its_tangent_is_the_derivative_of_the_force(theory):
    operators, omega = staggered(theory), rpm(9000)
    state = equilibrium(operators, omega)
    step = np.random.default_rng(0).standard_normal(state.size) * np.abs(state).max() * 1e-5
    left, ahead, behind = (
        unbalanced(operators, omega**2, each, operators.stressed(each)) for each in (state, state + step, state - step)
    )
    assert np.linalg.norm(left) < 1e-8 * np.linalg.norm(omega**2 * operators.load)
    difference, linear = 0.5 * (behind - ahead), tangent(operators, omega, state) @ step
    assert np.linalg.norm(difference - linear) < 1e-6 * np.linalg.norm(linear)


def test_slow_is_linear():
    """At a low speed the state is the linear static solution, bending included."""
    operators = staggered(effects=replace(BENT, spin_softening=False))
    omega = 1.0
    state = equilibrium(operators, omega)
    linear = np.linalg.solve(operators.stiffness.toarray(), omega**2 * operators.load)
    np.testing.assert_allclose(state, linear, atol=1e-5 * np.abs(linear).max())


@dataclass(frozen=True)
class Prescribed:
    """Fields of known values."""

    values: np.ndarray

    def evaluate(self, _):
        return self.values


def of_points(fields, *values):
    """Fields (nfield,) that are the same at every point."""
    return Prescribed(np.broadcast_to(np.array(values)[:, None, None], (len(values), *fields.dx.shape)))


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "solid"])
def test_turning_in_the_plane_strains_nothing(theory):
    """A finite in-plane rotation of an unclamped sheet leaves no stress, which von Karman's strains alone would."""
    operators = assemble(Plate(rectangle(0.2, 0.08, 4, 2), 0.01, STEEL), Rotor(), BENT, theory)
    c, s = np.cos(0.4) - 1.0, np.sin(0.4)
    energy = operators.model.energies[0]
    in_plane = (c, -s, 0.0, s, c) if theory == "solid" else (c, -s, s, c)
    zeros = (0.0,) * (energy.fields.size - len(in_plane))
    stress = replace(energy, fields=of_points(energy.fields, *in_plane, *zeros)).at(None).stress
    np.testing.assert_allclose(stress, 0.0, atol=1e-15 * 2e11)


@pytest.mark.parametrize("triangles", [False, True])
def test_turning_in_space_strains_nothing(triangles):
    """A finite rotation of an unclamped Mindlin plate by 0.9 rad about any axis, shear included."""
    mesh = distorted(rectangle(0.2, 0.08, 4, 2), 0.01)
    plate = Plate(mesh.to_meshtri() if triangles else mesh, 0.01, STEEL)
    section, shear = assemble(plate, Rotor(), BENT).model.energies
    turn = Rotation.from_rotvec([0.6, -0.5, 0.45]).as_matrix()
    moved, (tx, ty) = turn[:, :2] - np.eye(3)[:, :2], -turn[:2, 2]
    section = replace(section, fields=of_points(section.fields, *moved.ravel(), tx, 0.0, 0.0, ty, 0.0, 0.0))
    np.testing.assert_allclose(section.at(None).stress, 0.0, atol=1e-14 * 2e11 * 0.01)
    sampled = np.einsum("kj,jmcs->kmcs", moved, shear.sides).reshape(6, *shear.sides.shape[2:])
    felt = []
    for turns in ((0.0, 0.0), (tx, ty)):  # a director that stays behind, and one that turns too
        values = np.concatenate([sampled, of_points(shear.samples, *turns).values])
        felt.append(np.abs(replace(shear, samples=Prescribed(values)).at(None).stress).max())
    assert felt[1] < 1e-12 * felt[0]


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff"])
def test_stretch_without_bending_meets_the_linear_prestress(theory):
    """At stagger 0 the plate stays flat; linear and nonlinear prestress differ by the strain, 1e-3 of stiffening."""
    omega = rpm(10000)
    bent = assemble(paper_plate(8, 4), Rotor(), BENT, theory)
    modes, flat = solve_modes(bent, omega, 4), frequencies(paper_plate(8, 4), None, FLAT, theory, omega, 4)
    np.testing.assert_allclose(displacement(bent, modes.state)[:, 2], 0.0, atol=1e-12)
    np.testing.assert_allclose(modes.frequencies_hz, flat, rtol=1e-3)


def thin_ell(stagger=0.4):
    """An arm of 20 x 150 mm that carries, on one side, a tip of 50 x 120 mm; 1 mm thick."""
    whole = MeshQuad.init_tensor(np.linspace(0.0, 0.2, 9), np.append([-0.01], np.linspace(0.01, 0.11, 5)))
    x, y = whole.p[:, whole.t].mean(axis=1)
    plate = Plate(whole.restrict(np.flatnonzero((x > 0.15) | (y < 0.01))), 0.001, STEEL)
    return assemble(plate, Rotor(0.05, stagger), BENT)


def test_few_factors_where_the_load_turns_a_thin_plate_far(monkeypatch):
    """From rest at once, and to the state that many small parts of the load lead to."""
    operators, omega, factors = thin_ell(), rpm(1500), []
    small = None
    for part in np.linspace(0.0, 1.0, 21)[1:]:
        small = equilibrium(operators, omega * part**0.5, small)
    plain = assembly.Operators.factorise
    monkeypatch.setattr(assembly.Operators, "factorise", lambda *given: factors.append(1) or plain(*given))
    state = equilibrium(operators, omega)
    assert np.abs(displacement(operators, state)[:, 2]).max() > 10 * 0.001
    np.testing.assert_allclose(state, small, atol=1e-9 * np.abs(small).max())
    assert len(factors) <= 6


def test_a_state_that_is_known_is_not_sought_again(monkeypatch):
    operators, speeds = thin_ell(), np.array([rpm(500), rpm(1500)])
    states = tuple((float(omega), equilibrium(operators, float(omega))) for omega in speeds)
    cold = campbell(operators, speeds, 4)
    monkeypatch.setattr(statics, "settle", None)
    warm = campbell(operators, speeds, 4, states=states)
    np.testing.assert_allclose(warm.frequencies_hz, cold.frequencies_hz, rtol=1e-9)


def test_a_thin_strip_untwists():
    """A strip free to twist turns its chord towards the plane of rotation, the more the faster (tennis racket)."""
    operators = staggered(h=0.001)
    twist = []
    for speed in (1000, 2000, 4000):
        moved = displacement(operators, equilibrium(operators, rpm(speed)))
        tip = np.isclose(operators.plate.mesh.p[0], 0.2)
        twist.append(-np.polyfit(operators.plate.mesh.p[1, tip], moved[tip, 2], 1)[0])
    # The chord lies at 0.7 rad to the plane of rotation; -w_y > 0 turns it back, and never past that plane.
    assert 0.0 < twist[0] < twist[1] < twist[2] < np.tan(0.7)
