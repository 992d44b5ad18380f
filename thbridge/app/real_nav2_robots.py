"""Real Nav2 robots of a ROS 2 graph, as the robots of a study."""

from collections.abc import Callable
from dataclasses import dataclass

from sim.common.robot_numbers import namespace_of
from thbridge.app.compose.setting import StudySetting
from thbridge.files.ros.definitions import ROS_SHARES, Definitions
from thbridge.ros import names
from thbridge.ros.reconfigure import DescribedParameter
from thbridge.ros.remote.names import RemoteNames
from thbridge.ros.remote.robot import RemoteRobot
from thbridge.ros.topics import RosMessage, Topic
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.nav2_goals import Nav2Goals
from thbridge.ros2graph.sockets.joining import carrier_of
from thbridge.ros2graph.sockets.nav2_fleet import Nav2Fleet, Nav2Robot
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
    setting: StudySetting,
    graph: Ros2Address,
    robot_of: Callable[[int, RemoteNames], RemoteRobot],
    traffic: TrafficRecorder,
    offset: DescribedParameter,
) -> Nav2Fleet:
    """Return the real robots of a study, before they join their graph; see `Nav2Fleet`."""
    study = setting.study
    robots = [
        Nav2Robot(robot_of(robot, remote), nav2, Nav2Goals(remote, f"{names.FLEET}-{namespace_of(robot)}-"))
        for robot, (remote, nav2) in enumerate(study.fleet.nav2_names(study.robots, graph.distribution))
    ]
    return Nav2Fleet(
        carrier_of(graph, Admission.to(study.open_to)),
        Distribution.of(graph.distribution.value),
        robots,
        Nav2Traffic(traffic, Definitions(ROS_SHARES)),
        offset,
        is_time_simulated=study.ros2.use_sim_time,
    )
