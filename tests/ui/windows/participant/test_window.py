"""The participant's window draws a screen and gives back acts, by mouse and by keyboard."""

import os
import subprocess
import sys
from dataclasses import replace
from itertools import combinations, product

import pytest
from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, QRectF, Qt
from PySide6.QtGui import QAccessible, QCursor, QFontMetricsF
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QWidget
from pytestqt.qtbot import QtBot

from tests.support.slow import slow
from tests.support.windows import sample_screens
from tests.support.windows.layout_faults import settle
from tests.support.windows.participant_windows import (
    STATES,
    Open,
    Opened,
    buttons,
    covered,
    press,
    room_on_map,
    that_asks,
)
from thbridge.files.language_texts import shipped_texts
from ui.model.playing.screen import (
    Act,
    AnswerDialogueAct,
    Banner,
    Cancel,
    ChooseRobot,
    Confirm,
    ConsiderRoom,
    DialoguePopup,
    EndGameAct,
    EnlargePicture,
    FitMap,
    FollowRobot,
    GiveConsentAct,
    HistoryLine,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    NextRobot,
    Phase,
    PickName,
    PlayAgainAct,
    RequestHandbackAct,
    RequestSuggestionAct,
    SelectRoomAct,
    ShowHelp,
    ShowNext,
    ShowWaiting,
    StopRobotAct,
    SwitchSound,
    TakePictureAct,
    TakeUpTreasureAct,
    TreasurePopup,
    TypeDigit,
    TypeLetter,
)
from ui.model.playing.spoken import energy_words, tile_words
from ui.model.shared.theme import LIGHT
from ui.windows.look import GAP, font
from ui.windows.map import MapView
from ui.windows.participant.cards import EDGE, PAD
from ui.windows.participant.pages.pages import KeyCap
from ui.windows.participant.popups.finding import PICTURE, NamingResult, TreasureFacts, TreasurePicture
from ui.windows.participant.score import ScoreLabel
from ui.windows.participant.top import BannerLine
from ui.windows.participant.widgets.buttons import ActionButton, ParticipantButton
from ui.windows.participant.widgets.painting import chip_size
from ui.windows.participant.widgets.panels import RobotChip, SpeechBubble, TitledPanel, Transcript

LEFT = Qt.MouseButton.LeftButton


# Mouse ----------------------------------------------------------------------------------------------------------------


CLICKS: list[tuple[str, Act]] = [
    ("playing", ChooseRobot(1)),
    ("playing", SelectRoomAct(5)),
    ("playing", RequestSuggestionAct()),
    ("playing", StopRobotAct(0)),
    ("commanded", RequestHandbackAct(1)),
    ("left", TakeUpTreasureAct(2)),
    ("playing", EndGameAct()),
    ("playing", FollowRobot()),
    ("playing", FitMap()),
    ("playing", ShowHelp()),
    ("dialogue", AnswerDialogueAct(0)),
    ("dialogue", AnswerDialogueAct(1)),
    ("dialogue", ShowNext()),
    ("dialogue", ShowWaiting(2)),
    ("treasure", TakePictureAct()),
    ("treasure", LeaveTreasureAct()),
    ("picture", IdentifyTreasureAct()),
    ("question", Confirm()),
    ("question", Cancel()),
    ("consent", GiveConsentAct()),
    ("over", PlayAgainAct()),
]


