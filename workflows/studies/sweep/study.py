"""A study from beginning to end: what is computed, by whom, into which folder; begun again it goes on."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Iterable, Mapping
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows.errors import BadInput
from workflows.io import folder
from workflows.progress import Stages
from workflows.scene.load import DEFAULT, SceneFile, SceneLike, as_scene_file
from workflows.solve import resources
from workflows.studies.sweep import evaluate, executor, plan, sensitivity, store
from workflows.studies.sweep.evaluate import Block, PlateCache
from workflows.studies.sweep.executor import Workers, workers_of
from workflows.studies.sweep.plan import Plan
from workflows.studies.sweep.store import Folder, Region

if TYPE_CHECKING:
    import xarray as xr

LEAST, _MOST, _MANY = 256, 4096, 1024
"""Points of a block at most, and the number of blocks above which they grow."""

_GOES_ON = "what is finished stays; the same command goes on"

_plates = PlateCache()
"""Of this process; every task looks here first."""


@dataclass(frozen=True)
class Study:
    """What is computed, and by which code; all that a worker needs.

    Attributes:
        source: the scene that the points have in common.
        plan: the points.
        quick: whether the working range is measured on fewer sweeps, good to a percent.
        code: digest of the sources that compute it.
    """

    source: SceneFile
    plan: Plan
    quick: bool
    code: str

    @cached_property
    def size(self) -> int:
        """Points of a block at most."""
        points, size = plan.size(self.plan), LEAST
        while size < _MOST and size * _MANY < points:
            size *= 2
        return size

    @cached_property
    def identity(self) -> dict[str, Any]:
        """What makes it this study, as plain data."""
        return {
            "title": self.source.scene.title,
            "scene": plan.plain(self.source.scene),
            "mesh_sha256": self.source.mesh_sha256,
            "plan": self.plan.identity(),
            "quick": self.quick,
            "points": plan.size(self.plan),
            "block": self.size,
            "code": executor.identity(),
        }

    @cached_property
    def key(self) -> str:
        """Digest of the identity."""
        canonical = json.dumps(self.identity, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
        return hashlib.sha256(canonical.encode()).hexdigest()

    @property
    def attributes(self) -> dict[str, str]:
        """What its data set says of its origin."""
        texts = {name: json.dumps(each, ensure_ascii=False, sort_keys=True) for name, each in self.identity.items()}
        keys = json.dumps([axis.name for axis in self.plan.axes])
        return texts | {"title": self.source.scene.title, "keys": keys, "study": self.key}

    def regions(self) -> list[Region]:
        """Its points, block by block."""
        return store.regions(self.plan, self.size)


def asked(
    scene: SceneLike = DEFAULT,
    vary: Mapping[str, object] | Iterable[str] = (),
    *,
    count: int | None = None,
    seed: int = 0,
    quick: bool = False,
    uncertain: bool = False,
) -> Study:
    """The study of a scene over what is varied.

    Raises:
        BadInput: the scene or what is varied is wrong.
    """
    source = as_scene_file(scene)
    if source.scene.damper is None:
        raise source.wrong("the table is missing: sweep needs a damper", "[damper]")
    resources.check(source)
    axes = sensitivity.axes(vary, source.scene) if uncertain else plan.read(vary, source.scene.rotor.gravity)
    if not axes:
        raise BadInput(
            "nothing is varied: expected KEY=START:STOP:COUNT, such as damper.friction=0.1:0.5:9", key="--vary"
        )
    plan.base(source, [axis.key for axis in axes])
    plan.check_units(axes, source.scene)
    speeds = source.scene.rotor.speeds
    if uncertain:
        points: Plan = sensitivity.plan(axes, speeds, sensitivity.BASE if count is None else count, seed)
    else:
        points = plan.grid(axes, speeds) if count is None else plan.sample(axes, speeds, count, seed)
    return Study(source, points, quick, executor.digest())


def compute(study: Study, region: Region) -> Block:
    """The rows of a region; what a worker does.

    Raises:
        BadInput: the worker has other code.
    """
    executor.same(study.code)
    executor.ready()
    return evaluate.block(study.source, study.plan, region.begin, region.end, _plates, quick=study.quick)


def complete(study: Study, out: Path, pool: AbstractContextManager[Workers], stages: Stages) -> xr.Dataset:
    """Compute what a folder lacks of a study, and open all of it.

    Raises:
        BadInput: the folder holds another study or is being written into, or the disk is full.
    """
    with (
        folder.resumable(_GOES_ON),
        store.opened(out, study.plan, study.size, study.attributes) as place,
    ):
        fill(study, place, pool, stages)
        return store.opened_table(place.path / store.DATA)


def in_memory(study: Study, pool: AbstractContextManager[Workers], stages: Stages) -> xr.Dataset:
    """The same, with nothing left on the disk."""
    with tempfile.TemporaryDirectory(prefix="spindamp-sweep-") as place:
        return complete(study, Path(place) / "study", pool, stages).load()


def fill(study: Study, place: Folder, pool: AbstractContextManager[Workers], stages: Stages) -> None:
    """Compute the regions that are missing or damaged."""
    regions = study.regions()
    missing = [region for region in regions if not place.holds(region)]
    points = plan.size(study.plan)
    done = points - sum(region.end - region.begin for region in missing)
    with stages("sweep", len(regions), done=len(regions) - len(missing)) as step:
        if not missing:
            return
        with pool as workers:
            for region, (rows, reasons) in executor.results(workers, partial(compute, study), missing):
                place.write(region, rows, reasons)
                done += region.end - region.begin
                step.advance(f"{done} of {points} points")


def sweep(
    scene: SceneLike = DEFAULT,
    vary: Mapping[str, object] | Iterable[str] = (),
    *,
    sample: int | None = None,
    seed: int = 0,
    quick: bool = False,
    uncertain: bool = False,
    out: str | Path | None = None,
    workers: int | None = None,
    dask: str | None = None,
    executor: Executor | None = None,
    stages: Stages | None = None,
) -> xr.Dataset:
    """The headline numbers of a scene over any of its keys; see :func:`spindamp.sweep`."""
    study = asked(scene, vary, count=sample, seed=seed, quick=quick, uncertain=uncertain)
    pool, clock = workers_of(workers, dask, executor), stages or Stages()
    data = in_memory(study, pool, clock) if out is None else complete(study, Path(out), pool, clock)
    return sensitivity.analysed(data, seed) if uncertain else data
