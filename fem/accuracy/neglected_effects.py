"""Effects left out: by how much Coriolis forces, large deflection and cavities would shift frequencies.

Coriolis forces (`turned`): two modes of rates a and b, coupled by g = phi_a' G phi_b, have together the rates w of
    (w² - a²) (w² - b²) = (Omega g w)²,
far from one another a shift of second order in Omega, where they nearly coincide one of first order, Omega g / 2. Modes
beyond those found take part by their static response to the Coriolis forces of these. On a coarse mesh rates are off by
more than modes may be apart: the shift is the largest that their distance, as uncertain as it is, allows.

Large deflection (`bent`): the static state at the highest speed, and by how much it shifts the frequencies; a coarse
mesh is enough for the difference.

Cavities (`cut`): by the first-order shift of each mode, of their mass and of their stiffness.

Modes of rates that may coincide may be mixed in any way on the plate itself: an effect moves each of them by no more
than the norm of what it does to all of them together (Weyl), whatever their mixture on the coarse mesh.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from fem.assembly import Operators, assemble, energy_densities, footprint, with_masses
from fem.linalg import Array, orthonormal, quadratic_forms
from fem.meshes.planform import locate
from fem.modal_model import lagrange
from fem.modes import Divergence, Modes, solve_modes, solve_real
from fem.plate import Plate
from fem.rotor import Effects, Rotor
from fem.statics import NoEquilibrium, linearise, settle, tangent
from fem.sweep.campbell import Campbell

BEYOND = 4
"""Modes beyond those asked for that are found as well."""

UNCERTAIN = 0.01
"""Relative error of a rate on a coarse mesh."""

SAMPLES = 4
"""Speeds at which a large deflection is solved for; between them its stiffness is a polynomial in Omega²."""

ENOUGH = 1e-6
"""Residual of the modes."""


@dataclass(frozen=True, eq=False)
class Turned:
    """Shifts (k, count), relative and without sign, that Coriolis forces cause at speeds omega (k,) in rad/s."""

    omega: Array
    shifts: Array

    @property
    def largest(self) -> tuple[float, float]:
        """The largest shift, and its speed in rad/s."""
        row = int(self.shifts.max(axis=1).argmax())
        return float(self.shifts[row].max()), float(self.omega[row])


def turned(
    plate: Plate, rotor: Rotor, effects: Effects, speeds: tuple[float, ...], count: int, theory: str = "mindlin"
) -> Turned | None:
    """By how much Coriolis forces would move the lowest modes.

    A coarse mesh will do, on which rates are good to `UNCERTAIN`.

    Args:
        plate: with its mesh.
        rotor: spin axis, hub and angles.
        effects: which effects of spinning count.
        speeds: [rad/s].
        count: of modes.
        theory: by name.

    Returns:
        None where the plate has no modes at any of the speeds.

    Raises:
        ValueError: as `solve_modes` does.
        Unresolved: the plate is too thin for its theory in double precision.
    """
    operators = assemble(plate, rotor, replace(effects, coriolis=True), theory)
    gyroscopic = operators.gyroscopic
    assert gyroscopic is not None
    requested = np.unique(np.asarray(speeds, dtype=float))
    samples = _samples(operators, gyroscopic, requested, count + BEYOND)
    if not samples:
        return None
    basis = orthonormal(np.hstack([vectors for _, _, vectors in samples]), operators.mass)[0]
    stiffness = [basis.T @ (matrix @ basis) for _, matrix, _ in samples]
    known = np.array([omega for omega, _, _ in samples])
    requested = requested[requested <= known.max()] if operators.effects.large_deflection else requested
    weights = np.array([lagrange(known**2, square) for square in requested**2])
    small = np.tensordot(weights, np.array(stiffness), 1)
    turning = basis.T @ (gyroscopic @ basis)
    squares, vectors = np.linalg.eigh(0.5 * (small + small.transpose(0, 2, 1)))
    alive = squares[:, 0] > 0.0
    if not alive.any():
        return None
    coupled = np.swapaxes(vectors[alive], 1, 2) @ turning @ vectors[alive]
    force = (requested[alive, None, None] * coupled) ** 2
    return Turned(requested[alive], _shifts(squares[alive], force)[:, :count])


def _samples(
    operators: Operators, gyroscopic: csc_array, requested: Array, count: int
) -> list[tuple[float, csc_array, Array]]:
    """Speeds that have modes, the stiffness there, and the modes with what answers their Coriolis forces.

    A linear prestress is known everywhere from two speeds, at which there need be no modes but at the lower.
    """
    samples: list[tuple[float, csc_array, Array]] = []
    large = operators.effects.large_deflection
    trial_speeds = np.linspace(requested[0] ** 2, requested[-1] ** 2, SAMPLES if large else 2) ** 0.5
    state = None
    for omega in np.unique(np.where(requested[-1] > requested[0], trial_speeds, requested[-1])):
        try:
            stiffness, state = linearise(operators, float(omega), state)
            modes = solve_real(operators, float(omega), stiffness, count, tolerance=ENOUGH)
        except (Divergence, NoEquilibrium):
            if large or not samples:
                break
            samples.append((float(omega), operators.at(float(omega)), samples[0][2][:, :0]))
            break
        answers = modes.factor.solve(gyroscopic @ modes.shapes)
        samples.append((float(omega), stiffness, np.hstack([modes.shapes, answers])))
    return samples


def _shifts(squares: Array, force: Array) -> Array:
    """Shifts (k, m) of modes of squared rates (k, m): those by all partners together, and what uncertain rates may add.

    Partners push a mode up or down, so that their shifts may cancel. Modes that may coincide have one another's shifts
    by others besides.

    force: (Omega g)², (k, m, m).
    """
    own, partner = np.broadcast_arrays(squares[:, :, None], squares[:, None, :])
    ratio, force = partner / own, force / own
    near = np.where(
        ratio < 1.0, np.minimum(ratio * (1.0 + 2.0 * UNCERTAIN), 1.0), np.maximum(ratio * (1.0 - 2.0 * UNCERTAIN), 1.0)
    )
    alike = near == 1.0
    expected, largest = _pushed(ratio, force), _pushed(near, force)
    mutual = np.maximum(np.abs(largest), _pushed(np.full_like(near, np.nextafter(1.0, 0.0)), force))
    by_others = np.abs(np.where(alike, 0.0, expected).sum(axis=2))
    by_others += np.where(alike, 0.0, np.abs(largest) - np.abs(expected)).sum(axis=2)
    return np.asarray(np.where(alike, mutual + by_others[:, None, :], 0.0).sum(axis=2))


def _pushed(ratio: Array, force: Array) -> Array:
    """Relative shift of a rate by a partner of a squared rate `ratio` times its own, by force: (Omega g)² over it."""
    middle = 0.5 * (1.0 + ratio + force)
    split = np.sqrt(np.maximum(middle**2 - ratio, 0.0))
    square = np.maximum(np.where(ratio < 1.0, middle + split, middle - split), 0.0)
    return np.asarray(np.where(force > 0.0, np.sqrt(square) - 1.0, 0.0))


STATE_ENOUGH = 1e-8
"""Energy of Newton's last step and residual of the modes, relatively: far below any change worth knowing."""


