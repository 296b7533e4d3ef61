"""The plate as one mass and one spring at the damper's place."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from fem_cases import BENT, FLAT, STEEL, STRIP, beam, paper_plate, rpm
from skfem import MeshTri

from fem import (
    Divergence,
    Effects,
    Material,
    PlaceError,
    Plate,
    Rectangle,
    Rotor,
    assemble,
    campbell,
    modes_at,
    rectangle,
    reduce_at,
    reduce_over,
    solve_modes,
    with_point_mass,
)
from fem.meshes.thickness import Bilinear, Polynomial
from fem.reduction.single_mode import Reduction, _Family

TIP = (0.2, 0.0)
CORIOLIS = Effects(coriolis=True)


def test_stuck_ball_at_rest_is_a_mass_on_a_spring():
    """To first order in the mass ratio K1 = K2; the second order is what the mode's shape gives."""
    small, large = (reduce_at(on(FLAT), 0.0, TIP, mass_ratio=ratio) for ratio in (0.006, 0.6))
    assert abs(small.K1 / small.K2 - 1.0) < 1e-5
    assert abs(large.K1 / large.K2 - 1.0) < 1e-2
    assert pytest.approx(1.006 * small.M2, rel=1e-12) == small.M1


ROTOR = Rotor(0.05, 0.3)


@cache
def on(effects, rotor=ROTOR):
    """The paper's plate."""
    return assemble(paper_plate(8, 4), rotor, effects)


def laden(effects, at, mass, omega):
    """Frequencies with a point mass, solved afresh without Coriolis forces."""
    still = with_point_mass(on(replace(effects, coriolis=False)), at, mass)
    return solve_modes(still, omega, 6).frequencies_hz


@pytest.mark.parametrize("effects", [FLAT, CORIOLIS, BENT])
@pytest.mark.parametrize("ratio", [0.006, 1.0, 20.0])
def test_stuck_ball_is_a_point_mass(effects, ratio):
    """omega_1 is the frequency of the plate with that mass; heavier than the plate too."""
    omega = rpm(9000)
    found = reduce_at(on(effects), omega, TIP, mass_ratio=ratio)
    assert np.abs(laden(effects, TIP, found.ball_mass, omega) / found.f1_hz - 1.0).min() < 1e-8
    assert pytest.approx((2 * np.pi * found.f1_hz) ** 2 * found.M1, rel=1e-12) == found.K1
    assert pytest.approx((2 * np.pi * found.f2_hz) ** 2 * found.M2, rel=1e-12) == found.K2


def test_mass_and_ratio_are_two_ways_to_say_it():
    operators = on(FLAT)
    by_ratio = reduce_at(operators, 500.0, TIP, mass_ratio=0.01)
    assert reduce_at(operators, 500.0, TIP, ball_mass=by_ratio.ball_mass) == by_ratio
    known = reduce_at(operators, 500.0, TIP, mass_ratio=0.01, modes=solve_modes(operators, 500.0, 4))
    assert known.f1_hz == pytest.approx(by_ratio.f1_hz, rel=1e-10)
    none = reduce_at(operators, 500.0, TIP, ball_mass=0.0)
    assert none.f1_hz == none.f2_hz


def test_floor_tilt():
    """Omega² r phi_x / omega_1²: zero at rest, near one for the paper's plate at its top speed."""
    operators = on(FLAT, Rotor())
    assert reduce_at(operators, 0.0, TIP, mass_ratio=0.006).floor_tilt == 0.0
    fast = reduce_at(operators, rpm(17500), TIP, mass_ratio=0.006)
    expected = rpm(17500) ** 2 * 0.2 * fast.slope / (2 * np.pi * fast.f1_hz) ** 2
    assert fast.floor_tilt == pytest.approx(expected, rel=1e-12)
    assert 0.7 < fast.floor_tilt < 0.9


