"""The cheapest plate theory whose frequencies agree with a solid's within a tolerance.

`theory_errors` estimates how far the frequencies of a theory are from a solid's, from the strains in its modes: at
one speed, `over_speeds` at all speeds of a diagram. `choose_theory` picks the cheapest theory by these estimates.
"""

from dataclasses import dataclass, field, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from fem.accuracy.tolerances import Budget
from fem.assembly import Operators, assemble
from fem.linalg import Array, Ints, forms
from fem.meshes.planform import lengths, root_facets
from fem.meshes.thickness import SLOPE, of, slope
from fem.modes import Divergence, solve_real
from fem.plate import Plate
from fem.rotor import Effects, Rotor
from fem.sweep.campbell import Campbell
from fem.theory.discretisation import Discretisation
from fem.theory.kirchhoff import is_rectangles
from fem.theory.mindlin import SHEAR_CORRECTION, at_root, seeming
from fem.theory.registry import Kind, clamp_lacks, kind

LAYER = 10.0**-0.5
"""Width of the layer along free edges in thicknesses."""

CLEAR = 2.0
"""Thicknesses from a point mass within which it shears the plate as a point does."""

SHEAR, LAYERED = (0.01, 0.09), 0.005
"""Part of the shear energy, without nu and by it, that Mindlin's theory has wrong, about nu / 6; and of the layers."""

MARGIN = 1.25
"""By how much more shear and layers may take than they do to first order, at corners that point inwards most."""

STOUT_ROOT, ALL = 0.2, 1.2
"""Thickness of the root over the smaller side beyond which nothing may be left of what the clamp does in stretching."""

STRETCH, SLOPES, TURN = slice(0, 4), slice(4, 6), slice(6, 10)
"""Fields of the gradient: of u and v, of w, and of the turning of sections."""


def theory_errors(
    operators: Operators, eigenvalues: Array, shapes: NDArray[np.generic], theory: str | None = None
) -> Array:
    """Relative errors of a theory's frequencies against a solid.

    Args:
        operators: of the plate.
        eigenvalues: squared circular frequencies, shape (count,) [rad²/s²].
        shapes: mass-normalised modes, shape (n, count).
        theory: by name; None: that of the operators.

    Returns:
        Shape (count,).
    """
    parts, count = _parts(shapes), eigenvalues.size
    stiff, heavy = _of_modes(doubt(operators, parts, theory), count), _of_modes(thick(operators, parts), count)
    return np.asarray(stiff / eigenvalues + heavy + sloping(operators))


def _parts(shapes: NDArray[np.generic]) -> Array:
    """Shapes (n, count), and beside them, where they are complex, their imaginary parts."""
    return np.hstack([np.real(shapes), np.imag(shapes)]) if np.iscomplexobj(shapes) else np.real(shapes)


def _of_modes(form: Array, count: int) -> Array:
    """What a form (r, r) of the parts of so many shapes has for each of them, (count,)."""
    return np.asarray(np.diag(form).reshape(-1, count).sum(axis=0))


def doubt(operators: Operators, basis: Array, theory: str | None = None) -> Array:
    """Matrix E (r, r) of a theory's errors in a basis (n, r); the theory by name, None: that of the operators.

    A mode of mass-normalised shape basis @ y has a relative error of y' E y / rate².

    Zero for solids, which are the reference.
    """
    model, plate = operators.model, operators.plate
    theory = theory or model.theory
    if kind(theory) is Kind.SOLID:
        return np.zeros((basis.shape[1],) * 2)
    gradient = _gradient(model, plate, basis)
    thin = kind(theory) is Kind.KIRCHHOFF
    unmoved = plate.elastic_root is not None and not thin  # "held" moves a clamp, not springs
    left = clamp_lacks(theory.partition("/")[0] if unmoved else theory)
    if at_root(plate) > STOUT_ROOT * min(plate.sides):
        left = left[0], max(left[1], ALL)
    energy = _clamp(model, plate, gradient, left)
    shear, layered = _shear(model, plate, gradient), _layers(model, plate, gradient)
    if thin:
        return 0.5 * energy + 0.5 * MARGIN * (shear + layered)
    wrong = SHEAR[0] + SHEAR[1] * abs(plate.material.poissons_ratio)
    energy += wrong * shear + LAYERED * layered
    return 0.5 * energy


