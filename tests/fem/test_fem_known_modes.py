"""A structure known by its modes: cells, places, the ball's pull, speeds between those known; CalculiX's files.

`data/plate_paper_*.frd.gz` are outputs of CalculiX 2.20 (C3D20R, 12 x 8 x 2 cells), cut to four modes: the plate of
200 x 80 x 10 mm with E = 182.6 GPa, nu = 0.3, rho = 7850 kg/m³ at rest and at 10 000 rpm about its z.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fem_cases import DATA
from scipy.spatial.transform import Rotation

from fem.meshes.cells import KINDS, cell
from fem.modal_files import document, in_si, joined, read, write
from fem.modal_model import (
    ModalModel,
    ModesAtSpeed,
    OffTheStructure,
    densities,
    drawn_by,
    edges,
    faces,
    families,
    place,
    pull,
)
from fem.reduction.known_modes import NoMotion, bending_direction, floor, reduced_modes
from fem.rotor import Rotor, from_rpm

Z, ORIGIN = np.array([0.0, 0.0, 1.0]), np.zeros(3)


def modes(shapes: np.ndarray, hz: tuple[float, ...] | None = None, omega: float = 0.0) -> ModesAtSpeed:
    count = len(shapes)
    return ModesAtSpeed(omega, np.arange(1.0, count + 1.0) * 100 if hz is None else np.array(hz), np.asarray(shapes))


def cloud(points: np.ndarray, shapes: np.ndarray, axis: np.ndarray = Z) -> ModalModel:
    return ModalModel(np.asarray(points), (modes(shapes),), axis, ORIGIN)


@pytest.fixture(scope="module")
def plate() -> ModalModel:
    """The paper's plate at rest and at 10 000 rpm, by CalculiX."""
    both = [read(DATA / f"plate_paper_{rpm}.frd.gz").model for rpm in (0, 10000)]
    return joined(
        [replace(m, speeds=(replace(m.speeds[0], omega=from_rpm(rpm)),)) for m, rpm in zip(both, (0, 1e4), strict=True)]
    )


@pytest.mark.parametrize("name", KINDS)
def test_a_cell_has_exact_volume_gradients_and_faces(name: str) -> None:
    """Of an affine image: volume by its determinant, gradients of linear fields, and a closed surface."""
    kind, random = cell(name), np.random.default_rng(7)
    flat = kind.dimension == 2
    mapping = np.eye(3) + 0.3 * random.standard_normal((3, 3))
    nodes = np.column_stack([kind.nodes, np.zeros(len(kind.nodes))]) if flat else kind.nodes
    points = 0.1 * nodes @ mapping.T
    field = random.standard_normal((3, 3))
    model = ModalModel(points, (modes((points @ field.T)[None]),), Z, ORIGIN, ((name, np.arange(len(points))[None]),))
    there = points.mean(axis=0)
    at = place(model, there)
    assert at.distance < 1e-12
    assert at.displacement(model.speeds[0].shapes)[0] == pytest.approx(field @ there, abs=1e-12)
    found = at.gradient(model.speeds[0])[0][0]
    assert found @ at.tangent == pytest.approx(field @ at.tangent, abs=1e-10)
    triangles = faces(model.cells)
    if flat:
        return
    first, second, third = points[triangles].swapaxes(0, 1)
    normals = np.cross(second - first, third - first)
    reference = {0: 8.0, 2: 1.0, 3: 1.0 / 6.0}[kind.simplex]
    exact = reference * 1e-3 * abs(np.linalg.det(mapping))
    assert model.weights.sum() == pytest.approx(exact, rel=1e-12)
    outwards = (points[triangles].mean(axis=1) * normals).sum() / 6.0  # the divergence theorem, and normals outwards
    assert abs(outwards) == pytest.approx(exact, rel=1e-12)
    assert len(edges(points, triangles)) >= 6


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_a_fit_knows_quadratic_fields_and_fibres_that_stay_normal(dimension: int) -> None:
    """Nodes along a line, on a plane and in space; what leaves them turns as the bending of beams and plates does."""
    random = np.random.default_rng(dimension)
    points = np.zeros((60, 3))
    points[:, :dimension] = random.uniform(-1.0, 1.0, (60, dimension))
    x, y, z = points.T
    w = 0.3 + 0.2 * x + 0.7 * x**2 - 0.4 * x * y + 0.1 * z + 0.5 * y * z
    model = cloud(points, np.stack([np.zeros(60), np.zeros(60), w], axis=1)[None])
    there = np.array([0.2, 0.1, -0.1]) * (np.arange(3) < dimension)
    found, spread = place(model, there).gradient(model.speeds[0])
    x, y, z = there
    slope = np.array([0.2 + 1.4 * x - 0.4 * y, -0.4 * x + 0.5 * z, 0.1 + 0.5 * y]) * (np.arange(3) < dimension)
    assert found[0, 2] == pytest.approx(slope, abs=1e-9)
    assert found[0, 0, 2] == pytest.approx(-slope[0] if dimension < 3 else 0.0, abs=1e-9)
    assert np.abs(spread).max() < 1e-9


