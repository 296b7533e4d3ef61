"""Mesh files, good and bad, and finding places in them."""

from functools import cache
from pathlib import Path

import meshio
import numpy as np
import pytest
import skfem
from fem_cases import AT_REST, BENT, STEEL, distorted, frequencies, rpm
from scipy.interpolate import RegularGridInterpolator

from fem import MeshError, Plate, Rotor, assemble, displacement, read_mesh, rectangle, reduce_at, solve_modes
from fem.meshes.planform import clamped_length, locate
from fem.output import between
from meshes import make

MESHES = Path(__file__).parents[2] / "meshes"


def cells_of(mesh):
    return [("quad" if mesh.t.shape[0] == 4 else "triangle", mesh.t.T)]


def flat(mesh):
    return np.round(np.column_stack([mesh.p.T, np.zeros(mesh.p.shape[1])]), 6)


def write(path, points, cells):
    data = [np.ones(len(c), dtype=np.int32) for _, c in cells]
    tags = {"gmsh:physical": data, "gmsh:geometrical": data} if path.suffix == ".msh" else {}
    meshio.write(path, meshio.Mesh(points, cells, cell_data=tags), **({"file_format": "gmsh22"} if tags else {}))
    return path


@pytest.mark.parametrize("suffix", [".msh", ".vtu", ".inp", ".bdf"])
@pytest.mark.parametrize("kind", ["quads", "triangles"])
def test_formats(tmp_path, suffix, kind, capfd):
    mesh = distorted(rectangle(0.2, 0.08, 5, 3), 0.005)
    mesh = mesh if kind == "quads" else mesh.to_meshtri()
    again = read_mesh(write(tmp_path / f"plate{suffix}", flat(mesh), cells_of(mesh)))
    assert type(again).__name__ == type(mesh).__name__
    first, second = (frequencies(Plate(each, 0.01, STEEL), effects=AT_REST, count=3) for each in (mesh, again))
    np.testing.assert_allclose(first, second, rtol=1e-5)  # .bdf carries few digits
    assert capfd.readouterr() == ("", "")


def test_second_order_cells_and_helpers(tmp_path):
    """Corners of 8-node quadrilaterals are used; boundary lines and points that no cell uses are left aside."""
    p = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0], [1, 0, 0], [2, 0.5, 0], [1, 1, 0], [0, 0.5, 0], [9, 9, 9]]
    path = tmp_path / "one.vtu"
    cells = [("quad8", np.arange(8)[None]), ("line3", np.array([[0, 1, 4]])), ("vertex", np.array([[8]]))]
    meshio.write(path, meshio.Mesh(np.array(p, dtype=float), cells))
    mesh = read_mesh(path)
    assert mesh.p.shape == (2, 4)
    assert mesh.t.shape == (4, 1)


def test_mixed_cells_become_triangles(tmp_path):
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0.5, 0]], dtype=float)
    cells = [("quad", np.array([[0, 1, 2, 3]])), ("triangle", np.array([[1, 4, 2]]))]
    assert read_mesh(write(tmp_path / "mixed.msh", points, cells)).t.shape == (3, 3)


@pytest.mark.parametrize("step", [1, 2])
def test_cells_that_are_clockwise_are_turned(tmp_path, step):
    """All, as seen from below, or half of them; the plate is the same, its area 0.2 m times 0.08 m."""
    mesh = rectangle(0.2, 0.08, 4, 2)
    quads = mesh.t.T.copy()
    quads[::step] = quads[::step, ::-1]
    x, y = (found := read_mesh(write(tmp_path / "half.msh", flat(mesh), [("quad", quads)]))).p[:, found.t]
    areas = 0.5 * (x * np.roll(y, -1, axis=0) - y * np.roll(x, -1, axis=0)).sum(axis=0)
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(0.2 * 0.08, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "message"),
    [("a.step", "STEP is geometry without a mesh"), ("a.igs", "IGES is geometry"), ("a.bdf", "without BEGIN BULK")],
)
def test_files_without_a_mesh_say_what_to_do(tmp_path, name, message):
    (tmp_path / name).write_text("GRID,1,,0.,0.,0.\n", encoding="utf-8")
    with pytest.raises(MeshError, match=message):
        read_mesh(tmp_path / name)


