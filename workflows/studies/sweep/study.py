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

import numpy as np

from workflows.errors import BadInput
from workflows.output import signals
from workflows.progress import Stages
from workflows.scene.load import DEFAULT, SceneFile, SceneLike, opened
from workflows.solve import resources
from workflows.studies.sweep import axes, evaluate, store
from workflows.studies.sweep import executor as crew
from workflows.studies.sweep import executor as fingerprint
from workflows.studies.sweep import executor as kernels
from workflows.studies.sweep import plan as plans
from workflows.studies.sweep import plan as scenes
from workflows.studies.sweep import sensitivity as doubts
from workflows.studies.sweep.evaluate import Block, PlateCache
from workflows.studies.sweep.executor import Crew
from workflows.studies.sweep.plan import Plan
from workflows.studies.sweep.store import Folder

if TYPE_CHECKING:
    import xarray as xr

LEAST, _MOST, _MANY = 256, 4096, 1024
"""Points of a shard, and the number of shards above which they grow."""

DATA = "sweep.zarr"

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
        """Points of a shard."""
        points, size = plans.size(self.plan), LEAST
        while size < _MOST and size * _MANY < points:
            size *= 2
        return size

    @cached_property
    def ranges(self) -> list[tuple[int, int]]:
        """First point of every shard, and the one after its last."""
        points = plans.size(self.plan)
        return [(begin, min(begin + self.size, points)) for begin in range(0, points, self.size)]

    @cached_property
    def identity(self) -> dict[str, Any]:
        """What makes it this study, as plain data."""
        return {
            "title": self.source.scene.title,
            "scene": axes.plain(self.source.scene),
            "mesh_sha256": self.source.mesh_sha256,
            "plan": self.plan.identity(),
            "quick": self.quick,
            "points": plans.size(self.plan),
            "shard": self.size,
            "code": fingerprint.identity(),
        }

    @cached_property
    def key(self) -> str:
        """Digest of the identity."""
        canonical = json.dumps(self.identity, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
        return hashlib.sha256(canonical.encode()).hexdigest()


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
    source = opened(scene)
    if source.scene.damper is None:
        raise BadInput("the table is missing: sweep needs a damper", file=source.name, key="[damper]")
    resources.check(source)
    if uncertain:
        return _uncertain(source, vary, count, seed, quick)
    given = axes.read(vary, source.scene.rotor.gravity)
    if not given:
        raise BadInput(
            "nothing is varied: expected KEY=START:STOP:COUNT, such as damper.friction=0.1:0.5:9", key="--vary"
        )
    scenes.base(source, [axis.key for axis in given])
    speeds = source.scene.rotor.speeds
    if count is None:
        return Study(source, plans.grid(given, speeds), quick, fingerprint.digest())
    return Study(source, plans.sample(given, speeds, count, seed), quick, fingerprint.digest())


def _uncertain(
    source: SceneFile, vary: Mapping[str, object] | Iterable[str], count: int | None, seed: int, quick: bool
) -> Study:
    """The study from which percentiles and Sobol' indices are taken."""
    given = doubts.axes(vary, source.scene)
    scenes.base(source, [axis.key for axis in given])
    plan = doubts.plan(given, source.scene.rotor.speeds, doubts.BASE if count is None else count, seed)
    return Study(source, plan, quick, fingerprint.digest())


def compute(study: Study, number: int) -> Block:
    """A shard's rows; what a worker does.

    Raises:
        BadInput: the worker has other code.
    """
    fingerprint.same(study.code)
    kernels.ready()
    begin, end = study.ranges[number]
    return evaluate.block(study.source, study.plan, begin, end, _plates, quick=study.quick)


def crew_of(
    workers: int | None = None, dask: str | None = None, executor: Executor | None = None
) -> AbstractContextManager[Crew]:
    """Who computes: an executor that is given, a Dask cluster, or processes of this machine."""
    if executor is not None:
        return crew.given(executor)
    return crew.local(workers) if dask is None else crew.cluster(dask)


def complete(study: Study, out: Path, hired: AbstractContextManager[Crew], stages: Stages) -> xr.Dataset:
    """Compute what a folder lacks of a study, and put all of it together there.

    Raises:
        BadInput: the folder holds another study or is being written into, or the disk is full.
    """
    with signals.going_on(_GOES_ON), store.opened(out, study.key, study.identity) as place:
        fill(study, place, hired, stages)
        with stages("write"), store.writing(out), store.replaced(place.path / DATA) as aside:
            said = store.attributes(study.source.scene.title, study.plan, study.identity, study.key)
            store.write(study.plan, partial(rows, study, place), said, aside)
        return store.opened_table(place.path / DATA)


def in_memory(study: Study, hired: AbstractContextManager[Crew], stages: Stages) -> xr.Dataset:
    """The same, with nothing left on the disk."""
    with tempfile.TemporaryDirectory(prefix="spindamp-sweep-") as place:
        return complete(study, Path(place) / "study", hired, stages).load()


def fill(study: Study, place: Folder, hired: AbstractContextManager[Crew], stages: Stages) -> None:
    """Compute the shards that are missing."""
    there = place.done(study.ranges)
    left = [number for number in range(len(study.ranges)) if number not in there]
    with stages("sweep", len(study.ranges), done=len(there)) as step:
        if not left:
            return
        with hired as workers:
            done = len(there)
            for number, block in crew.results(workers, partial(compute, study), left):
                place.write(number, block)
                done += 1
                step.advance(f"{min(done * study.size, plans.size(study.plan))} of {plans.size(study.plan)} points")


def rows(study: Study, place: Folder, begin: int, end: int) -> Block:
    """The rows of the points from one to before another, out of the shards."""
    first, last = begin // study.size, -(-end // study.size)
    texts: list[str] = []
    parts = []
    for number in range(first, last):
        block = place.read(number)
        start, stop = max(begin - block.begin, 0), min(end - block.begin, len(block.rows))
        part = block.rows[start:stop].copy()
        texts += [text for text in block.reasons if text not in texts]
        numbers = np.array([*(texts.index(text) for text in block.reasons), -1])
        part["reason"] = np.take(numbers, part["reason"])
        parts.append(part)
    return Block(begin, np.concatenate(parts), tuple(texts))


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
    hired, clock = crew_of(workers, dask, executor), stages or Stages()
    found = in_memory(study, hired, clock) if out is None else complete(study, Path(out), hired, clock)
    return doubts.analysed(found, seed) if uncertain else found
