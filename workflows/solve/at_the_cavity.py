"""The plate at the damper's place: reduced to one mass on one spring, and its modes as the cavity feels them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from workflows.effects.effect import Effect
from workflows.errors import BadInput
from workflows.scene import plate_mesh
from workflows.scene.source import SceneFile
from workflows.solve.records import CavityMode, Reduced

if TYPE_CHECKING:
    import fem


def felt(
    source: SceneFile, effects: dict[str, Effect], operators: fem.Operators, diagram: fem.Campbell
) -> tuple[list[Reduced | None], list[tuple[CavityMode, ...]]]:
    """What the damper feels at each speed of the diagram: the plate reduced, and its modes.

    Raises:
        BadInput: the damper's place, or too few modes to find the bending mode among.
    """
    reduced = reduce(source, operators, diagram)
    return reduced, cavity_modes(source, effects, operators, diagram, reduced)


def reduce(source: SceneFile, operators: fem.Operators, diagram: fem.Campbell) -> list[Reduced | None]:
    """What the damper feels at each speed of the diagram; nothing without a damper.

    Raises:
        BadInput: the damper's place, or too few modes to find the bending mode among.
    """
    if source.scene.damper is None:
        return [None] * diagram.omega.size
    return with_ball(source, reduction(source, operators, diagram))


def with_ball(source: SceneFile, plate: fem.Reduction) -> list[Reduced | None]:
    """What the damper of a scene feels on a plate that may carry others."""
    damper = source.scene.damper
    if damper is None:
        raise ValueError("the scene has no [damper]")
    with _placed(source):
        found = plate.with_ball(ball_mass=damper.balls, mass_ratio=damper.mass_ratio)
    return [Reduced(r.f1_hz, r.M1, r.K1, r.f2_hz, r.M2, r.K2, r.slope) for r in found]


def reduction(source: SceneFile, operators: fem.Operators, diagram: fem.Campbell) -> fem.Reduction:
    """The plate at the damper's place, for balls of any mass.

    Raises:
        BadInput: the damper's place, or too few modes to find the bending mode among.
    """
    from fem import Reduction

    with _placed(source):
        return Reduction(operators, diagram, plate_mesh.place(source, operators.plate.mesh))


@contextmanager
def _placed(source: SceneFile) -> Iterator[None]:
    """What is wrong with a damper's place, or with the modes it is reduced to, in the scene's words."""
    from fem import NoFlapMode, PlaceError

    try:
        yield
    except PlaceError as error:
        raise plate_mesh.off_the_plate(source, error) from error
    except NoFlapMode as error:
        modes = source.scene.rotor.modes
        raise BadInput(f"{error}: ask for more modes", file=source.name, key="[rotor] modes", value=modes) from error


def cavity_modes(
    source: SceneFile,
    effects: dict[str, Effect],
    operators: fem.Operators,
    diagram: fem.Campbell,
    reduced: list[Reduced | None],
) -> list[tuple[CavityMode, ...]]:
    """The modes at each speed of the diagram as the cavity feels them; none where the scene does not call for them."""
    from fem import modes_at

    balls = [0.0 if found is None else found.M1 - found.M2 for found in reduced]
    if source.scene.damper is None or not effects["structural_modes"].on:
        return [()] * len(balls)
    found = modes_at(operators, diagram, plate_mesh.place(source, operators.plate.mesh), np.array(balls))
    return [
        tuple(
            CavityMode(
                number=k + 1,
                stiffness=float(found.stiffness[n, k]),
                shape=_both(found.shape[n, :, k]),
                slope=_both(found.slope[n, :, k]),
                drawn=_both(found.drawn[n, :, k]),
                pressed=float(found.pressed[n, k]),
            )
            for k in range(found.stiffness.shape[1])
        )
        for n in range(found.stiffness.shape[0])
    ]


def _both(pair: np.ndarray) -> tuple[float, float]:
    return float(pair[0]), float(pair[1])
