"""
Read the results with xarray
============================

A run writes `results.nc`; `spindamp.dataset` returns the same data without a file. Dimensions are rpm, mode and cycle;
units are in the attributes.
"""

import spindamp

scene = {
    "title": "A steel plate",
    "plate": {"length": "20 cm", "width": "8 cm", "thickness": "1 cm"},
    "material": {"name": "steel"},
    "rotor": {"speeds": ["0 rpm", "5000 rpm", "10000 rpm"], "modes": 3},
    "accuracy": {"frequency": 0.02},
}
data = spindamp.dataset(spindamp.campbell(scene))
print(data)

# %%
# The first frequency at every speed, with its error estimate:

first = data.isel(mode=0)
for rpm in data.rpm.values:
    at = first.sel(rpm=rpm)
    print(f"{rpm:6.0f} rpm: {float(at.frequency_hz):.2f} Hz, good to {float(at.error_estimate):.1%}")

# %%
# At rest a beam of this section has 1.875² / (2π l²) √(E h² / 12ρ); a plate, which cannot contract freely across, has a
# slightly higher frequency.

beam = 1.875**2 / (2 * 3.1416 * 0.2**2) * (200e9 * 0.01**2 / (12 * 7850.0)) ** 0.5
ratio = float(first.frequency_hz[0]) / beam
print(f"over the beam's: {ratio:.3f}")
assert 1.0 < ratio < 1 / (1 - 0.3**2) ** 0.5
