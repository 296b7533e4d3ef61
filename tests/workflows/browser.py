"""A real browser without a window that runs a page, with a script of the test's at its end."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path
from typing import Any

from tests.workflows.conftest import SOFTWARE_GL, chromium


def driven(page: Path, script: str, folder: Path, gl: tuple[str, ...] = SOFTWARE_GL) -> Any:
    """What a script returns that a page runs once it stands; it may wait (`await`).

    Fails on whatever the page has to say on the console.
    """
    text = page.read_text(encoding="utf-8")
    end = f"(async () => {{ {script} }})().then(found => {{ document.title = 'found: ' + JSON.stringify(found) }})"
    copy = folder / "driven.html"
    copy.write_text(text.replace("</body>", f"<script>{end}</script></body>"), encoding="utf-8")
    arguments = ("--enable-logging=stderr", "--virtual-time-budget=4000", "--dump-dom")
    done = chromium(folder / "profile", *arguments, "--window-size=1000,1600", copy.as_uri(), gl=gl)
    said = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    assert not said, said
    found = re.search(r"<title>found: (.*?)</title>", done.stdout, re.S)
    assert found is not None, done.stderr[-2000:]
    return json.loads(html.unescape(found[1]))
