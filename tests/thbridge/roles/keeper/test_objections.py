"""Objections of a seat in a dialogue of another seat: rights, record, and what everybody reads."""

import math

import pytest
from msgspec import structs

from tests.support.hunts.seated_hunt import SeatedHunt
from thbridge.hunt.codec import to_json
from thbridge.hunt.events import ObjectionRaised, ObjectionReason, RobotDeparted
from thbridge.hunt.seats import DialogueSight, Seat
from thbridge.roles.keeper.team.game_team import TeamRules
from thbridge.roles.keeper.team.people_talk import TalkRules
from thbridge.roles.shared.team_notices import LONGEST_REASON, ObjectionView, RaiseObjection
from thbridge.roles.shared.view import AnswerDialogue, SelectRoom, View
from thbridge.text_protocol.wire.notice_format import encode_notice

DRIVER = Seat("driver", "the driver", robots=(0,), names_treasures=False)
NAMER = Seat("namer", "the namer", robots=(1,), objects=True)
JUDGE = Seat("judge", "the judge", takes_over=False, talks=False, sees_dialogues=DialogueSight.OWN)
SEATS = (DRIVER, NAMER, JUDGE)
TALK = TeamRules(TalkRules(0.0, math.inf))
TOO_FAR = ObjectionReason.TOO_FAR


def talking(seats: tuple[Seat, ...] = SEATS, team: TeamRules | None = TALK) -> SeatedHunt:
    """Return a hunt in which the driver talks with a robot about room 4: dialogue 1."""
    hunt = SeatedHunt(seats, team)
    assert hunt.ask("driver", SelectRoom(0, 4)).dialogues
    return hunt


def test_everybody_who_sees_the_dialogue_reads_the_objection_and_the_commander_decides():
    hunt = talking()
    sentences = len(hunt.view("driver").dialogues[0].said)
    view = hunt.ask("namer", RaiseObjection(1, TOO_FAR, " It is behind the wall. "))
    objection = ObjectionView(1, "namer", TOO_FAR, "It is behind the wall.", sentences)
    assert view.refusal is None
    assert [hunt.view(seat).team.objections for seat in ("driver", "namer")] == [(objection,)] * 2
    assert not hunt.view("judge").team.objections
    (raised,) = hunt.events(ObjectionRaised)
    assert (raised.dialogue, raised.seat, raised.robot, raised.room.people, raised.reason, raised.after) == (
        1, "namer", 0, 4, "too-far", sentences,
    )  # fmt: skip
    hunt.send("driver", 0, 4)
    assert [(each.robot, each.seat) for each in hunt.events(RobotDeparted)] == [(0, "driver")]


@pytest.mark.parametrize(
    ("seat", "request_", "sentence"),
    [
        ("judge", RaiseObjection(1, TOO_FAR), "Only the namer can object in dialogues of others."),
        ("driver", RaiseObjection(1, TOO_FAR), "Only the namer can object in dialogues of others."),
        ("namer", RaiseObjection(7, TOO_FAR), "This dialogue has ended."),
        ("namer", RaiseObjection(1, ObjectionReason.WRONG_NAME), "This reason does not fit the dialogue."),
        ("namer", RaiseObjection(1, TOO_FAR, "x" * (LONGEST_REASON + 1)), "An objection has at most 200 characters."),
    ],
)
def test_an_objection_without_the_right_or_the_occasion_is_refused(seat, request_, sentence):
    hunt = talking()
    assert hunt.ask(seat, request_).refusal.sentence == sentence
    assert hunt.events(ObjectionRaised) == []


def test_a_seat_answers_in_its_own_dialogue_instead_of_objecting():
    hunt = talking((structs.replace(DRIVER, objects=True), NAMER))
    refusal = hunt.ask("driver", RaiseObjection(1, TOO_FAR)).refusal
    assert refusal.sentence == "You can answer in this dialogue yourself."


def test_a_seat_objects_once_in_a_dialogue_and_a_repetition_has_no_effect():
    hunt = talking()
    hunt.ask("namer", RaiseObjection(1, TOO_FAR))
    assert hunt.ask("namer", RaiseObjection(1, TOO_FAR)).refusal is None
    refusal = hunt.ask("namer", RaiseObjection(1, ObjectionReason.OTHER_ROOM)).refusal
    assert refusal.sentence == "You have already objected in this dialogue."
    assert len(hunt.events(ObjectionRaised)) == 1


def test_own_words_need_the_texts_between_people():
    hunt = talking(team=None)
    refusal = hunt.ask("namer", RaiseObjection(1, TOO_FAR, "I know.")).refusal
    assert refusal.sentence == "Messages between people are switched off now."
    assert hunt.ask("namer", RaiseObjection(1, TOO_FAR)).team.objections


def test_after_a_restart_of_the_keeper_the_dialogue_still_has_the_objection():
    hunt = talking()
    hunt.ask("namer", RaiseObjection(1, TOO_FAR))
    before = hunt.view("driver")
    again = SeatedHunt(SEATS, TALK, history=hunt.entries)
    assert again.view("driver").team.objections == before.team.objections
    turn = again.view("driver").dialogues[0].turn
    again.ask("namer", RaiseObjection(1, ObjectionReason.OTHER_ROOM))
    again.ask("driver", AnswerDialogue(1, turn, 0))
    assert len(again.events(ObjectionRaised)) == 1


def test_a_game_without_the_right_has_no_trace_of_it():
    hunt = talking((DRIVER, structs.replace(NAMER, objects=Seat("", "").objects)))
    lines = [to_json(entry) for entry in hunt.entries]
    lines += [str(encode_notice("a", "b", each)) for each in hunt.shown["namer"] if isinstance(each, View)]
    assert lines
    assert not any("object" in line for line in lines)
