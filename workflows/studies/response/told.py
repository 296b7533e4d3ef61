"""What a forced response amounts to, in sentences."""

from __future__ import annotations

import numpy as np

from workflows.findings import possible, worth
from workflows.results.crossings import Crossing
from workflows.studies.response.peaks import HELPS, Row, endured, is_beyond, root_stress, rows
from workflows.studies.response.records import Response, Through
from workflows.wording import significant, whole


def sentences(found: Response) -> list[str]:
    """Whether the ball helps, in one plain sentence; then each crossing."""
    said = [_verdict(found)] + [_sentence(found, through) for through in found.passed]
    if (dense := possible.too_dense(found.results)) is not None:
        said = [f"No verdict: {dense[0]}.", dense[1], *said[1:]]
    if _undamped(found):
        said = [f"No verdict: {_UNDAMPED}."]
    for crossing, why in found.idle:
        said.append(f"{place(crossing)}: nothing to follow, {why}.")
    return said


_UNDAMPED = (
    "without damping of its own ([damper] damping_ratio) the structure has no bound at resonance, so that there is no"
    " amplitude that the ball could be held against; give it what the air or its clamp takes, such as 0.001"
)


def _undamped(found: Response) -> bool:
    given = found.results.scene.damper
    return given is not None and given.damping_ratio == 0 and bool(found.passed)


def _verdict(found: Response) -> str:
    """Whether the ball helps anywhere where the plate endures it, and up to which force it does."""
    helped = [row for row in rows(found) if row.ratio <= HELPS and not is_beyond(found, row)]
    orders = _listed(sorted({through.crossing.order for through in found.passed}))
    if not found.passed:
        return "No crossing is driven at the damper's place."
    if not helped:
        bearable = "" if found.strain_per_amplitude is None else " at any amplitude and speed that its root endures"
        return f"No: at order{orders} the ball does not help{bearable}."
    takes = f"the ball takes up to {significant(100 * (1 - min(row.ratio for row in helped)), 2)} % of the amplitude"
    limits = _limits(found, helped)
    if not any(limits.values()):
        return f"Yes: at order{_listed(sorted(limits))} {takes} at resonance."
    where = [f"{limit} at order {order}" if limit else f"at order {order}" for order, limit in sorted(limits.items())]
    return f"Yes, {' and '.join(where)}: {takes} at resonance. Larger forces are more than the plate endures."


def _limits(found: Response, helped: list[Row]) -> dict[int, str]:
    """Order by order, up to which force the plate endures what the ball helps against; empty where up to the last."""
    limits = {row.through.crossing.order: "" for row in helped}
    for through in found.passed:
        mine = [row for row in helped if row.through is through]
        if mine and any(is_beyond(found, row) for row in rows(found) if row.through is through):
            greatest = max(row.force for row in mine)
            limits[through.crossing.order] = f"up to {significant(greatest)} {found.excitation.unit}"
    return limits


def _listed(orders: list[int]) -> str:
    """Of a few orders, as the end of a word: s 2 and 3."""
    words = [str(order) for order in orders]
    return f" {words[0]}" if len(words) == 1 else f"s {', '.join(words[:-1])} and {words[-1]}"


def place(c: Crossing) -> str:
    """Where an order meets a mode."""
    return f"Order {c.order} meets the {c.family} mode at {whole(c.rpm)} rpm without a ball"


def _sentence(found: Response, through: Through) -> str:
    c, unit = through.crossing, found.excitation.unit
    where = f"{place(c)}, {significant(c.frequency_hz)} Hz"
    every = [row for row in rows(found) if row.through is through]
    borne = [row for row in every if not is_beyond(found, row)]
    mine = borne if any(row.ratio <= HELPS for row in borne) else every
    best = min(mine, key=lambda row: row.ratio)
    begins = _begins(found, through)
    if best.ratio > HELPS:
        left, most = significant(100 * best.ratio, 4), significant(100 * (1 - HELPS), 1)
        return (
            f"{where}: the ball does not help. Under no force followed does it take {most} % of the amplitude; at best"
            f" {left} % of it are left{begins}"
        )
    helped = [row.force for row in mine if row.ratio <= HELPS]
    span = significant(helped[0]) if len(helped) == 1 else f"{significant(helped[0])} to {significant(helped[-1])}"
    cut = significant(100 * (1 - best.ratio), 2)
    if mine is every and any(is_beyond(found, row) for row in mine if row.ratio <= HELPS):
        cut += " %, but only where the root of a blade does not endure it; it takes"
        return f"{where}: the ball takes up to {cut} that at {span} {unit}{begins}"
    return f"{where}: the ball helps at {span} {unit}, taking up to {cut} % of the amplitude{begins}"


def _begins(found: Response, through: Through) -> str:
    """From which force on the ball moves, and what the root then bears."""
    least, unit = through.least_force, found.excitation.unit
    if least == 0:
        return "; nothing holds it at rest."
    if not np.isfinite(least):
        return "; it never moves."
    stress, force = root_stress(found, through), significant(least)
    if stress is None:
        return f"; it begins to move at {force} {unit}."
    per_force = float(np.abs(through.shaped(through.states.without)).max(axis=0)[0]) / through.forces[0]
    there = significant(1e-6 * stress * per_force * least)
    limit = endured(found, through)
    much = ", more than blades endure" if limit is not None and per_force * least > limit else ""
    return f"; it begins to move at {force} {unit}, where the root without a ball bears {there} MPa{much}."


def text(found: Response) -> str:
    """What a person reads on the terminal."""
    lines = [found.results.scene.title, *sentences(found), ""]
    heads = (
        "order",
        "mode",
        "largest at, rpm",
        f"{found.excitation.kind}, {found.excitation.unit}",
        "without, mm",
        "with, mm",
        "ratio",
        "regime",
        "hits",
        "short way off",
    )
    table = [heads, *(_cells(found, row) for row in rows(found))]
    widths = [max(len(cells[k]) for cells in table) for k in range(len(heads))]
    lines += ["  ".join(cell.rjust(width) for cell, width in zip(cells, widths, strict=True)) for cells in table]
    if any(is_beyond(found, row) for row in rows(found)):
        lines.append(f"{worth.MARKED}.")
    low, high = (significant(100 * ratio, 2) for ratio in worth.AIR)
    for through in found.passed:
        figures, c = through.figures, through.crossing
        if figures.peak > 0:
            ends = " to ".join(significant(1e3 * end) for end in figures.range)
            lines.append(
                f"order {c.order}: the ball's damping ratio is {significant(100 * figures.peak, 2)} % at most, at"
                f" {significant(1e3 * figures.peak_amplitude)} mm; it works from {ends} mm; the air alone gives blades"
                f" {low} to {high} %"
            )
    return "\n".join(lines)


def _cells(found: Response, row: Row) -> tuple[str, ...]:
    c = row.through.crossing
    off = "–" if row.difference is None else f"{significant(100 * row.difference, 2)} %"
    return (
        str(c.order),
        f"{c.family} {c.branch + 1}",
        whole(row.rpm),
        significant(row.force),
        significant(1e3 * row.without, 4),
        f"{significant(1e3 * row.mean, 4)}{worth.MARK if is_beyond(found, row) else ''}",
        significant(row.ratio, 4),
        row.regime,
        significant(row.hits_per_cycle),
        off,
    )
