"""`spindamp check`: validate a scene and show what would be simulated."""

from __future__ import annotations

from typing import Annotated

import typer

from workflows.commands.options import Json


def check(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help="A scene (TOML), or the name of a shipped one.")],
    json: Json = False,
) -> None:
    """Validate a scene; print it resolved, with the effects it calls for and why."""
    from workflows import effects, needs, resolved, scene_file

    source = scene_file.load(scene)
    needs.check(source)
    sides = None
    if source.mesh is not None:
        from workflows import plate_mesh

        sides = plate_mesh.check(source)
    decided = effects.of(source)
    theory = effects.theory(source.scene, sides, decided["large_deflection"].on)
    if json:
        from json import dumps

        typer.echo(dumps(resolved.document(source.scene, decided, theory), indent=1, allow_nan=False))
        return
    typer.echo(resolved.as_toml(source.scene, decided, theory))
    typer.echo(f"\n# A run needs about {needs.in_words(needs.memory(source))} of memory.")
