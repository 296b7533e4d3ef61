"""The table of a thickness that varies over the planform: [plate.thickness]."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Self

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, model_validator

from workflows.scene import quantities as units
from workflows.scene.quantities import Lengths, Line, Table, fault, quantities, quantity_schema, si, wrong

if TYPE_CHECKING:
    from fem.meshes.thickness import Profile

GRID = 129
"""Places along each side of a rectangle at which a thickness is looked at."""

MOST_COEFFICIENTS = 12
"""Of a polynomial, along x and along y: in powers of metres higher ones drown in rounding."""


def _length_rows(value: object, info: ValidationInfo) -> tuple[tuple[float, ...], ...]:
    """Rows of lengths; of a plain list each is a row of its own."""
    if not isinstance(value, list | tuple) or not value:
        raise wrong("expected a list of lists of lengths, one list for each x")
    return tuple(quantities(row if isinstance(row, list | tuple) else [row], units.LENGTH, info) for row in value)


def _coefficients(value: object, info: ValidationInfo) -> tuple[tuple[float, ...], ...]:
    """Rows i of coefficients j of x^i y^j, each a length to the power 1 - i - j."""
    if not isinstance(value, list | tuple) or not value or not all(isinstance(r, list | tuple) and r for r in value):
        raise wrong("expected a list of lists, of x^i y^j the coefficient j in list i: [['5 mm'], ['-0.01 mm/mm']]")
    if max(len(value), *map(len, value)) > MOST_COEFFICIENTS:
        raise wrong(f"expected at most {MOST_COEFFICIENTS} lists of at most {MOST_COEFFICIENTS} coefficients")
    return tuple(
        tuple(si(item, units.length_power(1 - i - j), info) for j, item in enumerate(row))
        for i, row in enumerate(value)
    )


_ROWS = {"type": "array", "items": quantity_schema(units.LENGTH), "minItems": 1}
LengthRows = Annotated[
    tuple[tuple[float, ...], ...],
    BeforeValidator(_length_rows),
    WithJsonSchema({"type": "array", "items": {"anyOf": [quantity_schema(units.LENGTH), _ROWS]}, "minItems": 1}),
]
_COEFFICIENT = {"anyOf": [{"type": "number"}, {"type": "string"}], "examples": ["5 mm", "-0.01 mm/mm"]}
Coefficients = Annotated[
    tuple[tuple[float, ...], ...],
    BeforeValidator(_coefficients),
    WithJsonSchema(
        {
            "type": "array",
            "items": {"type": "array", "items": _COEFFICIENT, "minItems": 1, "maxItems": MOST_COEFFICIENTS},
            "minItems": 1,
            "maxItems": MOST_COEFFICIENTS,
        }
    ),
]


class Thickness(Table):
    """A thickness that varies over the planform, symmetric about the flat mid-surface.

    A table over x and y, bilinear between its places; a polynomial in x and y; or a field of the mesh file. x and y are
    the plate's (the mesh file's, where there is one).
    """

    x: Lengths | None = Field(None, description="of a table: places along x, ascending")
    y: Lengths | None = Field(None, description="of a table: places across, ascending; left out: the same all across")
    values: LengthRows | None = Field(None, description="of a table: for each x a list of the thicknesses at each y")
    polynomial: Coefficients | None = Field(
        None, description="coefficients of x^i y^j, number j in list i; numbers without a unit are in powers of m"
    )
    field: Line | None = Field(
        None, description="point data of the mesh file, in the unit of its coordinates, linear between its points"
    )

    @model_validator(mode="after")
    def _one(self) -> Self:
        """One way of giving a thickness that varies, and a table whose parts fit together."""
        given = [key for key in ("values", "polynomial", "field") if getattr(self, key) is not None]
        if len(given) != 1:
            raise fault(
                given[-1] if given else "values",
                f"expected one of a table (x, y, values), a polynomial and a field of the mesh file"
                f"{': leave one out' * bool(given)}",
            )
        if self.values is not None:
            self._fits(self.values)
        for key in ("x", "y") if self.values is None else ():
            if getattr(self, key) is not None:
                raise fault(key, "belongs to a table with values: leave it out")
        return self

    def _fits(self, values: tuple[tuple[float, ...], ...]) -> None:
        """The parts of a table, together."""
        if self.x is None:
            raise fault("x", "missing: the places along x of the table's values")
        for key, places in (("x", self.x), ("y", self.y or ())):
            if any(b <= a for a, b in pairwise(places)):
                raise fault(key, "expected places that ascend")
        columns = 1 if self.y is None else len(self.y)
        if len(values) != len(self.x) or any(len(row) != columns for row in values):
            what = "one thickness" if self.y is None else f"a list of {columns} thicknesses, one for each y,"
            raise fault("values", f"expected {what} for each of the {len(self.x)} places along x")
        if min(map(min, values)) <= 0.0:
            raise fault("values", "expected thicknesses above 0")

    def profile(self, field: Profile | None = None) -> Profile:
        """The thickness as `fem` takes it; `field`: that of the mesh file, where it is one.

        Raises:
            ValueError: it is a field of the mesh file, which is not given.
        """
        from fem.meshes.thickness import Bilinear, Polynomial

        if self.polynomial is not None:
            return Polynomial(self.polynomial)
        if self.values is not None:
            return Bilinear(self.x or (), self.y or (0.0,), self.values)
        if field is None:
            raise ValueError("a thickness from the mesh file needs the mesh")
        return field


def thickness_at(given: float | Thickness, place: tuple[float, float], field: Profile | None = None) -> float:
    """The thickness [m] at a place (x, y) [m]; `field` as in :meth:`Thickness.profile`."""
    return given if isinstance(given, float) else given.profile(field).near(place)


def extremes(given: float | Thickness, length: float, width: float) -> tuple[float, float]:
    """Least and greatest thickness [m] of a rectangle with these sides [m].

    Raises:
        ValueError: it is not above 0 all over the plate, or a table does not cover it.
    """
    if isinstance(given, float):
        return given, given
    import numpy as np

    from fem.meshes import thickness

    x, y = np.linspace(0.0, length, GRID), np.linspace(-0.5 * width, 0.5 * width, GRID)
    values = np.asarray(thickness.of(given.profile(), np.stack(np.meshgrid(x, y, indexing="ij"))))
    return float(values.min()), float(values.max())
