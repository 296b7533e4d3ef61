"""Mid-surface meshes from files, through meshlane: Gmsh .msh, VTU, Abaqus .inp, Nastran .bdf and the rest.

Straight-sided cells are used: of second-order cells the corners are taken. One kind of cell a mesh: where a
file mixes triangles and quadrilaterals, the quadrilaterals are split.

Meshlane is a maintained continuation of meshio: it knows the second-order wedges (Abaqus C3D15, CalculiX) that meshio
stumbles over, and keeps sets of nodes and cells.

`raw_mesh` serves volume meshes too. Decks of Abaqus, CalculiX and Nastran are brought into the plain form that readers
take: included files are put in their place, sets of nodes that name others get these nodes, and solid elements the name
of their family. What would generate or move nodes is refused: readers pass over it and are left with another mesh.
"""

import contextlib
import io
import math
import re
import tempfile
import xml.etree.ElementTree as ElementTree
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fem.linalg import Array, Ints
from fem.meshes.planform import MeshError, check_mesh, root, root_facets, twice_areas

Lines = Iterator[tuple[str, str]]

TRIANGLES = ("triangle", "triangle6", "triangle7")
QUADS = ("quad", "quad8", "quad9")
IGNORED = ("vertex", "line", "line3")
FLATNESS = 1e-6
"""Largest departure from a plane of constant z, relative to the size of the mesh."""


NASTRAN = (".bdf", ".nas", ".fem")
"""Endings of Nastran's files."""


class FieldError(ValueError):
    """Point data of a mesh file that is not what is asked for; the message says why."""


def read_mesh(path: str | Path) -> Any:
    """Read the mesh of a file; see `read_field`, of which this is the first part."""
    return read_field(path, None)[0]


def read_field(path: str | Path, field: str | None) -> tuple[Any, Array | None]:
    """Read the `skfem.MeshQuad` or `skfem.MeshTri` of a file, in m, with x radial and y across, and a field on it.

    field: name of point data with one number a point; these (npoint,) come with the mesh.

    Coordinates are kept, but points of the root that lie off its line by rounding are laid on it, so that a refined
    mesh is clamped along the same edge. The plate is clamped at its smallest x, wherever that is: there a rotor's
    hub_radius ends.

    Raises:
        MeshError: with the file's name, for a file that cannot be read, that holds no surface, or whose surface is not
            flat, not upright, not in one piece or without a straight root edge.
        FieldError: for a field that is not there, or has not one finite number a point.
    """
    path = Path(path)
    with named(path):
        raw = raw_mesh(path)
        mesh, points = surface_of(raw)
    return mesh, None if field is None else _values(raw, field, points)


@contextlib.contextmanager
def named(path: Path) -> Iterator[None]:
    """Put a file's name before what is wrong with its mesh, and see that it is there.

    Raises:
        MeshError: there is no such file, or what was raised within.
    """
    try:
        if not path.is_file():
            raise MeshError("no such mesh file")
        yield
    except MeshError as error:
        raise type(error)(f"{path}: {error}") from None


def _values(raw: Any, field: str, points: Ints) -> Array:
    """Values of point data at some of the file's points."""
    if field not in raw.point_data:
        known = ", ".join(sorted(raw.point_data)) or "none"
        raise FieldError(f"the mesh file has no point data {field!r}: it has {known}")
    values = np.asarray(raw.point_data[field])
    if values.size != len(raw.points) or values.dtype.kind not in "fiu":
        raise FieldError(f"point data {field!r} is of shape {values.shape}: expected one number for each point")
    floats = values.reshape(-1).astype(float)[points]
    if not np.isfinite(floats).all():
        raise FieldError(f"point data {field!r} has values that are not finite")
    return floats


def raw_mesh(path: Path) -> Any:
    """What meshlane reads of a file, whose words it keeps for itself.

    Raises:
        MeshError: it cannot be read.
    """
    import meshlane

    output = io.StringIO()
    try:
        _check_kind(path)
        _check_named_files(path)
        with _plain(path) as deck, contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            return meshlane.read(deck)
    except MeshError:
        raise
    except SystemExit:
        lines = [
            line for line in output.getvalue().splitlines() if not line.startswith(("No MAPDL", "Error: Couldn't"))
        ]
        why = lines[0].strip() if lines and " id" in lines[0] else _DAMAGED
        raise MeshError(deck_fault(path) or f"not a mesh file that meshlane can read ({why})") from None
    except meshlane.ReadError as error:
        raise MeshError(f"not a readable mesh file ({' '.join(str(error).split()) or 'damaged'})") from None
    except ImportError as error:
        raise MeshError(f"to read this format, the Python package {error.name} must be installed") from None
    except Exception as error:  # what readers stumble over, said in terms of their own code
        why = f"not a readable mesh file: {_DAMAGED} ({type(error).__name__})"
        raise MeshError(deck_fault(path) or why) from None


