"""Scenes whose structure is known by its modes, from CalculiX's files and neutral ones; and files that are spoilt."""

import gzip
import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg

import spindamp as package
from fem.modal_files import read
from tests.workflows.conftest import BALL, QUIET, changed, refused, table_of, write
from workflows import pipeline
from workflows.report import mode_viewer, remarks
from workflows.scene.load import as_scene_file, load
from workflows.solve.results import ErrorParts

pytestmark = pytest.mark.usefixtures("undrawn")

DATA = Path(__file__).parents[1] / "fem" / "data"
SCENE = {
    "title": "Known",
    "structure": {"modes": "rest.frd"},
    "rotor": {"speeds": ["0 rpm"], "axis": [0, 0, 1], "origin": ["0 m", "0 m", "0 m"], "gravity": "10 m/s^2"},
    "damper": BALL
    | {"at": ["200 mm", "0 mm", "0 mm"], "ball_material": "steel", "radius": "3 mm", "cavity": ["7 mm", "7 mm"]}
    | {"rolling_friction": "0.06 mm", "damping_ratio": 0.001},
    "release": {"displacement": ["1 mm", "0 mm"], "cycles": 5},
}
BOTH = {"0 rpm": "rest.frd", "10000 rpm": "fast.frd"}


@pytest.fixture
def files(tmp_path, monkeypatch):
    """CalculiX's modes of a plate at rest and at speed, in the current folder."""
    monkeypatch.chdir(tmp_path)
    for name, file in (("rest", "plate_paper_0"), ("fast", "plate_paper_10000")):
        (tmp_path / f"{name}.frd").write_bytes(gzip.decompress((DATA / f"{file}.frd.gz").read_bytes()))
    return tmp_path


def figures(results):
    """What a verdict rests on, at the last speed."""
    own, reduced = results.speeds[-1].damping_curve, results.speeds[-1].reduced
    return [own.peak, own.peak_amplitude, *own.half, own.cutoff, reduced.f1_hz, reduced.M2, reduced.floor_tilt]


@pytest.fixture(scope="module")
def plate():
    """The same plate for our own finite elements."""
    scene = changed(SCENE, structure=None, rotor__axis=None, rotor__origin=None, damper__at=None)
    scene["plate"] = {"length": "200 mm", "width": "80 mm", "thickness": "10 mm", "theory": "mindlin"}
    scene["material"] = {"youngs_modulus": "182.6 GPa", "poissons_ratio": 0.3, "density": 7850}
    scene["effects"] = {"structural_modes": True, "floor_tilt": True, "coriolis": False, "cavity_mass": False}
    return changed(scene, rotor__speeds=["10000 rpm"])


@pytest.mark.parametrize("speeds", [["5000 rpm", "10000 rpm"], ["0 rpm", "5000 rpm"]])
def test_an_error_that_is_unknown_is_no_figure(files, speeds):
    """Between two speeds that are known, whether that is the first or the last of those run."""
    scene = changed(SCENE, structure={"modes": BOTH}, rotor__speeds=speeds, damper=None, release=None)
    run = package.run(write(scene, files / "scene.toml"))
    parts = ErrorParts(mesh=1e-4, layers=0.0, basis=0.0, theory=0.0, large_deflection=0.0, coriolis=0.0)
    for between in (math.nan, 0.0):
        own = {5000.0: replace(parts, basis=between)}
        points = (
            replace(p, modes=tuple(replace(m, error_parts=own.get(round(p.rpm), parts)) for m in p.modes))
            for p in run.speeds
        )
        said = remarks.sentence(replace(run, speeds=tuple(points)))
        assert said.startswith("Between the speeds of the files the accuracy") == math.isnan(between)
        assert "–" not in said


def test_how_far_a_cavity_sticks_out_is_said_of_each_damper_on_the_same_modes(files):
    """Of a plate of 10 mm; as modes may be those of a blade with a housing, which has no cells, none is refused."""
    for cavity, far in (("7 mm", 0.0), ("12 mm", 1e-3), ("30 mm", 10e-3), ("7 mm", 0.0)):
        source = load(write(changed(SCENE, damper__cavity=[cavity, "7 mm"]), files / "scene.toml"))
        state = pipeline.structure(source, QUIET)
        assert state.points[0].sticks_out == pytest.approx(far, abs=1e-6)
        assert any("it does not fit" in remark for remark in state.source.remarks) == (far > 0.0)


