"""Decks of Abaqus, CalculiX and Nastran: in the plain form that readers take, and what they hold beside the mesh.

Included files are put in their place, sets are written as numbers, elements one a line by the name of their family;
what readers do not know is left out. What would generate or move nodes is refused, and so are cells that readers do not
know: they would pass over these and be left with another mesh.
"""

import math
import re
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from fem.meshes.planform import MeshError

Lines = Iterator[tuple[str, str]]
"""Lines of a deck, each after where it stands."""

NASTRAN = (".bdf", ".nas", ".fem")
"""Endings of Nastran's files."""

_DATA = re.compile(
    r"\s*(?P<keyword>\*\s*(?:INCLUDE|NODE|ELEMENT|NSET|ELSET))\b.*?"
    r"(?P<option>,\s*INPUT\s*=\s*(?P<file>\"[^\"]+\"|[^,\s][^,]*))",
    re.IGNORECASE,
)
_INCLUDE = re.compile(
    r"\s*(?P<keyword>INCLUDE)(?:\s*=\s*|\s+|(?=['\"]))(?P<file>'[^']+'|\"[^\"]+\"|[^\s'\"$=](?:[^'\"$]*[^\s'\"$])?)\s*(?:\$.*)?$",
    re.IGNORECASE,
)
"""Lines that name a file with data."""

_NO_FILE = {
    _DATA: re.compile(
        r"\s*\*\s*(?:INCLUDE\b|(?:NODE|ELEMENT|NSET|ELSET)\s*,(?:.*,)?\s*INPUT\s*(?:=\s*)?(?:,|$))", re.IGNORECASE
    ),
    _INCLUDE: re.compile(r"\s*INCLUDE", re.IGNORECASE),
}
"""Lines that should name one."""

_OPEN = re.compile(r"\s*INCLUDE\s*=?\s*(?:'[^']*|\"[^\"]*)", re.IGNORECASE)
"""Lines of Nastran with a name in quotes that goes on."""

_LONGEST = 1000
"""Length up to which a name in quotes may go on."""

_FLAGS = re.compile(r"\s*(?:GENERATE|UNSORTED|INTERNAL)\s*(?:,|$)", re.IGNORECASE)
"""Lines that continue a keyword without a value."""

_IN_FULL = "write the mesh in full, as cgx does by `send all abq` and Abaqus/CAE into its job's file"

_REFUSED = {
    **dict.fromkeys(("NGEN", "NFILL", "NCOPY", "NMAP"), "generates nodes"),
    **dict.fromkeys(("ELGEN", "ELCOPY"), "generates elements"),
    "SYSTEM": "moves nodes",
}
"""Keywords of Abaqus and CalculiX that are not read, and what each does."""

_SOLID = re.compile(r"D?C3D(4|6|8|10|15|20)[HIMRST]*")
_SHELL = re.compile(r"(?:D?S|STRI|M3D)[34689]\w*")
_SURFACE = re.compile(r"(?:D?S|STRI|M3D|SFM3D|R3D|CP[SE]G?|D?C[AG]XA?|[AD]C2D|[AD]CAX|F3D)([34689])\w*")
_BEAM = re.compile(r"(?:B[23][123]|PIPE[23][12])\w*")
_NO_CELL = re.compile(
    r"[DA]C1D\w*|T[23]D\w*|R2D2|RB[23]D2|MASS|ROTARYI|HEATCAP|(?:SPRING|DASHPOT|CONN|DCOUP|JOINT|GAP|ITT|ITS)\w*"
)
"""Types of elements of Abaqus and CalculiX, with their number of nodes: those with a volume, shells and membranes, all
that lie in a surface, beams, and others that are no cells."""

_SURFACES = {"3": "S3", "4": "S4", "6": "STRI65", "8": "S8R", "9": "S9R5"}
"""What readers call elements in a surface, by the number of nodes."""

_CARDS = {
    "CTETRA": (4, 10),
    "CPENTA": (6, 15),
    "CHEXA": (8, 20),
    **dict.fromkeys(("CPYRAM", "CPYRA"), (5, 13)),
    **dict.fromkeys(("CTRIA3", "CTRIAR"), (3,)),
    **dict.fromkeys(("CQUAD4", "CQUADR", "CSHEAR"), (4,)),
    "CTRIA6": (6,),
    "CQUAD8": (8,),
    "CQUAD9": (9,),
}
"""Cells of Nastran, and how many nodes they may have."""

