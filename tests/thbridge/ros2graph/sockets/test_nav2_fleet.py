"""A fleet of Nav2 robots on a graph in memory. Each robot is the action server of our own sessions, with topics."""

import asyncio
import logging
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, Twist
from sim.inputs import CancelGoal, DriveManually, KidnapRobot, PlaceRobot, SendGoal, SetPoseEstimate
from sim.parameters import live_parameters
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, NoPath
from sim.snapshot import TeamSnapshot
from tests.support.ros2.driven_robot import DrivenRobot
from tests.support.ros2.loopback import LoopbackGraph
from thbridge.ros.messages import pack, types, unpack
from thbridge.ros.messages.pack import Transform
from thbridge.ros.messages.records import LogLevel
from thbridge.ros.reconfigure import described, values_config
from thbridge.ros.remote.robot import RemoteRobot
from thbridge.ros.topics import RosMessage, Topic
from thbridge.ros2 import parameter_messages
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.nav2_goals import Nav2Goals
from thbridge.ros2.navigate_to_pose import NAVIGATE_TO_POSE
from thbridge.ros2.parameters import Value, kind_of
from thbridge.ros2.qos import DEFAULT, LATCHED, ROSOUT, SENSOR_DATA, TF, QosProfile
from thbridge.ros2.topics import type_of_ros1
from thbridge.ros2graph.sockets.action_server import GraphActionServer
from thbridge.ros2graph.sockets.joining import NodeTaken
from thbridge.ros2graph.sockets.nav2_fleet import Nav2Fleet, Nav2Robot
from thbridge.ros2graph.values.address import RosDistribution
from thbridge.ros2graph.values.graph import NodeName
from thbridge.study.real_robots import FleetNames, FleetSection

SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND
FOOTPRINT = np.array([[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]])
GOAL = Goal(5, Pose2(2.0, 0.0, 0.0))
(OFFSET,) = map(described, live_parameters(FleetSection))
NAMES = FleetNames(odom_frame="odom", base_frame="base_link")


class Notes:
    """Recorder that keeps all messages."""

    def __init__(self) -> None:
        self.came: list[tuple[Topic, str, bytes]] = []
        self.went: list[RosMessage] = []

    def received(self, topic: Topic, publisher: str, stamp_ns: int, data: bytes) -> None:
        self.came.append((topic, publisher, data))

    def sent(self, message: RosMessage) -> None:
        self.went.append(message)


class Lab:
    """A fleet of one robot, and the robot."""

    def __init__(self, name: str = "kilted", *, simulated: bool = False) -> None:
        self.graph = LoopbackGraph()
        self.kind = Distribution.of(name)
        self.now = START
        self.recorder = Notes()
        remote, self.named = NAMES.nav2_names(1, RosDistribution(name))
        self.remote = RemoteRobot(0, remote, "/thbridge_fleet", FOOTPRINT)
        robot = Nav2Robot(self.remote, self.named, Nav2Goals(remote, "/thbridge_fleet-robot1-"))
        self.fleet = Nav2Fleet(
            self.graph.program(),
            self.kind,
            [robot],
            self.recorder,
            OFFSET,
            is_time_simulated=simulated,
            wall=lambda: self.now,
        )
        self.x = 0.0
        self.mute: set[str] = set()
        self.heard: dict[str, list[bytes]] = {"cmd_vel": [], "initialpose": []}
        self.start_robot()

    def start_robot(self) -> None:
        self.robot = DrivenRobot(self.kind)
        self.program = program = self.graph.program()
        node = NodeName("/robot1", "bt_navigator")
        logic = self.robot.navigate
        self.server = GraphActionServer(program, node, "/robot1/navigate_to_pose", self.kind, NAVIGATE_TO_POSE, logic)
        self.writers = {
            topic: self.publish(topic, kind, qos)
            for topic, kind, qos in (
                ("/robot1/odom", types.ODOMETRY, SENSOR_DATA),
                ("/robot1/amcl_pose", types.POSE_WITH_COVARIANCE, LATCHED),
                ("/robot1/tf", types.TFMESSAGE, TF),
                ("/robot1/local_plan", types.PATH, DEFAULT),
                ("/map", types.STRING, LATCHED),
            )
        }
        for topic, heard in self.heard.items():
            kind = "geometry_msgs/msg/PoseWithCovarianceStamped"
            if topic == "cmd_vel":
                kind = "geometry_msgs/msg/Twist" + ("Stamped" if self.named.is_twist_stamped else "")
            support = self.kind.message(kind)
            program.subscribe(
                node,
                f"/robot1/{topic}",
                support,
                DEFAULT,
                lambda data, _, heard=heard: heard.append(data),
            )

    def publish(self, topic: str, kind: str, qos: QosProfile) -> Callable[[bytes], None]:
        to_cdr = self.kind.from_ros1(kind, type_of_ros1(kind))
        support = self.kind.message(type_of_ros1(kind))
        writer = self.program.publish(NodeName("/robot1", "driver"), topic, support, qos)
        return lambda data: writer.write(to_cdr(data))

    def say(self) -> None:
        """Let the robot publish its topics."""
        tick = self.robot.tick
        here = Pose2(self.x, 0.0, 0.0)
        for topic, data in (
            ("/robot1/odom", pack.odometry(tick, "odom", "base_link", here, STANDSTILL)),
            ("/robot1/amcl_pose", pack.pose_with_covariance(tick, "map", here, np.eye(3))),
            ("/robot1/tf", pack.transforms(tick, [Transform("map", "odom", Pose2(0.0, 0.0, 0.0))])),
        ):
            if topic not in self.mute:
                self.writers[topic](data)

    def step(self, *inputs: Any, seconds: float = 0.02) -> TeamSnapshot:
        """Run ticks, the inputs in the first tick."""
        for number in range(round(seconds * 50)):
            self.now += SECOND // 50
            if "robot" not in self.mute:
                self.robot.step()
                self.server.publish()
                self.say()
            self.graph.deliver()
            snapshot = self.fleet.step(inputs if number == 0 else ())
            self.graph.deliver()
        return snapshot

    def look(self) -> None:
        """Run a tick before the robots are ready."""
        self.now += SECOND // 50
        self.robot.step()
        self.server.publish()
        self.say()
        self.graph.deliver()
        self.fleet.tell_changes()


