"""The theories against each other, their rates, and the choice among them."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from fem_cases import AT_REST, BENT, FLAT, STEEL, STRIP, beam_rates, distorted, frequencies, paper_plate, rpm

from fem import (
    Effects,
    ElasticRoot,
    Material,
    Plate,
    Rectangle,
    Rotor,
    Unresolved,
    assemble,
    choose_theory,
    critical_speed,
    families,
    rectangle,
    solve_modes,
)
from fem.accuracy.theory_selection import theory_errors
from fem.accuracy.tolerances import Budget
from fem.theory.registry import solid_theory
from tests.benchmarks.calculix_tables import COUNT, TABLES, stored

# Euler-Bernoulli and longitudinal vibration of a bar, the smooth problems: nu = 0 has no corner singularities.
CANTILEVER = np.array([3.516015269, 22.034491565, 61.697214418])


def slope(sizes, errors):
    return -np.polyfit(np.log(sizes), np.log(errors), 1)[0]


def test_bending_rates():
    """Argyris's elements, of degree 5, converge as h^8 where nothing is singular; others on the square below."""
    sizes, errors = (3, 4), []
    for n in sizes:
        shape = {"width": 0.5, "height": 1e-4, "nx": n, "ny": max(1, n // 2), "triangles": True}
        (found,) = beam_rates("kirchhoff/argyris", "flap", [0.0], **shape)
        errors.append(abs(found[1] / CANTILEVER[1] - 1.0))
    assert slope(sizes, errors) > 7.6
    assert errors[-1] < 1e-6


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "solid"])
@pytest.mark.parametrize("triangles", [False, True])
def test_membrane_rates(theory, triangles):
    """Longitudinal vibration, omega = pi/2L sqrt(E/rho) at nu = 0: quadratic elements converge as h^4."""
    sizes, errors = (2, 3, 4), []
    for n in sizes:
        mesh = rectangle(1.0, 0.5, n, max(1, n // 2))
        plate = Plate(mesh.to_meshtri() if triangles else mesh, 0.3, STRIP)
        operators = assemble(plate, Rotor(), replace(AT_REST, rotary_inertia=False), theory)
        modes = solve_modes(operators, 0.0, 8)
        axial = modes.frequencies_hz[families(operators, modes).index("axial")]
        errors.append(abs(axial / (0.25 * np.sqrt(2e11 / 7850.0)) - 1.0))
    assert slope(sizes, errors) > 3.6
    assert errors[-1] < 1e-4


def test_a_square_bar_twists():
    """Saint-Venant: omega = pi/2L sqrt(G J / rho I), J = 0.1406 b^4, I = b^4 / 6: as much of it along y as along z."""
    plate = Plate(rectangle(0.2, 0.02, 16, 2), 0.02, STEEL)
    operators = assemble(plate, Rotor(), AT_REST, "solid")
    modes = solve_modes(operators, 0.0, 6)
    twist = modes.frequencies_hz[families(operators, modes).index("twist")]
    shear = STEEL.youngs_modulus / (2 * (1 + STEEL.poissons_ratio))
    assert twist == pytest.approx(np.sqrt(6 * 0.1406 * shear / STEEL.density) / (4 * 0.2), rel=0.01)


@pytest.mark.parametrize("kind", ["quads", "triangles"])
def test_thin_mindlin_tends_to_kirchhoff(kind):
    mesh = distorted(rectangle(0.2, 0.1, 12, 6), 0.004)
    plate = Plate(mesh if kind == "quads" else mesh.to_meshtri(), 1e-4, STEEL)
    thin, thick = (frequencies(plate, Rotor(0.1), FLAT, theory, 30.0) for theory in ("kirchhoff", "mindlin"))
    np.testing.assert_allclose(thick, thin, rtol=2e-3)


@pytest.mark.parametrize("height", [1e-3, 1e-4, 1e-5])
def test_thin_solid_is_a_beam(height):
    """Rounding grows with (L/h)², and no faster: at 1e-5 it is still far below the mesh's error."""
    (found,) = beam_rates("solid", "flap", [0.0], width=0.5, height=height, nx=8, ny=4)
    np.testing.assert_allclose(found[0], CANTILEVER[0], rtol=4e-3)


@pytest.mark.parametrize(("thickness", "locking"), [(0.1, 2e-3), (0.01, 1e-2)])
def test_a_solid_hardly_locks_on_distorted_cells_unless_it_is_thin(thickness, locking):
    """The figures that `fem.theory.solid` warns with."""
    regular = rectangle(1.0, 1.0, 8, 8)
    even, moved = (
        frequencies(Plate(mesh, thickness, STEEL), None, AT_REST, "solid", count=3)
        for mesh in (regular, distorted(regular, 0.25 / 8))
    )
    assert np.abs(moved / even - 1.0).max() < locking


@pytest.mark.parametrize("effects", [FLAT, Effects(coriolis=True), BENT])
@pytest.mark.parametrize(("height", "cells"), [(1e-6, (8, 2)), (1e-7, (4, 1)), (1e-8, (4, 1))])
def test_what_rounding_eats_up_does_not_diverge(effects, height, cells):
    """A plate at rest cannot: where so little is left of its stiffness, that is said; of 1e-6, on cells that small."""
    operators = assemble(Plate(rectangle(1.0, 0.25, *cells), height, STEEL), Rotor(), effects, "solid")
    for omega in (0.0, 1e-3):
        with pytest.raises(Unresolved, match="too thin for theory 'solid/2'"):
            solve_modes(operators, omega, 3)
    with pytest.raises(Unresolved):
        critical_speed(operators)


def test_morley_comes_from_below():
    square = Plate(rectangle(1.0, 1.0, 8, 8).to_meshtri(), 1e-3, STEEL)
    low, high = (frequencies(square, None, AT_REST, f"kirchhoff/{each}") for each in ("morley", "argyris"))
    assert (low < high).all()


@pytest.mark.parametrize(
    ("theory", "sizes", "thickness", "meshes_error"),
    [("kirchhoff", (4, 4), 0.004, 1e-4), ("mindlin", (4, 4), 0.004, 1e-3), ("solid", (3, 2), 0.012, 2e-3)],
)
def test_quads_and_triangles_agree(theory, sizes, thickness, meshes_error):
    """One plate, two kinds of mesh, at speed and under stagger: within the meshes' errors.

    A solid divides each triangle in three: on the same grid there are six times the bricks.
    """
    quads, split = (Rectangle(0.2, 0.08).mesh(size) for size in sizes)
    found = [
        frequencies(Plate(mesh, thickness, STEEL), Rotor(0.1, 0.6), FLAT, theory, rpm(6000), 4)
        for mesh in (quads, split.to_meshtri())
    ]
    np.testing.assert_allclose(found[0], found[1], rtol=meshes_error)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "solid"])
