"""How the documentation is built: `python3 go.py docs`."""

import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

project, author = "spindamp", "the authors of spindamp"
extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
    "myst_parser",
    "mathml",
    "reference",
]
exclude_patterns = ["_build", "examples/*", "**/sg_execution_times.rst", "sg_execution_times.rst"]
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3
highlight_language = "text"  # of blocks that name none
suppress_warnings = ["config.cache"]

html_theme = "pydata_sphinx_theme"
html_title = "spindamp"
html_theme_options = {
    "navigation_with_keys": True,
    "show_toc_level": 2,
    "secondary_sidebar_items": ["page-toc"],
    "navbar_end": ["theme-switcher"],
}
html_sidebars = {name: [] for name in ("index", "tour", "cluster", "physics", "scene", "validation", "architecture", "api")}
html_sourcelink_suffix = ""
html_show_sourcelink = False

autodoc_typehints = "description"
autodoc_member_order = "bysource"
napoleon_google_docstring, napoleon_numpy_docstring = True, False

sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "questions",
    "filename_pattern": r"/plot_",
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": False,
    "show_signature": False,
    "show_memory": False,
    "abort_on_example_error": True,
    "image_scrapers": ("figures.axes",),
    "reset_modules": (),
}


def setup(app):
    """Docstrings are plain text with bars and powers in it, not reStructuredText."""
    app.connect("autodoc-process-docstring", _plain)
    app.connect("source-read", _inside)


def _plain(app, what, name, thing, options, lines):
    lines[:] = [re.sub(r"(?<=\w)_(?!\w)", r"\\_", line.replace("|", "\\|")) for line in lines]


def _inside(app, name, source):
    """Links out of docs/, which are of use where the files are read as they lie."""
    out = re.escape("../" * (name.count("/") + 1))
    text = source[0].replace("](../CONTRIBUTING.md", "](contributing.md")
    source[0] = re.sub(rf"\[([^\]]+)\]\({out}[^)]*\)", r"\1", text)
