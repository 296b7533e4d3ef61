"""Scenes with a solid blade: from a mesh file to modes and a damper's figures, and what is refused."""

import json
import math
import re
import tomllib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, replace
from functools import partial
from pathlib import Path

import meshio
import numpy as np
import psutil
import pytest

import spindamp
import workflows
from damper import ringdown
from damper.state import HIT
from fem.modal_model import largest_strain
from fem.rotor import from_rpm
from meshes import make
from tests.workflows.conftest import QUIET, table_of
from workflows import pipeline
from workflows.errors import BadInput, NoAnswer
from workflows.formatting import significant
from workflows.io import files
from workflows.report import page, remarks, text, viewer
from workflows.report.verdict import answer, first_frequency
from workflows.scene.load import SceneFile, load, parse
from workflows.solve import coupling, engine_orders, excitation, limits, remedies, resources
from workflows.solve.blade import blade_of, in_words
from workflows.solve.damper import particle_damper, verdict_damper
from workflows.solve.results import ErrorParts
from workflows.studies.design.objectives import Evaluation, Obstacle
from workflows.studies.design.report import active_constraints, verdict
from workflows.studies.design.space import Optimum, design_space, evaluate_designs
from workflows.studies.design.study import design

LEVEL = ('stagger = "35 deg"', 'stagger = "0 deg"')
TEXTS = table_of("blades")
SCENE, DAMPER, PLATE = (TEXTS[name] for name in ("scene", "damper", "plate"))

pytestmark = pytest.mark.usefixtures("quickly")


def flat(folder, cells, name="fan.inp", grade=1.0, held=None, **shape):
    """A plate as a mesh file, x = 50 to 250 mm, 80 mm wide and 10 mm thick; held: its root by x and y."""
    shape = {"length": 0.2, "chord": 0.08, "thickness": 0.01, "hub_radius": 0.05} | shape
    mesh = make.solid(make.Airfoil(section="flat", **shape), cells, grade)
    if held is not None:
        mesh.point_sets["NROOT"] = np.flatnonzero(held(*mesh.points.T[:2]))
    make.write_inp(folder / name, mesh, "flat")
    return mesh


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("blade")
    make.write_inp(folder / "fan.inp", make.solid(make.FAN, (12, 6, 1)), "fan")
    return folder


def scene(folder, text=SCENE + DAMPER, speeds="'0 rpm', '5900 rpm'", **changes):
    text = text.format(speeds=speeds)
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new)
    path = folder / "fan.toml"
    path.write_text(text, encoding="utf-8")
    return load(path)


@pytest.fixture(scope="module")
def few(folder):
    """The fan with its damper at three speeds, each solved by itself."""
    return pipeline.structure(scene(folder, speeds="'0 rpm', '3100 rpm', '5900 rpm'"), QUIET).results(stages=QUIET)


def test_a_blade_has_the_frequencies_of_calculix_and_a_damper_at_the_tip(few):
    """CalculiX' C3D20R on the same mesh, to what its static iteration leaves; M2 from the shape at the place."""
    rest, _, spinning = (np.array([mode.frequency_hz for mode in point.modes]) for point in few.speeds)
    np.testing.assert_allclose(rest, [101.9927909, 395.1181656, 672.5577939, 1041.8809431], rtol=1e-6)
    np.testing.assert_allclose(spinning, [156.5335592, 464.1662986, 647.1481493, 1103.9168585], rtol=4e-5)
    for point in few.speeds:
        assert point.reduced.f1_hz < point.reduced.f2_hz == pytest.approx(point.modes[0].frequency_hz)
        assert 0.02 < point.reduced.M2 < 0.2  # the blade weighs 0.5 kg
        assert all(0.0 < mode.error_estimate < 0.6 for mode in point.modes)
    at_rest, slow, fast = (point.modes[0].error_parts.coriolis for point in few.speeds)  # CalculiX': in tests/fem
    assert at_rest < 1e-12 < slow
    assert fast / slow == pytest.approx((5900 / 3100) ** 2, rel=0.1), "and the blade is stiffened"
    assert few.speeds[2].radius == pytest.approx(0.34, rel=0.01)


@pytest.mark.parametrize(("coriolis", "finer"), [(1e-4, True), (9e-4, False)])
def test_a_finer_mesh_is_named_where_the_rest_leaves_room(few, coriolis, finer):
    """The accuracy asked for is 0.05 %: no mesh takes away what else is in an error."""
    point, scene = few.speeds[0], few.scene.changed(accuracy={"frequency": 5e-4})
    none = dict.fromkeys((part.name for part in fields(ErrorParts)), 0.0)
    parts = ErrorParts(**none | {"mesh": 4e-3, "coriolis": coriolis})
    modes = tuple(replace(mode, error_parts=parts) for mode in point.modes)
    said = remarks.sentence(replace(few, scene=scene, speeds=(replace(point, modes=modes),)))
    assert ("a finer mesh would reduce the error" in said) == finer
    assert ("no setting achieves less than about 0.09 %" in said) != finer


def test_more_speeds_are_the_same_blade(few, folder):
    """Speeds between those that are solved: what few speeds, each solved by itself, give."""
    speeds = "'0 rpm', '1000 rpm', '2000 rpm', '3100 rpm', '4000 rpm', '5900 rpm'"
    many = pipeline.structure(scene(folder, SCENE, speeds), QUIET).results()
    one, other = few.speeds[1], many.speeds[3]
    for alone, between in zip(one.modes, other.modes, strict=True):
        assert alone.error_parts.basis == 0.0 < between.error_parts.basis < 1e-3
        assert between.frequency_hz == pytest.approx(alone.frequency_hz, rel=between.error_parts.basis)


def test_modes_of_a_blade_are_written_at_every_speed_and_read_between_them(folder):
    """As known modes they have the frequencies of the blade, and its ball's pull but for the line that strays."""
    rest, half, full = (float(speed) for speed in (1000, 3500, 5900))
    blade = scene(folder, SCENE + DAMPER, f"'{rest} rpm', '{half} rpm', '{full} rpm'")
    model = pipeline.modes(blade, QUIET)
    assert [modes.omega for modes in model.speeds] == [from_rpm(speed) for speed in (rest, half, full)]
    files.save_modes(model, folder / "fan.npz", "--out")
    own = pipeline.structure(blade, QUIET, shapes=False)
    text = (SCENE + DAMPER).format(speeds=f"'{rest} rpm', '2000 rpm', '{full} rpm'")
    old = '[blade]\nmesh = "fan.inp"\nroot = "nroot"\n\n[material]\nname = "Ti-6Al-4V"\n'
    assert old in text
    (folder / "known.toml").write_text(text.replace(old, '[structure]\nmodes = "fan.npz"\n'), encoding="utf-8")
    known = pipeline.structure(load(folder / "known.toml"), QUIET, shapes=False)
    for one, other in zip(own.points[::2], known.points[::2], strict=True):
        assert [mode.frequency_hz for mode in one.modes] == pytest.approx([mode.frequency_hz for mode in other.modes])
        assert one.reduced.f1_hz == pytest.approx(other.reduced.f1_hz, rel=1e-3)
        (modes,) = (each for each in model.speeds if each.omega == one.omega)
        strain = other.root_strain / math.sqrt(other.reduced.M2)  # M2 is 1 over the square of the shape at the cavity
        assert strain == pytest.approx(largest_strain(model, modes, 0), rel=2e-4)
        assert other.root_strain <= (1 + 1e-4) * one.root_strain, "of the blade, the section at the root counts too"
        assert other.root_strain == pytest.approx(one.root_strain, rel=0.05)
    strays = [remark for remark in known.source.remarks if remark.startswith("The straight line from the root")]
    assert len(strays) == 1
    assert not any(remark.startswith("The straight line") for remark in own.source.remarks)


