"""Whether a particle damper works on a spinning plate, how much, and up to what load.

    import spindamp

    results = spindamp.run("paper")              # a shipped scene, the path of a scene, a dict, a Scene
    print(results)
    spindamp.save(results, "out")                # all that the command writes
    spindamp.report(results, "report.html")      # the page alone

    spindamp.campbell("blade.toml")              # the plate alone
    spindamp.ringdown("blade.toml", rpm=6000)    # the damper at one speed
    spindamp.response("paper")                   # forced response at the crossings of engine orders
    spindamp.accuracy("paper")                   # what accuracy costs in time
    spindamp.effects("paper")                    # what each effect changes, and costs
    spindamp.reproduce()                         # the paper, claim by claim

Each does what the command of its name does, writes nothing that it is not told to, and returns what it found. The
plate alone is in `fem`, the damper alone in `damper`.
"""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING

from workflows.errors import BadInput, NoAnswer, NotAvailable, SpindampError
from workflows.scene.file import DEFAULT, SceneFile, SceneLike, load, opened, parse, shipped
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    from pathlib import Path

    import xarray

    from workflows.solve.records import Results
    from workflows.studies.costs.ladder import Study
    from workflows.studies.costs.switching import Switches
    from workflows.studies.reproduction import Reproduction
    from workflows.studies.response.study import Response

__all__ = [
    "BadInput",
    "NoAnswer",
    "NotAvailable",
    "Scene",
    "SceneFile",
    "SpindampError",
    "accuracy",
    "campbell",
    "dataset",
    "effects",
    "load",
    "parse",
    "report",
    "reproduce",
    "response",
    "ringdown",
    "run",
    "save",
    "shipped",
]


def run(scene: SceneLike = DEFAULT) -> Results:
    """Plate at every speed, then the damper.

    Args:
        scene: the name of a shipped scene, the path of a file, a dict, a Scene or what `load` returns.

    Raises:
        BadInput: the scene is wrong, or needs more than this machine has; the message says what would be right.
        NoAnswer: the physics has none.
        TypeError: it is no scene.
    """
    from workflows import pipeline

    return pipeline.run(scene)


def campbell(scene: SceneLike = DEFAULT) -> Results:
    """The plate alone: frequencies over speed. Takes and raises what :func:`run` does."""
    from workflows import parts, pipeline

    return pipeline.run(parts.plate_only(opened(scene)))


def ringdown(scene: SceneLike = DEFAULT, rpm: float | None = None) -> Results:
    """The damper at one speed [rev/min], by default the scene's middle one. Takes and raises what :func:`run` does."""
    from workflows import parts, pipeline

    return pipeline.run(parts.at_one_speed(opened(scene), rpm))


def response(scene: SceneLike = DEFAULT) -> Response:
    """Steady states where engine orders cross modes, without and with the ball; forces from the scene's [excitation].

    Takes and raises what :func:`run` does.
    """
    from workflows.studies.response.study import respond

    return respond(opened(scene))


def reproduce() -> Reproduction:
    """The paper's every claim against this code."""
    from workflows.studies import reproduction

    return reproduction.reproduce()


def accuracy(scene: SceneLike = DEFAULT) -> Study:
    """What accuracy costs in time. Takes and raises what :func:`run` does."""
    from workflows.studies.costs.study import study

    return study(opened(scene))


def effects(scene: SceneLike = DEFAULT) -> Switches:
    """What each effect changes, and what it costs. Takes and raises what :func:`run` does."""
    from workflows.studies.costs.switching import switching

    return switching(opened(scene))


def dataset(results: Results) -> xarray.Dataset:
    """The same numbers as labelled arrays; see :func:`workflows.dataset`."""
    from workflows.results import files as results_files

    return results_files.dataset(results)


def save(results: Results, folder: str | PathLike[str]) -> Path:
    """Write a folder with all that the command `run` writes; see :func:`workflows.save`."""
    from workflows.report import publish

    return publish.save(results, folder)


def report(results: Results, path: str | PathLike[str]) -> Path:
    """Write the report, one page; see :func:`workflows.save_report`."""
    from workflows.report import publish

    return publish.save_report(results, path)
