"""Why a plate has no solution, in the terms of its scene."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

from workflows.errors import NoAnswer
from workflows.formatting import significant, whole
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile

_BORNE = 0.1
"""Average strain of the root beyond anything that small strains describe; metals yield at a tenth of it."""


@contextmanager
def translated_errors(source: SceneFile) -> Iterator[None]:
    """Say of what has no solution why, in the words of the scene.

    Raises:
        NoAnswer: the plate diverges, has no equilibrium, or is too thin for its theory in double precision.
    """
    from fem import Divergence, NoEquilibrium, NotConverged, SingularMatrix, Unresolved

    try:
        yield
    except Divergence as error:
        why = _overloaded(source) or "no speed asked for is below the critical one"
        raise NoAnswer(". ".join((f"{source.name}: [rotor] speeds: {error}; {why}", *source.remarks))) from error
    except NoEquilibrium as error:
        raise NoAnswer(f"{source.name}: [rotor] speeds, stagger: {error}") from error
    except Unresolved as error:
        keys = "[plate] theory, thickness" if error.loose is None else _soft(source)
        raise NoAnswer(f"{source.name}: {keys}: {error}") from error
    except (SingularMatrix, NotConverged) as error:
        why = _overloaded(source) or str(error)
        raise NoAnswer(
            f"{source.name}: [plate]: the plate's equations have no solution in floating point: {why}"
        ) from error


def _overloaded(source: SceneFile) -> str:
    """That a point mass pulls harder than any plate bears, with its key; empty where it does not."""
    scene = source.scene
    plate, material = scene.plate, scene.material
    if plate is None or material is None or plate.length is None or scene.point_mass == 0.0:
        return ""
    fastest = max(scene.rotor.speeds)
    pull = scene.point_mass * fastest**2 * (scene.rotor.hub_radius + plate.length)
    strain = pull / (material.youngs_modulus * plate_mesh.section(plate))
    if strain < _BORNE:
        return ""
    return (
        f"the point mass of {significant(scene.point_mass)} kg ([plate] tip_mass, [damper] housing) pulls at"
        f" {whole(fastest * 30 / math.pi)} rpm such that it would strain the root by {significant(100 * strain, 2)} %,"
        " which no plate bears: expected a lighter mass or lower speeds"
    )


def _soft(source: SceneFile) -> str:
    """The keys of a root's springs, and their values."""
    root = source.scene.plate.root if source.scene.plate is not None else None
    if root is None:
        return "[plate.root]"
    return f"[plate.root] stiffness = {root.stiffness:g}, rotational_stiffness = {root.rotational_stiffness:g}"
