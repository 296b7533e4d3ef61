"""`spindamp check`: validate a scene and show what would be simulated."""

from __future__ import annotations

from typing import Annotated

import typer

from workflows.cli.commands.options import Json


def check(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help="A scene (TOML), or the name of a shipped one.")],
    json: Json = False,
) -> None:
    """Validate a scene; print it resolved, with the effects it calls for and why, and what a run of it takes."""
    from workflows.cli.commands import kernels
    from workflows.errors import NoAnswer
    from workflows.results import resolved
    from workflows.scene import file as scene_file
    from workflows.solve import needs, pilot
    from workflows.solve.decided import decide
    from workflows.stages import Stages

    source = scene_file.load(scene)
    needs.check(source)
    if source.scene.damper is not None:
        kernels.say()
    decided = decide(source, Stages(visible=False))
    given = None if source.mesh is None else decided.form
    try:
        need = pilot.need(source, decided)
    except NoAnswer as error:
        taken, said = None, f"A run will end without an answer: {error}"
    else:
        needs.refuse(source, need.memory, need.seconds)
        taken, said = vars(need), pilot.in_words(need)
    if json:
        from json import dumps

        found = resolved.document(source, decided.effects, decided.theory, given) | {"needs": taken}
        typer.echo(dumps(found, indent=1, allow_nan=False))
        return
    typer.echo("\n".join(resolved.heading(source, given)))
    typer.echo(resolved.as_toml(source.scene, decided.effects, decided.theory))
    typer.echo(f"\n# {said}")
