"""What a run would need is said before any of it is done."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import meshio
import numpy as np
import pytest

import damper
import fem
from tests.limits import HANG
from tests.workflows.conftest import READY, Outcome, Scene, changed, write
from workflows.errors import BadInput
from workflows.scene import plate_mesh
from workflows.scene.file import load, shipped
from workflows.scene.source import SceneFile
from workflows.solve import foretold, likeness, needs, pilot, reckoned, trials
from workflows.solve import plate_stage as plate
from workflows.solve.decided import Decided, decide
from workflows.solve.fill import NOTHING, Fill, fill
from workflows.solve.price import Part, grown
from workflows.stages import Stages

GB = 1e9
PLAIN = {"coriolis": False, "large_deflection": False, "structural_modes": False, "floor_tilt": False}
UNBENT = PLAIN | {"stress_stiffening": False}
"""The same, and nothing is solved to say what large deflection would change."""
BARE: dict[str, Any] = {"plate__theory": "mindlin", "effects": PLAIN}


@pytest.fixture
def work(monkeypatch: pytest.MonkeyPatch) -> None:
    """Any work fails the test."""

    def begun(*_: object, **__: object) -> None:
        raise AssertionError("work has begun")

    monkeypatch.setattr("workflows.pipeline.structure", begun)
    monkeypatch.setattr("fem.read_mesh", begun)
    monkeypatch.setattr(needs, "available", lambda: 16 * GB)


@pytest.mark.parametrize("name", shipped())
def test_shipped_scenes_need_little(name: str) -> None:
    assert needs.memory(load(name)) < GB


MANY = {"start": "0 rpm", "stop": "9000 rpm", "count": 100_000}
TOO_MUCH: list[tuple[dict[str, Any], str, str]] = [
    ({"release__cycles": 1_000_000_000}, "[release] cycles = 1000000000.0: ", "ask for fewer cycles"),
    ({"rotor__speeds": MANY, "release__cycles": 1000}, "[rotor] speeds", "fewer speeds"),
    ({"rotor__speeds": MANY, "rotor__modes": 200}, "[rotor] speeds", "fewer speeds"),
    (
        {"rotor__modes": 200, "plate__theory": "solid", "rotor__speeds": {"start": 0, "stop": 1, "count": 60_000}},
        "",
        "",
    ),
]


@pytest.mark.usefixtures("work")
@pytest.mark.parametrize("command", ["check", "run", "campbell"])
@pytest.mark.parametrize(("changes", "key", "advice"), TOO_MUCH)
def test_too_much(
    changes: dict[str, Any],
    key: str,
    advice: str,
    command: str,
    paper: Scene,
    spindamp: Callable[..., Outcome],
    tmp_path: Path,
) -> None:
    if command == "campbell" and "release__cycles" in changes:
        pytest.skip("the plate alone has no cycles")
    write(changed(paper, **changes), tmp_path / "scene.toml")
    _refused(spindamp(command, "scene.toml"), f"scene.toml: {key}", advice)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


@pytest.mark.usefixtures("work")
@pytest.mark.parametrize("size", [700_000_000, 10**13])
def test_a_mesh_of_ten_million_cells(size: int, paper: Scene, spindamp: Callable[..., Outcome], tmp_path: Path) -> None:
    with (tmp_path / "fine.msh").open("wb") as file:
        file.write(b"$MeshFormat\n")
        file.truncate(size)  # takes no room on the disk
    scene = changed(paper, plate__length=None, plate__width=None, plate__mesh="fine.msh", damper__at=None)
    write(scene, tmp_path / "scene.toml")
    for command in ("check", "run"):
        outcome = spindamp(command, "scene.toml")
        _refused(outcome, "scene.toml: [plate] mesh = 'fine.msh': ", "coarsen the mesh")


def _refused(outcome: Outcome, start: str, advice: str) -> None:
    assert outcome.status == 2, outcome
    assert outcome.out == ""
    assert len(outcome.err.splitlines()) == 1
    assert outcome.err.startswith(f"spindamp: {start}")
    assert re.search(r"this needs about [0-9.]+ [GT]B of memory, and 16 GB are there: ", outcome.err)
    assert advice in outcome.err


def test_too_long(monkeypatch: pytest.MonkeyPatch, paper: Scene, spindamp: Callable[..., Outcome]) -> None:
    monkeypatch.setattr(needs, "available", lambda: float("inf"))
    write(changed(paper, release__cycles=1e9, rotor__speeds={"start": 1, "stop": 2, "count": 100}), Path("long.toml"))
    outcome = spindamp("run", "long.toml")
    assert outcome.status == 2
    assert re.search(r"long.toml: \[release\] cycles = 1000000000.0: this takes about \d+ days: ", outcome.err)


def test_the_limit_is_that_of_the_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    import resource

    before = needs.available()
    assert 1e7 < before < 1e15
    monkeypatch.setattr(resource, "getrlimit", lambda _: (1 << 20, -1))
    assert needs.available() == 0, "less than this very process has taken"


LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, (int(float(sys.argv.pop())),) * 2)
from workflows.cli import entry as cli
sys.exit(cli.main())
"""


