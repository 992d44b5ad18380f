"""Window with a study's form."""

from pathlib import Path

from PySide6.QtWidgets import QApplication, QLineEdit
from pytestqt.qtbot import QtBot

from tests.support.windows.questions import answering
from ui.windows.study import StudyWindow, study_window


def open_study(qtbot: QtBot, path: Path) -> StudyWindow:
    window = study_window(path)
    with qtbot.waitActive(window):
        window.show()
        window.activateWindow()
    return window


def leave_study(window: StudyWindow) -> None:
    """Close the window, and discard its changes."""
    with answering("Discard"):
        window.close()
    window.deleteLater()


def settled(qtbot: QtBot, window: StudyWindow) -> None:
    # Typed text is checked after a short delay.
    qtbot.waitUntil(lambda: window.editor.settled)


def retype(qtbot: QtBot, window: StudyWindow, key: str, typed: str) -> QLineEdit:
    window.open_field(key)
    line = QApplication.focusWidget()
    assert isinstance(line, QLineEdit)
    line.selectAll()
    qtbot.keyClicks(line, typed)
    settled(qtbot, window)
    return line
