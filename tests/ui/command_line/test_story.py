"""A hunt told in sentences."""

import dataclasses

from tests.support.hunts.hunt_without_simulator import RULES, HuntWithoutSimulator, templates
from tests.support.hunts.scripted_hunt import TAKE, ScriptedHunt
from thbridge.app.compose.game import build_bot
from thbridge.hunt.events import (
    Commander,
    CommanderChanged,
    HandbackRequested,
    RobotArrived,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
)
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.hunt.seats import Seat
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.robot_requests import ReleaseCommand
from ui.command_line.story import print_story, tell


def test_who_commands_a_robot_is_told() -> None:
    play = ScriptedHunt()
    play.ask(TAKE)
    play.hunt.puppets.researchers = ("/rviz", None)
    play.hunt.run(60)
    play.hunt.puppets.researchers = (None, None)
    play.hunt.run(60)
    play.ask(ReleaseCommand(0))
    sentences = [sentence.split("s  ", 1)[1] for tick in play.hunt.tick_records for sentence in tell(tick, RoomNames())]
    assert [sentence for sentence in sentences if "commanded" in sentence] == [
        "Robot 1 is now commanded by ground station 255.",
        "Robot 1 is now commanded by /rviz.",
        "Robot 1 is now commanded by ground station 255.",
        "Robot 1 is now commanded by the participant.",
    ]


def test_a_story_names_the_seats() -> None:
    seats = (Seat("driver", "the driver", robots=(0,)), Seat("namer", "the namer"))
    rules = dataclasses.replace(RULES, seats=seats)
    bots = [TabUI(build_bot(templates(), "nearest", seed), seat=each.name) for seed, each in enumerate(seats)]
    hunt = HuntWithoutSimulator(robots=1, rules=rules, participant=bots[0], others=bots[1:])
    hunt.run(300)
    sentences = {sentence.split("s  ", 1)[1] for tick in hunt.tick_records for sentence in tell(tick, RoomNames())}
    assert {"The driver joins", "The namer joins"} < sentences
    assert any(sentence.startswith("The driver to robot 1: ") for sentence in sentences)
    assert any(sentence.startswith("The driver: Robot 1 leaves for room") for sentence in sentences)
    hand_over = dataclasses.replace(
        hunt.tick_records[-1],
        events=(HandbackRequested(0, "namer"), CommanderChanged(0, Commander.PARTICIPANT, "namer", "driver")),
        utterances=(),
    )
    assert [sentence.split("s  ", 1)[1] for sentence in tell(hand_over, RoomNames())] == [
        "The namer asks to command robot 1.",
        "The driver: Robot 1 is now commanded by the namer.",
    ]


def test_names_are_told_as_words_and_no_file_of_a_picture() -> None:
    play = ScriptedHunt()
    play.hunt.run(2)
    events = (
        TreasurePictured(Room(3), 0, "rsz_t3.jpg", 5.0),
        TreasureIdentified(Room(3), 0, "beer_bottle", 20, 1.0),
        TreasureIdentified(None, None, None, -10, 0.0),
    )
    tick = dataclasses.replace(play.hunt.tick_records[-1], events=events, utterances=())
    assert [sentence.split("s  ", 1)[1] for sentence in tell(tick, RoomNames())] == [
        "Robot 1 takes a picture in room 3.",
        "The treasure in room 3 is named beer bottle: +20 points.",
        "The treasure is named: -10 points.",
    ]


def test_the_name_of_a_room_stands_beside_its_number() -> None:
    play = ScriptedHunt()
    play.hunt.run(2)
    events = (RobotArrived(0, Room(3)), RobotArrived(1, Room(4)), TreasureLeft(Room(3)))
    tick = dataclasses.replace(play.hunt.tick_records[-1], events=events, utterances=())
    assert [sentence.split("s  ", 1)[1] for sentence in tell(tick, RoomNames({3: "Kitchen"}))] == [
        "Robot 1 has reached room 3 (Kitchen).",
        "Robot 2 has reached room 4.",
        "The treasure in room 3 (Kitchen) is left undecided.",
    ]


def test_a_sentence_is_one_line_where_no_terminal_is(capsys, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    play = ScriptedHunt()
    play.hunt.run(2)
    events = (RobotArrived(0, Room(3)),)
    tick = dataclasses.replace(play.hunt.tick_records[-1], events=events, utterances=())
    print_story(tick, RoomNames({3: "Store of instruments beside the long corridor"}))
    assert capsys.readouterr().out == (
        "    0.2 s  Robot 1 has reached room 3 (Store of instruments beside the long corridor).\n"
    )
