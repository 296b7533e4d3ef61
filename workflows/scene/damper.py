"""The tables of the damper: [damper], [release]."""

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, model_validator

from workflows.errors import BadInput
from workflows.formatting import exact_mm
from workflows.scene import materials
from workflows.scene import quantities as q
from workflows.scene.quantities import ROUNDING, Table, fault, wrong

if TYPE_CHECKING:
    from damper.contact import Solid

HEAVIEST = 10.0
"""Mass of all balls over the structure's up to which they damp it, and are not what is damped."""


_PAIRS, _EXAMPLE = 16, "[['0.1 m/s', 0.9], ['10 m/s', 0.5]]"


def _restitution(value: object, info: ValidationInfo) -> float | str | tuple[tuple[float, float], ...]:
    if value == "auto":
        return "auto"
    if isinstance(value, str):
        raise wrong(f"expected a number from 0 to 1, 'auto', or pairs such as {_EXAMPLE}")
    if not isinstance(value, list | tuple):
        return _share(value)
    if not 1 <= len(value) <= _PAIRS or not all(isinstance(each, list | tuple) and len(each) == 2 for each in value):
        raise wrong(f"expected up to {_PAIRS} pairs of an impact speed and a restitution, such as {_EXAMPLE}")
    pairs = tuple((q.si(q.SPEED, speed, info), _share(e)) for speed, e in value)
    if any(speed <= before for (before, _), (speed, _) in pairwise(((0.0, 0.0), *pairs))):
        raise wrong("expected impact speeds above 0, in ascending order")
    return pairs


def _share(value: object) -> float:
    number = q.plain_number(value)
    if not 0 <= number <= 1:
        raise wrong(f"expected at {'least 0' if number < 0 else 'most 1'}")
    return number


_ONE_OR_PAIRS = {
    "anyOf": [
        {"type": "number", "minimum": 0, "maximum": 1},
        {"const": "auto"},
        q.array_schema({"type": "array", "minItems": 2}, most=_PAIRS),
    ]
}

_SPEEDS_OF_HITS = 16
"""Pairs of impact speed and restitution that stand for the law of dents."""

_FASTEST = 1000.0
"""Impact speed over that of first yield from which on Johnson's power of it holds."""

_HITS = 10.0, 0.1
"""Impact speeds [m/s] between which those of blades lie."""

_HYSTERESIS = 1e-4
"""Lever of rolling friction over the ball's radius that the hysteresis of metals leaves, about."""

_UNNAMED = (
    "requires named materials of ball and floor, and a floor of known strength: expected ball_material and"
    " floor_material, or a number"
)


