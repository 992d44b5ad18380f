"""While a game is made ready or not reached, the window says for how long, and can be told to go back."""

from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.support.windows.preferences import preferred
from thbridge.files.language_texts import shipped_texts
from ui.model.lobby import Back, FromWindow, Join, Offer, Preparing
from ui.windows.link import ParticipantLink
from ui.windows.participant.pages.pages import ConnectingPage
from ui.windows.participant.pages.start import StartPage
from ui.windows.participant_program import ParticipantMainWindow

Table = tuple[ParticipantMainWindow, list[FromWindow]]
GERMAN = shipped_texts("de")


@pytest.fixture
def table(qtbot: QtBot, qapp: QApplication, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Table:
    monkeypatch.setattr(QApplication, "quit", lambda: None)
    sent: list[FromWindow] = []
    window = ParticipantMainWindow(preferred(qapp, tmp_path), sent.append, texts=GERMAN)
    qtbot.addWidget(window, before_close_func=lambda it: it.leave())
    window.show()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    return window, sent


def waiting(window: ParticipantMainWindow) -> ConnectingPage:
    return next(page for page in window.findChildren(ConnectingPage) if page.isVisible())


def test_a_game_that_is_made_ready_can_be_cancelled(table: Table, qtbot: QtBot) -> None:
    window, sent = table
    window.receive(Preparing("Die Roboter werden vorbereitet."))
    page = waiting(window)
    assert page.bar.isVisible() and page.waited.text() == "0 Sekunden"
    qtbot.waitUntil(lambda: page.waited.text() == "1 Sekunde")
    for key in (Qt.Key.Key_Return, Qt.Key.Key_Space):
        qtbot.keyClick(QApplication.focusWidget() or window, key)
    assert sent == [], "a second press of the page before cancels nothing"
    qtbot.keyClick(page, Qt.Key.Key_Escape)
    assert sent == [Back()]
    window.receive(Join("127.0.0.1", 1, "token", practice=False))
    assert waiting(window) is page, "a game that was on its way is not joined any more"
    window.receive(Offer(GERMAN, 1, 2, 2))
    assert window.findChild(StartPage) is not None
    window.receive(Join("127.0.0.1", 1, "token", practice=False))
    assert window.game is not None


@pytest.mark.parametrize("hosted", [True, False])
def test_a_game_that_is_not_reached_can_be_left(
    qtbot: QtBot, qapp: QApplication, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, hosted: bool
) -> None:
    monkeypatch.setattr(QApplication, "quit", lambda: None)
    sent: list[FromWindow] = []
    window = ParticipantMainWindow(preferred(qapp, tmp_path), sent.append if hosted else None, texts=GERMAN)
    qtbot.addWidget(window, before_close_func=lambda it: it.leave())
    window.join(ParticipantLink("127.0.0.1", 1, "token"))
    window.show()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    qtbot.keyClick(window.game.window_of_game, Qt.Key.Key_Escape)
    assert sent == ([Back()] if hosted else [])
    assert window.isVisible() == hosted
