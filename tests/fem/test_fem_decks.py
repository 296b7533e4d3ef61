"""Decks as they are met: files in files, sets of sets, Nastran's continuations; what would be misread is refused."""

import numpy as np
import pytest
from fem_cases import box

from fem import MeshError
from fem.meshes.read import files_of
from fem.meshes.volume import read_volume

DECK = box("hexahedron20", (2, 1, 1), (0.2, 0.04, 0.02))


def scaled(factor):
    return [f"{n},{x:.9g},{y:.9g},{z:.9g}" for n, (x, y, z) in enumerate(factor * DECK.points, 1)]


NODES = scaled(1.0)
CELLS = [[n, *(nodes + 1)] for n, nodes in enumerate(DECK.cells[0][1], 1)]


def deck(nodes=NODES, cells=CELLS, kind="C3D20R", more=()):
    """A mesh as Abaqus and CalculiX write it."""
    listed = [",".join(map(str, each)) for each in cells]
    return "\n".join(["*NODE", *nodes, f"*ELEMENT,TYPE={kind},ELSET=EALL", *listed, *more]) + "\n"


FACE = [str(n) for n in np.flatnonzero(DECK.points[:, 0] == 0.0) + 1]
MESH = ["*NODE,NSET=NALL", *NODES, "*ELEMENT,TYPE=C3D20R,ELSET=EALL"]
MESH += [line for cell in CELLS for line in (",".join(map(str, cell[:16])) + ",", ",".join(map(str, cell[16:])))]
ROOT = ["*NSET,NSET=NROOT", ",".join(FACE)]
ASSEMBLY = ["*ASSEMBLY,NAME=A", "*INSTANCE,NAME=B-1,PART=B", "{}", "*END INSTANCE", "{}", "*END ASSEMBLY"]
PART = ["*PART,NAME=B", *MESH, *ROOT, "*END PART", *ASSEMBLY]

INNER, OUTER = ([line for line in NODES if (line.split(",")[0] in FACE) == inner] for inner in (True, False))
APART = ["*NODE,NSET=Nroot", *INNER[:3], "*NODE,NSET=REST", *OUTER, "*NODE,NSET=NROOT", *INNER[3:]]
APART += MESH[len(NODES) + 1 :]

READ = {
    "as it is": [*MESH, *ROOT],
    "from Windows": ["\ufeff*HEADING\r", *(f"{line}\r" for line in (*MESH, *ROOT))],
    "small letters, spaces": [line.lower().replace("nroot", "NROOT").replace("=", " = ") for line in (*MESH, *ROOT)],
    "mesh from a file": ["*HEADING", "a blade", "*INCLUDE, INPUT=mesh.inc", *ROOT],
    "nodes from a file": ["*NODE, INPUT=nodes.inc, NSET=NALL", *MESH[len(NODES) + 1 :], *ROOT],
    "files in files": ["*Include, input='outer.inc'", *ROOT],
    "set of a set": [*MESH, "*NSET,NSET=FACE", ",".join(FACE), "*NSET,NSET=NROOT", "FACE"],
    "set of a set and nodes": [
        *(*MESH, "*NSET,NSET=F", ",".join(FACE[:3]), "*NSET,NSET=NROOT", f"f,{','.join(FACE[3:])}"),
    ],
    "set in two parts": [*MESH, "*NSET,NSET=NROOT", ",".join(FACE[:3]), "*NSET,NSET=NROOT", ",".join(FACE[3:])],
    "generated set": [*MESH, "*NSET,NSET=G,GENERATE", f"{FACE[0]},{FACE[-1]}", "*NSET,NSET=NROOT", "G"],
    "set on lines of nodes": APART,
    "set on a line of nodes, and by numbers": [
        *(line for line in APART if line != "*NODE,NSET=NROOT"),
        *("*NSET,NSET=NROOT", ",".join(FACE[3:])),
    ],
    "set on lines of nodes of a part": ["*PART,NAME=B", *APART, "*END PART", *(line.format("") for line in ASSEMBLY)],
    "quotes": [*MESH, '*NSET,NSET="NROOT"', ",".join(FACE)],
    "set of elements' nodes": [*MESH, "*NSET,NSET=ALL,ELSET=EALL", "*NSET,NSET=EALL,ELSET=EALL", *ROOT],
    "a part": [line.format("") for line in PART],
    "a part, moved": [line.format("0.5,0,0", "") if line == "{}" else line for line in PART],
    "a set of the assembly": [
        *("*PART,NAME=B", *MESH, "*NSET,NSET=FACE", ",".join(FACE), "*END PART", *ASSEMBLY[:2], ASSEMBLY[3]),
        *("*NSET,NSET=NROOT,INSTANCE=B-1", *ROOT[1:], "*END ASSEMBLY"),
    ],
    "elements of Abaqus alone": [line.replace("C3D20R", "C3D20RH") for line in (*MESH, *ROOT)],
    "springs and skins beside": [
        *(*MESH, "*ELEMENT,TYPE=SPRINGA,ELSET=S", "901,3,4", "*ELEMENT,TYPE=S8R,ELSET=SKIN", "902,1,2,3,4,5,6,7,8"),
        *(*ROOT, "*STEP", "*STATIC", "*NODE PRINT,NSET=NROOT", "U", "*END STEP"),
    ],
}


