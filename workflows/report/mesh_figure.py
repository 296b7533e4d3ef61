"""The figure of the mesh: the cells, where the plate is clamped, and where the damper sits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from workflows.report import drawing, palette
from workflows.report.drawing import Sheet
from workflows.scene import plate_mesh
from workflows.scene.scene import Scene
from workflows.solve.records import Floats, Results, Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LONGEST_IN_MM = 2.0
"""Plates [m] up to which the axes are in mm."""

_SMALLEST = 2.5
"""Points of a side of a cell below which the cells would be a grey block."""

_LEAST, _MOST = 1.1, 4.0
"""Inches that the axes are high."""

_BESIDE = 0.9
"""Inches that labels take beside the axes, and below."""


def mesh(results: Results, sheet: Sheet) -> str:
    """The plate from above, in its own axes; nothing without a plate."""
    surface, scene = results.surface, results.scene
    if surface is None:
        return ""
    mark = None if scene.damper is None else plate_mesh.damper_at(scene, surface.points.T[:2])
    return of_surface(surface, mark, held(scene), sheet)


def of_surface(surface: Surface, mark: tuple[float, float] | None, root: str, sheet: Sheet) -> str:
    """A plate from above with its damper (x, y) [m], if any; `root` says what its root is."""
    figure = drawn(surface, mark, root, sheet)
    place = ", place of the damper" if mark else ""
    return drawing.svg(figure, sheet, "mesh", f"Mesh of the plate from above: cells, {root}{place}")


def drawn(surface: Surface, mark: tuple[float, float] | None, root: str, sheet: Sheet) -> Figure:
    """The same as a figure of matplotlib's."""
    metres, unit = (1e3, "mm") if np.ptp(surface.points, axis=0).max() <= _LONGEST_IN_MM else (1.0, "m")
    points = metres * surface.points[:, :2]
    length, width = np.ptp(points, axis=0)
    inside = sheet.width - _BESIDE
    height = float(np.clip(inside * width / length, _LEAST, _MOST))
    figure, (axes,) = drawing.canvas(sheet, height + _BESIDE)
    if cells_are_drawn(surface, sheet):
        _draw(axes, points, np.column_stack([surface.cells[1], surface.cells[1][:, 0]]), palette.MUTED, 0.35)
    _draw(axes, points, surface.outline, palette.INK, 0.9)
    _draw(axes, points, surface.root, palette.CATEGORIES[0], 3.0)
    axes.plot([], [], color=palette.CATEGORIES[0], lw=3.0, label=root)
    if mark is not None:
        x, y = (metres * value for value in mark)
        axes.plot(x, y, "o", ms=7, mfc="none", mec=palette.CATEGORIES[1], mew=1.6, label="damper", zorder=5)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel=f"x, radial, {unit}", ylabel=f"y, across, {unit}")
    axes.grid(visible=False)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper left", ncols=2)
    return figure


def held(scene: Scene) -> str:
    """What the root is."""
    return "clamped root" if scene.plate is None or scene.plate.root is None else "root on springs"


def cells_are_drawn(surface: Surface, sheet: Sheet = drawing.WIDE) -> bool:
    """Whether a figure shows each cell: beyond some thousands they would be one grey block."""
    length, width, _ = np.ptp(surface.points, axis=0)
    inside = 72.0 * (sheet.width - _BESIDE)
    scale = min(inside / length, 72.0 * _MOST / width)
    return bool(scale * np.sqrt(length * width / len(surface.cells[1])) >= _SMALLEST)


def _draw(axes: Axes, points: Floats, chains: np.ndarray, colour: str, width: float) -> None:
    """Polylines through points, chains (n, points of each), as one path, which keeps the page small."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    codes = np.full(chains.shape, Path.LINETO)
    codes[:, 0] = Path.MOVETO
    path = Path(points[chains].reshape(-1, 2), codes.ravel())
    axes.add_patch(PathPatch(path, fill=False, edgecolor=colour, lw=width, capstyle="round"))
