"""The screen while robots argue."""

import pytest
from msgspec import structs

from tests.support.hunts.participant_views import ANSWERS, argued, arguing, asking, ended, view, with_robot, with_room
from thbridge.files.language_texts import shipped_texts
from thbridge.roles.shared.view import (
    AnswerDialogue,
    Consent,
    IdentificationVerdict,
    IdentifyTreasure,
    LastWords,
    OpenDialogue,
    SendRobot,
    View,
)
from ui.model.playing.keys import act_for, help_lines
from ui.model.playing.participant import Participant
from ui.model.playing.screen import (
    AnswerDialogueAct,
    AskWhatItIs,
    ChooseRobot,
    IdentifyTreasureAct,
    PickName,
    SelectRoomAct,
    ShowNext,
    TypeDigit,
)

QUESTIONS = ("enquire", "enquire", "close-questions")


def model_of(seen: View) -> Participant:
    model = Participant()
    model.connected(0.0)
    model.receive(seen, 0.0)
    model.screen(0.0)
    return model


def test_who_said_what_is_as_the_game_tells():
    model = model_of(view())
    talk = arguing(">Go there next.", "No.", ">Why?", "Too far.", ">Still.")
    model.receive(view(dialogues=(talk,)), 0.0)
    lines = [("you", "Go there next."), ("robot", "No."), ("you", "Why?"), ("robot", "Too far."), ("you", "Still.")]
    assert list(model.screen(0.0).popup.sentences) == lines
    assert [(line.speaker, line.text) for line in model.screen(0.0).history[1:]] == lines


def test_the_sentence_that_opened_a_dialogue_is_there_once():
    model = model_of(view())
    model.do(SelectRoomAct(2), 0.0)
    model.receive(view(dialogues=(arguing(">Go to room 2 next.", "No."),)), 0.0)
    lines = [("you", "Go to room 2."), ("robot", "No.")]
    assert list(model.screen(0.0).popup.sentences) == lines
    assert [(line.speaker, line.text) for line in model.screen(0.0).history[1:]] == lines


def test_answers_are_numbered_and_digits_give_them_and_no_robot_is_sent_by_them():
    model = model_of(argued(arguing(">Go.", "No.", acts=ANSWERS)))
    screen = model.screen(0.0)
    assert [choice.key for choice in screen.popup.choices] == ["1", "2", "3", "4"]
    assert [act_for(str(digit), screen) for digit in range(6)] == [None, *map(AnswerDialogueAct, range(4)), None]
    assert not any(tile.choose.key for tile in screen.tiles)
    model.do(ShowNext(), 0.0)
    aside = model.screen(0.0)
    assert act_for("2", aside) == TypeDigit(2)
    assert [tile.choose.key for tile in aside.tiles] == ["1", "2", "3"]


def test_robots_that_do_not_argue_are_answered_by_letters_as_ever():
    screen = model_of(view(dialogues=(asking(0, 2),))).screen(0.0)
    assert [choice.key for choice in screen.popup.choices] == ["C", "S"]
    assert act_for("1", screen) == TypeDigit(1)
    assert screen.popup.note == ""


def test_esc_leads_back_from_the_questions_and_puts_the_other_answers_aside():
    screen = model_of(argued(arguing("No.", acts=ANSWERS))).screen(0.0)
    assert act_for("Esc", screen) == act_for("W", screen) == ShowNext()
    asking_it = model_of(argued(arguing("No.", acts=QUESTIONS))).screen(0.0)
    assert act_for("Esc", asking_it) == AnswerDialogueAct(2)
    assert act_for("3", asking_it) == AnswerDialogueAct(2)
    assert (act_for("W", asking_it), asking_it.popup.aside.key) == (ShowNext(), "W")


@pytest.mark.parametrize(
    ("who", "words"), [("both", "both agree"), ("participant", "decision is yours"), ("robot", "Robot 1 decides")]
)
def test_who_has_the_last_word_is_said(who, words):
    model = model_of(argued(arguing("No.", acts=("accept", "override")), who=who))
    popup = model.screen(0.0).popup
    assert words in popup.note
    assert [choice.hint for choice in popup.choices] == ["", "This is your decision."]


