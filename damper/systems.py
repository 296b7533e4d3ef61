"""Dampers on structures as the kernels take them: constants, and the terms of their flights.

Axes that no mode and no load couples fall into groups of coordinates that fly on their own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from damper.flows import flows_of
from damper.linear import equations_of
from damper.structures import load_of, members_of
from damper.swinging import swinging
from damper.system import MODES, STEP, SYSTEM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.arrays import Floats, Records
    from damper.linear import Equations
    from damper.modes import Harmonic
    from damper.parameters import Parameters
    from damper.structures import Structures


class Systems(NamedTuple):
    """Of n dampers: their constants, shape (n,); the terms of their flights, shape (m, …), as `flow` tells; equations.

    The latter in the coordinates (q, s), the former in these sorted by groups, `order` of them.
    """

    constants: Records
    flows: Floats
    equations: Equations
    order: list[int]


def systems_of(
    rows: Parameters, structures: Structures, harmonic: Harmonic | Sequence[Harmonic] | None = None
) -> Systems:
    """The systems of dampers on structures; something couples the axes of all of them or of none."""
    n, k = structures.mass.shape
    if k > MODES:
        raise ValueError(f"modes must be at most {MODES}, got {k}")
    equations, members = equations_of(rows, structures, harmonic), members_of(rows, structures)
    order = [z for group in members for z in group]
    spans = _spans(equations, members)
    constants = np.zeros(n, SYSTEM)
    for values in (
        _places(members, k),
        _sorted(_inertia(rows, structures), order),
        {"power": equations.power[:, order], "mode_shape": equations.shape[..., order]},
        {"pull": equations.pull[..., order], "sway": equations.sway, "span": spans},
        {"frequency": equations.frequency, "phase": equations.phase, "flow": np.arange(n)},
        {"several": k > 2 and harmonic is None, "damped": (structures.dashpot > 0).any(axis=1)},
    ):
        for name, value in values.items():
            _fill(constants[name], np.asarray(value))
    return Systems(constants, flows_of(equations, members, spans), equations, order)


def _places(members: list[list[int]], k: int) -> dict[str, Any]:
    """Which coordinates and axes each group has."""
    ends, axes = np.cumsum([0, *map(len, members)]), [0, 1, 2] if len(members) == 2 else [0, 2]
    order = [z for group in members for z in group]
    group = [0, len(members) - 1]
    return {
        "coordinates": k + 2,
        "groups": len(members),
        "low": ends[:-1],
        "high": ends[1:],
        "first": axes[:-1],
        "last": axes[1:],
        "group": group,
        "place": [order.index(k), order.index(k + 1)],
        "lane": [members[g].index(k + i) for i, g in enumerate(group)],
    }


def _inertia(rows: Parameters, structures: Structures) -> dict[str, Floats]:
    """What has to do with masses and energies, in the coordinates (q, s)."""
    n = len(rows)
    pull, curve = load_of(rows, structures)
    ball, none = rows["ball_mass"][:, None, None], np.zeros((n, 2))
    give = structures.shape / structures.mass[:, None, :]
    mass, spring = _energies(structures, ball, pull, curve)
    still = swinging(structures, pull, curve, ball, members_of(rows, structures))
    return {
        "mass": mass,
        "spring": spring,
        "yielding": np.concatenate([give, -structures.shape @ give.transpose(0, 2, 1)], axis=2),
        "dashpot": np.concatenate([structures.dashpot, none], axis=1),
        "inertia": np.concatenate([structures.mass, none], axis=1),
        **still._asdict(),
    }


def _sorted(values: dict[str, Floats], order: list[int]) -> dict[str, Floats]:
    """Vectors and matrices with their coordinates in this order."""
    square = {"mass", "spring", "deflection", "swing"}
    two = np.ix_(order, order)
    return {name: each[:, two[0], two[1]] if name in square else each[..., order] for name, each in values.items()}


def _energies(structures: Structures, ball: Floats, pull: Floats, curve: Floats) -> tuple[Floats, Floats]:
    """Matrices (n, k + 2, k + 2) of twice the kinetic and potential energy, spin apart; modes, then the ball."""
    n, k = structures.mass.shape
    ride = np.concatenate([structures.shape, np.broadcast_to(np.eye(2), (n, 2, 2))], axis=2)
    mass, spring = ball * (ride.transpose(0, 2, 1) @ ride), np.zeros((n, k + 2, k + 2))
    mass[:, range(k), range(k)] += structures.mass
    spring[:, range(k), range(k)] = structures.spring
    spring[:, k:, :k], spring[:, k:, k:] = ball * pull, ball * curve
    spring[:, :k, k:] = spring[:, k:, :k].transpose(0, 2, 1)
    return mass, spring


def _fill(room: npt.NDArray[Any], values: npt.NDArray[Any]) -> None:
    """Put values, the same for all dampers or with a row for each, into the first places of their room."""
    inner = values.shape[values.ndim - room.ndim + 1 :]
    room[(slice(None), *map(slice, inner))] = values


def _spans(equations: Equations, members: list[list[int]]) -> Floats:
    """Length (n, groups) [s] of each group's steps; a group without a mode of its own takes the others'."""
    rates = np.stack([_fastest(equations, group) for group in members], axis=1)
    spans: Floats = STEP / np.where(rates > 0.0, rates, rates.max(axis=1, keepdims=True))
    return spans


def _fastest(equations: Equations, group: list[int]) -> Floats:
    """Largest angular frequency or decay rate of a group's flights, and of what drives it, shape (n,) [rad/s]."""
    rows, columns = np.ix_(group, group)
    turns, decays = (
        np.abs(np.linalg.eigvals(each[..., rows, columns])).max(axis=(1, 2))
        for each in (equations.stiffness, equations.damping)
    )
    fastest: Floats = np.maximum(np.maximum(np.sqrt(turns), decays), equations.frequency)
    return fastest
