"""Signals that end a command: heard as exceptions while it works, unheard once its results are in place."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
import time
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

_REPEAT = 0.2
"""After how long a signal is raised once more if nothing has come of it [s]."""

_repeated: list[int] = []
"""The signal that is being raised once more."""

_ending = threading.Lock()
"""Held while a signal is raised once more, and where a command ends."""


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
    _repeated.clear()
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
    told = sys.unraisablehook
    sys.unraisablehook = lambda lost: None if lost.exc_value in _came else told(lost)  # it is raised again
    try:
        yield
    finally:
        sys.unraisablehook = told
        if to_the_end:
            ignore()
        with _ending:
            before = dict(_before)
            _before.clear()
        if not to_the_end:
            for number, handler in before.items():
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


def _terminated(number: int, frame: FrameType | None) -> None:
    _raise(number, Terminated(signal.Signals(number).name))


def _interrupted(number: int, frame: FrameType | None) -> None:
    _raise(number, KeyboardInterrupt())


def _raise(number: int, error: BaseException) -> None:
    if _repeated and _on_its_way(sys.exc_info()[1]):
        _repeated.clear()
        return
    _repeated.clear()
    _came.append(error)
    if len(_came) == 1:
        _thread.start_new_thread(_repeat, (number, error))  # threading's own locks may be those it came amid
    raise error


def _on_its_way(error: BaseException | None) -> bool:
    """Whether a signal, or what a library made of it, is what is being handled."""
    while error is not None and error not in _came:
        error = error.__context__
    return error is not None


def _repeat(number: int, error: BaseException) -> None:
    """Raise a signal until the command ends.

    What a handler raises is lost where nothing can be raised: in a finaliser, in a callback, in a look-up of C.
    """
    while True:
        time.sleep(_REPEAT)
        with _ending:
            if number not in _before or _came[:1] != [error]:
                return
            _repeated.append(number)
            _thread.interrupt_main(signal.Signals(number))  # nothing where the signal is ignored
