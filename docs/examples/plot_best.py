"""
Which damper is best?
=====================

`spindamp sweep` varies any keys of a scene; `spindamp design` searches for the best damper within the ranges and
limits of a table `[design]`. This example is a sweep in Python over clearance and restitution.
"""

from concurrent.futures import ThreadPoolExecutor

import spindamp

scene = {
    "title": "A damper on a known structure",
    "structure": {"frequency": "269.5 Hz", "mass": "1 kg"},
    "rotor": {"speeds": ["3500 rpm"], "radius": "20 cm"},
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
keys = {"damper.clearance": ["0.3 mm", "0.6 mm", "1.2 mm", "2.4 mm"], "damper.restitution": [0.2, 0.5, 0.8]}
with ThreadPoolExecutor(1) as one:  # in a script of your own, leave it out and all cores are used
    data = spindamp.sweep(scene, keys, quick=True, executor=one)
print(data)

# %%
# The largest damping ratio of the ball over clearance and restitution:

peaks = 100 * data.damping_ratio_peak.squeeze()
print(peaks.to_pandas())

# %%
from matplotlib.figure import Figure

shown = Figure(figsize=(7, 4), layout="constrained").subplots()
peaks.plot.line(ax=shown, x=peaks.dims[0], marker="o")
shown.set_ylabel("damping ratio by the ball at its best, %")

# %%
# However it bounces, a ball can dissipate at most 4 (m/M) (d/A) of the vibration's energy in a cycle, with d the
# clearance and A the amplitude; a damping ratio ζ corresponds to a loss of 4π ζ. These balls reach 60 to 90 % of the
# bound:

bound = 4 * 0.006 * data["damper.clearance"] / data.at_amplitude.squeeze() / (4 * 3.14159265)
share = peaks / 100 / bound
print(share.to_pandas())
assert share.max() < 1
assert share.min() > 0.5
