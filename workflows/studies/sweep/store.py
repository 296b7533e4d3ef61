"""The folder of a study: one Zarr data set, written in place by the one process that holds the lock.

A region of neighbouring points is one chunk of every array: Zarr puts a chunk in place whole, and its checksum shows
damage. Points are computed in smaller parts, and a region is written again as parts of it come. Its chunk of `done` is
written last, so that a study killed anywhere goes on where it was.
"""

from __future__ import annotations

import itertools
import json
import math
import os
import shutil
import time
import warnings
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.errors import BadInput
from workflows.formatting import listed, rounded_rpm
from workflows.io import folder
from workflows.io.serialise import Quantity
from workflows.studies.sweep.evaluate import DONE, QUANTITIES, ROW, Rows, empty
from workflows.studies.sweep.plan import SPEEDS, Plan

if TYPE_CHECKING:
    import xarray as xr

DATA, LOCK = "sweep.zarr", ".lock"

_METADATA = "zarr.json"

GOES_ON = "finished points are kept; the same command resumes"


@dataclass(frozen=True)
class Region:
    """Neighbouring points that are written together: one chunk of every array.

    Attributes:
        begin, end: absolute indices of its first point, and of the one after its last.
        slices: where they lie along each dimension.
        chunk: numbers of the chunk.
    """

    begin: int
    end: int
    slices: tuple[slice, ...]
    chunk: tuple[int, ...]


@dataclass(frozen=True)
class Part:
    """Points of a region that are computed together: absolute indices of the first, and of the one after the last."""

    region: Region
    begin: int
    end: int

    @property
    def points(self) -> slice:
        """Where they lie in their region."""
        return slice(self.begin - self.region.begin, self.end - self.region.begin)


