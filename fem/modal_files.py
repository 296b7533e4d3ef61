"""Files of modes: CalculiX's .frd in ASCII, and the neutral file that this package reads and writes, .npz or .json."""

import gzip
import io
import json
import re
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from fem.linalg import Array, Ints
from fem.meshes.cells import KINDS, cell
from fem.modal_model import SAME_SPEED, ModalModel, ModesAtSpeed, chosen
from fem.rotor import from_rpm, in_rpm


class ModesFileError(ValueError):
    """A file that holds no usable modes; the message says what is wrong and what would be right."""


@dataclass(frozen=True, eq=False)
class Raw:
    """What a file holds, in its own units.

    Attributes:
        model: nodes, cells and modes; speeds of nan where the file does not say.
        unit, mass_unit: what the file says of them; None: nothing.
        turns: whether axis and origin are the file's.
        solved: whether a solver has normalised the modes, and says their modal masses.
    """

    model: ModalModel
    unit: str | None = None
    mass_unit: str | None = None
    turns: bool = False
    solved: bool = False


def read(path: Path) -> Raw:
    """Read a file of modes by the end of its name: .frd, .npz or .json, the first also packed as .frd.gz.

    Raises:
        ModesFileError: it holds no usable modes.
        OSError: it cannot be read.
    """
    name = path.name.lower().removesuffix(".gz")
    data = path.read_bytes()
    if path.name.lower().endswith(".gz"):
        try:
            data = gzip.decompress(data)
        except (OSError, EOFError, zlib.error) as error:
            raise ModesFileError(f"not a complete .gz file: {error}") from error
    if not data.strip():
        raise ModesFileError("the file is empty")
    try:
        if name.endswith(".frd"):
            return _checked(Raw(_frd(data), solved=True))
        if name.endswith(".npz"):
            return _checked(_neutral(_npz(data)))
        if name.endswith(".json"):
            return _checked(_neutral(_json(data)))
    except (ValueError, TypeError, LookupError, ArithmeticError) as error:
        if isinstance(error, ModesFileError):
            raise
        raise ModesFileError(f"cannot be read: {error}") from error
    problem = "expected a file of modes whose name ends in .frd, .npz or .json"
    if name.endswith((".rst", ".op2", ".unv", ".csv")):
        problem += ": the guide 'My modes from ANSYS, CalculiX, a test' shows how to write .npz from others"
    raise ModesFileError(problem)


def _checked(raw: Raw) -> Raw:
    """The same, once all numbers are finite and make sense.

    Raises:
        ModesFileError: they do not.
    """
    model = raw.model
    if not np.isfinite(model.points).all():
        raise ModesFileError("coordinates of nodes are not numbers")
    if not len(model.points) or not np.ptp(model.points, axis=0).any():
        raise ModesFileError("expected nodes at different places")
    for modes in model.speeds:
        frequencies = modes.frequencies_hz
        if not frequencies.size:
            raise ModesFileError("it holds no modes")
        if not np.isfinite(frequencies).all():
            raise ModesFileError("frequencies are not numbers")
        low, high, number = frequencies.min(), frequencies.max(), int(frequencies.argmin()) + 1
        if low <= 0.0:
            raise ModesFileError(
                f"mode {number} has {low:g} Hz: expected frequencies above 0, of a constrained structure"
                " that does not diverge"
            )
        if high > _HIGHEST:
            raise ModesFileError(f"a mode has {high:g} Hz: expected frequencies in Hz")
        if low < _LOOSE * high:
            raise ModesFileError(
                f"mode {number} has {low:g} Hz beside {high:g} Hz: it is a rigid-body mode;"
                " expected the modes of a constrained structure"
            )
        for what, values in (("shapes", modes.shapes), ("static displacements", modes.static)):
            if values is not None and not np.isfinite(values).all():
                raise ModesFileError(f"{what} hold values that are not numbers")
            if values is not None and np.abs(values).max() > _LARGEST:
                raise ModesFileError(f"{what} hold values of up to {np.abs(values).max():g}: expected lengths")
        if modes.static is not None and np.abs(modes.static).max() > np.ptp(model.points, axis=0).max():
            raise ModesFileError(
                f"a static displacement of {np.abs(modes.static).max():g} is larger than the structure,"
                f" {np.ptp(model.points, axis=0).max():g}: expected both in one unit"
            )
        still = np.abs(modes.shapes).max(axis=(1, 2)) == 0.0
        if still.any():
            raise ModesFileError(f"nothing moves in mode {int(still.argmax()) + 1}")
    ascending = (chosen(modes, np.argsort(modes.frequencies_hz, kind="stable")) for modes in model.speeds)
    return replace(raw, model=replace(model, speeds=tuple(ascending)))