@pytest.mark.parametrize("case", READ)
def test_decks_are_read_with_their_root(case, tmp_path):
    path = tmp_path / "blade.inp"
    (tmp_path / "mesh.inc").write_text("\n".join(MESH))
    (tmp_path / "nodes.inc").write_text("\n".join(NODES))
    (tmp_path / "outer.inc").write_text("*INCLUDE,INPUT=mesh.inc\n")
    path.write_text("\n".join(READ[case]) + "\n", encoding="utf-8")
    mesh = read_volume(path)
    inside = {"mesh from a file": "mesh", "nodes from a file": "nodes", "files in files": "outer mesh"}.get(case, "")
    assert [each.name for each in files_of(path)] == ["blade.inp", *(f"{name}.inc" for name in inside.split())]
    assert [(kind, len(nodes)) for kind, nodes in mesh.cells] == [("hexahedron20", 2)]
    offset = 0.5 if "moved" in case else 0.0
    np.testing.assert_allclose(np.sort(mesh.points[:, 0]), np.sort(DECK.points[:, 0]) + offset, atol=1e-12)
    root = np.flatnonzero(mesh.points[:, 0] == offset)
    if case == "generated set":
        root = np.arange(int(FACE[0]) - 1, int(FACE[-1]))
    np.testing.assert_array_equal(mesh.sets["NROOT"], root)


def test_decks_that_include_each_other_are_followed_once(tmp_path):
    """However the names are spelt; what is not there is no file."""
    (tmp_path / "deck").mkdir()
    for name, other in (("a.inp", "../deck/b.inp"), ("b.inp", "../deck/a.inp")):
        (tmp_path / "deck" / name).write_text(f"*INCLUDE, INPUT={other}\n*INCLUDE, INPUT=none.inc\n*NODE\n")
    assert [each.name for each in files_of(tmp_path / "deck" / "a.inp")] == ["a.inp", "b.inp"]