@dataclass(frozen=True, eq=False)
class Bent:
    """The static state at a speed omega (rad/s), and what it does.

    Attributes:
        rotation: the largest of a point of the plate, in rad.
        strain: the largest principal one of the mid-surface.
        shifts: (count,) relative differences between frequencies about the state and those with the stiffening of the
            flat plate, for the rates of the flat plate that move them most within `UNCERTAIN`; infinite where only one
            of the two has modes.
    """

    omega: float
    rotation: float
    strain: float
    shifts: Array

    @property
    def shift(self) -> float:
        """The largest of the shifts."""
        return float(self.shifts.max())


def bent(plate: Plate, rotor: Rotor, effects: Effects, speeds: tuple[float, ...], count: int) -> Bent | None:
    """What the static deflection does to the lowest modes at the highest speed.

    In Mindlin's theory and without Coriolis forces. The shift is a difference on one mesh, for which one will do on
    which rates are good to `UNCERTAIN`.

    Args:
        plate: with its mesh.
        rotor: spin axis, hub and angles.
        effects: which effects of spinning count.
        speeds: [rad/s]; where the plate diverges at the highest, a lower one is taken.
        count: of modes.

    Returns:
        None where the plate diverges at all speeds tried.

    Raises:
        ValueError: as `solve_modes` does, and for effects without stress stiffening.
        Unresolved: the plate is too thin for its theory in double precision.
    """
    large = assemble(plate, rotor, replace(effects, coriolis=False, large_deflection=True))
    flat = replace(large, effects=replace(large.effects, large_deflection=False))
    ascending = sorted(set(speeds))
    bending = _at(flat, large, ascending.pop(), count)
    while bending is None and ascending:  # past the critical speed
        middle = len(ascending) // 2
        bending = _at(flat, large, ascending[middle], count)
        ascending = ascending[:middle]
    return bending


def _at(flat: Operators, large: Operators, omega: float, count: int) -> Bent | None:
    wanted = min(count + BEYOND, flat.mass.shape[0])
    before = state = after = None
    with suppress(Divergence):
        before = solve_modes(flat, omega, wanted)
    with suppress(Divergence, NoEquilibrium):
        state = settle(large, omega, converged=STATE_ENOUGH)[0]
        after = solve_real(large, omega, tangent(large, omega, state), wanted, tolerance=STATE_ENOUGH)
    if before is None and after is None:
        return None
    shifts = np.full(count, np.inf)
    if before is not None and after is not None:
        shifts = _apart(before, after, large.mass)[:count]
    return Bent(omega, *_size(large, state), shifts)


