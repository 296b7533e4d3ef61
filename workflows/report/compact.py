"""What matplotlib writes as SVG, made an element of a page: in the page's colours and type, and small."""

from __future__ import annotations

import re
from collections import Counter

from workflows.report.palette import VARIABLES

_HUNDREDTHS = re.compile(r"(\.\d\d)\d+")
"""Coordinates beyond hundredths of a point, which nobody sees."""


def for_a_page(text: str, name: str, description: str) -> str:
    """The drawing as an element of a page; `name` keeps its ids and classes apart from other drawings'."""
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.S)
    text = re.sub(r'\sxmlns(:\w+)?="[^"]*"', "", text)
    text = text.replace("xlink:href", "href")
    text = re.sub(r"(font(?:-family)?:[^;\"]*?)'DejaVu Sans'(?:, sans-serif)?", r"\1var(--sans)", text)
    text = re.sub(r' (?:d|x|y)="[^"]*"', lambda path: _HUNDREDTHS.sub(r"\1", path[0]), text)
    for colour, variable in VARIABLES.items():
        text = text.replace(colour, f"var({variable})")
    text = re.sub(r'(<text style="[^"]*)var\(--line-', r"\1var(--text-", text)
    text = re.sub(r"#0203([0-9a-f]{2})", lambda found: f"var(--shade-{int(found[1], 16)})", text)
    text = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", text, count=1)
    text = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", text, count=1)
    return _styled(_compact(_named(text, name)), name).replace("<svg", f'<svg role="img" aria-label="{description}"', 1)


def _compact(text: str) -> str:
    """The same drawing without remarks and blanks, the style of markers said once."""
    text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r' transform="rotate\(-0 [^"]*"', "", text)
    text = re.sub(r'(?<= d=")[^"]*', lambda path: re.sub(r"\s*([A-Za-z\n])\s*", r"\1", path[0].strip()), text)
    text = re.sub(r' style="[^"]*"', lambda style: re.sub(r"([:;]) ", r"\1", style[0]), text)
    text = re.sub(r"(opacity:0\.\d\d)\d+", r"\1", text)
    text = _drawn_once(re.sub(r">\s+<", "><", text))
    text = re.sub(r'(?:<use [^>]*? style="[^"]*"/>){2,}', _markers, text)
    while (plain := re.sub(r"<g>(<(?:path|use|text)\b[^>]*(?:/>|>[^<]*</\w+>))</g>", r"\1", text)) != text:
        text = plain
    return text.replace("><", ">\n<")


def _drawn_once(text: str) -> str:
    """Shapes that are defined and then used once, as those of a map are, drawn where they stand."""
    times = Counter(re.findall(r'href="#([^"]+)"', text))

    def plain(found: re.Match[str]) -> str:
        name, path, clip, x, y, style = found.groups()
        if times[name] > 1:
            return str(found[0])
        return f'<g clip-path="{clip}"><g transform="translate({x} {y})"><path {path}{style}/></g></g>'

    text = re.sub(
        r'<g><defs><path id="([^"]+)" (d="[^"]*")/></defs><g clip-path="([^"]+)">'
        r'<use href="#\1" x="([^"]*)" y="([^"]*)"( style="[^"]*")/></g></g>',
        plain,
        text,
    )
    return re.sub(r'(?:<g clip-path="[^"]+"><g transform="[^"]+"><path [^>]*/></g></g>){2,}', _together, text)


def _together(run: re.Match[str]) -> str:
    """Shapes one after another; where they are cut and moved alike, in one group."""
    heads = set(re.findall(r"<g clip-path[^>]*><g transform[^>]*>", run[0]))
    if len(heads) > 1:
        return str(run[0])
    head = str(heads.pop())
    return head + str(run[0]).replace(head, "").replace("</g></g>", "") + "</g></g>"


def _named(text: str, name: str) -> str:
    """Ids that something refers to as `name` and a number; the others are left out."""
    found = dict.fromkeys(re.findall(r"[(\"]#([^)\"]+)", text))
    short = {old: f"{name}{number}" for number, old in enumerate(found)}
    text = re.sub(r' id="([^"]*)"', lambda old: f' id="{short[old[1]]}"' if old[1] in short else "", text)
    return re.sub(r'([("])#([^)"]+)', lambda old: f"{old[1]}#{short[old[2]]}", text)


def _styled(text: str, name: str) -> str:
    """Styles that occur again and again as classes, `name` and a number, said once in the drawing."""
    often = [style for style, times in Counter(re.findall(r' style="([^"]*)"', text)).items() if times > 2]
    classes = {style: f"{name}-{number}" for number, style in enumerate(often)}
    text = re.sub(r' style="([^"]*)"', lambda old: f' class="{classes[old[1]]}"' if old[1] in classes else old[0], text)
    rules = "".join(f".{each}{{{style}}}\n" for style, each in classes.items())
    return text.replace("</style>", f"\n{rules}</style>", 1)


def _markers(run: re.Match[str]) -> str:
    """Markers one after another; where they have one style, in a group that has it."""
    styles = set(re.findall(r' style="([^"]*)"', run[0]))
    if len(styles) > 1:
        return run[0]
    bare = re.sub(r' style="[^"]*"', "", run[0])
    return f'<g style="{styles.pop()}">{bare}</g>'
