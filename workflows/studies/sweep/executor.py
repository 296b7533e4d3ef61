"""Who computes the shards: any `concurrent.futures.Executor`; processes of this machine, or a Dask cluster.

Tasks are handed out a few at a time, in the order of their numbers, and taken as they come: what a worker returns does
not depend on which worker it is. A worker that dies costs the tasks it had, which are handed out again.
"""

from __future__ import annotations

import hashlib
import os
import signal
import tempfile
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from workflows.errors import BadInput
from workflows.versions import versions

if TYPE_CHECKING:
    from multiprocessing.connection import Connection


T = TypeVar("T")

_AHEAD = 2
"""Tasks handed out for each worker: one that it does, one that waits."""

_DEATHS = 6
"""Times in a row that workers may die before any task is finished."""

_DYING = (
    "its workers die as soon as they begin: is there memory enough? A script that starts workers needs"
    " `if __name__ == '__main__':` around what it does"
)

_LOST = ("KilledWorker", "FutureCancelledError", "CancelledError", "LostDependency")
"""Errors by which Dask says that a task's workers have died."""

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

_LOOK = 0.5
"""Seconds after which a wait looks up, so that Ctrl-C is heard everywhere."""


class Crew:
    """An executor that can be had anew when its workers have died.

    Args:
        hire: makes an executor, and what says how many work in it.
    """

    def __init__(self, hire: Callable[[], tuple[Executor, Callable[[], int]]]) -> None:
        self._hire = hire
        self._executor, self._size = hire()

    @property
    def size(self) -> int:
        """How many work now, at least one."""
        return max(self._size(), 1)

    def renew(self) -> None:
        """Dismiss what is left of the workers and hire others."""
        before = self._executor
        self._executor, self._size = self._hire()
        before.shutdown(wait=False)

    def submit(self, task: Callable[..., T], *arguments: Any) -> Future[T]:
        """Hand out a task."""
        return self._executor.submit(task, *arguments)

    def dismiss(self, *, wait: bool = False) -> None:
        """Hand out no more; `wait` for the end of workers that end by themselves."""
        self._executor.shutdown(wait=wait)


def results(crew: Crew, task: Callable[[int], T], numbers: Iterable[int]) -> Iterator[tuple[int, T]]:
    """What a task gives for each number, as it comes.

    Raises:
        BadInput: workers die again and again.
    """
    pending: dict[Future[T], int] = {}
    try:
        yield from _all(crew, task, deque(numbers), pending)
    finally:
        for future in pending:
            future.cancel()


def _all(
    crew: Crew, task: Callable[[int], T], waiting: deque[int], pending: dict[Future[T], int]
) -> Iterator[tuple[int, T]]:
    deaths = 0
    while waiting or pending:
        whole = _hand_out(crew, task, waiting, pending)
        finished, _ = wait(pending, timeout=_LOOK, return_when=FIRST_COMPLETED)
        for future in finished:
            number = pending.pop(future)
            if _died(future):
                waiting.appendleft(number)
                whole = False
            else:
                deaths = 0
                yield number, future.result()
        if not whole:
            waiting.extendleft(pending.values())
            pending.clear()
            deaths += 1
            if deaths > _DEATHS:
                raise BadInput(_DYING, key="sweep")
            crew.renew()


def _hand_out(crew: Crew, task: Callable[[int], T], waiting: deque[int], pending: dict[Future[T], int]) -> bool:
    """Keep every worker busy; False if the executor takes no more tasks."""
    most = _AHEAD * crew.size
    while waiting and len(pending) < most:
        try:
            pending[crew.submit(task, waiting[0])] = waiting[0]
        except BrokenExecutor:
            return False
        waiting.popleft()
    return True


def _died(future: Future[Any]) -> bool:
    if future.cancelled():
        return True
    error = future.exception()
    return isinstance(error, BrokenExecutor) or type(error).__name__ in _LOST


@contextmanager
def given(executor: Executor, workers: int = 1) -> Iterator[Crew]:
    """A crew on an executor that is somebody else's, and stays open."""
    hired = iter([(executor, lambda: workers)])

    def hire() -> tuple[Executor, Callable[[], int]]:
        try:
            return next(hired)
        except StopIteration:
            raise BadInput("its workers have died", key="executor") from None

    yield Crew(hire)


