"""The mesh chosen for a tolerance: that it keeps its promise, and costs little more than it must."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from fem_cases import AT_REST, FLAT, STEEL, builder, frequencies, promise_kept, rpm
from scipy.optimize import fsolve

from fem import Divergence, Given, Material, Plate, Rectangle, Rotor, choose_mesh, rectangle, solve_modes
from fem.accuracy.theory_selection import theory_errors
from fem.meshes.mesh_sequence import crowded, root_order
from fem.theory import mindlin
from fem.theory.registry import THEORIES

COUNT = 6


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize(
    ("length", "width", "thickness", "theory"),
    [
        (0.2, 0.08, 0.01, "mindlin"),
        (0.2, 0.08, 0.01, "kirchhoff"),
        (0.3, 0.05, 0.001, "mindlin"),
        (0.1, 0.2, 0.004, "mindlin"),
        (0.1, 0.1, 0.0005, "kirchhoff"),
    ],
)
def test_keeps_its_promise(length, width, thickness, theory, tolerance):
    """True errors, against a finer mesh's limit, are within the tolerance and a factor of three of the estimates."""
    planform, build = built(length, width, thickness, theory)
    choice = choose_mesh(planform, build, (0.0, rpm(9000)), COUNT, tolerance)
    promise_kept(choice, build, -(-4 * choice.size // 3), tolerance, order=4)


@cache
def built(length, width, thickness, theory):
    """A planform and what builds its meshes, each once for all tolerances."""
    planform = Rectangle(length, width)
    return planform, cache(builder(planform, thickness, theory))


@pytest.mark.parametrize(
    ("length", "thickness", "top"), [(0.2, 0.0006, 5000), (0.17, 0.0006, 5000), (0.37, 0.0007, 4000)]
)
def test_two_meshes_that_hardly_resolve_a_stiffened_plate_are_doubted(length, thickness, top):
    """Chordwise modes under tension fall by half between meshes that a bending mode falls by four between."""
    form, omega = Rectangle(length, 0.1), rpm(top)
    build = builder(form, thickness, "kirchhoff")
    choice = choose_mesh(form, build, (omega,), 6, 1e-3)
    limit = solve_modes(build(10), omega, 6).frequencies_hz
    true = np.abs(solve_modes(choice.operators, omega, 6).frequencies_hz / limit - 1.0)
    assert (true <= 1.2 * choice.errors[0] + 1e-6).all()


def test_no_mesh_is_built_twice_and_none_is_far_finer_than_needed():
    log = []
    planform = Rectangle(0.2, 0.08)
    build = builder(planform, 0.01, log=log, effects=AT_REST)
    choice = choose_mesh(planform, build, (0.0,), COUNT, 1e-4)
    assert len(log) == len(set(log)) <= 4
    assert max(log) == choice.size
    coarser = planform.sizes[planform.sizes.index(choice.size) - 3]
    found, limit = (solve_modes(build(size), 0.0, COUNT).frequencies_hz for size in (coarser, 2 * choice.size))
    assert np.abs(found / limit - 1.0).max() > 1e-4


def test_a_given_mesh_is_split_until_it_is_fine_enough():
    planform = Given(rectangle(0.2, 0.08, 5, 2).to_meshtri())
    loose, tight = (choose_mesh(planform, builder(planform, 0.01), (0.0,), 2, t) for t in (5e-2, 5e-3))
    assert loose.size < tight.size
    assert tight.met
    limit = frequencies(Plate(Rectangle(0.2, 0.08).mesh(8), 0.01, STEEL), effects=AT_REST, count=2)
    true = np.abs(solve_modes(tight.operators, 0.0, 2).frequencies_hz / limit - 1.0)
    assert true.max() < 5e-3


def test_a_large_given_mesh_is_taken_as_it_is(monkeypatch):
    monkeypatch.setattr("fem.meshes.mesh_sequence.MOST_CELLS", 10)
    planform = Given(rectangle(0.2, 0.08, 5, 2))
    choice = choose_mesh(planform, builder(planform, 0.01), (0.0,), 2, 1e-3)
    assert choice.size == 1
    assert np.isnan(choice.errors).all()
    assert not choice.met


def test_another_theory_needs_its_record_alone(monkeypatch):
    """Mindlin's by another name: the same mesh, frequencies and errors of mesh and theory."""

    def by_another_name(plate, rotary_inertia, element):
        return replace(mindlin.discretise(plate, rotary_inertia), theory="another")

    monkeypatch.setitem(THEORIES, "another", replace(THEORIES["mindlin"], discretise=by_another_name, elements=()))
    planform, found = Rectangle(0.2, 0.08), []
    for theory in ("mindlin", "another"):
        choice = choose_mesh(planform, builder(planform, 0.01, theory), (0.0,), 2, 1e-2)
        modes = solve_modes(choice.operators, 0.0, 2)
        errors = theory_errors(choice.operators, modes.eigenvalues, modes.shapes)
        found.append((choice.operators.model.theory, choice.size, choice.errors, modes.frequencies_hz, errors))
    (_, size, *numbers), (name, other, *others) = found
    assert (name, other) == ("another", size)
    assert all(np.array_equal(one, two) for one, two in zip(numbers, others, strict=True))


def test_the_finest_is_taken_where_none_will_do(monkeypatch):
    monkeypatch.setitem(THEORIES, "mindlin", replace(THEORIES["mindlin"], most_unknowns=3000))
    planform = Rectangle(0.2, 0.08)
    choice = choose_mesh(planform, builder(planform, 0.01), (0.0,), 2, 1e-7)
    assert not choice.met
    assert choice.operators.mass.shape[0] <= 3000


def test_divergence_at_the_highest_speed_leaves_the_lowest():
    rotor, planform = Rotor(stagger=np.pi / 2), Rectangle(0.2, 0.2)
    soft, unstiffened = Material(2e9, 0.3, 7850.0), replace(FLAT, stress_stiffening=False)
    build = builder(planform, 0.001, rotor=rotor, effects=unstiffened, material=soft)
    choice = choose_mesh(planform, build, (0.0, rpm(20000)), 2, 1e-2)
    assert choice.probes.tolist() == [0.0]
    with pytest.raises(Divergence):
        choose_mesh(planform, build, (rpm(20000),), 2, 1e-2)


def test_a_speed_at_which_only_the_finer_meshes_have_modes(monkeypatch):
    """Its errors are not known until two meshes have modes there; until then the choice is not met."""
    import fem.accuracy.error_estimates

    planform, probe = Rectangle(0.2, 0.08), fem.accuracy.error_estimates.probe

    def gone(operators, *given):
        return probe(operators, *given)[: 1 if operators.mass.shape[0] < 300 else 2]

    monkeypatch.setattr("fem.accuracy.error_estimates.probe", gone)
    speeds = 0.0, rpm(9000)
    choice = choose_mesh(planform, builder(planform, 0.01), speeds, 2, 1e-2)
    assert choice.met
    assert choice.errors.shape == (2, 2)
    monkeypatch.setitem(THEORIES, "mindlin", replace(THEORIES["mindlin"], most_unknowns=800))
    choice = choose_mesh(planform, builder(planform, 0.01), speeds, 2, 1e-5)
    assert not choice.met
    assert choice.errors.shape[0] == 1 or np.isnan(choice.errors[1]).all()


def test_coarse_bricks_of_a_thin_plate_are_not_believed():
    """One cell's width apart they differ by a tenth of their error: they converge slowly until they are fine."""
    planform = Rectangle(0.1, 0.1)
    build = builder(planform, 0.004, "solid", effects=AT_REST)
    promise_kept(choose_mesh(planform, build, (0.0,), 3, 2e-2), build, 5, 2e-2)


def test_a_coarse_mesh_that_diverges_is_not_believed():
    """Near the critical speed of a thin plate in its plane of rotation, 28 Hz are left, none on the coarsest mesh."""
    planform = Rectangle(0.2, 0.1)
    build = builder(planform, 0.001, rotor=Rotor(0.0, np.pi / 2))
    with pytest.raises(Divergence):
        solve_modes(build(1), 9500.0, 2)
    build = cache(build)
    for speeds in ((0.0, 9500.0), (9500.0,)):
        choice = choose_mesh(planform, build, speeds, 2, 5e-2)
        np.testing.assert_allclose(choice.probes, speeds)
        promise_kept(choice, build, 8, 5e-2)


def test_corners_that_point_inwards():
    mesh = rectangle(0.2, 0.1, 8, 6)
    x, y = mesh.p[:, mesh.t].mean(axis=1)
    planform = Given(mesh.remove_elements(np.flatnonzero((np.abs(y) < 0.017) & (x > 0.06) & (x < 0.14))))
    build = builder(planform, 0.005, effects=AT_REST)
    promise_kept(choose_mesh(planform, build, (0.0,), COUNT, 1.5e-2), build, 4, 1.5e-2)


def test_errors_between_probes():
    planform = Rectangle(0.2, 0.08)
    choice = choose_mesh(planform, builder(planform, 0.01), (0.0, 100.0), 3, 1e-2)
    np.testing.assert_allclose(choice.errors_at(50.0), 0.75 * choice.errors[0] + 0.25 * choice.errors[1])


def test_sizes_are_multiples_of_one_grid():
    planform = Rectangle(0.2, 0.08)
    assert [planform.cells(size) for size in (1, 2, 7)] == [(5, 2), (10, 4), (35, 14)]
    x, y = planform.mesh(4).p
    assert (x.min(), x.max(), y.min(), y.max()) == (0.0, 0.2, -0.04, 0.04)
    np.testing.assert_allclose(crowded(4), [-1.0, -0.75, 0.0, 0.75, 1.0])


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
@pytest.mark.parametrize("degrees", [100.0, 115.0, 135.0, 160.0])
def test_the_order_at_a_blunt_corner_of_the_root(nu, degrees):
    """Just below twice the least real part of the roots of Williams' equation for a clamped and a free edge."""
    angle = np.radians(degrees)

    def mismatch(parts):
        k = complex(*parts)
        wrong = np.sin(k * angle) ** 2 - (4.0 - (k * (1.0 - nu) * np.sin(angle)) ** 2) / ((3.0 + nu) * (1.0 - nu))
        return wrong.real, wrong.imag

    tried = [fsolve(mismatch, (re, im), full_output=True) for re in np.linspace(0.3, 1.2, 10) for im in (0.1, 0.4)]
    least = min(found[0] for found, _, converged, _ in tried if converged == 1 and found[0] > 0.1)
    assert 0.88 * 2.0 * least < root_order(angle) < 2.0 * least
    assert root_order(0.5 * np.pi) == np.inf
