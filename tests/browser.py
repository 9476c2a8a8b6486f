"""A real headless Chromium for the tests of the pages, driven over its DevTools pipe.

Tests take the fixture ``page`` of ``tests/conftest.py`` (one browser a session, a fresh profile a
test)::

    def test_slider(page: Page, tmp_path: Path) -> None:
        page.emulate(dark=True, width=380)
        page.open(tmp_path / "report.html")
        page.click("#play")
        page.slide("#friction", 0.34)
        page.wait("document.querySelector('#margin').textContent !== ''")
        assert page.errors == []
        assert page.outside == []

The protocol is spoken as NUL-ended JSON through file descriptors 3 and 4 of the browser, so neither a
port nor another package is needed: https://chromedevtools.github.io/devtools-protocol/.
"""

from __future__ import annotations

import base64
import fcntl
import json
import os
import select
import shutil
import signal
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

Json = dict[str, Any]

NAMES = ("chromium", "chromium-browser", "google-chrome")
REQUIRED = "MESO_BROWSER"  # set to "required", a missing browser is a failure and not a skip
PATIENCE = 60.0  # seconds that any one answer may take
OWN_SCHEMES = ("data:", "about:")
SWITCHES = [
    "--headless",
    "--remote-debugging-pipe",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-extensions",
    "--mute-audio",
    "--hide-scrollbars",
    "--force-color-profile=srgb",
]
KEYS = {  # what a key inserts, and its code in the protocol
    "Tab": ("", 9),
    "Enter": ("\r", 13),
    "Escape": ("", 27),
    "Space": (" ", 32),
    "PageUp": ("", 33),
    "PageDown": ("", 34),
    "End": ("", 35),
    "Home": ("", 36),
    "ArrowLeft": ("", 37),
    "ArrowUp": ("", 38),
    "ArrowRight": ("", 39),
    "ArrowDown": ("", 40),
}
SHIFT = 8


class BrowserError(Exception):
    """The browser refused a command, ended, or took too long."""


