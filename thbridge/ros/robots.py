"""Whose a topic or a frame is, and what it is for, by the names and types that robots of the field use.

Names differ: Stage says `/robot_0/base_scan`, TurtleBot `/odom`, robot_localization `/odometry/filtered`, a camera
`/camera/odom/sample`. What a message is can be told from its type; whose it is, from the prefix of its frame, and else
from its namespace, unless that names a node.
"""

import re
from collections.abc import Collection, Iterable, Mapping

from thbridge.ros.frames import frame_name

MAP_FRAMES = frozenset({"map", "world", "static_map"})
"""Frames that a map is in, by their last word."""
ODOM_FRAME = "odom"
"""What frames of odometry begin with, by their last word: odom, odom_combined."""

_OWN_TOPICS = frozenset(
    {
        *("odom", "base_pose_ground_truth", "scan", "base_scan", "amcl_pose", "cmd_vel", "battery", "battery_state"),
        *("particlecloud", "initialpose", "robot_pose"),
    }
)
"""Topics that stand in a robot's own namespace."""
_NODES = re.compile(
    r"odom|pose|[eu]kf|filter|camera|slam|locali[sz]|base$|driver|controller|move_base|amcl|imu|gps|zed|t265|gazebo|ground"
)
"""What namespaces are called that are a node's, not a robot's."""
_TRUTH = re.compile(r"ground_?truth|(^|[/_])(gt|truth|mocap|vicon|vrpn\w*|optitrack)([/_]|$)")


def last_word(name: str) -> str:
    """What a topic or frame is called without its namespace or prefix."""
    return name.rpartition("/")[2]


def is_map_frame(frame: str) -> bool:
    """Whether poses in a frame are places on a map."""
    return last_word(frame_name(frame)) in MAP_FRAMES


def is_odom_frame(frame: str) -> bool:
    """Whether poses in a frame are counted by odometry."""
    return last_word(frame_name(frame)).startswith(ODOM_FRAME)


def is_truth(topic: str) -> bool:
    """Whether a topic of poses is called as topics are that know the truth: of simulators, of motion capture."""
    return _TRUTH.search(topic.lower()) is not None


def prefix_of(frame: str) -> str:
    """The robot's part of a frame: "robot1" of "/robot1/base_link", "" where there is none."""
    return frame_name(frame).rpartition("/")[0]


def namespace_of(topic: str) -> str:
    """The robot's part of a topic: "robot1" of "/robot1/odom"; "" where it has none, or the namespace is a node's."""
    words = topic.strip("/").split("/")
    for length in range(len(words) - 1, 0, -1):
        if words[length] in _OWN_TOPICS or words[length] == "move_base":
            namespace = "/".join(words[:length])
            return "" if _NODES.search(words[length - 1].lower()) else namespace
    return ""


def owner_of(topic: str, robots: Collection[str]) -> str:
    """The robot among those known that a topic belongs to.

    The one whose namespace it is in; else the only one there is; else the one without a name.
    """
    path = topic.strip("/")
    within = [robot for robot in robots if robot and path.startswith(f"{robot}/")]
    if within:
        return max(within, key=len)
    return next(iter(robots)) if len(robots) == 1 else namespace_of(topic)


def usual_first(topics: Iterable[str], usual: Collection[str]) -> list[str]:
    """Topics in the order of choice: those called as usual, in that order, then short ones."""
    ranks = {name: rank for rank, name in enumerate(usual)}
    return sorted(topics, key=lambda topic: (ranks.get(last_word(topic), len(ranks)), topic.count("/"), topic))


def owner_of_edge(key: tuple[str, str, str]) -> str:
    """Whose a transform is: as the prefix of a frame says, else the namespace of its tf.

    Args:
        key: namespace of the topic, parent frame, child frame.
    """
    namespace, parent, child = key
    return prefix_of(child) or prefix_of(parent) or namespace


def robots_among(
    odometry: Mapping[str, str], edges: Iterable[tuple[str, str, str]], others: Iterable[str]
) -> frozenset[str]:
    """Prefixes of frames and namespaces that are robots; "" is one without.

    Args:
        odometry: topics of odometry, each with the frame whose pose it says.
        edges: of tf, as for `owner_of_edge`, from frames of odometry.
        others: topics that only a robot has.
    """
    found = {prefix_of(child) or namespace_of(topic) for topic, child in odometry.items()}
    if not found:
        found |= {owner_of_edge(edge) for edge in edges}
    for topic in others:
        found.add(owner_of(topic, found) if found else namespace_of(topic))
    named = found - {""}
    return frozenset(named if len(named) == 1 else found)


def by_number(robot: str) -> tuple[int, str]:
    """What robots are sorted by: robot2 comes before robot10."""
    digits = "".join(sign for sign in robot if sign.isdigit())
    return int(digits or 0), robot
