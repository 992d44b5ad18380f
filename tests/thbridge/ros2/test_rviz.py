"""rviz2 asks for the topics that a session publishes, with a quality of service that it offers."""

from collections.abc import Iterator

import numpy as np
import pytest
from ruamel.yaml import YAML

from sim.common.geometry import IDENTITY
from sim.common.grid import OccupancyGrid
from sim.world.sensors import mount_of
from tests.support.programs.commands import invoke
from thbridge.ros.publisher import TeamPublisher
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.qos import DEFAULT, DeliveryReliability, Durability, QosProfile
from thbridge.ros2.rviz import rviz2_configuration
from thbridge.ros2.topics import SessionTopics
from thbridge.study.built_in import STANDARD

ROBOTS = 3
GRID = OccupancyGrid(np.zeros((20, 40), dtype=np.int8), 0.5, IDENTITY)
TYPES = {
    "Map": "nav_msgs/msg/OccupancyGrid",
    "LaserScan": "sensor_msgs/msg/LaserScan",
    "ParticleCloud": "nav2_msgs/msg/ParticleCloud",
    "Path": "nav_msgs/msg/Path",
    "Polygon": "geometry_msgs/msg/PolygonStamped",
    "PoseWithCovariance": "geometry_msgs/msg/PoseWithCovarianceStamped",
    "Odometry": "nav_msgs/msg/Odometry",
    "MarkerArray": "visualization_msgs/msg/MarkerArray",
}
"""Message types of displays, as rviz2's plugins declare them."""


@pytest.fixture(scope="module")
def manager() -> dict:
    text = rviz2_configuration([STANDARD.robot] * ROBOTS, GRID)
    return YAML(typ="safe").load(text)["Visualization Manager"]


def displays(section: dict) -> Iterator[dict]:
    for each in section.get("Displays", ()):
        yield each
        yield from displays(each)


def qos_of(topic: dict) -> QosProfile:
    assert topic["History Policy"] == "Keep Last"
    return QosProfile(
        topic["Depth"],
        {"Reliable": DeliveryReliability.RELIABLE, "Best Effort": DeliveryReliability.BEST_EFFORT}[
            topic["Reliability Policy"]
        ],
        {"Volatile": Durability.VOLATILE, "Transient Local": Durability.TRANSIENT_LOCAL}[topic["Durability Policy"]],
    )


def test_each_display_has_a_published_topic_with_its_type_and_quality(manager: dict) -> None:
    publisher = TeamPublisher(ROBOTS, mount_of(STANDARD.world.laser), 0.1)
    published = {topic.name: topic for topic in SessionTopics(Distribution.of("kilted"), publisher.topics, ROBOTS).all}
    found = [each for each in displays(manager) if "Topic" in each]
    assert len(found) > 3 + 8 * ROBOTS
    for each in found:
        topic = published[each["Topic"]["Value"]]
        assert topic.type == TYPES[each["Class"].partition("/")[2]], each
        assert topic.qos == qos_of(each["Topic"]), each


def test_classes_are_those_of_rviz2(manager: dict) -> None:
    classes = {each["Class"] for each in [*displays(manager), *manager["Tools"], manager["Views"]["Current"]]}
    assert {name.partition("/")[0] for name in classes} == {"rviz_common", "rviz_default_plugins", "nav2_rviz_plugins"}
    assert "rviz_default_plugins/TF" in classes
    assert "rviz_default_plugins/RobotModel" not in classes


def test_each_robot_has_tools_for_its_pose_and_its_goal(manager: dict) -> None:
    tools = [(each["Class"], each["Topic"]["Value"]) for each in manager["Tools"] if "Topic" in each]
    assert tools == [
        (f"rviz_default_plugins/{kind}", f"/robot{number}/{topic}")
        for number in range(1, ROBOTS + 1)
        for kind, topic in (("SetInitialPose", "initialpose"), ("SetGoal", "goal_pose"))
    ]
    assert {qos_of(each["Topic"]) for each in manager["Tools"] if "Topic" in each} == {DEFAULT}


def test_the_command_writes_it() -> None:
    done = invoke("ros", "rviz", "--ros2", "--robots", "2")
    assert done.exit_code == 0
    assert "/robot2/goal_pose" in done.stdout
    assert "/robot1/scan" in done.stdout
