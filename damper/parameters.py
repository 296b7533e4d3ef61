"""The numbers behind dampers, as arrays: validation and derived quantities, for one damper or many alike."""

from __future__ import annotations

from numbers import Integral, Real
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from damper.arrays import Floats

PARAMETERS = np.dtype(
    [
        ("modal_mass", "f8"),
        ("stiffness", "f8", 2),
        ("ball_mass", "f8"),
        ("ball_radius", "f8"),
        ("cavity", "f8", 2),
        ("centrifugal_acceleration", "f8"),
        ("restitution", "f8"),
        ("friction", "f8"),
        ("rolling_friction", "f8"),
        ("damping_ratio", "f8"),
        ("sticking_ratio", "f8"),
        ("floor_friction", "f8"),  # 0: no slip
        ("floor_tilt", "f8", 2),
        ("floor_radius", "f8", 2),  # inf: flat
        ("rotation", "f8"),
        ("stagger", "f8"),
        ("printed", "?"),
    ]
)
"""One row per damper; the fields are those of `damper.ParticleDamper`, in SI."""

Parameters = npt.NDArray[np.void]


def ensemble(base: Parameters, size: int, varied: dict[str, Any]) -> Parameters:
    """`size` rows that differ from the one row `base` in the varied fields, of shape (size,) or, in x and y, (size, 2).

    Raises:
        ValueError: an unknown field, a wrong shape, or a value without physical sense.
    """
    rows = np.repeat(base, size)
    for name, values in varied.items():
        if name not in (PARAMETERS.names or ()) or name == "printed":
            raise ValueError(f"{name} is no field of ParticleDamper that can be varied")
        array = table(name, values)
        if array.shape[:1] != (size,) or array.shape[1:] not in {(), rows[name].shape[1:]}:
            raise ValueError(f"{name} must have {size} values, one for each release, got shape {array.shape}")
        if name == "floor_friction":  # in the rows 0 stands for no slip, which is for the whole batch to say
            _require(array > 0, name, array, "positive")
        rows[name] = array[:, None] if array.ndim < rows[name].ndim else array
    validate(rows)
    return rows


def number(name: str, value: object) -> float:
    """The value as a float.

    Raises:
        ValueError: it is text, a truth value or anything else; named.
    """
    if isinstance(value, bool) or not isinstance(value, Real):
        raise ValueError(f"{name} must be a number, got {value!r}")
    try:
        return float(value)
    except OverflowError as error:  # a whole number of more than 308 digits
        raise ValueError(f"{name} must be finite") from error


def whole(name: str, value: object) -> int:
    """The value as a whole number from 1 on.

    Raises:
        ValueError: it is anything else; named.
    """
    if isinstance(value, bool) or not isinstance(value, Integral) or value < 1:
        raise ValueError(f"{name} must be a whole number of at least 1, got {value!r}")
    return int(value)


def table(name: str, values: npt.ArrayLike) -> Floats:
    """The values as an array.

    Raises:
        ValueError: they are not numbers, or too large for one; named.
    """
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name} must be numbers: {error}") from error


def pair(name: str, value: object) -> tuple[float, float]:
    """The value as two floats.

    Raises:
        ValueError: it is not two numbers; named.
    """
    if not isinstance(value, tuple | list | np.ndarray) or len(value) != 2:
        raise ValueError(f"{name} must be two numbers, along x and y, got {value!r}")
    return number(name, value[0]), number(name, value[1])


def validate(rows: Parameters) -> None:
    """Look whether every quantity makes physical sense.

    Raises:
        ValueError: one does not; field and value are named.
    """
    for name in ("modal_mass", "stiffness", "ball_mass", "ball_radius"):
        _require(rows[name] > 0, name, rows[name], "positive")
    for name in (
        "centrifugal_acceleration",
        "friction",
        "rolling_friction",
        "damping_ratio",
        "sticking_ratio",
        "floor_friction",
    ):
        _require(rows[name] >= 0, name, rows[name], "≥ 0")
    for name in ("floor_tilt", "rotation", "stagger"):
        _require(np.isfinite(rows[name]), name, rows[name], "finite")
    steep = np.abs(rows["floor_tilt"]) * rows["ball_radius"][:, None]
    _require(
        steep <= 1.0, "floor_tilt", rows["floor_tilt"], "at most 1 / ball_radius, beyond which floors are no floors"
    )
    fits = rows["floor_radius"] > rows["ball_radius"][:, None]
    _require(fits, "floor_radius", np.minimum(rows["floor_radius"], 1e300), "more than the ball's radius")
    for name in ("friction", "floor_friction"):
        _require(rows[name] <= 1e6, name, rows[name], "at most 1e6")
    e, zeta = rows["restitution"], rows["damping_ratio"]
    _require((e >= 0) & (e <= 1), "restitution", e, "between 0 and 1")
    _require(zeta < 1, "damping_ratio", zeta, "at least 0 and below 1")
    fits = rows["cavity"] >= 2 * rows["ball_radius"][:, None] * (1 - 1e-12)
    _require(fits, "cavity", rows["cavity"], "at least the ball's diameter")
    if (rows["printed"] & (rows["floor_friction"] > 0)).any():
        raise ValueError("floor_friction: the printed equations know no slip; use the consistent formulation")
    if (rows["printed"] & ~level(rows)).any():
        raise ValueError("the printed equations know a level floor only; use the consistent formulation")


