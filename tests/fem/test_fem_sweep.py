"""Campbell diagrams: bounds that hold, whatever is swept, and modes that are followed."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse.linalg
from fem_cases import AT_REST, BENT, FLAT, STEEL, complex_rates, paper_plate, rpm

from fem import Divergence, Effects, Plate, Rotor, assemble, campbell, critical_speed, families, rectangle, solve_modes
from fem.linalg import NotConverged, rounding
from fem.sweep.campbell import follow
from fem.sweep.reduced_basis import Question, answer_again, grow, modes_within

TOP = rpm(17500)

THICK, THIN = (Plate(rectangle(0.2, 0.08, 6, 3), thickness, STEEL) for thickness in (0.01, 0.004))
LADEN = replace(THICK, tip_mass=1.0, tip_at=(0.2, 0.0))

CASES = {
    "the paper's plate": (THICK, Rotor(), FLAT, TOP),
    "in the plane of rotation": (THICK, Rotor(stagger=np.pi / 2), FLAT, TOP),
    "staggered, with a hub": (THIN, Rotor(0.2, 0.6), FLAT, TOP),
    "square": (Plate(rectangle(0.2, 0.2, 5, 5), 0.002, STEEL), Rotor(), FLAT, rpm(6000)),
    "far beyond its own stiffness": (Plate(rectangle(0.2, 0.02, 12, 2), 1e-3, STEEL), Rotor(), FLAT, rpm(20000)),
    "tip mass": (LADEN, Rotor(0.1), FLAT, rpm(9000)),
    "Coriolis": (THIN, Rotor(0.1, 0.6), Effects(coriolis=True), rpm(12000)),
    "no rotary inertia": (THICK, Rotor(0.1, 0.2), Effects(rotary_inertia=False), TOP),
    "nothing on": (THICK, Rotor(), AT_REST, TOP),
}


@pytest.mark.parametrize("case", CASES)
def test_true_error_is_within_the_bound(case):
    """At 20 random speeds, and no bound above 1e-6."""
    plate, rotor, effects, top = CASES[case]
    operators = assemble(plate, rotor, effects)
    speeds = np.sort(np.random.default_rng(3).uniform(0.0, top, 20))
    found = campbell(operators, speeds, 6)
    true = np.array([solve_modes(operators, omega, 6).frequencies_hz for omega in speeds])
    assert found.bounds.max() <= 1e-6
    assert (np.abs(found.frequencies_hz / true - 1.0) <= found.bounds).all()


@pytest.mark.parametrize("case", CASES)
def test_a_basis_answers_other_speeds_within_its_bounds(case):
    """Also beyond the range it was grown for, and without the Coriolis forces it was grown with."""
    plate, rotor, effects, top = CASES[case]
    operators = assemble(plate, rotor, effects)
    bases = campbell(operators, np.linspace(0.0, 0.8 * top, 20), 6).bases
    still = replace(operators, gyroscopic=None)
    for body, known in ((operators, bases), (still, [basis.without_coriolis for basis in bases])):
        speeds = np.sort(np.random.default_rng(4).uniform(0.0, top, 5))
        found = answer_again(Question(body, 6, np.inf), speeds, known)
        true = 2.0 * np.pi * np.array([solve_modes(body, omega, 6).frequencies_hz for omega in speeds])
        assert (np.abs(found.rates / true - 1.0) <= found.bounds).all()
        inside = speeds <= 0.8 * top
        strict = answer_again(Question(body, 6, 1e-5), speeds[inside], known)
        assert (strict is None) == bool((found.bounds[inside] > 1e-5).any())


GRADED = np.geomspace(1e-3, 1.0, 200)
"""Parts of the highest speed that leave no room for interpolation between most of them."""


@pytest.mark.parametrize("spread", [np.linspace(0.0, 1.0, 200), GRADED, np.repeat(np.linspace(0.1, 1.0, 5), 40)])
@pytest.mark.parametrize("case", ["Coriolis", "far beyond its own stiffness", "square"])
def test_many_speeds_have_the_modes_of_each_by_itself(case, spread):
    """With Coriolis forces, where vectors are interpolated between speeds; through crossings and veerings."""
    plate, rotor, effects, top = CASES[case]
    operators = assemble(plate, replace(rotor, stagger=0.6), replace(effects, coriolis=True))
    speeds = top * spread
    basis = grow(Question(operators, 6, 1e-6), np.linspace(0.0, top, 20), 1)[0]
    rates, vectors = modes_within(basis, speeds, 8, basis.coriolis)
    parts = [modes_within(basis, part, 8, basis.coriolis) for part in np.split(speeds, 4)]
    np.testing.assert_allclose(rates, np.concatenate([part[0] for part in parts]), rtol=1e-12)
    state = np.concatenate([vectors, 1j * rates[:, None] * vectors], axis=1)  # orthogonal in energy: M and K together
    stiffness = basis.axes @ (basis.held(speeds)[:, :, None] * basis.axes.T)
    elastic, moving = np.split(state, 2, axis=1)
    energy = elastic.conj().swapaxes(1, 2) @ stiffness @ elastic + moving.conj().swapaxes(1, 2) @ basis.mass @ moving
    energy /= rates[:, :, None] * rates[:, None, :]
    np.testing.assert_allclose(energy, np.eye(8) * np.diagonal(energy, axis1=1, axis2=2)[:, None], atol=1e-8)


def test_bound_follows_the_tolerance():
    operators = assemble(paper_plate(10, 4), Rotor(), FLAT)
    speeds = np.linspace(0.0, TOP, 20)
    loose, tight = (campbell(operators, speeds, 6, tolerance=t) for t in (1e-3, 1e-9))
    assert loose.bounds.max() <= 1e-3
    assert tight.bounds.max() <= 1e-9
    assert loose.sizes < tight.sizes


@pytest.mark.parametrize("count", [1, 4, 9])
def test_count_asked_for_does_not_matter(count):
    operators = assemble(paper_plate(10, 4), Rotor(0.1, 0.4), FLAT)
    speeds = np.linspace(0.0, TOP, 7)
    few, many = campbell(operators, speeds, count), campbell(operators, speeds, 12)
    np.testing.assert_allclose(few.frequencies_hz, many.frequencies_hz[:, :count], rtol=2e-6)
    one, all_ = (solve_modes(operators, TOP, k).frequencies_hz for k in (count, 12))
    np.testing.assert_allclose(one, all_[:count], rtol=1e-9)


def test_sparse_and_dense_agree():
    operators = assemble(paper_plate(6, 3), Rotor(0.1, 0.4), FLAT)
    values = scipy.linalg.eigh(operators.at(TOP).toarray(), operators.mass.toarray(), eigvals_only=True)
    expected = np.sqrt(values[:20]) / (2.0 * np.pi)
    np.testing.assert_allclose(solve_modes(operators, TOP, 20).frequencies_hz, expected, rtol=1e-9)


@pytest.mark.parametrize("cells", [9, 15])
def test_a_soft_mode_does_not_drown_the_stiff_ones(cells):
    """Under a huge point mass one basis answers all speeds, as tightly as rounding lets each mode, and is right."""
    mesh, mass = rectangle(0.2, 0.45, cells, 3 * cells // 2), 1000.0 * STEEL.density * 0.2 * 0.45 * 3.5e-4
    plate = Plate(mesh, 3.5e-4, STEEL, mass, (0.2, 0.0))
    operators = assemble(plate, Rotor(0.0, -1.2), FLAT)
    speeds = np.linspace(0.2, 1.0, 20)
    found = campbell(operators, speeds, 5, tolerance=2e-7)
    assert len(found.sizes) == len(found.parts) == 1
    for row in (0, 9, 19):
        modes = solve_modes(operators, speeds[row], 5)
        uncertain = rounding(operators.at(speeds[row]), modes.shapes, modes.eigenvalues)
        assert (found.bounds[row] <= 2e-7 + 4.0 * uncertain).all()
        assert (np.abs(found.frequencies_hz[row] / modes.frequencies_hz - 1.0) <= found.bounds[row]).all()


def test_a_thousand_speeds_for_the_factors_of_one(monkeypatch):
    """As many factorisations as one static and one modal solve, on a mesh whose six frequencies are good to 1e-3.

    What that is in seconds, `python -m tests.benchmarks.track` tells.
    """
    factored = []
    plain = scipy.sparse.linalg.splu
    monkeypatch.setattr(scipy.sparse.linalg, "splu", lambda *a, **k: (factored.append(1), plain(*a, **k))[1])
    solve_modes(assemble(paper_plate(28, 11), Rotor(), FLAT), TOP, 6)
    one = len(factored)
    found = campbell(assemble(paper_plate(28, 11), Rotor(), FLAT), np.linspace(0.0, TOP, 1000), 6)
    assert len(factored) - one == one == 2
    assert found.bounds.max() <= 1e-6
    fine = solve_modes(assemble(paper_plate(42, 16), Rotor(), FLAT), 0.0, 6).frequencies_hz
    np.testing.assert_allclose(found.frequencies_hz[0], fine, rtol=1e-3)


def test_families_and_branches_through_a_crossing():
    """The paper's plate: lag falls through the second flap mode near 17000 rpm; each keeps its name and branch."""
    operators = assemble(paper_plate(), Rotor(), FLAT)
    found = campbell(operators, np.linspace(0.0, rpm(20000), 60), 4)
    assert found.families[0] == ["flap", "twist", "flap", "lag"]
    assert found.families[-1] == ["flap", "twist", "lag", "flap"]
    assert found.branches[-1].tolist() == [0, 1, 3, 2]
    assert found.veerings == ()
    names = np.array(found.families)
    for branch in range(4):
        assert len(set(names[found.branches == branch])) == 1


