"""What must hold exactly, whatever the mesh."""

import numpy as np
import pytest
import scipy.linalg
from fem_cases import (
    AT_REST,
    BENT,
    FLAT,
    STEEL,
    STRIP,
    complex_rates,
    distorted,
    frequencies,
    paper_plate,
    rpm,
    unit_of,
)
from skfem import MeshQuad

from fem import (
    Divergence,
    Effects,
    ElasticRoot,
    Material,
    Plate,
    Rotor,
    assemble,
    critical_speed,
    families,
    rectangle,
    solve_modes,
    with_point_mass,
)


def test_no_effects_no_speed_dependence():
    operators = assemble(paper_plate(10, 4), Rotor(), AT_REST)
    rest, fast = (solve_modes(operators, omega, 6).frequencies_hz for omega in (0.0, rpm(17500)))
    np.testing.assert_array_equal(rest, fast)


@pytest.mark.parametrize("stagger", [0.3, 1.0])
def test_softening_of_a_beam_goes_with_sine_squared(stagger):
    """omega²(stagger) = omega²(0) - Omega² sin² stagger where lag is stiff: exact for equal prestress."""
    plate, omega = Plate(rectangle(1.0, 0.05, 20, 1), 0.001, STRIP), 5.0
    straight, leaning = (
        2.0 * np.pi * frequencies(plate, Rotor(stagger=angle), omega=omega, count=1)[0] for angle in (0.0, stagger)
    )
    assert straight**2 - leaning**2 == pytest.approx((omega * np.sin(stagger)) ** 2, rel=2e-3)


@pytest.mark.parametrize(("effects", "thickness", "rtol"), [(FLAT, 0.01, 1e-10), (BENT, 0.003, 1e-9)])
def test_stiffness_and_speed_scale_together(effects, thickness, rtol):
    """Four times E and Omega² leave f / sqrt(E) unchanged."""
    plates = [Plate(rectangle(0.2, 0.08, 6, 3), thickness, Material(e, 0.3, 7850.0)) for e in (1e11, 4e11)]
    soft, hard = (
        frequencies(plate, Rotor(0.1, 0.7), effects, omega=800.0 * scale) / scale
        for plate, scale in zip(plates, (1.0, 2.0), strict=True)
    )
    np.testing.assert_allclose(soft, hard, rtol=rtol)


@pytest.mark.parametrize("theory", ["mindlin", "solid"])
@pytest.mark.parametrize("triangles", [False, True])
def test_mass_is_conserved(theory, triangles):
    """On soft springs along its root a plate goes to and fro along x as one piece, at the rate of its whole mass."""
    mesh = distorted(rectangle(0.2, 0.08, 6, 3), 0.005)
    rate = 1e3  # rad²/s²: far below what strains the plate, 1e9, and far above what rounding leaves, 1e-5
    soft = rate * STEEL.density * 0.01 * 0.2
    plate = Plate(
        mesh.to_meshtri() if triangles else mesh, 0.01, STEEL, elastic_root=ElasticRoot(stiffness=soft, rotational=1e4)
    )
    modes = solve_modes(assemble(plate, Rotor(), AT_REST, theory), 0.0, 3)
    assert np.abs(modes.eigenvalues / rate - 1.0).min() < 1e-5


def test_tip_mass_pulls_softens_and_weighs():
    """A heavy mass on a thin strip is a bob on a string: flap goes with Omega, and lag keeps what softening leaves."""
    plate = Plate(rectangle(1.0, 0.01, 20, 1), 1e-4, STRIP, 1.0, (1.0, 0.0))
    omega = 3.0
    found = []
    for stagger in (0.0, np.pi / 2):
        operators = assemble(plate, Rotor(stagger=stagger), FLAT)
        modes = solve_modes(operators, omega, 3)
        found.append(modes.eigenvalues[families(operators, modes).index("flap")] / omega**2)
    flap, lag = found
    assert flap == pytest.approx(1.0, abs=0.02)
    assert flap - lag == pytest.approx(1.0, abs=1e-3)


def test_point_masses_add_up():
    once, bare = (
        assemble(paper_plate(10, 4, **mass), Rotor(0.05, 0.3), FLAT)
        for mass in ({"tip_mass": 0.3, "tip_at": (0.2, 0.01)}, {})
    )
    twice = with_point_mass(with_point_mass(bare, (0.2, 0.01), 0.1), (0.2, 0.01), 0.2)
    for a, b in ((once.mass, twice.mass), (once.at(500.0), twice.at(500.0))):
        assert abs(a - b).max() < 1e-12 * abs(a).max()
    held = once.model.membrane
    for operators in (once, twice):
        balanced = (operators.stiffness @ operators.prestress)[held]
        np.testing.assert_allclose(balanced, operators.load[held], atol=1e-9 * abs(operators.load).max())


