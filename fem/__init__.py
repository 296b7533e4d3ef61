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
    from fem.accuracy import estimate_error
    from fem.choice import Choice, choose_mesh
    from fem.choosing import choose_theory
    from fem.critical import critical_speed
    from fem.display import displacement
    from fem.family import families
    from fem.levels import Given, Rectangle
    from fem.locate import PlaceError
    from fem.meshfile import read_mesh
    from fem.modes import Divergence, Modes, Unresolved, solve_modes
    from fem.operators import Operators, assemble, with_coriolis, with_point_mass
    from fem.planform import MeshError, rectangle
    from fem.plate import Material, Plate
    from fem.reduction import NoFlapMode, Reduced, reduce_at
    from fem.reduction_sweep import reduce_over
    from fem.root import ElasticRoot
    from fem.rotor import Effects, Rotor
    from fem.solver import NotConverged, SingularMatrix
    from fem.statics import NoEquilibrium, equilibrium
    from fem.sweep import Campbell, campbell
    from fem.tracking import Veering

_HOMES = {
    "Campbell": "fem.sweep",
    "Choice": "fem.choice",
    "Divergence": "fem.modes",
    "Effects": "fem.rotor",
    "ElasticRoot": "fem.root",
    "Given": "fem.levels",
    "Material": "fem.plate",
    "MeshError": "fem.planform",
    "Modes": "fem.modes",
    "NoEquilibrium": "fem.statics",
    "NoFlapMode": "fem.reduction",
    "NotConverged": "fem.solver",
    "Operators": "fem.operators",
    "PlaceError": "fem.locate",
    "Plate": "fem.plate",
    "Rectangle": "fem.levels",
    "Reduced": "fem.reduction",
    "Rotor": "fem.rotor",
    "SingularMatrix": "fem.solver",
    "Unresolved": "fem.modes",
    "Veering": "fem.tracking",
    "assemble": "fem.operators",
    "campbell": "fem.sweep",
    "choose_mesh": "fem.choice",
    "choose_theory": "fem.choosing",
    "critical_speed": "fem.critical",
    "displacement": "fem.display",
    "equilibrium": "fem.statics",
    "estimate_error": "fem.accuracy",
    "families": "fem.family",
    "read_mesh": "fem.meshfile",
    "rectangle": "fem.planform",
    "reduce_at": "fem.reduction",
    "reduce_over": "fem.reduction_sweep",
    "solve_modes": "fem.modes",
    "with_coriolis": "fem.operators",
    "with_point_mass": "fem.operators",
}

__all__ = [
    "Campbell",
    "Choice",
    "Divergence",
    "Effects",
    "ElasticRoot",
    "Given",
    "Material",
    "MeshError",
    "Modes",
    "NoEquilibrium",
    "NoFlapMode",
    "NotConverged",
    "Operators",
    "PlaceError",
    "Plate",
    "Rectangle",
    "Reduced",
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
