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
    from workflows import effects, needs, plate_mesh, resolved, scene_file

    source = scene_file.load(scene)
    needs.check(source)
    form = None if source.mesh is None else plate_mesh.planform(source)
    decided = effects.resolve(source.scene, source.name, form)
    theory = effects.theory(source.scene, form, decided["large_deflection"].on)
    mesh = None if form is None else form.mesh(form.sizes[0])
    if json:
        from json import dumps

        found = resolved.document(source, decided, theory, mesh)
        typer.echo(dumps(found, indent=1, allow_nan=False))
        return
    typer.echo("\n".join(resolved.heading(source, mesh)))
    typer.echo(resolved.as_toml(source.scene, decided, theory))
    typer.echo(f"\n# A run needs about {needs.in_words(needs.memory(source))} of memory.")
