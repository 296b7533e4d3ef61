"""Decks as they are met: files in files, sets of sets, Nastran's continuations; what would be misread is refused."""

import re
import time

import meshlane
import numpy as np
import pytest
from fem_cases import box

from fem import MeshError
from fem.meshes.decks import plain
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
    "mesh from a file on the next line": ["*INCLUDE,", "** a comment", "INPUT=mesh.inc", *ROOT],
    "nodes from a file on the next line": ["*NODE, NSET=NALL,", "INPUT=nodes.inc", *MESH[len(NODES) + 1 :], *ROOT],
    "cells from a file on the next line": [*MESH[:-4], f"{MESH[-5]},", "INPUT=cells.inc", *ROOT],
    "a tab after a file's name": ["*INCLUDE, INPUT=mesh.inc\t ", *ROOT],
    "words of a heading that include": ["*HEADING", "include, input", *MESH, *ROOT],
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
    "commas after whole elements": [*MESH[: len(NODES) + 2], *(f"{line.rstrip(',')}," for line in MESH[-4:]), *ROOT],
    "no commas within elements": [*MESH[: len(NODES) + 2], *(line.rstrip(",") for line in MESH[-4:]), *ROOT],
    "commas after nodes": ["*NODE", *(f"{line} ," for line in NODES), *MESH[len(NODES) + 1 :], *ROOT],
    "commas after nodes of a part": [f"{line},," if line in NODES else line.format("") for line in PART],
    "blanks before and in keywords": [line.replace("*", "  * ") for line in (*MESH, *ROOT)],
    "a keyword on two lines": [
        *(line.replace("D,ELSET", "D,\nELSET") for line in MESH),
        "*NSET,",
        "NSET=NROOT",
        *ROOT[1:],
    ],
    "exponents of Fortran": ["*NODE", "1,0.0D+0,0.d0,0D-3", *MESH[2:], *ROOT],
    "a set in two spellings": [
        *(*MESH, "*NSET,NSET=nroot", ",".join(FACE[:3]), "*NSET,NSET=NROOT", ",".join(FACE[3:])),
    ],
    "sets of elements without a step": [
        *MESH,
        "*ELSET,ELSET=ALL,GENERATE",
        "1,2",
        "*ELSET,GENERATE,ELSET=A",
        "1",
        *ROOT,
    ],
    "words of a heading": ["*HEADING", "part", "node, element", *MESH, *ROOT],
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
    (tmp_path / "cells.inc").write_text("\n".join(MESH[-4:]))
    (tmp_path / "outer.inc").write_text("*INCLUDE,INPUT=mesh.inc\n")
    path.write_text("\n".join(READ[case]) + "\n", encoding="utf-8")
    mesh = read_volume(path)
    inside = re.findall(r"(\w+)\.inc", " ".join(READ[case])) + ["mesh"] * (case == "files in files")
    assert [each.name for each in files_of(path)] == ["blade.inp", *(f"{name}.inc" for name in inside)]
    assert [(kind, len(nodes)) for kind, nodes in mesh.cells] == [("hexahedron20", 2)]
    offset = 0.5 if "moved" in case else 0.0
    np.testing.assert_allclose(np.sort(mesh.points[:, 0]), np.sort(DECK.points[:, 0]) + offset, atol=1e-12)
    root = np.flatnonzero(mesh.points[:, 0] == offset)
    if case == "generated set":
        root = np.arange(int(FACE[0]) - 1, int(FACE[-1]))
    np.testing.assert_array_equal(mesh.sets["NROOT"], root)
    assert len({name.upper() for name in mesh.sets}) == len(mesh.sets)


def test_decks_that_include_each_other_are_followed_once(tmp_path):
    """However the names are spelt; what is not there is no file."""
    (tmp_path / "deck").mkdir()
    for name, other in (("a.inp", "../deck/b.inp"), ("b.inp", "../deck/a.inp")):
        (tmp_path / "deck" / name).write_text(f"*INCLUDE, INPUT={other}\n*INCLUDE, INPUT=none.inc\n*NODE\n")
    assert [each.name for each in files_of(tmp_path / "deck" / "a.inp")] == ["a.inp", "b.inp"]


WITHIN = [*PART[:-3], ASSEMBLY[3]]
"""A part and its instance, up to the sets of the assembly."""


def placed(*lines):
    """A part, and an instance of it after lines that place it."""
    return [*PART[:-4], *lines, ASSEMBLY[3], ASSEMBLY[5]]


