"""What keeps meshes from their order, held against finer meshes: the edge layer, point masses, large deflection."""

import numpy as np
import pytest
from fem_cases import AT_REST, BENT, FLAT, STEEL, builder, frequencies, promise_kept, rpm

from fem import Effects, Given, Material, Plate, Rectangle, Rotor, assemble, choose_mesh, rectangle, solve_modes
from fem.accuracy.edge_layer import drift, folds, layer_and_rest, unseen
from fem.accuracy.theory_selection import layers
from fem.accuracy.tolerances import FIRST, SURE, Budget

COUNT = 6
TIP = (0.2, 0.0)
ALUMINIUM, TITANIUM = Material(7e10, 0.33, 2700.0), Material(114e9, 0.33, 4430.0)
INSIDE = (0.24, 0.0345)


def with_mass(theory, size, thickness, mass):
    plate = Plate(Rectangle(0.2, 0.08).mesh(size), thickness, STEEL, mass, TIP)
    return assemble(plate, Rotor(), AT_REST, theory)


@pytest.mark.parametrize(
    ("theory", "thickness", "mass", "sizes"),
    [
        ("mindlin", 0.004, 0.05, (8, 12)),
        ("mindlin", 0.01, 0.1, (6, 9)),
        ("kirchhoff", 0.004, 0.05, (6, 9)),
        ("kirchhoff", 0.01, 0.1, (6, 9)),
    ],
)
def test_drift_under_a_point_mass(theory, thickness, mass, sizes):
    """Where the formula says that a frequency falls for ever, it falls by that much from mesh to mesh."""
    coarse, fine = (with_mass(theory, size, thickness, mass) for size in sizes)
    check_drift(coarse, fine, least=1e-4, rel=0.12)


def check_drift(coarse, fine, least, rel):
    """Of modes that fall by more than the least in e."""
    modes = solve_modes(fine, 0.0, COUNT)
    predicted = drift(fine, modes.eigenvalues, modes.shapes)
    found = (solve_modes(coarse, 0.0, COUNT).frequencies_hz / modes.frequencies_hz - 1.0) / np.log(1.5)
    assert (predicted > least).any()
    assert found[predicted > least] == pytest.approx(predicted[predicted > least], rel=rel)


def drawn_to_mass(size, at, effects=FLAT):
    plate = Plate(Rectangle(0.4, 0.12, node=at).mesh(size), 0.0045, ALUMINIUM, 0.2, at)
    return assemble(plate, Rotor(), effects, "mindlin")


def test_inside_a_plate_there_is_half_the_drift():
    """Of what falls as the logarithm, all but a few percent has order 2 or more: what is left of it between meshes."""
    check_drift(*(drawn_to_mass(size, INSIDE, AT_REST) for size in (10, 15)), least=5e-5, rel=0.25)


def test_a_spinning_mass_hardly_presses_across():
    """What pulls a mass back across is the tension, which goes with the slope: at a tip the first mode presses not."""
    at, top = (0.4, 0.0), rpm(6800)
    operators = drawn_to_mass(6, at)
    modes = solve_modes(operators, top, 1)
    rate = modes.frequencies_hz / solve_modes(drawn_to_mass(9, at), top, 1).frequencies_hz - 1.0
    found = drift(operators, modes.eigenvalues, modes.shapes, top)
    assert max(rate[0], found[0]) < 0.1 * drift(operators, modes.eigenvalues, modes.shapes)[0]


def test_a_mass_gives_way_to_its_own_pull():
    """Further out it pulls more: large deflection then drifts with the mesh, and linear theory does not know it."""
    at, top = (0.1, 0.0), rpm(19000)

    def build(size, bent):
        plate = Plate(Rectangle(0.1, 0.04).mesh(size), 0.0003, TITANIUM, 0.0006, at)
        return assemble(plate, Rotor(), Effects(large_deflection=bent), "mindlin")

    moved = []
    for size in (3, 6):
        operators = [build(size, large) for large in (False, True)]
        flat, bent = (solve_modes(each, top, COUNT) for each in operators)
        moved.append(bent.frequencies_hz / flat.frequencies_hz)
    found = np.abs(moved[1] - moved[0]) / np.log(2.0)
    predicted = drift(operators[1], flat.eigenvalues, flat.shapes, top)
    for mode in (2, 5):  # bent across their length, which hangs on where it ends
        assert predicted[mode] == pytest.approx(found[mode], rel=0.35)
    assert max(found[0], predicted[0]) < 2e-6


