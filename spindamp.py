"""Whether a particle damper works on a spinning plate or blade, how well, and up to what load.

    import spindamp

    results = spindamp.run("paper")              # a shipped scene, the path of a scene, a dict, a Scene
    print(results)
    spindamp.save(results, "out")                # all that the command writes
    spindamp.load_results("out")                 # the same results again
    spindamp.report(results, "report.html")      # the page alone

    spindamp.campbell("blade.toml")              # the structure alone
    spindamp.modes("blade.toml", "blade.npz")    # its modes as a file for [structure] modes
    spindamp.ringdown("blade.toml", rpm=6000)    # the damper at one speed
    spindamp.response("paper")                   # forced response at the crossings of engine orders
    spindamp.accuracy("paper")                   # computing time against accuracy
    spindamp.effects("paper")                    # change and cost of each effect
    spindamp.reproduce()                         # the paper, claim by claim
    spindamp.sweep("paper", {"damper.restitution": [0.3, 0.5, 0.7]})     # any keys of a scene, as an xarray data set
    spindamp.compare("out", "paper")             # runs side by side
    spindamp.design()                            # the best damper within the limits of [design]

Each function does the same as the command of its name, writes only the files requested, and returns its results. It
raises `ImpossibleResult` if a figure violates a law of physics. The plate alone is in `fem`, the damper alone in
`damper`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import workflows
from workflows.errors import BadInput, ImpossibleResult, NoAnswer, NotAvailable, SpindampError
from workflows.laws import lawful
from workflows.progress import Stages
from workflows.scene.load import DEFAULT, SceneFile, SceneLike, as_scene_file, load, parse, shipped
from workflows.scene.scene import Scene, omega_of

if TYPE_CHECKING:
    from concurrent.futures import Executor

    import xarray

    from fem.modal_model import ModalModel
    from workflows.solve.results import Results
    from workflows.studies.comparison import Comparison
    from workflows.studies.design.report import DesignResult
    from workflows.studies.reproduction import Reproduction
    from workflows.studies.response import Response
    from workflows.studies.work_precision.effects import EffectStudy
    from workflows.studies.work_precision.timing import WorkPrecision

__all__ = [
    "BadInput",
    "ImpossibleResult",
    "NoAnswer",
    "NotAvailable",
    "Scene",
    "SceneFile",
    "SpindampError",
    "accuracy",
    "campbell",
    "compare",
    "dataset",
    "design",
    "effects",
    "load",
    "load_results",
    "modes",
    "parse",
    "report",
    "reproduce",
    "response",
    "ringdown",
    "run",
    "save",
    "shipped",
    "sweep",
]


@lawful()
def run(scene: SceneLike = DEFAULT) -> Results:
    """Plate at every speed, then the damper.

    Args:
        scene: the name of a shipped scene, the path of a file, a dict, a Scene or what `load` returns.

    Raises:
        BadInput: the scene is wrong, or needs more than this machine has; the message says what would be right.
        NoAnswer: the physics has none.
        TypeError: it is no scene.
    """
    return workflows.run(scene)


@lawful()
def campbell(scene: SceneLike = DEFAULT) -> Results:
    """The plate alone: frequencies over speed. Takes and raises what :func:`run` does."""
    from workflows import pipeline

    return workflows.run(pipeline.plate_only(as_scene_file(scene)))


@lawful()
def modes(scene: SceneLike = DEFAULT, file: str | PathLike[str] | None = None) -> ModalModel:
    """The structure's modes, and the neutral file of them (.npz or .json) that `[structure] modes` reads.

    Args:
        scene: see :func:`run`.
        file: to write; None: nothing is written.

    Raises:
        BadInput: the scene has no modes, or complex ones; the file cannot be written.
    """
    from workflows import pipeline
    from workflows.io.files import save_modes

    model = pipeline.modes(as_scene_file(scene), Stages(visible=False))
    if file is not None:
        save_modes(model, file)
    return model


@lawful()
def ringdown(scene: SceneLike = DEFAULT, rpm: float | None = None) -> Results:
    """The damper at one speed [rev/min], by default the scene's middle one. Takes and raises what :func:`run` does."""
    from workflows import pipeline

    return workflows.run(pipeline.at_one_speed(as_scene_file(scene), None if rpm is None else omega_of(rpm, "rpm")))


@lawful()
def response(scene: SceneLike = DEFAULT) -> Response:
    """Steady states where engine orders cross modes, without and with the ball; forces from the scene's [excitation].

    Takes and raises what :func:`run` does.
    """
    from workflows.studies.response import respond

    return respond(as_scene_file(scene))


@lawful()
def reproduce() -> Reproduction:
    """Every claim of the paper, compared with this code."""
    from workflows.studies import reproduction

    return reproduction.reproduce()


