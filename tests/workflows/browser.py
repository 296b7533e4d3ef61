"""A real browser without a window, started once: opens a page, runs a test's script in it, prints it.

It is spoken to in the Chrome DevTools Protocol over a pipe (https://chromedevtools.github.io/devtools-protocol/).
"""

import atexit
import base64
import fcntl
import json
import os
import select
import shutil
import subprocess
import tempfile
from contextlib import contextmanager
from functools import cache
from html.parser import HTMLParser
from importlib.util import find_spec
from pathlib import Path
from time import monotonic
from typing import Any

import pytest

from tests.limits import HANG

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="needs chromium (Debian: apt-get install chromium)")

AXE = find_spec("axe_core_python")
needs_axe = pytest.mark.skipif(AXE is None, reason="needs axe-core-python")

PHONE = 400
"""Pixels across."""

WIDE = 1000

SOFTWARE_GL = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""Flags by which WebGL is drawn without a graphics card."""

NO_GL = "HTMLCanvasElement.prototype.getContext = () => null;"
"""What a page finds that has no WebGL."""

VIEWER = """
const figure = document.querySelector('figure.viewer'), canvas = figure.querySelector('canvas');
const form = figure.querySelector('form');
const copy = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
const pixels = () => {
  figure.viewer.draw();
  [copy.canvas.width, copy.canvas.height] = [canvas.width, canvas.height];
  copy.drawImage(canvas, 0, 0);
  return copy.getImageData(0, 0, canvas.width, canvas.height).data;
};
"""
"""Scripts on a page's viewer begin with this."""

WORDS = ("Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded")


VOID = {"meta", "link", "img", "br", "hr", "input"}
"""Tags that are never closed."""


class Reader(HTMLParser):
    """Collects what could load something, ids, and tags left open."""

    def __init__(self, text):
        super().__init__()
        self.loads: list[str] = []
        self.ids: list[str] = []
        self.references: list[str] = []
        self.tags: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        for name, value in attrs:
            if name in ("src", "href", "xlink:href", "data", "action", "srcset") and value:
                (self.references if value.startswith("#") else self.loads).append(value)
            elif name == "id" and value:
                self.ids.append(value)
            elif name.startswith("on"):
                pytest.fail(f"{tag} {name}")
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, self.getpos()


class Browser:
    """One process; commands go down its file 3, answers and events come up its file 4, each ended by a zero byte."""

    def __init__(self):
        self.profile = tempfile.mkdtemp(prefix="browser-")
        down, self.down = os.pipe()
        self.up, up = os.pipe()
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (down, up)]
        quiet = ("--headless", "--no-sandbox", "--hide-scrollbars", "--disable-background-networking")
        arguments = (*quiet, *SOFTWARE_GL, "--remote-debugging-pipe", f"--user-data-dir={self.profile}", "about:blank")
        self.process = subprocess.Popen(
            [str(CHROMIUM), *arguments],
            stderr=subprocess.DEVNULL,
            pass_fds=(3, 4),
            preexec_fn=lambda: [os.dup2(end, name) for end, name in zip(ends, (3, 4), strict=True)] and None,
        )
        for end in (down, up, *ends):
            os.close(end)
        self.last = 0
        self.read = b""
        self.events: list[dict[str, Any]] = []
        atexit.register(self.close)

    def ask(self, method, session=None, **given):
        """The answer to a command."""
        self.last += 1
        message = {"id": self.last, "method": method, "params": given}
        if session is not None:
            message["sessionId"] = session
        left = memoryview(json.dumps(message).encode() + b"\0")
        while left:
            left = left[os.write(self.down, left) :]
        while (found := self.next()).get("id") != self.last:
            self.events.append(found)
        assert "error" not in found, (method, found["error"])
        return found["result"]

    def wait(self, method, session):
        """Until this happens in a page, or has happened."""
        while not any(each.get("method") == method and each.get("sessionId") == session for each in self.events):
            self.events.append(self.next())

    def next(self):
        """The next answer or event."""
        end = monotonic() + HANG
        while b"\0" not in self.read:
            ready, _, _ = select.select([self.up], [], [], max(end - monotonic(), 0))
            assert ready, "the browser says nothing"
            more = os.read(self.up, 1 << 20)
            assert more, "the browser is gone"
            self.read += more
        first, _, self.read = self.read.partition(b"\0")
        return json.loads(first)

    def close(self):
        """End it; it ends by itself where its pipe does."""
        os.close(self.down)
        self.process.wait(HANG)
        os.close(self.up)
        shutil.rmtree(self.profile, ignore_errors=True)