_HIGHEST = 1e9
"""Frequency [Hz] beyond which no structure vibrates."""

_LARGEST = 1e100
"""Displacement beyond which squares may overflow."""

_LOOSE = 1e-4
"""Part of the highest frequency below which a mode is a rigid body's, which rounding holds."""


_ELEMENTS = (
    *("hexahedron", "wedge", "tetra", "hexahedron20", "wedge15", "tetra10"),
    *("triangle", "triangle6", "quad", "quad8"),
)
"""Kinds of element by their number in an .frd, from 1, by meshio's names."""

_ORDER = {
    "hexahedron20": [*range(12), *range(16, 20), *range(12, 16)],
    "wedge15": [*range(9), *range(12, 15), *range(9, 12)],
}
"""Places of meshio's nodes in an .frd: there the vertical mid-side nodes stand before those of the top."""

_STATIC, _FREQUENCY = b"0", b"2"
"""Types of analysis in the line 100C of an .frd."""


def _frd(data: bytes) -> ModalModel:
    """The nodes, cells and modes of an .frd, as CalculiX 2.20 writes it in ASCII.

    Raises:
        ModesFileError: it holds no usable modes.
    """
    data = data.replace(b"\r\n", b"\n")
    if not data.lstrip().startswith(b"1C"):
        raise ModesFileError("not an .frd file: expected '1C' in its first line")
    head = re.search(rb"^    2C.*$", data, re.M)
    if head is None:
        raise ModesFileError("no block of nodes (2C)")
    if head[0].split()[-1] == b"2" or any(byte > 127 for byte in data[head.end() : head.end() + 4000]):
        raise ModesFileError("a binary .frd: expected ASCII, which CalculiX writes unless the deck asks for OUTPUT=…")
    if not re.search(rb"^ *9999\s*$", data[-200:], re.M):
        raise ModesFileError(
            "the file ends before its last line, '9999': it is truncated, or the analysis did not finish"
        )
    labels, points = _table(data, head.end(), int(head[0].split()[1]), "the block of nodes")
    order = np.argsort(labels, kind="stable")
    if np.unique(labels).size < labels.size:
        raise ModesFileError("two nodes have the same number")
    lookup = labels[order], order
    cells = _elements(data, lookup)
    results = _results(data, labels, lookup)
    return ModalModel(points, (results,), np.array([0.0, 0.0, 1.0]), np.zeros(3), cells, {}, labels)