REFUSED = {
    "empty": ("", "no cells with a volume"),
    "no mesh": ("these are\nwords\n", "no cells with a volume"),
    "nodes alone": ("*NODE\n" + "\n".join(NODES), "no cells with a volume"),
    "cells alone": (deck(nodes=()), "an id while no ids were defined"),
    "not a number": (deck([NODES[0].replace("0,0,0", "0,0,nan"), *NODES[1:]]), "line 2: node 1 has coordinates that"),
    "not finite": (deck([NODES[0].replace("0,0,0", "0,0,inf"), *NODES[1:]]), "node 1 has coordinates that are not"),
    "a word": (deck([NODES[0].replace("0,0,0", "0,0,z"), *NODES[1:]]), "line 2: expected .*, not '1,0,0,z'"),
    "two coordinates": (deck([each.rsplit(",", 1)[0] for each in NODES]), "not have three coordinates"),
    "one missing": (deck([*NODES[:-1], NODES[-1].rsplit(",", 1)[0]]), "line 33: node 32 has 2 coordinates, not 3$"),
    "two missing": (deck([*NODES[:4], "5,1.", *NODES[5:]]), "line 6: node 5 has 1 coordinate, not 3$"),
    "one left empty": (deck([*NODES[:4], "5,1.,,1.", *NODES[5:]]), "line 6: expected .* coordinates, not '5,1.,,1.'$"),
    "one decimal comma": (
        deck([*NODES[:4], "5,1.0,1,5,0.0", *NODES[5:]]),
        "line 6: node 5 has 4 .* are commas decimal",
    ),
    "a node twice": (deck([*NODES, "1,9,9,9"]), "1 of 2 hexahedron20 cells are .* m; line 34: node 1 is listed twice"),
    "no last node": (deck(NODES[:-1]), r"line \d+: element 2 names node 32, which is not in the file"),
    "a node misnumbered": (deck([f"2,{NODES[0][2:]}", *NODES[1:]]), "line 3: node 2 is listed twice, first in line 2$"),
    "a node below 0": (deck([f"-{NODES[0]}", *NODES[1:]]), "line 2: node -1: expected a number above 0"),
    "decimal commas": (deck([each.replace(".", ",") for each in NODES]), "line 3: node 2 has 4 coordinates, not 3"),
    "a node short": (deck(cells=[CELLS[0][:-1], CELLS[1]]), "not a mesh file that meshlane can read"),
    "listed twice": (deck(cells=[*CELLS, [9, *CELLS[0][1:]]]), "faces belong to more than two cells"),
    "shells": (deck(cells=[CELLS[0][:5]], kind="S4"), "no cells with a volume"),
    "beams": (deck(cells=[CELLS[0][:3]], kind="B31"), "no cells with a volume"),
    "no such kind": (deck(kind="C3D99"), "line 34: elements C3D99 are not read: use C3D10"),
    "both orders": (deck(more=["*ELEMENT,TYPE=C3D8", ",".join(map(str, CELLS[0][:9]))]), "orders? are mixed"),
    "in mm": (deck(scaled(1e3)), "measures 200 m: are its coordinates in mm"),
    "in um": (deck(scaled(1e-3)), "measures 0.0002 m: expected 2 mm to 20 m"),
    "in a point": (deck(scaled(0.0)), "measures 0 m"),
    "a set of no node": (deck(more=["*NSET,NSET=NROOT", "900,901"]), "line 38: set NROOT names node 900, which"),
    "cut": (deck()[:-40], "not a (readable )?mesh file"),
    "no such file": (["*INCLUDE,INPUT=none.inc"], r"line 1: it includes 'none.inc', which is not a file"),
    "a ring": (["*INCLUDE,INPUT=blade.inp", "*NODE"], r"line 1: it includes 'blade.inp', which includes it"),
    "generated nodes": (["*NODE", "1,0,0,0", "9,1,0,0", "*NGEN", "1,9"], r"line 4: \*NGEN generates nodes, .* in full"),
    "copied nodes": ([*MESH, "*NCOPY,CHANGE NUMBER=100,OLD SET=NALL,SHIFT", "0,0,1"], r"\*NCOPY generates nodes"),
    "generated elements": ([*MESH, "*ELGEN,ELSET=EALL", "1,2,1,1"], r"line \d+: \*ELGEN generates elements"),
    "cylindrical": (["*NODE,SYSTEM=C", *MESH[1:]], r"line 1: \*NODE, SYSTEM=C: expected nodes in rectangular"),
    "a system": (["*SYSTEM", "1,0,0,0,1,0", *MESH], r"line 1: \*SYSTEM moves nodes"),
    "no such set": ([*MESH, "*NSET,NSET=NROOT", "FACE"], r"a set of nodes holds 'FACE', which is neither a number"),
    "a set in two ways": ([*MESH, *ROOT, "*NSET,NSET=NROOT,ELSET=EALL"], r"line 41: another set is called NROOT"),
    "two sets": ([*MESH, "*NSET,NSET=X,ELSET=EALL", "*ELSET,ELSET=X", "1"], r"line \d+: another set is called X"),
    "an element of its own": ([*MESH, "*ELEMENT,TYPE=C3D27", "9,1,2"], r"line \d+: elements C3D27 are not read"),
    "without middles": ([*MESH[:-1], "0,0,0,0"], r"line \d+: element 2 names node 0, which is not"),
    "twice in place": (
        [line.format("") for line in (*PART[:-1], "*INSTANCE,NAME=B-2,PART=B", "1,0,0", "*END INSTANCE", PART[-1])],
        "the mesh is in 2 pieces",
    ),
}