class Page:
    """A page that stands in a browser."""

    def __init__(self, browser, session):
        self.browser, self.session = browser, session

    def ask(self, method, **given):
        """The answer to a command for this page."""
        return self.browser.ask(method, self.session, **given)

    def returned(self, script):
        """What a script returns; it may wait (`await`)."""
        text = f"(async () => {{ {script} }})()"
        found = self.ask("Runtime.evaluate", expression=text, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def prefers(self, scheme, motion="no-preference"):
        """Have it shown as to readers who prefer `light` or `dark`, and perhaps to `reduce` what moves."""
        values = {"prefers-color-scheme": scheme, "prefers-reduced-motion": motion}
        self.ask("Emulation.setEmulatedMedia", features=[{"name": k, "value": v} for k, v in values.items()])

    def resize(self, width):
        """Have a screen of so many pixels across."""
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=1600, deviceScaleFactor=1, mobile=False)

    def file(self, method, **given):
        """The page as the file that a command makes of it."""
        return base64.b64decode(self.ask(method, **given)["data"])

    def words(self):
        """Whatever it had to say on the console."""
        mine = (each for each in self.browser.events if each.get("sessionId") == self.session)
        return [each["params"] for each in mine if each.get("method") in WORDS]


_running = cache(Browser)


@contextmanager
def opened(path, *, width=WIDE, motion="no-preference", before=""):
    """A page in a browser's tab of its own; it fails at the end on whatever the page had to say on the console.

    before: a script that runs before any of the page's own.
    """
    browser = _running()
    browser.events.clear()
    home = browser.ask("Target.createBrowserContext")["browserContextId"]
    target = browser.ask("Target.createTarget", url="about:blank", browserContextId=home)["targetId"]
    session = browser.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
    page = Page(browser, session)
    for domain in ("Page", "Runtime", "Log"):
        page.ask(f"{domain}.enable")
    page.ask("Page.addScriptToEvaluateOnNewDocument", source=before)
    page.resize(width)
    page.prefers("light", motion)
    page.ask("Page.navigate", url=path.as_uri())
    browser.wait("Page.loadEventFired", session)
    try:
        yield page
        said = page.words()
        assert not said, said
    finally:
        browser.ask("Target.disposeBrowserContext", browserContextId=home)


def driven(path, script, *, before=""):
    """What a script returns that a page runs once it stands; nothing in it moves by itself."""
    with opened(path, motion="reduce", before=before) as page:
        return page.returned(script)


def findings(path, schemes=("light",)):
    """What hinders readers on a screen as wide as a phone: a page that is wider, and all that axe-core finds.

    Nothing where there is no browser; its width alone where there is no axe-core. Of further schemes only colours are
    looked at: nothing else depends on them. What moves stands still, as it would take most of the time.
    """
    if CHROMIUM is None:
        return []
    with opened(path, width=PHONE, motion="reduce") as page:
        across = page.returned("return document.documentElement.scrollWidth")
        found = [] if across <= PHONE else [f"{across} pixels across"]
        if AXE is None or AXE.origin is None:
            return found
        axe = Path(AXE.origin).with_name("axe.min.js").read_text(encoding="utf-8")
        page.ask("Runtime.evaluate", expression=axe)
        show = "const seen = v => v.nodes.slice(0, 3).map(n => n.html.slice(0, 90));"
        show += "return violations.map(v => [v.impact, v.id, ...seen(v)].join(' '));"
        rules = "{}"
        for scheme in schemes:
            page.prefers(scheme, "reduce")
            options = f"{{ resultTypes: ['violations'], preload: false, ...{rules} }}"
            found += page.returned(f"const {{ violations }} = await axe.run({options});" + show)
            rules = "{ runOnly: ['color-contrast', 'link-in-text-block'] }"
    return found