@pytest.mark.parametrize("halvings", [0, 6])
def test_what_no_basis_answers_is_solved_by_itself(monkeypatch, halvings):
    """A point mass of a thousand plates, and bases that may not grow: none answers the speeds between."""
    monkeypatch.setattr("fem.sweep.reduced_basis.HALVINGS", halvings)
    monkeypatch.setattr("fem.sweep.reduced_basis.LARGEST", 2)
    mass = 1000.0 * STEEL.density * 0.2 * 0.08 * 0.004
    plate = Plate(rectangle(0.2, 0.08, 6, 4).to_meshtri(), 0.004, STEEL, mass, (0.2, 0.0))
    operators = assemble(plate, Rotor(0.1, 0.5), FLAT, "kirchhoff/argyris")
    speeds = np.linspace(0.0, 16.2, 11)
    found = campbell(operators, speeds, 6)
    assert (found.bounds <= 1e-6).all()
    direct = np.array([solve_modes(operators, speed, 6).frequencies_hz for speed in speeds])
    assert (np.abs(found.frequencies_hz / direct - 1.0) <= found.bounds + 1e-10).all()
    assert len(found.parts) > 1
    assert found.shapes(10).shape == (operators.mass.shape[0], 6)
    assert np.array_equal(found.shapes(-1), found.shapes(10))
    assert not np.array_equal(found.shapes(-1), found.shapes(0))
    for number in (11, -12):
        with pytest.raises(IndexError, match="there are only 11 speeds"):
            found.shapes(number)


