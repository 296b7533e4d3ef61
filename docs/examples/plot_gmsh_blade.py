"""
My blade as a Gmsh mesh
=======================

Any planar mesh of the mid-surface that meshio reads will do: the plate is clamped along its edge at the smallest x.
First look at what is understood of the file.
"""

from pathlib import Path

import spindamp
from workflows.report import viewer

meshes = Path(spindamp.__file__).parent / "meshes"
for name, words in viewer.data_of_mesh(meshes / "plate_with_hole.msh").facts:
    print(f"{name:15} {words}")

# %%
# `spindamp view meshes/plate_with_hole.msh` says the same and shows it. A scene names the mesh in the place of length
# and width.

scene = {
    "title": "A plate with a hole",
    "plate": {"mesh": str(meshes / "plate_with_hole.msh"), "thickness": "10 mm"},
    "material": {"name": "steel"},
    "rotor": {"speeds": ["0 rpm", "3000 rpm", "6000 rpm"], "modes": 4},
    "accuracy": {"frequency": 0.02},
}
results = spindamp.campbell(scene)
print(results)

# %%
# At rest and without the hole, beam theory has the first frequency at 1.875² / (2π l²) √(E h² / 12ρ). The hole near the tip
# takes away a little of the mass:

steel = results.scene.material
beam = 1.875**2 / (2 * 3.1416 * 0.2**2) * (steel.youngs_modulus * 0.01**2 / (12 * steel.density)) ** 0.5
first = results.speeds[0].modes[0].frequency_hz
print(f"{first:.1f} Hz, a beam without a hole {beam:.1f} Hz")
assert 1.0 < first / beam < 1.1

# %%
# The mesh that was solved, refined from the file's as far as the accuracy asked for needs:

shown = results.plot.mesh()
