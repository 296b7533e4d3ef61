"""Mid-surface meshes from files, through meshlane: Gmsh .msh, VTU, Abaqus .inp, Nastran .bdf and the rest.

Straight-sided cells are used: of second-order cells the corners are taken. One kind of cell a mesh: where a
file mixes triangles and quadrilaterals, the quadrilaterals are split.

Meshlane is a maintained continuation of meshio: it knows the second-order wedges (Abaqus C3D15, CalculiX) that meshio
stumbles over, and keeps sets of nodes and cells.

`raw_mesh` serves volume meshes too. Decks of Abaqus, CalculiX and Nastran are brought into the plain form that readers
take (`fem.meshes.decks`).
"""

import contextlib
import io
import re
import tempfile
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fem.linalg import Array, Ints
from fem.meshes.decks import NASTRAN, DeckContents, deck_fault, included_files, is_deck, plain
from fem.meshes.planform import MeshError, check_mesh, root, root_facets, twice_areas

TRIANGLES = ("triangle", "triangle6", "triangle7")
QUADS = ("quad", "quad8", "quad9")
IGNORED = ("vertex", "line", "line3")
FLATNESS = 1e-6
"""Largest departure from a plane of constant z, relative to the size of the mesh."""


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
        with _plain(path) as (deck, found), contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            raw = meshlane.read(deck)
            raw.deck = found
            if found.sets:
                _name_sets(raw, found.sets)
            return raw
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
        if "gmsh:physical" in str(error):
            why = "not all of its cells are in physical groups: save it as text (Mesh.Binary = 0)"
        raise MeshError(deck_fault(path) or why) from None


def _name_sets(raw: Any, names: Mapping[str, str]) -> None:
    """Give sets the names of their file; those of two parts that have the same are one."""
    for own in (raw.point_sets, raw.cell_sets):
        given, named = dict(own), dict[str, Any]()
        for alias, members in given.items():
            name = names.get(alias, alias)
            if name not in named:
                named[name] = members
            elif own is raw.point_sets:
                named[name] = np.concatenate([named[name], members])
            else:
                named[name] = [np.concatenate(pair) for pair in zip(named[name], members, strict=True)]
        own.clear()
        own.update(named)


_DAMAGED = "damaged or truncated, or its cells lack some of their nodes"

GEOMETRY = {".step": "STEP", ".stp": "STEP", ".iges": "IGES", ".igs": "IGES", ".brep": "BREP"}
"""Geometry that is to be meshed, by the ending of its files."""

_BULK = re.compile(rb"(?i)BEGIN[ \t]+BULK")


def _check_kind(path: Path) -> None:
    """Refuse geometry without a mesh, and a part of a Nastran file that readers would search to its end."""
    kind = GEOMETRY.get(path.suffix.lower())
    if path.suffix.lower() in (".html", ".htm"):
        raise MeshError("a page, not a mesh: open it in a browser")
    if kind is not None:
        raise MeshError(f"{kind} is geometry without a mesh: mesh the mid-surface, or the volume (with Gmsh, say)")
    if path.name.lower().endswith((".frd", ".frd.gz", ".npz", ".op2", ".rst")):
        raise MeshError("a file of modes or results, not a mesh: use it in a scene as [structure] modes = 'blade.frd'")
    if path.suffix.lower() in NASTRAN and not _BULK.search(path.read_bytes()):
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


@contextlib.contextmanager
def _plain(path: Path) -> Iterator[tuple[Path, DeckContents]]:
    """A file as readers take it, in a file of its own where it has to be changed, and what it holds.

    Raises:
        MeshError: see `fem.meshes.decks.plain`.
    """
    lines: list[str] | None = None
    found = DeckContents()
    if is_deck(path):
        lines, found = plain(path)
    elif path.suffix.lower() == ".msh":
        lines = _gmsh(path, found.labels)
    elif path.suffix.lower() in (".cdb", ".inp"):
        blocks = re.findall(r"(?im)^NBLOCK.*\n\(\d*i(\d+).*\n((?:[ \d].*\n)+)", path.read_text(errors="replace"))
        rows = [line[: int(width)] for width, block in blocks for line in block.splitlines()]
        found.labels.extend(int(row) for row in rows if row.strip().isdigit())
    if lines is None:
        yield path, found
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / f"deck{path.suffix.lower()}"
        copy.write_text("\n".join(lines) + "\n", encoding="utf-8")
        yield copy, found


def _gmsh(path: Path, labels: list[int]) -> list[str] | None:
    """Lines of a text file of Gmsh, None where readers take it as it is; the numbers of its nodes go to `labels`.

    In format 4.1, readers take entities that all are in physical groups, or none: the others get a group without name.
    """
    data = path.read_bytes()
    if not re.match(rb"\s*\$MeshFormat\s+(2|4\.1)\S* 0 ", data):
        return None
    lines, changed = data.decode("utf-8", errors="replace").splitlines(), False
    try:
        at = lines.index("$Nodes") + 2
        if lines[lines.index("$MeshFormat") + 1].startswith("2"):
            labels += [int(line.split()[0]) for line in lines[at : lines.index("$EndNodes")]]
            return None
        while lines[at] != "$EndNodes":
            count = int(lines[at].split()[3])
            labels += map(int, lines[at + 1 : at + 1 + count])
            at += 1 + 2 * count
        first = lines.index("$Entities") + 2
        points = int(lines[first - 1].split()[0])
        for k in range(first, lines.index("$EndEntities")):
            words, place = lines[k].split(), 4 if k < first + points else 7
            if words[place] == "0":
                lines[k], changed = " ".join([*words[:place], "1", _NO_GROUP, *words[place + 1 :]]), True
    except (ValueError, IndexError):  # no entities; or what the reader stumbles over, too
        pass
    return lines if changed else None


_NO_GROUP = str(2**31 - 1)
"""Number of a physical group that no file has."""


def files_of(path: Path) -> list[Path]:
    """A mesh file, and those that there are of the files that it names with parts of its mesh."""
    if path.suffix.lower() in (".inp", *NASTRAN):
        return included_files(path)
    with contextlib.suppress(ElementTree.ParseError):  # which is said where it is read
        return [path, *(_named_files(path) if path.is_file() else [])]
    return [path]