@pytest.mark.parametrize(("modes", "limit", "status"), [(6, 1e9, 0), (100, 1.5e9, 2)])
def test_a_limit_of_address_space(modes: int, limit: float, status: int, paper: Scene, tmp_path: Path) -> None:
    """Six modes take 0.63 GB of addresses, a hundred 2.8 GB: refused at once, not after half a minute of work."""
    few = changed(paper, rotor__speeds=["5000 rpm"], rotor__modes=modes, effects=UNBENT)
    write(few, tmp_path / "scene.toml")
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, "campbell", "scene.toml", str(limit)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        timeout=HANG,
    )
    assert done.returncode == status, done.stderr
    assert ("[rotor] modes = 100: this needs about" in done.stderr) == (status == 2)


def test_first_meshes_too_large_are_refused_before_any_is_solved(
    monkeypatch: pytest.MonkeyPatch, paper: Scene, tmp_path: Path
) -> None:
    many = changed(paper, rotor__speeds=["5000 rpm"], rotor__modes=100, effects=UNBENT, plate__theory="mindlin")
    source = load(write(many, tmp_path / "scene.toml"))
    decided = decide(source, Stages(visible=False))

    def begun(*_: object, **__: object) -> None:
        raise AssertionError("work has begun")

    for work in ("likeness.like", "reckoned.pace", "plate_stage.discretise"):
        monkeypatch.setattr(f"workflows.solve.{work}", begun)
    monkeypatch.setattr(needs, "available", lambda: 3.5e8)
    with pytest.raises(BadInput, match=r"\[rotor\] modes = 100: this needs about .* ask for fewer modes"):
        pilot.need(source, decided)


def test_what_a_ball_takes_is_counted_where_small_plates_stand_for_a_large_one(
    monkeypatch: pytest.MonkeyPatch, paper: Scene, tmp_path: Path
) -> None:
    """A thousand cycles more at each speed are seen in the bytes."""
    monkeypatch.setattr(pilot, "PATIENCE", 0.0)
    monkeypatch.setattr(likeness, "UNKNOWNS", (500, 2000))
    needed = []
    for cycles in (20, 1020):
        scene = changed(paper, effects=PLAIN, plate__theory="mindlin", rotor__speeds=["3500 rpm", "7500 rpm"])
        scene = changed(scene, release__cycles=cycles, damper__damping_ratio=1e-3)
        needed.append(pilot.need(*_in_cells(scene, (60, 24), tmp_path)).memory)
    assert needed[1] - needed[0] == pytest.approx(2 * 1000 * needs.CYCLE, rel=0.05)


def _in_cells(flat: Scene, cells: tuple[int, int], folder: Path) -> tuple[SceneFile, Decided]:
    """A scene with its plate of 0.2 m by 0.08 m from a file, and what it calls for, as it is said of the rectangle.

    Of a rectangle without stagger that takes nothing; of a file a coarse mesh is solved.
    """
    decided = decide(load(write(flat, folder / "flat.toml")), Stages(visible=False))
    fine = fem.rectangle(0.2, 0.08, *cells)
    meshio.Mesh(np.column_stack([fine.p.T, 0 * fine.p[0]]), [("quad", fine.t.T)]).write(folder / "plate.vtu")
    named = changed(flat, plate__length=None, plate__width=None, plate__mesh="plate.vtu")
    if "damper" in named:
        named = changed(named, damper__at=None)
    source = load(write(named, folder / "scene.toml"))
    return source, replace(decided, form=plate_mesh.planform(source))