def test_a_robot_that_has_nothing_to_reply_is_seen_to_wait():
    popup = model_of(argued(arguing("No.", ">Still."))).screen(0.0).popup
    assert popup.note == "Robot 1 has nothing to add. It is your turn."


def test_what_is_answered_is_said_at_once_but_a_look_at_the_questions_is_not():
    for choice, said in ((1, [("robot", "No."), ("you", "challenge")]), (2, [("robot", "No.")])):
        model = model_of(argued(arguing("No.", acts=ANSWERS)))
        model.do(AnswerDialogueAct(choice), 0.0)
        assert list(model.screen(0.0).popup.sentences) == said
        assert [(line.speaker, line.text) for line in model.screen(0.0).history[1:]] == said


def test_two_robots_that_ask_are_answered_in_any_order_and_each_card_shows_its_own_dialogue():
    talks = (arguing("One.", acts=ANSWERS), arguing("Two.", acts=ANSWERS, robot=1, room=3))
    model = model_of(argued(*talks))
    screen = model.screen(0.0)
    assert [card.state for card in screen.cards] == ["waits for your answer"] * 2
    for robot in (1, 0, 1):
        model.do(ChooseRobot(robot), 0.0)
        screen = model.screen(0.0)
        assert screen.popup.robot == robot
        assert [item.robot for item in screen.waiting] == [1 - robot]
    model.do(AnswerDialogueAct(0), 0.0)
    assert model.requests() == (AnswerDialogue(2, 1, 0),)


def test_the_end_of_a_dialogue_stays_before_the_next_one_until_it_is_closed():
    two = arguing("Two.", acts=ANSWERS, robot=1, room=3)
    model = model_of(argued(arguing("No.", acts=ANSWERS), two))
    model.receive(argued(two, words=(ended(agreed=False),)), 0.0)
    screen = model.screen(0.0)
    assert (screen.popup.ended, screen.popup.outcome) == (True, "Robot 1 stays where it is.")
    assert [sentence for _, sentence in screen.popup.sentences] == ["No.", "Leave it."]
    assert [line.text for line in screen.history[-2:]] == ["Leave it.", "Robot 1 stays where it is."]
    assert "Robot 1 stays where it is." in screen.announcement
    model.do(ShowNext(), 0.0)
    screen = model.screen(0.0)
    assert screen.popup.robot == 1
    assert screen.waiting == ()


@pytest.mark.parametrize("agreed", [True, False])
def test_what_the_robot_has_said_itself_is_not_said_again(agreed):
    model = model_of(argued(arguing("No.", acts=ANSWERS)))
    said, speakers = ("No.", "Leave it.", "I stay."), ("robot", "person", "robot")
    told = LastWords(1, 0, "select-room", 2, said, speakers, agreed, is_told=True)
    model.receive(argued(words=(told,)), 0.0)
    screen = model.screen(0.0)
    assert (screen.popup.ended, screen.popup.outcome) == (True, "")
    assert list(screen.popup.sentences) == [("you", "Leave it."), ("robot", "I stay.")]
    assert [line.text for line in screen.history[-2:]] == ["Leave it.", "I stay."]
    assert "Robot 1: I stay." in screen.announcement


def test_an_esc_that_was_meant_for_the_dialogue_does_not_close_its_end():
    model = model_of(argued(arguing("No.", acts=ANSWERS)))
    model.receive(argued(words=(ended(agreed=False),)), 0.0)
    model.do(ShowNext(), 0.0)
    assert model.screen(0.0).popup.outcome


