"""What the player of the ball's path needs (templates/player.js): places and events, packed for a page."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from workflows.report import figures, mode_viewer
from workflows.results import files
from workflows.solve.results import BallPath, Floats, Results

_WORDS = {"start": "sets off", "reversal": "turns back", "hit": "hits the wall", "grip": "rolls without slip again"}
"""Kinds of event that are told; the release and the rubbing that belongs to a hit are not."""

_STOPS = {"reversal": "comes to rest", "hit": "hits the wall and stays"}
"""The same where the ball rests in the cavity afterwards."""


def data(results: Results) -> str:
    """The player's data as JSON that may stand in a page; nothing where no ball moved."""
    found, given = figures.path_shown(results), results.scene.damper
    if found is None or given is None:
        return ""
    path, point = found
    begin = float(path.t[0])
    told: dict[str, Any] = {
        "begin": 1e3 * begin,
        "t": mode_viewer.base64_of((1e3 * (path.t - begin)).astype("<f4")),
        "frequency": 1e-3 * figures.frequency(point),
        "radius": 1e3 * given.radius,
        "ball": _packed(path.ball),
        "structure": _packed(path.structure),
        "moving": [files.moving(path.ball), files.moving(path.structure)],
        "regime": "".join(str(3 * a + b) for a, b in path.regime.tolist()),
        "events": events(path),
    }
    return json.dumps(told, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def events(path: BallPath) -> list[tuple[int, str, int]]:
    """What happens: at which time of the path, in words, along which axis (1 or 2)."""
    found = []
    for at, kind, axis in zip(path.at.tolist(), path.kind, path.axis.tolist(), strict=True):
        words = _STOPS if path.regime[at, axis] == 0 and kind in _STOPS else _WORDS
        if kind in words:
            found.append((at, words[kind], axis + 1))
    return found


def _packed(motion: Floats) -> dict[str, Any]:
    """Places (n, 2) in mm as 16-bit integers of the largest, one axis after the other."""
    largest = float(np.abs(motion).max())
    return {"largest": 1e3 * largest, "places": mode_viewer.shorts(motion.T, largest)}