def test_a_click_asks_for_what_the_button_says(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"])
    for state, act in CLICKS:
        shown.show(STATES[state])
        shown.now += 1.0
        shown.done.clear()
        qtbot.mouseClick(that_asks(shown.window, act), LEFT)
        assert [done for done in shown.done if not isinstance(done, ConsiderRoom)] == [act], state


def test_a_name_is_picked_by_a_click(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["treasure"])
    names = shown.window.treasure.names
    assert names.currentItem() is None and not names.selectedItems(), "nothing is picked at first"
    qtbot.mouseClick(names.viewport(), LEFT, pos=names.visualItemRect(names.item(2)).center())
    assert shown.done == [PickName("Pink can")]


def test_only_the_name_picked_is_marked_in_the_list(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["picture"])
    names = shown.window.treasure.names
    first, last = (names.visualItemRect(names.item(row)).center() for row in (0, 3))
    qtbot.mousePress(names.viewport(), LEFT, pos=first)
    qtbot.mouseMove(names.viewport(), last)
    qtbot.mouseRelease(names.viewport(), LEFT, pos=last)
    assert shown.done == []
    assert [item.text() for item in names.selectedItems()] == ["Pink can"], "the one that the button names"


def test_a_name_of_a_file_is_shown_in_words_and_asked_for_as_it_is(qtbot: QtBot, opened: Open) -> None:
    treasure = STATES["treasure"].popup
    assert isinstance(treasure, TreasurePopup)
    named = replace(treasure, names=("basketball", "beer_bottle"), called=("basketball", "beer bottle"))
    shown = opened(replace(STATES["treasure"], popup=named))
    names = shown.window.treasure.names
    assert names.item(1).text() == "beer bottle"
    qtbot.mouseClick(names.viewport(), LEFT, pos=names.visualItemRect(names.item(1)).center())
    assert shown.done == [PickName("beer_bottle")]


def test_what_cannot_be_done_says_why_and_asks_for_nothing(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"])
    button = that_asks(shown.window, SelectRoomAct(6))
    qtbot.mouseClick(button, LEFT)
    assert not [done for done in shown.done if isinstance(done, SelectRoomAct)]
    assert "not possible" in button.accessibleName()
    assert "not enough energy" in button.accessibleDescription()


def test_the_map_takes_clicks(opened: Open) -> None:
    shown = opened(STATES["playing"])
    shown.window.map.room_clicked.emit(3)
    shown.window.map.robot_clicked.emit(2)
    assert shown.done == [SelectRoomAct(3), ChooseRobot(2)]


def test_rooms_are_considered_while_the_pointer_or_else_the_focus_is_on_them(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"])
    point(qtbot, that_asks(shown.window, SelectRoomAct(5)))
    that_asks(shown.window, SelectRoomAct(7)).setFocus()
    assert shown.done == [ConsiderRoom(5)], "the pointer comes before the focus"
    place = room_on_map(shown, 3)
    point(qtbot, shown.window.map, place)
    assert shown.done[1:] == [ConsiderRoom(7), ConsiderRoom(3)]
    point(qtbot, shown.window.column.hint)
    assert shown.done[3:] == [ConsiderRoom(7)]
    shown.window.setFocus()
    assert shown.done[4:] == [ConsiderRoom(None)]


def test_a_pop_up_that_comes_below_the_resting_pointer_is_not_pointed_at(qtbot: QtBot, opened: Open) -> None:
    shown = opened(replace(STATES["treasure"], popup=replace(sample_screens.treasure(), room=4)))
    leave = shown.window.treasure.leave
    place = leave.mapTo(shown.window, leave.rect().center())
    shown.show(STATES["playing"])
    point(qtbot, shown.window, place)
    for room in (4, 5):
        shown.show(replace(STATES["treasure"], popup=replace(sample_screens.treasure(), room=room)))
        qtbot.waitUntil(leave.underMouse)
        assert not leave.pointed_at(), "it has come there by itself"
        assert shown.window.map.hovered is None
        point(qtbot, shown.window, place + QPoint(room, 0))
        assert leave.pointed_at(), "the pointer was moved on it"
        shown.show(replace(shown.model.shown, score=room))
        assert leave.pointed_at(), "what changes elsewhere changes nothing here"


def test_a_room_under_the_resting_pointer_is_not_looked_at_once_a_pop_up_comes(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"])
    tile = that_asks(shown.window, SelectRoomAct(5))
    point(qtbot, tile)
    shown.show(STATES["dialogue"])
    assert shown.done == [ConsiderRoom(5), ConsiderRoom(None)]
    assert not tile.pointed_at()


def test_the_map_below_a_pop_up_that_has_gone_is_not_pointed_at(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["dialogue"])
    under = covered(shown, shown.window.dialogue)
    shown.show(STATES["playing"])
    places = {room: room_on_map(shown, room) for room in range(1, 9)}
    free = {room for room, place in places.items() if shown.window.map.robot_at(QPointF(place)) is None}
    room = next(room for room in free if under.contains(places[room]))
    place = places[room]
    shown.show(STATES["dialogue"])
    point(qtbot, shown.window.map, place)
    shown.done.clear()
    shown.show(STATES["playing"])
    qtbot.waitUntil(shown.window.map.viewport().underMouse)
    assert shown.done == [] and shown.window.map.hovered is None
    point(qtbot, shown.window.map, place + QPoint(3, 0))
    assert shown.done == [ConsiderRoom(room)]


def test_a_press_begun_on_one_find_does_not_leave_the_next(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["treasure"])
    qtbot.mousePress(shown.window.treasure.leave, LEFT)
    shown.show(replace(STATES["treasure"], popup=replace(sample_screens.treasure(), room=5)))
    shown.now += 1.0
    qtbot.mouseRelease(shown.window.treasure.leave, LEFT)
    assert shown.done == []


def point(qtbot: QtBot, widget: QWidget, place: QPoint | None = None) -> None:
    """Move the pointer onto a widget."""
    target = widget.mapToGlobal(widget.rect().center() if place is None else place)
    QCursor.setPos(target)
    qtbot.waitUntil(lambda: QCursor.pos() == target)
    QApplication.processEvents()


# Keys -----------------------------------------------------------------------------------------------------------------


KEYS: list[tuple[str, str, Act]] = [
    ("playing", "5", TypeDigit(5)),
    ("playing", "D", RequestSuggestionAct()),
    ("playing", "X", StopRobotAct()),
    ("commanded", "B", RequestHandbackAct()),
    ("left", "Ctrl+Z", TakeUpTreasureAct()),
    ("playing", "E", EndGameAct()),
    ("playing", "F", FollowRobot()),
    ("playing", "A", FitMap()),
    ("playing", "M", SwitchSound()),
    ("playing", "Tab", NextRobot(1)),
    ("playing", "Shift+Tab", NextRobot(-1)),
    ("playing", "F1", ShowHelp()),
    ("help", "Esc", ShowHelp()),
    ("dialogue", "C", AnswerDialogueAct(0)),
    ("dialogue", "Return", AnswerDialogueAct(0)),
    ("dialogue", "S", AnswerDialogueAct(1)),
    ("dialogue", "Esc", ShowNext()),
    ("treasure", "Ctrl+P", TakePictureAct()),
    ("treasure", "Ctrl+L", LeaveTreasureAct()),
    ("treasure", "Ctrl+F", FollowRobot()),
    ("treasure", "F", TypeLetter("f")),
    ("treasure", "Down", PickName("Blue bottle")),
    ("treasure", "End", PickName("Yellow can")),
    ("picture", "Return", IdentifyTreasureAct()),
    ("question", "Y", Confirm()),
    ("question", "N", Cancel()),
    ("consent", "A", GiveConsentAct()),
    ("over", "A", PlayAgainAct()),
]


def test_a_key_does_what_its_button_does(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"])
    for state, key, act in KEYS:
        shown.show(STATES[state])
        shown.now += 1.0
        shown.done.clear()
        press(qtbot, shown.window, key)
        assert shown.done == [act], (state, key)


def test_a_digit_of_the_number_pad_counts(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"])
    qtbot.keyClick(shown.window, Qt.Key.Key_5, Qt.KeyboardModifier.KeypadModifier)
    assert shown.done == [TypeDigit(5)]


def test_letters_go_to_the_list_wherever_the_focus_is(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["treasure"])
    treasure = shown.window.treasure
    shown.window.waiting.history.click()
    for focused in (shown.window, treasure.names, treasure.leave, treasure.name_it, shown.window.history):
        focused.setFocus()
        for key in "FPN":
            press(qtbot, shown.window, key)
        qtbot.keyClick(focused, Qt.Key.Key_Odiaeresis)
        assert shown.done == [TypeLetter("f"), TypeLetter("p"), TypeLetter("n"), TypeLetter("\u00f6")], focused
        assert treasure.names.currentItem() is None, "neither letters nor the focus pick anything by themselves"
        shown.done.clear()


def test_enter_names_what_was_typed_wherever_the_focus_was(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["treasure"])
    shown.window.top.tools.buttons[0].setFocus()
    press(qtbot, shown.window, "P")
    shown.show(replace(STATES["treasure"], popup=sample_screens.treasure(picked="Pink can")))
    shown.now += 1.0
    press(qtbot, shown.window, "Return")
    assert shown.done == [TypeLetter("p"), IdentifyTreasureAct()]


def test_a_blank_within_a_name_presses_no_button(qtbot: QtBot, opened: Open) -> None:
    pop = sample_screens.treasure()
    shown = opened(replace(STATES["treasure"], popup=replace(pop, typed="pink")))
    shown.window.treasure.leave.setFocus()
    press(qtbot, shown.window, "Space")
    assert shown.done == [TypeLetter(" ")]
    shown.show(replace(STATES["treasure"], popup=pop))
    shown.window.treasure.leave.setFocus()
    press(qtbot, shown.window, "Space")
    assert shown.done == [TypeLetter(" "), LeaveTreasureAct()]


def test_nothing_is_picked_by_keys_pressed_before_the_question_came(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["dialogue"])
    shown.window.setFocus()
    hold(shown.window, Qt.Key.Key_Down)
    shown.model.shown = STATES["treasure"]
    shown.window.refresh()
    press(qtbot, shown.window, "F")
    hold(shown.window, Qt.Key.Key_Down)
    names = shown.window.treasure.names
    qtbot.mouseClick(names.viewport(), LEFT, pos=names.visualItemRect(names.item(2)).center())
    assert shown.done == [], "nobody has seen the list yet"
    shown.now += 1.0
    for _ in range(3):
        hold(shown.window, Qt.Key.Key_Down, repeated=True)
    press(qtbot, shown.window, "F")
    assert shown.done == [PickName("Blue bottle")] * 3 + [TypeLetter("f")]
    shown.show(replace(STATES["treasure"], popup=replace(sample_screens.treasure(), room=5)))
    shown.done.clear()
    shown.now += 1.0
    hold(shown.window, Qt.Key.Key_Down, repeated=True)
    assert shown.done == [], "held since the question before"


def test_a_name_is_submitted_only_once_it_can_have_been_read(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["treasure"])
    named = replace(STATES["treasure"], popup=sample_screens.treasure(picked="Pink can"))
    shown.show(named)
    press(qtbot, shown.window, "Return")
    assert shown.done == []
    assert shown.window.treasure.name_it.accessibleName() == "Name it Pink can"
    shown.now += 0.31
    press(qtbot, shown.window, "Return")
    assert shown.done == [IdentifyTreasureAct()]


@pytest.mark.parametrize("focused", ["window", "name_it"])
def test_enter_that_names_and_is_held_answers_nothing(qtbot: QtBot, opened: Open, focused: str) -> None:
    shown = opened(STATES["picture"])
    (shown.window if focused == "window" else shown.window.treasure.name_it).setFocus()
    hold(shown.window, Qt.Key.Key_Return)
    assert shown.done == [IdentifyTreasureAct()]
    shown.show(STATES["dialogue"])
    shown.now += 1.0
    hold(shown.window, Qt.Key.Key_Return, repeated=True)
    assert shown.done == [IdentifyTreasureAct()]


def hold(window: QWidget, key: Qt.Key, *, repeated: bool = False) -> None:
    """Press a key without letting it go, or have it repeat."""
    target = QApplication.focusWidget() or window
    QTest.simulateEvent(target, True, key, Qt.KeyboardModifier.NoModifier, "", repeated)


def test_a_focused_button_is_pressed_by_enter_and_space_once(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["dialogue"])
    shown.window.dialogue.choices.buttons[1].setFocus()
    press(qtbot, shown.window, "Return")
    press(qtbot, shown.window, "Space")
    assert shown.done == [AnswerDialogueAct(1), AnswerDialogueAct(1)]


def test_everything_can_be_reached_by_keyboard(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["treasure"])
    reached: set[QWidget] = set()
    for _ in shown.window.regions:
        press(qtbot, shown.window, "F6")
        ahead = [QApplication.focusWidget()]
        while ahead:
            widget = ahead.pop()
            if widget is None or widget in reached:
                continue
            reached.add(widget)
            for arrow in (Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Up, Qt.Key.Key_Down):
                widget.setFocus()
                qtbot.keyClick(widget, arrow)
                ahead.append(QApplication.focusWidget())
    names = shown.window.treasure.names
    missing = [button.accessibleName() for button in buttons(shown.window) if button not in reached]
    assert names in reached
    assert missing == [], [w.accessibleName() for w in reached]


# What has just popped up ----------------------------------------------------------------------------------------------


def test_a_press_meant_for_what_was_there_before_is_no_answer(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["dialogue"])
    pop = sample_screens.dialogue()
    following = replace(pop, sentences=(*pop.sentences, ("you", "Continue"), ("robot", "Sure?")))
    other = (replace(pop.choices[0], act=AnswerDialogueAct(7)), pop.choices[1])
    button = shown.window.dialogue.choices.buttons[0]
    qtbot.mousePress(button, LEFT)
    shown.show(replace(STATES["dialogue"], popup=replace(following, choices=other)))
    qtbot.mouseRelease(button, LEFT)
    assert shown.done == [], "pressed on the old answer, let go on the new one"
    qtbot.mouseClick(button, LEFT)
    press(qtbot, shown.window, "C")
    assert shown.done == [], "nobody has read it yet"
    shown.now += 0.31
    qtbot.mouseClick(button, LEFT)
    assert shown.done == [AnswerDialogueAct(7)]


def test_the_next_turn_with_the_same_answers_wants_to_be_read_too(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["dialogue"])
    pop = sample_screens.dialogue()
    shown.show(
        replace(
            STATES["dialogue"], popup=replace(pop, sentences=(*pop.sentences, ("you", "Continue"), ("robot", "Sure?")))
        )
    )
    qtbot.mouseClick(shown.window.dialogue.choices.buttons[0], LEFT)
    assert shown.done == []


def test_a_pop_up_leaves_the_focus_where_it_is(opened: Open) -> None:
    shown = opened(STATES["playing"])
    tile = that_asks(shown.window, SelectRoomAct(7))
    tile.setFocus()
    shown.show(STATES["treasure"])
    assert QApplication.focusWidget() is tile
    names = shown.window.treasure.names
    names.setFocus()
    shown.show(replace(STATES["treasure"], waiting=sample_screens.waiting(3), confirmation=None))
    assert QApplication.focusWidget() is names


@pytest.mark.parametrize(
    "text", ["Roboter 1: Plüschwürfel benennen?", "Robot 1 is in room 3 and found something", "Wer?"]
)
def test_what_waits_fits_into_its_two_lines(opened: Open, text: str) -> None:
    shown = opened(
        replace(STATES["playing"], waiting=tuple(replace(each, text=text) for each in sample_screens.waiting(1)))
    )
    (chip,) = shown.window.waiting.chips
    metrics = QFontMetricsF(font("small"))
    beside = 2.75 * GAP + chip_size() + chip._key_room()
    space = QRectF(0.0, 0.0, chip.width() - beside, 1000.0)
    wrapped = metrics.boundingRect(space, int(Qt.TextFlag.TextWordWrap), text)
    assert wrapped.height() <= 2.0 * metrics.height() + 1.0 and wrapped.width() <= space.width()


def test_what_waits_last_is_only_a_number_where_there_is_no_room_for_its_words(opened: Open) -> None:
    shown = opened(replace(STATES["playing"], waiting=sample_screens.waiting(3)), 1024, 600)
    strip = shown.window.waiting
    assert [chip.short for chip in strip.chips] == [False, False, True]
    assert all(chip.visibleRegion().boundingRect() == chip.rect() for chip in strip.chips)
    assert strip.chips[2].accessibleName()
    shown.window.resize(1920, 1080)
    QApplication.processEvents()
    assert not any(chip.short for chip in strip.chips)


def test_the_focus_goes_to_what_takes_the_place_of_what_has_gone(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["treasure"])
    shown.window.treasure.names.setFocus()
    shown.show(STATES["dialogue"])
    assert QApplication.focusWidget() is shown.window.dialogue
    qtbot.keyClick(shown.window.dialogue, Qt.Key.Key_Return)
    assert shown.done == [], "nobody has read it yet"
    shown.now += 1.0
    qtbot.keyClick(shown.window.dialogue, Qt.Key.Key_Return)
    assert shown.done == [AnswerDialogueAct(0)], "and not Later, its first button"
    qtbot.keyClick(shown.window.dialogue, Qt.Key.Key_Down)
    assert QApplication.focusWidget() is shown.window.dialogue.choices.buttons[0]
    shown.show(STATES["treasure"])
    assert QApplication.focusWidget() is shown.window.treasure.names


def test_the_focus_goes_to_the_robots_where_nothing_takes_the_place(opened: Open) -> None:
    shown = opened(STATES["treasure"])
    shown.window.treasure.leave.setFocus()
    shown.show(STATES["playing"])
    cards = STATES["playing"].cards
    for robot in (1, 2):
        shown.show(
            replace(STATES["playing"], cards=tuple(replace(card, selected=card.robot == robot) for card in cards))
        )
        assert QApplication.focusWidget() is shown.window.column.cards.cards[robot].face


def test_what_was_said_last_is_shown_whole(qtbot: QtBot, opened: Open) -> None:
    pop = sample_screens.dialogue()
    shown = opened(replace(STATES["playing"], popup=replace(pop, sentences=(), choices=())))
    shown.show(replace(STATES["playing"], popup=replace(pop, sentences=pop.sentences[:2])))
    talk = shown.window.dialogue.transcript
    qtbot.waitUntil(lambda: talk.height() >= talk.heightForWidth(talk.width()) > 0)
    shown.show(replace(STATES["playing"], popup=pop))
    bar, newest = talk.verticalScrollBar(), talk.findChildren(SpeechBubble)[-1]
    qtbot.waitUntil(lambda: bar.value() <= newest.y() and newest.geometry().bottom() <= bar.value() + talk.height())


def test_the_newest_sentence_is_in_sight_where_there_is_as_much_more_room_as_it_takes(qtbot: QtBot) -> None:
    talk = Transcript(shipped_texts())
    qtbot.addWidget(talk)
    said = 6 * (("robot", "Shall I go?"),)
    talk.show_sentences(said, 0)
    talk.resize(300, 100)
    with qtbot.waitExposed(talk):
        talk.show()
    settle()
    bar = talk.verticalScrollBar()
    bar.blockSignals(True)  # a range that is the same in the end is not reported
    talk.show_sentences((*said, ("you", "Go.")), 0)
    settle()
    newest = talk.findChildren(SpeechBubble)[-1]
    assert bar.value() <= newest.y() and newest.geometry().bottom() <= bar.value() + talk.height()


@pytest.mark.parametrize("pop", [sample_screens.dialogue(), sample_screens.arguing()])
def test_what_was_said_has_all_the_room_that_is_left(opened: Open, pop: DialoguePopup) -> None:
    shown = opened(replace(STATES["playing"], popup=replace(pop, sentences=pop.sentences[:1])), 1200, 800)
    settle()
    talk = shown.window.dialogue
    above = talk.transcript.mapTo(talk, QPoint(0, 0)).y() - talk.aside.geometry().bottom()
    assert above < 8 * GAP


def test_answers_stay_where_they_are_while_the_talk_goes_on(opened: Open) -> None:
    pop = sample_screens.dialogue()
    shown = opened(replace(STATES["playing"], popup=replace(pop, sentences=pop.sentences[:2])))
    button = shown.window.dialogue.choices.buttons[0]
    before = button.mapTo(shown.window, QPoint(0, 0))
    shown.show(replace(STATES["playing"], popup=pop))
    for _ in range(5):
        QApplication.processEvents()
    assert button.mapTo(shown.window, QPoint(0, 0)) == before


def test_news_are_announced_once(opened: Open, monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []
    monkeypatch.setattr(QAccessible, "updateAccessibility", lambda event: told.append(event.message()))
    shown = opened(STATES["playing"])
    news = replace(STATES["playing"], announcement="Robot 1 is in room 4.", announcement_number=7)
    shown.show(news)
    shown.show(replace(news, score=130))
    assert told == ["Robot 1 is in room 4."]
    shown.show(replace(news, announcement_number=8))
    assert told == ["Robot 1 is in room 4."] * 2


def test_the_history_keeps_up_when_its_oldest_lines_go(qtbot: QtBot, opened: Open) -> None:
    told = tuple(HistoryLine("robot", 0, f"Sentence {number}.") for number in range(8))
    shown = opened(replace(STATES["playing"], history=told[:5]))
    qtbot.mouseClick(shown.window.waiting.history, LEFT)
    assert shown.window.history.isVisible()
    shown.show(replace(STATES["playing"], history=told[2:]))
    words = shown.window.history.toPlainText()
    assert words.splitlines() == [f"Robot 1: Sentence {number}." for number in range(8)]
    shown.show(replace(STATES["playing"], history=(HistoryLine("game", None, "Game 2 begins."),)))
    assert shown.window.history.toPlainText() == "Game 2 begins."


@pytest.mark.parametrize("size", [(1200, 800), (1920, 1080)])
def test_a_pop_up_leaves_its_robot_and_its_room_in_sight(opened: Open, size: tuple[int, int]) -> None:
    shown = opened(STATES["playing"], *size)
    window = shown.window
    for robot, room in product(range(3), range(1, 9)):
        for pop, panel in (
            (replace(sample_screens.dialogue(), robot=robot, room=room), window.dialogue),
            (replace(sample_screens.treasure(), robot=robot, room=room), window.treasure),
        ):
            shown.show(STATES["playing"])
            shown.show(replace(STATES["playing"], popup=pop))
            pose = next(mark.pose for mark in shown.model.robots(0.0) if mark.robot == robot)
            assert not covered(shown, panel).contains(window.map.pixel(pose.x, pose.y).toPoint()), (robot, room)
            if size == (1920, 1080):
                assert not covered(shown, panel).contains(room_on_map(shown, room)), (robot, room)


def test_a_pop_up_moves_to_another_corner_only_if_its_robot_would_be_hidden(opened: Open) -> None:
    shown = opened(replace(STATES["playing"], popup=sample_screens.dialogue()), 1200, 800)
    panel, robots = shown.window.dialogue, shown.model.robots(0.0)
    before = panel.geometry()
    pose = next(mark.pose for mark in robots if mark.robot == 0)
    for pixel, hidden in ((before.topLeft() - QPoint(60, 60), False), (before.center(), True)):
        x, y = shown.window.map.point(QPointF(pixel))
        moved = replace(pose, x=x, y=y)
        shown.model.robots = lambda _now, moved=moved: tuple(  # type: ignore[method-assign]
            replace(mark, pose=moved) if mark.robot == 0 else mark for mark in robots
        )
        shown.window.refresh()
        assert (panel.geometry() != before) == hidden
    assert not panel.geometry().contains(before.center())


@pytest.mark.parametrize("size", [(1024, 600), (1200, 800)])
def test_a_robot_that_is_followed_stays_in_sight_of_its_pop_up(opened: Open, size: tuple[int, int]) -> None:
    shown = opened(STATES["playing"], *size)
    window = shown.window
    for robot, pop in product(range(3), (sample_screens.dialogue(), sample_screens.treasure())):
        shown.show(STATES["playing"])
        shown.model.followed = robot
        shown.show(replace(STATES["playing"], popup=replace(pop, robot=robot)))
        for _ in range(60):
            window.refresh()
        panel = window.dialogue if window.dialogue.isVisible() else window.treasure
        place = window.map.robot_place(robot)
        assert place is not None
        assert window.map.rect().contains(place.toPoint())
        assert not covered(shown, panel).contains(place.toPoint()), robot


def test_a_drag_ends_following(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"])
    shown.model.followed = 0
    shown.show(STATES["playing"])
    view, middle = shown.window.map.viewport(), shown.window.map.rect().center()
    qtbot.mousePress(view, LEFT, pos=middle)
    qtbot.mouseMove(view, middle + QPoint(40, 20))
    qtbot.mouseRelease(view, LEFT, pos=middle + QPoint(40, 20))
    assert shown.done == [FollowRobot()]


def test_a_map_that_was_moved_stays_where_it_is_and_the_pop_up_in_another_corner(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"], 1200, 800)
    middle = shown.window.map.rect().center()
    qtbot.mousePress(shown.window.map.viewport(), LEFT, pos=middle)
    qtbot.mouseMove(shown.window.map.viewport(), middle + QPoint(40, 20))
    qtbot.mouseRelease(shown.window.map.viewport(), LEFT, pos=middle + QPoint(40, 20))
    moved = shown.window.map.box.viewRect()
    for room in (1, 2, 3, 6, 7, 8):
        shown.show(STATES["playing"])
        shown.show(replace(STATES["playing"], popup=replace(sample_screens.treasure(), room=room)))
        assert shown.window.map.box.viewRect() == moved
        assert not covered(shown, shown.window.treasure).contains(room_on_map(shown, room)), room


def test_a_click_meant_for_a_pop_up_that_has_just_come_or_gone_sends_nobody(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"], 1200, 800)
    shown.model.shown = STATES["treasure"]
    shown.window.refresh()
    place = room_on_map(shown, 6)
    qtbot.mouseClick(shown.window.map.viewport(), LEFT, pos=place)
    assert SelectRoomAct(6) not in shown.done
    shown.now += 1.0
    qtbot.mouseClick(shown.window.map.viewport(), LEFT, pos=place)
    assert SelectRoomAct(6) in shown.done


def test_a_pop_up_stays_where_it_is_while_all_is_about_one_robot(opened: Open) -> None:
    find = sample_screens.treasure()
    shown = opened(replace(STATES["playing"], popup=find))
    before = corner_of(shown, shown.window.treasure)
    shown.show(replace(STATES["playing"], popup=replace(sample_screens.dialogue(), robot=find.robot, room=find.room)))
    assert corner_of(shown, shown.window.dialogue) == before


def corner_of(shown: Opened, panel: QWidget) -> tuple[bool, bool]:
    """Whether a panel is at the right and at the bottom of the map."""
    place, area = panel.geometry(), shown.window.map_area.rect()
    return place.right() == area.right() - GAP, place.bottom() == area.bottom() - GAP


def test_the_banner_hides_nothing_of_the_end(opened: Open) -> None:
    over, ending = STATES["over"], STATES["over"].ending
    assert ending is not None
    long = replace(ending, lines=8 * ending.lines)
    shown = opened(replace(over, ending=long, banner=Banner("What is in room 2 is left there.", "note")), 800, 500)
    settle()
    area = shown.window.map_area
    assert not area.banner.geometry().intersects(shown.window.ending.geometry())


def test_pictures_have_one_size_and_a_press_enlarges_them(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["picture"])
    for state, panel in (("picture", shown.window.treasure), ("naming", shown.window.dialogue)):
        shown.show(STATES[state])
        assert panel.picture.size() == PICTURE and PICTURE.width() >= 200
        shown.done.clear()
        qtbot.mouseClick(panel.picture, LEFT)
        assert shown.done == [EnlargePicture()]
    shown.show(replace(STATES["picture"], enlarged=STATES["picture"].popup.picture))
    large = shown.window.large.picture
    assert large.width() > 2 * PICTURE.width()
    for key in ("Esc", "Return"):
        shown.done.clear()
        press(qtbot, shown.window, key)
        assert shown.done == [EnlargePicture()]


@pytest.mark.parametrize("size", [(1024, 768), (1280, 560)])
def test_a_click_on_a_name_moves_nothing(opened: Open, size: tuple[int, int]) -> None:
    shown = opened(STATES["treasure"], *size)
    panel, find = shown.window.treasure, sample_screens.treasure(picture=True)
    longest = replace(find.name_it, label="Name it Orange bottle", hint="Costs 1 energy. " + "It may win points. " * 4)
    places = []
    for picked in (None, *find.names):
        named = find.name_it if picked is None else replace(longest, label=f"Name it {picked}")
        shown.show(
            replace(STATES["treasure"], popup=replace(find, picked=picked, name_it=named, longest_name_it=longest))
        )
        for _ in range(5):
            QApplication.processEvents()
        row = panel.names.visualItemRect(panel.names.item(0))
        places.append((panel.geometry(), panel.names.viewport().mapTo(shown.window, row.topLeft()), panel.leave.pos()))
    assert len(set(map(str, places))) == 1


def test_picture_and_facts_stay_in_sight_while_a_name_is_talked_over(opened: Open) -> None:
    shown = opened(STATES["picture"])
    shown.show(STATES["naming"])
    talk = shown.window.dialogue
    assert talk.picture.isVisible() and talk.picture.accessibleName() == "Picture of what was found"
    assert talk.facts.isVisible() and talk.facts.accessibleName() == "Colour: Pink. Footprint: Square and Small."
    shown.show(STATES["dialogue"])
    assert not talk.picture.isVisible() and not talk.facts.isVisible()


def test_a_question_makes_the_answer_stand_out_that_changes_nothing(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["question"])
    no, yes = shown.window.question.no, shown.window.question.yes
    accent = LIGHT.accent
    assert [one.grab().toImage().pixelColor(6, one.height() // 2).name() == accent for one in (no, yes)] == [
        True,
        False,
    ]
    press(qtbot, shown.window, "F6")
    press(qtbot, shown.window, "Return")
    assert shown.done == [Cancel()], "it has the focus first"


# How it looks ---------------------------------------------------------------------------------------------------------


SHOWS = (
    MapView
    | ScoreLabel
    | TreasureFacts
    | TreasurePicture
    | NamingResult
    | SpeechBubble
    | RobotChip
    | KeyCap
    | BannerLine
    | TitledPanel
)
"""Widgets that show something without being a button or text that Qt reads out itself."""


def test_everything_has_a_name_for_assistive_technology(opened: Open) -> None:
    shown = opened(STATES["playing"])
    for state, screen in STATES.items():
        shown.show(screen)
        nameless = [
            f"{type(widget).__name__} {widget.geometry()}"
            for widget in shown.window.findChildren(QWidget)
            if widget.isVisible()
            and (widget.focusPolicy() & Qt.FocusPolicy.TabFocus or isinstance(widget, ParticipantButton | SHOWS))
            and not widget.accessibleName()
        ]
        assert nameless == [], state


@pytest.mark.parametrize(
    ("width", "height"),
    [(860, 540), *slow((1024, 768), (1920, 1080))],
)
def test_nothing_is_cut_off_or_lies_on_something_else(opened: Open, width: int, height: int) -> None:
    shown = opened(STATES["playing"], width, height)
    for state, screen in STATES.items():
        shown.show(screen)
        for _ in range(5):
            QApplication.processEvents()
        _look_for_overlaps(shown.window, state)


def _look_for_overlaps(window: QWidget, state: str) -> None:
    for widget in [*buttons(window), *window.findChildren(QLabel)]:
        if not widget.isVisible() or not widget.width():
            continue
        parent = widget.parentWidget()
        name = f"{state}: {type(widget).__name__} {widget.accessibleName() or widget.property('text')}"
        assert parent is not None and parent.rect().contains(widget.geometry()), name
        if isinstance(widget, QLabel | ActionButton) and widget.hasHeightForWidth():
            assert widget.heightForWidth(widget.width()) <= widget.height() + 1, name
    for one, other in combinations(buttons(window), 2):
        if one.parentWidget() is other.parentWidget() and not _on_its_card(one, other):
            assert not one.geometry().intersects(other.geometry()), f"{state}: {one.act}, {other.act}"


def _on_its_card(one: QWidget, other: QWidget) -> bool:
    """A card's button lies on it, where the card leaves room for it."""
    return "Card" in {type(one.parentWidget()).__name__, type(other.parentWidget()).__name__}


def test_who_commands_a_robot_is_read_beside_the_button_and_what_it_does_below(opened: Open) -> None:
    shown = opened(STATES["commanded"])
    shown.window.resize(shown.window.minimumSize())
    QApplication.processEvents()
    bold, plain = QFontMetricsF(font("small", bold=True)), QFontMetricsF(font("small"))
    for card in shown.window.column.cards.cards[:3]:
        button = card.ask_back.geometry()
        state = "" if card.ask_back.face.enabled else ", asked for"
        assert card.ask_back.accessibleName() == f"Ask for {card.accessibleName().lower()} back{state}"
        assert button.left() - PAD - bold.height() - GAP >= bold.horizontalAdvance("Ground station 255")
        assert plain.horizontalAdvance("traveling to room 4 · from the corridor") <= card.width() - 2.0 * PAD
        assert button.bottom() + plain.height() <= card.height() - EDGE


def test_a_robot_that_comes_back_has_a_lower_card_and_keeps_the_focus(opened: Open) -> None:
    shown = opened(STATES["commanded"])
    card = shown.window.column.cards.cards[0]
    card.ask_back.setFocus()
    high = card.maximumHeight()
    shown.show(STATES["playing"])
    assert card.maximumHeight() < high and not card.ask_back.isVisible() and card.stop.isVisible()
    assert card.face.hasFocus()


def test_rooms_stay_where_they_are_whoever_takes_and_gives_back_robots(opened: Open) -> None:
    taken = STATES["commanded"]
    given_back = replace(taken, cards=tuple(replace(card, commander="", ask_back=None) for card in taken.cards))
    shown = opened(taken)
    for _ in range(2):
        places = []
        for screen in (taken, given_back, replace(taken, cards=(*taken.cards[:1], *given_back.cards[1:]))):
            shown.show(screen)
            settle()
            places.append(shown.window.column.rooms.geometry())
        assert len(set(places)) == 1
        shown.window.resize(shown.window.minimumSize())


def test_six_robots_and_twelve_rooms_need_no_scrolling(opened: Open) -> None:
    window = opened(STATES["six"]).window
    for area in (window.column.card_area, window.column.tile_area):
        assert area.verticalScrollBar().maximum() == 0


def test_buttons_stay_where_they_are_while_their_letters_belong_to_a_list(opened: Open) -> None:
    shown = opened(STATES["playing"])
    bare = replace(
        STATES["treasure"],
        tools=tuple(replace(tool, key="") for tool in STATES["playing"].tools),
        ask_advice=replace(STATES["playing"].ask_advice, key=""),
    )
    places = []
    for screen in (STATES["playing"], bare):
        shown.show(screen)
        QApplication.processEvents()
        places.append([button.geometry() for button in shown.window.top.findChildren(ActionButton)])
    assert places[0] == places[1]


def test_tab_order_follows_the_eye(opened: Open) -> None:
    window = opened(STATES["dialogue"]).window
    corners = [region.mapTo(window, QPoint(0, 0)) for region in (window.top, window.column.cards, window.column.rooms)]
    assert [corner.y() for corner in corners] == sorted(corner.y() for corner in corners)
    assert window.regions[0] is window.dialogue, "what asks for an answer comes first"


class Painted(QObject):
    """Counts what is painted in a window, the map left out."""

    def __init__(self, window: QWidget, but: QWidget) -> None:
        super().__init__()
        self.count = 0
        self._but = but
        for widget in window.findChildren(QWidget):
            if widget is not but:
                widget.installEventFilter(self)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        self.count += event.type() in (QEvent.Type.Paint, QEvent.Type.LayoutRequest)
        return False


@pytest.mark.parametrize("state", ["playing", "treasure", "six"])
def test_a_screen_that_has_not_changed_costs_nothing(opened: Open, state: str) -> None:
    shown = opened(STATES[state])
    for _ in range(5):
        QApplication.processEvents()
    painted = Painted(shown.window, shown.window.map.viewport())
    before = painted.count
    for _ in range(10):
        shown.show(replace(shown.model.shown))
    only_edges = 10 * 4 if state == "treasure" else 0
    assert painted.count - before <= only_edges, "the frame of a pop-up is drawn with the map below it, no more"


def test_only_what_has_changed_is_drawn_anew(opened: Open) -> None:
    shown = opened(STATES["playing"])
    for _ in range(5):
        QApplication.processEvents()
    painted = Painted(shown.window, shown.window.map.viewport())
    cards = list(STATES["playing"].cards)
    cards[1] = replace(cards[1], energy=12.0)
    shown.show(replace(STATES["playing"], cards=tuple(cards)))
    assert 1 <= painted.count <= 6


@pytest.mark.slow
def test_twice_the_scale_cuts_nothing_off() -> None:
    """In a process of its own, because Qt takes the scale once, at its start."""
    asked = [sys.executable, "-m", "pytest", "-q", __file__, "-k", "cut_off or scrolling or whole"]
    done = subprocess.run(
        asked, env={**os.environ, "QT_SCALE_FACTOR": "2"}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout


# Pages ----------------------------------------------------------------------------------------------------------------


def test_each_phase_has_its_page(opened: Open) -> None:
    shown = opened(STATES["playing"])
    pages = {"connecting": "connecting", "consent": "consent", "playing": "top", "over": "ending"}
    for state, page in pages.items():
        shown.show(STATES[state])
        visible = {name for name in pages.values() if getattr(shown.window, name).isVisible()}
        assert page in visible
        assert visible <= {page, "top"}


def test_while_something_is_asked_nothing_behind_it_can_be_clicked(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["question"])
    room = that_asks(shown.window, SelectRoomAct(5))
    under = shown.window.childAt(room.mapTo(shown.window, room.rect().center()))
    assert under is not room


def test_tab_stays_in_what_lies_above_the_window(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"])
    for state, panel in (("help", shown.window.help), ("question", shown.window.question)):
        shown.window.setFocus()
        shown.show(STATES[state])
        for key in ("Tab", "Tab", "Tab", "Shift+Tab", "Shift+Tab"):
            press(qtbot, shown.window, key)
            focused = QApplication.focusWidget()
            assert focused is not None and panel.isAncestorOf(focused), (state, key)
        shown.show(STATES["playing"])


def test_the_score_counts_up_to_the_new_one(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"])
    score = shown.window.top.score
    shown.show(replace(STATES["playing"], score=150))
    assert score.accessibleName() == "Score 150"
    qtbot.waitUntil(lambda: not score.is_counting)


def test_phases_without_a_floor_plan_show_no_map(opened: Open) -> None:
    shown = opened(replace(STATES["connecting"], phase=Phase.CONNECTING))
    shown.model.floor_plan = None
    shown.show(STATES["playing"])
    shown.model.floor_plan = sample_screens.floor_plan("arena8")
    shown.show(STATES["dialogue"])
    assert shown.window.map.isVisible()


def test_nobody_looks_while_it_is_hidden(qtbot: QtBot, opened: Open) -> None:
    shown = opened(STATES["playing"])
    looks: list[float] = []
    screen = shown.model.screen
    shown.model.screen = lambda now: looks.append(now) or screen(now)
    shown.window.hide()
    looks.clear()
    with qtbot.assertNotEmitted(shown.window.top.requested, wait=100):
        pass
    assert looks == []
    shown.window.show()
    qtbot.waitUntil(lambda: len(looks) > 1)


def test_a_talk_that_fits_has_no_scroll_bar_that_would_break_its_lines(qtbot: QtBot) -> None:
    talk = Transcript(shipped_texts())
    qtbot.addWidget(talk)
    said = "I suggest room 3: room 7 costs me less now, but my whole round costs less with room 3 first. Shall I go?"
    talk.show_sentences((("you", "I don't know where to go."), ("robot", said)), 0)
    with qtbot.waitExposed(talk):
        talk.show()
    for width in range(300, 360):
        talk.resize(width, 40)
        QApplication.processEvents()
        assert talk.verticalScrollBar().isVisible()
        talk.resize(width, talk.heightForWidth(width))
        QApplication.processEvents()
        assert not talk.verticalScrollBar().isVisible(), width


def test_a_finding_has_shorter_words_for_a_narrow_tile() -> None:
    tile = replace(sample_screens.tile(1, 8), found="Orange bottle, +10", found_shorter=("Orange bottle", "+10"))
    assert tile_words(shipped_texts(), tile) == ("Orange bottle, +10", "Orange bottle", "+10")


def test_a_room_without_a_cost_has_no_way_only_where_none_leads_there() -> None:
    tile = replace(sample_screens.tile(1, 8), state="unvisited", cost=None, found="")
    impossible = replace(tile, choose=replace(tile.choose, enabled=False))
    assert tile_words(shipped_texts(), impossible) == ("",), "its robot drives, and another one talks about it"
    assert tile_words(shipped_texts(), replace(impossible, reachable=False)) == ("no path",)


def test_one_unit_is_no_units() -> None:
    texts = shipped_texts()
    tile = replace(sample_screens.tile(3, 8), cost=1.0)
    assert tile_words(texts, tile)[0] == "costs 1 unit of energy"
    assert tile_words(texts, replace(tile, cost=1.5))[0] == "costs 1.5 units of energy"
    card = replace(sample_screens.card(0), energy=28.0, cost=27.0)
    assert energy_words(texts, card)[0] == "Energy: 28 − 27 = 1 unit"
