"""Check whether windows can open on a display."""

import importlib.util
import os
import sys

INVISIBLE_PLATFORMS = {"offscreen", "minimal"}
"""Names of Qt's platforms whose windows are not visible."""


def why_no_window() -> str | None:
    """Return the reason why windows cannot open, with a remedy; None if they can open."""
    if importlib.util.find_spec("PySide6") is None or importlib.util.find_spec("pyqtgraph") is None:
        return "The packages for windows are not installed. Run make setup, or: pip install 'thbridge[gui]'."
    platform = os.environ.get("QT_QPA_PLATFORM", "").partition(":")[0]
    if platform in INVISIBLE_PLATFORMS:
        return f"QT_QPA_PLATFORM={platform} prevents visible windows. Unset this variable."
    if sys.platform == "linux" and not platform and not any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY"))):
        return "No display is available (DISPLAY is not set). Run the program on a desktop, or with xvfb-run."
    return None
