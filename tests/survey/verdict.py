"""What spindamp says of a plate, held against CalculiX."""

import tempfile
import time
from dataclasses import dataclass

import numpy as np

import workflows
from fem import Effects, Material, Plate, Rotor
from fem.accuracy.neglected_effects import bent
from tests.survey import scenes

ASKED = 1e-3
"""Accuracy of a scene that asks for none."""


@dataclass(frozen=True, eq=False)
class Verdict:
    """Six modes (count,): frequencies and CalculiX's in Hz, estimates and true errors, relative.

    reference and true errors are without Coriolis forces where spindamp left these out; missed: by how much they move
    a frequency there. slack: error of the reference itself. theory, effects: what was chosen. seconds: of the
    processor.
    """

    name: str
    theory: str
    effects: tuple
    seconds: float
    found: np.ndarray
    reference: np.ndarray
    estimate: np.ndarray
    true: np.ndarray
    missed: np.ndarray
    slack: np.ndarray

    @property
    def ratio(self):
        """True error, as far as it is beyond doubt, over the estimate; infinite where there is no estimate."""
        return np.maximum(self.true - self.slack, 0.0) / self.estimate

    @property
    def violations(self):
        """Numbers from 1 of the modes outside their estimate."""
        return (np.flatnonzero(~(self.ratio <= 1.0)) + 1).tolist()

    @property
    def wanting(self):
        """Numbers from 1 of the modes that an effect which was left out moves by more than the accuracy asked for."""
        return (np.flatnonzero(self.missed > ASKED) + 1).tolist()


def static_state(case, omega):
    """The static state of a plate at a speed in rad/s, None where it diverges; of the mean thickness, and one mode."""
    mesh = case.planform.even(1)
    thickness = float(case.thickness_at(*mesh.p[:, mesh.t].mean(axis=1)).mean())
    kg, *at = case.tip or (0.0,)
    plate = Plate(mesh, thickness, Material(*case.material), kg, tuple(at) or None)
    return bent(plate, Rotor(case.hub, np.radians(case.stagger)), Effects(), (omega,), 1)


def judge(case, reference):
    """Run a plate. reference: frequencies (2, count) in Hz without Coriolis forces and with them, and their errors."""
    frequencies, errors = reference
    with tempfile.TemporaryDirectory() as folder:
        start = time.process_time()
        results = workflows.run(scenes.write(case, folder))
        seconds = time.process_time() - start
    modes = results.speeds[0].modes
    found = np.array([mode.frequency_hz for mode in modes])
    estimate = np.array([mode.error_estimate or 0.0 for mode in modes])
    turning = int(results.effects["coriolis"].on)
    return Verdict(
        name=case.name,
        theory=results.theory.name,
        effects=tuple(name for name in ("coriolis", "large_deflection") if results.effects[name].on),
        seconds=seconds,
        found=found,
        reference=frequencies[turning],
        estimate=estimate,
        true=np.abs(found / frequencies[turning] - 1.0),
        missed=np.abs(frequencies[1] / frequencies[turning] - 1.0),
        slack=errors[turning],
    )