def test_a_slope_is_within_its_uncertainty() -> None:
    """Of a shape that is no polynomial, by nodes further and further apart."""
    for count in (8, 12, 20):
        x = np.linspace(0.0, 1.0, count)
        w = np.sin(2.5 * x)
        model = cloud(np.outer(x, [1.0, 0.0, 0.0]), np.stack([0 * x, 0 * x, w], axis=1)[None])
        found, spread = place(model, np.array([1.0, 0.0, 0.0])).gradient(model.speeds[0])
        assert abs(found[0, 2, 0] - 2.5 * np.cos(2.5)) <= abs(spread[0, 2, 0]), count


def test_a_floors_slope_is_as_uncertain_whatever_the_axes_of_the_file() -> None:
    """As uncertain as the two ways to find it differ along the floor's normal and axis."""
    random = np.random.default_rng(5)
    points = random.uniform([0.5, -0.1, -0.05], [1.5, 0.1, 0.05], (200, 3))
    w = np.sin(2.5 * points[:, 0])
    shape = np.stack([-2.5 * np.cos(2.5 * points[:, 0]) * points[:, 2], 0.3 * w, w], axis=1)
    spreads = []
    for turn in (np.eye(3), np.linalg.qr(random.normal(size=(3, 3)))[0]):
        model = replace(cloud(points @ turn.T, (shape @ turn.T)[None]), axis=turn @ [0.0, 1.0, 0.0])
        at = place(model, turn @ [1.4, 0.0, 0.0])
        spreads.append(floor(model, at, model.speeds[0], turn @ [0.0, 0.0, 1.0]).spread[:, 0])
    assert spreads[1] == pytest.approx(spreads[0], rel=1e-6)


def test_places_off_the_structure_or_without_a_slope_are_refused(plate: ModalModel) -> None:
    with pytest.raises(OffTheStructure, match="m off the structure"):
        place(plate, np.array([0.3, 0.0, 0.0]))
    near = place(plate, np.array([0.201, 0.0, 0.0]))
    assert near.distance == pytest.approx(1e-3)
    assert near.point == pytest.approx([0.2, 0.0, 0.0])
    one = cloud(np.array([[0.1, 0.0, 0.0], [0.1, 0.0, 0.0]]), np.ones((1, 2, 3)))
    with pytest.raises(OffTheStructure, match="coincide"):
        place(one, np.array([0.1, 0.0, 0.0]))


def test_a_rigid_blade_on_a_hinge_at_the_axis_flaps_as_a_tilted_orbit() -> None:
    """It flaps at the rotation's frequency with a ball and without, its floor at a right angle to its radius."""
    omega, radius = 100.0, 0.4
    x = np.linspace(0.0, radius, 9)
    shape = np.stack([0 * x, 0 * x, 3.0 * x], axis=1)[None]
    model = replace(cloud(np.outer(x, [1.0, 0.0, 0.0]), shape), speeds=(modes(shape, (omega / 2 / np.pi,), omega),))
    at = place(model, np.array([radius, 0.0, 0.0]))
    direction = bending_direction(model, at, model.speeds[0])
    found, every = reduced_modes(
        model.speeds[0], floor(model, at, model.speeds[0], direction), pull(model, at), ball_mass=5.0
    )
    assert direction.tolist() == [0.0, 0.0, 1.0]
    assert [found.M2, found.slope, found.floor_tilt] == pytest.approx([(3.0 * radius) ** -2, 1.0 / radius, 1.0])
    assert (found.f1_hz, found.f2_hz) == pytest.approx((omega / 2 / np.pi,) * 2)
    assert every.stiffness[0, 0] == pytest.approx(omega**2 * (1.0 + 5.0 / found.M2))


