"""Whether a structure in space, its root and its spin axis are likely to be meant as they are, in remarks."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from fem.modal_model import ON_ONE_SIDE, ModalModel, root_to_centre
from workflows.formatting import percent, significant
from workflows.solve.results import Floats, Ints


def orientation_remarks(
    model: ModalModel, masses: Floats, root: Ints, name: str, inboard: Ints | None = None
) -> Iterator[str]:
    """Remarks on a structure that lies inboard of its root, along the spin axis, or out of the plane of rotation.

    Args:
        model: its nodes and spin axis.
        masses: of the nodes (n,), in any unit.
        root: numbers of the clamped nodes; without any, only the extents are judged.
        name: what it is called.
        inboard: numbers of nodes that the root cuts off from it; None: there are none.
    """
    arms = model.load(model.points)
    radii, whole = np.linalg.norm(arms, axis=1), masses.sum()
    if root.size:
        within = np.flatnonzero(radii < radii[root].min())
        within = within if inboard is None else np.setdiff1d(within, inboard)
        inside = float(masses[within].sum() / whole)
        if inside > 0.5:
            yield (
                f"Most of the {name} ({percent(inside, 0)} %) lies nearer the axis than its root: the load compresses"
                " it."
            )
    axial, across = (float(np.ptp(each)) for each in (model.points @ model.axis, radii))
    way = root_to_centre(model.points, masses, root)
    lean = 0.0 if way is None else math.asin(min(abs(float(way @ model.axis)), 1.0))
    if axial > _SLENDER * across and (way is None or lean > _ALONG):
        yield (
            f"The {name} measures {significant(1e3 * axial)} mm along the spin axis and {significant(1e3 * across)} mm"
            " across it: does [rotor] axis lie along the blade, where it should lie across it?"
        )
    elif lean > _LEANS and np.linalg.norm(arms.mean(axis=0)) > ON_ONE_SIDE * radii.mean():
        yield (
            f"The {name} leans by {significant(math.degrees(lean), 2)}° out of the plane of rotation, from the"
            " middle of its root to its centre of mass: is this intended, or is [rotor] axis wrong?"
        )


_LEANS = math.radians(15.0)
"""Lean out of the plane of rotation above which the axis is asked about: blades are coned by some degrees."""

_ALONG = math.radians(45.0)
"""Lean out of the plane of rotation above which a structure lies along the axis rather than across it."""

_SLENDER = 1.5
"""Extent along the spin axis over that across it above which the axis may lie along the structure."""
