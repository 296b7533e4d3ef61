"""The stages of a run: their times, and progress for a person who waits."""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

NAMES = ("mesh", "prestress", "modes", "reduction", "damper", "write", "report", "total")


LOG = logging.getLogger("spindamp")
"""What is decided, and how long each stage takes; silent unless somebody listens (`spindamp -v`, `--log FILE`)."""


class Stages:
    """Clock of a run. Progress goes to standard error, and only where that is a terminal.

    `spent`: the times [s] of stages that were over before, and their total, which this clock goes on from.
    """

    def __init__(self, *, visible: bool | None = None, spent: Mapping[str, float] | None = None) -> None:
        self._spent = dict(spent or {})
        self._began = time.perf_counter() - self._spent.get("total", 0.0)
        self._inner: list[float] = []
        self._visible = sys.stderr.isatty() if visible is None else visible
        self._progress: Progress | None = None

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

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
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
        try:
            yield Step(self._progress, task)
        finally:
            whole = time.perf_counter() - began
            LOG.info("%s: %.3f s", name, whole)
            self._spent[name] = self._spent.get(name, 0.0) + whole - self._inner.pop()
            if self._inner:
                self._inner[-1] += whole
            if self._progress is not None and task is not None:
                self._progress.remove_task(task)

    def timings(self) -> dict[str, float]:
        """Seconds per stage that ran, in the order of a run, and the total so far."""
        spent = {name: self._spent[name] for name in NAMES if name in self._spent}
        return spent | {"total": time.perf_counter() - self._began}


class Step:
    """Handle on a running stage."""

    def __init__(self, progress: Progress | None, task: TaskID | None) -> None:
        self._progress = progress
        self._task = task

    def advance(self, detail: str = "") -> None:
        """One step is done."""
        if detail:
            LOG.debug("%s", detail)
        if self._progress is not None and self._task is not None:
            self._progress.update(self._task, advance=1, detail=detail)