@pytest.mark.usefixtures("quickly")
def test_a_plate_by_its_modes_is_the_plate(files, plate):
    """From CalculiX's modes, whose mesh is 0.17 % too stiff, and from our own in a neutral file; against our plate."""
    whole = package.run(plate)
    own = figures(whole)
    speeds = plate["rotor"]["speeds"]
    calculix = package.run(changed(SCENE, structure__modes=BOTH, rotor__speeds=speeds))
    found = figures(calculix)
    assert found[0] == pytest.approx(own[0], rel=whole.speeds[-1].damping_curve.error)
    assert found[1:5] == pytest.approx(own[1:5], rel=5e-3)
    assert found[5] == pytest.approx(own[5], rel=1.7e-3)
    assert found[6:] == pytest.approx(own[6:], rel=1e-3)
    package.modes(plate, "plate.npz")
    neutral = package.run(changed(SCENE, structure__modes="plate.npz", rotor__speeds=speeds, rotor__axis=None))
    assert figures(neutral) == pytest.approx(own, rel=2e-4)
    assert [mode.family for mode in neutral.speeds[0].modes] == ["flap", "twist", "flap", "lag", "twist", "flap"]
    assert neutral.speeds[0].modes[0].error_estimate is not None
    assert calculix.speeds[0].modes[0].error_estimate is None
    (displaced,) = [note for note in calculix.notes if "the centrifugal load displaces" in note]
    assert displaced.endswith(" mm.")  # a flat plate in the plane of rotation does not twist


def test_check_tells_where_the_cavity_lies(spindamp, files):
    said = spindamp("check", SCENE).out
    (row,) = re.findall(r"^# +1 +198\.64 +flap +(\S+) +(\S+) +(\S+) ", said, re.M)
    assert row == ("311.88", "485.8", "6.932")
    assert "load along (1, 0, 0)" in said
    modes = spindamp.json("check", SCENE)["seat"]["modes"]
    assert modes[3]["mass"][0] is None
    assert modes[0]["mass"][0] == pytest.approx(0.31188, abs=1e-5)


@pytest.mark.usefixtures("no_workers", "quickly")
def test_orders_forces_and_sweeps_take_known_modes(files):
    """Engine order 4 meets the first mode where this mesh solved at each speed has it; a base shakes it with CalculiX's
    participation."""
    scene = changed(SCENE, structure__modes=BOTH, rotor__speeds=["2900 rpm", "3500 rpm"], rotor__modes=4)
    base = changed(scene, excitation={"orders": [4], "base": "1 g"})
    (crossing,) = package.run(base).reductions
    assert crossing.frequency_hz == pytest.approx(206.52196, rel=1e-4)
    force = changed(scene, excitation={"orders": [4], "force": f"{10 * 0.8756 / 1.7895} N"})
    (other,) = package.run(force).reductions
    assert crossing.levels[0].amplitude == pytest.approx(other.levels[0].amplitude, rel=5e-3)
    level = float(force["excitation"]["force"][:-2])
    for x, share, rel in (200, 1.0, 1e-9), (100, 0.3395, 0.02):  # the damper's place; half way, by Euler and Bernoulli
        there = {"force": f"{level / share} N", "at": [f"{x} mm", "0 mm", "0 mm"], "direction": [0, 0, 2]}
        (same,) = package.run(changed(scene, excitation={"orders": [4]} | there)).reductions
        assert same.levels[0].amplitude == pytest.approx(other.levels[0].amplitude, rel=rel)
    swept = package.sweep(changed(scene, rotor__speeds=["3000 rpm"]), {"damper.radius": ["2 mm", "3 mm"]}, quick=True)
    assert np.isfinite(swept["best_damping_ratio"].values).all()