@lawful()
def accuracy(scene: SceneLike = DEFAULT) -> WorkPrecision:
    """Cost of accuracy in time. Takes and raises what :func:`run` does."""
    from workflows.studies.work_precision.study import study

    return study(as_scene_file(scene))


@lawful()
def effects(scene: SceneLike = DEFAULT) -> EffectStudy:
    """What each effect changes, and what it costs. Takes and raises what :func:`run` does."""
    from workflows.studies.work_precision.effects import effect_study

    return effect_study(as_scene_file(scene))


@lawful()
def sweep(
    scene: SceneLike = DEFAULT,
    vary: Mapping[str, object] | Iterable[str] = (),
    *,
    sample: int | None = None,
    seed: int = 0,
    quick: bool = False,
    uncertain: bool = False,
    out: str | PathLike[str] | None = None,
    workers: int | None = None,
    dask: str | None = None,
    executor: Executor | None = None,
) -> xarray.Dataset:
    """The damper's headline numbers over any keys of a scene.

    Args:
        scene: see :func:`run`.
        vary: the values of each key, by its dotted name: a list, or text such as ``"0.1 mm:4 mm:20"``, ``"log:…"``. A
            key of a pair sets both values, ``damper.cavity[0]`` one of them; ``damper.clearance`` sets the cavity.
        sample: number of points spread over all ranges, in place of a grid.
        seed: of the sample.
        quick: fewer and faster amplitude sweeps, in half to two thirds of the time. Three in four damping ratios, or
            more, are within 1 %; where a ball may either bounce or roll, they may be off by tens of percent.
        uncertain: take the ranges (or ``"normal:MEAN:DEVIATION"``) as distributions, by default of restitution,
            friction, rolling friction, damping ratio and clearance; `sample` is then the number of base points.
        out: a folder to work in, in which an interrupted sweep resumes. None: nothing is stored.
        workers: processes of this machine; None: one for each core.
        dask: address of a Dask scheduler, whose workers compute instead.
        executor: or any executor of `concurrent.futures`.

    Returns:
        A data set in which every key is a dimension, or in a sample a coordinate; a point without an answer holds nan,
        and `reason` gives the cause. With `uncertain` it also has percentiles and Sobol' indices.

    Raises:
        BadInput: scene, keys or values are wrong, or the folder belongs to another study.
    """
    from workflows.studies.sweep import study
    from workflows.studies.sweep.executor import workers_of

    points = study.of_scene(scene, vary, count=sample, seed=seed, quick=quick, uncertain=uncertain)
    pool = workers_of(workers, dask, executor)
    return study.solve(points, None if out is None else Path(out), pool, Stages())


@lawful()
def design(
    scene: SceneLike = "design",
    *,
    seed: int = 0,
    workers: int | None = None,
    dask: str | None = None,
    executor: Executor | None = None,
) -> DesignResult:
    """The damper that damps best within what the table [design] of a scene allows; else as :func:`sweep`.

    Returns:
        The best design with all its results: `optimum`, `active_constraints`, `document()`, and its scene as `toml`.

    Raises:
        BadInput: the scene is wrong, or has no [design].
        NoAnswer: the plate has none.
    """
    from workflows.studies.design import study
    from workflows.studies.sweep.executor import workers_of

    return study.design(scene, seed=seed, pool=workers_of(workers, dask, executor))


@lawful()
def compare(*runs: SceneLike | Results) -> Comparison:
    """Runs side by side: folders that :func:`save` has written, scenes, which are run, or results.

    Raises:
        BadInput: fewer than two, or one that is none of these; else as :func:`run`.
    """
    from workflows.studies import comparison

    return comparison.compare(runs)


def dataset(results: Results) -> xarray.Dataset:
    """The same numbers as labelled arrays; see :func:`workflows.dataset`."""
    return workflows.dataset(results)


def save(results: Results | Response, folder: str | PathLike[str]) -> Path:
    """Write a folder with all that the command `run`, or `response`, writes; see :func:`workflows.save`."""
    from workflows.studies.response import Response

    if isinstance(results, Response):
        from workflows.io.files import write_study

        write_study(results, Path(folder))
        return Path(folder)
    return workflows.save(results, folder)


def load_results(folder: str | PathLike[str]) -> Results:
    """Read the results of a run from its folder; see :func:`workflows.load_results`.

    Saved again they are identical except for `timings`.
    """
    return workflows.load_results(folder)


def report(results: Results, path: str | PathLike[str]) -> Path:
    """Write the report, one page; see :func:`workflows.save_report`."""
    return workflows.save_report(results, path)


if __name__ == "__main__":
    import sys

    from workflows.cli.main import main

    sys.exit(main())