PLACED = {
    "one number": (["0.5,"], [0.5, 0.0, 0.0]),
    "two numbers": (["0.5, 0."], [0.5, 0.0, 0.0]),
    "a blank before": ([",0.5,0."], [0.0, 0.5, 0.0]),
    "a comma behind": (["0.5,0.,0.,"], [0.5, 0.0, 0.0]),
    "turned by nothing": (["5.D-1,,", "0.,0.,0.,0.,0.,1.,"], [0.5, 0.0, 0.0]),
}


@pytest.mark.parametrize("case", PLACED)
def test_blanks_where_an_instance_is_placed_are_zeros(case, tmp_path):
    """The instance was left where its part is, or moved along another axis."""
    lines, offset = PLACED[case]
    path = tmp_path / "blade.inp"
    path.write_text("\n".join(placed(*lines)) + "\n")
    np.testing.assert_allclose(read_volume(path).points, DECK.points + offset, atol=1e-12)


def test_an_instance_is_turned_by_the_line_below_its_translation(tmp_path):
    path = tmp_path / "blade.inp"
    path.write_text("\n".join(placed("0.5,", ",,,,,1.,90.")) + "\n")
    x, y, z = np.add(DECK.points, [0.5, 0.0, 0.0]).T
    np.testing.assert_allclose(read_volume(path).points, np.transpose([-y, x, z]), atol=1e-12)


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
    "a node short": (
        deck(cells=[CELLS[0][:-1], CELLS[1]]),
        "line 35: element 1 has 19 nodes, and C3D20R has 20$",
    ),
    "a node too many": (deck(cells=[[*CELLS[0], 9], CELLS[1]]), "line 35: element 1 has 21 nodes, and C3D20R has 20$"),
    "listed twice": (deck(cells=[*CELLS, [9, *CELLS[0][1:]]]), "faces belong to more than two cells"),
    "shells": (deck(cells=[CELLS[0][:5]], kind="S4"), "no cells with a volume"),
    "beams": (deck(cells=[CELLS[0][:3]], kind="B31"), "no cells with a volume"),
    "no such kind": (deck(kind="C3D99"), "line 34: elements C3D99 are not read: use C3D10"),
    "both orders": (deck(more=["*ELEMENT,TYPE=C3D8", ",".join(map(str, CELLS[0][:9]))]), "orders? are mixed"),
    "in mm": (deck(scaled(1e3)), "measures 200 m: are its coordinates in mm"),
    "in um": (deck(scaled(1e-3)), "measures 0.0002 m: expected 2 mm to 20 m"),
    "in a point": (deck(scaled(0.0)), "measures 0 m"),
    "a set of no node": (deck(more=["*NSET,NSET=NROOT", "900,901"]), "line 38: set NROOT names node 900, which"),
    "cut": (deck()[:-40], "line 36: element 2 has 7 nodes, and C3D20R has 20"),
    "cut at a comma": (deck(cells=[CELLS[0], CELLS[1][:-1]])[:-1] + ",", "line 36: element 2 has 19 nodes, and"),
    "no such file": (["*INCLUDE,INPUT=none.inc"], r"line 1: it includes 'none.inc', which is not a file"),
    "no name of a file": (
        ["*HEADING", "*INCLUDE,", "INPUT="],
        r"line 2: '\*INCLUDE,INPUT=' names no file that can be read",
    ),
    "no name of a file with nodes": (["*NODE, INPUT, NSET=A"], r"line 1: '\*NODE, INPUT.*' names no file that can be"),
    "a ring": (["*INCLUDE,INPUT=blade.inp", "*NODE"], r"line 1: it includes 'blade.inp', which includes it"),
    "generated nodes": (["*NODE", "1,0,0,0", "9,1,0,0", "*NGEN", "1,9"], r"line 4: \*NGEN generates nodes, .* in full"),
    "copied nodes": ([*MESH, "*NCOPY,CHANGE NUMBER=100,OLD SET=NALL,SHIFT", "0,0,1"], r"\*NCOPY generates nodes"),
    "generated elements": ([*MESH, "*ELGEN,ELSET=EALL", "1,2,1,1"], r"line \d+: \*ELGEN generates elements"),
    "cylindrical": (["*NODE,SYSTEM=C", *MESH[1:]], r"line 1: \*NODE, SYSTEM=C: expected nodes in rectangular"),
    "a system": (["*SYSTEM", "1,0,0,0,1,0", *MESH], r"line 1: \*SYSTEM moves nodes"),
    "no such set": ([*MESH, "*NSET,NSET=NROOT", "FACE"], r"a set of nodes holds 'FACE', which is neither a number"),
    "two sets, elements first": (
        [*MESH, "*ELSET,ELSET=X", "1", "*NSET,NSET=X,ELSET=EALL"],
        r"line \d+: another set is called X",
    ),
    "no such instance": ([*WITHIN, "*NSET,NSET=X,INSTANCE=C-1", "1"], r"line \d+: no instance above is called C-1"),
    "a part's set without its instance": (
        [*WITHIN, "*NSET,NSET=X", "NROOT"],
        r"line \d+: a set of nodes holds 'NROOT', which is neither a number nor a set defined above",
    ),
    "two sets": ([*MESH, "*NSET,NSET=X,ELSET=EALL", "*ELSET,ELSET=X", "1"], r"line \d+: another set is called X"),
    "an element of its own": ([*MESH, "*ELEMENT,TYPE=C3D27", "9,1,2"], r"line \d+: elements C3D27 are not read"),
    **{
        f"cells {kind} beside": (deck(more=[f"*ELEMENT,TYPE={kind}", "9,1,2,3,4"]), f"line 37: elements {kind} are not")
        for kind in ("SC8R", "CSS8", "C3D8P", "AC3D20", "U1")
    },
    "no kind": (deck(more=["*ELEMENT", "9,1,2,3,4"]), "line 37: elements without a type are not read"),
    "a set without a name": ([*MESH, "*NSET", "1,2"], r"line 39: \*NSET without the name of a set"),
    "a step of nought": ([*MESH, "*NSET,NSET=A,GENERATE", "1,9,0"], "line 40: expected the first and the last number"),
    "numbers that fall": (
        [*MESH, "*NSET,NSET=A,GENERATE", "20,1,-1"],
        "40: expected .* not below it, .* not '20,1,-1'",
    ),
    "a last number below the first": ([*MESH, "*ELSET,ELSET=A,GENERATE", "2,1"], "line 40: expected .* not '2,1'$"),
    "a negative step": ([*MESH, "*NSET,NSET=A,GENERATE", "1,20,-1"], "line 40: expected .* not '1,20,-1'$"),
    "a mass on no instance": (
        [*WITHIN, "*ELEMENT,TYPE=MASS,ELSET=M", "1,C-1.32", "*NSET,NSET=A,ELSET=M"],
        r"line \d+: element 1 names node C-1.32 of no instance above",
    ),
    "no such set of elements": ([*MESH, "*ELSET,ELSET=A", "1,B"], "a set of elements holds 'B', which is neither a"),
    "without middles": ([*MESH[:-1], "0,0,0,0,0"], r"line \d+: element 2 names node 0, which is not"),
    "twice in place": (
        [line.format("") for line in (*PART[:-1], "*INSTANCE,NAME=B-2,PART=B", "1,0,0", "*END INSTANCE", PART[-1])],
        "the mesh is in 2 pieces",
    ),
    "cells of an assembly": (
        [*WITHIN, "*ELEMENT,TYPE=C3D8", "9,B-1.1,B-1.2,B-1.3,B-1.4,B-1.5,B-1.6,B-1.7,B-1.8"],
        r"line \d+: cells of an assembly are not read: put them into a part",
    ),
    "turned, not moved": (
        placed("0,0,0,0,0,1,90"),
        r"line \d+: an instance is placed by a line of three numbers \(0, 0",
    ),
    "turned about a point": (placed("0,0,0", "1,0,0,1,0,0,90"), "an instance is placed by .* not by '1,0,0,1,0,0,90'$"),
    "moved by a word": (placed("0,0,a"), "an instance is placed by .* not by '0,0,a'$"),
    "moved and turned thrice": (placed("0,0,0", ",,,,,1.,90.", "1"), "an instance is placed by .* not by '1'$"),
}


