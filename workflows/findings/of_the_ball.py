"""What the answer says of the ball beside its figures: whether it rolls, at rest, and cycle by cycle."""

from __future__ import annotations

import math

from workflows.findings import worth
from workflows.findings.of_the_floor import rung_down
from workflows.solve.records import Damping, Results, SpeedPoint
from workflows.wording import significant, whole

_MORE = 1.1
"""A cycle's loss over that of the answer from which it is said why; cycles differ by some percent."""

_LIGHT = 10.0
"""Load over g down from which the ball's weight is worth a word: a tenth of it."""

_NOTHING = 1e-9
"""Share of the initial energy that rounding may book as lost."""


def weight(results: Results) -> str | None:
    """The ball's own weight, where it is not small beside the load."""
    points = [p for p, _, _ in rung_down(results) if 0 < p.load_g < _LIGHT]
    if not points:
        return None
    light = sorted(points, key=lambda point: point.load_g)
    ruled = [p for p in light if worth.weighs(p)]
    if len(ruled) == len(light):
        share = f"more than the load up to {whole(ruled[-1].rpm)} rpm" if ruled[1:] else "more than the load"
    else:
        seen = light[len(ruled)]
        share = f"{significant(100 / seen.load_g, 2)} % of the load at {whole(seen.rpm)} rpm"
    return (
        f"The ball's weight is left out: it is {share}. On a horizontal shaft it turns through the cavity once a"
        " revolution, on a vertical one it pulls the ball to one side."
    )


def at_rest(results: Results) -> str | None:
    """Where nothing turns there is no load: what works by it does nothing, and the answer leaves that speed out."""
    damper, loads = results.scene.damper, [p.load_g for p, _, _ in rung_down(results)]
    if damper is None or 0.0 not in loads:
        return None
    idle = [key for key in ("rolling_friction", "floor_radius") if getattr(damper, key)]
    text = "At 0 rpm no load presses the ball on its floor: it is free between the walls"
    text += f", and {' and '.join(idle)} {'does' if len(idle) == 1 else 'do'} nothing" if idle else ""
    return f"{text}. The answer speaks of the speeds at which there is a load." if any(loads) else f"{text}."


def lost_at_most(damping: Damping) -> float | None:
    """Share of its energy that a cycle loses at most: a ball that loses nothing only lends, and the rest is ζ's."""
    books, most = damping.energy, damping.peak_sdc
    by_the_ball = books.rolling + books.impact + books.slip
    return damping.intrinsic_sdc if most is not None and abs(by_the_ball) <= _NOTHING * books.initial else most


def lent(results: Results) -> str | None:
    """A cycle of a ring-down that takes more than a steady vibration loses, since the ball may give some of it back."""
    damper = results.scene.damper
    if damper is None or damper.formulation == "printed":
        return None
    borrowed = [(_share(d), p) for p, _, d in rung_down(results) if lost_at_most(d) != d.peak_sdc and d.impacts]
    if borrowed:
        share, point = max(borrowed, key=lambda pair: pair[0])
        return (
            f"Ball and structure exchange energy, and the ball loses none: at {whole(point.rpm)} rpm it takes up to"
            f" {significant(100 * share, 2)} % in a cycle and gives it back later. The table leaves that out; the curve"
            " over amplitude has it, as the paper's definition does."
        )
    found = [(_share(d), steady, p) for p, _, d in rung_down(results) if p.load_g > 0 and (steady := _steady(p)) > 0]
    most = max(found, key=lambda each: each[0] / each[1], default=None)
    if most is None or most[0] <= _MORE * most[1]:
        return None
    share, steady, point = most
    ball, mean = (significant(100 * each, 2) for each in (share, steady))
    return (
        f"At {whole(point.rpm)} rpm a cycle of the ring-down loses up to {ball} % to the ball, more than the {mean} %"
        " of a steady vibration at its best: a cycle's capacity counts all that the ball took from the structure in it,"
        " also what it gives back later; the answer counts what is lost for good."
    )


def _share(damping: Damping) -> float:
    """The most that the ball takes in a cycle, without what the structure's own damping loses."""
    return 0.0 if damping.peak_sdc is None else 1 - (1 - damping.peak_sdc) / (1 - damping.intrinsic_sdc)


def _steady(point: SpeedPoint) -> float:
    """What the ball loses in a cycle of a steady vibration at most, on the floor of the ring-down."""
    own = point.level or point.working
    return 0.0 if own is None or not own.peak > 0 else -math.expm1(-4 * math.pi * own.peak)
