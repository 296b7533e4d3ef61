"""What somebody points at: a folder of results, a scene, a mesh file."""

from __future__ import annotations

from pathlib import Path

from workflows.errors import BadInput
from workflows.looking import of_mesh, of_results, of_scene
from workflows.looking.sight import Sight


def of(target: str, rpm: float | None = None) -> Sight:
    """What a folder of results, a scene or a mesh file shows; `rpm`: the one speed that a scene is solved at.

    Raises:
        BadInput: it is none of these, or it has no plate.
        NoAnswer: the scene's physics has none.
    """
    path = Path(target)
    try:
        folder, file = path.is_dir(), path.is_file()
    except (OSError, ValueError) as error:
        raise BadInput("expected a folder of results, a scene or a mesh file", file=target) from error
    if folder:
        return of_results.sight(path)
    if file and path.suffix.lower() != ".toml":
        return of_mesh.sight(path)
    if not file and path.suffix.lower() not in ("", ".toml"):
        raise BadInput("no such folder of results, scene or mesh file", file=target)
    return of_scene.sight(target, rpm)
