"""`spindamp sweep`: any keys of a scene over a grid or a sample."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from workflows.cli.commands.options import Dask, Json, Out, Processes, SceneArgument, Seed

Vary = Annotated[
    list[str] | None,
    typer.Option(
        "--vary",
        metavar="KEY=VALUES",
        help="START:STOP:COUNT, log:START:STOP:COUNT or a,b,c, with units; as often as keys are varied.",
    ),
]
Count = Annotated[
    int | None, typer.Option("--sample", metavar="N", help="So many points spread over all ranges, not a grid.")
]
Quick = Annotated[bool, typer.Option("--quick", help="Figures to about a percent, in a fifth of the time.")]

Uncertain = Annotated[
    bool,
    typer.Option(
        "--uncertain", help="Take ranges (or normal:MEAN:DEVIATION) as distributions: percentiles and Sobol' indices."
    ),
]


def sweep(
    scene: SceneArgument = "paper",
    vary: Vary = None,
    sample: Count = None,
    quick: Quick = False,
    uncertain: Uncertain = False,
    out: Out = None,
    workers: Processes = None,
    dask: Dask = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Vary keys of a scene, such as damper.mass_ratio=0.001:0.01:10, over a grid or a sample.

    Ended in any way and started again, it goes on. Without --out the folder is named after the scene's title; with
    --json and no --out nothing is written.
    """
    from workflows.cli.commands import kernels
    from workflows.progress import Stages
    from workflows.scene import load as scene_file
    from workflows.studies.sweep import executor, report, sensitivity, store, study

    asked = study.asked(scene, vary or (), count=sample, seed=seed, quick=quick, uncertain=uncertain)
    if out is None and not json:
        out = Path(f"spindamp-sweep-{scene_file.slug(asked.source.scene.title)}")
    if out is not None:
        store.checked(out)
    if not json:
        for axis in asked.plan.axes:
            if instead := axis.key.displaced(asked.source.scene):
                typer.echo(f"{axis.name} takes the place of the scene's {instead}")
    kernels.say()
    hired = executor.crew_of(workers, dask)
    with Stages() as stages:
        data = study.in_memory(asked, hired, stages) if out is None else study.complete(asked, out, hired, stages)
        if uncertain:
            data = sensitivity.analysed(data, seed)
        if out is not None:
            with stages("report"):
                report.write(data, out)
    typer.echo(report.dumps(data) if json else report.text(data))
    if out is not None and not json:
        typer.echo(f"\nopen {out / 'report.html'}")
