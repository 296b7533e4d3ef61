"""What is not known well, as distributions: how far the answers spread, and which parameter is worth measuring.

Saltelli's design: for each of N base points one in which everything is drawn, one in which everything is drawn again,
and one for each parameter in which that alone is. Sobol' indices are the shares of the variance that a parameter has by
itself (first order) and with all that it acts together with (total); the total is what measuring it could take away.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.errors import BadInput
from workflows.scene.scene import Scene
from workflows.solve import limits
from workflows.solve.results import Floats
from workflows.studies.sweep import store
from workflows.studies.sweep.evaluate import HEADLINE
from workflows.studies.sweep.plan import (
    SAMPLE,
    SPEEDS,
    Axis,
    Plan,
    Spread,
    at_shares,
    find,
    in_order,
    read,
    require_possible,
    speeds_of_a_point,
)

if TYPE_CHECKING:
    import xarray as xr


BASE = 128
"""Base points, unless it is said; the study has as many times the parameters and two."""

QUANTITIES = ("damping_ratio_peak", "at_amplitude", "range_high", "cutoff", "cutoff_ratio", "peak_sdc", HEADLINE)
PERCENTILES = (5.0, 25.0, 50.0, 75.0, 95.0)

INDICES = ("S1", "S1_conf", "ST", "ST_conf")
"""Sobol' indices, of first order and total, each with the half-width of its 95 % confidence interval."""

_RESAMPLES, _CONFIDENCE = 200, 0.95
_CONSTANT = 1e-9
"""Relative spread below which a quantity does not vary, and has no indices."""


def axes(vary: Mapping[str, object] | Iterable[str], scene: Scene) -> tuple[Axis, ...]:
    """What is uncertain: what is given as ranges or ``normal:MEAN:DEVIATION``, or else what hardly ever is known well.

    Raises:
        BadInput: see :func:`workflows.studies.sweep.plan.read`; the speeds are not uncertain.
    """
    spreads = read(vary, scene.rotor.gravity) or defaults(scene)
    for axis in spreads:
        if axis.spread is None or axis.name == SPEEDS:
            problem = "expected a distribution: START:STOP (even), log:START:STOP or normal:MEAN:DEVIATION"
            raise BadInput(problem, key=f"--vary {axis.name}")
    return spreads


def defaults(scene: Scene) -> tuple[Axis, ...]:
    """What is hardly ever known well of a damper, about a scene's own values."""
    assert scene.damper is not None
    known = scene.damper.uncertain(limits.solids(scene)).items()
    spreads = {f"damper.{name}": Spread(*spread) for name, spread in known if spread[1] > spread[0]}
    return tuple(Axis(find(name, "--vary"), (), spread) for name, spread in spreads.items())


def plan(axes: Sequence[Axis], speeds: Sequence[float], base: int, seed: int) -> Plan:
    """Saltelli's design over uncertain axes."""
    if isinstance(base, bool) or not isinstance(base, int | np.integer) or base < 8 or base & (base - 1):
        raise BadInput("expected a power of two from 8 on as base points", key="--sample", value=base)
    base = int(base)
    ordered = in_order(axes, speeds)
    require_possible(float(base) * (len(axes) + 2) * speeds_of_a_point(ordered), "--sample", base)
    from SALib.sample import sobol

    shares = sobol.sample(_problem(len(axes)), base, calc_second_order=False, scramble=True, seed=seed)
    return at_shares(ordered, shares, {"seed": seed, "design": "Saltelli"})


def indices(values: Floats, parameters: int, seed: int) -> dict[str, Floats]:
    """Sobol' indices of a quantity on Saltelli's design, with half-widths of their 95 % confidence intervals.

    Args:
        values: of the quantity at the points of the design, shape (base (parameters + 2),). Base points of which one
            has no answer are left out.
        parameters: how many there are.
        seed: of the resampling.

    Returns:
        ``S1``, ``S1_conf``, ``ST`` and ``ST_conf``, shape (parameters,) each; 0 where the quantity does not vary, nan
        where too few base points have an answer.
    """
    groups = values.reshape(-1, parameters + 2)
    groups = groups[np.isfinite(groups).all(axis=1)]
    if len(groups) < 8:
        return dict.fromkeys(INDICES, np.full(parameters, np.nan))
    if np.ptp(groups) <= _CONSTANT * np.abs(groups).max():
        return dict.fromkeys(INDICES, np.zeros(parameters))
    from SALib.analyze import sobol

    how: dict[str, Any] = {"num_resamples": _RESAMPLES, "conf_level": _CONFIDENCE, "seed": seed or 1}  # 0: none
    result = sobol.analyze(_problem(parameters), groups.ravel(), calc_second_order=False, **how)
    return {name: np.asarray(result[name], dtype=float) for name in INDICES}


def independent(values: Floats, parameters: int) -> Floats:
    """The values of the points in which everything is drawn, out of all of Saltelli's design."""
    groups = values.reshape(-1, parameters + 2)
    return np.concatenate([groups[:, 0], groups[:, -1]])


def with_indices(data: xr.Dataset, seed: int = 0) -> xr.Dataset:
    """Percentiles and indices of a study on Saltelli's design, beside all that it has already.

    Returns:
        The data set with ``percentiles`` (quantity, percentile, speed), and ``S1``, ``S1_conf``, ``ST``, ``ST_conf``
        (quantity, parameter, speed).
    """
    names = [name for name in store.keys_of(data) if data[name].dims == (SAMPLE,)]

    def percentiles(values: Floats) -> Floats:
        known = independent(values, len(names))
        if not np.isfinite(known).any():
            return np.full(len(PERCENTILES), np.nan)
        return np.asarray(np.nanpercentile(known, PERCENTILES))

    def shares(values: Floats) -> Floats:
        return np.stack([*indices(values, len(names), seed).values()])

    table = np.stack([data[quantity].transpose(SPEEDS, SAMPLE).values.astype(float) for quantity in QUANTITIES])
    spread, estimates = (np.moveaxis(np.apply_along_axis(of, 2, table), 1, -1) for of in (percentiles, shares))
    along = {name: (("quantity", "parameter", SPEEDS), estimates[:, k]) for k, name in enumerate(INDICES)}
    added = data.assign(along | {"percentiles": (("quantity", "percentile", SPEEDS), spread)})
    words = {"quantity": np.array(QUANTITIES, dtype=object), "parameter": np.array(names, dtype=object)}
    known = {name: (name, values) for name, values in (words | {"percentile": np.array(PERCENTILES)}).items()}
    return added.assign_coords(known)


def worth_measuring(data: xr.Dataset, quantity: str, k: int) -> list[tuple[str, float, float]]:
    """The parameters of a quantity at a speed: name, total index and its half-width, the greatest first."""
    point = data.sel(quantity=quantity).isel({SPEEDS: k})
    totals = zip(map(str, data["parameter"].values), point["ST"].values, point["ST_conf"].values, strict=True)
    return sorted(((n, float(t), float(c)) for n, t, c in totals if np.isfinite(t)), key=lambda item: -item[1])


def _problem(parameters: int) -> dict[str, Any]:
    """Shares from 0 to 1, as SALib calls them; what they stand for are the spreads of the axes."""
    names = [f"x{k}" for k in range(parameters)]
    return {"num_vars": parameters, "names": names, "bounds": [[0.0, 1.0]] * parameters}
