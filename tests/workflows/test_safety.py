"""Nothing in a scene is ever run, nothing is written outside of DIR, and text stays text."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr

from tests.limits import HANG
from tests.workflows.conftest import MESHES, changed, on_mesh, refused, stored, write
from workflows.scene.load import SHIPPED

TITLES = ["../../escaped", "/etc/escaped", "..\\..\\escaped", "`touch escaped`; $(touch escaped)", "\u202eescaped"]
TITLES += ["..", "-rf", "CON", "a" * 200]


@pytest.mark.usefixtures("undrawn", "quickly")
@pytest.mark.parametrize("title", [title for title in TITLES if title.isprintable()])
def test_a_title_names_a_folder_here(title, spindamp, tmp_path, structure, monkeypatch):
    place = tmp_path / "deep" / "here"
    place.mkdir(parents=True)
    monkeypatch.chdir(place)
    write(changed(structure, title=title, release__cycles=2), place / "scene.toml")
    assert spindamp("run", "scene.toml").status == 0
    assert [path.name for path in tmp_path.iterdir()] == ["deep"]
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["here"]
    others = [path for path in place.iterdir() if path.name != "scene.toml"]
    assert len(others) == 1
    assert others[0].name.startswith("spindamp-")
    assert (others[0] / "report.html").is_file()


def test_a_title_that_would_turn_the_line_around(spindamp, structure):
    for title in ("\u202eescaped", "bell\a", "\x1b[31mred", "two\nlines"):
        said = refused(spindamp("run", changed(structure, title=title)), "", "title = ")
        assert said.rstrip("\n").isprintable()


@pytest.mark.parametrize("mesh", ["../..//etc/passwd", "/etc/passwd", "/proc/self/environ", "/proc/self/mem"])
def test_a_mesh_elsewhere_is_only_read(mesh, spindamp, tmp_path, paper):
    before = os.stat("/etc/passwd")
    said = refused(spindamp("run", on_mesh(paper, mesh), "--out", "out"), f"scene.toml: [plate] mesh = '{mesh}': ")
    assert "root:" not in said
    assert os.stat("/etc/passwd").st_mtime == before.st_mtime
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


HOSTILE = """<script>alert(1)</script><img src=x onerror=alert(1)> "'&lt; {{ 7*7 }} {% raw %} ]]> --> $x_1$ \\\\frac%"""


@pytest.mark.usefixtures("quickly")
def test_text_stays_text_in_every_file(spindamp, tmp_path, structure):

    assert spindamp("run", changed(structure, title=HOSTILE, release__cycles=2), "--out", "out").status == 0
    out = tmp_path / "out"
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "<script>alert" not in page
    assert "<img src=x" not in page
    assert "&lt;script&gt;" in page
    assert "{{ 7*7 }}" in page
    assert stored(out / "results.json")["title"] == HOSTILE
    with xr.open_dataset(out / "results.nc", engine="h5netcdf") as data:
        assert data.attrs["title"] == HOSTILE


def test_a_mesh_with_a_hostile_name(spindamp, tmp_path, paper):
    name = "<script>alert(1)<!-- --> {{ 7 }}.msh"
    (tmp_path / name).write_bytes((MESHES / "plate_coarse.msh").read_bytes())
    scene = on_mesh(paper, name, rotor__speeds=[0], rotor__modes=2, damper=None, release=None, effects=None)
    assert spindamp("run", scene, "--out", "out").status == 0
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "<script>alert" not in page
    assert "<!-- -->" not in page


def test_modules_in_the_users_folder_are_not_imported(spindamp, tmp_path, paper):
    """Neither by a run nor by the process that draws for it."""
    for name in ("numpy", "pyvista", "matplotlib", "io", "typing", "PIL", "fem"):
        (tmp_path / f"{name}.py").write_text(
            "from pathlib import Path\nPath('imported').touch()\nraise SystemExit(9)\n"
        )
    few = {"rotor__speeds": ["0 rpm"], "rotor__modes": 2, "accuracy__frequency": 0.05}
    scene = changed(paper, **few, damper=None, release=None)
    assert spindamp("run", scene, "--out", "out").status == 0
    assert not (tmp_path / "imported").exists()


SCRIPT = Path(sys.executable).with_name("spindamp")


@pytest.mark.skipif(not SCRIPT.is_file(), reason="the command is not installed beside this Python")
def test_folders_of_the_same_name_do_not_hide_the_packages_from_the_command(paper, tmp_path):
    for name in ("fem", "damper", "workflows", "numpy"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("raise SystemExit(9)\n")
    soon = changed(paper, rotor__speeds=["0 rpm"], rotor__modes=2, accuracy__frequency=0.05)
    command = [SCRIPT, "campbell", write(soon, tmp_path / "scene.toml"), "--json"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=HANG)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("{")


def test_shipped_scenes_are_not_the_users(spindamp, tmp_path):
    """A name is a shipped scene, unless a file of just that name is here."""
    assert spindamp("check", "paper").status == 0
    assert spindamp("check", "../paper").status == 2
    assert spindamp("check", str(SHIPPED / "paper")).status == 2
