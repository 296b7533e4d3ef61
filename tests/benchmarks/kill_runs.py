"""Runs killed with SIGKILL at random moments: what is in the results' folder afterwards?

    python -m tests.benchmarks.kill_runs [COUNT [SEED]]

Two scenes take turns in one folder. A third of the runs die at a moment drawn from the whole of a run, a third while
they write, and a third within 80 ms of the exchange of old for new. After each, the folder must hold the one scene's
results or the other's, whole, to the last byte; after all, one run that is let live must leave nothing else behind.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import random
import re
import shutil
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from tests.limits import HANG
from workflows.io.folder import MANIFEST
from workflows.scene.load import SHIPPED

TIMES = {"results.json": rb'"timings": \{[^}]*\},', "report.html": rb"Time in seconds: [^\n]*"}
if TYPE_CHECKING:
    from multiprocessing.context import ForkServerProcess

LOADED = (
    "workflows.cli.commands",
    "workflows.report.page",
    "damper.batch",
    "damper.working",
    "matplotlib.figure",
    "xarray",
)
"""What each run would load anew, which is none of what is tried here; they start from a process that has it."""

MOMENTS = ("anywhere", "while writing", "at the exchange")


def main(count: int = 20, seed: int = 7) -> None:
    """Kill so many runs and print what was found."""
    with tempfile.TemporaryDirectory() as folder:
        found = Trial(Path(folder), seed).run(count)
    print(", ".join(f"{number} {what}" for what, number in sorted(found.items())))


class Trial:
    """Two scenes, what their results are, and the folder they are written to in turn."""

    def __init__(self, folder: Path, seed: int) -> None:
        self.folder = folder / "place"
        self.folder.mkdir()
        self.out = self.folder / "out"
        self.draw = random.Random(seed)
        self.scenes, self.right = [], []
        text = (SHIPPED / "structure.toml").read_text(encoding="utf-8")
        for name, cycles in (("one", 20), ("other", 25)):
            scene = folder / f"{name}.toml"
            scene.write_text(text.replace("cycles = 20", f"cycles = {cycles}"), encoding="utf-8")
            self.scenes.append(scene)
            began = time.perf_counter()
            ended(self.start(scene, folder / name))
            self.whole_run = time.perf_counter() - began
            self.right.append(contents(folder / name))

    def run(self, count: int) -> Counter[str]:
        """Kill `count` runs; what became of them."""
        if not self.out.exists():
            shutil.copytree(self.scenes[0].with_suffix(""), self.out)
        found: Counter[str] = Counter()
        held = self.right.index(contents(self.out))
        for number in range(count):
            new = 1 - held
            when = MOMENTS[number % len(MOMENTS)]
            status = self._killed(self.scenes[new], when)
            held_now = self.right.index(contents(self.out))
            if status == 0 and held_now != new:
                raise AssertionError("a run that ended well left the old results")
            outcome = "finished before the kill" if status == 0 else "new results" if held_now == new else "old results"
            found[f"killed {when}: {outcome}"] += 1
            held = held_now
        left = sum(path != self.out for path in self.folder.iterdir())
        found["scratch folders left by the dead"] = left
        ended(self.start(self.scenes[0], self.out))
        if [path.name for path in self.folder.iterdir()] != ["out"] or contents(self.out) != self.right[0]:
            raise AssertionError(f"the next run left {sorted(path.name for path in self.folder.iterdir())}")
        return found

    def _killed(self, scene: Path, when: str) -> int | None:
        before = {path for sign in ("*", f"*/{MANIFEST}") for path in self.folder.glob(f".out.{sign}")}
        process = self.start(scene, self.out)
        if when == "anywhere":
            time.sleep(self.draw.uniform(0.0, self.whole_run))
        else:
            sign = "*" if when == "while writing" else f"*/{MANIFEST}"
            began = time.perf_counter()
            while process.is_alive() and set(self.folder.glob(f".out.{sign}")) <= before:
                if time.perf_counter() - began > HANG:
                    raise AssertionError("no scratch folder appeared")
            time.sleep(self.draw.uniform(0.0, 0.8 * self.whole_run if when == "while writing" else 0.08))
        process.kill()
        return ended(process)

    @staticmethod
    def start(scene: Path, out: Path) -> ForkServerProcess:
        """Start a run in a process of its own."""
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(list(LOADED))
        process = context.Process(target=_run, args=("run", str(scene), "--out", str(out)))
        process.start()
        return process


def _run(*arguments: str) -> None:
    """The command in a process that says nothing."""
    from workflows import cli
    from workflows.report import figures

    figures.report = lambda _: dict.fromkeys(figures.SHOWN, "")  # drawing is not what is tried
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nowhere, stream)
    sys.exit(cli.main(list(arguments)))


def ended(process: ForkServerProcess) -> int | None:
    """Its status, once it has ended."""
    process.join(HANG)
    return process.exitcode


def contents(folder: Path) -> dict[str, bytes]:
    """A folder's files but for the times in them; they are exactly those that its list of files names."""
    found = {path.name: path.read_bytes() for path in folder.iterdir()}
    if sorted([*found[MANIFEST].decode().split(), MANIFEST]) != sorted(found):
        raise AssertionError(f"{sorted(found)} is not what the list of files says")
    json.loads(found["results.json"])
    for name, times in TIMES.items():
        found[name], replaced = re.subn(times, b"", found[name])
        if replaced != 1:
            raise AssertionError(f"{name} is not whole")
    return found


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
