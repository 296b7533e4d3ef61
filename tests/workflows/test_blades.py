"""Scenes of real blades: a thickness that varies."""

import json
import tomllib

import meshio
import numpy as np
import pytest

import workflows
from fem import Effects, ElasticRoot, Material, Plate, Rectangle, Rotor, assemble, rectangle, solve_modes
from fem.accuracy.theory_selection import theory_errors
from fem.meshes.thickness import Polynomial
from tests.workflows.conftest import BALL, changed, on_mesh, quads
from workflows.effects import selection
from workflows.errors import BadInput
from workflows.io import provenance
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile, parse
from workflows.solve import model_choice

TAPER = {
    "title": "taper",
    "plate": {"length": "20 cm", "width": "8 cm", "thickness": {"x": ["0 cm", "20 cm"], "values": ["4 mm", "2 mm"]}},
    "material": {"youngs_modulus": "200 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"},
    "rotor": {"speeds": ["3000 rpm"], "modes": 3},
    "accuracy": {"frequency": 1e-2},
}
POLYNOMIAL = {"polynomial": [["4 mm"], ["-10 um/mm"]]}
ROOT = {"stiffness": "5e8 N/m/m", "rotational_stiffness": "5e3 N*m/rad/m"}
SMALL = BALL | {"mass": "1 g", "radius": "0.5 mm", "cavity": ["1.5 mm", "1.4 mm"], "rolling_friction": "0.1 mm"}


def frequencies(scene):
    return [mode.frequency_hz for mode in workflows.run(scene).speeds[0].modes]


def written(path, field=None, unit=1.0):
    """0.2 x 0.08 m as 6 x 3 quadrilaterals, with point data."""
    points, cells = quads(np.linspace(0, 0.2, 7), np.linspace(-0.04, 0.04, 4))
    data = {"h": (4e-3 - 0.01 * points[:, 0]) / unit} if field is None else field
    meshio.Mesh(points / unit, [("quad", cells)], point_data=data).write(path)
    return path


def of_mesh(path, **thickness):
    return on_mesh(TAPER, path, plate__thickness=thickness or {"field": "h"})


def test_a_table_a_polynomial_and_a_field_of_the_same_taper(tmp_path):
    """One thickness in three spellings, the field in millimetres too: the same frequencies within their accuracy."""
    table = frequencies(TAPER)
    assert frequencies(changed(TAPER, plate__thickness=POLYNOMIAL)) == pytest.approx(table, rel=1e-9)
    assert frequencies(of_mesh(written(tmp_path / "blade.vtu"))) == pytest.approx(table, rel=1e-2)
    in_mm = changed(of_mesh(written(tmp_path / "mm.vtu", unit=1e-3)), plate__mesh_unit="mm")
    in_m = of_mesh(written(tmp_path / "m.vtu"))
    assert frequencies(in_mm) == pytest.approx(frequencies(in_m), rel=1e-9)
    even = frequencies(changed(TAPER, plate__thickness="4 mm"))
    assert table[0] > 1.05 * even[0]  # a wedge of 2:1 is 3.824 to 3.516


def test_a_resolved_scene_is_the_same_scene():
    for given in (TAPER, changed(TAPER, plate__thickness=POLYNOMIAL), changed(TAPER, plate__root=ROOT)):
        scene = parse(given)
        decided = selection.resolve(scene)
        again = parse(tomllib.loads(provenance.as_toml(scene, decided, model_choice.chosen_theory(scene)[0])))
        assert again.plate.thickness == scene.plate.thickness
        assert again.plate.root == scene.plate.root


def test_check_says_the_thickness(tmp_path):
    source = SceneFile(parse(changed(TAPER, damper=SMALL, release={"ratio": 0.3})), "scene", tmp_path)
    assert "# Thickness: 2 mm to 4 mm, 2 mm at the damper" in provenance.heading(source)
    found = provenance.document(source, selection.resolve(source.scene), None)
    assert found["thickness"] == pytest.approx({"least": 2e-3, "greatest": 4e-3, "damper": 2e-3})
    json.dumps(found, allow_nan=False)


