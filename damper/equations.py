"""The equations of motion of structure and ball as linear systems, one for each pair of regimes of the two axes.

Structural modes q_k move the cavity, u = Phi q along x and y, and tilt its floor; the ball is at s in it. With the
ball's inertia and what the load does to a ball off its place,

    L = q'M q'/2 + m |u' + s'|²/2 + (2/5) m |s'|²/2 - q K q/2 - m s E q - m s D s/2,

E = G kappa - Omega² P Phi and D = G / rho - Omega² P: G the load, kappa the slopes of the floor, rho the radii of the
path of the ball's centre, P the projection onto the plane of rotation, as a stagger turns it. K holds what the load
does to a ball in its place. Rolling resistance or sliding friction is a constant force on s. Each flight is then

    z'' = - stiffness z - damping z' + resistance + force cos(nu t + phase),   z = (q, s).

`systems_of` makes the constants of such systems and the terms of their flights' power series. Axes that neither a mode
nor the load couples fall into two groups of coordinates that fly on their own.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from damper.model import Harmonic, in_plane, inertia_ratio, lateral_pull, restoring
from damper.state import MODES, STEP, SYSTEM, TERMS, Equations, zeros

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.model import Floats, Mode, Parameters, ParticleDamper, Records


class Structures(NamedTuple):
    """Structural modes as n dampers feel them.

    Attributes:
        mass, spring, dashpot: shape (n, k).
        shape: displacement of the cavity along x and y, shape (n, 2, k).
        drawn: force on the modes by unit acceleration of the base, but for its sign, shape (n, 2, k) [kg].
        pull, curve: E, shape (n, 2, k), and D, shape (n, 2, 2): the load accelerates the ball by -(E q + D s) [1/s²].
    """

    mass: Floats
    spring: Floats
    dashpot: Floats
    shape: Floats
    drawn: Floats
    pull: Floats
    curve: Floats

    @property
    def coupled(self) -> npt.NDArray[np.bool_]:
        """Whether anything couples the two axes of a damper, shape (n,)."""
        active = (self.shape != 0) | (self.pull != 0)
        return np.asarray((active[:, 0] & active[:, 1]).any(axis=1) | (self.curve[:, 0, 1] != 0))


def structures_by(damper: ParticleDamper, rows: Parameters) -> Structures:
    """The structures that rows of a damper vibrate on."""
    return _own_structure(damper) if rows is damper.parameters else _structures(damper, rows)


@lru_cache(maxsize=64)
def _own_structure(damper: ParticleDamper) -> Structures:
    return _structures(damper, damper.parameters)


def _structures(damper: ParticleDamper, rows: Parameters) -> Structures:
    mass, spring, dashpot, shape, slope, drawn = (
        _single_modes(rows) if damper.modes is None else _given_modes(rows, damper.modes)
    )
    pull = rows["centrifugal_acceleration"][:, None, None] * slope - in_plane(rows) @ shape
    return Structures(mass, spring, dashpot, shape, drawn, pull, restoring(rows))


def _single_modes(rows: Parameters) -> tuple[Floats, ...]:
    """One mode along x and one along y, as in the paper; the slope of the floor stands before what a base draws."""
    n = len(rows)
    shape, slope = np.zeros((n, 2, 2)), np.zeros((n, 2, 2))
    shape[:, 0, 0] = shape[:, 1, 1] = 1.0
    slope[:, 0, 0], slope[:, 1, 1] = rows["floor_tilt"].T
    mass = np.repeat(rows["modal_mass"][:, None], 2, axis=1)
    dashpot = 2 * rows["damping_ratio"][:, None] * np.sqrt(rows["stiffness"] * mass)
    return mass, rows["stiffness"].copy(), dashpot, shape, slope, mass[:, None, :] * shape


def _given_modes(rows: Parameters, modes: tuple[Mode, ...]) -> tuple[Floats, ...]:
    """A damper's modes, the same for all rows; those without a damping ratio have that of the rows."""
    n = len(rows)
    mass, spring = (np.tile([getattr(mode, name) for mode in modes], (n, 1)) for name in ("mass", "stiffness"))
    shape, slope, drawn = (
        np.tile(np.transpose([getattr(mode, name) for mode in modes]), (n, 1, 1))
        for name in ("shape", "slope", "participation")
    )
    ratio = np.stack([rows["damping_ratio"] if m.damping_ratio is None else np.full(n, m.damping_ratio) for m in modes])
    return mass, spring, 2 * ratio.T * np.sqrt(spring * mass), shape, slope, drawn


