"""Plates that leave the hub at an angle to the plane of rotation: exact beams, forces, symmetry."""

import numpy as np
import pytest
from fem_cases import BENT, FLAT, STEEL, STRIP, WRIGHT, frequencies, unit_of
from scipy.spatial.transform import Rotation

from fem import ElasticRoot, PlaceError, Plate, Rotor, assemble, equilibrium, rectangle, with_point_mass
from fem.linalg import factorise, lanczos
from fem.meshes.thickness import Polynomial
from fem.theory.fields import gram


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin"])
@pytest.mark.parametrize(
    ("gamma", "precone", "stagger"), [(2, 60, 0), (4, 60, 0), (3, 90, 0), (3, 90, 90), (3, 90, 35)]
)
def test_a_coned_beam(theory, gamma, precone, stagger):
    """Without a hub the pull is that at gamma cos(precone), and bending is softened by gamma² sin²(precone).

    As from the prestress that is linear. Staggered as well, the load bends the strip in its own plane, which is a
    problem of its own (it may buckle sideways), but for the axis along the strip.
    """
    raised = np.radians(precone)
    squared = WRIGHT[round(gamma * np.cos(raised))] ** 2 - (gamma * np.sin(raised)) ** 2
    assert cone_rates(theory, gamma, np.radians(stagger), raised) == pytest.approx(np.sqrt(squared), rel=1e-4)


def cone_rates(theory, gamma, stagger, precone):
    """First bending frequency of a strip, in units of sqrt(EI / rho A L^4)."""
    unit = unit_of(1e-3)
    plate = Plate(rectangle(1.0, 0.01, 40, 1), 1e-3, STRIP)
    operators = assemble(plate, Rotor(0.0, stagger, precone), FLAT, theory)
    lowest = lanczos(factorise(operators.at(gamma * unit)), operators.mass, 1)[0][0]
    return float(np.sqrt(lowest)) / unit


@pytest.mark.parametrize("theory", ["kirchhoff/bfs", "mindlin", "solid"])
@pytest.mark.parametrize("thickness", [0.004, Polynomial(((0.006, 0.02), (-0.01,)))])
def test_the_whole_force(theory, thickness):
    """Mass times the centre's distance from the axis, by turning the hub's axes into the plate's, not by a formula."""
    stagger, precone, hub = 0.5, 0.3, 0.07
    mesh = rectangle(0.2, 0.08, 4, 2)
    plate = Plate(mesh, thickness, STEEL, elastic_root=ElasticRoot(1e9, 1e5))
    operators = assemble(plate, Rotor(hub, stagger, precone), FLAT, theory)
    model = operators.model
    volume = model.displacement.dx * sum(layer.weight for layer in model.inertia)
    centre = np.array([(volume * model.points[0]).sum(), (volume * model.points[1]).sum(), 0.0]) / volume.sum()
    laid = Rotation.from_rotvec([0.0, -precone, 0.0]) * Rotation.from_rotvec([stagger, 0.0, 0.0])
    in_hub = np.array([hub, 0.0, 0.0]) + laid.apply(centre)
    expected = laid.inv().apply(STEEL.density * volume.sum() * in_hub * [1.0, 1.0, 0.0])
    found = [operators.load @ rigid(operators, direction) for direction in np.eye(3)]
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def rigid(operators, direction):
    """Unknowns (n,) of a plate that moves as a whole."""
    fields = operators.model.displacement
    values = np.zeros((fields.size, *fields.dx.shape))
    values[:3] = np.array(direction)[:, None, None]
    return factorise(gram((fields, np.eye(fields.size)))).solve(fields.load(values))


def test_a_point_mass_pulls_from_the_axis():
    operators = assemble(Plate(rectangle(0.2, 0.08, 4, 2), 0.004, STEEL), Rotor(0.1, 0.4, 0.2), FLAT)
    heavy = with_point_mass(operators, (0.15, 0.02), 0.5)
    rows = operators.at_place((0.15, 0.02)).rows[0]
    place = operators.from_axis((0.15, 0.02))
    axis = operators.rotor.axis
    np.testing.assert_allclose(heavy.load - operators.load, 0.5 * rows.T @ (place - (place @ axis) * axis), atol=1e-12)


