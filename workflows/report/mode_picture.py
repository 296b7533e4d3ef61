"""A mode shape in 3-D, drawn by VTK in a process of its own: without a working OpenGL, VTK may abort the process.

Run as a program with a NumPy archive on standard input: points (n, 3), cells (m, 3 or 4), the edges of the outline
(k, 2), the displacement (n, 3) to draw, and whether it is a mid-surface, which is drawn with a thickness; the picture
goes to standard output as PNG. It imports nothing of this project, so that it needs no path to it, and no file is left
behind by a run that is killed.
"""

from __future__ import annotations

import gc
import io
import os
import sys
from typing import Any

_SIZE = (1200, 720)
_COLOURS = 128
"""Colours of the picture: more make it larger, and nobody sees them."""

_THICKNESS = 0.02
"""Drawn thickness, in lengths of the plate: enough to catch the light."""


def main() -> None:
    """Read the archive, draw, write the picture."""
    gc.disable()  # it ends before there is any rubbish
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever VTK has to say is no part of the picture
    import numpy as np
    import pyvista as pv
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap
    from PIL import Image

    pv.OFF_SCREEN = True
    # Imported first and fed afterwards: the caller computes the modes while this process loads VTK.
    with np.load(io.BytesIO(sys.stdin.buffer.read())) as archive:
        points, cells, outline, shape = (archive[name] for name in ("points", "cells", "outline", "shape"))
        thick = "thick" not in archive or bool(archive["thick"])
    faces = np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel()
    ends = outline if len(outline) else cells[:, :2]
    at_rest = pv.PolyData(points, lines=np.column_stack([np.full(len(ends), 2), ends]).ravel())
    moved = pv.PolyData(points + shape, faces)
    moved["lift"] = np.linalg.norm(shape, axis=1)
    solid = moved.extrude((0.0, 0.0, -_THICKNESS), capping=True) if thick else moved

    colours = ListedColormap(colormaps["plasma"](np.linspace(0.12, 0.95, 256)))
    plotter: Any = pv.Plotter(off_screen=True, window_size=list(_SIZE))
    plotter.enable_anti_aliasing("ssaa")
    plotter.add_mesh(
        solid,
        scalars="lift",
        cmap=colours,
        ambient=0.25,
        smooth_shading=True,
        split_sharp_edges=True,
        show_scalar_bar=False,
    )
    if thick:
        plotter.add_mesh(moved.extract_all_edges(), color="white", opacity=0.35, line_width=1, lighting=False)
    plotter.add_mesh(at_rest, color="#8a8a8a", line_width=8 if thick else 3, lighting=False)
    plotter.camera_position = [(1.6, -2.4, 1.1), (0.5, 0.0, 0.1), (0.0, 0.0, 1.0)]
    plotter.reset_camera()
    plotter.camera.zoom(1.6)
    picture = Image.fromarray(plotter.screenshot(None, transparent_background=True, return_img=True))
    with out:
        small = picture.crop(picture.getbbox()).quantize(_COLOURS, Image.Quantize.FASTOCTREE)
        small.save(out, format="PNG", optimize=True)
    gc.freeze()


if __name__ == "__main__":
    main()