def test_turned_over_is_the_same_plate(theory):
    """Mirroring the stagger mirrors the plate: the frequencies stay."""
    left, right = (
        frequencies(paper_plate(6, 3), Rotor(0.1, angle), BENT, theory, rpm(9000), 4) for angle in (0.5, -0.5)
    )
    np.testing.assert_allclose(left, right, rtol=1e-9)


def choose(thickness, **asked):
    return choose_theory(Plate(Rectangle(0.2, 0.08).mesh(3), thickness, STEEL), **asked)


def test_choice_follows_thickness():
    chosen = {h: choose(h) for h in (1e-5, 0.01, 0.05)}
    assert [c.name for c in chosen.values()] == ["kirchhoff", "mindlin", "solid"]
    assert all(c.why for c in chosen.values())
    assert choose(0.01, accuracy=0.2).name == "kirchhoff"
    assert choose_theory(paper_plate(4, 2)).name == "mindlin"


def test_choice_keeps_its_word():
    """Where thin-plate theory is chosen for an accuracy, it is within half of that of Mindlin's."""
    thickness = 0.08 / 800
    assert choose(thickness, accuracy=1e-3).name == "kirchhoff"
    plate = Plate(Rectangle(0.2, 0.08).mesh(8), thickness, STEEL)
    thin, thick = (frequencies(plate, None, AT_REST, theory, count=2) for theory in ("kirchhoff", "mindlin"))
    np.testing.assert_allclose(thin, thick, rtol=5e-4)


