"""
A thousand speeds
=================

One reduced basis serves all speeds, with a bound on the error that it adds to each frequency.
"""

import numpy as np

from fem import Effects, Material, Plate, Rectangle, Rotor, assemble, campbell, solve_modes

plate = Plate(Rectangle(0.2, 0.08).mesh(4), 0.01, Material(200e9, 0.3, 7850.0))
operators = assemble(plate, Rotor(hub_radius=0.1), Effects(coriolis=False))
diagram = campbell(operators, np.linspace(0.0, 1800.0, 1000), count=6)  # rad/s
print(diagram.frequencies_hz.shape, f"bound {diagram.bounds.max():.1e}")

# %%
# One of the speeds solved directly, without the basis: the bound holds.

alone = solve_modes(operators, float(diagram.omega[617]), 6).frequencies_hz
assert (np.abs(diagram.frequencies_hz[617] / alone - 1) <= diagram.bounds[617] + 1e-12).all()
assert diagram.bounds.max() < 1e-6

# %%
# The squared frequency of a mode that keeps its shape grows linearly with the squared speed. The small deviation of
# the first mode from a straight line shows how little its shape changes:

squares = diagram.frequencies_hz[:, 0] ** 2
line = np.polyfit(diagram.omega**2, squares, 1)
print(f"largest departure from the line: {np.abs(np.polyval(line, diagram.omega**2) / squares - 1).max():.1%}")

# %%
from matplotlib.figure import Figure

shown = Figure(figsize=(7, 4), layout="constrained").subplots()
shown.plot(diagram.omega * 30 / np.pi, diagram.frequencies_hz)
shown.set(xlabel="rotation speed, rpm", ylabel="frequency, Hz")
