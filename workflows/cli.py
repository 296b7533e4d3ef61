"""The command line. Only here is anything printed on failure, and only here does the program exit."""

from __future__ import annotations

import os
import signal
import sys
from importlib import import_module
from importlib.metadata import version
from types import FrameType
from typing import Annotated

import typer

from workflows.commands import COMMANDS
from workflows.errors import SpindampError, one_line

DONE, DEFECT, BAD_INPUT, STOPPED, PIPE_CLOSED = 0, 1, 2, 130, 141

app = typer.Typer(add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False, rich_markup_mode=None)
for _name in COMMANDS:
    app.command(_name)(getattr(import_module(f"workflows.commands.{_name}"), _name))


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"spindamp {version('spindamp')}")
        raise typer.Exit


@app.callback()
def _spindamp(
    show: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Will a particle damper work on a spinning plate, how much, and up to what load?"""  # noqa: D400


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return its exit status."""
    signal.signal(signal.SIGTERM, _terminated)
    try:
        status = app(args=arguments, prog_name="spindamp", standalone_mode=False)
        if status == STOPPED:  # some versions of typer swallow a Ctrl-C
            raise KeyboardInterrupt
        sys.stdout.flush()
    except SpindampError as error:
        return _fail(str(error), error.exit_status)
    except (KeyboardInterrupt, typer.Abort):
        return _fail("stopped; the results folder is as it was", STOPPED)
    except BrokenPipeError:
        # Whoever read us has gone: keep the interpreter from flushing into the closed pipe.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return PIPE_CLOSED
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _fail(f"cannot write or read: {error.strerror or error}", BAD_INPUT)
    except Exception as error:
        usage = getattr(error, "format_message", None)
        if usage is not None and getattr(error, "exit_code", DEFECT) == BAD_INPUT:
            return _fail(one_line(usage()) or "missing command", BAD_INPUT)
        if os.environ.get("SPINDAMP_DEBUG"):
            raise
        return _fail(
            f"a defect of ours: {type(error).__name__}: {one_line(str(error))}; please report it with the scene and"
            " what SPINDAMP_DEBUG=1 shows",
            DEFECT,
        )
    return status if isinstance(status, int) else DONE


def _fail(message: str, status: int) -> int:
    print(f"spindamp: {message}", file=sys.stderr)
    return status


def _terminated(number: int, frame: FrameType | None) -> None:
    """End as a Ctrl-C would, so that nothing is left half done."""
    raise SystemExit(128 + number)


if __name__ == "__main__":
    sys.exit(main())
