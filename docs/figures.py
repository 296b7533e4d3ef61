"""Pictures of the documentation: of executed pages, and of the example in README.md (`python docs/figures.py`)."""

from __future__ import annotations

import os
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the pictures are the same on any number of cores

HERE = Path(__file__).resolve().parent
EXAMPLE = {"campbell": "campbell", "working": "damping"}
"""Figures of a report that the README shows, and the names of their files."""


def axes(block: Any, variables: dict[str, Any], gallery: dict[str, Any], **_: Any) -> str:
    """Write `shown` of a block, an axes of matplotlib's, as a picture and take it away."""
    from sphinx_gallery.scrapers import figure_rst

    made = variables["example_globals"].pop("shown", None)
    if made is None:
        return ""
    path = next(variables["image_path_iterator"])
    made.figure.savefig(path, dpi=160)
    return str(figure_rst([path], gallery["src_dir"]))


def main() -> None:
    """Run the scene of README.md, write its pictures beside this file and print what the command prints."""
    sys.path.insert(0, str(HERE.parent))
    import spindamp
    from workflows.report import figures, plots, text

    (scene,) = re.findall(r"```toml\n(.*?)```", (HERE.parent / "README.md").read_text(encoding="utf-8"), flags=re.S)
    results = spindamp.run(tomllib.loads(scene))
    with plots.style():
        drawn = figures.report(results)
    for name, file in EXAMPLE.items():
        picture = plots.standalone(drawn[name], len(results.speeds))
        (HERE / f"{file}.svg").write_text(picture, encoding="utf-8")
    spindamp.report(results, HERE / "_build" / "example.html")  # its first page is report.png, by a browser
    print(text.text(results, Path("spindamp-my-blade")))


if __name__ == "__main__":
    main()
