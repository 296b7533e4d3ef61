"""Plates that their load turns far, out of their plane or in it: CalculiX and the solid beside Mindlin's theory."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from fem_cases import BENT, FLAT, STEEL, frequencies, rpm

from fem import Material, Plate, Rectangle, Rotor, assemble, equilibrium, rectangle, solve_modes
from fem.accuracy.neglected_effects import bent
from fem.meshes.mesh_sequence import graded
from tests.benchmarks import calculix
from tests.benchmarks.calculix_tables import TABLES, TITANIUM, steel, stored
from tests.limits import HANG

needs_calculix = pytest.mark.skipif(not calculix.available(), reason="CalculiX (ccx) is not installed")

SAME = steel(0.3)
"""As STEEL."""

MESH = 2
"""Fineness; Mindlin's own frequencies are then within 0.15 % of those of finer meshes."""


def plate(case, fineness):
    return Plate(case.planform.graded(fineness), case.thickness, Material(*case.material))


def rotor(case):
    return Rotor(case.hub, np.radians(case.stagger))


@pytest.mark.parametrize("name", TABLES["bent"])
def test_rotations_as_in_calculix(name):
    """Six modes within 0.3 %, or within what Mindlin's theory and the mesh are off at rest, about the turned state."""
    case = TABLES["bent"][name]
    (still, spinning), differences = stored("bent")[name]
    operators = assemble(plate(case, MESH), rotor(case), BENT)
    own = np.abs(solve_modes(operators, 0.0).frequencies_hz / still - 1.0).max()
    found = solve_modes(operators, case.omega).frequencies_hz
    np.testing.assert_array_less(np.abs(found / spinning - 1.0), max(3e-3, own) + differences.max())


@pytest.mark.parametrize("slow", [1e-9, 1e-5, 1e-3])
@pytest.mark.parametrize("triangles", [False, True])
def test_a_plate_that_hardly_spins_is_stretched_as_in_the_linear_theory(slow, triangles):
    """Strains of 1e-14, as differences of stretched and unstretched lengths, are rounding."""
    mesh = rectangle(0.2, 0.08, 4, 2)
    operators = assemble(Plate(mesh.to_meshtri() if triangles else mesh, 1e-3, STEEL), Rotor(0.1), BENT)
    found = equilibrium(operators, slow) / slow**2
    np.testing.assert_allclose(found, operators.prestress, atol=1e-10 * np.abs(operators.prestress).max())


@pytest.mark.parametrize(("nu", "size"), [(0.0, 1), (0.3, 1), (0.45, 2)])
def test_strain_moves_a_flat_plate_as_it_moves_a_solid(nu, size):
    """At a strain of 1.2 %: what gets longer gets thinner and narrower, by as much as bricks do."""
    shifts = []
    for theory in ("mindlin", "solid"):
        flat = Plate(Rectangle(0.2, 0.08).mesh(size), 0.01, Material(182.6e9, nu, 7850.0))
        operators = assemble(flat, Rotor(), FLAT, theory)
        found = [solve_modes(replace(operators, effects=e), rpm(35000)).frequencies_hz for e in (BENT, FLAT)]
        shifts.append(found[0] / found[1] - 1.0)
    assert np.abs(shifts[1]).max() > 2e-3
    np.testing.assert_allclose(shifts[0], shifts[1], atol=1e-4)


@pytest.mark.parametrize("name", ["L, slow", "L, fast"])
def test_the_shift_of_a_coarse_mesh_is_that_of_calculix(name):
    """What linear stiffening misses on an L, whose load bends it in its own plane, is seen on a hundred cells."""
    case = TABLES["bent"][name]
    still, spinning = stored("bent")[name][0]
    at_rest, flat = (frequencies(plate(case, MESH), rotor(case), omega=omega) for omega in (0.0, case.omega))
    missed = np.abs(spinning / flat / (still / at_rest) - 1.0).max()
    found = bent(plate(case, 1), rotor(case), FLAT, (case.omega,), 6)
    assert found.shift == pytest.approx(missed, rel=0.15)
    assert 0.02 < found.rotation < 0.2