def bad_meshes():
    good = rectangle(0.2, 0.08, 3, 2)
    points, quads = flat(good), good.t.T
    bumped = points.copy()
    bumped[5, 2] = 0.01
    far = np.vstack([points, points + np.array([1.0, 0.0, 0.0])])
    tilted = points @ np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    bent = points.copy()
    bent[:, 0] += 0.05 * np.clip(points[:, 1], 0.0, None)
    arc = rectangle(0.2, 0.08, 3, 5)
    arc = type(arc)(arc.p + np.array([[5.0], [0.0]]) * np.where(arc.p[0] == 0.0, arc.p[1] ** 2, 0.0), arc.t)
    notched = rectangle(0.2, 0.08, 3, 3)
    middle = notched.p[:, notched.t].mean(axis=1)
    kept = ~((middle[0] < 0.07) & (np.abs(middle[1]) < 0.01))
    crossed = quads.copy()
    crossed[0] = crossed[0, [0, 2, 1, 3]]
    tetra = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    return {
        "crossed": (points, [("quad", crossed)], "cells are inverted or flat"),
        "bumped": (bumped, [("quad", quads)], r"plane of constant z.*as \[blade\] mesh"),
        "disconnected": (far, [("quad", np.vstack([quads, quads + len(points)]))], "2 parts"),
        "no root": (tilted, [("quad", quads)], "nothing to clamp"),
        "bent root": (bent, [("quad", quads)], r"beyond \(0, 0\) its edge continues at 2.9° .* of length 0.04"),
        "curved root": (flat(arc), cells_of(arc), r"not straight: .* at 9.1° to the clamped part, of length 0.016"),
        "two feet": (
            flat(notched),
            [("quad", notched.t.T[kept])],
            r"into 2 runs \(y from -0.04 to -0.013333, 0.013333 to 0.04\)",
        ),
        "solid": (tetra, [("tetra", np.array([[0, 1, 2, 3]]))], "has tetra: mesh the surface at mid-thickness"),
        "lines": (points, [("line", quads[:, :2])], "no triangles and no quadrilaterals"),
        "touching": (
            np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 1, 0], [2, 2, 0], [1, 2, 0]], dtype=float),
            [("quad", np.array([[0, 1, 2, 3], [2, 4, 5, 6]]))],
            "2 parts",
        ),
    }


@pytest.mark.parametrize("case", bad_meshes())
def test_bad_meshes(tmp_path, case):
    points, cells, message = bad_meshes()[case]
    path = write(tmp_path / "bad.msh", points, cells)
    with pytest.raises(MeshError, match=message) as caught:
        read_mesh(path)
    assert str(path) in str(caught.value)


def test_folded_triangles_are_refused():
    """scikit-fem forgets the orientation of triangles; two on the same side of their common edge overlap."""
    points = np.array([[0.0, 0.0, 1.0, 0.9], [0.0, 1.0, 0.4, 0.6]])
    with pytest.raises(MeshError, match="folded"):
        Plate(skfem.MeshTri(points, np.array([[0, 0], [1, 1], [2, 3]])), 0.01, STEEL)


def test_not_a_surface():
    with pytest.raises(MeshError, match="triangles or quadrilaterals"):
        Plate(skfem.MeshTet(), 0.01, STEEL)


@pytest.mark.parametrize("path", sorted(MESHES.glob("*.msh")), ids=lambda p: p.stem)
def test_shipped_meshes(path):
    """Each is read, and its first modes are good to 1 % beside those with every cell split in four."""
    mesh = read_mesh(path)
    coarse, fine = (
        frequencies(Plate(cells, 0.01, STEEL), omega=rpm(5000), count=3) for cells in (mesh, mesh.refined(1))
    )
    assert np.abs(coarse / fine - 1.0).max() < 1e-2


def test_shipped_meshes_are_what_the_script_makes(tmp_path, monkeypatch):
    monkeypatch.setattr(make, "HERE", tmp_path)
    make.main()
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(
        p.name for kind in ("msh", "inp") for p in MESHES.glob(f"*.{kind}")
    )
    for path in tmp_path.iterdir():
        assert path.read_text() == (MESHES / path.name).read_text()