def members_of(structures: Structures) -> list[list[int]]:
    """Coordinates (q, s) of each group: those of x and those of y, or all in one where anything couples them."""
    k = structures.mass.shape[1]
    if structures.coupled.any():
        return [list(range(k + 2))]
    along_y = ((structures.shape[:, 1] != 0) | (structures.pull[:, 1] != 0)).any(axis=0)
    return [[*np.flatnonzero(~along_y), k], [*np.flatnonzero(along_y), k + 1]]


def forces_on(structures: Structures, harmonics: Sequence[Harmonic]) -> Floats:
    """Height of each harmonic's force on the modes, without the ball's part in a moving base, shape (n, k) [N]."""
    k = structures.mass.shape[1]
    for one in harmonics:
        if one.modal is not None and len(one.modal) != k:
            raise ValueError(f"modal must be {k} forces, one for each mode, got {len(one.modal)}")
    push, base = (np.array([getattr(one, name) for one in harmonics])[:, None, :] for name in ("force", "base"))
    modal = np.array([one.modal or (0.0,) * k for one in harmonics])
    return np.asarray(modal + (push @ structures.shape)[:, 0] - (base @ structures.drawn)[:, 0])


REGIMES = 3


def equations_of(
    rows: Parameters, structures: Structures, harmonic: Harmonic | Sequence[Harmonic] | None = None
) -> Equations:
    """Equations of dampers on structures; one harmonic drives all of them, or each has its own.

    Where nothing couples the axes, one regime along both stands for all pairs in which it is that of an axis.
    """
    n = len(rows)
    sway, load, driven = _driven(rows, structures, harmonic)
    ball, printed = rows["ball_mass"][:, None, None], rows["printed"][:, None]
    # how much of the structure's acceleration the ball lags behind by: stuck, rolling, slipping
    lags = np.stack([np.zeros(n), inertia_ratio(rows), np.ones(n)])
    both = (
        np.ndindex(REGIMES, REGIMES) if structures.coupled.any() else zip(range(REGIMES), range(REGIMES), strict=True)
    )
    beta = np.moveaxis(lags[list(both)], 2, 0)
    pairs = beta.shape[1]
    each = Structures(*(np.repeat(values, pairs, axis=0) for values in structures))
    others = (np.repeat(values, pairs, axis=0) for values in (ball, load, sway, printed))
    stiffness, damping, resistance, force = (
        values.reshape(n, pairs, *values.shape[1:]) for values in _flight(beta.reshape(-1, 2), each, *others)
    )
    excess = np.zeros((n, 2))
    if printed.any():
        stuck, moving = np.moveaxis(_dashpots(structures, ball, printed), 1, 0)
        excess = (stuck - moving) / (structures.mass + ball[:, 0])
    return Equations(
        stiffness=stiffness,
        damping=damping,
        resistance=np.ascontiguousarray(resistance),
        force=np.ascontiguousarray(force),
        shape=np.concatenate([structures.shape, np.zeros((n, 2, 2))], axis=2),
        pull=np.concatenate([structures.pull, structures.curve], axis=2),
        sway=sway,
        excess=excess,
        power=load,
        frequency=driven[:, 0],
        phase=driven[:, 1],
    )


