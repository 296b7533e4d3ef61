"""A figure that violates a law ends a command with status 1 and one line, and leaves nothing; in Python it raises."""

import importlib
import re
from dataclasses import replace
from importlib.metadata import version

import pytest
import xarray as xr

import damper
import fem
import spindamp as face
from damper import engine
from tests.compiler import needs_compiler
from tests.workflows.conftest import KNOWN, changed, raising
from workflows.cli.main import main
from workflows.effects.selection import resolve
from workflows.errors import ImpossibleResult, SpindampError, during
from workflows.laws import lawful
from workflows.scene.load import parse
from workflows.solve import coupling, self_check
from workflows.solve.damper import particle_damper
from workflows.studies.sweep import executor

SCENE = changed(KNOWN, rotor__speeds=["9000 rpm"], title="wrong")
SHAKEN = changed(
    SCENE,
    rotor__speeds=["5000 rpm", "9000 rpm"],
    damper__damping_ratio=0.02,
    excitation={"orders": [2], "force": ["20 N"]},
)


@pytest.fixture
def wrong_energies(monkeypatch):
    """Ring-downs and sweeps whose energies are off by a millionth."""
    right = engine.run_block

    def run_block(block, runs, *others):
        right(block, runs, *others)
        if block[1] == len(runs):
            runs["books"]["final"] *= 1 + 1e-6

    monkeypatch.setattr(engine, "run_block", run_block)


ENDS = r"; nothing was published, please report it with the scene \(python .*spindamp .*numpy .*scipy .*numba .*\)\n$"


@pytest.mark.usefixtures("wrong_energies", "undrawn")
@pytest.mark.parametrize(
    ("command", "place"),
    [
        (("run", "--out", "out"), "a ring-down, at 9000 rpm"),
        (("ringdown", "--json"), "a ring-down, at 9000 rpm"),
        (("response", "--out", "out"), r"a ring-down, order 2 at \d+ rpm"),
    ],
)
def test_one_line_and_nothing_written(spindamp, tmp_path, command, place):
    outcome = spindamp(command[0], SHAKEN if command[0] == "response" else SCENE, *command[1:])
    assert (outcome.status, outcome.out) == (1, "")
    said = "spindamp: an internal error: the energy balance closes, but unexplained .* is .*, beyond the bound of "
    assert re.match(f"{said}.* in {place}{ENDS}", outcome.err), outcome.err
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


@needs_compiler
@pytest.mark.usefixtures("wrong_energies")
def test_no_row_of_a_sweep_hides_it(tmp_path, here, monkeypatch):
    """Neither a nan nor a reason in the data set: the study ends."""
    monkeypatch.setattr("workflows.studies.sweep.executor.ready", lambda: None)
    with pytest.raises(ImpossibleResult, match="in a ring-down, at point 0"):
        face.sweep(SCENE, {"damper.restitution": [0.4, 0.5]}, quick=True, executor=here, out=tmp_path / "out")
    with xr.open_zarr(tmp_path / "out" / "sweep.zarr") as data:
        assert not data.done.any()


def test_plates_of_a_sweep(here, monkeypatch):
    """Where a plate without an answer is a row that says why, an impossible one is none."""
    plate = {"length": "20 cm", "width": "8 cm", "thickness": "1 cm"}
    scene = changed(SCENE, structure=None, plate=plate, material={"name": "steel"}, rotor__radius=None)
    impossible = raising(fem.LawViolation("frequencies ascend, but they do not"))
    monkeypatch.setattr("fem.sweep.campbell.check_diagram", impossible)
    with pytest.raises(ImpossibleResult, match="frequencies ascend"):
        face.sweep(scene, {"damper.restitution": [0.4, 0.5]}, quick=True, executor=here)


@pytest.mark.usefixtures("wrong_energies")
def test_python_raises():
    for call in (face.run, face.ringdown):
        with pytest.raises(ImpossibleResult, match=rf"energy balance .*spindamp {version('spindamp')}") as caught:
            call(SCENE)
        assert isinstance(caught.value.__cause__, damper.LawViolation)
        assert isinstance(caught.value, SpindampError)