@pytest.fixture(params=["jazzy", "kilted"])
def lab(request: pytest.FixtureRequest) -> Lab:
    made = Lab(request.param)
    made.look()
    return made


def test_what_is_missing_is_reported_with_its_topics() -> None:
    lab = Lab()
    lab.mute = {"/robot1/odom", "/robot1/tf", "/robot1/amcl_pose"}
    (sentence,) = lab.fleet.missing()
    for name in ("/robot1/odom", " on /robot1/tf", "/robot1/amcl_pose", "no action server /robot1/navigate_to_pose"):
        assert name in sentence
    assert "_action" not in sentence
    with pytest.raises(ValueError, match="not all robots are ready"):
        lab.fleet.step()
    lab.mute.clear()
    lab.look()
    assert lab.fleet.missing() == []


def test_the_pose_of_a_robot_that_stood_before_the_start_is_known() -> None:
    lab = Lab()
    lab.mute = {"/robot1/tf", "/robot1/amcl_pose", "/robot1/odom"}
    lab.writers["/robot1/amcl_pose"](pack.pose_with_covariance(0, "map", Pose2(1.0, 2.0, 0.0), np.eye(3)))
    lab.graph.pending.clear()  # The fleet was not there yet.
    lab.look()
    lab.mute.discard("/robot1/odom")  # The first odometry may arrive later.
    lab.look()
    lab.look()
    assert lab.fleet.missing() == []
    here = lab.fleet.step().robots[0].estimate.base_in_map
    assert (here.x, here.y) == (1.0, 2.0)


@pytest.mark.parametrize("qos", [LATCHED, DEFAULT, SENSOR_DATA], ids=["latched", "volatile", "best effort"])
def test_each_pose_arrives_once_with_any_quality_of_service(qos: QosProfile) -> None:
    lab = Lab()
    lab.mute = {"/robot1/amcl_pose"}
    publish = lab.publish("/robot1/amcl_pose", types.POSE_WITH_COVARIANCE, qos)
    lab.look()
    publish(pack.pose_with_covariance(0, "map", Pose2(0.0, 0.0, 0.0), np.eye(3)))
    lab.look()
    assert [topic.name for topic, _, _ in lab.recorder.came].count("/robot1/amcl_pose") == 1


def test_a_goal_is_reached(lab: Lab) -> None:
    snapshot = lab.step(SendGoal(0, GOAL), seconds=0.2)
    assert snapshot.robots[0].navigation.goal == GOAL
    assert lab.robot.goal is not None
    assert (lab.robot.goal.base_in_map.x, lab.robot.goal.base_in_map.y) == (2.0, 0.0)
    assert snapshot.robots[0].navigation.state == "controlling"
    lab.robot.arrive()
    results = [lab.step().robots[0].navigation.result for _ in range(3)]
    assert [result for result in results if result is not None] == [GoalReached(GOAL)]


