"""From a scene to results: the one package that knows both the plate (`fem`) and the damper.

    import workflows

    results = workflows.run("paper")                    # or a path, a dict, a Scene
    workflows.save(results, "out")                      # all that the command writes
    workflows.save_report(results, "report.html")       # the page alone

Names are imported when first used, so that light commands stay light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from workflows.errors import BadInput, NoAnswer, NotAvailable, SpindampError
    from workflows.pipeline import run
    from workflows.publish import save, save_report
    from workflows.records import Results
    from workflows.results_files import dataset
    from workflows.results_json import document
    from workflows.scene import Scene
    from workflows.scene_file import SceneFile, load, parse, shipped

_HOMES = {
    "BadInput": "workflows.errors",
    "NoAnswer": "workflows.errors",
    "NotAvailable": "workflows.errors",
    "Results": "workflows.records",
    "Scene": "workflows.scene",
    "SceneFile": "workflows.scene_file",
    "SpindampError": "workflows.errors",
    "dataset": "workflows.results_files",
    "document": "workflows.results_json",
    "load": "workflows.scene_file",
    "parse": "workflows.scene_file",
    "run": "workflows.pipeline",
    "save": "workflows.publish",
    "save_report": "workflows.publish",
    "shipped": "workflows.scene_file",
}

__all__ = [
    "BadInput",
    "NoAnswer",
    "NotAvailable",
    "Results",
    "Scene",
    "SceneFile",
    "SpindampError",
    "dataset",
    "document",
    "load",
    "parse",
    "run",
    "save",
    "save_report",
    "shipped",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'workflows' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
