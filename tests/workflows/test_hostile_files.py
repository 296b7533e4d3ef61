"""Scene and mesh files that are no such thing: refused at once, in one line, without waiting for what never comes."""

import os
import socket
import sys
from contextlib import contextmanager, nullcontext
from pathlib import Path

import pytest

from tests.workflows.conftest import MESHES, Outcome, on_mesh, python, refused, write
from workflows.scene.load import SHIPPED, load

PAPER = (SHIPPED / "paper.toml").read_text(encoding="utf-8")
NOBODY = 65534


SCENES = {
    "empty": (b"", "the file is empty"),
    "only line breaks": (b"\r\n\n  \n", "the file is empty"),
    "only a byte order mark": ("\ufeff".encode(), "[rotor]: missing"),
    "only a comment": (b"# nothing yet\n", "[rotor]: missing"),
    "UTF-16": (PAPER.encode("utf-16"), "not UTF-8"),
    "Latin-1": ("title = 'é'".encode("latin-1"), "not UTF-8"),
    "binary": (bytes(range(256)) * 40, "not UTF-8"),
    "zeros": (bytes(5000), "not valid TOML"),
    "old Mac line ends": (PAPER.replace("\n", "\r").encode(), "not valid TOML"),
    "JSON": (b'{"plate": {"length": 1}}', "not valid TOML"),
    "YAML": (b"plate:\n  length: 1\n", "not valid TOML"),
    "half of a scene": (PAPER.encode()[:300].rstrip()[:-3] + b'"x', "not valid TOML"),
    "a key twice": (b"title = '1'\ntitle = '2'", "not valid TOML"),
    "a table twice": (PAPER.encode() + b"\n[rotor]\n", "not valid TOML"),
    "brackets without end": (b"a = " + b"[" * 200_000, "not a scene"),
    "braces without end": (b"a = " + b"{a = " * 100_000, "not a scene"),
    "a number of a million digits": (PAPER.replace('"20 cm"', "1" * 900_000, 1).encode(), "too many digits"),
    "two megabytes of comment": (b"#" * 2_000_000, "a file of more than"),
}


@pytest.mark.parametrize(("content", "message"), SCENES.values(), ids=SCENES)
def test_scene_file(content, message, spindamp, tmp_path):
    (tmp_path / "bad.toml").write_bytes(content)
    assert len(refused(spindamp("run", "bad.toml", "--out", "out"), "bad.toml: ", message)) < 300
    assert [path.name for path in tmp_path.iterdir()] == ["bad.toml"]


@pytest.mark.parametrize(
    "content", [PAPER.replace("\n", "\r\n").encode(), PAPER.encode("utf-8-sig")], ids=["CRLF", "byte order mark"]
)
def test_scenes_from_other_systems(content, tmp_path):
    (tmp_path / "scene.toml").write_bytes(content)
    assert load(tmp_path / "scene.toml").scene == load("paper").scene


def _socket(path):
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(os.path.relpath(path))  # the name of a socket is short


def _closed(path):
    path.write_text(PAPER)
    path.chmod(0)


NO_FILES = {
    "a folder": (Path.mkdir, "found a folder"),
    "a pipe": (os.mkfifo, "found a pipe"),
    "a socket": (_socket, "found a socket"),
    "an endless device": (lambda path: path.symlink_to("/dev/zero"), "found a device"),
    "a silent device": (lambda path: path.symlink_to("/dev/null"), "found a device"),
    "a link to nowhere": (lambda path: path.symlink_to("nowhere"), "a link to"),
    "a link to itself": (lambda path: path.symlink_to(path.name), "cannot be read"),
    "a file for others only": (_closed, "cannot be read: Permission denied"),
    "nothing": (lambda _: None, "no such"),
}
"""What makes something that is no file to read, and what is said of it."""


@contextmanager
def _unprivileged(folder):
    """As a user who may not read everything."""
    if os.geteuid() != 0:
        yield
        return
    for parent in (folder, *folder.parents):
        if not os.stat(parent).st_mode & 0o001:
            pytest.skip("the tests' own folder is closed to others")
    os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.mark.parametrize(("make", "message"), NO_FILES.values(), ids=NO_FILES)
@pytest.mark.parametrize("as_mesh", [False, True], ids=["scene", "mesh"])
def test_what_is_no_file(make, message, as_mesh, spindamp, tmp_path, paper):
    closed, name = make is _closed, "it.msh" if as_mesh else "it.toml"
    if closed and os.geteuid() == 0:
        tmp_path.chmod(0o777)
        for parent in list(tmp_path.parents)[:3]:
            if parent.name.startswith("pytest-"):
                parent.chmod(0o755)
    make(tmp_path / name)
    scene = write(on_mesh(paper, name), tmp_path / "scene.toml") if as_mesh else name
    with _unprivileged(tmp_path) if closed else nullcontext():
        outcome = spindamp("check", Path(scene).name)
    start = "scene.toml: [plate] mesh = 'it.msh': " if as_mesh else "it.toml: "
    assert len(refused(outcome, start, message)) < 300


def refused_mesh(spindamp, paper, name, message=""):
    """The line that refuses the paper's plate on a mesh file in the current folder."""
    return refused(spindamp("run", on_mesh(paper, name)), "scene.toml: [plate] ", message)


GOOD = (MESHES / "plate_coarse.msh").read_text(encoding="utf-8")
CORNERS = ("0 -.04 0", ".2 -.04 0", ".2 .04 0", "0 .04 0")


