"""Separate desktop for tests: an X server without a screen, a mouse and keyboard that tests control, and a screen
reader.

Tests see windows only as assistive technology does (AT-SPI): names, roles, positions.
"""

import ctypes
import json
import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.support.programs.peer_programs import skip_if_crashed, skipping_if_crashed

DEBIAN_PYTHON = "/usr/bin/python3"
LAUNCHER = Path("/usr/libexec/at-spi-bus-launcher")
PATIENCE = 120.0
"""Time limit of waits, seconds; it is long because other programs may keep the machine busy."""
Servers = dict[str, subprocess.Popen[bytes]]


def _missing() -> str | None:
    for program in ("Xvfb", "xdotool", "dbus-daemon"):
        if shutil.which(program) is None:
            return f"{program} is not installed"
    if not LAUNCHER.exists():
        return "at-spi2-core is not installed"
    if subprocess.run([DEBIAN_PYTHON, "-c", "import pyatspi"], capture_output=True, env={}, check=False).returncode:
        return "python3-pyatspi is not installed"
    return None


MISSING = _missing()
needs_desktop = pytest.mark.skipif(MISSING is not None, reason=f"{MISSING} (make peers, as root)")


@dataclass(frozen=True)
class Seen:
    """Object that a screen reader finds on the screen."""

    name: str
    description: str
    role: str
    window: str
    x: int
    y: int
    width: int
    height: int
    enabled: bool
    focusable: bool
    focused: bool
    checked: bool
    text: str

    @property
    def middle(self) -> tuple[float, float]:
        return self.x + self.width / 2, self.y + self.height / 2


class Desktop:
    """X display with a session bus.

    Args:
        environment: environment variables of the programs to show there.
        eyes: process of the screen reader.
        servers: programs that the desktop needs, by name.
    """

    def __init__(self, environment: dict[str, str], eyes: subprocess.Popen[str], servers: Servers) -> None:
        self.environment = environment
        self._eyes = eyes
        self._servers = servers

    def look(self) -> list[Seen]:
        """Return everything that is visible."""
        assert self._eyes.stdin is not None and self._eyes.stdout is not None
        with self._skipping_if_crashed():
            self._eyes.stdin.write("look\n")
            self._eyes.stdin.flush()
            return [Seen(**fields) for fields in json.loads(self._eyes.stdout.readline())]

    @contextmanager
    def _skipping_if_crashed(self) -> Iterator[None]:
        with ExitStack() as checked:
            for name, process in {**self._servers, "the screen reader": self._eyes}.items():
                checked.enter_context(skipping_if_crashed(name, process))
            yield

    def find(self, name: str, role: str | None = None) -> Seen | None:
        """Return the first object whose name begins with `name`; None if there is none."""
        return next(
            (seen for seen in self.look() if seen.name.startswith(name) and role in (None, seen.role)),
            None,
        )

    def wait(self, what: str, condition: Callable[[], object], seconds: float = PATIENCE) -> None:
        """Wait until a condition holds. After the time limit, raise TimeoutError with everything that is visible."""
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                with self._skipping_if_crashed():
                    shown = "\n".join(f"{one.role}: {one.name} | {one.text[:80]}" for one in self.look() if one.name)
                    raise TimeoutError(f"waited {seconds} s for {what}; there is\n{shown}")
            time.sleep(0.1)

    def found(self, name: str, role: str | None = None, seconds: float = PATIENCE) -> Seen:
        """Wait for an object with this name; return it."""
        self.wait(name, lambda: self.find(name, role) is not None, seconds)
        seen = self.find(name, role)
        assert seen is not None
        return seen

    def rested(self, name: str, role: str | None = None, seconds: float = PATIENCE) -> Seen:
        """Wait until an object with this name has the same position and state in two looks; return it."""
        before = self.found(name, role, seconds)
        while (now := self.found(name, role, seconds)) != before:
            before = now
        return now

    def do(self, *words: str) -> str:
        """Run a command of xdotool; return its output."""
        done = subprocess.run(["xdotool", *words], env=self.environment, capture_output=True, text=True, check=False)
        return done.stdout.strip()

    def focus_window(self, title: str, seconds: float = PATIENCE) -> str:
        """Wait for a window whose title begins with `title`, and give it the keyboard focus, because there is no window
        manager to do so."""
        window = ""

        def there() -> bool:
            nonlocal window
            window = self.do("search", "--onlyvisible", "--name", f"^{title}").split("\n")[-1]
            return bool(window)

        self.wait(f"a window called {title}", there, seconds)
        self.do("windowfocus", "--sync", window)
        return window

    def ask_to_close(self, window: str) -> None:
        """Ask a window to close, as window managers do after a click on the close button."""
        _ask_to_close(self.environment["DISPLAY"], int(window))

    def leave_game(self) -> None:
        """Close the participant's window in the middle of a game.

        Repeat the click while the question does not yet accept it.
        """
        self.ask_to_close(self.focus_window("Treasure hunt"))
        self.found("Leave the game", role="push button")

        def gone() -> bool:
            button = self.find("Leave the game", role="push button")
            if button is not None:
                self.click(button)
            return button is None

        self.wait("the window to close", gone)

    def press(self, *keys: str) -> None:
        """Press and release keys, one after the other."""
        self.do("key", "--delay", "40", *keys)

    def click(self, at: Seen | tuple[float, float]) -> None:
        """Click with the left button like a person: move there, press, release."""
        x, y = at.middle if isinstance(at, Seen) else at
        # Without --sync, which waits forever if the pointer is already there.
        self.do("mousemove", str(round(x)), str(round(y)), "click", "1")

    def turn_wheel(self, x: float, y: float, *, down: bool) -> None:
        """Turn the wheel of the mouse by one step over a point."""
        self.do("mousemove", str(round(x)), str(round(y)), "click", "5" if down else "4")

    def drag(self, *points: tuple[float, float]) -> None:
        """Press the left button at the first point, move through the others, and release it at the last one."""
        moves = [["mousemove", str(round(x)), str(round(y))] for x, y in points]
        self.do(*moves[0], "mousedown", "1", *(word for move in moves[1:] for word in move), "mouseup", "1")

    def picture(self, path: Path) -> None:
        """Write a picture of the screen to a file."""
        subprocess.run(["import", "-window", "root", str(path)], env=self.environment, check=True)


