"""The command: every plate that CalculiX has answered for; a line for each, and what all of them say."""

import argparse
import os
import sys

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np

from tests.survey import plates, references
from tests.survey.verdict import judge, static_state
from workflows import SpindampError

HEAD = (
    f"{'plate':14}{'strain':>9}{'rotation':>9} {'theory':17}{'with':6}{'time':>6}"
    f"{'true':>9}{'estimate':>9}{'worst':>7}  outside"
)


def main(arguments=None):
    """Run them; 1 if any mode is outside its estimate."""
    parser = argparse.ArgumentParser(prog="python -m tests.survey", description=__doc__)
    parser.add_argument("--only", default="", help="plates whose name holds this")
    given = parser.parse_args(arguments)
    verdicts, unanswered = [], 0
    print(HEAD)
    for case, reference in answered(given.only):
        try:
            verdicts.append(judge(case, reference))
        except (SpindampError, IndexError) as error:
            print(f"{case.name:14}no answer: {error}", flush=True)
            unanswered += 1
            continue
        print(_line(verdicts[-1], static_state(case, case.omega)), flush=True)
    summary = _summary(verdicts, len(verdicts) + unanswered)
    print("\n".join(f"{what}: {value}" for what, value in summary.items()))
    return 1 if summary["modes outside"] or unanswered else 0


def answered(only):
    """Plates with a reference."""
    known = references.stored()
    for case in plates.cases():
        if only in case.name and case.name in known:
            yield case, known[case.name]


def _line(verdict, state):
    strain, rotation = (np.nan, np.nan) if state is None else (state.strain, state.rotation)
    k = int(np.argmax(verdict.ratio))
    outside = ", ".join(f"{n}: {verdict.true[n - 1]:.2%} ({verdict.estimate[n - 1]:.2%})" for n in verdict.violations)
    if verdict.wanting:
        outside += f"; left out: {', '.join(f'{n}: {verdict.missed[n - 1]:.2%}' for n in verdict.wanting)}"
    marks = "".join(name[0].upper() for name in verdict.effects)
    return (
        f"{verdict.name:14}{strain:9.1e}{rotation:9.3f} {verdict.theory:17}{marks:4}{verdict.seconds:6.1f} s"
        f"{verdict.true[k]:9.1e}{verdict.estimate[k]:9.1e}{verdict.ratio[k]:7.2f}  {outside}"
    )


def _summary(verdicts, tried):
    if not verdicts:
        return {"plates": tried, "modes outside": 0}
    true, slack, estimate = (
        np.concatenate([getattr(v, name) for v in verdicts]) for name in ("true", "slack", "estimate")
    )
    return {
        "plates": tried,
        "without an answer": tried - len(verdicts),
        "modes": true.size,
        "modes outside": sum(len(v.violations) for v in verdicts),
        "modes that what was left out moves by more than the accuracy asked for": sum(len(v.wanting) for v in verdicts),
        "plates with a mode outside": sum(bool(v.violations) for v in verdicts),
        "median of estimate / truth": round(float(np.median(estimate / np.maximum(true, slack))), 2),
        "largest truth / estimate": round(float(max(v.ratio.max() for v in verdicts)), 1),
        "seconds": round(sum(v.seconds for v in verdicts), 1),
    }


if __name__ == "__main__":
    sys.exit(main())
