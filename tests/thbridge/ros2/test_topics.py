"""Topics of a session on a ROS 2 graph."""

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.world.sensors import mount_of
from tests.support.project import ROOT
from thbridge.recording.bag.reading.reader import recorded
from thbridge.ros.messages import pack
from thbridge.ros.publisher import TeamPublisher, clock_message
from thbridge.ros.topics import TF, RosMessage, Topic
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.qos import LATCHED, SENSOR_DATA
from thbridge.ros2.topics import LEFT_OUT, SessionTopics
from thbridge.study.built_in import STANDARD

PUBLISHER = TeamPublisher(2, mount_of(STANDARD.world.laser), 0.1, vehicles=True)


@pytest.fixture(scope="module", params=["jazzy", "kilted"])
def topics(request: pytest.FixtureRequest) -> SessionTopics:
    return SessionTopics(Distribution.of(request.param), PUBLISHER.topics, 2)


def test_each_topic_of_a_session_is_published_or_left_out_with_a_reason(topics: SessionTopics) -> None:
    for name in topics.left_out:
        word = name if name in LEFT_OUT else name.split("/", 2)[2]
        assert LEFT_OUT[word], name


def test_topics_have_the_names_and_the_quality_of_nav2(topics: SessionTopics) -> None:
    known = {topic.name: topic for topic in topics.all}
    assert len(known) == len(topics.all)
    assert known["/robot2/map"].qos == LATCHED
    assert known["/robot2/map"].node == "/robot2/map_server"
    assert known["/robot1/scan"].qos == SENSOR_DATA
    assert known["/robot1/particle_cloud"].type == "nav2_msgs/msg/ParticleCloud"
    assert known["/robot1/plan"].node == "/robot1/planner_server"
    assert "/robot1/global_costmap/costmap" in known


def test_the_transforms_of_each_robot_are_in_its_namespace(topics: SessionTopics) -> None:
    lines = [
        pack.Transform("map", "robot1/odom", Pose2(1.0, 0.0, 0.0)),
        pack.Transform("robot2/odom", "robot2/base_footprint", Pose2(2.0, 0.0, 0.0)),
    ]
    message = RosMessage(TF, 0, pack.transforms(5, lines))
    frames = {
        target.name: [
            each.child_frame_id for each in Distribution.of("jazzy").decode(target.type, convert(message)).transforms
        ]
        for target, convert in topics.targets[TF.name]
    }
    assert frames == {
        "/tf": ["robot1/odom", "robot2/base_footprint"],
        "/robot1/tf": ["robot1/odom"],
        "/robot2/tf": ["robot2/base_footprint"],
    }


@pytest.mark.parametrize("count", [0, 1, 300])
def test_particles_have_equal_weights(topics: SessionTopics, count: int) -> None:
    poses = np.linspace(0.0, 1.0, 3 * count).reshape(count, 3)
    topic = next(each for each in PUBLISHER.topics if each.name == "/robot1/particlecloud")
    message = RosMessage(topic, 0, pack.pose_array(5, "map", poses))
    ((target, convert),) = topics.targets[topic.name]
    cloud = Distribution.of("jazzy").decode(target.type, convert(message))
    assert cloud.header.frame_id == "map"
    assert [each.pose.position.x for each in cloud.particles] == poses[:, 0].tolist()
    assert sum(each.weight for each in cloud.particles) == pytest.approx(float(count > 0))


def test_the_clock_is_a_topic(topics: SessionTopics) -> None:
    message = clock_message(50)
    ((target, convert),) = topics.targets[message.topic.name]
    assert target.name == "/clock"
    assert Distribution.of("jazzy").decode(target.type, convert(message)).clock.sec == 2


def test_each_message_of_a_hunt_can_be_read(topics: SessionTopics) -> None:
    distribution = Distribution.of("jazzy")
    read = set()
    for publisher, stamp_ns, data in recorded(ROOT / "tests" / "system" / "studies_of_0_1" / "hunt.bag"):
        topic = Topic(publisher.topic, publisher.msgtype)
        for target, convert in topics.targets.get(topic.name, ()):
            # rosbags reads the message, and writes the same bytes.
            message = convert(RosMessage(topic, stamp_ns, data))
            assert distribution.encode(target.type, distribution.decode(target.type, message)) == message
            read.add(target.name)
    assert len(read) > 25
