"""One real robot, bytes to bytes: what it says becomes a team member's output, what it is asked messages."""

import math

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Battery, LaserMount, Scan, Twist
from sim.inputs import CancelGoal, DriveManually, SendGoal, SetPoseEstimate
from sim.robot.navigator.goals import Goal, GoalReached
from thbridge.ros import names
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import pack, unpack
from thbridge.ros.messages.goal_status import GoalId, GoalStatus, GoalStatusCode
from thbridge.ros.messages.pack import Transform
from thbridge.ros.messages.stamps import stamp_ns, tick_of
from thbridge.ros.remote.robot import RemoteRobot, missing_of
from thbridge.study.real_robots import FleetNames

NAMED = FleetNames().names(2)
FOOTPRINT = np.array([[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]])
START = 88_000_000_000
"""A tick of the wall clock of our days: greater than 32 bits."""
GOAL = Goal(3, Pose2(4.0, 0.0, 0.0))


class Rig:
    """A robot in the hands of a test."""

    def __init__(self) -> None:
        self.robot = RemoteRobot(1, NAMED, "/us", FOOTPRINT)
        self.tick = START

    @property
    def now(self) -> int:
        return stamp_ns(self.tick)

    def receive(self, topic: str, data: bytes) -> None:
        assert self.robot.receive(topic, data, self.now) is None

    def place(self, x: float) -> None:
        self.receive(NAMED.odom, pack.odometry(self.tick, NAMED.odom_frame, "", Pose2(x, 0, 0), Twist(0.4, 0.1)))

    def status(self, *entries: GoalStatus) -> None:
        self.receive(NAMED.action("status"), pack.goal_status_array(self.tick, entries))

    def step(self, ticks: int = 1):
        for _ in range(ticks):
            self.tick += 1
            output = self.robot.step(self.now)
        return output

    def sent(self) -> list[tuple[str, bytes]]:
        sent, self.robot.outgoing = self.robot.outgoing, []
        return [(message.topic.name, message.data) for message in sent]


@pytest.fixture
def rig() -> Rig:
    made = Rig()
    made.place(0.0)
    made.receive(NAMED.amcl_pose, pack.pose_with_covariance(made.tick, "map", Pose2(1, 0, 0), np.eye(3)))
    made.status()
    return made


def test_it_tells_which_topics_are_silent_until_they_speak():
    rig = Rig()
    (sentence,) = missing_of([rig.robot])
    for name in (
        "/robot2/odom",
        "/robot2/amcl_pose",
        "no action server /robot2/move_base",
        "robot2/odom -> robot2/base_footprint",
    ):
        assert name in sentence
    assert rig.step() is None
    rig.status()
    rig.place(0.0)
    (sentence,) = missing_of([rig.robot])
    assert "/robot2/amcl_pose" in sentence
    assert "move_base" not in sentence


def test_what_was_heard_is_told_as_a_simulation_tells_it(rig):
    assert missing_of([rig.robot]) == []
    output = rig.step()
    assert output.estimate.base_in_map == Pose2(1, 0, 0)
    assert output.observations.odometry.twist == Twist(0.4, 0.1)
    assert (output.observations.tick, output.estimate.tick) == (START, START + 1)
    assert math.isnan(output.observations.battery.charge)
    assert output.navigation.goal is None
    assert output.neighbour.robot == 1
    rig.receive(NAMED.battery, pack.battery_state(Battery(0, 30.0, 120.0), "robot2"))
    battery = rig.step().observations.battery
    assert (battery.charge, battery.capacity) == pytest.approx((30.0, 120.0))


def test_a_goal_goes_out_with_a_name_and_comes_to_its_end(rig):
    rig.robot.take(SendGoal(1, GOAL), rig.now)
    assert rig.step().navigation.goal == GOAL
    ((topic, data),) = rig.sent()
    goal = unpack.move_base_goal(data)
    assert (topic, goal.frame, goal.pose) == ("/robot2/move_base/goal", "map", GOAL.base_in_map)
    assert goal.goal_id.startswith("/us-robot2-")
    entry = GoalStatus(GoalId(goal.goal_id, 0), GoalStatusCode.ACTIVE, "")
    rig.status(entry)
    navigation = rig.step().navigation
    assert (navigation.state, navigation.remaining) == ("controlling", 3.0)
    rig.receive(
        NAMED.action("result"), pack.move_base_result(rig.tick, entry._replace(status=GoalStatusCode.SUCCEEDED))
    )
    assert rig.step().navigation.result == GoalReached(GOAL)
    assert rig.step().navigation.result is None