def test_follow_crossing_and_veering():
    """Two modes that exchange places pair off by likeness; two that mix half and half, or are coupled, are flagged."""
    eye, swap = np.eye(3), np.eye(3)[[1, 0, 2]]
    half = np.array([[0.5, 0.5, 0.0], [0.5, 0.5, 0.0], [0.0, 0.0, 1.0]])
    alone = lambda step: np.zeros((3, 3))  # noqa: E731
    branches, veerings = follow(np.stack([eye, swap, eye]), 2, alone)
    assert branches.tolist() == [[0, 1], [0, 1], [1, 0], [1, 0]]
    assert veerings == ()
    _, veerings = follow(np.stack([eye, swap]), 3, lambda step: np.full((3, 3), 1e-2))
    assert [(v.step, v.modes, v.likeness) for v in veerings] == [(1, (0, 1), (1.0, 1.0))]
    _, veerings = follow(np.stack([eye, half]), 3, alone)
    assert [(v.step, v.modes) for v in veerings] == [(1, (0, 1))]
    assert veerings[0].likeness == (0.5, 0.5)


def test_veering_is_flagged():
    """Under stagger flap and lag couple and veer; a step across the veering cannot tell who is who."""
    plate = Plate(rectangle(0.2, 0.02, 16, 2), 0.018, STEEL)
    operators = assemble(plate, Rotor(0.0, 0.6), FLAT)
    coarse = campbell(operators, np.array([0.0, rpm(22000)]), 2)
    fine = campbell(operators, np.linspace(0.0, rpm(40000), 400), 2)
    assert coarse.veerings
    assert not fine.veerings