def test_the_theory_goes_by_the_greatest_thickness():
    """Thin at the tip, stout at the root."""
    thin = {"x": [0, 0.2], "values": ["0.1 mm", "0.05 mm"]}
    stout = {"x": [0, 0.2], "values": ["30 mm", "0.1 mm"]}
    found = [model_choice.chosen_theory(parse(changed(TAPER, plate__thickness=t)))[0] for t in (thin, stout)]
    assert [theory.name for theory in found if theory] == ["kirchhoff", "solid"]


def test_the_pull_at_the_root():
    """rho Omega² of the moment of what hangs there over the section: b (h0 L²/2 - s L³/3) and b h0."""
    plate = parse(TAPER).plate
    assert plate_mesh.volume(plate) == pytest.approx((0.08 * 0.2 * 3e-3, 0.08 * (4e-3 * 0.02 - 0.01 * 0.008 / 3)))
    assert plate_mesh.section(plate) == pytest.approx(0.08 * 4e-3)


def test_the_cavity_fits_where_it_is(tmp_path):
    """2.8 mm go into the middle, 3 mm thick, and not into the tip; field and table alike."""
    narrow = SMALL | {"cavity": ["2.8 mm", "2.4 mm"]}
    for scene in (TAPER, of_mesh(written(tmp_path / "blade.vtu"))):
        inside = changed(scene, damper=narrow | {"at": ["10 cm", "0 cm"]}, release={"ratio": 0.3})
        plate_mesh.planform(SceneFile(parse(inside), "scene", tmp_path))
        with pytest.raises(BadInput, match="through the plate's thickness: expected less than 2 mm"):
            plate_mesh.planform(SceneFile(parse(changed(inside, damper=narrow)), "scene", tmp_path))


def test_the_thickness_is_exported(tmp_path):
    workflows.save(workflows.run(TAPER), tmp_path / "out")
    mesh = meshio.read(tmp_path / "out" / "modes.vtu")
    assert mesh.point_data["thickness"] == pytest.approx(4e-3 - 0.01 * mesh.points[:, 0])
    assert "2 to 4 mm thick" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")


FIELDS = [
    ({"g": np.ones(28)}, "has no point data 'h': it has g"),
    ({}, "has no point data 'h': it has none"),
    ({"h": np.ones((28, 3))}, r"of shape \(28, 3\): expected one number for each point"),
    ({"h": np.full(28, np.nan)}, "values that are not finite"),
    ({"h": np.linspace(-1e-3, 5e-3, 28)}, "above 0 everywhere on the plate, but it is -0.001 m at"),
]


@pytest.mark.parametrize(("data", "words"), FIELDS)
def test_what_is_no_field(tmp_path, data, words):
    with pytest.raises(BadInput, match=words) as error:
        workflows.run(of_mesh(written(tmp_path / "blade.vtu", data)))
    assert "[plate] thickness" in str(error.value)


def test_a_table_that_does_not_cover_a_mesh(tmp_path):
    short = of_mesh(written(tmp_path / "blade.vtu"), x=["0 cm", "10 cm"], values=["4 mm", "2 mm"])
    with pytest.raises(BadInput, match="the table of the thickness has x from 0 to 0"):
        workflows.run(short)


def by_fem(rotor, omega, elastic_root=None, **effects):
    """The three lowest frequencies of the plate, 4 mm thick everywhere, on a mesh of our own."""
    plate = Plate(Rectangle(0.2, 0.08).mesh(4), 4e-3, Material(200e9, 0.3, 7850.0), elastic_root=elastic_root)
    return solve_modes(assemble(plate, rotor, Effects(**effects)), omega, 3).frequencies_hz.tolist()