@contextmanager
def desktop(width: int = 1280, height: int = 860) -> Iterator[Desktop]:
    """Yield a desktop; at the end of the block, stop all its programs."""
    servers: Servers = {}
    with ExitStack() as opened:
        environment = {
            **{key: value for key, value in os.environ.items() if key not in ("QT_QPA_PLATFORM", "WAYLAND_DISPLAY")},
            "DISPLAY": opened.enter_context(x_server(width, height, servers)),
            "PYTHONUNBUFFERED": "1",
            "QT_LINUX_ACCESSIBILITY_ALWAYS_ON": "1",
        }
        command = ["dbus-daemon", "--session", "--nofork", "--nopidfile", "--print-address", "{}"]
        environment["DBUS_SESSION_BUS_ADDRESS"] = _asked_for(opened, command, servers)
        servers[LAUNCHER.name] = _started([str(LAUNCHER), "--launch-immediately"], environment)
        opened.callback(_end, servers[LAUNCHER.name])
        eyes = subprocess.Popen(
            [DEBIAN_PYTHON, str(Path(__file__).with_name("desktop_eyes.py"))],
            env={key: value for key, value in environment.items() if key != "PYTHONPATH"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        opened.callback(_end, eyes)
        yield Desktop(environment, eyes, servers)


@contextmanager
def x_server(width: int, height: int, servers: Servers | None = None) -> Iterator[str]:
    """Run an X server without a screen until the end of the block, and add it to `servers`; yield its name for
    DISPLAY."""
    servers = {} if servers is None else servers
    screen = f"{width}x{height}x24"
    with ExitStack() as opened:
        command = ["Xvfb", "-displayfd", "{}", "-screen", "0", screen, "-nolisten", "tcp", "-noreset"]
        display = _asked_for(opened, command, servers)
        with skipping_if_crashed("Xvfb", servers["Xvfb"]):
            yield f":{display}"


def _asked_for(opened: ExitStack, command: list[str], servers: Servers) -> str:
    """Start a server that writes its address to a file descriptor; return the address."""
    reading, writing = os.pipe()
    server = subprocess.Popen(
        [word.format(writing) for word in command], pass_fds=(writing,), stderr=subprocess.DEVNULL
    )
    servers[command[0]] = server
    opened.callback(_end, server)
    os.close(writing)
    with os.fdopen(reading) as answer:
        place = answer.readline().strip()
    if not place:
        skip_if_crashed(command[0], server.wait())
        raise RuntimeError(f"{command[0]} does not start")
    return place


def _started(command: list[str], environment: dict[str, str]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class _ClientMessage(ctypes.Structure):
    """XClientMessageEvent of Xlib, padded to the size of XEvent."""

    _fields_ = (
        ("type", ctypes.c_int),
        ("serial", ctypes.c_ulong),
        ("send_event", ctypes.c_int),
        ("display", ctypes.c_void_p),
        ("window", ctypes.c_ulong),
        ("message_type", ctypes.c_ulong),
        ("format", ctypes.c_int),
        ("data", ctypes.c_long * 17),
    )


def _ask_to_close(display: str, window: int) -> None:
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XInternAtom.restype = ctypes.c_ulong
    x11.XInternAtom.argtypes = (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int)
    x11.XSendEvent.argtypes = (ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int, ctypes.c_long, ctypes.c_void_p)
    x11.XCloseDisplay.argtypes = (ctypes.c_void_p,)
    there = x11.XOpenDisplay(display.encode())
    client_message = 33
    event = _ClientMessage(
        type=client_message,
        window=window,
        message_type=x11.XInternAtom(there, b"WM_PROTOCOLS", 0),
        format=32,
    )
    event.data[0] = x11.XInternAtom(there, b"WM_DELETE_WINDOW", 0)
    x11.XSendEvent(there, window, 0, 0, ctypes.byref(event))
    x11.XCloseDisplay(there)


def _end(process: subprocess.Popen[bytes] | subprocess.Popen[str]) -> None:
    process.terminate()
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