@pytest.mark.parametrize(("speeds", "coriolis"), [(6, False), (101, False), (6, True), (21, True)])
def test_sharp_veering_is_flagged(speeds, coriolis):
    """The second flap and the first lag come within 0.9 Hz under stagger and cross without one."""
    plate = Plate(rectangle(0.3, 0.03, 12, 2), 0.002, STEEL)
    found = {}
    for stagger in (0.0, 0.6):
        operators = assemble(plate, Rotor(0.15, stagger), Effects(coriolis=coriolis))
        found[stagger] = campbell(operators, np.linspace(0.0, 1500.0, speeds), 6)
    assert (1, 2) in [v.modes for v in found[0.6].veerings]
    assert (1, 2) not in [v.modes for v in found[0.0].veerings]
    if not coriolis:  # which couples all of them a little
        assert found[0.0].veerings == ()
        assert len(found[0.6].veerings) == 1


@pytest.mark.parametrize(
    ("sides", "cells", "thickness", "stagger", "effects"),
    [
        ((1.0, 0.02), (12, 2), 0.001, 0.0, FLAT),  # stiffening and softening nearly cancel in the plane
        ((0.2, 0.08), (6, 4), 0.004, np.pi / 2, FLAT),  # 127 times the first frequency
        ((0.2, 0.08), (6, 4), 0.004, np.pi / 2, Effects(stress_stiffening=False)),
        ((0.02, 1.0), (2, 12), 0.001, 0.0, FLAT),  # below the first frequency
    ],
)
def test_critical_speed_is_the_dense_solver_s(monkeypatch, sides, cells, thickness, stagger, effects):
    monkeypatch.setattr("fem.linalg.LARGEST", (120, 10))
    operators = assemble(Plate(rectangle(*sides, *cells), thickness, STEEL), Rotor(stagger=stagger), effects)
    least = scipy.linalg.eigh(operators.spinning.toarray(), operators.stiffness.toarray(), eigvals_only=True)[0]
    assert critical_speed(operators) == pytest.approx((-least) ** -0.5, rel=1e-8)


def test_coriolis_forces_up_to_the_critical_speed():
    """Trial vectors beyond it have no stiffness: a coned plate, its frequencies by the dense solver of the states."""
    plate, rotor = Plate(rectangle(0.2, 0.03, 5, 1), 0.005, STEEL), Rotor(stagger=0.35, precone=0.7)
    operators = assemble(plate, rotor, Effects(stress_stiffening=False, coriolis=True))
    found = campbell(operators, np.linspace(0.0, 1.01 * critical_speed(operators), 8), 4)
    assert (found.omega.size, found.diverged.size) == (7, 1)
    for omega, frequencies in zip(found.omega, found.frequencies_hz, strict=True):
        np.testing.assert_allclose(2.0 * np.pi * frequencies, complex_rates(operators, omega)[:4], rtol=1e-6)


