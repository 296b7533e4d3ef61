"""What a person who waits is told of the damper's compiler."""

from __future__ import annotations

import sys

import typer


def say() -> None:
    """Why a start is slow: compiled code is not there yet (on a terminal, as progress is), or cannot be kept."""
    from damper import compiled

    if not compiled.CACHED:
        problem = "neither the installation nor a home folder can be written, so that compiled code is not kept"
        typer.echo(f"spindamp: {problem}: every start takes some ten seconds longer", err=True)
    elif compiled.fresh() and sys.stderr.isatty():
        typer.echo(
            "spindamp: compiling the damper's kernels, once for an installation: up to a minute, with their check",
            err=True,
        )
