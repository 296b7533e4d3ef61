"""Every quantity of the results is said once, and all files are views of what is said there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import workflows
from workflows.io import serialise
from workflows.scene import quantities
from workflows.scene.load import load
from workflows.solve.results import Results, SpeedPoint
from workflows.studies.sweep.evaluate import QUANTITIES

HOUSE = Path(workflows.__file__).parent


def test_published_schema_is_that_of_the_records() -> None:
    published = (HOUSE / "results.schema.json").read_text(encoding="utf-8")
    assert published == serialise.text(), "python -m workflows.io.serialise"


def test_every_quantity_has_a_unit_and_a_meaning() -> None:
    for quantity in serialise.quantities(SpeedPoint):
        assert quantity.kind in ("number", "integer", "string"), quantity
        unit = {"J": "N*m"}.get(quantity.unit, quantity.unit)  # which no scene has
        if unit not in ("", "1", "g", "rpm"):
            assert quantities.to_si(f"3 {unit}", quantities.Kind("", "", unit, 0.0, 9.0)) == 3.0
        assert (unit == "") is (quantity.kind == "string"), quantity
        assert quantity.meaning, quantity


def test_no_two_quantities_have_one_name_in_a_data_set(finished: Path) -> None:
    found = workflows.dataset(workflows.load_results(finished))
    names = Counter(each.name for each in serialise.quantities(SpeedPoint))
    assert set(found.variables) <= names.keys()
    assert max(names.values()) == 1, names.most_common(3)


def test_columns_of_sweeps_are_those_of_runs() -> None:
    """By name and unit; a sweep adds what belongs to no speed of a run."""
    known = {each.name: each.unit for each in serialise.quantities(SpeedPoint)}
    mine = {quantity.name: quantity.unit for quantity in QUANTITIES}
    own = mine.keys() - known.keys()
    assert own == {"grade", "best_damping_ratio", "best_amplitude", "ball_mass"}
    assert all(known[name] == unit for name, unit in mine.items() if name not in own)


def _full() -> Any:
    """A speed that has every part, with one mode, cycle and point of a curve."""
    from workflows.solve import results
    from workflows.solve.results import Floats

    one: Floats = np.ones(1)
    parts = results.ErrorParts(*(0.0,) * 6)
    figures: dict[str, Any] = dict.fromkeys(("peak", "peak_amplitude", "cutoff"), 1.0)
    figures |= {"range": (1.0, 2.0), "half": (1.0, 2.0), "amplitude": one, "damping_ratio": one}
    ring: dict[str, Any] = dict.fromkeys((each.name for each in fields(results.Damping)), 1)
    ring |= {"outcome": "", "stopped": None, "release": (1.0, 0.0), "history": None, "path": None}
    ring |= {"amplitude_g": one, "sdc": one, "peak_velocity": one}
    damping = results.Damping(**ring | {"energy": results.Energy(*(1.0,) * 7), "modal_energies": {1: 1.0}})
    return results.SpeedPoint(
        omega=1.0,
        rpm=1.0,
        radius=1.0,
        load_g=1.0,
        modes=(results.Mode(1.0, "flap", parts, 0.0),),
        reduced=results.Reduced(*(1.0,) * 7),
        cavity_modes=(results.CavityMode(1, 1.0, (1.0, 0.0), (1.0, 0.0)),),
        damper=damping,
        working=results.OwnFigures(
            **figures, error=0.0, from_above=results.Figures(**figures), folds=(1.0, 2.0), jump=(1.0, 2.0)
        ),
        level=results.Figures(**figures),
        tilted=results.CutOff(1.0, 1.0),
        pendulum=results.Pendulum((1.0, 1.0), (1.0, 1.0)),
    )


def test_every_number_of_the_document_is_in_the_data_set() -> None:
    """A number that each holds once, so that one missing, or one in the place of another, shows."""
    point = _full()
    run = Results(load("structure").scene, {}, (point,))
    document = workflows.document(run)["speeds"][0]
    numbers = sum(1 for _ in leaves(document))
    columns = list(serialise.columns(SpeedPoint, [point], "rpm"))
    assert sum(column.values.size for column in columns) == numbers + 1  # the duration, which JSON leaves out
    assert sum(variable.size for variable in workflows.dataset(run).variables.values()) == numbers + 1
    jsonschema = pytest.importorskip("jsonschema")
    schema = serialise.schema()
    jsonschema.validate(document, schema["$defs"]["SpeedPoint"] | {"$defs": schema["$defs"]})


def test_a_speed_without_a_damper_has_neither_part_nor_columns() -> None:
    plain = SpeedPoint(omega=1.0, rpm=1.0, radius=1.0, load_g=1.0)
    results = Results(load("structure").scene, {}, (plain,))
    assert workflows.document(results)["speeds"] == [{"rpm": 1.0, "load_g": 1.0, "modes": []}]
    assert set(workflows.dataset(results).variables) == {"rpm", "load_g"}


def leaves(node: Any) -> Iterator[Any]:
    """Every number and text of plain data."""
    if isinstance(node, dict | list):
        for each in node.values() if isinstance(node, dict) else node:
            yield from leaves(each)
    else:
        yield node
