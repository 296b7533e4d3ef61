"""A structure known by its modes, reduced to what a damper on it feels: its floor's motion and slope, M2, K2, f1."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem.linalg import LEAST_ACROSS, Array, axes_beside, symmetric
from fem.modal_model import ModalModel, ModesAtSpeed, Place, Pull
from fem.modes import Divergence
from fem.plate import Material
from fem.reduction.modal import ModesAtPlace
from fem.reduction.single_mode import FlapMode, Reduced, check_mass, reduced


class NoMotion(ValueError):
    """No mode moves the place as asked, or its floor has no axes; the message says how.

    Attributes:
        about: what is at fault, `at` (the place), `normal` or `direction`.
    """

    def __init__(self, message: str, about: str = "at") -> None:
        super().__init__(message)
        self.about = about


STILL = 1e-6
"""Displacement of a place, relative to the largest of its mode, that counts as none."""


LEAST_PRESSED = 0.1
"""Part of the load that has to press the ball onto a floor."""


@dataclass(frozen=True, eq=False)
class Floor:
    """The cavity's floor at a speed. It faces the axis, its normal along the load, unless it was given one.

    Attributes:
        normal: unit vector, (3,); axes: of the floor, unit vectors (2, 3).
        radius: of the place, from the axis [m]; lean: parts of that along the axes, (2,), 0 of a floor that faces it.
        moved: displacement of the place along the axes in each mode, (2, k).
        slope: of the floor along them, (2, k) [1/m]; spread: what of it is uncertain, (2, k).
    """

    normal: Array
    axes: Array
    radius: float
    lean: Array
    moved: Array
    slope: Array
    spread: Array

    @property
    def pressing(self) -> float:
        """Part of the radius along the normal [m]."""
        return float(np.sqrt(self.radius**2 - self.lean @ self.lean)) if self.lean.any() else self.radius

    def stagger(self, axis: Array) -> float:
        """Angle [rad] from axis 1 of the floor to the spin axis, towards axis 2, as of a plate."""
        angle = float(np.arctan2(*(self.axes @ axis)[::-1]))
        quarters = round(angle / (0.5 * np.pi))
        return quarters * 0.5 * np.pi if abs(angle - quarters * 0.5 * np.pi) <= STILL else angle


def floor(model: ModalModel, at: Place, modes: ModesAtSpeed, direction: Array, given: Array | None = None) -> Floor:
    """The floor of a cavity in a structure of known modes.

    The structure is deformed by the static displacement, where that is known: place, load and slopes are those of the
    deformed structure.

    Args:
        model: of the structure.
        at: place of the cavity.
        modes: at one speed.
        direction: of axis 1, shape (3,), less what of it is along the floor's normal.
        given: normal of the floor out of the undeformed structure, shape (3,), which turns with it; None: the floor
            faces the load.

    Raises:
        NoMotion: there is no load's direction there, it does not press on the floor, or axis 1 is nearly its normal.
    """
    deformed, point = _deformed(at, modes)
    arm = model.load(point)
    radius = float(np.linalg.norm(arm))
    if radius <= STILL * model.size:
        raise NoMotion("the place is on the spin axis, where there is no load to define a floor")
    normal = arm / radius
    if given is not None:
        turned = np.linalg.solve(deformed.T, given)
        normal = np.asarray(turned / np.linalg.norm(turned))
        if arm @ normal <= LEAST_PRESSED * radius:
            angle, most = np.degrees(np.arccos([float(arm @ normal) / radius, LEAST_PRESSED]))
            raise NoMotion(
                f"the load does not press the ball onto a floor with this normal, {angle:.3g}° from the load: expected"
                f" one that points outwards, less than {most:.0f}° from the load",
                "normal",
            )
    axes = frame(normal, direction, "load" if given is None else "floor's normal")
    lean = np.zeros(2) if given is None else axes @ arm
    gradient, spread = at.gradient(modes)
    moved = axes @ at.displacement(modes.shapes).T
    slope, unsure = (
        -np.einsum("i,kij,aj->ak", normal, each @ np.linalg.inv(deformed), axes) for each in (gradient, spread)
    )
    return Floor(normal, axes, radius, lean, moved, slope, np.abs(unsure))


def _deformed(at: Place, modes: ModesAtSpeed) -> tuple[Array, Array]:
    """The gradient (3, 3) of the deformation at a place, and where it then is (3,) [m], as far as that is known."""
    if modes.static is None:
        return np.eye(3), at.point
    still = type(modes)(modes.omega, np.ones(1), modes.static[None])
    return np.eye(3) + at.gradient(still)[0][0], at.point + at.displacement(still.shapes)[0]


def frame(normal: Array, direction: Array, name: str = "load") -> Array:
    """Axes (2, 3) of a floor, the first as near to a direction as the floor allows; `name` of what the normal is along.

    Raises:
        NoMotion: it is nearly along the normal.
    """
    axes, angle = axes_beside(normal, direction)
    if angle < LEAST_ACROSS:
        near, least = (f"{np.round(np.degrees(each), 1):g}°" for each in (angle, LEAST_ACROSS))
        raise NoMotion(
            f"axis 1 of the cavity must be perpendicular to the {name}, but its direction is only {near} from it:"
            f" expected {least} or more",
            "direction",
        )
    return axes


def bending_direction(model: ModalModel, at: Place, modes: ModesAtSpeed) -> Array:
    """Direction (3,) in which the first mode moves a place, less its part along the load.

    Args:
        model: of the structure.
        at: the place.
        modes: at one speed.

    Raises:
        NoMotion: the place does not move so in this mode.
    """
    moved = at.displacement(modes.shapes[:1])[0]
    arm = model.load(at.point)
    square = float(arm @ arm)
    across = moved - (moved @ arm) / square * arm if square > 0.0 else moved
    if np.linalg.norm(across) <= _HARDLY * np.linalg.norm(modes.shapes[0], axis=1).max():
        raise NoMotion("the first mode does not move this place across the load: it gives no axis of the cavity")
    largest = across[np.abs(across).argmax()]
    across = np.where(np.abs(across) <= STILL * abs(largest), 0.0, across) * np.sign(largest)
    return np.asarray(across / np.linalg.norm(across))


_HARDLY = 1e-3
"""Displacement of a place, relative to the largest of its mode, from which on its direction is taken from it."""


def reduced_modes(
    modes: ModesAtSpeed,
    at: Floor,
    pull: Pull,
    *,
    ball_mass: float | None = None,
    mass_ratio: float | None = None,
    load: Array | None = None,
) -> tuple[Reduced, ModesAtPlace]:
    """Reduced parameters at a place in the mode that yields most along axis 1, and all modes as the cavity feels them.

    The ball's inertia and its pull mix the modes that are known; what others would add is of second order in the ratio
    of its mass to theirs.

    Args:
        modes: at a speed.
        at: the floor at this speed.
        pull: what the load of 1 kg does.
        ball_mass: of all balls [kg], or
        mass_ratio: the same over M2.
        load: force on the modes (count,) by a unit of a load elsewhere, which `pressed` then is.

    Raises:
        ValueError: unless exactly one of ball_mass and mass_ratio is given and not negative.
        NoMotion: no mode moves the place along axis 1.
        Divergence: where the pull takes the stiffness of a mode.
    """
    check_mass(ball_mass, mass_ratio)
    squares = modes.squares
    index = int((at.moved[0] ** 2 / squares).argmax())
    lift = float(at.moved[0, index])
    if abs(lift) <= STILL * float(np.abs(modes.shapes[index]).max()):
        raise NoMotion("no mode moves the place along axis 1 of the cavity")
    mass = lift**-2
    ball = mass * mass_ratio if mass_ratio is not None else float(ball_mass or 0.0)
    pulled = pull.stiffness(modes)
    stiffness = np.diag(squares) + modes.omega**2 * ball * pulled
    free, turned = np.linalg.eigh(stiffness)
    if free[0] <= 0.0:
        raise Divergence(modes.omega, float(free[0]))
    stuck = _stuck(stiffness, ball, pull, modes, index) if ball > 0.0 else float(squares[index])
    mode = FlapMode(mass, float(at.slope[0, index] / lift))
    drawn_in = mass * float(pulled[index, index])
    system = reduced(modes.omega**2 * at.pressing, index, mode, ball, float(squares[index]), stuck, drawn_in)
    drawn = np.zeros((2, squares.size)) if modes.drawn is None else at.axes @ modes.drawn.T
    moved, slope, drawn = (np.asarray(part[None] @ turned) for part in (at.moved, at.slope, drawn))
    pressed = np.zeros((1, squares.size)) if load is None else load[None] @ turned
    return system, ModesAtPlace(np.array([modes.omega]), free[None], moved, slope, drawn, pressed)


def cavity_shifts(
    modes: ModesAtSpeed, pull: Pull, material: Material, volume: float, weakens: float, metal: Sequence[Place]
) -> Array:
    """What cavities at a place that the modes know nothing of do to frequencies, relatively, without sign, (k,).

    To first order: by the mass that they take out with its load, and by the strain energy of as much material.

    Args:
        modes: at a speed.
        pull: what the load of 1 kg does there.
        material: what is cut.
        volume: of all cavities [m³].
        weakens: stiffness that they take over that of as much material, at most.
        metal: places in the metal that is cut; their mean is the mean of its strain energy.
    """
    moved, energy = pull.place.displacement(modes.shapes), np.zeros(len(modes.shapes))
    dilation = material.poissons_ratio / (1.0 - 2.0 * material.poissons_ratio)
    for each in metal:
        turned = _deformed(each, modes)[0].T @ each.gradient(modes)[0]
        strain = symmetric(turned)
        spread = dilation * np.trace(strain, axis1=1, axis2=2) ** 2
        energy += 2.0 * material.shear_modulus / len(metal) * ((strain**2).sum(axis=(1, 2)) + spread)
    drawn = modes.omega**2 * np.diagonal(pull.stiffness(modes)) / modes.squares
    lighter = material.density * np.abs((moved**2).sum(axis=1) - drawn)
    return np.asarray(0.5 * volume * (lighter + weakens * energy / modes.squares))


def _stuck(stiffness: Array, ball: float, pull: Pull, modes: ModesAtSpeed, index: int) -> float:
    """Squared frequency of the mode of this number with a ball that moves with its place."""
    from scipy.linalg import eigh

    moved = pull.place.displacement(modes.shapes)
    mass = np.eye(len(moved)) + ball * moved @ moved.T
    values, vectors = eigh(stiffness, mass)
    alike = int(np.abs((mass @ vectors)[index]).argmax())
    return float(values[alike])
