"""
Where do engine orders meet my modes?
=====================================

A crossing is a speed at which a multiple of the rotation frequency excites a mode. Between the speeds of a run,
f² is interpolated linearly over Ω².
"""

import spindamp
from workflows.solve.engine_orders import crossings

scene = {
    "title": "A steel plate",
    "plate": {"length": "20 cm", "width": "8 cm", "thickness": "1 cm"},
    "material": {"name": "steel"},
    "rotor": {"speeds": {"start": "0 rpm", "stop": "15000 rpm", "count": 6}, "modes": 4},
    "accuracy": {"frequency": 0.02},
}
results = spindamp.campbell(scene)
for meeting in crossings(results):
    if meeting.order <= 6:
        print(f"{meeting.order}x meets {meeting.label:8} at {meeting.rpm:7.0f} rpm, {meeting.frequency_hz:6.1f} Hz")

# %%
# Is linear interpolation accurate enough? The plate solved again, at the speed where order 3 meets the first mode:

meeting = next(each for each in crossings(results) if each.order == 3)
there = spindamp.campbell(scene | {"rotor": {"speeds": [f"{meeting.rpm} rpm"], "modes": 4}})
solved = there.speeds[0].modes[0].frequency_hz
print(f"order 3: {meeting.frequency_hz:.3f} Hz, solved there {solved:.3f} Hz")
assert abs(solved / meeting.frequency_hz - 1) < 1e-3

# %%
shown = results.plot.campbell()
