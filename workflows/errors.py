"""What can go wrong for a user, as a tree.

SpindampError
├── BadInput          exit 2   a file, a key or a value is wrong; says what would be right
│   └── NotAvailable  exit 2   right in itself, but this version does not do it yet
├── NoAnswer          exit 3   the input is fine, the physics has no answer (divergence, say)
└── ImpossibleResult  exit 1   a figure violates a law of physics: a defect, of which nothing is published

`fem.LawViolation` and `damper.LawViolation` become an `ImpossibleResult` where a command or a function of `spindamp`
ends (`workflows.laws`); on the way there no handler of other errors takes them. Anything else that reaches the command
line is an internal error: exit 1.
"""

import difflib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from datetime import date, time
from itertools import islice
from typing import TypeVar

T = TypeVar("T")

_LONGEST_KEY, _LONGEST_VALUE = 80, 60


class SpindampError(Exception):
    """Base of every error that is not a defect; carries the exit status of the command line."""

    exit_status = 1


class BadInput(SpindampError):
    """Wrong input: where it is, what was found and what would be right, in one line.

    Args:
        problem: what is wrong or what would be right ("expected a length such as '20 cm'").
        file: name of the file it was read from, if any.
        key: the key as a user would look for it, such as ``[plate] length`` or ``--out``.
        value: what was found there, as written.
    """

    exit_status = 2

    def __init__(self, problem: str, *, file: str | None = None, key: str | None = None, value: object = None) -> None:
        self.problem = problem
        self.file = file
        self.key = key
        self.value = value
        super().__init__(str(self))

    def __str__(self) -> str:
        place = self.key if self.key is None or len(self.key) <= _LONGEST_KEY else self.key[:_LONGEST_KEY] + "…"
        if place is not None and self.value is not None:
            place = f"{place} = {shown(self.value)}"
        return one_line(": ".join(part for part in (self.file, place, self.problem) if part))


@contextmanager
def read_from(file: str) -> Iterator[None]:
    """Bad input that does not say which file it stands in stands in this one."""
    try:
        yield
    except BadInput as error:
        if error.file is not None:
            raise
        raise type(error)(error.problem, file=file, key=error.key, value=error.value) from error


class NotAvailable(BadInput):
    """Request for rightly, but not built in this version."""


class NoAnswer(SpindampError):
    """The physics has no answer to give, and why."""

    exit_status = 3


class ImpossibleResult(SpindampError):
    """A figure violates a law of physics: law, figure, bound, place and versions, in one line."""


def present(part: T | None) -> T:
    """A part of a scene or of a result that is known to be there: what led here has checked it."""
    if part is None:
        raise ValueError("a part of the scene or of the results is missing that was checked before")
    return part


@contextmanager
def during(place: str) -> Iterator[None]:
    """Note on an error where it came up, such as a speed."""
    try:
        yield
    except Exception as error:
        error.add_note(place)
        raise


def shown(value: object) -> str:
    """A value as it stands in a scene, shortened."""
    text = _written(value)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 1] + "…"


def _written(value: object, depth: int = 3) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int) and value.bit_length() > 64:
        # Python refuses to write out whole numbers of many digits.
        return f"{'-' if value < 0 else ''}1e{int(value.bit_length() * 0.30103)}"
    if isinstance(value, date | time):
        return value.isoformat()
    if isinstance(value, str):
        return repr(value[: _LONGEST_VALUE + 1])
    if isinstance(value, Mapping):
        inner = (f"{k} = {_written(v, depth - 1)}" for k, v in islice(value.items(), _LONGEST_VALUE if depth else 0))
        return "{" + ", ".join(inner) + "}" if depth else "{…}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_written(v, depth - 1) for v in value[:_LONGEST_VALUE]) + "]" if depth else "[…]"
    return repr(value)


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """A hint for a misspelling, or nothing."""
    names = {name.lower(): name for name in known}
    close = difflib.get_close_matches(word[:80].lower(), names, n=1, cutoff=0.6)
    return f": did you mean '{names[close[0]]}'?" if close and names[close[0]] != word else ""


def one_line(text: str) -> str:
    """Text without line breaks or control characters, so that one error is one line."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())
