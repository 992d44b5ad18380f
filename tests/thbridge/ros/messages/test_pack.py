"""Every packer against rosbags' serializer: the same bytes, and the values come back."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys.msg import normalize_msgtype

from sim.common.geometry import Pose2
from sim.common.observations import Battery, Scan, Twist
from sim.numerics import elementary
from sim.robot.costmap.view import CostmapView
from tests.support.bags.drawn_team import MOUNT, SESSION, arena
from thbridge.ros.messages import pack, types, unpack
from thbridge.ros.messages.goal_status import GoalId, GoalStatus, GoalStatusCode
from thbridge.ros.messages.pack import DiagnosticLevel, DiagnosticStatus, RoomLabel, Transform
from thbridge.ros.messages.records import LogLevel, LogLine
from thbridge.ros.messages.session_records import (
    DialogueMoveRecord,
    DialogueStateRecord,
    GameEvent,
    InputRecord,
    ScoreRecord,
    SeatNotice,
    UtteranceRecord,
)

TICKS = st.integers(0, 50 * 86400)
REALS = st.floats(-1e6, 1e6)
POSES = st.builds(Pose2, REALS, REALS, st.floats(-math.pi, math.pi, exclude_max=True))
TEXTS = st.text(max_size=40)
FRAMES = st.text("abcdefghijklmnop/0123456789_", max_size=30)
POSE = Pose2(1.5, -2.25, 2.5)


def message(msgtype: str, *fields: object) -> object:
    return types.typestore().types[normalize_msgtype(msgtype)](*fields)


def serialised(msgtype: str, value: object) -> bytes:
    return bytes(types.typestore().serialize_ros1(value, normalize_msgtype(msgtype)))


def ros_header(tick: int, frame: str = "") -> object:
    stamp = message("builtin_interfaces/Time", 1 + tick // 50, tick % 50 * 20_000_000)
    return message("std_msgs/Header", tick, stamp, frame)


def ros_pose(pose: Pose2) -> object:
    return message(
        "geometry_msgs/Pose",
        message("geometry_msgs/Point", pose.x, pose.y, 0.0),
        message("geometry_msgs/Quaternion", 0.0, 0.0, elementary.sin(pose.theta / 2), elementary.cos(pose.theta / 2)),
    )


def ros_twist(twist: Twist) -> object:
    return message(
        "geometry_msgs/Twist",
        message("geometry_msgs/Vector3", twist.linear, 0.0, 0.0),
        message("geometry_msgs/Vector3", 0.0, 0.0, twist.angular),
    )


@given(TICKS, FRAMES, FRAMES, POSES, REALS, REALS)
def test_odometry(tick: int, frame: str, child: str, pose: Pose2, linear: float, angular: float) -> None:
    twist = Twist(linear, angular)
    planar = np.array([[1.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 3.0]])
    data = pack.odometry(tick, frame, child, pose, twist, pack.covariance(planar, 1e6))
    full = np.zeros((6, 6))
    full[:2, :2], full[:2, 5], full[5, :2], full[5, 5] = planar[:2, :2], planar[:2, 2], planar[2, :2], planar[2, 2]
    full[2, 2] = full[3, 3] = full[4, 4] = 1e6
    expected = message(
        types.ODOMETRY,
        ros_header(tick, frame),
        child,
        message("geometry_msgs/PoseWithCovariance", ros_pose(pose), full.ravel()),
        message("geometry_msgs/TwistWithCovariance", ros_twist(twist), np.zeros(36)),
    )
    assert data == serialised(types.ODOMETRY, expected)
    read = unpack.odometry(data)
    assert (read.stamp_ns, read.frame, read.child_frame) == (1_000_000_000 + tick * 20_000_000, frame, child)
    assert (read.pose.x, read.pose.y) == (pose.x, pose.y)
    assert math.remainder(read.pose.theta - pose.theta, 2 * math.pi) == pytest.approx(0, abs=1e-9)


@given(st.lists(st.tuples(POSES, REALS, REALS), min_size=1, max_size=4), st.floats(0.0, 1e6))
def test_odometry_of_many_robots_is_that_of_each(robots: list[tuple[Pose2, float, float]], unmeasured: float) -> None:
    covariance = pack.covariance(np.diag([1.0, 2.0, 3.0]), unmeasured)
    rows = pack.OdometryRows(covariance)
    poses, twists = np.array([pose.array() for pose, _, _ in robots]), np.array([twist for _, *twist in robots])
    rows.packed(poses[::-1] + 1.0, twists[::-1] + 1.0)  # nothing of it stays
    for row, (pose, linear, angular) in zip(rows.packed(poses, twists), robots, strict=True):
        alone = pack.odometry(3, "a", "b", pose, Twist(linear, angular), covariance, covariance)
        assert alone == pack.head(3) + pack.frame_names("a", "b") + row


@given(TICKS, st.lists(st.tuples(FRAMES, FRAMES, POSES), max_size=5))
def test_transforms(tick: int, entries: list[tuple[str, str, Pose2]]) -> None:
    data = pack.transforms(tick, [Transform(*entry) for entry in entries])
    stamped = []
    for parent, child, pose in entries:
        moved = message(
            "geometry_msgs/Transform",
            message("geometry_msgs/Vector3", pose.x, pose.y, 0.0),
            message(
                "geometry_msgs/Quaternion", 0.0, 0.0, elementary.sin(pose.theta / 2), elementary.cos(pose.theta / 2)
            ),
        )
        stamped.append(message("geometry_msgs/TransformStamped", ros_header(tick, parent), child, moved))
    assert data == serialised(types.TFMESSAGE, message(types.TFMESSAGE, stamped))
    assert [(t.parent, t.child) for _, t in unpack.transforms(data)] == [entry[:2] for entry in entries]


def test_laser_scan_keeps_infinity_and_nan_and_has_no_intensities() -> None:
    ranges = np.linspace(0.05, 8, MOUNT.beams).astype(np.float32)
    ranges[:2] = np.inf, np.nan
    data = pack.laser_scan(Scan(7, MOUNT, ranges), "robot1/base_laser", 0.1)
    angle_max = MOUNT.angle_min + 180 * MOUNT.angle_increment
    expected = message(
        types.LASER_SCAN,
        ros_header(7, "robot1/base_laser"),
        MOUNT.angle_min,
        angle_max,
        MOUNT.angle_increment,
        0.0,
        0.1,
        MOUNT.range_min,
        MOUNT.range_max,
        ranges,
        np.empty(0, np.float32),
    )
    assert data == serialised(types.LASER_SCAN, expected)


@given(TICKS, st.lists(POSES, max_size=20))
def test_pose_array_and_path(tick: int, poses: list[Pose2]) -> None:
    array = np.array([pose.array() for pose in poses]).reshape(-1, 3)
    cloud = message(types.POSE_ARRAY, ros_header(tick, "map"), [ros_pose(pose) for pose in poses])
    assert_alike(pack.pose_array(tick, "map", array), serialised(types.POSE_ARRAY, cloud), len(poses))
    stamped = [message("geometry_msgs/PoseStamped", ros_header(tick, "map"), ros_pose(pose)) for pose in poses]
    path = message(types.PATH, ros_header(tick, "map"), stamped)
    assert_alike(pack.path(tick, "map", array), serialised(types.PATH, path), len(poses))


def assert_alike(ours: bytes, theirs: bytes, poses: int) -> None:
    """Equal, but for the last bits of quaternions: numpy's sines and libm's may round differently."""
    assert len(ours) == len(theirs)
    row = max(1, (len(ours) - 23) // max(poses, 1))
    assert ours[:23] == theirs[:23]
    for start in range(23, len(ours), row):
        mine, its = ours[start : start + row], theirs[start : start + row]
        assert mine[:-32] == its[:-32]
        assert np.frombuffer(mine[-32:]) == pytest.approx(np.frombuffer(its[-32:]), abs=1e-15)


def test_pose_with_covariance() -> None:
    planar = np.diag([0.25, 0.5, 0.07])
    data = pack.pose_with_covariance(3, "map", POSE, planar)
    full = np.zeros((6, 6))
    full[0, 0], full[1, 1], full[5, 5] = 0.25, 0.5, 0.07
    inner = message("geometry_msgs/PoseWithCovariance", ros_pose(POSE), full.ravel())
    assert data == serialised(
        types.POSE_WITH_COVARIANCE, message(types.POSE_WITH_COVARIANCE, ros_header(3, "map"), inner)
    )
    assert unpack.pose_with_covariance(data).pose.x == POSE.x


def test_map_and_its_meta_data() -> None:
    grid = arena()
    meta = message(
        types.MAP_META_DATA,
        message("builtin_interfaces/Time", 1, 0),
        grid.resolution,
        grid.cols,
        grid.rows,
        ros_pose(grid.origin),
    )
    assert pack.map_meta_data(0, grid) == serialised(types.MAP_META_DATA, meta)
    data = pack.occupancy_grid(0, "map", grid)
    expected = message(types.OCCUPANCY_GRID, ros_header(0, "map"), meta, grid.cells.ravel())
    assert data == serialised(types.OCCUPANCY_GRID, expected)
    assert unpack.occupancy_grid(data) == grid


def test_battery_state() -> None:
    data = pack.battery_state(Battery(50, 62.5, 100.0), "robot2")
    nan = math.nan
    none = np.empty(0, np.float32)
    expected = message(
        types.BATTERY_STATE, ros_header(50), nan, nan, nan, 62.5, 100.0, 100.0, 0.625, 2, 0, 0, True, none, none, "",
        "robot2",
    )  # fmt: skip
    assert data == serialised(types.BATTERY_STATE, expected)
    assert unpack.battery_state(data) == unpack.BatteryCharge(62.5, 0.625)


def test_command_and_string() -> None:
    assert pack.command(Twist(0.5, -1.0)) == serialised(types.TWIST, ros_twist(Twist(0.5, -1.0)))
    assert pack.string("%%goto £") == serialised(types.STRING, message(types.STRING, "%%goto £"))


def test_goal_and_result() -> None:
    goal_id = message("actionlib_msgs/GoalID", message("builtin_interfaces/Time", 1, 20_000_000), "robot1-4")
    target = message("geometry_msgs/PoseStamped", ros_header(1, "map"), ros_pose(POSE))
    goal = message(types.MOVE_BASE_GOAL, ros_header(1), goal_id, message("move_base_msgs/MoveBaseGoal", target))
    data = pack.move_base_goal(1, GoalId("robot1-4", 1_020_000_000), "map", POSE)
    assert data == serialised(types.MOVE_BASE_GOAL, goal)
    assert unpack.move_base_goal(data).pose.theta == pytest.approx(POSE.theta)
    assert (unpack.move_base_goal(data).goal_id, unpack.move_base_goal(data).frame) == ("robot1-4", "map")
    status = message("actionlib_msgs/GoalStatus", goal_id, 4, "no way")
    result = message(types.MOVE_BASE_RESULT, ros_header(9), status, message("move_base_msgs/MoveBaseResult"))
    data = pack.move_base_result(9, GoalStatus(GoalId("robot1-4", 1_020_000_000), GoalStatusCode.ABORTED, "no way"))
    assert data == serialised(types.MOVE_BASE_RESULT, result)
    assert unpack.move_base_result(data) == unpack.MoveBaseResult("robot1-4", 4, "no way")


@given(TICKS, st.lists(st.tuples(TEXTS, st.integers(0, 10**12), st.sampled_from(GoalStatusCode), TEXTS), max_size=4))
def test_status_array(tick: int, rows: list[tuple[str, int, GoalStatusCode, str]]) -> None:
    entries = [GoalStatus(GoalId(goal_id, stamp_ns), status, text) for goal_id, stamp_ns, status, text in rows]
    data = pack.goal_status_array(tick, entries)
    expected = message(types.GOAL_STATUS_ARRAY, ros_header(tick), [ros_status(entry) for entry in entries])
    assert data == serialised(types.GOAL_STATUS_ARRAY, expected)
    assert unpack.goal_status_array(data) == entries


def ros_status(entry: GoalStatus) -> object:
    time = message("builtin_interfaces/Time", *divmod(entry.goal.stamp_ns, 1_000_000_000))
    return message(
        "actionlib_msgs/GoalStatus", message("actionlib_msgs/GoalID", time, entry.goal.id), entry.status, entry.text
    )


def test_feedback_and_cancel() -> None:
    entry = GoalStatus(GoalId("robot1-4", 1_020_000_000), GoalStatusCode.ACTIVE, "under way")
    base = message("geometry_msgs/PoseStamped", ros_header(7, "map"), ros_pose(POSE))
    feedback = message("move_base_msgs/MoveBaseFeedback", base)
    data = pack.move_base_feedback(7, entry, pack.pose_stamped(7, "map", POSE))
    assert data == serialised(
        types.MOVE_BASE_FEEDBACK, message(types.MOVE_BASE_FEEDBACK, ros_header(7), ros_status(entry), feedback)
    )
    status, frame, pose = unpack.move_base_feedback(data)
    assert (status, frame, pose.x, pose.y) == (entry, "map", POSE.x, POSE.y)
    data = pack.goal_id(entry.goal)
    time = message("builtin_interfaces/Time", 1, 20_000_000)
    assert data == serialised(types.GOAL_ID, message(types.GOAL_ID, time, "robot1-4"))
    assert unpack.goal_id(data) == entry.goal


def test_pose_stamped_and_polygon() -> None:
    expected = message(types.POSE_STAMPED, ros_header(2, "map"), ros_pose(POSE))
    assert pack.pose_stamped(2, "map", POSE) == serialised(types.POSE_STAMPED, expected)
    corners = [message("geometry_msgs/Point32", 0.5, -0.25, 0.0), message("geometry_msgs/Point32", 1.0, 2.0, 0.0)]
    polygon = message(types.POLYGON_STAMPED, ros_header(2, "map"), message("geometry_msgs/Polygon", corners))
    data = pack.polygon(2, "map", np.array([[0.5, -0.25], [1.0, 2.0]]))
    assert data == serialised(types.POLYGON_STAMPED, polygon)


@given(TICKS, TEXTS, TEXTS, st.sampled_from(LogLevel))
def test_log_and_clock(tick: int, name: str, text: str, level: LogLevel) -> None:
    data = pack.log(tick, LogLine(level, name, text))
    assert data == serialised(types.LOG, message(types.LOG, ros_header(tick), level, name, text, "", "", 0, []))
    time = message("builtin_interfaces/Time", 1 + tick // 50, tick % 50 * 20_000_000)
    assert pack.clock(tick) == serialised(types.CLOCK, message(types.CLOCK, time))


def test_diagnostics() -> None:
    entry = DiagnosticStatus(
        DiagnosticLevel.WARN, "robot1: energy", "little left", "robot1", {"charge": "9.5", "unit": "£"}
    )
    values = [message("diagnostic_msgs/KeyValue", key, value) for key, value in entry.values.items()]
    status = message("diagnostic_msgs/DiagnosticStatus", 1, entry.name, entry.message, entry.hardware_id, values)
    expected = message(types.DIAGNOSTIC_ARRAY, ros_header(50), [status])
    assert pack.diagnostic_array(50, [entry]) == serialised(types.DIAGNOSTIC_ARRAY, expected)


@given(TICKS, st.dictionaries(st.integers(1, 999), TEXTS, max_size=4))
def test_room_labels(tick: int, names: dict[int, str]) -> None:
    data = pack.room_labels(tick, "map", [RoomLabel(room, name, 1.5, -2.0) for room, name in names.items()])
    place = message(
        "geometry_msgs/Pose",
        message("geometry_msgs/Point", 1.5, -2.0, 0.0),
        message("geometry_msgs/Quaternion", 0.0, 0.0, 0.0, 1.0),
    )
    scale, colour = (
        message("geometry_msgs/Vector3", 0.0, 0.0, 0.5),
        message("std_msgs/ColorRGBA", *(float(np.float32(shade)) for shade in (0.2, 0.2, 0.2, 1.0))),
    )
    for_ever = message("builtin_interfaces/Duration", 0, 0)
    markers = [
        message(
            "visualization_msgs/Marker",
            *(ros_header(tick, "map"), "rooms", room, 9, 0, place, scale, colour, for_ever, False, [], [], name),
            *("", False),
        )
        for room, name in names.items()
    ]
    assert data == serialised(types.MARKER_ARRAY, message(types.MARKER_ARRAY, markers))
    assert unpack.room_labels(data) == names
    assert unpack.outlines(data) == []


def test_a_costmap_is_translated_as_costmap_2d_does_it() -> None:
    costs = np.arange(256, dtype=np.uint8).reshape(16, 16)
    data = pack.costmap("map", CostmapView(50, POSE, 0.05, costs))
    cells = unpack.occupancy_grid(data).cells.ravel().tolist()
    assert (cells[0], cells[253], cells[254], cells[255]) == (0, 99, 100, -1)
    # By costmap_2d's own formula, in whole numbers: 1 + 97 * (cost - 1) / 251.
    assert cells[1:253] == [1 + 97 * (cost - 1) // 251 for cost in range(1, 253)]
    assert (cells[1], cells[252]) == (1, 98)


def test_session() -> None:
    data = pack.session(0, SESSION)
    versions = '{"python": "3.11", "thbridge": "0.1"}'
    expected = message(
        types.SESSION, ros_header(0), SESSION.study, SESSION.seed, versions, "play", ["SimR", "Hider"], "nearest"
    )
    assert data == serialised(types.SESSION, expected)
    assert unpack.session(data) == SESSION


@given(TICKS, TEXTS, st.none() | st.integers(0, 99), st.none() | st.integers(0, 99), TEXTS)
def test_game_event(tick: int, kind: str, robot: int | None, room: int | None, json: str) -> None:
    record = GameEvent(kind, robot, room, json)
    data = pack.game_event(tick, record)
    numbers = (0 if robot is None else robot + 1, -1 if room is None else room)
    assert data == serialised(types.GAME_EVENT, message(types.GAME_EVENT, ros_header(tick), kind, *numbers, json))
    assert unpack.game_event(data) == record


@given(TICKS, st.integers(-1000, 1000), st.lists(REALS, max_size=10))
def test_score(tick: int, points: int, energy: list[float]) -> None:
    record = ScoreRecord(points, 3, 8, tuple(energy))
    data = pack.score(tick, record)
    expected = message(types.SCORE, ros_header(tick), points, 3, 8, np.array(energy, dtype=np.float64))
    assert data == serialised(types.SCORE, expected)
    assert unpack.score(data) == record


@given(TICKS, st.integers(-(2**63), 2**63 - 1), TEXTS, TEXTS, st.none() | st.integers(0, 99))
def test_utterance(tick: int, dialogue: int, speaker: str, text: str, room: int | None) -> None:
    record = UtteranceRecord(dialogue, speaker, 2, room, "select-room", text, "continue", "wizard")
    data = pack.utterance(tick, record)
    fields = (dialogue, speaker, 3, -1 if room is None else room, "select-room", text, "continue", "wizard")
    assert data == serialised(types.UTTERANCE, message(types.UTTERANCE, ros_header(tick), *fields))
    assert unpack.utterance(data) == record


DIALOGUE_MOVES = st.builds(
    DialogueMoveRecord,
    talk=st.integers(-(2**63), 2**63 - 1),
    dialogue=st.integers(0, 2**31 - 1),
    parent=st.none() | st.integers(1, 2**31 - 1),
    index=st.integers(0, 2**31 - 1),
    robot=st.integers(0, 99),
    is_booked=st.booleans(),
    **dict.fromkeys(
        ("speaker", "author", "game", "locution", "content", "before", "after", "text", "heard", "fault"), TEXTS
    ),
)


@given(TICKS, DIALOGUE_MOVES)
def test_dialogue_move(tick: int, record: DialogueMoveRecord) -> None:
    data = pack.dialogue_move(tick, record)
    numbers = (record.talk, record.dialogue, record.parent or 0, record.index, record.robot + 1)
    words = (record.speaker, record.author, record.game, record.locution, record.content, record.before, record.after)
    fields = (*numbers, *words, record.is_booked, record.text, record.heard, record.fault)
    assert data == serialised(types.DIALOGUE_MOVE, message(types.DIALOGUE_MOVE, ros_header(tick), *fields))
    assert unpack.dialogue_move(data) == record


@given(TICKS, st.integers(-(2**63), 2**63 - 1), st.integers(0, 99), TEXTS)
def test_dialogue_state(tick: int, talk: int, robot: int, json: str) -> None:
    data = pack.dialogue_state(tick, DialogueStateRecord(talk, robot, json))
    expected = message(types.DIALOGUE_STATE, ros_header(tick), talk, robot + 1, json)
    assert data == serialised(types.DIALOGUE_STATE, expected)
    assert unpack.dialogue_state(data) == DialogueStateRecord(talk, robot, json)


@given(TICKS, TEXTS, TEXTS, TEXTS)
def test_outside_input(tick: int, sender: str, line: str, json: str) -> None:
    record = InputRecord("received", sender, line, json)
    data = pack.outside_input(tick, record)
    assert data == serialised(types.INPUT, message(types.INPUT, ros_header(tick), "received", sender, line, json))
    assert unpack.outside_input(data) == record


@given(TICKS, TEXTS, TEXTS, TEXTS)
def test_seat_notice(tick: int, seat: str, kind: str, json: str) -> None:
    record = SeatNotice(seat, kind, json)
    data = pack.seat_notice(tick, record)
    assert data == serialised(types.SEAT_NOTICE, message(types.SEAT_NOTICE, ros_header(tick), seat, kind, json))
    assert unpack.seat_notice(data) == record


@given(st.data())
def test_cut_messages_are_value_errors(data: st.DataObject) -> None:
    samples = {
        unpack.odometry: pack.odometry(1, "odom", "base", POSE, Twist(1, 2)),
        unpack.transforms: pack.transforms(1, [Transform("a", "b", POSE)]),
        unpack.occupancy_grid: pack.occupancy_grid(0, "map", arena()),
        unpack.battery_state: pack.battery_state(Battery(1, 2.0, 3.0), "x"),
        unpack.session: pack.session(0, SESSION),
        unpack.score: pack.score(1, ScoreRecord(1, 2, 3, (4.0,))),
        unpack.utterance: pack.utterance(1, UtteranceRecord(1, "robot", 0, 1, "s", "t", "m", "robot")),
        unpack.dialogue_move: pack.dialogue_move(1, DialogueMoveRecord(1, 2, None, 0, 0, *"abcdefg", True, "h", "i")),
        unpack.seat_notice: pack.seat_notice(1, SeatNotice("driver", "View", "{}")),
        unpack.dialogue_state: pack.dialogue_state(1, DialogueStateRecord(1, 0, "{}")),
    }
    read = data.draw(st.sampled_from(list(samples)))
    sample = samples[read]
    needed = 40 if read is not unpack.session else len(sample) - 1
    with pytest.raises(ValueError):
        read(sample[: data.draw(st.integers(0, min(needed, len(sample) - 1)))])


@given(TICKS, FRAMES, st.lists(st.tuples(TEXTS, st.lists(st.tuples(REALS, REALS), min_size=3, max_size=9)), max_size=4))
def test_outlines(tick: int, frame: str, bodies: list[tuple[str, list[tuple[float, float]]]]) -> None:
    data = pack.outlines(tick, frame, [(name, np.array(corners)) for name, corners in bodies])

    def marker(action: int, number: int, name: str, line: list[tuple[float, float]]) -> object:
        return message(
            "visualization_msgs/Marker",
            ros_header(tick, frame),
            name,
            number,
            4,
            action,
            ros_pose(Pose2(0.0, 0.0, 0.0)),
            message("geometry_msgs/Vector3", 0.05, 0.0, 0.0),
            message("std_msgs/ColorRGBA", np.float32(0.9), np.float32(0.4), 0.0, 1.0),
            message("builtin_interfaces/Duration", 0, 0),
            False,
            [message("geometry_msgs/Point", x, y, 0.0) for x, y in line],
            [],
            name,
            "",
            False,
        )

    outlines = [marker(0, i, name, [*corners, corners[0]]) for i, (name, corners) in enumerate(bodies)]
    array = message("visualization_msgs/MarkerArray", [marker(3, 0, "", []), *outlines])
    assert data == serialised("visualization_msgs/MarkerArray", array)