class Damper(Table):
    """Equal balls, each in a cavity of its own, moving in step.

    Its axes lie in the cavity's floor, which faces the spin axis: 1 through the plate's thickness (its z), along which
    it bends, and 2 across (its y).
    """

    at: q.Place | None = None
    """place (x, y) on the plate, in the plate's axes (those of a mesh file, where there is one); default: the middle of
    the tip. On a structure in space a place (x, y, z), a set of its nodes or a node's number"""
    direction: q.Direction | None = None
    """axis 1 of the cavity on a structure in space; default: the first mode's motion at the place; its component
    along the load is ignored"""
    normal: q.Direction | None = None
    """of the cavity's floor, outwards, on a structure in space at rest; default: the floor faces the load at each
    speed. On an inclined floor the load pulls the ball against a wall"""
    mass_ratio: Annotated[q.Number, q.Positive, Field(le=HEAVIEST)] | None = None
    """mass of all balls together over the effective mass M2, dimensionless"""
    mass: Annotated[q.Mass, q.Positive] | None = None
    """mass of all balls together"""
    ball_density: Annotated[q.Density, q.Positive] | None = None
    """density of each ball; the total mass is then count (4/3) π radius³ times this"""
    ball_material: Annotated[str, *q.name_of(materials.BALLS)] | None = None
    """name of a known material, instead of ball_density"""
    floor_material: Annotated[str, *q.name_of(materials.BALLS)] | None = None
    """a material whose strength is known, of the cavity's floor and walls; default: that of the plate, where it has a
    name"""
    count: Annotated[int, Field(ge=1, le=10**9)] = 1
    """number of balls: equal, each in a cavity of its own, moving in step"""
    radius: Annotated[q.Length, q.Positive]
    """radius of a ball, half its diameter"""
    cavity: q.Sides
    """sides in the damper's axes: 1 along the bending direction (through the thickness), 2 across; its depth along
    the load is the ball's diameter"""
    housing: Annotated[q.Mass, q.Positive] | None = None
    """mass of a housing that holds the cavity outside the plate, a point mass at the damper's place; without it the
    cavity must fit the plate"""
    restitution: Annotated[
        float | str | tuple[tuple[float, float], ...], BeforeValidator(_restitution), WithJsonSchema(_ONE_OR_PAIRS)
    ]
    """e of a wall hit, dimensionless; or pairs of impact speed and e, interpolated over the logarithm of the speed;
    'auto': from the strength of ball and floor"""
    friction: Annotated[q.Number, q.NotNegative, Field(le=1e6)]
    """μ of a wall hit, dimensionless"""
    rolling_friction: q.AutoLength
    """μ_r, a length; 'auto': elastic hysteresis of ball and floor"""
    floor_radius: q.Radii | None = None
    """of a hollow floor, a sphere's, or a pair along the damper's two axes; default: the floor is flat"""
    formulation: Literal["consistent", "printed"] = "consistent"
    """equations that satisfy Newton's third law, or those of the paper as printed"""
    damping_ratio: Annotated[q.Number, Field(ge=0, le=0.9)] = 0.0
    """ζ of the structure itself, dimensionless; at most 0.9"""
    sticking_ratio: Annotated[q.Number, Field(gt=0, lt=1)] = 1e-2
    """ε: a ball sticks to a wall below this fraction of the structure's velocity, dimensionless"""

    @model_validator(mode="before")
    @classmethod
    def _by_name(cls, data: Any) -> Any:
        return materials.with_numbers(data, "ball_material", materials.BALLS, ("ball_density",))

    @model_validator(mode="after")
    def _sense(self) -> Self:
        """One way of giving the mass, a ball that fits its cavity, and a rolling resistance that lets it roll."""
        ways = "mass_ratio, mass, ball_density and ball_material"
        q.check_one(self, ("mass_ratio", "mass", "ball_density"), ways, blamed=0)
        if self.ball_density is not None:
            materials.check_density("ball_density", self.ball_density)
            if materials.is_too_dense(self.ball_density):
                raise fault(
                    "ball_density", f"expected at most {materials.OSMIUM:g} kg/m^3, that of osmium, the densest solid"
                )
        for side in self.cavity:
            if side < 2 * self.radius * (1 - ROUNDING):
                ball, least = exact_mm(self.radius), exact_mm(2 * self.radius)
                raise fault("cavity", f"a ball of radius {ball} does not fit: expected sides of at least {least}")
        if self.floor_radius is not None:
            self._hollow(self.floor_radius)
        lever = self.rolling_friction
        if isinstance(lever, float) and lever < 0:
            raise fault("rolling_friction", "expected at least 0")
        if isinstance(lever, float) and lever > self.radius * (1 + ROUNDING):
            problem = f"expected a length, the coefficient times the ball's radius: at most {exact_mm(self.radius)}"
            raise fault("rolling_friction", problem)
        return self

    @property
    def on_plate(self) -> tuple[float, float] | None:
        """The place (x, y) on a plate; None for the middle of its tip."""
        return (self.at[0], self.at[1]) if isinstance(self.at, tuple) else None

    @property
    def cut(self) -> float:
        """Volume that all cavities together take out of the plate [m³]; none where they have a housing."""
        return 0.0 if self.housing else self.count * 2 * self.radius * self.cavity[0] * self.cavity[1]

    @property
    def weakens(self) -> float:
        """Stiffness that a cavity takes over that of as much material, at most.

        A round hole in shear takes 4 times its volume, one across it more.
        """
        sides = (2 * self.radius, *self.cavity)
        return 1 + 3 * max(sides) / min(sides)

    def density(self, mass: float) -> float:
        """Of each ball where all of them weigh so much [kg/m³]."""
        return mass / self.count / (4 / 3 * math.pi * self.radius**3)

    def fills(self, axis: int) -> bool:
        """Whether a ball fills its cavity along an axis, from 0: it cannot move so."""
        return self.cavity[axis] <= 2 * self.radius * (1 + 1e-9)

    @property
    def lossless(self) -> bool:
        """Whether a wall hit loses nothing."""
        return self.restitution == 1

    def hits(self, mass: float, made_of: "tuple[Solid, Solid] | None") -> dict[str, Any]:
        """The law of impact as `damper` takes it: restitution at low speeds, and pairs of impact speed and restitution.

        Args:
            mass: of a ball [kg].
            made_of: ball and floor; None where that is not known.

        Raises:
            BadInput: the law is to follow from materials that are not known.
        """
        pairs = self.restitution
        if isinstance(pairs, float):
            return {"restitution": pairs}
        if isinstance(pairs, str):
            from damper import contact

            onset = math.nan if made_of is None else contact.yield_speed(mass, self.radius, *made_of)
            if made_of is None or math.isnan(onset):
                raise BadInput(_UNNAMED, key="[damper] restitution", value="auto")
            most = math.sqrt(1 - contact.HYSTERESIS)
            speeds = (onset * np.geomspace(1.0, _FASTEST, _SPEEDS_OF_HITS)).tolist()
            pairs = tuple((v, min(most, contact.restitution(v, mass, self.radius, *made_of))) for v in speeds)
        return {"restitution": pairs[0][1], "restitution_by_speed": pairs}

    def uncertain(self, made_of: "tuple[Solid, Solid] | None") -> dict[str, tuple[float, float, str]]:
        """Between which ends, and by which law, those of its values are spread that are hardly ever known well.

        Rolling friction over two decades, since what it is made of (hysteresis, roughness, a dent) is hardly ever
        measured; restitution within ±0.2, which impact speed and material leave; friction ±30 %, the structure's
        damping a factor of 2 either way, the clearance along the bending direction within ±0.05 mm, or half of it. What
        follows from materials ('auto'): restitution as of hits at `_HITS`, rolling friction up to a hundred times what
        hysteresis alone leaves.
        """
        from damper import contact

        e, zeta, gap = self.restitution, self.damping_ratio, self.cavity[0] - 2 * self.radius
        ends = (max(e - 0.2, 0.0), min(e + 0.2, 1.0)) if isinstance(e, float) else None
        if e == "auto" and made_of is not None and self.balls is not None:
            hit = self.balls / self.count, self.radius, *made_of
            ends = (contact.restitution(_HITS[0], *hit), contact.restitution(_HITS[1], *hit))
        tolerance, lever = min(5e-5, gap / 2), self.rolling_friction
        least = lever / 10 if isinstance(lever, float) else _HYSTERESIS * self.radius
        return {
            **({} if ends is None else {"restitution": (*ends, "even")}),
            "friction": (0.7 * self.friction, 1.3 * self.friction, "even"),
            "damping_ratio": (zeta / 2, min(2 * zeta, 0.99), "log"),
            "clearance[0]": (gap - tolerance, gap + tolerance, "even"),
            "rolling_friction": (least, min(100 * least, self.radius), "log"),
        }

    def _hollow(self, floor: tuple[float, float]) -> None:
        """A hollow floor in which the ball finds room, and whose equations are not the paper's."""
        if self.formulation == "printed":
            raise fault("floor_radius", "the printed equations support a flat floor only: leave this out")
        for radius, side in zip(floor, self.cavity, strict=True):
            least = max(self.radius, side / 2)
            if radius <= least * (1 + ROUNDING):
                why = "half the cavity's side" if side / 2 > self.radius else "the ball's radius"
                raise fault("floor_radius", f"expected more than {why}, {least:g} m")

    @property
    def balls(self) -> float | None:
        """Mass of all balls together [kg]; None where it is a ratio."""
        if self.ball_density is None:
            return self.mass
        return self.count * 4 / 3 * math.pi * self.radius**3 * self.ball_density


