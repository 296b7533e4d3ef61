"""What users type: refused early, with one clear line; and what `import fem` offers."""

import re
from pathlib import Path

import numpy as np
import pytest
from fem_cases import STEEL, paper_plate

import fem
from fem import (
    Divergence,
    Effects,
    Given,
    Material,
    Plate,
    Rectangle,
    Rotor,
    assemble,
    campbell,
    choose_theory,
    displacement,
    equilibrium,
    rectangle,
    reduce_at,
    solve_modes,
    with_point_mass,
)
from fem.rotor import from_rpm, in_rpm


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((0.0, 0.3, 7850.0), "youngs_modulus must be a positive number of Pa, got 0.0"),
        ((np.nan, 0.3, 7850.0), "youngs_modulus"),
        ((2e11, 0.5, 7850.0), "poissons_ratio must lie between -1 and 0.5, got 0.5"),
        ((2e11, -1.0, 7850.0), "poissons_ratio"),
        ((2e11, 0.3, -1.0), "density must be a positive number of kg/m³, got -1.0"),
    ],
)
def test_material(values, message):
    with pytest.raises(ValueError, match=message):
        Material(*values)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"thickness": 0.0}, "thickness must be a positive number of m"),
        ({"tip_mass": -1.0}, "tip_mass must be zero or more kg"),
        ({"tip_mass": 1.0}, "tip_mass needs tip_at"),
        ({"tip_at": (5.0, 0.0)}, "does not lie on the plate"),
        ({"tip_at": (0.1, 0.0, 0.0)}, "a place on the plate is"),
    ],
)
def test_plate(keys, message):
    with pytest.raises(ValueError, match=message):
        Plate(**{"mesh": rectangle(0.2, 0.08, 2, 1), "thickness": 0.01, "material": STEEL, **keys})


def test_rotor():
    with pytest.raises(ValueError, match="hub_radius must be a finite number of m"):
        Rotor(hub_radius=np.inf)
    with pytest.raises(ValueError, match="stagger must be a finite angle"):
        Rotor(stagger=np.inf)
    np.testing.assert_array_equal(Rotor(stagger=np.pi / 2).axis, [0.0, 1.0, 0.0])


def test_plate_of_nothing():
    with pytest.raises(TypeError, match="material must be"):
        Plate(rectangle(0.2, 0.08, 2, 1), 0.01, None)


@pytest.mark.parametrize("switch", ["no", None, 1])
def test_effects_are_on_or_off(switch):
    with pytest.raises(TypeError, match="coriolis must be True or False"):
        Effects(coriolis=switch)


def test_theory():
    with pytest.raises(ValueError, match=r"one of mindlin, .*kirchhoff/morley, solid/2.*, got 'solid/3'"):
        assemble(paper_plate(2, 1), Rotor(), Effects(), "solid/3")
    with pytest.raises(TypeError, match="theory must be the name of one"):
        assemble(paper_plate(2, 1), Rotor(), Effects(), None)


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
def test_choice_of_theory(bad):
    with pytest.raises(ValueError, match="must be positive and finite"):
        choose_theory(paper_plate(2, 1), accuracy=bad)


def test_point_mass():
    operators = assemble(paper_plate(2, 1), Rotor(), Effects())
    for mass in (-1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="mass must be zero or more kg"):
            with_point_mass(operators, (0.1, 0.0), mass)
        with pytest.raises(ValueError, match="give either ball_mass or mass_ratio"):
            reduce_at(operators, 0.0, (0.2, 0.0), mass_ratio=mass)


def test_equilibrium():
    operators = assemble(paper_plate(2, 1), Rotor(), Effects(large_deflection=True))
    with pytest.raises(ValueError, match="one finite speed"):
        equilibrium(operators, np.nan)
    with pytest.raises(ValueError, match="start must be of shape"):
        equilibrium(operators, 1.0, np.zeros(3))


def test_displacement_of_another_model():
    with pytest.raises(ValueError, match="shapes must be"):
        displacement(assemble(paper_plate(2, 1), Rotor(), Effects()), np.zeros(3))


