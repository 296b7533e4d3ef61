"""Modes at further speeds from the factor of the first: the same as when each speed is solved by itself."""

import numpy as np
import pytest
from fem_cases import BENT, FLAT, STEEL, builder, rpm

from fem import (
    Divergence,
    Effects,
    Given,
    Plate,
    Rectangle,
    Rotor,
    assemble,
    assembly,
    choose_mesh,
    rectangle,
    solve_modes,
    statics,
)
from fem.accuracy.error_estimates import complete, probe
from fem.assembly import transfer

COUNT, EXACT = 6, 1e-7


def plate(theory="mindlin", effects=FLAT, stagger=0.3, hub=0.1, thickness=0.002, length=0.2):
    mesh = Rectangle(length, 0.1).mesh(2 if theory == "solid" else 3)
    return assemble(Plate(mesh, thickness, STEEL), Rotor(hub, stagger), effects, theory)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff", "solid"])
@pytest.mark.parametrize("top", [3000.0, 20000.0])
def test_both_speeds_as_solved_by_themselves(theory, top):
    """At 20000 rpm the first frequency is three times that at rest."""
    operators, speeds = plate(theory), (0.0, rpm(top))
    for (values, shapes, _), speed in zip(probe(operators, speeds, COUNT, EXACT), speeds, strict=True):
        alone = solve_modes(operators, speed, COUNT)
        assert values == pytest.approx(alone.eigenvalues, rel=3 * EXACT)
        alike = np.abs(shapes.T @ operators.mass @ alone.shapes)
        assert np.diag(alike) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("effects", [Effects(coriolis=True), BENT])
def test_with_effects_that_are_not_linear_in_the_squared_speed(effects):
    operators, speeds = plate(effects=effects), (rpm(2000.0), rpm(6000.0))
    for (values, *_), speed in zip(probe(operators, speeds, COUNT, EXACT), speeds, strict=True):
        assert values == pytest.approx(solve_modes(operators, speed, COUNT).eigenvalues, rel=3 * EXACT)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff/bfs", "kirchhoff/argyris"])
def test_a_state_on_a_coarser_mesh_saves_most_of_newtons_steps(theory, monkeypatch):
    """From rest the plate is twisted in parts of its load; from the coarser mesh's state at once, to the same."""
    form, omega, steps = Rectangle(0.2, 0.2), rpm(4000.0), []
    plain = assembly.Operators.factorise
    monkeypatch.setattr(assembly.Operators, "factorise", lambda *given: steps.append(1) or plain(*given))
    coarse, fine = (assemble(Plate(form.mesh(k), 0.002, STEEL), Rotor(0.0, np.pi / 4), BENT, theory) for k in (2, 3))
    known = statics.equilibrium(coarse, omega)
    steps.clear()
    cold = statics.equilibrium(fine, omega)
    from_rest = len(steps)
    steps.clear()
    warm = statics.equilibrium(fine, omega, transfer(known, coarse, fine))
    assert 2 * len(steps) < from_rest
    np.testing.assert_allclose(warm, cold, atol=1e-9 * np.abs(cold).max())


def test_a_point_not_found_is_no_start_and_no_failure():
    """On sheared cells points lie on the diagonals at which scikit-fem's search loses them; others lie off."""
    mesh = rectangle(0.3, 0.05, 2, 4)
    mesh = type(mesh)(mesh.p + np.array([[0.0], [0.75]]) * mesh.p[0], mesh.t)
    form = Given(mesh)

    def on(mesh):
        return assemble(Plate(mesh, 0.002, STEEL), Rotor(0.1, 0.7), BENT)

    assert choose_mesh(form, lambda size: on(form.mesh(size)), (0.0, 100.0), 1, 1e-1).errors.shape == (2, 1)
    coarse, longer = on(mesh), on(rectangle(0.6, 0.05, 4, 2))
    assert transfer(statics.equilibrium(coarse, 100.0), coarse, longer) is None


def test_ends_where_the_plate_diverges():
    operators = plate(effects=Effects(stress_stiffening=False), stagger=np.pi / 2, thickness=0.001)
    critical = solve_modes(operators, 0.0, 1).eigenvalues[0] ** 0.5
    assert len(probe(operators, (0.0, 0.99 * critical), 2, EXACT)) == 2
    assert len(probe(operators, (0.0, 1.01 * critical), 2, EXACT)) == 1
    with pytest.raises(Divergence):
        probe(operators, (1.01 * critical,), 2, EXACT)
    with pytest.raises(ValueError, match="count of modes"):
        probe(operators, (0.0,), 0, EXACT)


def test_a_mode_that_the_start_does_not_lead_to_is_noticed():
    """Flap modes stiffen past the third twist, which is then the sixth mode and not among the six at rest."""
    form = Rectangle(0.3, 0.05)
    build = builder(form, 1.5904e-3, "kirchhoff", Rotor(0.3))
    operators = build(3)
    top = 2.02 * float(solve_modes(operators, 0.0, 1).eigenvalues[0] ** 0.5)
    found = probe(operators, (0.0, top), COUNT, 1e-6)
    true = solve_modes(operators, top, COUNT).eigenvalues
    assert found[1].eigenvalues[-1] > 1.05 * true[-1]
    assert not complete(operators, top, found[1])
    by_itself = probe(operators, (0.0, top), COUNT, EXACT, alone=True)
    assert complete(operators, top, by_itself[1])
    np.testing.assert_allclose(by_itself[1].eigenvalues, true, rtol=3 * EXACT)
    choice = choose_mesh(form, build, (0.0, top), COUNT, 1e-3)
    limit = solve_modes(build(2 * choice.size), top, COUNT).frequencies_hz
    true_error = np.abs(solve_modes(choice.operators, top, COUNT).frequencies_hz / limit - 1.0).max()
    assert choice.errors[1].max() / 3.0 <= true_error <= 1e-3


def test_a_divergence_that_the_start_does_not_lead_to_is_noticed():
    """Softened in its plane of rotation a deep strip loses its lag mode, of which flap modes have no part."""
    form = Rectangle(0.2, 0.04)
    build = builder(form, 0.008, rotor=Rotor(0.1), effects=Effects(stress_stiffening=False))
    top = 5.0 * float(solve_modes(build(2), 0.0, 1).eigenvalues[0] ** 0.5)
    with pytest.raises(Divergence):
        solve_modes(build(2), top, 1)
    assert choose_mesh(form, build, (0.0, top), 1, 1e-2).probes.tolist() == [0.0]


def test_speeds_that_do_not_settle_are_solved_by_themselves(monkeypatch):
    monkeypatch.setattr("fem.linalg.ROUNDS", 1)
    operators, top = plate(), rpm(20000.0)
    assert probe(operators, (0.0, top), COUNT, EXACT)[1][0] == pytest.approx(
        solve_modes(operators, top, COUNT).eigenvalues, rel=1e-10
    )
