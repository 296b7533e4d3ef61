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
    from fem.accuracy.error_estimates import estimate_error
    from fem.accuracy.mesh_selection import Choice, choose_mesh
    from fem.accuracy.theory_selection import choose_theory
    from fem.linalg import NotConverged, SingularMatrix
    from fem.meshes.mesh_sequence import Given, Rectangle
    from fem.meshes.planform import MeshError, PlaceError, rectangle
    from fem.meshes.read import read_mesh
    from fem.modes.gyroscopic import critical_speed
    from fem.modes.real import Divergence, Modes, families
    from fem.modes.solve import solve_modes
    from fem.operators.assembly import Operators, assemble, with_cavity, with_coriolis, with_point_mass
    from fem.output import displacement
    from fem.plate import ElasticRoot, Material, Plate
    from fem.reduction.modal import ModesAtPlace, modes_at
    from fem.reduction.single_mode import NoFlapMode, Reduced, Reduction, reduce_at, reduce_over
    from fem.rotor import Effects, Rotor
    from fem.statics import NoEquilibrium, Unresolved, equilibrium
    from fem.sweep.campbell import Campbell, Veering, campbell
    from fem.sweep.laws import LawViolation

_HOMES = {
    "Campbell": "fem.sweep.campbell",
    "Choice": "fem.accuracy.mesh_selection",
    "Divergence": "fem.modes.real",
    "Effects": "fem.rotor",
    "ElasticRoot": "fem.plate",
    "Given": "fem.meshes.mesh_sequence",
    "LawViolation": "fem.sweep.laws",
    "Material": "fem.plate",
    "MeshError": "fem.meshes.planform",
    "Modes": "fem.modes.real",
    "ModesAtPlace": "fem.reduction.modal",
    "NoEquilibrium": "fem.statics",
    "NoFlapMode": "fem.reduction.single_mode",
    "NotConverged": "fem.linalg",
    "Operators": "fem.operators.assembly",
    "PlaceError": "fem.meshes.planform",
    "Plate": "fem.plate",
    "Rectangle": "fem.meshes.mesh_sequence",
    "Reduced": "fem.reduction.single_mode",
    "Reduction": "fem.reduction.single_mode",
    "Rotor": "fem.rotor",
    "SingularMatrix": "fem.linalg",
    "Unresolved": "fem.statics",
    "Veering": "fem.sweep.campbell",
    "assemble": "fem.operators.assembly",
    "campbell": "fem.sweep.campbell",
    "choose_mesh": "fem.accuracy.mesh_selection",
    "choose_theory": "fem.accuracy.theory_selection",
    "critical_speed": "fem.modes.gyroscopic",
    "displacement": "fem.output",
    "equilibrium": "fem.statics",
    "estimate_error": "fem.accuracy.error_estimates",
    "families": "fem.modes.real",
    "modes_at": "fem.reduction.modal",
    "read_mesh": "fem.meshes.read",
    "rectangle": "fem.meshes.planform",
    "reduce_at": "fem.reduction.single_mode",
    "reduce_over": "fem.reduction.single_mode",
    "solve_modes": "fem.modes.solve",
    "with_cavity": "fem.operators.assembly",
    "with_coriolis": "fem.operators.assembly",
    "with_point_mass": "fem.operators.assembly",
}

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
    "estimate_error",
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
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
