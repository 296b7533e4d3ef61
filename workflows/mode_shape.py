"""The first mode shape for the report: from VTK in a process of its own, or else from matplotlib."""

from __future__ import annotations

import io
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from workflows.records import Floats, Surface

PATIENCE = 20.0
"""Seconds to wait for VTK once everything else is done."""

COMMAND = ["-m", "workflows.mode_picture"]
"""What draws, as arguments to Python."""

_SCALE = 0.25
"""Largest displacement drawn, in lengths of the plate."""


@dataclass(frozen=True)
class Picture:
    """A PNG picture, and a remark where it is not the usual one."""

    png: bytes
    remark: str = ""


class Artist:
    """Draws while the run goes on: started early, fed the shape when it is known, asked for the picture last."""

    def __init__(self) -> None:
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._shape: tuple[Floats, np.ndarray, Floats] | None = None
        self._failure = ""

    def __enter__(self) -> Self:
        self._folder = tempfile.TemporaryDirectory(prefix="spindamp-")
        command = [sys.executable, *COMMAND, str(self._path)]
        try:
            self._process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
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
            if self._process.stdin is not None:
                self._process.stdin.close()
        if self._folder is not None:
            self._folder.cleanup()

    @property
    def _path(self) -> Path:
        return Path(self._folder.name if self._folder else ".") / "mode.png"

    def draw(self, surface: Surface, speed: int) -> None:
        """Hand over the first mode at the speed nearest to number `speed` of the run."""
        row = int(np.argmin(np.abs(np.asarray(surface.at) - speed)))
        shape = surface.shapes[row, 0]
        largest = float(np.linalg.norm(shape, axis=1).max()) or 1.0
        sign = 1.0 if shape[np.argmax(np.abs(shape[:, 2])), 2] >= 0 else -1.0
        length = float(np.ptp(surface.points[:, 0]))
        self._shape = surface.points / length, surface.cells[1], sign * _SCALE * shape / largest
        archive = io.BytesIO()
        np.savez(archive, points=self._shape[0], cells=self._shape[1], shape=self._shape[2])
        if self._process is not None and self._process.stdin is not None:
            try:
                self._process.stdin.write(archive.getvalue())
                self._process.stdin.close()
            except OSError:
                self._failure = "the drawing process ended early"

    def picture(self) -> Picture | None:
        """The picture; None where no shape was handed over."""
        if self._shape is None:
            return None
        failure = self._failure or self._wait()
        if not failure:
            return Picture(self._path.read_bytes())
        remark = f"Drawn without VTK, which found no working OpenGL here ({failure})."
        return Picture(_plain(*self._shape), remark)

    def _wait(self) -> str:
        """Wait for VTK; empty if it has drawn, else what happened."""
        if self._process is None:
            return "it did not start"
        began = time.monotonic()
        try:
            status = self._process.wait(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            return f"no picture within {time.monotonic() - began:.0f} s"
        if status != 0:
            return f"exit status {status}"
        return "" if self._path.is_file() else "no picture"


def _plain(points: Floats, cells: np.ndarray, shape: Floats) -> bytes:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    figure = Figure(figsize=(8, 4.6), facecolor="none")
    axes = figure.add_subplot(projection="3d", facecolor="none")
    moved = points + shape
    lift = np.linalg.norm(shape, axis=1)[cells].mean(axis=1)
    faces = Poly3DCollection(moved[cells], array=lift, cmap="plasma", edgecolor="#ffffff60", linewidth=0.4)
    axes.add_collection3d(faces)
    low, high = np.minimum(points, moved).min(axis=0), np.maximum(points, moved).max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(np.maximum(high - low, 1e-3), zoom=1.5)
    axes.view_init(22, -62)
    axes.set_axis_off()
    out = io.BytesIO()
    canvas: Any = FigureCanvasAgg(figure)
    canvas.print_png(out)
    return out.getvalue()
