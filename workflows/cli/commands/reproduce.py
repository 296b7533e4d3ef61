"""`spindamp reproduce`: the paper's every claim against this code."""

from __future__ import annotations

import typer

from workflows.cli.commands.options import Json, Out


def reproduce(out: Out = None, json: Json = False) -> None:
    """Hold the paper's every claim against this code.

    Without --out nothing is written.
    """
    from workflows.cli.commands import kernels
    from workflows.output import folder
    from workflows.progress import Stages
    from workflows.studies import reproduction
    from workflows.studies.reproduction import report

    if out is not None:
        folder.check(out, r"reproduce\.(json|csv)|closure\.csv")
    kernels.say()
    with Stages() as stages:
        found = reproduction.reproduce(stages)
        if out is not None:
            with stages("report"):
                report.write(found, out)
    if json:
        typer.echo(report.dumps(found))
        return
    for claim in found.claims:
        typer.echo(f"{claim.verdict:<15} {claim.id:<16} {claim.claim}")
    typer.echo("\n" + ", ".join(f"{count} {verdict}" for verdict, count in found.count.items()))
    if out is not None:
        typer.echo(f"open {out / 'report.html'}")