def _flight(
    beta: Floats, structures: Structures, ball: Floats, load: Floats, sway: Floats, printed: npt.NDArray[np.bool_]
) -> tuple[Floats, Floats, Floats, Floats]:
    """Stiffness, damping, resistance and force in one pair of regimes.

    Along each axis the ball's acceleration in space is b = (1 - beta) u'' + h, h = -beta (E q + D s + resistance), and
    M q'' + C q' + K q + m Phi' b + m E's = 0: two equations for u'', the rest is substitution. In the printed equations
    the structure feels of a moving ball the rolling resistance alone, and one that is stuck adds to its dashpot.
    """
    n, k = structures.mass.shape
    alone = printed & (beta > 0.0)
    carried = np.where(alone, 0.0, 1.0 - beta)[:, :, None]
    share = 1.0 / np.where(alone, beta, 1.0)[:, :, None]
    compliance = structures.shape @ (structures.shape / structures.mass[:, None, :]).transpose(0, 2, 1)
    inverse = 1.0 / structures.mass[:, :, None]
    lag = beta[:, :, None]
    back = np.linalg.inv(np.eye(2) + ball * compliance * carried.transpose(0, 2, 1))

    def response(modes: Floats, h: Floats) -> Floats:
        """Accelerations of z from those that the modes would have without the ball, and from h."""
        u = back @ (structures.shape @ modes - ball * compliance @ (share * h))
        b = carried * u + share * h
        moved = modes - ball * inverse * (structures.shape.transpose(0, 2, 1) @ b)
        return np.concatenate([moved, h - lag * u], axis=1)

    eye = np.broadcast_to(np.eye(k), (n, k, k))
    springs = np.concatenate([structures.spring[:, :, None] * eye, ball * structures.pull.transpose(0, 2, 1)], axis=2)
    load_pull = np.concatenate([structures.pull, structures.curve], axis=2)
    stiffness = -response(-inverse * springs, -lag * load_pull)
    dashpot = structures.dashpot
    if printed.any():  # there is one mode along each axis
        dashpot = np.where(beta == 0.0, _dashpots(structures, ball, printed)[:, 0], dashpot)
    dashpots = np.concatenate([dashpot[:, :, None] * eye, np.zeros((n, k, 2))], axis=2)
    damping = -response(-inverse * dashpots, np.zeros((n, 2, k + 2)))
    resistance = response(np.zeros((n, k, 2)), -lag * np.eye(2))
    force = response(inverse * load[:, :k, None], lag * sway[:, :, None])
    return stiffness, damping, resistance.transpose(0, 2, 1), force[..., 0]


def _dashpots(structures: Structures, ball: Floats, printed: npt.NDArray[np.bool_]) -> Floats:
    """Coefficients while the ball is stuck, and else, shape (n, 2, k); the same but in the printed equations."""
    with_ball = structures.dashpot * np.sqrt(np.where(printed, 1.0 + ball[:, 0] / structures.mass, 1.0))
    return np.stack([with_ball, structures.dashpot], axis=1)


def _driven(
    rows: Parameters, structures: Structures, harmonic: Harmonic | Sequence[Harmonic] | None
) -> tuple[Floats, Floats, Floats]:
    """A harmonic's acceleration of the ball against its base, its force on each coordinate, frequency and phase."""
    n, k = structures.mass.shape
    if harmonic is None:
        return np.zeros((n, 2)), np.zeros((n, k + 2)), np.zeros((n, 2))
    each = (harmonic,) * n if isinstance(harmonic, Harmonic) else tuple(harmonic)
    sway = -np.array([one.base for one in each])
    ball = rows["ball_mass"][:, None] * sway
    modal = forces_on(structures, each) + (ball[:, None, :] @ structures.shape)[:, 0]
    driven = np.array([(one.frequency, one.phase) for one in each])
    return sway, np.concatenate([modal, ball], axis=1), driven


def _swinging(structures: Structures, ball: Floats, members: list[list[int]]) -> dict[str, Floats]:
    """`deflection`, `swing`, shape (n, N, N), `reach` and `bias`, shape (n, 2, N), of `damper.state.SYSTEM`.

    In the modes v_k of M + m Phi'Phi and K, the structure swings about where the ball's place holds it; its dashpots
    add to the accelerations.
    """
    (n, k), pull = structures.mass.shape, structures.pull
    deflection, swing = np.zeros((n, k + 2, k + 2)), np.zeros((n, k + 2, k + 2))
    reach, bias = np.zeros((n, 2, k + 2)), np.zeros((n, 2, k + 2))
    sag = ball * pull.transpose(0, 2, 1) / structures.spring[:, :, None]  # q = -sag s at rest
    bias[:, :, k:] = pull @ sag - structures.curve
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
    return {"deflection": deflection, "swing": swing, "reach": reach, "bias": bias}


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
    along = [[0, 1]] if len(members) == 1 else [[0], [1]]
    groups = [_terms(equations, *each, spans[:, g]) for g, each in enumerate(zip(members, along, strict=True))]
    series, sources = np.max([each.shape[2:4] for each in groups], axis=0)
    n, pairs = groups[0].shape[:2]
    flows = zeros((n, len(groups) * pairs, series, sources, TERMS))
    for g, terms in enumerate(groups):
        flows[:, g * pairs : (g + 1) * pairs, : terms.shape[2], : terms.shape[3]] = terms
    return flows


