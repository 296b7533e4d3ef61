"""Frequencies that others computed or derived, each at the tolerance of its source."""

import numpy as np
import pytest
from fem_cases import (
    AT_REST,
    BENT,
    FLAT,
    STEEL,
    WRIGHT,
    beam_rates,
    calculix,
    calculix_cases,
    frequencies,
    paper_plate,
    rpm,
)
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar

from fem import Effects, Material, Plate, Rotor, assemble, campbell, rectangle, solve_modes

# The source of WRIGHT: (hub radius / length, gamma) -> flap frequencies from the first.
WRIGHT_MORE = {
    (0.0, 0): (3.5160, 22.0345, 61.6972),
    (0.0, 2): (4.1373, 22.6149, 62.2732),
    (0.0, 10): (11.2023, 33.6404, 74.6493),
    (1.0, 2): (4.8337,),
    (1.0, 10): (16.6064,),
}
# Table II of the paper.
TABLE_II = {3500: 208.9, 5000: 218.8, 7500: 241.3, 10000: 269.5, 12500: 301.7, 15000: 336.7, 17500: 373.5}


LAG = np.sqrt(WRIGHT**2 - np.arange(13) ** 2)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff"])
@pytest.mark.parametrize(
    ("family", "shape", "expected", "rtol"),
    [
        ("flap", {}, WRIGHT, 1e-4),
        ("flap", {"stagger": np.pi / 2}, LAG, 1e-4),
        ("lag", {"width": 0.005, "nx": 80}, LAG, 2e-4),
    ],
    ids=["flap", "lag by stagger", "lag in the plane"],
)
def test_rotating_beam(theory, family, shape, expected, rtol):
    found = np.array([f[0] for f in beam_rates(theory, family, range(13), **shape)])
    np.testing.assert_allclose(found, expected, rtol=rtol)


@pytest.mark.parametrize("case", WRIGHT_MORE)
def test_rotating_beam_higher_modes_and_hub(case):
    (hub, gamma), expected = case, WRIGHT_MORE[case]
    (found,) = beam_rates("mindlin", "flap", [gamma], hub=hub)
    np.testing.assert_allclose(found[: len(expected)], expected, rtol=1e-4)


@pytest.mark.parametrize("theory", ["kirchhoff/bfs", "kirchhoff/argyris", "mindlin"])
@pytest.mark.parametrize("h", [1e-3, 1e-4, 1e-5])
def test_thin_square_cantilever(theory, h):
    """Converged thin-plate values of omega a² sqrt(rho h / D), below Barton's upper bounds (1951), to 0.1 %."""
    converged = np.array([3.471, 8.507, 21.285, 27.199, 30.956, 54.187])
    barton = np.array([3.492, 8.525, 21.43, 27.33, 31.11, 54.44])
    mesh = rectangle(1.0, 1.0, 8, 8)
    plate = Plate(mesh.to_meshtri() if theory == "kirchhoff/argyris" else mesh, h, STEEL)
    bending = STEEL.youngs_modulus * h**3 / 12.0 / (1.0 - STEEL.poissons_ratio**2)
    found = 2.0 * np.pi * frequencies(plate, None, AT_REST, theory) * np.sqrt(STEEL.density * h / bending)
    np.testing.assert_allclose(found, converged, rtol=1e-3)
    assert (found < barton).all()


@pytest.mark.parametrize(
    ("theory", "cells", "expected", "tolerance"),
    [
        ("mindlin", (40, 16), (207.21, 1033.2), 2e-4),
        ("kirchhoff", (20, 8), (208.24, 1082.96), 2e-4),
        ("solid", (20, 10), (207.54, 1034.6), 3e-3),
    ],
)
def test_paper_plate_at_rest(theory, cells, expected, tolerance):
    """First bending and twist by independent codes: Mindlin (kappa = 5/6, hard clamp), Kirchhoff, CalculiX 80x32x2."""
    found = frequencies(paper_plate(*cells), None, AT_REST, theory, count=2)
    np.testing.assert_allclose(found, expected, rtol=tolerance)


