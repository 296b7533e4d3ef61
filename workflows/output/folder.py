"""A folder of results that is replaced whole or not at all.

New results are written into a hidden sibling and take the folder's place in one step, so that whoever looks,
whenever, sees the old results or the new ones. Files in the folder that are not ours stay.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import hashlib
import os
import platform
import re
import secrets
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path

from workflows.errors import BadInput
from workflows.output import signals

WINDOWS = os.name == "nt"

LOCK = ".spindamp.lock"
"""The file that stands for a folder where folders themselves cannot be locked; filelock takes it away again there."""

_WAITS = (0.05, 0.1, 0.2, 0.4, 0.8)
"""Seconds between attempts to rename a folder in which another program, a virus scanner say, has a file open."""

ASIDE = ".old"
"""How the name of a folder ends that a swap in two steps has set aside."""


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """One run at a time, where the system has locks: a killed run gives its lock back by itself."""
    try:
        import fcntl
    except ImportError:
        from filelock import FileLock

        with FileLock(folder / LOCK):
            yield
        return
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        yield
        return
    try:
        with contextlib.suppress(OSError):  # some network disks have none
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def scratch_folder(prefix: str, parent: Path) -> Path:
    """A new folder for results that nobody else looks into while they are being written."""
    if WINDOWS:  # there mkdtemp shuts others out for good: a folder takes its permissions from the one above
        folder = parent / f"{prefix}{secrets.token_hex(8)}"
        folder.mkdir()
        return folder
    return Path(tempfile.mkdtemp(prefix=prefix, dir=parent))


def dress(scratch: Path, target: Path) -> None:
    """Give the new folder the owner and the permissions of the old one, or those that any new folder has."""
    if WINDOWS:
        return
    if not target.is_dir():
        scratch.chmod(0o777 & ~_umask())
        return
    old, new = target.stat(), scratch.stat()
    if hasattr(os, "chown") and (old.st_uid, old.st_gid) != (new.st_uid, new.st_gid):
        with contextlib.suppress(PermissionError):  # only root gives a folder away
            os.chown(scratch, old.st_uid, old.st_gid)
    scratch.chmod(stat.S_IMODE(old.st_mode))


def link_or_copy(old: str, new: str) -> str:
    """The same file under a second name, or a copy of it where the system has no such names."""
    try:
        os.link(old, new)
    except OSError:
        shutil.copy2(old, new)
    return new


def sync(folder: Path) -> None:
    """See the files of a folder, and the folder, onto the disk."""
    for path in folder.iterdir():
        if path.is_file() and not path.is_symlink():
            with path.open("r+b") as file:  # Windows syncs only what can be written
                os.fsync(file.fileno())
    sync_folder(folder)


def sync_folder(folder: Path) -> None:
    """See the names in a folder onto the disk."""
    with contextlib.suppress(OSError):  # not every system can sync a folder
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def swap(scratch: Path, target: Path) -> None:
    """Put a folder in the place of another, in one step where the system can; the old one is then gone or in `scratch`.

    Raises:
        OSError: the file system refuses; `target` is then what it was.
    """
    if not target.exists():
        try:
            rename(scratch, target)
        except OSError as error:
            if error.errno not in (errno.EEXIST, errno.ENOTEMPTY) and not target.is_dir():
                raise  # otherwise another run came first: replace its results
        else:
            sync_folder(target.parent)
            return
    if not exchange(scratch, target):
        aside = scratch.with_name(scratch.name + ASIDE)
        rename(target, aside)
        try:
            rename(scratch, target)
        except OSError:
            rename(aside, target)
            raise
        shutil.rmtree(aside, ignore_errors=True)
    sync_folder(target.parent)


def rename(old: Path, new: Path) -> None:
    """Rename a folder, again and again while it is in use for a moment."""
    for wait in _WAITS:
        try:
            os.rename(old, new)
        except PermissionError:
            time.sleep(wait)
        else:
            return
    os.rename(old, new)


def exchange(one: Path, other: Path) -> bool:
    """Exchange two folders in one step (Linux); False where the system cannot."""
    at_cwd, both = -100, 2
    try:
        renameat2 = ctypes.CDLL(None, use_errno=True).renameat2
    except (OSError, AttributeError, TypeError):
        return False
    return bool(renameat2(at_cwd, os.fsencode(one), at_cwd, os.fsencode(other), both) == 0)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


MANIFEST = ".spindamp"
"""Lists what a run wrote, so that the next one can tell its own files from a user's."""

ALWAYS_OURS = {"results.json", "results.nc", "modes.vtu", "report.html", MANIFEST}
_CARRIED_AT_MOST = 1000
_NAME_MAX = 255
"""Bytes that file systems take for a name."""

_NO_LETTERS = '<>:"|?*'
"""What a name cannot hold on Windows."""

_LONGEST_NAME = 100
"""Bytes of a name that goes into that of its scratch folder, which is longer."""


def check(folder: Path, names: str = "") -> Path:
    """Where results can go, resolved; looked at before any work is done, and nothing is written.

    Args:
        folder: what the user asked for.
        names: a regular expression for names of files that will be written besides the usual ones.

    Raises:
        BadInput: `folder` is a file, the current folder or one above it, or cannot be written.
    """
    try:
        target = _resolved(folder)
        exists = target.exists() or target.is_symlink()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise BadInput(f"cannot be a folder: {reason}", key="--out", value=str(folder)) from error
    if exists and not target.is_dir():
        problem: str | None = "is a file: expected a folder"
    else:
        problem = _not_to_be_replaced(target) or (_held(target, names) if exists else None)
    if problem is not None:
        raise BadInput(problem, key="--out", value=str(folder))
    return target