def test_what_was_agreed_is_done_at_once_and_can_be_read_until_it_is_done():
    words = (ended(agreed=True),)
    model = model_of(argued(arguing("There?", acts=ANSWERS)))
    model.receive(argued(words=words, consents=(Consent(0, "select-room", 2),)), 0.0)
    assert model.requests() == (SendRobot(0, 2),)
    assert model.screen(0.0).popup.outcome == "Robot 1 goes to room 2."
    model.receive(with_robot(argued(words=words), 0, moving_to=2), 0.0)
    assert model.screen(0.0).popup.outcome == "Robot 1 goes to room 2."
    model.receive(with_robot(argued(), 0, place=2), 0.0)
    assert model.screen(0.0).popup is None


def test_an_end_that_was_left_for_another_robot_comes_back_with_its_own():
    model = model_of(argued())
    model.receive(argued(words=(ended(agreed=False),)), 0.0)
    model.screen(0.0)
    model.do(ChooseRobot(1), 0.0)
    model.do(SelectRoomAct(3), 0.0)
    assert model.screen(0.0).popup.robot == 1
    assert model.screen(0.0).waiting == (), "it has been read"
    model.do(ChooseRobot(0), 0.0)
    assert model.screen(0.0).popup.outcome


def test_a_robot_that_says_nothing_because_all_was_said_is_explained():
    model = model_of(argued())
    model.do(SelectRoomAct(2), 0.0)
    model.receive(argued(words=(ended(agreed=False, said=()),)), 0.0)
    assert "talked about this before" in model.screen(0.0).popup.outcome


def test_the_sheet_of_keys_has_those_of_numbered_answers():
    assert "1 to 5" in dict(help_lines(shipped_texts(), 8, numbered=True))
    assert "1 to 5" not in dict(help_lines(shipped_texts(), 8))


@pytest.mark.parametrize(("who", "told"), [("robot", "Robot 1 has named the treasure by itself. "), ("both", "")])
def test_a_name_that_a_robot_has_given_by_itself_is_told_as_its_own(who, told):
    found = with_room(with_robot(argued(who=who), 0, place=3), 3, state="visited", robot=0, sensed={"colour": "Pink"})
    model = model_of(found)
    model.receive(with_room(found, 3, verdict=IdentificationVerdict("Pink can", 30)), 1.0)
    assert model.screen(1.0).popup.verdict == f"{told}Pink can is right, 30 points won."


def test_a_name_is_said_to_robots_that_argue_and_what_was_agreed_is_what_it_is_named():
    found = with_room(argued(), 2, state="visited", robot=0, sensed={"colour": "Blue"})
    found = structs.replace(with_robot(found, 0, place=2), names=("Cup", "Vase"))
    model = model_of(found)
    model.do(PickName("Cup"), 0.0)
    model.screen(0.0)
    model.do(IdentifyTreasureAct(), 0.0)
    assert OpenDialogue(0, "take-treasure", 2, "Cup") in model.requests()
    agreed = structs.replace(found, consents=(Consent(0, "take-treasure", 2, "Vase"),))
    model.receive(agreed, 0.0)
    assert IdentifyTreasure(2, "Vase") in model.requests()
    assert IdentifyTreasure(2, "Cup") not in model.requests()


def test_who_does_not_know_what_was_found_asks_the_robot_by_button_or_key():
    found = with_room(argued(), 2, state="visited", robot=0, sensed={"colour": "Blue"})
    found = structs.replace(with_robot(found, 0, place=2), names=("Cup", "Vase"))
    model = model_of(found)
    screen = model.screen(0.0)
    assert screen.popup.unsure.enabled and act_for("Ctrl+K", screen) == AskWhatItIs()
    model.do(AskWhatItIs(), 0.0)
    assert OpenDialogue(0, "take-treasure", 2, "") in model.requests()
    assert not model.screen(0.0).popup.unsure.enabled


def test_robots_that_do_not_argue_are_not_asked_what_they_found():
    found = with_room(view(), 2, state="visited", robot=0, sensed={"colour": "Blue"})
    model = model_of(structs.replace(with_robot(found, 0, place=2), names=("Cup", "Vase")))
    assert model.screen(0.0).popup.unsure is None
    model.do(AskWhatItIs(), 0.0)
    assert not [each for each in model.requests() if isinstance(each, OpenDialogue)]
