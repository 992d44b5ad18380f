"""The section `fleet`: names of real robots, and what cannot be one."""

from dataclasses import replace
from pathlib import Path

import pytest

from thbridge.files.errors import BadFile, BadFiles
from thbridge.ros.remote.names import Nav2Names
from thbridge.ros2graph.values.address import RosDistribution
from thbridge.study.real_robots import FleetNames, FleetSection, Nav2FleetNames
from thbridge.study.robots_from import RobotsFrom
from thbridge.study.study_file import Study, read_study_text
from thbridge.study.text import resolved

FILE = Path("study.yaml")


def test_by_default_names_are_those_of_our_own_robots():
    study = Study(robots=2)
    assert study.robots_from is RobotsFrom.SIM
    second = study.fleet.names(2)[1]
    assert (second.odom, second.action("goal"), second.odom_frame) == (
        "/robot2/odom",
        "/robot2/move_base/goal",
        "robot2/odom",
    )


def test_other_robots_need_other_names_only():
    text = """
robots: 3
robots_from: ros
fleet:
  robot: {namespace: "tb3_{n}", odom_frame: "/tb3_{n}/odom", scan: base_scan, amcl_pose: "/loc/{n}/pose"}
  each:
    3: {namespace: /kobuki, recorded: [bumper]}
"""
    study = read_study_text(FILE, text)
    assert study.robots_from is RobotsFrom.ROS
    first, _, third = study.fleet.names(3)
    assert (first.odom, first.scan, first.amcl_pose) == ("/tb3_1/odom", "/tb3_1/base_scan", "/loc/1/pose")
    assert (third.scan, third.odom_frame, third.recorded) == ("/kobuki/base_scan", "tb3_3/odom", ("/kobuki/bumper",))
    assert read_study_text(FILE, resolved(study)) == study


def test_a_robot_may_be_alone_on_its_graph():
    text = 'robots: 1\nfleet: {robot: {namespace: "", odom_frame: odom}}'
    (only,) = read_study_text(FILE, text).fleet.names(1)
    assert (only.odom, only.move_base) == ("/odom", "/move_base")


@pytest.mark.parametrize(
    ("fleet", "key", "problem"),
    [
        ("{robot: {scan: 'la ser'}}", "fleet.robot.scan", "is not a valid name of a topic"),
        ("{robot: {scan: '{number}/scan'}}", "fleet.robot.scan", "is not a valid name of a topic"),
        ("{robot: {map_frame: ''}}", "fleet.robot.map_frame", "is not a valid name of a frame"),
        ("{each: {2: {move_base: '4move'}}}", "fleet.each.2.move_base", "is not a valid name of a topic"),
        (
            "{robot: {namespace: /robot}}",
            "fleet.robot.odom",
            "/robot/odom is both odom of robot 1 and odom of robot 2",
        ),
        ("{each: {2: {odom_frame: robot1/odom}}}", "fleet.each.2.odom_frame", "of robot 1 and odom_frame of robot 2"),
        ("{robot: {plan: odom}}", "fleet.robot.plan", "is both odom of robot 1 and plan of robot 1"),
    ],
)
def test_what_cannot_be_a_name_is_told_with_line_and_remedy(fleet, key, problem):
    with pytest.raises(BadFile) as caught:
        read_study_text(FILE, f"robots: 2\nfleet: {fleet}\nrobots_from: ros\n")
    fault = caught.value.faults[0] if isinstance(caught.value, BadFiles) else caught.value
    assert (fault.key, fault.line) == (key, 2)
    assert problem in fault.problem
    assert fault.remedy


def test_the_standard_names_survive_the_study_in_a_bag():
    study = replace(Study(), robots_from=RobotsFrom.ROS)
    assert read_study_text(FILE, resolved(study)) == study


def test_nav2_robots_have_the_names_of_nav2() -> None:
    remote, nav2 = FleetNames().nav2_names(2, RosDistribution.JAZZY)
    assert (nav2.action, nav2.tf, nav2.tf_static) == ("/robot2/navigate_to_pose", "/robot2/tf", "/robot2/tf_static")
    assert remote.action("status") == "/robot2/navigate_to_pose/_action/status"
    assert (remote.plan, remote.battery, remote.odom) == ("/robot2/plan", "/robot2/battery_state", "/robot2/odom")
    assert not nav2.is_twist_stamped
    assert FleetNames().nav2_names(2, RosDistribution.KILTED)[1].is_twist_stamped
    shared = FleetNames(nav2=Nav2FleetNames(tf="/tf", stamped_cmd_vel=False))
    assert shared.nav2_names(2, RosDistribution.KILTED)[1] == Nav2Names(nav2.action, "/tf", nav2.tf_static, False)


def test_nav2_robots_may_share_names_of_frames_unless_they_share_a_topic_of_transforms() -> None:
    own = FleetSection(robot=FleetNames(odom_frame="odom"))
    assert own.clash(2, RobotsFrom.ROS2) is None
    assert own.clash(2, RobotsFrom.ROS) is not None
    shared = FleetSection(robot=FleetNames(odom_frame="odom", nav2=Nav2FleetNames(tf="/tf")))
    clash = shared.clash(2, RobotsFrom.ROS2)
    assert clash is not None
    assert clash.field == "odom_frame"
    same = FleetSection(robot=FleetNames(nav2=Nav2FleetNames(action="/navigate_to_pose")))
    assert same.clash(2, RobotsFrom.ROS2) is not None


def test_names_of_nav2_are_checked() -> None:
    named = FleetNames(nav2=Nav2FleetNames(tf="my tf"))
    assert [field for field, _ in named.faults(1)] == ["nav2.tf"]
