"""Parts of sentences that the answer, the remarks and the studies' reports share, and the marks of their tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

from workflows.formatting import significant, whole
from workflows.scene.materials import KNOWN, OSMIUM, is_too_dense
from workflows.solve import limits
from workflows.solve.results import Results, SpeedPoint

PRINTED = "the equations as printed do not conserve energy"
WEIGHT = "the ball's weight, which is left out, is more than the load"

BEYOND, BEYOND_MEANS = "†", "† At a larger amplitude, or a higher speed, than the plate endures"
NO_VERDICT, NO_VERDICT_MEANS = "‡", "‡ A speed that the answer gives no verdict on"
AT_REST, AT_REST_MEANS = "*", "* Up to there a ball at rest stays at rest; the ring-down itself shows no cut-off."
"""Marks of numbers in tables, and what they stand for below."""


def at_load(point: SpeedPoint) -> str:
    """Where in the range of speeds, within a sentence."""
    return f"at {whole(point.rpm)} rpm" if point.load_g > 0 else "at rest"


def at_speed(point: SpeedPoint) -> str:
    """A speed with its load."""
    return f"{whole(point.rpm)} rpm ({whole(point.load_g)} g)"


def stretch(chosen: Sequence[SpeedPoint], points: Sequence[SpeedPoint]) -> str:
    """Where some of the points lie among all, in few words: up to, from, from ... to; both with rising load."""
    places = sorted(points, key=lambda point: point.load_g)
    at = sorted(places.index(point) for point in chosen)
    first, last = (at_speed(places[k]) for k in (at[0], at[-1]))
    if len(at) == 1:
        return f"at {first}"
    if at[-1] - at[0] >= len(at):
        among = f"at {len(at)} of {len(places)} speeds from {first} to {last}"
        return f"at {first} and {last}" if len(at) == 2 else among
    if len(at) == len(places) or (at[0] > 0 and at[-1] < len(places) - 1):
        return f"from {first} to {last}"
    return f"up to {last}" if at[0] == 0 else f"from {first} on"


def capital(text: str) -> str:
    """The text as the begin of a sentence."""
    return text[0].upper() + text[1:]


def millimetres(length: float) -> str:
    """A length [m] in mm."""
    return significant(1e3 * length, 2)


def percent(share: float) -> str:
    """A share in percent."""
    return significant(100 * share, 2)


def mark(results: Results, point: SpeedPoint) -> str:
    """What a table puts beside the damper's figures at a speed; empty where they are as good as the answer."""
    figures, verdict = point.working, point.verdict
    if figures is None or verdict is None:
        return ""
    if limits.is_beyond(results, point):
        return BEYOND
    return NO_VERDICT if verdict.rank < 0 or (point.load_g == 0 and figures.peak > 0) else ""


def legend(results: Results) -> list[str]:
    """What the marks of the damper's figures stand for, as far as a table over all speeds has them."""
    meanings = {
        BEYOND: f"{BEYOND_MEANS}; what is left below that is in the answer above.",
        NO_VERDICT: f"{NO_VERDICT_MEANS}.",
    }
    marks = {mark(results, point) for point in results.speeds}
    return [meaning for each, meaning in meanings.items() if each in marks]


def cutoff_mark(results: Results, point: SpeedPoint) -> str:
    """What a table puts beside a cut-off that no ring-down shows."""
    return AT_REST if limits.cutoff(results, point).at_rest else ""


def cutoff_legend(results: Results) -> list[str]:
    """What the mark of cut-offs stands for, where a table has it."""
    return [AT_REST_MEANS] if any(cutoff_mark(results, point) for point in results.speeds) else []


def beyond(*, by_deflection: bool) -> str:
    """What a larger amplitude than the plate endures would do to it."""
    if by_deflection:
        return f"bend the plate by over {100 * limits.SMALL:g} % of its length, beyond what it can be computed for"
    return f"strain the plate's root by over {100 * limits.ENDURED:g} %, which no blade metal endures in vibration"


def torn_from(results: Results) -> str | None:
    """From which of the speeds on the plate would tear, and by what stress; None where it holds at all."""
    torn = [point for point in results.speeds if limits.is_torn(results, point)]
    if not torn:
        return None
    first = min(torn, key=lambda point: point.omega)
    return torn_at(first.rpm, limits.root_stress(results, first.omega) or 0.0)


def torn_at(rpm: float, stress: float) -> str:
    """That a plate tears from a speed on."""
    return (
        f"from {whole(rpm)} rpm on: there the centrifugal pull at the root, {significant(stress / 1e6)} MPa on"
        f" average, is more than any blade metal bears ({significant(limits.STRONGEST / 1e6)} MPa)"
    )


def too_dense(results: Results) -> tuple[str, str] | None:
    """What of a ball is denser than any solid, and what would weigh as much; None where it is possible."""
    damper = results.scene.damper
    density = max((limits.ball_density(results, point) for point in results.speeds), default=0.0)
    if damper is None or not is_too_dense(density):
        return None
    volume = 4 / 3 * math.pi * damper.radius**3
    one, steel = density * volume, KNOWN["steel"].density
    together = one * damper.count
    return (
        f"a ball of radius {significant(1e3 * damper.radius)} mm and {significant(1e3 * one)} g would be"
        f" {significant(density / OSMIUM, 2)} times as dense as osmium, and nothing is denser",
        "The figures are those of feasible balls of the same total mass, such as"
        f" {math.ceil(together / (steel * volume))} of steel ([damper] count), each in a cavity"
        " of its own, moving in step.",
    )
