"""From a TOML file, or the name of a shipped scene, to a validated scene; what is wrong with it in words; schema."""

from __future__ import annotations

import hashlib
import json
import os
import re
import stat
import tomllib
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from pathlib import Path
from typing import Any, TypeAlias

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic.json_schema import GenerateJsonSchema

from workflows import docstrings
from workflows.errors import BadInput, did_you_mean
from workflows.formatting import revolutions
from workflows.scene import quantities
from workflows.scene.materials import PLATES
from workflows.scene.quantities import Table, hints
from workflows.scene.scene import Scene


@dataclass(frozen=True)
class SceneFile:
    """A scene and where it came from: `name` for messages, `folder` for the files it names.

    `remarks` are on how it is written, and lost where it becomes a `Scene`; `written`: its tables as they were written.
    """

    scene: Scene
    name: str
    folder: Path
    remarks: tuple[str, ...] = ()
    written: Mapping[str, Any] = field(default_factory=dict, compare=False, repr=False)

    @property
    def mesh(self) -> Path | None:
        """The mesh file that plate or blade name, relative to the scene's folder."""
        meshed = self.scene.plate or self.scene.blade
        return None if meshed is None or meshed.mesh is None else self.folder / meshed.mesh

    @property
    def files(self) -> tuple[Path, ...]:
        """What its structure comes from: that file and what it includes, or files of known modes."""
        if self.scene.known is not None:
            return tuple(self.folder / name for name in self.scene.known.files.values())
        if self.mesh is None:
            return ()
        from fem.meshes.read import files_of

        return tuple(files_of(self.mesh))

    @cached_property
    def files_sha256(self) -> str | None:
        """Their digest; they are read once."""
        return sha256_of(self.files)

    def plate_alone(self) -> SceneFile:
        """The same without the damper; a housing stays, a part of the point mass at the damper's place."""
        damper, mass, alone = self.scene.damper, self.scene.point_mass, self.changed(damper=None, release=None)
        if self.scene.plate is None or damper is None or not mass:
            return alone
        return alone.changed(plate={"tip_mass": mass, "tip_mass_at": damper.on_plate})

    def with_full_paths(self) -> SceneFile:
        """The same with the full paths of the files it names, for a copy in another folder."""
        tables: dict[str, dict[str, Any]] = {}
        for table, _, key in (name.partition(".") for name in FILES):
            names = getattr(getattr(self.scene, table), key, None)
            if isinstance(names, str):
                tables[table] = {key: self._full(names)}
            elif names is not None:  # by speeds
                tables[table] = {key: {speed: self._full(name) for speed, name in names.items()}}
        return self.changed(**tables)

    def _full(self, name: str) -> str:
        return str((self.folder / name).resolve())

    def wrong(self, problem: str, key: str, value: object = None) -> BadInput:
        """The error of one of its keys."""
        return BadInput(problem, file=self.name, key=key, value=value)

    @contextmanager
    def blaming(self, key: str, value: object, *errors: type[Exception]) -> Iterator[None]:
        """What fails inside with one of these errors is the fault of one of its keys, which names the mesh file."""
        try:
            yield
        except errors as error:
            raise self.wrong(str(error).removeprefix(f"{self.mesh}: "), key, value) from error

    def changed(self, **tables: Table | Mapping[str, Any] | None) -> SceneFile:
        """The same with another scene; see :meth:`Scene.changed`."""
        return replace(self, scene=self.scene.changed(**tables))


def sha256_of(files: Iterable[Path]) -> str | None:
    """SHA-256 of the bytes of a file, or of the digests of several, of those there are; None of none."""
    digests = []
    for path in filter(Path.is_file, files):
        with path.open("rb") as file:
            digests.append(hashlib.file_digest(file, "sha256").hexdigest())
    if len(digests) < 2:
        return digests[0] if digests else None
    return hashlib.sha256("".join(digests).encode()).hexdigest()


FILES = ("plate.mesh", "blade.mesh", "structure.modes")
"""Keys that name files."""

SHIPPED = Path(__file__).parents[1] / "scenes"
DEFAULT = "paper"
_MESHES = {".msh", ".vtu", ".vtk", ".inp", ".bdf", ".nas", ".fem", ".xdmf", ".stl", ".step", ".stp", ".iges", ".igs"}
"""How names of meshes end, and of geometry that is taken for one."""

