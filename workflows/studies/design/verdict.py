"""What there is to say of the best design, by whichever goal it was found."""

from __future__ import annotations

from workflows.studies.design import of_amplitude, of_damping, words
from workflows.studies.design.amplitude import LeastAmplitude
from workflows.studies.design.damping import LeastDamping
from workflows.studies.design.holds import Holds
from workflows.studies.design.scored import Found
from workflows.studies.design.space import Space
from workflows.wording import significant


def verdict(space: Space, found: Found) -> str:
    """The answer in a line."""
    goal = space.goal
    return of_damping.verdict(found, goal) if isinstance(goal, LeastDamping) else of_amplitude.verdict(found)


def sentences(space: Space, found: Found, held: tuple[Holds, ...]) -> list[str]:
    """What carries it, and what holds it; or why nothing works."""
    scored, goal = found.scored, space.goal
    if not scored.works:
        return _why_none(space, found)
    lines = [
        f"The best of {found.evaluations} designs tried: {words.best(space, found)}; its balls weigh"
        f" {significant(1e3 * scored.mass)} g."
    ]
    if isinstance(goal, LeastDamping):
        lines += of_damping.sentences(space, found, goal)
    elif isinstance(goal, LeastAmplitude):
        lines += of_amplitude.sentences(found, goal)
    what = "damping" if isinstance(goal, LeastDamping) else "amplitude"
    for each in held:
        gain = "" if each.gain is None else f"; 5 % further would change the {what} by {100 * each.gain:+.1f} %"
        lines.append(f"What holds it: {each.said}{gain}.")
    if not held:
        lines.append("No limit holds it: the best lies inside all ranges.")
    return lines


def _why_none(space: Space, found: Found) -> list[str]:
    goal = space.goal
    if found.scored.impossible:
        return [f"The design that comes nearest cannot be: {found.scored.why}."]
    if isinstance(goal, LeastDamping):
        return of_damping.why_none(space, found, goal)
    return of_amplitude.why_none(space, found, goal) if isinstance(goal, LeastAmplitude) else []