def deck_fault(path: Path) -> str:
    """What is wrong with the numbers of a deck of Abaqus that cannot be used, by line; empty: nothing that is seen."""
    nodes: dict[int, str] = {}
    named: list[tuple[str, int, str]] = []
    lines, first = Counter[int](), dict[int, str]()  # by how many coordinates they have
    key, carried = "", False
    for where, line in _cards(path) if path.suffix.lower() == ".inp" else ():
        if line.lstrip().startswith("*"):
            key, options = _keyword(line)
            if key in ("PART", "END PART", "INSTANCE", "END INSTANCE"):  # which number their own nodes
                if fault := _unknown(named, nodes):
                    return fault
                nodes, named = {}, []
            owner = "" if key == "ELEMENT" else f"set {options.get('NSET')}"
            key, carried = "" if options.keys() & {"GENERATE", "INSTANCE"} else key, False
            continue
        values = [value.strip() for value in line.strip().rstrip(",").split(",")]
        if key == "NODE":
            try:
                number, place = int(values[0]), [float(value) for value in values[1:]]
            except ValueError:
                return f"{where}: expected a node's number and its coordinates, not {line.strip()!r}"
            if len(place) > 3 and "." not in line:
                return f"{where}: node {number} has {len(place)} coordinates, not 3: are commas decimal signs?"
            lines[len(place)] += 1
            first.setdefault(len(place), f"{where}: node {number}")
            if number < 1:
                return f"{where}: node {number}: expected a number above 0"
            if number in nodes:
                return f"{where}: node {number} is listed twice, first in {nodes[number]}"
            if not all(map(math.isfinite, place)):
                return f"{where}: node {number} has coordinates that are not finite"
            nodes[number] = where
        elif key in ("ELEMENT", "NSET"):
            numbers = [int(value) for value in values if value.isdigit()]
            if key == "ELEMENT" and not carried:
                owner, numbers = f"element {values[0]}", numbers[1:]
            carried = line.rstrip().endswith(",")
            named += [(where, number, owner) for number in numbers]
    if len(lines) > 1:
        odd, *_, usual = sorted(lines, key=lambda count: lines[count])
        comma = ": are commas decimal signs?" if odd > usual else ""
        return f"{first[odd]} has {odd} coordinate{'s' * (odd != 1)}, not {usual}{comma}"
    return _unknown(named, nodes)


def _unknown(named: list[tuple[str, int, str]], nodes: Mapping[int, str]) -> str:
    """The first node that an element or a set names and that there is not."""
    for where, number, owner in named:
        if nodes and number not in nodes:
            return f"{where}: {owner} names node {number}, which is not in the file"
    return ""


_DAMAGED = "damaged or truncated, or its cells lack some of their nodes"

GEOMETRY = {".step": "STEP", ".stp": "STEP", ".iges": "IGES", ".igs": "IGES", ".brep": "BREP"}
"""Geometry that is to be meshed, by the ending of its files."""

_BULK = b"BEGIN BULK"


def _check_kind(path: Path) -> None:
    """Refuse geometry without a mesh, and a part of a Nastran file that readers would search to its end."""
    kind = GEOMETRY.get(path.suffix.lower())
    if path.suffix.lower() in (".html", ".htm"):
        raise MeshError("a page, not a mesh: open it in a browser")
    if kind is not None:
        raise MeshError(f"{kind} is geometry without a mesh: mesh the mid-surface, or the volume (with Gmsh, say)")
    if path.name.lower().endswith((".frd", ".frd.gz", ".npz", ".op2", ".rst")):
        raise MeshError("a file of modes or results, not a mesh: use it in a scene as [structure] modes = 'blade.frd'")
    if path.suffix.lower() in NASTRAN and _BULK not in path.read_bytes().upper():
        raise MeshError("a Nastran file without BEGIN BULK: put that line above the GRID lines, ENDDATA below")