def thick(operators: Operators, basis: Array) -> Array:
    """Matrix E (r, r) of the inertia through the thickness, in a basis (n, r).

    A mode of mass-normalised shape basis @ y is lowered by y' E y, relatively.

    By the motion through the thickness, which contracts by nu / (1 - nu) of what is stretched in the plane: no plate
    theory here gives it mass (Love, A Treatise on the Mathematical Theory of Elasticity, art. 278, for rods).
    """
    model, plate = operators.model, operators.plate
    if kind(model.theory) is Kind.SOLID:
        return np.zeros((basis.shape[1],) * 2)
    nu, h = plate.material.poissons_ratio, _heights(model, plate)
    xx, _, _, yy = _gradient(model, plate, basis)[STRETCH]
    area = model.gradient.dx / (1.0 if isinstance(plate.thickness, float | int) else h)
    weights = plate.material.density * area * h**3 / 12.0 * (nu / (1.0 - nu)) ** 2
    return np.asarray(0.5 * np.einsum("cpk,cp,cpm->km", xx + yy, weights, xx + yy, optimize=True))


def sloping(operators: Operators) -> float:
    """What plate theories are off where faces slope."""
    plate = operators.plate
    if kind(operators.model.theory) is Kind.SOLID:
        return 0.0
    return SLOPE * slope(plate.thickness, plate.mesh) ** 2


def layers(operators: Operators, eigenvalues: Array, shapes: NDArray[np.generic]) -> Array:
    """By how much the layers along free edges lower frequencies, relatively.

    Args:
        operators: of the plate.
        eigenvalues: squared circular frequencies, shape (count,) [rad²/s²].
        shapes: mass-normalised modes, shape (n, count).

    Returns:
        Shape (count,).
    """
    model, plate = operators.model, operators.plate
    energy = _layers(model, plate, _gradient(model, plate, _parts(shapes)))
    return np.asarray(0.5 * MARGIN * _of_modes(energy, eigenvalues.size) / eigenvalues)


def _gradient(model: Discretisation, plate: Plate, basis: Array) -> Array:
    """Fields of the gradient (10, ncell, npoint, r), those of the turning as such, not in parts of the thickness."""
    gradient = model.gradient.evaluate(basis)
    if isinstance(plate.thickness, float | int):
        return gradient
    return np.concatenate([gradient[: TURN.start], gradient[TURN] / _heights(model, plate)[:, :, None]])


def _heights(model: Discretisation, plate: Plate) -> Array:
    """The thickness (ncell, npoint) in m."""
    return np.asarray(np.broadcast_to(of(plate.thickness, model.points[:2]), model.points.shape[1:]))


def _clamp(model: Discretisation, plate: Plate, gradient: Array, left: tuple[float, float]) -> Array:
    """What the root of a solid has in energy beyond that of a theory with so much of it left: (r, r)."""
    facets = root_facets(model.mesh)
    sides = lengths(model.mesh, facets)
    total = np.zeros((gradient.shape[-1],) * 2)
    h = at_root(plate)
    for part, fields, per_strain in zip(left, (TURN, STRETCH), (h**3 / 12.0, h), strict=True):
        xx, xy, yx, yy = _on(model, facets, gradient[fields])
        strains = np.stack([xx, yy, xy + yx])
        stresses = np.tensordot(plate.material.plane_stress, strains, 1)
        total += np.einsum("sfk,f,sfm->km", strains, part * seeming(plate) * per_strain * sides, stresses)
    return total


def _layers(model: Discretisation, plate: Plate, gradient: Array) -> Array:
    """The twist in the layers along free edges: (r, r)."""
    facets = np.setdiff1d(model.mesh.boundary_facets(), root_facets(model.mesh))
    sides = np.diff(model.mesh.p[:, model.mesh.facets[:, facets]], axis=1)[:, 0]
    long = np.linalg.norm(sides, axis=0)
    x, y = (sides / long)[:, :, None]
    (xx, xy), (yx, yy) = _slopes(model, model.mesh.f2t[0, facets], gradient[SLOPES])
    twist = (0.5 * (xy + yx) * (x**2 - y**2) + (yy - xx) * x * y)[_clear(model, plate, facets)]
    nu, h = plate.material.poissons_ratio, _heights(model, plate).mean(axis=1)[model.mesh.f2t[0, facets]]
    rigidity = plate.material.youngs_modulus * h**3 / 12.0 / (1.0 - nu**2)
    return np.asarray(np.einsum("fk,f,fm->km", twist, 2.0 * (1.0 - nu) * rigidity * LAYER * h * long, twist))


