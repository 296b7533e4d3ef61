"""A folder of results that is replaced whole or not at all, whatever ends the run; and the signals that may end it.

A run writes into a scratch folder beside it, which takes its place by one rename; from then on signals are ignored.
Before that they are raised as exceptions. What a handler raises may be lost in a finaliser or in a callback of C, so
that it is raised again until the command ends.
"""

import contextlib
import ctypes
import errno
import hashlib
import os
import platform
import re
import secrets
import shutil
import signal
import stat
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any, TypeAlias

from workflows.errors import BadInput

_Handler: TypeAlias = Callable[[int, FrameType | None], Any] | int | None

_USUAL = {"SIGINT": signal.default_int_handler, "SIGTERM": signal.SIG_DFL, "SIGHUP": signal.SIG_DFL}
"""What is done at the signals that end a command, unless somebody has it otherwise: nohup, say."""

_REPEAT = 0.2
"""Seconds after which a signal is raised again if nothing has come of it."""

_STARTS_OVER = "no partial files are left; the same command starts over"
_outcome = [_STARTS_OVER]

_signals: list[BaseException] = []
"""What the signals raise that have come since a command began."""

_before: dict[int, _Handler] = {}
"""The signals that a running command has taken, and what was done at them before."""

_timer: list[tuple[float, float]] = []
"""The timer that was set before a signal came."""


class Terminated(BaseException):
    """A signal asked the program to end; no handler of a library takes it for its own."""


def restart_advice() -> str:
    """What an end from outside leaves, in words."""
    return _outcome[-1]


@contextmanager
def resumable(words: str) -> Iterator[None]:
    """While the block lasts, and where it is ended from outside, an end leaves something else; in these words."""
    _outcome.append(words)
    yield
    _outcome.pop()


@contextmanager
def orderly_end(*, to_the_end: bool) -> Iterator[None]:
    """Let what would end the program at once end it as a Ctrl-C does; what is ignored (nohup) stays so.

    Afterwards all is as before or, `to_the_end` of the process, ignored: a second signal must not garble the end.
    """
    _outcome[:] = [_STARTS_OVER]
    _signals.clear()
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    for name, usual in _USUAL.items():
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) == usual:
            _before[number] = signal.signal(number, _raise)
    hook = sys.unraisablehook
    sys.unraisablehook = lambda lost: None if lost.exc_value in _signals else hook(lost)  # it is raised again
    try:
        yield
    finally:
        sys.unraisablehook = hook
        if to_the_end:
            ignore()
        elif _timer:
            signal.setitimer(signal.ITIMER_REAL, *_timer.pop())
        while _before:
            number, handler = _before.popitem()
            if not to_the_end:
                signal.signal(number, handler)


@contextmanager
def signal_as_cause() -> Iterator[None]:
    """What fails in the block after a signal came ends as the signal does.

    What a signal raises while a library takes or gives back a lock turns into an error of that lock.
    """
    try:
        yield
    except (Exception, SystemExit) as error:
        if _signals:
            raise _signals[0] from error
        raise


def ignore() -> None:
    """From now on no signal ends the running command: its results are about to be in place. Without one, nothing."""
    for number in _before:
        signal.signal(number, signal.SIG_IGN)


def _raise(number: int, frame: FrameType | None) -> None:
    error = KeyboardInterrupt() if number == signal.SIGINT else Terminated(signal.Signals(number).name)
    _signals.append(error)
    if len(_signals) == 1 and hasattr(signal, "setitimer"):
        _before[signal.SIGALRM] = signal.signal(signal.SIGALRM, _raise_again)
        _timer[:] = [signal.setitimer(signal.ITIMER_REAL, _REPEAT, _REPEAT)]
    raise error


def _raise_again(number: int, frame: FrameType | None) -> None:
    """Raise what came, unless that, or what a library made of it, is being handled already."""
    error = sys.exc_info()[1]
    while error is not None and error not in _signals:
        error = error.__context__
    if error is None and _signals:
        raise _signals[0]


MANIFEST = ".spindamp"
"""Lists what a run wrote, so that the next one can tell its own files from a user's."""

ALWAYS_OURS = {"results.json", "results.nc", "modes.vtu", "report.html", MANIFEST}
ASIDE = ".old"
"""How the name of a folder ends that was set aside where two cannot be exchanged in one step."""

PARTIAL = ".partial-"
"""How the names of files begin that are not whole yet."""

_CARRIED_AT_MOST = 1000
_NAME_MAX, _LONGEST_NAME = 255, 100
"""Bytes that file systems take for a name, and those of a name that goes into its scratch folder's, which is longer."""


