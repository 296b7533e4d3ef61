"""Units at the boundary: everything arrives in SI or not at all."""

import math
import re
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.workflows.conftest import table_of
from workflows import formatting
from workflows.effects import selection
from workflows.report import templates
from workflows.scene import quantities
from workflows.scene.load import load
from workflows.scene.quantities import UnitError, to_si

TABLES = table_of("units")


@pytest.mark.parametrize(
    ("value", "kind", "expected", "error"),
    [*((*case, 1e-15) for case in TABLES["right"]), *((*case, 1e-13) for case in TABLES["customary"])],
)
def test_reads(value, kind, expected, error):
    assert to_si(value, getattr(quantities, kind)) == pytest.approx(expected, rel=error)


def test_g_is_gravity_in_loads_and_gram_in_masses():
    assert to_si("6000 g", quantities.LOAD, gravity=10.0) == 60_000
    assert to_si("6000 g", quantities.MASS) == 6
    with pytest.raises(UnitError):
        to_si("1 g", quantities.ACCELERATION)


@pytest.mark.parametrize(
    ("value", "kind", "message"),
    [*TABLES["wrong"], (10**400, "LENGTH", "finite"), (None, "LENGTH", "expected a length")],
)
def test_refuses(value, kind, message):
    with pytest.raises(UnitError, match=message.replace("(", "\\(")):
        to_si(value, getattr(quantities, kind))


@given(st.floats(1e-6, 1e9) | st.floats(-1e9, -1e-6) | st.just(0.0))
def test_a_unit_is_a_factor(number):
    assert to_si(f"{number!r} mm", quantities.LENGTH) == pytest.approx(1e-3 * number, rel=1e-15)


@given(st.text(max_size=40))
def test_any_text_is_read_or_refused(text):
    try:
        value = to_si(text, quantities.LENGTH)
    except UnitError:
        return
    assert math.isfinite(value)


@pytest.mark.parametrize(("unit", "si"), quantities._FACTORS)
def test_the_factors_at_hand_are_those_of_pint(unit, si):
    assert quantities._FACTORS[unit, si] == quantities._by_pint(unit, si)


@pytest.mark.parametrize(
    ("share", "said"),
    [
        (0.0, "0.000"),
        (-0.0, "0.000"),
        (-1e-15, "0.000"),
        (-3e-7, "−0.00003"),
        (-2.34e-4, "−0.023"),
        (3e-7, "0.000"),
        (0.12136, "12.136"),
    ],
)
def test_a_loss_that_rounds_to_nothing_has_no_sign(share, said):
    """One below 0 that is more than what rounding leaves keeps its digits."""
    assert formatting.percent(share, 3) == said


def test_a_ratio_beside_one_is_not_rounded_to_it():
    assert [formatting.beside(ratio, 1) for ratio in (2.345, 1.043, 1.0004, 0.997)] == [
        "2.3",
        "1.04",
        "1.0004",
        "0.997",
    ]
    flat = [SimpleNamespace(hardness_ratio=ratio, dent_radius=1e-4) for ratio in (1.002, 1.021)]
    for radius, width in ((2e-3, "to a width of up to 0.2 mm"), (1e-4, "over the ball's whole width")):
        (said,) = templates.said("remarks/flows", contacts=flat, damper=SimpleNamespace(radius=radius))
        assert said.endswith(f"is up to 1.02 times the hardness of the softer material, and the contact yields {width}")
    (said,) = templates.said("remarks/veering", veerings=[(1000.0, 2000.0, ["flap 2", "twist 1"])] * 5)
    assert said.count("Between 1000 and 2000 rpm (flap 2, twist 1)") == 1
    assert "), and at 1 further place, modes change" in said


def test_what_is_compared_reads_otherwise():
    """What Coriolis forces move is just above what is asked for: 2 (2 Omega L / (pi c))², twice in one digit."""
    source = load("paper")
    wave = math.sqrt(182.6e9 / 7850.0)
    moved = 2 * (max(source.scene.rotor.speeds) * 0.2 / (0.5 * math.pi * wave)) ** 2
    why = selection.resolve(source.changed(accuracy={"frequency": 0.999 * moved}).scene, "", None)["coriolis"].why
    more, less = re.fullmatch(
        r"it lowers .* by about ([\d.]+) % at most, more than the ([\d.]+) % requested", why
    ).groups()
    assert float(more) > float(less)
    mode = SimpleNamespace(number=1, whole=1.004e-3)
    of = {"parts": {"mesh": mode.whole}, "target": 1e-3, "met": False, "off": [], "keys": {}, "least": None}
    (said,) = templates.said("remarks/sentence", unknown=False, first=mode, last=mode, left=None, **of)
    assert said.startswith("Mode 1 is accurate to 0.1004 % (")


def test_a_range_without_width_is_one_value():
    assert formatting.span(3.204, 3.196) == "3.2"
    assert formatting.interval("2", "3", " and ", "between ", "at ") == "between 2 and 3"
    assert formatting.revolutions([366.5191, 366.5192, 366.5191, 366.5192, 366.5191]) == "5 speeds at 3500 rpm"
    near, far = (SimpleNamespace(rpm=rpm, omega=rpm * math.pi / 30, load_g=rpm) for rpm in (3500.1, 3500.2))
    assert templates.stretch([near, far], [near, far]) == "at 3500 rpm (3500 g)"
    assert templates.said("phrases/between_speeds", points=[near, far]) == ["at 3500 rpm"]
    (said,) = templates.said("remarks/veering", veerings=[(3500.1, 3500.2, ["flap 2", "twist 1"])])
    assert said.startswith("Near 3500 rpm (flap 2, twist 1) modes change")
    (said,) = templates.said("answer/between", ranges={"at amplitudes of 1 mm": [near, far]}, held={})
    assert said.startswith("At 3500 rpm the ball gives")
    amplitudes = {"of": [(4.271e-4, 4.273e-4)], "g": 51234.0, "limited": False, "error": 0.0}
    assert templates.said("answer/range", carrier="blade", **amplitudes) == ["at amplitudes of 0.43 mm (21.9 g)"]


@pytest.mark.parametrize(("value", "said"), [(-0.4, "0"), (-0.6, "−1"), (-12345.0, "−12\u2009345"), (-0.0, "0")])
def test_no_whole_number_is_minus_nothing(value, said):
    assert formatting.fixed(value) == said