_CELL = re.compile(r"CI?(?:HEX|TET|PEN|PYR|WED|QUAD|TRI)\w*")
"""Names of Nastran's cards of cells, those that are not read among them."""


def is_deck(path: Path) -> bool:
    """Whether a file is a deck, by its name and what is in it."""
    suffix = path.suffix.lower()
    return suffix in NASTRAN or (
        suffix == ".inp" and re.search(rb"(?i)\*\s*(node|include)\b", path.read_bytes()) is not None
    )


@dataclass(frozen=True)
class DeckContents:
    """What a deck holds, beside what readers take of it.

    Attributes:
        labels: numbers of its nodes in the order in which readers have them.
        elements: how many there are of each type.
        keywords: how often each occurs; of Nastran, cards.
        held: nodes, or sets of them, whose displacements *BOUNDARY, or SPC and SPC1 of Nastran, hold.
        materials: Young's modulus, Poisson's ratio and density in the deck's units, as far as they are given.
        used: materials of solid sections.
        sets: names of sets by those under which they are written.
    """

    labels: list[int] = field(default_factory=list)
    elements: Counter[str] = field(default_factory=Counter)
    keywords: Counter[str] = field(default_factory=Counter)
    held: dict[str, None] = field(default_factory=dict)
    materials: dict[str, list[float | None]] = field(default_factory=dict)
    used: dict[str, None] = field(default_factory=dict)
    sets: dict[str, str] = field(default_factory=dict)

    def missing(self) -> dict[str, str]:
        """What a blade lacks without elements that are not solid, by their type."""
        return {
            kind: lost
            for kind in self.elements
            for lost, kinds in _LOST.items()
            if re.fullmatch(kinds, kind) and (self.used or not kind.startswith("T"))
        }

    def unused(self) -> dict[str, int]:
        """Constraints, anisotropy and removed elements by their keywords, and how often each occurs."""
        isotropic = not any(key.startswith("ELASTIC, TYPE=") for key in self.keywords)
        return {
            key: count
            for key, count in self.keywords.items()
            if _UNUSED.fullmatch(key) and not (isotropic and key == "ORIENTATION")
        }

    def note(self, key: str, material: str, line: str) -> None:
        """Take down a line of data of *BOUNDARY, or the first of *ELASTIC or *DENSITY."""
        words = _words(line)
        if key == "BOUNDARY":
            first = int(words[1]) if len(words) > 1 and words[1].isdigit() else 1  # or a name such as ENCASTRE
            if first <= 3:
                self.held[words[0].replace('"', "")] = None
            return
        own, given = self.materials.setdefault(material, [None, None, None]), [_number(word) for word in words]
        if key == "DENSITY" and own[2] is None:
            own[2] = given[0]
        elif key == "ELASTIC" and own[0] is None:
            own[:2] = given[0], given[1] if len(given) > 1 and words[1] else 0.0


_LOST = {
    "mass": r"MASS|ROTARYI|CONM\d|CMASS\d",
    "stiffness": r"(?:SPRING|GAP|CONN|JOINT|CELAS|CBUSH|CGAP)\w*",
    "mass and stiffness": rf"{_SHELL.pattern}|{_BEAM.pattern}|T[23]D\w*|C(?:QUAD|TRI|SHEAR|BAR|BEAM|BEND|ROD|TUBE)\w*",
}
"""What elements beside solid ones have; those of trusses stand for edges where no section is given."""

_UNUSED = re.compile(
    r"EQUATION|MPC|TIE|RIGID BODY|(?:KINEMATIC |DISTRIBUTING )?COUPLING|CONTACT PAIR|CYCLIC SYMMETRY MODEL|ORIENTATION"
    r"|MODEL CHANGE, REMOVE|PRE-TENSION SECTION|EMBEDDED ELEMENT|ELASTIC, TYPE=.*|FOUNDATION|NONSTRUCTURAL MASS"
    r"|RBE\d|RBAR|RROD|RSPLINE|MAT(?:2|3|8|9|11)|PCOMP\w*|NSML?1?"
)
"""Keywords of Abaqus and CalculiX and cards of Nastran that change a blade, and are not used."""