class Release(Table):
    """Release of the displaced structure from rest."""

    displacement: q.LengthPair | None = None
    """at release, in the damper's axes: 1 along the bending direction, 2 across; without displacement,
    acceleration and ratio: along 1, by 1.5 times the amplitude above which the ball moves"""
    acceleration: q.LoadPair | None = None
    """of the structure at release, in the damper's axes"""
    ratio: Annotated[q.Number, q.Positive, Field(le=1e9)] | None = None
    """acceleration along the damper's axis 1 over the centrifugal load, dimensionless"""
    cycles: q.Cycles = "auto"
    """number of vibration cycles; auto: until the ball stays at rest"""

    @model_validator(mode="after")
    def _one(self) -> Self:
        """One way of giving the release at most, and one that sets something in motion."""
        present = [key for key in ("displacement", "acceleration", "ratio") if getattr(self, key) is not None]
        if len(present) > 1:
            raise fault(present[-1], "expected one of displacement, acceleration and ratio")
        pair = self.displacement if self.displacement is not None else self.acceleration
        if pair is not None and not any(pair):
            raise fault(present[0], "expected a release that is not zero on both axes")
        return self


_FOIL = 1e-5 * 1000.0
"""Mass per area [kg/m^2] of foil 0.01 mm thick, of density 1000 kg/m^3."""


