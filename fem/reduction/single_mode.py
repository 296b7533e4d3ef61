"""The plate as one mass on one spring at the damper's place, with the ball in flight and with it stuck.

phi is the fundamental flap mode scaled to 1 at the damper, along the axis 1 of a floor that faces the load. Ball in
flight: M2 = phi' M phi and K2 = omega_2² M2. Ball stuck: a point mass that has inertia, pulls on the plate and softens
like all mass; omega_1 is the frequency of that plate, M1 = M2 + m_p and K1 = omega_1² M1. `reduce_at` reduces at one
speed, `reduce_over` at all speeds of a diagram.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array

from fem.assembly import AtPlace, Operators, with_point_mass
from fem.linalg import Array, SingularMatrix, factorise, lanczos, most_alike, refine, rounding
from fem.meshes.planform import PlaceError, position
from fem.modes import Divergence, Modes, bending_strains, families, lowest, solve_real
from fem.statics import linearise
from fem.sweep.campbell import Campbell, without_coriolis
from fem.sweep.laws import EXACT, check_reduced, require

SEARCHED = 4
"""Modes looked through for the fundamental flap mode when none are given."""


class NoFlapMode(ValueError):
    """None of the modes looked through bends the plate along its length."""


@dataclass(frozen=True)
class Reduced:
    """Reduced parameters at a place on the plate, SI units.

    f1_hz, M1, K1 with the ball stuck; f2_hz, M2, K2 without.

    Attributes:
        ball_mass: m_p.
        mode_index: which of the plate's modes, from 0.
        slope: of a floor that faces the load, per unit of the place's motion along its axis 1, 1/m: phi_x on the
            plate's centre line, without precone.
        floor_tilt: Omega² r slope / omega_1², where Omega² r is the load: how much of the inertia drive a cavity floor
            that tilts with the plate would cancel; the reduced model leaves it out.
        pull: what the load of 1 kg at the place adds to K, over Omega² [-].
    """

    f1_hz: float
    M1: float
    K1: float
    f2_hz: float
    M2: float
    K2: float
    ball_mass: float
    mode_index: int
    slope: float
    floor_tilt: float
    pull: float = 0.0


def reduce_at(
    operators: Operators,
    omega: float,
    at: tuple[float, float],
    *,
    ball_mass: float | None = None,
    mass_ratio: float | None = None,
    modes: Modes | None = None,
) -> Reduced:
    """Reduced mass and stiffness of the flap mode at a place, at one speed.

    phi is real: Coriolis forces are left out.

    Args:
        operators: of the plate.
        omega: speed [rad/s].
        at: place (x, y) [m].
        ball_mass: m_p [kg]; or
        mass_ratio: m_p / M2 [-].
        modes: the plate's at this speed, if known.

    Raises:
        ValueError: unless exactly one of ball_mass and mass_ratio is given and not negative.
        NoFlapMode: none is among the modes.
        PlaceError: the mode does not move at the place, or it is off the plate.
        Divergence: past the critical speed.
    """
    check_mass(ball_mass, mass_ratio)
    if modes is not None and modes.omega != omega:
        raise ValueError(f"the modes belong to {modes.omega!r} rad/s, not to {omega!r}")
    if modes is None or np.iscomplexobj(modes.shapes):
        modes = searched(operators, omega, None if modes is None else modes.state)
    index = flap_index(families(operators, modes))
    place = operators.at_place(at)
    shape = modes.shapes[:, index]
    (mode,) = flap_modes(place, place.flap @ shape[:, None])
    mass = mode.mass * mass_ratio if mass_ratio is not None else float(ball_mass or 0.0)
    free = float(modes.eigenvalues[index])
    stuck = _stuck(place, modes, index, mass) if mass > 0.0 else free
    return reduced(omega**2 * operators.radius(*at), index, mode, mass, free, stuck, mode.mass * place.pull(shape))


def searched(operators: Operators, omega: float, start: Array | None = None) -> Modes:
    """Real modes enough to find the flap mode among; start: the state at this or a neighbouring speed, if known."""
    still, state = linearise(operators, omega, start)
    return solve_real(operators, omega, still, SEARCHED, state)


def check_mass(ball_mass: float | None, mass_ratio: float | None) -> None:
    """Raise ValueError unless exactly one is given, finite and not negative."""
    masses = [value for value in (ball_mass, mass_ratio) if value is not None]
    if len(masses) != 1 or not 0.0 <= masses[0] < np.inf:
        raise ValueError(
            f"give either ball_mass or mass_ratio, zero or more and finite, got {ball_mass!r} and {mass_ratio!r}"
        )


@dataclass(frozen=True)
class FlapMode:
    """A flap mode scaled to 1 along a floor's axis 1 at a place: its modal mass in kg and the floor's slope in 1/m."""

    mass: float
    slope: float


def flap_modes(place: AtPlace, motions: Array) -> list[FlapMode]:
    """Scale mass-normalised flap modes of which the motion along the floor's axis 1 and its slope (2, k) are known.

    Raises:
        PlaceError: where one of them does not move.
    """
    if np.abs(motions[0]).min() * np.sqrt(place.operators.mass.sum()) < 1e-6:
        raise PlaceError(f"the fundamental flap mode does not move at {position(place.at)} m")
    return [FlapMode(float(lift**-2), float(slope / lift)) for lift, slope in motions.T]


def reduced(
    load: float, index: int, mode: FlapMode, ball_mass: float, free: float, stuck: float, pull: float
) -> Reduced:
    """The reduced parameters from the frequencies without the ball and with it stuck.

    Args:
        load: centrifugal acceleration at the place [m/s²].
        index: number of the mode.
        mode: at the place.
        ball_mass: [kg].
        free: squared circular frequency without the ball [rad²/s²].
        stuck: squared circular frequency with it [rad²/s²].
        pull: see `Reduced`.

    Raises:
        LawViolation: they do not belong together.
    """
    system = Reduced(
        f1_hz=float(np.sqrt(stuck) / (2 * np.pi)),
        M1=mode.mass + ball_mass,
        K1=stuck * (mode.mass + ball_mass),
        f2_hz=float(np.sqrt(free) / (2 * np.pi)),
        M2=mode.mass,
        K2=free * mode.mass,
        ball_mass=ball_mass,
        mode_index=index,
        slope=mode.slope,
        floor_tilt=load * mode.slope / stuck,
        pull=pull,
    )
    check_reduced(system)
    return system


def flap_index(names: list[str]) -> int:
    """Find the lowest flap mode among families.

    Raises:
        NoFlapMode: when there is none.
    """
    if "flap" not in names:
        raise NoFlapMode(f"no flap mode among the {len(names)} lowest: {', '.join(names)}")
    return names.index("flap")


def _stuck(place: AtPlace, modes: Modes, index: int, mass: float) -> float:
    """Squared frequency of the mode that the flap mode becomes when a mass sticks to the plate."""
    heavy = with_point_mass(place.operators, place.at, mass)
    stiffness, _ = linearise(heavy, modes.omega, modes.state)
    value, _ = become(place, modes.omega, (stiffness, heavy.mass), modes.shapes, index)
    return value


def become(
    place: AtPlace, omega: float, stuck: tuple[csc_array, csc_array], shapes: Array, index: int
) -> tuple[float, Array]:
    """Follow one of a plate's shapes when a mass sticks to it at a place.

    Args:
        place: on the plate without the mass.
        omega: speed [rad/s].
        stuck: stiffness and mass (n, n) with the mass.
        shapes: of the plate without it, shape (n, k).
        index: number of the shape.

    Returns:
        Eigenvalue [rad²/s²] and shape (n,) of the mode in which the plate moves most alike.

    Raises:
        Divergence: the stiffness is lost.
    """
    stiffness, mass = stuck
    try:
        factor = factorise(stiffness)
    except SingularMatrix:
        raise Divergence(omega, 0.0) from None
    if factor.negative:
        raise Divergence(omega, lowest(stiffness, mass, lanczos(factor, mass, 1)[0]), factor.negative)
    start = np.column_stack([shapes, factor.solve(place.rows[0].toarray().T)])
    value, shape = refine(stiffness, mass, start, index, factor, place.operators.mass)
    if value <= 0.0:
        raise Divergence(omega, value)
    return value, shape


ALONE, LIGHT = 1.5, 0.1
"""Least ratio of the second eigenvalue to the lowest, and most that a ball may add to the mass and stiffness of a mode,
for the lowest mode to stay the lowest when the ball sticks."""

SHAPES = 10.0
"""Most error of a displacement in a shape of modal mass 1, over the root of its eigenvalue's relative error."""

