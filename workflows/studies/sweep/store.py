"""The folder of a study: immutable shards, each written aside, synced and renamed by the one process with the lock.

study.json        what is computed, and by which code; written first, never changed
shards/000000.npz rows of the points from there on
sweep.zarr        all of them as one labelled data set, once they are there
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import os
import shutil
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from workflows.errors import BadInput
from workflows.output import folder as folders
from workflows.output import folder as store
from workflows.studies.sweep.axes import SPEEDS, Value
from workflows.studies.sweep.evaluate import QUANTITIES, Block

if TYPE_CHECKING:
    import xarray as xr

    from workflows.studies.sweep.evaluate import Block
    from workflows.studies.sweep.plan import Plan


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
        BadInput: see :func:`workflows.output.folder.check`; or it holds what no study wrote.
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


Along: TypeAlias = dict[str, tuple[str, list[Value]]]
"""The values of every axis, and the dimension that they lie along."""

_SLAB = 16384
"""Points that are held at a time while a data set is written, and of its chunks."""


def write(plan: Plan, rows: Callable[[int, int], Block], attributes: dict[str, str], path: Path) -> None:
    """Write the data set of a whole study as Zarr, slab by slab along its first dimension.

    Args:
        plan: the study's points.
        rows: gives the rows of the points from one to before another, and their reasons.
        attributes: of the data set.
        path: where to.
    """
    first = next(iter(plan.dimensions))
    length, along_axes = plan.dimensions[first], plan.coordinates()
    for begin, end in slabs(plan):
        data = _slab(plan, along_axes, rows, begin, end).assign_attrs(attributes)
        if begin == 0:
            chunks = (min(length, _step(plan)), *list(plan.dimensions.values())[1:])
            encoding = {name: {"chunks": chunks} for name in data.data_vars}
            data.to_zarr(path, mode="w", encoding=encoding, consolidated=False, zarr_format=3)
        else:
            along = data.drop_vars([name for name in data.variables if first not in data[name].dims])
            along.to_zarr(path, append_dim=first, consolidated=False, zarr_format=3)


def slabs(plan: Plan) -> Iterator[tuple[int, int]]:
    """Stretches of the first dimension that are written at a time."""
    length, step = next(iter(plan.dimensions.values())), _step(plan)
    for begin in range(0, length, step):
        yield begin, min(begin + step, length)


def _step(plan: Plan) -> int:
    return max(1, _SLAB // math.prod(list(plan.dimensions.values())[1:]))


def _slab(plan: Plan, along_axes: Along, rows: Callable[[int, int], Block], begin: int, end: int) -> xr.Dataset:
    import xarray as xr

    names = tuple(plan.dimensions)
    shape = (end - begin, *list(plan.dimensions.values())[1:])
    each = math.prod(shape[1:])
    block = rows(begin * each, end * each)
    data: dict[str, Any] = {}
    for quantity in QUANTITIES:
        attributes = {"long_name": quantity.meaning, "units": quantity.unit}
        data[quantity.name] = (names, block.rows[quantity.name].reshape(shape), attributes)
    texts = np.array([*block.reasons, ""], dtype=object)[block.rows["reason"]]
    data["reason"] = (names, texts.reshape(shape), {"long_name": "why there is no answer; empty where there is one"})
    return xr.Dataset(data, coords=_coordinates(plan, along_axes, names[0], begin, end))


def _coordinates(plan: Plan, along_axes: Along, first: str, begin: int, end: int) -> dict[str, Any]:
    """Values of the keys along their dimensions, and the speeds in rpm beside them."""
    units = {axis.name: axis.key.unit for axis in plan.axes}
    found: dict[str, Any] = {}
    for name, (along, values) in along_axes.items():
        mine = values[begin:end] if along == first else values
        found[name] = (along, _array(mine), {"units": units[name]} if units[name] else {})
        if name == SPEEDS:
            from workflows.solve.results import rpm

            found["rpm"] = (along, np.array([rpm(float(value)) for value in mine]), {"units": "rpm"})
    return found


def _array(values: list[Value]) -> Any:
    """Numbers as numbers; words and truth values as words."""
    if any(isinstance(value, bool | str) for value in values):
        return np.array([value if isinstance(value, str) else str(value).lower() for value in values], dtype=object)
    return np.array(values)


def opened_table(path: Path) -> xr.Dataset:
    """A data set that was written, read as it is asked for."""
    import xarray as xr

    found = xr.open_dataset(path, engine="zarr", consolidated=False)
    # Zarr lists its arrays in any order.
    data = {name: found[name].variable for name in (*(quantity.name for quantity in QUANTITIES), "reason")}
    coordinates = {name: found[name].variable for name in (*keys_of(found), "rpm")}
    return xr.Dataset(data, coords=coordinates, attrs=found.attrs)


def keys_of(data: xr.Dataset) -> list[str]:
    """The keys that are varied, in the order of the plan."""
    found: list[str] = json.loads(data.attrs["keys"])
    return found


def attributes(title: str, plan: Plan, identity: dict[str, Any], key: str) -> dict[str, str]:
    """What a data set says of its origin."""
    return {
        "title": title,
        "keys": json.dumps([axis.name for axis in plan.axes]),
        "study": key,
        "scene": json.dumps(identity["scene"], ensure_ascii=False, sort_keys=True),
        "code": json.dumps(identity["code"], sort_keys=True),
    }
