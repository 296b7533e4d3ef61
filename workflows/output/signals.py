"""Signals that end a command: heard as exceptions while it works, unheard once its results are in place."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, TypeAlias

_Handler: TypeAlias = Callable[[int, FrameType | None], Any] | int | None

_AGAIN = "nothing is half-written; the same command starts over"
_said = [_AGAIN]

_came: list[BaseException] = []
"""The signals that have come since a command began, each as what it raises."""

_before: dict[int, _Handler] = {}
"""The signals that a running command has taken, and what was done at them before."""


def again() -> str:
    """What an end from outside leaves, in words."""
    return _said[-1]


@contextmanager
def going_on(words: str) -> Iterator[None]:
    """While the block lasts, and where it is ended from outside, an end leaves something else; in these words."""
    _said.append(words)
    yield
    _said.pop()


class Terminated(BaseException):
    """A signal asked the program to end; no handler of a library takes it for its own."""


@contextmanager
def heard(*, to_the_end: bool) -> Iterator[None]:
    """Let what would end the program at once end it as a Ctrl-C does; what is ignored (nohup) stays so.

    Afterwards all is as before or, `to_the_end` of the process, ignored: a second signal must not garble the end.
    """
    _said[:] = [_AGAIN]
    _came.clear()
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    usual = {"SIGINT": signal.default_int_handler, "SIGTERM": signal.SIG_DFL, "SIGHUP": signal.SIG_DFL}
    usual["SIGBREAK"] = signal.SIG_DFL  # Ctrl-Break on Windows, which has no SIGHUP
    for name, handler in usual.items():
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) == handler:
            _before[number] = handler
            signal.signal(number, _terminated if handler == signal.SIG_DFL else _interrupted)
    try:
        yield
    finally:
        if to_the_end:
            ignore()
        else:
            for number, handler in _before.items():
                signal.signal(number, handler)
        _before.clear()


@contextmanager
def to_blame() -> Iterator[None]:
    """What fails in the block after a signal came ends as the signal does.

    What a signal raises while a library takes or gives back a lock turns into an error of that lock.
    """
    try:
        yield
    except (Exception, SystemExit) as error:
        if _came:
            raise _came[0] from error
        raise


def ignore() -> None:
    """From now on no signal ends the running command: its results are about to be in place. Without one, nothing."""
    for number in _before:
        signal.signal(number, signal.SIG_IGN)


def _terminated(number: int, frame: FrameType | None) -> None:
    _came.append(Terminated(signal.Signals(number).name))
    raise _came[-1]


def _interrupted(number: int, frame: FrameType | None) -> None:
    _came.append(KeyboardInterrupt())
    raise _came[-1]