def test_its_surface_moves_in_pages(files):
    """In three dimensions, with fewer points where it has many, also from a folder; a cloud has marks at its nodes."""
    results = package.run(changed(SCENE, damper=None, release=None))
    package.save(results, "out")
    surface = package.load_results("out").surface
    seen = mode_viewer.of_surface(surface, results.speeds, most=200)
    data = json.loads(seen.data)
    assert data["span"] == pytest.approx([0.2, 0.08, 0.01], rel=1e-6)
    assert data["axes"] == {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1], "spin axis": [0, 0, 1]}
    assert seen.points < seen.of / 2
    whole = mode_viewer.thinned(surface, 10**6)
    corners = surface.points[whole.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    assert area == pytest.approx(2 * (0.2 * 0.08 + 0.2 * 0.01 + 0.08 * 0.01))
    (files / "bar.json").write_text(json.dumps(small()))
    cloud = package.run(changed(OF_THE_BAR, damper=None, release=None)).surface
    assert len(cloud.points) == 4 * 9


@pytest.mark.parametrize(
    ("axis", "origin", "says"),
    [
        ([0, 0, 1], "0 mm", None),
        ([0, 1, 0], "-50 mm", None),
        (
            [1, 0, 0],
            "0 mm",
            r"measures 200 mm along the spin axis and 40\.\d mm across it: does \[rotor\] axis lie along",
        ),
        (
            [0, 0, 1],
            "500 mm",
            r"Most of the structure \(9\d\.?\d? %\) lies nearer the axis than its root: the load compr",
        ),
        ([0.3, 0, 1], "-50 mm", r"leans by 17° out of the plane of rotation"),
    ],
)
def test_a_spin_axis_along_known_modes_or_beyond_their_tip_is_remarked(spindamp, files, axis, origin, says):
    """A plate along x, 200 x 80 x 10 mm, clamped at x = 0; as a blade with such an axis is."""
    scene = changed(SCENE, damper=None, release=None, rotor__axis=axis, rotor__origin=[origin, "0 m", "0 m"])
    said = re.findall(r"^# (.*)", spindamp("check", scene).out, re.M)
    found = [remark for remark in said if re.search(r"along the spin axis|nearer the axis|leans by", remark)]
    assert len(found) == (says is not None)
    assert says is None or re.search(says, found[0])


def test_a_load_that_would_tear_known_modes_is_remarked(spindamp, files):
    """A bar to R: ρΩ²R²/2 = 2400 MPa at 36 620 rpm, of 7850 kg/m³ and R² = (200² + 40²) mm²."""
    for rpm, torn in ((36300, False), (36900, True)):
        scene = changed(SCENE, damper=None, release=None, rotor__speeds=[f"{rpm} rpm"])
        said = re.findall(r"^# (At .* rpm the tip .*)", spindamp("check", scene).out, re.M)
        assert len(said) == torn
    ((speed, stress),) = re.findall(
        r"the tip moves at (\d+) m/s, .* of a bar of constant section by (\d+) MPa", said[0]
    )
    assert float(speed) == pytest.approx(36900 * np.pi / 30 * np.hypot(0.2, 0.04), rel=1e-2)
    assert float(stress) == pytest.approx(0.5e-6 * 7850 * float(speed) ** 2, rel=1e-2)
    assert said[0].endswith("Verdicts do not include the root stress of known modes.")


def test_speeds_between_files_are_said(files):
    between = package.run(changed(SCENE, structure__modes=BOTH, rotor__speeds=["5000 rpm"], damper=None, release=None))
    assert any("the error of this is unknown" in note for note in between.notes)
    assert not any("static displacement" in note for note in between.notes)
    orders = {"excitation": {"orders": [4], "force": "1 N"}, "rotor__speeds": ["0 rpm", "10000 rpm"]}
    met = pipeline.structure(as_scene_file(changed(SCENE, structure__modes=BOTH, **orders)), QUIET, shapes=False)
    assert any("the error of this is unknown" in remark for remark in met.source.remarks), "orders meet modes between"
    at_rest = package.run(changed(SCENE, damper=None, release=None))
    assert any("does not state the speed" in note for note in at_rest.notes)


def test_files_that_contradict_their_speeds_are_remarked_on(spindamp, files):
    """One file for two speeds; a file at rest after a static step; and files of different numbers of modes."""
    text = (files / "rest.frd").read_text()
    fewer = text[: text.rindex("    1PSTEP", 0, text.index("3MODAL"))] + " 9999\n"
    (files / "few.frd").write_text(fewer)
    said = {
        "is given for 2 speeds": {"0 rpm": "rest.frd", "10000 rpm": "rest.frd"},
        "The modes at 10000 rpm hold no static displacement": {"0 rpm": "fast.frd", "10000 rpm": "rest.frd"},
        "does it belong to another speed?": {"0 rpm": "fast.frd", "10000 rpm": "rest.frd"},
        "The files hold 2 to 4 modes; the first 2, common to all": {"0 rpm": "few.frd", "10000 rpm": "fast.frd"},
    }
    for words, modes in said.items():
        assert words in spindamp("check", changed(SCENE, structure__modes=modes, rotor__speeds=["5000 rpm"])).out


def test_a_static_step_after_the_modes_is_none_of_theirs(files):
    """That of another load, ten times as large, replaced the one before them."""
    text = (files / "fast.frd").read_text()
    begin, end = text.index("    1PSTEP"), text.index(" -3", text.index("    1PSTEP")) + 4
    assert text[begin:end].split("100CL")[1][50] == "0", "a static step"
    other = re.sub(r"(?m)^( -1.{10})(.{12})", lambda m: f"{m[1]}{10 * float(m[2]):12.5E}", text[begin:end])
    (files / "after.frd").write_text(text.replace("\n 9999", f"\n{other.rstrip()}\n 9999"))
    before, after = (read(files / f"{name}.frd").model.speeds[0] for name in ("fast", "after"))
    assert len(after.frequencies_hz) == len(before.frequencies_hz) == 4
    np.testing.assert_array_equal(after.static, before.static)


def loaded(text, mass, still=None):
    """The modes with a point mass where the first moves most, in the space of all: normalised to mass, too.

    still: mode that does not move the mass.
    """
    every = []
    shapes_of(text, lambda values: every.append(values) or values)
    hertz = np.array([float(number) for number in re.findall(r"(?m)^  100CL.{5}(.{12}).*\n -4  DISP", text)])
    shapes = np.array(every)
    sizes = np.linalg.norm(shapes, axis=2)
    there = np.full(len(sizes[0]), True) if still is None else sizes[still] < 1e-3 * sizes[still].max()
    at = shapes[:, (sizes[0] * there).argmax()]
    squares, mixing = scipy.linalg.eigh(np.diag((2 * np.pi * hertz) ** 2), np.eye(len(hertz)) + mass * at @ at.T)
    changed_shapes = iter(np.einsum("ij,inc->jnc", mixing, shapes))
    blocks = re.split(r"(?m)^(?=    1PSTEP)", shapes_of(text, lambda _: next(changed_shapes)))
    for k, block in enumerate(blocks):
        if mode := re.search(r"1PMODE +(\d+)", block):
            square = squares[int(mode[1]) - 1]
            block = re.sub(r"(?m)^(  100CL.{5}).{12}", rf"\g<1>{square**0.5 / 2 / np.pi:12.7f}", block)
            blocks[k] = re.sub(r"1PGK +\S+", f"1PGK                {square:.6E}", block)
    return "".join(blocks)


def test_modes_with_a_point_mass_are_normalised_to_mass(spindamp, files):
    """They were refused: of the cells alone, the first mode has 2.6 times the density of the others."""
    text = (files / "rest.frd").read_text()
    (files / "rest.frd").write_text(loaded(text, 0.5))
    said = spindamp("check", SCENE).out
    assert re.search(
        r"# By its shapes rest.frd has densities from .*: parts of different density, or point masses\.", said
    )


def test_shapes_scaled_to_one_are_not_normalised_to_mass_whatever_their_mass(spindamp, files):
    """Nor is their modulus one: with a point mass they are not orthogonal in a uniform mass either."""
    text = loaded((files / "rest.frd").read_text(), 0.5)
    (files / "rest.frd").write_text(shapes_of(text, lambda values: values / np.linalg.norm(values, axis=1).max()))
    refused(spindamp("check", SCENE), "scene.toml: [structure] modes: rest.frd: its shapes are not normalised to mass")


@pytest.mark.parametrize("mass", [0.5, 30.0])
def test_so_are_two_modes_with_a_point_mass_where_one_of_them_does_not_move(spindamp, files, mass):
    """Orthogonal in a uniform mass, but of one modulus, they were refused. A heavy mass is no heavy material."""
    text = (files / "rest.frd").read_text()
    two = "".join(re.split(r"(?m)^(?=    1PSTEP)", text)[:3]) + " 9999\n"
    (files / "rest.frd").write_text(loaded(two, mass, still=1))
    said = spindamp("check", SCENE).out
    assert re.search(
        r"# By its shapes rest.frd has densities from 7850 to .*: parts of different density, or point m", said
    )
    assert ", of 7850 kg/m³ by the scale of their modes" in said


def test_millimetres_and_tonnes_are_asked_for(spindamp, files):
    """A file in mm and t: refused as it is, with the units that fit; with them, the plate in SI."""
    lines = (files / "rest.frd").read_text().split("\n")
    nodes, shape = True, 1000.0
    for k, line in enumerate(lines):
        if line.startswith(" -1") and len(line) == 49:
            factor = shape if nodes else 1000.0**0.5
            values = [float(line[13 + 12 * i : 25 + 12 * i]) * factor for i in range(3)]
            lines[k] = line[:13] + "".join(f"{value:12.5E}" for value in values)
        elif line.startswith(" -3"):
            nodes = False
    (files / "rest.frd").write_text("\n".join(lines))
    asked = "unit = 'mm', mass_unit = 't' (7850 kg/m^3)"
    assert "describes a structure 216 m large" in refused(spindamp("check", SCENE), "scene.toml", asked)
    assert "311.88" in spindamp("check", changed(SCENE, structure__unit="mm", structure__mass_unit="t")).out
    refused(spindamp("check", changed(SCENE, structure__unit="mm")), "scene.toml", asked)


def sub(old, new, count=1):
    """A change of text that is there."""

    def change(text):
        assert re.search(old, text, re.M), old
        return re.sub(old, new, text, count=count, flags=re.M)

    return change


def dropped(start):
    """Without the first line of this kind after the header of the first mode."""

    def change(text):
        at = text.index("\n -1", text.index("MODAL"))
        return text[:at] + text[text.index("\n", at + 1) :] if start == "mode" else text.replace("\n -1", "", 1)

    return change


VALUE = r"(MODAL.*\n(?: -[45].*\n)+ -1.{10}).{12}"
"""Up to the first displacement of the first mode, and that."""

SPOILT_FRD = [
    ("empty", lambda _: "", "the file is empty"),
    ("no frd", lambda _: "hello\n", "not an .frd file"),
    ("only a static step", lambda t: t[: t.index("    1PSTEP")] + STATIC + " 9999\n", "only a static step"),
    ("no displacements", sub(r"^ -4  DISP ", " -4  STRESS ", 99), "no displacements"),
    ("truncated", lambda t: t[: len(t) // 2], "the file ends before its last line"),
    ("truncated with an end", lambda t: t[: len(t) // 2] + "\n 9999\n", "is truncated"),
    ("no nodes", sub(r"^    2C", "    XX"), "no block of nodes"),
    ("binary", sub(r"^(    2C.*) 1\s*$", r"\1 2\n"), "a binary .frd"),
    ("bytes", sub(r"^(    2C.*)$", "\\1\n\u00ff\u00fe"), "a binary .frd"),
    ("a node less", dropped("node"), "1236 lines of the 1237"),
    ("a node less in a mode", dropped("mode"), "1236 lines of the 1237"),
    ("a node twice", sub(r"^ -1         2 ", " -1         1 "), "two nodes have the same number"),
    ("an unknown node", sub(r"^ -2        75", " -2      9999"), "names node 9999"),
    ("an element short of nodes", sub(r"^ -2 .*\n", ""), "nodes, expected 20"),
    ("nan", sub(VALUE, r"\1         NaN"), "not numbers"),
    ("letters", sub(VALUE, r"\1************"), "not a number"),
    ("nan in nodes", sub(r"(2C.*\n -1.{10}).{12}", r"\1         NaN"), "coordinates of nodes are not numbers"),
    ("a line too short", sub(VALUE, r"\1"), "not of 49 characters"),
    ("a negative frequency", sub(r"(CL  10\d) 198.6395470", r"\1 -98.6395470"), "mode 1 has -98.6"),
    ("frequency nought", sub(r"(CL  10\d) 198.6395470", r"\1 000.0000000"), "mode 1 has 0 Hz"),
    ("no frequency", sub(r"(CL  10\d) 198.6395470", r"\1 abc.abcdefg"), "hold no frequency"),
    ("another frequency", sub(r"(CL  10\d) 198.6395470", r"\1 298.6395470"), "is not the square"),
    ("a mode less", sub(r"(1PMODE +2 *\n.*\n) -4  DISP ", r"\1 -4  DISQ "), "mode 2 is missing"),
    ("no number", sub(r"1PGM +1.0", "1PGM                x.0", 9), "cannot be read"),
    ("no modal mass", sub(r"^    1PGM.*\n", "", 9), "no modal mass"),
    ("no modal mass to speak of", sub(r"1PGM +1.0", "1PGM                0.0", 9), "modal mass of 0"),
    ("shapes of displacement 1", lambda t: unit_shapes(t), "not normalised to mass"),
    ("shapes 1000 times too large", lambda t: times(t, 1000.0), "describes a structure 0.216 m large of 0.00785 kg"),
    ("two steps", sub(r"(1PSTEP +\d+ +1 +)\d+(\s+1PGM.*\n.*\n.*\n.*\n +1PMODE +2)", r"\g<1>7\2"), "modes of 2 steps"),
    ("complex", sub(r"^ -4  DISP ( +4 +1(?:.*\n){5} -1)", r" -4  DISPI\1", 9), "complex modes"),
    ("exponents of Fortran", sub(r"(?<=\d)E(?=[+-])", "D", 10**6), "not a number, ' 0.00000D+00': expected such as"),
    ("no first mode", sub(r"^ -4  DISP ", " -4  DISQ "), "mode 1 is missing"),
    ("a rigid body", lambda t: rigid(t), "it is a rigid-body mode"),
    ("nothing moves", lambda t: times(t, 0.0), "nothing moves in mode 1"),
    ("far away", sub(VALUE, r"\g<1>1.00000E+300"), "shapes hold values of up to 1e+300"),
]

STATIC = "    1PSTEP                         1           1           1\n"


def shapes_of(text, change):
    """The text with the values of each mode changed."""
    blocks = re.split(r"(?m)^(?=    1PSTEP)", text)
    for k, block in enumerate(blocks):
        lines = block.split("\n")
        rows = [i for i, line in enumerate(lines) if line.startswith(" -1") and "1PMODE" in block]
        if rows and "-4  DISP" in block:
            values = change(np.array([[float(lines[i][13 + 12 * c : 25 + 12 * c]) for c in range(3)] for i in rows]))
            for i, row in zip(rows, values, strict=True):
                lines[i] = lines[i][:13] + "".join(f"{value:12.5E}" for value in row)
        blocks[k] = "\n".join(lines)
    return "".join(blocks)


def rigid(text):
    """The first mode at next to nothing, with the stiffness of that."""
    text = sub(r"(CL  101) 198.6395470", r"\1 0.001591549")(text)
    return sub(r"1PGK +\S+", "1PGK                1.0000000E-04")(text)


def unit_shapes(text):
    return shapes_of(text, lambda values: values / np.abs(values).max() * (1 + 2 * (np.abs(values).max() > 2)))


def times(text, factor):
    return shapes_of(text, lambda values: values * factor)


@pytest.mark.parametrize(("change", "message"), [pytest.param(*rest, id=name) for name, *rest in SPOILT_FRD])
def test_a_spoilt_frd(spindamp, files, change, message):
    text = (files / "rest.frd").read_text()
    global STATIC
    STATIC = text[text.index("    1PSTEP") : text.index(" -3", text.index("    1PSTEP")) + 4]
    STATIC = re.sub(r"(100CL.{50})2", r"\g<1>0", STATIC)
    (files / "rest.frd").write_text(change(text), encoding="latin-1")
    refused(spindamp("check", SCENE), "scene.toml: [structure]", message)


def small():
    """The neutral file of a bar that bends: 9 nodes, 2 modes."""
    x = np.linspace(0.0, 200.0, 9)
    shapes = np.zeros((1, 2, 9, 3))
    shapes[0, 0, :, 2], shapes[0, 1, :, 1] = 6e-5 * x**2, 4.5e-3 * x
    head = {"format": "spindamp modes 1", "unit": "mm", "mass_unit": "kg", "axis": [0, 0, 2], "origin": [0, 0, 0]}
    modes = {"speeds_rpm": [3000.0], "frequencies_hz": [[200.0, 300.0]], "modal_masses": [[1.0, 1.0]]}
    nodes = {"nodes": np.stack([x, 0 * x, 0 * x], axis=1).tolist(), "shapes": shapes.tolist(), "set_TIP": [8]}
    return head | modes | nodes


OF_THE_BAR = changed(SCENE, structure__modes="bar.json", damper__at="TIP")
OF_THE_BAR["rotor"] = {"speeds": ["3000 rpm"], "gravity": "10 m/s^2"}

WRONG = table_of("wrong_modes")


def bent(case):
    """Keys that a case changes, None where it leaves them out."""
    return case.get("change", {}) | dict.fromkeys(case.get("without", ()))


@pytest.mark.parametrize("case", WRONG["files"].values(), ids=WRONG["files"])
def test_a_spoilt_neutral_file(spindamp, tmp_path, case):
    data = {name: value for name, value in (small() | bent(case)).items() if value is not None}
    (tmp_path / "bar.json").write_text(json.dumps(data))
    refused(spindamp("check", OF_THE_BAR), "scene.toml: ", case["says"])


@pytest.mark.parametrize("case", WRONG["scenes"].values(), ids=WRONG["scenes"])
def test_a_wrong_scene_of_known_modes(spindamp, tmp_path, case):
    (tmp_path / "bar.json").write_text(json.dumps(small()))
    changes = {key.replace(".", "__"): value for key, value in bent(case).items()}
    refused(spindamp("check", changed(OF_THE_BAR, **changes)), "scene.toml: ", case["says"])


def test_a_mode_that_is_there_twice(spindamp, tmp_path):
    """It counted twice, and the ball damped twice as much."""
    ((first, second),) = np.array(small()["shapes"])
    copied = small() | {"modal_masses": [[1.0] * 3], "shapes": np.array([[first, -first, second]]).tolist()}
    for hertz in (200.0, 200.2, 300.0):
        (tmp_path / "bar.json").write_text(json.dumps(copied | {"frequencies_hz": [[200.0, hertz, 400.0]]}))
        found = spindamp("check", OF_THE_BAR)
        assert ("modes 1 and 2 are the same: leave one out" in found.err) == (found.status == 2) == (hertz == 200.0)
        assert ("modes 1 and 2 (200 and 200.2 Hz) move all its nodes alike" in found.out) == (hertz == 200.2)


def test_what_lies_between_speeds_and_follows_from_none(spindamp, tmp_path):
    """A frequency that falls to next to nothing and rises again: what passes through it is below 0 beside it."""
    several = {"speeds_rpm": [0.0, 1000.0, 2000.0, 9000.0], "shapes": small()["shapes"] * 4}
    several |= {"frequencies_hz": [[first, 300.0] for first in (200.0, 1.0, 200.0, 200.0)]}
    (tmp_path / "bar.json").write_text(json.dumps(small() | several | {"modal_masses": [[1.0, 1.0]] * 4}))
    outcome = spindamp("check", OF_THE_BAR | {"rotor": {"speeds": ["5000 rpm"]}})
    refused(outcome, "scene.toml: [structure] modes: bar.json: the squared frequencies between", "closer speeds")


def test_a_bar_of_nine_nodes(spindamp, tmp_path):
    """A set of nodes for the place, the file's own axis: M2 = 1/phi², tilt = 2/L of a parabola, and modes listed."""
    (tmp_path / "bar.json").write_text(json.dumps(small()))
    found = spindamp.json("check", OF_THE_BAR)["seat"]
    assert found["modes"][0]["mass"][0] == pytest.approx((6e-5 * 200**2) ** -2)
    assert found["modes"][0]["floor_tilt"][0] == pytest.approx(2 / 0.2)
    assert found["modes"][1]["floor_tilt"][1] == pytest.approx(1 / 0.2)
    assert [mode["family"] for mode in found["modes"]] == ["flap", "lag"]
    assert "9 nodes" in spindamp("modes", OF_THE_BAR).out
    outcome = spindamp("modes", OF_THE_BAR, "--out", "x.csv")
    refused(outcome, "--out = 'x.csv': expected a name that ends in .npz or .json")
    refused(spindamp("modes", "structure"), "structure.toml: [plate]", "modes requires [plate]")


def test_balls_heavier_than_what_moves_of_the_structure_are_remarked(spindamp, tmp_path):
    """Nodes without cells do not tell a density: 0.17 kg in g for kg are lighter than a ball of 0.89 g."""
    for unit, heavier in (("kg", False), ("g", True)):
        (tmp_path / "bar.json").write_text(json.dumps(small() | {"mass_unit": unit}))
        remark = "The balls weigh 0.000888 kg, more than the effective mass M2 of mode 1 at the damper, 0.000174 kg: is"
        assert (f"# {remark} [structure] mass_unit right?" in spindamp("check", OF_THE_BAR).out) == heavier


@pytest.mark.usefixtures("quickly")
def test_words_for_what_is_no_plate(tmp_path, monkeypatch):
    """One mode, along axis 1 alone: the file may have no other, and nothing is said of a plate or of both axes."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bar.json").write_text(json.dumps(small()))
    results = package.run(changed(OF_THE_BAR, rotor__modes=1))
    assert any("along its axis 2" in note and "beyond those requested" in note for note in results.notes)
    said = " ".join([*results.notes, *(effect.why for effect in results.effects.values())])
    assert "plate" not in said
    assert "both of its axes" not in said
    assert said.count("The strain of these modes is not known") == 1


def test_the_axis_of_a_file_and_a_point_of_the_scene(spindamp, tmp_path):
    """The file says about what direction it spins, the scene about which point: what moves along z lags about y."""
    (tmp_path / "bar.json").write_text(json.dumps(small() | {"axis": [0, 1, 0]}))
    found = spindamp.json("check", changed(OF_THE_BAR, rotor__origin=["-50 mm", "0 m", "0 m"]))
    assert found["seat"]["modes"][0]["family"] == "lag"
    assert found["radii"]["damper"] == pytest.approx(0.25)


def test_axis_1_is_the_motion_at_the_lowest_speed_of_the_scene(spindamp, tmp_path):
    """Not at that of the files: here the first mode turns by 45 degrees on the way."""
    data = small()
    bent = np.array(data["shapes"])[0, 0, :, 2]
    fast = np.stack([0 * bent, bent, bent], axis=1) / np.sqrt(2)
    second = np.stack([0 * bent, bent, -bent], axis=1) / np.sqrt(2)
    shapes = [[np.array(data["shapes"])[0, 0].tolist(), np.roll(np.array(data["shapes"])[0, 0], -1, axis=1).tolist()]]
    data |= {"speeds_rpm": [0.0, 3000.0], "frequencies_hz": [[200.0, 300.0]] * 2, "modal_masses": [[1.0, 1.0]] * 2}
    (tmp_path / "bar.json").write_text(json.dumps(data | {"shapes": [*shapes, [fast.tolist(), (2 * second).tolist()]]}))
    assert spindamp.json("check", OF_THE_BAR)["seat"]["axes"][0] == pytest.approx([0.0, 0.5**0.5, 0.5**0.5])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        pytest.param(lambda _: b"nodes 1 2 3", "not an .npz file", id="text"),
        pytest.param(lambda data: data[:-30], "not a complete .npz file", id="truncated"),
        pytest.param(lambda data: data.replace(data[200:230], bytes(30)), "not a complete .npz file", id="holes"),
        pytest.param(lambda _: b"\x1f\x8b" + bytes(50), "not a complete .gz file", id="gz"),
    ],
)
def test_a_spoilt_archive(spindamp, tmp_path, change, message):
    np.savez_compressed(tmp_path / "bar.npz", **small())
    name = "bar.npz.gz" if ".gz" in message else "bar.npz"
    (tmp_path / name).write_bytes(change((tmp_path / "bar.npz").read_bytes()))
    refused(spindamp("check", changed(OF_THE_BAR, structure__modes=name)), "scene.toml: ", message)


def test_nodes_out_of_order_and_pounds_for_slinches(spindamp, files):
    """Cells in CalculiX' own order of nodes, not meshio's; and a mass unit that makes steel as light as foam."""
    scene = changed(SCENE, structure__modes="plate.npz", rotor__axis=None, rotor__origin=None)
    assert spindamp("modes", SCENE, "--out", files / "plate.npz").status == 0
    with np.load(files / "plate.npz") as file:
        data = {name: file[name] for name in file.files}
    cells = data["cells_hexahedron20"]
    assert "of 7850 kg/m³ by the scale of their modes" in spindamp("check", scene).out
    order = [*range(12), *range(16, 20), *range(12, 16)]
    for wrong, says in (
        ({"cells_hexahedron20": cells[:, order]}, "is partly inverted, with the nodes 1, 75, 83"),
        ({"cells_hexahedron20": np.concatenate([cells, cells[:3]])}, "3 cells hexahedron20 are listed twice"),
        ({"shapes": data["shapes"] * 386.09**0.5}, "of 20.3 kg/m^3, by the scale of its shapes"),
    ):
        np.savez(files / "plate.npz", **(data | wrong))
        refused(spindamp("check", scene), "scene.toml: ", says)
