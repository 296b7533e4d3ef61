"""What can go wrong for a user, as a tree.

SpindampError
├── BadInput          exit 2   a file, a key or a value is wrong; says what would be right
│   └── NotAvailable  exit 2   right in itself, but this version does not do it yet
└── NoAnswer          exit 3   the input is fine, the physics has no answer (divergence, say)

Anything else that reaches the command line is a defect of ours: exit 1.
"""

from __future__ import annotations


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
        found = self.key
        if found is not None and self.value is not None:
            found = f"{found} = {shown(self.value)}"
        return one_line(": ".join(part for part in (self.file, found, self.problem) if part))


class NotAvailable(BadInput):
    """Asked for rightly, but not built in this version."""


class NoAnswer(SpindampError):
    """The physics has no answer to give, and why."""

    exit_status = 3


def shown(value: object, limit: int = 60) -> str:
    """A value as a user would recognise it, shortened."""
    if isinstance(value, bool):
        return "true" if value else "false"
    text = repr(value)
    return text if len(text) <= limit else text[: limit - 1] + "…"


def one_line(text: str) -> str:
    """Text without line breaks or control characters, so that one error is one line."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())
