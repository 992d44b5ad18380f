import re
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from sim.geometry import Pose2
from sim.navigator import Cancelled, Goal
from sim.team import TeamSnapshot
from sim.things import Presence, Thing, polygons_of
from tests.thbridge.ros.drive import LEG, MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.ros import unpack
from thbridge.ros.names import RobotNames
from thbridge.ros.publisher import Message, Publisher
from thbridge.ros.types import plain_definition


def published(robots: int, ticks: int) -> list[Message]:
    publisher = Publisher(robots, MOUNT, SCAN_PERIOD)
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
    opening = Publisher(2, MOUNT, SCAN_PERIOD).opening(0, SESSION, arena())
    assert [message.topic.name for message in opening] == ["/thbridge/session", "/tf_static", "/map", "/map_metadata"]
    assert all(message.topic.latched for message in opening)
    assert all(message.stamp_ns == 1_000_000_000 for message in opening)


def test_one_static_message_leads_from_every_base_to_its_laser() -> None:
    static = Publisher(2, MOUNT, SCAN_PERIOD).opening(0, SESSION, arena())[1]
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
    publisher = Publisher(1, MOUNT, SCAN_PERIOD)
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
    tf = Publisher(1, MOUNT, SCAN_PERIOD).tick(snapshot)[0]
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
    kinds = [name.rpartition("/")[2] for name in names if name.startswith("/robot1/move_base/") and "plan" not in name]
    assert kinds == ["goal", "result", "goal", "result"]


def test_a_goal_that_another_replaces_ends_before_the_other_begins() -> None:
    first, second = snapshots(1, 2)
    publisher = Publisher(1, MOUNT, SCAN_PERIOD)
    publisher.tick(first)
    old = first.robots[0].navigation.goal
    assert old is not None
    navigation = replace(second.robots[0].navigation, goal=Goal(99, Pose2(1.0, 1.0, 0.0)), result=Cancelled(old))
    said = publisher.tick(_with(second, navigation=navigation))
    assert [m.topic.name.rpartition("/")[2] for m in said if "move_base/" in m.topic.name] == ["result", "goal"]


def test_a_plan_is_said_when_new_and_when_gone_but_not_as_it_is_driven() -> None:
    plans = [m for m in published(1, 2 * LEG) if m.topic.name.endswith("/plan")]
    assert len(plans) == 3  # the first leg's, none, the second leg's


def test_a_localiser_without_particles_says_no_cloud() -> None:
    (snapshot,) = snapshots(1, 1)
    estimate = replace(snapshot.robots[0].estimate, updated=True, particles=np.empty((0, 3)))
    names = {m.topic.name for m in Publisher(1, MOUNT, SCAN_PERIOD).tick(_with(snapshot, estimate=estimate))}
    assert "/robot1/amcl_pose" in names
    assert "/robot1/particlecloud" not in names


def test_a_team_of_another_size_is_refused() -> None:
    (snapshot,) = snapshots(2, 1)
    with pytest.raises(ValueError):
        Publisher(3, MOUNT, SCAN_PERIOD).tick(snapshot)


def _with(snapshot: TeamSnapshot, **changes: object) -> TeamSnapshot:
    return replace(snapshot, robots=(replace(snapshot.robots[0], **changes),))


def crate(x: float) -> Presence:
    return Presence(Thing("crate", ((0.1, 0.1), (-0.1, 0.1), (0.0, -0.1)), Pose2(x, 2.0, 0.0)), appeared=True)


def test_things_are_said_when_they_come_and_go_and_at_ten_hertz_when_they_walk() -> None:
    publisher = Publisher(1, MOUNT, SCAN_PERIOD)
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
    messages = Publisher(2, MOUNT, SCAN_PERIOD).tick(replace(snapshot, dead=frozenset({1})))
    of_second = [message.topic.name for message in messages if message.topic.name.startswith("/robot2")]
    assert of_second == ["/robot2/base_pose_ground_truth"]
    assert {transform.child for _, transform in unpack.transforms(messages[0].data)} == {
        "robot1/odom",
        "robot1/base_footprint",
    }
