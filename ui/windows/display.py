"""Check for a display on which windows can be opened."""

import importlib.util
import os
import sys

INVISIBLE_PLATFORMS = {"offscreen", "minimal"}
"""Platforms of Qt that show nothing to anybody."""


def why_no_window() -> str | None:
    """Return the reason why no window can be opened, with a remedy; None where one can."""
    if importlib.util.find_spec("PySide6") is None or importlib.util.find_spec("pyqtgraph") is None:
        return "The packages for windows are not installed. Run make setup, or: pip install 'thbridge[gui]'."
    platform = os.environ.get("QT_QPA_PLATFORM", "").partition(":")[0]
    if platform in INVISIBLE_PLATFORMS:
        return f"QT_QPA_PLATFORM={platform} keeps windows from being shown. Unset it."
    if sys.platform == "linux" and not platform and not any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY"))):
        return "There is no display (DISPLAY is not set). Start it on a desktop, or by xvfb-run."
    return None
