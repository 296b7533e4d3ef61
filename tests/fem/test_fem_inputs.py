"""What users type: refused early, with one clear line; and what `import fem` offers."""

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from fem_cases import FLAT, STEEL, distorted, paper_plate

import fem
from fem.rotor import from_rpm, in_rpm


@cache
def small(**effects):
    """The paper's plate on two cells."""
    return fem.assemble(paper_plate(2, 1), fem.Rotor(), fem.Effects(**effects))


def plate(**keys):
    return fem.Plate(**{"mesh": fem.rectangle(0.2, 0.08, 2, 1), "thickness": 0.01, "material": STEEL, **keys})


def skew(theory):
    return fem.assemble(
        fem.Plate(distorted(fem.rectangle(0.2, 0.08, 4, 3), 0.004), 0.01, STEEL), fem.Rotor(), FLAT, theory
    )


def reduced(at=(0.2, 0.0), **keys):
    return fem.reduce_at(small(), 0.0, at, **keys)


def of_another_speed():
    return fem.reduce_at(small(), 10.0, (0.2, 0.0), mass_ratio=0.1, modes=fem.solve_modes(small(), 0.0, 3))


def over(at, **keys):
    return fem.reduce_over(small(), fem.campbell(small(), np.array([0.0, 100.0]), 4), at, **keys)


REFUSED = {
    "youngs_modulus must be a positive number of Pa, got 0.0": [lambda: fem.Material(0.0, 0.3, 7850.0)],
    "youngs_modulus": [lambda: fem.Material(np.nan, 0.3, 7850.0)],
    "poissons_ratio must lie between -1 and 0.5, got 0.5": [lambda: fem.Material(2e11, 0.5, 7850.0)],
    "poissons_ratio": [lambda: fem.Material(2e11, -1.0, 7850.0)],
    "density must be a positive number of kg/m³, got -1.0": [lambda: fem.Material(2e11, 0.3, -1.0)],
    "thickness must be a positive number of m": [lambda: plate(thickness=0.0)],
    "tip_mass must be zero or more kg": [lambda: plate(tip_mass=-1.0)],
    "tip_mass needs tip_at": [lambda: plate(tip_mass=1.0)],
    "a place on the plate is": [lambda: plate(tip_at=(0.1, 0.0, 0.0))],
    "does not lie on the plate": [
        lambda: plate(tip_at=(5.0, 0.0)),
        lambda: reduced((0.3, 0.0), mass_ratio=0.1),
        lambda: over((0.3, 0.0), ball_mass=0.1),
    ],
    "does not move": [lambda: reduced((0.0, 0.0), mass_ratio=0.1)],
    "belong to": [of_another_speed],
    "give either ball_mass or mass_ratio": [
        reduced,
        lambda: reduced(ball_mass=1.0, mass_ratio=0.1),
        lambda: over((0.2, 0.0)),
        *(lambda bad=bad: reduced(mass_ratio=bad) for bad in (-0.1, np.nan, np.inf)),
    ],
    "mass must be zero or more kg": [
        lambda bad=bad: fem.with_point_mass(small(), (0.1, 0.0), bad) for bad in (-1.0, np.nan, np.inf)
    ],
    "hub_radius must be a finite number of m": [lambda: fem.Rotor(hub_radius=np.inf)],
    "stagger must be a finite angle": [lambda: fem.Rotor(stagger=np.inf)],
    "precone must be a finite angle in rad": [lambda: fem.Rotor(precone=np.nan)],
    "stress_stiffening": [lambda: fem.Effects(large_deflection=True, stress_stiffening=False)],
    "must be a positive number of N": [
        lambda pair=pair: fem.ElasticRoot(*pair) for pair in ((0.0, 1.0), (1.0, 0.0), (np.inf, 1.0), (1.0, np.nan))
    ],
    r"one of mindlin, .*kirchhoff/morley, solid/2.*, got 'solid/3'": [lambda: skew("solid/3")],
    "theory must be": [lambda: skew("reissner")],
    "rectangles": [lambda: skew("kirchhoff/bfs")],
    "choose_theory": [lambda: skew("auto")],
    "must be positive and finite": [
        lambda bad=bad: fem.choose_theory(paper_plate(2, 1), accuracy=bad) for bad in (0.0, -1.0, np.nan, np.inf)
    ],
    "tolerance must be above 0": [
        lambda: fem.choose_mesh(fem.Rectangle(0.2, 0.08), lambda size: small(), (0.0,), 3, 0.0)
    ],
    "one finite speed": [
        lambda: fem.equilibrium(small(large_deflection=True), np.nan),
        *(lambda bad=bad: fem.solve_modes(small(), bad) for bad in (np.nan, np.inf, np.array([1.0, 2.0]))),
    ],
    "start must be of shape": [lambda: fem.equilibrium(small(large_deflection=True), 1.0, np.zeros(3))],
    "shapes must be": [lambda: fem.displacement(small(), np.zeros(3))],
    "must be positive": [
        make
        for bad in (0.0, -1.0, np.nan, np.inf)
        for make in (lambda bad=bad: fem.rectangle(bad, 1.0, 2, 2), lambda bad=bad: fem.Rectangle(1.0, bad))
    ],
    "whole number from 1": [lambda: fem.Rectangle(1.0, 1.0).mesh(0)],
    "1, 2, 4, 8": [lambda: fem.Given(fem.rectangle(1.0, 1.0, 2, 2)).mesh(3)],
    "at least one cell": [lambda: fem.rectangle(1.0, 1.0, 0, 2)],
    "count of modes": [
        make
        for bad in (0, 2.5, 10_000)
        for make in (
            lambda bad=bad: fem.solve_modes(small(), 0.0, bad),
            lambda bad=bad: fem.campbell(small(), [0.0, 1.0], bad),
        )
    ],
    "damping_ratio": [
        make
        for bad in (-0.1, np.nan, 1.0, np.inf)
        for make in (
            lambda bad=bad: fem.solve_modes(small(), 0.0, 1, damping_ratio=bad),
            lambda bad=bad: fem.campbell(small(), [0.0, 1.0], 1, damping_ratio=bad),
        )
    ],
    "campbell needs": [lambda bad=bad: fem.campbell(small(), np.array(bad)) for bad in ([], [-1.0], [np.nan])],
    "tolerance must": [lambda: fem.campbell(small(), np.array([1.0]), tolerance=0.0)],
}
"""What each message is said of."""


