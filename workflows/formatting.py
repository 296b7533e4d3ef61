"""Numbers in sentences: as many digits as they deserve, and no powers of ten where a plain number reads well."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from fem.rotor import in_rpm

if TYPE_CHECKING:
    from markupsafe import Markup

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""Superscripts, for `str.translate`."""

_CODE = re.compile("`([^`\n]+)`")

_SPEEDS_LISTED = 4
_ROUNDED = 1e-9
"""Share that rounding may leave over, of the energy of a long ring-down say."""

_READABLE = {
    "m": (1e3, "mm"),
    "kg": (1e3, "g"),
    "Pa": (1e-6, "MPa"),
    "rad/s": (in_rpm(1.0), "rpm"),
    "rad": (180 / math.pi, "deg"),
    "1": (1.0, ""),
}

DASH = "–"
"""Stands for a number that is not there."""


def readable(unit: str) -> tuple[float, str]:
    """The unit that people read instead of one in SI: the factor to it, and its name; empty for plain numbers."""
    return _READABLE.get(unit, (1.0, unit))


def exact_mm(length: float) -> str:
    """A length [m] in millimetres, with the digits that somebody may have typed."""
    return f"{1e3 * length:.6g} mm"


def whole(value: float) -> str:
    """A speed or a load within a sentence: whole numbers from 100 on, three significant digits below."""
    return f"{value:.0f}" if abs(value) >= 100 else significant(value)


def significant(value: float | None, digits: int = 3) -> str:
    """A number in so many significant digits: 0.00021, 12, 470000, 3.2·10⁻⁹."""
    if value is None or not math.isfinite(value):
        return DASH
    if value == 0:
        return "0"
    power = math.floor(math.log10(abs(value)))
    if -5 <= power <= 6:
        rounded = float(f"{value:.{digits - 1}e}")
        text = f"{rounded:.{max(digits - 1 - power, 0)}f}"
        return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", "\u2212")
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa}·10{str(int(exponent)).translate(RAISED)}".replace("-", "\u2212")


def apart(value: float, other: float, digits: int = 2) -> int:
    """Significant digits, at least so many, in which a number does not read like another that it is compared with."""
    return next((n for n in range(digits, 17) if significant(value, n) != significant(other, n)), digits)


def beside(value: float, other: float, digits: int = 2) -> str:
    """A number in so many digits, or as many as it takes not to read like another that it is compared with."""
    return significant(value, apart(value, other, digits))


def interval(low: str, high: str, joint: str = " to ", before: str = "", alone: str = "") -> str:
    """A range, after a word; or, where both its ends read the same, one of them, after another word."""
    return f"{before}{low}{joint}{high}" if low != high else f"{alone}{low}"


def span(low: float, high: float, digits: int = 2) -> str:
    """The same of two numbers."""
    return interval(significant(low, digits), significant(high, digits))


def fixed(value: float | None, places: int = 0) -> str:
    """A number for a column: so many decimals, a thin space between thousands, a dash where there is none."""
    if value is None or not math.isfinite(value):
        return DASH
    text = f"{value:z,.{places}f}"  # z: no -0
    return text.replace(",", "\u2009").replace("-", "\u2212")


def amount(value: float | None) -> str:
    """A number for a column whose rows differ by powers of ten: whole ones from 100 on, three digits below."""
    return fixed(value) if value is not None and abs(value) >= 100 else significant(value)


def percent(value: float | None, places: int = 2) -> str:
    """A share as a percentage for a column; a loss below 0 that is more than rounding stays one."""
    if value is None:
        return DASH
    hidden = -0.5 * 0.1**places < 100 * value < -100 * _ROUNDED
    return significant(100 * value, 2) if hidden else fixed(100 * value, places)


def share(value: float | None, digits: int = 3) -> str:
    """A share as a percentage in few digits, as of what scatters; what rounding leaves is 0."""
    return significant(None if value is None else 100 * value if abs(value) > _ROUNDED else 0.0, digits)


def upwards(error: float) -> str:
    """An error in one digit, not less than it is."""
    step = 10.0 ** math.floor(math.log10(error))
    return f"{math.ceil(error / step * (1 - 1e-9)) * step:.1g}"


def plain(text: str) -> str:
    """A text for a terminal: what `backticks` mark as typed stands as it is typed."""
    return _CODE.sub(r"\1", text)


def prose(text: str) -> Markup:
    """A text for a page, escaped: typographic apostrophes, and what `backticks` mark as code."""
    from markupsafe import Markup, escape

    return Markup(_CODE.sub(r"<code>\1</code>", str(escape(text.replace("'", "\u2019")))))


def rounded_rpm(omega: float) -> float:
    """Revolutions per minute of a speed [rad/s], without the last digits that the conversion leaves behind."""
    return float(f"{in_rpm(omega):.13g}")


def turning(omega: float) -> str:
    """A rotation speed [rad/s] within a sentence: 3500 rpm."""
    return f"{whole(rounded_rpm(omega))} rpm"


def revolutions(speeds: Sequence[float]) -> str:
    """Rotation speeds [rad/s] in rpm: each of a few, or how many from where to where."""
    if len(speeds) > _SPEEDS_LISTED:
        low, high = (f"{in_rpm(bound(speeds)):.6g}" for bound in (min, max))
        return f"{len(speeds)} speeds {interval(low, high, before='from ', alone='at ')} rpm"
    return f"{listed([f'{in_rpm(speed):.6g}' for speed in speeds])} rpm"


def listed(items: Sequence[float | str], joint: str = "and") -> str:
    """A few levels, or texts, in words."""
    texts = [each if isinstance(each, str) else significant(each) for each in items]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} {joint} {texts[-1]}"


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """The lines of a table, its heads first; cells that a row lacks at its end stay empty."""
    widths = [max(len(row[i]) for row in rows if i < len(row)) for i in range(len(rows[0]))]
    return ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=False)) for row in rows]
