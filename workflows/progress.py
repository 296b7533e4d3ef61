"""The stages of a run: their times, and progress for a person who waits."""

from __future__ import annotations

import logging
import math
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

NAMES = ("mesh", "prestress", "modes", "reduction", "damper", "write", "report", "total")


LOG = logging.getLogger("spindamp")
"""What is decided, and how long each stage takes; silent unless somebody listens (`spindamp -v`, `--log FILE`)."""


SILENT, _SELDOM, _OTHER = 30.0, 60.0, 10.0
"""Seconds before the first line of progress where there is no terminal; between two of a stage, and of two stages."""


class Stages:
    """Clock of a run. Progress goes to standard error: a bar on a terminal, elsewhere lines where they are asked for.

    `spent`: the times [s] of stages that were over before, and their total, which this clock goes on from. `lines`:
    without a terminal a line of each stage that lasts and one a minute, once the work has taken half a minute.
    """

    def __init__(
        self, *, visible: bool | None = None, spent: Mapping[str, float] | None = None, lines: bool = False
    ) -> None:
        self._spent = dict(spent or {})
        self._began = time.perf_counter() - self._spent.get("total", 0.0)
        self._inner: list[float] = []
        self._visible = sys.stderr.isatty() if visible is None else visible
        self._progress: Progress | None = None
        self._lines = lines and not self._visible
        self._last = ("", -math.inf)

    def __enter__(self) -> Self:
        if self._visible:
            from rich.console import Console
            from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

            self._progress = Progress(
                TextColumn("{task.description:<10}"),
                BarColumn(bar_width=20),
                TextColumn("{task.fields[detail]}"),
                TimeElapsedColumn(),
                TextColumn("{task.fields[left]}"),
                TimeRemainingColumn(compact=True),  # says nothing where the work is not counted
                console=Console(stderr=True),
                transient=True,
            )
            self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._progress is not None:
            self._progress.stop()

    @contextmanager
    def __call__(self, name: str, steps: int | None = None, done: int = 0) -> Iterator[Step]:
        """Time a stage; times of the same name add up, and a stage within another counts for itself alone.

        `steps` is how many times it will be advanced, with those `done` before: they tell the time that remains.
        """
        began = time.perf_counter()
        LOG.debug("%s begins", name)
        task = None
        if self._progress is not None:
            left = "" if steps is None else "remaining"
            task = self._progress.add_task(name, total=steps, completed=done, detail="", left=left)
        self._inner.append(0.0)
        self.report(name, "")
        try:
            yield Step(self, name, steps, done, task)
        finally:
            whole = time.perf_counter() - began
            LOG.info("%s: %.3f s", name, whole)
            self._spent[name] = self._spent.get(name, 0.0) + whole - self._inner.pop()
            if self._inner:
                self._inner[-1] += whole
            if self._progress is not None and task is not None:
                self._progress.remove_task(task)

    def report(self, name: str, line: str, task: TaskID | None = None, detail: str = "", steps: int = 1) -> None:
        """Advance the bar of a task, if there is one; without a terminal print the line, where one is due."""
        if self._progress is not None and task is not None:
            self._progress.update(task, advance=steps, detail=detail)
        now = time.perf_counter()
        stage, before = self._last
        if not self._lines or now - self._began < SILENT or now - before < (_SELDOM if name == stage else _OTHER):
            return
        self._last = (name, now)
        print(f"spindamp: {name}{line and ': '}{line}", file=sys.stderr, flush=True)

    def timings(self) -> dict[str, float]:
        """Seconds per stage that ran, in the order of a run, and the total so far."""
        spent = {name: self._spent[name] for name in NAMES if name in self._spent}
        return spent | {"total": time.perf_counter() - self._began}


class Step:
    """Handle on a running stage: how far it has come, and the time that remains.

    The time up to the first advance is not counted: it includes what is done once, such as compilation.
    """

    def __init__(self, stages: Stages, name: str, steps: int | None, done: int, task: TaskID | None) -> None:
        self._stages, self._name, self._steps, self._task = stages, name, steps, task
        self._done = done
        self._first: tuple[int, float] | None = None

    def advance(self, detail: str, steps: int = 1) -> None:
        """Some steps are done."""
        LOG.debug("%s", detail)
        self._done += steps
        now, line = time.perf_counter(), detail
        if self._steps is not None:
            left = f"{self._done} of {self._steps} steps"
            if self._first is not None:
                first, then = self._first
                each = (now - then) / (self._done - first)
                left += f", {math.ceil(each * (self._steps - self._done))} s remaining"
            line = f"{detail}; {left}"
        self._first = self._first or (self._done, now)
        self._stages.report(self._name, line, self._task, detail, steps)
