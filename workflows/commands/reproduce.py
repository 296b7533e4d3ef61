"""`spindamp reproduce`: the paper's every claim against this code."""

from __future__ import annotations

import typer

from workflows.commands.options import Json, Out


def reproduce(out: Out = None, json: Json = False) -> None:
    """Hold the paper's every claim against this code.

    Without --out nothing is written.
    """
    from workflows import reproduction, store
    from workflows.reproduction import page
    from workflows.stages import Stages

    if out is not None:
        store.check(out, r"reproduce\.(json|csv)|closure\.csv")
    with Stages() as stages:
        found = reproduction.reproduce(stages)
        if out is not None:
            with stages("report"):
                page.write(found, out)
    if json:
        typer.echo(page.dumps(found))
        return
    for claim in found.claims:
        typer.echo(f"{claim.verdict:<15} {claim.id:<16} {claim.claim}")
    typer.echo("\n" + ", ".join(f"{count} {verdict}" for verdict, count in found.count.items()))
    if out is not None:
        typer.echo(f"open {out / 'report.html'}")
