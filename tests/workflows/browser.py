"""A real browser without a window that runs a page, with a script of the test's at its end."""

from __future__ import annotations

import html
import json
import re
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from tests.workflows.conftest import PHONE, SOFTWARE_GL, chromium

AXE = find_spec("axe_core_python")
needs_axe = pytest.mark.skipif(AXE is None, reason="needs axe-core-python")


def driven(
    page: Path, script: str, folder: Path, gl: tuple[str, ...] = SOFTWARE_GL, *more: str, width: int = 1000
) -> Any:
    """What a script returns that a page runs once it stands; it may wait (`await`).

    Fails on whatever the page has to say on the console.
    """
    text = page.read_text(encoding="utf-8")
    end = f"(async () => {{ {script} }})().then(found => {{ document.title = 'found: ' + JSON.stringify(found) }})"
    copy = folder / "driven.html"
    copy.write_text(text.replace("</body>", f"<script>{end}</script></body>"), encoding="utf-8")
    arguments = ("--enable-logging=stderr", "--virtual-time-budget=4000", "--dump-dom")
    done = chromium(folder / "profile", *arguments, f"--window-size={width},1600", *more, copy.as_uri(), gl=gl)
    said = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    assert not said, said
    found = re.search(r"<title>found: (.*?)</title>", done.stdout, re.S)
    assert found is not None, done.stderr[-2000:]
    return json.loads(html.unescape(found[1]))


def findings(page: Path, folder: Path, *more: str) -> list[str]:
    """What axe-core finds in a page that hinders readers, of any weight, on a screen as wide as a phone."""
    assert AXE is not None
    assert AXE.origin is not None
    axe = Path(AXE.origin).with_name("axe.min.js").read_text(encoding="utf-8").replace("</script", "<\\/script")
    text = page.read_text(encoding="utf-8")
    copy = folder / "checked.html"
    copy.write_text(text.replace("</body>", f"<script>{axe}</script></body>"), encoding="utf-8")
    look = "const { violations } = await axe.run(document, { resultTypes: ['violations'] });"
    look += (
        "return violations.map(v => [v.impact, v.id, ...v.nodes.slice(0, 3).map(n => n.html.slice(0, 90))].join(' '));"
    )
    found: list[str] = driven(copy, look, folder, SOFTWARE_GL, *more, width=PHONE)
    return found
