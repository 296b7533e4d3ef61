"""Headlines against the numbers that stand beside them, on ten blades and more: is every first sentence true?

    python -m tests.benchmarks.headlines [SCENE …]

Each scene of headlines.toml goes through `run`, which estimates from free vibration, through `response`, which follows
the motion, and, where it has a table [design], through `design`; ten small spaces on a known structure go through
`design` alone. Every number of a sentence has to follow from the JSON beside it: percent, levels, speeds, what the
plate endures, damping ratios. Of what was followed no level may contradict the sentence. `run` and `response` have to
agree: the same verdict, percent within 3 points, and the range of `run` holds the levels of `response` that give half
of the best, and no other, within 20 % of its ends; unless `run` calls its estimate rough.
Prints every sentence to be read, then what does not hold, and ends with 1 where something does not. It takes some
twenty minutes of one core, most of them in `response` and `design`.
"""

import json
import math
import re
import sys
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import spindamp
from workflows.errors import SpindampError
from workflows.io import serialise
from workflows.report import verdict
from workflows.solve.excitation import HELPS
from workflows.studies import response_report as of_response

Table = dict[str, Any]

POINTS, ENDS = 3.0, 0.2
"""What `run` and `response` may differ by: points of a percentage, and relative at the ends of a range."""

DIGITS = {2: 0.05, 3: 0.005}
"""Relative error of a number rounded to so many significant digits."""


@dataclass(frozen=True)
class Said:
    """What a sentence says of a crossing: percent is 0, and the ends of the range are nan, where the ball is no use."""

    text: str
    order: int
    rpm: float
    percent: float
    low: float
    high: float

    @property
    def useful(self) -> bool:
        return self.percent > 0

    @property
    def rough(self) -> bool:
        """Whether it tells no levels apart."""
        return "roughly" in self.text

    @property
    def short(self) -> str:
        levels = f", {self.low:.3g} to {self.high:.3g}" if self.useful else ""
        return f"{self.percent:.3g} % less{levels}" if self.useful else "not useful"


_NUMBER = r"(\d[\d.]*)"
_PLACE = re.compile(rf"At engine order (\d+) \({_NUMBER} rpm, [\w ]+ mode\): ")
_LESS = re.compile(
    rf"up to {_NUMBER} % less vibration at {_NUMBER} [^ ,.]+"
    rf"(?:, at least half of that (?:(?:roughly )?between|at all levels evaluated from)"
    rf" {_NUMBER} (?:and|to) {_NUMBER} )?"
)
_AT_MOST = re.compile(rf"the balls? reduces? the amplitude by {_NUMBER} % at most")
_ENDURED = re.compile(rf"that the plate endures \(up to {_NUMBER} ")
_IDLE = (
    ("overstressed", re.compile(r"At ([\d., and]+) \S+ the (?:root|plate|blade|structure) would be ")),
    ("held", re.compile(r"At ([\d., and]+) \S+ the load holds the balls? at rest")),
)
_BESIDE = re.compile(rf"At {_NUMBER} \S+ the reduction is {_NUMBER} %")
_GOES_ON = re.compile(r"At [\d.]+[, ]")
_RATIO = re.compile(
    rf"equivalent damping ratio of up to {_NUMBER} %"
    rf"|at most {_NUMBER} % equivalent damping ratio \(at {_NUMBER} rpm"
)


def said(sentences: Sequence[str]) -> list[Said]:
    """The sentences that speak of a crossing."""
    found = []
    for text in sentences:
        place = _PLACE.match(text)
        if place is None or "no estimate" in text:
            if found and _GOES_ON.match(text):
                found[-1] = replace(found[-1], text=f"{found[-1].text} {text}")
            continue
        less = _LESS.search(text)
        percent, low, high = (0.0, math.nan, math.nan)
        if less is not None:
            percent, low = float(less[1]), float(less[2])
            low, high = (low, low) if less[3] is None else (float(less[3]), float(less[4]))
        found.append(Said(text, int(place[1]), float(place[2]), percent, low, high))
    return found


