"""What users type: refused early, with one clear line; and what `import fem` offers."""

import subprocess
import sys

import numpy as np
import pytest
from fem_cases import STEEL, paper_plate

import fem
from fem import Effects, Material, Plate, Rotor, assemble, displacement, rectangle, solve_modes


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
    ],
)
def test_plate(keys, message):
    with pytest.raises(ValueError, match=message):
        Plate(**{"mesh": rectangle(0.2, 0.08, 2, 1), "thickness": 0.01, "material": STEEL, **keys})


def test_rotor():
    with pytest.raises(ValueError, match="hub_radius must be zero or more m"):
        Rotor(hub_radius=-0.1)
    with pytest.raises(ValueError, match="stagger must be a finite angle"):
        Rotor(stagger=np.inf)
    np.testing.assert_array_equal(Rotor(stagger=np.pi / 2).axis, [0.0, 1.0, 0.0])


def test_rectangle():
    with pytest.raises(ValueError, match="must be positive"):
        rectangle(0.0, 1.0, 2, 2)
    with pytest.raises(ValueError, match="at least one cell"):
        rectangle(1.0, 1.0, 0, 2)


def test_modes():
    operators = assemble(paper_plate(2, 1), Rotor(), Effects())
    with pytest.raises(ValueError, match="count of modes"):
        solve_modes(operators, 0.0, 0)
    with pytest.raises(ValueError, match="damping_ratio"):
        solve_modes(operators, 0.0, 1, damping_ratio=-0.1)


def test_what_is_off_is_not_assembled():
    operators = assemble(paper_plate(2, 1), Rotor(), Effects(stress_stiffening=False, spin_softening=False))
    assert operators.geometric is operators.softening is operators.gyroscopic is operators.prestress is None


def test_inputs_are_frozen():
    for thing, name in ((STEEL, "density"), (Rotor(), "stagger"), (Effects(), "coriolis"), (paper_plate(2, 1), "mesh")):
        with pytest.raises(AttributeError):
            setattr(thing, name, 1.0)


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


def test_everything_offered_is_there():
    assert sorted(fem.__all__) == dir(fem)
    for name in fem.__all__:
        thing = getattr(fem, name)
        assert thing.__name__ == name
        assert thing.__doc__
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        fem.nonsense  # noqa: B018


def test_import_is_light():
    """`import fem` and the records it offers load neither SciPy nor scikit-fem."""
    code = "import sys; from fem import Effects, Material, Rotor; Rotor(); Effects(); Material(1.0, 0.3, 1.0)"
    code += "; assert not {'scipy', 'skfem', 'meshio', 'numpy'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