def _gmsh(nodes, cells, count=None):
    points = "".join(f"{number} {node}\n" for number, node in enumerate(nodes, 1))
    lines = "".join(f"{number} {cell}\n" for number, cell in enumerate(cells, 1))
    return (
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(nodes) if count is None else count}\n{points}$EndNodes\n"
        f"$Elements\n{len(cells)}\n{lines}$EndElements\n"
    )


QUAD = "3 2 0 1 1 2 3 4"
BAD = {
    "empty": ("", "empty"),
    "blank": ("\n\n", "damaged or truncated"),
    "cut in the header": (GOOD[:8], "not a"),
    "cut in the nodes": (GOOD[:300], "damaged or truncated"),
    "cut in the cells": (GOOD[: len(GOOD) * 4 // 5], "damaged or truncated"),
    "junk": (bytes(range(256)) * 20, "not a mesh file"),
    "text": ("a plate\n" * 50, "not a mesh file"),
    "of another version": (GOOD.replace("2.2 0 8", "9.9 0 8"), "not a"),
    "text that claims to be binary": (GOOD.replace("2.2 0 8", "2.2 1 8"), "not a"),
    "a point too few": (_gmsh(CORNERS[:3], (QUAD,)), "not a readable mesh file"),
    "no points": (_gmsh((), (QUAD,)), "not a readable mesh file"),
    "a count that lies": (_gmsh(CORNERS, (QUAD,), 10**12), "not a readable mesh file"),
    "a negative count": (_gmsh(CORNERS, (QUAD,), -4), "not a readable mesh file"),
    "a kind of cell that is none": (_gmsh(CORNERS, ("999 2 0 1 1 2 3 4",)), "not a readable mesh file"),
    "a coordinate that is no number": (_gmsh(("0 -.04 0", "nan -.04 0", *CORNERS[2:]), (QUAD,)), "not finite"),
    "an infinite coordinate": (_gmsh(("0 -.04 0", "inf -.04 0", *CORNERS[2:]), (QUAD,)), "not finite"),
    "infinity by zero": (_gmsh(("0 0 0", "inf 0 0", ".2 .08 0", "0 .08 0"), (QUAD,)), "not finite"),
    "a cell without extent": (_gmsh(("0 0 0",) * 4, (QUAD,)), "inverted or flat"),
    "in millimetres": (_gmsh(("0 -40 0", "200 -40 0", "200 40 0", "0 40 0"), (QUAD,)), "a mesh is in metres"),
    "beyond every size": (_gmsh(("0 -.04 0", "1e300 -.04 0", "1e300 .04 0", "0 .04 0"), (QUAD,)), "in metres"),
}


@pytest.mark.parametrize(("content", "message"), BAD.values(), ids=BAD)
def test_mesh_file(content, message, spindamp, tmp_path, paper):
    (tmp_path / "it.msh").write_bytes(content if isinstance(content, bytes) else content.encode())
    assert len(refused_mesh(spindamp, paper, "it.msh", message)) < 300
    assert {path.name for path in tmp_path.iterdir()} == {"scene.toml", "it.msh"}


@pytest.mark.parametrize("name", ["it.xyz", "it", "it.vtu", "it.xdmf", "it.stl", "it.inp", "it.bdf", "it.h5m", "it.e"])
def test_junk_under_any_name(name, spindamp, tmp_path, paper):
    (tmp_path / name).write_bytes(b"\x00\xff<a>\n*NODE\nGRID" * 100)
    refused_mesh(spindamp, paper, name, f"mesh = '{name}': ")


@pytest.mark.parametrize(("what", "kind"), [("a pipe", "HDF"), ("an endless device", "Binary")])
def test_an_xdmf_file_that_names_no_file(what, kind, tmp_path, paper):
    """Each in a process of its own, which reading a pipe would never let end."""
    named = "it.bin:/x" if kind == "HDF" else "it.bin"
    items = f'<DataItem DataType="Float" Dimensions="4 3" Precision="8" Format="{kind}">{named}</DataItem>'
    grid = f'<Grid><Geometry GeometryType="XYZ">{items}</Geometry></Grid>'
    (tmp_path / "it.xdmf").write_text(f'<Xdmf Version="3.0"><Domain>{grid}</Domain></Xdmf>')
    write(on_mesh(paper, "it.xdmf"), tmp_path / "bad.toml")
    NO_FILES[what][0](tmp_path / "it.bin")
    done = python("-m", "workflows.cli", "check", "bad.toml", cwd=tmp_path)
    outcome = Outcome(done.returncode, done.stdout, done.stderr)
    refused(outcome, "bad.toml: [plate] mesh = 'it.xdmf': ", "it names 'it.bin', which is not a file")


def test_entities_that_grow_without_end(spindamp, tmp_path, paper):
    entities = '<!ENTITY a0 "aaaaaaaaaa">' + "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 12))
    bomb = f'<?xml version="1.0"?><!DOCTYPE VTKFile [{entities}]><VTKFile type="UnstructuredGrid">&a11;</VTKFile>'
    (tmp_path / "it.vtu").write_text(bomb)
    refused_mesh(spindamp, paper, "it.vtu", "mesh = 'it.vtu': not a mesh file")


def test_a_format_whose_reader_is_not_installed(spindamp, tmp_path, paper, monkeypatch):
    monkeypatch.setitem(sys.modules, "netCDF4", None)
    (tmp_path / "it.exo").write_text(GOOD, encoding="utf-8")
    said = refused_mesh(spindamp, paper, "it.exo", "mesh = 'it.exo': ")
    assert "to read this format, the Python package netCDF4 must be installed" in said