@pytest.mark.parametrize("triangles", [False, True])
def test_locate(triangles):
    mesh = distorted(rectangle(0.2, 0.08, 6, 4), 0.004)
    mesh = mesh.to_meshtri() if triangles else mesh
    rng = np.random.default_rng(0)
    places = [(0.2, 0.0), (0.2, 0.04), (0.0, -0.04), *rng.uniform([0.0, -0.04], [0.2, 0.04], (20, 2))]
    for place in places:
        cell, reference = locate(mesh, place)
        back = mesh.mapping().F(reference[:, None, None], tind=np.array([cell]))[:, 0, 0]
        np.testing.assert_allclose(back, place, atol=1e-12)
    with pytest.raises(ValueError, match="does not lie on the plate"):
        locate(mesh, (0.21, 0.0))


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "solid"])
@pytest.mark.parametrize("drawn_at", [0.15, -3.0])
def test_a_plate_is_the_same_wherever_its_mesh_draws_it(theory, drawn_at):
    """The hub's radius ends at the clamped root: load, stagger, point mass and reduction do not know x = 0."""
    found, there = drawn(theory, 0.0), drawn(theory, drawn_at)
    np.testing.assert_allclose(there, found, rtol=1e-9)
    assert found[-1] == pytest.approx(0.3, rel=1e-14)


@cache
def drawn(theory, x):
    mesh = rectangle(0.2, 0.08, 4, 2).translated((x, 0.0))
    plate = Plate(mesh, 0.004, STEEL, tip_mass=0.05, tip_at=(x + 0.2, 0.0))
    operators = assemble(plate, Rotor(0.1, 0.6), BENT, theory)
    felt = reduce_at(operators, rpm(8000), (x + 0.15, 0.01), ball_mass=0.002)
    modes = solve_modes(operators, rpm(8000), 4).frequencies_hz
    return [*modes, felt.f1_hz, felt.M1, felt.M2, felt.floor_tilt, operators.radius(x + 0.2)]


@pytest.mark.parametrize("suffix", [".msh", ".vtu"])
def test_a_root_with_noise_is_clamped_all_along(tmp_path, suffix):
    """A micrometre of noise in cells of 20 mm: the frequencies of the plain mesh, however often it is refined."""
    mesh = rectangle(0.2, 0.08, 10, 4)
    known = frequencies(Plate(mesh, 0.01, STEEL), effects=AT_REST, count=3)
    for seed in range(3):
        points = mesh.p.copy()
        points[0] += np.where(mesh.p[0] == 0.0, np.random.default_rng(seed).uniform(-1e-6, 1e-6, mesh.p.shape[1]), 0.0)
        noisy = type(mesh)(points, mesh.t)
        assert clamped_length(noisy) == pytest.approx(0.08, rel=1e-6)
        drawn = np.column_stack([points.T, np.zeros(points.shape[1])])
        again = read_mesh(write(tmp_path / f"noisy{suffix}", drawn, cells_of(mesh)))
        assert clamped_length(again.refined(3)) == pytest.approx(0.08, rel=1e-12)
        found = frequencies(Plate(again, 0.01, STEEL), effects=AT_REST, count=3)
        np.testing.assert_allclose(found, known, rtol=2e-5)  # 1e-6 of 0.2 m, squared in the frequency


def test_a_seam():
    """Two halves joined along part of their common line: what was meant, and what is a slit, cannot be told."""
    mesh = rectangle(0.2, 0.08, 4, 2)
    middle = np.flatnonzero(np.isclose(mesh.p[1], 0.0) & (mesh.p[0] > 0.12))
    upper = mesh.p[1, mesh.t].mean(axis=0) > 0.0
    own = mesh.p.shape[1] + np.arange(middle.size)
    cells = mesh.t.copy()
    for old, new in zip(middle, own, strict=True):
        cells[:, upper] = np.where(cells[:, upper] == old, new, cells[:, upper])
    cracked = type(mesh)(np.hstack([mesh.p, mesh.p[:, middle]]), cells)
    with pytest.raises(MeshError, match=r"2 points coincide with others, the first one at \(0\.15, 0\): merge them"):
        Plate(cracked, 0.01, STEEL)
    points = cracked.p.copy()
    points[1, own] += 1e-6
    Plate(type(mesh)(points, cells), 0.01, STEEL)


