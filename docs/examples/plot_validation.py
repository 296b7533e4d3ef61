"""
Does it agree with another solver?
==================================

CalculiX, with 3-D bricks, on the paper's plate with E = 200 GPa: six modes at seven speeds, compared with the
frequencies of this code and their error estimates.
"""

import csv
from pathlib import Path

import numpy as np

import spindamp

table = Path(spindamp.__file__).parent / "tests" / "fem" / "data" / "calculix_paper_plate.csv"
with table.open(encoding="utf-8") as lines:
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))

# %%
# The same plate in this code, at stagger 0. Both omit Coriolis forces.

theirs = {}
for row in rows:
    if float(row["stagger_deg"]) == 0 and float(row["softening"]) == 1:
        theirs.setdefault(float(row["rpm"]), []).append(float(row["frequency_hz"]))
scene = {
    "title": "The paper's plate, E = 200 GPa",
    "plate": {"length": "20 cm", "width": "8 cm", "thickness": "1 cm"},
    "material": {"youngs_modulus": "200 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"},
    "rotor": {"speeds": [f"{rpm} rpm" for rpm in sorted(theirs)], "modes": 6},
    "effects": {"coriolis": False},
}
results = spindamp.campbell(scene)
print(results)

# %%
# Differences, and the error estimates of this code:

worst = 0.0
for point in results.speeds:
    reference = np.array(theirs[min(theirs, key=lambda rpm: abs(rpm - point.rpm))])
    ours = np.array([mode.frequency_hz for mode in point.modes])
    off = ours / reference - 1
    worst = max(worst, np.abs(off).max())
    print(f"{point.rpm:6.0f} rpm:", " ".join(f"{100 * each:+.3f} %" for each in off))
stated = max(mode.error_estimate for point in results.speeds for mode in point.modes)
print(f"largest difference {worst:.2%}, largest error stated {stated:.2%}, CalculiX's own mesh about 0.05 %")
assert worst < stated + 0.001

# %%
from matplotlib.figure import Figure

shown = Figure(figsize=(7, 4), layout="constrained").subplots()
for rpm, reference in theirs.items():
    shown.plot([rpm] * len(reference), reference, "o", mfc="none", color="black")
for mode in range(6):
    shown.plot([p.rpm for p in results.speeds], [p.modes[mode].frequency_hz for p in results.speeds])
shown.set(xlabel="rotation speed, rpm", ylabel="frequency, Hz", title="circles: CalculiX, 3-D bricks; lines: this code")