@pytest.mark.parametrize("part", [False, True])
def test_a_set_of_elements_gives_a_set_of_their_nodes(part, tmp_path):
    """By *NSET, ELSET, also in a part; the first element has 20 of the deck's 32 nodes."""
    path = tmp_path / "blade.inp"
    lines = [*MESH, *ROOT, "*ELSET,ELSET=FIRST", "1", "*NSET,NSET=INNER,ELSET=FIRST"]
    around = ["*PART,NAME=B"], ["*END PART", *(line.format("") for line in ASSEMBLY)]
    path.write_text("\n".join([*around[0], *lines, *around[1]] if part else lines) + "\n")
    np.testing.assert_array_equal(read_volume(path).sets["INNER"], np.sort(CELLS[0][1:]) - 1)


ALL = range(1, 33)
FIRST = sorted(int(node) for node in CELLS[0][1:])
SETS = {
    "a part's and the assembly's": (
        [*WITHIN, "*NSET,NSET=nroot,INSTANCE=B-1", "7,9", "*NSET,NSET=NROOT,INSTANCE=B-1", "11"],
        {"NROOT": [7, 9, 11], "B.NROOT": map(int, FACE)},
    ),
    "the assembly's of elements, the part's of nodes": (
        [*WITHIN, "*ELSET,ELSET=NROOT,INSTANCE=B-1", "1"],
        {"NROOT": FIRST, "B.NROOT": map(int, FACE)},
    ),
    "an instance's and the assembly's": (
        [*PART[:-3], "*NSET,NSET=Own", "3", ASSEMBLY[3], "*NSET,NSET=OWN,INSTANCE=B-1", "5"],
        {"OWN": [5], "B-1.OWN": [3], "NROOT": map(int, FACE)},
    ),
    "an instance's in one of the assembly": (
        [*WITHIN, "*NSET,NSET=X", "B-1.NROOT, b-1.20", "*NSET,NSET=Y", "X"],
        {"X": sorted({*map(int, FACE), 20}), "Y": sorted({*map(int, FACE), 20})},
    ),
    "a set of a part in one of its instance": (
        [*WITHIN, "*NSET,NSET=X,INSTANCE=B-1", "NROOT,20", "*NSET,NSET=Y,INSTANCE=B-1,ELSET=EALL"],
        {"X": sorted({*map(int, FACE), 20}), "Y": ALL},
    ),
    "a set of an instance, generated": (
        [*WITHIN, "*NSET,NSET=X,INSTANCE=B-1,GENERATE", "1,9,4", "*NSET,NSET=Y,INSTANCE=B-1", "X"],
        {"X": [1, 5, 9], "Y": [1, 5, 9]},
    ),
    "elements of an instance": (
        [*WITHIN, "*ELSET,ELSET=E,INSTANCE=B-1", "1", "*NSET,NSET=X,ELSET=E", "*NSET,NSET=Y,ELSET=B-1.EALL"],
        {"X": FIRST, "Y": ALL},
    ),
    "a set by elements in a set": (
        [*MESH, "*ELSET,ELSET=E", "1", "*NSET,NSET=X,ELSET=E", "*NSET,NSET=Y", "X,32"],
        {"X": FIRST, "Y": sorted({*FIRST, 32})},
    ),
    "elements added to nodes": (
        [*MESH, *ROOT, "*ELSET,ELSET=E", "1", "*NSET,NSET=X", "32", "*NSET,NSET=X,ELSET=E"],
        {"X": sorted({*FIRST, 32})},
    ),
    "elements added to elements": (
        [*MESH, "*ELSET,ELSET=A", "1", "*ELSET,ELSET=B", "2", "*NSET,NSET=X,ELSET=A", "*NSET,NSET=X,ELSET=B"],
        {"X": ALL},
    ),
    "a mass and an element": (
        [*MESH, "*ELEMENT,TYPE=MASS,ELSET=M", "900,32", "*ELSET,ELSET=MM", "1,M", "*NSET,NSET=TIP,ELSET=MM"],
        {"TIP": sorted({*FIRST, 32})},
    ),
    "a mass alone, a spring": (
        [
            *(*MESH, "*ELEMENT,TYPE=MASS,ELSET=M", "900,32", "*NSET,NSET=TIP,ELSET=M"),
            *("*ELEMENT,TYPE=SPRINGA,ELSET=S", "901,3,4", "*NSET,NSET=X,ELSET=S", "*NSET,NSET=Y", "X,TIP"),
        ],
        {"TIP": [32], "X": [3, 4], "Y": [3, 4, 32]},
    ),
    "a mass of a part, and one of the assembly": (
        [
            *(*PART[:-7], "*ELEMENT,TYPE=MASS,ELSET=M", "900,32", *PART[-7:-3], ASSEMBLY[3]),
            *("*NSET,NSET=X,ELSET=B-1.M", "*ELEMENT,TYPE=MASS,ELSET=M", "1,b-1.31", "*NSET,NSET=Y,ELSET=M"),
        ],
        {"X": [32], "Y": [31]},
    ),
    "nodes and elements of one name": (
        [
            *(*MESH, "*ELSET,ELSET=A", "1", "*NSET,NSET=a,ELSET=A", "*NSET,NSET=X", "A,32"),
            *("*ELEMENT,TYPE=MASS,ELSET=M", "900,32", "*NSET,NSET=M,ELSET=M", "*NSET,NSET=Y", "M"),
        ],
        {"A": FIRST, "X": sorted({*FIRST, 32}), "M": [32], "Y": [32]},
    ),
    "nodes of a part's elements of the same name": (
        [*WITHIN, "*NSET,NSET=EALL,ELSET=EALL,INSTANCE=B-1", "*NSET,NSET=X", "EALL"],
        {"EALL": ALL, "X": ALL},
    ),
    "an instance's set in quotes": (
        [*PART[:-7], '*NSET,NSET="my set"', "1,2", *PART[-7:-3], ASSEMBLY[3], "*NSET,NSET=X", 'B-1."my set",B-1.4'],
        {"X": [1, 2, 4]},
    ),
    "words on lines of their own": (
        [
            *MESH,
            "*NSET, NSET=G,",
            "GENERATE",
            "1,9,4",
            "*NSET, NSET=H, UNSORTED,",
            "INTERNAL",
            "9,1",
            "*NSET,NSET=I,",
            "2",
        ],
        {"G": [1, 5, 9], "H": [1, 9], "I": [2]},
    ),
    "a name with a comma": (
        [*MESH, '*NSET,NSET="a,b=c"', "1,2", '*NSET,NSET="a,d"', "3", "*NSET,NSET=X", '"a,b=c",4'],
        {"a,b=c": [1, 2], "a,d": [3], "X": [1, 2, 4]},
    ),
    "a number as a name": ([*MESH, '*NSET,NSET="12"', "1,2", "*NSET,NSET=X", '"12",4'], {"12": [1, 2], "X": [1, 2, 4]}),
    "a part's name with a comma": (
        [line.replace("=B-1", '="B,1"').replace("=B", '="B,x"', "PART" in line) for line in WITHIN],
        {"NROOT": map(int, FACE)},
    ),
}


