"""Whether a program with a broken kernel publishes numbers: `python -m tests.benchmarks.broken_kernels [NAME …]`.

Each break of broken_kernels.toml is made in a copy of this tree. Its commands are run as they are (`all guards`) and
with laws that forbid nothing and a self-check that is said to be passed (`no guards`); with `--laws` also with the
laws alone. A command has published if it ends with status 0, or with 3, which is a statement on the physics; where its
figures are those of the unbroken tree, the break is not in its way. Chaos magnifies what a break does to rounding: how
far the figures are off is said. A break of a kernel takes some minutes, for all kernels have to be compiled anew.
"""

import argparse
import json
import math
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from damper.compiled import mark_of
from tests.workflows.conftest import BALL, KNOWN, changed, write

ROOT = Path(__file__).parents[2]

PARTS = ("damper", "fem", "workflows", "meshes", "spindamp.py")
"""Of a tree, what a command needs."""

HANGS = 400.0
"""Seconds after which a command counts as hanging, which publishes nothing."""

MEMORY = 6 << 30
"""Bytes that a command may allocate; a broken loop that records for ever must not take the machine with it."""


def callers(folder: Path, name: str) -> set[str]:
    """A module and all that import it, directly or not."""
    sources = {path.stem: path.read_text(encoding="utf-8") for path in folder.glob("*.py")}
    found = {name}
    while more := {each for each, text in sources.items() for one in found if f"damper.{one} import" in text} - found:
        found |= more
    return found


class Break:
    """What is made wrong: in each file, every one of some texts by others."""

    def __init__(self, name: str, *changes: tuple[str, str, str]) -> None:
        self.name, self.changes = name, changes

    def apply(self, tree: Path) -> None:
        """Make it wrong in a tree, and drop what was compiled of it there and of all that calls it."""
        for file, right, wrong in self.changes:
            path = tree / file
            text = path.read_text(encoding="utf-8")
            if right not in text:
                raise SystemExit(f"{self.name}: {file} no longer holds: {right}")
            path.write_text(text.replace(right, wrong), encoding="utf-8")
            for compiled in (tree / "damper" / "__pycache__").glob("*.pyc"):
                compiled.unlink()
            kernels = tree / "damper" / "__pycache__"
            if any(kernels.glob(f"{path.stem}.*.nb?")):
                for module in callers(tree / "damper", path.stem):
                    for compiled in kernels.glob(f"{module}.*.nb?"):
                        compiled.unlink()
        mark = mark_of(tree / "damper", tree / "damper" / "__pycache__")  # or all of the cache would be dropped
        mark.parent.mkdir(exist_ok=True)
        mark.touch()


def breaks() -> list[Break]:
    """Nothing, and what broken_kernels.toml holds."""
    given = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    return [Break("nothing"), *(Break(name, *map(tuple, each["changes"])) for name, each in given.items())]


LAWLESS = Break(
    "no law",
    ("damper/laws.py", "    holds = value <= bound\n", "    return\n    holds = value <= bound\n"),
    ("fem/sweep/laws.py", "    if not holds.all():\n", "    if False:\n"),
)

BIG = {"mass_ratio": 0.01, "count": 12, "radius": "2 mm", "cavity": ["5 mm", "5 mm"], "rolling_friction": "0.05 mm"}
TILTED = KNOWN | {
    "structure": {"frequency": "200 Hz", "mass": "0.3 kg", "floor_tilt": 2.0},
    "rotor": KNOWN["rotor"] | {"speeds": ["3000 rpm", "5000 rpm"]},
    "damper": BALL | BIG | {"damping_ratio": 0.05},
    "release": {"ratio": 0.5},
    "excitation": {"orders": [3], "force": ["20 N"]},
}
DESIGN = {"clearance": ["0.5 mm", "1 mm", "2 mm"], "mass": "20 g", "amplitude": ["1 mm", "3 mm"]}
SCENES = {
    "scene": TILTED,
    "level": changed(TILTED, structure__floor_tilt=None),
    "design": changed(TILTED, excitation=None, design=DESIGN),
}

SWEEP = ("--vary", "damper.restitution=0.4,0.5", "--quick", "--workers", "1", "--out", "out-sweep")
ON_STRUCTURES = {
    "run": ("run", "scene.toml", "--out", "out-run"),
    "run on a level floor": ("run", "level.toml", "--out", "out-level"),
    "ringdown": ("ringdown", "scene.toml", "--json"),
    "response": ("response", "scene.toml", "--out", "out-response"),
    "design": ("design", "design.toml", "--workers", "1", "--out", "out-design"),
    "sweep": ("sweep", "scene.toml", *SWEEP),
}
ON_PLATES = {
    "run of a plate": ("run", "paper", "--out", "out-run"),
    "campbell": ("campbell", "paper", "--json"),
    "sweep of a plate": ("sweep", "paper", *SWEEP),
}

