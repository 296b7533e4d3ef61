"""Random dampers on known structures, over everything that a scene accepts, and what each ring-down must keep."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from damper import Batch, Outcome, ParticleDamper, ringdown, ringdowns, sample
from tests.soak.dice import Dice, power, sometimes
from workflows.effects.selection import resolve
from workflows.scene.load import parse
from workflows.scene.scene import SLOWEST
from workflows.solve.coupling import known_structure, release_displacement
from workflows.solve.damper import particle_damper

Scene = dict[str, Any]

BOOKS = 1e-10
"""Largest share of the energy that the books may leave unexplained."""
INSIDE = 1e-12
"""Largest overlap of ball and wall, over the gap and the structure's amplitude, which rounding goes by."""
EVENTS = 200_000
"""Cap on the events of a ring-down of given length; near e = 1 a ball makes millions of hops against a wall."""
CYCLES = 10_000
"""Cap on the length of one that goes on until the ball rests."""
_VARIED = ("modal_mass", "stiffness", "ball_mass", "ball_radius", "cavity", "centrifugal_acceleration")
_VARIED += ("restitution", "friction", "rolling_friction", "damping_ratio", "sticking_ratio")


@dataclass(frozen=True)
class Kind:
    """What the scenes of a batch have in common."""

    formulation: str
    slips: bool
    cycles: float | str


def kind(dice: Dice) -> Kind:
    """A kind of ring-down; one in twenty goes on until the ball rests."""
    formulation = dice.one_of(("consistent", "consistent", "printed"))
    slips = formulation == "consistent" and dice.one_of((True, False))
    endless = dice.between(0.0, 1.0) < 0.05
    return Kind(formulation, slips, "auto" if endless else round(power(dice, 0.0, 2.0), 3))


def scene(dice: Dice, kind: Kind) -> Scene:
    """A structure, a ball, a cavity and a release, from one end of what is allowed to the other."""
    frequency, amplitude = power(dice, -1, 4), power(dice, -6, -1)
    square = (2 * math.pi * frequency) ** 2
    radius = amplitude * power(dice, -2, 2)
    gaps = [amplitude * sometimes(dice, (0.0, 1.0, 1e-9), power(dice, -4, 3)) for _ in range(2)]
    lever = radius * power(dice, -4, 0)
    threshold = square * amplitude * sometimes(dice, (0.0, 0.1, 1.0), power(dice, -3, 1))
    load = threshold * radius / lever if threshold > 0 else square * amplitude
    spins = threshold > 0 or dice.one_of((True, False))
    turning = max(power(dice, -2, 3), 1.01 * amplitude, 2.02 * (radius + max(gaps)))
    speed = min(max(math.sqrt(load / turning), SLOWEST), 9e4)
    friction = sometimes(dice, (0.3,) if kind.slips else (0.0, 0.3), power(dice, -3, 2))
    return {
        "title": "soak",
        "structure": {"frequency": frequency, "mass": power(dice, -6, 6)},
        "rotor": {"speeds": [speed if spins else 0.0], "radius": load / speed**2},
        "effects": {"ball_slip": kind.slips},
        "damper": {
            "mass_ratio": sometimes(dice, (0.006, 1.0), min(power(dice, -9, 3), 10.0)),
            "radius": radius,
            "cavity": [2 * (radius + gap) for gap in gaps],
            "restitution": sometimes(dice, (0.0, 0.5, 1.0), 1 - power(dice, -9, 0)),
            "friction": friction,
            "rolling_friction": lever if threshold > 0 else 0.0,
            "formulation": kind.formulation,
            "damping_ratio": sometimes(dice, (0.0, 0.01), min(power(dice, -6, 0), 1 - power(dice, -9, 0), 0.9)),
            "sticking_ratio": sometimes(dice, (0.01,), power(dice, -6, -1)),
        },
        "release": {
            "displacement": [dice.one_of((-1, 1)) * amplitude, amplitude * sometimes(dice, (0, 1), power(dice, -6, 0))],
            "cycles": kind.cycles,
        },
    }


def damper_of(given: Scene) -> tuple[ParticleDamper, tuple[float, float], float | None]:
    """The damper, release and number of cycles that a scene stands for: as `spindamp run` takes them."""
    parsed = parse(given)
    point = known_structure(parsed, parsed.rotor.speeds[0])
    cycles = given["release"]["cycles"]
    system = particle_damper(parsed, resolve(parsed), point)
    return system, release_displacement(parsed, point, system), None if cycles == "auto" else cycles


def run(scenes: list[Scene], threads: int | None = None) -> Batch:
    """Ring-downs of scenes of one kind, as one batch."""
    found = [damper_of(one) for one in scenes]
    dampers, releases, cycles = [f[0] for f in found], [f[1] for f in found], found[0][2]
    varied = {name: np.array([getattr(d, name) for d in dampers]) for name in _VARIED}
    if dampers[0].floor_friction is not None:
        spinning = [d.floor_friction or d.friction for d in dampers]
        varied["floor_friction"] = np.array(spinning)
    return ringdowns(dampers[0], releases, cycles, threads=threads, max_cycles=CYCLES, max_events=EVENTS, **varied)


def faults(batch: Batch, k: int, given: Scene) -> list[str]:
    """What ring-down k of a batch, that of a scene, did not keep."""
    cycles, events = given["structure"]["frequency"] * batch.duration[k], int(batch.events[k])
    numbers = ("duration", "initial", "final", "structure", "rolling", "impact", "slip", "peak_sdc")
    values = {name: float(getattr(batch, name)[k]) for name in numbers}
    found = [f"{name} is {value}" for name, value in values.items() if not math.isfinite(value)]
    if batch.outcome[k] is Outcome.EVENT_CAP and events > max(1000 * cycles, 10 * batch.impacts[k]):
        found.append(f"stalls: {events} events in {cycles:.2g} cycles, of which only {batch.impacts[k]} are hits")
    if given["release"]["cycles"] != "auto" and batch.outcome[k] not in (Outcome.CYCLES_DONE, Outcome.EVENT_CAP):
        found.append(f"ended with {batch.outcome[k].name} before its cycles were done")
    if given["damper"]["formulation"] == "consistent":
        initial = values["initial"]
        if abs(batch.residual[k]) > initial * BOOKS:
            found.append(f"the energy books miss {batch.residual[k] / initial:.2g}")
        if values["final"] > initial * (1 + BOOKS):
            found.append(f"energy rose by {values['final'] / initial - 1:.2g}")
        found += [
            f"{name} gives {-values[name] / initial:.2g} of the energy"
            for name in ("structure", "rolling", "impact", "slip")
            if values[name] < -BOOKS * initial
        ]
    return found


def overlap(given: Scene, cycles: float = 10.0) -> float:
    """Largest overlap of ball and wall in the first cycles, over the gap and the largest deflection."""
    damper, release, asked = damper_of(given)
    motion = ringdown(damper, release, min(cycles, asked or cycles), keep_events=True, max_events=EVENTS)
    position = np.abs(sample(motion, np.linspace(0.0, motion.duration, 300)).relative_position).max(axis=0)
    scale = np.abs(motion.rows["u"]).max()
    worst = 0.0
    for axis in range(2):
        at_events = np.abs(motion.rows["s"][motion.rows["axis"] == axis]).max()
        gap = damper.half_gap[axis]
        worst = max(worst, (max(position[axis], at_events) - gap) / (gap + scale))
    return float(worst)
