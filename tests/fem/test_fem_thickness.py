"""Thickness that varies over the planform: exact tapers, the theories among each other, CalculiX."""

from dataclasses import dataclass

import numpy as np
import pytest
from fem_cases import AT_REST, BENT, FLAT, STEEL, STRIP, builder, check_tangent, distorted, frequencies, unit_of
from scipy.integrate import quad

from fem import (
    ElasticRoot,
    Material,
    Plate,
    Rectangle,
    Rotor,
    assemble,
    choose_mesh,
    equilibrium,
    rectangle,
    solve_modes,
)
from fem.assembly import transfer
from fem.linalg import factorise
from fem.meshes.mesh_sequence import Given
from fem.meshes.thickness import SLOPE, Bilinear, Nodal, Polynomial, slope
from fem.theory.finite_rotation import Section
from fem.theory.registry import discretise
from tests.benchmarks.calculix_tables import COUNT, TABLES, stored

THEORIES = ("kirchhoff/bfs", "kirchhoff/argyris", "kirchhoff/morley", "mindlin", "solid")


WEDGES = {0.5: (3.8238, 18.3173), 0.2: (4.2925, 15.7427)}
"""First and second frequency of wedges by how thick the tip is, in sqrt(E I / rho A L^4) of the root.

Mabie and Rogers, J. Acoust. Soc. Am. 36 (1964) 463; Bessel functions have the same to the last digit.
"""


@pytest.mark.parametrize("ratio", WEDGES)
@pytest.mark.parametrize("theory", THEORIES)
def test_a_linear_taper(theory, ratio):
    """Thin enough that neither shear, rotary inertia nor the slope of the faces counts much."""
    h, cells, rtol = {"solid": (1e-2, 40, 3e-4), "kirchhoff/morley": (2e-3, 48, 1e-2)}.get(theory, (2e-3, 24, 1e-4))
    mesh = rectangle(1.0, 0.05, cells, 1)
    taper = Polynomial(((h,), ((ratio - 1.0) * h,)))
    plate = Plate(mesh.to_meshtri() if theory.endswith("morley") else mesh, taper, STRIP)
    rates = 2.0 * np.pi * frequencies(plate, None, AT_REST, theory, count=2) / unit_of(h)
    np.testing.assert_allclose(rates, WEDGES[ratio], rtol=rtol)


@dataclass(frozen=True)
class Exponential:
    """The bar whose stress is the same everywhere, with a mass at its tip that goes with it."""

    tip: float
    rate: float

    def at(self, points):
        return self.tip * np.exp(self.rate * (1.0 - points[0] ** 2))

    def near(self, place):
        return float(self.at(np.array(place)))


@pytest.mark.parametrize("theory", ["kirchhoff/bfs", "mindlin", "solid"])
def test_a_bar_of_constant_stress(theory):
    """h'/h = -rho x / sigma at 1 rad/s: the strain is sigma / E everywhere, but where the tip is pulled by points."""
    stress, width = 0.5 * STRIP.density, 0.02
    profile = Exponential(1e-3, STRIP.density / (2.0 * stress))
    plate = Plate(rectangle(1.0, width, 30, 2), profile, STRIP)
    operators = assemble(plate, Rotor(), FLAT, theory)
    pull = stress * width * profile.tip
    edge = tip_load(operators, pull / width)
    moved = factorise(operators.stiffness).solve(operators.load + edge)
    strain, expected = operators.model.gradient.evaluate(moved)[0], stress / STRIP.youngs_modulus
    np.testing.assert_allclose(strain[operators.model.points[0] < 0.8], expected, rtol=1e-4)


def tip_load(operators, per_width):
    """Force (n,) of a pull in N/m along the tip's edge, spread over the last cells' ends as a mass would be."""
    y, weights = np.polynomial.legendre.leggauss(5)
    width = np.ptp(operators.plate.mesh.p[1])
    rows = [
        w * 0.5 * width * operators.at_place((1.0, 0.5 * width * s)).rows[0][[0]]
        for s, w in zip(y, weights, strict=True)
    ]
    return per_width * sum(rows).toarray().ravel()


