"""Whether there is a screen, and a plate on it."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from workflows.looking.sight import Sight
from workflows.solve.records import Mode, Surface
from workflows.wording import amount

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
    """What the window's program reads: every mode at every speed kept, one of them first."""
    surface = sight.surface
    length = float(np.ptp(surface.points[:, :2], axis=0).max())
    mark = np.array([] if sight.mark is None else [[*sight.mark, 0.0]]).reshape(-1, 3) / length
    given: dict[str, Any] = {
        "points": surface.points / length,
        "cells": surface.cells[1],
        "outline": surface.outline,
        "root": surface.root,
        "mark": mark,
        "first": (surface.at.index(first), mode) if surface.at else (0, 0),
        "largest": _SCALE,
        "title": np.array(title),
    }
    out = io.BytesIO()
    np.savez(out, **given, **_shapes(surface), said=_said(sight))
    return out.getvalue()


def _shapes(surface: Surface) -> dict[str, Any]:
    """Displacements to be drawn, (speeds, modes, n, 3), and behind them; none of the latter where all is in phase."""
    behind = surface.behind if surface.behind is not None else np.zeros((0, *surface.shapes.shape[1:]))
    squares = (surface.shapes**2).sum(axis=-1)
    if len(behind):
        squares += (behind**2).sum(axis=-1)
    largest = np.sqrt(squares.max(axis=-1, initial=0.0))
    scale = (_SCALE / np.where(largest > 0, largest, 1.0))[..., None, None]
    return {
        "shapes": (surface.shapes * scale).astype(np.float32),
        "behind": (behind * scale[: len(behind)]).astype(np.float32),
    }


def _said(sight: Sight) -> npt.NDArray[np.str_]:
    """Each mode in words, (speeds, modes)."""
    count = sight.surface.shapes.shape[1]
    rows = [
        [_mode(number, mode, point.rpm) for number, mode in enumerate(point.modes[:count], 1)]
        for point in (sight.speeds[at] for at in sight.surface.at)
    ]
    return np.array(rows, dtype=np.str_)


def _mode(number: int, mode: Mode, rpm: float) -> str:
    return f"mode {number}, {mode.family}, {mode.frequency_hz:.2f} Hz at {amount(rpm)} rpm"
