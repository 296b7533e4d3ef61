"""`spindamp view`: what it says of a mesh, what it shows of a run, and what it refuses."""

import base64
import json
import re
from dataclasses import replace
from pathlib import Path

import meshio
import meshlane
import numpy as np
import pytest

from fem import modal_model
from fem.meshes.cells import cell, edges_of
from tests.workflows.browser import VIEWER, driven, findings, needs_chromium
from tests.workflows.conftest import MESHES, changed, refused, shipped_scene, write
from workflows.cli.main import main
from workflows.report import figures, mode_viewer, viewer
from workflows.report.page import load_results
from workflows.solve.results import Surface

KNOWN = Path(__file__).parents[1] / "fem" / "data" / "plate_paper_0.frd.gz"
SIDE = 0.1


@pytest.fixture(autouse=True)
def _no_screen(monkeypatch):
    monkeypatch.setattr(mode_viewer, "screen_exists", lambda: False)


@pytest.fixture
def plain(paper):
    """A scene whose plate is soon solved."""
    return changed(paper, rotor__speeds=["3000 rpm", "9000 rpm"], rotor__modes=3, accuracy={"frequency": 0.05})


def mesh_file(path, points, cells):
    kind = "triangle" if len(cells[0]) == 3 else "quad"
    meshio.write(path, meshio.Mesh(np.array([[*p, 0.0] for p in points]), [(kind, np.array(cells))]))
    return path


def test_two_triangles_by_hand(spindamp, tmp_path):
    """An isosceles right triangle has angles of 45°, 45° and 90°, and a longest side √2 times its shortest."""
    square = mesh_file(tmp_path / "square.vtu", [[0, 0], [SIDE, 0], [SIDE, SIDE], [0, SIDE]], [[0, 1, 2], [0, 2, 3]])
    found = spindamp.json("view", square)
    assert (found["kind"], found["cells"], found["points"], found["holes"]) == ("triangle", 2, 4, 0)
    assert found["extent"] == {"x": [0.0, SIDE], "y": [0.0, SIDE]}
    assert found["root"] == {"x": 0.0, "edges": 1, "length": pytest.approx(SIDE)}
    assert found["edges"]["shortest"] == pytest.approx(SIDE)
    assert found["edges"]["longest"] == pytest.approx(SIDE * np.sqrt(2))
    assert found["angles"]["least"] == pytest.approx(45.0)
    assert found["angles"]["greatest"] == pytest.approx(90.0)
    assert found["angles"]["odd_cells"] == 0
    assert found["aspect"] == pytest.approx(np.sqrt(2))
    assert not list(tmp_path.glob("*.html")), "--json writes nothing that was not asked for"


def test_what_is_shown_is_said_to_programs(spindamp, plain):
    """The damper is at the middle of the tip of 20 cm."""
    found = spindamp.json("view", plain, "--rpm", 9000, "--mode", 2, "--out", "shown.html")
    assert (found["file"], found["rpm"], found["mode"]) == ("shown.html", pytest.approx(9000), 2)
    assert Path(found["file"]).is_file()
    assert found["damper"] == pytest.approx([0.2, 0.0])


def test_a_sharp_cell_is_counted(spindamp, tmp_path):
    """A triangle of base 1 and height 0.1 in its middle has two angles of atan 0.2 = 11.3° and one of 157.4°."""
    flat = mesh_file(
        tmp_path / "flat.vtu",
        [[0, 0], [0, 1], [0.1, 0.5], [1, 0], [1, 1]],
        [[0, 2, 1], [0, 3, 2], [3, 4, 2], [4, 1, 2]],
    )
    found = spindamp.json("view", flat)["angles"]
    assert found["least"] == pytest.approx(np.degrees(np.arctan(0.2)), rel=1e-9)
    assert found["greatest"] == pytest.approx(180 - 2 * np.degrees(np.arctan(0.2)), rel=1e-9)
    assert found["odd_cells"] == 1
    told = spindamp("view", flat, "--out", "page.html").out
    assert "; 1 cell has an angle below 20° or above 150°" in told
    assert ": 1 edge, " in told


