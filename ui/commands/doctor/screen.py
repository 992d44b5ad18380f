"""Check of the screen: open a window in a separate program, because Qt aborts a program if its plug-in fails."""

import os
import re
import subprocess
import sys
from collections.abc import Mapping

from ui.commands.doctor.qt_libraries import remedy_for
from ui.commands.doctor.result import HealthCheck, ok, warning
from ui.windows.display import why_no_window

_PROGRAM = """
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

application = QApplication(["thbridge"])
window = QWidget()
window.resize(240, 80)
window.show()
shown = QTest.qWaitForWindowExposed(window, 10000)
window.close()
print("window", application.platformName(), shown)
"""
_TIMEOUT = 30.0
"""Time limit of the program, seconds. It is long enough to load Qt from a slow disk."""
_NOT_LOADED = re.compile(r"(lib[\w.+-]+\.so[.\d]*): cannot open shared object file")
_OF_PLATFORM = re.compile(r"^qt\.qpa\.\w+: (.+)$", re.MULTILINE)
_PLUGIN_ADVICE = "is needed to load"
"""Part of the line that Qt always adds when its plug-in xcb fails, for any reason."""


def check_screen() -> HealthCheck:
    """Check that a window opens on the screen."""
    reason = why_no_window()
    if reason is None:
        return try_window(os.environ)
    problem, _, remedy = reason.partition(". ")
    return warning("screen", problem, remedy.rstrip("."))


def try_window(environment: Mapping[str, str], timeout: float = _TIMEOUT) -> HealthCheck:
    """Open and close a small window on the Qt platform that an environment names."""
    named = next(
        (f"{name}={environment[name]}" for name in ("WAYLAND_DISPLAY", "DISPLAY") if environment.get(name)), ""
    )
    screen = named or "the screen"
    look = "Check that the display exists and that you have access to it, for example with xdpyinfo"
    try:
        done = subprocess.run(
            [sys.executable, "-c", _PROGRAM],
            env={**environment, "QT_DEBUG_PLUGINS": "1"},
            capture_output=True, text=True, errors="replace", timeout=timeout, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return warning("screen", f"Qt opened no window on {screen} within {timeout:g} s", look)
    opened = re.search(r"^window (\S+) (\w+)$", done.stdout, re.MULTILINE)
    if opened is None:
        return failed_window(screen, done.stderr, look)
    if opened[2] != "True":
        return warning("screen", f"a window on {screen} was opened, but not shown within 10 s", look)
    return ok("screen", f"a window opens on {screen} (Qt's platform {opened[1]})")


def failed_window(screen: str, said: str, look: str) -> HealthCheck:
    """Return the result if Qt aborted the program, with the reason that Qt printed."""
    missing = list(dict.fromkeys(_NOT_LOADED.findall(said)))
    if missing:
        return warning(
            "screen", f"no window opens on {screen}: Qt cannot load {', '.join(missing)}", remedy_for(missing)
        )
    # With QT_DEBUG_PLUGINS, Qt also lists each plug-in that it finds.
    lines = (line for line in _OF_PLATFORM.findall(said) if _PLUGIN_ADVICE not in line)
    words = next(lines, "Qt gave no reason")
    return warning("screen", f"no window opens on {screen}: {words.rstrip('.')}", look)
