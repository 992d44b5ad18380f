"""Topics of a session on a ROS 2 graph: names, types and quality of service of Nav2, made from the topics of ROS 1.

Frames keep the names that they have in ROS 1, such as robot1/odom. Transforms are published twice: of all robots on
/tf and /tf_static, and of each robot in its namespace, where Nav2's nodes expect them.

Source: ros-navigation/navigation2: nav2_amcl, nav2_map_server, nav2_planner, nav2_controller, nav2_costmap_2d;
ros2/geometry2, tf2_ros/qos.hpp. Differences from Nav2: /clock is reliable, so that all subscriptions get it.
Plans are latched, because they are only published after a change.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import TypeAlias

import numpy as np

from thbridge.ros import names
from thbridge.ros.messages import pack, types, unpack
from thbridge.ros.messages.cursor import UINT32, Cursor
from thbridge.ros.messages.pack.fields import stamp
from thbridge.ros.names import RobotNames
from thbridge.ros.topics import CLOCK, RosMessage, Topic
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.qos import DEFAULT, LATCHED, ROSOUT, SENSOR_DATA, TF, QosProfile

SESSION_NODE = "/thbridge"
PARTICLE_CLOUD = "nav2_msgs/msg/ParticleCloud"
TWIST, TWIST_STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
_TWIST_STAMPED_OF_ROS1 = "geometry_msgs/TwistStamped"

Convert: TypeAlias = Callable[[RosMessage], bytes]
"""Function that returns a message of ROS 1 in CDR."""


@dataclass(frozen=True, slots=True)
class Ros2Topic:
    """Topic of a session on a ROS 2 graph.

    Attributes:
        name: for example "/robot1/scan".
        type: for example "sensor_msgs/msg/LaserScan".
        qos: quality of service that is offered.
        node: full name of the node that publishes it.
    """

    name: str
    type: str
    qos: QosProfile
    node: str = SESSION_NODE


LEFT_OUT = {
    names.MAP_METADATA: "it is part of the map",
    "initialpose": "it has only messages of clients",
    "move_base_simple/goal": "clients publish goal_pose",
    "move_base/goal": "the action navigate_to_pose replaces it",
    "move_base/cancel": "the action navigate_to_pose replaces it",
    "move_base/status": "the action navigate_to_pose replaces it",
    "move_base/feedback": "the action navigate_to_pose replaces it",
    "move_base/result": "the action navigate_to_pose replaces it",
}
"""Topics of ROS 1 that do not exist on ROS 2 graphs, with the reasons. Topics of robots have no namespace here."""

_COMMAND = QosProfile(1)
_PLACES = {
    "amcl_pose": ("amcl_pose", "amcl", LATCHED),
    "particlecloud": ("particle_cloud", "amcl", SENSOR_DATA),
    "scan": ("scan", "", SENSOR_DATA),
    "battery": ("battery_state", "", DEFAULT),
    "cmd_vel": ("cmd_vel", "controller_server", _COMMAND),
    "plan": ("plan", "planner_server", LATCHED),
    "local_plan": ("local_plan", "controller_server", LATCHED),
    "move_base/global_costmap/costmap": ("global_costmap/costmap", "global_costmap/global_costmap", LATCHED),
    "move_base/local_costmap/costmap": ("local_costmap/costmap", "local_costmap/local_costmap", LATCHED),
    "move_base/global_costmap/footprint": (
        "global_costmap/published_footprint",
        "global_costmap/global_costmap",
        DEFAULT,
    ),
    "move_base/local_costmap/footprint": ("local_costmap/published_footprint", "local_costmap/local_costmap", DEFAULT),
}
"""Name, node and quality of service of robots' topics that differ from the usual: the same name, our node, default."""


