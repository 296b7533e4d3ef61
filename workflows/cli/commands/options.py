"""Arguments that commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

SceneArgument = Annotated[
    str,
    typer.Argument(metavar="[SCENE]", help="A scene (TOML), or the name of a shipped one.", show_default=True),
]
Out = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Folder for the results; replaced whole or not at all.")
]
Processes = Annotated[
    int | None, typer.Option("--workers", metavar="N", help="Processes of this machine; without it, one for each core.")
]
Dask = Annotated[
    str | None, typer.Option("--dask", metavar="ADDRESS", help="A Dask scheduler, whose workers compute instead.")
]
Seed = Annotated[int, typer.Option("--seed", metavar="N", help="Of what is drawn at random.")]
Json = Annotated[bool, typer.Option("--json", help="Print the machine-readable result and nothing else.")]
