"""Votes, hand-over, and objections in dialogues of teammates at the terminal."""

import pytest
from msgspec import structs

from tests.support.hunts.people_in_a_hunt import ALL_AGREE, SEATS, HuntOfPeople
from thbridge.hunt.events import CommanderChanged, ObjectionRaised, ObjectionReason, RobotDeparted, VoteCast
from ui.model.playing.screen import (
    AnswerDialogueAct,
    ChooseRobot,
    DialoguePopup,
    ObjectBecause,
    RaiseObjectionAct,
    SelectRoomAct,
    VoteAct,
)


def hunt_at(seat):
    hunt = HuntOfPeople(voting=ALL_AGREE, at_terminal=seat)
    hunt.run()
    return hunt


def typed(hunt, line):
    """Type a line; return the lines printed in answer."""
    before = len(hunt.terminal.lines)
    hunt.terminal.type(line)
    hunt.run()
    return hunt.terminal.lines[before:]


def entries(hunt, kind):
    return [entry for entry in hunt.hunt.log.entries if isinstance(entry, kind)]


def propose(hunt):
    driver = hunt.people["driver"]
    driver.do(SelectRoomAct(3))
    hunt.run(12)
    while isinstance(driver.screen.popup, DialoguePopup) and driver.screen.popup.choices:
        driver.do(AnswerDialogueAct(0))
        hunt.run(12)


@pytest.mark.parametrize(("line", "agrees"), [("yes close by", True), ("no 1 close by", False), ("n", False)])
def test_a_person_votes_with_yes_or_no_and_a_reason(line, agrees):
    hunt = hunt_at("namer")
    propose(hunt)
    assert hunt.terminal.lines[-2:] == [
        "The driver proposes that robot 1 goes to room 3.",
        "  2 more people must agree. Type yes or no, and a reason if you like (number 1).",
    ]
    typed(hunt, line)
    (cast,) = entries(hunt, VoteCast)
    assert (cast.seat, cast.agrees, cast.reason) == ("namer", agrees, "" if line == "n" else "close by")


def test_a_vote_without_an_open_decision_says_so():
    assert typed(hunt_at("namer"), "yes") == ["There is nothing to vote on at the moment."]


def test_the_proposer_reads_votes_and_results():
    hunt = hunt_at("driver")
    for line in ("1 3", "c", "c"):
        typed(hunt, line)
    assert "You propose that robot 1 goes to room 3." in hunt.terminal.lines
    hunt.people["namer"].do(VoteAct(1, True, "near"))
    hunt.people["scout"].do(VoteAct(1, True))
    hunt.run()
    assert [event.robot for event in entries(hunt, RobotDeparted)] == [0]
    for line in ("The namer agrees: “near”", "The team has agreed: robot 1 goes to room 3."):
        assert line in hunt.terminal.lines


def test_a_person_hands_over_a_robot_and_asks_for_one():
    hunt = hunt_at("driver")
    assert typed(hunt, "a 3") == ["You have asked for robot 3. The scout decides now."]
    assert typed(hunt, "g 1 nobody") == ["Type the name of a teammate who can take over robots: namer"]
    typed(hunt, "g 1 namer")
    assert [(event.robot, event.name) for event in entries(hunt, CommanderChanged)] == [(0, "namer")]


def test_a_dialogue_of_a_teammate_has_its_speakers_and_no_answers():
    hunt = hunt_at("namer")
    propose(hunt)
    assert "The driver to robot 1: Continue" in hunt.terminal.lines
    assert not any("[c Continue" in line for line in hunt.terminal.lines)


def test_a_person_objects_in_a_dialogue_of_a_teammate():
    driver, namer, scout = SEATS
    hunt = HuntOfPeople((driver, structs.replace(namer, objects=True), scout), at_terminal="namer")
    hunt.run()
    assert typed(hunt, "o 1") == ["No teammate talks with this robot, or you may not object."]
    hunt.people["driver"].do(SelectRoomAct(3))
    hunt.run(12)
    how = "To object, type o 1 and the number of a reason; own words may follow."
    assert hunt.terminal.lines[-1] == how
    assert typed(hunt, "o 1")[-2:] == ["  3  Another robot should go there.", how]
    assert typed(hunt, "o 1 2 Room 5 is near.") == ["You object: Another room is better. “Room 5 is near.”"]
    (entry,) = entries(hunt, ObjectionRaised)
    assert (entry.seat, entry.reason, entry.text) == ("namer", "other-room", "Room 5 is near.")
    assert typed(hunt, "o 1 1") == ["You have already objected in this dialogue."]


def test_the_commander_at_the_terminal_reads_an_objection():
    driver, namer, scout = SEATS
    hunt = HuntOfPeople((driver, structs.replace(namer, objects=True), scout), at_terminal="driver")
    hunt.run()
    typed(hunt, "1 3")
    namer_at = hunt.people["namer"]
    namer_at.do(ChooseRobot(0))
    namer_at.do(RaiseObjectionAct())
    namer_at.do(ObjectBecause(ObjectionReason.TOO_FAR))
    hunt.run()
    assert hunt.terminal.lines[-1] == "The namer objects: That room is too far."