def _number(word: str) -> float | None:
    """A number as Abaqus and Nastran write it, 1.5+9 among them; None: it is none."""
    try:
        return float(re.sub(r"(?<=[\d.])[dDeE]?(?=[+-]\d)", "e", _E.sub("E", word)))
    except ValueError:
        return None


def plain(path: Path) -> tuple[list[str], DeckContents]:
    """Lines of a deck in plain form, and what it holds.

    Raises:
        MeshError: it names a file that is not there, or holds what would be read wrongly; file and line are named.
    """
    found = DeckContents()
    lines = (
        _nastran(_cards(path), found) if path.suffix.lower() in NASTRAN else _abaqus(_keywords_and_data(path), found)
    )
    return list(lines), found


def included_files(path: Path) -> list[Path]:
    """A deck, and those that there are of the files that it names with parts of its mesh."""
    names, seen, files = _DATA if path.suffix.lower() == ".inp" else _INCLUDE, {path.resolve()}, [path]
    for each in files:  # which grows on the way
        raw = each.read_bytes() if each.is_file() else b""
        lines = _joined(_text(raw), names) if re.search(rb"(?i)include|input", raw) else ()
        for named in filter(None, (names.match(line) for _, line in lines)):
            other = _located(path, each, named)
            if other.is_file() and other.resolve() not in seen:
                seen.add(other.resolve())
                files.append(other)
    return files


def _text(raw: bytes) -> str:
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def _located(deck: Path, path: Path, named: re.Match[str]) -> Path:
    """A file that a line names, from the folder of the main deck as for CalculiX and Abaqus, or else from its own."""
    name = named["file"].strip().strip("'\"").strip()
    return deck.parent / name if (deck.parent / name).is_file() else path.parent / name


def _joined(text: str, names: re.Pattern[str]) -> Iterator[tuple[int, str]]:
    """Lines by their numbers, keywords that go on after a comma, and Nastran's names of files, on one line each."""
    begun, first = "", 0
    for number, line in enumerate(text.splitlines(), 1):
        if names is _INCLUDE:
            whole = begun + line.strip() if begun else line
            more = len(whole) < _LONGEST and _OPEN.fullmatch(whole) is not None
        else:
            if begun and (not line.strip() or line.lstrip().startswith("**")):
                continue
            if begun and (line.lstrip().startswith("*") or not ("=" in line or _FLAGS.match(line))):
                yield first, begun
                begun = ""
            whole = begun + line.strip() if begun else line
            more = re.match(r"\s*\*(?!\*).*,\s*$", whole) is not None
        first = first if begun else number
        begun = whole.rstrip() if more else ""
        if not more:
            yield first, whole
    if begun:
        yield first, begun


def _included(path: Path, names: re.Pattern[str], outer: tuple[Path, ...] = ()) -> Lines:
    """Lines of a deck and of the files that its lines name, each with where it stands.

    Raises:
        MeshError: a line names no file, one that is not there, or one that includes it.
    """
    for number, line in _joined(_text(path.read_bytes()), names):
        where = f"{path.name}, line {number}" if outer else f"line {number}"
        named = names.match(line)
        if named is None and _NO_FILE[names].match(line):
            expected = "INCLUDE 'file'" if names is _INCLUDE else "INPUT=file"
            raise MeshError(f"{where}: {line.strip()[:80]!r} names no file that can be read: expected {expected}")
        if named is None:
            yield where, line
            continue
        if not named["keyword"].upper().endswith("INCLUDE"):
            yield where, line.replace(named["option"], "")
        other = _located((*outer, path)[0], path, named)
        if not other.is_file() or other.resolve() in {each.resolve() for each in (*outer, path)}:
            why = "which includes it" if other.is_file() else "which is not a file"
            raise MeshError(f"{where}: it includes {named['file'].strip()!r}, {why}")
        yield from _included(other, names, (*outer, path))


def _keywords_and_data(path: Path) -> Lines:
    """Lines of a deck of Abaqus, those of included files too, without comments, blank ones and blanks around them."""
    for where, line in _included(path, _DATA):
        if line.strip() and not line.lstrip().startswith("**"):
            yield where, line.strip()


