"""A plate as its user would give it: a scene that leaves all to spindamp, and a mesh file where it is no rectangle."""

from pathlib import Path

import meshio
import numpy as np

from tests.survey import plates


def write(case, folder):
    """Write a plate's scene into a folder; its path."""
    path = Path(folder) / "scene.toml"
    young, nu, density = case.material
    lines = [f'title = "{case.name}"', "", "[plate]", *_plate(case, Path(folder))]
    lines += ["", "[material]", f"youngs_modulus = {young}", f"poissons_ratio = {nu}", f"density = {density}"]
    lines += ["", "[rotor]", f'speeds = ["{case.rpm:g} rpm"]', f"hub_radius = {case.hub}"]
    lines += [f'stagger = "{case.stagger:g} deg"', f"modes = {plates.COUNT}", ""]
    path.write_text("\n".join(lines))
    return path


def _plate(case, folder):
    mesh = case.as_drawn()
    length, width = case.planform.sides
    if mesh is None:
        yield f"length = {length}"
        yield f"width = {width}"
    else:
        kind = "quad" if mesh.t.shape[0] == 4 else "triangle"
        points = np.column_stack([mesh.p.T, np.zeros(mesh.p.shape[1])])
        meshio.Mesh(points, [(kind, mesh.t.T)]).write(folder / "plate.vtu")
        yield 'mesh = "plate.vtu"'
    if case.tip is not None:
        kg, x, y = case.tip
        yield f"tip_mass = {kg}"
        yield f"tip_mass_at = [{x}, {y}]"
    if not case.profile:
        yield f"thickness = {case.thickness}"
        return
    table = np.zeros((2, 3))
    for i, j, c in case.profile:
        table[i, j] = c
    yield f"thickness = {{ polynomial = {table.tolist()} }}"
