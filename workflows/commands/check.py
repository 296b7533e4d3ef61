"""`spindamp check`: validate a scene and show what would be simulated."""

from __future__ import annotations

from typing import Annotated

import typer

from workflows.commands.options import Json


def check(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help="A scene (TOML), or the name of a shipped one.")],
    json: Json = False,
) -> None:
    """Validate a scene; print it resolved, with the effects it calls for and why, and what a run of it takes."""
    from workflows import effects, needs, pilot, pipeline, resolved, scene_file
    from workflows.errors import NoAnswer
    from workflows.stages import Stages

    source = scene_file.load(scene)
    needs.check(source)
    decided = pipeline.decide(source, Stages(visible=False))
    form = decided.form
    theory = effects.theory(source.scene, form, decided.effects["large_deflection"].on)
    given = None if source.mesh is None else form
    try:
        need = pilot.need(source, form, decided.effects)
    except NoAnswer as error:
        taken, said = None, f"A run will end without an answer: {error}"
    else:
        needs.refuse(source, need.memory, need.seconds)
        taken, said = vars(need), pilot.in_words(need)
    if json:
        from json import dumps

        found = resolved.document(source, decided.effects, theory, given) | {"needs": taken}
        typer.echo(dumps(found, indent=1, allow_nan=False))
        return
    typer.echo("\n".join(resolved.heading(source, given)))
    typer.echo(resolved.as_toml(source.scene, decided.effects, theory))
    typer.echo(f"\n# {said}")
