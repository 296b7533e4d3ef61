"""The plate's modes as a ball in a cavity feels them."""

import numpy as np
import pytest
from fem_cases import paper_plate, rpm

from fem import (
    Divergence,
    Effects,
    Material,
    PlaceError,
    Plate,
    Rotor,
    assemble,
    campbell,
    modes_at,
    rectangle,
    reduce_over,
    solve_modes,
    with_point_mass,
)

TIP = (0.2, 0.0)


def at_rest(operators, at, count=6, mass=0.0):
    return modes_at(operators, campbell(operators, np.zeros(1), count), at, np.array([mass]))


def test_slender_cantilever():
    """Both first bending modes: w or v = 2/sqrt(m) at the tip and a slope of 1.37651/L, as a beam's."""
    plate = Plate(rectangle(1.0, 0.02, 40, 2), 0.01, Material(2e11, 0.0, 7850.0))
    found = at_rest(assemble(plate, Rotor(), Effects()), (1.0, 0.0), 3)
    mass = 7850.0 * 0.02 * 0.01
    for axis in range(2):
        k = int(np.argmax(np.abs(found.shape[0, axis]) / np.sqrt(found.stiffness[0])))
        assert abs(found.shape[0, axis, k]) * np.sqrt(mass) == pytest.approx(2.0, rel=2e-3)
        assert found.slope[0, axis, k] / found.shape[0, axis, k] == pytest.approx(1.376506, rel=3e-3)
        assert abs(found.shape[0, 1 - axis, k]) < 1e-9 * abs(found.shape[0, axis, k])


@pytest.mark.parametrize("effects", [Effects(), Effects(coriolis=True), Effects(large_deflection=True)])
def test_a_stuck_ball_is_a_low_rank_update(effects):
    """With the ball's inertia m phi'phi added, the frequencies are those of the plate with a point mass, solved afresh.

    Flap modes to second order in the mass ratio, 1 %; in-plane ones move along the radius too, where a cavity does not.
    """
    rotor, at = Rotor(0.05, 0.3), (0.18, 0.02)
    operators = assemble(paper_plate(8, 4), rotor, effects)
    omega, mass = np.array([rpm(3000), rpm(9000)]), 0.003
    found = modes_at(operators, campbell(operators, omega, 6), at, np.full(2, mass))
    still = assemble(paper_plate(8, 4), rotor, Effects(large_deflection=effects.large_deflection))
    for k in range(2):
        heavy = solve_modes(with_point_mass(still, at, mass), omega[k], 6)
        ridden = np.eye(6) + mass * found.shape[k].T @ found.shape[k]
        squares = np.sort(np.linalg.eigvals(np.linalg.solve(ridden, np.diag(found.stiffness[k]))).real)
        assert np.sqrt(squares[:3]) / (2 * np.pi) == pytest.approx(heavy.frequencies_hz[:3], rel=1e-4)


def test_reduced_parameters_are_a_view_of_it():
    """Of the mode that yields most along z: M2 and slope of `reduce_over`, but for what the ball's pull does to the
    shape (of the order of the mass ratio, 0.006), and its frequency with the ball stuck, to the second order."""
    operators = assemble(paper_plate(8, 4), Rotor(), Effects())
    diagram = campbell(operators, np.array([0.0, rpm(10000), rpm(17500)]), 6)
    reduced = reduce_over(operators, diagram, TIP, mass_ratio=0.006)
    found = modes_at(operators, diagram, TIP, np.array([r.ball_mass for r in reduced]))
    for k, r in enumerate(reduced):
        first = int(np.argmax(found.shape[k, 0] ** 2 / found.stiffness[k]))
        assert found.shape[k, 0, first] ** -2 == pytest.approx(r.M2, rel=2e-3)
        assert found.slope[k, 0, first] / found.shape[k, 0, first] == pytest.approx(r.slope, rel=2e-3)
        stuck = found.stiffness[k, first] / (1.0 + r.ball_mass * found.shape[k, 0, first] ** 2)
        assert np.sqrt(stuck) / (2 * np.pi) == pytest.approx(r.f1_hz, rel=1e-4)


def test_twist_moves_a_cavity_off_the_centre_line():
    operators = assemble(paper_plate(8, 4), Rotor(), Effects())
    diagram = campbell(operators, np.zeros(1), 6)
    twist = diagram.families[0].index("twist")
    found = [modes_at(operators, diagram, (0.2, y), np.zeros(1)).shape[0, 0, twist] for y in (-0.03, 0.0, 0.03)]
    assert found[0] == pytest.approx(-found[2], rel=1e-9)
    assert abs(found[1]) < 1e-9 * abs(found[0])


def test_a_thousand_speeds_agree_with_each_by_itself():
    operators = assemble(paper_plate(8, 4), Rotor(0.1, 0.5), Effects())
    omega = np.linspace(0.0, rpm(15000), 200)
    masses = np.linspace(0.001, 0.004, 200)
    found = modes_at(operators, campbell(operators, omega, 4), TIP, masses)
    for k in (3, 120):
        alone = modes_at(operators, campbell(operators, omega[[k]], 4), TIP, masses[[k]])
        assert alone.stiffness[0] == pytest.approx(found.stiffness[k], rel=1e-6)
        assert np.abs(alone.slope[0]) == pytest.approx(np.abs(found.slope[k]), rel=1e-3, abs=1e-3)


def test_places_off_the_plate_and_lost_stiffness():
    operators = assemble(paper_plate(8, 4), Rotor(0.0, np.pi / 2), Effects(stress_stiffening=False))
    with pytest.raises(PlaceError):
        at_rest(operators, (0.3, 0.0))
    with pytest.raises(Divergence):
        modes_at(operators, campbell(operators, np.array([rpm(9000)]), 4), TIP, np.array([5.0]))