@pytest.mark.parametrize("case", SETS)
def test_sets_are_those_of_the_deck(case, tmp_path):
    """Those of an assembly and of its parts were merged; others were refused, or left out."""
    lines, expected = SETS[case]
    path = tmp_path / "blade.inp"
    path.write_text(
        "\n".join([*(line.format("") for line in lines), *ASSEMBLY[-1:] * ("*PART,NAME=B" in lines)]) + "\n"
    )
    mesh = read_volume(path)
    for name, numbers in expected.items():
        np.testing.assert_array_equal(mesh.labels[mesh.sets[name]], list(numbers), err_msg=name)
    assert len({name.upper() for name in mesh.sets}) == len(mesh.sets)


@pytest.mark.parametrize(
    ("more", "held"), [([], ["NROOT", "NALL"]), (["*NSET,NSET=NROOT,INSTANCE=B-1", "7"], ["B.NROOT", "NALL"])]
)
def test_a_support_on_an_instances_set_is_on_that_of_its_part(more, held, tmp_path):
    path = tmp_path / "blade.inp"
    lines = [*WITHIN, *more, ASSEMBLY[-1], "*STEP", "*BOUNDARY", "B-1.NROOT,1,3", "b-1.NALL,3", "*END STEP"]
    path.write_text("\n".join(line.format("") for line in lines) + "\n")
    assert sorted(read_volume(path).deck.held) == sorted(held)


