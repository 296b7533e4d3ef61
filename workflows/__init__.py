"""From a scene to results: the one package that knows both the plate (`fem`) and the damper.

    import workflows

    results = workflows.run("paper")                    # or a path, a dict, a Scene
    workflows.save(results, "out")                      # all that the command writes
    workflows.load_results("out")                       # the same results again
    workflows.save_report(results, "report.html")       # the page alone

Names are imported when first used, so that light commands stay light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from workflows.errors import BadInput, ImpossibleResult, NoAnswer, NotAvailable, SpindampError
    from workflows.io.files import dataset
    from workflows.io.serialise import document
    from workflows.report.page import load_results, save, save_report
    from workflows.report.text import run
    from workflows.scene.load import SceneFile, load, parse, shipped
    from workflows.scene.scene import Scene
    from workflows.solve.results import Results

_NAMES = {
    "workflows.errors": "BadInput ImpossibleResult NoAnswer NotAvailable SpindampError",
    "workflows.io.files": "dataset",
    "workflows.io.serialise": "document",
    "workflows.report.page": "load_results save save_report",
    "workflows.report.text": "run",
    "workflows.scene.load": "SceneFile load parse shipped",
    "workflows.scene.scene": "Scene",
    "workflows.solve.results": "Results",
}
"""What is offered, by the modules that have it."""

_HOMES = {name: module for module, names in _NAMES.items() for name in names.split()}

__all__ = [
    "BadInput",
    "ImpossibleResult",
    "NoAnswer",
    "NotAvailable",
    "Results",
    "Scene",
    "SceneFile",
    "SpindampError",
    "dataset",
    "document",
    "load",
    "load_results",
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