@dataclass(frozen=True)
class _Place:
    """Where a set is given.

    Attributes:
        where: file and line.
        owner: the part or instance there.
        instance: the instance that a set of the assembly is of.
        parts: those of the instances.
    """

    where: str
    owner: str
    instance: str
    parts: Mapping[str, str]

    @property
    def before(self) -> str:
        """What stands before numbers of an instance's nodes and elements."""
        return f"{self.instance}." if self.instance else ""


@dataclass(frozen=True)
class _Sets:
    """Sets of a deck by the part or instance that they are of, "": of none, and by their names in capital letters.

    Attributes:
        keyword: NSET or ELSET.
        members: numbers of nodes or elements; those of an assembly's sets after their instance and a dot.
        spelled: names as the deck spells them last.
        unwritten: sets that are still to be written.
        aliases: names under which sets are written, which readers keep apart whatever the names hold.
    """

    keyword: str
    members: dict[str, dict[str, list[str]]] = field(default_factory=dict)
    spelled: dict[str, str] = field(default_factory=dict)
    unwritten: dict[tuple[str, str], None] = field(default_factory=dict)
    aliases: dict[tuple[str, str], str] = field(default_factory=dict)

    def own(self, owner: str) -> dict[str, list[str]]:
        """The sets of a part or instance."""
        return self.members.setdefault(owner, {})

    def of(self, owner: str, name: str) -> list[str]:
        """Members of a set, to be added to."""
        key = name.upper()
        self.spelled[key] = name
        self.unwritten[owner, key] = None
        self.aliases.setdefault((owner, key), f"{self.keyword}{len(self.aliases)}")
        return self.own(owner).setdefault(key, [])

    def listed(self, line: str, at: "_Place", *, generate: bool) -> list[str]:
        """What a line of data stands for."""
        words = [word for word in _words(line) if word]
        if not generate:
            return [each for word in words for each in self.named(word, at)]
        try:
            first, *rest = map(int, words)
            last, step = (*rest, first, 1)[:2] if len(rest) != 1 else (rest[0], 1)
            if first <= last and step > 0:
                return [f"{at.before}{number}" for number in range(first, last + 1, step)]
        except ValueError:
            pass
        raise MeshError(
            f"{at.where}: expected the first and the last number, which is not below it, and a step, not {line!r}"
        )

    def named(self, word: str, at: "_Place") -> list[str]:
        """Members of a set, or a number itself; either may follow an instance's name and a dot."""
        if word.isdigit():
            return [f"{at.before}{word}"]
        own, name = self.own(at.owner), word.replace('"', "").upper()
        for whole in (at.before + name, name):
            instance, _, short = whole.rpartition(".")
            if instance not in at.parts:
                continue
            if short.isdigit():
                return [f"{instance}.{short}"]
            for other in (self.own(_instance(instance)), self.own(at.parts[instance])):
                if short in other:
                    return [f"{instance}.{number}" for number in other[short]]
        for each in (name, name.rpartition(".")[2]):
            if each in own:
                return own[each]
        kind = "nodes" if self.keyword == "NSET" else "elements"
        raise MeshError(
            f"{at.where}: a set of {kind} holds {word!r}, which is neither a number nor a set defined above"
        )

    def written(self, owner: str) -> Iterator[str]:
        """The sets of a part, an instance or, with owner "", of none, where these end."""
        for own, name in [key for key in self.unwritten if key[0] == owner]:
            del self.unwritten[own, name]
            by_instance: dict[str, list[str]] = {}
            for member in self.members[own][name]:
                instance, _, number = member.rpartition(".")
                by_instance.setdefault(instance, []).append(number)
            for instance, numbers in by_instance.items():
                option = f", INSTANCE={_plain_name(instance)}" if instance else ""
                yield f"*{self.keyword}, {self.keyword}={self.aliases[own, name]}{option}"
                yield ", ".join(numbers)


def _part(name: str) -> str:
    return f"PART {name.upper()}"


def _instance(name: str) -> str:
    return f"INSTANCE {name.upper()}"


def _plain_name(name: str) -> str:
    """A name of a part or instance as readers take it."""
    return re.sub("[,=]", "_", name.upper())