@pytest.mark.parametrize(
    ("theory", "rotary", "modulus", "worst"),
    [
        ("kirchhoff", True, 182.42e9, 3.6e-4),
        ("mindlin", False, 184.35e9, 7.0e-4),
        ("mindlin", True, 184.73e9, 1.11e-3),
    ],
)
def test_table_two_needs_one_number(theory, rotary, modulus, worst):
    """One Young's modulus, fitted here so that the largest error of the seven rows is least, brings them together.

    The printed table fits thin-plate theory best. With shear and rotary inertia no modulus brings all rows within
    0.1 %: rotary inertia divides the stiffening, which the modulus cannot scale, by 1.001. Frequencies over the root
    of the modulus hang on nothing but the speed over that root.
    """
    mesh = rectangle(0.2, 0.08, 10, 4) if theory == "kirchhoff" else rectangle(0.2, 0.08, 20, 8)
    operators = assemble(Plate(mesh, 0.01, STEEL), Rotor(), Effects(rotary_inertia=rotary), theory)
    speeds, printed = rpm(np.array(list(TABLE_II))), np.array(list(TABLE_II.values()))
    roots = np.sqrt(np.array([180e9, 190e9]) / STEEL.youngs_modulus)
    every = np.linspace(speeds.min() / roots[1], speeds.max() / roots[0], 60)
    square = CubicSpline(every**2, campbell(operators, every, 1, tolerance=1e-8).frequencies_hz[:, 0] ** 2)

    def error(e):
        root = np.sqrt(e / STEEL.youngs_modulus)
        return root * np.sqrt(square((speeds / root) ** 2)) / printed - 1.0

    best = minimize_scalar(
        lambda e: np.abs(error(e * 1e9)).max(), bounds=(180, 190), method="bounded", options={"xatol": 0.01}
    )
    assert best.x * 1e9 == pytest.approx(modulus, abs=0.02e9)
    assert np.abs(error(modulus)).max() < worst


@pytest.mark.parametrize("stagger", [0.0, 90.0])
@pytest.mark.parametrize("softening", [True, False])
def test_calculix(stagger, softening):
    """Six modes at every speed; CalculiX's own mesh error is 0.05 %."""
    operators = assemble(paper_plate(), Rotor(stagger=np.deg2rad(stagger)), Effects(spin_softening=softening))
    table = {
        speed: f for (angle, softened, speed), f in calculix().items() if (angle, softened) == (stagger, softening)
    }
    assert len(table) == 7 + (not softening and stagger == 0.0)
    for speed, expected in table.items():
        np.testing.assert_allclose(solve_modes(operators, rpm(speed), 6).frequencies_hz, expected, rtol=3.5e-3)


@pytest.mark.parametrize("stagger", [0.0, 90.0])
def test_calculix_by_bricks(stagger):
    """The solid model's first three modes within 0.3 % at every speed."""
    operators = assemble(paper_plate(18, 9), Rotor(stagger=np.deg2rad(stagger)), Effects(), "solid")
    table = {speed: f[:3] for (angle, softened, speed), f in calculix().items() if angle == stagger and softened}
    assert len(table) == 7
    found = campbell(operators, rpm(np.array(list(table))), 3).frequencies_hz
    np.testing.assert_allclose(found, list(table.values()), rtol=3e-3)


@pytest.mark.parametrize("case", calculix_cases())
def test_calculix_other_plates(case):
    """A thin plate with a hub, staggered ones that twist, a square one in the plane of rotation, a tip mass.

    Under a point force in its plane a sheet gives way like log(1 / cell): in-plane modes of a tip mass depend on the
    mesh, here and in CalculiX (2980 and 2960 Hz on two meshes for the fifth).
    """
    row, expected = calculix_cases()[case]
    number = {key: float(row[key]) for key in row if key not in ("case", "cells")}
    length, width, mass = number["length"], number["width"], number["mass"]
    plate = Plate(
        rectangle(length, width, 20, max(8, round(20 * width / length))),
        number["thickness"],
        Material(number["youngs_modulus"], number["poissons_ratio"], number["density"]),
        tip_mass=mass,
        tip_at=(length, 0.0) if mass else None,
    )
    rotor = Rotor(number["hub_radius"], np.deg2rad(number["stagger_deg"]))
    bent = 0.0 < number["stagger_deg"] < 90.0
    found = frequencies(plate, rotor, BENT if bent else FLAT, omega=rpm(number["rpm"]))
    np.testing.assert_allclose(found, expected, rtol=1e-2 if mass else 4e-3)
    if bent and row["case"] == "staggered titanium":
        straight = frequencies(plate, rotor, omega=rpm(number["rpm"]))
        assert np.abs(straight / expected - 1.0).max() > 1e-2  # the static twist counts