def _table(data: bytes, begin: int, count: int, what: str) -> tuple[Ints, Array]:
    """Numbers (n,) and three values (n, 3) of the lines ' -1' after a header, up to ' -3'."""
    begin = data.index(b"\n", begin) + 1
    while data[begin : begin + 3] in (b" -4", b" -5"):
        begin = data.index(b"\n", begin) + 1
    end = data.find(b"\n -3", begin)
    if end < 0:
        raise ModesFileError(f"{what} has no end (' -3'): the file is truncated")
    lines = data[begin : end + 1].split(b"\n")[:-1]
    if len(lines) != count:
        raise ModesFileError(f"{what} has {len(lines)} lines of the {count} that its header names: nodes are missing")
    width = {len(line) for line in lines}
    if len(width) != 1 or width.pop() < 49 or any(line[:3] != b" -1" for line in lines):
        raise ModesFileError(f"{what} has lines that are not of 49 characters: ' -1', a number, three values")
    letters = np.frombuffer(b"".join(line[:49] for line in lines), dtype="S1").reshape(count, 49)
    try:
        labels = np.ascontiguousarray(letters[:, 3:13]).view("S10")[:, 0].astype(np.int64)
        values = np.ascontiguousarray(letters[:, 13:]).view("S12").astype(np.float64)
    except ValueError as error:
        word = re.sub(r".*b'(.*)'.*", r"'\1'", str(error))
        raise ModesFileError(f"{what} holds what is not a number, {word}: expected such as '1.23450E-03'") from error
    return labels, values


def _rows(labels: Ints, lookup: tuple[Ints, Ints], what: str) -> Ints:
    """Which rows of the nodes these labels are."""
    known, order = lookup
    at = np.minimum(np.searchsorted(known, labels), known.size - 1)
    unknown = labels[known[at] != labels]
    if unknown.size:
        raise ModesFileError(f"{what} names node {int(unknown[0])}, which is not in the file")
    return np.asarray(order[at])


def _elements(data: bytes, lookup: tuple[Ints, Ints]) -> tuple[tuple[str, Ints], ...]:
    """The cells of an .frd by kind; beams and what else has no surface are left out."""
    head = re.search(rb"^    3C.*$", data, re.M)
    if head is None:
        return ()
    end = data.find(b"\n -3", head.end())
    if end < 0:
        raise ModesFileError("the block of elements has no end (' -3'): the file is truncated")
    by_kind: dict[str, list[list[int]]] = {}
    try:
        for part in data[head.end() : end].split(b"\n -1")[1:]:
            lines = part.split(b"\n")
            kind = int(lines[0].split()[1])
            if not 1 <= kind <= len(_ELEMENTS):
                continue
            name = _ELEMENTS[kind - 1]
            fields = (line[k : k + 10] for line in lines[1:] for k in range(3, len(line.rstrip()), 10))  # may touch
            nodes, count = list(map(int, fields)), len(cell(name).nodes)
            if len(nodes) != count:
                raise ModesFileError(f"an element of type {kind} has {len(nodes)} nodes, expected {count}")
            by_kind.setdefault(name, []).append(nodes)
    except (ValueError, IndexError) as error:
        if isinstance(error, ModesFileError):
            raise
        raise ModesFileError(f"the block of elements cannot be read: {error}") from error
    elements = []
    for name, every in by_kind.items():
        rows = _rows(np.array(every).ravel(), lookup, "an element").reshape(len(every), -1)
        elements.append((name, rows[:, _ORDER.get(name, slice(None))]))
    return tuple(elements)


