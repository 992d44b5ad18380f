"""The participant's window speaks the language of the game, wherever it learns of it."""

from pathlib import Path

import pytest
from PySide6.QtWidgets import QApplication, QLabel, QWidget
from pytestqt.qtbot import QtBot

from tests.support.hunts.participant_views import view
from tests.support.programs.processes import Program, until
from tests.support.windows.preferences import preferred
from tests.ui.windows.participant.joined_window import ArrivedLink
from thbridge.files import language_texts
from thbridge.files.language_texts import shipped_texts
from thbridge.roles.shared.notices import GameTexts
from ui.model.lobby import LOBBY, FromHost, Offer, Preparing, Thanks
from ui.sources.game import ReceivedEvent
from ui.windows.link import ParticipantLink
from ui.windows.participant_program import GamePage, ParticipantMainWindow


def words(widget: QWidget) -> list[str]:
    """All that is read in a widget."""
    return [label.text() for label in widget.findChildren(QLabel) if label.isVisible()]


def game_of(window: ParticipantMainWindow) -> GamePage:
    assert window.game is not None
    return window.game


def test_a_window_at_a_server_follows_its_language(qtbot: QtBot, qapp: QApplication, tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text("map: practice\ntemplates: practice\nrobots: 1\nserver:\n  port: 0\n")
    server = Program(tmp_path, "play", "study.yaml", "--outside", "TabUI", "--language", "de", "--no-report")
    window = ParticipantMainWindow(preferred(qapp, tmp_path), None, texts=shipped_texts())
    qtbot.addWidget(window, before_close_func=lambda it: it.leave())
    try:
        until("the server to listen", lambda: "can join at" in server.text, [server])
        host, _, port = server.text.split("can join at ")[1].split(".\n")[0].rpartition(":")
        assert window.windowTitle() == "Treasure hunt"
        window.join(ParticipantLink(host, int(port), "token"))
        with qtbot.waitActive(window):
            window.show()
            window.activateWindow()
        qtbot.waitUntil(lambda: game_of(window).in_progress)
        shown = game_of(window).window_of_game
        assert window.windowTitle() == shown.windowTitle() == "Schatzsuche"
        assert shown.column.dont_know.accessibleName() == "Weiß nicht"
        assert shown.history.accessibleName() == "Verlauf"
        assert QApplication.focusWidget() is shown, "keys go to the window that is seen"
    finally:
        window.leave()
        server.close()


class ToldLink(ArrivedLink):
    """A link to a game in German, which can be told more."""

    def __init__(self) -> None:
        super().__init__()
        self.tell("de")
        self._arrived.append(ReceivedEvent(0.0, view()))

    def tell(self, language: str) -> None:
        self._arrived.append(ReceivedEvent(0.0, GameTexts.of(shipped_texts(language))))


def test_only_another_language_opens_the_window_of_a_game_again(
    qtbot: QtBot, qapp: QApplication, tmp_path: Path
) -> None:
    window = ParticipantMainWindow(preferred(qapp, tmp_path), None, lambda: 1.0, shipped_texts())
    qtbot.addWidget(window, before_close_func=lambda it: it.leave())
    link = ToldLink()
    window.join(link)
    window.show()
    game = game_of(window)
    game.pump()
    german = game.window_of_game
    assert german.windowTitle() == "Schatzsuche"
    link.tell("de")
    game.pump()
    assert game.window_of_game is german, "as after each fault of the network"
    link.tell("en")
    game.pump()
    assert game.window_of_game is not german and window.windowTitle() == "Treasure hunt"
    assert game.in_progress


def test_a_hosted_window_speaks_the_language_of_its_host_from_the_first_page_on_and_reads_none(
    qtbot: QtBot, qapp: QApplication, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    german = shipped_texts("de")
    offer = Offer(german, 1, 4, 2, consent="Wir zeichnen Sie auf.")
    messages: list[tuple[FromHost, str]] = [
        (offer, "Bevor Sie teilnehmen"),
        (Offer(german, 1, 4, 2), "Wie viele Roboter?"),
        (Preparing(german.text("pages.preparing", count=2)), "Die 2 Roboter werden vorbereitet."),
        (Thanks(german), "Vielen Dank"),
    ]

    def read(*_: object) -> None:
        raise AssertionError("the window reads a language")

    monkeypatch.setattr(language_texts, "read_texts", read)
    shipped_texts.cache_clear()
    window = ParticipantMainWindow(preferred(qapp, tmp_path), lambda _message: None)
    qtbot.addWidget(window, before_close_func=lambda it: it.leave())
    window.show()
    for message, said in messages[:3]:
        window.receive(LOBBY.decode_from_host(LOBBY.encode(message)))
        assert said in words(window)
        assert window.windowTitle() == "Schatzsuche"
    window.join(ArrivedLink(), practice=True)
    game_of(window).pump()
    assert "Übung" in words(window)
    window.receive(LOBBY.decode_from_host(LOBBY.encode(messages[3][0])))
    assert messages[3][1] in words(window)
