from typing import get_args

from tests.support.ros.watched_messages import StampedMessage, event
from thbridge.analysis.report.report import WayMade
from thbridge.hunt.codec import kind_of
from thbridge.hunt.events import GameEnded, HandbackRequested, TreasureIdentified, TreasurePictured, TreasureTakenUp
from thbridge.ros import names
from thbridge.ros.messages import pack, types
from thbridge.ros.messages.pack import DiagnosticLevel, DiagnosticStatus
from thbridge.ros.messages.records import LogLevel, LogLine
from ui.model.watching.scene import EntryKind
from ui.model.watching.session_log import MAX_ENTRIES, RoomStatus, SessionLog


def log(second: int, level: LogLevel, text: str) -> StampedMessage:
    return StampedMessage(names.ROSOUT, types.LOG, second, pack.log(0, LogLine(level, "/robot1/amcl", text)))


def test_rooms_are_as_the_game_left_them_at_a_time() -> None:
    session_log = SessionLog()
    for message in (
        event(1, "started"),
        event(2, "hidden", treasures=[{"name": "Pink can"}, {"name": "Blue box"}]),
        event(3, "departed", 0, 2),
        event(5, "arrived", 0, 2),
        event(6, "departed", 1, 1),
        event(7, "failed", 1, 1, reason="No way."),
        event(9, "started"),
    ):
        session_log.take(message)
    assert session_log.rooms(2) == {1: RoomStatus(found="Pink can"), 2: RoomStatus(found="Blue box")}
    assert session_log.rooms(4)[2] == RoomStatus("reserved", 0, "Blue box")
    assert session_log.rooms(6)[2] == RoomStatus("visited", 0, "Blue box")
    assert session_log.rooms(6)[1].state == "reserved"
    assert session_log.rooms(8)[1] == RoomStatus(found="Pink can")
    assert session_log.rooms(9) == {}


def test_what_the_participant_said_of_a_treasure_is_told_with_its_room_and_its_points() -> None:
    session_log = SessionLog()
    for message in (
        event(1, "started"),
        event(2, "hidden", treasures=[{"name": "beer_bottle"}, {"name": "Blue box"}, {"name": "Pink can"}]),
        event(3, "arrived", 0, 1),
        event(4, "identified", 0, 1, name="pink_can", points=-20),
        event(5, "left", None, 2),
        event(6, "identified", None, 3, name=None, points=30),
        event(7, "departed", 1, 1),
        event(8, kind_of(TreasureTakenUp), None, 2),
    ):
        session_log.take(message)
    assert session_log.rooms(3)[1] == RoomStatus("visited", 0, "beer bottle")
    assert session_log.rooms(4)[1] == RoomStatus("lost", 0, "beer bottle", "−20 for pink can", ("−20",))
    assert session_log.rooms(7)[1] == RoomStatus("reserved", 1, "beer bottle", "−20 for pink can", ("−20",))
    assert session_log.rooms(7)[2] == RoomStatus(found="Blue box", answer="left unnamed")
    assert session_log.rooms(8)[2] == RoomStatus(found="Blue box")
    assert session_log.rooms(8)[3].answer == "+30"


def test_an_event_is_told_with_who_where_and_what() -> None:
    session_log = SessionLog()
    session_log.take(event(7, "failed", 1, 4, reason="No way there.", refund=12.5))
    (entry,) = session_log.entries("event")
    assert (entry.what, entry.who, entry.robot, entry.room) == ("failed", "robot 2", 1, 4)
    assert entry.text == "reason No way there, refund 12.5"
    assert entry.important


def test_rooms_are_named_where_the_messages_name_them() -> None:
    session_log = SessionLog()
    labels = pack.room_labels(0, "map", [pack.RoomLabel(3, "Kitchen", 0.5, 2.0)])
    session_log.take(StampedMessage(names.ROOMS, types.MARKER_ARRAY, 0, labels))
    assert session_log.room_names.titled(3) == "room 3 (Kitchen)"
    assert not any(session_log.entries(kind) for kind in get_args(EntryKind))