def test_the_narrowest_part_decides():
    """Of a T whose arm is a tenth as wide as its tip, thin-plate theory has the twist 4 % too high."""
    case = TABLES["theories"]["T"]
    plate = Plate(case.planform.graded(2), case.thickness, Material(*case.material))
    assert choose_theory(plate, accuracy=1e-2).name == "mindlin"
    assert choose_theory(plate, accuracy=0.2).name == "kirchhoff"


def test_the_modes_asked_for_decide():
    """Shear matters the more, the shorter the waves: of a strip that bends, hardly; of its fortieth mode, much."""
    plate = Plate(Rectangle(0.2, 0.08).mesh(6), 0.0008, STEEL)
    assert choose_theory(plate, accuracy=1e-2, count=6).name == "kirchhoff"
    assert choose_theory(plate, accuracy=1e-2, count=40).name == "mindlin"


REFERENCE = stored("theories")
SMOOTH = [name for name in REFERENCE if name not in ("T", "L")]


@cache
def beside_calculix(name, theory):
    """True relative errors of a theory with a sign, estimates, and how uncertain the former are: mesh and CalculiX."""
    case = TABLES["theories"][name]
    found = []
    for fineness in (4, 6) if name == "T" else (2, 3):  # the arm of the T is narrow
        plate = Plate(case.planform.graded(fineness), case.thickness, Material(*case.material))
        operators = assemble(plate, Rotor(), AT_REST, theory)
        found.append(solve_modes(operators, 0.0, COUNT))
    (frequencies, _), (uncertain, _) = REFERENCE[name]
    coarse, fine = (modes.frequencies_hz for modes in found)
    true = fine / frequencies - 1.0
    estimate = theory_errors(operators, found[1].eigenvalues, found[1].shapes)
    return true, estimate, uncertain + np.abs(coarse / fine - 1.0)


@pytest.mark.parametrize(
    ("theory", "name"),
    [
        *((theory, name) for theory in ("mindlin", "mindlin/held") for name in REFERENCE),
        *(("kirchhoff", name) for name in REFERENCE if name not in ("tapered", "swept")),
    ],
)
def test_theories_own_errors(theory, name):
    """Against CalculiX: every mode within the estimate, and that not far above what the mesh's error lets be seen."""
    true, estimate, uncertain = beside_calculix(name, theory)
    assert (np.abs(true) <= estimate + uncertain).all()
    clear = np.abs(true) > 4.0 * uncertain
    assert (estimate[clear] < 5.0 * np.abs(true[clear])).all()


@pytest.mark.parametrize("name", SMOOTH)
def test_a_held_root_is_a_solids(name):
    """Mindlin's plates are too soft by what the clamp holds back, up to 0.4 % here; held, by a quarter of that."""
    (free, _, _), (held, _, uncertain) = (beside_calculix(name, theory) for theory in ("mindlin", "mindlin/held"))
    assert np.abs(held).max() <= 0.35 * np.abs(free).max() + uncertain.max()


def test_poissons_ratio_tells():
    """What the clamp does to a cantilever is about 0.29 nu² / (1 - nu) h/L, by comparison with solids."""
    for nu, constant in ((0.0, 0.006), (0.3, 0.04), (0.45, 0.10), (0.49, 0.135)):
        plate = Plate(Rectangle(0.2, 0.08).mesh(4), 0.004, Material(2e11, nu, 7850.0))
        operators = assemble(plate, Rotor(), AT_REST, "mindlin")
        modes = solve_modes(operators, 0.0, 3)
        flap = theory_errors(operators, modes.eigenvalues, modes.shapes)[0] * 0.2 / 0.004
        assert flap == pytest.approx(constant, abs=0.02)


@pytest.mark.parametrize(
    ("sides", "count", "least"), [((0.15, 0.02), 6, 1.0), ((0.3, 0.02), 6, 1.0), ((0.2, 0.08), 4, 1 / 3)]
)
def test_layers_of_a_solid(sides, count, least):
    """What two of them leave is as estimated; in torsion of a bar it does not fall with the length, as in bending."""
    plate = Plate(Rectangle(*sides).mesh(1), 0.01, STEEL)
    two, six = (frequencies(plate, None, AT_REST, theory, count=count) for theory in ("solid", "solid/6"))
    true = float((two / six - 1.0).max())
    assert true > 1e-3 or sides[1] > 0.02
    assert least * true < solid_theory(sides, 0.01, Budget(1e-2).layers)[1] < 3.0 * true