def _results(data: bytes, labels: Ints, lookup: tuple[Ints, Ints]) -> ModesAtSpeed:
    """The modes of an .frd, and its static displacement."""
    static: Array | None = None
    frequencies: list[float] = []
    shapes: list[Array] = []
    steps: set[bytes] = set()
    numbers: list[int] = []
    begin = 0
    for head in re.finditer(rb"^  100C.*\n -4  (\S+)", data, re.M):
        before, begin = data[begin : head.start()], head.end()
        line, name = head[0].split(b"\n")[0], head[1]
        kind = line[57:58]
        if name == b"DISPI":
            raise ModesFileError(
                "complex modes (a block DISPI, by Coriolis forces, friction or cyclic symmetry): a damper takes real"
                " modes, of *FREQUENCY, of one blade or the whole disc"
            )
        if name != b"DISP" or kind not in (_STATIC, _FREQUENCY):
            continue
        try:
            value = float(line[12:24])
        except ValueError as error:
            raise ModesFileError(f"columns 13 to 24 of a header hold no frequency: {line[12:24]!r}") from error
        what = f"the block of mode {len(frequencies) + 1}" if kind == _FREQUENCY else "the block of displacements"
        own, moved = _table(data, head.end(), len(labels), what)
        ordered = np.full((len(labels), 3), np.nan)
        ordered[_rows(own, lookup, what)] = moved
        if np.isnan(ordered).any():
            raise ModesFileError(f"{what} holds values that are not numbers, or lacks nodes")
        if kind == _STATIC:
            static = static if frequencies else ordered  # the last before the modes
            continue
        steps.add(_parameter(before, b"1PSTEP", 2) or b"1")
        numbers.append(int(_parameter(before, b"1PMODE", 0) or len(numbers) + 1))
        frequencies.append(value)
        shapes.append(ordered / _norm(before, value, len(frequencies)))
    if not frequencies:
        only = "only a static step" if static is not None else "no displacements"
        raise ModesFileError(f"{only}: expected modes, of *FREQUENCY with *NODE FILE, U")
    if len(steps) > 1:
        raise ModesFileError(
            f"modes of {len(steps)} steps: expected one *FREQUENCY step in a file; a file for each speed"
        )
    if lost := [one for one, other in pairwise((0, *numbers)) if other != one + 1]:
        raise ModesFileError(f"mode {lost[0] + 1} is missing: expected the displacements of all modes from 1 on")
    return ModesAtSpeed(np.nan, np.array(frequencies), np.array(shapes), static)


def _norm(before: bytes, frequency: float, number: int) -> float:
    """Root of the modal mass that an .frd says a mode has, once stiffness and frequency belong together."""
    mass, stiffness = _parameter(before, b"1PGM", 0), _parameter(before, b"1PGK", 0)
    if mass is None or stiffness is None:
        raise ModesFileError(
            f"mode {number} has no modal mass (1PGM) and stiffness (1PGK): the scale of its shape is unknown"
        )
    m, k = float(mass), float(stiffness)
    if not (np.isfinite([m, k]).all() and m > 0.0):
        raise ModesFileError(f"mode {number} has a modal mass of {m:g}: expected more than 0")
    square = (2.0 * np.pi * frequency) ** 2
    if frequency > 0.0 and not abs(k / m / square - 1.0) <= _AGREE:
        raise ModesFileError(
            f"mode {number}: modal stiffness over mass, {k / m:g}, is not the square of {frequency:g} Hz, {square:g}"
        )
    return float(np.sqrt(m))


_AGREE = 1e-3
"""Relative difference between a frequency and what modal mass and stiffness make of it."""


def _parameter(before: bytes, name: bytes, place: int) -> bytes | None:
    """A word of the last parameter line of this name."""
    matches = re.findall(rb"^    " + name + rb" +(.*)$", before, re.M)
    words = matches[-1].split() if matches else []
    return words[place] if len(words) > place else None


FORMAT = "spindamp modes 1"
"""What the neutral file says in its key `format`."""

_REQUIRED = {
    "unit": ": of the coordinates, such as 'm' or 'mm'",
    "mass_unit": ": of the modal masses, such as 'kg' or 't'",
    "speeds_rpm": ": the rotation speeds of the modes, such as [0]",
    **dict.fromkeys(("nodes", "frequencies_hz", "shapes"), ""),
    "modal_masses": ": 1 for each mode whose shape is mass-normalised, its modal mass otherwise",
}
"""What each key is for, where its name does not say it."""

_SHAPES: dict[str, tuple[int | str, ...]] = {
    "nodes": ("nodes", 3),
    "speeds_rpm": ("speeds",),
    "frequencies_hz": ("speeds", "modes"),
    "shapes": ("speeds", "modes", "nodes", 3),
    "modal_masses": ("speeds", "modes"),
    "axis": (3,),
    "origin": (3,),
    "static": ("speeds", "nodes", 3),
    "rotations": ("speeds", "modes", "nodes", 3),
    "damping_ratios": ("speeds", "modes"),
    "frequency_errors": ("speeds", "modes"),
    "drawn": ("speeds", "modes", 3),
}
"""Lengths of each array of the neutral file; one that has a name is the same in all."""