def check(folder: Path, names: str = "", *read: str) -> Path:
    """Where results can go, resolved; looked at before any work is done, and nothing is written.

    Args:
        folder: what the user asked for.
        names: a regular expression for names of files that will be written besides the usual ones.
        read: the scenes and the folders of runs that the results are made of.

    Raises:
        BadInput: `folder` is a file, the current folder or one above it, cannot be written, or would lose what is read.
    """
    try:
        target = Path(os.path.realpath(folder))
        if any(len(os.fsencode(part)) > _NAME_MAX for part in target.parts):
            raise OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG))
        exists = target.exists() or target.is_symlink()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise BadInput(f"cannot be a folder: {reason}", key="--out", value=str(folder)) from error
    if exists and not target.is_dir():
        problem: str | None = "is a file: expected a folder"
    elif exists and not os.access(target, os.W_OK):
        problem = "is read-only: expected a folder that can be written"
    else:
        problem = _not_to_be_replaced(target) or (_conflict(target, names, read) if exists else None)
    if problem is not None:
        raise BadInput(problem, key="--out", value=str(folder))
    return target


def _not_to_be_replaced(target: Path) -> str | None:
    """What is against putting another folder in this one's place, be it there or not."""
    here = Path.cwd().resolve()
    if target == here or target in here.parents:
        return "expected a folder of its own, below the current one or elsewhere"
    if os.path.ismount(target):
        return "is a disk of its own: expected a folder on it"
    return unwritable(target)


def unwritable(target: Path) -> str | None:
    """That nothing can be put where a path leads; rights alone do not tell, as in /proc."""
    parent = next((p for p in target.parents if p.exists()), target.anchor)
    try:
        with tempfile.TemporaryFile(dir=parent):
            return None
    except OSError:
        return f"{parent} cannot be written"


def _conflict(target: Path, names: str, read: Sequence[str]) -> str | None:
    """What a folder holds that is against it."""
    foreign = _user_files(target)
    for path in map(Path, read):
        if path.is_dir() and path.resolve() == target:
            return "is one of the runs that are read: expected another folder"
        if path.is_file() and path.resolve().parent == target and target / path.resolve().name not in foreign:
            return f"holds {path.name}, the scene of this run, which would be deleted: expected another folder"
    taken = [path.name for path in foreign if path.name in ALWAYS_OURS or re.fullmatch(names, path.name)]
    if taken:
        return f"holds a {taken[0]} that no run wrote: expected another folder"
    if len(foreign) > _CARRIED_AT_MOST:
        return "holds too many files that are not results: expected a new folder or one with results"
    return None


def _user_files(target: Path) -> list[Path]:
    """What is in a folder besides results of a run: whatever the manifest of the last run does not list."""
    ours = {MANIFEST}
    with contextlib.suppress(OSError, UnicodeDecodeError):
        ours |= set((target / MANIFEST).read_text(encoding="utf-8").splitlines())
    return [path for path in sorted(target.iterdir()) if path.name not in ours]


@contextmanager
def replacing(folder: Path) -> Iterator[Path]:
    """A scratch folder that becomes `folder` when the block ends well, and vanishes when it does not.

    Raises:
        BadInput: see :func:`check`, and whenever the file system refuses (no space left, say).
    """
    from filelock import FileLock

    target = check(folder)
    with writing(folder), contextlib.ExitStack() as stack:
        target.parent.mkdir(parents=True, exist_ok=True)
        _remove_leftovers(target)
        scratch = Path(tempfile.mkdtemp(prefix=f"{_prefix(target)}{os.getpid()}-", dir=target.parent))
        # After the swap the scratch name holds what was there before.
        stack.callback(shutil.rmtree, scratch, ignore_errors=True)
        yield scratch
        names = "".join(f"{path.name}\n" for path in sorted(scratch.iterdir()))
        (scratch / MANIFEST).write_text(names, encoding="utf-8")
        for path in scratch.iterdir():
            if path.is_file() and not path.is_symlink():
                _sync(path)
        user = getattr(os, "getuid", lambda: 0)()
        with FileLock(Path(tempfile.gettempdir()) / f"spindamp-{user}.lock"):  # one run of this user at a time
            _carry_over(target, scratch)
            _copy_permissions(scratch, target)
            _sync(scratch)
            ignore()
            _swap(scratch, target)


@contextmanager
def writing(path: str | os.PathLike[str], key: str = "--out", more: str = "") -> Iterator[None]:
    """What the disk refuses in the block is bad input; `key` named the path, `more` says what else is to be known."""
    try:
        yield
    except OSError as error:
        raise BadInput(f"cannot be written: {error.strerror or error}{more}", key=key, value=str(path)) from error


@contextmanager
def replacing_file(path: Path) -> Iterator[Path]:
    """A file beside a path, of the same ending, that takes its place when the block ends well, and else vanishes."""
    aside = path.with_name(f"{PARTIAL}{secrets.token_hex(8)}{path.suffix.lower()}")
    try:
        yield aside
        _sync(aside)
        os.replace(aside, path)
    finally:
        aside.unlink(missing_ok=True)


