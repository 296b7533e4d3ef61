"""Shapes between the vertices of a coarse mesh: the elements' own functions, on a mesh without gaps."""

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from fem import Effects, Material, Plate, Rotor, assemble, displacement, rectangle, solve_modes
from fem.output import between

STEEL = Material(200e9, 0.3, 7850.0)
LENGTH, WIDTH, THICKNESS = 0.2, 0.08, 0.004


def solved(mesh, theory, count=3):
    operators = assemble(Plate(mesh, THICKNESS, STEEL), Rotor(), Effects(), theory)
    return operators, solve_modes(operators, 0.0, count).shapes


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
    fine, fine_shapes = solved(rectangle(LENGTH, WIDTH, 40, 16), "kirchhoff")
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
