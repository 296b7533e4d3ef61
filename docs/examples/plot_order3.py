"""
What happens at order 3?
========================

At a crossing, an engine order excites the mode at its natural frequency. The steady state is computed event by event,
from three starts, since several steady states may coexist. In this example a damper sits on a structure of 1 kg, and
the frequency of the force runs through the resonance.
"""

import numpy as np
from matplotlib.figure import Figure

from damper import Harmonic, ParticleDamper, forced

ball = ParticleDamper(
    modal_mass=1.0,
    stiffness=(1.0, 1.0),
    ball_mass=0.02,
    ball_radius=1.0,
    cavity=(4.0, 4.0),
    centrifugal_acceleration=0.0,
    restitution=0.6,
    damping_ratio=5e-3,
)
frequencies = np.linspace(0.97, 1.03, 7)
found = forced(ball, [Harmonic(frequency=w, force=(0.03, 0.0)) for w in frequencies])
without = np.abs(found.without)
print("without the ball at most", f"{without.max():.3g}", "with it", f"{found.mean.max():.3g}")

# %%
# Without the ball it is the textbook oscillator, F / √((k - m ω²)² + (c ω)²):

textbook = 0.03 / np.abs(1 - frequencies**2 + 2j * 5e-3 * frequencies)
assert np.allclose(without.reshape(len(frequencies), -1)[:, 0], textbook, rtol=1e-9)
assert found.mean.max() < 0.7 * without.max()

# %%
# With the ball the peak is lower. Adjacent dots are the three starts.

shown = Figure(figsize=(7, 4), layout="constrained").subplots()
shown.plot(frequencies, without.reshape(len(frequencies), -1)[:, 0], color="black", label="without the ball")
shown.plot(frequencies, found.mean, "o", ms=4)
shown.set(xlabel="frequency of the force over the structure's", ylabel="amplitude")
shown.legend()

# %%
# For a blade, `spindamp response blade.toml` does this at every crossing, for the orders and forces in the scene's
# `[excitation]`, and writes a page.