@pytest.mark.parametrize("size", [2, 4, 6])
def test_a_mass_is_on_a_node(size):
    """Wherever it is; a mass nearer to an edge than any line stays where the cells leave it."""
    form = Rectangle(0.4, 0.12, node=INSIDE)
    assert np.linalg.norm(form.mesh(size).p.T - INSIDE, axis=1).min() < 1e-12
    at_edge = Rectangle(0.4, 0.12, node=(0.3999, 0.0599)).mesh(size)
    np.testing.assert_array_equal(at_edge.p, Rectangle(0.4, 0.12).mesh(size).p)


def test_no_mass_no_drift():
    operators = with_mass("mindlin", 2, 0.004, 0.0)
    modes = solve_modes(operators, 0.0, 3)
    assert not drift(operators, modes.eigenvalues, modes.shapes).any()


@pytest.mark.parametrize(("mass", "met"), [(0.0, True), (0.05, False)])
def test_a_point_mass_is_not_said_to_converge(mass, met):
    form = Rectangle(0.2, 0.08)
    choice = choose_mesh(form, lambda size: with_mass("mindlin", size, 0.004, mass), (0.0,), COUNT, 3e-4)
    assert choice.met is met
    finer = 1.5
    limit = solve_modes(with_mass("mindlin", int(finer * choice.size), 0.004, mass), 0.0, COUNT).frequencies_hz
    true = np.abs(solve_modes(choice.operators, 0.0, COUNT).frequencies_hz / limit - 1.0)
    if mass:  # the limit is still on the way; the estimate goes down to a tenth of the thickness
        true *= folds(choice.operators.plate) / np.log(finer)
    assert true.max() / 3.0 <= choice.errors.max() <= 3.0 * true.max()


def test_half_of_the_layer_is_seen_by_cells_of_some_thicknesses():
    """4.7 fits plates of h/b from 1/70 to 1/700; ends: error of the fourth order, and all mass, 6 sqrt(2) / w."""
    assert unseen(4.7, 1.0) == pytest.approx(0.5, abs=0.01)
    assert unseen(1e3, 1.0) == pytest.approx(1.0 - 6.0 * np.sqrt(2.0 / 10.0) / 1e3, abs=1e-6)
    assert unseen(0.2, 1.0) / unseen(0.1, 1.0) == pytest.approx(16.0, rel=0.05)


def test_the_phase_of_a_complex_mode_says_nothing_of_its_layers():
    """At 1 rad/s Coriolis forces leave the modes at rest but for a factor of size 1; one is in the plane."""
    plate, found = Plate(rectangle(0.2, 0.08, 8, 4), 0.01, STEEL), []
    for coriolis, phase in ((False, 1.0), (True, np.exp(0.7j))):
        operators = assemble(plate, Rotor(0.1, 0.5), Effects(coriolis=coriolis), "mindlin")
        modes = solve_modes(operators, 1.0, 4)
        found.append(layers(operators, modes.eigenvalues, phase * modes.shapes))
    np.testing.assert_allclose(found[1], found[0], rtol=1e-4, atol=1e-8)


def test_a_row_of_elements_is_as_stiff_as_the_formula_says():
    """Forty quadratic elements for v'' = v, loaded at their end, assembled by scikit-fem."""
    from skfem import Basis, BilinearForm, ElementLineP2, MeshLine
    from skfem.helpers import dot, grad

    edge, thickness = 0.003, 0.001
    width = np.sqrt(10.0) * edge / thickness
    basis = Basis(MeshLine(np.linspace(0.0, 40.0 * width, 41)), ElementLineP2())
    matrix = BilinearForm(lambda u, v, _: dot(grad(u), grad(v)) + u * v).assemble(basis).toarray()
    end = basis.get_dofs(lambda x: x[0] == 0.0).all()[0]
    assert unseen(edge, thickness) == pytest.approx(1.0 - np.linalg.inv(matrix)[end, end], rel=1e-10)


