"""What a person who waits is told of the damper's compiler."""

from __future__ import annotations

import sys

import typer


def say() -> None:
    """Why a start is slow: compiled code is not there yet (on a terminal, as progress is), not kept, or not wanted."""
    from damper import compiled

    if not compiled.COMPILES:
        problem = "a hundred times slower, and results do not wait for their self-check"
        typer.echo(f"spindamp: NUMBA_DISABLE_JIT: the damper's kernels run as plain Python, {problem}", err=True)
    elif not compiled.CACHED:
        problem = "neither the installation nor a home folder can be written, so that compiled code is not kept"
        typer.echo(f"spindamp: {problem}: every start takes some ten seconds longer", err=True)
    elif compiled.fresh() and sys.stderr.isatty():
        typer.echo(
            "spindamp: compiling the damper's kernels, once for an installation: up to a minute, with their check",
            err=True,
        )
