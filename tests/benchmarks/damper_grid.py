"""The engine against the dense reference over many random scenes, 15 cycles each.

    python -m tests.benchmarks.damper_grid [SCENES]

A scene drops out where the reference at two samplings, 512 and 2048 a period, disagrees with itself by more than
1e-9 of a period or in its events: impacts amplify rounding, in some scenes beyond that within 15 cycles. How often the
engine and the reference agree nonetheless is printed with it.
"""

from __future__ import annotations

import sys

from damper import ringdown
from tests.damper.reference import Reference
from tests.damper.scenes import random_scene
from tests.damper.test_reference import ENERGY_TOLERANCE, agree, events

CYCLES = 15
MANY = 20_000


def main(scenes: int = 200) -> int:
    """Compare, print the count of each outcome, and return how many scenes contradict the reference."""
    agreed = dropped = contradicted = skipped = 0
    worst_time = worst_energy = 0.0
    for seed in range(scenes):
        damper, release = random_scene(seed)
        run = ringdown(damper, release, CYCLES, keep_events=True)
        if run.events > MANY:
            skipped += 1
            continue
        reference = Reference(damper, release, CYCLES, samples=512)
        if not agree(reference.events, Reference(damper, release, CYCLES, samples=2048).events):
            dropped += 1
            continue
        scale = max(reference.initial, reference.final)
        energy = abs(run.energy.final / run.energy.initial * reference.initial - reference.final) / scale
        if agree(events(run), reference.events) and energy <= ENERGY_TOLERANCE and run.impacts == reference.impacts:
            agreed += 1
            pairs = zip(events(run), reference.events, strict=True)
            worst_time = max([worst_time, *(abs(ours[0] - theirs[0]) for ours, theirs in pairs)])
            worst_energy = max(worst_energy, energy)
        else:
            contradicted += 1
            print(f"scene {seed}: {len(events(run))} events against {len(reference.events)}, energy {energy:.1e}")
    print(
        f" {contradicted} do not; {dropped} dropped out, {skipped} skipped with more than {MANY} events"
        f" {contradicted} do not; {dropped} dropped out, {skipped} with more than {MANY} events skipped"
    )
    return contradicted


if __name__ == "__main__":
    sys.exit(min(main(*map(int, sys.argv[1:])), 1))
