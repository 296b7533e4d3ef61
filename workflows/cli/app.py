"""The commands put together; imported by the command line once it can answer for what goes wrong."""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import version
from typing import Annotated

import typer

from workflows.cli.commands import COMMANDS
from workflows.errors import BadInput

_commands = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)
for _name in COMMANDS:
    _commands.command(_name)(getattr(import_module(f"workflows.cli.commands.{_name}"), _name))


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"spindamp {version('spindamp')}")
        raise typer.Exit


def _self_check(asked: bool) -> None:
    if asked:
        from workflows.cli.commands import kernels
        from workflows.solve import self_check

        kernels.say()
        for line in self_check.report():
            print(line, flush=True)
        raise typer.Exit(0 if line == self_check.ALL_PASSED else 1)


@_commands.callback(invoke_without_command=True)
def _spindamp(
    context: typer.Context,
    show: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    check: Annotated[
        bool,
        typer.Option(
            "--self-check",
            callback=_self_check,
            is_eager=True,
            help="Compare reference plates and motions with independent results, and print the versions.",
        ),
    ] = False,
) -> None:
    """Will a particle damper work on a spinning plate, how much, and up to what load?"""  # noqa: D400
    if context.invoked_subcommand is None:
        raise BadInput(f"missing command: expected one of {', '.join(COMMANDS)}; spindamp --help says what they do")


app = typer.main.get_command(_commands)
"""Built once: a Typer that is called reads the signatures of all commands anew."""