def test_a_mesh_file_as_text_and_picture(spindamp, tmp_path):
    said, page = spindamp("view", MESHES / "plate_with_hole.msh").out, "spindamp-view-plate-with-hole-msh.html"
    described = ("560 triangles, 322 points", "x 0 to 200 mm, y −40 to 40 mm", "80 mm long", "m, an assumption")
    for words in (*described, f"open {page}"):
        assert words in said
    text = (tmp_path / page).read_text(encoding="utf-8")
    assert "560 triangles, 322 points" in text
    assert len(text) < 500_000


SOLIDS = {"tetra10": "C3D10", "hexahedron20": "C3D20", "wedge15": "C3D15"}


@pytest.mark.parametrize("kind", SOLIDS)
def test_a_mesh_of_a_volume_is_shown_or_named_as_one(kind, spindamp, tmp_path):
    """One cell of 100 mm, in mm; the same with its corners in each other's place is none of a blade."""

    def written(nodes):
        rows = "".join(f"{k}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(nodes.tolist(), 1))
        numbers = [*map(str, range(1, len(nodes) + 1))]
        cell_lines = f"1, {', '.join(numbers[:10])}{',' * (len(nodes) > 10)}\n{', '.join(numbers[10:])}\n"
        text = f"*NODE\n{rows}*ELEMENT, TYPE={SOLIDS[kind]}\n{cell_lines}*NSET, NSET=NROOT\n1, 2, 3\n"
        (tmp_path / "solid.inp").write_text(text, encoding="ascii")
        return tmp_path / "solid.inp"

    nodes = cell(kind).nodes
    nodes = 100.0 * (nodes - nodes.min(axis=0)) / np.ptp(nodes, axis=0)
    outcome = spindamp("view", written(nodes), "--out", "page.html")
    assert outcome.status == 0, outcome.err
    for words in (f"1 {kind}, {len(nodes)} points", "x 0 to 100 mm, y 0 to 100 mm, z 0 to 100 mm", "NROOT", "as mm"):
        assert words in outcome.out
    assert f"1 {kind}" in (tmp_path / "page.html").read_text(encoding="utf-8")
    data = viewer.of("solid.inp")
    ends = data.surface.points[data.surface.cells[1]]
    x, area = ends.mean(axis=1), np.cross(ends[:, 1] - ends[:, 0], ends[:, 2] - ends[:, 0]) / 2
    known = {"tetra10": 1 / 6, "hexahedron20": 1.0, "wedge15": 1 / 2}[kind]
    assert abs((x * area).sum() / 3) == pytest.approx(known * SIDE**3), "the volume within, by Gauss' theorem"
    drawn = json.loads(data.view.data)
    parts = {"tetra10": 2 * 6, "hexahedron20": 2 * 12, "wedge15": 2 * 9}[kind]
    assert len(base64.b64decode(drawn["edges"])) == 4 * parts, "the edges of faces, each in two parts"
    assert drawn["axes"] == {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}
    nodes[[0, 1]] = nodes[[1, 0]]
    refused(spindamp("view", written(nodes)), "", f"solid.inp: 1 of 1 {kind} cells are inverted")
    nodes[0, 0] = np.nan
    refused(spindamp("view", written(nodes)), "", "solid.inp: line 2: node 1 has coordinates that are not finite")


def test_a_mesh_in_millimetres_is_asked_about(spindamp, tmp_path):
    large = mesh_file(tmp_path / "mm.vtu", [[0, 0], [200, 0], [200, 80], [0, 80]], [[0, 1, 2, 3]])
    assert "200 m is long: --unit mm?" in spindamp("view", large, "--out", "page.html").out
    said = spindamp("view", large, "--unit", "mm", "--out", "page.html").out
    assert "x 0 to 200 mm, y 0 to 80 mm" in said
    assert "mm, as --unit says" in said


def test_a_mesh_in_inches_is_taken_as_such(spindamp, tmp_path, monkeypatch):
    """A box of 8 x 1 x 1 inches, which could be one of 8 m, too; each file is read once."""
    nodes = cell("hexahedron20").nodes
    nodes = (nodes - nodes.min(axis=0)) / np.ptp(nodes, axis=0) * [8.0, 1.0, 1.0]
    meshio.write(tmp_path / "box.vtu", meshio.Mesh(nodes, [("hexahedron20", np.arange(20)[None])]))
    reads, read = [], meshlane.read
    monkeypatch.setattr(meshlane, "read", lambda path: reads.append(path) or read(path))
    assert "taken as m, an assumption: --unit sets" in spindamp("view", "box.vtu", "--out", "page.html").out
    assert len(reads) == 1
    found = spindamp.json("view", "box.vtu", "--unit", "in")
    assert found["unit"] == "in"
    assert found["extent"]["x"] == pytest.approx([0.0, 8 * 0.0254])
    wrong = "box.vtu: --unit = 'um': the mesh measures 8e-06 m in the unit given: are its coordinates in m or mm?"
    refused(spindamp("view", "box.vtu", "--unit", "um"), wrong)
    meshio.write(tmp_path / "box.vtu", meshio.Mesh(1e4 * nodes, [("hexahedron20", np.arange(20)[None])]))
    refused(spindamp("view", "box.vtu"), "box.vtu: --unit: the mesh measures 8e+04 m: expected 2 mm to 20 m")


def test_a_folder_shows_what_its_run_kept(finished, document, spindamp):
    speed = document["speeds"][2]
    outcome = spindamp("view", finished, "--rpm", speed["rpm"], "--mode", 3, "--out", "page.html")
    assert outcome.status == 0, outcome.err
    found = viewer.of(str(finished))
    data = json.loads(replace(found, first=(2, 2)).view.data)
    assert data["first"] == [2, 2]
    assert [each["rpm"] for each in data["speeds"]] == [each["rpm"] for each in document["speeds"]]
    shown = [[(mode["hz"], mode["family"]) for mode in each["modes"]] for each in data["speeds"]]
    kept = [[(mode["frequency_hz"], mode["family"]) for mode in each["modes"]] for each in document["speeds"]]
    assert shown == kept
    stagger = document["scene"]["rotor"]["stagger"]
    assert data["axes"]["spin axis"] == pytest.approx([0.0, np.sin(stagger), np.cos(stagger)], abs=1e-4)
    assert data["damper"] == document["scene"]["damper"]["at"]
    assert data["thickness"]["largest"] == document["scene"]["plate"]["thickness"]


def test_a_scene_is_solved_at_the_speed_asked_for(plain, spindamp, tmp_path):
    outcome = spindamp("view", plain, "--rpm", 6000, "--out", "page.html")
    assert outcome.status == 0, outcome.err
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert '"rpm":6000.0' in text.replace("5999.999999999999", "6000.0").replace("6000.000000000001", "6000.0")
    assert '"rpm":3000' not in text


def test_speeds_without_a_unit_are_remarked(plain, spindamp):
    bare = changed(plain, rotor__speeds=[200, 3000])
    said = spindamp("view", bare, "--rpm", 3000, "--out", "page.html").out
    assert re.search(r"^remark +Speeds without a unit are in rad/s: 3000 is 28647\.9 rpm\.", said, re.MULTILINE)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("nothere.msh",), "nothere.msh: no such folder of results, scene or mesh file"),
        (("nothere",), "nothere: no such scene"),
        (("structure",), "view needs a plate"),
        ((".",), "holds no run: expected a folder with results.json and results.nc"),
        ((MESHES / "plate_coarse.msh", "--rpm", "100"), "--rpm = 100: a mesh alone has no speeds"),
        ((MESHES / "make.py",), "not a readable mesh file"),
        ((KNOWN,), "a file of modes or results, not a mesh"),
        ((MESHES / "plate_coarse.msh", "--out", "."), "--out = '.': is a folder"),
        ((MESHES / "plate_coarse.msh", "--out", "v.png"), "--out = 'v.png': a page is written: expected a name that"),
        ((MESHES / "plate_coarse.msh", "--out", "nosuch/v.html"), "--out = 'nosuch/v.html': no such folder"),
        ((MESHES / "plate_coarse.msh", "--unit", "kg"), "--unit = 'kg': expected a unit of length such as 'mm'"),
        (("paper", "--unit", "mm"), "--unit = 'mm': belongs to a mesh file: results and scenes have their unit"),
        (("paper", "--rpm", "-1"), "--rpm = -1: expected a rotation speed between 0"),
    ],
)
def test_what_cannot_be_looked_at(arguments, said, spindamp):
    refused(spindamp("view", *arguments), "", said)
    assert not Path("nosuch").exists()


