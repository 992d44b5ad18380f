"""Preferences of tests, in a separate file."""

from pathlib import Path

from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QApplication

from ui.windows.look import Choice
from ui.windows.preferences import Preferences


def preferred(qapp: QApplication, folder: Path, choice: Choice = "light", *, has_sound: bool = True) -> Preferences:
    """Return preferences that are stored in a folder."""
    kept = QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat)
    return Preferences(qapp, kept, choice, has_sound=has_sound)
