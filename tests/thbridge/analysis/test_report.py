import math
from dataclasses import replace

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Battery
from tests.support.bags.drawn_team import LEG, MOUNT, SCAN_PERIOD, SESSION, arena, snapshots
from tests.thbridge.analysis.reported_drive import Recorded, recorded, session
from thbridge.analysis.report.builder import read_games, read_report
from thbridge.analysis.report.paths import pieces
from thbridge.analysis.report.report import Report
from thbridge.hunt.codec import to_json
from thbridge.hunt.events import MoveFailed
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.ros.messages import pack, types
from thbridge.ros.messages.pack import Transform
from thbridge.ros.messages.session_records import GameEvent
from thbridge.ros.publisher import TeamPublisher


@pytest.fixture(scope="module")
def report() -> Report:
    return session(2, 400)


def test_things_are_drawn_where_they_were_first_and_where_they_walked() -> None:
    square = np.array([[0.1, 0.1], [-0.1, 0.1], [-0.1, -0.1], [0.1, -0.1]])
    said = [
        pack.outlines(second, "map", [("crate", square), ("walker", square + np.array([0.5 * second, 1.0]))])
        for second in range(3)
    ]
    report = read_report(recorded("/things", types.MARKER_ARRAY, second, data) for second, data in enumerate(said))
    crate, walker = report.things
    assert (crate.name, crate.path.tolist()) == ("crate", [[0.0, 0.0]])
    assert crate.outline.tolist() == [*square.tolist(), square[0].tolist()]
    assert walker.path == pytest.approx(np.array([[0.0, 1.0], [0.5, 1.0], [1.0, 1.0]]))


def odometry(second: float, topic: str, frame: str, pose: Pose2) -> Recorded:
    data = pack.odometry(0, frame, "base_link", pose, STANDSTILL)
    return recorded(topic, types.ODOMETRY, second, data)


def test_everything_of_our_own_session_is_found(report: Report) -> None:
    assert report.missing == ()
    assert report.session == SESSION
    assert report.grid == arena()
    assert report.duration == pytest.approx(399 / 50)
    assert [track.name for track in report.tracks] == ["robot1", "robot2"]


def test_the_error_is_that_of_the_belief_against_the_truth(report: Report) -> None:
    # The drawn team believes itself 3 cm ahead, up to 4 cm aside, and turned by 0.02 rad.
    errors = report.tracks[1].errors
    ticks = np.arange(400)
    assert errors[:, 1] == pytest.approx(np.hypot(0.03, 0.04 * np.sin(ticks / 100 + 1)), abs=1e-4)
    assert errors[:, 2] == pytest.approx(0.02, abs=1e-6)


def test_distance_energy_and_legs(report: Report) -> None:
    track = report.tracks[0]
    # Three legs of 2 s at 0.5 m/s; the bag ends a tick before the third.
    assert track.distance == pytest.approx(0.5 * (3 * LEG - 1) / 50, rel=1e-4)
    assert track.energy[0].tolist() == [0.0, 100.0]
    assert track.energy[-1] == pytest.approx([7.0, 97.2], abs=1e-5)
    assert [leg.outcome for leg in track.attempts] == ["arrived", "no path", "under way"]
    assert (track.attempts[1].start, track.attempts[1].end) == pytest.approx((3.0, 5.0))
    assert track.attempts[1].reason == "the goal is inside a wall"