def test_elements_that_are_removed_are_not_passed_over(tmp_path):
    path = tmp_path / "blade.inp"
    steps = ["*STEP", "*MODEL CHANGE, TYPE=ELEMENT, REMOVE", "2", "*Model change, remove", "2"]
    steps += ["*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", "A,B", "*MODEL CHANGE, ADD=STRAIN FREE", "2", "*END STEP"]
    path.write_text("\n".join([*MESH, *ROOT, *steps]) + "\n")
    assert read_volume(path).deck.unused() == {"MODEL CHANGE, REMOVE": 2}


@pytest.mark.parametrize("case", REFUSED)
def test_what_would_be_misread_is_one_line(case, tmp_path):
    given, problem = REFUSED[case]
    path = tmp_path / "blade.inp"
    path.write_text(given if isinstance(given, str) else "\n".join(given).replace("{}", "") + "\n")
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
    is_read(path, mesh, kind)


def is_read(path, mesh, kind):
    """The file has the cells of the mesh, of one kind."""
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
    with pytest.raises(MeshError, match=r"line 71: CTETRA 12 has 8 nodes, expected 4 or 10"):
        read_volume(path)


@pytest.mark.parametrize("kind", ORDER)
def test_second_order_cells_of_meshio_are_read(kind, tmp_path):
    """They are called CHEXA_ and the like there, and were refused."""
    mesh, path = box(kind, (2, 1, 1), (0.2, 0.04, 0.02)), tmp_path / "blade.bdf"
    meshlane.write(path, meshlane.Mesh(mesh.points, list(mesh.cells)))
    assert f"{ORDER[kind][0]}_" in path.read_text()
    is_read(path, mesh, kind)