_OF_MODES = (".frd", ".frd.gz", ".npz", ".rst", ".op2", ".unv")
"""How names of files of modes end."""

_LARGEST = 1_000_000
"""Bytes; no scene written by hand comes near."""


SceneLike: TypeAlias = str | os.PathLike[str] | Mapping[str, Any] | Scene | SceneFile
"""A scene as Python calls take it: the name of a shipped one, a file's path, a dict, or one that is already read."""


def shipped() -> list[str]:
    """Names of the scenes that come with the package."""
    return sorted(path.stem for path in SHIPPED.glob("*.toml"))


def as_scene_file(scene: SceneLike) -> SceneFile:
    """A scene however it is given; the mesh of one that comes from no file is looked for from the current folder.

    Raises:
        BadInput: see :func:`load`.
        TypeError: it is no scene.
    """
    if isinstance(scene, SceneFile):
        return scene
    if isinstance(scene, str | os.PathLike):
        return load(scene)
    if isinstance(scene, Scene):
        return _with_its_mesh(SceneFile(scene, "scene", Path.cwd()))
    if isinstance(scene, Mapping):
        plain = _plain(scene)
        return _with_its_mesh(SceneFile(parse(plain), "scene", Path.cwd(), _remarks(plain), plain))
    raise TypeError(
        f"expected a scene's name or path, a dict, a Scene or what load returns, got {type(scene).__name__}"
    )


def load(where: str | os.PathLike[str] = DEFAULT) -> SceneFile:
    """Read and validate a scene.

    Args:
        where: a TOML file, or the name of a shipped scene.

    Raises:
        BadInput: no such file, not TOML, or a scene that is wrong; names file, key and value.
        TypeError: neither a name nor a path.
    """
    if not isinstance(where, str | os.PathLike):
        raise TypeError(f"load takes a scene's name or path, got {type(where).__name__}")
    if not os.fspath(where).strip():
        raise BadInput(f"expected the path of a scene, or the name of a shipped one: {', '.join(shipped())}")
    path = Path(where)
    if path.suffix.lower() in _MESHES and path.is_file():
        problem = f'a mesh, not a scene: name it in a scene as [plate] mesh = "{path.name}" (or [blade] mesh)'
        raise BadInput(f"{problem}, or look at it with `spindamp view {where}`", file=str(where))
    if path.name in ("results.json", "results.nc") and path.is_file():
        problem = "results of a run, not a scene: commands that read a run take its folder"
        raise BadInput(f"{problem}, '{path.parent}'", file=str(where))
    if path.name.lower().endswith(_OF_MODES) and path.is_file():
        problem = f'a file of modes, not a scene: name it in a scene as [structure] modes = "{path.name}"'
        raise BadInput(problem, file=str(where))
    if str(where) in shipped() and not path.is_file():
        path, name = SHIPPED / f"{where}.toml", f"{where}.toml"
    else:
        name = str(where)
    text = _read(path, name)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        hint = next((f": {hint}" for what, hint in hints()["toml"].items() if what in str(error)), "")
        raise BadInput(f"not valid TOML: {error}{hint}", file=name) from error
    except ValueError as error:  # a whole number longer than Python converts
        raise BadInput("not a scene: a number has too many digits", file=name) from error
    except RecursionError as error:
        raise BadInput("not a scene: nested too deeply", file=name) from error
    return _with_its_mesh(SceneFile(parse(data, name), name, path.resolve().parent, _remarks(data), data))


def parse(data: Mapping[str, Any], name: str = "scene") -> Scene:
    """Validate a scene that is already a mapping, such as one from a notebook; values of NumPy and paths will do.

    Raises:
        BadInput: the scene is wrong; the message names `name`, the key and the value.
        TypeError: not a mapping.
    """
    if not isinstance(data, Mapping):
        raise TypeError(f"parse takes a dict of the scene's tables, got {type(data).__name__}")
    plain = _plain(data)
    try:
        return Scene.model_validate(plain, context={"gravity": _gravity(plain)})
    except ValidationError as error:
        raise bad_input(error, plain, name) from None