def test_no_critical_speed_is_soon_found(monkeypatch):
    """On a strip whose stiffening and softening nearly cancel."""
    monkeypatch.setattr("fem.linalg.LARGEST", (120, 10))
    operators = assemble(Plate(rectangle(1.0, 0.02, 24, 4), 0.001, STEEL), Rotor(), FLAT)
    assert critical_speed(operators) == np.inf


@pytest.mark.parametrize("near", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("coriolis", [False, True])
def test_modes_next_to_the_critical_speed_are_soon_found(monkeypatch, near, coriolis):
    """A frequency that vanishes: its inverse is 1e5 times the others', which drown in its rounding."""
    monkeypatch.setattr("fem.linalg.LARGEST", (60, 10))
    effects = Effects(stress_stiffening=False, coriolis=coriolis)
    operators = assemble(Plate(rectangle(0.2, 0.08, 6, 4), 0.004, STEEL), Rotor(stagger=np.pi / 2), effects)
    critical = critical_speed(operators)
    found = solve_modes(operators, (1.0 - near) * critical, 6).frequencies_hz
    before = solve_modes(operators, (1.0 - 2.0 * near) * critical, 6).frequencies_hz
    rest = solve_modes(operators, 0.0, 1)
    uncertain = rounding(operators.stiffness, np.abs(rest.shapes), rest.eigenvalues)[0]
    # Rounding the entries of K(Omega) moves its lowest eigenvalue, relative to that at rest, by a standard deviation of
    # a tenth of this, and so does the rounding of the critical speed. The eigenvalues should be 2 and 4 times `near`:
    # the root of their ratio is off by up to 3 * 0.1 * (1/2 + 1/4 + 1/4) / 2 of this over `near`.
    assert found[0] / before[0] == pytest.approx(np.sqrt(0.5), rel=1e-3 + 0.15 * uncertain / near)
    np.testing.assert_allclose(found[1:], before[1:], rtol=10.0 * near + 1e-9)


def test_lanczos_gives_up_with_a_word(monkeypatch):
    monkeypatch.setattr("fem.linalg.LARGEST", (4, 0))
    with pytest.raises(NotConverged, match="Lanczos vectors leave a residual"):
        solve_modes(assemble(paper_plate(8, 4), Rotor(), FLAT), 0.0, 3)


def test_critical_speed():
    """Softening without stiffening at right angles: divergence where Omega is the flap frequency at rest."""
    operators = assemble(paper_plate(8, 4), Rotor(stagger=np.pi / 2), Effects(stress_stiffening=False))
    rest = np.sqrt(solve_modes(operators, 0.0, 1).eigenvalues[0])
    critical = critical_speed(operators)
    assert critical == pytest.approx(rest, rel=1e-4)  # not all mass moves across the axis
    found = campbell(operators, np.linspace(0.0, 1.5 * critical, 31), 3)
    assert (found.omega < critical).all()
    assert (found.diverged >= (1.0 - 1e-8) * critical).all()
    assert found.omega.size + found.diverged.size == 31
    with pytest.raises(Divergence) as caught:
        campbell(operators, np.linspace(1.1, 2.0, 3) * critical, 3)
    assert caught.value.eigenvalue < 0.0
    below = solve_modes(operators, 0.99 * critical, 1).eigenvalues[0]
    assert 0.0 < below < 0.03 * rest**2
    with pytest.raises(Divergence) as caught:
        solve_modes(operators, 1.01 * critical, 1)
    assert (caught.value.count, caught.value.omega) == (1, 1.01 * critical)
    for effects in (FLAT, AT_REST):
        assert critical_speed(assemble(paper_plate(8, 4), Rotor(), effects)) == np.inf


def test_large_deflection_sweep():
    operators = assemble(Plate(rectangle(0.2, 0.08, 8, 4), 0.004, STEEL), Rotor(0.1, 0.7), BENT)
    speeds = np.linspace(0.0, rpm(12000), 5)
    found, alone = campbell(operators, speeds, 4), solve_modes(operators, speeds[-1], 4)
    np.testing.assert_allclose(found.frequencies_hz[-1], alone.frequencies_hz, rtol=1e-8)
    assert found.families[-1] == families(operators, alone)