def put(path: str | os.PathLike[str], write: Callable[[Path], object], key: str = "path") -> Path:
    """Put what is written in the place of a file, whole or not at all; returns the file, resolved.

    Raises:
        BadInput: it cannot be written; `key` is what named it.
    """
    out = writable(path, key)
    with writing(path, key):
        out.parent.mkdir(parents=True, exist_ok=True)
        with replacing_file(out) as fresh:
            write(fresh)
    return out


def writable(path: str | os.PathLike[str], key: str = "path") -> Path:
    """The path of a file, resolved; BadInput where there can be none."""
    try:
        target = Path(path).resolve()
        taken, special = target.is_dir(), target.exists() and not target.is_file()
    except (OSError, ValueError, RuntimeError) as error:  # RuntimeError: a loop of links
        problem = f"cannot be a file: {getattr(error, 'strerror', None) or error}"
        raise BadInput(problem, key=key, value=str(path)) from error
    if taken or os.fspath(path).endswith(("/", os.sep)):
        raise BadInput("is a folder: expected a file, such as 'report.html'", key=key, value=str(path))
    if special:
        raise BadInput("is not a regular file: expected one such as 'report.html'", key=key, value=str(path))
    if (why := unwritable(target)) is not None:
        raise BadInput(why, key=key, value=str(path))
    return target


def _prefix(target: Path) -> str:
    """How the names of scratch folders begin; short enough for a file system that takes the folder's own name."""
    name, written = target.name, os.fsencode(target.name)
    name = name if len(written) <= _LONGEST_NAME else hashlib.sha256(written).hexdigest()[:16]
    return f".{name}.{platform.node()[:64]}-"


def _remove_leftovers(target: Path) -> None:
    """Remove what runs that were killed left beside `target`: scratch folders of processes that are gone.

    A run killed between the two steps of a swap left the old results aside: they come back.
    """
    import psutil

    prefix = _prefix(target)
    for path in target.parent.iterdir():
        number = path.name.removeprefix(prefix).partition("-")[0]
        if path.name.startswith(prefix) and re.fullmatch("[0-9]{1,9}", number) and not psutil.pid_exists(int(number)):
            if path.suffix == ASIDE and not os.path.lexists(target):
                os.rename(path, target)
            else:
                shutil.rmtree(path, ignore_errors=True)


def _carry_over(target: Path, scratch: Path) -> None:
    """Put the user's own files of the old folder into the new one."""
    for path in _user_files(target) if target.is_dir() else []:
        new = scratch / path.name
        if os.path.lexists(new):
            raise BadInput(f"holds a {path.name} that no run wrote", key="--out", value=str(target))
        if path.is_dir() and not path.is_symlink():
            shutil.copytree(path, new, symlinks=True, copy_function=_link_or_copy)
        else:
            _link_or_copy(path, new)


def _link_or_copy(old: str | Path, new: str | Path) -> str | Path:
    """The same file under a second name, or a copy of it where the system has no such names."""
    try:
        os.link(old, new, follow_symlinks=False)
    except (OSError, NotImplementedError):
        shutil.copy2(old, new, follow_symlinks=False)
    return new


def _copy_permissions(scratch: Path, target: Path) -> None:
    """Give the new folder the owner and the permissions of the old one, or those that any new folder has."""
    if not target.is_dir():
        mask = os.umask(0)
        os.umask(mask)
        scratch.chmod(0o777 & ~mask)
        return
    old = target.stat()
    with contextlib.suppress(OSError, AttributeError):  # only root gives a folder away
        os.chown(scratch, old.st_uid, old.st_gid)
    scratch.chmod(stat.S_IMODE(old.st_mode))


def _sync(path: Path) -> None:
    """See a file, or the names in a folder, onto the disk."""
    with contextlib.ExitStack() as stack:
        if path.is_dir():
            stack.enter_context(contextlib.suppress(OSError))  # not every system can sync a folder
        handle = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
        stack.callback(os.close, handle)
        os.fsync(handle)


def _swap(scratch: Path, target: Path) -> None:
    """Put a folder in the place of another, in one step where the system can; the old one is then gone or in `scratch`.

    Raises:
        OSError: the file system refuses; `target` is then what it was.
    """
    if not target.exists():
        os.rename(scratch, target)
    elif not exchange(scratch, target):
        aside = scratch.with_name(scratch.name + ASIDE)
        os.rename(target, aside)
        try:
            os.rename(scratch, target)
        except OSError:
            os.rename(aside, target)
            raise
        shutil.rmtree(aside, ignore_errors=True)
    _sync(target.parent)


def exchange(one: Path, other: Path) -> bool:
    """Exchange two folders in one step (Linux); False where the system cannot."""
    at_cwd, both = -100, 2
    try:
        renameat2 = ctypes.CDLL(None, use_errno=True).renameat2
    except (OSError, AttributeError, TypeError):
        return False
    return bool(renameat2(at_cwd, os.fsencode(one), at_cwd, os.fsencode(other), both) == 0)