class SessionTopics:
    """Topics of a session on a ROS 2 graph.

    Args:
        distribution: message types.
        topics: topics of the session in ROS 1, without the clock.
        robots: number of robots.

    Attributes:
        targets: topics of the graph by the name of the topic of the session, each with its conversion.
        all: all topics of the graph.
        left_out: topics of ROS 1 that have no topic on the graph.
    """

    def __init__(self, distribution: Distribution, topics: Sequence[Topic], robots: int) -> None:
        self._distribution = distribution
        self._robots = [RobotNames.of(robot) for robot in range(robots)]
        self.targets = {topic.name: tuple(self._targets_of(topic)) for topic in (CLOCK, *topics)}
        self.left_out = tuple(name for name, targets in self.targets.items() if not targets)
        self.all = tuple(target for targets in self.targets.values() for target, _ in targets)

    def _targets_of(self, topic: Topic) -> Iterator[tuple[Ros2Topic, Convert]]:
        within = self._within(topic.name)
        word = topic.name if within is None else within[1]
        if word in LEFT_OUT:
            return
        if within is not None:
            yield self._target_of_robot(topic, *within)
            return
        kind = type_of_ros1(topic.msgtype)
        convert = converter_from_ros1(self._distribution, topic.msgtype, kind)
        qos = {names.TF: TF, names.ROSOUT: ROSOUT}.get(topic.name, LATCHED if topic.latched else DEFAULT)
        yield Ros2Topic(topic.name, kind, qos), convert
        for robot in self._robots:
            own = robot.topic(topic.name[1:])
            if topic.name == names.MAP:
                yield Ros2Topic(own, kind, qos, robot.topic("map_server")), convert
            elif topic.name in {names.TF, names.TF_STATIC}:
                yield Ros2Topic(own, kind, qos), partial(_transforms_of, convert, robot.namespace[1:])

    def _within(self, name: str) -> tuple[RobotNames, str] | None:
        """Return the robot of a topic, and the rest of the topic's name; None for topics of the team."""
        for robot in self._robots:
            if name.startswith(f"{robot.namespace}/"):
                return robot, name.removeprefix(f"{robot.namespace}/")
        return None

    def _target_of_robot(self, topic: Topic, robot: RobotNames, word: str) -> tuple[Ros2Topic, Convert]:
        last = word.rpartition("/")[2]
        # The topics of plans contain the names of planners.
        place = _PLACES.get(last if topic.msgtype == types.PATH else word)
        usual = word, "", LATCHED if topic.latched else DEFAULT
        name, node, qos = place or usual
        kind, convert = self._kind_of(topic, word)
        return Ros2Topic(robot.topic(name), kind, qos, robot.topic(node) if node else SESSION_NODE), convert

    def _kind_of(self, topic: Topic, word: str) -> tuple[str, Convert]:
        if word == "particlecloud":
            return PARTICLE_CLOUD, _particle_cloud
        kind = velocity_type(self._distribution) if word == "cmd_vel" else type_of_ros1(topic.msgtype)
        return kind, converter_from_ros1(self._distribution, topic.msgtype, kind)


def velocity_type(distribution: Distribution) -> str:
    """Return the type of Nav2's velocity commands. Since Kilted, they have a time stamp."""
    return TWIST if distribution.name == "jazzy" else TWIST_STAMPED


def type_of_ros1(ros1_type: str) -> str:
    """Return the type of ROS 2 for a type of ROS 1."""
    if ros1_type == types.LOG:
        return "rcl_interfaces/msg/Log"
    package, _, name = ros1_type.partition("/")
    return f"{package}/msg/{name}"


def converter_from_ros1(distribution: Distribution, ros1_type: str, kind: str) -> Convert:
    """Return the function that converts messages of a topic. A velocity gets its time stamp if `kind` has one."""
    if (ros1_type, kind) == (types.TWIST, TWIST_STAMPED):
        return partial(_stamped_twist, distribution.from_ros1(_TWIST_STAMPED_OF_ROS1, TWIST_STAMPED))
    convert = distribution.from_ros1(ros1_type, kind)
    return lambda message: convert(message.data)


def converter_to_ros1(distribution: Distribution, kind: str, ros1_type: str) -> Callable[[bytes], bytes]:
    """Return the function of the opposite direction. It raises ValueError for bytes that are not a message."""
    if (ros1_type, kind) == (types.TWIST, TWIST_STAMPED):
        convert = distribution.to_ros1(TWIST_STAMPED, _TWIST_STAMPED_OF_ROS1)
        return lambda data: Cursor.behind_header(convert(data)).remaining()
    return distribution.to_ros1(kind, ros1_type)


def _transforms_of(convert: Convert, namespace: str, message: RosMessage) -> bytes:
    """Return the transforms of one robot, whose child or parent frame is in its namespace."""
    pieces = _transforms_by_namespace(message.data).get(namespace, ())
    return convert(message._replace(data=pack.stamped_transforms(pieces)))


@lru_cache(maxsize=1)
def _transforms_by_namespace(data: bytes) -> Mapping[str, Sequence[bytes]]:
    """Return the transforms of a message by namespace. The topics of all robots need it, one after the other."""
    pieces: dict[str, list[bytes]] = defaultdict(list)
    for parent, child, piece in unpack.transform_pieces(data):
        for namespace in {frame.partition("/")[0] for frame in (parent, child) if "/" in frame}:
            pieces[namespace].append(piece)
    return pieces


def _stamped_twist(convert: Callable[[bytes], bytes], message: RosMessage) -> bytes:
    """Return a velocity command with its time stamp; `convert` makes CDR of geometry_msgs/TwistStamped."""
    header = UINT32.pack(0) + stamp(message.stamp_ns) + UINT32.pack(0)
    return convert(header + message.data)


def _particle_cloud(message: RosMessage) -> bytes:
    """Return geometry_msgs/PoseArray as nav2_msgs/ParticleCloud, whose particles have equal weights."""
    cursor = Cursor(message.data)
    stamp_ns, frame = cursor.header()
    count = cursor.integer(UINT32)
    weighted = np.empty((count, 8), dtype="<f8")
    weighted[:, :7] = cursor.reals(7 * count).reshape(count, 7)
    weighted[:, 7] = 1.0 / max(count, 1)
    text = frame.encode() + b"\0"
    head = stamp(stamp_ns) + UINT32.pack(len(text)) + text
    head += bytes(-len(head) % 4) + UINT32.pack(count)
    return b"\0\1\0\0" + head + (bytes(-len(head) % 8) + weighted.tobytes() if count else b"")