@pytest.mark.parametrize("theory", ["kirchhoff/bfs", "kirchhoff/argyris", "mindlin", "solid"])
@pytest.mark.parametrize("taper", [0.0, 1.0])
def test_the_stretch_of_a_bar(theory, taper):
    """u(L) = integral of N / (E b h), N the pull of all that lies outside, on a hub; without pull across the width.

    A solid is pulled apart through its thickness too, which the clamp hinders.
    """
    profile, hub = Polynomial(((4e-3,), (-5e-3 * taper,), (2.5e-3 * taper,))), 0.3
    plate = Plate(rectangle(1.0, 0.02, 20, 1), profile, STRIP)
    operators = assemble(plate, Rotor(hub, np.pi / 2), FLAT, theory)

    def height(x):
        return profile.near((x, 0.0))

    def pull(x):
        return STRIP.density * quad(lambda s: (hub + s) * height(s), x, 1.0)[0]

    expected = quad(lambda x: pull(x) / height(x) / STRIP.youngs_modulus, 0.0, 1.0)[0]
    found = (operators.at_place((1.0, 0.0)).rows[0] @ operators.prestress)[0]
    assert found == pytest.approx(expected, rel=1e-4 if theory == "solid" and taper else 1e-8)


PROFILES = {
    "polynomial": Polynomial(((0.01, -0.02), (-0.015, 0.05), (-0.03,))),
    "table": Bilinear((0.0, 0.2), (-0.04, 0.04), ((0.012, 0.008), (0.004, 0.005))),
}


@pytest.mark.parametrize("name", PROFILES)
@pytest.mark.parametrize("theory", ["kirchhoff/bfs", "kirchhoff/argyris", "mindlin", "solid"])
def test_mass_and_centre_and_inertia_of_sections(theory, name):
    """To rounding, but for bricks, which follow a polynomial of third degree by quadratics: to 1e-6."""
    profile = PROFILES[name]
    model = discretise(Plate(rectangle(0.2, 0.08, 6, 3), profile, STEEL), theory)
    x, y, z = model.points
    layers = [(layer.weight * model.displacement.dx, z + layer.z) for layer in model.inertia]
    found = [sum((dv * value).sum() for dv, _ in layers) for value in (1.0, x, y)]
    found.append(sum((dv * height**2).sum() for dv, height in layers))
    np.testing.assert_allclose(found, moments(profile), rtol=1e-12, atol=1e-18)


def moments(profile):
    """Integrals of h, h x, h y and h³/12 over 0.2 x 0.08 m, by Gauss."""
    t, weights = np.polynomial.legendre.leggauss(12)
    x, y = np.meshgrid(0.1 * (1.0 + t), 0.04 * t, indexing="ij")
    h, area = profile.at(np.stack([x, y])), 0.1 * 0.04 * np.outer(weights, weights)
    return tuple(float((area * value).sum()) for value in (h, h * x, h * y, h**3 / 12.0))


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin", "solid"])
@pytest.mark.parametrize("size", [1, 2, 4])
@pytest.mark.parametrize("triangles", [False, True])
def test_a_field_stays_the_same_function_on_finer_meshes(theory, size, triangles):
    """Volume and first moments of a field linear in x and y on distorted cells; of any field on all meshes alike."""
    mesh = distorted(rectangle(0.2, 0.08, 4, 2), 0.006)
    mesh = mesh.to_meshtri() if triangles else mesh
    plane = Polynomial(((0.01, 0.03), (-0.02,)))
    field = Nodal(mesh, plane.at(mesh.p))
    finer = Given(mesh).mesh(size)
    volume, *first, _ = moments(plane)
    model = discretise(Plate(finer, field, STEEL), theory)
    dx, (x, y, _) = model.displacement.dx * sum(layer.weight for layer in model.inertia), model.points
    np.testing.assert_allclose([dx.sum(), (dx * x).sum(), (dx * y).sum()], [volume, *first], rtol=1e-12)
    rough = Nodal(mesh, 0.01 * np.random.default_rng(1).uniform(0.5, 1.0, mesh.p.shape[1]))
    volumes = [
        (m.displacement.dx * sum(layer.weight for layer in m.inertia)).sum()
        for m in (discretise(Plate(on, rough, STEEL), theory) for on in (mesh, finer))
    ]
    tolerance = 2e-3 if theory == "kirchhoff" and not triangles else 1e-12  # two triangles have not a cell's points
    assert volumes[0] == pytest.approx(volumes[1], rel=tolerance)


