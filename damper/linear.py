"""The equations of motion of structure and ball as linear systems, one for each pair of regimes of the two axes.

Structural modes q_k move the cavity, u = Phi q along x and y, and tilt its floor; the ball is at s in it. With the
ball's inertia and what the load does to a ball off its place,

    L = q'M q'/2 + m |u' + s'|²/2 + (2/5) m |s'|²/2 - q K q/2 - m s E q - m s D s/2,

E = G kappa - Omega² P Phi and D = G / rho - Omega² P: G the load, kappa the slopes of the floor, rho the radii of the
path of the ball's centre, P the projection onto the plane of rotation, as a stagger turns it. K holds what the load
does to a ball in its place. Rolling resistance or sliding friction is a constant force on s. Each flight is then

    z'' = - stiffness z - damping z' + resistance + force cos(nu t + phase),   z = (q, s).

Axes that no mode and no load couples fall into groups of coordinates that fly on their own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from damper.modes import Harmonic
from damper.parameters import in_plane, inertia_ratio, path_curvature
from damper.records import ROLLING, STUCK
from damper.system import MODES, SYSTEM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.arrays import Floats, Integers, Records
    from damper.modes import Mode
    from damper.parameters import Parameters

REGIMES = 3


class Structures(NamedTuple):
    """Structural modes as n dampers feel them.

    Attributes:
        mass, spring, dashpot: shape (n, k).
        shape, slope: displacement and slope of the cavity's floor along x and y, shape (n, 2, k).
        drawn: force on the modes by unit acceleration of the base, but for its sign, shape (n, 2, k) [kg].
    """

    mass: Floats
    spring: Floats
    dashpot: Floats
    shape: Floats
    slope: Floats
    drawn: Floats


def single_modes(rows: Parameters) -> Structures:
    """One mode along x and one along y, as in the paper."""
    n = len(rows)
    shape, slope = np.zeros((n, 2, 2)), np.zeros((n, 2, 2))
    shape[:, 0, 0] = shape[:, 1, 1] = 1.0
    slope[:, 0, 0], slope[:, 1, 1] = rows["floor_tilt"].T
    mass = np.repeat(rows["modal_mass"][:, None], 2, axis=1)
    dashpot = 2 * rows["damping_ratio"][:, None] * np.sqrt(rows["stiffness"] * mass)
    return Structures(mass, rows["stiffness"].copy(), dashpot, shape, slope, mass[:, None, :] * shape)


def structures_of(rows: Parameters, modes: tuple[Mode, ...]) -> Structures:
    """A damper's modes, the same for all rows; those without a damping ratio have that of the rows."""
    n = len(rows)
    mass, spring = (np.tile([getattr(mode, name) for mode in modes], (n, 1)) for name in ("mass", "stiffness"))
    shape, slope, drawn = (
        np.tile(np.transpose([getattr(mode, name) for mode in modes]), (n, 1, 1))
        for name in ("shape", "slope", "participation")
    )
    ratio = np.stack([rows["damping_ratio"] if m.damping_ratio is None else np.full(n, m.damping_ratio) for m in modes])
    return Structures(mass, spring, 2 * ratio.T * np.sqrt(spring * mass), shape, slope, drawn)


def load_of(rows: Parameters, structures: Structures) -> tuple[Floats, Floats]:
    """E, shape (n, 2, k), and D, shape (n, 2, 2): the load accelerates the ball by -(E q + D s) [1/s²]."""
    spin, load = in_plane(rows), rows["centrifugal_acceleration"][:, None]
    pull = load[:, :, None] * structures.slope - spin @ structures.shape
    return pull, (load * path_curvature(rows))[:, :, None] * np.eye(2) - spin


def couples(rows: Parameters, structures: Structures) -> npt.NDArray[np.bool_]:
    """Whether anything couples the two axes of a damper, shape (n,)."""
    pull, curve = load_of(rows, structures)
    felt = (structures.shape != 0) | (pull != 0)
    coupled: npt.NDArray[np.bool_] = (felt[:, 0] & felt[:, 1]).any(axis=1) | (curve[:, 0, 1] != 0)
    return coupled


