"""
What is my cut-off?
===================

The ball stays at rest until the structure's acceleration is large enough to roll it. On a level floor, rolling
resistance holds it: a ball of radius :math:`r` sets off where the acceleration along the floor exceeds
:math:`\\mu_r / r` of the load that presses it down.
"""

import spindamp

scene = {
    "title": "A damper on a known structure",
    "structure": {"frequency": "269.5 Hz", "mass": "1 kg"},
    "rotor": {"speeds": ["5000 rpm", "10000 rpm"], "radius": "20 cm"},
    "damper": {
        "mass_ratio": 0.006,
        "count": 183,
        "radius": "1 mm",
        "cavity": ["2.5 mm", "2.4 mm"],
        "restitution": 0.5,
        "friction": 0.3,
        "rolling_friction": "0.1 mm",
    },
    "release": {"displacement": ["20 mm", "0 mm"]},
}
results = spindamp.run(scene)
print(results)

# %%
# The cut-off over the load is 0.1 = 0.1 mm / 1 mm, within the resolution of one cycle of the ring-down.

for point in results.speeds:
    print(f"{point.rpm:6.0f} rpm: {point.damper.cutoff_g:7.0f} g, {point.damper.cutoff_ratio:.3f} of the load")
    assert 0.09 < point.damper.cutoff_ratio < 0.13

# %%
# Damping by the ball over amplitude:

shown = results.plot.damping()
