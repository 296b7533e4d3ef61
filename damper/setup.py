"""Linear flights set up: constants of the systems, and the terms of their power series.

`systems_of` makes both for dampers on structural modes. Axes that neither a mode nor the load couples fall into two
groups of coordinates that fly on their own. `flows_of` has the terms for each regime, `swinging` the bounds on the
drive of a stuck ball.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from damper.equations import REGIMES, Equations, equations_of, load_of, members_of
from damper.state import MODES, STEP, SYSTEM, TERMS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.equations import Structures
    from damper.model import Floats, Harmonic, Integers, Parameters, Records


class Swinging(NamedTuple):
    """`deflection`, `swing`, shape (n, N, N), `reach` and `bias`, shape (n, 2, N), of `damper.state.SYSTEM`."""

    deflection: Floats
    swing: Floats
    reach: Floats
    bias: Floats


def swinging(structures: Structures, pull: Floats, curve: Floats, ball: Floats, members: list[list[int]]) -> Swinging:
    """In the coordinates (q, s), N of them.

    In the modes v_k of M + m Phi'Phi and K, the structure swings about where the ball's place holds it; its dashpots
    add to the accelerations.
    """
    n, k = structures.mass.shape
    deflection, swing = np.zeros((n, k + 2, k + 2)), np.zeros((n, k + 2, k + 2))
    reach, bias = np.zeros((n, 2, k + 2)), np.zeros((n, 2, k + 2))
    sag = ball * pull.transpose(0, 2, 1) / structures.spring[:, :, None]  # q = -sag s at rest
    bias[:, :, k:] = pull @ sag - curve
    for group in members:
        modes = [z for z in group if z < k]
        if not modes:
            continue
        shape, force = structures.shape[:, :, modes], pull[:, :, modes]
        diagonal = np.eye(len(modes))
        mass = structures.mass[:, modes, None] * diagonal + ball * (shape.transpose(0, 2, 1) @ shape)
        root = np.linalg.inv(np.linalg.cholesky(mass))
        square, vectors = np.linalg.eigh(root @ (structures.spring[:, modes, None] * root.transpose(0, 2, 1)))
        v, rate = root.transpose(0, 2, 1) @ vectors, np.sqrt(square)
        projected = v.transpose(0, 2, 1) @ mass
        here = np.ix_(range(n), modes, modes)
        swing[here], deflection[here] = projected, rate[:, :, None] * projected
        for axis in range(2):
            deflection[:, modes, k + axis] = (deflection[here] @ sag[:, modes, axis, None])[..., 0]
        still = rate[:, None, :] * (shape @ v) - force @ v / rate[:, None, :]
        moving = shape @ v @ (v.transpose(0, 2, 1) @ (structures.dashpot[:, modes, None] * v))
        reach[:, :, modes] = np.hypot(still, moving)
    return Swinging(deflection, swing, reach, bias)


_ROOM = 2**26
"""Bytes that the terms of flights may take at once; working them out takes four times that."""


def at_once(modes: int, *, coupled: bool) -> int:
    """How many dampers' terms there is room for."""
    flows, size, axes = (REGIMES**2, modes + 2, 2) if coupled else (2 * REGIMES, modes + 1, 1)
    return max(1, _ROOM // (flows * (size + 2 * axes + 2) * (2 * size + axes + 2) * TERMS * 8))


def flows_of(equations: Equations, members: list[list[int]], spans: Floats) -> Floats:
    """Terms of all series of flights, shape (n, flows, series, sources, TERMS).

    Flow 3 (x) + (y) belongs to a pair of regimes where all coordinates are one group, else flow 3 g + (regime).
    """
    n, driven = len(spans), 2 * bool((equations.frequency > 0.0).any())
    if len(members) == 1:
        parts = [(members[0], [0, 1], range(REGIMES**2))]
    else:
        parts = [(members[0], [0], range(0, REGIMES**2, REGIMES)), (members[1], [1], range(REGIMES))]
    series, sources = (
        max(k * len(z) + each * len(axes) + driven for z, axes, _ in parts) for k, each in ((1, 2), (2, 1))
    )
    flows = np.zeros((n, sum(len(pairs) for *_, pairs in parts), series, sources, TERMS))
    for g, (group, axes, pairs) in enumerate(parts):
        found = _flows(_chosen(equations, group, axes, pairs), spans[:, g], driven)
        first = g * len(pairs)
        flows[:, first : first + len(pairs), : found.shape[2], : found.shape[3]] = np.moveaxis(found, (0, -1), (-1, 0))
    return flows


def _flows(of: Equations, step: Floats, driven: int) -> Floats:
    """Of one group, shape (TERMS, flows, series, sources, n)."""
    pairs, size = of.force.shape[:2]
    pressed = slice(2 * size, 2 * size + len(of.sway))
    sources = pressed.stop + driven
    wave = _wave(of.frequency * step, sources, driven)
    terms = np.zeros((TERMS + 2, pairs, size, sources, len(step)))
    for m in range(size):
        terms[0, :, m, m] = terms[1, :, m, size + m] = 1.0
    stiffness, damping, force = of.stiffness * step**2, of.damping * step, of.force * step**2
    for k in range(TERMS):
        terms[k + 2] = force[:, :, None] * wave[k] - _product(stiffness, terms[k])
        terms[k + 2] -= (k + 1) * _product(damping, terms[k + 1])
        if k == 0:
            terms[2, :, :, pressed] += of.resistance.swapaxes(1, 2) * step**2
        terms[k + 2] /= (k + 1) * (k + 2)
    order = (np.arange(1, TERMS + 1) * np.arange(2, TERMS + 2))[:, None, None, None, None]
    cavity, here = _product(of.shape, terms), terms[:TERMS]
    drive = of.sway[:, None] * wave[:TERMS] - cavity[2:] * (order / step**2) - _product(of.pull, here)
    for axis in range(len(of.sway)):  # what resists a ball stuck along the axis is nothing but a lateral pull
        drive[0, :, axis, pressed.start + axis] -= 1.0
    series = [here, cavity[:TERMS], drive]
    if driven:
        power = _product(of.power[None], here)
        series += [np.broadcast_to(wave[:TERMS], power.shape), power]
    return np.concatenate(series, axis=2)


def _chosen(equations: Equations, group: list[int], axes: list[int], pairs: range) -> Equations:
    """The equations of a group, one damper beside the other: their axis last."""
    matrix, vector, moved = np.ix_(pairs, group, group), np.ix_(pairs, group), np.ix_(axes, group)

    def cut(each: Floats, places: tuple[Integers, ...]) -> Floats:
        return each[(slice(None), *places)]  # type: ignore[arg-type]

    part = Equations(
        stiffness=cut(equations.stiffness, matrix),
        damping=cut(equations.damping, matrix),
        resistance=cut(equations.resistance, np.ix_(pairs, axes, group)),
        force=cut(equations.force, vector),
        shape=cut(equations.shape, moved),
        pull=cut(equations.pull, moved),
        sway=equations.sway[:, axes],
        power=equations.power[:, group],
        frequency=equations.frequency,
        phase=equations.phase,
    )
    return Equations(*(np.ascontiguousarray(np.moveaxis(each, 0, -1)) for each in part))


def _product(matrices: Floats, terms: Floats) -> Floats:
    """Of matrices (…, a, b, n) with (…, b, sources, n), where few numbers stand in each of many."""
    total = matrices[..., :, 0, None, :] * terms[..., None, 0, :, :]
    for m in range(1, matrices.shape[-2]):
        total += matrices[..., :, m, None, :] * terms[..., None, m, :, :]
    product: Floats = total
    return product


def _wave(turn: Floats, sources: int, driven: int) -> Floats:
    """Terms of cos(turn x + phase) from cosine and sine of the phase, shape (TERMS + 2, 1, 1, sources, n)."""
    wave = np.zeros((TERMS + 2, 1, 1, sources, len(turn)))
    if driven:
        wave[0, ..., -2, :], wave[1, ..., -1, :] = 1.0, -turn
        for k in range(TERMS):
            wave[k + 2] = -(turn**2) * wave[k] / ((k + 1) * (k + 2))
    return wave


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
        _places(members, k, alone=_alone(structures, members)),
        _sorted(_inertia(rows, structures), order),
        {"power": equations.power[:, order], "mode_shape": equations.shape[..., order]},
        {"pull": equations.pull[..., order], "sway": equations.sway, "span": spans},
        {"lateral": rows["lateral_acceleration"]},
        {"frequency": equations.frequency, "phase": equations.phase, "flow": np.arange(n)},
        {"several": k > 2 and harmonic is None, "damped": (structures.dashpot > 0).any(axis=1)},
    ):
        for name, value in values.items():
            _fill(constants[name], np.asarray(value))
    return Systems(constants, flows_of(equations, members, spans), equations, order)


def _alone(structures: Structures, members: list[list[int]]) -> bool:
    """Whether each axis has one mode, scaled to 1 at the cavity: it is the cavity's displacement itself."""
    return len(members) == 2 == structures.mass.shape[1] and bool((structures.shape == np.eye(2)).all())


def _places(members: list[list[int]], k: int, *, alone: bool) -> dict[str, Any]:
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
        "cavity": [0 if alone else len(members[g]) + i - axes[g] for i, g in enumerate(group)],
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