@pytest.mark.parametrize("case", TEXTS["fan"].values(), ids=TEXTS["fan"])
def test_what_is_wrong_is_one_line_with_its_key(folder, case):
    with pytest.raises(BadInput, match=case["says"]) as refused:
        pipeline.run(scene(folder, change=case["change"]))
    assert "\n" not in str(refused.value)


def test_too_large_a_blade_is_refused_before_it_is_solved(folder, monkeypatch):
    """On a machine with room for the program and 20 MB."""
    own = min(float(psutil.Process().memory_info().rss), resources.BASE)
    monkeypatch.setattr(resources, "available", lambda: resources.BASE + 2e7 - own)
    with pytest.raises(BadInput, match=r"\[blade\] mesh = 'fan.inp': this needs about .* coarsen the mesh"):
        pipeline.run(scene(folder, SCENE + DAMPER + "\n", speeds="'0 rpm', '100 rpm'"))


def test_a_blade_that_diverges_is_called_a_blade(folder):
    """One that points at the axis is pressed, not stretched, and buckles."""
    flat(folder, (8, 2, 1), "inwards.inp", chord=0.02, thickness=0.002, hub_radius=-0.3)
    with pytest.raises(NoAnswer, match=r"\[rotor\] speeds: the blade diverges at 9000 rpm: "):
        pipeline.run(scene(folder, SCENE, "'9000 rpm'", change=("fan.inp", "inwards.inp")))


MEASURED = {21_699: 0.77e9, 68_715: 2.83e9, 155_175: 1.07e9 + 2 * 2.64e9}
"""Bytes in use at most of whole sweeps with so many unknowns; the last: matrices, and two factors of 262 million."""


@pytest.mark.parametrize("unknowns", MEASURED)
def test_the_memory_of_a_blade_is_foreseen(unknowns):
    """Not below what was measured, and not half as much again above it."""
    foreseen = resources.BASE + resources.of_a_blade(unknowns)
    assert 1.0 <= foreseen / MEASURED[unknowns] <= 1.5


def test_eight_gigabytes_hold_a_blade_or_it_is_refused(folder, monkeypatch):
    monkeypatch.setattr(resources, "available", lambda: 8e9)
    source = scene(folder)
    resources.check_blade(source, 130_000)
    with pytest.raises(BadInput, match=r"this needs about 20 GB of memory, .* coarsen the mesh, which has 300000 unk"):
        resources.check_blade(source, 300_000)


TURBINE = make.Airfoil(0.07, 0.04, 0.006, 0.9, 0.6, edge=0.4, pretwist=18, camber=28, hub_radius=0.22)


def test_a_stiff_blade_calls_for_no_newton(folder, monkeypatch):
    """A turbine's blade at 11 200 rpm: large deflection moves it by 0.006 %, which stands beside each frequency."""
    make.write_inp(folder / "turbine.inp", make.solid(TURBINE, (8, 4, 1), 4.0), "turbine")
    speeds, mesh = "'5600 rpm', '11200 rpm'", ("fan.inp", "turbine.inp")
    linear = scene(folder, SCENE, speeds, change=mesh)
    monkeypatch.setattr("fem.solid.sweep.equilibrium", None)
    found = pipeline.structure(linear, QUIET)
    effect = found.effects["large_deflection"]
    assert not effect.on
    assert re.match(
        r"at 11200 rpm it moves frequencies by at most about 0\.0\d+ %, less than a tenth of the", effect.why
    )
    slow, fast = (point.modes[0].error_parts.large_deflection for point in found.points)
    assert 0.0 < slow < fast == effect.left_out.shifts[0, 0] < 5e-4
    monkeypatch.undo()
    asked = scene(folder, SCENE + "[effects]\nlarge_deflection = true\n", speeds, change=mesh)
    for one, other in zip(found.points, pipeline.structure(asked, QUIET).points, strict=True):
        for mode, exact in zip(one.modes, other.modes, strict=True):
            off = abs(mode.frequency_hz / exact.frequency_hz - 1.0)
            assert off <= mode.error_parts.large_deflection + mode.error_parts.basis + exact.error_parts.basis


def test_the_table_of_check_has_the_effects_that_all_speeds_call_for(folder, spindamp):
    """Alone, 2000 rpm calls for no large deflection, with which the run solves it: 109.698 Hz, without it 109.693."""
    source = scene(folder, speeds="'2000 rpm', '5900 rpm'")
    (slow, _) = pipeline.structure(source, QUIET, shapes=False).points
    found = json.loads(spindamp("check", folder / "fan.toml", "--json").out)["seat"]["modes"]
    for mode, solved in zip(found, slow.modes, strict=True):
        assert mode["frequency_hz"] == pytest.approx(solved.frequency_hz, rel=1e-8)


def test_plate_and_blade_exclude_each_other():
    with pytest.raises(BadInput, match=r"\[plate\]: expected a \[blade\] or this: leave one out"):
        parse({"blade": {"mesh": "a.inp"}, "plate": {}, "rotor": {"speeds": [1.0]}})


def test_a_flat_plate_of_bricks_has_the_plates_numbers(tmp_path):
    """Frequencies within both estimates; what the damper meets within 0.4 %: two theories, two meshes."""
    flat(tmp_path, (10, 4, 2), "flat.inp", 3.0)
    plate = PLATE.format(place="hub_radius = '50 mm'", at="['200 mm', '0 mm']")
    bricks = PLATE.format(place="origin = [0.0, 0.0, 0.0]", at="['250 mm', '0 mm', '0 mm']")
    (tmp_path / "plate.toml").write_text(f"[plate]\nlength = 0.2\nwidth = 0.08\nthickness = 0.01\n{plate}")
    (tmp_path / "bricks.toml").write_text(f"[blade]\nmesh = 'flat.inp'\n{bricks}")
    (one,), (other,) = (
        pipeline.structure(load(tmp_path / f"{name}.toml"), QUIET).points for name in ("plate", "bricks")
    )
    for known, found in zip(one.modes, other.modes, strict=True):
        assert found.family == known.family
        off = abs(found.frequency_hz / known.frequency_hz - 1.0)
        assert off <= found.error_estimate + known.error_estimate
    for name in ("f1_hz", "f2_hz", "M2", "K2", "floor_tilt"):
        assert getattr(other.reduced, name) == pytest.approx(getattr(one.reduced, name), rel=4e-3), name
    stress = 4430 * other.omega**2 * (0.25**2 - 0.05**2) / 2
    assert other.root_stress == pytest.approx(stress, rel=1e-9)
    for known, found in zip(one.cavity_modes, other.cavity_modes, strict=True):
        for axis in range(2):
            assert abs(found.shape[axis]) == pytest.approx(abs(known.shape[axis]), rel=5e-3, abs=1e-6)
            assert abs(found.slope[axis]) == pytest.approx(abs(known.slope[axis]), rel=5e-3, abs=1e-4)