def _named_files(path: Path) -> list[Path]:
    """The files beside a mesh file that hold its numbers.

    XDMF names binary files by their path, HDF5 files by that from its own folder; TetGen's two files lie side by side.
    """
    named: list[Path] = []
    if path.suffix.lower() in (".xdmf", ".xmf"):
        for item in ElementTree.parse(path).iter("DataItem"):
            text = (item.text or "").strip()
            if item.get("Format") == "Binary":
                named.append(Path(text))
            elif item.get("Format") == "HDF":
                named.append(path.resolve().parent / text.partition(":")[0])
    elif path.suffix.lower() in (".node", ".ele"):
        named = [path.with_suffix(suffix) for suffix in (".node", ".ele")]
    return named


def _check_named_files(path: Path) -> None:
    """See that what a mesh file names are files: a pipe or a device could be read for ever."""
    for other in _named_files(path):
        if not other.is_file():
            raise MeshError(f"it names {other.name!r}, which is not a file: expected one with the mesh's numbers")


def surface_of(raw: Any) -> tuple[Any, Ints]:
    """The mesh of what `raw_mesh` gives of a file, and which of its points it has; see `read_field`."""
    from skfem import MeshQuad, MeshTri

    kinds = {block.type for block in raw.cells}
    others = ", ".join(sorted(kinds - set(TRIANGLES + QUADS + IGNORED)))
    if others:
        raise MeshError(
            f"a plate needs a mesh of its mid-surface, but the file has {others}: mesh the surface at mid-thickness"
            " with triangles or quadrilaterals, or name the volume's mesh as [blade] mesh"
        )
    triangles = _cells(raw, TRIANGLES, 3)
    quads = _cells(raw, QUADS, 4)
    if not len(triangles) and not len(quads):
        raise MeshError("the file has no triangles and no quadrilaterals")
    split = [triangles, quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]
    cells = np.vstack(split) if len(triangles) else quads
    if cells.min() < 0 or cells.max() >= len(raw.points):
        raise MeshError("a cell refers to a point that is not in the file")
    used, renumbered = np.unique(cells, return_inverse=True)
    points = np.asarray(raw.points, dtype=float)[used]
    if not np.isfinite(points).all():
        raise MeshError("the mesh has points with coordinates that are not finite")
    points = _flat(points)
    cells = _oriented(points, renumbered.reshape(cells.shape))
    kind = MeshTri if cells.shape[1] == 3 else MeshQuad
    mesh = kind(np.ascontiguousarray(points.T), np.ascontiguousarray(cells.T))
    check_mesh(mesh)
    clamped = np.unique(mesh.facets[:, root_facets(mesh)])
    if np.ptp(mesh.p[0, clamped]) > 0.0:
        points = mesh.p.copy()
        points[0, clamped] = root(mesh)
        mesh = kind(points, mesh.t)
    return mesh, used


def _flat(points: Array) -> Array:
    if points.shape[1] == 3 and points.size and np.ptp(points[:, 2]) > FLATNESS * np.ptp(points, axis=0).max():
        raise MeshError(
            f"the mid-surface must lie in a plane of constant z, but z runs over {np.ptp(points[:, 2]):.6g}:"
            " a twisted or cambered blade is a solid: name a mesh of its volume as [blade] mesh"
        )
    return points[:, :2]


def _cells(raw: Any, kinds: tuple[str, ...], corners: int) -> Ints:
    blocks = [block.data[:, :corners] for block in raw.cells if block.type in kinds]
    return np.vstack(blocks).astype(np.int64) if blocks else np.empty((0, corners), dtype=np.int64)


def _oriented(points: Array, cells: Ints) -> Ints:
    """Cells counter-clockwise: those that are clockwise are turned; `check_mesh` sees the flat ones."""
    area = twice_areas(points[cells].transpose(2, 1, 0))
    return np.where(area[:, None] > 0.0, cells, cells[:, ::-1])


_DATA = re.compile(
    r"\s*(?P<keyword>\*(?:INCLUDE|NODE|ELEMENT|NSET|ELSET))\b.*?(?P<option>,\s*INPUT\s*=(?P<file>[^,]+))", re.IGNORECASE
)
_INCLUDE = re.compile(r"(?P<keyword>INCLUDE)\s+(?P<file>.+)", re.IGNORECASE)
"""Lines that name a file with data."""