def _words(line: str) -> list[str]:
    """What stands between the commas of a line, without blanks around it; commas in quotes are none."""
    parts = line.split('"')
    parts[1:-1:2] = [part.replace(",", "\0") for part in parts[1:-1:2]]
    return [word.strip().replace("\0", ",") for word in '"'.join(parts).split(",")]


def _abaqus(lines: Lines, found: DeckContents) -> Iterator[str]:
    """A deck of Abaqus in plain form; what it holds is added to `found`."""
    nsets, elsets = (_Sets(keyword) for keyword in ("NSET", "ELSET"))
    sets, of_cells = {"NSET": nsets, "ELSET": elsets}, set[tuple[str, str]]()
    labels_of: dict[str, list[int]] = {}
    parts: dict[str, str] = {}  # of instances
    rows: dict[str, dict[str, str]] = {}  # elements of parts and instances by their numbers
    row, members, labels, generate, owner = list[str](), list[str](), found.labels, False, ""
    key, kind, count, last, material, instance = "", "", 0, "", "", ""
    moves, outside = 0, False  # lines that place an instance; in an assembly, between instances
    for where, line in lines:
        if line.startswith("*"):
            _check_nodes(last, row, kind, count)
            row = []
            key, options = _keyword(line)
            _refuse(where, key, options)
            found.keywords[key] += 1
            members, generate, instance = [], "GENERATE" in options, options.get("INSTANCE", "").upper()
            name = options.get({"NODE": "NSET", "ELEMENT": "ELSET"}.get(key, key), "")
            cells = options.get("ELSET", "") if key == "NSET" else ""
            other = nsets if key in ("ELEMENT", "ELSET") else elsets
            by_cells = (owner, name.upper()) in of_cells and other is nsets
            if by_cells or (cells and name.upper() != cells.upper() and name.upper() in elsets.own(owner)):
                raise MeshError(f"{where}: another set is called {name.upper()}, one by *NSET, ELSET: use two names")
            if key.rpartition(" ")[2] in ("PART", "INSTANCE", "ASSEMBLY"):
                if key != "INSTANCE":  # sets of the assembly are written where it ends
                    yield from (*nsets.written(owner), *elsets.written(owner))
                if key == "PART":
                    owner = _part(options["NAME"])
                elif key == "INSTANCE":
                    owner, part = _instance(options["NAME"]), _part(options.get("PART", ""))
                    parts[options["NAME"].upper()], moves = part, 0
                    found.labels.extend(labels_of.get(part, []))
                else:
                    owner, outside = "", key in ("ASSEMBLY", "END INSTANCE")
                labels = labels_of.setdefault(owner, []) if key == "PART" else found.labels
                own = (f"{each}={_plain_name(options[each])}" for each in _OWN if each in options)
                yield ", ".join([f"*{key}", *own])
            elif key == "NODE":
                members = nsets.of(owner, name) if name else []
                yield "*NODE"
            elif key == "ELEMENT":
                kind = options.get("TYPE", "").upper()
                count, plain_kind = _family(where, kind)
                members = elsets.of(owner, name) if name else []
                if count and outside and not owner:
                    raise MeshError(f"{where}: cells of an assembly are not read: put them into a part")
                if count:
                    yield f"*ELEMENT, TYPE={plain_kind}"
            elif key in sets:
                if not name:
                    raise MeshError(f"{where}: *{key} without the name of a set")
                if instance and instance not in parts:
                    raise MeshError(f"{where}: no instance above is called {instance}")
                if cells:
                    place = _Place(where, owner, instance, parts)
                    of_them = _nodes(elsets.named(cells, place), place, rows)
                    if name.upper() != cells.upper():
                        of_cells.add((owner, name.upper()))
                    nsets.of(owner, elsets.spelled.get(name.upper(), name)).extend(of_them)
                    key = ""
                else:
                    members = sets[key].of(owner, name)
            elif key == "MATERIAL":
                material = options.get("NAME", "").upper()
            elif key == "SOLID SECTION":
                found.used[options.get("MATERIAL", "").upper()] = None
            elif key == "ELASTIC" and not options.get("TYPE", "ISO").upper().startswith("ISO"):
                key = f"ELASTIC, TYPE={options['TYPE'].upper()}"
                found.keywords[key] += 1
            elif key == "MODEL CHANGE" and "REMOVE" in options and options.get("TYPE", "ELEMENT").upper() == "ELEMENT":
                found.keywords["MODEL CHANGE, REMOVE"] += 1
        elif key == "NODE":
            number = line.partition(",")[0].strip()
            labels.append(int(number) if number.isdigit() else -1)
            members.append(number)
            yield _E.sub("E", line.rstrip(", "))
        elif key == "INSTANCE":
            moves += 1
            yield _move(where, line, moves)
        elif key == "ELEMENT":
            own_row = [part.strip() for part in line.split(",") if part.strip()]
            if len(row) + len(own_row) > count + 1:  # lines continue an element as long as it lacks nodes
                _check_nodes(*((last, row) if row else (where, own_row)), kind, count)
            row, last = [*row, *own_row], where
            if len(row) == count + 1 or not (count or line.endswith(",")):
                members.append(row[0])
                found.elements[kind] += 1
                whole = rows.setdefault(owner, {})[row[0]] = ",".join(row)
                if count:
                    yield whole
                row = []
        elif key in sets:
            members += sets[key].listed(line, _Place(where, owner, instance, parts), generate=generate)
        elif key in ("BOUNDARY", "ELASTIC", "DENSITY"):
            found.note(key, material, line)
    _check_nodes(last, row, kind, count)
    yield from (*nsets.written(owner), *elsets.written(owner))
    if not found.labels:  # parts without an instance
        found.labels.extend(number for each in labels_of.values() for number in each)
    _name_sets(found, nsets, elsets, parts)