@pytest.mark.parametrize("theory", THEORIES)
def test_a_profile_that_does_not_vary_is_a_constant(theory):
    """All matrices and the large deflection's own, in every theory."""
    mesh = rectangle(0.2, 0.08, 6, 3)
    mesh = mesh.to_meshtri() if theory.endswith("morley") else mesh
    rotor, omega = Rotor(0.1, 0.5), 900.0
    profiles = (4e-3, Polynomial(((4e-3,),)), Bilinear((0.0, 0.2), (0.0,), ((4e-3,), (4e-3,))))
    effects = BENT if theory in ("mindlin", "solid") else FLAT
    found = [frequencies(Plate(mesh, profile, STEEL), rotor, effects, theory, omega, 5) for profile in profiles]
    np.testing.assert_allclose(found[1:], [found[0]] * 2, rtol=1e-8)


ALIKE = {
    "on springs": (Plate(Rectangle(0.2, 0.08).mesh(3), 0.008, STEEL, elastic_root=ElasticRoot(2e9, 3e4)), 1e3, 4e-2),
    "thin taper": (
        Plate(Rectangle(0.2, 0.08).mesh(4), Polynomial(((1.2e-3, 0.0, -0.15), (-3e-3,))), STEEL),
        1200.0,
        6e-3,
    ),
}
"""A plate whose springs lower its lag by a quarter, and one that tapers along and across; how far thin-plate theory is
off: by 0.38 h/b in twist."""


@pytest.mark.parametrize("name", ALIKE)
@pytest.mark.parametrize("part", [0.0, 1.0])
def test_the_theories_agree(name, part):
    plate, top, rtol = ALIKE[name]
    theories = ("mindlin", "kirchhoff/bfs", "kirchhoff/argyris", *(["solid"] if name == "on springs" else []))
    thick, *others = (frequencies(plate, Rotor(0.1), FLAT, theory, part * top, 5) for theory in theories)
    for theory, found in zip(theories[1:], others, strict=True):
        np.testing.assert_allclose(found, thick, rtol=2e-3 if theory == "solid" else rtol, err_msg=theory)


def test_the_director_of_a_taper():
    """At a state far away."""
    plate = Plate(distorted(rectangle(0.2, 0.08, 3, 2), 0.01), PROFILES["polynomial"], STEEL)
    model = discretise(plate, "mindlin")
    assert isinstance(model.energies[0], Section)
    check_tangent(model, 1e-2, 1e-7, 1e-6, seed=2)


@pytest.mark.parametrize("name", ["tapered", "tapered, staggered"])
def test_blades_as_in_calculix(name):
    """Six modes of tapered plates, at rest and at speed, in Mindlin's theory and as solids."""
    compare(name, "mindlin", 4e-3, 5)


@pytest.mark.parametrize("name", [name for name in TABLES["blades"] if "precone" in name])
def test_cones_as_in_calculix(name):
    """Six modes of plates that leave the hub at an angle, some staggered or tapered, about the state they bend to."""
    compare(name, "mindlin", 4e-3, 3)


def test_a_thick_solid_blade_as_in_calculix():
    """To 0.1 %, h/b up to 0.2 and h/L up to 0.08."""
    compare("tapered, thick", "solid", 1e-3, 4)


def compare(name, theory, rtol, size):
    case = TABLES["blades"][name]
    frequencies, differences = stored("blades")[name]
    plate = Plate(Rectangle(0.2, 0.08).mesh(size), case.thickness, Material(*case.material))
    rotor = Rotor(case.hub, np.radians(case.stagger), np.radians(case.precone))
    operators = assemble(plate, rotor, BENT, theory)
    for omega, expected, difference in zip((0.0, case.omega), frequencies, differences, strict=True):
        found = solve_modes(operators, omega, COUNT).frequencies_hz
        np.testing.assert_array_less(np.abs(found / expected - 1.0), rtol + difference.max())


