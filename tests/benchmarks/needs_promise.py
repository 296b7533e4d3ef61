"""What `check` says that a run takes, against what it takes: `python -m tests.benchmarks.needs_promise 40`.

Random scenes of the soak, with several speeds, modes and accuracies, half of them with a damper, some on meshes from
files; each is checked and run in processes of its own. The machine must be quiet: the promise is of seconds. With CPU
in the environment seconds are those of the processor.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from fem import rectangle
from tests.soak.dice import Dice, Seeded, power, sometimes
from tests.soak.plates import scene as plate_scene
from tests.workflows.conftest import write

LIMIT = 300


def scene(dice: Dice, folder: Path) -> dict[str, Any]:
    """A random plate at several speeds, and what sits on it."""
    found = plate_scene(dice)
    plate, rotor = found["plate"], found["rotor"]
    fastest = max(float(str(speed).split()[0]) for speed in rotor["speeds"])
    plate["thickness"] = max(plate["thickness"], 3e-4 * max(plate["length"], plate["width"]))
    fastest = fastest or 1.0
    rotor["speeds"] = [f"{speed} rad/s" for speed in np.linspace(0.2, 1.0, int(power(dice, 0, 1.5))) * fastest]
    rotor["modes"] = int(power(dice, 0.3, 1.6))
    plate["theory"] = dice.one_of(("auto", "auto", plate["theory"]))
    found["accuracy"] = {"frequency": power(dice, -4.5, -2)}
    found.pop("effects", None)
    length, width = plate["length"], plate["width"]
    if dice.between(0, 1) < 0.3:
        cells = int(power(dice, 1, 1.7))
        mesh = rectangle(length, width, cells, max(2, cells // 2))
        x, y = mesh.p
        points = np.column_stack([x, y + dice.one_of((0.0, 0.3)) * x, 0 * x])
        tri = dice.between(0, 1) < 0.5
        kept = mesh.to_meshtri() if tri else mesh
        meshio.Mesh(points, [("triangle" if tri else "quad", kept.t.T)]).write(folder / "plate.vtu")
        plate["length"] = plate["width"] = None
        plate["mesh"] = "plate.vtu"
    if dice.between(0, 1) < 0.5:
        thickness = plate["thickness"]
        found["damper"] = {
            "mass_ratio": power(dice, -4, -2),
            "radius": 0.2 * thickness,
            "cavity": [0.6 * thickness] * 2,
            "restitution": dice.between(0.3, 0.9),
            "friction": 0.2,
            "rolling_friction": 0.002 * thickness,
            "damping_ratio": sometimes(dice, (0.0,), 1e-3),
        }
        found["release"] = {"ratio": power(dice, -3, 0), "cycles": dice.one_of(("auto", 30, 3000))}
    return {table: _plain(values) for table, values in found.items()}


def _plain(values: Any) -> Any:
    return {key: value for key, value in values.items() if value is not None} if isinstance(values, dict) else values


def measured(command: list[str], folder: Path) -> tuple[int, float, float, str, str]:
    """Status, seconds, bytes, and what was printed."""
    began = time.perf_counter()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with subprocess.Popen(
        ["/usr/bin/env", sys.executable, "-c", MEASURED, *command],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            out, err = process.communicate(timeout=LIMIT)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = time.perf_counter() - began
    if os.environ.get("CPU"):
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    peak = float(err.rsplit("peak=", 1)[1]) if "peak=" in err else np.nan
    return process.returncode, seconds, peak, out, err


MEASURED = """
import os, resource, sys
if os.environ.get("CPU"):
    import time, fem.linalg.spent
    from workflows.solve import decided, pilot, price, reckoned
    for module in (fem.linalg.spent, decided, pilot, price, reckoned):
        module.perf_counter = time.process_time
from workflows.cli import entry as cli
status = cli.main(sys.argv[1:])
print(f"peak={1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss}", file=sys.stderr)
sys.exit(status)
"""


def main(count: int, seed: int) -> None:
    """A line for each scene: promised over taken, of memory and time."""
    ratios = []
    for number in range(count):
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            given = scene(Seeded((seed, number)), folder)
            write(given, folder / "scene.toml")
            status, price, _, out, err = measured(["check", "scene.toml", "--json"], folder)
            if status != 0:
                print(f"{number:4d} refused: {err.splitlines()[0][:150]}", flush=True)
                continue
            needs = json.loads(out)["needs"]
            status, seconds, peak, out, err = measured(["run", "scene.toml", "--out", "out"], folder)
        ratios.append((needs["memory"] / peak, needs["seconds"] / seconds))
        said = f"{needs['memory'] / 1e6:7.0f} MB, took {peak / 1e6:7.0f} ({ratios[-1][0]:.2f})"
        print(
            f"{number:4d} {said}; {needs['seconds']:6.1f} s, took {seconds:6.1f} ({ratios[-1][1]:.2f}), check took"
            f" {price:.1f} s; status {status}"
            f" {given['plate'].get('mesh', '-')} {given['plate']['theory']} {given['rotor']['modes']} modes,"
            f" {len(given['rotor']['speeds'])} speeds, {given['accuracy']['frequency']:.0e}"
            f"{' damper' if 'damper' in given else ''}",
            flush=True,
        )
    memory, seconds = np.array(ratios).T
    for what, found in (("memory", memory), ("seconds", seconds)):
        worst = f"{np.nanmin(found):.2f} to {np.nanmax(found):.2f}"
        inside = int(((found >= 0.5) & (found <= 2)).sum())
        print(f"{what}: {worst}, median {np.nanmedian(found):.2f}; within a factor of two: {inside} of {found.size}")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