def test_a_root_on_springs():
    """Softer than the clamp, as `fem` has it; stiff springs are the clamp."""
    even = changed(TAPER, plate__thickness="4 mm", rotor__speeds=["0 rpm"])
    clamped, soft = frequencies(even), frequencies(changed(even, plate__root=ROOT))
    stiff = frequencies(changed(even, plate__root={"stiffness": 1e15, "rotational_stiffness": 1e11}))
    assert stiff == pytest.approx(clamped, rel=1e-3)
    own = by_fem(Rotor(), 0.0, elastic_root=ElasticRoot(5e8, 5e3))
    assert soft == pytest.approx(own, rel=1e-2)
    assert soft[0] < 0.8 * clamped[0]


def test_a_cone_calls_for_large_deflection():
    """The load has a part across the plate, which bends it: at stagger 0 too; flat in the plane it does not."""
    exact = changed(TAPER, accuracy={"frequency": 1e-3})
    flat, coned = (parse(changed(exact, rotor__precone=angle)) for angle in ("0 deg", "6 deg"))
    decided = [selection.resolve(scene)["large_deflection"] for scene in (flat, coned)]
    assert [effect.on for effect in decided] == [False, True]


def test_a_cone_is_solved_as_fem_has_it():
    rotor = {"speeds": ["3000 rpm"], "modes": 3, "precone": "4 deg", "hub_radius": "5 cm", "stagger": "20 deg"}
    found = frequencies(changed(TAPER, plate__thickness="4 mm", rotor=rotor))
    own = by_fem(Rotor(0.05, np.radians(20.0), np.radians(4.0)), 100.0 * np.pi, large_deflection=True)
    assert found == pytest.approx(own, rel=1e-2)


def test_a_damper_takes_no_cone():
    coned = changed(TAPER, rotor__precone="4 deg", damper=SMALL, release={"ratio": 0.3})
    with pytest.raises(BadInput, match="the load then has a component along the cavity's floor"):
        parse(coned)
    parse(changed(coned, rotor__precone="0 deg"))


@pytest.mark.parametrize("theory", ["mindlin", "mindlin/held", "kirchhoff", "solid/2"])
def test_the_theorys_error_knows_the_slope_of_the_faces(theory):
    """0.7 times the square of the slope, which is 0.02 here; a solid has none."""
    tapered = Plate(rectangle(0.2, 0.08, 8, 4), Polynomial(((0.01,), (-0.04,))), Material(2e11, 0.3, 7850.0))
    operators = assemble(tapered, Rotor(), Effects(), theory)
    modes = solve_modes(operators, 0.0, 3)
    errors = theory_errors(operators, modes.eigenvalues, modes.shapes)
    if theory == "solid/2":
        assert not errors.any()
    else:
        assert (errors > 0.7 * 0.02**2).all()
        assert (errors < 0.1).all()


@pytest.mark.parametrize("thickness", ["4 mm", {"field": "h"}])
def test_a_slit_tip(thickness, tmp_path):
    """Two prongs side by side that nothing joins at the tip bend as one beam (Southwell and Gough)."""
    points, cells = quads(np.linspace(0, 0.2, 7), np.array([-0.04, -0.02, -0.001, 0.001, 0.02, 0.04]))
    cells = cells[(cells[:, 0] % 6 != 2) | (cells[:, 0] < 6)]  # slit from 33 mm to the tip
    fields = {"h": np.full(len(points), 4e-3)}
    meshio.Mesh(points, [("quad", cells)], point_data=fields).write(tmp_path / "slit.vtu")
    slit = on_mesh(TAPER, tmp_path / "slit.vtu", plate__thickness=thickness)
    beam = 3.5160 / (2 * np.pi) * np.sqrt(2e11 * 4e-3**2 / 12 / 7850) / 0.2**2
    assert frequencies(slit)[0] == pytest.approx(np.hypot(beam, np.sqrt(1.19) * 3000 / 60), rel=0.03)
