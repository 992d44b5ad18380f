import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import Battery, Twist
from sim.common.robot_numbers import namespace_of
from sim.inputs import KillRobot, ReviveRobot, SendGoal, SetCharge
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.costmap.view import CostmapView, ShownCostmap
from sim.robot.navigator.goals import Cancelled, Goal
from sim.robot.software import PropagatedOutput, RobotOutput
from sim.snapshot import TeamSnapshot
from sim.team import Team
from sim.world.thing import Thing
from sim.world.things import ThingState, polygons_of
from tests.support.bags.drawn_team import LEG, MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.files.map_files import read_map
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.goal_status import GoalStatusCode
from thbridge.ros.messages.pack import RoomLabel
from thbridge.ros.messages.records import CancelRequest, GoalRequest, SimpleGoal, VelocityCommand
from thbridge.ros.messages.types import plain_definition, typestore
from thbridge.ros.names import RobotNames
from thbridge.ros.publisher import Planners, RosMessage, TeamPublisher, Topic, clock_message

ARENA = read_map(Path(__file__).parents[3] / "maps" / "arena8")


def published(robots: int, ticks: int) -> list[RosMessage]:
    publisher = TeamPublisher(robots, MOUNT, SCAN_PERIOD)
    messages = publisher.opening(0, SESSION, arena())
    for snapshot in snapshots(robots, ticks):
        messages += publisher.tick(snapshot, records(snapshot.tick))
    return messages


def test_robots_count_from_one_and_frames_have_no_leading_slash() -> None:
    robot = RobotNames.of(0)
    assert robot.topic("scan") == "/robot1/scan"
    assert (robot.odom, robot.base_footprint) == ("robot1/odom", "robot1/base_footprint")
    assert (robot.base_link, robot.base_laser) == ("robot1/base_link", "robot1/base_laser")


def test_opening_says_the_session_first_and_latches_everything() -> None:
    opening = TeamPublisher(2, MOUNT, SCAN_PERIOD).opening(0, SESSION, arena())
    assert [message.topic.name for message in opening] == ["/thbridge/session", "/tf_static", "/map", "/map_metadata"]
    assert all(message.topic.latched for message in opening)
    assert all(message.stamp_ns == 1_000_000_000 for message in opening)


def test_the_opening_names_the_rooms_where_they_are_known() -> None:
    rooms = (RoomLabel(1, "Kitchen", 0.5, 2.0), RoomLabel(2, "Room 2", 3.0, 2.0))
    labels = TeamPublisher(1, MOUNT, SCAN_PERIOD, rooms=rooms).opening(0, SESSION, arena())[-1]
    assert (labels.topic.name, labels.topic.latched) == ("/hunt/rooms", True)
    assert unpack.room_labels(labels.data) == {1: "Kitchen", 2: "Room 2"}


def test_one_static_message_leads_from_every_base_to_its_laser() -> None:
    static = TeamPublisher(2, MOUNT, SCAN_PERIOD).opening(0, SESSION, arena())[1]
    frames = [(transform.parent, transform.child) for _, transform in unpack.transforms(static.data)]
    assert frames == [
        ("robot1/base_footprint", "robot1/base_link"),
        ("robot1/base_link", "robot1/base_laser"),
        ("robot2/base_footprint", "robot2/base_link"),
        ("robot2/base_link", "robot2/base_laser"),
    ]


def test_rates() -> None:
    per_topic = Counter(message.topic.name for message in published(2, 500))
    assert per_topic["/tf"] == 500
    for robot in ("/robot1", "/robot2"):
        assert per_topic[f"{robot}/odom"] == per_topic[f"{robot}/base_pose_ground_truth"] == 500
        assert per_topic[f"{robot}/scan"] == 100
        assert per_topic[f"{robot}/battery"] == 10
        assert per_topic[f"{robot}/amcl_pose"] == per_topic[f"{robot}/particlecloud"] == 17


def test_a_change_of_energy_is_said_at_once() -> None:
    publisher = TeamPublisher(1, MOUNT, SCAN_PERIOD)
    said = [message.topic.name for snapshot in snapshots(1, 2, first=51) for message in publisher.tick(snapshot)]
    assert said.count("/robot1/battery") == 1


def test_every_message_has_a_known_type_and_stamps_never_go_back() -> None:
    messages = published(2, 200)
    stamps = [message.stamp_ns for message in messages]
    assert stamps == sorted(stamps)
    for topic in {message.topic for message in messages}:
        assert re.fullmatch("[0-9a-f]{32}", plain_definition(topic.msgtype).md5)


