"""Votes, hand-over and dialogues of teammates at the terminal."""

import pytest

from tests.support.hunts.people_in_a_hunt import ALL_AGREE, HuntOfPeople
from thbridge.hunt.events import CommanderChanged, RobotDeparted, VoteCast
from ui.model.playing.screen import AnswerDialogueAct, DialoguePopup, SelectRoomAct, VoteAct


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