RIGHT = 1e-9
"""Relative error of a squared frequency at a speed between two known ones that counts as none."""

ROUNDED = 1e-7
"""One up to which it is rounding, if twice as many speeds have not halved it."""


def reduce_over(
    operators: Operators,
    diagram: Campbell,
    at: tuple[float, float],
    *,
    ball_mass: float | None = None,
    mass_ratio: float | None = None,
) -> list[Reduced]:
    """Reduced mass and stiffness at a place, at every speed of a diagram.

    Args:
        operators: of the plate.
        diagram: of at least 4 modes.
        at: place (x, y) [m].
        ball_mass: m_p [kg]; or
        mass_ratio: m_p / M2 [-].

    Raises:
        ValueError, NoFlapMode, PlaceError: as `reduce_at` does.
    """
    check_mass(ball_mass, mass_ratio)
    return Reduction(operators, diagram, at).with_ball(ball_mass=ball_mass, mass_ratio=mass_ratio)


class Reduction:
    """A plate at a place and at every speed of a diagram, to be reduced with balls of any mass.

    What the ball has no part in is done once. Raises as `reduce_over` does.

    Attributes:
        operators: of the plate, without Coriolis forces unless its deflection is large; diagram: its modes.
        at: place (x, y) [m].
    """

    def __init__(self, operators: Operators, diagram: Campbell, at: tuple[float, float]) -> None:
        self._bent = operators.effects.large_deflection
        if not self._bent:
            operators, diagram = without_coriolis(operators, diagram, SEARCHED)
        self.operators, self.diagram, self.at = operators, diagram, at
        self._bending: dict[int, tuple[float, float]] = {}
        if self._bent:
            return
        self._indices = [flap_index(names) for names in diagram.families]
        self._family = _Family(operators.at_place(at), diagram, self._indices)
        self._free, motions = self._family.follow(np.zeros(diagram.omega.size))
        self._modes = flap_modes(operators.at_place(at), motions)
        shapes = (diagram.shapes(k)[:, index] for k, index in enumerate(self._indices))
        every = zip(self._modes, shapes, strict=True)
        self._pulls = [mode.mass * operators.at_place(at).pull(shape) for mode, shape in every]

    def with_ball(self, *, ball_mass: float | None = None, mass_ratio: float | None = None) -> list[Reduced]:
        """Reduced parameters for a ball_mass in kg or as m_p / M2, at every speed."""
        check_mass(ball_mass, mass_ratio)
        operators, diagram, at = self.operators, self.diagram, self.at
        if self._bent:
            pairs = zip(map(float, diagram.omega), diagram.states, strict=True)
            return [
                reduce_at(operators, modes.omega, at, ball_mass=ball_mass, mass_ratio=mass_ratio, modes=modes)
                for modes in (searched(operators, omega, state) for omega, state in pairs)
            ]
        ratio = mass_ratio or 0.0
        masses = np.array([mode.mass * ratio if ball_mass is None else ball_mass for mode in self._modes])
        stuck = self._family.follow(masses)[0] if masses.any() else self._free
        self._family.check(stuck, masses, self._modes)
        load, speeds = operators.radius(*at), map(float, diagram.omega)
        every = zip(speeds, self._indices, self._modes, masses, self._free, stuck, self._pulls, strict=True)
        return [
            reduced(omega**2 * load, index, mode, float(mass), float(free), float(fixed), pull)
            for omega, index, mode, mass, free, fixed, pull in every
        ]

    def bending(self, number: int) -> tuple[float, float]:
        """Largest bending strain [1/m] and displacement [-] in the flap mode over that of the place along z.

        See `fem.modes.bending_strains`.

        Args:
            number: of the speed in the diagram.
        """
        if number not in self._bending:
            shape = self.diagram.shapes(number)[:, [flap_index(self.diagram.families[number])]]
            (strain,) = bending_strains(self.operators, shape, self.diagram.states[number])
            lift = abs(self.operators.at_place(self.at).flap[0] @ shape[:, 0])
            moved = self.operators.model.displacement.evaluate(shape)[2]
            self._bending[number] = float(strain / lift), float(np.abs(moved).max() / lift)
        return self._bending[number]