def regions(plan: Plan, most: int) -> list[Region]:
    """All points of a plan, in order, in regions of at most so many."""
    lengths, sides = tuple(plan.dimensions.values()), _chunk_shape(plan, most)
    blocks, begin = [], 0
    for chunk in itertools.product(*(range(-(-n // side)) for n, side in zip(lengths, sides, strict=True))):
        slices = tuple(
            slice(k * side, min((k + 1) * side, n)) for k, side, n in zip(chunk, sides, lengths, strict=True)
        )
        end = begin + math.prod(each.stop - each.start for each in slices)
        blocks.append(Region(begin, end, slices, chunk))
        begin = end
    return blocks


def _chunk_shape(plan: Plan, most: int) -> tuple[int, ...]:
    """Points of a chunk along each dimension: the fastest ones whole, so that its points are neighbours."""
    sides: list[int] = []
    for length in reversed(plan.dimensions.values()):
        sides.insert(0, min(length, max(most // math.prod(sides), 1)))
    return tuple(sides)


SELDOM = 100.0
"""Time between two writings of what has come, over the time that one takes."""


@dataclass
class Folder:
    """A study's folder, its lock held; it collects the points that come, and writes their regions from time to time.

    Attributes:
        path: where it is.
        user_path: the same as the user wrote it.
        arrays: of the data set, by name; `done`, which says what may be read of the others, is the last.
        contents: of regions that are done in part, by their first point.
    """

    path: Path
    user_path: Path
    arrays: dict[str, Any]
    contents: dict[int, Rows] = field(default_factory=dict)
    _changed: dict[int, Region] = field(default_factory=dict)
    _next: float = -math.inf

    def content(self, region: Region) -> Rows:
        """What is done of a region, where every byte of it is as it was written; else nothing of it is."""
        content = empty(region.end - region.begin)
        try:
            for name, array in self.arrays.items():
                if not self.path.joinpath(DATA, name, "c", *map(str, region.chunk)).is_file():
                    return empty(len(content))  # Zarr reads what is missing as empty
                content[name] = np.asarray(array[region.slices]).ravel()
        except (OSError, ValueError):
            return empty(len(content))
        return content

    def add(self, part: Part, rows: Rows) -> None:
        """Take the rows of a part.

        Raises:
            BadInput: the disk does not take what is written.
        """
        region = part.region
        self.contents.setdefault(region.begin, empty(region.end - region.begin))[part.points] = rows
        self._changed[region.begin] = region
        if time.monotonic() >= self._next:
            self.write()

    def write(self) -> None:
        """Write what has come since the last time.

        Raises:
            BadInput: the disk does not take it; what is finished stays.
        """
        began = time.monotonic()
        for begin, region in list(self._changed.items()):
            content, shape = self.contents[begin], tuple(each.stop - each.start for each in region.slices)
            with writing(self.user_path):
                for name, array in self.arrays.items():
                    array[region.slices] = content[name].reshape(shape)
            del self._changed[begin]
            if content[DONE].all():
                del self.contents[begin]
        self._next = time.monotonic() + SELDOM * (time.monotonic() - began)


@contextmanager
def open_folder(path: Path, plan: Plan, most: int, identity: dict[str, str]) -> Iterator[Folder]:
    """The folder of a study for as long as the block lasts, new or begun before.

    Args:
        path: the folder.
        plan: its points.
        most: points of a region at most.
        identity: what makes it this study; see :func:`attributes`.

    Raises:
        BadInput: another process writes into it, it holds another study, or it cannot be written.
    """
    import zarr
    from filelock import FileLock, Timeout

    target = check_target(path)
    with writing(path):
        target.mkdir(parents=True, exist_ok=True)
    lock = FileLock(target / LOCK, timeout=0)
    try:
        held = lock.acquire()
    except Timeout:
        problem = "another sweep is writing into it: wait until it ends, or use another folder"
        raise BadInput(problem, key="--out", value=str(path)) from None
    except (OSError, NotImplementedError) as error:
        raise BadInput(f"cannot be locked: {error}", key="--out", value=str(path)) from error
    with held:
        _check_same(target, path, identity)
        with writing(path):
            _lay_out(target, plan, _chunk_shape(plan, most), identity)
        with zarr.config.set({"array.write_empty_chunks": True}):
            arrays = dict(zarr.open_group(target / DATA, mode="r+", use_consolidated=False).arrays())
            yield Folder(target, path, {name: arrays[name] for name in ROW.names or ()})


def check_target(path: Path) -> Path:
    """Where a study can go, resolved; nothing is written.

    Raises:
        BadInput: see :func:`workflows.io.folder.check`; or it holds what no study wrote.
    """
    target = Path(os.path.realpath(path))
    if (target / DATA / _METADATA).is_file():
        return target
    target = folder.check(path)
    if target.is_dir():
        for entry in sorted(target.iterdir()):
            if entry.name != LOCK and not entry.name.startswith(folder.PARTIAL):
                problem = f"holds a {entry.name} and no study: expected a new folder or one with a study"
                raise BadInput(problem, key="--out", value=str(path))
    return target


_CALLED = {"code": "code and versions", "files_sha256": "files", "plan": "points", "block": "points"}


def _check_same(target: Path, path: Path, identity: dict[str, str]) -> None:
    """See that what an old folder holds is of the same study, and clear what a killed process left half-written."""
    for partial in (*target.glob(f"{folder.PARTIAL}*"), *(target / DATA).rglob("*.partial")):
        if partial.is_dir() and not partial.is_symlink():
            shutil.rmtree(partial, ignore_errors=True)
        else:
            partial.unlink(missing_ok=True)
    known = target / DATA / _METADATA
    if not known.exists():
        return
    try:
        before = json.loads(known.read_text(encoding="utf-8"))["attributes"]
    except (OSError, ValueError, LookupError) as error:
        problem = f"its {DATA}/{_METADATA} is damaged ({error}): use another folder, or remove this one"
        raise BadInput(problem, key="--out", value=str(path)) from error
    if before.get("study") != identity["study"] and not (target / DATA / DONE / "c").exists():
        shutil.rmtree(target / DATA)  # no point of it was ever computed
    elif before.get("study") != identity["study"]:
        names = [name for name in identity if name != "study" and identity[name] != before.get(name)]
        what = listed(list(dict.fromkeys(_CALLED.get(name, name) for name in names)) or ["key"])
        problem = f"contains a study that differs in its {what}: use another folder, or remove the old one"
        raise BadInput(problem, key="--out", value=str(path))


def writing(path: Path) -> AbstractContextManager[None]:
    """What goes wrong with the disk, in one line."""
    return folder.writing(path, more=f"; {GOES_ON}")


def _lay_out(target: Path, plan: Plan, sides: tuple[int, ...], identity: dict[str, str]) -> None:
    """Put the data set in place but for its points: what describes it, and the values of the keys.

    In an old folder this puts right what was damaged.
    """
    import xarray as xr
    import zarr
    from zarr.codecs import Crc32cCodec, ZstdCodec

    aside = target / f"{folder.PARTIAL}{DATA}"
    xr.Dataset(coords=_coordinates(plan), attrs=identity).to_zarr(aside, mode="w", consolidated=False, zarr_format=3)
    group = zarr.open_group(aside, mode="r+")
    for each in (
        *QUANTITIES,
        Quantity("reason", "", "why there is no answer; empty where there is one", "string"),
        Quantity(DONE, "", "whether the point has been computed", "bool"),
    ):
        group.create_array(
            each.name,
            shape=tuple(plan.dimensions.values()),
            chunks=sides,
            dtype=each.dtype,
            fill_value=np.nan if each.dtype == "f8" else None,
            dimension_names=list(plan.dimensions),
            attributes={**each.attributes},
            compressors=[ZstdCodec(), Crc32cCodec()],
        )
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Consolidated metadata")  # in no specification yet, but xarray looks for it
        zarr.consolidate_metadata(aside)
    if not (target / DATA).exists():
        os.rename(aside, target / DATA)
        return
    for path in sorted(aside.rglob("*")):
        if path.is_file():
            place = target / DATA / path.relative_to(aside)
            place.parent.mkdir(parents=True, exist_ok=True)
            os.replace(path, place)
    shutil.rmtree(aside)


def _coordinates(plan: Plan) -> dict[str, Any]:
    """Values of the keys along their dimensions, and the speeds in rpm beside them."""
    units = {axis.name: axis.key.unit for axis in plan.axes}
    coordinates: dict[str, Any] = {}
    for name, (along, values) in plan.coordinates.items():
        if values.dtype == object:  # words, and truth values as words
            values = np.array([value if isinstance(value, str) else str(value).lower() for value in values], object)
        coordinates[name] = (along, values, {"units": units[name]} if units[name] else {})
        if name == SPEEDS:
            coordinates["rpm"] = (along, np.array([rounded_rpm(float(value)) for value in values]), {"units": "rpm"})
    return coordinates


def open_dataset(path: Path) -> xr.Dataset:
    """A data set that was written, read as it is asked for."""
    import xarray as xr

    table = xr.open_dataset(path, engine="zarr")
    # Zarr lists its arrays in any order.
    data = {name: table[name].variable for name in (*(quantity.name for quantity in QUANTITIES), "reason")}
    coordinates = {name: table[name].variable for name in (*keys_of(table), "rpm")}
    return xr.Dataset(data, coords=coordinates, attrs=table.attrs)


def keys_of(data: xr.Dataset) -> list[str]:
    """The keys that are varied, in the order of the plan."""
    keys: list[str] = json.loads(data.attrs["keys"])
    return keys