@pytest.mark.parametrize(("axis", "softened"), [((0.0, 0.0, 1.0), 0.0), ((0.0, 1.0, 0.0), 1.0)])
def test_the_pull_of_a_load_at_a_tip_that_bends_as_a_parabola(axis: tuple[float, ...], softened: float) -> None:
    """w = (x/L)²: the line shortens by half of 4/(3L); what moves in the plane of rotation is softened as well."""
    x = np.linspace(0.0, 0.25, 12)
    model = cloud(np.outer(x, [1.0, 0, 0]), np.stack([0 * x, 0 * x, (x / 0.25) ** 2], axis=1)[None], np.array(axis))
    model = replace(model, origin=np.array([-0.1, 0.0, 0.0]))
    found = pull(model, place(model, np.array([0.25, 0.0, 0.0]))).stiffness(model.speeds[0])
    assert found[0, 0] == pytest.approx(0.35 * 4 / 3 / 0.25 - softened, rel=2e-3)


@pytest.mark.parametrize("sweep", [0.0, 0.7])
def test_a_line_strays_where_it_leaves_a_swept_bar_not_inboard_of_its_root(sweep: float) -> None:
    """A line that is not normal to the root begins inboard of it, as deep as its far corner; by plane geometry."""
    nodes = 0.5 * (cell("hexahedron").nodes + 1.0) * [0.2, 0.06, 0.008] - [0.0, 0.03, 0.004]
    nodes[:, 1] += sweep * nodes[:, 0]
    still = modes(np.zeros((1, 8, 3)))
    model = ModalModel(nodes, (still,), Z, np.array([-0.2, 0.0, 0.0]), (("hexahedron", np.arange(8)[None]),))
    point = np.array([0.12, 0.018 + 0.12 * sweep, 0.0])
    found, slope = pull(model, place(model, point)).strays, point[1] / 0.32
    if sweep == 0.0:
        inboard = (0.12 + 0.048 * slope) / (1.0 + slope**2) - 0.12
        assert inboard == pytest.approx(2.31e-3, rel=1e-2)  # of the root, which lies straight ahead
        assert found == pytest.approx(inboard * np.sin(np.arctan(slope)), rel=1e-6)
    else:
        beside = (0.2 * slope - 0.03) * np.cos(np.arctan(sweep)) * np.cos(np.arctan(sweep) - np.arctan(slope))
        assert beside < found < 1.5 * beside


@pytest.mark.parametrize("coupling", [0.0, 0.003, 0.1])
def test_modes_between_speeds_are_those_of_the_structure(coupling: float) -> None:
    """Of a stiffness linear in the squared speed, whose lowest modes cross, or veer sharply or slowly; signs at random.

    Frequencies are within their errors, effective masses and shapes are right where two modes are a mixture of both.
    """
    random, nodes, count = np.random.default_rng(3), 20, 6
    size = 3 * nodes
    mass = np.repeat(random.uniform(0.5, 2.0, nodes), 3)
    basis = np.linalg.qr(random.standard_normal((size, size)))[0]
    lowest = [1e6, 1.5e6, 5e6, 7e6, 1.2e7]
    rest = basis @ np.diag([*lowest, *np.linspace(2e7, 9e7, size - 5)]) @ basis.T
    mixed = random.standard_normal((size, size))
    growth = np.diag([4e6, 2e5, *random.uniform(3e5, 3e6, size - 2)]) + coupling * 5e5 * (mixed + mixed.T)
    growth = basis @ growth @ basis.T

    def at(omega: float, count: int = count) -> ModesAtSpeed:
        stiffness = (rest + (omega / 1000.0) ** 2 * growth) / np.sqrt(np.outer(mass, mass))
        squares, vectors = np.linalg.eigh(stiffness)
        shapes = (vectors / np.sqrt(mass)[:, None] * random.choice([-1.0, 1.0], size)).T[:count]
        hz = np.sqrt(squares[:count]) / (2.0 * np.pi)
        return ModesAtSpeed(omega, hz, shapes.reshape(count, nodes, 3), damping_ratios=1e-3 * hz)

    def model(*omegas: float, count: int = count) -> ModalModel:
        points = np.arange(size, dtype=float).reshape(nodes, 3)
        return ModalModel(points, tuple(at(omega, count) for omega in omegas), Z, ORIGIN)

    known = model(0.0, 300.0, 600.0, 1000.0)
    assert known.likeness.min() > 0.98
    for omega in (250.0, 370.0, 450.0, 800.0):
        found, exact = known.at(omega), at(omega)
        error = np.abs(found.frequencies_hz / exact.frequencies_hz - 1.0)
        assert (error <= found.interpolation).all(), omega
        assert found.interpolation.max() < 2e-2
        one, other = (np.abs(each.shapes[:4]) for each in (found, exact))
        assert np.abs(one - other).max() < 2e-3 * other.max(), omega
        assert found.damping_ratios == pytest.approx(1e-3 * exact.frequencies_hz, rel=0.02)
    assert known.at(1000.0).tracks[:2].tolist() == ([1, 0] if coupling < 0.1 else [0, 1])
    two = model(0.0, 1000.0)
    assert two.at(900.0).interpolation is None
    assert two.at(1000.0).frequencies_hz.tolist() == two.speeds[1].frequencies_hz[:count].tolist()
    assert model(0.0, 1000.0, count=1).likeness[0] < 0.1, "the lowest mode becomes one that is not in the files"
    with pytest.raises(ValueError, match="known from 0 to 1000 rad/s"):
        two.at(1001.0)


