"""Input decks of Abaqus, CalculiX and Nastran in the plain form that mesh readers take, or why they cannot be.

Included files are put in their place, sets of nodes that name others get these nodes, and solid elements the name of
their family. What would generate or move nodes is refused: readers pass over it and are left with another mesh.
"""

from __future__ import annotations

import re
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from fem.meshes.planform import MeshError

if TYPE_CHECKING:
    from collections.abc import Iterator

    Lines = Iterator[tuple[str, str]]

NASTRAN = (".bdf", ".nas", ".fem")
"""Endings of Nastran's files."""

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


@contextmanager
def plain(path: Path) -> Iterator[Path]:
    """A file as readers take it: a deck in plain form in a file of its own, any other file itself.

    Raises:
        MeshError: it names a file that is not there, or holds what would be read wrongly; file and line are named.
    """
    suffix, lines = path.suffix.lower(), None
    if suffix == ".inp" and re.search(rb"(?i)\*(node|include)\b", path.read_bytes()):
        lines = _abaqus(_included(path, _DATA))
    elif suffix in NASTRAN:
        lines = _nastran(_included(path, _INCLUDE))
    if lines is None:
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / f"deck{suffix}"
        copy.write_text("\n".join(lines) + "\n", encoding="utf-8")
        yield copy


def _included(path: Path, names: re.Pattern[str], outer: tuple[Path, ...] = ()) -> Lines:
    """Lines of a deck and of the files that its lines name, each with where it stands."""
    raw = path.read_bytes()
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("cp1252", errors="replace")
    for number, line in enumerate(text.splitlines(), 1):
        where = f"{path.name}, line {number}" if outer else f"line {number}"
        named = names.match(line)
        if named is None:
            yield where, line
            continue
        if not named["keyword"].upper().endswith("INCLUDE"):
            yield where, line.replace(named["option"], "")
        other = path.parent / named["file"].strip(" '\"")
        if not other.is_file() or other.resolve() in {each.resolve() for each in (*outer, path)}:
            why = "which includes it" if other.is_file() else "which is not a file"
            raise MeshError(f"{where}: it includes {named['file'].strip()!r}, {why}")
        yield from _included(other, names, (*outer, path))


def _abaqus(lines: Lines) -> Iterator[str]:
    sets: dict[str, list[str]] = {}
    here: set[str] = set()
    own: list[str] | None = None
    nodes, generates = False, False
    for where, line in lines:
        if line.startswith("**") or not line.strip():
            continue
        if line.lstrip().startswith("*"):
            key, options = _keyword(line)
            _refuse(where, key, options)
            if key in ("PART", "INSTANCE", "ASSEMBLY"):  # sets of another have the same names
                here = set()
            nodes, generates = key == "NODE", "GENERATE" in options
            name = options.get("NSET", "").upper() if key in ("NODE", "NSET") else ""
            if name and name not in here:
                sets[name] = []
                here.add(name)
            own = sets[name] if name else None
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
    if key == "NSET" and "ELSET" in options:
        raise MeshError(f"{where}: *NSET, ELSET={options['ELSET']} is not read: name that set of elements instead")
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
    raise MeshError(f"{where}: a set of nodes holds {part!r}, which is no number and no set above it")


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