def test_tf_composes_to_the_estimate() -> None:
    (snapshot,) = snapshots(1, 1, first=77)
    tf = TeamPublisher(1, MOUNT, SCAN_PERIOD).tick(snapshot)[0]
    (_, odom), (_, base) = unpack.transforms(tf.data)
    assert (odom.parent, odom.child, base.parent, base.child) == (
        "map",
        "robot1/odom",
        "robot1/odom",
        "robot1/base_footprint",
    )
    estimate = snapshot.robots[0].estimate.base_in_map
    assert odom.pose.compose(base.pose).distance(estimate) < 1e-9


def test_a_command_is_said_when_it_changes_and_ten_times_a_second_while_driving() -> None:
    commands = [message for message in published(1, 3 * LEG // 2) if message.topic.name == "/robot1/cmd_vel"]
    # 20 in the leg of 100 ticks, then once that the robot stands.
    assert len(commands) == LEG // 5 + 1
    assert commands[-1].data == bytes(48)


def test_goals_and_results_come_in_pairs() -> None:
    names = [message.topic.name for message in published(1, 3 * LEG)]
    kinds = [
        name.rpartition("/")[2] for name in names if name in {"/robot1/move_base/goal", "/robot1/move_base/result"}
    ]
    assert kinds == ["goal", "result", "goal", "result"]


def test_a_goal_that_another_replaces_ends_before_the_other_begins() -> None:
    first, second = snapshots(1, 2)
    publisher = TeamPublisher(1, MOUNT, SCAN_PERIOD)
    publisher.tick(first)
    old = first.robots[0].navigation.goal
    assert old is not None
    navigation = replace(second.robots[0].navigation, goal=Goal(99, Pose2(1.0, 1.0, 0.0)), result=Cancelled(old))
    said = publisher.tick(_with(second, navigation=navigation))
    kinds = [m.topic.name.rpartition("/")[2] for m in said if "move_base/" in m.topic.name]
    assert [kind for kind in kinds if kind != "status"] == ["result", "goal"]


def test_a_plan_is_said_when_new_and_when_gone_but_not_as_it_is_driven() -> None:
    plans = [m for m in published(1, 2 * LEG) if m.topic.name.endswith("/plan")]
    assert len(plans) == 3  # the first leg's, none, the second leg's


def test_plans_are_named_by_the_robots_own_planners() -> None:
    named = [Planners("GlobalPlanner", "DWAPlannerROS"), Planners.of(RobotParameters())]
    topics = {topic.name for topic in TeamPublisher(2, MOUNT, SCAN_PERIOD, named).topics}
    assert {"/robot1/move_base/GlobalPlanner/plan", "/robot1/move_base/DWAPlannerROS/local_plan"} <= topics
    assert {"/robot2/move_base/NavfnROS/plan", "/robot2/move_base/TrajectoryPlannerROS/local_plan"} <= topics


def test_whatever_is_said_is_on_one_of_the_topics_that_were_announced() -> None:
    announced = set(TeamPublisher(2, MOUNT, SCAN_PERIOD).topics)
    assert {message.topic for message in published(2, 200)} <= announced


def test_a_local_plan_is_said_when_it_changes() -> None:
    publisher = TeamPublisher(1, MOUNT, SCAN_PERIOD)
    plan = np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 0.1]])
    said = []
    for snapshot, local_plan in zip(snapshots(1, 4), (plan, plan.copy(), plan[:1], np.empty((0, 3))), strict=True):
        navigation = replace(snapshot.robots[0].navigation, local_plan=local_plan)
        messages = publisher.tick(_with(snapshot, navigation=navigation))
        said.append([unpack.path(m.data).tolist() for m in messages if m.topic.name.endswith("/local_plan")])
    assert [len(paths) for paths in said] == [1, 0, 1, 1]
    assert said[0][0] == pytest.approx(plan)