def _clear(model: Discretisation, plate: Plate, facets: Ints) -> Ints:
    """Which of some facets stands for each: for those next to a point mass the nearest that is clear of it.

    There shear bends w by the logarithm of the distance, and the twist of w has no limit; that of the sections has.
    """
    numbers = np.arange(facets.size)
    if plate.tip_mass == 0.0 or plate.tip_at is None:
        return numbers
    middle = model.mesh.p[:, model.mesh.facets[:, facets]].mean(axis=1)
    away = np.linalg.norm(middle - np.array(plate.tip_at)[:, None], axis=0)
    clear = numbers[away >= CLEAR * plate.thickness_at(plate.tip_at)]
    if clear.size in (0, facets.size):
        return numbers
    apart = np.linalg.norm(middle[:, :, None] - middle[:, None, clear], axis=0)
    return np.where(np.isin(numbers, clear), numbers, clear[apart.argmin(axis=1)])


def _shear(model: Discretisation, plate: Plate, gradient: Array) -> Array:
    """The energy of the shear forces D grad (theta_x,x + theta_y,y), in which layers have no part: (r, r)."""
    cells = np.arange(model.mesh.t.shape[1])
    xx, _, _, yy = gradient[TURN]
    material, h = plate.material, _heights(model, plate)
    rigidity = material.youngs_modulus * h**3 / 12.0 / (1.0 - material.poissons_ratio**2)
    (steep,) = np.moveaxis(_slopes(model, cells, (rigidity[:, :, None] * (xx + yy))[None]), 1, 0)
    area = model.gradient.dx / (1.0 if isinstance(plate.thickness, float | int) else h)
    weights = (area / (SHEAR_CORRECTION * material.shear_modulus * h)).sum(axis=1)
    return np.asarray(np.einsum("ack,c,acm->km", steep, weights, steep))


def _slopes(model: Discretisation, cells: Ints, values: Array) -> Array:
    """Derivatives (2, nfield, ncell, r) in some cells of fields (nfield, all cells, npoint, r), by least squares."""
    places = model.points[:2][:, cells].transpose(1, 2, 0)
    places = places - places.mean(axis=1, keepdims=True)
    turned = places.transpose(0, 2, 1)
    apart = np.linalg.solve(turned @ places, turned)
    return np.asarray(np.einsum("cap,fcpk->afck", apart, values[:, cells]))


def _on(model: Discretisation, facets: Ints, values: Array) -> Array:
    """Fields (nfield, all cells, npoint, r) in the middle of facets: (nfield, nfacet, r)."""
    cells = model.mesh.f2t[0, facets]
    middle = model.mesh.p[:, model.mesh.facets[:, facets]].mean(axis=1)
    off = middle - model.points[:2][:, cells].mean(axis=2)
    return np.asarray(values[:, cells].mean(axis=2) + np.einsum("ac,afck->fck", off, _slopes(model, cells, values)))


STOUT = 0.3
"""Thickness over the smaller side beyond which a plate is a block."""

DEAR = 3e-3
"""Accuracy below which a solid is not taken unasked: a plate of 20 x 8 x 1 cm takes 2 s for 1e-2, and 45 s for 1e-3."""

ENOUGH = 1e-3
"""Residual of the modes."""


@dataclass(frozen=True, eq=False)
class Chosen:
    """A theory and why it was chosen.

    Attributes:
        model_error: estimate of its own relative error against a solid, in frequency.
        operators: the matrices of the plate by Mindlin's theory that it was chosen by, where it took any.
    """

    name: str
    why: str
    model_error: float
    operators: Operators | None = field(default=None, repr=False)


