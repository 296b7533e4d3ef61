"""What an effect says of itself."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import InstanceOf

from fem.meshes.mesh_sequence import Planform
from workflows.errors import present
from workflows.scene.damper import Damper
from workflows.scene.plate import Material, Plate
from workflows.scene.scene import Scene

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LeftOut:
    """Relative shifts (k, count), without sign, of the modes at speeds omega (k,) in rad/s, ascending."""

    omega: Floats = field(repr=False)
    shifts: Floats = field(repr=False)

    def at(self, omega: Floats, count: int) -> Floats:
        """Shifts (k, count) at speeds (k,) in rad/s: nothing at rest, and between speeds linear in their square."""
        square = np.concatenate([[0.0], self.omega**2]) if self.omega[0] > 0.0 else self.omega**2
        rows = np.vstack([np.zeros(self.shifts.shape[1]), self.shifts]) if self.omega[0] > 0.0 else self.shifts
        values = np.stack([np.interp(omega**2, square, column) for column in rows.T], axis=-1)
        beyond = np.repeat(values.max(axis=-1, keepdims=True), max(count - values.shape[-1], 0), axis=-1)
        return np.asarray(np.concatenate([values, beyond], axis=-1)[..., :count])

    @property
    def largest(self) -> float:
        """The largest shift."""
        return float(self.shifts.max())


class Called(NamedTuple):
    """Whether a scene calls for an effect, why (not), and what leaving it out would move, where that is known."""

    called: bool
    why: str
    moves: LeftOut | None = None


@dataclass(frozen=True, eq=False)
class Case:
    """A scene that may call for an effect.

    `form`: the planform of its plate, needed where that is a mesh. `on`: the effects decided before this one.
    """

    scene: Scene
    form: Planform | None
    on: Mapping[str, bool]

    @property
    def spins(self) -> bool:
        """Whether anything spins."""
        return any(speed > 0 for speed in self.scene.rotor.speeds)

    @property
    def plate(self) -> tuple[Plate, Material]:
        """The scene's with what it is made of; effects of spinning are asked where there is one."""
        return present(self.scene.plate), present(self.scene.material)

    @property
    def damper(self) -> Damper:
        """The scene's; effects of a damper are asked where there is one."""
        return present(self.scene.damper)


class Refusal(NamedTuple):
    """Why a scene cannot have an effect that it insists on, and the key and value that say so: by default its own."""

    problem: str
    key: str = ""
    value: object = True


@dataclass(frozen=True)
class Definition:
    """An effect, whose name is the key of the scene and of its module.

    Attributes:
        of: what it belongs to.
        called_for: the rule: whether a scene calls for it, and why (not).
        word: what people call it.
        refused: what rules it out where the scene insists on it, None where nothing does.
        part_of: another effect without which it makes no sense.
        after: effects to be decided before.
        assumed: the key of what is taken for granted with it (True) or without it, in a theory of the plate; the words
            are in `templates/assumptions.toml`.
        arguments: its terms: of `damper.ParticleDamper`, from [damper], the speed [rad/s] and whether it is on. The
            terms of an effect of the plate are those of the switch of its name in `fem.Effects`.
        spins: whether only a plate that spins is asked.
    """

    of: Literal["plate", "damper"]
    called_for: Callable[[Case], Called]
    word: str
    refused: Callable[[Scene], Refusal | None] = lambda scene: None
    part_of: str = ""
    after: tuple[str, ...] = ()
    assumed: Callable[[Scene, bool, str], str] = lambda scene, on, theory: "on" if on else "off"
    arguments: Callable[[Damper, float, bool], dict[str, Any]] = lambda damper, omega, on: {}
    spins: bool = False


NO_DAMPER = Called(False, "no damper in the scene")
GIVEN = Called(False, "the structure's frequencies are given")
AT_REST = Called(False, "nothing spins")
PRINTED = "the printed equations support one mode along each axis and a level floor"


def not_printed(scene: Scene) -> Refusal | None:
    """Refuses what the printed equations do not know."""
    return Refusal(PRINTED) if scene.is_printed else None


@dataclass(frozen=True)
class Effect:
    """Whether an effect is simulated, why (not), and what it would move where it is not, as far as that is known."""

    on: bool
    why: str
    left_out: InstanceOf[LeftOut] | None = field(default=None, repr=False, compare=False)