@pytest.mark.parametrize("precone", [0.0, 0.3, -0.8, np.pi / 2])
def test_the_radius_is_the_distance_from_the_axis(precone):
    """Off the centre line the chord counts as far as it lies in the plane of rotation."""
    operators = assemble(Plate(rectangle(0.2, 0.08, 2, 1), 0.004, STEEL), Rotor(0.1, 0.4, precone), FLAT)
    rotor, place = operators.rotor, operators.from_axis((0.15, 0.0))
    assert operators.radius(0.15) == pytest.approx(np.linalg.norm(rotor.projector @ place), rel=1e-12)
    assert operators.radius(0.15) == pytest.approx(0.1 + 0.15 * np.cos(precone), rel=1e-12)
    floor, raised = operators.at_place((0.15, 0.0)), np.sin(precone) * np.cos(0.4)
    assert floor.axes[2, 0] == pytest.approx(np.cos(precone), abs=1e-12)
    assert floor.axes[0, 2] ** -2 == pytest.approx(1.0 / (1.0 - raised**2))
    assert operators.radius(0.15, 0.02) == pytest.approx(
        np.linalg.norm(rotor.projector @ operators.from_axis((0.15, 0.02))), rel=1e-12
    )
    assert precone or operators.radius(0.15, 0.02) == pytest.approx(np.hypot(0.25, 0.02 * np.cos(0.4)), rel=1e-12)
    assert rotor.axis @ rotor.outwards == pytest.approx(0.0, abs=1e-15)
    assert np.linalg.norm(rotor.outwards) == pytest.approx(1.0)


def test_a_load_along_the_plates_normal_leaves_no_axis_through_the_thickness():
    """Raised by 81 degrees the load is 9 degrees from the normal."""
    raised = (Rotor(0.1, 0.0, np.radians(angle)) for angle in (79.0, 81.0))
    near, beyond = (assemble(Plate(rectangle(0.2, 0.08, 2, 1), 0.004, STEEL), rotor, FLAT) for rotor in raised)
    assert near.at_place((0.15, 0.0)).axes[0, 2] ** -2 == pytest.approx(np.cos(np.radians(79.0)) ** -2)
    with pytest.raises(PlaceError, match="hardly any load lies in the plate's plane"):
        beyond.at_place((0.15, 0.0)).axes  # noqa: B018


@pytest.mark.parametrize("effects", [FLAT, BENT])
def test_up_or_down_is_the_same(effects):
    """A plate that is its own mirror image has the same modes coned either way, whatever its stagger."""
    plate = Plate(rectangle(0.2, 0.08, 6, 3), Polynomial(((0.004, 0.0, -0.5), (-0.01,))), STEEL)
    up, down = (frequencies(plate, Rotor(0.1, 0.5, cone), effects, omega=400.0) for cone in (0.1, -0.1))
    np.testing.assert_allclose(up, down, rtol=1e-9)


def test_about_its_own_length_the_stagger_is_no_more():
    """At a precone of 90 degrees without a hub the axis is the plate's x, however it is staggered."""
    plate = Plate(rectangle(0.2, 0.08, 6, 3), 0.004, STEEL)
    found = [frequencies(plate, Rotor(0.0, stagger, np.pi / 2), omega=200.0) for stagger in (0.0, 0.7, np.pi / 2)]
    np.testing.assert_allclose(found[1:], [found[0]] * 2, rtol=1e-9)


def test_a_cone_bends_what_is_raised_towards_the_plane():
    """The load pulls the tip of a thin strip down to the plane of rotation: at speed it stretches out there."""
    plate, precone = Plate(rectangle(0.2, 0.02, 16, 1), 5e-4, STEEL), 0.05
    operators = assemble(plate, Rotor(0.1, 0.0, precone), BENT)
    lift = (operators.at_place((0.2, 0.0)).rows[0] @ equilibrium(operators, 600.0))[2]
    assert -0.2 * np.sin(precone) * 1.05 < lift < -0.2 * np.sin(precone) * 0.8
