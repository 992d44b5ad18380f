"""Objections in dialogues of teammates: the button, the question for the reason, and what both people read."""

import pytest
from msgspec import structs

from tests.support.hunts.people_in_a_hunt import SEATS, HuntOfPeople
from thbridge.hunt.events import ObjectionRaised, ObjectionReason, RobotDeparted
from ui.model.playing.answer_guard import ANSWER_DELAY, AnswerGuard
from ui.model.playing.keys import act_for
from ui.model.playing.offers import offer
from ui.model.playing.screen import (
    AnswerDialogueAct,
    Cancel,
    ChooseRobot,
    ObjectBecause,
    RaiseObjectionAct,
    SelectRoomAct,
    ShowHelp,
)

DRIVER, NAMER, SCOUT = SEATS
OBJECTING = (DRIVER, structs.replace(NAMER, objects=True), SCOUT)
FAR = "The namer objects: That room is too far. “Look at the wall.”"


def talking(seats=OBJECTING, closes=1e6):
    """Return a hunt in which the driver talks with robot 1 about room 3, and the namer reads along."""
    hunt = HuntOfPeople(seats, closes=closes)
    hunt.run()
    hunt.people["driver"].do(SelectRoomAct(3))
    hunt.run(12)
    hunt.people["namer"].do(ChooseRobot(0))
    assert hunt.people["namer"].screen.popup.partner == "the driver"
    return hunt


def raised(hunt):
    return [entry for entry in hunt.hunt.log.entries if isinstance(entry, ObjectionRaised)]


def test_a_person_objects_with_a_reason_and_both_read_it_in_the_dialogue():
    hunt = talking()
    driver, namer = hunt.people["driver"], hunt.people["namer"]
    said = driver.screen.popup.sentences
    assert act_for("O", namer.screen) == RaiseObjectionAct()
    assert namer.screen.popup.own_words
    namer.do(RaiseObjectionAct(" Look at the wall. "))
    question = namer.screen.confirmation
    assert "“Look at the wall.”" in question.text
    assert [answer.label for answer in question.answers] == [
        "That room is too far.", "Another room is better.", "Another robot should go there.", "Do not object",
    ]  # fmt: skip
    namer.do(act_for("1", namer.screen))
    hunt.run()
    (entry,) = raised(hunt)
    assert (entry.seat, entry.reason, entry.text) == ("namer", "too-far", "Look at the wall.")
    assert driver.screen.popup.sentences == (*said, ("objection", FAR))
    assert driver.screen.banner.text == FAR
    assert FAR in driver.history
    assert namer.screen.popup.sentences[-1][1] == "You object: That room is too far. “Look at the wall.”"
    while driver.screen.popup is not None and driver.screen.popup.choices:
        driver.do(AnswerDialogueAct(0))
        hunt.run(12)
    assert [event.seat for event in hunt.hunt.log.entries if isinstance(event, RobotDeparted)] == ["driver"]


def test_an_objection_that_arrives_delays_the_answer_of_the_commander():
    hunt = talking()
    driver, namer = hunt.people["driver"], hunt.people["namer"]
    guard, before = AnswerGuard(), driver.screen
    guard.show(before, None, 0.0, acting=False)
    namer.do(RaiseObjectionAct())
    namer.do(ObjectBecause(ObjectionReason.TOO_FAR))
    hunt.run()
    assert guard.admits(AnswerDialogueAct(0), 10.0)
    assert guard.show(driver.screen, before, 10.0, acting=False)
    assert not guard.admits(AnswerDialogueAct(0), 10.0 + ANSWER_DELAY / 2)
    assert guard.admits(AnswerDialogueAct(0), 10.0 + ANSWER_DELAY)


def test_a_person_objects_once_and_may_cancel():
    hunt = talking()
    namer = hunt.people["namer"]
    namer.do(RaiseObjectionAct())
    namer.do(Cancel())
    assert namer.screen.confirmation is None
    namer.do(RaiseObjectionAct())
    namer.do(ObjectBecause(ObjectionReason.OTHER_ROOM))
    hunt.run()
    button = offer(namer.screen, RaiseObjectionAct())
    assert (button.enabled, button.hint) == (False, "You have objected. The driver decides.")
    assert not namer.screen.popup.own_words
    namer.do(RaiseObjectionAct("Again."))
    assert namer.screen.confirmation is None
    assert len(raised(hunt)) == 1


def test_a_question_about_a_dialogue_that_has_ended_disappears_with_a_reason():
    hunt = talking()
    driver, namer = hunt.people["driver"], hunt.people["namer"]
    namer.do(RaiseObjectionAct())
    while driver.screen.popup is not None and driver.screen.popup.choices:
        driver.do(AnswerDialogueAct(0))
        hunt.run(12)
    assert namer.screen.confirmation is None
    assert namer.screen.banner.text == "This dialogue has ended."
    assert raised(hunt) == []


def test_there_is_no_field_for_own_words_while_texts_are_off():
    assert not talking(closes=0.0).people["namer"].screen.popup.own_words


@pytest.mark.parametrize("seat", ["driver", "scout"])
def test_without_the_right_there_is_no_button_no_key_and_no_line_on_the_help_sheet(seat):
    hunt = talking()
    person = hunt.people[seat]
    person.do(ChooseRobot(0))
    assert person.screen.popup.objects is None
    assert act_for("O", person.screen) is None
    person.do(RaiseObjectionAct())
    assert person.screen.confirmation is None
    person.do(ShowHelp())
    assert not any(keys == "O" for keys, _ in person.screen.help)
    hunt.people["namer"].do(ShowHelp())
    assert any(keys == "O" for keys, _ in hunt.people["namer"].screen.help)