@pytest.mark.parametrize(("option", "value"), [("--rpm", 9000), ("--mode", 7), ("--mode", 0)])
def test_speeds_and_modes_that_a_folder_has_not(finished, spindamp, option, value):
    refused(spindamp("view", finished, option, value), "", f"{option} = {value}")


@pytest.mark.usefixtures("undrawn")
def test_results_without_a_plate(spindamp):
    assert spindamp("run", "structure", "--out", "out").status == 0
    assert "without a plate" in spindamp("view", "out").err


@pytest.fixture(scope="module")
def turning(tmp_path_factory):
    """The folder of a run whose modes are complex: a plate whose bending is in the plane of rotation."""
    paper = shipped_scene("paper")
    rotor = {"speeds": ["9000 rpm"], "modes": 3, "stagger": "45 deg"}
    few = {"rotor": rotor, "effects": {"coriolis": True}, "accuracy": {"frequency": 0.05}}
    scene = changed(paper, **few, damper=None, release=None)
    folder = tmp_path_factory.mktemp("turning")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(figures, "report", lambda _: dict.fromkeys(figures.SHOWN, ""))
        assert main(["run", str(write(scene, folder / "scene.toml")), "--out", str(folder / "out")]) == 0
    return folder / "out"


def test_complex_modes_of_a_folder_keep_their_phase(turning):
    """In an undamped gyroscopic mode points lag behind others; a mode without that would move along a fixed shape."""
    view_data = viewer.of(str(turning))
    kept = load_results(turning).surface
    assert np.abs(kept.behind).max() > 1e-3 * np.abs(kept.shapes).max()
    data = json.loads(view_data.view.data)
    assert data["behind"]