def executable() -> str | None:
    """The path of the first Chromium found, or None."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Browser:
    """One running Chromium; made by `browser`."""

    def __init__(self, path: str, profile: str) -> None:
        (ours_in, to), (answers, ours_out) = os.pipe(), os.pipe()
        # above 4, so that neither end is overwritten by the other's move to 3 or 4
        source, sink = (fcntl.fcntl(fd, fcntl.F_DUPFD_CLOEXEC, 10) for fd in (ours_in, ours_out))
        actions = [
            (os.POSIX_SPAWN_DUP2, source, 3),
            (os.POSIX_SPAWN_DUP2, sink, 4),
            (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0),
            (os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0),
        ]
        command = [path, *SWITCHES, f"--user-data-dir={profile}", "about:blank"]
        self._process = os.posix_spawn(
            path, command, dict(os.environ), file_actions=actions, setpgroup=0
        )
        for fd in (ours_in, ours_out, source, sink):
            os.close(fd)
        self._to, self._answers = to, answers
        self._rest = b""
        self._asked = 0
        self._events: dict[str, list[Json]] = {}

    def send(self, method: str, session: str = "", **values: Any) -> Json:
        """The result of one command of the protocol; events on the way are kept."""
        self._asked += 1
        message: Json = {"id": self._asked, "method": method, "params": values}
        if session:
            message["sessionId"] = session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._to, data) :]
        end = time.monotonic() + PATIENCE
        while (answer := self._next(end, method)).get("id") != self._asked:
            pass
        if "error" in answer:
            raise BrowserError(f"{method}: {answer['error']['message']}")
        result: Json = answer["result"]
        return result

    def events(self, session: str) -> list[Json]:
        """What has happened in a session since this was last asked."""
        self.send("Browser.getVersion")  # whatever was sent before its answer has now arrived
        return self._events.pop(session, [])

    def _next(self, end: float, waiting: str) -> Json:
        while b"\0" not in self._rest:
            ready, _, _ = select.select([self._answers], [], [], max(0.0, end - time.monotonic()))
            read = os.read(self._answers, 1 << 20) if ready else b""
            if not read:
                raise BrowserError(f"{waiting}: the browser {'ended' if ready else 'is too slow'}")
            self._rest += read
        line, self._rest = self._rest.split(b"\0", 1)
        message: Json = json.loads(line)
        if "method" in message:
            self._events.setdefault(message.get("sessionId", ""), []).append(message)
        return message

    def close(self) -> None:
        """End the browser and all its processes."""
        os.close(self._to)
        os.close(self._answers)
        os.killpg(self._process, signal.SIGKILL)
        os.waitpid(self._process, 0)


@contextmanager
def browser(path: str) -> Iterator[Browser]:
    """A running Chromium with an empty profile, ended on leaving."""
    profile = tempfile.mkdtemp(prefix="meso-robust-browser-")
    running = Browser(path, profile)
    try:
        yield running
    finally:
        running.close()
        shutil.rmtree(profile, ignore_errors=True)


class Page:
    """One tab; made by `tab`.

    Attributes
    ----------
    url
        The address last opened.
    """

    def __init__(self, running: Browser, session: str) -> None:
        self._browser, self._session = running, session
        self._errors: list[str] = []
        self._requests: list[str] = []
        self.url = ""
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.send(f"{domain}.enable")

    def send(self, method: str, **values: Any) -> Json:
        """Any command of the protocol, for what the methods below do not offer."""
        return self._browser.send(method, self._session, **values)

    def open(self, path: Path) -> None:
        """Load a file of this machine and wait until it is loaded and drawn; forgets what was before."""
        self._collect()
        self._errors, self._requests = [], []
        self.url = path.resolve().as_uri()
        failed = self.send("Page.navigate", url=self.url).get("errorText")
        if failed:
            raise BrowserError(f"{self.url}: {failed}")
        self.wait("document.readyState === 'complete'")
        self.draw()

    @property
    def errors(self) -> list[str]:
        """Every error and warning of the console and every exception since `open`, as text."""
        self._collect()
        return list(self._errors)

    @property
    def requests(self) -> list[str]:
        """The address of every request since `open`, the page's own included."""
        self._collect()
        return list(self._requests)

    @property
    def outside(self) -> list[str]:
        """The requests for anything but the page itself and what it carries."""
        own = self.url.split("#")[0]
        return [
            url
            for url in self.requests
            if url.split("#")[0] != own and not url.startswith(OWN_SCHEMES)
        ]

    def evaluate(self, script: str) -> Any:
        """The value of a JavaScript expression (awaited if it is a promise), as JSON carries it."""
        answer = self.send(
            "Runtime.evaluate",
            expression=script,
            returnByValue=True,
            awaitPromise=True,
            userGesture=True,
        )
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise BrowserError(details.get("exception", {}).get("description", details["text"]))
        return answer["result"].get("value")

    def wait(self, condition: str, seconds: float = PATIENCE) -> None:
        """Until a JavaScript expression is true; `BrowserError` if it does not become so."""
        end = time.monotonic() + seconds
        while not self.evaluate(condition):
            if time.monotonic() > end:
                raise BrowserError(f"not true within {seconds:g} s: {condition}")
            time.sleep(0.02)

    def draw(self) -> None:
        """Until what was changed has been drawn: two frames from now."""
        self.evaluate(
            "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done())))"
        )

    def click(self, selector: str) -> None:
        """Press and release the mouse in the middle of an element, as a hand would."""
        x, y = self._middle(selector)
        self._mouse("mousePressed", x, y)
        self._mouse("mouseReleased", x, y)
        self.draw()

    def drag(self, selector: str, right: float, down: float = 0.0) -> None:
        """Drag from the middle of an element by so many pixels of the page."""
        x, y = self._middle(selector)
        self._mouse("mousePressed", x, y)
        for part in (0.25, 0.5, 0.75, 1.0):
            self._mouse("mouseMoved", x + part * right, y + part * down)
        self._mouse("mouseReleased", x + right, y + down)
        self.draw()

    def slide(self, selector: str, value: float) -> None:
        """Set a slider or another input; it fires ``input`` and ``change`` as for a hand."""
        self.evaluate(
            f"(i => {{ i.value = {json.dumps(str(value))};"
            " for (const name of ['input', 'change'])"
            f" i.dispatchEvent(new Event(name, {{bubbles: true}})); }})({self._element(selector)})"
        )
        self.draw()

    def press(self, key: str, *, shift: bool = False) -> None:
        """Press and release a key: a name of `KEYS`, or one character."""
        text, code = KEYS.get(key, (key, ord(key[0].upper())))
        name = " " if key == "Space" else key
        same: Json = {"key": name, "code": key, "windowsVirtualKeyCode": code}
        same["modifiers"] = SHIFT if shift else 0
        down = {"text": text} if text else {}
        self.send(
            "Input.dispatchKeyEvent", type="keyDown" if text else "rawKeyDown", **same, **down
        )
        self.send("Input.dispatchKeyEvent", type="keyUp", **same)
        self.draw()

    def emulate(
        self,
        *,
        dark: bool = False,
        width: int = 1280,
        height: int = 900,
        still: bool = False,
        printed: bool = False,
    ) -> None:
        """What the reader has: colour scheme, window in CSS pixels, reduced motion, paper.

        Everything is set at each call, so what is left out goes back to its default.
        """
        self.send(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        features = {
            "prefers-color-scheme": "dark" if dark else "light",
            "prefers-reduced-motion": "reduce" if still else "no-preference",
        }
        self.send(
            "Emulation.setEmulatedMedia",
            media="print" if printed else "",
            features=[{"name": name, "value": value} for name, value in features.items()],
        )
        self.draw()

    def screenshot(self, path: Path, *, whole: bool = True) -> None:
        """Write a PNG of the whole page, or only of what the window shows."""
        taken = self.send(
            "Page.captureScreenshot", captureBeyondViewport=whole, **self._clip(whole)
        )
        path.write_bytes(base64.b64decode(taken["data"]))

    def pdf(self) -> bytes:
        """The page as printed on A4 with a 15 mm margin."""
        inch = {"paperWidth": 8.27, "paperHeight": 11.69}
        inch |= {f"margin{side}": 0.59 for side in ("Top", "Bottom", "Left", "Right")}
        return base64.b64decode(self.send("Page.printToPDF", **inch)["data"])

    def _clip(self, whole: bool) -> Json:
        if not whole:
            return {}
        size = self.send("Page.getLayoutMetrics")["cssContentSize"]
        return {"clip": {"x": 0, "y": 0, "scale": 1} | {k: size[k] for k in ("width", "height")}}

    def _element(self, selector: str) -> str:
        found = f"document.querySelector({json.dumps(selector)})"
        if not self.evaluate(f"{found} !== null"):
            raise BrowserError(f"nothing on the page is {selector}")
        return found

    def _middle(self, selector: str) -> tuple[float, float]:
        x, y = self.evaluate(
            "(e => { e.scrollIntoView({block: 'center', behavior: 'instant'});"
            " const b = e.getBoundingClientRect();"
            f" return [b.x + b.width / 2, b.y + b.height / 2]; }})({self._element(selector)})"
        )
        return x, y

    def _mouse(self, what: str, x: float, y: float) -> None:
        held = {"button": "left", "buttons": 1, "clickCount": 1}
        self.send("Input.dispatchMouseEvent", type=what, x=x, y=y, **held)

    def _collect(self) -> None:
        for event in self._browser.events(self._session):
            values = event["params"]
            match event["method"]:
                case "Runtime.exceptionThrown":
                    details = values["exceptionDetails"]
                    thrown = details.get("exception", {}).get("description", details["text"])
                    self._errors.append(thrown)
                case "Runtime.consoleAPICalled" if values["type"] in ("error", "warning", "assert"):
                    said = (str(a.get("value", a.get("description"))) for a in values["args"])
                    self._errors.append(" ".join(said))
                case "Log.entryAdded" if values["entry"]["level"] in ("error", "warning"):
                    self._errors.append(values["entry"]["text"])
                case "Network.requestWillBeSent":
                    self._requests.append(values["request"]["url"])


@contextmanager
def tab(running: Browser) -> Iterator[Page]:
    """A tab of its own, without the history, storage or settings of others."""
    apart = running.send("Target.createBrowserContext")["browserContextId"]
    made = running.send("Target.createTarget", url="about:blank", browserContextId=apart)
    joined = running.send("Target.attachToTarget", targetId=made["targetId"], flatten=True)
    page = Page(running, joined["sessionId"])
    page.emulate()
    try:
        yield page
    finally:
        running.send("Target.disposeBrowserContext", browserContextId=apart)