def test_mass_and_stiffness_have_the_frequency_of_their_point():
    scene = parse(SCENE)
    point = coupling.known_structure(scene, scene.rotor.speeds[0])
    effects = resolve(scene)
    particle_damper(scene, effects, point)
    for name in ("K1", "M2"):
        wrong = replace(point.reduced, **{name: 1.001 * getattr(point.reduced, name)})
        with pytest.raises(damper.LawViolation, match="f1 is that of K1 and M1"):
            particle_damper(scene, effects, replace(point, reduced=wrong))


def test_what_is_no_violation_stays_what_it_is():
    with pytest.raises(ZeroDivisionError) as caught, lawful(), during("at 3 rpm"):
        raise ZeroDivisionError
    assert caught.value.__notes__ == ["at 3 rpm"]


def test_workers_hand_violations_on(tmp_path):
    """From another process, with the place where it came up."""
    with executor.local(1) as workers, pytest.raises(damper.LawViolation, match="a law, but") as caught:
        list(executor.results(workers, violate, [7]))
    assert caught.value.__notes__ == ["at point 7"]


def violate(number):
    with during(f"at point {number}"):
        raise damper.LawViolation("a law", "figure", 2.0, 1.0)


@needs_compiler
def test_self_check(spindamp, monkeypatch):
    stamps = []
    monkeypatch.setattr("damper.self_check.leave", stamps.append)
    outcome = spindamp("--self-check")
    first, *lines, last = outcome.out.splitlines()
    families = importlib.import_module("damper.self_check").FAMILIES
    assert [path.name.split(".")[0] for path in stamps] == [
        "plates",
        *(f"kernels-{family.replace(' ', '-')}" for family in families),
    ]
    assert (outcome.status, outcome.err, last) == (0, "", "all checks passed")
    assert f"numpy {version('numpy')}" in first
    assert len(lines) > 30
    assert all(line.startswith("ok ") for line in lines)
    monkeypatch.setitem(importlib.import_module("damper.self_check").RINGDOWNS["level floor"].figures, "hits", 163)
    monkeypatch.setattr("fem.sweep.laws.EXACT", -1.0)
    outcome = spindamp("--self-check")
    assert outcome.status == 1
    assert "WRONG  level floor: hits 164, reference 163, error 6.1e-03" in outcome.out
    assert re.search("WRONG  plates: .*, but mode 1 at 0 rpm misses that", outcome.out)
    assert outcome.out.splitlines()[-1] == "do not trust results of this installation"


def test_self_check_of_plain_python(spindamp, monkeypatch):
    """What takes seconds is checked, and what is not is said."""
    stamps = []
    monkeypatch.setattr("damper.self_check.leave", stamps.append)
    monkeypatch.setattr("damper.compiled.COMPILES", False)
    outcome = spindamp("--self-check")
    *lines, left_out, last = outcome.out.splitlines()
    assert (outcome.status, last) == (0, "all checks passed")
    assert left_out.startswith("not checked: damping curves and steady states")
    assert sum("level floor" in line for line in lines) == 3
    assert [path.name.split(".")[0] for path in stamps] == ["plates"]
    assert "cannot be written" not in outcome.err


@pytest.fixture
def new_machine(tmp_path, monkeypatch):
    monkeypatch.setattr(self_check, "stamp_of_plates", lambda: tmp_path / "plates.0.checked")
    self_check.plates.cache_clear()
    yield tmp_path / "plates.0.checked"
    self_check.plates.cache_clear()


def test_plates_are_checked_once(new_machine, monkeypatch):
    ran = []
    monkeypatch.setattr("fem.reduction.reference.check", lambda: ran.append(1))
    for _ in range(2):
        self_check.plates()
    assert (ran, new_machine.exists()) == ([1], True)
    self_check.plates.cache_clear()
    self_check.plates()
    assert ran == [1]


def test_no_plate_is_published_by_programs_that_fail(new_machine, monkeypatch, capsys):
    wrong = raising(fem.LawViolation("'beam' has the frequency 3.5, but 3.6 came out"))
    monkeypatch.setattr("fem.reduction.reference.check", wrong)
    assert main(["campbell", "campbell", "--json"]) == 1
    assert capsys.readouterr().err.startswith("spindamp: an internal error: 'beam' has the frequency 3.5, but")
    assert not new_machine.exists()
