"""Pictures of the executed pages: whatever axes, figures or pictures a block leaves as `shown`."""

from __future__ import annotations

from typing import Any

from sphinx_gallery.scrapers import figure_rst


def axes(block: Any, variables: dict[str, Any], gallery: dict[str, Any], **_: Any) -> str:
    """Write `shown` of a block, an axes of matplotlib's, as a picture and take it away."""
    made = variables["example_globals"].pop("shown", None)
    if made is None:
        return ""
    path = next(variables["image_path_iterator"])
    made.figure.savefig(path, dpi=160)
    return str(figure_rst([path], gallery["src_dir"]))