def test_divergence_with_a_ball_says_a_negative_eigenvalue():
    operators = assemble(paper_plate(4, 2), Rotor(0.1, 0.3), Effects())
    with pytest.raises(Divergence) as caught:
        reduce_at(operators, 10.0, (0.2, 0.0), mass_ratio=1e9)
    assert caught.value.eigenvalue < 0.0


def test_rectangle():
    for length in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="must be positive"):
            rectangle(length, 1.0, 2, 2)
        with pytest.raises(ValueError, match="must be positive"):
            Rectangle(1.0, length)
    with pytest.raises(ValueError, match="whole number from 1"):
        Rectangle(1.0, 1.0).mesh(0)
    with pytest.raises(ValueError, match="1, 2, 4, 8"):
        Given(rectangle(1.0, 1.0, 2, 2)).mesh(3)
    with pytest.raises(ValueError, match="at least one cell"):
        rectangle(1.0, 1.0, 0, 2)


def test_modes():
    operators = assemble(paper_plate(2, 1), Rotor(), Effects())
    for count in (0, 2.5, 10_000):
        with pytest.raises(ValueError, match="count of modes"):
            solve_modes(operators, 0.0, count)
        with pytest.raises(ValueError, match="count of modes"):
            campbell(operators, [0.0, 1.0], count)
    for omega in (np.nan, np.inf, np.array([1.0, 2.0])):
        with pytest.raises(ValueError, match="one finite speed"):
            solve_modes(operators, omega)
    for ratio in (-0.1, np.nan, 1.0, np.inf):
        with pytest.raises(ValueError, match="damping_ratio"):
            solve_modes(operators, 0.0, 1, damping_ratio=ratio)
        with pytest.raises(ValueError, match="damping_ratio"):
            campbell(operators, [0.0, 1.0], 1, damping_ratio=ratio)


def test_what_is_off_is_not_assembled():
    operators = assemble(paper_plate(2, 1), Rotor(), Effects(stress_stiffening=False, spin_softening=False))
    assert operators.geometric is operators.softening is operators.gyroscopic is operators.prestress is None


def test_inputs_are_frozen():
    for thing, name in ((STEEL, "density"), (Rotor(), "stagger"), (Effects(), "coriolis"), (paper_plate(2, 1), "mesh")):
        with pytest.raises(AttributeError):
            setattr(thing, name, 1.0)


def test_matrices_are_read_only():
    operators = assemble(paper_plate(2, 1, tip_mass=0.1, tip_at=(0.2, 0.0)), Rotor(), Effects(coriolis=True))
    for array in (operators.stiffness.data, operators.mass.data, operators.gyroscopic.data, operators.load):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0.0


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "solid"])
def test_displacement_at_the_vertices(theory):
    """Shapes at the mesh's own vertices, whatever the theory's unknowns; zero at the root, one of many alike."""
    plate = Plate(rectangle(0.2, 0.08, 4, 2).to_meshtri(), 0.01, STEEL)
    operators = assemble(plate, Rotor(), Effects(), theory)
    modes = solve_modes(operators, 0.0, 2)
    moved = displacement(operators, modes.shapes[:, 0])
    assert moved.shape == (plate.mesh.p.shape[1], 3)
    np.testing.assert_allclose(moved[plate.mesh.p[0] == 0.0], 0.0, atol=1e-12)
    tip = np.abs(moved[plate.mesh.p[0] > 0.199, 2])
    assert tip.min() > 0.9 * tip.max()
    assert np.abs(moved[:, :2]).max() < 1e-6 * tip.max()


def test_revolutions_per_minute():
    """One turn a second is 60 of them, of numbers and of arrays."""
    assert in_rpm(2 * np.pi) == pytest.approx(60.0, rel=1e-15)
    assert from_rpm(np.array([60.0, 3000.0])) == pytest.approx(2 * np.pi * np.array([1.0, 50.0]), rel=1e-15)


def test_revolutions_are_converted_in_one_place():
    root = Path(fem.__file__).parents[1]
    sources = [path for name in ("fem", "damper", "workflows") for path in (root / name).rglob("*.py")]
    factor = re.compile(r"\b30(\.0)? / ((math|np)\.)?pi\b|\bpi / 30\b")
    assert {path.name for path in sources if factor.search(path.read_text(encoding="utf-8"))} == {"rotor.py"}