def systems_of(
    rows: Parameters, structures: Structures, harmonic: Harmonic | Sequence[Harmonic] | None = None
) -> Records:
    """The systems of dampers on structures; something couples the axes of all of them or of none.

    One harmonic drives all of them, or each has its own.
    """
    n, k = structures.mass.shape
    if k > MODES:
        raise ValueError(f"modes must be at most {MODES}, got {k}")
    pull, curve = load_of(rows, structures)
    sway, load, driven = _driven(rows, structures, harmonic)
    ball = rows["ball_mass"][:, None, None]
    give = structures.shape / structures.mass[:, None, :]
    compliance = structures.shape @ give.transpose(0, 2, 1)
    flights = [
        _flight(structures, pull, curve, ball, compliance, (load, sway), _beta(rows, divmod(pair, REGIMES)))
        for pair in range(REGIMES**2)
    ]
    stiffness, damping, resistance, force = (np.stack(each, axis=1) for each in zip(*flights, strict=True))
    mass, spring = _energies(structures, ball, pull, curve)
    members = members_of(rows, structures)
    order = [z for group in members for z in group]
    ends = np.cumsum([0, *map(len, members)])
    axes = [0, 1, 2] if len(members) == 2 else [0, 2]
    stuck = _stuck_modes(structures, pull, curve, ball, members)
    one, two = np.arange(k + 2)[order], np.ix_(order, order)
    zeros = np.zeros((n, 2, 2))
    span = _spans(stiffness, damping, driven, members)
    step = np.repeat(span, np.diff(ends), axis=1)[:, None, :]
    members_low = ends[:-1]
    systems = np.zeros(n, SYSTEM)
    for name, values in {
        "stiffness": _picked(stiffness, two) * step[..., None] ** 2,
        "damping": _picked(damping, two) * step[..., None],
        "resistance": resistance[..., one] * step[:, None] ** 2,
        "force": force[..., one] * step**2,
        "power": load[:, one],
        "sway": sway,
        "frequency": driven[:, 0],
        "phase": driven[:, 1],
        "mode_shape": np.concatenate([structures.shape, zeros], axis=2)[..., one],
        "pull": np.concatenate([pull, curve], axis=2)[..., one],
        "yielding": np.concatenate([give, -compliance], axis=2)[..., one],
        "dashpot": np.concatenate([structures.dashpot, zeros[:, 0]], axis=1)[:, one],
        "mass": _picked(mass, two),
        "spring": _picked(spring, two),
        "deflection": _picked(stuck[0], two),
        "swing": _picked(stuck[1], two),
        "reach": stuck[2][..., one],
        "bias": stuck[3][..., one],
        "span": span,
        "low": members_low,
        "high": ends[1:],
        "first": axes[:-1],
        "last": axes[1:],
        "group": [0, len(members) - 1],
        "place": [order.index(k), order.index(k + 1)],
        "coordinates": k + 2,
        "groups": len(members),
        "inertia": np.concatenate([structures.mass, zeros[:, 0]], axis=1)[:, one],
        "several": k > 2 and harmonic is None,
        "damped": (structures.dashpot > 0).any(axis=1),
    }.items():
        _fill(systems[name], np.asarray(values))
    return systems


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


def _picked(matrices: Floats, both: tuple[Integers, ...]) -> Floats:
    rows, columns = both
    picked: Floats = np.ascontiguousarray(matrices[..., rows, columns])
    return picked


def _beta(rows: Parameters, regimes: tuple[int, int]) -> Floats:
    """How much of the structure's acceleration the ball lags behind by, along each axis, shape (n, 2)."""
    share = {STUCK: np.zeros(len(rows)), ROLLING: inertia_ratio(rows)}
    return np.stack([share.get(regime, np.ones(len(rows))) for regime in regimes], axis=1)


