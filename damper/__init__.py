"""The particle damper: one ball rolling on the floor of a cavity, followed event by event in closed form.

    from damper import ParticleDamper, capacity, ringdown

A level floor under one mode along x and one along y is the paper's. `floor_tilt`, `floor_radius`, `rotation`, `modes`
of a `ParticleDamper` and the argument `harmonic` of `ringdown`, go beyond it; the results are the same kind of thing.

The heavy parts (compiled kernels) load at the first ring-down.
"""

from damper.batch import Batch, ringdowns
from damper.capacity import Capacity, ball_density, capacity, intrinsic_sdc, two_hit_bound, work_bound
from damper.model import Formulation, ParticleDamper
from damper.modes import Harmonic, Mode
from damper.ringdown import EnergyBooks, Outcome, RingDown, ringdown
from damper.sample import History, sample
from damper.stepping import SteppedRingDown, stepped_ringdown
from damper.working import Working, working

__all__ = [
    "Batch",
    "Capacity",
    "EnergyBooks",
    "Formulation",
    "Harmonic",
    "History",
    "Mode",
    "Outcome",
    "ParticleDamper",
    "RingDown",
    "SteppedRingDown",
    "Working",
    "ball_density",
    "capacity",
    "intrinsic_sdc",
    "ringdown",
    "ringdowns",
    "sample",
    "stepped_ringdown",
    "two_hit_bound",
    "work_bound",
    "working",
]
