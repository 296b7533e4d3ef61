"""A plate in a window: VTK in a process of its own, which may abort without a working OpenGL.

Run as a program with a NumPy archive on standard input: points (n, 3), cells (m, 3 or 4), outline and root (k, 2),
mark (0 or 1, 3), shapes and behind (speeds, modes, n, 3) as they are to be drawn, the largest of their displacements,
said (speeds, modes) in words, first (speed, mode) and a title. It imports nothing of this project. With a number as its
argument it draws so many frames, one mode after the other, and ends.
"""

from __future__ import annotations

import io
import sys
import time
from typing import Any

import numpy as np

_PERIOD = 1.8
"""Seconds that a period takes on the screen."""

_KEYS = "left, right: mode    [ ]: speed    space: stop, go on"


class Shown:
    """Which mode at which speed is shown, both from 0, and where it puts the plate."""

    def __init__(self, given: dict[str, Any]) -> None:
        self.given = given
        self.speed, self.mode = (int(number) for number in given["first"])
        self.playing = True

    @property
    def counts(self) -> tuple[int, int]:
        """Speeds and modes that there are."""
        speeds, modes = self.given["shapes"].shape[:2]
        return int(speeds), int(modes)

    @property
    def moves(self) -> bool:
        """Whether there is anything in motion."""
        return min(self.counts) > 0

    @property
    def said(self) -> str:
        """The mode shown, in words."""
        return str(self.given["said"][self.speed, self.mode]) if self.moves else ""

    def go(self, speeds: int = 0, modes: int = 0) -> None:
        """On by so many speeds and modes, as far as there are any."""
        self.pick(self.speed + speeds, self.mode + modes)

    def pick(self, speed: float, mode: float) -> None:
        """A speed and a mode, the nearest there are."""
        there = [
            min(max(round(number), 0), count - 1) for number, count in zip((speed, mode), self.counts, strict=True)
        ]
        self.speed, self.mode = there

    def swing(self) -> Any:
        """How far each point swings, (n,)."""
        shape, behind = self._parts()
        return np.sqrt((shape**2 + behind**2).sum(axis=1))

    def places(self, angle: float) -> Any:
        """The points (n, 3) at an angle of the period [rad]."""
        shape, behind = self._parts()
        return self.given["points"] + np.cos(angle) * shape + np.sin(angle) * behind

    def marked(self, places: Any) -> Any:
        """The damper's place (0 or 1, 3) where the points are at these places: it goes with the one next to it."""
        points, mark = self.given["points"], self.given["mark"]
        if not len(mark):
            return mark
        nearest = int(((points - mark) ** 2).sum(axis=1).argmin())
        return mark + (places - points)[nearest]

    def _parts(self) -> tuple[Any, Any]:
        at = self.speed, self.mode
        shape, behind = self.given["shapes"][at], self.given["behind"]
        return shape, behind[at] if len(behind) else 0.0 * shape


def main() -> None:
    """Read the archive, show it until the window is closed."""
    with np.load(io.BytesIO(sys.stdin.buffer.read())) as archive:
        shown = Shown({name: archive[name] for name in archive.files})
    frames = int(sys.argv[1]) if len(sys.argv) > 1 else None
    plotter, plate, mark = _drawn(shown, off_screen=frames is not None)
    if not shown.moves and frames is None:
        plotter.show()
        return
    if frames is None:
        _controls(plotter, shown)
    plotter.show(interactive_update=True, auto_close=False)
    began, angle = time.perf_counter(), 0.0
    while not getattr(plotter, "_closed", False) and (frames is None or frames > 0):
        if shown.moves:
            passed, began = time.perf_counter() - began, time.perf_counter()
            angle += 2 * np.pi * passed / _PERIOD if shown.playing else 0.0
            plate.points = shown.places(angle)
            mark.points = shown.marked(plate.points)
            plate["swing"] = shown.swing()
            plotter.add_text(f"{shown.given['title']}\n{shown.said}", font_size=10, name="said")
        plotter.update(30)
        if frames is not None:
            frames -= 1
            shown.go(modes=1)
        if plotter.render_window is None:
            break
    plotter.close()


def _drawn(shown: Shown, *, off_screen: bool) -> tuple[Any, Any, Any]:
    """The plotter, the plate in it, and the damper's mark, which may be of no points."""
    import pyvista as pv

    points, cells = shown.given["points"], shown.given["cells"]
    plate = pv.PolyData(points.copy(), np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel())
    plotter: Any = pv.Plotter(title=str(shown.given["title"]), off_screen=off_screen)
    if shown.moves:
        plate["swing"] = shown.swing()
        largest = float(shown.given["largest"])
        plotter.add_mesh(
            plate, scalars="swing", clim=(0.0, largest), cmap="plasma", show_edges=True, show_scalar_bar=False
        )
    else:
        plotter.add_mesh(plate, color="lightgrey", show_edges=True)
    for name, colour, width in (("outline", "grey", 2), ("root", "#0072b2", 7)):
        edges = shown.given[name]
        lines = np.column_stack([np.full(len(edges), 2), edges]).ravel()
        plotter.add_mesh(pv.PolyData(points, lines=lines), color=colour, line_width=width, label=name)
    mark = pv.PolyData(shown.given["mark"].astype(float))
    if len(shown.given["mark"]):
        plotter.add_mesh(mark, color="#d55e00", point_size=16, render_points_as_spheres=True)
    plotter.add_text(f"{shown.given['title']}\n{shown.said}", font_size=10, name="said")
    plotter.camera_position = [(0.9, -2.1, 1.1), (0.5, 0.0, 0.0), (0.0, 0.0, 1.0)]
    plotter.reset_camera()
    return plotter, plate, mark


def _controls(plotter: Any, shown: Shown) -> None:
    """Sliders and keys that choose a speed and a mode; the sliders follow the keys."""
    speeds, modes = shown.counts
    sliders: dict[str, Any] = {}
    for name, count, now, left in (("speed", speeds, shown.speed, 0.03), ("mode", modes, shown.mode, 0.53)):
        if count > 1:
            sliders[name] = plotter.add_slider_widget(
                lambda value, name=name: shown.pick(
                    value - 1 if name == "speed" else shown.speed, value - 1 if name == "mode" else shown.mode
                ),
                (1, count),
                value=now + 1,
                title=name,
                pointa=(left, 0.12),
                pointb=(left + 0.4, 0.12),
                title_height=0.02,
                fmt="%.0f",
                style="modern",
            )

    def step(speeds: int, modes: int) -> None:
        shown.go(speeds, modes)
        for name, slider in sliders.items():
            slider.GetRepresentation().SetValue(1 + getattr(shown, name))

    def stop() -> None:
        shown.playing = not shown.playing

    for key, by in (("Right", (0, 1)), ("Left", (0, -1)), ("bracketright", (1, 0)), ("bracketleft", (-1, 0))):
        plotter.add_key_event(key, lambda by=by: step(*by))
    plotter.add_key_event("space", stop)
    plotter.add_text(_KEYS, position="lower_left", font_size=8, name="keys")


if __name__ == "__main__":
    main()
