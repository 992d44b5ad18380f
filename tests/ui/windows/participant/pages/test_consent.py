"""The text that participants agree to, before anything else."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.support.windows.preferences import preferred
from thbridge.files.language_texts import shipped_texts
from ui.model.lobby import Agreed, Declined, FromWindow, Offer, Thanks, WindowClosed
from ui.windows.participant.pages.pages import ConsentPage, ThanksPage
from ui.windows.participant.pages.start import StartPage
from ui.windows.participant_program import ParticipantMainWindow

ASKED = Offer(shipped_texts(), 1, 4, 2, consent="We record you.")
Seen = tuple[ParticipantMainWindow, list[FromWindow]]


@pytest.fixture
def seen(qtbot: QtBot, qapp: QApplication, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Seen]:
    monkeypatch.setattr(QApplication, "quit", lambda: None)
    sent: list[FromWindow] = []
    window = ParticipantMainWindow(preferred(qapp, tmp_path), sent.append)
    qtbot.addWidget(window)
    window.receive(ASKED)
    window.show()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    yield window, sent
    window.leave()


def page(window: ParticipantMainWindow, kind: type) -> bool:
    return bool(window.findChildren(kind)) and window.findChildren(kind)[0].isVisible()


def test_the_text_comes_before_the_start_page_and_yes_leads_there(seen: Seen, qtbot: QtBot) -> None:
    window, sent = seen
    assert page(window, ConsentPage) and not page(window, StartPage)
    qtbot.keyClick(window, Qt.Key.Key_A)
    qtbot.keyClick(window, Qt.Key.Key_A)
    assert sent == [Agreed()], "once"
    window.receive(Offer(shipped_texts(), 1, 4, 2))
    assert page(window, StartPage)


@pytest.mark.parametrize("by", ["mouse", "keyboard"])
def test_no_is_thanked_and_ends(seen: Seen, qtbot: QtBot, by: str) -> None:
    window, sent = seen
    if by == "mouse":
        qtbot.mouseClick(window.findChildren(ConsentPage)[0].decline, Qt.MouseButton.LeftButton)
    else:
        qtbot.keyClick(window, Qt.Key.Key_N)
    assert sent == [Declined()]
    assert page(window, ThanksPage)
    qtbot.keyClick(window, Qt.Key.Key_Return)
    assert sent == [Declined(), WindowClosed()]
    assert not window.isVisible()


def test_a_window_opened_again_after_a_no_thanks_and_asks_nothing(
    qtbot: QtBot, qapp: QApplication, tmp_path: Path
) -> None:
    window = ParticipantMainWindow(preferred(qapp, tmp_path), lambda _message: None)
    qtbot.addWidget(window, before_close_func=lambda it: it.leave())
    window.receive(Thanks(shipped_texts()))
    window.show()
    assert page(window, ThanksPage) and not window.findChildren(ConsentPage)


def test_enter_agrees_to_nothing(seen: Seen, qtbot: QtBot) -> None:
    window, sent = seen
    qtbot.keyClick(window, Qt.Key.Key_Return)
    assert sent == []