def test_a_browser_opens_the_page_where_there_is_a_screen(monkeypatch, spindamp, tmp_path):
    opened = []
    monkeypatch.setattr(mode_viewer, "screen_exists", lambda: True)
    monkeypatch.setattr("webbrowser.open", opened.append)
    outcome = spindamp("view", MESHES / "plate_coarse.msh")
    assert (outcome.status, "open spindamp-view-plate-coarse-msh.html" in outcome.out) == (0, True)
    (page,) = tmp_path.glob("*.html")
    assert opened == [page.as_uri()]
    assert spindamp("view", MESHES / "plate_coarse.msh", "--out", "page.html").status == 0
    assert len(opened) == 1


@needs_chromium
def test_a_browser_shows_the_mesh_with_its_hole(tmp_path):
    path = tmp_path / "page.html"
    viewer.write(viewer.of(str(MESHES / "plate_with_hole.msh")), path)
    script = """
    Object.assign(figure.viewer.view, { yaw: 0, rise: Math.PI / 2, near: 1 });
    form.cells.checked = false;
    const seen = pixels();
    let left = canvas.width, right = 0, drawn = 0;
    for (let y = 0; y < canvas.height; y++) for (let x = 0; x < canvas.width; x++)
      if (seen[4 * (y * canvas.width + x) + 3] > 127) { drawn++; left = Math.min(left, x); right = Math.max(right, x); }
    return { drawn, length: right - left + 1 };
    """
    found = driven(path, VIEWER + script)
    mesh = meshio.read(MESHES / "plate_with_hole.msh")
    triangles = mesh.points[mesh.cells_dict["triangle"]][..., :2]
    (ax, ay), (bx, by) = (triangles[:, 1] - triangles[:, 0]).T, (triangles[:, 2] - triangles[:, 0]).T
    area = 0.5 * np.abs(ax * by - ay * bx).sum()
    scale = (found["length"] / np.ptp(mesh.points[:, 0])) ** 2
    assert found["drawn"] / scale == pytest.approx(area, rel=0.02), "seen from above, the hole is left out"