def _move(where: str, line: str, place: int) -> str:
    """A line that places an instance in full, the first a translation and the second a rotation; blanks are zeros.

    Raises:
        MeshError: it is another.
    """
    words, count = _words(line), {1: 3, 2: 7}.get(place, 0)
    values = [_number(word or "0") for word in words] + [0.0] * (count - len(words))
    numbers = [value for value in values[:count] if value is not None and math.isfinite(value)]
    turned = place == 2 and len(numbers) == 7 and numbers[6] != 0.0
    if len(numbers) < count or any(words[count:]) or not count or (turned and numbers[:3] == numbers[3:6]):
        raise MeshError(
            f"{where}: an instance is placed by a line of three numbers (0, 0, 0 where it is only turned), then one of"
            f" seven, two points of an axis and an angle; not by {line!r}"
        )
    return ", ".join(map(repr, numbers))


def _nodes(elements: list[str], at: _Place, rows: Mapping[str, Mapping[str, str]]) -> Iterator[str]:
    """The nodes of elements, each once; of those of instances after these and a dot."""
    every: dict[str, None] = {}
    for element in elements:
        instance, dot, number = element.rpartition(".")
        for own in (_instance(instance), at.parts[instance]) if dot else (at.owner,):
            for node in rows.get(own, {}).get(number, "").upper().replace('"', "").split(",")[1:]:
                if "." in node and node.rpartition(".")[0] not in at.parts:
                    raise MeshError(f"{at.where}: element {number} names node {node} of no instance above")
                every[f"{instance}{dot}{node}"] = None
    yield from every


def _name_sets(found: DeckContents, nsets: _Sets, elsets: _Sets, parts: Mapping[str, str]) -> None:
    """Give sets that are written their names: a part's or instance's after its own where the assembly has it, too."""
    outer = {*nsets.own(""), *elsets.own("")}
    for sets in (nsets, elsets):
        for (owner, name), alias in sets.aliases.items():
            before = f"{owner.partition(' ')[2]}." if owner and name in outer else ""
            found.sets[alias] = before + sets.spelled[name]
    for held in [each for each in found.held if "." in each and each.upper() not in outer]:
        instance, _, name = held.upper().rpartition(".")
        own = (each for each in (_instance(instance), parts.get(instance, "")) if name in nsets.own(each))
        owner = next(own, "").partition(" ")[2]
        del found.held[held]
        found.held[f"{owner}.{name}" if owner and name in outer else name] = None


_OWN = ("NAME", "PART")
"""Options of parts, instances and assemblies that place their nodes."""

_E = re.compile(r"(?<=[\d.])[dD](?=[+-]?\d)")
"""Exponents as Fortran writes them."""