def levels_of(text: str) -> dict[str, list[float]]:
    """The levels that a sentence names as idle, by why."""
    found = {}
    for why, pattern in _IDLE:
        if (match := pattern.search(text)) is not None:
            found[why] = [float(each) for each in re.findall(r"\d[\d.]*", match[1])]
    return found


def off(told: float, true: float | None, digits: int) -> bool:
    """Whether a number of a sentence is another than the true one, rounded."""
    return true is None or not math.isfinite(true) or abs(told - true) > DIGITS[digits] * 1.02 * max(abs(told), 1e-12)


def of_reduction(each: Said, reductions: Sequence[Table]) -> list[str]:
    """What a sentence of `run` says beside its record."""
    mine = [r for r in reductions if r["order"] == each.order and abs(r["rpm"] - each.rpm) <= max(0.5, 5e-3 * r["rpm"])]
    if not mine:
        return [f"no record of order {each.order} at {each.rpm:g} rpm"]
    true = min(mine, key=lambda r: abs(r["rpm"] - each.rpm))
    faults = []
    ends = true.get("range", (None, None))
    if each.useful != (ends[0] is not None):
        faults.append(f"said to be {'useful' if each.useful else 'useless'}, range {ends}")
    elif each.useful:
        if off(each.percent, 100 * (1 - true["ratio"]), 2):
            faults.append(f"{each.percent:g} % where the ratio is {true['ratio']:.4f}")
        if not each.rough and (off(each.low, ends[0], 3) or off(each.high, ends[1], 3)):
            faults.append(f"{each.low:g} to {each.high:g} where the range is {ends}")
    if (limit := _ENDURED.search(each.text)) is not None and off(float(limit[1]), true.get("endured_level"), 3):
        faults.append(f"endures {limit[1]} where endured_level is {true.get('endured_level')}")
    rows = [(level["level"], level["ratio"], level["endured"]) for level in true.get("levels", ())]
    return faults if each.rough else faults + of_levels(each, rows, true.get("moves_from"))


def of_crossings(each: Said, document: Table) -> list[str]:
    """What a sentence of `response` says beside the motion that was followed."""
    mine = [c for c in document["crossings"] if c["order"] == each.order and abs(c["rpm"] - each.rpm) <= 0.5]
    if not mine:
        return []  # the estimate stands alone there
    limit, least = next(
        (d["endured_amplitude"], d["least_force"])
        for d in document["dampers"]
        if (d["order"], d["mode"]) == (mine[0]["order"], mine[0]["mode"])
    )
    rows = [(c["force"], c["ratio"], limit is None or c["amplitude"]["greatest"] <= limit) for c in mine]
    faults = [
        f"the ratio at {c['force']:g} is not that of the amplitudes"
        for c in mine
        if abs(c["ratio"] * c["amplitude_without"] / c["amplitude"]["mean"] - 1) > 1e-6
    ]
    most = max((100 * (1 - ratio) for _, ratio, endured in rows if endured), default=0.0)
    if each.useful and off(each.percent, most, 2):
        faults.append(f"{each.percent:g} % where the motion shows {most:.3g} %")
    if not each.useful and most > 100 * (1 - HELPS):
        faults.append(f"not useful, where the motion shows {most:.3g} %")
    faults += [
        f"{level:g} is between {each.low:g} and {each.high:g}, and its ratio is {ratio:.4f}"
        for level, ratio, _ in rows
        if each.low * 1.005 < level < each.high * 0.995 and 100 * (1 - ratio) < 0.45 * each.percent
    ]
    asked = document["scene"]["excitation"][document["excitation"]["kind"]]
    return faults + of_levels(each, [row for row in rows if any(math.isclose(row[0], level) for level in asked)], least)


