"""
My blade as a Gmsh mesh
=======================

Any planar mesh of the mid-surface that meshlane reads is accepted; the plate is clamped along its edge at the
smallest x. First check what is read from the file.
"""

from pathlib import Path

import spindamp
from workflows.report import viewer

meshes = Path(spindamp.__file__).parent / "meshes"
for name, words in viewer.data_of_mesh(meshes / "plate_with_hole.msh").facts:
    print(f"{name:15} {words}")

# %%
# `spindamp view meshes/plate_with_hole.msh` prints the same and shows the mesh. In a scene the mesh replaces length
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
# At rest and without the hole, beam theory gives the first frequency 1.875² / (2π l²) √(E h² / 12ρ). The hole near
# the tip removes a little mass:

steel = results.scene.material
beam = 1.875**2 / (2 * 3.1416 * 0.2**2) * (steel.youngs_modulus * 0.01**2 / (12 * steel.density)) ** 0.5
first = results.speeds[0].modes[0].frequency_hz
print(f"{first:.1f} Hz, a beam without a hole {beam:.1f} Hz")
assert 1.0 < first / beam < 1.1

# %%
# The mesh that was solved, refined from that of the file as far as the requested accuracy needs:

shown = results.plot.mesh()