def _between(squares: Array, nodes: list[int]) -> list[int]:
    """Which speed lies halfway, in Omega², between each two neighbours among nodes that are not next to each other."""
    halfway = []
    for low, high in pairwise(nodes):
        inside = np.arange(low + 1, high)
        if inside.size:
            halfway.append(int(inside[np.abs(squares[inside] - 0.5 * (squares[low] + squares[high])).argmin()]))
    return halfway


class _Family:
    """The plate with balls stuck to it: K(Omega) + Omega² m K_a and M + m M_a, of 1 kg at the damper's place."""

    def __init__(self, place: AtPlace, diagram: Campbell, indices: list[int]) -> None:
        self._place, self._operators = place, place.operators
        self._spinning, self._mass = place.ball
        self._motion = place.flap
        self._diagram, self._indices = diagram, indices

    def follow(self, masses: Array) -> tuple[Array, Array]:
        """Squared frequencies (k,) of the flap mode with masses (k,) in kg; motion and slope (2, k).

        Raises:
            Divergence: past the critical speed.
        """
        omega = self._diagram.omega
        fresh = {k: self.solved(k, masses[k]) for k in {0, omega.size - 1}}
        known: dict[int, tuple[float, Array]] = {}
        before = np.inf
        while True:
            known |= fresh
            nodes = sorted(known)
            solved = np.column_stack([known[k][1] for k in nodes])
            flaps = np.column_stack([self._diagram.shapes(k)[:, self._indices[k]] for k in nodes])
            values, motions = self._ritz(np.column_stack([solved, flaps]), masses)
            values[nodes], motions[:, nodes] = [known[k][0] for k in nodes], self._motion @ solved
            fresh = {k: self.solved(k, masses[k]) for k in _between(omega**2, nodes)}
            right = max(RIGHT, 4.0 * self._rounding(values[nodes], solved))
            wrong = max((abs(values[k] / value - 1.0) for k, (value, _) in fresh.items()), default=0.0)
            if wrong <= right or 0.5 * before < wrong <= ROUNDED:
                return values, motions
            before = wrong

    def check(self, stuck: Array, masses: Array, modes: list[FlapMode]) -> None:
        """Check squared frequencies (k,) with balls of masses (k,) stuck, at the lowest speed and at the highest.

        Where the flap mode is the lowest, stands alone and is hardly changed by the ball, it stays the lowest. Alone,
        it moves the place as the diagram's shape of modal mass 1 does, as far as eigenvalues fix a shape.

        Raises:
            LawViolation: it exceeds Rayleigh's quotient of its shape without the ball, or has another modal mass.
        """
        law = "a stuck ball leaves the lowest eigenvalue below Rayleigh's quotient"
        for k in {0, masses.size - 1}:
            omega, free = self._diagram.omega[[k]], (2.0 * np.pi * self._diagram.frequencies_hz[k]) ** 2
            if self._indices[k] != 0 or free[1] <= ALONE * free[0]:
                continue
            shape, slack = self._diagram.shapes(k)[:, 0], EXACT + 2.0 * self._diagram.bounds[k, 0]
            error = abs(modes[k].mass ** -0.5 - abs(self._motion[0] @ shape))
            alike = np.sqrt(slack / self._operators.mass.sum())
            require("a modal mass of 1 kg moves as fast as the mode", np.array([error]), SHAPES * alike, omega)
            heavier, stiffer = (masses[k] * (shape @ (each @ shape)) for each in (self._mass, self._spinning))
            stiffer *= omega**2 / free[0]
            if max(heavier, abs(stiffer)) < LIGHT:
                require(law, stuck[[k]] - free[0] * (1.0 + stiffer) / (1.0 + heavier), slack * free[0], omega)

    def _rounding(self, values: Array, shapes: Array) -> float:
        """What double precision leaves uncertain of some squared frequencies (k,) with shapes (n, k), relatively."""
        stiffness = self._operators.at(float(self._diagram.omega[-1]))
        return 2.0 * float(rounding(stiffness, shapes, values).max())

    def solved(self, k: int, mass: float) -> tuple[float, Array]:
        """The squared frequency at speed number k and its shape (n,), by the full matrices."""
        omega = float(self._diagram.omega[k])
        stiffness = self._operators.at(omega) + omega**2 * mass * self._spinning
        heavy = self._operators.mass + mass * self._mass
        stuck = stiffness.tocsc(), heavy.tocsc()
        return become(self._place, omega, stuck, self._diagram.shapes(k), self._indices[k])

    def _ritz(self, span: Array, masses: Array) -> tuple[Array, Array]:
        """Squared frequencies (k,) at all speeds, motion and slope (2, k), within a span (n, r)."""
        basis = np.linalg.qr(span)[0]
        operators = self._operators
        still, spinning, mass, more_spinning, more_mass = (
            basis.T @ (matrix @ basis)
            for matrix in (operators.stiffness, operators.spinning, operators.mass, self._spinning, self._mass)
        )
        wanted = self._flaps_in(basis)
        values, parts = np.empty(masses.size), np.empty((basis.shape[1], masses.size))
        for k, (omega, ball) in enumerate(zip(self._diagram.omega, masses, strict=True)):
            stiffness = still + omega**2 * (spinning + ball * more_spinning)
            every, vectors = eigh(stiffness, mass + ball * more_mass)
            alike = most_alike(wanted[k], mass, vectors)
            values[k], parts[:, k] = every[alike], vectors[:, alike]
        return values, self._motion @ basis @ parts

    def _flaps_in(self, basis: Array) -> Array:
        """Products (k, r) in the mass of the flap modes without balls and a basis (n, r)."""
        heavy = self._operators.mass @ basis
        rows, first = [], 0
        for part in self._diagram.parts:
            small = part.basis.T @ heavy
            flaps = self._indices[first : first + len(part.vectors)]
            rows += [vectors[:, flap] @ small for vectors, flap in zip(part.vectors, flaps, strict=True)]
            first += len(part.vectors)
        return np.array(rows)
