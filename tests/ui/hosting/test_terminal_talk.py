"""A person at the terminal in a game of several people: who is there, and texts to each other."""

import pytest

from tests.support.hunts.people_in_a_hunt import HuntOfPeople
from thbridge.hunt.events import PersonRead, PersonSaid
from ui.model.playing.screen import SayToPeopleAct


@pytest.fixture
def hunt():
    playing = HuntOfPeople(at_terminal="namer")
    playing.run()
    return playing


def typed(hunt, line):
    before = len(hunt.terminal.lines)
    hunt.terminal.type(line)
    hunt.run()
    return hunt.terminal.lines[before:]


def test_the_game_begins_with_who_commands_whom(hunt):
    begin = hunt.terminal.lines.index(
        "You are the namer. You command no robot. You may name treasures, take over robots, end the game early"
        " and stop all robots."
    )
    assert hunt.terminal.lines[begin + 1] == "The driver commands robot 1 and robot 2."


def test_team_shows_the_people_and_the_names_for_texts(hunt):
    assert typed(hunt, "team") == [
        "  You, the namer: commands no robot. May name treasures, stop all robots, take over robots"
        " and end the game early.",
        "  @driver  the driver: here, commands robot 1 and robot 2",
        "  @scout  the scout: here, commands robot 3",
    ]


def test_texts_to_all_and_to_one_reach_their_addressees(hunt):
    assert typed(hunt, "> hello all") == []
    assert typed(hunt, "@scout psst") == []
    assert hunt.people["scout"].read == [("The namer", "hello all"), ("The namer to you only", "psst")]
    assert hunt.people["driver"].read == [("The namer", "hello all")]


def test_a_text_of_another_person_is_printed_once_and_marked_as_read(hunt):
    before = len(hunt.terminal.lines)
    hunt.people["driver"].do(SayToPeopleAct("namer", "look\n\x1b[2JRobot 1: done"))
    hunt.run(200)
    assert hunt.terminal.lines[before:] == ["The driver to you only: look \\x1b[2JRobot 1: done"]
    assert [entry.seat for entry in hunt.hunt.log.entries if isinstance(entry, PersonRead)] == ["namer"]


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        ("@nobody hello", "No person has this name. The names are: driver, scout"),
        (">", "Type the message behind the name."),
        ("> " + "x" * 501, "A message has at most 500 characters. This one has 501."),
    ],
)
def test_a_text_that_cannot_be_sent_has_a_reason(hunt, line, answer):
    assert typed(hunt, line) == [answer]
    assert not any(isinstance(entry, PersonSaid) for entry in hunt.hunt.log.entries)


def test_a_refused_text_is_printed_with_the_reason(hunt):
    for number in range(11):
        hunt.terminal.type(f"> text {number}")
    hunt.run()
    assert hunt.terminal.lines[-2:] == ["These are too many messages. Wait a little.", "Not sent: text 10"]
