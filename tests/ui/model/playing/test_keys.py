import string
from dataclasses import replace

import pytest

from tests.support.hunts.screen_player import ScreenPlayer
from thbridge.files.language_texts import shipped_texts
from ui.model.playing.keys import (
    CONSENT,
    HELP,
    OVER,
    PLAYING,
    act_for,
    choice_keys,
    help_lines,
    key_of,
    question_keys,
    shown_key,
)
from ui.model.playing.participant import Participant
from ui.model.playing.screen import (
    AnswerDialogueAct,
    Cancel,
    Confirm,
    DialoguePopup,
    EndGameAct,
    FinishNumber,
    FollowRobot,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    NextRobot,
    Phase,
    PickName,
    PlayAgainAct,
    RequestSuggestionAct,
    SelectRoomAct,
    ShowHelp,
    ShowNext,
    StopRobotAct,
    TakePictureAct,
    TreasurePopup,
    TypeDigit,
    TypeLetter,
)

QUESTION = question_keys(shipped_texts())


def test_no_key_does_two_things_at_a_time():
    for table in (PLAYING, QUESTION):
        keys = [key for binding in table for key in binding.keys]
        assert len(set(keys)) == len(keys)


def test_a_whole_hunt_by_keys_alone():
    seat = ScreenPlayer(robots=2)

    def press(*keys):
        for key in keys:
            act = act_for(key, seat.screen)
            assert act is not None, key
            seat.press(act)

    seat.hunt.puppets.ticks = 2
    for _ in range(400):
        screen = seat.screen
        if screen.phase is Phase.OVER:
            break
        pop = screen.popup
        if isinstance(pop, DialoguePopup):
            press("C" if pop.choices[0].key == "C" else "Enter")
        elif isinstance(pop, TreasurePopup) and pop.verdict is not None:
            press("Enter")
        elif isinstance(pop, TreasurePopup) and pop.take_picture is not None and pop.take_picture.enabled:
            press("Ctrl+P")
        elif isinstance(pop, TreasurePopup) and not pop.leave.enabled:
            seat.run()
        elif isinstance(pop, TreasurePopup):
            naming = ("Down", "Ctrl+N" if pop.robot == 0 else "Enter")
            press(*naming) if pop.name_it.hint.startswith("Pick") else press("Ctrl+L")
        elif screen.ask_advice.enabled:
            press("D")
        else:
            press("Tab")
    assert seat.screen.phase is Phase.OVER
    assert seat.hunt.session.game.score != 0
    press("A")
    assert seat.screen.game == 2
    press("E", "Y")
    assert seat.screen.phase is Phase.OVER


@pytest.mark.parametrize(
    ("key", "act"),
    [
        ("Tab", NextRobot(1)),
        ("Shift+Tab", NextRobot(-1)),
        ("3", TypeDigit(3)),
        ("?", RequestSuggestionAct()),
        ("D", RequestSuggestionAct()),
        ("X", StopRobotAct()),
        ("E", EndGameAct()),
        ("Esc", ShowNext()),
        ("F1", ShowHelp()),
        ("Q", None),
        ("", None),
    ],
)
def test_keys_while_playing(key, act):
    assert act_for(key, ScreenPlayer().screen) == act


def test_a_question_hears_only_yes_no_and_help():
    seat = ScreenPlayer()
    screen = seat.press(EndGameAct())
    assert [act_for(key, screen) for key in ("Y", "N", "Esc", "F1")] == [Confirm(), Cancel(), Cancel(), ShowHelp()]
    assert [act_for(key, screen) for key in ("3", "Tab", "Enter", "D", "E")] == [None] * 5


def test_a_question_is_answered_by_the_letters_of_the_language_as_its_buttons_say():
    seat = ScreenPlayer(Participant(texts=shipped_texts("de")))
    question = seat.press(EndGameAct()).confirmation
    assert (question.yes.key, question.no.key) == ("J", "N")
    assert [act_for(key, seat.screen) for key in ("J", "N", "Esc", "Y")] == [Confirm(), Cancel(), Cancel(), None]
    assert ("J", "Eine Frage des Programms mit Ja beantworten") in help_lines(shipped_texts("de"), 8)


def test_a_dialogue_takes_the_letters_on_its_buttons():
    seat = ScreenPlayer()
    screen = seat.do(SelectRoomAct(3))
    assert [act_for(key, screen) for key in ("C", "S", "Enter")] == [
        AnswerDialogueAct(0),
        AnswerDialogueAct(1),
        AnswerDialogueAct(0),
    ]
    assert act_for("Esc", screen) == ShowNext()