def _flight(
    structures: Structures,
    pull: Floats,
    curve: Floats,
    ball: Floats,
    compliance: Floats,
    driving: tuple[Floats, Floats],
    beta: Floats,
) -> tuple[Floats, Floats, Floats, Floats]:
    """Stiffness, damping, resistance and force in one pair of regimes.

    Along each axis the ball's acceleration in space is b = (1 - beta) u'' + h, h = -beta (E q + D s + resistance), and
    M q'' + C q' + K q + m Phi' b + m E's = 0: two equations for u'', the rest is substitution.
    """
    n, k = structures.mass.shape
    inverse = 1.0 / structures.mass[:, :, None]
    lag = beta[:, :, None]
    back = np.linalg.inv(np.eye(2) + ball * compliance * (1.0 - beta)[:, None, :])

    def response(modes: Floats, h: Floats) -> Floats:
        """Accelerations of z from those that the modes would have without the ball, and from h."""
        u = back @ (structures.shape @ modes - ball * compliance @ h)
        b = (1.0 - lag) * u + h
        return np.concatenate([modes - ball * inverse * (structures.shape.transpose(0, 2, 1) @ b), b - u], axis=1)

    eye = np.broadcast_to(np.eye(k), (n, k, k))
    springs = np.concatenate([structures.spring[:, :, None] * eye, ball * pull.transpose(0, 2, 1)], axis=2)
    stiffness = -response(-inverse * springs, -lag * np.concatenate([pull, curve], axis=2))
    dashpots = np.concatenate([structures.dashpot[:, :, None] * eye, np.zeros((n, k, 2))], axis=2)
    damping = -response(-inverse * dashpots, np.zeros((n, 2, k + 2)))
    resistance = response(np.zeros((n, k, 2)), -lag * np.eye(2))
    load, sway = driving
    force = response(inverse * load[:, :k, None], lag * sway[:, :, None])
    return stiffness, damping, resistance.transpose(0, 2, 1), force[..., 0]


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


def forces_on(structures: Structures, harmonics: Sequence[Harmonic]) -> Floats:
    """Height of each harmonic's force on the modes, without the ball's part in a moving base, shape (n, k) [N]."""
    k = structures.mass.shape[1]
    for one in harmonics:
        if one.modal is not None and len(one.modal) != k:
            raise ValueError(f"modal must be {k} forces, one for each mode, got {len(one.modal)}")
    push, base = (np.array([getattr(one, name) for one in harmonics])[:, None, :] for name in ("force", "base"))
    modal = np.array([one.modal or (0.0,) * k for one in harmonics])
    forces: Floats = modal + (push @ structures.shape)[:, 0] - (base @ structures.drawn)[:, 0]
    return forces


def members_of(rows: Parameters, structures: Structures) -> list[list[int]]:
    """Coordinates (q, s) of each group: those of x and those of y, or all in one where anything couples them."""
    k, pull = structures.mass.shape[1], load_of(rows, structures)[0]
    if couples(rows, structures).any():
        return [list(range(k + 2))]
    along_y = ((structures.shape[:, 1] != 0) | (pull[:, 1] != 0)).any(axis=0)
    return [[*np.flatnonzero(~along_y), k], [*np.flatnonzero(along_y), k + 1]]


def _stuck_modes(
    structures: Structures, pull: Floats, curve: Floats, ball: Floats, members: list[list[int]]
) -> tuple[Floats, Floats, Floats, Floats]:
    """What bounds the drive of a stuck ball from here on: `deflection`, `swing`, `reach` and `bias` of `System`.

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
    return deflection, swing, reach, bias


def _fastest(stiffness: Floats, damping: Floats, driven: Floats, group: list[int]) -> Floats:
    """Largest angular frequency or decay rate of a group's flights, and of what drives it, shape (n,) [rad/s]."""
    at = np.ix_(group, group)
    turns = np.sqrt(np.abs(np.linalg.eigvals(_picked(stiffness, at))).max(axis=(1, 2)))
    decays = np.abs(np.linalg.eigvals(_picked(damping, at))).max(axis=(1, 2))
    fastest: Floats = np.maximum(np.maximum(turns, decays), driven[:, 0])
    return fastest


def _spans(stiffness: Floats, damping: Floats, driven: Floats, members: list[list[int]]) -> Floats:
    """Unit of time (n, groups) [s] of each group's flights; one without a mode of its own takes the others'."""
    rates = np.stack([_fastest(stiffness, damping, driven, group) for group in members], axis=1)
    spans: Floats = 1.0 / np.where(rates > 0.0, rates, rates.max(axis=1, keepdims=True))
    return spans
