"""Runs side by side: where their scenes differ, their verdicts, their figures at each speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from workflows.errors import BadInput
from workflows.io import provenance, serialise
from workflows.progress import Stages
from workflows.report import text
from workflows.scene.load import SceneLike
from workflows.solve.results import Results, SpeedPoint


@dataclass(frozen=True, eq=False)
class Comparison:
    """Runs side by side.

    Attributes:
        names: what each is called, no two alike.
        results: of each.
    """

    names: tuple[str, ...]
    results: tuple[Results, ...]

    @property
    def differences(self) -> dict[str, tuple[Any, ...]]:
        """Keys of the resolved scenes that are not the same in all, with the value in each, None where it has none."""
        scenes = [
            dict(_flat(provenance.resolved_scene(each.scene, each.effects, each.theory))) for each in self.results
        ]
        keys = dict.fromkeys(key for scene in scenes for key in scene)
        values = {key: tuple(scene.get(key) for scene in scenes) for key in keys if key != "title"}
        return {key: each for key, each in values.items() if any(value != each[0] for value in each[1:])}

    @property
    def points(self) -> list[tuple[float, list[SpeedPoint | None]]]:
        """Every speed of any run [rpm], with what each run has there."""
        by_speed = [{point.rpm: point for point in each.speeds} for each in self.results]
        return [(rpm, [points.get(rpm) for points in by_speed]) for rpm in sorted(set().union(*by_speed))]


def compare(runs: Sequence[SceneLike | Results], stages: Stages | None = None) -> Comparison:
    """Put runs side by side.

    Args:
        runs: two or more: folders that `spindamp run` has written, scenes, which are run, or results.
        stages: the clock of what is run.

    Raises:
        BadInput: fewer than two, or one that is neither a folder of a run nor a scene.
        NoAnswer: a scene has none.
    """
    if len(runs) < 2:
        raise BadInput("expected at least two runs: folders of results, or scenes", key="compare")
    results = [_of(each, stages) for each in runs]
    titles = [_name(run, each) for run, each in zip(runs, results, strict=True)]
    names = [title if titles.count(title) == 1 else f"{title} ({k + 1})" for k, title in enumerate(titles)]
    return Comparison(tuple(names), tuple(results))


def _of(run: SceneLike | Results, stages: Stages | None) -> Results:
    if isinstance(run, Results):
        return run
    if isinstance(run, str | PathLike) and Path(run).is_dir():
        return serialise.read(run)
    return text.run(run, stages)


def _name(run: SceneLike | Results, results: Results) -> str:
    """What a run is called: a folder or file by its name, anything else by its title."""
    return Path(fspath(run)).stem if isinstance(run, str | PathLike) else results.scene.title


def _flat(table: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """Keys of nested tables by their dotted names."""
    found = []
    for key, value in table.items():
        found += _flat(value, f"{prefix}{key}.") if isinstance(value, Mapping) else [(prefix + key, value)]
    return found