def _terms(of: Equations, group: list[int], axes: list[int], span: Floats) -> Floats:
    """Terms of a group's series in each pair of regimes, its steps so long, shape (n, pairs, series, sources, TERMS).

    The series are those of its coordinates, of the cavity's displacement along its axes, of the drive of a stuck ball
    there and, where it is driven, of the wave and of what that puts in per velocity. The sources are the coordinates,
    their rates, what resists along the axes, and the wave's cosine and sine at the start.
    """
    (n, pairs), size, count = of.force.shape[:2], len(group), len(axes)
    driven, pressed = bool((of.frequency > 0.0).any()), 2 * size
    rows, step = size + driven, span[:, None, None, None]
    law = np.zeros((n, pairs, rows, 2 * rows))  # the next derivative of coordinates and wave from the last two
    law[..., :size, :size] = -of.stiffness[..., group, :][..., group] * step**2
    law[..., :size, rows : rows + size] = -of.damping[..., group, :][..., group] * step
    z = np.zeros((n, pairs, (TERMS + 2) * rows, pressed + count + 2 * driven))
    for m in range(size):
        z[..., m, m] = z[..., rows + m, size + m] = 1.0
    if driven:
        turn = (of.frequency * span)[:, None]
        law[..., :size, size], law[..., size, size] = of.force[..., group] * step[..., 0] ** 2, -(turn**2)
        z[..., size, pressed + count], z[..., rows + size, pressed + count + 1] = 1.0, -turn
    for first in range(0, TERMS * rows, rows):
        z[..., first + 2 * rows : first + 3 * rows, :] = law @ z[..., first : first + 2 * rows, :]
        if first == 0:
            resistance = of.resistance[..., axes, :][..., group].swapaxes(2, 3)
            z[..., 2 * rows : 2 * rows + size, pressed : pressed + count] += resistance * step**2
    every = z.reshape(n, pairs, TERMS + 2, rows, -1)
    moving, wave = every[..., :size, :], every[:, :, :TERMS, size:]
    shape, pull = (each[:, None, None, axes, :][..., group] for each in (of.shape, of.pull))
    excess = of.excess[:, None, None, axes, None]
    u, inverse = shape @ moving, 1.0 / step[..., None]
    drive = -(pull @ moving)[:, :, :TERMS] - inverse * (excess * u[:, :, 1:-1] + inverse * u[:, :, 2:])
    drive[:, :, 0, range(count), range(pressed, pressed + count)] -= 1.0  # a stuck ball feels no more than a pull
    series = [moving[:, :, :TERMS], u[:, :, :TERMS], drive]
    if driven:
        drive += of.sway[:, None, None, axes, None] * wave
        series += [wave, of.power[:, None, None, None, group] @ moving[:, :, :TERMS]]
    return np.moveaxis(np.concatenate(series, axis=3), 2, 4)


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
    equations, members = equations_of(rows, structures, harmonic), members_of(structures)
    order = [z for group in members for z in group]
    spans = _spans(equations, members)
    several = ((structures.shape != 0).sum(axis=2) > 1).any(axis=1) | (k > 2)
    compliance = (structures.shape**2 / structures.mass[:, None, :]).sum(axis=2)
    constants = np.zeros(n, SYSTEM)
    for values in (
        _places(structures, members, order),
        _sorted(_inertia(rows, structures, members), order),
        {"power": equations.power[:, order], "mode_shape": equations.shape[..., order]},
        {"pull": equations.pull[..., order], "sway": equations.sway, "excess": equations.excess, "span": spans},
        {"lateral": lateral_pull(rows), "reduced": 1.0 / (1.0 / rows["ball_mass"][:, None] + compliance)},
        {"frequency": equations.frequency, "phase": equations.phase, "flow": np.arange(n)},
        {"several": several & (harmonic is None), "damped": (structures.dashpot > 0).any(axis=1)},
    ):
        for name, value in values.items():
            _fill(constants[name], np.asarray(value))
    return Systems(constants, flows_of(equations, members, spans), equations, order)


