"""A finished run as one file, from which it comes back as it was, to the last bit.

The records become a tree of plain JSON in which each says what it is; arrays lie beside it, by number. Nothing in the
file is ever run: names of records are looked up in a table.
"""

from __future__ import annotations

import json
import os
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

from workflows.effects.effect import Effect
from workflows.effects.left_out import LeftOut
from workflows.errors import BadInput
from workflows.scene.file import parse
from workflows.scene.scene import Scene
from workflows.solve import records
from workflows.solve.structure_records import Theory

NAME = "run.npz"
VERSION = 2

Arrays = list[npt.NDArray[Any]]

_OURS = (Effect, LeftOut, Theory, *(kind for kind in vars(records).values() if is_dataclass(kind)))
_KINDS: dict[str, Any] = {kind.__name__: kind for kind in _OURS if isinstance(kind, type)}
"""Records that a file may hold, by name."""


def write(results: records.Results, path: Path) -> None:
    """Keep a run but for its times, which stand in `results.json`: the same scene keeps the same bits.

    Raises:
        OSError: the file system refuses.
    """
    arrays: Arrays = []
    tree = _packed(replace(results, timings={}), arrays)
    text = json.dumps({"version": VERSION, "run": tree}, ensure_ascii=False)
    named = {f"array_{number}": array for number, array in enumerate(arrays)}
    np.savez_compressed(path, tree=np.frombuffer(text.encode(), np.uint8), **named)  # type: ignore[arg-type]


def read(folder: str | os.PathLike[str]) -> records.Results:
    """What a run left in a folder, or in its file `run.npz`.

    Raises:
        BadInput: there is no run of ours, or one of another version.
        TypeError: not the name of a folder.
    """
    if not isinstance(folder, str | os.PathLike):
        raise TypeError(f"load_results takes the name of a folder that a run has written, got {type(folder).__name__}")
    given = Path(folder)
    path = given / NAME if given.is_dir() else given
    try:
        with path.open("rb") as file, np.load(file) as kept:
            document = json.loads(kept["tree"].tobytes())
            arrays = [kept[f"array_{number}"] for number in range(len(kept.files) - 1)]
        if document["version"] != VERSION:
            raise _unreadable(given, f"has version {document['version']} of what a run keeps: expected {VERSION}")
        found = _unpacked(document["run"], arrays)
    except FileNotFoundError:
        raise _unreadable(
            given, f"holds no run: expected a folder with {NAME}, as `spindamp run --out` writes"
        ) from None
    except OSError as error:
        raise _unreadable(given, f"cannot be read: {error.strerror or error}") from error
    except (BadZipFile, ValueError, KeyError, IndexError, TypeError, EOFError) as error:
        raise _unreadable(given, f"is not what a run of ours keeps: {error}") from error
    if not isinstance(found, records.Results):
        raise _unreadable(given, "is not what a run of ours keeps")
    return replace(found, timings=_timings(path))


def _timings(path: Path) -> dict[str, float]:
    """What the stages took, from the file beside; nothing where that is gone."""
    try:
        return dict(json.loads(path.with_name("results.json").read_text(encoding="utf-8"))["timings"])
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def _unreadable(path: Path, problem: str) -> BadInput:
    return BadInput(problem, key="folder", value=str(path))


def _packed(value: Any, arrays: Arrays) -> Any:
    if value is None or isinstance(value, bool | int | float | str):
        return value.item() if isinstance(value, np.generic) else value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        arrays.append(value)
        return {"array": len(arrays) - 1}
    if isinstance(value, tuple | list):
        return {type(value).__name__: [_packed(item, arrays) for item in value]}
    if isinstance(value, dict):
        return {"dict": [[_packed(key, arrays), _packed(item, arrays)] for key, item in value.items()]}
    if isinstance(value, Scene):
        return {"scene": _scene(value)}
    kind = next(known.__name__ for known in type(value).__mro__ if _KINDS.get(known.__name__) is known)
    return {"record": kind, "fields": {f.name: _packed(getattr(value, f.name), arrays) for f in fields(value)}}


def _scene(scene: Scene) -> dict[str, Any]:
    """The scene as one that can be read again: a material by its name has no numbers beside it."""
    data = scene.model_dump(mode="json", exclude_none=True)
    for table, name, numbers in (
        ("material", "name", ("youngs_modulus", "poissons_ratio", "density")),
        ("damper", "ball_material", ("ball_density",)),
    ):
        if name in data.get(table, {}):
            data[table] = {key: item for key, item in data[table].items() if key not in numbers}
    return data


def _unpacked(tree: Any, arrays: Arrays) -> Any:
    if not isinstance(tree, dict):
        return tree
    if "array" in tree:
        return arrays[tree["array"]]
    if "scene" in tree:
        return parse(tree["scene"])
    if "dict" in tree:
        return {_unpacked(key, arrays): _unpacked(item, arrays) for key, item in tree["dict"]}
    if "record" in tree:
        return _KINDS[tree["record"]](**{name: _unpacked(item, arrays) for name, item in tree["fields"].items()})
    ((name, items),) = tree.items()
    made = [_unpacked(item, arrays) for item in items]
    return tuple(made) if name == "tuple" else made