def test_nastran_has_exponents_of_fortran_and_blanks_within_begin_bulk(tmp_path):
    """Both were refused."""
    mesh, lines = bulk("tetra10", "free")
    lines[2:4] = "begin  bulk", "GRID,1,,0.0D-3,-0.d0,0.+0"
    path = tmp_path / "blade.bdf"
    path.write_text("\n".join(lines) + "\n")
    np.testing.assert_allclose(read_volume(path).points, mesh.points, atol=1e-9)


INCLUDES = {
    "quotes": ["INCLUDE 'all nodes.bdf'"],
    "a leading blank": ["  include 'all nodes.bdf'"],
    "no blank": ["INCLUDE'all nodes.bdf'"],
    "an equals sign": ["INCLUDE=nodes.bdf"],
    "blanks around it": ['INCLUDE = "all nodes.bdf"'],
    "a comment": ["INCLUDE 'all nodes.bdf' $ it's the mesh", "$ INCLUDE 'none.bdf'"],
    "a comment after a bare name": ["INCLUDE nodes.bdf $ 'mesh'"],
    "two lines": ["INCLUDE 'all nod", "        es.bdf'"],
}


@pytest.mark.parametrize("case", INCLUDES)
def test_nastran_and_optistruct_include_files_in_many_ways(case, tmp_path):
    """They were dropped but for one way, and half of a blade with them."""
    mesh, lines = bulk("tetra10", "blanks")
    nodes = [line for line in lines if line.startswith("GRID")]
    for name in ("nodes.bdf", "all nodes.bdf"):
        (tmp_path / name).write_text("\n".join(nodes) + "\n")
    path = tmp_path / "blade.fem"
    path.write_text("\n".join([*lines[:3], *INCLUDES[case], *lines[3 + len(nodes) :]]) + "\n")
    np.testing.assert_allclose(read_volume(path).points, mesh.points, atol=1e-9)
    assert len(files_of(path)) == 2


@pytest.mark.parametrize(
    ("cards", "held"),
    [
        (["SPC1,1,3,5,THRU,9", "SPC1,1,3,4,THRU,6", "SPC1,1,3,8,THRU,7", "SPC1,1,3,2"], [2, 4, 5, 6, 7, 8, 9]),
        (
            ["SPC1,1,3,5,THRU,5", "SPC1,1,3,1,THRU,2", "SPC1,1,4,20,THRU,22", "SPC1,1,3,40,THRU,999"],
            [1, 2, 5, *range(40, 46)],
        ),
        (["SPC1,1,3,1,THRU,45", "SPC1,1,3,7,THRU,9", "SPC1,1,3,9,THRU,70"], range(1, 46)),
    ],
)
def test_supports_of_ranges_of_nodes(cards, held, tmp_path):
    path, (_, lines) = tmp_path / "blade.bdf", bulk("tetra10", "free")
    path.write_text("\n".join([*lines[:-1], *cards, "ENDDATA"]) + "\n")
    assert sorted(map(int, read_volume(path).deck.held)) == list(held)


def test_many_ranges_and_long_lines_take_no_time(tmp_path):
    """Each range was sought in all labels, each blank of a line with a file's name in all that follow."""
    path = tmp_path / "blade.bdf"
    nodes = [f"GRID,{n},,0.,0.,0." for n in range(1, 40001)]
    path.write_text(
        "\n".join(["BEGIN BULK", *nodes, *(f"SPC1,1,3,{n},THRU,40000" for n in range(1, 10001)), "ENDDATA"])
    )
    begun = time.process_time()
    assert len(plain(path)[1].held) == 40000
    for name in ("a" + " " * 50000, "a " * 25000):
        path.write_text(f'BEGIN BULK\nINCLUDE {name}"\n')
        with pytest.raises(MeshError, match=r"line 2: .* names no file"):
            plain(path)
    assert time.process_time() - begun < 4.0


@pytest.mark.parametrize(
    "line", ["INCLUDE", "INCLUDE 'nodes.bdf", "INCLUDE 'nodes.bdf' 'more.bdf'", "INCLUDEnodes.bdf"]
)
def test_a_line_of_nastran_that_includes_no_file_is_refused(line, tmp_path):
    path, (_, lines) = tmp_path / "blade.bdf", bulk("tetra10", "blanks")
    path.write_text("\n".join([*lines[:3], line, *lines[3:]]) + "\n")
    with pytest.raises(MeshError, match=r"line 4: .INCLUDE.* names no file that can be read: expected INCLUDE 'file'"):
        read_volume(path)