def _apart(before: Modes, after: Modes, mass: csc_array) -> Array:
    """Largest shifts (count,) from modes to others, as far apart as those before may be.

    The others' squared rates are a matrix between the modes before, to which these are nearest (des Cloizeaux).
    """
    squares = before.eigenvalues
    left, _, right = np.linalg.svd(before.shapes.T @ (mass @ after.shapes))
    mixed = left @ right
    change = (mixed * after.eigenvalues) @ mixed.T - np.diag(squares)
    shifts = np.abs(np.sqrt(after.eigenvalues / squares) - 1.0)
    for k, own in enumerate(squares):
        gaps = np.abs(squares - own)
        least = np.maximum(gaps - 2.0 * UNCERTAIN * own, 0.0)
        alike = least == 0.0
        together = np.linalg.norm(change[np.ix_(alike, alike)], 2) if alike.sum() > 1 else 0.0
        nearer = np.where(alike, 0.0, _repelled(least, change[k]) - _repelled(gaps, change[k])).sum()
        shifts[k] = max(shifts[k], 0.5 * together / own) + 0.5 * nearer / own
    return np.asarray(shifts)


def _repelled(gaps: Array, coupling: Array) -> Array:
    """By how much two values with a gap (n,) part when they are coupled (n,)."""
    return np.asarray(np.hypot(0.5 * gaps, coupling) - 0.5 * gaps)


def _size(operators: Operators, state: Array | None) -> tuple[float, float]:
    """Largest rotation in rad, in the plane or out of it, and largest strain of the mid-surface (Green's)."""
    if state is None:
        return np.nan, np.nan
    stretched = operators.model.gradient.evaluate(state)[:6].reshape(3, 2, -1)
    stretched[:2] += np.eye(2)[:, :, None]
    strain = 0.5 * (np.einsum("kan,kbn->abn", stretched, stretched) - np.eye(2)[:, :, None])
    within = np.arctan2(stretched[1, 0] - stretched[0, 1], stretched[0, 0] + stretched[1, 1])
    out = np.arctan(np.linalg.norm(stretched[2], axis=0))
    return float(max(np.abs(within).max(), out.max())), float(np.abs(np.linalg.eigvalsh(strain.T)).max())


@dataclass(frozen=True)
class Cut:
    """Relative shifts (k, count) of frequencies, without sign, by cavities.

    Attributes:
        mass: by the metal that they take out, at their place.
        extent: by that it is not at the place alone.
        stiffness: by the strain energy of as much metal, averaged over the thickness; cavities that are cut across the
            stress lose a multiple.
    """

    mass: Array
    extent: Array
    stiffness: Array


def cut(
    operators: Operators,
    diagram: Campbell,
    numbers: Sequence[int],
    at: tuple[float, float],
    volume: float,
    depth: float,
) -> Cut:
    """What cavities (`with_cavity`) change, to first order.

    Args:
        operators: of the plate, with or without the cavities.
        diagram: its modes over speeds.
        numbers: of the speeds in the diagram.
        at: place (x, y) of the cavities [m].
        volume: of all cavities [m³].
        depth: of a cavity [m].

    Raises:
        PlaceError: off the plate, or where the plate has no room for them.
    """
    places = footprint(operators, at, volume, depth)
    cells = [locate(operators.model.mesh, (x, y))[0] for x, y in places]
    whole = operators.plate.material.density * volume
    masses = [with_masses(operators, where, whole / len(where)) for where in (np.array([at]), places)]
    parts = []
    for number in numbers:
        omega, shapes = float(diagram.omega[number]), diagram.shapes(number)
        squares = (2.0 * np.pi * diagram.frequencies_hz[number]) ** 2
        shifts = []
        for heavy in masses:
            stiffer = omega**2 * quadratic_forms(heavy.spinning - operators.spinning, shapes) / squares
            shifts.append(0.5 * (quadratic_forms(heavy.mass - operators.mass, shapes) - stiffer))
        densities = energy_densities(operators.model, shapes)
        strained = densities[cells].max(axis=1).mean(axis=0)
        if operators.effects.large_deflection:
            # linear strains of a mode about a bent state may have more energy than the mode
            volumes = operators.model.gradient.dx * sum(layer.weight for layer in operators.model.elastic)
            energy = np.einsum("cpk,cp->k", densities, volumes)
            strained = strained * np.minimum((squares + omega**2) / energy, 1.0)
        parts.append((np.abs(shifts[0]), np.abs(shifts[1] - shifts[0]), 0.5 * volume * strained / squares))
    return Cut(*np.array(parts).reshape(len(numbers), 3, -1).transpose(1, 0, 2))
