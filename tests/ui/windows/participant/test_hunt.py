"""Whole hunts in the window, on the real view model and the real game: by mouse alone, and by keyboard alone."""

from collections.abc import Callable, Iterator

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.support.hunts.screen_player import ScreenPlayer
from tests.support.windows.participant_windows import buttons
from tests.ui.windows.participant.window_player import LEFT, WindowPlayer
from thbridge.hunt.events import PropertyMeasured, PropertyTold
from ui.model.playing.screen import (
    Action,
    AnswerDialogueAct,
    DialoguePopup,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    NextRobot,
    Phase,
    PlayAgainAct,
    RequestSuggestionAct,
    ShowNext,
    TakePictureAct,
    TreasurePopup,
)
from ui.model.shared.theme import LIGHT
from ui.windows import look
from ui.windows.participant import ParticipantWindow

TURNS = 300


@pytest.fixture
def player(qtbot: QtBot, qapp: QApplication) -> Iterator[Callable[..., WindowPlayer]]:
    def sit(
        robots: int, set_name: str = "original-2016", size: tuple[int, int] = (1200, 800), text: float = 1.0
    ) -> WindowPlayer:
        look.apply_palette(qapp, LIGHT)
        look.apply_text_size(qapp, text)
        seat = ScreenPlayer(robots=robots, set_name=set_name)
        window = ParticipantWindow(seat.model, lambda: seat.now, LIGHT)
        qtbot.addWidget(window)
        window.resize(*size)
        window.show()
        window.activateWindow()
        qtbot.waitUntil(window.isActiveWindow)
        return WindowPlayer(seat, window, qtbot)

    yield sit
    look.apply_text_size(qapp, 1.0)


def to_find_out(pop: TreasurePopup) -> Action | None:
    """What is left to sense or to tell of a treasure."""
    acts = (act for fact in pop.facts or () if not fact.value for act in fact.acts)
    return next((act for act in acts if act.enabled), None)


def by_mouse(player: WindowPlayer, right: str) -> None:
    screen, window = player.seat.screen, player.window
    pop = screen.popup
    if isinstance(pop, DialoguePopup) and pop.choices:
        player.click(AnswerDialogueAct(0))
    elif isinstance(pop, TreasurePopup) and pop.verdict is not None:
        player.click(ShowNext())
    elif isinstance(pop, TreasurePopup) and pop.take_picture is not None and pop.take_picture.enabled:
        player.click(TakePictureAct())
    elif isinstance(pop, TreasurePopup) and (more := to_find_out(pop)) is not None:
        player.click(more.act)
    elif isinstance(pop, TreasurePopup) and pop.picked is None and pop.names:
        names = window.treasure.names
        item = names.findItems(right, Qt.MatchFlag.MatchExactly)[0]
        player.qtbot.mouseClick(names.viewport(), LEFT, pos=names.visualItemRect(item).center())
        player.wait()
    elif isinstance(pop, TreasurePopup) and (pop.name_it.enabled or pop.leave.enabled):
        player.click(IdentifyTreasureAct() if pop.name_it.enabled else LeaveTreasureAct())
    elif pop is None and screen.ask_advice.enabled:
        player.click(RequestSuggestionAct())
    elif pop is None and len(screen.cards) > 1:
        player.click(next(card.select.act for card in screen.cards if not card.selected))
    else:
        player.wait()


def by_keyboard(player: WindowPlayer, right: str) -> None:
    screen = player.seat.screen
    pop = screen.popup
    if isinstance(pop, DialoguePopup) and pop.choices:
        player.key("Return")
    elif isinstance(pop, TreasurePopup) and pop.verdict is not None:
        player.key("Esc")
    elif isinstance(pop, TreasurePopup) and pop.take_picture is not None and pop.take_picture.enabled:
        player.key("Ctrl+P")
    elif isinstance(pop, TreasurePopup) and (more := to_find_out(pop)) is not None:
        player.key(more.key)
    elif isinstance(pop, TreasurePopup) and pop.names and pop.picked != right and pop.verdict is None:
        player.key("Down")
    elif isinstance(pop, TreasurePopup) and (pop.name_it.enabled or pop.leave.enabled):
        player.key("Return" if pop.name_it.enabled else "Ctrl+L")
    elif pop is None and screen.ask_advice.enabled:
        player.key("D")
    elif pop is None and len(screen.cards) > 1:
        player.key("Tab")
    else:
        player.wait()


@pytest.mark.parametrize(
    ("play", "robots", "set_name", "size", "text"),
    [
        (by_mouse, 2, "original-2016", (1280, 720), 1.25),
        pytest.param(by_keyboard, 6, "original-2016", (1920, 1080), 1.0, marks=pytest.mark.slow),
        pytest.param(by_mouse, 3, "four-properties", (1366, 768), 1.0, marks=pytest.mark.slow),
        (by_keyboard, 2, "four-properties", (800, 600), 1.0),
    ],
)
def test_a_whole_hunt(
    player: Callable[..., WindowPlayer],
    play: Callable[[WindowPlayer, str], None],
    robots: int,
    set_name: str,
    size: tuple[int, int],
    text: float,
) -> None:
    sitting = player(robots, set_name, size, text)
    seat = sitting.seat
    for _ in range(TURNS):
        if seat.screen.phase is Phase.OVER:
            break
        pop = seat.screen.popup
        right = seat.hunt.session.game.treasures[pop.room - 1].name if isinstance(pop, TreasurePopup) else ""
        play(sitting, right)
    assert seat.screen.phase is Phase.OVER
    assert seat.screen.score > 0
    found_out = [type(event) for event in seat.hunt.log.events if isinstance(event, PropertyMeasured | PropertyTold)]
    assert set(found_out) == ({PropertyMeasured, PropertyTold} if set_name == "four-properties" else set())
    assert sitting.window.ending.isVisible()
    assert len(sitting.views) == 1, "the map has stayed as it is"
    assert sitting.window.top.score.accessibleName() == f"Score {seat.screen.score}"
    sitting.wait()  # until the end can have been read
    if play is by_mouse:
        sitting.click(PlayAgainAct())
    else:
        sitting.key("A")
    sitting.wait(30)
    assert seat.screen.phase is Phase.PLAYING
    assert not sitting.window.ending.isVisible()


def test_every_enabled_action_of_a_game_has_a_button_in_sight(player: Callable[..., WindowPlayer]) -> None:
    sitting = player(2)
    sitting.key("D")
    shown = {button.act for button in buttons(sitting.window) if button.face is not None and button.face.enabled}
    offered = {action.act for action in sitting.seat.offers() if action.enabled}
    assert offered <= shown
    assert NextRobot(1) not in shown, "which only has a key"