def of_added(headline: Sequence[str], reductions: Sequence[Table]) -> list[str]:
    """Whether a level that `response` evaluates too is near the best that `run` estimates at one of the crossings."""
    best = [each["level"] for each in reductions if each["level"] is not None]
    added = [match[1] for text in headline if (match := re.match(r"([\d., and]+) \S+ (?:is|are) evaluated too", text))]
    return [
        f"{level} is not near the best levels estimated, {best}"
        for level in re.findall(r"\d[\d.]*", " ".join(added))
        if not any(math.isclose(float(level), each, rel_tol=0.05) for each in best)
    ]


def of_levels(each: Said, rows: Sequence[tuple[float, float, bool]], moves_from: float | None) -> list[str]:
    """The levels that a sentence calls idle, and those that it leaves out."""
    faults = []
    named = levels_of(each.text)
    for level, ratio, endured in rows:
        why = [name for name, levels in named.items() if any(not off(told, level, 3) for told in levels)]
        inside = each.useful and each.low * 0.995 <= level <= each.high * 1.005
        if len(why) > 1 or (why and inside and why != ["overstressed"]):
            faults.append(f"{level:g} is called {' and '.join(why)}, and the range holds it")
        if "overstressed" in why and endured:
            faults.append(f"{level:g} is called too strong, and is endured")
        if "held" in why and (moves_from is None or level > moves_from * 1.001):
            faults.append(f"{level:g} is called too weak, and the ball moves from {moves_from}")
        if inside and endured and 100 * (1 - ratio) < 0.45 * each.percent:
            faults.append(f"{level:g} is in the range, and its ratio is {ratio:.4f}")
        own = [float(cut) for told, cut in _BESIDE.findall(each.text) if not off(float(told), level, 3)]
        if own and off(own[0], 100 * (1 - ratio), 2):
            faults.append(f"{own[0]:g} % at {level:g}, and its ratio is {ratio:.4f}")
        if each.useful and not inside and not why and not own:
            faults.append(f"of {level:g} nothing is said")
    if not each.useful and (claimed := _AT_MOST.search(each.text)) is not None:
        most = max((100 * (1 - ratio) for _, ratio, endured in rows if endured), default=0.0)
        if most > 1.05 * float(claimed[1]) + 1e-9:
            faults.append(f"{claimed[1]} % at most, and {most:.3g} % at a level")
    return faults


def of_speeds(sentences: Sequence[str], speeds: Sequence[Table]) -> list[str]:
    """The damping ratio that the damper's own verdict says, beside the verdicts of the speeds."""
    verdicts = [p["verdict"] for p in speeds if p.get("verdict") is not None and p["load_g"] > 0]
    best = max((v["damping_ratio"] or 0.0 for v in verdicts), default=0.0)
    match = _RATIO.search(" ".join(sentences))
    if match is None:
        return []
    told = float(match[1] or match[2])
    return [f"ζ {told:g} % where the best is {100 * best:.3g} %"] if off(told, 100 * best, 2) else []


def disagreements(short: Sequence[Said], motion: Sequence[Said], levels: Sequence[float]) -> list[str]:
    """Where `run` and `response` say different things of a crossing; `levels`: those that `response` followed."""
    faults = []
    for mine in short:
        other = next((m for m in motion if m.order == mine.order and abs(m.rpm - mine.rpm) <= 1), None)
        if other is None:
            faults.append(f"order {mine.order}: response says nothing")
            continue
        place = f"order {mine.order}, run against response"
        if mine.useful != other.useful:
            faults.append(f"{place}: {mine.short} against {other.short}")
            continue
        if not mine.useful or "roughly" in mine.text:
            continue
        if abs(mine.percent - other.percent) > POINTS:
            faults.append(f"{place}: {mine.percent:g} % against {other.percent:g} %")
        useful = [level for level in levels if other.low * 0.995 <= level <= other.high * 1.005]
        wide = mine.low / (1 + ENDS), mine.high * (1 + ENDS)
        narrow = mine.low * (1 + ENDS), mine.high / (1 + ENDS)
        named = [float(level) for level, _ in _BESIDE.findall(mine.text)]
        outside = [level for level in useful if not wide[0] <= level <= wide[1] and level not in named]
        faults += [f"{place}: {level:g} gives half" for level in outside]
        idle = [level for level in levels if level not in useful]
        faults += [f"{place}: {level:g} gives less than half" for level in idle if narrow[0] <= level <= narrow[1]]
    return faults


