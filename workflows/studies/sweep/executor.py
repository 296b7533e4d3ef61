"""Who computes: processes of this machine, a Dask cluster, or any `concurrent.futures.Executor`; and by which code.

Tasks are handed out a few at a time, in order, and taken as they come: what a worker returns does not depend on which
worker it is. A worker that dies costs the tasks it had, which are handed out again.
"""

import hashlib
import math
import os
import signal
import tempfile
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TypeVar

import numpy as np

from damper import Harmonic, backbone, damping_curve, forced, ringdowns
from damper.self_check import RINGDOWNS
from workflows.errors import BadInput
from workflows.versions import versions

T = TypeVar("T")
Task = TypeVar("Task")

_AHEAD = 2
"""Tasks handed out for each worker: one that it does, one that waits."""

_DEATHS = 6
"""How often every task that is handed out may be lost before any is finished."""

_DYING = "its workers end at once: is there enough memory?"

_LOST = ("KilledWorker", "FutureCancelledError", "CancelledError", "LostDependency")
"""Errors by which Dask says that a task's workers have died."""

_ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "LOKY_MAX_MEMORY_LEAK_SIZE": "1e15",
}
"""Of processes of this machine: one thread each, as there is one for each core, and solved plates that are kept."""


@dataclass(frozen=True)
class Workers:
    """Who computes.

    Attributes:
        executor: gives an executor for so many tasks that works, a new one where the workers of the last have died.
        count: how many work now; inf: not known.
    """

    executor: Callable[[int], Executor]
    count: Callable[[], float]


def results(workers: Workers, compute: Callable[[Task], T], tasks: Iterable[Task]) -> Iterator[tuple[Task, T]]:
    """What is computed for each task, as it comes.

    Raises:
        BadInput: workers die again and again.
    """
    waiting, pending, lost = deque(tasks), dict[Future[T], Task](), 0
    total = len(waiting)
    try:
        while waiting or pending:
            most = min(_AHEAD * max(workers.count(), 1), total)
            while waiting and len(pending) < most:
                try:
                    future = workers.executor(total).submit(compute, waiting[0])
                except BrokenExecutor as error:  # the workers died in this moment
                    future = Future()
                    future.set_exception(error)
                pending[future] = waiting.popleft()
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                task = pending.pop(future)
                failure = CancelledError() if future.cancelled() else future.exception()
                if isinstance(failure, BrokenExecutor) or type(failure).__name__ in _LOST:
                    waiting.appendleft(task)
                    lost += 1
                else:
                    lost = 0
                    yield task, future.result()
            if lost > _DEATHS * most:
                raise BadInput(_DYING, key="sweep")
    finally:
        for future in pending:
            future.cancel()


def workers_of(
    workers: int | None = None, dask: str | None = None, executor: Executor | None = None
) -> AbstractContextManager[Workers]:
    """Who computes: an executor that is given, a Dask cluster, or processes of this machine."""
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int | np.integer) or workers < 1):
        raise BadInput("expected a whole number of processes from 1 on", key="--workers", value=workers)
    if executor is not None:
        return external(executor, math.inf if workers is None else workers)
    return local(workers) if dask is None else cluster(dask)


@contextmanager
def external(executor: Executor, workers: float = math.inf) -> Iterator[Workers]:
    """Workers of an executor that is somebody else's, and stays open."""
    yield Workers(lambda _: executor, lambda: workers)


@contextmanager
def local(workers: int | None = None) -> Iterator[Workers]:
    """Processes of this machine, one for each core unless it is said, no more than tasks; each has one thread."""
    import loky

    count, started = loky.cpu_count() if workers is None else workers, 0
    how = {"initializer": _begin, "initargs": (os.getpid(),), "env": _ENVIRONMENT}

    def executor(tasks: int) -> Executor:
        nonlocal started
        started = max(started, min(count, tasks))
        found: Executor = loky.get_reusable_executor(started, **how)
        return found

    try:
        yield Workers(executor, lambda: count)
    finally:
        if started:
            loky.get_reusable_executor(started, **how).shutdown(kill_workers=True)


@contextmanager
def cluster(address: str) -> Iterator[Workers]:
    """The workers of a Dask scheduler.

    Raises:
        BadInput: no scheduler answers there, it has no workers, or Dask is not installed.
    """
    try:
        from distributed import Client
    except ImportError:
        raise BadInput("needs Dask: pip install 'spindamp[cluster]'", key="--dask", value=address) from None
    try:
        client = Client(address, timeout="10s", set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise BadInput(f"no scheduler answers there: {error}", key="--dask", value=address) from error
    with client:
        if not client.ncores():
            problem = f"the scheduler has no workers: start some with `dask worker {address} --nthreads 1`"
            raise BadInput(problem, key="--dask", value=address)
        with client.get_executor(pure=False, retries=10) as executor:
            yield Workers(lambda _: executor, lambda: sum(client.ncores().values()))


def _begin(parent: int) -> None:
    """In a new process: leave Ctrl-C to the one that started it, and end when that one has ended, however."""

    def end_with_parent() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(0)

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=end_with_parent, daemon=True).start()


_PACKAGES = ("fem", "damper", "workflows")
_ROOT = Path(__file__).parents[3]


@cache
def digest() -> str:
    """SHA-256 of the sources of all packages, names and contents."""
    sha = hashlib.sha256()
    for package in _PACKAGES:
        for path in sorted((_ROOT / package).rglob("*.py")):
            sha.update(path.relative_to(_ROOT).as_posix().encode() + b"\0")
            sha.update(path.read_bytes() + b"\0")
    return sha.hexdigest()


def prepare(code: str) -> None:
    """See that a worker runs the code that the study is of, and has its kernels compiled.

    Raises:
        BadInput: it does not.
    """
    if digest() != code:
        raise BadInput("a worker runs other code than the study: install the same version everywhere", key="sweep")
    ready()


def identity() -> dict[str, str]:
    """The code by its digest, and versions; what differs in any of them may differ in its last bits."""
    return {"sources_sha256": digest()} | versions()


@cache
def ready() -> None:
    """Compile all kernels, or load them: the first process of a machine alone, the others once it is done.

    An installation has a cache of its own: of the code, and of where it lies.
    """
    from filelock import FileLock

    user = getattr(os, "getuid", lambda: 0)()
    place = hashlib.sha256(f"{digest()} {Path(__file__).resolve()}".encode()).hexdigest()[:16]
    done = Path(tempfile.gettempdir()) / f"spindamp-{user}-{place}.compiled"
    if done.exists():
        return
    with FileLock(done.with_suffix(".lock")):
        if not done.exists():
            _compile()
            done.touch()


def _compile() -> None:
    """Run everything once, on level and on tilting floors, without forces and with one."""
    for name in ("level floor", "tilting, hollow floor"):
        damper, given, _ = RINGDOWNS[name]
        damping_curve(damper, threads=1, sweeps=2, stay=1)
        ringdowns(damper, [given["release"]], 1, threads=1)
        backbone(damper, threads=1)
        forced(damper, [Harmonic(damper.stuck_frequency, force=(1.0, 0.0))], threads=1, max_cycles=32)
