"""A plate in a window: VTK in a process of its own, which may abort without a working OpenGL.

Run as a program with a NumPy archive on standard input: points (n, 3), cells (m, 3 or 4), outline and root (k, 2),
mark (0 or 1, 3), shape and behind (n, 3) as they are to be drawn, and a title. It imports nothing of this
project. With a number as its argument it draws so many frames and ends.
"""

from __future__ import annotations

import io
import sys
import time
from typing import Any

_PERIOD = 1.8
"""Seconds that a period takes on the screen."""


def main() -> None:
    """Read the archive, show it until the window is closed."""
    import numpy as np
    import pyvista as pv

    with np.load(io.BytesIO(sys.stdin.buffer.read())) as archive:
        given = {name: archive[name] for name in archive.files}
    frames = int(sys.argv[1]) if len(sys.argv) > 1 else None
    points, cells, shape, behind = (given[name] for name in ("points", "cells", "shape", "behind"))
    plate = pv.PolyData(points.copy(), np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel())
    moving = bool(np.abs(shape).max(initial=0.0) > 0)
    plotter: Any = pv.Plotter(title=str(given["title"]), off_screen=frames is not None)
    if moving:
        plate["swing"] = np.sqrt((shape**2 + behind**2).sum(axis=1))
        plotter.add_mesh(plate, scalars="swing", cmap="plasma", show_edges=True, show_scalar_bar=False)
    else:
        plotter.add_mesh(plate, color="lightgrey", show_edges=True)
    for name, colour, width in (("outline", "grey", 2), ("root", "#0072b2", 7)):
        edges = given[name]
        lines = np.column_stack([np.full(len(edges), 2), edges]).ravel()
        plotter.add_mesh(pv.PolyData(points, lines=lines), color=colour, line_width=width, label=name)
    if len(given["mark"]):
        plotter.add_mesh(pv.PolyData(given["mark"]), color="#d55e00", point_size=16, render_points_as_spheres=True)
    plotter.add_text(str(given["title"]), font_size=10)
    plotter.camera_position = [(0.9, -2.1, 1.1), (0.5, 0.0, 0.0), (0.0, 0.0, 1.0)]
    plotter.reset_camera()
    if not moving and frames is None:
        plotter.show()
        return
    plotter.show(interactive_update=True, auto_close=False)
    began = time.perf_counter()
    while not getattr(plotter, "_closed", False) and (frames is None or frames > 0):
        angle = 2 * np.pi * (time.perf_counter() - began) / _PERIOD
        plate.points = points + np.cos(angle) * shape + np.sin(angle) * behind
        plotter.update(30)
        frames = None if frames is None else frames - 1
        if plotter.render_window is None:
            break
    plotter.close()


if __name__ == "__main__":
    main()