_IN_FULL = "write the mesh in full, as cgx does by `send all abq` and Abaqus/CAE into its job's file"

_REFUSED = {
    **dict.fromkeys(("NGEN", "NFILL", "NCOPY", "NMAP"), "generates nodes"),
    **dict.fromkeys(("ELGEN", "ELCOPY"), "generates elements"),
    "SYSTEM": "moves nodes",
}
"""Keywords of Abaqus and CalculiX that readers pass over, and what each does."""

_SOLID = re.compile(r"C3D(4|6|8|10|15|20)[HIMRST]*", re.IGNORECASE)


@contextlib.contextmanager
def _plain(path: Path) -> Iterator[Path]:
    """A file as readers take it: a deck in plain form in a file of its own, any other file itself.

    Raises:
        MeshError: it names a file that is not there, or holds what would be read wrongly; file and line are named.
    """
    suffix, lines = path.suffix.lower(), None
    if suffix == ".inp" and re.search(rb"(?i)\*(node|include)\b", path.read_bytes()):
        lines = _abaqus(_cards(path))
    elif suffix in NASTRAN:
        lines = _nastran(_included(path, _INCLUDE))
    if lines is None:
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / f"deck{suffix}"
        copy.write_text("\n".join(lines) + "\n", encoding="utf-8")
        yield copy


def files_of(path: Path) -> list[Path]:
    """A mesh file, and those that there are of the files that it names with parts of its mesh."""
    suffix, found = path.suffix.lower(), [path]
    if suffix != ".inp" and suffix not in NASTRAN:
        with contextlib.suppress(ElementTree.ParseError):  # which is said where it is read
            found += _named_files(path) if path.is_file() else []
        return found
    names, seen = _DATA if suffix == ".inp" else _INCLUDE, {path.resolve()}
    for each in found:  # which grows on the way
        raw = each.read_bytes() if each.is_file() else b""
        lines = _text(raw).splitlines() if re.search(rb"(?i)include|input", raw) else []
        for named in filter(None, map(names.match, lines)):
            other = each.parent / _name(named)
            if other.is_file() and other.resolve() not in seen:
                seen.add(other.resolve())
                found.append(other)
    return found


def _text(raw: bytes) -> str:
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def _name(named: re.Match[str]) -> str:
    return named["file"].strip(" '\"")


def _included(path: Path, names: re.Pattern[str], outer: tuple[Path, ...] = ()) -> Lines:
    """Lines of a deck and of the files that its lines name, each with where it stands."""
    for number, line in enumerate(_text(path.read_bytes()).splitlines(), 1):
        where = f"{path.name}, line {number}" if outer else f"line {number}"
        named = names.match(line)
        if named is None:
            yield where, line
            continue
        if not named["keyword"].upper().endswith("INCLUDE"):
            yield where, line.replace(named["option"], "")
        other = path.parent / _name(named)
        if not other.is_file() or other.resolve() in {each.resolve() for each in (*outer, path)}:
            why = "which includes it" if other.is_file() else "which is not a file"
            raise MeshError(f"{where}: it includes {named['file'].strip()!r}, {why}")
        yield from _included(other, names, (*outer, path))


def _cards(path: Path) -> Lines:
    """Lines of a deck of Abaqus, those of included files too, but for comments and blank ones."""
    return ((where, line) for where, line in _included(path, _DATA) if line.strip() and not line.startswith("**"))


