"""A statement of the paper, what the code finds, and what follows."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

Value = float | int | str | list[float] | None
"""A number, several, words, or nothing where a formulation has no say."""


class Verdict(StrEnum):
    """How a statement fares."""

    REPRODUCED = "reproduced"
    PARTLY = "partly"
    NOT = "not reproduced"
    UNTESTABLE = "not testable"


@dataclass(frozen=True)
class Claim:
    """A checkable statement.

    Attributes:
        id: short and lasting.
        source: where it stands in the paper.
        claim: the statement, in our words.
        paper: the paper's value, with its unit.
        printed, consistent: the values found with either formulation, in the same unit.
        verdict: how it fares.
        why: the reason, in a sentence or two.
    """

    id: str
    source: str
    claim: str
    paper: str
    printed: Value
    consistent: Value
    verdict: Verdict
    why: str


def judge(holds: bool, partly: bool = False) -> Verdict:
    """Reproduced, partly, or not."""
    if holds:
        return Verdict.REPRODUCED
    return Verdict.PARTLY if partly else Verdict.NOT
