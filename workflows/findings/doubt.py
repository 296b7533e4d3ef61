"""Speeds that have no verdict, for the model does not hold there, and what a verdict rests on at the others."""

from __future__ import annotations

from collections.abc import Sequence

from workflows.findings import possible, worth
from workflows.findings.said import stretch
from workflows.findings.worth import Grade
from workflows.solve.records import Results, SpeedPoint
from workflows.wording import span

Graded = tuple[SpeedPoint, Grade]

WEIGHT = "the ball's weight, which is left out, is more than the load"


def held(grades: Sequence[Graded]) -> list[SpeedPoint]:
    """The points that a verdict can be given on."""
    return [point for point, grade in grades if grade is not Grade.UNKNOWN]


def none(results: Results, grades: Sequence[Graded]) -> str:
    """The verdict where there is none at any of the points: why; and where, if there are several reasons."""
    reasons, torn = _reasons(results, grades), possible.torn_from(results)
    if torn is None and len(reasons) == 1:
        return f"No verdict: {reasons[0][1]}"
    return f"No verdict {'; none '.join(_placed(reasons, grades, torn))}"


def beside(results: Results, grades: Sequence[Graded], verdict: str) -> str:
    """A verdict with what it rests on, and with the speeds that it does not speak of."""
    unsaid = _placed(_reasons(results, grades), grades, possible.torn_from(results))
    return "; no verdict ".join([f"{verdict}{_gripped(results, grades)}", *unsaid])


def _placed(reasons: list[tuple[list[SpeedPoint], str]], grades: Sequence[Graded], torn: str | None) -> list[str]:
    points = [point for point, _ in grades]
    placed = [f"{stretch(those, points)}: there {why}" for those, why in reasons]
    return placed if torn is None else [*placed, torn]


def _reasons(results: Results, grades: Sequence[Graded]) -> list[tuple[list[SpeedPoint], str]]:
    """Which of the points have no verdict and why, but for those at which the plate would tear."""
    found = [p for p, grade in grades if grade is Grade.UNKNOWN and not possible.torn(results, p)]
    light, sliding = [p for p in found if worth.weighs(p)], [p for p in found if not worth.weighs(p)]
    reasons = [(light, WEIGHT)] if light else []
    if sliding:
        takes = f"a friction of {_grips(results, sliding)} at the amplitude of its best"
        reasons.append((sliding, f"the ball would slide, for to roll takes {takes}"))
    return reasons


def _gripped(results: Results, grades: Sequence[Graded]) -> str:
    """What a verdict rests on where the ball rolls only on a floor that grips better than the walls."""
    damper = results.scene.damper
    if damper is None:
        return ""
    better = [p for p in held(grades) if _grip(results, p) > damper.friction]
    if not better:
        return ""
    return (
        ", if the ball rolls without slip, which at the amplitude of its best takes a friction of"
        f" {_grips(results, better)} {stretch(better, [p for p, _ in grades])}: {damper.friction:g} is given for the"
        " walls"
    )


def _grips(results: Results, points: Sequence[SpeedPoint]) -> str:
    """The least and the most friction that rolling takes at the points."""
    each = [_grip(results, point) for point in points]
    return span(min(each), max(each))


def _grip(results: Results, point: SpeedPoint) -> float:
    found = worth.best(results, point)
    return 0.0 if found is None else worth.grip(results, point, found.amplitude)
