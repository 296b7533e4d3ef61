"""`spindamp check`: validate a scene and show what would be simulated."""

from __future__ import annotations

from typing import Annotated

import typer

from workflows.cli.commands.options import Json


def check(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help="A scene (TOML), or the name of a shipped one.")],
    json: Json = False,
) -> None:
    """Validate a scene; print it resolved, with the effects it calls for and why, and the sizes of a run."""
    from workflows.progress import Stages
    from workflows.results import provenance
    from workflows.scene import load as scene_file
    from workflows.solve import resources
    from workflows.solve.model_choice import choose_model, model

    source = scene_file.load(scene)
    resources.check(source)
    decided = choose_model(source, Stages(visible=False))
    given = None if source.mesh is None else decided.form
    sizes = resources.sizes(source, decided, None if decided.form is None else model(source, decided))
    if json:
        from json import dumps

        found = provenance.document(source, decided.effects, decided.theory, given) | {"sizes": vars(sizes)}
        typer.echo(dumps(found, indent=1, allow_nan=False))
        return
    typer.echo("\n".join(provenance.heading(source, given)))
    typer.echo(provenance.as_toml(source.scene, decided.effects, decided.theory))
    typer.echo(f"\n# {sizes}")
