"""What keeps meshes from their order, held against finer meshes: the edge layer, point masses, large deflection."""

import numpy as np
import pytest
from fem_cases import STEEL, rpm

from fem import Effects, Given, Plate, Rectangle, Rotor, assemble, choose_mesh, rectangle, solve_modes
from fem.singular import drift, unseen

COUNT = 6
TIP = (0.2, 0.0)


def with_mass(theory, size, thickness, mass):
    plate = Plate(Rectangle(0.2, 0.08).mesh(size), thickness, STEEL, mass, TIP)
    return assemble(plate, Rotor(), Effects(), theory)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff"])
@pytest.mark.parametrize(("thickness", "mass"), [(0.004, 0.05), (0.01, 0.1)])
def test_drift_under_a_point_mass(theory, thickness, mass):
    """Where the formula says that a frequency falls for ever, it falls by that much from mesh to mesh."""
    coarse, fine = (with_mass(theory, size, thickness, mass) for size in (8, 16))
    modes = solve_modes(fine, 0.0, COUNT)
    predicted = drift(fine, modes)
    found = (solve_modes(coarse, 0.0, COUNT).frequencies_hz / modes.frequencies_hz - 1.0) / np.log(2.0)
    for_ever = predicted > 1e-4
    assert for_ever.any()
    assert found[for_ever] == pytest.approx(predicted[for_ever], rel=0.12)


def test_no_mass_no_drift():
    operators = with_mass("mindlin", 2, 0.004, 0.0)
    assert not drift(operators, solve_modes(operators, 0.0, 3)).any()


@pytest.mark.parametrize(("mass", "met"), [(0.0, True), (0.05, False)])
def test_a_point_mass_is_not_said_to_converge(mass, met):
    form = Rectangle(0.2, 0.08)
    choice = choose_mesh(form, lambda size: with_mass("mindlin", size, 0.004, mass), (0.0,), COUNT, 1e-4)
    assert choice.met is met
    limit = solve_modes(with_mass("mindlin", 2 * choice.size, 0.004, mass), 0.0, COUNT).frequencies_hz
    true = np.abs(solve_modes(choice.operators, 0.0, COUNT).frequencies_hz / limit - 1.0)
    assert true.max() / 3.0 <= choice.errors.max() <= 3.5 * true.max()


def test_half_of_the_layer_is_seen_by_cells_of_some_thicknesses():
    assert unseen(0.0, 1.0) == 0.0
    assert unseen(4.7, 1.0) == pytest.approx(0.5)
    assert unseen(1e3, 1.0) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("slenderness", [200, 700])
@pytest.mark.parametrize("tolerance", [1e-3, 3e-4])
def test_thin_plates_with_shear_keep_the_promise(slenderness, tolerance):
    """Meshes that miss the layer along the edges agree with each other, and are wrong by all of it."""
    form = Rectangle(0.2, 0.04)

    def build(size):
        return assemble(Plate(form.mesh(size), 0.04 / slenderness, STEEL), Rotor(), Effects(), "mindlin")

    choice = choose_mesh(form, build, (0.0,), COUNT, tolerance)
    limit = solve_modes(build(16), 0.0, COUNT).frequencies_hz
    true = np.abs(solve_modes(choice.operators, 0.0, COUNT).frequencies_hz / limit - 1.0)
    assert true.max() <= tolerance
    assert true.max() / 3.0 <= choice.errors.max() <= 3.5 * true.max()


def test_large_deflection_is_part_of_the_estimate():
    """Twisted by its load, a thin plate has other modes, whose errors are larger than those of the flat one."""
    form, top, tolerance = Rectangle(0.2, 0.2), rpm(4000), 1e-2

    def build(size, effects=Effects(large_deflection=True)):  # noqa: B008
        return assemble(Plate(form.mesh(size), 0.002, STEEL), Rotor(0.0, np.pi / 4), effects, "mindlin")

    choice = choose_mesh(form, build, (top,), COUNT, tolerance)
    limit = solve_modes(build(8), top, COUNT).frequencies_hz
    true = np.abs(solve_modes(choice.operators, top, COUNT).frequencies_hz / limit - 1.0)
    assert choice.met
    assert true.max() <= tolerance
    assert true.max() / 3.0 <= choice.errors.max() <= 3.5 * true.max()
    flat = choose_mesh(form, lambda size: build(size, Effects()), (top,), COUNT, tolerance)
    assert 3.0 * flat.errors.max() < true.max()


def test_edges_of_given_meshes():
    """Cells of 2 cm by 1 cm: what is across a long side is 1 cm wide, halved when each edge is split in two."""
    assert Rectangle(0.2, 0.08).edge(1) == pytest.approx(0.08 / 2 * (2 / 2) ** 2, rel=1e-12)
    given = Given(rectangle(0.2, 0.08, 20, 4))
    assert given.edge(1) == pytest.approx(0.02)  # of 40 long edges and 8 short ones, most are along
    assert given.edge(2) == pytest.approx(0.01)
    assert Given(rectangle(0.2, 0.08, 20, 4).to_meshtri()).edge(1) == pytest.approx(0.02)