def _plain(value: Any, depth: int = 5) -> Any:
    """Values as TOML has them, as deep as a scene goes: a table, one in it, a key, a list of lists, a value."""
    if depth and isinstance(value, Mapping):
        return {key: _plain(item, depth - 1) for key, item in value.items()}
    if depth and isinstance(value, list | tuple):
        return [_plain(item, depth - 1) for item in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    try:
        return value.tolist() if hasattr(value, "tolist") else value  # of NumPy
    except AttributeError:  # a quantity of another library, whose number is no array
        return str(value)


def _read(path: Path, name: str) -> str:
    try:
        problem = non_file_kind(path)
        if problem:
            results = ": `spindamp view` shows results" if (path / "results.json").is_file() else ""
            raise BadInput(f"expected a scene file, found {problem}{results}", file=name)
        with path.open("rb") as file:
            raw = file.read(_LARGEST + 1)
    except FileNotFoundError:
        names = [*shipped(), *(p.name for p in path.parent.glob("*.toml"))] if path.parent.is_dir() else shipped()
        if path.is_symlink():
            raise BadInput(f"a link to {os.readlink(path)}, which does not exist", file=name) from None
        raise BadInput(f"no such scene{did_you_mean(path.name, names)}", file=name) from None
    except (OSError, ValueError) as error:
        raise BadInput(f"cannot be read: {getattr(error, 'strerror', None) or error}", file=name) from None
    if len(raw) > _LARGEST:
        kind = "results" if path.suffix in (".json", ".nc") else "a file"
        raise BadInput(f"not a scene: {kind} of more than {_LARGEST} bytes", file=name)
    if not raw.strip():
        raise BadInput("the file is empty: expected a scene, such as `spindamp check paper` prints", file=name)
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise BadInput("not a scene: not UTF-8 text", file=name) from None


def non_file_kind(path: Path) -> str:
    """What is at `path` instead of a file, in words; empty for a file. A pipe or a device could be read for ever.

    Raises:
        OSError: there is nothing, or it may not be looked at.
    """
    mode = path.stat().st_mode
    if stat.S_ISREG(mode):
        return ""
    if stat.S_ISDIR(mode):
        return "a folder"
    return "a pipe" if stat.S_ISFIFO(mode) else "a device" if stat.S_ISCHR(mode) or stat.S_ISBLK(mode) else "a socket"


def _gravity(data: Mapping[str, Any]) -> float:
    """[rotor] gravity, needed to read accelerations in g; a wrong one is reported by its own field."""
    try:
        return quantities.to_si(data["rotor"]["gravity"], quantities.ACCELERATION)
    except (LookupError, TypeError, quantities.UnitError):
        return quantities.STANDARD_GRAVITY


def _remarks(data: Mapping[str, Any]) -> tuple[str, ...]:
    """Remarks on how a scene, which is valid, is written."""
    speeds = data["rotor"]["speeds"]
    return speed_remarks([speeds["start"], speeds["stop"]] if isinstance(speeds, Mapping) else speeds)


def speed_remarks(speeds: Iterable[Any]) -> tuple[str, ...]:
    """A remark on speeds, as they are written, of which some have no unit: they are seldom meant in rad/s."""
    bare = [speed for speed in speeds if speed and not isinstance(speed, str)]
    if not bare:
        return ()
    fastest = max(bare)
    return (
        f"Speeds without a unit are in rad/s: {fastest:g} is {revolutions([fastest])}. Was '{fastest:g} rpm' meant?",
    )


def _with_its_mesh(scene: SceneFile) -> SceneFile:
    """The same, once the mesh file that it may name is seen to be there."""
    if scene.mesh is not None and (problem := file_problem(scene.mesh, "mesh file")):
        table = "plate" if scene.scene.blade is None else "blade"
        raise scene.wrong(problem, f"[{table}] mesh", getattr(scene.scene, table).mesh)
    return scene


def file_problem(path: Path, what: str) -> str:
    """What keeps a file that a scene names from being read, before anything is read; empty if nothing does."""
    try:
        problem = non_file_kind(path)
        if problem:
            return f"expected a {what}, found {problem}"
        with path.open("rb") as file:
            return "" if file.read(1) else "the file is empty"
    except FileNotFoundError:
        return "a link to a file that does not exist" if path.is_symlink() else "no such file beside the scene"
    except (OSError, ValueError) as error:
        return f"cannot be read: {getattr(error, 'strerror', None) or error}"


_LISTED = 20
"""Unknown keys that are named in one message."""

_DIAMETERS = ("diameter", "ball_diameter")


def bad_input(error: ValidationError, data: Mapping[str, Any], name: str) -> BadInput:
    """The most telling of pydantic's errors, with every unknown key."""
    # A misspelt key makes the right one missing as well: the misspelling is the cause.
    order = {"extra_forbidden": 0, "missing": 2}
    errors = sorted(error.errors(include_url=False), key=lambda e: order.get(e["type"], 1))
    first = errors[0]
    loc = _keys(first)
    problem, value = error_text(first, loc), _lookup(data, loc)
    unknown = [fault for fault in errors[1:] if fault["type"] == "extra_forbidden"]
    rest = [fault for fault in errors[1:] if fault["type"] == first["type"] or fault["type"] not in order]
    if unknown:
        problem += f"; also unknown: {', '.join(map(_in_a_list, unknown[:_LISTED]))}"
        problem += f" and {len(unknown) - _LISTED} more" if len(unknown) > _LISTED else ""
    elif rest:
        problem += "".join(f"; also {_named(fault)}" for fault in rest[:_LISTED])
        problem += f"; and {len(rest) - _LISTED} more" if len(rest) > _LISTED else ""
    if first["type"] == "extra_forbidden" and len(loc) == 1 and isinstance(first["input"], Mapping):
        return BadInput(problem, file=name, key=f"[{loc[0]}]")
    return BadInput(problem, file=name, key=key_name(loc), value=value)


def _keys(error: Any) -> list[str]:
    """The keys that lead to an error; marks of alternatives are in brackets, which no key is."""
    loc = [part for part in map(str, error["loc"]) if not part.startswith("[")]
    return loc + str(error["ctx"]["key"]).split(".") if error["type"] == "together" else loc


def _named(error: Any) -> str:
    """A further error with its key."""
    loc = _keys(error)
    return f"{key_name(loc)}: {'missing' if error['type'] == 'missing' else error_text(error, loc)}"


def _in_a_list(error: Any) -> str:
    loc = [part[:80] for part in _keys(error)]
    key = f"[{loc[0]}]" if len(loc) == 1 and isinstance(error["input"], Mapping) else key_name(loc)
    hint = _unknown(error, loc)
    return f"{key} ({hint.removeprefix(': ')})" if hint else key


def error_text(error: Any, loc: list[str]) -> str:
    """One of pydantic's errors in our words; `loc`: the keys that lead to it."""
    context = error.get("ctx", {})
    match error["type"]:
        case "extra_forbidden":
            what = "table" if len(loc) == 1 and isinstance(error["input"], Mapping) else "key"
            return f"unknown {what}{_unknown(error, loc)}"
        case "missing":
            named = loc[0] == "material" and len(loc) == 2
            return f"missing (or give the material's name: {', '.join(PLATES)})" if named else f"missing{_meant(loc)}"
        case "literal_error":
            value, expected = error["input"], context["expected"]
            names = expected.split("'")[1::2]
            return f"expected {expected}{did_you_mean(value, names) if isinstance(value, str) else ''}"
        case kind if kind in hints()["errors"]:
            return hints()["errors"][kind].format(**context)
        case _:
            text = str(error["msg"])
            return text[:1].lower() + text[1:]


def _unknown(error: Any, loc: list[str]) -> str:
    """What was probably meant by an unknown key."""
    known = hints()
    shape = known["also_called"].get(loc[-1], loc[-1])
    if loc[0] in ("plate", "rotor") and shape in known["shape"]:
        return f": {known['shape'][shape]}"
    if hint := instead(loc):
        return hint
    if loc[0] == "damper" and loc[-1] in _DIAMETERS:
        half = quantities.halved(error["input"], quantities.LENGTH)
        return f": a ball is given by its radius{f', here radius = {half}' if half else ', half its diameter'}"
    beside = [name for table, _, name in (path.rpartition(".") for path in keys()) if table == ".".join(loc[:-1])]
    return did_you_mean(loc[-1], beside) or _belongs(loc[-1])


def instead(loc: list[str]) -> str:
    """What a scene has instead of a key that people take for one; empty where nothing is known."""
    known = hints()["keys"]
    hint = known.get(".".join(loc)) or known.get(loc[-1])
    return f": {hint}" if hint else ""


def _meant(loc: list[str]) -> str:
    """What a key that is missing means, and which keys a table needs."""
    if len(loc) > 2 or ".".join(loc) not in keys():
        return ""
    table, field = keys()[".".join(loc)]
    inner = _tables_of(field)
    needs = [name for table in inner for name, key in table.model_fields.items() if key.is_required()]
    needed = f"; it needs {', '.join(needs)}" if len(loc) == 1 and needs else ""
    return f": {docstrings.of_fields(table)[loc[-1]]}{needed}"


def key_name(loc: list[str]) -> str:
    """``[plate] length`` from ("plate", "length")."""
    if len(loc) == 1 and loc[0] in Scene.model_fields and loc[0] != "title":
        return f"[{loc[0]}]"
    return loc[0] if len(loc) == 1 else f"[{loc[0]}] {'.'.join(loc[1:])}"


def _lookup(data: Any, loc: list[str]) -> object:
    for part in loc:
        if not isinstance(data, Mapping) or part not in data:
            return None
        data = data[part]
    return None if isinstance(data, Mapping) and len(loc) == 1 else data


@cache
def keys() -> dict[str, tuple[type[BaseModel], FieldInfo]]:
    """All keys of a scene by dotted path: the table that has each, and its field."""

    def listed(table: type[BaseModel], prefix: str) -> Iterator[tuple[str, tuple[type[BaseModel], FieldInfo]]]:
        for name, entry in table.model_fields.items():
            yield prefix + name, (table, entry)
            for inner in _tables_of(entry):
                yield from listed(inner, f"{prefix}{name}.")

    return dict(listed(Scene, ""))


def _tables_of(field: Any) -> list[type[BaseModel]]:
    """The tables that a key may hold."""
    models, kinds = [], [field.annotation]
    while kinds:
        kind = kinds.pop()
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            models.append(kind)
        kinds += getattr(kind, "__args__", ())
    return models


def _belongs(key: str) -> str:
    homes = [f"[{table}]" for table, _, name in (path.partition(".") for path in keys()) if name == key]
    return f": it belongs in {' or '.join(homes)}" if homes else ""


def slug(title: str) -> str:
    """A title as part of a folder's name."""
    plain = unicodedata.normalize("NFKD", title).replace("'", "").encode("ascii", "ignore").decode().lower()
    return "-".join(re.findall(r"[a-z0-9]+", plain))[:60].rstrip("-") or "run"


class _Described(GenerateJsonSchema):
    """Docstrings say what each key means, and its unit what a number alone is in."""

    def model_schema(self, schema: Any) -> dict[str, Any]:
        table = super().model_schema(schema)
        for name, text in docstrings.of_fields(schema["cls"]).items():
            key = table["properties"][name]
            si = unit(key)
            key["description"] = text if si is None else f"{text}; a number without a unit is in {si}"
        return table


def schema() -> dict[str, Any]:
    """The schema, from the same model that validates scenes."""
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    tables: dict[str, Any] = _tidied(Scene.model_json_schema(schema_generator=_Described))
    return head | tables | {"title": "spindamp scene"}


def unit(node: Any) -> str | None:
    """The SI unit of a quantity, however deep in the schema of its key it stands."""
    if isinstance(node, dict) and "x-si" in node:
        return str(node["x-si"])
    inner = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    return next((name for part in inner if (name := unit(part))), None)


_BOUNDS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}


def _tidied(node: Any) -> Any:
    """Bounds under their standard names, and no titles: pydantic titles every key after itself."""
    if isinstance(node, dict):
        tidy = {key: value for key, value in node.items() if key != "title" or isinstance(value, dict)}
        return {_BOUNDS.get(key, key): _tidied(value) for key, value in tidy.items()}
    return [_tidied(item) for item in node] if isinstance(node, list) else node


if __name__ == "__main__":
    text = json.dumps(schema(), indent=1, ensure_ascii=False)
    Path(__file__).parents[1].joinpath("scene.schema.json").write_text(text + "\n", encoding="utf-8")
