"""The command: every case, every kind of change, so many times; a line for each case."""

from __future__ import annotations

import argparse
import sys

from tests.perturbed.cases import CASES
from tests.perturbed.trial import trial


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
