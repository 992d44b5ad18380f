"""Seats of a game for the researcher's window: presence, robots, dialogues, texts and votes, at any time."""

import json

from tests.support.ros.watched_messages import StampedMessage, event
from thbridge.hunt.codec import kind_of, to_json
from thbridge.hunt.events import (
    CommanderChanged,
    DecisionKind,
    DecisionOutcome,
    DecisionProposed,
    DecisionSettled,
    PersonRead,
    PersonSaid,
    SeatLeft,
    SeatTaken,
    TeamEntry,
    VoteCast,
)
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.hunt.seats import PlayedBy
from thbridge.ros import names
from thbridge.ros.messages import pack, types
from thbridge.ros.messages.session_records import GameEvent, SeatNotice
from ui.model.watching.seat_log import SeatDialogue
from ui.model.watching.seat_rows import SeatRow, TeamLine, seat_rows, team_lines
from ui.model.watching.session_log import SessionLog

SEATS = [
    {"name": "driver", "label": "the driver", "robots": [0, 1], "names_treasures": False, "stops": "all"},
    {"name": "namer", "label": "the namer", "sees_map": False, "sees_dialogues": "own"},
]
SECOND = 1_000_000_000


def started() -> StampedMessage:
    return event(SECOND, "started", robots=2, seats=SEATS)


def team(entry: TeamEntry) -> StampedMessage:
    stamp = round((1.0 + entry.at) * SECOND)
    record = GameEvent(kind_of(type(entry)), None, None, to_json(entry))
    return StampedMessage(names.TEAM, types.GAME_EVENT, stamp, pack.game_event(0, record))


def view(second: int, seat: str, *dialogues: tuple[int, int, str], partners: dict[int, str]) -> StampedMessage:
    shown = [{"dialogue": number, "robot": robot, "matter": matter} for number, robot, matter in dialogues]
    text = json.dumps({"game": 1, "dialogues": shown, "team": {"partners": list(partners.items())}})
    data = pack.seat_notice(0, SeatNotice(seat, "View", text))
    return StampedMessage(names.SHOWN, types.SEAT_NOTICE, second * SECOND, data)


def log_of(*messages: StampedMessage) -> SessionLog:
    log = SessionLog()
    for message in messages:
        log.take(message)
    return log


def rows(log: SessionLog, second: int) -> tuple[SeatRow, ...]:
    return seat_rows(log.seats.at(second * SECOND))


def lines(log: SessionLog, second: int) -> tuple[TeamLine, ...]:
    return team_lines(log.seats.at(second * SECOND), RoomNames(), SECOND)


def test_a_game_with_one_participant_has_no_seats() -> None:
    log = log_of(event(SECOND, "started", robots=2), view(2, "", (1, 0, "select-room"), partners={}))
    assert rows(log, 9) == ()


def test_presence_at_each_time() -> None:
    log = log_of(
        started(),
        team(SeatTaken("driver", 1.0)),
        team(SeatLeft("driver", 3.0)),
        team(SeatTaken("driver", 5.0, PlayedBy.RESEARCHER)),
        team(SeatTaken("driver", 7.0)),
        team(SeatTaken("namer", 7.0, PlayedBy.PROGRAM)),
    )
    assert [rows(log, second)[0].presence for second in (1, 2, 4, 6, 8)] == [
        "not taken",
        "person",
        "away",
        "researcher",
        "person",
    ]
    assert rows(log, 9)[1].presence == "program"
    assert rows(log, 4)[0].why_not_played == ""
    assert "A person plays the seat driver" in rows(log, 8)[0].why_not_played
    assert "A program plays the seat namer" in rows(log, 9)[1].why_not_played


def test_robots_of_each_seat_follow_their_commander() -> None:
    changes = (
        (2, {"by": "participant", "name": "namer"}),
        (4, {"by": "ground station", "name": "station 255"}),
        (6, {"by": "participant", "name": "driver"}),
    )
    kind = kind_of(CommanderChanged)
    log = log_of(started(), *(event(second * SECOND, kind, 1, **fields) for second, fields in changes))
    found = [tuple(row.robots for row in rows(log, second)) for second in (1, 3, 5, 7)]
    assert found == [
        ("robots 1, 2", "no robot"),
        ("robot 1", "robot 2"),
        ("robot 1", "no robot"),
        ("robots 1, 2", "no robot"),
    ]