def test_a_failure_has_its_reason(lab: Lab) -> None:
    lab.step(SendGoal(0, GOAL), seconds=0.2)
    lab.robot.fail("no_way", "there is no path")
    results = [lab.step().robots[0].navigation.result for _ in range(3)]
    assert [result for result in results if result is not None] == [
        NoPath(GOAL, "no_way", "there is no path (Nav2 error 208)")
    ]


def test_cancel_stops_the_robot(lab: Lab) -> None:
    lab.step(SendGoal(0, GOAL), seconds=0.2)
    lab.step(CancelGoal(0))
    results = [lab.step().robots[0].navigation.result for _ in range(3)]
    assert [result for result in results if result is not None] == [Cancelled(GOAL)]
    assert lab.robot.goal is None


def test_at_the_end_the_robot_stops(lab: Lab) -> None:
    lab.step(SendGoal(0, GOAL), seconds=0.2)

    async def stop() -> None:
        stopping = asyncio.create_task(lab.fleet.stop())
        while not stopping.done():
            lab.graph.deliver()
            await asyncio.sleep(0)

    asyncio.run(stop())
    lab.robot.step()
    assert lab.robot.goal is None


def test_another_goal_comes_first(lab: Lab) -> None:
    lab.step(SendGoal(0, GOAL), seconds=0.2)
    lab.robot.drive(Goal(1, Pose2(9.0, 9.0, 0.0)))
    results = [lab.step().robots[0].navigation.result for _ in range(60)]
    assert [result for result in results if result is not None] == [Cancelled(GOAL)]


def test_a_robot_that_restarts_gets_its_goal_again(lab: Lab, caplog: pytest.LogCaptureFixture) -> None:
    lab.step(SendGoal(0, GOAL), seconds=0.2)
    asyncio.run(lab.program.stop())
    lab.mute = {"robot"}
    lab.step(seconds=0.2)
    lab.mute = set()
    lab.start_robot()
    lab.step(seconds=2.5)
    assert lab.robot.goal is not None
    assert "robot 1: its navigation did not report its goal, so the goal is sent again" in caplog.text


def test_silence_is_reported_and_ends_the_goal(lab: Lab, caplog: pytest.LogCaptureFixture) -> None:
    lab.step(SendGoal(0, GOAL), seconds=0.2)
    lab.mute = {"robot"}
    results = [lab.step().robots[0].navigation.result for _ in range(7 * 50)]
    (result,) = [result for result in results if result is not None]
    assert isinstance(result, NoPath)
    assert result.reason == "unanswered"
    assert "robot 1: it is silent: no more odometry" in caplog.text
    lab.mute = set()
    lab.step(seconds=1.5)
    assert "its odometry is back" in caplog.text
    assert lab.robot.goal is None, "the goal is canceled"


def test_driving_by_hand_and_pose_estimates(lab: Lab) -> None:
    lab.step(DriveManually(0, Twist(0.3, 0.1), 5), SetPoseEstimate(0, Pose2(1.0, 2.0, 0.0), np.eye(3)))
    lab.step(seconds=0.2)
    kind = "geometry_msgs/msg/TwistStamped" if lab.named.is_twist_stamped else "geometry_msgs/msg/Twist"
    commands: list[Any] = [lab.kind.decode(kind, data) for data in lab.heard["cmd_vel"]]
    speeds = [getattr(each, "twist", each).linear.x for each in commands]
    assert (speeds[0], speeds[-1]) == (0.3, 0.0)
    (estimate,) = lab.heard["initialpose"]
    back = lab.kind.to_ros1("geometry_msgs/msg/PoseWithCovarianceStamped", types.POSE_WITH_COVARIANCE)
    assert unpack.pose_with_covariance(back(estimate)).pose == Pose2(1.0, 2.0, 0.0)


