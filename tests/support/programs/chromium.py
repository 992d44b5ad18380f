"""Chromium without a screen, controlled through the DevTools protocol."""

import base64
import contextlib
import itertools
import json
import subprocess
import tempfile
import time
import urllib.request
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from websockets.sync.client import connect

CHROMIUM = Path("/usr/bin/chromium")
_FLAGS = (
    *(
        "--headless=new",
        "--no-sandbox",
        "--mute-audio",
        "--disable-dev-shm-usage",
        "--disable-gpu",
        "--hide-scrollbars",
    ),
    *(
        "--blink-settings=primaryHoverType=2,availableHoverTypes=2,primaryPointerType=4,availablePointerTypes=4",
        "--remote-debugging-port=0",
        "--no-first-run",
        "--disable-extensions",
        "--disable-background-networking",
    ),
)
_CODES = {"Tab": 9, "Enter": 13, "Escape": 27, "ArrowUp": 38, "ArrowDown": 40}


class Chromium:
    """Browser with one tab.

    Args:
        profile: folder of the browser's profile, which keeps its cookies; a temporary one by default.

    Attributes:
        messages: events that the browser has reported, oldest first.
    """

    def __init__(self, profile: Path | None = None) -> None:
        self._temporary = tempfile.TemporaryDirectory(prefix="chromium-", ignore_cleanup_errors=True)
        self._profile = Path(self._temporary.name) if profile is None else profile
        # A browser that was killed has left the file.
        self._ports.unlink(missing_ok=True)
        self._process = subprocess.Popen(
            [CHROMIUM, *_FLAGS, f"--user-data-dir={self._profile}", "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._numbers = itertools.count(1)
        self.messages: list[dict[str, Any]] = []
        port = self._port()
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/json/list", timeout=30) as answer:
            tab = next(each for each in json.load(answer) if each["type"] == "page")
        self._open = contextlib.ExitStack()
        self._socket = self._open.enter_context(connect(tab["webSocketDebuggerUrl"], max_size=None, ping_interval=None))
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.command(f"{domain}.enable")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _: TracebackType | None
    ) -> None:
        self._open.close()
        self._process.terminate()
        self._process.wait(30)
        self._temporary.cleanup()

    def kill(self) -> None:
        """Kill the browser."""
        self._process.kill()
        self._open.close()
        self._process.wait(30)

    def command(self, method: str, **parameters: object) -> dict[str, Any]:
        """Send a command of the DevTools protocol; return its result."""
        number = next(self._numbers)
        self._socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self._socket.recv(timeout=120))
            if message.get("id") == number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return dict(message["result"])
            self.messages.append(message)

    def evaluate(self, expression: str) -> Any:
        """Return the value of an expression in the page; a promise is awaited."""
        done = self.command("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in done:
            raise RuntimeError(done["exceptionDetails"]["exception"].get("description", expression))
        return done["result"].get("value")

    def until(self, expression: str, seconds: float = 60.0) -> None:
        """Wait until an expression is true in the page. Raise TimeoutError at the end of the timeout."""
        end = time.monotonic() + seconds
        while not self._holds(expression):
            if time.monotonic() > end:
                raise TimeoutError(f"not true in the page: {expression}\n{self.evaluate('document.body.innerText')}")
            time.sleep(0.02)

    def open(self, address: str, before: str = "", blocked: Sequence[str] = ()) -> None:
        """Open an address as a new visitor.

        Args:
            address: the address.
            before: JavaScript that runs before the page's own scripts.
            blocked: addresses that the browser cannot reach, with `*` for any text.
        """
        self.command("Network.clearBrowserCookies")
        self.command("Network.setBlockedURLs", urls=list(blocked))
        script = self.command("Page.addScriptToEvaluateOnNewDocument", source=before)["identifier"]
        self.come_back(address)
        self.command("Page.removeScriptToEvaluateOnNewDocument", identifier=script)

    def come_back(self, address: str) -> None:
        """Open an address with the cookies so far."""
        self.command("Page.navigate", url=address)
        self.until("document.readyState === 'complete' && location.protocol !== 'about:'")

    def resize(self, width: int, height: int, *, touch: bool = False) -> None:
        """Give the page a size in pixels; with `touch`, as on a phone."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": touch}
        self.command("Emulation.setDeviceMetricsOverride", **size)
        self.command("Emulation.setTouchEmulationEnabled", enabled=touch)

    def prefer(self, *, dark: bool = False, still: bool = False) -> None:
        """Set the preferences of the person's system: dark colors, reduced motion."""
        features = [
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"},
            {"name": "prefers-reduced-motion", "value": "reduce" if still else "no-preference"},
        ]
        self.command("Emulation.setEmulatedMedia", features=features)

    def press(self, key: str, code: str = "", *, ctrl: bool = False, shift: bool = False, alt: bool = False) -> None:
        """Press and release a key; `key` is named as in the DOM."""
        held = alt * 1 + ctrl * 2 + shift * 8
        event: dict[str, object] = {"key": key, "code": code, "modifiers": held}
        if key in _CODES:
            event["windowsVirtualKeyCode"] = _CODES[key]
        text = "\r" if key == "Enter" else key if len(key) == 1 and not ctrl and not alt else ""
        self.command("Input.dispatchKeyEvent", type="keyDown" if text else "rawKeyDown", text=text, **event)
        self.command("Input.dispatchKeyEvent", type="keyUp", **event)

    def picture(self) -> bytes:
        """Return the visible part of the page as a PNG."""
        return base64.b64decode(self.command("Page.captureScreenshot", format="png")["data"])

    def _holds(self, expression: str) -> bool:
        try:
            return bool(self.evaluate(expression))
        except RuntimeError:
            return False  # The page is being replaced, or an element does not exist yet.

    @property
    def _ports(self) -> Path:
        return self._profile / "DevToolsActivePort"

    def _port(self) -> int:
        file, end = self._ports, time.monotonic() + 60
        while time.monotonic() < end:
            if file.exists() and (lines := file.read_text().split()):
                return int(lines[0])
            time.sleep(0.05)
        raise TimeoutError("Chromium did not start")
