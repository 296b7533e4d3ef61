"""The command: every case against itself, changed by rounding, so many times; a line for each case."""

import argparse
import sys
from dataclasses import dataclass, field

import numpy as np

from tests.perturbed.cases import CASES, EXACT, Answer, Case
from tests.perturbed.changes import KINDS, SI


@dataclass
class Found:
    """What was tried: the largest relative difference for each kind of change, that relative to what is uncertain."""

    apart: dict[str, float] = field(default_factory=dict)
    share: float = 0.0
    faults: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        apart = ", ".join(f"{kind} {value:.1e}" for kind, value in self.apart.items())
        faults = "".join(f"\n    {fault}" for fault in self.faults)
        return f"{apart}; {self.share:.2g} of what is uncertain{faults}"


def trial(case: Case, times: int, seed: int = 0) -> Found:
    """Solve a case as it is, and so many times with each kind of change."""
    found = Found()
    plain = case.problem.build()
    right = case.answer(plain, SI)
    if right.ending != case.ending:
        found.faults.append(f"ends with {right.ending or 'an answer'}, not with {case.ending or 'one'}")
    for number, (kind, change) in enumerate(KINDS.items()):
        found.apart[kind] = 0.0
        for k in range(times):
            with change(case.problem, plain, np.random.default_rng((seed, number, k))) as (operators, units):
                _compare(found, kind, k, right, case.answer(operators, units))
    return found


def _compare(found: Found, kind: str, k: int, right: Answer, other: Answer) -> None:
    if other.ending != right.ending or other.values.shape != right.values.shape:
        found.faults.append(f"{kind} {k} ends with {other.ending or 'an answer'}, not with {right.ending or 'one'}")
        return
    if not right.values.size or (other.values == right.values).all():
        return
    apart = np.abs(other.values / right.values - 1.0)
    share = apart / (EXACT + 2.0 * np.maximum(right.uncertain, other.uncertain))
    found.apart[kind] = max(found.apart[kind], float(apart.max()))
    found.share = max(found.share, float(share.max()))
    if not (share <= 1.0).all():
        worst = int(np.nanargmax(np.where(np.isnan(share), np.inf, share)))
        found.faults.append(f"{kind} {k}: answer {worst} is {other.values[worst]!r}, not {right.values[worst]!r}")


def main(arguments: list[str] | None = None) -> int:
    """Try all; 1 if any answer hung on rounding."""
    parser = argparse.ArgumentParser(prog="python -m tests.perturbed", description=__doc__)
    parser.add_argument("--times", type=int, default=100, help="of each kind of change")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="cases whose name holds this")
    given = parser.parse_args(arguments)
    failed = 0
    for name, case in CASES.items():
        if given.only in name:
            found = trial(case, given.times, given.seed)
            failed += len(found.faults)
            print(f"{name}: {found}", flush=True)
    print(f"faults: {failed}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
