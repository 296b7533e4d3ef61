"""The whole reproduction: one study, its claims, the slips, and what would close the gap."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from workflows.progress import Stages
from workflows.results.provenance import versions
from workflows.studies.reproduction.claims import Claim, Verdict, of_equations, of_figures, of_table_two
from workflows.studies.reproduction.paper_errors import Closure, Slip, closure, slips
from workflows.studies.reproduction.simulation import TEXTS, Simulated, Sweeps, study, sweeps


@dataclass(frozen=True, eq=False)
class Reproduction:
    """Everything the report shows."""

    study: Simulated
    sweeps: Sweeps
    claims: tuple[Claim, ...]
    slips: tuple[Slip, ...]
    closure: tuple[Closure, ...]

    @property
    def count(self) -> dict[Verdict, int]:
        """How many claims got which verdict."""
        found = Counter(claim.verdict for claim in self.claims)
        return {verdict: found[verdict] for verdict in Verdict}

    def document(self) -> dict[str, Any]:
        """The machine-readable result."""
        return {
            "schema_version": 1,
            "versions": versions(),
            "claims": [_plain(asdict(claim)) for claim in self.claims],
            "slips": [_plain(asdict(slip)) for slip in self.slips],
            "closure": [_plain(asdict(line)) for line in self.closure],
            "assumptions": TEXTS["assumptions"],
        }


def reproduce(stages: Stages | None = None) -> Reproduction:
    """Judge every claim; nothing is written."""
    stages = stages or Stages()
    simulated = study(stages)
    with stages("damper"):
        curves = sweeps(simulated)
        claims = (*of_table_two(simulated), *of_equations(simulated), *of_figures(simulated, curves))
        return Reproduction(simulated, curves, claims, slips(simulated), closure(simulated))


def _plain(value: Any) -> Any:
    """For JSON: numbers of Python, no infinities or NaN."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return value
