"""The participant's window, on samples and in a game."""

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.support.windows.participant_windows import opened
from tests.support.windows.preferences import preferred
from tests.ui.windows.participant.joined_window import ArrivedLink, JoinedWindow
from thbridge.files.language_texts import shipped_texts
from ui.windows.participant_program import ParticipantMainWindow

__all__ = ["opened"]


@pytest.fixture
def at_table(qtbot: QtBot, qapp: QApplication, tmp_path: Path) -> Callable[[bool], JoinedWindow]:
    def sit(hosted: bool) -> JoinedWindow:
        table = JoinedWindow()
        send = table.told.append if hosted else None
        window = ParticipantMainWindow(preferred(qapp, tmp_path), send, lambda: table.now, shipped_texts())
        table.window = window
        qtbot.addWidget(window, before_close_func=lambda it: it.leave())
        window.join(ArrivedLink())
        with qtbot.waitExposed(window):
            window.show()
        window.activateWindow()
        qtbot.waitUntil(window.isActiveWindow)
        qtbot.waitUntil(lambda: window.game is not None and window.game.in_progress)
        return table

    return sit