_OPTIONAL = ("node_labels", *(name for name in _SHAPES if name not in _REQUIRED))

_KEYS = {name: name for name in ("static", "rotations", "damping_ratios")}
_KEYS |= {"errors": "frequency_errors", "drawn": "drawn"}
"""Under which key the neutral file has what need not be known of modes."""


def _npz(data: bytes) -> dict[str, Any]:
    if not data.startswith(b"PK"):
        raise ModesFileError("not an .npz file: expected one written by numpy.savez")
    try:
        with np.load(io.BytesIO(data)) as file:
            return {name: file[name] for name in file.files}
    except (ValueError, OSError, EOFError, zipfile.BadZipFile, KeyError, RuntimeError, zlib.error) as error:
        raise ModesFileError(f"not a complete .npz file of plain arrays: {error}") from error


def _json(data: bytes) -> dict[str, Any]:
    try:
        parsed = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise ModesFileError(f"not valid JSON: {error}") from error
    if not isinstance(parsed, dict):
        raise ModesFileError("expected an object with the keys of the neutral file")
    return parsed


def _neutral(data: Mapping[str, Any]) -> Raw:
    """What the neutral file holds.

    Raises:
        ModesFileError: a key is missing, unknown or of another shape than it should be.
    """
    if str(data.get("format", "")) != FORMAT:
        raise ModesFileError(f"key 'format': expected '{FORMAT}'")
    known_keys = ("format", *_REQUIRED, *_OPTIONAL)
    for name in data:
        if name not in known_keys and not name.startswith(("cells_", "set_")):
            raise ModesFileError(f"unknown key '{name}': expected {', '.join(known_keys)}, cells_…, set_…")
    for name, meaning in _REQUIRED.items():
        if name not in data:
            raise ModesFileError(f"key '{name}' is missing{meaning}")
        if name in ("unit", "mass_unit") and not str(data[name]).strip():
            raise ModesFileError(f"key '{name}' is empty{meaning}")
    arrays = _arrays(data)
    speeds, masses = arrays["speeds_rpm"], arrays["modal_masses"]
    points, frequencies = arrays["nodes"], arrays["frequencies_hz"]
    if np.unique(speeds).size < speeds.size or speeds.size == 0 or not (np.isfinite(speeds) & (speeds >= 0.0)).all():
        raise ModesFileError("key 'speeds_rpm': expected different speeds, 0 or above")
    if not (np.isfinite(masses).all() and masses.min(initial=1.0) > 0.0):
        raise ModesFileError("key 'modal_masses': expected masses above 0, 1 of shapes that are mass-normalised")
    for name, below in (("damping_ratios", 1.0), ("frequency_errors", np.inf)):
        if name in arrays and not ((arrays[name] >= 0.0) & (arrays[name] < below)).all():
            raise ModesFileError(f"key '{name}': expected numbers of 0 or above{', and below 1' * (below == 1.0)}")
    norm = np.sqrt(masses)[:, :, None, None]
    scales = {"shapes": norm, "rotations": norm, "drawn": norm[..., 0]}
    own = {"shapes": "shapes", **_KEYS}
    whole = {field: arrays[name] / scales.get(name, 1.0) for field, name in own.items() if name in arrays}
    known = tuple(
        ModesAtSpeed(float(from_rpm(speeds[k])), frequencies[k], **{name: values[k] for name, values in whole.items()})
        for k in np.argsort(speeds)
    )
    if ("axis" in arrays) != ("origin" in arrays):
        raise ModesFileError("keys 'axis' and 'origin': expected both or neither")
    axis = arrays.get("axis", np.array([0.0, 0.0, 1.0]))
    if not np.linalg.norm(axis) > 0.0:
        raise ModesFileError("key 'axis': expected a direction")
    nodes = len(points)
    labels = _whole(data, "node_labels", str(nodes), (nodes,)) if "node_labels" in data else None
    if labels is not None and np.unique(labels).size < nodes:
        raise ModesFileError("key 'node_labels': two nodes have the same number")
    sets = {
        name.removeprefix("set_"): _whole(data, name, "a list of", (None,), nodes)
        for name in data
        if name.startswith("set_")
    }
    origin = arrays.get("origin", np.zeros(3))
    model = ModalModel(points, known, axis / np.linalg.norm(axis), origin, _cells(data, nodes), sets, labels)
    return Raw(model, str(data["unit"]), str(data["mass_unit"]), "axis" in arrays)


