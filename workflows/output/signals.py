"""Signals that end a command: raised as exceptions while it works, ignored once its results are in place.

What a handler raises is lost where nothing can be raised (in a finaliser, in a callback of C) or where a library passes
over everything. A timer therefore raises it again until the command ends.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, TypeAlias

_Handler: TypeAlias = Callable[[int, FrameType | None], Any] | int | None

_USUAL = {"SIGINT": signal.default_int_handler, "SIGTERM": signal.SIG_DFL, "SIGHUP": signal.SIG_DFL}
"""What is done at the signals that end a command, unless somebody has it otherwise: nohup, say."""

_REPEAT = 0.2
"""Seconds after which a signal is raised again if nothing has come of it."""

_AGAIN = "nothing is half-written; the same command starts over"
_outcome = [_AGAIN]

_came: list[BaseException] = []
"""What the signals raise that have come since a command began."""

_before: dict[int, _Handler] = {}
"""The signals that a running command has taken, and what was done at them before."""

_timer: list[tuple[float, float]] = []
"""The timer that was set before a signal came."""


class Terminated(BaseException):
    """A signal asked the program to end; no handler of a library takes it for its own."""


def again() -> str:
    """What an end from outside leaves, in words."""
    return _outcome[-1]


@contextmanager
def going_on(words: str) -> Iterator[None]:
    """While the block lasts, and where it is ended from outside, an end leaves something else; in these words."""
    _outcome.append(words)
    yield
    _outcome.pop()


@contextmanager
def heard(*, to_the_end: bool) -> Iterator[None]:
    """Let what would end the program at once end it as a Ctrl-C does; what is ignored (nohup) stays so.

    Afterwards all is as before or, `to_the_end` of the process, ignored: a second signal must not garble the end.
    """
    _outcome[:] = [_AGAIN]
    _came.clear()
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    for name, usual in _USUAL.items():
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) == usual:
            _before[number] = signal.signal(number, _raise)
    hook = sys.unraisablehook
    sys.unraisablehook = lambda lost: None if lost.exc_value in _came else hook(lost)  # it is raised again
    try:
        yield
    finally:
        sys.unraisablehook = hook
        if to_the_end:
            ignore()
        elif _timer:
            signal.setitimer(signal.ITIMER_REAL, *_timer.pop())
        while _before:
            number, handler = _before.popitem()
            if not to_the_end:
                signal.signal(number, handler)


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


def _raise(number: int, frame: FrameType | None) -> None:
    error = KeyboardInterrupt() if number == signal.SIGINT else Terminated(signal.Signals(number).name)
    _came.append(error)
    if len(_came) == 1 and hasattr(signal, "setitimer"):
        _before[signal.SIGALRM] = signal.signal(signal.SIGALRM, _raise_again)
        _timer[:] = [signal.setitimer(signal.ITIMER_REAL, _REPEAT, _REPEAT)]
    raise error


def _raise_again(number: int, frame: FrameType | None) -> None:
    """Raise what came, unless that, or what a library made of it, is being handled already."""
    error = sys.exc_info()[1]
    while error is not None and error not in _came:
        error = error.__context__
    if error is None and _came:
        raise _came[0]
