"""Where a command or a function of `spindamp` ends: the violation of a law becomes an error that says so."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from workflows import versions
from workflows.errors import ImpossibleResult, one_line


@contextmanager
def lawful() -> Iterator[None]:
    """Translate the violation of a law by a figure of `fem` or `damper`; serves as a decorator as well.

    Raises:
        ImpossibleResult: such a violation.
    """
    loaded = (sys.modules.get(name) for name in ("fem.sweep.laws", "damper.laws"))
    try:
        yield
    except Exception as error:
        if not isinstance(error, tuple(module.LawViolation for module in loaded if module is not None)):
            raise
        places = "".join(f", {note}" for note in getattr(error, "__notes__", ()))
        problem = f"an internal error: {error}{places}; nothing was published, please report it with the scene"
        raise ImpossibleResult(one_line(f"{problem} ({versions.line()})")) from error
