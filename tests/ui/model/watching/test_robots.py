from sim.common.geometry import Pose2
from tests.ui.model.watching.hear import Heard, odometry, tf
from thbridge.ros.messages import types
from thbridge.ros.names import RobotNames
from thbridge.ros.topics import Planners, RobotTopics
from ui.model.watching.robots import RobotDiscovery


def introduced(*heard: Heard) -> RobotDiscovery:
    introductions = RobotDiscovery()
    for said in heard:
        introductions.take(said)
    return introductions


def silent(topic: str, msgtype: str) -> Heard:
    return Heard(topic, msgtype, 0, b"")


def test_all_topics_of_a_robot_of_ours_are_known() -> None:
    ours = RobotTopics.of(RobotNames.of(1), Planners("GlobalPlanner", "DWAPlannerROS"))
    introductions = introduced(
        *(silent(topic.name, topic.msgtype) for topic in ours.all()),
        odometry(0, Pose2(0, 0, 0), ours.odom.name, "robot2/odom", "robot2/base_footprint"),
    )
    (member,) = introductions.robots()
    assert (member.robot, member.name, member.base) == (1, "robot 2", "robot2/base_footprint")
    found = {name: getattr(member, name) for name in ("odom", "scan", "battery", "goal", "status", "result", "plan")}
    assert found == {name: getattr(ours, name).name for name in found}
    assert member.truth == ours.base_pose_ground_truth.name
    assert (member.estimate, member.cloud) == (ours.amcl_pose.name, ours.particlecloud.name)
    assert (member.local_plan, member.footprint) == (ours.local_plan.name, ours.local_footprint.name)
    assert (member.global_costmap, member.local_costmap) == (ours.global_costmap.name, ours.local_costmap.name)


def test_robots_come_in_the_order_of_their_numbers() -> None:
    heard = [
        odometry(0, Pose2(0, 0, 0), f"/robot{number}/odom", f"robot{number}/odom", f"robot{number}/base_footprint")
        for number in (10, 2, 1)
    ]
    assert [(member.robot, member.key) for member in introduced(*heard).robots()] == [
        (0, "robot1"),
        (1, "robot2"),
        (9, "robot10"),
    ]


def test_a_robot_without_a_name_has_all_topics() -> None:
    introductions = introduced(
        odometry(0, Pose2(0, 0, 0)), silent("/scan", types.LASER_SCAN), silent("/amcl_pose", types.POSE_WITH_COVARIANCE)
    )
    (member,) = introductions.robots()
    assert (member.name, member.odom, member.scan, member.estimate) == ("robot 1", "/odom", "/scan", "/amcl_pose")


def test_stage_s_robots_are_told_apart() -> None:
    introductions = introduced(
        *(odometry(0, Pose2(0, 0, 0), f"/robot_{n}/odom", f"robot_{n}/odom", f"robot_{n}/base_link") for n in (0, 1)),
        *(silent(f"/robot_{n}/base_scan", types.LASER_SCAN) for n in (0, 1)),
    )
    assert [(member.robot, member.name, member.scan) for member in introductions.robots()] == [
        (0, "robot_0", "/robot_0/base_scan"),
        (1, "robot_1", "/robot_1/base_scan"),
    ]


def test_a_robot_that_only_tf_speaks_of_has_a_base() -> None:
    (member,) = introduced(tf(0, ("odom", "base_footprint", Pose2(0, 0, 0)))).robots()
    assert (member.odom, member.base) == (None, "base_footprint")


def test_poses_that_somebody_wants_are_no_belief() -> None:
    introductions = introduced(odometry(0, Pose2(0, 0, 0)), silent("/initialpose", types.POSE_WITH_COVARIANCE))
    assert introductions.robots()[0].estimate is None
