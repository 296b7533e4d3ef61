"""What a sweep takes: seconds, points and events a second with one worker and with two, and the share that is lost.

    python -m tests.benchmarks.sweep_speed [MASSES CLEARANCES SPEEDS]

The map of the paper's damper over mass ratio, clearance and speed, quickly: 4 sweeps through the amplitudes a point. An
event is a hit, a reversal, a sticking or a release, in ring-downs and in sweeps through the amplitudes; those of the
sweeps are counted on two blocks. Efficiency is the time with one worker over twice that with two; it means something on
a machine with two idle cores only, so that the processor time of all processes is printed beside it.
"""

import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any
from unittest import mock

import psutil

import damper.motion
from workflows.progress import Stages
from workflows.studies.sweep import evaluate, executor, study
from workflows.studies.sweep.evaluate import PlateCache


def main(masses: int = 16, clearances: int = 16, speeds: int = 10) -> None:
    """Print what one worker takes, and two."""
    vary = {
        "damper.mass_ratio": f"log:0.001:0.05:{masses}",
        "damper.clearance": f"log:0.1 mm:4 mm:{clearances}",
        "rotor.speeds": f"3500 rpm:17500 rpm:{speeds}",
    }
    asked = study.of_scene("paper", vary, quick=True)
    points = asked.plan.size
    each = events_of_a_point(asked)
    print(f"{points} points in {len(asked.regions())} blocks, {each:.0f} events each")
    seconds = []
    for workers in (1, 2):
        with tempfile.TemporaryDirectory() as place:
            began, before = time.perf_counter(), spent()
            study.complete(asked, Path(place) / "out", executor.local(workers), Stages(visible=False))
            seconds.append(time.perf_counter() - began)
            cpu = spent() - before
        rate = points / seconds[-1]
        print(
            f"{workers} worker(s): {seconds[-1]:.1f} s, {cpu:.1f} s of the processor, {rate:.0f} points/s,"
            f" {rate * each:.3g} events/s, {points * each / cpu:.3g} events per second of the processor"
        )
    efficiency = seconds[0] / 2 / seconds[1]
    print(f"efficiency on 2 workers: {efficiency:.2f}; load of the machine {psutil.getloadavg()[0]:.1f}")


def events_of_a_point(asked: study.Study) -> float:
    """Events of a point on average, over the first block and the last."""
    seen = []
    real = damper.motion.flights

    def watched(*arguments: Any, **more: Any) -> damper.motion.Flights:
        found = real(*arguments, **more)
        seen.append(found.runs["clock"])
        return found

    count = 0
    with ExitStack() as stack:
        for module in ("curve_measurement", "batch", "ringdown"):
            stack.enter_context(mock.patch(f"damper.{module}.flights", watched))
        for region in (asked.regions()[0], asked.regions()[-1]):
            evaluate.block(asked.source, asked.plan, region.begin, region.end, PlateCache(), quick=asked.quick)
            count += region.end - region.begin
    return sum(int(clocks["events"].sum()) for clocks in seen) / count


def spent() -> float:
    """Processor time of this process and of all its children that have ended [s]."""
    times = psutil.Process().cpu_times()
    return times.user + times.system + times.children_user + times.children_system


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