@pytest.mark.parametrize("name", ["jazzy", "kilted"])
def test_all_messages_are_recorded(name: str, caplog: pytest.LogCaptureFixture) -> None:
    lab = Lab(name)
    lab.look()
    lab.writers["/robot1/local_plan"](pack.path(0, "map", np.zeros((2, 3))))
    lab.step(SendGoal(0, GOAL), seconds=1.2)
    lab.writers["/robot1/local_plan"](pack.path(0, "map", np.zeros((2, 3))))
    lab.robot.arrive()
    lab.step(seconds=0.2)
    came = {(topic.name, publisher) for topic, publisher, _ in lab.recorder.came}
    assert came >= {(name, "/robot1/driver") for name in ("/robot1/odom", "/robot1/tf", "/robot1/local_plan")}
    odometry = [data for topic, _, data in lab.recorder.came if topic.name == "/robot1/odom"]
    assert unpack.odometry(odometry[0]).pose == Pose2(0.0, 0.0, 0.0)
    went = [message.topic.name for message in lab.recorder.went]
    action = "/robot1/navigate_to_pose"
    updates = "/thbridge_fleet/parameter_updates"
    assert {*went} == {f"{action}/goal", f"{action}/status", f"{action}/result", updates}
    (end,) = [message for message in lab.recorder.went if message.topic.name == f"{action}/result"]
    assert unpack.move_base_result(end.data).status == 3
    assert "/map: /robot1/driver publishes std_msgs/msg/String, but nav_msgs/msg/Occ" in caplog.text


def test_logs_are_recorded_with_their_levels_of_ros1(lab: Lab) -> None:
    kind = type_of_ros1(types.LOG)
    writer = lab.program.publish(NodeName("/robot1", "amcl"), "/rosout", lab.kind.message(kind), ROSOUT)
    for level in (10, 20, 30, 40, 50):
        writer.write(lab.kind.encode(kind, lab.kind.make(kind, level=level)))
    lab.step()
    logs = [data for topic, _, data in lab.recorder.came if topic == Topic("/rosout", types.LOG)]
    assert [unpack.log(data).level for data in logs] == [*LogLevel]


def test_odometry_that_jumps_is_reported(lab: Lab, caplog: pytest.LogCaptureFixture) -> None:
    lab.step(seconds=0.2)
    lab.x = 30.0
    lab.step(seconds=0.1)
    assert "robot 1:" in caplog.text


def test_time_comes_from_the_clock_if_requested() -> None:
    lab = Lab(simulated=True)
    lab.look()
    assert lab.fleet.missing() == ["use_sim_time is set, but there is no time on /clock yet"]
    clock = lab.publish("/clock", types.CLOCK, DEFAULT)
    clock(pack.clock(100))
    lab.look()
    lab.look()
    assert lab.fleet.missing() == []
    assert lab.fleet.step().tick == 100


def test_latched_messages_from_before_the_first_clock_are_kept_for_the_recording() -> None:
    lab = Lab(simulated=True)
    grid = OccupancyGrid(np.zeros((2, 3), dtype=np.int8), 0.05, Pose2(0.0, 0.0, 0.0))
    lab.publish("/map", types.OCCUPANCY_GRID, LATCHED)(pack.occupancy_grid(0, "map", grid))
    static = [Transform("base_link", "laser", Pose2(0.1, 0.0, 0.0))]
    lab.publish("/robot1/tf_static", types.TFMESSAGE, LATCHED)(pack.transforms(0, static))
    lab.look()
    lab.publish("/clock", types.CLOCK, DEFAULT)(pack.clock(100))
    lab.look()
    assert {topic.name for topic, _, _ in lab.recorder.came if topic.latched} == {"/map", "/robot1/tf_static"}


