"""The folder of a study: immutable shards, each written aside, synced and renamed by the one process with the lock.

study.json        what is computed, and by which code; written first, never changed
shards/000000.npz rows of the points from there on
sweep.zarr        all of them as one labelled data set, once they are there
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import shutil
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workflows.errors import BadInput
from workflows.output import store
from workflows.output import swap as folders
from workflows.studies.sweep.quantities import Block

STUDY, SHARDS, LOCK = "study.json", "shards", ".lock"
_ASIDE = ".partial-"
"""How the names of files begin that are not whole yet; the lock's owner may remove them."""

OURS = r"sweep\.(json|zarr|csv)|study\.json|shards|report\.html|uncertain\.csv|best\.toml"
"""Names that a study writes, as a regular expression."""


_TORN = (OSError, EOFError, ValueError, KeyError, zipfile.BadZipFile)


@dataclass(frozen=True)
class Folder:
    """A study's folder, its lock held.

    Attributes:
        path: where it is.
        given: the same as it was asked for.
        key: digest of what is computed and of the code that does it.
    """

    path: Path
    given: Path
    key: str

    def shard(self, number: int) -> Path:
        """The file of a shard."""
        return self.path / SHARDS / f"{number:06d}.npz"

    def done(self, ranges: list[tuple[int, int]]) -> set[int]:
        """Numbers of the shards that are there and whole; what is not is removed, and will be computed again."""
        found = set()
        for number, (begin, end) in enumerate(ranges):
            if not self.shard(number).exists():
                continue
            try:
                block = self.read(number)
                if block.begin != begin or len(block.rows) != end - begin:
                    raise ValueError("other points")
            except _TORN:
                self.shard(number).unlink(missing_ok=True)
            else:
                found.add(number)
        return found

    def write(self, number: int, block: Block) -> None:
        """Write a shard.

        Raises:
            BadInput: the disk does not take it; what is finished stays.
        """
        out = io.BytesIO()
        np.savez(out, key=np.array(self.key), begin=block.begin, rows=block.rows, reasons=np.array(block.reasons, "U"))
        with writing(self.given):
            write_whole(self.shard(number), out.getvalue())

    def read(self, number: int) -> Block:
        """Read a shard; every byte of it is checked.

        Raises:
            OSError, EOFError, ValueError, KeyError, zipfile.BadZipFile: it is not whole.
        """
        with np.load(io.BytesIO(self.shard(number).read_bytes())) as found:
            if str(found["key"]) != self.key:
                raise ValueError("a shard of another study")
            return Block(int(found["begin"]), found["rows"], tuple(map(str, found["reasons"])))


@contextmanager
def opened(path: Path, key: str, identity: dict[str, Any]) -> Iterator[Folder]:
    """The folder of a study for as long as the block lasts, new or begun before.

    Raises:
        BadInput: another process writes into it, it holds another study, or it cannot be written.
    """
    from filelock import FileLock, Timeout

    target = checked(path)
    with writing(path):
        (target / SHARDS).mkdir(parents=True, exist_ok=True)
    lock = FileLock(target / LOCK, timeout=0)
    try:
        lock.acquire()
    except Timeout:
        raise BadInput(
            "another sweep is writing into it: wait for its end, or take another folder", key="--out", value=str(path)
        ) from None
    except (OSError, NotImplementedError) as error:
        raise BadInput(f"cannot be locked: {error}", key="--out", value=str(path)) from error
    try:
        _clear(target)
        _settle(target, path, key, identity)
        yield Folder(target, path, key)
    finally:
        lock.release()


def checked(path: Path) -> Path:
    """Where a study can go, resolved; nothing is written.

    Raises:
        BadInput: see :func:`workflows.output.store.check`; or it holds what no study wrote.
    """
    target = Path(os.path.realpath(path))
    if (target / STUDY).is_file():
        return target
    target = store.check(path)
    if target.is_dir():
        others = [found.name for found in sorted(target.iterdir()) if found.name not in (SHARDS, LOCK)]
        others = [name for name in others if not name.startswith(_ASIDE)]
        if others:
            raise BadInput(
                f"holds a {others[0]} and no study: expected a new folder or one with a study",
                key="--out",
                value=str(path),
            )
    return target


def _settle(target: Path, path: Path, key: str, identity: dict[str, Any]) -> None:
    """Say in a new folder what is computed in it; see that an old one is of the same study."""
    known = target / STUDY
    text = json.dumps({"key": key} | identity, indent=1, ensure_ascii=False, allow_nan=False)
    if not known.exists():
        with writing(path):
            write_whole(known, f"{text}\n".encode())
        return
    try:
        before = json.loads(known.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"its {STUDY} cannot be read: {error}", key="--out", value=str(path)) from error
    if before.get("key") != key:
        names = [name for name in identity if json.loads(json.dumps(identity[name])) != before.get(name)]
        what = " and ".join(_CALLED.get(name, name) for name in names) or "key"
        raise BadInput(
            f"holds a study that differs in its {what}: expected another folder, or the old one removed",
            key="--out",
            value=str(path),
        )


_CALLED = {"code": "code and versions", "plan": "points", "scene": "scene"}


def _clear(target: Path) -> None:
    """Remove what a killed process left half-written."""
    for folder in (target, target / SHARDS):
        for path in folder.glob(f"{_ASIDE}*"):
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """What goes wrong with the disk, in one line."""
    try:
        yield
    except OSError as error:
        raise BadInput(
            f"cannot be written: {error.strerror or error}; what is finished stays, and the same command goes on",
            key="--out",
            value=str(path),
        ) from error


def write_whole(path: Path, data: bytes) -> None:
    """Write a file aside, see it onto the disk, and give it its name: it is there whole or not at all."""
    aside = path.with_name(f"{_ASIDE}{path.name}")
    try:
        with aside.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(aside, path)
    except OSError:
        with contextlib.suppress(OSError):
            aside.unlink()
        raise
    folders.sync_folder(path.parent)


@contextmanager
def replaced(target: Path) -> Iterator[Path]:
    """A folder aside that takes the place of `target` once it is whole and on the disk."""
    aside = target.with_name(f"{_ASIDE}{target.name}")
    shutil.rmtree(aside, ignore_errors=True)
    try:
        yield aside
        for folder, _, _ in os.walk(aside):
            folders.sync(Path(folder))
        folders.swap(aside, target)
    finally:
        shutil.rmtree(aside, ignore_errors=True)
