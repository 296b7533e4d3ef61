"""The particle damper: one ball rolling on the floor of a cavity, followed event by event.

    from damper import ParticleDamper, capacity, ringdown

A level floor under one mode along x and one along y is the paper's. Tilting and hollow floors, `rotation` and `modes`
of a `ParticleDamper`, and the argument `harmonic` of `ringdown`, go beyond it; the results are the same kind of thing.
`forced` is what a harmonic force leads to in the end, `backbone` the short way to its amplitude.

The heavy parts (compiled kernels) load at the first ring-down.
"""

from damper.backbone import Backbone, Branch, Way, backbone
from damper.batch import Batch, ringdowns
from damper.capacity import Capacity, ball_density, capacity, intrinsic_sdc, work_bound
from damper.curve_measurement import damping_curve
from damper.curves import DampingCurve
from damper.fixed_step import SteppedRingDown, stepped_ringdown
from damper.laws import LawViolation
from damper.model import Formulation, Harmonic, Mode, ParticleDamper
from damper.motion import EnergyBooks, Outcome, RingDown
from damper.ringdown import History, ringdown, sample
from damper.starts import Start, moves_from
from damper.steady_state import Forced, Regime, forced

__all__ = [
    "Backbone",
    "Batch",
    "Branch",
    "Capacity",
    "DampingCurve",
    "EnergyBooks",
    "Forced",
    "Formulation",
    "Harmonic",
    "History",
    "LawViolation",
    "Mode",
    "Outcome",
    "ParticleDamper",
    "Regime",
    "RingDown",
    "Start",
    "SteppedRingDown",
    "Way",
    "backbone",
    "ball_density",
    "capacity",
    "damping_curve",
    "forced",
    "intrinsic_sdc",
    "moves_from",
    "ringdown",
    "ringdowns",
    "sample",
    "stepped_ringdown",
    "work_bound",
]
