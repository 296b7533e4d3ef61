"""Whether there is a screen, and a plate on it."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from workflows.looking.sight import Sight

COMMAND = ["-P", str(Path(__file__).with_name("window.py"))]
"""What shows the window, as arguments to Python."""

_SCALE = 0.14
"""Largest displacement drawn, in lengths of the plate."""


def there_is() -> bool:
    """Whether this machine, as far as it tells, has a screen to open a window on."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def shown(sight: Sight, first: int, mode: int, title: str) -> bool:
    """Show a mode (from 0) at a speed of the run in a window until it is closed; False where that did not work."""
    try:
        done = subprocess.run(
            [sys.executable, *COMMAND], input=archive(sight, first, mode, title), stderr=subprocess.DEVNULL, check=False
        )
    except OSError:
        return False
    return done.returncode == 0


def archive(sight: Sight, first: int, mode: int, title: str) -> bytes:
    """What the window's program reads."""
    surface = sight.surface
    length = float(np.ptp(surface.points[:, :2], axis=0).max())
    shape, behind = np.zeros((2, *surface.points.shape))
    if surface.at:
        row = surface.at.index(first)
        shape = surface.shapes[row, mode]
        behind = behind if surface.behind is None else surface.behind[row, mode]
        largest = float(np.sqrt((shape**2 + behind**2).sum(axis=1).max())) or 1.0
        shape, behind = _SCALE * shape / largest, _SCALE * behind / largest
    mark = np.array([] if sight.mark is None else [[*sight.mark, 0.0]]).reshape(-1, 3) / length
    out = io.BytesIO()
    np.savez(
        out,
        points=surface.points / length,
        cells=surface.cells[1],
        outline=surface.outline,
        root=surface.root,
        mark=mark,
        shape=shape,
        behind=behind,
        title=np.array(title),
    )
    return out.getvalue()
