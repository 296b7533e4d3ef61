"""Reference plates that must come out right before a machine's first figures of plates are published.

A narrow plate that does not contract sideways (nu = 0) is a uniform beam. Turning without a hub it has, out of the
plane of rotation, the flap frequencies of Wright, Smith, Thresher and Wang (J. Appl. Mech. 49 (1982) 197); in that
plane, where spin softening acts, their squares are less by that of the speed, exactly. A thin square plate at rest has
the converged frequencies below; Barton's (J. Appl. Mech. 18 (1951) 129), 3.492, 8.525 and 21.43, are upper bounds.
The beam at rest, reduced at its tip, has the closed forms of Euler and Bernoulli.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from fem.assembly import assemble
from fem.linalg import Array
from fem.meshes.planform import rectangle
from fem.plate import Material, Plate
from fem.reduction.single_mode import reduce_over
from fem.rotor import Effects, Rotor
from fem.sweep.campbell import campbell
from fem.sweep.laws import LawViolation

BEAM = {0.0: (3.5160, 22.0345), 2.0: (4.1373, 22.6149), 10.0: (11.2023, 33.6404)}
"""Flap frequencies by gamma = Omega sqrt(rho A L⁴ / E I), both in the unit sqrt(E I / rho A L⁴); at rest the roots of
cos sqrt(x) cosh sqrt(x) = -1."""

SQUARE = (3.471, 8.507, 21.285)
"""Of a clamped square plate, nu = 0.3, in the unit sqrt(D / rho h a⁴)."""

TABLES, SOFTENED, MESH = 2e-5, 2e-6, 5e-4
"""Most relative errors: of the tables' last digits; of the softening in a beam a fiftieth as wide as long; of 8 x 8
cells."""

TIP = {"effective mass": 0.25, "slope": 1.376505485, "frequency with the ball": 3.208291983}
"""Of the beam at rest, reduced at its tip: M2 / rho A L; L w' / w; and x² for a ball of mu rho A L, where
1 + cos x cosh x + mu x (cos x sinh x - sin x cosh x) = 0."""

BALL = 0.05
"""mu."""

SHEARED = 2e-4
"""Most relative error of the slope, which Mindlin's plates of this thickness have by their shear."""

_THEORIES = ("kirchhoff", "mindlin")
_THICKNESS, _MODULUS, _DENSITY = 1e-3, 2e11, 7850.0


class Line(NamedTuple):
    """A figure as computed here and as it should be, without dimension, and the relative error that it may have."""

    name: str
    value: float
    reference: float
    allowed: float

    @property
    def error(self) -> float:
        """Relative."""
        return abs(self.value / self.reference - 1.0)


def lines() -> Iterator[Line]:
    """All figures, by both theories of plates."""
    beam = Plate(rectangle(1.0, 0.02, 16, 1), _THICKNESS, Material(_MODULUS, 0.0, _DENSITY))
    square = Plate(rectangle(1.0, 1.0, 8, 8), _THICKNESS, Material(_MODULUS, 0.3, _DENSITY))
    gammas = np.array(list(BEAM))
    for theory in _THEORIES:
        flap, softened = (_frequencies(beam, theory, gammas, stagger)[:, :2] for stagger in (0.0, 0.5 * math.pi))
        for n, gamma in enumerate(gammas):
            where = f"{theory}: beam at gamma = {gamma:g}"
            for k, reference in enumerate(BEAM[float(gamma)]):
                yield Line(f"{where}, flap {k + 1}", float(flap[n, k]), reference, TABLES)
            less = math.sqrt(flap[n, 0] ** 2 - gamma**2)
            yield Line(f"{where}, flap 1 in the plane", float(softened[n, 0]), less, SOFTENED)
        tip = _at_the_tip(beam, theory)
        for name, reference in TIP.items():
            allowed = SHEARED if name == "slope" else SOFTENED
            yield Line(f"{theory}: beam at rest, {name} at its tip", tip[name], reference, allowed)
        frequencies = _frequencies(square, theory, np.zeros(1), 0.0)[0]
        for k, reference in enumerate(SQUARE):
            yield Line(f"{theory}: square plate, mode {k + 1}", float(frequencies[k]), reference, MESH)


def check() -> None:
    """Check the reference plates.

    Raises:
        LawViolation: a figure differs from its reference.
    """
    for line in lines():
        if not line.error <= line.allowed:
            raise LawViolation(
                f"'{line.name}' is {line.reference:.6g}, but {line.value:.6g} came out, an error of"
                f" {line.error:.2g} beyond the bound of {line.allowed:g}, in the self-check of plates"
            )


def _frequencies(plate: Plate, theory: str, gammas: Array, stagger: float) -> Array:
    """Lowest frequencies (k, 4) without dimension."""
    material = plate.material
    rigidity = _MODULUS * _THICKNESS**2 / (12.0 * (1.0 - material.poissons_ratio**2))
    unit = math.sqrt(rigidity / _DENSITY)
    diagram = campbell(assemble(plate, Rotor(stagger=stagger), Effects(), theory), gammas * unit, 4)
    return np.asarray(2.0 * np.pi * diagram.frequencies_hz / unit)


def _at_the_tip(beam: Plate, theory: str) -> dict[str, float]:
    """The figures of `TIP`."""
    unit = math.sqrt(_MODULUS * _THICKNESS**2 / (12.0 * _DENSITY))
    operators = assemble(beam, Rotor(), Effects(), theory)
    mass = _DENSITY * _THICKNESS * float(np.ptp(beam.mesh.p[1]))
    (reduced,) = reduce_over(operators, campbell(operators, np.zeros(1), 4), (1.0, 0.0), ball_mass=BALL * mass)
    values = reduced.M2 / mass, reduced.slope, 2.0 * np.pi * reduced.f1_hz / unit
    return dict(zip(TIP, map(float, values), strict=True))
