"""Why a plate has no solution, in the words of its scene."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from workflows.errors import NoAnswer
from workflows.scene.file import SceneFile


@contextmanager
def answering(source: SceneFile) -> Iterator[None]:
    """Say of what has no solution why, in the words of the scene.

    Raises:
        NoAnswer: the plate diverges, has no equilibrium, or is too thin for its theory in double precision.
    """
    from fem import Divergence, NoEquilibrium, NotConverged, SingularMatrix, Unresolved

    try:
        yield
    except Divergence as error:
        found = f"{source.name}: {error}; no speed asked for is below the critical one"
        raise NoAnswer(". ".join((found, *source.remarks))) from error
    except NoEquilibrium as error:
        raise NoAnswer(f"{source.name}: {error}") from error
    except Unresolved as error:
        raise NoAnswer(f"{source.name}: [plate] theory, thickness: {error}") from error
    except (SingularMatrix, NotConverged) as error:
        raise NoAnswer(f"{source.name}: the plate's equations have no solution in floating point: {error}") from error
