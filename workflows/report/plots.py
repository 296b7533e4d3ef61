"""The pictures of a run for Python: axes of matplotlib's or a plotter of pyvista's, to be shown, changed or saved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.errors import BadInput
from workflows.report import drawing, figure_working, figures, mesh_figure, palette
from workflows.scene import plate_mesh
from workflows.solve.records import Floats, Results, shown
from workflows.wording import amount

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SWING = 0.14
"""Largest displacement drawn, in lengths of the plate."""

_SAME = 1e-3
"""Relative difference up to which two speeds are one."""


@dataclass(frozen=True, eq=False)
class Plots:
    """What can be drawn of results; `axes.figure.savefig("campbell.pdf")` writes a picture.

    Each raises BadInput where the run has not what it shows.
    """

    results: Results

    def campbell(self) -> Axes:
        """Natural frequencies [Hz] over the rotation speed [rpm], with engine orders and their crossings."""
        with drawing.style():
            return self._axes(figures.campbell_drawn(self.results, drawing.WIDE), "a plate that turns")

    def damping(self) -> Axes:
        """Damping ratio by the ball [%] over the amplitude at the cavity [mm], a curve for each load."""
        with drawing.style():
            return self._axes(figure_working.drawn(self.results, drawing.WIDE), "a damper whose ball can move")

    def ringdown(self) -> Axes:
        """Velocity of the structure [m/s] over time [ms] after the release, at the run's middle speed."""
        with drawing.style():
            return self._axes(figures.velocity_drawn(self.results, drawing.WIDE), "a ring-down")

    def mesh(self) -> Axes:
        """The plate from above: cells, root, place of the damper."""
        surface, scene = self.results.surface, self.results.scene
        if surface is None:
            raise _without("a plate")
        mark = None if scene.damper is None else plate_mesh.damper_at(scene, surface.points.T[:2])
        with drawing.style():
            return self._axes(mesh_figure.drawn(surface, mark, mesh_figure.held(scene), drawing.WIDE), "a plate")

    def mode(self, number: int = 1, rpm: float | None = None) -> Any:
        """A mode in three dimensions, the plate at rest in outline.

        Args:
            number: of the mode, from 1.
            rpm: rotation speed, one of those kept; the middle one by default.

        Returns:
            A `pyvista.Plotter`: `.show()` shows it, `.screenshot(path)` writes it where nothing has been shown yet.
        """
        import pyvista as pv

        surface = self.results.surface
        if surface is None:
            raise _without("a plate")
        row = self._row(surface.at, rpm)
        if not 1 <= number <= surface.shapes.shape[1]:
            raise BadInput(f"expected a mode from 1 to {surface.shapes.shape[1]}", key="number", value=number)
        points, cells, shape = surface.points, surface.cells[1], surface.shapes[row, number - 1]
        moved, swing = _swinging(points, shape)
        point = self.results.speeds[surface.at[row]]
        mode = point.modes[number - 1]
        plotter = pv.Plotter()
        plate = pv.PolyData(moved, np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel())
        plate["swing, of the largest"] = swing
        plotter.add_mesh(plate, cmap="plasma", show_edges=True, clim=(0.0, 1.0))
        for edges, colour, width in ((surface.outline, "grey", 2), (surface.root, palette.CATEGORIES[0], 6)):
            lines = np.column_stack([np.full(len(edges), 2), edges]).ravel()
            plotter.add_mesh(pv.PolyData(points, lines=lines), color=colour, line_width=width)
        said = f"mode {number}, {mode.family}, {mode.frequency_hz:.2f} Hz at {amount(point.rpm)} rpm"
        plotter.add_text(said, font_size=10)
        return plotter

    def _row(self, at: tuple[int, ...], rpm: float | None) -> int:
        """Which of the speeds kept is meant."""
        if rpm is None:
            return int(np.argmin(np.abs(np.asarray(at) - shown(self.results.speeds))))
        kept = [self.results.speeds[number].rpm for number in at]
        row = min(range(len(kept)), key=lambda k: abs(kept[k] - rpm))
        if abs(kept[row] - rpm) > _SAME * max(rpm, 1.0):
            raise BadInput(f"expected a speed with shapes: {', '.join(map(amount, kept))}", key="rpm", value=rpm)
        return row

    def _axes(self, figure: Figure | None, needed: str) -> Axes:
        from workflows.report import ticks

        if figure is None:
            raise _without(needed)
        ticks.label(figure)
        return palette.coloured(figure, len(self.results.speeds)).axes[0]


def _without(needed: str) -> BadInput:
    return BadInput(f"the run has nothing to draw: expected {needed}", key="plot")


def _swinging(points: Floats, shape: Floats) -> tuple[Floats, Floats]:
    """The points (n, 3) moved by a shape, and how far each swings, of the largest."""
    length = float(np.ptp(points, axis=0).max())
    swing = np.linalg.norm(shape, axis=1)
    largest = float(swing.max()) or 1.0
    return points + _SWING * length / largest * shape, swing / largest