@pytest.mark.parametrize(
    ("rotor", "effects", "count"),
    [
        (Rotor(), FLAT, 100),
        (Rotor(0.1, 0.5), FLAT, 100),
        (Rotor(0.1, 0.5), CORIOLIS, 20),
        (Rotor(0.1, 0.5), BENT, 3),
    ],
)
@pytest.mark.parametrize("mass", [{"mass_ratio": 0.006}, {"ball_mass": 2.0}, {"ball_mass": 0.0}])
def test_over_speeds_as_at_each(rotor, effects, count, mass):
    """A sweep answers what each speed by itself does, heavy balls included."""
    operators, diagram = swept(rotor, effects, count)
    found = reduce_over(operators, diagram, TIP, **mass)
    assert len(found) == count
    for k in (0, count // 3, count - 1):
        alone = reduce_at(operators, float(diagram.omega[k]), TIP, **mass)
        for name in ("f1_hz", "M1", "K1", "f2_hz", "M2", "K2", "ball_mass", "slope", "floor_tilt"):
            assert getattr(found[k], name) == pytest.approx(getattr(alone, name), rel=1e-5), name
        assert found[k].f1_hz == pytest.approx(alone.f1_hz, rel=1e-6)


@cache
def swept(rotor, effects, count):
    return on(effects, rotor), campbell(on(effects, rotor), np.linspace(0.0, rpm(17500), count), 4)


@pytest.mark.parametrize("cells", [5, 7, 9])
def test_over_speeds_solves_no_more_for_rounding(monkeypatch, cells):
    """What rounding leaves between a speed solved and one in between is none the less for more speeds solved."""
    solved = []
    plain = _Family.solved
    monkeypatch.setattr(_Family, "solved", lambda self, k, mass: (solved.append(k), plain(self, k, mass))[1])
    mesh = rectangle(0.00345, 0.00305, cells, cells).to_meshtri()
    plate = Plate(mesh, 1e-6, Material(6.13e9, -0.4144, 434.0), 1.83e-10, (0.00345, 0.0))
    operators = assemble(plate, Rotor(0.01325, -0.6685), Effects(), "kirchhoff")
    diagram = campbell(operators, np.linspace(0.14, 0.71, 101), 4)
    found = reduce_over(operators, diagram, np.array([0.00345, 0.0]), mass_ratio=1.5e-3)
    assert len(solved) <= 24
    for k in (0, 37, 100):
        one = reduce_at(operators, float(diagram.omega[k]), (0.00345, 0.0), mass_ratio=1.5e-3)
        assert found[k].f1_hz == pytest.approx(one.f1_hz, rel=1e-7)
        assert pytest.approx(one.M1, rel=1e-5) == found[k].M1


def at_rest(operators, at, count=6, mass=0.0):
    return modes_at(operators, campbell(operators, np.zeros(1), count), at, np.array([mass]))


def test_modes_of_a_slender_cantilever():
    """Both first bending modes: w or v = 2/sqrt(m) at the tip and a slope of 1.37651/L, as a beam's."""
    plate = Plate(rectangle(1.0, 0.02, 40, 2), 0.01, STRIP)
    found = at_rest(assemble(plate, Rotor(), FLAT), (1.0, 0.0), 3)
    mass = 7850.0 * 0.02 * 0.01
    for axis in range(2):
        k = int(np.argmax(np.abs(found.shape[0, axis]) / np.sqrt(found.stiffness[0])))
        assert abs(found.shape[0, axis, k]) * np.sqrt(mass) == pytest.approx(2.0, rel=2e-3)
        assert found.slope[0, axis, k] / found.shape[0, axis, k] == pytest.approx(1.376506, rel=3e-3)
        assert abs(found.shape[0, 1 - axis, k]) < 1e-9 * abs(found.shape[0, axis, k])


@pytest.mark.parametrize("effects", [FLAT, CORIOLIS, BENT])
def test_a_stuck_ball_is_a_low_rank_update(effects):
    """With the ball's inertia m phi'phi added, the frequencies are those of the plate with a point mass.

    Flap modes to second order in the mass ratio, 1 %; in-plane ones move along the radius too, where a cavity does not.
    """
    at, omega, mass = (0.18, 0.02), rpm(np.array([3000, 9000])), 0.003
    found = modes_at(on(effects), campbell(on(effects), omega, 6), at, np.full(2, mass))
    for k in range(2):
        ridden = np.eye(6) + mass * found.shape[k].T @ found.shape[k]
        squares = np.sort(np.linalg.eigvals(np.linalg.solve(ridden, np.diag(found.stiffness[k]))).real)
        assert np.sqrt(squares[:3]) / (2 * np.pi) == pytest.approx(laden(effects, at, mass, omega[k])[:3], rel=1e-4)


def test_reduced_parameters_are_a_view_of_it():
    """Of the mode that yields most along z: M2 and slope of `reduce_over`, but for what the ball's pull does to the
    shape (of the order of the mass ratio, 0.006), and its frequency with the ball stuck, to the second order."""
    operators = on(FLAT, Rotor())
    diagram = campbell(operators, rpm(np.array([0, 10000, 17500])), 6)
    reduced = reduce_over(operators, diagram, TIP, mass_ratio=0.006)
    found = modes_at(operators, diagram, TIP, np.array([r.ball_mass for r in reduced]))
    for k, r in enumerate(reduced):
        first = int(np.argmax(found.shape[k, 0] ** 2 / found.stiffness[k]))
        assert found.shape[k, 0, first] ** -2 == pytest.approx(r.M2, rel=2e-3)
        assert found.slope[k, 0, first] / found.shape[k, 0, first] == pytest.approx(r.slope, rel=2e-3)
        stuck = found.stiffness[k, first] / (1.0 + r.ball_mass * found.shape[k, 0, first] ** 2)
        assert np.sqrt(stuck) / (2 * np.pi) == pytest.approx(r.f1_hz, rel=1e-4)


def test_twist_moves_a_cavity_off_the_centre_line():
    operators = on(FLAT)
    diagram = campbell(operators, np.zeros(1), 6)
    twist = diagram.families[0].index("twist")
    found = [modes_at(operators, diagram, (0.2, y), np.zeros(1)).shape[0, 0, twist] for y in (-0.03, 0.0, 0.03)]
    assert found[0] == pytest.approx(-found[2], rel=1e-9)
    assert abs(found[1]) < 1e-9 * abs(found[0])


@pytest.mark.parametrize("rotor", [Rotor(0.05), Rotor(0.05, 0.5), Rotor(0.05, 0.5, 0.4)])
@pytest.mark.parametrize("at", [(0.14, 0.001), (0.13, 0.033)])
def test_the_floor_tilts_against_the_load_wherever_it_points(rotor, at):
    """By the centrifugal energy of a ball on a floor that bends with the plate, from displacements near by."""
    operators = on(FLAT, rotor)
    shapes, h, place = campbell(operators, np.zeros(1), 6).shapes(0), 1e-4, np.array(at)

    def moved(x, y):
        return operators.at_place((float(x), float(y))).rows[0] @ shapes

    spun, arm = rotor.projector, operators.from_axis(at)
    outwards = spun @ arm / np.linalg.norm(spun @ arm)
    first = np.eye(3)[2] - outwards[2] * outwards
    along, across = ((moved(*(place + d)) - moved(*(place - d))) / (2 * h) for d in h * np.eye(2))
    found, (u, v) = operators.at_place(at).floor @ shapes, (found_axes := operators.at_place(at).axes)[:2]
    assert u == pytest.approx(first / np.linalg.norm(first))
    assert [u @ v, v @ outwards, np.linalg.det(found_axes)] == pytest.approx([0.0, 0.0, -1.0], abs=1e-12)
    for k, axis in enumerate((u, v)):
        turned = axis[0] * along + axis[1] * across - axis[2] * np.array([along[2], across[2], 0.0 * along[2]])

        def energy(floor, lift, turned=turned, axis=axis):
            ball = arm[:, None] + lift * moved(*at) + floor * (axis[:, None] + lift * turned)
            return 0.5 * ((spun @ ball) ** 2).sum(axis=0)

        mixed = (energy(1, 1) - energy(1, -1) - energy(-1, 1) + energy(-1, -1)) / 4
        drawn = axis @ spun @ moved(*at) - np.linalg.norm(spun @ arm) * found[2 + k]
        assert mixed == pytest.approx(drawn, rel=1e-5, abs=1e-5 * np.abs(mixed).max())
        assert found[k] == pytest.approx(axis @ moved(*at), abs=1e-12 * np.abs(found[k]).max())


def test_many_speeds_agree_with_each_by_itself():
    operators, diagram = swept(Rotor(0.1, 0.5), FLAT, 100)
    masses = np.linspace(0.001, 0.004, 100)
    found = modes_at(operators, diagram, TIP, masses)
    for k in (3, 60):
        alone = modes_at(operators, campbell(operators, diagram.omega[[k]], 4), TIP, masses[[k]])
        assert alone.stiffness[0] == pytest.approx(found.stiffness[k], rel=1e-6)
        assert np.abs(alone.slope[0]) == pytest.approx(np.abs(found.slope[k]), rel=1e-3, abs=1e-3)


def test_places_off_the_plate_and_lost_stiffness():
    operators = assemble(paper_plate(8, 4), Rotor(0.0, np.pi / 2), Effects(stress_stiffening=False))
    with pytest.raises(PlaceError):
        at_rest(operators, (0.3, 0.0))
    with pytest.raises(Divergence):
        modes_at(operators, campbell(operators, np.array([rpm(9000)]), 4), TIP, np.array([5.0]))


@pytest.mark.parametrize(
    ("theory", "heights", "speed"),
    [
        *(("mindlin", heights, 600.0) for heights in ((0.004, 0.004), (0.006, 0.002), (0.003, 0.006))),
        *(("mindlin", (0.004, 0.004), speed) for speed in (0.0, 1500.0)),
        *((theory, (0.006, 0.002), 1500.0) for theory in ("kirchhoff", "solid")),
        ("mindlin", (0.001, 0.001), 1680.0),
    ],
)
def test_strain_of_the_root(theory, heights, speed):
    """A narrow plate is a beam: one that tapers is not strained most at its root, and one that turns bends there."""
    length, width, hub, at = 0.2, 0.02, 0.1, 0.17
    thickness = Polynomial(((heights[0],), ((heights[1] - heights[0]) / length,)))
    plate = Plate(rectangle(length, width, 48, 2), thickness, STEEL)
    operators = assemble(plate, Rotor(hub_radius=hub), FLAT, theory)
    found = Reduction(operators, campbell(operators, [speed], 4), (at, 0.0))
    hertz, strain, motion = beam(length, lambda x: np.interp(x, (0.0, length), heights), at, speed, hub)
    assert found.with_ball(ball_mass=0.0)[0].f2_hz == pytest.approx(hertz, rel=0.02)
    bends, moves = found.bending(0)
    assert bends == pytest.approx(strain.max(), rel=0.05)
    assert moves == pytest.approx(motion, rel=0.02)


def bending_of(mesh, thickness, at):
    """Largest strain over the displacement of a place, in the first mode at rest."""
    operators = assemble(Plate(mesh, thickness, STEEL), Rotor(hub_radius=0.1), FLAT, "mindlin")
    return Reduction(operators, campbell(operators, [0.0], 4), at).bending(0)[0]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_strain_of_a_swept_root(side):
    """It is largest next to its inner corner: 0.29 to 0.33 by CalculiX (40 x 16 x 2 C3D20R), 0.13 amid."""
    turn = side * np.tan(np.radians(30.0))
    mesh = rectangle(0.2, 0.08, 40, 16)
    swept = type(mesh)(mesh.p + np.array([[0.0], [turn]]) * mesh.p[0], mesh.t)
    assert bending_of(swept, 0.004, (0.17, 0.17 * turn)) == pytest.approx(0.32, rel=0.08)


def test_strain_of_a_neck():
    """It is a beam's."""
    knots, heights = (0.0, 0.06, 0.08, 0.1, 0.2), (0.01, 0.01, 0.004, 0.01, 0.01)
    neck = Bilinear(knots, (0.0,), tuple((each,) for each in heights))
    _, expected, _ = beam(0.2, lambda x: np.interp(x, knots, heights), 0.19)
    assert bending_of(rectangle(0.2, 0.05, 50, 4), neck, (0.19, 0.0)) == pytest.approx(expected.max(), rel=0.07)


def test_strain_of_a_single_triangle():
    """Next to its tip a strip has one point of the rule; a fine mesh has the same."""
    corners = MeshTri(np.array([[0.0, 0.0, 0.15], [-0.03, 0.03, 0.0]]), np.array([[0], [1], [2]]))
    coarse, fine = (bending_of(mesh, 0.003, (0.1, 0.0)) for mesh in (corners.refined(1), corners.refined(4)))
    assert coarse == pytest.approx(fine, rel=0.1)
    assert np.isfinite(bending_of(corners, 0.003, (0.1, 0.0)))


def test_a_diagram_of_one_mode_is_reduced_where_coriolis_forces_act():
    """The lowest mode of a plate thicker than wide is lag: the flap mode is sought among more modes than those."""
    plate = Plate(Rectangle(0.2, 0.02).mesh(4), 0.03, STEEL)
    operators = assemble(plate, Rotor(hub_radius=0.1), Effects(coriolis=True))
    diagrams = (campbell(operators, [100.0, 900.0], count=count) for count in (1, 4))
    one, four = (reduce_over(operators, diagram, at=(0.2, 0.0), ball_mass=2e-3) for diagram in diagrams)
    np.testing.assert_allclose([each.K2 for each in one], [each.K2 for each in four], rtol=1e-6)
