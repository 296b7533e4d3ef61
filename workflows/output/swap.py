"""Steps on whole folders that replacing one by another is made of, on any file system."""

from __future__ import annotations

import contextlib
import ctypes
import errno
import os
import secrets
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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


def scratch(prefix: str, parent: Path) -> Path:
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
