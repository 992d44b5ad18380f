"""Refusals of what programs ask for: told by the keeper and the log, and on the wire where a study wants it."""

import logging
from dataclasses import replace

import pytest

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from thbridge.app.session.session import SessionOutlets
from thbridge.app.trouble_log import TroubleLog
from thbridge.dialogue.moves import Author, DialogueTopic, DialogueUtterance, Leave, Scenario, Speaker
from thbridge.hunt.events import RobotArrived, RobotDeparted, TreasureLeft, TreasurePictured, TreasureSensed
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.roles.keeper.keeper import ProgramRefusal
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.router import SendToClient


class Outsider:
    """A game without TabUI, and a connection of a program of 2016 in its place."""

    def __init__(self, *, tells_refusals: bool = False, robots: bool = True) -> None:
        outside = {legacy.TABUI} if robots else {legacy.TABUI, legacy.SIMR}
        self.heard: list[str] = []
        self.hunt = HuntWithoutSimulator(
            outside=outside, tells_refusals=tells_refusals, outlets=SessionOutlets(self._perform)
        )
        self.session = self.hunt.session
        self.connection = self.session.router.connect(0.0)
        self.say("%%setid TabUI")
        self.hunt.run(6)

    def _perform(self, outputs) -> None:
        for output in outputs:
            if isinstance(output, SendToClient):
                self.heard.append(output.data.decode().strip())

    def say(self, line: str) -> None:
        self._perform(self.session.router.receive_data(self.connection, f"{line}\n".encode(), 0.0))

    def refused(self, line: str) -> list[str]:
        """Say a line; return the sentences of the refusals that follow."""
        before = len(self.hunt.tick_records)
        self.say(line)
        self.hunt.run(3)
        return [each.refused.sentence for tick in self.hunt.tick_records[before:] for each in tick.refusals]


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("%%goto TabUI SimR 0 39 39 45", "Room 40 is not a room of this game; it has 1 to 8."),
        ("%%goto TabUI SimR 7 1 1 45", "There is no robot 8; the team has 2."),
        ("%%snap TabUI Hider 3", "No robot stands in room 4."),
        ("%%snap TabUI Hider x", "It is not a line of the hunt of 2016."),
        ("%%goto TabUI SimR 0 one 1 45", "SimR cannot read it: 'one' is not a number."),
        ("%%goto TabUI SimR 0", "SimR cannot read it: its content is not that of %%goto."),
        ("%%move TabUI SimR 0 F 9", "SimR cannot read it: the intensity is 1 to 5, not 9."),
        ("%%error TabUI Nobody hello", "No program is called Nobody here."),
    ],
)
def test_what_is_refused_is_told_to_people_who_run_the_server_and_not_on_the_wire(line, sentence):
    outsider = Outsider()
    assert outsider.refused(line) == [sentence]
    assert set(outsider.heard) == {"%%ack"}


def test_a_visited_room_is_refused_with_its_reason():
    outsider = Outsider()
    assert outsider.refused("%%goto TabUI SimR 0 2 2 45") == []
    outsider.hunt.run(20)
    assert outsider.refused("%%goto TabUI SimR 1 2 2 45") == ["Room 3 has been visited already."]


def test_before_there_are_robots_there_is_no_game():
    assert Outsider(robots=False).refused('%%error TabUI Hider "3"') == [
        "There is no game yet, because no robots have joined."
    ]


def test_a_study_may_have_refusals_told_on_the_wire():
    outsider = Outsider(tells_refusals=True)
    outsider.refused("%%goto TabUI SimR 0 39 39 45")
    assert outsider.heard[-1] == "%%error Game TabUI refused: Room 40 is not a room of this game; it has 1 to 8."


def test_a_reply_to_a_program_that_has_gone_is_told_as_that_and_none_of_the_keeper_s_own():
    outsider = Outsider(tells_refusals=True)
    outsider.refused("%%goto TabUI SimR 0 2 2 45")
    outsider.say("%%goto TabUI SimR 1 39 39 45")
    outsider.say("%%sshhuuttddoowwnn")
    before = len(outsider.hunt.tick_records)
    outsider.hunt.run(20)
    told = [str(each) for tick in outsider.hunt.tick_records[before:] for each in tick.refusals]
    assert told == [
        'refused "%%goto TabUI SimR 1 39 39 45" of TabUI: Room 40 is not a room of this game; it has 1 to 8.',
        'could not deliver "%%error SimR TabUI "0;2"" of SimR: No program is called TabUI here.',
    ]


def test_what_is_repeated_does_not_fill_the_log(caplog):
    log, refused = TroubleLog(), RequestRefused("no", "No.")
    with caplog.at_level(logging.WARNING):
        for _ in range(120):
            log.note([ProgramRefusal("TabUI", "%%goto", refused)])
        for _ in range(5):  # in turn
            log.note([ProgramRefusal("TabUI", "%%goto", RequestRefused("no", "Never."))])
            log.note([ProgramRefusal("TabUI", "%%goto", refused)])
    told = [record.getMessage() for record in caplog.records]
    assert told == [
        'refused "%%goto" of TabUI: No.',
        'refused "%%goto" of TabUI: No. (10 times)',
        'refused "%%goto" of TabUI: No. (100 times)',
        'refused "%%goto" of TabUI: Never.',
    ]


def test_a_strategy_that_fails_is_told_in_the_log(caplog):
    topic = DialogueTopic(Scenario.SPECIFIC_ROOM, 1, Room(1), 50.0, 500.0)
    said = DialogueUtterance(1, 0, Speaker.ROBOT, Author.ROBOT, Leave(), "", topic, fault="a str is no move")
    log = TroubleLog()
    with caplog.at_level(logging.WARNING):
        for _ in range(3):
            log.note([], [said, replace(said, fault="")])
    (told,) = [record.getMessage() for record in caplog.records]
    assert told.endswith("chose a move by its own strategy, because the study's strategy failed: a str is no move")


def test_a_line_of_2016_that_comes_twice_counts_once() -> None:
    outsider = Outsider(tells_refusals=True)
    goto, sense, snap = "%%goto TabUI SimR 0 2 2 45", '%%error TabUI Hider "2"', "%%snap TabUI Hider 2"
    assert outsider.refused(goto) + outsider.refused(goto) == []
    outsider.hunt.run(20)
    for line in (sense, snap, sense, snap):
        assert outsider.refused(line) == []
    assert outsider.refused("%%goto TabUI SimR 0 4 4 45") == []
    assert outsider.refused(snap) == [], "what is known is sent again though its robot has gone on"
    kinds = [type(event) for event in outsider.hunt.log.events]
    of_room_3 = [RobotDeparted, RobotArrived, TreasureSensed, TreasurePictured]
    assert kinds[2:] == [*of_room_3, TreasureLeft, RobotDeparted]
    assert len([line for line in outsider.heard if "%%image" in line]) == 3