def test_what_is_left_is_measured_along_the_plan_to_this_goal(rig):
    corner = np.array([[1.0, 0, 0], [1.0, 2, 0], [4.0, 2, 0], [4.0, 0, 0]])
    rig.receive(NAMED.plan, pack.path(rig.tick, "map", corner))
    rig.tick += 1
    rig.robot.take(SendGoal(1, GOAL), rig.now)
    assert rig.step().navigation.remaining == 3.0  # the plan is older than the goal
    rig.receive(NAMED.plan, pack.path(rig.tick, "map", corner))
    navigation = rig.step().navigation
    assert navigation.remaining == pytest.approx(7.0)
    assert navigation.plan[0].tolist() == [1.0, 0.0, 0.0]
    rig.receive(NAMED.plan, pack.path(rig.tick, "map", corner[:2]))
    assert rig.step().navigation.remaining == 3.0  # a plan to another place


def test_driving_by_hand_repeats_the_command_and_ends_with_a_stop(rig):
    rig.robot.take(DriveManually(1, Twist(0.3, -0.2), 25), rig.now)
    rig.step(40)
    sent = [(topic, unpack.twist(data)) for topic, data in rig.sent()]
    assert {topic for topic, _ in sent} == {"/robot2/cmd_vel"}
    assert [twist for _, twist in sent] == [Twist(0.3, -0.2)] * 5 + [STANDSTILL]


def test_a_halt_stops_driving_at_once_and_the_end_of_the_program_stops_everything(rig):
    rig.robot.take(DriveManually(1, Twist(0.3, 0.0), 100), rig.now)
    rig.step(3)
    rig.sent()
    rig.robot.take(CancelGoal(1), rig.now)
    ((topic, data),) = rig.sent()
    assert (topic, unpack.twist(data)) == ("/robot2/cmd_vel", STANDSTILL)
    rig.robot.take(SendGoal(1, GOAL), rig.now)
    rig.step()
    rig.sent()
    rig.robot.stop(rig.now)
    assert [topic for topic, _ in rig.sent()] == ["/robot2/move_base/cancel"]


def test_it_can_be_told_where_it_is(rig):
    rig.robot.take(SetPoseEstimate(1, Pose2(7, 8, 1), np.diag([0.1, 0.2, 0.3])), rig.now)
    ((topic, data),) = rig.sent()
    sent = unpack.pose_with_covariance(data)
    assert (topic, sent.frame, sent.pose.x) == ("/robot2/initialpose", "map", 7)
    assert sent.covariance.diagonal().tolist() == [0.1, 0.2, 0.3]
    assert tick_of(sent.stamp_ns) == rig.tick


@pytest.mark.parametrize("roll", [0.0, math.pi])
def test_a_scan_is_seen_where_the_laser_is_known_to_sit_and_once(rig, roll):
    mount = LaserMount(Pose2(0, 0, 0), -1.0, 0.5, 5, 0.1, 10.0)
    ranges = np.array([1, 2, 3, 4, 10], dtype=np.float32)
    data = pack.laser_scan(Scan(rig.tick, mount, ranges), "robot2/laser", 0.1)
    rig.receive(NAMED.scan, data)
    assert rig.step().observations.scan is None
    static = bytearray(pack.transforms(rig.tick, [Transform(NAMED.base_frame, "robot2/laser", Pose2(0.1, 0, 0))]))
    if roll:
        static[-32:] = np.array([1.0, 0.0, 0.0, 0.0]).tobytes()
    rig.receive(names.TF_STATIC, bytes(static))
    rig.receive(NAMED.scan, data)
    scan = rig.step().observations.scan
    assert scan.mount.laser_in_base.x == 0.1
    assert scan.mount.angles() == pytest.approx((-1 if roll else 1) * mount.angles(), abs=1e-6)
    assert scan.ranges.tolist() == [1, 2, 3, 4, math.inf]
    assert rig.step().observations.scan is None


def test_bytes_that_are_no_message_are_refused(rig):
    for topic in rig.robot.subscriptions:
        assert isinstance(rig.robot.receive(topic, b"\x01\x02\x03", rig.now), InvalidMessage), topic
    assert rig.step().estimate.base_in_map == Pose2(1, 0, 0)


def test_a_network_that_breaks_for_less_than_the_silence_costs_no_goal(rig):
    patient = Rig()
    patient.robot = RemoteRobot(1, NAMED, "/us", FOOTPRINT, stale_ns=20_000_000_000)
    for each in (patient, rig):
        each.place(0.0)
        each.receive(NAMED.amcl_pose, pack.pose_with_covariance(each.tick, "map", Pose2(1, 0, 0), np.eye(3)))
        each.status()
        each.robot.take(SendGoal(1, GOAL), each.now)
        each.step(15 * 50)
    assert patient.step().navigation.goal == GOAL
    assert rig.step().navigation.goal is None