def test_help_closes_by_esc_before_anything_else_hears_it():
    seat = ScreenPlayer()
    seat.do(SelectRoomAct(3))
    screen = seat.press(ShowHelp())
    assert [act_for(key, screen) for key in ("Esc", "F1", "H")] == [ShowHelp()] * 3
    assert [act_for(key, screen) for key in ("C", "3", "Tab", "Enter")] == [None] * 4


def test_names_are_picked_by_arrows():
    seat = ScreenPlayer()
    seat.do(SelectRoomAct(3))
    seat.do(AnswerDialogueAct(0))
    seat.do(AnswerDialogueAct(0), 40)
    screen = seat.screen
    assert screen.popup.picked is None
    assert act_for("Down", screen) == PickName(screen.popup.names[0])
    assert act_for("Up", screen) == PickName(screen.popup.names[-1])
    screen = seat.press(act_for("Up", screen))
    assert act_for("Down", screen) == PickName(screen.popup.names[0])
    assert [act_for(key, screen) for key in ("Home", "End")] == [
        PickName(screen.popup.names[0]),
        PickName(screen.popup.names[-1]),
    ]


def test_letters_belong_to_the_open_list_and_ctrl_stands_before_those_of_buttons():
    seat = ScreenPlayer()
    seat.do(SelectRoomAct(3))
    seat.do(AnswerDialogueAct(0))
    screen = seat.do(AnswerDialogueAct(0), 40)
    letters = string.ascii_uppercase
    assert [act_for(letter, screen) for letter in letters] == [TypeLetter(letter.lower()) for letter in letters]
    keys = ("Enter", "Ctrl+N", "Ctrl+P", "Ctrl+L", "Esc", "Ctrl+X", "Ctrl+F", "Ctrl+H", "?", "Space", "3", "Ctrl+Q")
    acts = [
        IdentifyTreasureAct(),
        IdentifyTreasureAct(),
        TakePictureAct(),
        LeaveTreasureAct(),
        ShowNext(),
        StopRobotAct(),
        FollowRobot(),
    ]
    acts += [ShowHelp(), RequestSuggestionAct(), None, TypeDigit(3), None]
    assert [act_for(key, screen) for key in keys] == acts
    printed = {action.key for action in seat.offers()}
    assert {"Enter", "Ctrl+P", "Ctrl+L", "Esc", "F1"} <= printed
    assert not printed & set(letters), "no button says that a letter presses it"
    assert act_for("Space", seat.press(TypeLetter("b"), 1)) == TypeLetter(" ")


def test_enter_and_esc_are_for_the_digits_while_some_are_typed():
    screen = replace(ScreenPlayer().screen, typed="1")
    assert act_for("Enter", screen) == FinishNumber()
    assert act_for("Esc", screen) == Cancel()


def test_no_key_does_anything_before_there_is_a_game_but_that_of_help():
    screen = Participant().screen(0.0)
    assert [act_for(key, screen) for key in ("Enter", "3", "A", "F1")] == [None, None, None, ShowHelp()]


def test_answers_get_letters_of_their_own():
    assert choice_keys(("Continue", "Stop")) == ("C", "S")
    assert choice_keys(("Don't go", "Yes", "Yes, but")) == ("O", "Y", "S")
    assert len(set(choice_keys(("?",) * 8))) == 8


def test_every_binding_is_on_the_help_sheet():
    sheet = " ".join(keys for keys, _ in help_lines(shipped_texts(), 8))
    assert all(key in sheet for binding in (*PLAYING, *QUESTION) for key in binding.keys)
    assert help_lines(shipped_texts(), 8)[0] == ("1 to 8", "Send the robot to this room")
    assert "both digits" in help_lines(shipped_texts(), 12)[0][1]
    assert not any("room" in keys or "0" in keys for keys, _ in help_lines(shipped_texts(), 0)), (
        "no rooms before there is a game"
    )


def test_acts_without_a_key_have_none_printed():
    assert key_of(PlayAgainAct()) == "A"
    assert key_of(SelectRoomAct(3)) == ""


@pytest.mark.parametrize(
    ("key", "english", "german"),
    [
        ("Ctrl+P", "Ctrl+P", "Strg+P"),
        ("Shift+Tab", "Shift+Tab", "Umschalt+Tab"),
        ("PageUp", "Page Up", "Bild auf"),
        ("F1", "F1", "F1"),
        ("?", "?", "?"),
        ("+", "+", "+"),
    ],
)
def test_keys_are_shown_as_the_languages_keyboard_has_them(key, english, german):
    assert (shown_key(shipped_texts("en"), key), shown_key(shipped_texts("de"), key)) == (english, german)


@pytest.mark.parametrize("binding", [*PLAYING, *CONSENT, *OVER, *QUESTION, HELP])
def test_what_each_key_does_has_a_text(binding):
    assert shipped_texts().has(binding.does)
