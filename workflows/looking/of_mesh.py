"""A mesh file to look at, as a scene's `mesh` would be read."""

from __future__ import annotations

from pathlib import Path

from workflows.errors import BadInput
from workflows.looking.mesh_facts import facts
from workflows.looking.sight import Sight
from workflows.solve.plate_records import bare
from workflows.wording import significant

_LONGEST = 5.0
"""Plates [m] beyond which the file is more likely in millimetres."""


def sight(path: Path) -> Sight:
    """The mesh of a file.

    Raises:
        BadInput: it is no mesh of a plate's mid-surface; the message says what is wrong.
    """
    from fem import MeshError, read_mesh

    try:
        mesh = read_mesh(path)
    except MeshError as error:
        raise BadInput(str(error).removeprefix(f"{path}: "), file=str(path)) from error
    surface = bare(mesh)
    words, numbers = facts(surface)
    return Sight(
        title=path.name,
        surface=surface,
        speeds=(),
        mark=None,
        thickness=None,
        root="clamped root",
        facts=(*words, ("unit", _unit(float(max(mesh.p.max(axis=1) - mesh.p.min(axis=1)))))),
        numbers=numbers,
    )


def _unit(side: float) -> str:
    taken = "a file is in metres, unless a scene's mesh_unit says otherwise"
    if side <= _LONGEST:
        return taken
    return f'{taken}; {significant(side, 3)} m is long: mesh_unit = "mm"?'