def test_the_same_scene_passes_where_there_is_room(
    monkeypatch: pytest.MonkeyPatch, paper: Scene, spindamp: Callable[..., Outcome], tmp_path: Path
) -> None:
    scene = write(changed(paper, rotor__speeds=["5000 rpm"], **BARE), tmp_path / "scene.toml")
    source = load(scene)
    decided = decide(source, Stages(visible=False))
    needed = pilot.need(source, decided).memory
    monkeypatch.setattr(needs, "available", lambda: 1.2 * needed)
    assert spindamp("check", scene).status == 0
    monkeypatch.setattr(needs, "available", lambda: 0.99 * needs.memory(source))
    assert spindamp("check", scene).status == 2


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin"])
def test_a_plate_grows_no_further_than_the_memory(
    theory: str, monkeypatch: pytest.MonkeyPatch, paper: Scene, tmp_path: Path
) -> None:
    fine = changed(paper, plate__theory=theory, accuracy={"frequency": 1e-6}, damper=None, release=None)
    source = load(write(fine, tmp_path / "scene.toml"))
    quiet = Stages(visible=False)
    decided = decide(source, quiet)
    model = plate.model(source, decided)
    others = sum(part.memory for part in needs.parts(source) if part.key == "[rotor] speeds")
    most = 6000
    monkeypatch.setattr(needs, "available", lambda: needs.BASE + others + needs.of_a_plate(model, most, 6) + 1)
    choice = plate.discretise(source, decided, quiet).choice
    assert 1000 < choice.operators.mass.shape[0] <= most
    assert not choice.met


@pytest.mark.parametrize("model", ["kirchhoff", "mindlin", "solid/2", "solid/4"])
@pytest.mark.parametrize("kind", ["rectangles", "skew", "triangles"])
def test_unknowns_are_counted_before_there_are_any(model: str, kind: str) -> None:
    import skfem

    mesh = fem.rectangle(0.2, 0.08, 6, 2 if model == "solid/4" else 5)
    if kind == "skew":
        mesh = skfem.MeshQuad(mesh.p + np.array([[0.0], [0.3]]) * mesh.p[0], mesh.t)
    if kind == "triangles":
        mesh = mesh.to_meshtri()
    body = fem.Plate(mesh, 0.003, fem.Material(1e11, 0.3, 7e3))
    found = fem.assemble(body, fem.Rotor(0.0, 0.0), fem.Effects(), model).mass.shape[0]
    assert found < needs.unknowns(model, mesh) < 1.15 * found, "the clamped ones are counted"


