"""A root on springs: the exact beam, the clamp as their limit, and the theories among each other."""

from itertools import islice, pairwise

import numpy as np
import pytest
from fem_cases import AT_REST, BENT, FLAT, STEEL, STRIP, check_tangent, frequencies, unit_of
from scipy.optimize import brentq

from fem import ElasticRoot, Plate, Rotor, Unresolved, assemble, rectangle, solve_modes
from fem.accuracy.theory_selection import theory_errors
from fem.linalg import factorise
from fem.meshes.thickness import Polynomial
from fem.theory.registry import LAYERED

LENGTH, WIDTH, HEIGHT = 1.0, 0.02, 0.01
BENDING = STRIP.youngs_modulus * HEIGHT**3 / 12.0
THEORIES = ("kirchhoff/bfs", "kirchhoff/argyris", "mindlin", "solid")


def strip(theory, root):
    mesh = rectangle(LENGTH, WIDTH, 40 if theory == "solid" else 24, 1)
    return assemble(Plate(mesh, HEIGHT, STRIP, elastic_root=root), Rotor(), AT_REST, theory)


def beam(translation, rotation, count):
    """Roots beta of the cantilever on springs: E I w'' = c w' and E I w''' = -k w at the root, in units of E I and L.

    With the rotation alone it is Chun's equation (J. Sound Vib. 1972, a beam hinged with a rotational spring).
    """

    def mismatch(b):
        c, s, ch, sh = np.cos(b), np.sin(b), np.cosh(b), np.sinh(b)
        at_root = [-b, -rotation, b, -rotation], [translation, -(b**3), translation, b**3]
        rows = np.array([*at_root, [-c, -s, ch, sh], [s, -c, sh, ch]])  # of cos, sin, cosh, sinh
        return np.linalg.det(rows / np.abs(rows).max(axis=1)[:, None])

    pairs = pairwise(np.linspace(0.05, 12.0, 2000))
    crossed = (pair for pair in pairs if mismatch(pair[0]) * mismatch(pair[1]) < 0)
    return np.array([brentq(mismatch, *pair, xtol=1e-13) for pair in islice(crossed, count)])


def test_the_equation_has_its_limits():
    """Clamped: 1.8751, 4.6941; hinged: 0 and 3.9266; and Chun's root at c L / E I = 1, b³ (1 + ch c) = c' (...)."""
    np.testing.assert_allclose(beam(1e12, 1e12, 2), (1.87510407, 4.69409113), rtol=1e-7)
    np.testing.assert_allclose(beam(1e12, 1e-9, 1), 3.92660231, rtol=1e-7)
    b = beam(1e12, 1.0, 1)[0]
    balance = 1.0 + np.cosh(b) * np.cos(b) - b * (np.sin(b) * np.cosh(b) - np.cos(b) * np.sinh(b))
    assert abs(balance) < 1e-8


@pytest.mark.parametrize(("translation", "rotation"), [(1e5, 1.0), (1e5, 10.0), (30.0, 1e5), (50.0, 5.0)])
@pytest.mark.parametrize("theory", THEORIES)
def test_a_beam_on_springs(theory, translation, rotation):
    """Two frequencies of bending; shear and rotary inertia, 1e-3 at most, apart."""
    root = ElasticRoot(translation * BENDING / LENGTH**3, rotation * BENDING / LENGTH)
    operators = strip(theory, root)
    rates = 2.0 * np.pi * solve_modes(operators, 0.0, 8).frequencies_hz
    for expected in beam(translation, rotation, 2) ** 2:
        assert np.abs(rates / unit_of(HEIGHT) / expected - 1.0).min() < 1e-3