def of_best(document: Table) -> list[str]:
    """What a design says in its first sentence, beside its value and the motion that was followed."""
    text, faults = document["verdict"], []
    if not document["works"]:
        return []
    if (match := re.search(rf"crossings is {_NUMBER} mm, {_NUMBER} % less", text)) is not None:
        if off(float(match[1]), 1e3 * document["value"], 3):
            faults.append(f"{match[1]} mm where value is {document['value']}")
        cut = 100 * (1 - document["value"] / document["without"])
        if off(float(match[2]), cut, 2):
            faults.append(f"{match[2]} % where value and without make {cut:.3g} %")
        if abs(document["confirmed"] / document["value"] - 1) > POINTS / 100:
            faults.append(f"the motion comes to {document['confirmed']:.4g} m, the search to {document['value']:.4g} m")
    elif (match := re.search(rf"damping ratio of at least {_NUMBER} %", text)) is not None:
        if off(float(match[1]), 100 * document["value"], 3):
            faults.append(f"{match[1]} % where value is {document['value']}")
        if (match := re.search(rf"reaches {_NUMBER} % of that", " ".join(document["why"]))) is not None:
            share = 100 * document["value"] / document["bound"]
            faults += [f"{match[1]} % of the bound where {share:.3g} is right"] * (abs(float(match[1]) - share) > 0.5)
    else:
        faults.append("no number in the verdict")
    return faults


@dataclass(frozen=True)
class Line:
    """All that a command says of a scene, and what of it does not hold."""

    scene: str
    command: str
    sentences: Sequence[str]
    faults: list[str]


def judged(name: str, scene: Table) -> Iterator[Line]:
    """All that is said of a scene, a command after the other."""
    scene = {"title": name} | scene
    if "structure" in scene and "design" in scene:
        document = spindamp.design(scene, workers=1).document()
        yield Line(name, "design", [f"{document['verdict']}.", *document["why"]], of_best(document))
        return
    plain = {key: value for key, value in scene.items() if key != "design"}
    results = spindamp.run(plain)
    document = json.loads(serialise.dumps(results))
    reductions, answer = document["reductions"], verdict.answer(results)
    every = [f"{answer.verdict}.", *answer.sentences]
    short = said(every)
    faults = [fault for each in short for fault in of_reduction(each, reductions)]
    yield Line(name, "run", every, faults + of_speeds(every, document["speeds"]))
    try:
        found = spindamp.response(plain)
        document = of_response.document(found)
        motion = said(document["headline"])
        faults = [fault for each in motion for fault in of_crossings(each, document)]
        levels = sorted({entry["force"] for entry in document["crossings"]})
        faults += of_added(document["headline"], reductions) + disagreements(short, motion, levels)
        yield Line(name, "response", document["headline"], faults)
    except SpindampError as failed:
        yield Line(name, "response", [f"No answer: {failed}"], ["no answer"])
    if "design" in scene:
        document = spindamp.design(scene, workers=1).document()
        yield Line(name, "design", [f"{document['verdict']}.", *document["why"]], of_best(document))


def main(*names: str) -> int:
    """Print the table and what does not hold; return whether anything does not."""
    every = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    lines = []
    for name in names or every:
        for line in judged(name, every[name]):
            lines.append(line)
            mark = "does not hold" if line.faults else "holds"
            print(f"{line.scene:17s} {line.command:9s} {mark:14s} {' '.join(line.sentences)}", flush=True)
    wrong = [line for line in lines if line.faults]
    for line in wrong:
        print(f"\n{line.scene}, {line.command}:")
        print("\n".join(f"  {fault}" for fault in line.faults))
    print(f"\n{len(lines)} headlines, {len(lines) - len(wrong)} hold")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
