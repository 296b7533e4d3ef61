"""The whole reproduction: one study, its claims, the slips, and what would close the gap."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from workflows.progress import Stages
from workflows.results.provenance import versions
from workflows.studies.reproduction import claims as families
from workflows.studies.reproduction import equations, sweeps, table_two
from workflows.studies.reproduction.claims import Claim, Simulated, Sweeps, Verdict, study
from workflows.studies.reproduction.paper_errors import Closure, Slip, closure, slips

ASSUMPTIONS = (
    ("g = 10 m/s², hub radius 0, speeds of 3500 to 17500 rpm", "read back from the loads of Table II, to every digit"),
    ("E/ρ = 182.6 GPa / 7850 kg/m³ with ν = 0.3 and thin-plate theory", "ours: fitted to the frequencies of Table II"),
    ("ζ = 0.01 of the structure", "ours: the paper prints none"),
    ("release at 20 mm and 5 mm, 10000 rpm for Figs. 4 to 7", "ours; the load of 22000 g is the paper's"),
    ("cavity of 2.5 × 2.4 mm", "Fig. 4: Δ_H = 145 and Δ_V = 116 at 269.5 Hz"),
    ("e = 0.5, μ = 0.3, μ_r = 0.1 mm, r = 1 mm, mass ratio 0.6 %", "captions of Figs. 3 to 7"),
    ("mass ratio of all balls to the effective mass at the tip", "II.C: m_p / M2"),
    ("ε = 0.01", "II.A"),
)


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
            "assumptions": [{"assumption": text, "source": source} for text, source in ASSUMPTIONS],
        }


def reproduce(stages: Stages | None = None) -> Reproduction:
    """Judge every claim; nothing is written."""
    stages = stages or Stages()
    found = study(stages)
    with stages("damper"):
        curves = families.sweeps(found)
        claims = [*table_two.claims(found), *equations.claims(found), *sweeps.claims(found, curves)]
        return Reproduction(found, curves, tuple(claims), tuple(slips(found)), tuple(closure(found)))


def _plain(value: Any) -> Any:
    """For JSON: numbers of Python, no infinities or NaN."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return value