def _check_nodes(where: str, row: list[str], kind: str, count: int) -> None:
    """Refuse an element that is begun and has not the nodes of its kind."""
    if count and row:
        raise MeshError(f"{where}: element {row[0]} has {len(row) - 1} nodes, and {kind} has {count}")


def _family(where: str, kind: str) -> tuple[int, str]:
    """Number of nodes of a kind of element, and what readers call it; of one that is no cell 0.

    Raises:
        MeshError: it may be a cell, and is not read.
    """
    if solid := _SOLID.fullmatch(kind):
        return int(solid[1]), f"C3D{solid[1]}"
    if surface := _SURFACE.fullmatch(kind):
        return int(surface[1]), _SURFACES[surface[1]]
    if _BEAM.fullmatch(kind) or _NO_CELL.fullmatch(kind):
        return 0, ""
    use = "use C3D10, C3D20, C3D15 or those of first order, in a plate S4 or S8R"
    raise MeshError(f"{where}: elements {kind or 'without a type'} are not read: {use}")


def _keyword(line: str) -> tuple[str, dict[str, str]]:
    """A keyword of Abaqus, and its options by name; capital letters."""
    key, *options = _words(line.strip().lstrip("*"))
    pairs = (option.partition("=") for option in options)
    return " ".join(key.upper().split()), {name.strip().upper(): value.strip().strip('"') for name, _, value in pairs}


def _refuse(where: str, key: str, options: Mapping[str, str]) -> None:
    """Raise MeshError for what generates or moves nodes and elements."""
    if key in _REFUSED:
        raise MeshError(f"{where}: *{key} {_REFUSED[key]}, which is not read: {_IN_FULL}")
    if key == "NODE" and options.get("SYSTEM", "R").upper() != "R":
        raise MeshError(f"{where}: *NODE, SYSTEM={options['SYSTEM']}: expected nodes in rectangular coordinates")


def deck_fault(path: Path) -> str:
    """What is wrong with the numbers of a deck of Abaqus that cannot be used, by line; empty: nothing that is seen."""
    nodes: dict[int, str] = {}
    named: list[tuple[str, int, str]] = []
    lines, first = Counter[int](), dict[int, str]()  # by how many coordinates they have
    key, count, owner, row = "", 0, "", list[str]()
    for where, line in _keywords_and_data(path) if path.suffix.lower() == ".inp" else ():
        if line.startswith("*"):
            key, options = _keyword(line)
            if key in ("PART", "END PART", "INSTANCE", "END INSTANCE"):  # which number their own nodes
                if fault := _unknown(named, nodes):
                    return fault
                nodes, named = {}, []
            count = _family(where, options.get("TYPE", "").upper())[0] if key == "ELEMENT" else 0
            owner = "" if key == "ELEMENT" else f"set {options.get('NSET')}"
            key, row = "" if options.keys() & {"GENERATE", "INSTANCE"} else key, []
            continue
        values = [value.strip() for value in line.rstrip(",").split(",")]
        if key == "NODE":
            try:
                number, place = int(values[0]), [float(_E.sub("E", value)) for value in values[1:]]
            except ValueError:
                return f"{where}: expected a node's number and its coordinates, not {line!r}"
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
            if key == "ELEMENT" and not row:
                owner, numbers = f"element {values[0]}", numbers[1:]
            row = [] if len(row) + len(values) > count else [*row, *values]
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


def _cards(path: Path) -> Iterator[tuple[str, str, list[str]]]:
    """Cards of a Nastran file, those of included files too: where each stands, its name and its fields.

    A card is in free format, or in fields of 8 or, where its name has a star, 16 columns; lines that begin with blanks,
    +, * or a comma continue it. It has eight fields at least, blank where the deck has none. Meshio writes second-order
    cells as CHEXA_ and the like.
    """
    where, name, fields, bulk = "", "", list[str](), False
    for place, line in _included(path, _INCLUDE):
        line = line.partition("$")[0].rstrip().expandtabs(8)
        if not bulk or not line.strip(" ,"):
            bulk = bulk or line.strip().upper().startswith("BEGIN")
            continue
        if line.upper().startswith("ENDDATA"):
            break
        first, *own = line.split(",") if "," in line else (line[:8],)
        wide = "*" in first
        if "," in line:  # the last field of ten, or six, is a mark
            own = own[:4] if wide else own if len(own) > 9 else own[:8]
        else:
            own = [line[k : k + 8 * (1 + wide)] for k in range(8, 72, 8 * (1 + wide))]
        own = [each.strip() for each in own]
        own += [""] * ((4 if wide else 8) - len(own))
        if first.strip() and first[0] not in "+*":
            if name:
                yield where, name, fields + [""] * (8 - len(fields))
            where, name, fields = place, first.strip().rstrip("*_").upper(), own
        else:
            fields = [*fields, *own]
    if name:
        yield where, name, fields + [""] * (8 - len(fields))