def test_a_goal_without_end_is_under_way() -> None:
    (track,) = session(1, LEG // 2).tracks
    assert [(leg.outcome, leg.end) for leg in track.attempts] == [("under way", pytest.approx((LEG // 2 - 1) / 50))]


def test_the_names_of_rooms_are_those_in_the_bag_in_every_game() -> None:
    labels = pack.room_labels(0, "map", [pack.RoomLabel(1, "Kitchen", 0.5, 2.0), pack.RoomLabel(2, "Room 2", 3.0, 2.0)])
    games = [
        recorded("/hunt/events", types.GAME_EVENT, second, pack.game_event(0, GameEvent("started", None, None, text)))
        for second, text in ((1, '{"game": 1}'), (2, '{"game": 2}'))
    ]
    reports = read_games([recorded("/hunt/rooms", types.MARKER_ARRAY, 0, labels), *games])
    assert [report.rooms for report in reports] == [RoomNames({1: "Kitchen"})] * 2


def test_ways_made_last_from_their_beginning_to_their_end_or_the_robots() -> None:
    publisher = TeamPublisher(2, MOUNT, SCAN_PERIOD)
    messages = []
    for snapshot in snapshots(2, 300):
        tick = snapshot.tick
        first = 1 if 60 <= tick < 110 or 130 <= tick < 150 or tick >= 290 else None
        navigation = replace(snapshot.robots[0].navigation, makes_way_for=first)
        robots = (replace(snapshot.robots[0], navigation=navigation), snapshot.robots[1])
        dead = frozenset({0}) if 140 <= tick < 160 else frozenset()
        messages += publisher.tick(replace(snapshot, robots=robots, dead=dead))
    report = read_report(recorded(m.topic.name, m.topic.msgtype, m.stamp_ns / 1e9, m.data) for m in messages)
    assert [(made.start, made.end, made.robot) for made in report.tracks[0].ways_made] == [
        (pytest.approx(1.2), pytest.approx(2.2), "robot2"),
        (pytest.approx(2.6), pytest.approx(2.8), "robot2"),
        (pytest.approx(5.8), pytest.approx(report.duration), "robot2"),
    ]
    assert not report.tracks[1].ways_made


def test_moments_are_for_people(report: Report) -> None:
    arrived, identified, ended, said = report.timeline[:4]
    assert (arrived.kind, arrived.who, arrived.room, arrived.text) == ("arrived", "robot 1", 1, "")
    assert (identified.text, identified.points) == ("name Blue <Bottle>", -20)
    assert (ended.who, ended.room, ended.text) == ("", None, "reason every room is visited")
    assert (said.kind, said.who, said.text) == ("said", "robot 1", "It will cost me £1 to go there")
    assert report.score is not None
    assert report.score.visited == 8
    assert report.inputs == 8


def test_ten_robots_come_in_the_order_of_their_numbers() -> None:
    tracks = session(11, 2).tracks
    assert [track.name for track in tracks][-3:] == ["robot9", "robot10", "robot11"]
    assert [track.label for track in tracks][-3:] == ["robot 9", "robot 10", "robot 11"]


def test_a_foreign_bag_of_one_robot_without_namespace() -> None:
    # A mobile base with amcl, as navigation's tutorials have it: odometry, an old tf with slashes, no truth.
    tf = pack.transforms(0, [Transform("/map", "/odom", Pose2(1.0, 2.0, math.pi / 2))])
    first = recorded("/tf", types.TFMESSAGE, 10.0, tf)
    foreign = [
        Recorded("/tf", "tf/tfMessage", first.stamp_ns, tf, first.md5),
        odometry(10.0, "/odom", "odom", Pose2(0.0, 0.0, 0.0)),
        odometry(11.0, "/odom", "odom", Pose2(2.0, 0.0, 0.0)),
    ]
    report = read_report(foreign)
    (track,) = report.tracks
    assert track.name == "robot"
    assert track.estimate[:, :3] == pytest.approx(np.array([[0.0, 1.0, 2.0], [1.0, 1.0, 4.0]]))
    assert track.distance == pytest.approx(2.0)
    assert not len(track.errors)
    told = " ".join(report.missing)
    for word in ("map", "true path of robot", "energy of robot", "events", "score"):
        assert word in told


def test_amcl_pose_serves_where_tf_says_nothing() -> None:
    pose = pack.pose_with_covariance(0, "map", Pose2(1.0, 0.0, 0.0), np.eye(3))
    bag = [
        odometry(0.0, "/r/base_pose_ground_truth", "map", Pose2(0.0, 0.0, 0.0)),
        recorded("/r/amcl_pose", types.POSE_WITH_COVARIANCE, 0.5, pose),
        odometry(1.0, "/r/base_pose_ground_truth", "map", Pose2(1.0, 0.0, 0.2)),
    ]
    (track,) = read_report(bag).tracks
    assert track.errors == pytest.approx(np.array([[0.5, 0.5, 0.1]]))


def test_a_battery_that_knows_only_its_share_is_told_in_percent() -> None:
    data = bytearray(pack.battery_state(Battery(0, 30.0, 60.0), ""))
    data[28:32] = np.float32(math.nan).tobytes()
    (track,) = read_report([recorded("/r/battery", types.BATTERY_STATE, 0.0, bytes(data))]).tracks
    assert track.energy.tolist() == [[0.0, 50.0]]


def test_types_of_another_release_and_broken_messages_are_left_out_and_told() -> None:
    good = odometry(0.0, "/a/odom", "odom", Pose2(0.0, 0.0, 0.0))
    report = read_report(
        [
            Recorded("/b/odom", good.msgtype, 0, good.data, "0" * 32),
            Recorded("/c/odom", good.msgtype, 0, good.data[:30], good.md5),
            good,
        ]
    )
    assert [track.name for track in report.tracks] == ["a"]
    assert any("/b/odom" in sentence and "another version" in sentence for sentence in report.missing)
    assert any("/c/odom" in sentence for sentence in report.missing)


def test_a_bag_of_nothing_is_a_report_of_what_is_missing() -> None:
    report = read_report([])
    assert (report.duration, report.tracks, report.timeline) == (0.0, (), ())
    assert len(report.missing) == 4


def test_why_a_robot_did_not_get_there_is_told_in_words() -> None:
    failed = MoveFailed(1, Room(3), "Robot 2 is stuck and cannot get free.", 27.76007947445022, Room(0))
    data = pack.game_event(0, GameEvent("failed", 1, 3, to_json(failed)))
    (moment,) = read_report([recorded("/hunt/events", types.GAME_EVENT, 1.0, data)]).timeline
    assert (moment.who, moment.room) == ("robot 2", 3)
    assert moment.text == "reason Robot 2 is stuck and cannot get free, refund 27.7601, at 0"


def test_a_path_goes_on_elsewhere_where_its_robot_was_carried_and_where_it_was_found() -> None:
    messages = []
    for second in range(6):
        there = Pose2(0.5 * second, 0.0 if second < 3 else 7.0, 0.0)
        truth = pack.odometry(0, "map", "robot1/base_link", there, STANDSTILL)
        driven = pack.odometry(0, "robot1/odom", "robot1/base_link", Pose2(0.5 * second, 0.0, 0.0), STANDSTILL)
        correction = Pose2(0.0, 0.0 if second < 5 else 7.0, 0.0)
        frames = pack.transforms(0, [Transform("map", "robot1/odom", correction)])
        messages.append(recorded("/robot1/base_pose_ground_truth", types.ODOMETRY, second, truth))
        messages.append(recorded("/tf", types.TFMESSAGE, second, frames))
        messages.append(recorded("/robot1/odom", types.ODOMETRY, second, driven))
    event = pack.game_event(0, GameEvent("carried", 0, None, '{"event": "carried", "robot": 0}'))
    (track,) = read_report([*messages, recorded("/hunt/events", types.GAME_EVENT, 3.0, event)]).tracks
    assert [piece[:, 0].tolist() for piece in pieces(track.truth, track.carried)] == [[0, 1, 2], [3, 4, 5]]
    assert [piece[:, 0].tolist() for piece in pieces(track.estimate, track.relocated)] == [[0, 1, 2, 3, 4], [5]]
    assert track.distance == pytest.approx(2.0)