def test_a_set_of_elements_gives_a_set_of_their_nodes(tmp_path):
    """By *NSET, ELSET; the first element has 20 of the deck's 32 nodes."""
    path = tmp_path / "blade.inp"
    path.write_text("\n".join([*MESH, *ROOT, "*ELSET,ELSET=FIRST", "1", "*NSET,NSET=INNER,ELSET=FIRST"]) + "\n")
    np.testing.assert_array_equal(read_volume(path).sets["INNER"], np.sort(CELLS[0][1:]) - 1)


@pytest.mark.parametrize("case", REFUSED)
def test_what_would_be_misread_is_one_line(case, tmp_path):
    given, problem = REFUSED[case]
    path = tmp_path / "blade.inp"
    path.write_text(given if isinstance(given, str) else "\n".join(given) + "\n")
    with pytest.raises(MeshError, match=problem) as refused:
        read_volume(path)
    assert str(refused.value).startswith(f"{path}: ")
    assert "\n" not in str(refused.value)
    path.write_text(deck())
    assert [len(nodes) for _, nodes in read_volume(path).cells] == [2]


ORDER = {
    "hexahedron20": ("CHEXA", [*range(12), *range(16, 20), *range(12, 16)]),
    "tetra10": ("CTETRA", [*range(10)]),
    "wedge15": ("CPENTA", [*range(9), *range(12, 15), *range(9, 12)]),
}
"""Nastran's names, and its order of nodes: those between bottom and top before those of the top."""


def bulk(kind, style):
    """A mesh as Nastran's cards: of fixed width with or without marks, or free."""
    mesh, (card, order) = box(kind, (2, 1, 1), (0.2, 0.04, 0.02)), ORDER[kind]
    lines = [f"GRID    {n:>8}        " + "".join(f"{x:8.5f}" for x in at) for n, at in enumerate(mesh.points, 1)]
    for number, cell in enumerate(mesh.cells[0][1], 1):
        own = [str(each) for each in (number, 1, *(cell[order] + 1))]
        mark = "+" if style == "marks" else ""
        for k in range(0, len(own), 8):
            row, first = own[k : k + 8], mark if k else card
            after = mark if k + 8 < len(own) else ""
            free, fixed = ",".join([first, *row]), f"{first:<8}" + "".join(f"{n:>8}" for n in row) + after
            lines.append(free if style == "free" else fixed)
    return mesh, ["SOL 103", "CEND", "BEGIN BULK", *lines, "ENDDATA"]


@pytest.mark.parametrize("style", ["marks", "blanks", "free"])
@pytest.mark.parametrize("kind", ORDER)
def test_nastran_continues_cards_in_three_ways(kind, style, tmp_path):
    path = tmp_path / "blade.bdf"
    mesh, lines = bulk(kind, style)
    path.write_text("\n".join(lines) + "\n")
    found = read_volume(path)
    ((name, cells),) = found.cells
    assert name == kind
    np.testing.assert_allclose(found.points[cells], mesh.points[mesh.cells[0][1]], atol=1e-9)


def test_nastran_from_two_files_and_in_other_systems(tmp_path):
    mesh, lines = bulk("tetra10", "blanks")
    nodes = [line for line in lines if line.startswith("GRID")]
    (tmp_path / "nodes.bdf").write_text("\n".join(nodes) + "\n")
    path = tmp_path / "blade.bdf"
    path.write_text("\n".join([*lines[:3], "INCLUDE 'nodes.bdf'", *lines[3 + len(nodes) :]]) + "\n")
    np.testing.assert_allclose(read_volume(path).points, mesh.points, atol=1e-9)
    for turned in (f"{nodes[0][:16]}       5{nodes[0][24:]}", "GRID,1,5,0.,0.,0."):
        path.write_text("\n".join([*lines[:3], turned, *lines[4:]]) + "\n")
        with pytest.raises(MeshError, match=r"line 4: node 1 lies in coordinate system 5: expected nodes in the basic"):
            read_volume(path)
    path.write_text("\n".join([*lines[:-2], lines[-2][:24], "ENDDATA"]) + "\n")
    with pytest.raises(MeshError, match=r"lack some of their nodes|some of their lines are not read"):
        read_volume(path)