def test_a_large_mesh_of_bricks_is_not_split_to_tell_its_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """A split mesh would have had more unknowns than any that the search may try, and gigabytes."""
    import fem
    from fem.accuracy import choose_mesh as choice

    monkeypatch.setattr(choice, "MOST_UNKNOWNS", {name: most // 10 for name, most in choice.MOST_UNKNOWNS.items()})
    form = fem.Given(fem.rectangle(0.2, 0.08, 40, 16))
    tried = []

    def build(size: int) -> fem.Operators:
        tried.append(size)
        body = fem.Plate(form.mesh(size), 0.003, fem.Material(1e11, 0.3, 7e3))
        return fem.assemble(body, fem.Rotor(0.0, 0.0), fem.Effects())

    found = fem.choose_mesh(form, build, (10.0,), 2, 1e-3)
    assert tried == [1]
    assert not found.met
    assert np.isnan(found.errors).all()


MEASURED = f"""
import pathlib, sys
from workflows.cli import entry as cli
from workflows.report import figures, mode_viewer
mode_viewer.COMMAND = ["-I", "-S", "-c", {READY!r}]
if sys.argv.pop() == "undrawn":
    figures.report = lambda _: dict.fromkeys(figures.SHOWN, "")
status = cli.main(sys.argv[1:])
print(1024 * int(pathlib.Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0]))
sys.exit(status)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the peak of a process is read from /proc")
@pytest.mark.parametrize(
    ("changes", "figures"),
    [
        ({"rotor__speeds": ["3500 rpm", "17500 rpm"]}, "drawn"),
        ({"rotor__speeds": ["5000 rpm"]} | BARE | {"effects": PLAIN | {"large_deflection": True}}, "undrawn"),
        ({"damper__rolling_friction": 0, "release__cycles": 50_000, "rotor__speeds": ["5000 rpm"]} | BARE, "undrawn"),
    ],
    ids=["paper", "deflected", "cycles"],
)
def test_the_memory_promised_is_what_a_run_takes(
    changes: dict[str, Any], figures: str, paper: Scene, spindamp: Callable[..., Outcome], tmp_path: Path
) -> None:
    """The figures are drawn once: they take 25 MB, whatever the plate."""
    import json

    write(changed(paper, **changes), tmp_path / "scene.toml")
    promised = json.loads(spindamp("check", "scene.toml", "--json").out)["needs"]["memory"]
    done = subprocess.run(
        [sys.executable, "-c", MEASURED, "run", "scene.toml", "--out", "out", figures],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
        timeout=HANG,
    )
    taken = float(done.stdout.split()[-1])
    assert 0.5 < promised / taken < 2.0


def test_the_estimate_of_a_cycle_is_of_the_right_size(structure: Scene, tmp_path: Path) -> None:
    """The arrays and objects of a cycle alone, without the text made from them."""
    import json
    import tracemalloc

    import workflows

    source = load(write(changed(structure, release__cycles=3000), tmp_path / "scene.toml"))
    workflows.run(source)  # compiles and loads, which is not counted
    tracemalloc.start()
    try:
        results = workflows.run(source)
        text = json.dumps(workflows.document(results), indent=1)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert text
    cycles = max(part.memory for part in needs.parts(source) if "cycles" in part.key)
    assert 0.3 < cycles / most < 3


def test_each_kind_of_work_grows_by_its_own_measure() -> None:
    """Seconds that are made of factors, solutions, all else and what is always there are found again, far beyond."""

    def took(on: Fill) -> Part:
        factoring, solving = 2e-10 * on.work, 4e-8 * on.entries
        return Part(on, factoring + solving + 2.0 + 0.3 + 1e-5 * on.unknowns, factoring, solving, 2.0)

    small, middle, large = Fill(2e3, 1e5, 3e7), Fill(8e3, 6e5, 3e8), Fill(6e4, 9e6, 5e10)
    assert grown([took(small), took(middle)], large) == pytest.approx(took(large).seconds, rel=1e-9)
    assert grown([took(middle)], middle) == pytest.approx(took(middle).seconds)
    many = Part(small, 3.0, 0.0, 0.0, 2.9)
    assert grown([many], large) == pytest.approx(2.9 + 0.1 * 30), "of one alone, modes of a projection do not grow"
    falling = Part(small, 2.0, 0.0, 0.0), Part(middle, 1.0, 0.0, 0.0)
    assert grown(falling, large) == pytest.approx(1.0), "nothing is negative"


SOLVED = [((0.2, 0.01), 7, 2), ((0.2, 0.2), 7, 6), ((0.2, 0.05), 5, 40)]
"""Sides, size and modes of plates whose factors differ, of like unknowns."""

PEAKS = """
import os, pathlib, sys
import fem, fem.linalg.spent
def peak(): return 1024 * int(pathlib.Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0])
def solved(sides, size, modes):
    body = fem.Plate(fem.Rectangle(*sides).mesh(size), 0.003, fem.Material(1e11, 0.3, 7e3))
    fem.campbell(fem.assemble(body, fem.Rotor(0.1, 0.3), fem.Effects(large_deflection=True)), [100.0], modes)
solved((0.2, 0.05), 1, 2)
for plate in eval(sys.argv[1]):
    if os.fork() == 0:
        before = peak()
        solved(*plate)
        print(peak() - before, flush=True)
        os._exit(0)
    assert os.wait()[1] == 0
"""


@pytest.fixture(scope="module")
def peaks() -> dict[Any, float]:
    """What each plate of SOLVED takes, solved in a process that has all it loads."""
    command = [sys.executable, "-c", PEAKS, repr(SOLVED)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=HANG)
    return dict(zip(SOLVED, map(float, done.stdout.split()), strict=True))


@pytest.mark.skipif(sys.platform != "linux", reason="the peak of a process is read from /proc")
@pytest.mark.parametrize(("sides", "size", "modes"), SOLVED, ids=str)
def test_a_mesh_takes_what_its_factor_has(
    sides: tuple[float, float], size: int, modes: int, peaks: dict[Any, float]
) -> None:
    """Of like unknowns a slender plate's factor has fewer entries; the peak of a process that solves on it alone."""
    on = fill("mindlin/held", fem.Rectangle(*sides).mesh(size))
    promised = needs.of_a_mesh("mindlin/held", on, modes, large_deflection=True)
    assert 0.5 < promised / peaks[sides, size, modes] < 2.0


@pytest.mark.parametrize(
    ("model", "triangles", "cells", "numberings", "within"),
    [
        ("kirchhoff", False, (16, 36), 5, 0.3),
        ("kirchhoff", True, (12, 28), 5, 0.3),
        ("mindlin/held", False, (12, 28), 5, 0.3),
        ("mindlin/held", True, (12, 28), 5, 0.3),
        ("solid/2", False, (4, 8), 5, 0.3),
        ("solid/2", True, (3, 6), 5, 0.3),
        ("solid/6", False, (4, 8), 5, 0.6),  # few blocks of many unknowns
        ("solid/6", False, (8, 14), 1, 0.2),
    ],
)
def test_what_a_factor_will_have_is_known_from_the_mesh(
    model: str, triangles: bool, cells: tuple[int, int], numberings: int, within: float
) -> None:
    """Entries and work grow from a coarse mesh to a fine one as those of the true factors do.

    Minimum degree breaks ties by the order of the unknowns, and by entries that happen to cancel: the true growth is
    anything between those of several numberings, which for mindlin's rectangles are 11.4 and 17.0 times the work.
    """
    told, true = [], []
    for along in cells:
        mesh = fem.rectangle(0.2, 0.1, along, along // 2)
        if triangles:
            mesh = mesh.to_meshtri()
        body = fem.Plate(mesh, 0.004, fem.Material(2e11, 0.3, 7850.0))
        pulled = fem.Effects(stress_stiffening=not model.startswith("solid"))  # fills no brick that is not full
        matrix = fem.assemble(body, fem.Rotor(0.1, 0.3), pulled, model).at(100.0)
        found = fill(model, mesh)
        told.append((found.entries, found.work))
        true.append([_factored(matrix, seed) for seed in range(numberings)])
    growth, grown = np.divide(told[1], told[0]), np.divide(true[1], true[0])
    assert (growth > grown.min(axis=0) / (1 + within)).all(), (growth, grown)
    assert (growth < grown.max(axis=0) * (1 + within)).all(), (growth, grown)


def _factored(matrix: Any, seed: int) -> tuple[float, float]:
    """Entries of a factor and the work of making it; of unknowns in their own order, or in another one."""
    from fem.linalg.lanczos import factorise

    order = np.random.default_rng(seed).permutation(matrix.shape[0]) if seed else np.arange(matrix.shape[0])
    lower = factorise(matrix[order][:, order].tocsc()).lu.L
    columns = np.diff(lower.indptr).astype(float)
    return lower.nnz, (columns**2).sum() + 130.0 * lower.nnz


def test_factors_and_solutions_are_booked() -> None:
    """As many as were made, columns one by one, in all books that are open."""
    from fem.linalg.lanczos import factorise
    from fem.linalg.spent import spent

    body = fem.Plate(fem.rectangle(0.2, 0.08, 3, 2), 0.003, fem.Material(1e11, 0.3, 7e3))
    matrix = fem.assemble(body, fem.Rotor(0.0, 0.0), fem.Effects()).stiffness
    with spent() as outer:
        factor = factorise(matrix)
        with spent() as inner:
            factor.solve(np.ones((matrix.shape[0], 3)))
            factor.solve(np.ones(matrix.shape[0]))
        before = outer.solving
        assert factor.negative == 0
        assert outer.solving > before, "the pivots are read from a copy of all entries"
    factor.solve(np.ones(matrix.shape[0]))
    assert (outer.factors, outer.columns, inner.factors, inner.columns) == (1, 4, 0, 4)
    assert outer.factoring > 0.0
    assert outer.projecting == 0.0
    with spent() as many:
        fem.solve_modes(fem.assemble(body, fem.Rotor(0.0, 0.0), fem.Effects()), 0.0, 40)
    assert many.projecting > 0.2 * (many.factoring + many.solving), "of few unknowns it is most of the work"
    assert outer.solving >= inner.solving > 0.0


def test_the_search_says_which_mesh_it_would_try_next(paper: Scene, tmp_path: Path) -> None:
    """Ended before any mesh, it names that which it takes when it is not ended."""
    fine = changed(paper, plate__theory="mindlin", accuracy={"frequency": 3e-4}, rotor__speeds=["5000 rpm"])
    source = load(write(changed(fine, damper=None, release=None), tmp_path / "scene.toml"))
    quiet = Stages(visible=False)
    decided = decide(source, quiet)
    whole = plate.discretise(source, decided, quiet).choice
    sizes = [size for size, _ in whole.tried]
    assert len(sizes) > 2
    assert whole.following is None
    ended = plate.discretise(source, decided, quiet, until=0.0)
    assert [size for size, _ in ended.choice.tried] == sizes[:2]
    assert ended.choice.following == sizes[2]
    trial = trials.Trial(ended, NO_PART)
    for course in foretold.ahead(source, decided.plate[0], trial):
        assert course.sizes[:3] == tuple(sizes[:3])


NO_PART = Part(NOTHING, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin"])
@pytest.mark.parametrize("accuracy", [1e-2, 3e-3, 1e-3, 3e-4])
@pytest.mark.parametrize("sides", [("200 mm", "80 mm"), ("400 mm", "80 mm")])
def test_the_end_of_a_search_lies_between_those_foretold(
    sides: tuple[str, str], accuracy: float, theory: str, paper: Scene, tmp_path: Path
) -> None:
    """Ended after its first two meshes; it may choose the mesh before the last that it tries."""
    scene = changed(paper, plate__length=sides[0], plate__width=sides[1], plate__theory=theory, effects=PLAIN)
    scene = changed(scene, accuracy={"frequency": accuracy}, damper=None, release=None)
    source = load(write(scene, tmp_path / "scene.toml"))
    quiet = Stages(visible=False)
    decided = decide(source, quiet)
    whole = plate.discretise(source, decided, quiet).choice
    trial = trials.Trial(plate.discretise(source, decided, quiet, until=0.0), NO_PART)
    courses = foretold.ahead(source, decided.plate[0], trial)
    assert courses[0].chosen <= whole.size <= courses[-1].chosen
    if trial.discrete.choice.following is None:
        assert [course.chosen for course in courses] == [whole.size]


@pytest.mark.parametrize(
    ("error", "tried", "chosen"),
    [(1e-4, (1, 2), 1), (8e-4, (1, 2), 2), (1e-3, (1, 2, 4), 2), (3e-3, (1, 2, 4), 4), (1.0, (1, 2, 4, 8), 8)],
)
def test_a_search_goes_on_as_its_errors_say(error: float, tried: tuple[int, ...], chosen: int) -> None:
    """On cells from a file, whose errors fall with the square of their size, to one of 4e-4; by hand."""
    form = fem.Given(fem.rectangle(0.2, 0.08, 4, 2))
    found = foretold.course(form, (1,), 2, lambda size: error / size**2, 4e-4, 100.0)
    assert found == foretold.Course(tried, chosen)


def test_small_plates_tell_the_errors_of_a_large_one(paper: Scene, tmp_path: Path) -> None:
    """Of a fine mesh from a file, within the factor that is allowed for; they are so small that the first mesh does."""
    flat = changed(paper, plate__theory="kirchhoff", effects=PLAIN, rotor__speeds=["5000 rpm"])
    quiet = Stages(visible=False)
    source, decided = _in_cells(changed(flat, damper=None, release=None), (40, 20), tmp_path)
    alike = trials.alike(source, decided, "kirchhoff")
    told = foretold.told(decided.plate[0], alike)
    assert told is not None
    form, small = decided.plate[0], alike[-1].discrete.choice.operators
    here = fem.solve_modes(small, 500.0, 6).frequencies_hz
    beyond = plate.discretise(source, decided, quiet, size=2).choice.operators
    true = np.abs(here / fem.solve_modes(beyond, 500.0, 6).frequencies_hz - 1.0).max()
    assert 1.0 / foretold.DOUBTED < told[0] / true < foretold.DOUBTED
    assert form.sizes == (1, 2)
    assert [course.chosen for course in foretold.guessed(source, decided, "kirchhoff", alike)] == [1]
    assert plate.discretise(source, decided, quiet).choice.size == 1


def test_the_search_is_followed_while_the_next_mesh_is_worth_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Meshes of 1.5 s at 6000 unknowns each: the next takes two, whatever there may be beyond."""
    asked = []

    def tried(_: object, __: object, ___: object, until: float, swept: bool) -> Any:
        asked.append((until, swept))
        unknowns, following = (4000.0, 7000.0) if len(asked) == 1 else (7000.0, 90_000.0)
        search = Part(NOTHING, 1.2, 0.0, 0.0)
        return SimpleNamespace(
            unknowns=unknowns, next=following, search=search, sweep=search, foreseen=lambda _: 2.0 * len(asked)
        )

    monkeypatch.setattr(trials, "tried", tried)
    monkeypatch.setattr(trials.plate, "model", lambda *_: "mindlin")
    assert len(trials.followed(None, None, [])) == 2  # type: ignore[arg-type]
    assert asked == [(trials.FIRST, True), (7000.0, True)]


def test_what_ring_downs_take_is_found_at_speeds_all_over(monkeypatch: pytest.MonkeyPatch) -> None:
    """Below half of the highest speed they take 0.1 s and a thousand cycles, above next to nothing."""
    clock = [0.0]

    def simulate(_: object, __: object, points: Any, ___: object) -> Any:
        (point,) = points
        slow = point.omega < 500.0
        clock[0] += 0.1 if slow else 0.001
        return (SimpleNamespace(omega=point.omega, damping=SimpleNamespace(sdc=np.zeros(1000 if slow else 2))),)

    monkeypatch.setattr(pilot, "perf_counter", lambda: clock[0])
    monkeypatch.setattr(pilot.ringdowns, "simulate", simulate)
    given = load("paper")
    release = given.scene.release.model_copy(update={"cycles": "auto"})  # type: ignore[union-attr]
    rotor = given.scene.rotor.model_copy(update={"speeds": tuple(np.linspace(0.0, 1000.0, 501))})
    source = replace(given, scene=given.scene.model_copy(update={"release": release, "rotor": rotor}))
    points = tuple(SimpleNamespace(omega=omega) for omega in np.linspace(0.0, 1000.0, trials.PROBED))
    cycles, seconds = pilot._damper(source, {}, points)  # type: ignore[arg-type]
    assert cycles == pytest.approx(250 * 1000, rel=0.3)
    assert seconds == pytest.approx(250 * 0.1, rel=0.3)


def test_ring_downs_that_take_little_are_tried_at_two_speeds(monkeypatch: pytest.MonkeyPatch) -> None:
    """At the lowest and the highest; at all that may be tried where they are a good part of a run."""
    clock, each, asked = [0.0], [0.1], list[float]()

    def simulate(_: object, __: object, points: Any, ___: object) -> Any:
        (point,) = points
        asked.append(point.omega)
        clock[0] += each[0]
        return (SimpleNamespace(omega=point.omega, damping=None),)

    monkeypatch.setattr(pilot, "perf_counter", lambda: clock[0])
    monkeypatch.setattr(pilot.ringdowns, "simulate", simulate)
    source = load("paper")
    points = tuple(SimpleNamespace(omega=omega) for omega in _some(source.scene.rotor.speeds, trials.PROBED))
    for seconds, tried in ((0.1, 2), (0.5, trials.PROBED)):
        each[0] = seconds
        asked.clear()
        pilot._damper(source, {}, points)  # type: ignore[arg-type]
        assert len(asked) == tried
        assert set(asked[:2]) == {points[0].omega, points[-1].omega}


def _some(speeds: tuple[float, ...], most: int) -> list[float]:
    return [speeds[round(k * (len(speeds) - 1) / (most - 1))] for k in range(most)]


def test_compiling_once_is_no_part_of_a_run(monkeypatch: pytest.MonkeyPatch, structure: Scene, tmp_path: Path) -> None:
    """The first ring-down of an installation compiles for 1000 s; whoever asks for the need has then waited for it."""
    clock, called, ringdown = [0.0], [], damper.ringdown

    def compiling(*given: Any, **how: Any) -> Any:
        called.append(given)
        clock[0] += 1000.0 if len(called) == 1 else 0.1
        return ringdown(*given, **how)

    monkeypatch.setattr(pilot, "perf_counter", lambda: clock[0])
    monkeypatch.setattr(pilot, "may_be_large", lambda *_: True)
    monkeypatch.setattr(damper, "ringdown", compiling)
    source = load(write(structure, tmp_path / "scene.toml"))
    found = pilot.need(source, replace(decide(source, Stages(visible=False)), seconds=0.0))
    assert len(called) > 1
    assert found.seconds < 100.0


def test_deciding_is_a_part_of_the_run(structure: Scene, tmp_path: Path) -> None:
    source = load(write(structure, tmp_path / "scene.toml"))
    decided = decide(source, Stages(visible=False))
    own = pilot.need(source, replace(decided, seconds=0.0)).seconds
    assert pilot.need(source, replace(decided, seconds=1000.0)).seconds == pytest.approx(1000.0 + own, rel=0.5)
    assert decide(load("paper"), Stages(visible=False)).seconds > 0.0


@pytest.mark.parametrize(
    ("speeds", "modes", "large", "alone"),
    [(3, 6, False, False), (3, 14, False, True), (18, 14, False, False), (1, 14, False, True), (3, 6, True, True)],
)
def test_what_grows_with_the_speeds_is_what_the_sweep_solves_one_by_one(
    speeds: int, modes: int, large: bool, alone: bool, paper: Scene, tmp_path: Path
) -> None:
    """Factors of the sweep: one for each speed, or of a basis, however many speeds there are."""
    from fem.linalg.spent import spent

    few = changed(paper, plate__theory="mindlin", rotor__modes=modes, effects=PLAIN | {"large_deflection": large})
    every = [f"{speed} rad/s" for speed in np.linspace(300, 100, speeds)]
    few = changed(few, rotor__speeds=every, damper=None, release=None)
    source = load(write(few, tmp_path / "scene.toml"))
    decided = decide(source, Stages(visible=False))
    assert plate.each_alone(source.scene, decided.effects) == alone
    discrete = plate.discretise(source, decided, Stages(visible=False), size=2)
    with spent() as book:
        plate.sweep(source, discrete)
    assert (book.factors >= speeds) == (alone or speeds == 1)


@pytest.mark.parametrize("model", ["kirchhoff", "mindlin", "solid/2"])
@pytest.mark.parametrize("kind", ["rectangles", "skew", "triangles"])
def test_plates_alike_have_the_same_cells(model: str, kind: str) -> None:
    """Of so many unknowns, over the same box, in elements of the same kind."""
    import skfem

    import fem
    from fem.theory.kirchhoff import is_rectangles

    mesh = fem.rectangle(0.2, 0.08, 60, 24)
    mesh = skfem.MeshQuad(mesh.p + np.array([[0.1], [0.0]]), mesh.t)
    if kind == "skew":
        mesh = skfem.MeshQuad(mesh.p + np.array([[0.0], [0.3]]) * mesh.p[0], mesh.t)
    if kind == "triangles":
        mesh = mesh.to_meshtri()
    alike = likeness.alike(fem.Given(mesh), model, 8000.0)
    (small,) = (alike.mesh(size) for size in alike.sizes)
    assert needs.unknowns(model, small) == pytest.approx(8000.0, rel=0.25)
    assert small.t.shape[0] == mesh.t.shape[0]
    assert is_rectangles(small) == is_rectangles(mesh)
    assert np.ptp(small.p, axis=1)[0] == pytest.approx(0.2)
    np.testing.assert_allclose(small.p.min(axis=1), mesh.p.min(axis=1), atol=1e-12)


@pytest.mark.parametrize(("cells", "most", "solved"), [(6, 60_000, (1, 2, 4)), (6, 3000, (1, 2)), (24, 3000, (1,))])
def test_the_meshes_reckoned_are_those_of_a_search(
    cells: int, most: int, solved: tuple[int, ...], monkeypatch: pytest.MonkeyPatch, paper: Scene, tmp_path: Path
) -> None:
    """Of bricks on cells from a file, as far as the unknowns go; a large mesh is solved alone."""
    import meshio

    import fem
    from fem.accuracy import choose_mesh as choice

    monkeypatch.setattr(choice, "MOST_UNKNOWNS", choice.MOST_UNKNOWNS | {"solid": most})
    mesh = fem.rectangle(0.2, 0.08, cells, cells)
    points = np.column_stack([mesh.p.T, np.zeros(mesh.p.shape[1])])
    meshio.Mesh(points, [("quad", mesh.t.T)]).write(tmp_path / "plate.vtu")
    named = {"plate__length": None, "plate__width": None, "plate__mesh": "plate.vtu", "plate__theory": "solid"}
    scene = changed(paper, **named, rotor__speeds=["5000 rpm"], rotor__modes=3, damper=None, release=None)
    thin = changed(scene, plate__thickness=1e-3, accuracy={"frequency": 2e-3})  # for which two layers do
    source = load(write(thin, tmp_path / "scene.toml"))
    decided = decide(source, Stages(visible=False))
    model, (form, _) = plate.model(source, decided), decided.plate
    expected = [needs.unknowns(model, form.mesh(size)) for size in solved]
    assert reckoned.searched(source, decided, model) == expected
    if expected[-1] < 10_000:  # others take long
        tried = plate.discretise(source, decided, Stages(visible=False)).choice.tried
        assert tuple(size for size, _ in tried) == solved


def test_what_no_mesh_takes_away_asks_for_no_finer_one(paper: Scene, tmp_path: Path) -> None:
    """Under a point mass the search ends short of the accuracy, by itself: so does what is reckoned of it."""
    heavy = changed(paper, plate__tip_mass="50 g", plate__thickness="4 mm", plate__theory="mindlin", damper=None)
    scene = changed(heavy, release=None, rotor__speeds=["0 rpm"], accuracy={"frequency": 3e-4})
    source = load(write(scene, tmp_path / "scene.toml"))
    decided = decide(source, Stages(visible=False))
    discrete = plate.discretise(source, decided, Stages(visible=False))
    assert not discrete.choice.met
    (course,) = foretold.ahead(source, decided.plate[0], trials.Trial(discrete, NO_PART))
    assert course.sizes[-1] == max(size for size, _ in discrete.choice.tried)
    assert course.chosen == discrete.choice.size
