"""The Mindlin element itself: patches, spurious modes, locking, rates."""

import tracemalloc

import numpy as np
import pytest
from fem_cases import AT_REST, STEEL, distorted, frequencies

from fem import Plate, rectangle
from fem.assembly import elastic_stiffness
from fem.theory import kirchhoff, mindlin
from fem.theory import registry as theories

MESHES = {
    "quads": lambda n: rectangle(1.0, 1.0, n, n),
    "skewed quads": lambda n: distorted(rectangle(1.0, 1.0, n, n), 0.25 / n),
    "triangles": lambda n: rectangle(1.0, 1.0, n, n).to_meshtri(),
    "skewed triangles": lambda n: distorted(rectangle(1.0, 1.0, n, n).to_meshtri(), 0.2 / n),
}


@pytest.fixture
def free_plate(monkeypatch):
    """Discretise a plate that nothing clamps."""
    monkeypatch.setattr(mindlin, "clamped", lambda basis, plate: np.empty(0, dtype=np.int64))
    return lambda kind, thickness: mindlin.discretise(Plate(MESHES[kind](3), thickness, STEEL))


@pytest.mark.parametrize("thickness", [0.1, 1e-3])
@pytest.mark.parametrize("kind", MESHES)
def test_free_plate_has_six_rigid_motions_and_no_more(free_plate, kind, thickness):
    model = free_plate(kind, thickness)
    stiffness = elastic_stiffness(model).toarray()
    scale = 1.0 / np.sqrt(np.diag(stiffness))
    values = np.linalg.eigvalsh(stiffness * np.outer(scale, scale))
    assert np.abs(values[:6]).max() < 1e-11
    assert values[6] > 1e-8


@pytest.mark.parametrize("kind", MESHES)
def test_patch(free_plate, kind):
    """Constant membrane strain, curvature and shear are met exactly on any mesh."""
    model = free_plate(kind, 0.01)
    x, y, _ = model.points
    bent = 0.5 * x**2 + 0.25 * y**2 - x * y
    u, v, w, tx, ty = _interpolate(model, 2 * x + 3 * y, -y + x, bent, x - y, 0.5 * y - x)
    gradients = model.gradient.evaluate(u + v + w + tx + ty)
    expected = [2, 3, 1, -1, x - y, 0.5 * y - x, 1, -1, -1, 0.5]
    for found, value in zip(gradients, expected, strict=True):
        np.testing.assert_allclose(found, np.broadcast_to(value, x.shape), atol=1e-11)
    ((shear, _),) = model.extra
    np.testing.assert_allclose(shear.evaluate(w + tx + ty), 0.0, atol=1e-11)
    sheared = shear.evaluate(_interpolate(model, 0, 0, 3 * x - y, 0, 0)[2]).T
    np.testing.assert_allclose(sheared, np.broadcast_to([3.0, -1.0], sheared.shape), atol=1e-11)


def _interpolate(model, *targets):
    """Unknowns of each of u, v, w, theta_x, theta_y alone, for values at points of functions of degree two or less."""
    fields = []
    for target, block in zip(targets, model.displacement.blocks, strict=True):
        vector = np.zeros(model.dofs)
        target = np.broadcast_to(target, model.points[0].shape)
        for cell, dofs in enumerate(block.dofs):
            vector[dofs] = np.linalg.lstsq(block.table[cell, :, 0], target[cell], rcond=None)[0]
        fields.append(vector)
    return fields


@pytest.mark.parametrize("kind", MESHES)
def test_no_locking(kind):
    """omega / h tends to a constant as h/L goes from 1e-1 to 1e-5: it is what shear leaves of thin-plate theory."""
    found = {}
    for h in (1e-2, 1e-3, 1e-4, 1e-5):
        found[h] = frequencies(Plate(MESHES[kind](8), h, STEEL), effects=AT_REST) / h
    for h in (1e-4, 1e-5):
        np.testing.assert_allclose(found[h], found[1e-3], rtol=1e-4)
    np.testing.assert_allclose(found[1e-2], found[1e-3], rtol=3e-3)  # the true shear effect


@pytest.mark.parametrize("element", ["bfs", "argyris", "morley"])
def test_memory_of_an_assembly_grows_with_the_cells(element):
    """Four times the cells take four times the memory: nothing is as large as the square of their number."""
    peaks = []
    for n in (10, 20):
        mesh = rectangle(1.0, 1.0, 2 * n, 2 * n if element == "bfs" else n)
        plate = Plate(mesh if element == "bfs" else mesh.to_meshtri(), 0.01, STEEL)
        tracemalloc.start()
        try:
            theories.discretise(plate, f"kirchhoff/{element}")
            peaks.append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
    assert peaks[1] < 5.0 * peaks[0]


def test_what_rectangles_share_has_the_same_bits_after_any_plate(monkeypatch):
    """A plate does not depend on which was assembled before it in the same process."""

    def stiffness(length, width, before):
        monkeypatch.setattr(kirchhoff, "COMBINATIONS", {})
        for sides in (*before, (length, width)):
            plate = Plate(rectangle(*sides, 10, 4), 0.01, STEEL)
            found = elastic_stiffness(theories.discretise(plate, "kirchhoff/bfs")).toarray()
        return found

    alone = stiffness(0.2, 0.08, ())
    for other in ((0.2003, 0.03), (0.3, 0.1), (0.7, 0.047)):
        assert np.array_equal(stiffness(0.2, 0.08, (other,)), alone)
