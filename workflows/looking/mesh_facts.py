"""What a mesh is like: cells, extent, root, sizes and quality, in words and in numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from workflows.report.mode_viewer import loops
from workflows.solve.records import Floats, Surface
from workflows.wording import significant, whole

_SHARP, _BLUNT = 20.0, 150.0
"""Angles [degrees] within which a cell is of a good shape."""


def facts(surface: Surface) -> tuple[tuple[tuple[str, str], ...], dict[str, Any]]:
    """Name and words of each, and the same in SI for programs."""
    found = numbers(surface)
    (x0, x1), (y0, y1) = found["extent"]["x"], found["extent"]["y"]
    least, middle, most = (significant(1e3 * found["edges"][name]) for name in ("shortest", "median", "longest"))
    sharp, blunt = found["angles"]["least"], found["angles"]["greatest"]
    odd = found["angles"]["odd_cells"]
    words = [
        ("cells", f"{whole(found['cells'])} {_KINDS[surface.cells[0]]}, {whole(found['points'])} points"),
        ("extent", f"x {_mm(x0)} to {_mm(x1)} mm, y {_mm(y0)} to {_mm(y1)} mm"),
        ("root", f"the edge at the smallest x, {_mm(x0)} mm: {whole(found['root']['edges'])} edges, "
         f"{_mm(found['root']['length'])} mm long"),
        ("holes", whole(found["holes"])),
        ("edges of cells", f"{least} mm (shortest), {middle} (median), {most} (longest)"),
        ("shape of cells", f"angles from {sharp:.0f}° to {blunt:.0f}°; longest side over shortest at most "
         f"{significant(found['aspect'], 2)}"
         + (f"; {whole(odd)} cells have an angle below {_SHARP:.0f}° or above {_BLUNT:.0f}°" if odd else "")),
    ]  # fmt: skip
    return tuple(words), found


_KINDS = {"quad": "quadrilaterals", "triangle": "triangles"}


def numbers(surface: Surface) -> dict[str, Any]:
    """The same as plain data: lengths in m, angles in degrees."""
    points, cells = surface.points[:, :2], surface.cells[1]
    corners = points[cells]
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    angles = _angles(corners)
    low, high = points.min(axis=0), points.max(axis=0)
    ends = points[surface.root]
    bad = (angles < _SHARP).any(axis=1) | (angles > _BLUNT).any(axis=1)
    return {
        "kind": surface.cells[0],
        "cells": len(cells),
        "points": len(points),
        "extent": {"x": [float(low[0]), float(high[0])], "y": [float(low[1]), float(high[1])]},
        "root": {"x": float(low[0]), "edges": len(ends), "length": float(_length(ends))},
        "holes": len(loops(surface.outline)) - 1,
        "edges": {
            "shortest": float(sides.min()),
            "median": float(np.median(sides)),
            "longest": float(sides.max()),
        },
        "angles": {
            "least": float(angles.min()),
            "greatest": float(angles.max()),
            "odd_cells": int(np.count_nonzero(bad)),
        },
        "aspect": float((sides.max(axis=1) / sides.min(axis=1)).max()),
    }


def _angles(corners: Floats) -> Floats:
    """Inner angles [degrees] of cells with corners (m, 3 or 4, 2)."""
    on, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cosine = (on * back).sum(axis=2) / np.linalg.norm(on, axis=2) / np.linalg.norm(back, axis=2)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def _length(ends: Floats) -> float:
    return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum())


def _mm(metres: float) -> str:
    return significant(1e3 * metres, 4) if metres else "0"