@pytest.mark.parametrize("theory", THEORIES)
def test_what_a_force_at_the_tip_does(theory):
    """w = F L³/3EI + F L²/c + F/k, and for what shears 6 F L / 5 G A; a pull P moves the root by P/k."""
    root = ElasticRoot(3e6, 2e4)
    operators = strip(theory, root)
    factor, force = factorise(operators.stiffness), 1e3 * WIDTH
    row = operators.at_place((LENGTH, 0.0)).rows[0]
    bent = factor.solve(force * row[[2]].toarray().ravel())
    expected = force / WIDTH * (LENGTH**3 / (3.0 * BENDING) + LENGTH**2 / root.rotational + 1.0 / root.stiffness)
    assert (row @ bent)[2] == pytest.approx(expected, rel=1e-3)
    pulled = factor.solve(force * row[[0]].toarray().ravel())
    at_root = operators.at_place((0.0, 0.0)).rows[0] @ pulled
    assert at_root[0] == pytest.approx(force / WIDTH / root.stiffness, rel=1e-3)


@pytest.mark.parametrize("theory", ["kirchhoff/bfs", "kirchhoff/argyris", "kirchhoff/morley", "mindlin", "solid"])
@pytest.mark.parametrize("thickness", [0.01, Polynomial(((0.01, 0.02), (-0.02,)))])
def test_stiff_springs_are_a_clamp(theory, thickness):
    """Frequencies rise to those of the clamp, and what is left falls with the inverse of the stiffness."""
    mesh = rectangle(0.2, 0.08, 6, 3)
    mesh = mesh.to_meshtri() if theory.endswith("morley") else mesh
    clamped, *yielding = (
        frequencies(Plate(mesh, thickness, STEEL, elastic_root=root), Rotor(0.1), FLAT, theory, 500.0, 5)
        for root in (None, ElasticRoot(1e16, 1e12), ElasticRoot(1e15, 1e11))
    )
    least, most = (1.0 - each / clamped for each in yielding)
    assert (least > 0.0).all()
    assert least.max() < 1e-4
    np.testing.assert_allclose(most / least, 10.0, rtol=0.1)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "solid"])
def test_springs_at_large_deflections(theory):
    plate = Plate(rectangle(0.2, 0.08, 3, 2), 0.004, STEEL, elastic_root=ElasticRoot(2e9, 3e4))
    check_tangent(assemble(plate, Rotor(0.1, 0.7), BENT, theory).model, 1e-4, 1e-8, 1e-5, seed=3)


@pytest.mark.parametrize(("translation", "rotation"), [(5e11, 1e8), (1e13, 1e9), (1e15, 1e11)])
def test_stiff_springs_are_as_uncertain_as_a_clamp_not_moved(translation, rotation):
    """A solid cannot contract between stiff springs, and a plate does: by no more than is said, up to 0.5 %."""
    length, thickness = 0.2, 0.02
    plate = Plate(rectangle(length, 0.08, 20, 8), thickness, STEEL, elastic_root=ElasticRoot(translation, rotation))
    held, free = (assemble(plate, Rotor(), AT_REST, theory) for theory in ("solid", "mindlin"))
    solid, modes = (solve_modes(operators, 0.0, 4) for operators in (held, free))
    apart = np.abs(modes.frequencies_hz / solid.frequencies_hz - 1.0)
    said = theory_errors(free, modes.eigenvalues, modes.shapes)
    assert (apart < said + LAYERED[2] * thickness / length).all()


@pytest.mark.parametrize(("thickness", "soft"), [(0.01, True), (1e-8, False)])
def test_too_soft_is_not_too_thin(thickness, soft):
    """By what is at fault: the springs of a plate that has its frequencies when clamped, or the plate."""
    root = ElasticRoot(1e-6, 1e-9) if soft else ElasticRoot(1e12, 1e9)
    plate = Plate(rectangle(0.2, 0.08, 8, 4), thickness, STEEL, elastic_root=root)
    with pytest.raises(Unresolved, match="almost free" if soft else "too thin for theory") as found:
        solve_modes(assemble(plate, Rotor(), FLAT, "solid"), 0.0, 3)
    assert (found.value.loose == root) == soft
