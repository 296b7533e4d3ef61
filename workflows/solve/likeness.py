"""What a plate takes, told by smaller ones like it: its sides, modes and effects, in few cells of the same kind.

Where the first meshes of a search are too large to be tried beforehand.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from workflows.solve import needs

if TYPE_CHECKING:
    from fem import Given
    from fem.meshes.ladder import Planform
    from workflows.solve.decided import Decided

UNKNOWNS = 2000, 8000
"""Of the plates that are solved for this; the larger takes a second or two, and is left out where it would not."""

_SHEARED = 0.1
"""Slope of cells that stand for such as are no rectangles."""


def like(decided: Decided, model: str, unknowns: float) -> Decided:
    """The same scene on a small plate of about so many unknowns."""
    form, theory = decided.plate
    return replace(decided, form=alike(form, model, unknowns), theory=theory)


def alike(form: Planform, model: str, unknowns: float) -> Given:
    """One mesh of about so many unknowns in cells like those of a planform, over all that encloses it."""
    from fem import Given, rectangle
    from fem.theory.kirchhoff import is_rectangles

    class Alone(Given):
        """A planform without other meshes."""

        @property
        def sizes(self) -> tuple[int, ...]:
            return (1,)

    own, (length, width) = form.mesh(form.sizes[0]), form.sides
    cells = unknowns * own.t.shape[1] / needs.unknowns(model, own)
    if own.t.shape[0] == 3:
        cells *= 0.5  # of quadrilaterals, each of which becomes two triangles
    along = max(1, round((cells * length / width) ** 0.5))
    mesh = rectangle(length, width, along, max(1, round(cells / along)))
    points = mesh.p + own.p.min(axis=1, keepdims=True) - mesh.p.min(axis=1, keepdims=True)
    if own.t.shape[0] == 3:
        return Alone(type(mesh)(points, mesh.t).to_meshtri(), thickness=getattr(form, "thickness", None))
    if not is_rectangles(own):
        points[1] += _SHEARED * (points[0] - points[0].min())
    return Alone(type(mesh)(points, mesh.t), thickness=getattr(form, "thickness", None))
