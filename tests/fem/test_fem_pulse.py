"""The energy that a short pulse leaves: an infinite plate, a beam in closed form, all modes of small bodies."""

import math

import numpy as np
import pytest
from fem_cases import FLAT, box, paper_plate
from scipy.linalg import eigh

from fem import Material, Plate, Rotor, assemble, rectangle
from fem.reduction.pulse import inverse_mass, spectrum
from fem.solid.assembly import assemble_solid
from fem.solid.blade import Blade, root_at

STEEL = Material(2.1e11, 0.3, 7850.0)


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin"])
def test_a_hit_in_the_middle_of_a_wide_plate_is_that_on_an_infinite_one(theory):
    """Boussinesq's dashpot: force over velocity is 8 sqrt(D rho h) until waves come back from the edges.

    Half a sine through 1/Y leaves the energy Y J² pi² / 8 tau.
    """
    plate = Plate(rectangle(0.8, 0.8, 40, 40), 2e-3, STEEL)
    operators = assemble(plate, Rotor(), FLAT, theory)
    bending = STEEL.youngs_modulus * plate.thickness**3 / 12 / (1 - STEEL.poissons_ratio**2)
    mobility = 1 / (8 * math.sqrt(bending * STEEL.density * plate.thickness))
    durations = np.array([2e-4, 1.5e-4])
    found = inverse_mass(operators, at(operators, 0.4), durations)
    assert found == pytest.approx(math.pi**2 / 4 * mobility / durations, rel=0.01)


def test_a_slow_pulse_on_a_strip_meets_the_modes_of_a_beam():
    """Cantilever: cos x cosh x = -1, every mode moves the tip by 4/m; pulses from one to a twentieth of its period."""
    length, width, thickness = 0.2, 0.008, 0.002
    plate = Plate(rectangle(length, width, 60, 2), thickness, Material(2.1e11, 0.0, 7850.0))
    operators = assemble(plate, Rotor(), FLAT, "kirchhoff")
    roots = np.array([1.87510407, 4.69409113, 7.85475744, 10.99554073, *(np.pi * (np.arange(5, 12) - 0.5))])
    rates = (roots / length) ** 2 * math.sqrt(2.1e11 * thickness**2 / 12 / 7850.0)
    durations = 2 * math.pi / rates[0] / np.array([1.0, 3.0, 20.0])
    mass = 7850.0 * length * width * thickness
    exact = [4 / mass * (spectrum(rates, each) ** 2).sum() for each in durations]
    assert inverse_mass(operators, at(operators, length), durations) == pytest.approx(exact, rel=0.01)


def test_a_pulse_meets_all_modes_of_a_plate():
    operators = assemble(paper_plate(6, 3), Rotor(), FLAT, "mindlin")
    meets_every_mode(operators, at(operators, 0.2), np.array([1e-3, 1e-4, 3e-5]))


def test_a_pulse_meets_all_modes_of_a_solid():
    mesh, origin, axis = box("hexahedron20"), np.array([-1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    operators = assemble_solid(Blade(mesh, STEEL, root_at(mesh, axis, origin), axis, origin))
    force = np.zeros((operators.nodes, 3))
    force[np.argmax(mesh.points.sum(axis=1)), 1] = 1.0
    meets_every_mode(operators, operators.gathered(force), np.array([2e-3, 2e-4]))


def meets_every_mode(operators, force, durations):
    inverse, shapes = eigh(operators.mass.toarray(), operators.stiffness.toarray())
    moves = inverse > 1e-12 * inverse.max()  # what has no mass follows at once, and keeps nothing
    rates, lifts = inverse[moves] ** -0.5, force @ shapes[:, moves] * inverse[moves] ** -0.5
    exact = [((spectrum(rates, each) * lifts) ** 2).sum() for each in durations]
    assert inverse_mass(operators, force, durations) == pytest.approx(exact, rel=0.02)


def at(operators, x):
    """A unit force along z on the centre line."""
    return operators.at_place((x, 0.0)).floor[[0]].toarray()[0]


def test_the_spectrum_of_half_a_sine():
    """By quadrature of its definition, and its limits."""
    t = (np.arange(20000) + 0.5) / 20000
    rates = np.array([0.0, 1.0, math.pi, 7.0, 3 * math.pi, 40.0])
    pulse = np.sin(math.pi * t) * math.pi / 2
    exact = np.abs((pulse * np.exp(1j * rates[:, None] * t)).mean(axis=1))
    assert spectrum(rates, 1.0) == pytest.approx(exact, abs=1e-6)