def test_ways_made_last_from_the_diagnostics_that_tell_them_to_those_that_do_not() -> None:
    session_log = SessionLog()
    for second, values in ((1, {}), (2, {"makes way for": "robot1"}), (3, {"makes way for": "robot1"}), (5, {})):
        status = DiagnosticStatus(DiagnosticLevel.OK, "robot2: navigation", "drives", "robot2", values)
        data = pack.diagnostic_array(0, [status])
        session_log.take(StampedMessage(names.DIAGNOSTICS, types.DIAGNOSTIC_ARRAY, second * 10**9, data))
    assert session_log.ways_made.of("robot2", 9.0) == (WayMade(2.0, 5.0, "robot1"),)
    assert session_log.ways_made.changes == 2


def test_that_the_participant_asks_for_a_robot_is_said_in_words() -> None:
    session_log = SessionLog()
    session_log.take(event(7, kind_of(HandbackRequested), 1))
    (entry,) = session_log.entries("event")
    assert (entry.who, entry.what, entry.important) == ("robot 2", "asked back", True)
    assert entry.text == "the participant asks for it"


def test_people_read_names_as_words_and_no_file_of_a_picture() -> None:
    session_log = SessionLog()
    session_log.take(event(7, kind_of(TreasurePictured), 1, 3, image="beer_bottle.jpg", cost=5.0))
    session_log.take(event(8, kind_of(TreasureIdentified), 1, 3, name="beer_bottle", points=-20, cost=1.0))
    session_log.take(event(9, kind_of(GameEnded), reason="all-visited", score=-20))
    assert [entry.text for entry in session_log.entries("event")] == [
        "cost 5",
        "name beer bottle, points -20, cost 1",
        "reason every room is visited, score -20",
    ]


def test_who_commands_a_robot_at_a_time() -> None:
    session_log = SessionLog()
    for message in (
        event(1, "started"),
        event(2, "commanded", 0, by="ground station", name="ground station 255"),
        event(3, "commanded", 1, by="researcher", name="/rviz"),
        event(4, "commanded", 1, by="participant", name=""),
        event(5, "started"),
    ):
        session_log.take(message)
    assert session_log.commanders(1) == {}
    assert session_log.commanders(3) == {0: "ground station 255", 1: "researcher /rviz"}
    assert session_log.commanders(4) == {0: "ground station 255"}
    assert session_log.commanders(5) == {}
    assert all(entry.important for entry in session_log.entries("event"))


def test_seats_are_commanders() -> None:
    session_log = SessionLog()
    seats = [{"name": "driver", "label": "the driver", "robots": [0]}, {"name": "scout", "label": "s", "robots": [1]}]
    for message in (
        event(1, "started", seats=seats),
        event(2, "commanded", 0, by="ground station", name="ground station 255"),
        event(3, "commanded", 0, by="participant", name="scout"),
    ):
        session_log.take(message)
    assert session_log.commanders(1) == {0: "driver", 1: "scout"}
    assert session_log.commanders(2) == {0: "ground station 255", 1: "scout"}
    assert session_log.commanders(3) == {0: "scout", 1: "scout"}


def test_grave_lines_of_the_log_are_important() -> None:
    session_log = SessionLog()
    for level in LogLevel:
        session_log.take(log(int(level), level, "something"))
    assert [entry.what for entry in session_log.entries("log") if entry.important] == ["error", "fatal"]


def test_what_cannot_be_read_is_left_out() -> None:
    session_log = SessionLog()
    session_log.take(StampedMessage(names.GAME_EVENTS, types.GAME_EVENT, 1, b"\0"))
    session_log.take(StampedMessage("/odom", types.ODOMETRY, 1, b""))
    assert [len(session_log.entries(kind)) for kind in ("event", "said", "line", "input", "log")] == [0] * 5


def test_long_lists_lose_what_is_oldest() -> None:
    session_log = SessionLog()
    line = log(0, LogLevel.INFO, "again")
    for second in range(MAX_ENTRIES + 1):
        session_log.take(StampedMessage(line.topic, line.msgtype, second, line.data))
    assert len(session_log.entries("log")) <= MAX_ENTRIES
    assert session_log.dropped("log") + len(session_log.entries("log")) == MAX_ENTRIES + 1
    assert session_log.entries("log")[-1].stamp_ns == MAX_ENTRIES


def test_what_an_event_leaves_empty_is_not_told() -> None:
    session_log = SessionLog()
    session_log.take(event(4, "commanded", 1, by="participant", name=""))
    assert [entry.text for entry in session_log.entries("event")] == ["by participant"]