@pytest.mark.parametrize("h_over_b", [1 / 70, 1 / 160])
def test_twist_is_off_by_what_the_layer_and_the_rest_leave(h_over_b):
    """Errors of three meshes of a thin plate divide into the layer's part, by its formula, and one of fourth order."""
    form, sizes = Rectangle(0.2, 0.04), (2, 3, 5)

    *found, limit = (
        frequencies(Plate(form.mesh(size), 0.04 * h_over_b, STEEL), effects=AT_REST) for size in (*sizes, 8)
    )
    true = found[-1] / limit - 1.0
    missed = tuple(unseen(form.edge(size), 0.04 * h_over_b) for size in sizes)
    apart = found[0] / found[1] - 1.0, found[1] / found[2] - 1.0
    estimate = layer_and_rest(apart, missed, sizes, 4.0)
    assert true.max() / 1.5 <= estimate.max() <= 1.5 * true.max()


@pytest.mark.parametrize(("slenderness", "tolerance", "finer"), [(200, 3e-4, 12), (700, 1e-3, 9)])
def test_thin_plates_with_shear_keep_the_promise(slenderness, tolerance, finer):
    """Meshes that miss the layer along the edges agree with each other, and are wrong by all of it."""
    form = Rectangle(0.2, 0.04)
    build = builder(form, 0.04 / slenderness, effects=AT_REST)
    promise_kept(choose_mesh(form, build, (0.0,), COUNT, tolerance), build, finer, tolerance)


def test_large_deflection_is_part_of_the_estimate():
    """Twisted by its load, a thin plate has other modes, whose errors are larger than those of the flat one."""
    form, top, tolerance = Rectangle(0.2, 0.2), rpm(4000), 1e-2
    build, unbent = (builder(form, 0.002, rotor=Rotor(0.0, np.pi / 4), effects=each) for each in (BENT, FLAT))
    true = promise_kept(choose_mesh(form, build, (top,), COUNT, tolerance), build, 5, tolerance)
    flat = choose_mesh(form, unbent, (top,), COUNT, tolerance)
    assert flat.errors.max() < true


def test_edges_of_given_meshes():
    """Cells of 2 cm by 1 cm: what is across a long side is 1 cm wide, halved when each edge is split in two."""
    assert Rectangle(0.2, 0.08).edge(1) == pytest.approx(0.08 / 2 * (2 / 2) ** 2, rel=1e-12)
    given = Given(rectangle(0.2, 0.08, 20, 4))
    assert given.edge(1) == pytest.approx(0.02)  # of 40 long edges and 8 short ones, most are along
    assert given.edge(2) == pytest.approx(0.01)
    assert Given(rectangle(0.2, 0.08, 20, 4).to_meshtri()).edge(1) == pytest.approx(0.02)


@pytest.mark.parametrize("asked", [1e-1, 1e-2, 1e-3, 1e-4, 1e-6])
def test_parts_make_no_more_than_the_whole(asked):
    """A mesh that takes the part of its tolerance that meshes take, beside any theory and effects left out."""
    budget = Budget(asked, asked)
    for part in (budget.thin, budget.sheared, budget.layers, budget.left_out, budget.rough_drive, budget.scattered):
        assert 0.0 < part < asked
    assert 1e-7 <= budget.basis <= max(1e-3 * asked, 1e-7)
    assert 0.0 < FIRST < SURE < 1.0
    for theory in np.linspace(0.0, budget.sheared, 7):
        for left_out in np.linspace(0.0, asked - theory, 7):
            mesh = budget.mesh(theory, left_out)
            assert 0.0 < mesh <= asked
            if theory + left_out <= 0.75 * asked * (1 - 1e-9):
                assert theory + left_out + min(FIRST, 0.65) * mesh <= asked * (1 + 1e-12)


def test_a_scene_s_budget_is_what_it_asks_for():
    from workflows.scene.load import load

    scene = load("paper").scene
    assert scene.budget == Budget(scene.accuracy.frequency, scene.accuracy.damping)
