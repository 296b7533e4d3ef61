"""Forty scenes' results, to be compared before and after a change that should move no digit.

    python -m tests.benchmarks.same_digits write before.json      # with the old code
    python -m tests.benchmarks.same_digits compare before.json    # with the new code; 1 if anything is 1e-12 apart

Random plates and ring-downs of the soak and the shipped scenes, through the public calls alone.
"""

import json
import math
import sys
from pathlib import Path
from typing import Any

import workflows
from tests.soak import plates
from tests.soak.dice import Seeded, power
from tests.workflows.conftest import BALL, KNOWN

SHIPPED = ("paper", "printed", "structure", "campbell")
PLATES, RINGS = 16, 20
APART = 1e-12
LEFT_OUT = {"timings", "versions", "scene_sha256", "title"}


def scenes() -> dict[str, Any]:
    """By name."""
    found: dict[str, Any] = {name: name for name in SHIPPED}
    found |= {f"plate {number}": _plate(number) for number in range(PLATES)}
    return found | {f"ring-down {number}": _ring(number) for number in range(RINGS)}


def _plate(number: int) -> dict[str, Any]:
    scene = plates.sensible(number)
    scene["rotor"] |= {"speeds": [share * scene["rotor"]["speeds"][0] for share in (0.0, 0.3, 1.0)], "modes": 4}
    return scene | {"accuracy": {"frequency": 1e-3}, "effects": {"coriolis": number % 2 == 0}}


def _ring(number: int) -> dict[str, Any]:
    dice = Seeded((17, number))
    structure = {"frequency": f"{power(dice, 1, 3)} Hz", "mass": "1 kg"}
    ball = {"mass_ratio": power(dice, -3.5, -1.5), "restitution": dice.between(0.2, 0.95)}
    ball |= {"rolling_friction": f"{power(dice, -3, -1)} mm", "damping_ratio": dice.one_of((0.0, 0.001))}
    release = {"ratio": power(dice, -1.0, 0.0), "cycles": 5}
    rotor = KNOWN["rotor"] | {"speeds": ["3000 rpm", "9000 rpm"]}
    return {"structure": structure, "rotor": rotor, "damper": BALL | ball, "release": release}


def answers() -> dict[str, Any]:
    """Results, or what was said instead."""
    found = {}
    for name, scene in scenes().items():
        try:
            document = workflows.document(workflows.run(scene))
            found[name] = json.loads(json.dumps({key: document[key] for key in document if key not in LEFT_OUT}))
        except workflows.SpindampError as error:
            found[name] = str(error)
        print(name, file=sys.stderr, flush=True)
    return found


def differences(one: Any, other: Any, where: str = "") -> list[str]:
    """Where two documents differ by more than rounding."""
    if isinstance(one, dict) and isinstance(other, dict):
        named = [f"{where}: {key} is in one alone" for key in sorted(one.keys() ^ other.keys())]
        return named + [
            text for key in one.keys() & other.keys() for text in differences(one[key], other[key], f"{where}/{key}")
        ]
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        pairs = zip(one, other, strict=True)
        return [text for number, (a, b) in enumerate(pairs) for text in differences(a, b, f"{where}/{number}")]
    if isinstance(one, float) and isinstance(other, float) and math.isclose(one, other, rel_tol=APART):
        return []
    return [] if one == other else [f"{where}: {one!r}, then {other!r}"]


def main(what: str, path: str) -> int:
    """Write, or compare."""
    found = answers()
    if what == "write":
        Path(path).write_text(json.dumps(found), encoding="utf-8")
        return 0
    apart = differences(json.loads(Path(path).read_text(encoding="utf-8")), found)
    print("\n".join(apart[:40]) or f"{len(found)} scenes, no digit moved")
    return 1 if apart else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