@pytest.mark.parametrize("message", REFUSED)
def test_what_makes_no_sense_is_refused(message):
    for make in REFUSED[message]:
        with pytest.raises(ValueError, match=message):
            make()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fem.Plate(fem.rectangle(0.2, 0.08, 2, 1), 0.01, None), "material must be"),
        (lambda: fem.Plate(fem.rectangle(0.2, 0.08, 2, 1), lambda x, y: 0.01 - 0.04 * x, STEEL), "thickness must be a"),
        (lambda: skew(None), "theory must be the name of one"),
        *((lambda bad=bad: fem.Effects(coriolis=bad), "coriolis must be True or False") for bad in ("no", None, 1)),
    ],
)
def test_what_is_of_another_type(make, message):
    with pytest.raises(TypeError, match=message):
        make()


def test_divergence_with_a_ball_says_a_negative_eigenvalue():
    with pytest.raises(fem.Divergence) as caught:
        fem.reduce_at(fem.assemble(paper_plate(4, 2), fem.Rotor(0.1, 0.3), FLAT), 10.0, (0.2, 0.0), mass_ratio=1e9)
    assert caught.value.eigenvalue < 0.0


def test_what_is_off_is_not_assembled():
    operators = small(stress_stiffening=False, spin_softening=False)
    assert operators.geometric is operators.softening is operators.gyroscopic is operators.prestress is None
    np.testing.assert_array_equal(fem.Rotor(stagger=np.pi / 2).axis, [0.0, 1.0, 0.0])


def test_inputs_are_frozen():
    for thing, name in (
        (STEEL, "density"),
        (fem.Rotor(), "stagger"),
        (fem.Effects(), "coriolis"),
        (paper_plate(2, 1), "mesh"),
    ):
        with pytest.raises(AttributeError):
            setattr(thing, name, 1.0)


def test_matrices_are_read_only():
    operators = fem.assemble(
        paper_plate(2, 1, tip_mass=0.1, tip_at=(0.2, 0.0)), fem.Rotor(), fem.Effects(coriolis=True)
    )
    for array in (operators.stiffness.data, operators.mass.data, operators.gyroscopic.data, operators.load):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0.0


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "solid"])
def test_displacement_at_the_vertices(theory):
    """Shapes at the mesh's own vertices, whatever the theory's unknowns; zero at the root, one of many alike."""
    plate = fem.Plate(fem.rectangle(0.2, 0.08, 4, 2).to_meshtri(), 0.01, STEEL)
    operators = fem.assemble(plate, fem.Rotor(), FLAT, theory)
    modes = fem.solve_modes(operators, 0.0, 2)
    moved = fem.displacement(operators, modes.shapes[:, 0])
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
