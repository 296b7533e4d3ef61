"""A study from beginning to end: what is computed, by whom, into which folder; begun again it goes on."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows.errors import BadInput
from workflows.io import folder
from workflows.progress import Stages
from workflows.scene.load import DEFAULT, FILES, SceneFile, SceneLike, as_scene_file, sha256_of
from workflows.solve import resources
from workflows.studies.sweep import evaluate, executor, plan, sensitivity, store
from workflows.studies.sweep.plan import Plan

if TYPE_CHECKING:
    import xarray as xr

LEAST, _MOST, _MANY = 256, 4096, 1024
"""Points of a region at most, and the number of regions above which they grow."""

PARTS = 64
"""Parts of a study at least, if it has so many points: all workers have some, and an end loses few points."""


@dataclass(frozen=True)
class Study:
    """What is computed, and by which code; all that a worker needs.

    Attributes:
        source: the scene that the points have in common.
        plan: the points.
        quick: whether the working range is measured on fewer and faster sweeps, mostly within a percent.
        code: digest of the sources that compute it.
        resampling: seed of the confidence intervals; None where nothing is uncertain.
    """

    source: SceneFile
    plan: Plan
    quick: bool
    code: str
    resampling: int | None = None

    @cached_property
    def size(self) -> int:
        """Points of a region at most."""
        size = LEAST
        while size < _MOST and size * _MANY < self.plan.size:
            size *= 2
        return size

    @cached_property
    def attributes(self) -> dict[str, str]:
        """What its data set says of its origin: what makes it this study, the keys that are varied, and a digest."""
        identity: dict[str, Any] = {
            "title": self.source.scene.title,
            "scene": plan.plain(self.source.scene),
            "files_sha256": sha256_of([*self.source.files, *self._varied_files()]),
            "plan": self.plan.identity,
            "quick": self.quick,
            "points": self.plan.size,
            "block": self.size,
            "code": executor.identity(),
        }
        texts = {name: json.dumps(each, ensure_ascii=False, sort_keys=True) for name, each in identity.items()}
        keys = json.dumps([axis.name for axis in self.plan.axes])
        digest = hashlib.sha256(json.dumps(texts).encode()).hexdigest()
        return texts | {"title": self.source.scene.title, "keys": keys, "study": digest}

    def _varied_files(self) -> list[Path]:
        """Files of the structures that are tried in its place."""
        from fem.meshes.read import files_of

        axes = [axis for axis in self.plan.axes if axis.key.path in FILES]
        named = [self.source.folder / str(value) for axis in axes for value in axis.values]
        return [each for path in named for each in files_of(path)]

    def regions(self) -> list[store.Region]:
        """Its points, region by region."""
        return store.regions(self.plan, self.size)

    def parts(self, region: store.Region) -> list[store.Part]:
        """The parts in which a region is computed; they are the same for any workers."""
        step = max(min(self.size, self.plan.size // PARTS), 1)
        begins = range(region.begin, region.end, step)
        return [store.Part(region, begin, min(begin + step, region.end)) for begin in begins]


def of_scene(
    scene: SceneLike = DEFAULT,
    vary: Mapping[str, object] | Iterable[str] | str = (),
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
    seed = plan.check_seed(seed)
    if isinstance(vary, Mapping):
        vary = {name: list(each) if isinstance(each, Iterator) else each for name, each in vary.items()}
    else:
        vary = [vary] if isinstance(vary, str) else list(vary)
    if count is None and not uncertain:
        plan.check_size(vary, len(source.scene.rotor.speeds))
    axes = sensitivity.axes(vary, source.scene) if uncertain else plan.read(vary, source.scene.rotor.gravity)
    if not axes:
        raise BadInput(
            "nothing is varied: expected KEY=START:STOP:COUNT, such as damper.friction=0.1:0.5:9", key="--vary"
        )
    plan.base(source, [axis.key for axis in axes])
    plan.check_units(axes, source.scene)
    speeds = source.scene.rotor.speeds
    if uncertain:
        points = sensitivity.plan(axes, speeds, sensitivity.BASE if count is None else count, seed)
    else:
        points = plan.grid(axes, speeds) if count is None else plan.sample(axes, speeds, count, seed)
    source = plan.with_remarks(source, axes, grid=count is None and not uncertain)
    return Study(source, points, quick, executor.digest(), seed if uncertain else None)


def compute(study: Study, part: store.Part) -> evaluate.Rows:
    """The rows of a part; what a worker does.

    Raises:
        BadInput: the worker has other code.
    """
    executor.prepare(study.code)
    speeds = study.plan.speeds(part.region.begin, part.region.end)
    return evaluate.block(study.source, study.plan, part.begin, part.end, speeds, quick=study.quick)


def complete(study: Study, out: Path, pool: AbstractContextManager[executor.Workers], stages: Stages) -> xr.Dataset:
    """Compute the points that a folder lacks of a study, or has damaged, and open all of it.

    Raises:
        BadInput: the folder holds another study or is being written into, or the disk is full.
    """
    with (
        folder.resumable(store.GOES_ON),
        store.open_folder(out, study.plan, study.size, study.attributes) as place,
    ):
        missing, count = list[store.Part](), 0
        for region in study.regions():
            content, parts = place.content(region), study.parts(region)
            lacking = [part for part in parts if not content[evaluate.DONE][part.points].all()]
            if lacking and content[evaluate.DONE].any():
                place.contents[region.begin] = content
            missing += lacking
            count += len(parts)
        done = study.plan.size - sum(part.end - part.begin for part in missing)
        with stages("sweep", count, done=count - len(missing)) as step:
            if missing:
                with pool as workers:
                    try:
                        for part, rows in executor.results(workers, partial(compute, study), missing):
                            place.add(part, rows)
                            done += part.end - part.begin
                            step.advance(f"{done} of {study.plan.size} points")
                    finally:
                        place.write()
        return store.open_dataset(place.path / store.DATA)


def solve(study: Study, out: Path | None, pool: AbstractContextManager[executor.Workers], stages: Stages) -> xr.Dataset:
    """The data set of a study, in a folder or with nothing left on the disk; percentiles of what is uncertain."""
    if out is None:
        with tempfile.TemporaryDirectory(prefix="spindamp-sweep-") as place:
            data = complete(study, Path(place) / "study", pool, stages).load()
    else:
        data = complete(study, out, pool, stages)
    return data if study.resampling is None else sensitivity.with_indices(data, study.resampling)
