"""`spindamp design`: the damper that damps best within what a scene allows."""

from __future__ import annotations

from pathlib import Path

import typer

from workflows.cli.commands.options import Dask, Json, Out, Processes, SceneArgument, Seed


def design(
    scene: SceneArgument = "design",
    out: Out = None,
    workers: Processes = None,
    dask: Dask = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Find the damper that damps best within what the table [design] of a scene allows.

    Where none works, the results say why, and the exit status is 3.

    Without --out the folder is named after the scene's title; with --json and no --out nothing is written.
    """
    from workflows.cli.commands import kernels
    from workflows.errors import NoAnswer
    from workflows.output import folder
    from workflows.progress import Stages
    from workflows.scene import load as scene_file
    from workflows.studies.design import report, study
    from workflows.studies.sweep.executor import crew_of

    source = scene_file.load(scene)
    if source.scene.damper is not None:
        kernels.say()
    if out is None and not json:
        out = Path(f"spindamp-design-{scene_file.slug(source.scene.title)}")
    if out is not None:
        folder.check(out, report.FILES)
    with Stages() as stages:
        found = study.design(source, seed=seed, hired=crew_of(workers, dask), stages=stages)
        if out is not None:
            with stages("report"):
                report.write(found, out)
    typer.echo(report.dumps(found) if json else report.text(found))
    if out is not None and not json:
        winner = f", or spindamp run {out / 'best.toml'}" if found.toml else ""
        typer.echo(f"\nopen {out / 'report.html'}{winner}")
    if not found.found.scored.works:
        raise NoAnswer(f"{source.name}: {report.in_short(found)}")