def test_an_included_file_is_that_of_the_main_decks_folder(tmp_path):
    """As for CalculiX and Abaqus, also from files of other folders; only what is not there is one beside these."""
    (tmp_path / "sub").mkdir()
    path = tmp_path / "blade.inp"
    path.write_text("\n".join(["*INCLUDE, INPUT=sub/all.inc", *MESH[len(NODES) + 1 :], *ROOT]) + "\n")
    (tmp_path / "sub" / "all.inc").write_text("*INCLUDE, INPUT=nodes.inc\n")
    for folder, factor in ((tmp_path / "sub", 2.0), (tmp_path, 1.0)):
        (folder / "nodes.inc").write_text("\n".join(["*NODE", *scaled(factor)]) + "\n")
        assert read_volume(path).size == pytest.approx(0.2 * factor)
        assert files_of(path) == [path, tmp_path / "sub" / "all.inc", folder / "nodes.inc"]


def test_nastran_in_fields_of_16_columns_and_what_is_no_cell(tmp_path):
    mesh, lines = bulk("hexahedron20", "free")
    wide = []
    for line in lines[3:-1]:
        if line.startswith("GRID"):
            wide += [f"GRID*   {line[8:16]:>16}{'':16}{line[24:32]:>16}{line[32:40]:>16}", f"*       {line[40:48]:>16}"]
        else:
            own = line.split(",")[1:]
            first = "CHEXA*" if line.startswith("CHEXA") else "*"
            for k in range(0, len(own), 4):
                wide.append(f"{first if k == 0 else '*':<8}" + "".join(f"{each:>16}" for each in own[k : k + 4]))
    wide[:2] = ["GRID*,1,,0.,0.,*A", "*A,0."]
    path = tmp_path / "blade.bdf"
    path.write_text("\n".join([*lines[:3], *wide, "CONM2,90,1,,0.05", "CQUAD4,91,1,1,2,3,4,0.5", "ENDDATA"]) + "\n")
    found = read_volume(path)
    np.testing.assert_allclose(found.points[found.cells[0][1]], mesh.points[mesh.cells[0][1]], atol=1e-9)
    refused = {
        "CHEXA1,99,1,1,2,3,4,5,6\n,7,8": "line 80: CHEXA1 is not read: use CHEXA, CPENTA or CTETRA",
        "GRDSET,,7": "line 80: GRDSET has nodes lie in coordinate system 7: expected nodes in the basic one",
        "CQUAD8,99,1,1,2,3,4,5,6\n,7": "line 80: CQUAD8 99 has 7 nodes, expected 8",
    }
    for card, problem in refused.items():
        path.write_text("\n".join([*lines[:3], *wide, card, "ENDDATA"]) + "\n")
        with pytest.raises(MeshError, match=problem):
            read_volume(path)


def test_cards_of_16_columns_may_lack_their_second_line(tmp_path):
    """They ended with an internal error, nodes with two coordinates."""
    mesh, lines = bulk("tetra10", "free")
    lines[3] = f"GRID*   {1:>16}{'':16}{'0.':>16}{'0.':>16}"
    cards = [f"MAT1*   {1:>16}{'2.1+11':>16}{'':16}{'.3':>16}", "MAT1*,2,2.1+11,,.3", "PSOLID*,1,1"]
    cards += [f"SPC*    {1:>16}{1:>16}{123:>16}{'0.':>16}", "SPC1*,1,123,2,3", "SPC*,1,4,3"]
    path = tmp_path / "blade.bdf"
    path.write_text("\n".join([*lines[:-1], *cards, "ENDDATA"]) + "\n")
    found = read_volume(path)
    np.testing.assert_allclose(found.points, mesh.points, atol=1e-9)
    assert found.deck.materials == {"1": [2.1e11, 0.3, None], "2": [2.1e11, 0.3, None]}
    assert list(found.deck.held) == ["1", "2", "3", "4"]


def gmsh(mesh, labels, grouped):
    """A box of tetrahedra in Gmsh's format 4.1, its faces at the ends in x two surfaces: the first is the root.

    grouped: whether the other surface is in a physical group, too.
    """
    (faces,), x = mesh.boundary(), mesh.points[:, 0]
    ends = [faces[(x[faces] == end).all(axis=1)] for end in (x.min(), x.max())]
    blocks = [(2, n, 9, np.hstack([face[:, ::2], face[:, 1::2]])) for n, face in enumerate(ends, 1)]
    blocks.append((3, 1, 11, mesh.cells[0][1][:, [*range(8), 9, 8]]))
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", "2", '2 7 "NROOT"', '3 8 "V"']
    lines += ["$EndPhysicalNames", "$Entities", "1 0 2 1", "1 0 0 0 0", "1 0 0 0 0 1 1 1 7 2 -99 98"]
    lines += [f"2 1 0 0 1 1 1 {'1 9' if grouped else 0} 1 97", "1 0 0 0 1 1 1 1 8 2 1 2", "$EndEntities"]
    count = len(labels)
    lines += ["$Nodes", f"1 {count} {labels.min()} {labels.max()}", f"3 1 0 {count}", *map(str, labels)]
    lines += [*(" ".join(map(repr, point)) for point in mesh.points.tolist()), "$EndNodes", "$Elements"]
    lines += [f"3 {sum(len(nodes) for *_, nodes in blocks)} 1 999"]
    for dimension, entity, kind, nodes in blocks:
        lines.append(f"{dimension} {entity} {kind} {len(nodes)}")
        lines += [" ".join(map(str, (number, *labels[own]))) for number, own in enumerate(nodes, 1)]
    return "\n".join([*lines, "$EndElements"]) + "\n"


