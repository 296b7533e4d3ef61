"""Equations as MathML, which browsers draw by themselves: nothing is fetched."""

from __future__ import annotations

import re
from html import escape
from typing import Any

from docutils import nodes


def setup(app: Any) -> dict[str, bool]:
    """Draw equations on HTML pages."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    app.connect("config-inited", _choose)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _choose(app: Any, config: Any) -> None:
    config.html_math_renderer = "mathml"


def _drawn(node: Any, display: str) -> str:
    from latex2mathml.converter import convert

    text = node.astext()
    drawn = re.sub(r'<mi mathvariant="bold">(\w)</mi>', _bold, convert(text, display=display))
    return f'<span role="math" aria-label="{escape(text)}">{drawn}</span>'


def _bold(letter: re.Match[str]) -> str:
    """A bold letter of its own: browsers know no variants of letters any more."""
    place = ord(letter[1])
    start = 0x1D400 - ord("A") if letter[1].isupper() else 0x1D41A - ord("a")
    return f"<mi>{chr(place + start)}</mi>" if letter[1].isascii() and letter[1].isalpha() else letter[0]


def _inline(self: Any, node: Any) -> None:
    self.body.append(_drawn(node, "inline"))
    raise nodes.SkipNode


def _block(self: Any, node: Any) -> None:
    self.body.append(
        f'<div class="equation" style="overflow-x: auto; text-align: center; margin: 0.8em 0">{_drawn(node, "block")}</div>'
    )
    raise nodes.SkipNode