def test_costmaps_are_said_when_they_are_shown() -> None:
    (snapshot,) = snapshots(1, 1)
    view = CostmapView(0, Pose2(-1.0, -2.0, 0.0), 0.05, np.array([[0, 1, 252], [253, 254, 255]], dtype=np.uint8))
    navigation = replace(snapshot.robots[0].navigation, local_costmap=ShownCostmap(lambda: view))
    messages = TeamPublisher(1, MOUNT, SCAN_PERIOD).tick(_with(snapshot, navigation=navigation))
    (shown,) = [m for m in messages if m.topic.name.endswith("_costmap/costmap")]
    assert shown.topic == Topic("/robot1/move_base/local_costmap/costmap", types.OCCUPANCY_GRID, latched=True)
    grid = unpack.occupancy_grid(shown.data)
    assert grid.cells.tolist() == [[0, 1, 98], [99, 100, -1]]
    assert (grid.resolution, grid.origin) == (0.05, view.origin)


def test_footprints_lie_where_the_robot_believes_it_is() -> None:
    (snapshot,) = snapshots(1, 1)
    square = np.array([[0.2, 0.1], [-0.2, 0.1], [-0.2, -0.1], [0.2, -0.1]])
    robot = snapshot.robots[0]
    snapshot = _with(snapshot, neighbour=replace(robot.neighbour, footprint=square))
    messages = TeamPublisher(1, MOUNT, SCAN_PERIOD).tick(snapshot)
    shown = {m.topic.name: m.data for m in messages if m.topic.name.endswith("/footprint")}
    assert set(shown) == {"/robot1/move_base/global_costmap/footprint", "/robot1/move_base/local_costmap/footprint"}
    (data,) = set(shown.values())
    corners = np.frombuffer(data[-4 * 12 :], dtype="<f4").reshape(4, 3)
    assert corners[:, :2] == pytest.approx(robot.estimate.base_in_map.transform(square), abs=1e-5)


def test_what_clients_said_is_recorded_as_they_said_it_before_what_follows() -> None:
    first, second = snapshots(1, 2, first=LEG)
    publisher = TeamPublisher(1, MOUNT, SCAN_PERIOD)
    publisher.tick(first)
    target = Pose2(1.0, 2.0, 0.5)
    asked = (
        GoalRequest(0, "rviz-1", 5, target, 1000),
        CancelRequest(0, "rviz-1", 0),
        SimpleGoal(0, target, 1001),
        GoalRequest(0, "rviz-2", 0, None, 1002, "it is in another frame"),
        VelocityCommand(0, Twist(0.1, 0.0)),
    )
    messages = publisher.tick(second, asked)
    heard = [message for message in messages if message.foreign]
    assert heard == messages[: len(heard)]
    assert [m.topic.name for m in heard] == [
        "/robot1/move_base/goal",
        "/robot1/move_base/cancel",
        "/robot1/move_base_simple/goal",
    ]
    assert unpack.move_base_goal(heard[0].data).goal_id == "rviz-1"
    assert unpack.goal_id(heard[1].data) == ("rviz-1", 0)
    ended = [unpack.move_base_result(m.data) for m in messages if m.topic.name.endswith("/result")]
    log = b"".join(message.data for message in messages if message.topic.name == "/rosout")
    assert b"a client's goal rviz-1: (1.00, 2.00)" in log
    assert b"goal rviz-2 was given up: it is in another frame" in log
    assert ended[-1] == unpack.MoveBaseResult("rviz-2", GoalStatusCode.ABORTED, "it is in another frame")


def test_robots_that_are_carried_on_say_what_they_would_if_they_had_been_stepped() -> None:
    team = Team(ARENA.grid, WorldParameters(), [RobotParameters()] * 3, ARENA.starts[:3], 1, 100.0)
    inputs = {
        1: [SendGoal(robot, Goal(robot, ARENA.rooms[-1 - robot].goal)) for robot in range(3)],
        60: [KillRobot(2), SetCharge(0, 50.0)],
        90: [ReviveRobot(2)],
    }
    seen, stepped = (TeamPublisher(3, MOUNT, SCAN_PERIOD) for _ in range(2))
    carried = looked_at = 0
    for tick in range(1, 200):
        snapshot = team.step(inputs.get(tick, ()))
        said = seen.tick(snapshot)
        outputs = [output for output in snapshot.robots if isinstance(output, PropagatedOutput)]
        carried += len(outputs)
        looked_at += sum("observations" in vars(output) for output in outputs)
        whole = tuple(
            RobotOutput(output.observations, output.estimate, output.navigation, output.neighbour)
            for output in snapshot.robots
        )
        assert said == stepped.tick(replace(snapshot, robots=whole))
    assert carried > 100
    assert looked_at < carried / 10


