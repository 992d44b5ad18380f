"""Window of template sets."""

from pathlib import Path

from PySide6.QtGui import QTextCursor
from pytestqt.qtbot import QtBot

from tests.support.project import ROOT
from ui.windows.templates.window import TemplateWindow

SHIPPED = ROOT / "templates"


def open_templates(qtbot: QtBot, folder: Path) -> TemplateWindow:
    window = TemplateWindow(folder)
    with qtbot.waitActive(window):
        window.show()
        window.activateWindow()
    qtbot.waitUntil(lambda: window.draft is not None)
    return window


def append(window: TemplateWindow, name: str, text: str) -> None:
    page = window.pages[name]
    page.moveCursor(QTextCursor.MoveOperation.End)
    page.insertPlainText(text)