def _places(structures: Structures, members: list[list[int]], order: list[int]) -> dict[str, Any]:
    """Which coordinates and axes each group has.

    Where each axis has one mode, scaled to 1 at the cavity, that is the cavity's displacement itself.
    """
    k, group = structures.mass.shape[1], [0, len(members) - 1]
    ends, axes = np.cumsum([0, *map(len, members)]), [0, 1, 2] if len(members) == 2 else [0, 2]
    alone = len(members) == 2 == k and bool((structures.shape == np.eye(2)).all())
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


def _inertia(rows: Parameters, structures: Structures, members: list[list[int]]) -> dict[str, Floats]:
    """What has to do with masses and energies, in the coordinates (q, s)."""
    n = len(rows)
    ball = rows["ball_mass"][:, None, None]
    give = structures.shape / structures.mass[:, None, :]
    mass, spring = _energies(structures, ball)
    return {
        "mass": mass,
        "spring": spring,
        "yielding": np.concatenate([give, -structures.shape @ give.transpose(0, 2, 1)], axis=2),
        "dashpot": np.concatenate([_dashpots(structures, ball, rows["printed"][:, None]), np.zeros((n, 2, 2))], axis=2),
        **_swinging(structures, ball, members),
    }


def _sorted(values: dict[str, Floats], order: list[int]) -> dict[str, Floats]:
    """Vectors and matrices with their coordinates in this order."""
    square = len(order), len(order)
    return {name: (each[:, order] if each.shape[1:] == square else each)[..., order] for name, each in values.items()}


def _energies(structures: Structures, ball: Floats) -> tuple[Floats, Floats]:
    """Matrices (n, k + 2, k + 2) of twice the kinetic and potential energy, spin apart; modes, then the ball."""
    n, k = structures.mass.shape
    ride = np.concatenate([structures.shape, np.broadcast_to(np.eye(2), (n, 2, 2))], axis=2)
    mass, spring = ball * (ride.transpose(0, 2, 1) @ ride), np.zeros((n, k + 2, k + 2))
    mass[:, range(k), range(k)] += structures.mass
    spring[:, range(k), range(k)] = structures.spring
    spring[:, k:, :k], spring[:, k:, k:] = ball * structures.pull, ball * structures.curve
    spring[:, :k, k:] = spring[:, k:, :k].transpose(0, 2, 1)
    return mass, spring


def _fill(room: npt.NDArray[Any], values: npt.NDArray[Any]) -> None:
    """Put values, the same for all dampers or with a row for each, into the first places of their room."""
    inner = values.shape[values.ndim - room.ndim + 1 :]
    room[(slice(None), *map(slice, inner))] = values


def _spans(equations: Equations, members: list[list[int]]) -> Floats:
    """Length (n, groups) [s] of each group's steps; a group without a mode of its own takes the others'."""
    rates = np.stack([_fastest(equations, group) for group in members], axis=1)
    return np.asarray(STEP / np.where(rates > 0.0, rates, rates.max(axis=1, keepdims=True)))


def _fastest(equations: Equations, group: list[int]) -> Floats:
    """Largest angular frequency or decay rate of a group's flights, and of what drives it, shape (n,) [rad/s]."""
    both = np.stack([equations.stiffness, equations.damping])[..., group, :][..., group]
    turns, decays = np.abs(np.linalg.eigvals(both)).max(axis=(2, 3))
    return np.asarray(np.maximum(np.maximum(np.sqrt(turns), decays), equations.frequency))