STAMPS = """
from damper import self_check
from damper.self_check import leave
from workflows.solve.self_check import stamp_of_plates
for path in (*map(self_check.stamp_of, self_check.FAMILIES), stamp_of_plates()):
    leave(path)
"""
"""Leaves the stamps of a self-check that was passed, so that no process makes it."""


Figures = list[str]


def run(tree: Path, command: tuple[str, ...]) -> tuple[str, str, Figures]:
    """What became of a command in a tree, the last that it said, and its figures."""
    done = python(tree, "-m", "workflows.cli", *command)
    if done is None:
        return "hangs", "", []
    said = done.stderr.strip().splitlines()[-1] if done.stderr.strip() else ""
    if done.returncode not in (0, 3):
        return f"status {done.returncode}", said, []
    texts = [done.stdout] if "--json" in command else []
    texts += [path.read_text(encoding="utf-8") for path in sorted(tree.glob("out-*/*.json"))]
    figures: Figures = []
    for text in texts:
        collect(json.loads(text), figures)
    return "PUBLISHED", said, figures


def collect(value: Any, figures: Figures) -> None:
    """Add the numbers in a JSON value to `figures`, to five digits; but for times and estimates of rounding."""
    if isinstance(value, dict):
        for key, each in value.items():
            if key not in {"timings", "versions", "seconds", "error_parts", "machine"}:
                collect(each, figures)
    elif isinstance(value, list):
        for each in value:
            collect(each, figures)
    elif isinstance(value, int | float):
        figures.append(f"{value:.5g}")


def python(tree: Path, *arguments: str) -> subprocess.CompletedProcess[str] | None:
    """Run Python in a tree; None where it hangs."""
    environment = os.environ | {"PYTHONPATH": str(tree), "OMP_NUM_THREADS": "1"}
    command = [sys.executable, *arguments]
    try:
        return subprocess.run(
            command,
            cwd=tree,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=HANGS,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY)),
        )
    except subprocess.TimeoutExpired:
        return None


def broken_copy(tree: Path, each: Break) -> Path:
    """A copy of this tree, with what is compiled in it, that is broken."""
    for part in PARTS:
        if (ROOT / part).is_dir():
            shutil.copytree(ROOT / part, tree / part, ignore=shutil.ignore_patterns("*.checked"))
        else:
            shutil.copy2(ROOT / part, tree / part)
    each.apply(tree)
    for name, scene in SCENES.items():
        write(scene, tree / f"{name}.toml")
    return tree


LEVELS = ("all guards", "laws alone", "no guards")

EXPECTED: dict[tuple[str, ...], Figures] = {}
"""Figures of the commands where nothing is broken."""


def difference(figures: Figures, expected: Figures) -> float:
    """The largest relative difference of figures; inf where there are more or fewer."""
    if len(figures) != len(expected):
        return math.inf
    pairs = [(float(one), float(other)) for one, other in zip(figures, expected, strict=True)]
    return max((abs(a - b) / max(abs(a), abs(b)) for a, b in pairs if a != b), default=0.0)


def results(each: Break, *, laws: bool) -> Iterator[tuple[str, str, str, str]]:
    """Break, guards, command and what became of it, in a copy of this tree."""
    with tempfile.TemporaryDirectory() as folder:
        tree = broken_copy(Path(folder), each)
        commands = ON_STRUCTURES | ON_PLATES
        if each.changes:
            commands = ON_PLATES if each.changes[0][0].startswith("fem") else ON_STRUCTURES
        for guards in LEVELS if each.changes else LEVELS[:1]:
            if guards == "laws alone" and not laws:
                continue
            if guards == "laws alone":
                python(tree, "-c", STAMPS)
            if guards == "no guards":
                LAWLESS.apply(tree)
                python(tree, "-c", STAMPS)
            for name, command in commands.items():
                became, said, figures = run(tree, command)
                if not each.changes:
                    EXPECTED[command] = figures
                elif became == "PUBLISHED":
                    off = difference(figures, EXPECTED[command])
                    became = f"PUBLISHED, off by up to {off:.1g}" if off else "the right figures"
                yield each.name, guards, name, f"{became} {said}"
                for out in tree.glob("out-*"):
                    shutil.rmtree(out)


def main() -> None:
    """Print a line for each break, guards and command."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.broken_kernels")
    parser.add_argument("names", nargs="*", help="breaks whose names begin so; default: all")
    parser.add_argument("--laws", action="store_true", help="also with the laws alone")
    given = parser.parse_args()
    for each in breaks():
        if each.changes and given.names and not any(each.name.startswith(name) for name in given.names):
            continue
        for row in results(each, laws=given.laws):
            print(" | ".join(row), flush=True)


if __name__ == "__main__":
    main()