def test_a_plate_in_its_plane_is_hardly_moved():
    """The paper's plate: 0.09 % at its highest speed, of the same order as its strain of 0.3 %."""
    found = bent(Plate(Rectangle(0.2, 0.08).mesh(1), 0.01, STEEL), Rotor(), FLAT, (rpm(3500), rpm(17500)), 6)
    assert found.omega == rpm(17500)
    assert found.strain == pytest.approx(0.5 * 7850 * rpm(17500) ** 2 * 0.04 / 2e11, rel=0.3)
    assert 3e-4 < found.shift < 1e-3


def test_past_the_critical_speed_a_lower_one_tells():
    """In the plane of rotation and without a hub a plate diverges; 2000 rpm is the last with modes."""
    thin = Plate(Rectangle(0.2, 0.2).mesh(1), 0.001, STEEL)
    speeds = tuple(rpm(value) for value in (500, 1000, 2000, 40000, 80000))
    assert bent(thin, Rotor(0.0, np.pi / 2), FLAT, speeds, 3).omega == speeds[2]


NEAR = 0.17061176, 0.03356962, 0.00131759, Material(1e9, 0.49, 1000.0), Rotor(0.17061176, np.radians(3.05030255))
"""Length, width, thickness, material and rotor of a plate whose fourth and fifth mode are 0.1 % apart."""


def true_shifts(width, size, omega):
    length, _, thickness, material, rotor = NEAR
    operators = assemble(Plate(Rectangle(length, width).mesh(size), thickness, material), rotor, BENT)
    bent_, flat = (solve_modes(replace(operators, effects=effects), omega).frequencies_hz for effects in (BENT, FLAT))
    return np.abs(bent_ / flat - 1.0)


@cache
def coarse_shifts():
    length, width, thickness, material, rotor = NEAR
    return bent(Plate(Rectangle(length, width).mesh(3), thickness, material), rotor, FLAT, (rpm(1180),), 6).shifts


@pytest.mark.parametrize("wider", [-2e-3, -5e-4, 0.0, 5e-4, 2e-3])
def test_what_mixes_modes_that_nearly_coincide(wider):
    """Flap and lag cross as the plate gets wider: one coarse mesh bounds the shifts of all, and not by far at one."""
    found, true = coarse_shifts(), true_shifts(NEAR[1] * (1.0 + wider), 4, rpm(1180))
    assert (true < 1.02 * found).all()
    if wider == 0.0:
        assert true.max() > 1e-3
        assert found.max() < 2.0 * true.max()


@needs_calculix
def test_a_heavy_mass_is_softened():
    """What moves in the plane of rotation has a square lower by Omega²: flap at stagger 90°, lag at 0 (Southwell).

    CalculiX softens the plate alone, of a fiftieth of the mass.
    """
    omega, kg = rpm(3000), 15.0
    nodes, bricks = calculix.extruded(rectangle(0.1, 0.04, 6, 2), 0.01, 1)

    def squares(stagger, mass):
        deck = calculix.deck(nodes, bricks, SAME, omega, 0.0, stagger, 2, mass)
        return calculix.solved(deck, 2, HANG) ** 2

    flat, upright = (squares(stagger, (kg, 0.1, 0.0)) for stagger in (0.0, np.pi / 2))
    np.testing.assert_allclose((flat - upright) * [1, -1], (omega / (2 * np.pi)) ** 2, rtol=0.02)


@pytest.mark.parametrize(
    ("mesh", "thickness", "layers", "material", "speed", "hub", "degrees", "rtol"),
    [
        (rectangle(0.16, 0.06, 12, 5), 0.006, 2, SAME, 8000, 0.1, 0.0, 4e-3),
        (rectangle(0.16, 0.06, 12, 5), 0.006, 2, SAME, 8000, 0.05, 23.0, 4e-3),
        (graded(0.2, 0.1, 10, 4), 0.002, 1, TITANIUM, 12000, 0.02, 30.0, 3e-3),  # at a rotation of 0.2
    ],
)
@needs_calculix
def test_a_plate_nobody_tabulated(mesh, thickness, layers, material, speed, hub, degrees, rtol):
    """On meshes on which CalculiX is good to 0.2 %."""
    turned = {"hub": hub, "stagger": np.radians(degrees)}
    expected = calculix.frequencies_on(mesh, thickness, layers, material, rpm(speed), **turned, count=4, timeout=HANG)
    plate, effects = Plate(mesh, thickness, Material(*material)), BENT if degrees else FLAT
    np.testing.assert_allclose(
        frequencies(plate, Rotor(*turned.values()), effects, omega=rpm(speed), count=4), expected, rtol=rtol
    )