def _nastran(cards: Iterator[tuple[str, str, list[str]]], found: DeckContents) -> Iterator[str]:
    """The nodes and cells of a Nastran file, in free format; what it holds is added to `found`."""
    properties, materials, held = set[str](), dict[str, str](), list[range]()
    weight = 1.0
    yield "BEGIN BULK"
    for where, name, fields in cards:
        (found.elements if name.startswith("C") else found.keywords)[name] += 1
        if name in ("GRID", "GRDSET"):
            if fields[1] not in ("", "0"):
                who = f"node {fields[0]} lies" if name == "GRID" else "GRDSET has nodes lie"
                raise MeshError(
                    f"{where}: {who} in coordinate system {fields[1]}: expected nodes in the basic one (CP = 0)"
                )
            if name == "GRID":
                found.labels.append(int(fields[0]) if fields[0].isdigit() else -1)
                yield ",".join([name, fields[0], "", *(_E.sub("E", each) or "0." for each in fields[2:5])])
        elif name in _CARDS:
            counts, nodes = _CARDS[name], [each for each in fields[2:] if each]
            if len(counts) == 1:  # others have thicknesses behind them
                nodes = [each for each in fields[2 : 2 + counts[0]] if each]
            else:
                properties.add(fields[1] or fields[0])
            if len(nodes) not in counts:
                expected = " or ".join(map(str, counts))
                raise MeshError(f"{where}: {name} {fields[0]} has {len(nodes)} nodes, expected {expected}")
            own = [name, *fields[:2], *nodes]
            yield ",".join(own[:9])
            yield from (",".join(["+", *own[k : k + 8]]) for k in range(9, len(own), 8))
        elif _CELL.fullmatch(name):
            raise MeshError(f"{where}: {name} is not read: use CHEXA, CPENTA or CTETRA, in a plate CQUAD4 or CTRIA3")
        elif name == "MAT1":
            found.materials[fields[0]] = [_number(fields[k]) for k in (1, 3, 4)]
        elif name == "PSOLID":
            materials[fields[0]] = fields[1]
        elif name == "PARAM" and fields[0].upper() == "WTMASS":
            weight = _number(fields[1]) or 1.0
        elif name in ("SPC", "SPC1"):
            held += _supports(name, fields)
    for material in found.materials.values():
        material[2] = None if material[2] is None else weight * material[2]
    found.used.update({material: None for number, material in materials.items() if number in properties})
    labels, done = sorted(found.labels), 0
    for span in sorted(held, key=lambda span: span.start):
        if len(span) == 1:
            found.held[str(span.start)] = None
            continue
        first, behind = (bisect_left(labels, end) for end in (max(span.start, done), span.stop))
        found.held.update({str(label): None for label in labels[first:behind]})
        done = max(done, span.stop)
    yield "ENDDATA"


def _supports(name: str, fields: list[str]) -> Iterator[range]:
    """Numbers of nodes that an SPC or SPC1 holds in a direction, not in rotations alone."""
    if name == "SPC":
        pairs = [(fields[k], fields[k + 1]) for k in (1, 4)]
    else:
        pairs = [(each, fields[1]) for each in fields[2:]]
        if fields[3].upper() == "THRU" and fields[2].isdigit() and fields[4].isdigit():
            pairs = []
            if {*fields[1]} & {*"123"}:
                yield range(int(fields[2]), int(fields[4]) + 1)
    for node, directions in pairs:
        if node.isdigit() and {*directions} & {*"123"}:
            yield range(int(node), int(node) + 1)