@needs_chromium
def test_lines_at_the_back_of_a_thin_body_are_hidden(tmp_path):
    """A flat tetrahedron, whose three edges to its apex meet in the middle: seen from above, not from below."""
    corners = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.05, 0.087, 0.0], [0.05, 0.043, 0.001]])
    meshio.write(tmp_path / "flat.vtu", meshio.Mesh(corners, [("tetra", np.arange(4)[None])]))
    viewer.write(viewer.of(str(tmp_path / "flat.vtu")), tmp_path / "page.html")
    script = """
    const contrast = rise => {
      Object.assign(figure.viewer.view, { yaw: 0, rise, near: 1 });
      pixels();
      const place = [canvas.width / 2 - 30, canvas.height / 2 - 30, 60, 60];
      const reds = [...copy.getImageData(...place).data].filter((_, i) => i % 4 === 0);
      return Math.max(...reds) - Math.min(...reds);
    };
    const axes = figure.querySelector('.triad').textContent;
    return { above: contrast(Math.PI / 2), below: contrast(-Math.PI / 2), axes };
    """
    found = driven(tmp_path / "page.html", VIEWER + script)
    assert found["above"] > 50
    assert found["below"] < 20
    assert found["axes"] == "xyz"


def cube(**options):
    """The surface of one cell, of 2 m about the origin."""
    cells = (("hexahedron20", np.arange(20)[None]),)
    lines, triangles, none = edges_of(cells), modal_model.faces(cells), np.zeros((0, 0, 20, 3))
    return Surface(cell("hexahedron20").nodes, ("triangle", triangles), lines, lines[:0], none, (), **options)


def test_the_still_picture_of_a_solid_shows_its_upper_side():
    """Of the 12 edges of a cube, in two parts each, the four around its top."""
    surface = cube(frame=np.eye(3))
    seen = figures.seen_from_above(surface)
    np.testing.assert_array_equal(seen, surface.points[:, 2] > 0.5)
    assert seen[surface.outline].all(axis=1).sum() == 8


@pytest.mark.parametrize(("origin", "least"), [(None, -1.0), ([7.0, 0.0, -2.0], 1.0)])
def test_the_still_picture_measures_outwards_from_the_spin_axis(origin, least):
    """Not from the origin of the file: a cube of 2 m about it with its damper, and an axis 2 m away."""
    frame, turns = np.array([[0.0, 0, 1], [0, -1, 0], [1, 0, 0]]), None if origin is None else np.array(origin)
    surface = cube(frame=frame, origin=turns)
    (axes,) = figures.mesh_of(surface, (0.5, -0.5), "clamped root").axes
    assert axes.get_xlabel().startswith("outwards, ")
    scale = 1e3 if axes.get_xlabel().endswith("mm") else 1.0
    drawn = np.concatenate([np.asarray(patch.get_path().vertices)[:, 0] for patch in axes.patches])
    assert (drawn.min() / scale, drawn.max() / scale) == pytest.approx((least, least + 2.0))
    (mark,) = [line for line in axes.lines if line.get_marker() == "o"]
    assert np.asarray(mark.get_xdata())[0] / scale == pytest.approx(least + 1.5)


@needs_chromium
def test_nothing_hinders_a_reader(turning, tmp_path):
    for number, view_data in enumerate((viewer.of(str(turning)), viewer.of(str(MESHES / "plate_with_hole.msh")))):
        path = tmp_path / f"{number}.html"
        viewer.write(view_data, path)
        assert findings(path) == []


@pytest.mark.parametrize("study", ["sweep", "response", "design", "accuracy", "effects", "reproduce"])
def test_the_folder_of_a_study_leads_to_its_page(study, tmp_path, spindamp):
    (tmp_path / "out").mkdir()
    for name in (f"{study}.json", "report.html"):
        (tmp_path / "out" / name).write_text("{}", encoding="utf-8")
    shown = spindamp("view", "out")
    assert (shown.status, shown.out) == (0, f"open {Path('out') / 'report.html'}\n"), shown