def test_a_static_displacement_is_nought_at_rest(plate: ModalModel) -> None:
    """And grows with the square of the speed from there, as between two files of which only one can have it."""
    assert plate.at(from_rpm(5000)).static == pytest.approx(plate.speeds[1].static / 4.0, abs=1e-12)


DRAWN = {0: (-0.8749314, 0.8799380), 10000: (-0.8814362, 0.8803016)}
"""Participation factors of CalculiX's .dat: the first bending mode along z, the first lag mode along y."""


@pytest.mark.parametrize(("rpm", "mass", "hz"), [(0, 0.31188, 198.6395), (10000, 0.31859, 269.2277)])
def test_a_plate_of_calculix(plate: ModalModel, rpm: int, mass: float, hz: float) -> None:
    """Frequencies, participation and effective mass as CalculiX's own .dat has them; the plate's density and volume."""
    known = plate.at(from_rpm(rpm))
    assert known.frequencies_hz[0] == pytest.approx(hz, abs=1e-4)
    assert families(plate, known) == ["flap", "twist", "flap", "lag"]
    assert densities(plate, known) == pytest.approx(7850.0, rel=1e-4)
    assert plate.weights.sum() == pytest.approx(0.2 * 0.08 * 0.01)
    drawn = drawn_by(plate, known)
    assert np.abs([drawn[0, 2], drawn[3, 1]]) == pytest.approx(np.abs(DRAWN[rpm]), rel=1e-4)
    at = place(plate, np.array([0.2, 0.0, 0.0]))
    seen = floor(plate, at, known, np.array([0.3, 0.0, 1.0]))
    found, _ = reduced_modes(known, seen, pull(plate, at), mass_ratio=0.006)
    assert abs(found.M2 - mass) < 5e-6
    assert seen.axes == pytest.approx(np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]), abs=1e-9)
    assert abs(seen.spread[0, 0] / seen.slope[0, 0]) < 1e-3


@pytest.mark.parametrize("length", [0.04, 0.1, 0.25])
@pytest.mark.parametrize("at_root", ["clamped", "elastic", "free"])
def test_families_go_by_the_span_however_wide_a_plate_is(length: float, at_root: str) -> None:
    """Shapes of a plate 0.1 m wide that are what they are called by construction, laid anyhow in the file.

    The span goes from the root to the tip; of a root that moves it is outwards from the spin axis.
    """
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0.0, 1.0, 17), np.linspace(-1.0, 1.0, 13)))
    still, bend = np.zeros_like(x), {"clamped": x**2, "elastic": 0.1 + x**2, "free": x**2 - 0.3}[at_root]
    shapes = {
        "flap": [still, still, bend],
        "twist": [still, still, bend * y],
        "chord": [still, still, bend * (y**2 - 0.37)],
        "lag": [still, bend, still],
        "axial": [bend, still, still],
    }
    turn = Rotation.from_rotvec([0.4, -0.7, 1.1]).as_matrix()
    points = np.stack([length * x, 0.05 * y, still], axis=1) + np.array([0.2, 0.03, 0.0])
    for stagger in np.radians([0.0, 70.0]):
        axis = turn @ [0.0, np.sin(stagger), np.cos(stagger)]
        laid = cloud(points @ turn.T, np.array([np.array(each).T @ turn.T for each in shapes.values()]), axis)
        assert families(laid, laid.speeds[0]) == list(shapes), stagger