def choose_theory(
    plate: Plate,
    rotor: Rotor | None = None,
    effects: Effects | None = None,
    speeds: tuple[float, ...] = (0.0,),
    count: int = 6,
    accuracy: float = 1e-3,
) -> Chosen:
    """The cheapest theory that meets an accuracy in frequency.

    The error of each theory is found from the modes on the plate's mesh, which may be coarse. Thin-plate theory has no
    large deflection: it is off by about 0.4 theta² at a rotation theta.

    Args:
        plate: with its mesh.
        rotor: spin axis, hub and angles.
        effects: which effects of spinning count.
        speeds: [rad/s].
        count: of modes.
        accuracy: relative, in frequency.

    Raises:
        ValueError: an accuracy that is not positive.
        Unresolved: the plate is too thin for Mindlin's theory.
    """
    if not 0.0 < accuracy < inf:
        raise ValueError(f"accuracy must be positive and finite, got {accuracy!r}")
    effects, budget = effects or Effects(), Budget(accuracy)
    ratio = plate.thickest / min(plate.sides)
    if ratio > STOUT:
        return Chosen("solid", f"the plate is a block: its thickness is {ratio:.2g} of its smaller side", 0.0)
    plain = replace(effects, coriolis=False, large_deflection=False)
    operators = assemble(plate, rotor or Rotor(), plain, "mindlin/held")
    thin, thick = own_errors(operators, speeds, count)
    if effects.large_deflection:
        why = "the load deflects the plate: only Mindlin's theory and the solid support finite rotations"
    elif thin <= budget.thin:
        return Chosen("kirchhoff", f"thin: shear and the clamp change frequencies by {_percent(thin)} at most", thin)
    else:
        why = f"thin-plate theory would be off by about {_percent(thin)}"
    if thick <= budget.sheared:
        return Chosen("mindlin", why, thick, operators)
    left = f"Mindlin's theory would be off by about {_percent(thick)}"
    if accuracy >= DEAR and is_rectangles(plate.mesh) and not effects.large_deflection:
        return Chosen("solid", left, 0.0)
    why = 'theory = "solid" is accurate but expensive' if accuracy < DEAR else "a solid would be no better here"
    return Chosen("mindlin", f"{left}; {why}", thick, operators)


def own_errors(operators: Operators, speeds: tuple[float, ...], count: int) -> tuple[float, float]:
    """Largest relative errors of thin-plate theory and of Mindlin's against a solid, its root held as a solid's is.

    Args:
        operators: of the plate by Mindlin's theory so held, whose mesh may be coarse.
        speeds: [rad/s]; the lowest and the highest count, as far as there are modes.
        count: of modes.
    """
    worst = np.zeros(2)
    for omega in sorted({min(speeds), max(speeds)}):
        try:
            modes = solve_real(operators, omega, operators.at(omega), count, tolerance=ENOUGH)
        except Divergence:
            break
        errors = [theory_errors(operators, modes.eigenvalues, modes.shapes, name) for name in ("kirchhoff", None)]
        worst = np.maximum(worst, np.max(errors, axis=1))
    return float(worst[0]), float(worst[1])


def _percent(part: float) -> str:
    return f"{100 * part:.1g} %"


STRAINED = 0.02
"""Of the strain at the root: CalculiX on plates strained by 0.8 % had up to 0.017 of it in their first mode."""


def over_speeds(operators: Operators, diagram: Campbell) -> Array:
    """Relative errors (k, count) of frequencies against a solid."""
    count, errors = diagram.frequencies_hz.shape[1], []
    strained = _strained(operators, diagram.omega)[:, None]
    for part in diagram.parts:
        squares, vectors = part.rates[:, :count] ** 2, part.vectors[:, :, :count]
        if np.iscomplexobj(part.basis):  # of one speed by itself
            errors.append(theory_errors(operators, squares[0], part.basis @ vectors[0])[None])
            continue
        rules = np.stack([rule(operators, part.basis) for rule in (doubt, thick)])
        stiff, heavy = forms(rules, vectors.transpose(0, 2, 1))
        errors.append(stiff / squares + heavy + sloping(operators))
    return np.vstack(errors) + strained


def _strained(operators: Operators, omega: Array) -> Array:
    """What stays uncertain of the stress that stiffens a plate at speeds (k,): a part of the strain at its root."""
    plate, hub = operators.plate, operators.rotor.hub_radius
    if kind(operators.model.theory) is Kind.SOLID or not operators.effects.stress_stiffening:
        return np.zeros(omega.size)
    reach = abs((hub + plate.sides[0]) ** 2 - hub**2)
    return STRAINED * 0.5 * plate.material.density * omega**2 * reach / plate.material.youngs_modulus
