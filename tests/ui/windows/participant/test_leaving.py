"""Closing the participant's window while a game goes on is asked for in the window itself."""

import gc
from collections.abc import Callable

import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtWidgets import QApplication, QDialog, QLabel
from pytestqt.qtbot import QtBot

from tests.support.hunts.participant_views import view
from tests.support.windows import sample_screens
from tests.support.windows.participant_windows import press
from tests.ui.windows.participant.joined_window import ArrivedLink, JoinedWindow
from ui.model.lobby import Back, WindowClosed
from ui.model.shared.theme import LIGHT
from ui.sources.game import ReceivedEvent
from ui.windows.link import ParticipantLink
from ui.windows.participant import ParticipantWindow
from ui.windows.participant.widgets.buttons import ActionButton


def test_a_link_with_a_token_that_no_server_takes_is_refused_before_it_starts() -> None:
    with pytest.raises(ValueError, match="token"):
        ParticipantLink("127.0.0.1", 1, "")


@pytest.mark.parametrize("hosted", [True, False])
def test_closing_in_the_middle_of_a_game_asks_in_the_window(
    qtbot: QtBot, at_table: Callable[[bool], JoinedWindow], hosted: bool
) -> None:
    table = at_table(hosted)
    window = table.window
    assert window is not None and window.game is not None
    game = window.game.window_of_game
    press(qtbot, game, "F1")
    table.now += 1.0
    window.close()
    assert window.isVisible() and game.question.isVisible(), "in the place of the sheet of rules"
    assert window.findChildren(QDialog) == []
    words = [label.text() for label in game.question.findChildren(QLabel) if label.isVisible()]
    assert words[0] == "Leave the game?"
    assert ("It ends if you leave it." in words[1]) == hosted
    table.now += 1.0
    press(qtbot, game, "N")
    assert window.isVisible() and not game.question.isVisible()
    window.close()
    table.now += 1.0
    press(qtbot, game, "Y")
    qtbot.waitUntil(lambda: not window.isVisible())
    assert table.told == ([WindowClosed()] if hosted else [])


def test_the_start_page_is_offered_at_the_end_alone_and_the_map_stays(
    qtbot: QtBot, at_table: Callable[[bool], JoinedWindow]
) -> None:
    table = at_table(True)
    window = table.window
    assert window is not None and window.game is not None
    game, link = window.game.window_of_game, window.game._link
    assert isinstance(link, ArrivedLink)
    qtbot.waitUntil(lambda: game.map.mapTo(window, QPoint()) != QPoint())
    before = game.map.rect().translated(game.map.mapTo(window, QPoint()))
    qtbot.keyClick(window, Qt.Key.Key_F10)
    assert table.told == []
    link._arrived.append(ReceivedEvent(1.0, view(over="given-up")))
    table.now += 1.0
    qtbot.waitUntil(game.ending.isVisible)
    assert game.map.rect().translated(game.map.mapTo(window, QPoint())) == before
    button = next(one for one in game.ending.findChildren(ActionButton) if one.face and one.face.key == "F10")
    qtbot.waitUntil(lambda: button.visibleRegion().boundingRect() == button.rect())
    qtbot.keyClick(window, Qt.Key.Key_F10)
    assert table.told == [Back()]


def test_a_window_that_has_gone_leaves_nothing_behind(qapp: QApplication) -> None:
    window = ParticipantWindow(
        sample_screens.SampleModel(sample_screens.playing(), sample_screens.floor_plan()), lambda: 0.0, LIGHT
    )
    window.show()
    qapp.processEvents()
    window.close()
    window.deleteLater()
    del window
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    gc.collect()
    assert qapp.allWidgets() == []