def test_rights_are_named_if_they_differ() -> None:
    assert [row.rights for row in rows(log_of(started()), 1)] == [
        "stops all robots",
        "names treasures, sees only its own dialogues, no map",
    ]


def test_each_dialogue_is_with_the_seat_that_answers() -> None:
    log = log_of(
        started(),
        view(2, "driver", (1, 0, "select-room"), (2, 1, "take-treasure"), partners={2: "namer"}),
        view(3, "namer", (2, 1, "take-treasure"), partners={}),
        view(5, "driver", partners={}),
        view(5, "namer", partners={}),
    )
    both = (SeatDialogue(0, "select-room", "driver"), SeatDialogue(1, "take-treasure", "namer"))
    assert log.seats.at(4 * SECOND).dialogues == both
    assert [row.talks for row in rows(log, 4)] == ["robot 1", "robot 2"]
    assert log.seats.at(6 * SECOND).dialogues == ()


def test_a_text_has_its_author_addressee_time_and_readers() -> None:
    log = log_of(
        started(),
        team(PersonSaid(1, "driver", "", "Hello.", 2.0, 0.5)),
        team(PersonSaid(2, "namer", "driver", "Hi.", 3.0, 0.5)),
        team(PersonRead(1, "namer", 4.0)),
    )
    assert lines(log, 4)[0] == TeamLine("0:02.00", "The driver to all", "Hello.", "not read by the namer", True)
    assert lines(log, 5) == (
        TeamLine("0:02.00", "The driver to all", "Hello.", "read by the namer 0:04.00", False),
        TeamLine("0:03.00", "The namer to the driver", "Hi.", "not read by the driver", True),
    )


def test_a_vote_has_its_proposer_votes_reasons_and_result() -> None:
    log = log_of(
        started(),
        team(SeatTaken("driver", 0.0)),
        team(SeatTaken("namer", 0.0)),
        team(DecisionProposed(1, "driver", DecisionKind.SEND, 0, Room(3), "", 2, 2.0)),
        team(VoteCast(1, "namer", False, "It is too far.", 4.0)),
        team(VoteCast(1, "namer", True, "", 6.0)),
        team(DecisionSettled(1, DecisionOutcome.CARRIED, 7.0)),
    )
    (opened,), (against,), (done,) = (lines(log, second) for second in (3, 5, 8))
    assert opened.title == "The driver proposes: robot 1 drives to room 3"
    assert (opened.is_open, opened.state) == (True, "open: 1 of 2 agree; waits for the namer")
    assert against.body == "✓ the driver (proposed it)\n✗ the namer: It is too far."
    assert (done.body, done.is_open) == ("✓ the driver (proposed it)\n✓ the namer", False)
    assert done.state == "agreed after 5 s; 2 of 2 agreed"


def test_another_game_begins_with_its_own_seats() -> None:
    log = log_of(started(), team(SeatTaken("driver", 1.0)), event(9 * SECOND, "started", robots=1, seats=SEATS[1:]))
    assert [row.name for row in rows(log, 9)] == ["namer"]
    assert rows(log, 9)[0].presence == "not taken"
    assert rows(log, 8)[0].presence == "person"


def test_damaged_entries_have_no_effect() -> None:
    broken = pack.seat_notice(0, SeatNotice("driver", "View", '{"dialogues": 3}'))
    log = log_of(
        started(),
        StampedMessage(names.SHOWN, types.SEAT_NOTICE, 2 * SECOND, broken),
        team(VoteCast(7, "namer", True, "", 3.0)),
        event(4 * SECOND, "started", robots=2, seats=[{"nome": "driver"}]),
    )
    assert log.seats.at(3 * SECOND).dialogues == ()
    assert rows(log, 5) == ()