def _arrays(data: Mapping[str, Any]) -> dict[str, Array]:
    """The arrays of a file by key, whose shapes agree."""
    sizes: dict[int | str, int | None] = {3: 3}
    arrays = {}
    for name, lengths in _SHAPES.items():
        if name in data:
            array = _array(data[name], name, tuple(sizes.get(length) for length in lengths))
            arrays[name] = array
            sizes |= dict(zip(lengths, array.shape, strict=True))
    return arrays


def _array(values: Any, name: str, shape: tuple[int | None, ...]) -> Array:
    """An array of the file; None in a shape is any number."""
    try:
        if np.iscomplexobj(np.asarray(values)):
            raise ModesFileError(f"key '{name}': complex values, expected real modes, of the undamped structure")
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        if isinstance(error, ModesFileError):
            raise
        raise ModesFileError(f"key '{name}': expected numbers, rows of the same length") from error
    if not _fits(array.shape, shape):
        wanted = " × ".join("any" if want is None else str(want) for want in shape)
        have = " × ".join(map(str, array.shape))
        raise ModesFileError(f"key '{name}': expected {wanted} numbers, found {have}")
    if name in _OPTIONAL and not np.isfinite(array).all():
        raise ModesFileError(f"key '{name}': expected finite numbers")
    return array