def test_feedback_tells_where_the_robot_believes_it_is() -> None:
    (snapshot,) = snapshots(2, 1, first=LEG // 2)
    said = {message.topic.name: message.data for message in TeamPublisher(2, MOUNT, SCAN_PERIOD).tick(snapshot)}
    for robot, output in enumerate(snapshot.robots):
        _, frame, base = unpack.move_base_feedback(said[f"/{namespace_of(robot)}/move_base/feedback"])
        assert (frame, base.distance(output.estimate.base_in_map)) == ("map", pytest.approx(0.0, abs=1e-12))


def test_status_feedback_and_the_log_tell_of_a_goal() -> None:
    messages = published(1, LEG + 1)
    per_topic = Counter(message.topic.name for message in messages)
    assert per_topic["/robot1/move_base/feedback"] == LEG // 5
    assert LEG // 10 < per_topic["/robot1/move_base/status"] < LEG // 10 + 5
    log = [message.data for message in messages if message.topic.name == "/rosout"]
    assert [b"/robot1/move_base" in data for data in log] == [True, True]
    assert b"robot1-0 was reached" in log[-1]


def test_the_log_tells_of_collisions_and_of_robots_that_are_lost_or_dead_once() -> None:
    publisher = TeamPublisher(1, MOUNT, SCAN_PERIOD)
    texts = []
    for snapshot in snapshots(1, 12, first=1):
        tick = snapshot.tick
        lost = replace(snapshot.robots[0].estimate, lost=3 <= tick < 5)
        world = replace(snapshot.world, collisions=np.array([1 if tick >= 6 else 0]))
        dead = frozenset({0}) if 8 <= tick < 10 else frozenset()
        messages = publisher.tick(replace(_with(snapshot, estimate=lost), world=world, dead=dead))
        texts += [(tick, message.data) for message in messages if message.topic.name == "/rosout"]
    for tick, word in (
        (3, b"does not know"),
        (5, b"knows where"),
        (6, b"has hit"),
        (8, b"stopped"),
        (10, b"runs again"),
    ):
        assert [told for told, data in texts if word in data] == [tick]


def test_log_and_diagnostics_tell_for_whom_a_robot_makes_way_from_the_beginning_to_the_end() -> None:
    publisher = TeamPublisher(1, MOUNT, SCAN_PERIOD)
    lines, told = [], []
    for snapshot in snapshots(1, 16, first=1):
        tick = snapshot.tick
        first = 2 if 3 <= tick < 9 else 1 if 9 <= tick < 11 or tick >= 13 else None
        navigation = replace(snapshot.robots[0].navigation, makes_way_for=first)
        dead = frozenset({0}) if tick == 15 else frozenset()
        for message in publisher.tick(replace(_with(snapshot, navigation=navigation), dead=dead)):
            if message.topic.name == "/rosout":
                lines.append((tick, unpack.log(message.data).text))
            elif message.topic.name == "/diagnostics":
                parts = {each.name: each for each in unpack.diagnostic_array(message.data)}
                drives = parts.get("robot1: navigation")
                told.append((tick, drives and drives.values.get("makes way for"), drives and drives.message))
    assert [line for line in lines if " way " in line[1]] == [
        (3, "makes way for robot 3"),
        (9, "made way for robot 3 for 0.1 s"),
        (9, "makes way for robot 2"),
        (11, "made way for robot 2 for 0.0 s"),
        (13, "makes way for robot 2"),
        (15, "made way for robot 2 for 0.0 s"),
        (16, "makes way for robot 2"),
    ]
    assert [each[:2] for each in told] == [
        (3, "robot3"),
        (9, "robot2"),
        (11, None),
        (13, "robot2"),
        (15, None),
        (16, "robot2"),
    ]
    assert told[0][2] == "makes way for robot 3"


def test_diagnostics_tell_apart_who_makes_way_and_who_is_held_up() -> None:
    (snapshot,) = snapshots(1, 1)
    navigation = replace(snapshot.robots[0].navigation, waits_for=1)
    publisher = TeamPublisher(1, MOUNT, SCAN_PERIOD)
    (data,) = [m.data for m in publisher.tick(_with(snapshot, navigation=navigation)) if m.topic.name == "/diagnostics"]
    (drives,) = [each for each in unpack.diagnostic_array(data) if each.name == "robot1: navigation"]
    assert drives.message == "waits for robot 2, which is in its way"
    assert "makes way for" not in drives.values


def test_diagnostics_come_once_a_second_with_every_part_of_every_robot() -> None:
    messages = [message for message in published(2, 100) if message.topic.name == "/diagnostics"]
    assert len(messages) == 2
    message = typestore().deserialize_ros1(messages[0].data, "diagnostic_msgs/msg/DiagnosticArray")
    parts = ["software", "localisation", "navigation", "energy", "bumper"]
    assert [status.name for status in message.status] == [f"robot{n}: {part}" for n in (1, 2) for part in parts]
    assert {status.level for status in message.status} == {0}


@pytest.mark.parametrize(
    ("charge", "lost", "dead", "part", "level"),
    [
        (0.0, False, False, "energy", 2),
        (10.0, False, False, "energy", 1),
        (90.0, True, False, "localisation", 2),
        (90.0, False, True, "software", 3),
    ],
)
def test_diagnostics_say_what_is_wrong(charge: float, lost: bool, dead: bool, part: str, level: int) -> None:
    (snapshot,) = snapshots(1, 1)
    robot = snapshot.robots[0]
    snapshot = _with(
        snapshot,
        estimate=replace(robot.estimate, lost=lost),
        observations=replace(robot.observations, battery=Battery(0, charge, 100.0)),
    )
    snapshot = replace(snapshot, dead=frozenset({0}) if dead else frozenset())
    (data,) = [m.data for m in TeamPublisher(1, MOUNT, SCAN_PERIOD).tick(snapshot) if m.topic.name == "/diagnostics"]
    message = typestore().deserialize_ros1(data, "diagnostic_msgs/msg/DiagnosticArray")
    assert {status.name: status.level for status in message.status}[f"robot1: {part}"] == level


def test_the_clock_tells_the_stamp_of_a_tick() -> None:
    message = clock_message(75)
    assert (message.topic.name, message.stamp_ns) == ("/clock", 2_500_000_000)
    assert message.data == bytes((2, 0, 0, 0)) + (500_000_000).to_bytes(4, "little")


def test_a_localiser_without_particles_says_no_cloud() -> None:
    (snapshot,) = snapshots(1, 1)
    estimate = replace(snapshot.robots[0].estimate, updated=True, particles=np.empty((0, 3)))
    names = {m.topic.name for m in TeamPublisher(1, MOUNT, SCAN_PERIOD).tick(_with(snapshot, estimate=estimate))}
    assert "/robot1/amcl_pose" in names
    assert "/robot1/particlecloud" not in names


def test_a_team_of_another_size_is_refused() -> None:
    (snapshot,) = snapshots(2, 1)
    with pytest.raises(ValueError):
        TeamPublisher(3, MOUNT, SCAN_PERIOD).tick(snapshot)


def _with(snapshot: TeamSnapshot, **changes: object) -> TeamSnapshot:
    return replace(snapshot, robots=(replace(snapshot.robots[0], **changes),))


def crate(x: float) -> ThingState:
    return ThingState(Thing("crate", ((0.1, 0.1), (-0.1, 0.1), (0.0, -0.1)), Pose2(x, 2.0, 0.0)), appeared=True)


def test_things_are_said_when_they_come_and_go_and_at_ten_hertz_when_they_walk() -> None:
    publisher = TeamPublisher(1, MOUNT, SCAN_PERIOD)
    said = []
    for snapshot in snapshots(1, 40):
        things = (crate(1.0 + 0.01 * snapshot.tick),) if snapshot.tick in range(10, 31) else ()
        world = replace(snapshot.world, things=things, bodies=polygons_of(things))
        topics = [message.topic.name for message in publisher.tick(replace(snapshot, world=world))]
        if "/things" in topics:
            said.append(snapshot.tick)
    assert said == [10, 15, 20, 25, 30, 31]


def test_without_things_nothing_is_said_of_them() -> None:
    assert "/things" not in {message.topic.name for message in published(2, 100)}


def test_of_a_dead_robot_only_the_truth_is_said() -> None:
    (snapshot,) = snapshots(2, 1, first=100)
    messages = TeamPublisher(2, MOUNT, SCAN_PERIOD).tick(replace(snapshot, dead=frozenset({1})))
    of_second = [message.topic.name for message in messages if message.topic.name.startswith("/robot2")]
    assert of_second == ["/robot2/base_pose_ground_truth"]  # and the log says that it died
    assert {transform.child for _, transform in unpack.transforms(messages[0].data)} == {
        "robot1/odom",
        "robot1/base_footprint",
    }