def stuck_frequency(rows: Parameters) -> Floats:
    """omega_1 along x, the ball stuck, shape (n,) [rad/s]."""
    omega: Floats = np.sqrt(rows["stiffness"][:, 0] / (rows["modal_mass"] + rows["ball_mass"]))
    return omega


def half_gap(rows: Parameters) -> Floats:
    """How far the ball's centre can go from the cavity's centre along x and y, shape (n, 2) [m]."""
    gap: Floats = np.maximum(0.5 * rows["cavity"] - rows["ball_radius"][:, None], 0.0)
    return gap


def rolling_threshold(rows: Parameters) -> Floats:
    """a_r = mu_r N / (r m_p), shape (n,) [m/s^2]."""
    threshold: Floats = rows["rolling_friction"] / rows["ball_radius"] * rows["centrifugal_acceleration"]
    return threshold


def inertia_ratio(rows: Parameters) -> Floats:
    """Beta in  s'' = -beta (u'' - a_r sigma), shape (n,) [-]; see `ParticleDamper.inertia_ratio`."""
    return np.where(rows["centrifugal_acceleration"] == 0, 1.0, np.where(rows["printed"], 5 / 2, 5 / 7))


def spin_mass(rows: Parameters) -> Floats:
    """Mass-equivalent of the rolling ball's spin, shape (n,) [kg]; see `ParticleDamper.spin_mass`."""
    return np.where(rows["printed"] | (rows["centrifugal_acceleration"] == 0), 0.0, 0.4 * rows["ball_mass"])


def path_curvature(rows: Parameters) -> Floats:
    """1 / rho of the path of the ball's centre on the cavity's floor along x and y, shape (n, 2) [1/m]."""
    curvature: Floats = 1.0 / (rows["floor_radius"] - rows["ball_radius"][:, None])
    return curvature


def in_plane(rows: Parameters) -> Floats:
    """Omega² P, shape (n, 2, 2) [1/s²]: how the spin draws a ball outwards along x (flap) and y (chord)."""
    sine, cosine = np.sin(rows["stagger"]), np.cos(rows["stagger"])
    projection = np.array([[sine * sine, -sine * cosine], [-sine * cosine, cosine * cosine]])
    drawn: Floats = np.moveaxis(projection * rows["rotation"] ** 2, -1, 0)
    return drawn


def level(rows: Parameters) -> npt.NDArray[np.bool_]:
    """Whether the load pulls the ball to no side, wherever structure and ball are, shape (n,)."""
    bent = (rows["floor_tilt"] != 0).any(axis=1) | np.isfinite(rows["floor_radius"]).any(axis=1)
    still: npt.NDArray[np.bool_] = (rows["rotation"] == 0) & ((rows["centrifugal_acceleration"] == 0) | ~bent)
    return still


def energy(rows: Parameters, state: npt.NDArray[Any]) -> Floats:
    """Energy of structure and ball, shape (n,) [J], from records with fields u, v, w, spin, shape (n, 2 axes).

    Sum over the axes of  K u^2 / 2 + M2 v^2 / 2 + m_p (v + w)^2 / 2, and for a rolling ball 2/5 m_p spin^2 / 2.
    """
    u, v, w, spin = state["u"], state["v"], state["w"], state["spin"]
    m2, ball, sphere = (m[:, None] for m in (rows["modal_mass"], rows["ball_mass"], spin_mass(rows)))
    twice = rows["stiffness"] * u**2 + m2 * v**2 + ball * (v + w) ** 2 + sphere * spin**2
    total: Floats = 0.5 * twice.sum(axis=1)
    return total


def _require(holds: npt.NDArray[np.bool_], name: str, values: npt.NDArray[Any], rule: str) -> None:
    bad = ~(holds & np.isfinite(values))
    if bad.any():
        raise ValueError(f"{name} must be {rule}, got {values[bad][0]:g}")