def test_what_only_a_simulation_can_do_is_refused(lab: Lab, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        lab.step(KidnapRobot(0, Pose2(0.0, 0.0, 0.0)), PlaceRobot(0, Pose2(9.0, 9.0, 0.0)))
    assert "real robots do not support Carry" in caplog.text
    assert "robot 1 is not at its start pose: please move it to (9.00, 9.00)" in caplog.text
    assert math.isnan(lab.step().robots[0].observations.battery.charge)


class Tuner:
    """A program that reads and sets parameters of the fleet's node."""

    def __init__(self, lab: Lab) -> None:
        self.lab = lab
        self.program = lab.graph.program()
        self.events: list[Any] = []
        event = lab.kind.message(parameter_messages.EVENT)
        self.program.subscribe(NodeName("/", "tuner"), "/parameter_events", event, DEFAULT, self._hear)

    def _hear(self, data: bytes, gid: bytes) -> None:
        event: Any = self.lab.kind.decode(parameter_messages.EVENT, data)
        self.events += [(event.node, each.name, each.value.double_value) for each in event.changed_parameters]

    def call(self, service: str, **fields: object) -> Any:
        kind, type_ = self.lab.kind, parameter_messages.SERVICE_TYPES[service]
        client = self.program.client(NodeName("/", "tuner"), f"/thbridge_fleet/{service}", kind.service(type_))
        responses: list[bytes] = []

        async def wait() -> None:
            client.call(kind.encode(f"{type_}_Request", kind.make(f"{type_}_Request", **fields)), responses.append)
            self.lab.graph.deliver()
            await asyncio.sleep(0)  # The server answers in the next turn of the event loop.
            self.lab.graph.deliver()

        asyncio.run(wait())
        return kind.decode(f"{type_}_Response", responses[0])

    def set(self, *values: tuple[str, Value], together: bool = False) -> list[str]:
        make = self.lab.kind.make
        parameters = [
            make(
                "rcl_interfaces/msg/Parameter",
                name=name,
                value=parameter_messages.parameter_value(self.lab.kind, kind_of(value), value),
            )
            for name, value in values
        ]
        service = parameter_messages.SET_TOGETHER if together else parameter_messages.SET
        answer = self.call(service, parameters=parameters)
        return [each.reason for each in ([answer.result] if together else answer.results)]

    def get(self, *wanted: str) -> list[Any]:
        return self.call(parameter_messages.GET, names=list(wanted)).values


def updates(lab: Lab) -> list[bytes]:
    return [each.data for each in lab.recorder.went if each.topic.name == "/thbridge_fleet/parameter_updates"]


def test_the_time_offset_of_odometry_changes_and_is_recorded(lab: Lab, caplog: pytest.LogCaptureFixture) -> None:
    tuner = Tuner(lab)
    lab.step(seconds=0.2)
    assert updates(lab) == [values_config([(OFFSET, 0.0)])]
    assert tuner.set(("odom_time_offset", 0.2)) == [""]
    offset, simulated = tuner.get("odom_time_offset", "use_sim_time")
    assert (offset.double_value, simulated.bool_value) == (0.2, False)
    lab.step(seconds=0.1)
    assert updates(lab)[1:] == [values_config([(OFFSET, 0.2)])]
    assert tuner.events == [("/thbridge_fleet", "odom_time_offset", 0.2)]
    assert "/thbridge_fleet/odom_time_offset is 0.2 s now" in caplog.text
    assert tuner.set(("odom_time_offset", 0.2)) == [""], "this is no change"
    assert tuner.set(("odom_time_offset", -0.1), ("odom_time_offset", 0.3)) == ["", ""]
    lab.step()
    assert updates(lab)[2:] == [values_config([(OFFSET, 0.3)])]


def test_the_time_offset_pairs_poses_with_earlier_odometry() -> None:
    lab = Lab()
    lab.mute = {"/robot1/tf"}
    lab.look()

    def ahead() -> float:
        """Drive at 1 m/s for a second; return by how much the believed position is ahead of the localization."""
        for _ in range(50):
            lab.x += 0.02
            snapshot = lab.step()
        return snapshot.robots[0].estimate.base_in_map.x - lab.x

    assert ahead() == pytest.approx(0.0)
    assert Tuner(lab).set(("odom_time_offset", 0.1)) == [""]
    assert ahead() == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("odom_time_offset", 10.5, "odom_time_offset is at most 10, not 10.5"),
        ("odom_time_offset", math.nan, "odom_time_offset is a number, not nan"),
        ("odom_time_offset", 1, "has the type double"),
        ("use_sim_time", True, "read-only"),
        ("silence", 1.0, "not declared"),
    ],
)
@pytest.mark.parametrize("together", [False, True])
def test_other_offsets_are_refused(name: str, value: Value, reason: str, together: bool) -> None:
    lab = Lab()
    tuner = Tuner(lab)
    (told, *_) = tuner.set((name, value), ("odom_time_offset", 0.25), together=together)
    assert reason in told
    assert tuner.get("odom_time_offset")[0].double_value == (0.0 if together else 0.25)
    assert tuner.set(together=True) == [""] and tuner.set() == []
    assert tuner.set(*[("odom_time_offset", 0.5)] * 201)[0] == "a request sets at most 200 parameters"


def test_a_second_fleet_in_a_domain_is_refused_and_commands_nothing() -> None:
    lab = Lab()
    other = lab.graph.program()
    other.add_node(NodeName("/", "thbridge_fleet"))
    asyncio.run(other.start())
    refused = asyncio.run(lab.fleet.start())
    assert refused == NodeTaken("/thbridge_fleet")
    assert "already has the node /thbridge_fleet. Stop that program first." in str(refused)
    asyncio.run(lab.fleet.stop())
    assert not [endpoint for endpoint in other.endpoints() if endpoint.node == NodeName("/", "thbridge_fleet")]
