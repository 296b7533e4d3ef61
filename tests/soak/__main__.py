"""The command: try, count, write down what fails, and say what the worst was."""

import argparse
import sys
import traceback
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from damper import Outcome
from tests.soak import plates, rings
from tests.soak.dice import Seeded
from tests.workflows.conftest import text_of

BATCH = 100
"""Ring-downs of one kind; each batch has a seed of its own."""
LOOKED_AT = 10
"""Of so many ring-downs one is looked at for overlap, which needs its every event."""


@dataclass
class Tally:
    """What was tried, and the worst of it."""

    ringdowns: int = 0
    plates: int = 0
    residual: float = 0.0
    overlap: float = 0.0
    cycles: float = 0.0
    events: int = 0
    capped: int = 0
    endings: dict[str, int] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)

    def report(self) -> str:
        """The lines at the end."""
        endings = ", ".join(f"{count} {name}" for name, count in sorted(self.endings.items()))
        return "\n".join(
            [
                f"scenes tried: {self.ringdowns} ring-downs, {self.plates} plates ({endings})",
                f"failures: {len(self.failures)}",
                f"worst energy residual: {self.residual:.2g} of the energy at release",
                f"worst overlap: {self.overlap:.2g} of gap and amplitude",
                f"longest run: {self.cycles:.0f} cycles; most events: {self.events}; ended by their cap: {self.capped}",
            ]
        )


def main(arguments: list[str] | None = None) -> int:
    """Run the soak; 1 if anything failed."""
    parser = argparse.ArgumentParser(prog="python -m tests.soak", description=__doc__)
    parser.add_argument("--ringdowns", type=int, default=100_000)
    parser.add_argument("--plates", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, help="folder for the scenes that fail")
    given = parser.parse_args(arguments)
    tally = Tally()
    for number in range(-(-given.ringdowns // BATCH)):
        batch_of_rings(given.seed, number, min(BATCH, given.ringdowns - tally.ringdowns), given.out, tally)
    for number in range(given.plates):
        one_plate(given.seed, number, given.out, tally)
    print(tally.report())
    return 1 if tally.failures else 0


def batch_of_rings(seed: int, number: int, size: int, out: Path | None, tally: Tally) -> None:
    """Ring-downs of one kind."""
    dice = Seeded((seed, 0, number))
    kind = rings.kind(dice)
    scenes = [rings.scene(dice, kind) for _ in range(size)]
    batch = rings.run(scenes)
    tally.ringdowns += size
    tally.capped += int((batch.outcome == Outcome.EVENT_CAP).sum())
    tally.events = max(tally.events, int(batch.events.max()))
    for k, scene in enumerate(scenes):
        found = rings.faults(batch, k, scene)
        tally.cycles = max(tally.cycles, float(batch.duration[k]) * scene["structure"]["frequency"])
        if kind.formulation == "consistent":
            tally.residual = max(tally.residual, abs(float(batch.residual[k] / batch.initial[k])))
        if k % LOOKED_AT == 0:
            overlap = rings.overlap(scene)
            tally.overlap = max(tally.overlap, overlap)
            if not overlap <= rings.INSIDE:
                found.append(f"ball and wall overlap by {overlap:.2g}")
        _note(found, f"ringdown-{seed}-{number}-{k}", scene, None, out, tally)


def one_plate(seed: int, number: int, out: Path | None, tally: Tally) -> None:
    """A plate on a mesh; what is raised and not foreseen is a failure too."""
    dice = Seeded((seed, 1, number))
    scene = plates.scene(dice)
    mesh = plates.mesh(dice, scene)
    tally.plates += 1
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found, ending = plates.faults(scene, mesh)
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        found, ending = [f"{type(error).__name__} in {Path(where.filename).name}:{where.lineno}: {error}"], "error"
    tally.endings[ending] = tally.endings.get(ending, 0) + 1
    _note(found, f"plate-{seed}-{number}", scene, mesh, out, tally)


def _note(found: list[str], name: str, scene: dict[str, Any], mesh: Any, out: Path | None, tally: Tally) -> None:
    if not found:
        return
    tally.failures.append(name)
    print(f"{name}: {'; '.join(found)}", flush=True)
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        if mesh is not None:
            scene = {**scene, "plate": {**scene["plate"], "mesh": f"{name}.vtu"}}
            del scene["plate"]["length"], scene["plate"]["width"]
            kind = "quad" if mesh.t.shape[0] == 4 else "triangle"
            flat = np.column_stack([mesh.p.T, np.zeros(mesh.p.shape[1])])
            meshio.write(out / f"{name}.vtu", meshio.Mesh(flat, [(kind, mesh.t.T)]))
        (out / f"{name}.toml").write_text("".join(f"# {line}\n" for line in found) + text_of(scene))


if __name__ == "__main__":
    sys.exit(main())