@contextmanager
def local(workers: int | None = None) -> Iterator[Crew]:
    """Processes of this machine, one for each core unless it is said; each computes with one thread."""
    count = _cores() if workers is None else workers
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise BadInput("expected a whole number of processes from 1 on", key="--workers", value=count)
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    context = get_context("spawn")
    held, let_go = context.Pipe(duplex=False)  # workers end when the end that lets go is closed

    def hire() -> tuple[Executor, Callable[[], int]]:
        return ProcessPoolExecutor(count, mp_context=context, initializer=_begin, initargs=(held,)), lambda: count

    with held, let_go, _one_thread():
        crew = Crew(hire)
        try:
            yield crew
        finally:
            let_go.close()
            crew.dismiss(wait=True)


@contextmanager
def cluster(address: str) -> Iterator[Crew]:
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
            raise BadInput(
                f"the scheduler has no workers: start some with `dask worker {address} --nthreads 1`",
                key="--dask",
                value=address,
            )
        crew = Crew(lambda: (client.get_executor(pure=False, retries=10), lambda: sum(client.ncores().values())))
        try:
            yield crew
        finally:
            crew.dismiss()


def _cores() -> int:
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


@contextmanager
def _one_thread() -> Iterator[None]:
    """Processes started meanwhile compute with one thread each: there is one for each core."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _begin(held: Connection) -> None:
    """In a new process: leave Ctrl-C to the one that started it, and end when that one lets go or ends, however."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_parent, args=(held,), daemon=True).start()


def _end_with_the_parent(held: Connection) -> None:
    from multiprocessing import connection, parent_process

    parent = parent_process()
    connection.wait([held] if parent is None else [held, parent.sentinel])
    os._exit(0)


_PACKAGES = ("fem", "damper", "workflows")
_ROOT = Path(__file__).parents[3]


@cache
def digest() -> str:
    """SHA-256 of the sources of all packages, names and contents."""
    found = hashlib.sha256()
    for package in _PACKAGES:
        for path in sorted((_ROOT / package).rglob("*.py")):
            found.update(path.relative_to(_ROOT).as_posix().encode() + b"\0")
            found.update(path.read_bytes() + b"\0")
    return found.hexdigest()


def same(other: str) -> None:
    """See that a worker runs the code that the study is of.

    Raises:
        BadInput: it does not.
    """
    if digest() != other:
        raise BadInput("a worker has other code than the study: install the same version everywhere", key="sweep")


def identity() -> dict[str, str]:
    """The code by its digest, and versions; what differs in any of them may differ in its last bits."""
    return {"sources_sha256": digest()} | versions()


@cache
def ready() -> None:
    """Compile all kernels, or load them: the first process of a machine alone, the others once it is done."""
    from filelock import FileLock

    user = getattr(os, "getuid", lambda: 0)()
    place = Path(tempfile.gettempdir()) / f"spindamp-{user}-{_digest()}"
    done = place.with_suffix(".compiled")
    if done.exists():
        return
    with FileLock(place.with_suffix(".lock")):
        if not done.exists():
            compile_all()
            done.touch()


def compile_all() -> None:
    """Run everything once, on level and on tilting floors, left alone and driven."""
    from damper import Harmonic, ParticleDamper, backbone, forced, ringdowns, working

    level = ParticleDamper(
        modal_mass=1.0,
        stiffness=(1e6, 1e6),
        ball_mass=1e-2,
        ball_radius=1e-3,
        cavity=(3e-3, 3e-3),
        centrifugal_acceleration=1e3,
        restitution=0.5,
        friction=0.3,
        rolling_friction=1e-5,
    )
    for damper in (level, ParticleDamper(**vars(level) | {"floor_tilt": (1.0, 0.0)})):
        working(damper, threads=1, sweeps=2, stay=1)
        ringdowns(damper, [(1e-3, 0.0)], 1, threads=1)
        backbone(damper, threads=1)
        forced(damper, [Harmonic(1e3, force=(1.0, 0.0))], threads=1, max_cycles=32)


def _digest() -> str:
    """Of the code and of where it lies: an installation has a cache of its own."""
    import hashlib

    return hashlib.sha256(f"{digest()} {Path(__file__).resolve()}".encode()).hexdigest()[:16]
