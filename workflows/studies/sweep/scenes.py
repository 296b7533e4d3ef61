"""The scene of a point: the study's own with the point's values put in, checked as any scene is."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import replace

from workflows.errors import BadInput
from workflows.scene.file import parse
from workflows.scene.source import SceneFile
from workflows.studies.sweep import key_data
from workflows.studies.sweep.keys import CLEARANCE, SPEEDS, Data, Key, Value


def base(source: SceneFile, varied: Sequence[Key]) -> Data:
    """The study's scene as plain data, ready for these keys.

    Raises:
        BadInput: it lacks a table that a key belongs to.
    """
    data = key_data.written_out(key_data.plain(source.scene), varied)
    for key in varied:
        table = key.table[0]
        if table not in data:
            raise BadInput(f"the scene {source.name} has no [{table}]", key=f"--vary {key.name}")
    return data


def with_values(data: Data, values: Mapping[Key, Value]) -> Data:
    """A copy of plain data with values put in; clearances last, which add to the ball's diameter."""
    found = copy.deepcopy(data)
    for key in sorted(values, key=lambda key: key.name.startswith(CLEARANCE)):
        key.put(found, values[key])
    return found


def of_a_point(source: SceneFile, data: Data, speeds: Sequence[float]) -> SceneFile:
    """The scene of plain data at these speeds.

    Raises:
        BadInput: its values are wrong together.
    """
    table, name = SPEEDS.split(".")
    whole = data | {table: data[table] | {name: list(speeds)}}
    return replace(source, scene=parse(whole, source.name), remarks=())