def test_cells_nodes_and_one_side_of_a_plate_give_one_slope(plate: ModalModel) -> None:
    """By shape functions, by a fit to all nodes, and by one to those of its upper face alone."""
    known = plate.speeds[0]
    upper = plate.points[:, 2] > 0.0049
    above = replace(known, shapes=known.shapes[:, upper], static=None)
    for name, model, its, height in (
        ("cells", plate, known, 0.0),
        ("all nodes", replace(plate, cells=()), known, 0.0),
        ("upper", replace(plate, cells=(), points=plate.points[upper]), above, 0.005),
    ):
        seen = floor(model, place(model, np.array([0.2, 0.0, height])), its, Z)
        assert seen.slope[0, 0] / seen.moved[0, 0] == pytest.approx(6.9324, rel=1e-3), name


def test_a_neutral_file_comes_back_bit_for_bit(plate: ModalModel, tmp_path: Path) -> None:
    """Through .npz and .json, one after the other; and from a file in mm and t."""
    more = {"errors": np.full(4, 1e-3), "damping_ratios": np.full(4, 2e-3)}
    speeds = [replace(m, rotations=0.1 * m.shapes, static=m.shapes[0] * 1e-4, **more) for m in plate.speeds]
    speeds = [replace(m, drawn=m.shapes[:, 7]) for m in speeds]
    full = replace(plate, sets={"TIP": np.array([3, 5])}, speeds=tuple(speeds))
    write(full, tmp_path / "one.npz")
    write(read(tmp_path / "one.npz").model, tmp_path / "two.json")
    back, was = document(read(tmp_path / "two.json").model), document(full)
    assert back.keys() == was.keys()
    assert all(np.array_equal(back[name], was[name]) for name in was)
    scaled = read(tmp_path / "one.npz")
    in_mm = in_si(replace(scaled, model=in_si(scaled, 1e3, 1e-3)), 1e-3, 1e3)
    assert in_mm.speeds[0].shapes == pytest.approx(full.speeds[0].shapes, rel=1e-14)
    with pytest.raises(ValueError, match=r"\.npz or \.json"):
        write(full, tmp_path / "one.csv")


def test_a_floor_that_is_given_its_normal_turns_with_the_structure() -> None:
    """A bar with precone: the load's parts by hand; turned as a whole at speed, as if the bar were laid so."""
    rotor, length = Rotor(hub_radius=0.1, precone=np.radians(6.0), stagger=np.radians(25.0)), 0.2
    nodes = 0.5 * (cell("hexahedron").nodes + 1.0) * [length, 0.02, 0.02] - [0.0, 0.01, 0.01]
    cells = (("hexahedron", np.arange(8)[None]),)
    still = modes(np.repeat(np.eye(3)[2][None, None], 8, axis=1))
    model = ModalModel(nodes, (still,), rotor.axis, -0.1 * rotor.outwards, cells)
    at, x, z = place(model, np.array([length, 0.0, 0.0])), np.eye(3)[0], np.eye(3)[2]
    faced, seen = floor(model, at, still, z), floor(model, at, still, z, 2.0 * x)
    radius = 0.1 + length * np.cos(rotor.precone)
    assert faced.radius == seen.radius == pytest.approx(radius, rel=1e-12)
    assert not faced.lean.any()
    assert seen.pressing == pytest.approx(radius * np.cos(rotor.precone), rel=1e-12)
    across = -radius * np.sin(rotor.precone) * np.array([np.cos(rotor.stagger), np.sin(rotor.stagger)])
    np.testing.assert_allclose(seen.axes, [z, np.cross(z, x)], atol=1e-12)
    np.testing.assert_allclose(seen.lean, across, rtol=1e-12)
    turn = Rotation.from_rotvec([0.0, 0.1, -0.2]).as_matrix()
    moved = replace(still, static=nodes @ (turn - np.eye(3)).T)
    laid = ModalModel(nodes @ turn.T, (still,), rotor.axis, -0.1 * rotor.outwards, cells)
    turned, expected = (floor(model, at, moved, z, x), floor(laid, place(laid, turn @ at.point), still, z, turn @ x))
    np.testing.assert_allclose(turned.normal, turn @ x, atol=1e-12)
    np.testing.assert_allclose(turned.lean, expected.lean, rtol=1e-10)
    with pytest.raises(NoMotion, match="the load does not press the ball onto a floor with this normal"):
        floor(model, at, still, z, -x)
