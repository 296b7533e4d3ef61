"""The material that a cavity takes out of the plate: to first order a negative mass, which a positive one witnesses."""

import numpy as np
import pytest

from fem import Effects, Material, Plate, Rotor, assemble, campbell, rectangle, solve_modes, with_cavity
from fem.accuracy.neglected_effects import cut
from tests.workflows.conftest import QUIET, changed
from workflows import pipeline
from workflows.scene.load import as_scene_file
from workflows.studies.sweep.evaluate import PlateCache

STEEL = Material(182.6e9, 0.3, 7850.0)


@pytest.mark.parametrize(
    ("at", "omega"), [((0.188, 0.004), 1500.0), ((0.148, 0.012), 0.0), ((0.148, 0.012), 1500.0), ((0.044, 0.004), 0.0)]
)
def test_a_hole_in_the_mesh(at, omega):
    """A plate of which a cell is missing is lighter by as much, and softer by no more than the estimate."""
    mesh, volume = rectangle(0.2, 0.08, 25, 10), 8e-3 * 8e-3 * 0.01
    off = np.hypot(*(mesh.p[:, mesh.t].mean(axis=1) - np.array(at)[:, None]))
    holed, full = (
        assemble(Plate(each, 0.01, STEEL), Rotor(), Effects(), "kirchhoff")
        for each in (mesh.remove_elements(np.flatnonzero(off < 1e-9)), mesh)
    )
    known = campbell(full, np.array([omega]), 6)
    with_hole, counted = (
        solve_modes(each, omega, 6).frequencies_hz for each in (holed, with_cavity(full, at, volume, 0.01))
    )
    shifts = cut(full, known, [0], at, volume, 0.01)
    error = counted / with_hole - 1
    extent = shifts.extent[0] + shifts.mass[0] ** 2  # and second order
    assert (error > -extent).all()
    assert (error < 4 * shifts.stiffness[0] + extent).all()
    if at[0] == 0.188:  # where the first mode hardly bends, it is the mass that counts
        assert error[0] < 0.01 * (counted[0] / known.frequencies_hz[0, 0] - 1)


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin", "solid/2"])
def test_the_shift_of_a_beam(theory):
    """By hand: m phi² / 2, at the tip of a uniform cantilever 2 m / M, in the middle phi² = 0.3395² of that."""
    beam = Plate(rectangle(0.4, 0.02, 40, 2), 0.004, Material(2e11, 0.0, 7850.0))
    full = assemble(beam, Rotor(), Effects(), theory)
    volume = 1e-3 * 0.4 * 0.02 * 0.004
    tip, middle = (with_cavity(full, (x, 0.0), volume, 0.002) for x in (0.4, 0.2))
    before, at_tip, at_middle = (solve_modes(each, 0.0, 1).frequencies_hz[0] for each in (full, tip, middle))
    assert at_tip / before - 1 == pytest.approx(2e-3, rel=0.02)
    assert at_middle / before - 1 == pytest.approx(2e-3 * 0.1153, rel=0.02)


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("effects", [{}, {"coriolis": True}, {"large_deflection": True}])
def test_a_run_counts_it(paper, effects):
    """Every frequency of a run with the effect, at rest and fast, is shifted as a positive mass shifts it back."""
    scene = changed(paper, rotor__speeds=[0, "17500 rpm"], rotor__modes=2, release__cycles=1, effects=effects)
    scene = changed(scene, effects__cavity_mass="auto", damper__count=5)
    mass, none = 7850 * 5 * 2.5e-3 * 2.4e-3 * 2e-3, {"effects__cavity_mass": False}
    on, off, heavy = (
        pipeline.structure(as_scene_file(changed(scene, **changes)), QUIET, shapes=False)
        for changes in ({}, none, none | {"plate__tip_mass": mass})
    )
    assert on.effects["cavity_mass"].on, "0.04 % of each frequency, of 0.1 % asked for"
    for points in zip(on.points, off.points, heavy.points, strict=True):
        light, plain, heavier = (each.reduced.f2_hz for each in points if each.reduced is not None)
        assert light / plain - 1 == pytest.approx(1 - heavier / plain, rel=0.1)
        assert points[0].modes[0].frequency_hz == pytest.approx(light, rel=1e-5)
        counted, uncounted = (
            [mode.error_parts.cavity_mass for mode in each.modes if mode.error_parts is not None] for each in points[:2]
        )
        assert None not in counted
        assert set(uncounted) == {None}


@pytest.mark.usefixtures("quickly")
def test_left_out_it_is_part_of_the_error(paper):
    scene = changed(paper, rotor__speeds=[0], rotor__modes=2, damper__count=1, accuracy__frequency=2e-3, effects=None)
    (point,) = pipeline.structure(as_scene_file(scene), QUIET, shapes=False).points
    parts, reduced = point.modes[0].error_parts, point.reduced
    assert parts.cavity_mass == pytest.approx(7850 * 2.5e-3 * 2.4e-3 * 2e-3 / reduced.M2 / 2, rel=0.05)


@pytest.mark.usefixtures("quickly")
def test_plates_that_are_kept_have_the_error_of_each_damper(paper):
    """Cavities that are left out, and of those that count others of the same volume and depth, on one plate."""
    scene = changed(paper, rotor__speeds=[0], rotor__modes=2, damper__count=1, accuracy__frequency=2e-3, effects=None)
    small, other = {"damper__cavity": ["2.5 mm", "2.2 mm"]}, {"damper__cavity": ["2.5 mm", "3 mm"]}
    on = {"effects__cavity_mass": True}
    wide = on | other | {"damper__radius": "0.8 mm"}
    scenes = [as_scene_file(changed(scene, **each)) for each in ({}, small, {}, on, wide)]
    cache = PlateCache()
    kept = [cache.state(each).points[0].modes[0].error_parts for each in scenes]
    alone = [PlateCache().state(each).points[0].modes[0].error_parts for each in scenes]
    assert kept == alone
    assert len({None if each is None else each.cavity_mass for each in alone}) == 4


def test_a_bent_plate_has_no_more_strain_at_its_cavity_than_energy():
    """A tip cavity in a staggered plate, which the load bends: linear strains of its twist had 47 times its energy."""
    plate = Plate(rectangle(0.3, 0.06, 16, 4), 0.005, Material(110e9, 0.34, 4430.0))
    operators = assemble(plate, Rotor(0.3, np.pi / 4), Effects(large_deflection=True))
    known = campbell(operators, np.array([12000 * np.pi / 30]), 4)
    assert cut(operators, known, [0], (0.29, 0.0), 8e-8, 4.4e-3).stiffness.max() < 0.02
