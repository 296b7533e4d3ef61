"""Plates that spin: prestress, modes, and the reduced mass and stiffness at a damper's place.

    from fem import Effects, Material, Plate, Rotor, assemble, campbell, rectangle, solve_modes

    plate = Plate(rectangle(0.2, 0.08, 20, 8), 0.01, Material(182.6e9, 0.3, 7850.0))
    operators = assemble(plate, Rotor(), Effects(), theory="mindlin")
    solve_modes(operators, omega=1047.2).frequencies_hz          # one speed
    campbell(operators, np.linspace(0.0, 1832.6, 1000)).bounds   # a thousand, each with a bound on its error

Everything is in SI units, angular speeds in rad/s. The names below are imported when first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fem.accuracy.mesh_selection import Choice, choose_mesh
    from fem.accuracy.theory_selection import choose_theory
    from fem.assembly import Operators, assemble, with_cavity, with_coriolis, with_point_mass
    from fem.linalg import NotConverged, SingularMatrix
    from fem.meshes.mesh_sequence import Given, Rectangle
    from fem.meshes.planform import MeshError, PlaceError, rectangle
    from fem.meshes.read import read_mesh
    from fem.modes import Divergence, Modes, critical_speed, families, solve_modes
    from fem.output import displacement
    from fem.plate import ElasticRoot, Material, Plate
    from fem.reduction.modal import ModesAtPlace, modes_at
    from fem.reduction.single_mode import NoFlapMode, Reduced, Reduction, reduce_at, reduce_over
    from fem.rotor import Effects, Rotor
    from fem.statics import NoEquilibrium, Unresolved, equilibrium
    from fem.sweep.campbell import Campbell, Veering, campbell
    from fem.sweep.laws import LawViolation

_NAMES = {
    "fem.accuracy.mesh_selection": "Choice choose_mesh",
    "fem.accuracy.theory_selection": "choose_theory",
    "fem.assembly": "Operators assemble with_cavity with_coriolis with_point_mass",
    "fem.linalg": "NotConverged SingularMatrix",
    "fem.meshes.mesh_sequence": "Given Rectangle",
    "fem.meshes.planform": "MeshError PlaceError rectangle",
    "fem.meshes.read": "read_mesh",
    "fem.modes": "Divergence Modes critical_speed families solve_modes",
    "fem.output": "displacement",
    "fem.plate": "ElasticRoot Material Plate",
    "fem.reduction.modal": "ModesAtPlace modes_at",
    "fem.reduction.single_mode": "NoFlapMode Reduced Reduction reduce_at reduce_over",
    "fem.rotor": "Effects Rotor",
    "fem.statics": "NoEquilibrium Unresolved equilibrium",
    "fem.sweep.campbell": "Campbell Veering campbell",
    "fem.sweep.laws": "LawViolation",
}
"""What is offered, by the modules that have it."""

_HOMES = {name: module for module, names in _NAMES.items() for name in names.split()}

__all__ = [
    "Campbell",
    "Choice",
    "Divergence",
    "Effects",
    "ElasticRoot",
    "Given",
    "LawViolation",
    "Material",
    "MeshError",
    "Modes",
    "ModesAtPlace",
    "NoEquilibrium",
    "NoFlapMode",
    "NotConverged",
    "Operators",
    "PlaceError",
    "Plate",
    "Rectangle",
    "Reduced",
    "Reduction",
    "Rotor",
    "SingularMatrix",
    "Unresolved",
    "Veering",
    "assemble",
    "campbell",
    "choose_mesh",
    "choose_theory",
    "critical_speed",
    "displacement",
    "equilibrium",
    "families",
    "modes_at",
    "read_mesh",
    "rectangle",
    "reduce_at",
    "reduce_over",
    "solve_modes",
    "with_cavity",
    "with_coriolis",
    "with_point_mass",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'fem' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