@pytest.mark.parametrize("grouped", [True, False])
def test_gmsh_saves_a_root_and_all_elements(grouped, tmp_path):
    """With curves around surfaces that have higher numbers than there are cells; or surfaces in no group."""
    mesh, path = box("tetra10", (2, 1, 1), (0.2, 0.04, 0.02)), tmp_path / "blade.msh"
    labels = np.random.default_rng(0).permutation(len(mesh.points)) * 3 + 5
    path.write_text(gmsh(mesh, labels, grouped))
    found = read_volume(path)
    np.testing.assert_array_equal(found.sets["NROOT"], np.flatnonzero(mesh.points[:, 0] == 0.0))
    np.testing.assert_array_equal(found.sets["V"], np.arange(len(mesh.points)))
    np.testing.assert_array_equal(found.labels, labels)
    np.testing.assert_array_equal(found.points, mesh.points)


def numbered(kind, path):
    """A mesh file of a kind, and the number that it gives the node at each of its places."""
    mesh = box("tetra10", (2, 1, 1), (0.2, 0.04, 0.02))
    labels, every = 1000 - 7 * np.arange(len(mesh.points)), [point.tolist() for point in mesh.points]
    places = [*zip(labels.tolist(), every, strict=True), (1001, [9.0, 9.0, 9.0])]  # the last is of no cell
    if kind == "gmsh":
        path.write_text(gmsh(mesh, labels, grouped=False))
    elif kind == "gmsh, format 2":
        nodes = [f"{label} {' '.join(map(repr, at))}" for label, at in places]
        cells = [f"{n} 11 2 0 1 {' '.join(map(str, labels[own[[*range(8), 9, 8]]]))}" for n, own in cells_of(mesh)]
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(nodes)), *nodes, "$EndNodes"]
        path.write_text("\n".join([*lines, "$Elements", str(len(cells)), *cells, "$EndElements"]) + "\n")
    elif kind == "nastran":
        nodes = [f"GRID,{label},,{','.join(map(repr, at))}" for label, at in places]
        cells = [[str(n), "1", *map(str, labels[own])] for n, own in cells_of(mesh)]
        lines = [f"CTETRA,{','.join(own[:8])}\n,{','.join(own[8:])}" for own in cells]
        path.write_text("\n".join(["BEGIN BULK", *nodes, *lines, "ENDDATA"]) + "\n")
    elif kind == "ansys":
        meshlane.write(
            path, meshlane.Mesh(np.vstack([[9.0, 9.0, 9.0], mesh.points]), [("tetra10", mesh.cells[0][1] + 1)])
        )
        labels = np.arange(2, len(mesh.points) + 2)
    else:
        nodes = [f"{label},{','.join(map(repr, at))}" for label, at in places[::-1]]
        cells = [f"{n},{','.join(map(str, labels[own]))}" for n, own in cells_of(mesh)]
        lines = ["*NODE", *nodes, "*ELEMENT,TYPE=C3D10", *cells]
        if kind == "instance":
            lines = ["*PART,NAME=B", *lines, "*END PART", *(line.format("") for line in ASSEMBLY)]
            lines.insert(-1, "*NODE\n1000,8,8,8")  # a point of reference
        path.write_text("\n".join(lines) + "\n")
    return dict(zip(labels.tolist(), every, strict=True))


def cells_of(mesh):
    return enumerate(mesh.cells[0][1], 1)


KINDS = {"deck": "inp", "instance": "inp", "nastran": "bdf", "gmsh": "msh", "gmsh, format 2": "msh", "ansys": "cdb"}


@pytest.mark.parametrize("kind", KINDS)
def test_nodes_keep_the_numbers_of_their_file(kind, tmp_path):
    path = tmp_path / f"blade.{KINDS[kind]}"
    at = numbered(kind, path)
    mesh = read_volume(path)
    np.testing.assert_allclose([at[label] for label in mesh.labels.tolist()], mesh.points, atol=1e-12)