def test_geometric_stiffness_a_hundred_times_the_elastic():
    """A membrane: the lowest flap frequency tends to Omega, whatever the plate's own stiffness."""
    operators = assemble(Plate(rectangle(1.0, 0.02, 40, 1), 1e-4, STRIP), Rotor(), FLAT)
    elastic = solve_modes(operators, 0.0, 1).eigenvalues[0]
    omega = 10.0 * np.sqrt(elastic)
    assert solve_modes(operators, omega, 1).eigenvalues[0] / omega**2 == pytest.approx(1.0, abs=0.1)


def test_an_inward_beam_buckles():
    """Clamped at the rim and pointing at the axis, a beam is compressed by N = -rho A Omega² (L - s)² / 2.

    The witness is a Ritz solution of the beam in powers of s, from the clamp.
    """
    powers = np.arange(2, 12)
    total, apart = powers[:, None] + powers, np.multiply.outer(powers, powers)
    bending = apart * np.multiply.outer(powers - 1, powers - 1) / (total - 3)
    pressing = 0.5 * apart * (1 / (total - 1) - 2 / total + 1 / (total + 1))
    gamma = np.sqrt(1.0 / scipy.linalg.eigvalsh(pressing, bending)[-1])

    operators = assemble(Plate(rectangle(1.0, 0.02, 30, 1), 0.001, STRIP), Rotor(hub_radius=-1.0), FLAT)
    critical = critical_speed(operators)
    assert critical / unit_of(0.001) == pytest.approx(gamma, rel=1e-3)
    rest, near = (solve_modes(operators, omega, 1).eigenvalues[0] for omega in (0.0, 0.99 * critical))
    assert 0.0 < near < 0.05 * rest
    with pytest.raises(Divergence):
        solve_modes(operators, 1.01 * critical, 1)


@pytest.mark.parametrize("triangles", [False, True])
def test_strongly_graded_mesh(triangles):
    """Cells from 0.5 mm to 50 mm in one mesh change little."""
    x = np.concatenate([[0.0], np.cumsum(np.geomspace(1.0, 100.0, 16))])
    y = np.concatenate([[0.0], np.cumsum(np.geomspace(1.0, 10.0, 8))])
    mesh = MeshQuad.init_tensor(0.2 * x / x[-1], 0.08 * (y / y[-1] - 0.5))
    plate = Plate(mesh.to_meshtri() if triangles else mesh, 0.01, STEEL)
    graded, even = (frequencies(each, omega=rpm(10000), count=4) for each in (plate, paper_plate()))
    np.testing.assert_allclose(graded, even, rtol=1e-2)


@pytest.mark.parametrize(("theory", "tolerance"), [("mindlin", 1e-2), ("kirchhoff", 1e-2), ("solid", 2.5e-2)])
def test_nearly_incompressible(theory, tolerance):
    """Little happens to the frequencies as nu tends to 1/2; bricks stiffen by 2 % on this coarse mesh."""
    found = [
        frequencies(paper_plate(10, 4, Material(2e11, nu, 7850.0)), effects=AT_REST, theory=theory, count=4)
        for nu in (0.49, 0.4999)
    ]
    np.testing.assert_allclose(found[1], found[0], rtol=tolerance)


def test_modes_of_unknowns_without_mass_are_not_made_up():
    plate = Plate(rectangle(0.2, 0.1, 2, 1), 0.01, STEEL)
    operators = assemble(plate, Rotor(0.1), Effects(rotary_inertia=False), "mindlin")
    massive = np.linalg.matrix_rank(operators.mass.toarray(), hermitian=True)
    inverse = scipy.linalg.eigh(operators.mass.toarray(), operators.stiffness.toarray(), eigvals_only=True)[::-1]
    found = solve_modes(operators, 0.0, operators.mass.shape[0])
    assert found.eigenvalues.size == massive < operators.mass.shape[0]
    assert found.eigenvalues == pytest.approx(1.0 / inverse[:massive], rel=1e-7)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "kirchhoff/morley", "kirchhoff/argyris"])
@pytest.mark.parametrize("fewer", [0, 2, 5])
def test_complex_modes_of_all_unknowns(theory, fewer):
    plate = Plate(rectangle(0.2, 0.1, 1, 1), 0.01, STEEL)
    operators = assemble(plate, Rotor(0.1, 0.4), Effects(coriolis=True), theory)
    omega, count = 500.0, operators.mass.shape[0] - fewer
    found = solve_modes(operators, omega, count)
    assert np.sqrt(found.eigenvalues) == pytest.approx(complex_rates(operators, omega)[:count], rel=1e-7)