@pytest.fixture(scope="module")
def bricks(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bricks")
    flat(folder, (4, 2, 1), "flat.inp", 3.0)
    return folder


def on_bricks(folder, old="", new=""):
    text = f"[blade]\nmesh = 'flat.inp'\n{PLATE.format(place='origin = [0.0, 0.0, 0.0]', at='[0.25, 0.0, 0.0]')}"
    assert old in text
    (folder / "bricks.toml").write_text(text.replace(old, new), encoding="utf-8")
    return load(folder / "bricks.toml")


@pytest.mark.parametrize(
    ("cavity", "wrong"),
    [('["5 mm", "5 mm"]', None), ('["12 mm", "5 mm"]', (1, 2.5)), ('["12 mm", "90 mm"]', (5.1, 45))],
)
def test_a_cavity_that_the_blade_has_no_room_for_is_remarked(bricks, cavity, wrong):
    """A plate of 10 mm times 80 mm."""
    said = pipeline.structure(on_bricks(bricks, '["5 mm", "5 mm"]', cavity), QUIET).results(stages=QUIET).notes
    assert len(said) == (wrong is not None)
    if wrong is not None:
        far, across = wrong
        assert f"sticks out of the structure by up to {far:g} mm, near (2" in said[0]
        assert re.search(rf"near \(24[68], -?{across:g}\.?\d*, ", said[0])


def test_a_node_goes_by_the_number_of_its_file(tmp_path):
    """It went by its place in the file, here 17, the number of another node; a VTU has no numbers."""
    mesh = flat(tmp_path, (4, 2, 1), "flat.inp", 3.0)
    labels = 17 + 5 * np.arange(len(mesh.points))[::-1]
    nodes = [f"{label},{','.join(map(repr, at))}" for label, at in zip(labels, mesh.points.tolist(), strict=True)]
    cells = [f"{n},{','.join(map(str, labels[own]))}" for n, own in enumerate(mesh.cells[0].data, 1)]
    (tmp_path / "flat.inp").write_text("\n".join(["*NODE", *nodes, "*ELEMENT,TYPE=C3D20R", *cells]) + "\n")
    place = np.flatnonzero((mesh.points == [0.25, 0.0, 0.0]).all(axis=1)).item()
    named, given = (
        pipeline.structure(on_bricks(tmp_path, "at = [0.25, 0.0, 0.0]", f"at = {at}"), QUIET, shapes=False)
        for at in (labels[place], [0.25, 0.0, 0.0])
    )
    assert named.points[0].reduced == given.points[0].reduced
    for number in (place + 1, labels.max() + 5):
        problem = rf"\[damper\] at = {number}: no such node: expected a number from 17 to {labels.max()}"
        with pytest.raises(BadInput, match=problem):
            pipeline.structure(on_bricks(tmp_path, "at = [0.25, 0.0, 0.0]", f"at = {number}"), QUIET)
    mesh.write(tmp_path / "flat.vtu")
    (tmp_path / "bricks.toml").write_text((tmp_path / "bricks.toml").read_text().replace("flat.inp", "flat.vtu"))
    with pytest.raises(BadInput, match="the numbers of the nodes are not known from this file: expected three"):
        pipeline.structure(load(tmp_path / "bricks.toml"), QUIET)


TITANIUM = ["*MATERIAL,NAME=TI", "*ELASTIC", "1.138E11,0.342", "*DENSITY", "4430."]
SECTION = "*SOLID SECTION,ELSET=EALL,MATERIAL={}"
UNUSED = {
    "the same": ([*TITANIUM, SECTION.format("TI"), "*BOUNDARY", "NROOT,1,3", "NALL,4,6"], None),
    "a mass": (["*ELEMENT,TYPE=MASS,ELSET=M", "901,9", "902,10", "*MASS,ELSET=M", "0.05"], "2 MASS (mass is missing)"),
    "shells": (["*ELEMENT,TYPE=S8R", "901,1,2,3,4,5,6,7,8"], "1 S8R (mass and stiffness are missing)"),
    "beams": (["*ELEMENT,TYPE=B32", "901,1,2,3", "902,3,4,5"], "2 B32 (mass and stiffness are missing)"),
    "edges of a mesher": (["*ELEMENT,TYPE=T3D2", "901,1,2", "*ELEMENT,TYPE=CPS6", "902,1,2,3,4,5,6"], None),
    "springs": (["*ELEMENT,TYPE=SPRINGA", "901,1,", "2"], "1 SPRINGA (stiffness is missing)"),
    "constraints": (["*EQUATION", "2", "9,1,1.,10,1,-1.", "*MPC", "TIE,1,2", "*EQUATION"], "EQUATION (2); MPC (1)"),
    "supports": (
        ["*NSET,NSET=Ntip", "80,81", "*STEP", "*BOUNDARY", "NROOT,1,3", "NTIP,3", "82,1,2", "83,4,6", "NALL,4"],
        "BOUNDARY on 2 nodes not clamped here (NTIP); BOUNDARY on 1 node not clamped here (by number)",
    ),
    "another material": (
        [*TITANIUM, SECTION.format("AL"), "*MATERIAL,NAME=AL", "*DENSITY", "2800.,", "*ELASTIC", "7.D10,0.33"],
        "a material of 70 GPa, 2800 kg/m³, ν = 0.33",
    ),
    "no Poisson's ratio": (
        [SECTION.format("AL"), "*MATERIAL,NAME=AL", "*ELASTIC", "7.D10", "*DENSITY", "2800."],
        "a material of 70 GPa, 2800 kg/m³, ν = 0",
    ),
    "none behind a comma": (
        [SECTION.format("AL"), "*MATERIAL,NAME=AL", "*ELASTIC", "7.D10,", "*DENSITY", "2800."],
        "a material of 70 GPa, 2800 kg/m³, ν = 0",
    ),
    "bedding and paint": (
        ["*FOUNDATION", "EALL,F1,1.E9", "*NONSTRUCTURAL MASS,ELSET=EALL,UNITS=TOTAL MASS", "0.1"],
        "FOUNDATION (1); NONSTRUCTURAL MASS (1)",
    ),
    "oriented, and isotropic": ([*TITANIUM, f"{SECTION.format('TI')},ORIENTATION=O", "*ORIENTATION,NAME=O"], None),
    "materials": ([*TITANIUM, SECTION.format("TI"), SECTION.format("AL")], "the materials TI and AL"),
    "orthotropic": (
        [
            *TITANIUM[:1],
            "*ELASTIC,TYPE=ENGINEERING CONSTANTS",
            "1.,1.,1.,.3,.3,.3,1.,1.,",
            "1.,294",
            "*ORIENTATION,NAME=O",
        ],
        "ELASTIC, TYPE=ENGINEERING CONSTANTS (1); ORIENTATION (1)",
    ),
}


@pytest.mark.parametrize("case", UNUSED)
def test_what_a_deck_says_and_a_blade_has_not_is_remarked(tmp_path, case):
    lines, unused = UNUSED[case]
    flat(tmp_path, (4, 2, 1), "flat.inp", 3.0)
    with (tmp_path / "flat.inp").open("a") as deck:
        deck.write("\n".join(lines) + "\n")
    remark = (
        f"flat.inp has more that is not used: {unused}. The blade is solved without this, of the scene's [material]"
    )
    notes = pipeline.structure(on_bricks(tmp_path), QUIET, shapes=False).source.remarks
    assert [note.removesuffix(" alone.") for note in notes] == ([] if unused is None else [remark])


CARDS = ["MAT1,1,1.138+11,,.342,4430.", "PSOLID,1,1"]
UNUSED_CARDS = {
    "the same": ([*CARDS, "SPC1,1,123,1,THRU,3", "SPC,2,90,456"], None),
    "supports": (
        [*CARDS, "SPC1,1,13,1,THRU,90000", "SPC,2,90,1,,91,456"],
        "SPC on {free} nodes not clamped here (by number)",
    ),
    "a node": ([*CARDS, "SPC1,1,123456,80", "SPC1,1,456,81,82"], "SPC on 1 node not clamped here (by number)"),
    "a weight density": (["PARAM,WTMASS,.1", "MAT1,1,1.138+11,,.342,44300.", "PSOLID,1,1"], None),
    "a mass density": ([*CARDS, "PARAM,WTMASS,.5"], "a material of 113.8 GPa, 2215 kg/m³, ν = 0.342"),
    "a material of no element": ([*CARDS, "MAT1,2,7.+10,,.3,2700.", "PSOLID,2,2"], None),
    "two materials": (
        ["PSOLID,2,2", *CARDS, "MAT1,2,7.+10,,.3,2700.", "CHEXA,900,2,{cell}"],
        "the materials 2 and 1",
    ),
    "splines and paint": (
        [*CARDS, "RSPLINE,903,.1,1,2,3", "NSM1,1,PSOLID,1,.1", "NSML,1,PSOLID,1,.1"],
        "RSPLINE (1); NSM1 (1); NSML (1)",
    ),
}


@pytest.mark.parametrize("case", UNUSED_CARDS)
def test_what_cards_of_nastran_say_and_a_blade_has_not_is_remarked(tmp_path, case):
    """The root is x = 50 mm, of the nodes 1 to 3 too; cells are of property 1, the last of two."""
    mesh = flat(tmp_path, (4, 2, 1), "flat.inp", 3.0)
    cards, unused = UNUSED_CARDS[case]
    cells = [",".join(map(str, cell[[*range(12), *range(16, 20), *range(12, 16)]] + 1)) for cell in mesh.cells[0].data]
    lines = [f"GRID,{n},,{','.join(map(repr, at))}" for n, at in enumerate(mesh.points.tolist(), 1)]
    rows = [f"CHEXA,{n},1,{own}" for n, own in enumerate(cells[: -1 if "{cell}" in cards[-1] else None], 1)]
    rows += [card.replace("{cell}", cells[-1]) for card in cards]
    for row in rows:
        words = row.split(",")
        lines += [
            ",".join([words[0], *words[1:9]]),
            *(",".join(["", *words[k : k + 8]]) for k in range(9, len(words), 8)),
        ]
    (tmp_path / "flat.bdf").write_text("\n".join(["BEGIN BULK", *lines, "ENDDATA"]) + "\n")
    free = np.count_nonzero(mesh.points[:, 0] > 0.0501)
    structure = pipeline.structure(on_bricks(tmp_path, "flat.inp", "flat.bdf"), QUIET, shapes=False)
    remark = (
        f"flat.bdf has more that is not used: {(unused or '').format(free=free)}. The blade is solved without this,"
    )
    notes = structure.source.remarks
    assert [note[: len(remark)] for note in notes] == ([] if unused is None else [remark])


def test_cells_with_fewer_points_are_said_to_be_solved_as_others(tmp_path):
    """C3D8I and C3D8R do not lock as C3D8 do, as which they are solved."""
    mesh = flat(tmp_path, (4, 2, 1), "flat.inp", 3.0)
    corners = mesh.cells[0].data[:, :8] + 1
    nodes = [f"{n},{','.join(map(repr, at))}" for n, at in enumerate(mesh.points.tolist(), 1)]
    for kind, said in (("C3D8I", ", and its C3D8I are solved here as C3D8:"), ("C3D8", ":")):
        cells = [f"{n},{','.join(map(str, own))}" for n, own in enumerate(corners, 1)]
        (tmp_path / "flat.inp").write_text("\n".join(["*NODE", *nodes, f"*ELEMENT,TYPE={kind}", *cells]) + "\n")
        notes = pipeline.structure(on_bricks(tmp_path), QUIET, shapes=False).source.remarks
        assert notes[0].startswith(
            f"The mesh is of first order{said} such cells are far too stiff in bending (they lock)"
        )


@pytest.mark.parametrize("case", TEXTS["bricks"].values(), ids=TEXTS["bricks"])
def test_a_damper_that_a_blade_cannot_hold_is_refused(bricks, case):
    """A plate of 10 mm times 80 mm times 200 mm of 4430 kg/m³; steel of 7850 kg/m³."""
    with pytest.raises(BadInput, match=rf"\[damper\] {case['says']}") as refused:
        pipeline.structure(on_bricks(bricks, *case["change"]), QUIET)
    assert "\n" not in str(refused.value)


def test_a_verdict_on_a_cavity_that_sticks_out_says_so(bricks):
    text = "this holds only if the cavities fit: they stick out of the blade by up to 1 mm"
    for cavity, sticks_out in (('["12 mm", "5 mm"]', True), ('["5 mm", "5 mm"]', False)):
        source = on_bricks(bricks, '["5 mm", "5 mm"]', cavity)
        assert (text in answer(pipeline.run(source)).verdict) == sticks_out
        told = dict(viewer.of(str(bricks / "bricks.toml")).facts)["damper"]
        assert told == "at 250, 0, 0 mm" + f"; {text}" * sticks_out


def test_a_sweep_says_how_far_a_cavity_sticks_out(bricks):
    on_bricks(bricks, '["5 mm", "5 mm"]', '["5 mm", "5 mm"]')
    with ThreadPoolExecutor(1) as pool:
        found = spindamp.sweep(
            bricks / "bricks.toml", {"damper.cavity[0]": ["5 mm", "12 mm"]}, quick=True, executor=pool
        )
    far = found.sticks_out.isel({"rotor.speeds": 0}).values
    assert np.isnan(far[0])
    assert far[1] == pytest.approx(1e-3)


def with_clearances(folder, *clearances, limit=""):
    """One ball of 4 mm in 10 mm of metal, in cavities of so many mm more."""
    free = f"[design]\nclearance = {[f'{each} mm' for each in clearances]}\namplitude = ['5 mm', '6 mm']\n{limit}"
    return on_bricks(folder, "[accuracy]", f"{free}\n[accuracy]").changed(damper={"count": 1})


def test_a_design_whose_cavity_sticks_out_of_a_solid_blade_is_not_feasible(bricks):
    """Boxes of 12 and 10.06 mm in 10 mm of metal, and one of 40 mm that is for the most part beside it.

    As a run has it, a hundredth of the smallest side, 0.04 mm, may stick out.
    """
    space = design_space(with_clearances(bricks, 8, 36, 6.06))
    rows = (np.arange(3)[:, None] + 0.5) / 3
    thick, large, fits = evaluate_designs(space, rows, quick=True)
    assert "[damper] cavity = " in large.why.text
    assert re.search("the box of 40 x 40 x 4 mm .* only \\d+ % of it is in metal", large.why.text)
    assert (thick.why.kind, thick.impossible) == ("sticks_out", True)
    assert 1e3 * thick.sticks_out == pytest.approx(1.0)
    assert not fits.impossible
    for longest, named in ((6.06, ["fit"]), (1.5, ["clearance"]), (3, [])):
        space = design_space(with_clearances(bricks, 0.5, 1, longest))
        (best,) = evaluate_designs(space, rows[2:], quick=True)
        limits = active_constraints(
            space, Optimum(rows[2], best, 3), lambda *given: evaluate_designs(*given[:2], quick=given[2])
        )
        assert [each.name for each in limits if each.name != "amplitude"] == named, (
            "a clearance 5 % longer than the first does not fit; longer than the last, the ball damps less"
        )
    elsewhere = Optimum(rows[2], replace(fits, why=None, sticks_out=1e-3), 3)
    qualified = "; this holds only if the cavity fits: it sticks out of the structure by up to 1 mm"
    assert verdict(space, elsewhere).endswith(qualified), "where the structure is not a solid blade"


def test_that_a_cavity_has_to_fit_limits_where_a_larger_one_would_be_better(bricks):
    """What it would gain is the worth of a clearance 5 % larger, though it sticks out; a worse one is no limit."""
    space = design_space(with_clearances(bricks, 1, 2, 6.06))
    best, asked = Optimum(np.array([5 / 6]), Evaluation(1e-3, 1e-3), 3), list[float]()

    def limits(value):
        def score(space, shares, _):
            asked.append(space.values(shares[0])["damper.clearance"] / 6.06e-3)
            out = Evaluation(0.0, -101.0, why=Obstacle("sticks_out", value=1e-4))
            return [out if space.has_to_fit else Evaluation(value, value)]

        return active_constraints(space, best, score)

    assert limits(9e-4) == ()
    assert asked == pytest.approx([1.05, 1.02, 1.05])
    (limit,) = limits(1.2e-3)
    assert (limit.name, limit.gain) == ("fit", pytest.approx(0.2))
    assert limit.said == "the cavity has to lie within the blade, which limits the clearance"


def test_a_design_space_in_which_no_cavity_fits_says_by_how_much_the_least_sticks_out(bricks, no_workers):
    least = "no design is feasible: every cavity sticks out of the blade, the best one by up to 0.5 mm"
    with pytest.raises(BadInput, match=least):
        design(with_clearances(bricks, 8, 9, 7))
    with pytest.raises(BadInput, match=r"\[design\] wall = 0.001: on a solid blade the cavity itself has to fit"):
        design(with_clearances(bricks, 1, 2, 3, limit="wall = '1 mm'"))


def test_metal_is_missing_where_half_of_a_cavity_is_in_it_and_not_where_the_mesh_has_it_cut(bricks, tmp_path):
    """The middle of a cavity at the skin is in no cell: it lies 0.1 mm off; its mass is that of one inside."""
    automatic = ("cavity_mass = false", "")
    middle = on_bricks(bricks, *automatic)
    skin = middle.changed(damper={"at": (0.25, 0.0, 0.0055), "normal": (1.0, 0.0, -0.05)})
    (one,), (other,) = (pipeline.structure(each, QUIET).points for each in (middle, skin))
    assert other.modes[0].error_parts.cavity_mass == pytest.approx(one.modes[0].error_parts.cavity_mass, rel=0.05)
    block = flat(tmp_path, (6, 5, 3), length=0.06, chord=0.05, thickness=0.03)
    (cells,) = (each.data for each in block.cells)
    centres = block.points[cells].mean(axis=1)
    cut = np.linalg.norm(centres - (0.095, 0.0, 0.0), axis=1) > 1e-3
    assert (~cut).sum() == 1
    for kept in (cut, np.full(len(cells), True)):
        mesh = meshio.Mesh(block.points, [(block.cells[0].type, cells[kept])], point_sets=block.point_sets)
        make.write_inp(tmp_path / "flat.inp", mesh, "block")
        source = on_bricks(tmp_path, *automatic)
        for sides in (0.01, 0.011):
            size = {"at": (0.1, 0.0, 0.0), "radius": 0.005, "cavity": (sides, sides), "count": 1}
            state = pipeline.structure(source.changed(damper=size), QUIET)
            assert not any("sticks out" in note for note in state.source.remarks)
            assert (state.points[0].modes[0].error_parts.cavity_mass is None) == (kept is cut)


def test_the_cavity_of_the_shipped_blade_fits_and_its_mass_is_an_error(bricks):
    """Not so 0.7 mm off the middle of its thickness. The balls' own pull is not that of the cavities' metal."""
    path = Path(make.__file__).parent / "fan_blade.toml"
    slow = path.read_text(encoding="utf-8").replace("speeds = {", "speeds = [0.0]  # {")
    for place, sticks_out in (("10.08 mm", False), ("10.8 mm", True)):
        assert "10.08 mm" in slow
        source = SceneFile(parse(tomllib.loads(slow.replace("10.08 mm", place))), "fan", path.parent)
        (point,), notes = (state := pipeline.structure(source, QUIET)).points, state.source.remarks
        assert any("sticks out" in note for note in notes) == sticks_out
    raised = 4430 * source.scene.damper.cut / point.reduced.M2 / 2
    assert point.modes[0].error_parts.cavity_mass == pytest.approx(raised, rel=0.1)
    (tip,) = pipeline.structure(on_bricks(bricks, "cavity_mass = false", ""), QUIET).points
    still = 4430 * 20 * 4e-3 * 5e-3**2 / tip.reduced.M2 / 2
    assert 0.5 * still < tip.modes[0].error_parts.cavity_mass < still, "the load on it stiffens"
    (without,) = pipeline.structure(on_bricks(bricks), QUIET).points
    assert without.modes[0].error_parts.cavity_mass is None


def test_meshes_of_first_order_are_warned_of_wherever_they_are_used(tmp_path, spindamp):
    """In `check`, also as JSON, and on the terminal, with a report and without."""
    fine = flat(tmp_path, (4, 2, 1))
    used, number = np.unique(fine.cells[0].data[:, :8], return_inverse=True)
    meshio.write(tmp_path / "flat.inp", meshio.Mesh(fine.points[used], [("hexahedron", number.reshape(-1, 8))]))
    on_bricks(tmp_path)
    scene = tmp_path / "bricks.toml"
    for arguments in (("check", scene), ("check", scene, "--json"), ("campbell", scene)):
        assert "The mesh is of first order" in spindamp(*arguments).out
    said = spindamp("campbell", scene, "--out", tmp_path / "out").out
    assert "The mesh is of first order" in said
    assert "before the cavities" not in said, "a blade is solved as its mesh is"


def test_check_gives_a_place_without_what_rounding_leaves_of_it(bricks, spindamp):
    """The middle of the tip face is given to the nanometre."""
    on_bricks(bricks, "at = [0.25, 0.0, 0.0]", "at = [0.25, 1e-11, -1e-11]")
    said = spindamp("check", bricks / "bricks.toml").out
    assert "# Place (250, 0, 0) mm, " in said
    assert "; load along (1, 0, 0)\n" in said


def test_at_one_speed_a_blade_does_not_say_at_which_other_its_ball_would_move(bricks):
    """Its frequency at another is not known."""
    source = on_bricks(bricks, 'rolling_friction = "0.02 mm"', 'rolling_friction = "1 mm"')
    verdict, (first, *_) = (found := answer(pipeline.run(source))).verdict, found.sentences
    assert verdict == "No: the balls never move within what the blade endures"
    assert "they would move with a rolling friction below" in first
    assert "rpm (" not in first


@pytest.mark.usefixtures("undrawn")
def test_another_mode_than_the_first_that_moves_the_cavity_most_is_named(bricks):
    """Along the chord on the centre line that is the lag mode."""
    lag, bending = (
        pipeline.run(on_bricks(bricks, "friction = 0.3", f"friction = 0.3\ndirection = {way}"), QUIET)
        for way in ([0, 1, 0], [0, 0, 1])
    )
    modes = lag.speeds[0].modes
    number = [mode.family for mode in modes].index("lag")
    assert f"Mode {number + 1} (lag, {significant(modes[number].frequency_hz)} Hz" in remarks.other_mode(lag)
    assert remarks.other_mode(bending) is None
    for found, name, head in ((lag, "lag 1", "lag 1 Hz"), (bending, "first bending", "first Hz")):
        assert text.rows(found)[0][2] == head
        assert f"<th rowspan=2>{name} <small>Hz</small></th>" in page.render(found, page.draw(found))
    with pytest.raises(BadInput, match=r"nothing to draw: expected a plate; mode\(\) draws this structure"):
        text.shown(found).plot.mesh()


def test_what_first_moves_a_ball_does_not_depend_on_how_its_cavity_is_turned(bricks):
    """The same blade, load and motion: the whole amplitude that moves it, and the tilt's share of the drive."""
    found = []
    for angle in np.radians([0.0, 20.0, 45.0, 75.0]):
        turned = f"friction = 0.3\ndirection = [0, {np.sin(angle)}, {np.cos(angle)}]"
        state = pipeline.structure(on_bricks(bricks, "friction = 0.3", turned), QUIET)
        point = state.points[-1]
        system = verdict_damper(state.source.scene, state.effects, point)
        first = min(system.amplitude_of(system.break_away_threshold), coupling.moves_first_from(system, point))
        shortening = coupling.shortening(point) * np.cos(angle) ** 2
        found.append([first / np.cos(angle), system.swing_frequency, shortening, point.tilt_share])
    np.testing.assert_allclose(found, np.broadcast_to(found[0], (4, 4)), rtol=2e-3)
    assert found[0][3] > 0.1


@pytest.fixture(scope="module")
def twisted(tmp_path_factory):
    """A blade so twisted that its fundamental is named lag, at two speeds, with a damper at its tip."""
    folder = tmp_path_factory.mktemp("twisted")
    shape = make.Airfoil(0.24, 0.11, 0.007, 0.95, 0.45, pretwist=85.0, camber=35.0, sweep=0.05, lean=0.03)
    make.write_inp(folder / "fan.inp", make.solid(shape, (4, 2, 1)), "fan")
    text = SCENE.replace("modes = 4", "modes = 2") + DAMPER.replace("26 mm", "43 mm").replace("25 mm", "38 mm")
    (folder / "fan.toml").write_text(text.format(speeds="'3000 rpm', '8000 rpm'"), encoding="utf-8")
    return pipeline.structure(load(folder / "fan.toml"), QUIET).results(stages=QUIET)


def test_the_fundamental_counts_as_the_first_whatever_its_family(twisted):
    """The second, which is named flap, was taken for it, and nothing was said of the root's strength."""
    for point in twisted.speeds:
        assert [mode.family for mode in point.modes] == ["lag", "flap"]
        assert first_frequency(point) == point.modes[0].frequency_hz == pytest.approx(point.reduced.f2_hz, rel=1e-9)
    assert remarks.other_mode(twisted) is None
    stresses = [twisted.scene.material.youngs_modulus * point.root_strain for point in twisted.speeds]
    met = {crossing.label: crossing for crossing in engine_orders.of_points(twisted.speeds, (2, 4))}
    assert min(stresses) < excitation.largest_stress(twisted, met["lag 1"]) < max(stresses), "between two speeds"
    endured = limits.endured(twisted, met["lag 1"].omega)
    assert excitation.endured(twisted, met["lag 1"]) == endured > limits.endured(twisted)
    assert excitation.largest_stress(twisted, met["flap 1"]) is None
    given = replace(twisted, scene=twisted.scene.model_copy(update={"material": None}))  # as of known modes
    assert excitation.largest_stress(given, met["lag 1"]) is None
    assert excitation.endured(given, met["lag 1"]) == endured < math.inf
    assert excitation.endured(given, met["flap 1"]) == math.inf


def test_every_change_of_the_mode_that_the_damper_follows_is_named(twisted):
    """The first was all that was said; a mode that was not asked for is not taken for the last that was."""
    slow, fast = twisted.speeds
    second = replace(fast.reduced, f2_hz=fast.modes[1].frequency_hz)
    one, other = (significant(hertz) for hertz in (slow.modes[0].frequency_hz, second.f2_hz))
    changed = replace(fast, reduced=second)
    cases = {f"mode 2 (flap, {other} Hz": fast.modes, f"a mode not requested ({other} Hz": fast.modes[:1]}
    for what, modes in cases.items():
        point = replace(changed, modes=modes)
        said = remarks.other_mode(replace(twisted, speeds=(point, slow)))
        assert said.startswith(f"Mode 1 (lag, {one} Hz at 3000 rpm), and from 8000 rpm on {what} at 8000 rpm) moves")
        assert first_frequency(point) == second.f2_hz


def test_a_direction_near_the_load_or_the_floors_normal_is_refused_by_the_key_that_gives_it(bricks):
    """On the centre line the load is along x; less of a direction than a sixth across it is what rounding leaves."""
    near = (
        "axis 1 of the cavity must be perpendicular to the {}, but its direction is only {}° from it:"
        " expected 10° or more"
    )
    for key, value, what, problem in (
        ("direction", "[1, 0, 0]", "", near.format("load", 0)),
        ("direction", "[1, 0.14, 0.1]", "", near.format("load", 9.8)),
        ("direction", "[-1, 0.02, 0]", "", near.format("load", 1.1)),
        ("direction", "[0.5, 0, 1]", "normal = [1, 0, 1.5]", near.format("floor's normal", 7.1)),
        ("normal", "[0.12, 0, 1]", "", near.format("floor's normal", 6.8)),
        ("normal", "[0.05, 1, 0]", "", "the load does not press .* 87.1° from the load: expected .* less than 84°"),
    ):
        keys = f"friction = 0.3\n{key} = {value}\n{what}"
        with pytest.raises(BadInput, match=rf"\[damper\] {key} = \[.*\]: {problem}"):
            pipeline.structure(on_bricks(bricks, "friction = 0.3", keys), QUIET)
    kept = on_bricks(bricks, "friction = 0.3", "friction = 0.3\ndirection = [1, 0.15, 0.1]")
    (point,) = pipeline.structure(kept, QUIET).points
    assert point.reduced is not None


def coned(folder, lean=0.08715574, more="", normal=1):
    """One ball on a floor at right angles to the blade, the spin axis leaning towards it or away: by 5 degrees."""
    text = (folder / on_bricks(folder).name).read_text(encoding="utf-8")
    text = text.replace('speeds = ["10000 rpm"]', f'speeds = ["300 rpm"]\naxis = [{lean}, 0, 0.9961947]')
    text = text.replace("count = 20", f"count = 1\nnormal = [{normal}, 0, 0]{more}")
    (folder / "coned.toml").write_text(text, encoding="utf-8")
    return load(folder / "coned.toml")


@pytest.mark.parametrize("way", [1, -1])
def test_a_ball_on_a_floor_that_does_not_face_the_load_falls_to_a_wall(bricks, way):
    """Precone of 5 degrees: Omega² r sin cos along the floor; the fall of a rolling ball, and where it rests."""
    source = coned(bricks, way * 0.08715574)
    state = pipeline.structure(source, QUIET)
    (point,) = state.points
    system = particle_damper(source.scene, state.effects, point)
    drawn, angle = (300 * np.pi / 30) ** 2 * 0.25, np.radians(5.0)
    assert system.centrifugal_acceleration == pytest.approx(drawn * np.cos(angle) ** 2, rel=1e-4)
    pull = -way * drawn * np.sin(angle) * np.cos(angle)
    assert system.lateral_acceleration == pytest.approx((pull, 0.0), rel=2e-3, abs=1e-9)
    motion = ringdown(system, (1e-9, 0.0), 200, keep_events=True)
    first = motion.rows["time"][motion.rows["kind"] == HIT][0]
    rolling = 5 / 7 * (abs(pull) - 0.02 / 2 * drawn * np.cos(angle) ** 2)
    assert first == pytest.approx(np.sqrt(2 * 0.5e-3 / rolling), rel=5e-3)
    # the load bends the plate, and turns the floor with it: a cantilever under rho A Omega² (a + x) sin cos
    bends = 4430 * 8e-4 * (drawn / 0.25) * np.cos(angle) * np.sin(angle) * (0.05 * 0.2**3 / 6 + 0.2**4 / 8)
    turned = bends / (113.8e9 * 0.08 * 0.01**3 / 12)
    lost = 1 - system.lateral_acceleration[0] / pull
    assert lost == pytest.approx(turned / np.tan(angle), rel=0.15)


def test_a_leaning_ball_is_remarked_and_its_normal_looks_outwards(bricks):
    said = remarks.leaning_load(pipeline.run(coned(bricks)))
    assert "to the normal of the cavity's floor by 5°" in said
    assert "leans on a wall" in said
    with pytest.raises(BadInput, match=r"\[damper\] normal = \[-1.0, 0.0, 0.0\]: the load does not press"):
        pipeline.run(coned(bricks, normal=-1))


@pytest.mark.parametrize("floor", ["", '\nfloor_radius = "5 mm"'])
def test_a_ball_at_a_wall_moves_with_the_rolling_friction_that_is_said(floor, bricks, spindamp):
    """What the load pulls it along the floor stays, whatever the rolling friction; `check` shows load and floor."""
    source = coned(bricks, more=floor)
    results = pipeline.run(source)
    remedy = remedies.what_moves(results, results.speeds[0])
    state = pipeline.structure(source, QUIET)
    system = particle_damper(source.scene, state.effects, state.points[0])
    moved = replace(system, rolling_friction=remedy.rolling_friction)
    assert moved.amplitude_of(moved.leaving_threshold) == pytest.approx(limits.endured(results), rel=1e-3)
    said = spindamp("check", bricks / "coned.toml").out
    assert "load along (0.99619, 0, -0.087156)" in said
    assert "° from the load, which pulls the ball along the floor" in said


ROOTS = {
    "the inner end": (lambda x, y: x < 0.051, r"50 to 61.4 mm", None),
    "a fifth": (lambda x, y: x < 0.081, r"50 to 87.6 mm", None),
    "a third": (lambda x, y: x < 0.111, r"50 to 116 mm", r"The root covers 30 % of the blade's radial extent: is it"),
    "an edge": (
        lambda x, y: y < -0.039,
        r"58.3 to 253 mm",
        r"The root covers 9\d % of the blade's radial extent: is it",
    ),
    "the tip": (lambda x, y: x > 0.249, r"250 to 253 mm", r"Most of the blade \(9\d %\) lies nearer the axis than its"),
}


@pytest.mark.parametrize("case", ROOTS)
def test_a_root_that_hardly_is_one_is_remarked(tmp_path, spindamp, case):
    """A plate, x = 50 to 250 mm, 80 mm wide, 35° off the plane of rotation; 61.4² = 50² + (40 cos 35° + 5 sin 35°)²."""
    held, radii, remark = ROOTS[case]
    flat(tmp_path, (20, 2, 1), held=held)
    scene(tmp_path, SCENE, "'10 rpm'")
    said = spindamp("check", tmp_path / "fan.toml").out
    assert f"along x, y and z, at radii of 50 to 253 mm, its root at {radii}, " in said
    remarks = re.findall(r"# (The root covers .*|Most of the blade .*)", said)
    assert len(remarks) == (remark is not None)
    assert remark is None or re.match(remark, remarks[0])


END = {
    "a face": ("nroot", lambda mesh, end: end[mesh.points[end, 1] < 0.001], None),
    "a radius": ("50 mm", lambda mesh, end: end, None),
    "corners": (
        "nroot",
        lambda mesh, end: np.intersect1d(end, mesh.cells[0].data[:, :8]),
        "the root's 6 nodes contain no whole face of a cell, only the corners of 2 without their mid-side nodes: ",
    ),
    "three nodes": (
        "nroot",
        lambda mesh, end: end[[0, 1, -1]],
        "the root's 3 nodes contain no whole face of a cell: expected all nodes of the clamped faces$",
    ),
    "two edges by their radius": (
        "64.03 mm",
        lambda mesh, end: end,
        "at the radius 0.06403 m 6 nodes contain no whole face of a cell: expected a radius with whole faces;"
        " the nearest with some is 70 mm$",
    ),
}


@pytest.mark.parametrize("case", END)
def test_a_root_without_a_whole_face_of_a_cell_is_refused(tmp_path, spindamp, case):
    """It was accepted: at half the frequency, and its stress, not known, was taken for 0 at any speed."""
    root, nodes, says = END[case]
    mesh = flat(tmp_path, (10, 2, 1))
    mesh.point_sets["NROOT"] = nodes(mesh, mesh.point_sets["NROOT"])
    make.write_inp(tmp_path / "fan.inp", mesh, "flat")
    scene(tmp_path, SCENE, "'10 rpm'", root=('root = "nroot"', f'root = "{root}"'), level=LEVEL)
    run = spindamp("check", tmp_path / "fan.toml")
    assert (run.status == 0) == (says is None)
    assert says is None or re.search(rf"\[blade\] root = '{root}': {says}", run.err.strip())


def test_a_root_whose_stress_is_not_known_is_remarked(tmp_path, spindamp):
    """Both edges of a plate, whose areas cancel."""
    flat(tmp_path, (4, 2, 1), held=lambda _, y: np.abs(y) > 0.039)
    scene(tmp_path, SCENE, "'10 rpm'")
    assert "# The mean stress at the root is not known, since" in spindamp("check", tmp_path / "fan.toml").out


def test_a_root_up_to_a_radius_clamps_all_nodes_there(tmp_path):
    flat(tmp_path, (20, 4, 1), held=lambda x, y: np.hypot(x, y) <= 0.1 + 1e-9)
    roots = [
        ('root = "nroot"', f"root = {root}") for root in ('"nroot"', '{ radius = "100 mm" }', "{ radius = '40 mm' }")
    ]
    named, within, nowhere = (partial(scene, tmp_path, SCENE, "'6000 rpm'", root=root, level=LEVEL) for root in roots)
    assert workflows.run(within()).speeds[0].modes == workflows.run(named()).speeds[0].modes
    with pytest.raises(BadInput, match=r"\[blade\] root = \{radius = 0.04\}: no nodes lie within 0.04 m of the axis"):
        workflows.run(nowhere())


def test_what_a_root_inside_the_mesh_cuts_off_is_held_with_it(tmp_path):
    """A plate from 50 to 250 mm held at 100 mm is that from there on: its inner part has no modes among them."""
    states = []
    for length, root in (0.2, "100 mm"), (0.15, "NROOT"):
        flat(tmp_path, (round(100 * length), 2, 1), length=length, hub_radius=0.25 - length)
        source = scene(tmp_path, SCENE, "'6000 rpm'", root=('root = "nroot"', f'root = "{root}"'), level=LEVEL)
        states.append(pipeline.structure(source, QUIET, shapes=False))
    inside, alone = (state.points[0] for state in states)
    assert [m.frequency_hz for m in inside.modes] == pytest.approx([m.frequency_hz for m in alone.modes], rel=1e-7)
    assert inside.root_stress == pytest.approx(0.5 * 4430 * inside.omega**2 * (0.25**2 - 0.1**2), rel=1e-2)
    remarks = [" ".join(state.source.remarks) for state in states]
    assert "25 % of the mesh is cut off from the blade by its root" in remarks[0]
    assert "cut off" not in remarks[1]


def test_a_load_that_no_metal_bears_is_remarked_at_the_fastest_speed(tmp_path, spindamp):
    """Mean stress at the root of a bar from r to R: ρΩ²(R² - r²)/2 = 2400 MPa at 40 582 rpm, the edges left out."""
    flat(tmp_path, (10, 2, 1))
    for rpm, said in (40200, False), (41200, True):
        scene(tmp_path, SCENE, f"'0 rpm', '{rpm} rpm'", level=LEVEL)
        out = spindamp("check", tmp_path / "fan.toml").out
        assert ("more than any blade metal bears (2400 MPa): are [blade] unit" in out) == said
    tip, stress = map(float, re.findall(r"tip moves at (\d+) m/s, .* by (\d+) MPa on average", out)[0])
    omega = 41200 * np.pi / 30
    assert tip == pytest.approx(omega * np.hypot(0.25, 0.04), rel=1e-2)
    assert stress == pytest.approx(0.5e-6 * 4430 * omega**2 * (0.25**2 - 0.05**2), rel=1e-2)


@pytest.mark.parametrize("speeds", ["['0 rpm']", "['0 rpm', '3000 rpm']"])
def test_a_single_row_of_hexahedra_is_refused(tmp_path, spindamp, speeds):
    """By the usual two points of integration each way they deform without stress."""
    flat(tmp_path, (3, 1, 1), "row.inp", length=0.1, chord=0.02, thickness=0.02)
    text = f"[blade]\nmesh = 'row.inp'\n[material]\nname = 'steel'\n[rotor]\norigin = [0, 0, 0]\nspeeds = {speeds}\n"
    (tmp_path / "row.toml").write_text(text, encoding="utf-8")
    run = spindamp("campbell", tmp_path / "row.toml")
    assert run.status != 0
    assert "hexahedra of 20 nodes in a row deform without stress" in run.err


@pytest.mark.parametrize(
    ("axis", "along", "lean"),
    [
        ("[0, 0, 1]", False, []),
        ("[0, 1, 0]", False, []),
        ("[1, 0, 0]", True, []),
        ("[0.3, 0, 1]", False, ["17"]),
        ("[0, 0.5, 1]", False, []),
        ("[0.1736, 0, 0.9848]", False, []),
    ],
)
def test_a_spin_axis_along_the_blade_or_that_leans_is_asked_about(tmp_path, spindamp, axis, along, lean):
    """A bar along x: 0.3 for 0 in an axis along z leans it by 16.7°; 10° of cone are none to ask about."""
    flat(tmp_path, (10, 2, 1))
    scene(tmp_path, SCENE, "'10 rpm'", axis=('stagger = "35 deg"', f"axis = {axis}"))
    out = spindamp("check", tmp_path / "fan.toml").out
    assert ("The blade measures 200 mm along the spin axis and 40" in out) == along
    assert ("does [rotor] axis lie along the blade" in out) == along
    if not along:
        assert re.findall(r"leans by (\S+)° out of the plane of rotation", out) == lean


def test_a_blade_wider_than_long_may_have_its_chord_along_the_axis(tmp_path, spindamp):
    """50 mm long and 100 mm wide, at a stagger of 70°: the axis lies across its span, whichever extent is larger."""
    flat(tmp_path, (4, 4, 1), length=0.05, chord=0.1, hub_radius=0.2)
    scene(tmp_path, SCENE, "'10 rpm'", level=('stagger = "35 deg"', 'stagger = "70 deg"'))
    out = spindamp("check", tmp_path / "fan.toml").out
    assert "50 × 100 × 10 mm" in out
    assert "along the spin axis" not in out


def test_the_scene_of_the_guide_is_read():
    """`check`, word for word, beside the mesh that it names."""
    folder = Path(make.__file__).parent
    text = (folder.parent / "docs" / "guide" / "blades.md").read_text(encoding="utf-8")
    (scene_of_guide,) = re.findall(r"```toml\n(.*?)```", text, flags=re.S)
    source = SceneFile(parse(tomllib.loads(scene_of_guide)), "guide", folder)
    blade = blade_of(source)
    assert in_words(source, blade) == (
        "256 hexahedron20 cells of fan_blade.inp, 240 × 110 × 70.6 mm along x, y and z, at radii of 100 to 341 mm,"
        " its root at 100 to 110 mm, 4608 unknowns, 69 nodes clamped"
    )