def _resolved(folder: Path) -> Path:
    """The folder without links.

    Raises:
        OSError, ValueError: it has a name that no folder has.
    """
    target = Path(os.path.realpath(folder))
    if any(len(os.fsencode(part)) > _NAME_MAX for part in target.parts):
        raise OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG))
    if WINDOWS and any(map(_no_name, target.parts[1:])):
        raise ValueError(f"no name may hold any of {_NO_LETTERS} or end in a dot or blank")
    return target


def _not_to_be_replaced(target: Path) -> str | None:
    """What is against putting another folder in this one's place, be it there or not."""
    here = Path.cwd().resolve()
    if target == here or target in here.parents:
        return "expected a folder of its own, below the current one or elsewhere"
    if os.path.ismount(target):
        return "is a disk of its own: expected a folder on it"
    parent = next((p for p in target.parents if p.exists()), target.anchor)
    if not os.path.isdir(parent) or not os.access(parent, os.W_OK | os.X_OK):
        return f"{parent} cannot be written"
    return None


def _held(target: Path, names: str) -> str | None:
    """What a folder holds that is against it."""
    foreign = _foreign(target)
    taken = [path.name for path in foreign if path.name in ALWAYS_OURS or re.fullmatch(names, path.name)]
    if taken:
        return f"holds a {taken[0]} that no run of ours wrote: expected another folder"
    if len(foreign) > _CARRIED_AT_MOST:
        return "holds too many files that are not results: expected a new folder or one with results"
    return None


@contextmanager
def replacing(folder: Path) -> Iterator[Path]:
    """A scratch folder that becomes `folder` when the block ends well, and vanishes when it does not.

    Raises:
        BadInput: see :func:`check`, and whenever the file system refuses (no space left, say).
    """
    target = check(folder)
    scratch: Path | None = None
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        _clear(target)
        prefix = f"{_prefix(target)}{os.getpid()}-"
        scratch = scratch_folder(prefix, target.parent)
        yield scratch
        names = "".join(f"{path.name}\n" for path in sorted(scratch.iterdir()))
        (scratch / MANIFEST).write_text(names, encoding="utf-8")
        sync(scratch)
        with alone_in(target.parent):
            _carry_over(target, scratch)
            dress(scratch, target)
            sync_folder(scratch)
            signals.ignore()
            _swap(scratch, target, folder)
    except OSError as error:
        raise BadInput(f"cannot be written: {error.strerror or error}", key="--out", value=str(folder)) from error
    finally:
        # After the swap the scratch name holds what was there before.
        if scratch is not None:
            shutil.rmtree(scratch, ignore_errors=True)


def _swap(scratch: Path, target: Path, folder: Path) -> None:
    """Put new results in the place of old ones or, where these are held fast, beside them."""
    try:
        swap(scratch, target)
    except PermissionError as error:
        beside = next(p for n in count(1) if not os.path.lexists(p := target.with_name(f"{target.name}-{n}")))
        rename(scratch, beside)
        as_given = folder.with_name(beside.name) if folder.parent.resolve() == target.parent else beside
        raise BadInput(
            f"cannot be replaced: {error.strerror}, as while another program has a file in it open; the new results"
            f" are in {as_given}",
            key="--out",
            value=str(folder),
        ) from error


def _prefix(target: Path) -> str:
    """How the names of scratch folders begin; short enough for a file system that takes the folder's own name."""
    name = target.name if len(os.fsencode(target.name)) <= _LONGEST_NAME else _digest(target.name)
    return f".{name}.{platform.node()[:64]}-"


def _no_name(part: str) -> bool:
    return bool(set(part) & set(_NO_LETTERS)) or part.endswith((".", " "))


def _digest(name: str) -> str:
    return hashlib.sha256(os.fsencode(name)).hexdigest()[:16]


def _clear(target: Path) -> None:
    """Remove what runs that were killed left beside `target`: scratch folders of processes that are gone.

    A run killed between the two steps of a swap left the old results aside: they come back.
    """
    prefix = _prefix(target)
    for path in target.parent.iterdir():
        number = path.name.removeprefix(prefix).partition("-")[0]
        if path.name.startswith(prefix) and number.isdecimal() and not _alive(int(number)):
            if path.suffix == ASIDE and not os.path.lexists(target):
                os.rename(path, target)
            else:
                shutil.rmtree(path, ignore_errors=True)


def _alive(process: int) -> bool:
    import psutil

    try:
        return psutil.pid_exists(process)
    except OverflowError:
        return True


def _foreign(target: Path) -> list[Path]:
    """What is in a folder besides results of ours: whatever the manifest of the last run does not list."""
    ours = {MANIFEST}
    with contextlib.suppress(OSError, UnicodeDecodeError):
        ours |= set((target / MANIFEST).read_text(encoding="utf-8").splitlines())
    return [path for path in sorted(target.iterdir()) if path.name not in ours]


def _carry_over(target: Path, scratch: Path) -> None:
    if not target.is_dir():
        return
    for path in _foreign(target):
        new = scratch / path.name
        if os.path.lexists(new):
            raise BadInput(f"holds a {path.name} that no run of ours wrote", key="--out", value=str(target))
        if path.is_symlink():
            new.symlink_to(os.readlink(path), target_is_directory=path.is_dir())
        elif path.is_dir():
            shutil.copytree(path, new, symlinks=True, copy_function=link_or_copy)
        else:
            link_or_copy(str(path), str(new))
