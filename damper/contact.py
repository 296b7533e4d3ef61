"""Contact of a ball with its floor and walls: Hertz's pressure, first yield, dents, hits.

Formulas from Johnson, Contact Mechanics (1985): Hertz, eqs. 4.22 to 4.24; first yield at a peak pressure of 1.60 Y (von
Mises, Poisson's ratio 0.3), eqs. 6.8 and 6.9; full plasticity where the mean pressure reaches the hardness, section
6.3; hits, sections 11.4 and 11.5; rolling by elastic hysteresis, section 9.1.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from damper.model import number

ONSET = 1.60
"""Peak pressure over the yield strength at first yield."""

HYSTERESIS = 0.016
"""Share of the elastic work lost in a cycle: the geometric mean of 0.005 and 0.05, between which metals are."""


@dataclass(frozen=True)
class Solid:
    """What presses on what.

    Attributes:
        youngs_modulus: [Pa].
        poissons_ratio: [-].
        yield_strength: in tension, Y [Pa]; nan where it is not known.
        hardness: mean pressure under an indenter at which the solid flows, H [Pa]; nan where it is not known.
    """

    youngs_modulus: float
    poissons_ratio: float
    yield_strength: float = math.nan
    hardness: float = math.nan

    def __post_init__(self) -> None:
        """Refuse what has no physical sense."""
        if not 0 < number("youngs_modulus", self.youngs_modulus) < math.inf:
            raise ValueError(f"youngs_modulus must be positive, got {self.youngs_modulus:g}")
        if not -1 < number("poissons_ratio", self.poissons_ratio) < 0.5:
            raise ValueError(f"poissons_ratio must be between -1 and 0.5, got {self.poissons_ratio:g}")
        for name in ("yield_strength", "hardness"):
            if number(name, getattr(self, name)) <= 0:
                raise ValueError(f"{name} must be positive, got {getattr(self, name):g}")


@dataclass(frozen=True)
class Contact:
    """A ball under a load on its floor; what the strength of the weaker solid decides is nan where it is not known.

    It is not known either where that of the floor is not, and the ball bears the load: floors are the softer, mostly.

    Attributes:
        hertz_radius: of the contact, were it elastic [m].
        peak_pressure: at its middle [Pa].
        yield_ratio: the load over that of first yield [-].
        hardness_ratio: the elastic mean pressure over the hardness [-]; from 1 on the contact flows.
        dent_radius: at most, sqrt(N / pi H) [m]; 0 below first yield.
        dent_depth: at most, dent_radius² / 2r [m].
        dent_slope: of its rim, at most: what a ball climbs to leave it, dent_radius / r [-].
    """

    hertz_radius: float
    peak_pressure: float
    yield_ratio: float
    hardness_ratio: float
    dent_radius: float
    dent_depth: float
    dent_slope: float


def modulus(one: Solid, other: Solid) -> float:
    """E* of two solids, 1/E* = (1 - nu1²)/E1 + (1 - nu2²)/E2 [Pa]."""
    return 1 / sum((1 - each.poissons_ratio**2) / each.youngs_modulus for each in (one, other))


def _strengths(one: Solid, other: Solid) -> tuple[float, float]:
    """The least that is known of yield strength and hardness of two solids [Pa]."""
    first, second = (
        min((v for each in (one, other) if not math.isnan(v := getattr(each, name))), default=math.nan)
        for name in ("yield_strength", "hardness")
    )
    return first, second


def resting(load: float, radius: float, ball: Solid, floor: Solid, floor_radius: float = math.inf) -> Contact:
    """The contact of a ball that a load presses on its floor.

    Args:
        load: N [N].
        radius: of the ball, r [m].
        ball: its material.
        floor: that of the floor.
        floor_radius: of a hollow floor [m]; inf: flat.

    Raises:
        ValueError: the load is negative, or the ball does not fit the floor.
    """
    if not 0 <= number("load", load) < math.inf:
        raise ValueError(f"load must be at least 0 and finite, got {load:g}")
    if not 0 < number("radius", radius) < floor_radius:
        raise ValueError(f"radius must be positive and less than that of the floor, got {radius:g}")
    relative = 1 / (1 / radius - 1 / floor_radius)
    stiff = modulus(ball, floor)
    strength, hardness = _strengths(ball, floor)
    a = (3 * load * relative / (4 * stiff)) ** (1 / 3)
    peak = 2 * a * stiff / (math.pi * relative)
    yields, flows = (peak / (ONSET * strength)) ** 3, 2 / 3 * peak / hardness
    yields = math.nan if math.isnan(floor.yield_strength) and yields <= 1 else yields
    flows = math.nan if math.isnan(floor.hardness) and flows < 1 else flows
    dent = 0.0 if yields <= 1 else math.nan if math.isnan(flows) else math.sqrt(load / (math.pi * hardness))
    return Contact(a, peak, yields, flows, dent, dent**2 / (2 * radius), dent / radius)


def rim_slope(load: float, radius: float, ball: Solid, floor: Solid, floor_radius: float = math.inf) -> float:
    """Slope of the dent's rim when the elastic part has gone with the ball: what a ball climbs before it rolls away.

    The contact of radius a and mean pressure p closes again elastically, so that the hollow has the curvature 1/r less
    that of Hertz's contact of the same a and load: its rim slopes by a/r - (3 pi / 4) p / E*.

    Args:
        load: N [N].
        radius: of the ball, r [m].
        ball: its material.
        floor: that of the floor.
        floor_radius: of a hollow floor [m]; inf: flat.

    Returns:
        The slope [-]: 0 below first yield, nan where yield strength or hardness is not known.
    """
    contact = resting(load, radius, ball, floor, floor_radius)
    strength, hardness = _strengths(ball, floor)
    if math.isnan(strength + hardness + contact.dent_radius):
        return math.nan
    if contact.yield_ratio <= 1:
        return 0.0
    most = _most(hardness / strength)
    c = _grown(lambda c: c**2 * _pressure(c, most), contact.yield_ratio)
    return math.pi / 2 * ONSET * strength / modulus(ball, floor) * max(c - _pressure(c, most), 0.0)


_PLASTIC = 40 / (math.pi / 2 * ONSET)
"""Contact radius over that at first yield from which on a contact is fully plastic: E* a / Y r = 40."""


def _most(hardness_ratio: float) -> float:
    """Mean pressure of full plasticity over that at first yield, by the hardness over the yield strength.

    The pressure grows no faster than that of an elastic contact, which goes with the radius: a metal whose hardness is
    more than 4 times its yield strength, as that of annealed stainless steel, counts as one of 4 times.
    """
    return min(max(hardness_ratio / (2 / 3 * ONSET), 1.0), 1 + math.log(_PLASTIC))


def _pressure(c: float, most: float) -> float:
    """Mean pressure over that at first yield, by the contact radius over that at first yield.

    It grows from 1.07 Y to the hardness with the logarithm of the radius (Johnson, Fig. 6.16).
    """
    return 1 + (most - 1) * min(math.log(c) / math.log(_PLASTIC), 1.0)


def _grown(reached: Callable[[float], float], value: float) -> float:
    """Contact radius over that at first yield at which something that grows faster than it does reaches a value."""
    low, high = 0.0, math.log(max(value, 1.0))
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if reached(math.exp(middle)) < value else (low, middle)
    return math.exp(low)


def yield_speed(mass: float, radius: float, ball: Solid, wall: Solid) -> float:
    """Speed of a hit on a flat wall from which on the contact yields [m/s]; nan where the wall's strength is not known.

    (1/2) m v² = (2/5) N_y d_y: Hertz's work up to first yield, with the load N_y and the approach d_y there.

    Args:
        mass: of the ball [kg].
        radius: of the ball [m].
        ball: its material.
        wall: that of the wall.
    """
    stiff = modulus(ball, wall)
    peak = ONSET * (_strengths(ball, wall)[0] if wall.yield_strength > 0 else math.nan)
    a = math.pi * radius * peak / (2 * stiff)
    load, approach = 2 / 3 * peak * math.pi * a**2, a**2 / radius
    return math.sqrt(0.8 * load * approach / mass)


def restitution(speed: float, mass: float, radius: float, ball: Solid, wall: Solid) -> float:
    """Ratio of the normal speeds after and before a hit on a flat wall [-]; nan where its strength is not known.

    1 up to the speed of first yield. Beyond, the pressure grows as under a resting ball: where contact radius and mean
    pressure are c and q times those at first yield, the elastic work is q² c³ times that up to there, and the pressure
    has spent (5/8) of the integral of q d(c⁴ - q c³) on the volume that does not spring back. The elastic part returns.
    A fully plastic hit returns Johnson's power of the speed, -1/4 (eq. 11.47).

    Args:
        speed: of the hit [m/s].
        mass: of the ball [kg].
        radius: of the ball [m].
        ball: its material.
        wall: that of the wall; a hardness that is not known is 2.8 times the yield strength (Tabor).
    """
    strength, hardness = _strengths(ball, wall)
    faster = speed / yield_speed(mass, radius, ball, wall)
    if math.isnan(faster):
        return math.nan
    most = _most(2.8 if math.isnan(hardness) else hardness / strength)
    elastic, plastic = _works(_grown(lambda c: sum(_works(c, most)), faster**2), most)
    return math.sqrt(elastic / (elastic + plastic))


def _works(c: float, most: float) -> tuple[float, float]:
    """Elastic work and that of denting over the work up to first yield, by the contact radius over that there."""
    q, s = _pressure(c, most), min(c, _PLASTIC)
    at, grows = _pressure(s, most), (most - 1) / math.log(_PLASTIC)
    dented = at * s**3 * (s - at) - grows * ((s**4 - 1) / 4 - (at * s**3 - 1) / 3 + grows * (s**3 - 1) / 9)
    dented += q * (c**3 * (c - q) - s**3 * (s - at))
    return q**2 * c**3, 0.625 * dented


def hit_time(speed: float, mass: float, radius: float, ball: Solid, wall: Solid) -> float:
    """How long an elastic hit on a flat wall lasts, 2.94 d/v with the greatest approach d [s]; eq. 11.24.

    Args:
        speed: of the hit [m/s].
        mass: of the ball [kg].
        radius: of the ball [m].
        ball: its material.
        wall: that of the wall.
    """
    stiff = modulus(ball, wall)
    approach = math.pow(15 * mass * speed**2 / (16 * math.sqrt(radius) * stiff), 0.4)
    return 2.94 * approach / speed


def rolling_lever(contact: Contact) -> float:
    """Lever of rolling resistance by elastic hysteresis, (3/16) alpha a [m]."""
    return 3 / 16 * HYSTERESIS * contact.hertz_radius
