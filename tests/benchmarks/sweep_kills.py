"""Sweeps killed with SIGKILL at random moments, workers killed singly, and a Dask cluster that loses one of its two.

    python -m tests.benchmarks.sweep_kills [KILLS [SEED]]

One sweep that nothing disturbs says what the folder must hold to the last byte. Another is killed KILLS times at a
moment drawn from the whole of what is left of it, and started again; after each kill all its blocks must be whole. A
third loses a worker process every few seconds; two more run into one folder at once, and one finds the code changed in
between. Where a disk in memory may be mounted (as root on Linux), one fills it up three times, each larger than the one
before. The last is computed by a scheduler and two workers on this machine, one of which is killed in the middle; the
other must take it up.
"""

from __future__ import annotations

import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import psutil

from tests.limits import HANG
from workflows.studies.sweep.store import DATA, DONE, LOCK

ROOT = Path(__file__).parents[2]

VARY = (
    "damper.mass_ratio=log:0.001:0.05:16",
    "damper.clearance=log:0.1 mm:4 mm:16",
    "rotor.speeds=3000 rpm:9000 rpm:4",
)


def main(kills: int = 20, seed: int = 7) -> None:
    """Run all trials and print what was found; AssertionError where the end is not as undisturbed."""
    draw = random.Random(seed)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        began = time.perf_counter()
        ended(start(place / "right"))
        whole = time.perf_counter() - began
        right = contents(place / "right")
        print(f"undisturbed: {whole:.1f} s, {len(right)} files, {len(done(place / 'right'))} blocks")
        print(killed(place / "killed", right, kills, whole, draw))
        print(without_workers(place / "workers", right, draw))
        print(two_writers(place / "two", right))
        print(other_code(place / "code", right))
        print(on_a_small_disk(place / "disk", right))
        print(on_a_cluster(place / "cluster", right))


def start(out: Path, *more: str, code: Path = ROOT) -> subprocess.Popen[str]:
    """Start the sweep in a process of its own, which has two workers, by the code in a folder."""
    vary = [part for text in VARY for part in ("--vary", text)]
    workers = [] if more else ["--workers", "2"]
    command = [sys.executable, "-m", "workflows.cli", "sweep", "structure", *vary, "--quick", *workers, *more]
    how: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen([*command, "--out", str(out)], cwd=code, env=os.environ | {"PYTHONPATH": str(code)}, **how)


def ended(process: subprocess.Popen[str]) -> None:
    """Wait for its end, which must be good."""
    _, errors = process.communicate(timeout=HANG)
    if process.returncode != 0:
        raise AssertionError(f"status {process.returncode}: {errors}")


def contents(out: Path) -> dict[str, bytes]:
    """All files but the lock's, and those that are not whole yet."""
    files = (path for path in sorted(out.rglob("*")) if path.is_file() and path.name != LOCK)
    files = (path for path in files if "partial" not in str(path.relative_to(out)))
    return {path.relative_to(out).as_posix(): path.read_bytes() for path in files}


def same(out: Path, right: dict[str, bytes]) -> None:
    """The folder holds what it must, to the last byte."""
    found = contents(out)
    wrong = sorted(name for name in found.keys() | right.keys() if found.get(name) != right.get(name))
    if wrong:
        raise AssertionError(f"not as undisturbed: {', '.join(wrong)}")


def done(out: Path) -> set[Path]:
    """What says of the blocks that they are there."""
    return {path for path in (out / DATA / DONE / "c").rglob("*") if path.is_file() and path.suffix != ".partial"}


def killed(out: Path, right: dict[str, bytes], kills: int, whole: float, draw: random.Random) -> str:
    """Kill the sweep again and again; nothing that is finished may be lost or torn."""
    known: set[Path] = set()
    finished = 0
    for _ in range(kills):
        process = start(out)
        time.sleep(draw.uniform(0.0, whole))
        children = psutil.Process(process.pid).children(recursive=True) if process.poll() is None else []
        process.kill()
        process.communicate(timeout=HANG)
        finished += process.returncode == 0
        _, alive = psutil.wait_procs(children, timeout=10)
        if alive:
            raise AssertionError(f"{len(alive)} workers outlive the sweep")
        torn = [name for name, data in contents(out).items() if right[name] != data]
        if torn or not known <= done(out):
            raise AssertionError("a block is torn, or lost")
        known = done(out)
        if len(known) == len([name for name in right if name.startswith(f"{DATA}/{DONE}/c/")]) and draw.random() < 0.7:
            for path in sorted(known)[1:]:  # begin again, or there would be nothing left to kill
                path.unlink()
            known = done(out)
    ended(start(out))
    same(out, right)
    return f"{kills} kills at random moments ({finished} after the end): every byte as undisturbed, no worker left"


