"""The first mode shape for the report: from VTK in a process of its own, or else from matplotlib."""

from __future__ import annotations

import contextlib
import io
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from workflows.solve.records import Floats, Surface

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PATIENCE = 20.0
"""Seconds to wait for VTK once everything else is done."""

COMMAND = ["-P", str(Path(__file__).with_name("mode_picture.py"))]
"""What draws, as arguments to Python; -P: modules in the user's folder are not taken for the ones meant."""

PNG = b"\x89PNG"

_SCALE = 0.25
"""Largest displacement drawn, in lengths of the plate."""


@dataclass(frozen=True)
class Picture:
    """A PNG picture, and a remark where it is not the usual one."""

    png: bytes
    remark: str = ""


@dataclass(frozen=True, eq=False)
class Drawn:
    """What is drawn: points (n, 3) in lengths of the plate, cells (m, 3 or 4), outline (k, 2), displacement (n, 3)."""

    points: Floats
    cells: np.ndarray
    outline: np.ndarray
    shape: Floats


class Artist:
    """Draws while the run goes on: started early, fed the shape when it is known, asked for the picture last."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._shape: Drawn | None = None
        self._failure = ""

    def __enter__(self) -> Self:
        try:
            self._process = subprocess.Popen(
                [sys.executable, *COMMAND], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
            )
        except OSError as error:
            self._failure = str(error)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            for stream in (self._process.stdin, self._process.stdout):
                if stream is not None:
                    with contextlib.suppress(OSError):  # what it had not read yet
                        stream.close()

    def draw(self, surface: Surface, speed: int) -> None:
        """Hand over the first mode at the speed nearest to number `speed` of the run."""
        row = int(np.argmin(np.abs(np.asarray(surface.at) - speed)))
        shape = surface.shapes[row, 0]
        largest = float(np.linalg.norm(shape, axis=1).max()) or 1.0
        sign = 1.0 if shape[np.argmax(np.abs(shape[:, 2])), 2] >= 0 else -1.0
        length = float(np.ptp(surface.points[:, 0]))
        moved = sign * _SCALE * shape / largest
        self._shape = Drawn(surface.points / length, surface.cells[1], surface.outline, moved)
        archive = io.BytesIO()
        np.savez(archive, **vars(self._shape))
        if self._process is not None and self._process.stdin is not None:
            stdin, self._process.stdin = self._process.stdin, None
            try:
                stdin.write(archive.getvalue())
            except OSError:
                self._failure = "the drawing process ended early"
            with contextlib.suppress(OSError):
                stdin.close()

    def picture(self) -> Picture | None:
        """The picture; None where no shape was handed over."""
        if self._shape is None:
            return None
        png = b"" if self._failure else self._wait()
        if png:
            return Picture(png)
        remark = f"Drawn without VTK, which found no working OpenGL here ({self._failure})."
        return Picture(_png(_plain(self._shape)), remark)

    def _wait(self) -> bytes:
        """What VTK has drawn; where it has not, `_failure` says why."""
        png = b""
        if self._process is None:
            self._failure = "it did not start"
            return png
        try:
            png = self._process.communicate(timeout=PATIENCE)[0]
        except subprocess.TimeoutExpired:
            self._failure = f"no picture within {PATIENCE:.0f} s"
            return png
        if self._process.returncode != 0:
            self._failure, png = f"exit status {self._process.returncode}", b""
        elif not png.startswith(PNG):
            self._failure, png = "no picture", b""
        return png


def _plain(drawn: Drawn) -> Figure:
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    figure = Figure(figsize=(8, 4.6), facecolor="none")
    axes: Any = figure.add_subplot(projection="3d", facecolor="none")
    points, moved = drawn.points, drawn.points + drawn.shape
    lift = np.linalg.norm(drawn.shape, axis=1)[drawn.cells].mean(axis=1)
    faces = Poly3DCollection(moved[drawn.cells], array=lift, cmap="plasma", edgecolor="#ffffff60", linewidth=0.4)
    axes.add_collection3d(faces)
    axes.add_collection3d(Line3DCollection(points[drawn.outline], color="#8a8a8a", linewidth=1.2))
    low, high = np.minimum(points, moved).min(axis=0), np.maximum(points, moved).max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(np.maximum(high - low, 1e-3), zoom=1.5)
    axes.view_init(22, -62)
    axes.set_axis_off()
    return figure


def _png(figure: Figure) -> bytes:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    out = io.BytesIO()
    canvas: Any = FigureCanvasAgg(figure)
    canvas.print_png(out)
    return out.getvalue()
