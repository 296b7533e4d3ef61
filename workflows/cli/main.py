"""The command line. Only here is anything printed on failure, and only here does the program exit.

Nothing slow is imported at the top: a Ctrl-C while the rest loads finds its handler here.
"""

import atexit
import gc
import io
import os
import signal
import sys

from workflows.errors import SpindampError, one_line
from workflows.io import folder
from workflows.io.folder import Terminated
from workflows.laws import lawful

DONE, DEFECT, BAD_INPUT, STOPPED, PIPE_CLOSED = 0, 1, 2, 130, 141


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return its exit status; without arguments, those of this process, which then ends."""
    _open_streams()
    if arguments is None:
        # Rubbish is looked for less often than Python does, and not while the process ends: a sixth of a run, for 8 MB.
        gc.set_threshold(300_000)
        atexit.register(gc.freeze)
        if "OMP_NUM_THREADS" not in os.environ:
            # Numpy's last bits, and with them chaotic ring-downs, depend on the number of threads; sweeps use one too.
            os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        with folder.orderly_end(to_the_end=arguments is None):
            return _run(arguments)
    except KeyboardInterrupt:
        return _fail(f"stopped; {folder.restart_advice()}", STOPPED)
    except Terminated as error:
        return _fail(f"ended by {error}; {folder.restart_advice()}", 128 + signal.Signals[str(error)])


def _run(arguments: list[str] | None) -> int:
    try:
        with folder.signal_as_cause():
            import typer

            from workflows.cli.commands import app
    except ImportError as error:
        return _fail(f"the installation is incomplete: {one_line(str(error))}; install spindamp again", DEFECT)
    try:
        with lawful(), folder.signal_as_cause():
            status = app(args=arguments, prog_name="spindamp", standalone_mode=False)
        if status == STOPPED:  # some versions of typer swallow a Ctrl-C
            raise KeyboardInterrupt
        sys.stdout.flush()
    except SpindampError as error:
        return _fail(str(error), error.exit_status)
    except typer.Abort:
        raise KeyboardInterrupt from None
    except SystemExit as error:  # typer's answer to a closed pipe, and its end of a completion
        if error.code in (None, DONE):
            return DONE
        _silence("stdout")
        return PIPE_CLOSED if error.code == DEFECT else BAD_INPUT
    except BrokenPipeError:
        _silence("stdout")
        return PIPE_CLOSED
    except MemoryError:
        return _fail("not enough memory: take a coarser mesh, fewer modes or fewer speeds", BAD_INPUT)
    except OSError as error:
        _silence("stdout")
        return _fail(f"cannot write or read: {error.strerror or error}", BAD_INPUT)
    except Exception as error:
        if (usage := _usage(error)) is not None:
            return _fail(usage, BAD_INPUT)
        if os.environ.get("SPINDAMP_DEBUG"):
            raise
        problem = f"an internal error: {type(error).__name__}: {one_line(str(error))}"
        return _fail(f"{problem}; please report it with the scene and what SPINDAMP_DEBUG=1 shows", DEFECT)
    return status if isinstance(status, int) else DONE


def _usage(error: Exception) -> str | None:
    """What typer says of options and arguments that make no sense; None where that is not what is wrong."""
    formatter = getattr(error, "format_message", None)
    return one_line(formatter()) if formatter is not None and getattr(error, "exit_code", DEFECT) == BAD_INPUT else None


def _fail(message: str, status: int) -> int:
    try:
        print(f"spindamp: {message}", file=sys.stderr, flush=True)
    except OSError:  # no room for the message: the status still says it
        _silence("stderr")
    return status


def _open_streams() -> None:
    """Give a program started without output or error stream a place to write to, and every letter a way out."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
        elif isinstance(stream, io.TextIOWrapper):
            # A file on Windows is not to be in the old encoding of a console.
            into_a_file = sys.platform == "win32" and not stream.isatty() and "PYTHONIOENCODING" not in os.environ
            stream.reconfigure(encoding="utf-8" if into_a_file else None, errors="backslashreplace")


def _silence(name: str) -> None:
    """Keep the interpreter from flushing what is left into a stream that no one takes from."""
    try:
        os.dup2(os.open(os.devnull, os.O_WRONLY), getattr(sys, name).fileno())
    except (OSError, ValueError):
        setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