_HOUSED = "housing = the mass of what protrudes from the plate"


def through_the_thickness(damper: Damper, thickness: float) -> tuple[str, str] | None:
    """Side 1 leaves a wall on either side of it."""
    if damper.housing or damper.cavity[0] < thickness * (1 - ROUNDING):
        return None
    side = "side 1 lies along the bending direction, through the plate's thickness"
    return "cavity", f"{side}: expected less than {exact_mm(thickness)}, or {_HOUSED}"


def in_the_plane(damper: Damper, reach: float, room: float) -> tuple[str, str] | None:
    """Ball and side 2 lie in the plate: `reach` is from the root to the damper's place, `room` the width there.

    The width counts as far as it lies on both sides of the place alike.
    """
    if 2 * damper.radius >= reach * (1 - ROUNDING):
        most = exact_mm(reach / 2)
        return "radius", f"the ball does not fit between the root and its place: expected less than {most}"
    if damper.housing or damper.cavity[1] < room * (1 - ROUNDING):
        return None
    if room <= ROUNDING * reach:
        problem = "on the plate's edge there is no room for a cavity"
        return "at", f"{problem}: expected a place further in, or {_HOUSED}"
    smaller = f"expected less than {exact_mm(room)}, the room at its place, another place (at)"
    return "cavity", f"side 2 lies across the plate: {smaller}, or {_HOUSED}"


def cavities_abreast(damper: Damper, thickness: float, width: float) -> int:
    """How many cavities, wall to wall, lie side by side in a section of the plate; at least one."""
    layers, across = int(thickness / damper.cavity[0] + ROUNDING), int(width / damper.cavity[1] + ROUNDING)
    return max(layers, 1) * max(across, 1)


def side_by_side(damper: Damper, thickness: float, width: float, reach: float) -> tuple[str, str] | None:
    """The cavities of all balls lie between the root and the damper's place, in as many rows as it takes."""
    most = cavities_abreast(damper, thickness, width) * int(reach / (2 * damper.radius) + ROUNDING)
    if damper.housing or damper.count <= most:
        return None
    room = f"the plate has room for {most} cavities of this size between its root and the damper's place"
    return "count", f"{room}: expected no more, or {_HOUSED}"


def housing_too_light(damper: Damper) -> tuple[str, str] | None:
    """No housing weighs less than foil over the two open faces of each cavity, as light as plastic."""
    faces = 2 * 2 * damper.radius * damper.cavity[1] * damper.count
    least = _FOIL * faces
    if damper.housing is None or damper.housing >= least:
        return None
    return "housing", f"lighter than 0.01 mm of plastic foil over the open faces: expected at least {1e3 * least:.2g} g"


def misfit(damper: Damper, thickness: float, width: float, reach: float, room: float) -> tuple[str, str] | None:
    """The first misfit of a damper in a plate; see `in_the_plane` for `reach` and `room`."""
    return (
        through_the_thickness(damper, thickness)
        or in_the_plane(damper, reach, room)
        or side_by_side(damper, thickness, width, reach)
        or housing_too_light(damper)
    )
