"""Real Nav2 robots of a ROS 2 graph, as the robots of a study."""

from dataclasses import dataclass

import numpy as np

from sim.common.robot_numbers import namespace_of
from thbridge.app.compose.setting import StudySetting
from thbridge.files.ros.definitions import ROS_SHARES, Definitions
from thbridge.ros.reconfigure import DescribedParameter
from thbridge.ros.remote.robot import RemoteRobot
from thbridge.ros.topics import RosMessage, Topic
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.nav2_goals import Nav2Goals
from thbridge.ros2graph.sockets.joining import carrier_of
from thbridge.ros2graph.sockets.nav2_fleet import NODE, Nav2Fleet, Nav2Robot
from thbridge.ros2graph.values.address import Ros2Address
from thbridge.rosgraph.sockets.fleet import TrafficRecorder
from thbridge.rosgraph.wire.links import TopicHeader
from thbridge.sockets.admission import Admission


@dataclass(frozen=True, slots=True)
class Nav2Traffic:
    """Recorder of a fleet of ROS 2, which passes messages on in the form of ROS 1.

    Attributes:
        held: the recorder of ROS 1.
        definitions: definitions of message types.
    """

    held: TrafficRecorder
    definitions: Definitions

    def received(self, topic: Topic, publisher: str, stamp_ns: int, data: bytes) -> None:
        """Record a received message."""
        definition = self.definitions.of(topic.msgtype)
        header = TopicHeader(topic.name, topic.msgtype, definition.md5, definition.text, topic.latched)
        self.held.received(header, publisher, stamp_ns, data)

    def sent(self, message: RosMessage) -> None:
        """Record a message to a robot."""
        self.held.sent(message)


def build_nav2_fleet(
    setting: StudySetting, graph: Ros2Address, traffic: TrafficRecorder, offset: DescribedParameter
) -> Nav2Fleet:
    """Return the real robots of a study, before they join their graph; see `Nav2Fleet`."""
    study, section = setting.study, setting.study.fleet
    footprint = np.array(study.world.footprint, dtype=np.float64)
    stale_ns = round(section.silence * 1e9)
    robots = []
    for robot, (remote, nav2) in enumerate(section.nav2_names(study.robots, graph.distribution)):
        goals = Nav2Goals(remote, f"{NODE.whole}-{namespace_of(robot)}-")
        robots.append(Nav2Robot(RemoteRobot(robot, remote, NODE.whole, footprint, stale_ns), nav2, goals))
    recorder = Nav2Traffic(traffic, Definitions(ROS_SHARES))
    types = Distribution.of(graph.distribution.value)
    return Nav2Fleet(
        carrier_of(graph, Admission.to(study.open_to)),
        types,
        robots,
        recorder,
        offset,
        is_time_simulated=study.ros2.use_sim_time,
    )
