"""
Where do engine orders meet my modes?
=====================================

A crossing is a speed at which a multiple of the rotation's frequency excites a mode. Between the speeds of a run
f² goes with Ω² along a straight line.
"""

import spindamp
from workflows.results.crossings import crossings

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
shown = results.plot.campbell()
