"""Frequencies over speed obey their laws before they leave, and what violates one does not."""

from dataclasses import replace

import numpy as np
import pytest
from fem_cases import BENT, FLAT, STEEL, paper_plate, rpm

from fem import Effects, LawViolation, Plate, Rotor, assemble, campbell, rectangle, reduce_over
from fem.reduction import reference, single_mode
from fem.reduction.single_mode import FlapMode
from fem.sweep import laws

SPEEDS = np.linspace(0.0, rpm(17500), 7)
THIN = Plate(rectangle(0.2, 0.08, 5, 3), 0.004, STEEL)
KINDS = {
    "linear prestress": (Rotor(0.1, 0.5), FLAT),
    "Coriolis": (Rotor(0.1, 0.5), Effects(coriolis=True)),
    "large deflection": (Rotor(0.1, 0.5), BENT),
}


@pytest.fixture(scope="module", params=KINDS)
def found(request):
    operators = assemble(paper_plate(8, 4), *KINDS[request.param])
    speeds = SPEEDS[:3] if request.param == "large deflection" else SPEEDS
    return operators, campbell(operators, speeds, 4)


def wrong(diagram, factor, *, row=slice(None), mode=slice(None)):
    """The diagram with some frequencies multiplied."""
    frequencies = diagram.frequencies_hz.copy()
    frequencies[row, mode] *= factor
    return replace(diagram, frequencies_hz=frequencies)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"factor": -1.0}, "positive and finite"),
        ({"factor": np.nan, "row": 1, "mode": 2}, "positive and finite"),
        ({"factor": np.inf, "row": 1, "mode": 3}, "positive and finite"),
        ({"factor": 0.01, "row": 1, "mode": 1}, "frequencies ascend, but mode 1 at"),
        ({"factor": 1.005}, "Rayleigh's quotients"),
        ({"factor": 0.9999, "row": -1, "mode": 0}, "Rayleigh's quotients"),
    ],
)
def test_impossible_frequencies(found, change, says):
    operators, diagram = found
    laws.check_diagram(operators, diagram, 0.0)
    with pytest.raises(LawViolation, match=says):
        laws.check_diagram(operators, wrong(diagram, **change), 0.0)


@pytest.mark.parametrize(
    ("factor", "says"), [(1.001, "below their tangents|above their chords"), (0.999, "above their chords")]
)
@pytest.mark.parametrize("mode", [0, 3])
@pytest.mark.parametrize("found", ["linear prestress"], indirect=True)
def test_frequencies_between_the_ends(found, factor, says, mode):
    """Where the stiffness is linear in the square of the speed, one speed tells of another."""
    operators, diagram = found
    with pytest.raises(LawViolation, match=says):
        laws.check_diagram(operators, wrong(diagram, factor, row=3, mode=mode), 0.0)


def test_shapes_without_their_mass(found):
    operators, diagram = found
    parts = [replace(part, basis=1.001 * part.basis) for part in diagram.parts]
    with pytest.raises(LawViolation, match="modal mass of 1"):
        laws.check_diagram(operators, replace(diagram, parts=tuple(parts)), 0.0)


def test_a_ball_that_is_too_light(monkeypatch):
    """A ball whose frequency is hardly lowered, or raised, violates Rayleigh's quotient."""
    operators = assemble(paper_plate(8, 4), Rotor(), FLAT)
    diagram = campbell(operators, SPEEDS, 4)
    reduce_over(operators, diagram, (0.2, 0.0), mass_ratio=0.006)
    right = single_mode.become
    monkeypatch.setattr(single_mode, "become", lambda *given: (1.01 * right(*given)[0], right(*given)[1]))
    with pytest.raises(LawViolation, match="a stuck ball"):
        reduce_over(operators, diagram, (0.2, 0.0), mass_ratio=0.006)


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin", "solid"])
@pytest.mark.parametrize("stagger", [0.0, 0.7, np.pi / 2])
def test_concave_and_below_the_tangents(theory, stagger):
    """Southwell: f² is at least the sum of what either stiffness gives, and at most its tangent at rest."""
    operators = assemble(THIN, Rotor(0.05, stagger), FLAT, theory)
    diagram = campbell(operators, SPEEDS / 3, 3)
    laws.check_diagram(operators, diagram, 0.0)
    squares = diagram.frequencies_hz[:, 0] ** 2
    slopes = np.diff(squares) / np.diff(SPEEDS**2)
    assert (np.diff(slopes) <= 1e-9 * slopes[0]).all()


def test_the_reference_plates(monkeypatch):
    """Digits of the literature see a factor that the laws cannot."""
    errors = {line.name: line.error / line.allowed for line in reference.lines()}
    assert max(errors.values()) < 0.8
    right = reference.Material
    monkeypatch.setattr(reference, "Material", lambda modulus, *given: right(1.0001 * modulus, *given))
    with pytest.raises(LawViolation, match=r"flap 1' is 3\.516.* in the self-check of plates"):
        reference.check()


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda mode: FlapMode(1.05 * mode.mass, mode.slope), "effective mass"),
        (lambda mode: FlapMode(mode.mass, -mode.slope), "slope"),
    ],
)
def test_a_wrong_reduction_is_known(wrong, said, monkeypatch):
    """To a law, if it can be, and to the self-check without that."""
    operators = assemble(THIN, Rotor(0.05), FLAT)
    diagram, right = campbell(operators, SPEEDS / 3, 4), single_mode.flap_modes
    for at in ((0.2, 0.04), (0.02, 0.01)):
        reduce_over(operators, diagram, at, mass_ratio=0.01)
    monkeypatch.setattr(single_mode, "flap_modes", lambda *given: list(map(wrong, right(*given))))
    if said == "effective mass":
        with pytest.raises(LawViolation, match="a modal mass of 1 kg moves as fast as the mode"):
            reduce_over(operators, diagram, (0.2, 0.0), mass_ratio=0.01)
    monkeypatch.setattr(single_mode._Family, "check", lambda *_: None)
    with pytest.raises(LawViolation, match=f"{said} at its tip' is .* in the self-check of plates"):
        reference.check()


def test_reduced_figures_belong_together():
    operators = assemble(THIN, Rotor(0.05), FLAT)
    (found,) = reduce_over(operators, campbell(operators, np.zeros(1), 4), (0.2, 0.0), mass_ratio=0.01)
    laws.check_reduced(found)
    for name in ("K1", "K2", "M1", "f1_hz"):
        with pytest.raises(LawViolation, match=r" is M.*, but they are "):
            laws.check_reduced(replace(found, **{name: 1.001 * getattr(found, name)}))
