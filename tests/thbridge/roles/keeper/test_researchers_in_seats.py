"""Researchers who play the seats of participants while these are away."""

import pytest

from tests.support.hunts.seated_hunt import SeatedHunt
from thbridge.hunt.events import (
    ConsentGiven,
    DialogueSaid,
    PersonSaid,
    RobotDeparted,
    SeatLeft,
    SeatTaken,
)
from thbridge.hunt.seats import PlayedBy, Seat
from thbridge.roles.keeper.team.game_team import TeamRules
from thbridge.roles.keeper.team.people_talk import TalkRules
from thbridge.roles.shared.seat_programs import researchers_program
from thbridge.roles.shared.team_notices import ReportPresence, SayToPeople
from thbridge.roles.shared.view import AnswerDialogue, GiveConsent, PlayAgain, SelectRoom, SendRobot

SEATS = (Seat("driver", "the driver", robots=(0,)), Seat("namer", "the namer", robots=(1,)))
TALK = TeamRules(TalkRules(0.0, 1e6))


@pytest.fixture
def hunt() -> SeatedHunt:
    return SeatedHunt(SEATS, TALK)


def holders(hunt: SeatedHunt, seat: str) -> list[PlayedBy | None]:
    """Return who played a seat, in order; None while nobody did."""
    entries = (entry for entry in hunt.entries if isinstance(entry, SeatTaken | SeatLeft) and entry.seat == seat)
    return [entry.by if isinstance(entry, SeatTaken) else None for entry in entries]


def test_a_seat_of_a_person_is_refused(hunt: SeatedHunt) -> None:
    assert hunt.take_as_researcher("driver") == (
        "a person plays the seat driver now; take a seat that is empty, or whose person is away"
    )
    assert holders(hunt, "driver") == [PlayedBy.PERSON]


def test_a_seat_of_a_program_is_refused(hunt: SeatedHunt) -> None:
    hunt.leave("driver")
    hunt.run(3)
    hunt.join("driver", simulated=True)
    hunt.run(3)
    assert hunt.take_as_researcher("driver").startswith("a program plays the seat driver now")
    assert holders(hunt, "driver") == [PlayedBy.PERSON, None, PlayedBy.PROGRAM]


def test_the_record_names_the_researcher_until_the_person_is_back(hunt: SeatedHunt) -> None:
    hunt.leave("driver")
    hunt.run(3)
    assert hunt.take_as_researcher("driver") == ""
    hunt.ask_as_researcher("driver", SelectRoom(0, 4))
    while hunt.view("driver").dialogues:
        dialogue = hunt.view("driver").dialogues[0]
        hunt.ask_as_researcher("driver", AnswerDialogue(dialogue.dialogue, dialogue.turn, 0))
    hunt.ask_as_researcher("driver", SendRobot(0, 4), SayToPeople("I am back."))
    hunt.join("driver")
    hunt.run(3)
    hunt.ask("driver", SayToPeople("Now I am really back."))
    assert holders(hunt, "driver") == [PlayedBy.PERSON, None, PlayedBy.RESEARCHER, PlayedBy.PERSON]
    assert [each.seat for each in hunt.events(RobotDeparted)] == ["driver"]
    said = [each for each in hunt.entries if isinstance(each, DialogueSaid) and each.speaker == "person"]
    assert said and {(each.author, each.seat) for each in said} == {("wizard", "driver")}
    taken = [n for n, entry in enumerate(hunt.entries) if isinstance(entry, SeatTaken) and entry.seat == "driver"]
    texts = [n for n, entry in enumerate(hunt.entries) if isinstance(entry, PersonSaid)]
    assert taken[1] < texts[0] < taken[2] < texts[1]


def test_the_others_see_that_the_seat_is_played(hunt: SeatedHunt) -> None:
    hunt.leave("driver")
    hunt.run(3)
    team = hunt.view("namer").team
    assert team is not None and not team.teammates[0].present
    hunt.take_as_researcher("driver")
    team = hunt.view("namer").team
    assert team is not None and team.teammates[0].present


@pytest.mark.parametrize("away", [True, False], ids=["away from the page", "disconnected"])
def test_the_researcher_leaves_when_the_person_comes_back(hunt: SeatedHunt, away: bool) -> None:
    if away:
        hunt.ask("driver", ReportPresence(present=False))
    else:
        hunt.leave("driver")
        hunt.run(3)
    assert hunt.take_as_researcher("driver") == ""
    if away:
        hunt.ask("driver", ReportPresence(present=True))
    else:
        hunt.join("driver")
        hunt.run(3)
    ((program, reason),) = hunt.dismissed
    assert program == researchers_program("driver")
    assert reason.startswith("a person plays the seat driver now")
    hunt.ask_as_researcher("driver", SayToPeople("Am I still here?"))
    assert hunt.events(PersonSaid) == []


def test_a_researcher_cannot_agree_or_play_again_for_a_person(hunt: SeatedHunt) -> None:
    hunt.leave("driver")
    hunt.run(3)
    hunt.take_as_researcher("driver")
    entries = len(hunt.entries)
    hunt.ask_as_researcher("driver", GiveConsent("2026-01-01T00:00:00Z"), PlayAgain(1), ReportPresence(present=False))
    assert not any(isinstance(each, ConsentGiven) for each in hunt.entries[entries:])
    assert holders(hunt, "driver")[-1] is PlayedBy.RESEARCHER
