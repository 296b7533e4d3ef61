"""How far the frequencies of a run can be trusted: the whole error, its parts, and whether it is what was asked for."""

from __future__ import annotations

from typing import NamedTuple

from fem.accuracy.theory_selection import DEAR
from workflows.effects.table import EFFECTS
from workflows.findings import missing
from workflows.solve.records import ErrorParts, Results
from workflows.wording import significant, upwards

PARTS = {
    "mesh": "mesh",
    "layers": "layers of the solid",
    "basis": "reduced basis",
    "theory": "theory",
    **{name: f"{kind.word} left out" for name, kind in EFFECTS.items() if name in ErrorParts.__annotations__},
}
"""Parts of an error, as people call them."""


class Worst(NamedTuple):
    """The largest error of a mode (its number, from 1) over the speeds, with its parts."""

    number: int
    whole: float
    parts: ErrorParts


def worst(results: Results) -> list[Worst]:
    """Mode by mode, those whose error is known."""
    found: dict[int, Worst] = {}
    for point in results.speeds:
        for number, mode in enumerate(point.modes, 1):
            whole, parts = mode.error_estimate, mode.error_parts
            if whole is not None and parts is not None and (number not in found or whole > found[number].whole):
                found[number] = Worst(number, whole, parts)
    return [found[number] for number in sorted(found)]


def met(results: Results) -> bool:
    """Whether no error, as far as it is known, is beyond the accuracy asked for."""
    return all(mode.whole <= results.scene.accuracy.frequency for mode in worst(results))


def sentence(results: Results) -> str | None:
    """How far the frequencies can be trusted, and what no error counts in; None if the errors are not known."""
    said = errors(results)
    return None if said is None else " ".join(part for part in (said, missing.sentence(results)) if part)


def errors(results: Results) -> str | None:
    """The whole error of the first frequency and of the worst, what most of that is, and what would mend it."""
    modes = worst(results)
    if not modes:
        return None
    last, asked = max(modes, key=lambda mode: mode.whole), results.scene.accuracy.frequency
    verdict = "within" if met(results) else "more than"
    first = f"The first frequency is good to {_percent(modes[0].whole)} %"
    others = (
        "" if len(modes) == 1 else f", the worst of {len(modes)}, number {last.number}, to {_percent(last.whole)} %"
    )
    remedy = "" if met(results) else f"; {cure(results)}"
    return f"{first}{others} ({_largest(last)}): {verdict} the {significant(100 * asked)} % asked for{remedy}."


def cure(results: Results) -> str:
    """Which keys would bring every error within the accuracy asked for; or, where none would, what can be had.

    The mesh is only as fine as what the rest leaves of the accuracy makes worth while, and else would be finer.
    """
    modes, asked = worst(results), results.scene.accuracy.frequency
    left = {mode.number: mode.whole for mode in modes}
    sizes = {name: [getattr(mode.parts, name) or 0.0 for mode in modes] for name in PARTS}
    keys = []
    for name in sorted(PARTS, key=lambda name: -max(sizes[name])):
        if max(left.values()) > asked and (key := _remedy(results, name)) is not None:
            keys.append(key)
            left = {mode.number: left[mode.number] - size for mode, size in zip(modes, sizes[name], strict=True)}
    rest = max(left[mode.number] - (mode.parts.mesh or 0.0) for mode in modes)
    thin = _is(results, "kirchhoff") and not any("theory" in key for key in keys)
    if keys and rest <= asked / 2 and not (thin and _DEFLECTED in keys):
        return f"{' and '.join(keys)} would do"
    return f"no key would mend that: [accuracy] frequency = {upwards(max(mode.whole for mode in modes))} can be had"


_DEFLECTED = "[effects] large_deflection = true"
"""What thin-plate theory does not know."""


def _remedy(results: Results, part: str) -> str | None:
    """The key that takes a part of the error away, with its value; None where nothing in a scene does."""
    if part in EFFECTS:
        return None if results.effects[part].on else f"[effects] {part} = true"
    plate, deflected = results.scene.plate, results.effects["large_deflection"].on
    if part != "theory" or _is(results, "solid") or plate is None or plate.mesh is not None or deflected:
        return None
    return f'[plate] theory = "{"auto" if results.scene.accuracy.frequency >= DEAR else "solid"}"'


def _is(results: Results, theory: str) -> bool:
    return results.theory is not None and results.theory.name == theory


def _largest(mode: Worst) -> str:
    """The parts that make up most of an error."""
    sizes = {said: getattr(mode.parts, name) or 0.0 for name, said in PARTS.items()}
    shown = [said for said, size in sizes.items() if size >= 0.1 * mode.whole]
    return ", ".join(f"{said} {_percent(sizes[said])} %" for said in shown)


def _percent(part: float) -> str:
    return significant(100 * part, 2)