LENGTH, WIDTH, THICKNESS = 0.2, 0.08, 0.004


def solved(mesh, theory, count=3):
    operators = assemble(Plate(mesh, THICKNESS, STEEL), Rotor(), AT_REST, theory)
    return operators, solve_modes(operators, 0.0, count).shapes


FINE = cache(lambda: solved(rectangle(LENGTH, WIDTH, 40, 16), "kirchhoff"))


def coarse(triangles):
    mesh = rectangle(LENGTH, WIDTH, 4, 2)
    return mesh.to_meshtri() if triangles else mesh


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin", "solid"])
@pytest.mark.parametrize("triangles", [False, True])
def test_whole_cells_are_the_vertices(theory, triangles):
    operators, shapes = solved(coarse(triangles), theory)
    count = operators.plate.mesh.p.shape[1]
    found = between(operators, shapes, 1)
    np.testing.assert_array_equal(found.mesh.p[:, :count], operators.plate.mesh.p)
    np.testing.assert_allclose(found.displacement[:, :count], displacement(operators, shapes), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin"])
@pytest.mark.parametrize("triangles", [False, True])
def test_between_them_the_shape_is_that_of_a_finer_mesh(theory, triangles):
    """The second bending mode on four cells, against one of 40: straight lines between vertices are far off."""
    operators, shapes = solved(coarse(triangles), theory)
    found = between(operators, shapes, 4)
    fine, fine_shapes = FINE()
    for number in range(3):
        w = displacement(fine, fine_shapes)[number, :, 2]
        exact = sampled(fine.plate.mesh.p, w, found.mesh.p.T, "cubic")
        ours = found.displacement[number, :, 2]
        share = exact @ ours / (ours @ ours)
        off = np.abs(share * ours - exact).max() / np.abs(exact).max()
        straight = sampled(operators.plate.mesh.p, displacement(operators, shapes)[number, :, 2], found.mesh.p.T)
        far = np.abs(share * straight - exact).max() / np.abs(exact).max()
        assert off < 0.04
        if number == 2:
            assert far > 2 * off, "what the vertices alone would show"


def sampled(points, values, places, method="linear"):
    x, y = (np.unique(np.round(along, 12)) for along in points)
    table = values[np.lexsort((points[1], points[0]))].reshape(len(x), len(y))
    return RegularGridInterpolator((x, y), table, method=method)(np.clip(places, [x[0], y[0]], [x[-1], y[-1]]))


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin"])
@pytest.mark.parametrize("triangles", [False, True])
@pytest.mark.parametrize("parts", [2, 3, 4])
def test_parts_fit_together(theory, triangles, parts):
    """No gap, no overlap: the area, the boundary and the lines of the cells are the plate's."""
    operators, shapes = solved(coarse(triangles), theory)
    found = between(operators, shapes, parts)
    x, y = found.mesh.p[:, found.mesh.t]
    twice = (x * np.roll(y, -1, axis=0) - y * np.roll(x, -1, axis=0)).sum(axis=0)
    assert 0.5 * np.abs(twice).sum() == pytest.approx(LENGTH * WIDTH)
    rim = found.mesh.p[:, found.mesh.facets[:, found.mesh.boundary_facets()]]
    assert np.linalg.norm(rim[:, 1] - rim[:, 0], axis=0).sum() == pytest.approx(2 * (LENGTH + WIDTH))
    edges = operators.plate.mesh.p[:, operators.plate.mesh.facets]
    lines = found.mesh.p[:, found.lines.T]
    lengths = [np.linalg.norm(ends[:, 1] - ends[:, 0], axis=0) for ends in (edges, lines)]
    assert lengths[1].sum() == pytest.approx(lengths[0].sum())
    assert len(found.lines) == parts * edges.shape[-1]
    assert len(np.unique(np.round(found.mesh.p, 12), axis=1).T) == found.mesh.p.shape[1], "no point twice"
    assert found.displacement.shape == (3, found.mesh.p.shape[1], 3)
