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
    from fem.accuracy.choose_mesh import Choice, choose_mesh
    from fem.accuracy.choose_theory import choose_theory
    from fem.accuracy.two_meshes import estimate_error
    from fem.linalg.lanczos import NotConverged, SingularMatrix
    from fem.meshes.ladder import Given, Rectangle
    from fem.meshes.locate import PlaceError
    from fem.meshes.planform import MeshError, rectangle
    from fem.meshes.read import read_mesh
    from fem.modes.critical_speed import critical_speed
    from fem.modes.family import families
    from fem.modes.real import Divergence, Modes
    from fem.modes.solve import solve_modes
    from fem.operators.assembly import Operators, assemble, with_coriolis, with_point_mass
    from fem.operators.at_vertices import displacement
    from fem.plate.given import Material, Plate
    from fem.plate.root import ElasticRoot
    from fem.plate.rotor import Effects, Rotor
    from fem.reduction.at_a_place import ModesAtPlace, modes_at
    from fem.reduction.at_one_speed import NoFlapMode, Reduced, reduce_at
    from fem.reduction.over_speeds import Reduction, reduce_over
    from fem.statics.large_deflection import NoEquilibrium, equilibrium
    from fem.statics.rest import Unresolved
    from fem.sweep.diagram import Campbell, campbell
    from fem.sweep.laws import LawViolation
    from fem.sweep.tracking import Veering

_HOMES = {
    "Campbell": "fem.sweep.diagram",
    "Choice": "fem.accuracy.choose_mesh",
    "Divergence": "fem.modes.real",
    "Effects": "fem.plate.rotor",
    "ElasticRoot": "fem.plate.root",
    "Given": "fem.meshes.ladder",
    "LawViolation": "fem.sweep.laws",
    "Material": "fem.plate.given",
    "MeshError": "fem.meshes.planform",
    "Modes": "fem.modes.real",
    "ModesAtPlace": "fem.reduction.at_a_place",
    "NoEquilibrium": "fem.statics.large_deflection",
    "NoFlapMode": "fem.reduction.at_one_speed",
    "NotConverged": "fem.linalg.lanczos",
    "Operators": "fem.operators.assembly",
    "PlaceError": "fem.meshes.locate",
    "Plate": "fem.plate.given",
    "Rectangle": "fem.meshes.ladder",
    "Reduced": "fem.reduction.at_one_speed",
    "Reduction": "fem.reduction.over_speeds",
    "Rotor": "fem.plate.rotor",
    "SingularMatrix": "fem.linalg.lanczos",
    "Unresolved": "fem.statics.rest",
    "Veering": "fem.sweep.tracking",
    "assemble": "fem.operators.assembly",
    "campbell": "fem.sweep.diagram",
    "choose_mesh": "fem.accuracy.choose_mesh",
    "choose_theory": "fem.accuracy.choose_theory",
    "critical_speed": "fem.modes.critical_speed",
    "displacement": "fem.operators.at_vertices",
    "equilibrium": "fem.statics.large_deflection",
    "estimate_error": "fem.accuracy.two_meshes",
    "families": "fem.modes.family",
    "modes_at": "fem.reduction.at_a_place",
    "read_mesh": "fem.meshes.read",
    "rectangle": "fem.meshes.planform",
    "reduce_at": "fem.reduction.at_one_speed",
    "reduce_over": "fem.reduction.over_speeds",
    "solve_modes": "fem.modes.solve",
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
