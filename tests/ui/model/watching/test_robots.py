from sim.common.geometry import Pose2
from tests.support.ros.watched_messages import StampedMessage, odometry, tf
from thbridge.ros.messages import types
from thbridge.ros.names import RobotNames
from thbridge.ros.topics import Planners, RobotTopics
from ui.model.watching.robots import RobotDiscovery


def discovered(*messages: StampedMessage) -> RobotDiscovery:
    discovery = RobotDiscovery()
    for message in messages:
        discovery.take(message)
    return discovery


def empty(topic: str, msgtype: str) -> StampedMessage:
    return StampedMessage(topic, msgtype, 0, b"")


def test_all_topics_of_a_robot_of_ours_are_known() -> None:
    ours = RobotTopics(RobotNames.of(1), Planners("GlobalPlanner", "DWAPlannerROS"))
    discovery = discovered(
        *(empty(topic.name, topic.msgtype) for topic in ours.all()),
        odometry(0, Pose2(0, 0, 0), ours.odom.name, "robot2/odom", "robot2/base_footprint"),
    )
    (robot,) = discovery.robots()
    assert (robot.robot, robot.name, robot.base) == (1, "robot 2", "robot2/base_footprint")
    found = {name: getattr(robot, name) for name in ("odom", "scan", "battery", "goal", "status", "result", "plan")}
    assert found == {name: getattr(ours, name).name for name in found}
    assert robot.truth == ours.base_pose_ground_truth.name
    assert (robot.estimate, robot.cloud) == (ours.amcl_pose.name, ours.particlecloud.name)
    assert (robot.local_plan, robot.footprint) == (ours.local_plan.name, ours.local_footprint.name)
    assert (robot.global_costmap, robot.local_costmap) == (ours.global_costmap.name, ours.local_costmap.name)


def test_robots_come_in_the_order_of_their_numbers() -> None:
    messages = [
        odometry(0, Pose2(0, 0, 0), f"/robot{number}/odom", f"robot{number}/odom", f"robot{number}/base_footprint")
        for number in (10, 2, 1)
    ]
    assert [(robot.robot, robot.key) for robot in discovered(*messages).robots()] == [
        (0, "robot1"),
        (1, "robot2"),
        (9, "robot10"),
    ]


def test_a_robot_without_a_name_has_all_topics() -> None:
    discovery = discovered(
        odometry(0, Pose2(0, 0, 0)), empty("/scan", types.LASER_SCAN), empty("/amcl_pose", types.POSE_WITH_COVARIANCE)
    )
    (robot,) = discovery.robots()
    assert (robot.name, robot.odom, robot.scan, robot.estimate) == ("robot 1", "/odom", "/scan", "/amcl_pose")


def test_stage_s_robots_are_told_apart() -> None:
    discovery = discovered(
        *(odometry(0, Pose2(0, 0, 0), f"/robot_{n}/odom", f"robot_{n}/odom", f"robot_{n}/base_link") for n in (0, 1)),
        *(empty(f"/robot_{n}/base_scan", types.LASER_SCAN) for n in (0, 1)),
    )
    assert [(robot.robot, robot.name, robot.scan) for robot in discovery.robots()] == [
        (0, "robot_0", "/robot_0/base_scan"),
        (1, "robot_1", "/robot_1/base_scan"),
    ]


def test_a_robot_that_only_tf_speaks_of_has_a_base() -> None:
    (robot,) = discovered(tf(0, ("odom", "base_footprint", Pose2(0, 0, 0)))).robots()
    assert (robot.odom, robot.base) == (None, "base_footprint")


def test_poses_that_somebody_wants_are_no_belief() -> None:
    discovery = discovered(odometry(0, Pose2(0, 0, 0)), empty("/initialpose", types.POSE_WITH_COVARIANCE))
    assert discovery.robots()[0].estimate is None