def test_more_layers_where_more_is_asked_for():
    names = [solid_theory((0.2, 0.08), 0.01, Budget(asked).layers)[0] for asked in (1e-2, 1e-3, 1e-4)]
    assert names == ["solid/2", "solid/4", "solid/6"]


@cache
def of_the_square(theory, size, triangles, thickness):
    mesh = Rectangle(1.0, 1.0).mesh(size)
    return frequencies(Plate(mesh.to_meshtri() if triangles else mesh, thickness, STEEL), None, AT_REST, theory)


@pytest.mark.parametrize(
    ("theory", "triangles", "thickness", "sizes", "order", "finest"),
    [
        ("kirchhoff/bfs", False, 1e-3, (2, 4, 8), 4.0, 1e-5),
        ("kirchhoff/argyris", True, 1e-3, (1, 2, 4), 4.5, 1e-5),
        ("kirchhoff/morley", True, 1e-3, (4, 8, 16), 2.0, 1e-2),
        ("mindlin", False, 0.05, (2, 4, 8), 4.0, 3e-5),
        ("mindlin", True, 0.05, (2, 4, 8), 3.6, 1e-4),
    ],
)
def test_rates_on_the_square_cantilever(theory, triangles, thickness, sizes, order, finest):
    """Six modes on cells graded towards the edges, singular corners and edge layers included.

    Cubic and quadratic elements should fall with the fourth power of the cell size, Morley's with the second; that
    Argyris's, of degree five, do not reach the eighth is the corners' doing. The limit is that of a far finer mesh.
    """
    finer = ("mindlin", 16) if theory == "mindlin" else ("kirchhoff/bfs", 14)
    limit = of_the_square(*finer, False, thickness)
    errors = [np.abs(of_the_square(theory, size, triangles, thickness) / limit - 1.0).max() for size in sizes]
    assert slope(sizes, errors) == pytest.approx(order, abs=0.4)
    assert errors[-1] < finest


def thin(theory, height, width, cells, root, triangles):
    """Frequencies over thickness of a plate 1 m long; springs of a root bend with it."""
    mesh = rectangle(1.0, width, *cells)
    springs = None if root is None else ElasticRoot(root[0] * 2e11 * height**3, root[1] * 2e11 * height**3)
    plate = Plate(mesh.to_meshtri() if triangles else mesh, height, STEEL, elastic_root=springs)
    return frequencies(plate, None, AT_REST, theory, count=3) / height


@pytest.mark.parametrize(
    ("theory", "height", "width", "cells", "root", "triangles"),
    [
        ("mindlin", 2e-5, 0.09, (17, 4), (1e2, 1.0), True),
        ("kirchhoff", 2e-6, 0.068, (25, 7), (1e2, 1.0), True),
        ("mindlin/held", 2e-7, 0.672, (21, 10), (2.27, 2.27), False),
        ("solid", 2e-6, 1.335, (20, 4), None, False),
        ("solid", 2e-5, 0.37, (37, 4), (0.221, 0.221), False),
    ],
)
def test_a_thin_plate_keeps_its_frequencies_or_is_refused(theory, height, width, cells, root, triangles):
    """Frequencies go with the thickness of a thin plate: rounding took from 0.3 % of the first to all of it."""
    thicker = thin(theory, 2e-4, width, cells, root, triangles)
    try:
        found = thin(theory, height, width, cells, root, triangles)
    except Unresolved:
        return
    np.testing.assert_allclose(found, thicker, rtol=1e-3)


def test_what_double_precision_does_not_tell_apart_is_no_mode():
    """Of all the modes of a thin solid the lowest beside the stiffest came out as NaN."""
    operators = assemble(Plate(rectangle(1.0, 0.4, 1, 1), 2e-5, STEEL), Rotor(), AT_REST, "solid")
    with pytest.raises(Unresolved):
        solve_modes(operators, 0.0, operators.mass.shape[0])