def test_what_is_not_a_thickness():
    mesh = rectangle(0.2, 0.08, 4, 2)
    for message, make in (
        (r"above 0 everywhere on the plate, but it is -0.001 m at \(0.2, ", lambda: Polynomial(((3e-3,), (-2e-2,)))),
        (r"x from 0 to 0.1 m, and the plate from 0 to 0.2 m", lambda: Bilinear((0.0, 0.1), (0.0,), ((4e-3,), (4e-3,)))),
        ("x must be in ascending order", lambda: Bilinear((0.2, 0.1), (0.0,), ((4e-3,), (4e-3,)))),
        ("2 rows, one for each x, of 1 numbers", lambda: Bilinear((0.0, 0.1), (0.0,), ((4e-3,),))),
        ("expected 15 values, one for each point", lambda: Nodal(mesh, np.ones(3))),
        ("do not lie within those", lambda: Nodal(rectangle(0.2, 0.08, 2, 4), np.ones(15))),
        ("but it is nan m", lambda: Nodal(mesh, np.full(15, np.nan))),
    ):
        with pytest.raises(ValueError, match=message):
            Plate(mesh, make(), STEEL)


@pytest.mark.parametrize(
    "profile",
    [Polynomial(((6e-3, 0.0, -0.8), (-15e-3,))), Bilinear((0.0, 0.07, 0.2), (0.0,), ((8e-3,), (4e-3,), (3e-3,)))],
)
@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin"])
def test_the_mesh_chosen_is_as_good_as_it_says(profile, theory):
    """Smooth: within the tolerance, and the estimate within twice what is left.

    With a kink inside cells two coarse meshes do not show how errors fall; what rests on them is doubted, and up to
    four times what is left.
    """
    planform = Rectangle(0.2, 0.08)
    build = builder(planform, profile, theory, Rotor(0.05))
    choice = choose_mesh(planform, build, (0.0, 600.0), 6, 1e-2)
    finer = build(2 * choice.size)
    found, limit = (
        np.array([solve_modes(each, omega, 6).frequencies_hz for omega in (0.0, 600.0)])
        for each in (choice.operators, finer)
    )
    errors = found / limit - 1.0
    assert np.abs(errors).max() < 1e-2
    largest = 2.0 if isinstance(profile, Polynomial) else 4.0
    assert choice.errors.max() / largest < np.abs(errors).max() < 2.0 * choice.errors.max()


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin"])
def test_a_large_deflection_goes_on_to_a_finer_mesh(theory):
    """The state on one mesh is nearly that on another: of a taper, whose rotations are kept in parts of h."""
    profile = Polynomial(((4e-3,), (-15e-3,)))
    coarse, fine = (
        assemble(Plate(rectangle(0.2, 0.08, 4 * n, 2 * n), profile, STEEL), Rotor(0.05, 0.7), BENT, theory)
        for n in (2, 3)
    )
    states = [equilibrium(operators, 800.0) for operators in (coarse, fine)]
    moved = transfer(states[0], coarse, fine)
    apart = moved - states[1]
    stiffness = fine.at(0.0)
    assert apart @ stiffness @ apart < 1e-2 * (states[1] @ stiffness @ states[1])


@pytest.mark.parametrize("thickness", [0.01, Polynomial(((0.02,), (-0.15,)))])
def test_what_the_slope_of_the_faces_costs(thickness):
    """A wedge whose faces slope by 0.075: bricks, extrapolated, are stiffer than Mindlin's plate, as far as is said."""

    def first(theory, size):
        return frequencies(Plate(Rectangle(0.1, 0.08).mesh(size), thickness, STRIP), None, AT_REST, theory)[0]

    coarse, fine = first("solid", 2), first("solid", 3)
    bricks = fine - (coarse - fine) / ((3.0 / 2.0) ** 3 - 1.0)
    missed = 1.0 - first("mindlin", 4) / bricks
    said = SLOPE * slope(thickness, rectangle(0.1, 0.08, 2, 2)) ** 2
    assert said == pytest.approx(0.0 if thickness == 0.01 else 0.7 * 0.075**2)
    assert 0.5 * said - 2e-4 < missed < said + 2e-4