def _fits(shape: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    return len(shape) == len(wanted) and all(want in (None, have) for have, want in zip(shape, wanted, strict=True))


def _whole(
    data: Mapping[str, Any], name: str, expected: str, shape: tuple[int | None, ...], below: int | None = None
) -> Ints:
    """Whole numbers of the file, from 0 to before another."""
    try:
        numbers = np.asarray(data[name])
    except ValueError as error:
        raise ModesFileError(f"key '{name}': expected rows of the same length") from error
    if not _fits(numbers.shape, shape) or numbers.shape == (0,) or not np.issubdtype(numbers.dtype, np.integer):
        raise ModesFileError(f"key '{name}': expected {expected} whole numbers")
    if below is not None and numbers.size and not (numbers.min() >= 0 and numbers.max() < below):
        raise ModesFileError(f"key '{name}': expected rows of 'nodes', from 0 to {below - 1}")
    return numbers.astype(np.int64)


def _cells(data: Mapping[str, Any], nodes: int) -> tuple[tuple[str, Ints], ...]:
    cells = []
    for name in (name for name in data if name.startswith("cells_")):
        kind = name.removeprefix("cells_")
        if kind not in KINDS:
            raise ModesFileError(f"key '{name}': expected cells_ and one of {', '.join(KINDS)}")
        count = len(cell(kind).nodes)
        cells.append((kind, _whole(data, name, f"rows of {count}", (None, count), nodes)))
    return tuple(cells)


def in_si(raw: Raw, length: float, mass: float) -> ModalModel:
    """The model of a file in m and kg.

    Args:
        raw: as read.
        length: m to the file's unit of length.
        mass: kg to the file's unit of mass.
    """
    root = float(np.sqrt(mass))
    factors = {"static": length, "rotations": 1.0 / (length * root), "drawn": root}
    speeds = []
    for modes in raw.model.speeds:
        known = ((name, getattr(modes, name)) for name in factors)
        scaled = {name: values * factors[name] for name, values in known if values is not None}
        speeds.append(replace(modes, shapes=modes.shapes / root, **scaled))
    return replace(raw.model, points=raw.model.points * length, origin=raw.model.origin * length, speeds=tuple(speeds))


def joined(models: Sequence[ModalModel]) -> ModalModel:
    """One structure of several files, each with the modes of one speed, which is known; ascending.

    No load displaces it at rest: where files of other speeds have a static displacement, that is 0 there.

    Raises:
        ModesFileError: their nodes are not the same, or two are of one speed.
    """
    first = models[0]
    for other in models[1:]:
        same = other.points.shape == first.points.shape
        if not same or np.abs(other.points - first.points).max() > _SAME_PLACE * first.size:
            raise ModesFileError(
                "the files do not have the same nodes: expected one mesh at all speeds, with undeformed coordinates"
            )
    speeds = sorted((modes for model in models for modes in model.speeds), key=lambda modes: modes.omega)
    for one, other_modes in pairwise(speeds):
        if other_modes.omega - one.omega <= SAME_SPEED * max(other_modes.omega, 1.0):
            raise ModesFileError(f"two files have the same speed, {in_rpm(one.omega):g} rpm")
    if any(modes.static is not None for modes in speeds):
        zero = np.zeros_like(first.points)
        speeds = [replace(m, static=zero) if m.static is None and m.omega == 0.0 else m for m in speeds]
    return replace(first, speeds=tuple(speeds))


_SAME_PLACE = 1e-5
"""Difference of coordinates, relative to the structure, that digits of a file leave."""


def document(model: ModalModel) -> dict[str, Any]:
    """The neutral file of a model, key by key, in m and kg; shapes of modal mass 1.

    Raises:
        ValueError: what is known differs from speed to speed.
    """
    speeds = model.speeds
    count = min(modes.frequencies_hz.size for modes in speeds)
    entries: dict[str, Any] = {
        "format": FORMAT,
        "unit": "m",
        "mass_unit": "kg",
        "axis": model.axis,
        "origin": model.origin,
        "speeds_rpm": np.array([_rpm(modes.omega) for modes in speeds]),
        "nodes": model.points,
        "frequencies_hz": np.array([modes.frequencies_hz[:count] for modes in speeds]),
        "shapes": np.array([modes.shapes[:count] for modes in speeds]),
        "modal_masses": np.ones((len(speeds), count)),
    }
    if model.labels is not None:
        entries["node_labels"] = model.labels
    for name, key in _KEYS.items():
        parts = [getattr(modes, name) for modes in speeds]
        if all(part is not None for part in parts):
            entries[key] = np.array([part if name == "static" else part[:count] for part in parts])
    entries |= {f"cells_{name}": cells for name, cells in model.cells}
    return entries | {f"set_{name}": rows for name, rows in model.sets.items()}


def _rpm(omega: float) -> float:
    """Turns a minute that give back the speed in rad/s, bit for bit where there are any."""
    rpm = float(in_rpm(omega))
    tidy = float(f"{rpm:.13g}")
    near = (tidy, rpm, np.nextafter(rpm, np.inf), np.nextafter(rpm, 0.0))
    return next((float(each) for each in near if from_rpm(float(each)) == omega), rpm)


def write(model: ModalModel, path: Path) -> None:
    """Write the neutral file of a model, .npz or .json by the end of the name.

    Raises:
        ValueError: another end of the name.
        OSError: it cannot be written.
    """
    entries = document(model)
    if path.suffix.lower() == ".npz":
        with path.open("wb") as file:
            np.savez_compressed(file, **entries)
    elif path.suffix.lower() == ".json":
        path.write_text(json.dumps(entries, default=np.ndarray.tolist, allow_nan=False) + "\n", encoding="utf-8")
    else:
        raise ValueError(f"expected a name that ends in .npz or .json, got {path.name}")
