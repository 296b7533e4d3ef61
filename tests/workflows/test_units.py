"""Units at the boundary: everything arrives in SI or not at all."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workflows.scene import units
from workflows.scene.units import Kind, UnitError, to_si

RIGHT = [
    ("20 cm", units.LENGTH, 0.2),
    ("2.5mm", units.LENGTH, 0.0025),
    ("1e-3 m", units.LENGTH, 1e-3),
    ("3 µm", units.LENGTH, 3e-6),
    ("1 in", units.LENGTH, 0.0254),
    ("184.35 GPa", units.PRESSURE, 184.35e9),
    ("210000 N/mm^2", units.PRESSURE, 210e9),
    ("7850 kg/m^3", units.DENSITY, 7850),
    ("7.85 g/cm^3", units.DENSITY, 7850),
    ("7.85 g/cm**3", units.DENSITY, 7850),
    ("3500 rpm", units.ROTATION, 3500 * math.pi / 30),
    ("3500 RPM", units.ROTATION, 3500 * math.pi / 30),
    ("50 rev/s", units.ROTATION, 100 * math.pi),
    ("100 rad/s", units.ROTATION, 100),
    ("45 deg", units.ANGLE, math.pi / 4),
    ("45°", units.ANGLE, math.pi / 4),
    ("269.5 Hz", units.FREQUENCY, 269.5),
    ("1.2 kHz", units.FREQUENCY, 1200),
    ("2 g", units.MASS, 0.002),
    ("10 m/s^2", units.ACCELERATION, 10),
    (0.2, units.LENGTH, 0.2),
    (7850, units.DENSITY, 7850),
]


@pytest.mark.parametrize(("value", "kind", "expected"), RIGHT)
def test_reads(value: object, kind: Kind, expected: float) -> None:
    assert to_si(value, kind) == pytest.approx(expected, rel=1e-15)


CUSTOMARY = [
    ("2 inch", units.LENGTH, 0.0508),
    ("2 inches", units.LENGTH, 0.0508),
    ("1.5 ft", units.LENGTH, 0.4572),
    ("3 feet", units.LENGTH, 0.9144),
    ("3 lb", units.MASS, 1.36077711),
    ("1 lb/in^3", units.DENSITY, 27679.904710203),
    ("1 psi", units.PRESSURE, 6894.7572931684),
    ("1 ksi", units.PRESSURE, 6894757.2931684),
    ("1 lbf/in^2", units.PRESSURE, 6894.7572931684),
    ("1 ft/s^2", units.ACCELERATION, 0.3048),
]


@pytest.mark.parametrize(("value", "kind", "expected"), CUSTOMARY)
def test_reads_customary_units(value: str, kind: Kind, expected: float) -> None:
    """From the exact inch (25.4 mm), pound (0.45359237 kg) and g (9.80665 m/s^2): NIST SP 811 (2008), appendix B."""
    assert to_si(value, kind) == pytest.approx(expected, rel=1e-13)


def test_g_is_gravity_in_loads_and_gram_in_masses() -> None:
    assert to_si("6000 g", units.LOAD, gravity=10.0) == 60_000
    assert to_si("6000 g", units.MASS) == 6
    with pytest.raises(UnitError):
        to_si("1 g", units.ACCELERATION)


WRONG = [
    ("5 kg", units.LENGTH, "expected a length such as '20 cm'"),
    ("50 Hz", units.ROTATION, "expected a rotation speed such as '3500 rpm'"),
    ("3500 rpm", units.FREQUENCY, "expected a frequency"),
    ("3 furlongs", units.LENGTH, "unknown unit 'furlongs'"),
    ("3 PSI", units.PRESSURE, "did you mean 'psi'?"),
    ("3 lb", units.LENGTH, "expected a length"),
    ("3 psi", units.LENGTH, "expected a length"),
    ("0.2", units.LENGTH, "a string carries its unit"),
    ("", units.LENGTH, "expected a length"),
    ("cm", units.LENGTH, "expected a length"),
    ("1 m; import os", units.LENGTH, "cannot read the unit"),
    ("9**9**9**9 m", units.LENGTH, "cannot read the unit"),
    ("1 m^99999999", units.LENGTH, "cannot read the unit"),
    ("1 __class__", units.LENGTH, "cannot read the unit"),
    ("1e999 m", units.LENGTH, "finite"),
    ("1e300 m", units.LENGTH, "out of range: expected a length from 1e-12 to"),
    (1e-300, units.LENGTH, "out of range"),
    (math.inf, units.LENGTH, "finite"),
    (math.nan, units.LENGTH, "finite"),
    (10**400, units.LENGTH, "finite"),
    (True, units.LENGTH, "expected a length"),
    (None, units.LENGTH, "expected a length"),
    (["1 m"], units.LENGTH, "expected a length"),
]


@pytest.mark.parametrize(("value", "kind", "message"), WRONG)
def test_refuses(value: object, kind: Kind, message: str) -> None:
    with pytest.raises(UnitError, match="^" if message == "" else message.replace("(", "\\(")):
        to_si(value, kind)


@pytest.mark.parametrize(
    ("value", "half"),
    [
        ("20 mm", "'10 mm'"),
        ("0.5in", "'0.25 in'"),
        (0.02, "0.01"),
        (3, "1.5"),
        ("wide", None),
        ("2", None),
        (True, None),
        ("20 kg", None),
        (10**400, None),
        (math.nan, None),
    ],
)
def test_half_of_a_quantity_is_written_as_it_was(value: object, half: str | None) -> None:
    assert units.halved(value, units.LENGTH) == half


@given(st.floats(1e-6, 1e9) | st.floats(-1e9, -1e-6) | st.just(0.0))
def test_a_unit_is_a_factor(number: float) -> None:
    assert to_si(f"{number!r} mm", units.LENGTH) == pytest.approx(1e-3 * number, rel=1e-15)


@given(st.text(max_size=40))
def test_any_text_is_read_or_refused(text: str) -> None:
    try:
        value = to_si(text, units.LENGTH)
    except UnitError:
        return
    assert math.isfinite(value)


@pytest.mark.parametrize(("unit", "si"), units._FACTORS)
def test_the_factors_at_hand_are_those_of_pint(unit: str, si: str) -> None:
    assert units._FACTORS[unit, si] == units._by_pint(unit, si)
