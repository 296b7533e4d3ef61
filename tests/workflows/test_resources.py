"""The sizes of a run, and the memory that it takes at least, are known before any of it is done."""

import json
import re
import sys
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
import skfem

import fem
import workflows
from fem.theory.registry import THEORIES
from tests.workflows.conftest import QUIET, changed, on_mesh, python, raising, refused, write
from workflows.errors import BadInput
from workflows.scene.load import as_scene_file, load, shipped
from workflows.solve import resources
from workflows.solve.model_choice import choose_model
from workflows.solve.structure import discretise

GB = 1e9
PLAIN = {"coriolis": False, "large_deflection": False, "structural_modes": False, "floor_tilt": False}
UNBENT = PLAIN | {"stress_stiffening": False}
"""The same, and nothing is solved to say what large deflection would change."""
ASKED = UNBENT | {"coriolis": True}
"""At a speed at which Coriolis forces are called for in any case, nothing is solved to say what they would change."""
BARE = {"plate__theory": "mindlin", "effects": PLAIN}


@pytest.fixture
def work(monkeypatch):
    """Any work fails the test."""

    for place in ("workflows.pipeline.structure", "fem.read_mesh"):
        monkeypatch.setattr(place, raising(AssertionError("work has begun")))
    monkeypatch.setattr(resources, "available", lambda: 16 * GB)


@pytest.mark.parametrize("name", shipped())
def test_shipped_scenes_need_little(name):
    assert resources.memory(load(name)) < GB


MANY = {"start": "0 rpm", "stop": "9000 rpm", "count": 100_000}
BRICKS = {"rotor__modes": 200, "plate__theory": "solid"}
TOO_MUCH = [
    ({"release__cycles": 1_000_000_000}, "[release] cycles = 1000000000.0: ", "request fewer cycles"),
    ({"rotor__speeds": MANY, "release__cycles": 1000}, "[rotor] speeds", "fewer speeds"),
    ({"rotor__speeds": MANY, "rotor__modes": 200}, "[rotor] speeds", "fewer speeds"),
    (BRICKS | {"rotor__speeds": MANY | {"count": 60_000}}, "", ""),
]


@pytest.mark.usefixtures("work")
@pytest.mark.parametrize("command", ["check", "run", "campbell"])
@pytest.mark.parametrize(("changes", "key", "advice"), TOO_MUCH)
def test_too_much(changes, key, advice, command, paper, spindamp, tmp_path):
    if command == "campbell" and "release__cycles" in changes:
        pytest.skip("the plate alone has no cycles")
    _too_much(spindamp(command, changed(paper, **changes)), f"scene.toml: {key}", advice)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


@pytest.mark.usefixtures("work")
@pytest.mark.parametrize("size", [700_000_000, 10**13])
def test_a_mesh_of_ten_million_cells(size, paper, spindamp, tmp_path):
    with (tmp_path / "fine.msh").open("wb") as file:
        file.write(b"$MeshFormat\n")
        file.truncate(size)  # takes no room on the disk
    for command in ("check", "run"):
        _too_much(
            spindamp(command, on_mesh(paper, "fine.msh")), "scene.toml: [plate] mesh = 'fine.msh': ", "coarsen the mesh"
        )


def _too_much(outcome, start, advice):
    said = refused(outcome, start, advice)
    assert re.search(r"this needs about [0-9.]+ [GT]B of memory, but only 16 GB are available: ", said)


def test_the_limit_is_that_of_the_machine(monkeypatch):
    import resource

    before = resources.available()
    assert 1e7 < before < 1e15
    monkeypatch.setattr(resource, "getrlimit", lambda _: (1 << 20, -1))
    assert resources.available() == 0, "less than this very process has taken"


LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, (int(float(sys.argv.pop())),) * 2)
from workflows import cli
sys.exit(cli.main())
"""


@pytest.mark.parametrize(("modes", "limit", "status"), [(6, 1e9, 0), (100, 1.5e9, 2)])
def test_a_limit_of_address_space(modes, limit, status, paper, tmp_path):
    """Six modes take 0.63 GB of addresses, a hundred 2.8 GB: refused at once, not after half a minute of work."""
    few = changed(paper, rotor__speeds=["10000 rpm"], rotor__modes=modes, effects=UNBENT if modes == 6 else ASKED)
    write(few, tmp_path / "scene.toml")
    done = python("-c", LIMITED, "campbell", "scene.toml", limit, cwd=tmp_path)
    assert done.returncode == status, done.stderr
    assert ("[rotor] modes = 100: this needs about" in done.stderr) == (status == 2)


def test_first_meshes_too_large_are_refused_before_any_is_solved(monkeypatch, paper):
    many = changed(paper, rotor__speeds=["10000 rpm"], rotor__modes=100, effects=ASKED, plate__theory="mindlin")
    source = as_scene_file(many)
    decided = choose_model(source, QUIET)
    monkeypatch.setattr("fem.assemble", raising(AssertionError("work has begun")))
    monkeypatch.setattr(resources, "available", lambda: 3.5e8)
    with pytest.raises(BadInput, match=r"\[rotor\] modes = 100: this needs about .* request fewer modes"):
        discretise(source, decided, QUIET)


def test_the_same_scene_passes_where_there_is_room(monkeypatch, paper, spindamp):
    scene = changed(paper, rotor__speeds=["5000 rpm"], **BARE)
    source = as_scene_file(scene)
    decided = choose_model(source, QUIET)
    needed = resources.sizes(source, decided.form, decided.effects, decided.model).memory
    monkeypatch.setattr(resources, "available", lambda: needed)
    assert spindamp("check", scene).status == 0
    monkeypatch.setattr(resources, "available", lambda: 0.99 * needed - resources.BASE)
    assert spindamp("check", scene).status == 2


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin"])
def test_a_plate_grows_no_further_than_the_memory(theory, monkeypatch, paper):
    fine = changed(paper, plate__theory=theory, accuracy={"frequency": 1e-6}, damper=None, release=None)
    source, most = as_scene_file(fine), 3000
    decided = choose_model(source, QUIET)
    others = sum(part.memory for part in resources.parts(source) if part.key == "[rotor] speeds")
    room = resources.BASE + others + resources.of_a_plate(decided.model, most, 6) + 1
    monkeypatch.setattr(resources, "available", lambda: room)
    choice = discretise(source, decided, QUIET).choice
    assert 1000 < choice.operators.mass.shape[0] <= most
    assert not choice.met


@pytest.mark.parametrize("model", ["kirchhoff", "mindlin", "solid/2", "solid/4"])
@pytest.mark.parametrize("kind", ["rectangles", "skew", "triangles"])
def test_unknowns_are_counted_before_there_are_any(model, kind):
    mesh = fem.rectangle(0.2, 0.08, 6, 2 if model == "solid/4" else 5)
    if kind == "skew":
        mesh = skfem.MeshQuad(mesh.p + np.array([[0.0], [0.3]]) * mesh.p[0], mesh.t)
    if kind == "triangles":
        mesh = mesh.to_meshtri()
    body = fem.Plate(mesh, 0.003, fem.Material(1e11, 0.3, 7e3))
    found = fem.assemble(body, fem.Rotor(0.0, 0.0), fem.Effects(), model).mass.shape[0]
    assert found < resources.unknowns(model, mesh) < 1.15 * found, "the clamped ones are counted"


def test_a_large_mesh_of_bricks_is_not_split_to_tell_its_error(monkeypatch):
    """A split mesh would have had more unknowns than any that the search may try, and gigabytes."""
    for name, theory in THEORIES.items():
        monkeypatch.setitem(THEORIES, name, replace(theory, most_unknowns=theory.most_unknowns // 10))
    form = fem.Given(fem.rectangle(0.2, 0.08, 40, 16))
    tried = []

    def build(size):
        tried.append(size)
        body = fem.Plate(form.mesh(size), 0.003, fem.Material(1e11, 0.3, 7e3))
        return fem.assemble(body, fem.Rotor(0.0, 0.0), fem.Effects())

    found = fem.choose_mesh(form, build, (10.0,), 2, 1e-3)
    assert tried == [1]
    assert not found.met
    assert np.isnan(found.errors).all()


BENT = {
    "rotor__speeds": ["5000 rpm"],
    "damper": None,
    "release": None,
    "plate__theory": "mindlin",
    "effects": PLAIN | {"large_deflection": True},
}
MEASURED = """
import pathlib, sys
from workflows import cli
from workflows.report import plots
if sys.argv.pop() == "undrawn":
    plots.svg = lambda *_, **__: ""
status = cli.main(sys.argv[1:])
print(1024 * int(pathlib.Path("/proc/self/status").read_text(encoding="ascii").split("VmHWM:")[1].split()[0]))
sys.exit(status)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the peak of a process is read from /proc")
def test_the_memory_promised_is_what_a_large_deflection_takes(paper, spindamp, tmp_path):
    """Without figures, which take 25 MB whatever the plate; a run with them is measured in `test_results`."""
    promised = spindamp.json("check", changed(paper, **BENT, excitation=None))["sizes"]["memory"]
    done = python("-c", MEASURED, "run", "scene.toml", "--out", "out", "undrawn", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert 0.5 < promised / float(done.stdout.split()[-1]) < 2.0


def test_the_estimate_of_a_cycle_is_of_the_right_size(structure):
    """The arrays and objects of a cycle alone, without the text made from them."""
    source = as_scene_file(changed(structure, release__cycles=3000))
    workflows.run(source)  # compiles and loads, which is not counted
    tracemalloc.start()
    try:
        results = workflows.run(source)
        assert json.dumps(workflows.document(results), indent=1)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    cycles = max(part.memory for part in resources.parts(source) if "cycles" in part.key)
    assert 0.3 < cycles / most < 3


@pytest.mark.parametrize("changes", [{"rotor__modes": 12}, {"plate__width": "20 mm"}, {"plate__theory": "mindlin"}])
def test_check_says_sizes(changes, paper, spindamp):
    """Speeds, modes, ring-downs, and the unknowns of a mesh that the search does try."""
    alone = changed(
        paper,
        effects=PLAIN,
        **{"rotor__speeds": ["3500 rpm", "7500 rpm"], "release__cycles": 20, "accuracy__frequency": 0.05} | changes,
    )
    found = spindamp.json("check", alone)["sizes"]
    assert (found["speeds"], found["ringdowns"], found["cycles"]) == (2, 2, 40.0)
    assert found["modes"] == alone["rotor"].get("modes", 6)
    source = as_scene_file(alone)
    decided = choose_model(source, QUIET)
    tried = discretise(source, decided, QUIET).choice.tried
    form = decided.plate[0]
    counted = [resources.unknowns(decided.model, form.mesh(size)) for size, _ in tried]
    assert found["unknowns"] in counted
    said = spindamp("check", "scene.toml").out.splitlines()[-1]
    assert said.startswith(f"# Sizes: 2 speeds, {found['modes']} modes, at least {found['unknowns']} unknowns, ")
    assert "2 ring-downs of 20 cycles; at least " in said


def test_sizes_without_a_plate(spindamp):
    said = spindamp("check", "structure").out.splitlines()[-1]
    assert re.fullmatch(r"# Sizes: \d+ speeds?, \d+ ring-downs?(?: of \d+ cycles)?; at least \d+ MB of memory", said)