def without_workers(out: Path, right: dict[str, bytes], draw: random.Random) -> str:
    """Kill one worker at a time, each time that a block more is there."""
    process, count = start(out), 0
    while process.poll() is None:
        time.sleep(draw.uniform(0.0, 1.0))
        if process.poll() is not None or len(done(out)) < count:
            continue
        workers = [
            child for child in psutil.Process(process.pid).children() if "popen_loky" in " ".join(child.cmdline())
        ]
        if workers:
            draw.choice(workers).send_signal(signal.SIGKILL)
            count += 1
    ended(process)
    same(out, right)
    return f"{count} workers killed singly: every byte as undisturbed"


def two_writers(out: Path, right: dict[str, bytes]) -> str:
    """The same sweep twice into one folder: one is refused while the other works, and harms nothing."""
    first = start(out)
    while first.poll() is None and not done(out):
        time.sleep(0.05)
    second = start(out)
    said = refused(second)
    ended(first)
    same(out, right)
    return f"two writers: {said!r}; the first ended with every byte as undisturbed"


def other_code(out: Path, right: dict[str, bytes]) -> str:
    """A sweep that is gone on with by other code, here with a comment more, is refused; its own ends it."""
    with tempfile.TemporaryDirectory() as folder:
        for name in ("damper", "fem", "workflows", "spindamp.py"):
            origin = ROOT / name
            (shutil.copytree if origin.is_dir() else shutil.copy)(origin, Path(folder) / name)
        with (Path(folder) / "damper" / "model.py").open("a", encoding="utf-8") as file:
            file.write("# other code\n")
        process = start(out)
        while process.poll() is None and not done(out):
            time.sleep(0.05)
        process.kill()
        process.communicate(timeout=HANG)
        said = refused(start(out, "--workers", "2", code=Path(folder)))
    ended(start(out))
    same(out, right)
    return f"other code in between: {said!r}; its own went on, every byte as undisturbed"


def refused(process: subprocess.Popen[str]) -> str:
    """What it says in one line, with status 2."""
    _, errors = process.communicate(timeout=HANG)
    if process.returncode != 2 or len(errors.strip().splitlines()) != 1:
        raise AssertionError(f"status {process.returncode}: {errors}")
    return re.sub(r"'/[^']*/", "'…/", errors.strip())


def on_a_small_disk(out: Path, right: dict[str, bytes]) -> str:
    """Into a disk in memory that holds a part of it, then more; at last all of it."""
    out.mkdir()
    whole, said = sum(map(len, right.values())), []
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", out], check=False, capture_output=True)
    if done.returncode != 0:
        return f"a full disk: not tried, {done.stderr.decode().strip()}"
    try:
        for share in (0.2, 0.4, 0.6):
            subprocess.run(["mount", "-o", f"remount,size={int(share * whole)}", out], check=True)
            said.append((refused(start(out / "map")), len(done(out / "map"))))
        subprocess.run(["mount", "-o", "remount,size=100m", out], check=True)
        ended(start(out / "map"))
        same(out / "map", right)
    finally:
        subprocess.run(["umount", out], check=True)
    counts = ", ".join(str(count) for _, count in said)
    return f"a full disk: {said[0][0]!r} with {counts} blocks; then every byte as undisturbed"


def on_a_cluster(out: Path, right: dict[str, bytes]) -> str:
    """A scheduler and two workers on loopback; one is killed when the first block is there."""
    started = [dask("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")]
    try:
        address = found(started[0], r"Scheduler at:\s+(tcp://\S+)")
        for _ in range(2):
            started.append(dask("worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"))
            found(started[-1], "Registered to")
        process = start(out, "--dask", address)
        while process.poll() is None and not done(out):
            time.sleep(0.05)
        before = len(done(out))
        started[1].kill()
        ended(process)
        same(out, right)
        return f"Dask, one of two workers killed after {before} blocks of {len(done(out))}: every byte as the local run"
    finally:
        for each in reversed(started):
            each.kill()
            each.communicate()


def dask(*arguments: str) -> subprocess.Popen[str]:
    """Start a part of a cluster."""
    command = [sys.executable, "-m", "distributed.cli.dask_" + arguments[0], *arguments[1:]]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def found(process: subprocess.Popen[str], pattern: str) -> str:
    """What a process says in a line that matches."""
    if process.stderr is None:
        raise ValueError("its errors are not read")
    for line in process.stderr:
        if match := re.search(pattern, line):
            return match[match.re.groups]
    raise AssertionError(f"it ended without {pattern}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