def _abaqus(lines: Lines) -> Iterator[str]:
    sets: dict[str, list[str]] = {}
    on_nodes: dict[str, str] = {}  # sets that *NODE names, as it spells them: readers do not know them
    here: set[str] = set()
    elsets: set[str] = set()
    of_cells: set[str] = set()
    own: list[str] | None = None
    nodes, generates = False, False
    for where, line in lines:
        if line.lstrip().startswith("*"):
            key, options = _keyword(line)
            _refuse(where, key, options)
            if key.rpartition(" ")[2] in ("PART", "INSTANCE", "ASSEMBLY"):
                yield from _sets(on_nodes, sets)
                here, elsets, of_cells, on_nodes = set(), set(), set(), {}  # sets of another have the same names
            nodes, generates = key == "NODE", "GENERATE" in options
            name = options.get("NSET", "").upper() if key in ("NODE", "NSET") else ""
            cells = options.get("ELSET", "").upper() if key in ("NSET", "ELSET", "ELEMENT") else ""
            by_cells = name != "" != cells  # readers do not know that, but every set of cells is one of nodes, too
            if (name or cells) in of_cells or (by_cells and name in (here | elsets) - {cells}):
                raise MeshError(f"{where}: another set is called {name or cells}, one by *NSET, ELSET: use two names")
            if by_cells:
                own = None
                if name != cells:
                    of_cells.add(name)
                    yield from (f"*ELSET, ELSET={options['NSET']}", options["ELSET"])
                continue
            elsets.add(cells)
            if name and name not in here:
                sets[name] = []
                here.add(name)
            own = sets[name] if name else None
            if name and nodes:
                on_nodes[name] = options["NSET"]
            kind = _SOLID.fullmatch(options.get("TYPE", "")) if key == "ELEMENT" else None
            line = re.sub(r"(?i)(TYPE\s*=\s*)\w+", rf"\g<1>C3D{kind[1]}", line) if kind else line
            yield re.sub(r"(?i),\s*GENERATE", "", line.replace('"', "")) if key == "NSET" else line.replace('"', "")
            if own and not nodes:  # readers would replace what was there
                yield ", ".join(own)
            continue
        parts = [part.strip() for part in line.split(",") if part.strip()]
        if own is None:
            yield line
        elif nodes:
            own.append(parts[0])
            yield line
        elif generates:
            begin, end, *step = map(int, parts)
            parts = [str(n) for n in range(begin, end + 1, *step)]
        else:
            parts = [each for part in parts for each in _members(where, part, sets)]
        if own is not None and not nodes:
            own += parts
            yield ", ".join(parts)
    yield from _sets(on_nodes, sets)


def _sets(names: Mapping[str, str], sets: Mapping[str, list[str]]) -> Iterator[str]:
    """Sets of nodes in full, by the names that they are to have."""
    for name, spelled in names.items():
        yield from (f"*NSET, NSET={spelled}", *sets[name])


def _keyword(line: str) -> tuple[str, dict[str, str]]:
    """A keyword of Abaqus, and its options by name; capital letters."""
    key, *options = (part.strip() for part in line.strip().lstrip("*").split(","))
    pairs = (option.partition("=") for option in options)
    return key.upper(), {name.strip().upper(): value.strip().strip('"') for name, _, value in pairs}


def _refuse(where: str, key: str, options: dict[str, str]) -> None:
    """Raise MeshError for what readers pass over."""
    if key in _REFUSED:
        raise MeshError(f"{where}: *{key} {_REFUSED[key]}, which is not read: {_IN_FULL}")
    if key == "NODE" and options.get("SYSTEM", "R").upper() != "R":
        raise MeshError(f"{where}: *NODE, SYSTEM={options['SYSTEM']}: expected nodes in rectangular coordinates")
    kind = options.get("TYPE", "")
    if key == "ELEMENT" and kind.upper().startswith("C3D") and not _SOLID.fullmatch(kind):
        raise MeshError(f"{where}: elements {kind} are not read: use C3D10, C3D20 or C3D15, or those of first order")


def _members(where: str, part: str, sets: dict[str, list[str]]) -> list[str]:
    """The nodes that a number, or a set's name, stands for."""
    if part.isdigit():
        return [part]
    name = part.strip('"').upper()
    for known in (name, name.rpartition(".")[2]):  # an instance's name before it
        if known in sets:
            return sets[known]
    raise MeshError(f"{where}: a set of nodes holds {part!r}, which is neither a number nor a set defined above")


def _nastran(lines: Lines) -> Iterator[str]:
    bulk = False
    for where, line in lines:
        if bulk and line.startswith((",", " " * 8)) and line.strip(" ,"):
            yield f"+{line}" if line.startswith(",") else f"+{line[1:]}"  # it continues the card above
            continue
        bulk = bulk or line.strip().upper().startswith("BEGIN")
        if line[:4].upper() == "GRID":
            width = 16 if "*" in line[:8] else 8
            number, system = line.split(",")[1:3] if "," in line else (line[8 : 8 + width], line[8 + width :][:width])
            if system.strip() not in ("", "0"):
                raise MeshError(
                    f"{where}: node {number.strip()} lies in coordinate system {system.strip()}: expected nodes in the"
                    " basic one (CP = 0)"
                )
        yield line
